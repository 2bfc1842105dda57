#!/bin/sh
# How soon the time left settles: every demo with --progress=json on one thread. For each picture the worst error from a
# third of its time on, in percent: of the whole time that is foretold (time so far and time left together), and of the
# time left until nine tenths are done. Time is processor time of the program, so that other work of the machine does not
# count. Small scenes are drawn in twice their size, to take seconds. OPTIONS: more words for gray.
cd "$(dirname "$0")/.." || exit 1
gray=${GRAY:-./gray}
out=${OUT:-build/bench}
mkdir -p "$out"

# The first line is the number of the process; before each other one comes its processor time in hundredths of a second.
with_clock() {
    read -r process
    clock=0
    while read -r line; do
        if read -r stat 2>/dev/null <"/proc/$process/stat"; then
            # shellcheck disable=SC2086
            set -- ${stat##*) }
            clock=$((${12} + ${13}))
        fi
        echo "$clock $line"
    done
}

printf '%-14s %9s %7s %14s %14s\n' scene seconds lines 'whole time, %' 'time left, %'
for scene in ${SCENES:-data/??demo.lua data/light.lua data/meshes.lua data/pyramid-fog.lua data/relief.lua data/solids.lua data/swept.lua}; do
    case $scene in
    *07demo* | *light* | *relief* | *swept*) size= ;;
    *) size='--size 1280x960' ;;
    esac
    # shellcheck disable=SC2016,SC2086
    sh -c 'echo "$$"; exec "$@" 2>&1 >/dev/null' sh "$gray" --no-fork -j 1 --progress=json $OPTIONS $size \
        --shard-pictures 1/1000 -o "$out/progress-%d.png" "$scene" |
        with_clock |
        awk -v scene="$(basename "$scene" .lua)" '
            function field(name,    at) {
                at = index($0, "\"" name "\":")
                return at ? substr($0, at + length(name) + 3) + 0 : -1
            }
            { clock = $1 / 100 }
            /"event":"(begin|build)"/ || /"event":"render"/ && field("share") <= 0 { begun = clock }
            /"event":"render"/ && field("share") > 0 { n++; at[n] = clock - begun; share[n] = field("share") }
            /"event":"written"/ { whole = clock - begun }
            END {
                for (i = 1; i <= n; i++) {
                    if (at[i] < whole / 3 || at[i] >= whole)
                        continue
                    lines++
                    error = at[i] / share[i] - whole
                    error = error < 0 ? -error : error
                    if (error / whole > worst)
                        worst = error / whole
                    if (at[i] < 0.9 * whole && error / (whole - at[i]) > worst_left)
                        worst_left = error / (whole - at[i])
                }
                printf "%-14s %9.2f %7d %14.1f %14.1f\n", scene, whole, lines, 100 * worst, 100 * worst_left
            }'
done
