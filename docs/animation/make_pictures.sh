#!/bin/sh
# Draws the pictures of docs/animation.md: every second frame of the demos of data/animation, small, as GIF. Words on the
# command line choose some: docs/animation/make_pictures.sh walker waves
cd "$(dirname "$0")/../.." || exit 1
[ $# -gt 0 ] || set -- $(basename -s .lua data/animation/*.lua)
for name in "$@"; do
    size=160x120 step="1-36/2 --fps 12.5"
    case $name in
    bounce) step="1-30/2 --fps 12.5" ;;
    clockwork) step="1-48/2 --fps 15" ;;
    walker) size=128x128 step="1-32/2 --fps 12.5" ;;
    flight) size=160x90 step="1-80/2 --fps 10" ;;
    esac
    # shellcheck disable=SC2086
    ./gray -q --size $size -ss 2 --frames $step -o "docs/animation/$name.gif" "data/animation/$name.lua" || exit 1
done
