#!/bin/sh
# Draws the pictures of docs/library.md: the demos of data/library in small, with few colours so that they stay small (by
# ImageMagick, if it is there). Words on the command line choose some: docs/library/make_pictures.sh gears knots
cd "$(dirname "$0")/../.." || exit 1
[ $# -gt 0 ] || set -- $(basename -s .lua data/library/show_*.lua | sed 's/^show_//') shapes
reduce() { # reduce PICTURE COLOURS
    command -v convert >/dev/null && convert "$1" -dither FloydSteinberg -colors "$2" -strip "PNG8:$1"
}
for name in "$@"; do
    if [ "$name" = materials ]; then # 40 pictures, 9 minutes of processor time
        (cd docs/library && ../../gray -q -D each=true ../../data/library/show_materials.lua) || exit 1
        for picture in docs/library/materials/*.png; do reduce "$picture" 256; done
        continue
    fi
    case $name in
    shapes) scene=data/solids.lua ;;
    *) scene=data/library/show_$name.lua ;;
    esac
    size=480x270
    [ "$name" = shapes ] && size=720x480
    [ "$name" = sdf ] && size=720x405
    ./gray -q --size $size -ss 3 --spp 24 -o "docs/library/$name.png" "$scene" || exit 1
    reduce "docs/library/$name.png" 128
done
