#!/bin/sh
# The cost of a ray as the scene grows (see the top of growth.c), the time of a picture by the number of threads, and
# by the size of the tiles. Arguments: those of growth.c; or `threads` or `tiles` for these tables alone.
# MODELS: the folder with the OBJ files (default ../shared/models). MOST: the largest number of objects (default 10
# million).
cd "$(dirname "$0")/.." || exit 1
BUILD=${BUILD:-build/release}
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
scene=${SCENE:-data/04demo.lua}

# wall-clock and processor seconds of the picture; the best of three
seconds_of() {
    for round in 1 2 3; do
        "$1" -q --size 640x480 -j "$2" --stats=json -o "$3-%d.png" "$scene" |
            sed 's/.*"render_seconds":\([0-9.]*\).*"render_processor_seconds":\([0-9.]*\).*/\1 \2/' |
            awk '{ wall += $1; work += $2 } END { print wall, work }'
    done >"$folder/rounds"
    echo "$(cut -d ' ' -f 1 "$folder/rounds" | sort -n | head -1) $(cut -d ' ' -f 2 "$folder/rounds" | sort -n | head -1)"
}

threads_table() {
    make -s BUILD="$BUILD" all || exit 1
    echo "threads   wall s  ratio   work s   ($scene, 640 x 480)"
    first=
    for threads in 1 2 3 4 8 32 128; do
        set -- $(seconds_of "$BUILD/gray" "$threads" "$folder/$threads")
        first=${first:-$1}
        echo "$threads $1 $2 $first" | awk '{ printf "%7d %8.3f %6.2f %8.3f\n", $1, $2, $4 / $2, $3 }'
        cmp -s "$folder/1-1.png" "$folder/$threads-1.png" || echo "        another picture with $threads threads"
    done
}

# A tile also samples a rim of one pixel around it: (side + 2)^2 / side^2 of the first pass. Every size needs a separate
# build of the program.
tiles_table() {
    echo "tile side   wall s, 1 thread   work s   wall s, ${MANY:-8} threads   work s   ($scene, 640 x 480)"
    for side in 8 16 32 64 128; do
        make -s BUILD="build/tile-$side" CFLAGS="$CFLAGS -DGRAY_TILE=$side" all || exit 1
        set -- $(seconds_of "build/tile-$side/gray" 1 "$folder/side-$side") $(seconds_of "build/tile-$side/gray" "${MANY:-8}" "$folder/many-$side")
        echo "$side $*" | awk '{ printf "%9d %18.3f %8.3f %18.3f %8.3f\n", $1, $2, $3, $4, $5 }'
        cmp -s "$folder/side-8-1.png" "$folder/side-$side-1.png" || echo "        another picture with tiles of $side"
        cmp -s "$folder/side-8-1.png" "$folder/many-$side-1.png" || echo "        another picture with tiles of $side"
    done
    make -s BUILD="$BUILD" all # the link to the program points back to it
}

case $1 in
threads) threads_table && exit ;;
tiles) tiles_table && exit ;;
esac
make -s BUILD="$BUILD" "$BUILD/bench/growth" &&
    "$BUILD/bench/growth" --models "${MODELS:-../shared/models}" --most "${MOST:-1e7}" --svg "$BUILD/bench/growth.svg" "$@" || exit 1
[ $# -gt 0 ] && exit 0
echo
threads_table
echo
tiles_table
