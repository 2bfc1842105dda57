#!/bin/sh
# The effect of the cut-off by contribution: renders every demo and classic scene with CUTOFF (default: the program's)
# and with `--cutoff 0`, and prints the largest change of an 8-bit value and the number of changed values. Arguments: scripts
# (default: all of data/); GRAY: the program; SIZE: of the pictures (default 160x120); LEVELS: the largest allowed
# change (default 1). Needs ImageMagick. Exit status 1: a scene changes by more. Without ImageMagick it prints a message
# and measures nothing.
cd "$(dirname "$0")/.." || exit 1
here=$(pwd)
gray=${GRAY:-$here/gray}
case $gray in /*) ;; *) gray=$here/$gray ;; esac
size=${SIZE:-160x120}
[ $# -gt 0 ] || set -- data/*.lua data/classic/*.lua
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
convert -version 2>/dev/null | grep -q ImageMagick ||
    { echo 'bench/cutoff.sh: ImageMagick (convert) is missing: left out' >&2; exit 0; }
failed=0
printf '%-26s %7s %9s %9s %9s\n' scene levels values 'rays M' 'all M'
for script in "$@"; do
    case $script in /*) path=$script ;; *) path=$here/$script ;; esac
    rm -rf "$folder/cut" "$folder/all"
    mkdir "$folder/cut" "$folder/all"
    for kind in cut all; do
        cutoff=${CUTOFF:+--cutoff $CUTOFF}
        [ $kind = cut ] || cutoff='--cutoff 0'
        # shellcheck disable=SC2086
        (cd "$folder/$kind" && timeout 300 "$gray" -q --stats=json --size "$size" $cutoff "$path") >"$folder/$kind.out" 2>&1
    done
    levels=0 values=0
    pictures=0
    for picture in "$folder"/all/*.png; do
        [ -f "$picture" ] || continue
        pictures=$((pictures + 1))
        name=$(basename "$picture")
        # Level and count of all values that differ, from the histogram of differences.
        found=$(convert "$picture" "$folder/cut/$name" -depth 8 -compose difference -composite -alpha off -depth 8 rgb:- |
            od -An -v -tu1 -w3 | awk '{ for (i = 1; i <= NF; i++) if ($i > 0) { n++; if ($i > most) most = $i } } END { print most + 0, n + 0 }')
        most=${found% *}
        [ "$most" -le "$levels" ] || levels=$most
        values=$((values + ${found#* }))
    done
    [ $pictures -gt 0 ] || continue # a module
    rays() {
        grep '^{' "$folder/$1.out" | awk '{
            n = split("camera_rays reflected_rays refracted_rays shadow_rays", keys, " ")
            for (i = 1; i <= n; i++) { at = index($0, "\"" keys[i] "\":"); if (at) sum += substr($0, at + length(keys[i]) + 3) + 0 }
        } END { printf "%.3f", sum / 1e6 }'
    }
    printf '%-26s %7d %9d %9s %9s\n' "$(basename "$script" .lua)" "$levels" "$values" "$(rays cut)" "$(rays all)"
    [ "$levels" -le "${LEVELS:-1}" ] || failed=1
done
exit $failed
