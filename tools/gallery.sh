#!/bin/sh
# Renders the large pictures of data/gallery, each with the options in the line LARGE of its script, into
# data/gallery/NAME.png, and prints its processor time, its peak memory and the size of the file. A run
# that was interrupted goes on where it was. The samples stay in build/gallery: where only the denoiser has changed, a
# picture takes seconds. Remove them after a change of the samples.
#   tools/gallery.sh [NAME...]           (all, if no name is given)
#   tools/gallery.sh --loop [NAME...]    the loops, with the options in the line LOOP, into data/gallery/NAME.mp4 (ffmpeg)
cd "$(dirname "$0")/.." || exit 1
word=LARGE ending=png
[ "$1" = --loop ] && { word=LOOP ending=mp4; shift; }
[ $# -gt 0 ] || set -- $(grep -l "^-- $word: " data/gallery/*.lua | sed 's:.*/::; s:\.lua$::')
for name in "$@"; do
    script=data/gallery/$name.lua
    options=$(sed -n "s/^-- $word: //p" "$script") && [ -n "$options" ] ||
        { echo "tools/gallery.sh: there is no line $word in $script" >&2; exit 1; }
    output=data/gallery/$name.$ending
    if [ $word = LARGE ]; then
        mkdir -p build/gallery
        output=build/gallery/$name.png options="$options --checkpoint auto --shard 1/1"
    fi
    # shellcheck disable=SC2086
    ./gray $options "$script" -q --stats --resume -o "$output" 2>"data/gallery/$name.stats" >/dev/null || {
        cat "data/gallery/$name.stats" >&2
        exit 1
    }
    [ $word = LOOP ] || ./gray merge -q -o "data/gallery/$name.png" "$output.1-of-1.part" || exit 1
    # A loop has 2 MB at most.
    if [ $word = LOOP ] && [ "$(wc -c <"data/gallery/$name.mp4")" -gt 2000000 ]; then
        mv "data/gallery/$name.mp4" "data/gallery/$name.large.mp4"
        for quality in 20 22 24 26 28 30; do
            ffmpeg -nostdin -v error -y -i "data/gallery/$name.large.mp4" -c:v libx264 -crf $quality -preset veryslow \
                -pix_fmt yuv420p -movflags +faststart "data/gallery/$name.mp4" || exit 1
            [ "$(wc -c <"data/gallery/$name.mp4")" -gt 2000000 ] || break
        done
        rm -f "data/gallery/$name.large.mp4"
    fi
    echo "$name"
    awk '/processors: build/ { inside = 1 } inside && /build|render|write/ { seconds += $(NF - 1) } /threads/ { inside = 0 }
        /peak memory/ { memory = $(NF - 1) } END { printf("  %.0f s of processor time, %s MB\n", seconds, memory) }' "data/gallery/$name.stats"
    echo "  $(wc -c <"data/gallery/$name.$ending") bytes"
    rm -f "data/gallery/$name.stats"
done
