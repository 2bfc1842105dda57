#!/bin/sh
# Draws the pictures of docs/functions.md, with few colours so that they stay small (by ImageMagick, if it is there).
cd "$(dirname "$0")/../.." || exit 1
./gray -q docs/functions/steps.lua || exit 1
while read -r name size; do
    ./gray -q --size "$size" --spp 24 -o "docs/functions/$name.png" "data/functions/$name.lua" || exit 1
done <<END
planet 360x270
landscape 400x240
lamp 240x240
creature 300x200
fractals 360x225
julia 360x203
END
for picture in docs/functions/*.png; do
    command -v convert >/dev/null && convert "$picture" -dither FloydSteinberg -colors 128 -strip "PNG8:$picture"
done
