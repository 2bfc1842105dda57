#!/bin/sh
# Renders the large pictures of data/gallery, each with the options in the line LARGE of its script, into
# data/gallery/NAME.png, and prints its processor time, its peak memory and the size of the file. A run
# that was interrupted goes on where it was.
# Usage: tools/gallery.sh [NAME...]      (all, if no name is given)
cd "$(dirname "$0")/.." || exit 1
[ $# -gt 0 ] || set -- $(ls data/gallery/*.lua | sed 's:.*/::; s:\.lua$::')
for name in "$@"; do
    script=data/gallery/$name.lua
    [ -r "$script" ] || { echo "tools/gallery.sh: there is no $script" >&2; exit 1; }
    options=$(sed -n 's/^-- LARGE: //p' "$script")
    # shellcheck disable=SC2086
    ./gray $options "$script" -q --stats --checkpoint auto --resume -o "data/gallery/$name.png" 2>"data/gallery/$name.stats" >/dev/null || {
        cat "data/gallery/$name.stats" >&2
        exit 1
    }
    echo "$name"
    awk '/processors: build/ { inside = 1 } inside && /build|render|write/ { seconds += $(NF - 1) } /threads/ { inside = 0 }
        /peak memory/ { memory = $(NF - 1) } END { printf("  %.0f s of processor time, %s MB\n", seconds, memory) }' "data/gallery/$name.stats"
    echo "  $(wc -c <"data/gallery/$name.png") bytes"
    rm -f "data/gallery/$name.stats"
done
