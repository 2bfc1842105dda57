#!/bin/sh
# Layered materials under Whitted, in instructions of one thread (valgrind), as a multiple of classic ones; both at the
# same -ss. GRAY: the program; SIZE: of the pictures (default 160x90).
cd "$(dirname "$0")/.." || exit 1
gray=${GRAY:-./gray}
command -v valgrind >/dev/null 2>&1 || { echo "valgrind is not installed: left out"; exit 0; }
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
count() {
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$gray" -q -j1 --no-fork --size "${SIZE:-160x90}" "$@" \
        -o "$folder/picture.png" bench/openpbr.lua 2>&1 | sed -n 's/.*refs: *//p' | tr -d ,
}
layered=$(count) classic=$(count -D classic=true)
echo "$layered $classic" | awk '{ printf "layered %.2f, classic %.2f thousand million: %.2f times\n", $1 / 1e9, $2 / 1e9, $1 / $2 }'
