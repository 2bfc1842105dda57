#!/bin/sh
# Renders the large pictures of data/gallery, each with the options in the line LARGE of its script, into
# data/gallery/NAME.png, and prints its processor time (user and system), its peak memory and the size of the file. A run
# that was interrupted goes on where it was.
# Usage: tools/gallery.sh [NAME...]      (all, if no name is given)
cd "$(dirname "$0")/.." || exit 1
[ $# -gt 0 ] || set -- $(ls data/gallery/*.lua | sed 's:.*/::; s:\.lua$::')
for name in "$@"; do
    script=data/gallery/$name.lua
    [ -r "$script" ] || { echo "tools/gallery.sh: there is no $script" >&2; exit 1; }
    options=$(sed -n 's/^-- LARGE: //p' "$script")
    (
        # shellcheck disable=SC2086
        ./gray $options "$script" -q --stats --checkpoint auto --resume -o "data/gallery/$name.png" >"data/gallery/$name.stats" || exit 1
        times | tail -n 1 | sed "s/^/$name: /"
    ) || exit 1
    sed -n 's/.*peak memory/  memory/p' "data/gallery/$name.stats"
    echo "  $(wc -c <"data/gallery/$name.png") bytes"
    rm -f "data/gallery/$name.stats"
done
