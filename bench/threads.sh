#!/bin/sh
# Complete pictures with two threads and with one: RUNS runs of each (default 5), interleaved; medians.
#   program  wall-clock time of the whole program, including the script, which runs on one thread
#   picture  wall-clock time of building, rendering and writing
#   work     processor time of the picture on two threads relative to one: the overhead of threads
#   idle     the share of render time in which threads waited for the last tile
#   foretold from processor times: building and writing on one thread, rendering on two, minus idle
# Other programs on the machine change the first two numbers; the others much less.
# Arguments: scripts (default: demos 01, 03, 05, 06, 14 and those of bench/pov). THREADS: instead of 2. MODELS: as in scenes.sh.
cd "$(dirname "$0")/.." || exit 1
gray=${GRAY:-./gray}
runs=${RUNS:-5}
many=${THREADS:-2}
models=$(cd "${MODELS:-../shared/models}" 2>/dev/null && pwd)
[ -f "$models/stanford-bunny.obj" ] && bunny=bench/pov/bunny.lua
# shellcheck disable=SC2086
[ $# -gt 0 ] || set -- data/01demo.lua data/03demo.lua data/05demo.lua data/06demo.lua data/14demo.lua bench/pov/primitives.lua \
    bench/pov/solids.lua $bunny
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT

now() { date +%s.%N; }

# A line: seconds of the program; of the picture; processor seconds of building, rendering, writing; idle seconds; rendering.
once() {
    model=
    case $2 in *bunny*) model="--allow-read $models -D MODEL=$models/stanford-bunny.obj" ;; esac
    begun=$(now)
    # shellcheck disable=SC2086
    "$gray" -q -j "$1" --stats=json -o "$folder/$1-%d.png" $model $OPTIONS "$2" >"$folder/json" || return 1
    awk -v begun="$begun" -v ended="$(now)" '
        function figure(key,   at) { at = index($0, "\"" key "\":"); return at ? substr($0, at + length(key) + 3) + 0 : 0 }
        { wall += figure("build_seconds") + figure("render_seconds") + figure("write_seconds")
          build += figure("build_processor_seconds"); render += figure("render_processor_seconds")
          write += figure("write_processor_seconds"); idle += figure("idle_seconds"); rendering += figure("render_seconds") }
        END { print ended - begun, wall, build, render, write, idle, rendering }' "$folder/json"
}

column() { cut -d ' ' -f "$2" "$folder/times-$1" | sort -n | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }

printf '%-14s %9s %9s %9s %9s %9s %9s\n' scene 'picture s' program picture work 'idle %' foretold
for script in "$@"; do
    rm -f "$folder"/times-*
    run=0
    while [ $run -lt "$runs" ]; do
        run=$((run + 1))
        once 1 "$script" >>"$folder/times-1" && once "$many" "$script" >>"$folder/times-many" || exit 1
    done
    for k in 1 2 3 4 5 6 7; do echo "$(column 1 $k) $(column many $k)"; done |
        awk -v name="$(basename "$script" .lua)" -v many="$many" '
            { one[NR] = $1; two[NR] = $2 }
            END {
                idle = two[7] > 0 ? two[6] / many / two[7] : 0
                all = two[3] + two[4] + two[5]
                shared = two[3] + two[5] + two[4] / many / (1 - idle)
                printf "%-14s %9.3f %9.2f %9.2f %9.2f %9.1f %9.2f\n", name, one[2], one[1] / two[1], one[2] / two[2],
                    all / (one[3] + one[4] + one[5]), 100 * idle, all / shared
            }'
    cmp -s "$folder/1-1.png" "$folder/$many-1.png" || echo "    another picture on $many threads"
done
