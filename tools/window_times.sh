#!/bin/sh
# How fast the window is: for each demo (words like 05; else a list of them) when the first correct pixels are on the
# screen after the build of the world, how long a stop takes (ten times, at moments spread over half a second), and
# closing the window. On a virtual display (Xvfb), keys by xdotool; the program itself reports the times (--verbose).
cd "$(dirname "$0")/.." || exit 1
if [ "$1" != inside ]; then
    for tool in Xvfb xvfb-run xdotool; do
        command -v $tool >/dev/null || { echo "$tool is missing" >&2; exit 1; }
    done
    [ $# -gt 0 ] || set -- 03 05 06 10 12 14
    exec xvfb-run -a -s "-screen 0 1000x760x24" sh "$0" inside "$@"
fi
shift
gray=$PWD/build/release/gray
export GDK_DEBUG=gl-disable GSK_RENDERER=cairo GTK_A11Y=none
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
said() { # waits until the file has this many lines with the word
    for i in $(seq 400); do
        [ "$(grep -c "$1" "$work/said")" -ge "$2" ] && return 0
        sleep 0.05
    done
    echo "never said: $1" >&2
    return 1
}
printf 'demo  on the screen   stops (least, median, most)   closed\n'
for demo in "$@"; do
    "$gray" -gui -q --verbose --progress=none -full -ss 16 "data/${demo}demo.lua" -o "$work/out.png" >"$work/out" 2>"$work/said" &
    pid=$!
    said 'on the screen' 1 || { kill $pid; continue; }
    for i in 1 2 3 4 5 6 7 8 9 10; do
        xdotool key F12
        sleep "0.$((5 + 5 * i))"
        xdotool key ctrl+period
        said 'stopped in' "$i" || break
    done
    xdotool key F12 sleep 0.3 key ctrl+q
    wait $pid
    first=$(sed -n 's/.*on the screen \([0-9.]*\) ms.*/\1/p' "$work/said" | head -1)
    stops=$(sed -n 's/.*stopped in \([0-9.]*\) ms.*/\1/p' "$work/said" | sort -n)
    closed=$(sed -n 's/.*closed in \([0-9.]*\) ms.*/\1/p' "$work/said")
    printf '%s    %8s ms       %s ms   %s ms\n' "$demo" "$first" \
        "$(echo "$stops" | awk '{a[NR] = $1} END {print a[1], a[int((NR + 1) / 2)], a[NR]}')" "$closed"
done
