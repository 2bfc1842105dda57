#!/bin/sh
# Counts the instructions of eight scenes with two programs (valgrind's callgrind) and prints their ratio: a measure
# that does not depend on the load of the machine.
#   bench/instructions.sh OLD NEW [SCENE...]
# One thread, one process, small pictures, --isa avx2 (valgrind has no AVX-512). A count includes everything: reading,
# building, rendering, writing. Repeated counts agree to about 0.01 %.
[ $# -ge 2 ] || { sed -n '2,6p' "$0" >&2; exit 2; }
old=$(realpath "$1") && new=$(realpath "$2") || exit 2
shift 2
cd "$(dirname "$0")/.." || exit 1
command -v valgrind >/dev/null 2>&1 || { echo "valgrind is not installed: left out"; exit 0; }
[ $# -gt 0 ] || set -- data/05demo.lua data/09demo.lua data/classic/cows.lua data/csg/machine.lua data/relief.lua \
    tests/pictures/glass.lua tests/pictures/materials.lua tests/pictures/caustics.lua
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
# Uses the Lua library of this tree, wherever the programs come from.
mkdir -p build/old build/new && cp "$old" build/old/gray && cp "$new" build/new/gray || exit 1
old=build/old/gray
new=build/new/gray

count() { # count PROGRAM SCENE: millions of instructions
    valgrind --tool=callgrind --callgrind-out-file=/dev/null --log-file="$work/log" "$1" -q --no-fork -j 1 --isa avx2 \
        -D quick=true --allow-read . --script-time 600 --size 64x48 -ss 2 -al-samples 2 -o "$work/p-%d.png" -- "$2" \
        >"$work/out" 2>&1 || { cat "$work/out" >&2; return 1; }
    awk '/Collected/ { printf "%.3f\n", $4 / 1e6 }' "$work/log"
}

echo "millions of instructions          old        new   new/old"
for scene in "$@"; do
    a=$(count "$old" "$scene") && b=$(count "$new" "$scene") || exit 1
    echo "$scene $a $b" | awk '{ printf "%-28s %10.1f %10.1f   %.4f\n", $1, $2, $3, $3 / $2 }'
done | tee "$work/table"
awk '{ sum += log($4); n++ } END { if (n) printf "geometric mean %41.4f\n", exp(sum / n) }' "$work/table"
