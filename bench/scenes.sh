#!/bin/sh
# Whole pictures against POV-Ray on the paired scenes of bench/pov: user seconds of tracing alone, one thread each, both at
# their adaptive anti-aliasing with 9 samples for a marked pixel; runs interleaved, medians of RUNS (default 3). Pictures go
# to OUT (default build/bench). MODELS: the folder with stanford-bunny.obj (default ../shared/models).
cd "$(dirname "$0")/.." || exit 1
here=$(pwd)
gray=${GRAY:-$here/gray}
runs=${RUNS:-3}
models=${MODELS:-$here/../shared/models}
out=${OUT:-$here/build/bench}
command -v povray >/dev/null 2>&1 || { echo "povray is not installed: left out"; exit 0; }
mkdir -p "$out" && cd "$out" || exit 1

median() { sort -n | awk '{ v[NR] = $1 } END { print NR ? v[int((NR + 1) / 2)] : "-" }'; }

# POV-Ray tells the CPU seconds of its trace stage on stderr.
pov_once() {
    povray +I"$here/bench/pov/$1.pov" +L"$out" +O"$out/$1-pov.png" +W640 +H480 -D -V +WT1 +FN +A0.05 +AM1 +R3 -J 2>"$1.log" >/dev/null
    sed -n 's/^ *Trace Time:.*(\([0-9.]*\) seconds).*/\1/p; s/^ *Trace Time:.*using.*(\([0-9.]*\) CPU.*/\1/p' "$1.log" | tail -n 1
}

gray_once() {
    scene=$1
    shift
    "$gray" -q -j 1 --stats=json -o "$out/$scene-gray.png" "$@" "$here/bench/pov/$scene.lua" 2>/dev/null |
        sed -n 's/.*"render_seconds":\([0-9.]*\).*/\1/p' | tail -n 1
}

pair() {
    scene=$1
    shift
    : >"$scene-pov.times"
    : >"$scene-gray.times"
    i=0
    while [ $i -lt "$runs" ]; do
        i=$((i + 1))
        pov_once "$scene" >>"$scene-pov.times"
        gray_once "$scene" "$@" >>"$scene-gray.times"
    done
    pov=$(median <"$scene-pov.times")
    mine=$(median <"$scene-gray.times")
    awk -v s="$scene" -v p="$pov" -v g="$mine" 'BEGIN { printf "%-12s %9.3f %9.3f %8.2f\n", s, p, g, (g > 0 ? p / g : 0) }'
}

printf '%-12s %9s %9s %8s\n' scene 'pov s' 'gray s' ratio
pair primitives -reflect-limit 4 -refract-limit 4
pair solids
if [ -f "$models/stanford-bunny.obj" ]; then
    "$gray" -q --allow-read "$models" -D MODEL="$models/stanford-bunny.obj" -D EXPORT=yes "$here/bench/pov/bunny.lua" >mesh.inc &&
        pair bunny -reflect-limit 4 --allow-read "$models" -D MODEL="$models/stanford-bunny.obj"
else
    echo "bunny: no $models/stanford-bunny.obj: left out"
fi
