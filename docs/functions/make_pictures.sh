#!/bin/sh
# Draws the pictures of docs/functions.md, with few colours so that they stay small (by ImageMagick, if it is there).
cd "$(dirname "$0")/../.." || exit 1
./gray -q docs/functions/steps.lua || exit 1
for name in planet landscape lamp creature; do
    ./gray -q -o "docs/functions/$name.png" "data/functions/$name.lua" || exit 1
done
for picture in docs/functions/*.png; do
    command -v convert >/dev/null && convert "$picture" -dither FloydSteinberg -colors 128 -strip "PNG8:$picture"
done
