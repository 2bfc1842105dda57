#!/bin/sh
# Ten implicit solids compared with POV-Ray's isosurface: the same picture of 640 x 480 with a shadow and a floor, one
# thread, both with adaptive anti-aliasing and 9 samples for a marked pixel. POV-Ray's max_gradient is set by hand
# (bench/implicit/implicit.pov), its accuracy is 1e-4. Prints processor seconds of rendering; `whole` is gray's whole run,
# with reading, recording and building. Runs alternate; medians of RUNS (default 3). Pictures go to OUT (default
# build/bench). Arguments: functions (default: all).
cd "$(dirname "$0")/.." || exit 1
here=$(pwd)
gray=${GRAY:-$here/gray}
runs=${RUNS:-3}
out=${OUT:-$here/build/bench}
command -v povray >/dev/null 2>&1 || { echo "povray is not installed: left out"; exit 0; }
[ -x "$gray" ] || { echo "no program $gray: make first"; exit 1; }
mkdir -p "$out" && cd "$out" || exit 1
all="bumps gyroid wall barth heart metaballs twist superquadric lattice blend"
# shellcheck disable=SC2086
[ $# -gt 0 ] || set -- $all

median() { sort -n | awk '{ v[NR] = $1 } END { print NR ? v[int((NR + 1) / 2)] : "-" }'; }

number_of() {
    n=0
    for name in $all; do
        [ "$name" = "$1" ] && echo $n
        n=$((n + 1))
    done
}

once() {
    povray +I"$here/bench/implicit/implicit.pov" Declare=Name="$(number_of "$1")" +O"$1-pov.png" +W640 +H480 -D -V +WT1 +FN \
        File_Gamma=1.0 +A0.05 +AM1 +R3 -J 2>implicit.log >/dev/null
    awk '/^ *Trace Time:/ { getline; sub(/.*with /, ""); print $1 }' implicit.log >>implicit-pov.times
    (
        "$gray" -q -j 1 --stats=json -D NAME="$1" -o "$1-gray.png" "$here/bench/implicit/implicit.lua" >implicit.json
        times
    ) | tail -n 1 | awk '{ for (k = 1; k <= 2; k++) { split($k, part, /[ms]/); sum += 60 * part[1] + part[2] } print sum }' >>implicit-whole.times
    sed 's/.*"render_processor_seconds":\([0-9.]*\).*/\1/' implicit.json >>implicit-gray.times
}

printf '%-14s %9s %9s %9s %7s\n' function pov-ray gray whole ratio
: >implicit.table
for name in "$@"; do
    rm -f implicit-pov.times implicit-gray.times implicit-whole.times
    run=0
    while [ $run -lt "$runs" ]; do
        once "$name"
        run=$((run + 1))
    done
    echo "$name $(median <implicit-pov.times) $(median <implicit-gray.times) $(median <implicit-whole.times)" |
        awk '{ printf "%-14s %9.2f %9.2f %9.2f %7.2f\n", $1, $2, $3, $4, $2 / $3 }' | tee -a implicit.table
done
awk '{ sum += log($5) } END { if (NR) printf "geometric mean of %d: %.2f\n", NR, exp(sum / NR) }' implicit.table
