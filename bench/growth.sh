#!/bin/sh
# How the cost of a ray grows with the scene (see the top of growth.c), and how a picture goes with the number of threads.
# MODELS: the folder with the OBJ files (default ../shared/models). MOST: the largest number of things (default 10 million).
cd "$(dirname "$0")/.." || exit 1
BUILD=${BUILD:-build/release}
make -s BUILD="$BUILD" "$BUILD/bench/growth" &&
    "$BUILD/bench/growth" --models "${MODELS:-../shared/models}" --most "${MOST:-1e7}" --svg "$BUILD/bench/growth.svg" "$@" || exit 1
[ $# -gt 0 ] && exit 0
echo
echo "threads   wall s  ratio   (data/04demo.lua, 640 x 480)"
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
for threads in 1 2 3 4 8 32 128; do
    for round in 1 2 3; do
        "$BUILD/gray" -q --size 640x480 -j "$threads" --stats=json -o "$folder/$threads-%d.png" data/04demo.lua |
            sed 's/.*"render_seconds":\([0-9.]*\).*/\1/' | awk '{ sum += $1 } END { print sum }'
    done | sort -n | head -1 | awk -v threads="$threads" -v first="$(cat "$folder/first" 2>/dev/null)" \
        '{ printf "%7d %8.3f %6.2f\n", threads, $1, first ? first / $1 : 1; print $1 > "'"$folder"'/last" }'
    [ -f "$folder/first" ] || cp "$folder/last" "$folder/first"
    cmp -s "$folder/1-1.png" "$folder/$threads-1.png" || echo "        another picture with $threads threads"
done
