#!/bin/sh
# How fast the window is. For each scene (default: ten demos, path-traced ones among them), at SIZE (default 1280x720) on a
# virtual display (Xvfb): the first picture after the world was built; then, while xdotool orbits and while it walks:
# pictures a second and their resolution, processor time of all processes for each, the first picture after the movement
# began, all pixels after it ended, and the first picture of the integrator (denoised, if it traces paths).
# The program reports the times (--verbose).
cd "$(dirname "$0")/.." || exit 1
if [ "$1" != inside ]; then
    for tool in Xvfb xvfb-run xdotool; do
        command -v $tool >/dev/null || { echo "$tool is missing" >&2; exit 1; }
    done
    [ $# -gt 0 ] || set -- data/03demo.lua data/06demo.lua data/10demo.lua data/12demo.lua data/14demo.lua \
        data/functions/creature.lua data/functions/julia.lua data/path/cornell.lua data/path/dining.lua data/path/street.lua
    exec xvfb-run -a -s "-screen 0 1700x1000x24 -noreset" sh "$0" inside "$@"
fi
shift
gray=$PWD/build/release/gray
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
export GDK_DEBUG=gl-disable GSK_RENDERER=cairo GTK_A11Y=none HOME="$work"

said() { # waits until the program has said so many lines with the words
    for i in $(seq 1200); do
        [ "$(grep -c "$1" "$work/said")" -ge "$2" ] && return 0
        sleep 0.05
    done
    echo "never said: $1" >&2
    return 1
}
ticks() { # of the program and its processes, in hundredths of a second
    for process in $pid $(pgrep -P $pid) $(pgrep -P "$(pgrep -d, -P $pid)"); do
        cat "/proc/$process/stat"
    done 2>/dev/null | awk '{ sum += $14 + $15 } END { print sum + 0 }'
}
move() { # move WAY: 3 seconds of it; prints what the program says about its longest part
    before=$(ticks)
    : >"$work/said"
    case $1 in
    orbits)
        # One process: those of its own for each movement would take a part of the processors.
        xdotool mousemove 800 500 mousedown 2 $(seq 150 | awk '{ print "mousemove_relative --", ($1 % 100 < 50 ? 2 : -2), $1 % 2, "sleep 0.02" }') \
            mouseup 2 ;;
    walks) xdotool key grave keydown w sleep 3 keyup w key Escape ;;
    esac
    after=$(ticks)
    said 'the integrator after' 1 || return
    sed -n 's/.*: \([0-9]*\) pictures in \([0-9.]*\) s, at 1.\([0-9]*\), the first after \([0-9]*\) ms, all pixels \([0-9]*\) ms.*/\1 \2 \3 \4 \5/p' "$work/said" |
        sort -n | awk -v way="$1" -v used=$((after - before)) \
            -v last="$(sed -n 's/.*integrator after \([0-9]*\) ms.*/\1/p' "$work/said" | tail -1)" '
            { count = $1; seconds = $2; divide = $3; first = $4; all = $5; sum += $1 }
            END { printf("    %-6s %5.1f pictures/s at 1/%d, %4.0f ms of processor each; first %4d ms, all pixels %5d ms, integrator %6d ms\n",
                way, seconds > 0 ? count / seconds : 0, divide, sum > 0 ? 10 * used / sum : 0, first, all, last) }'
}
for scene in "$@"; do
    [ -r "$scene" ] || { echo "cannot read $scene" >&2; exit 1; }
    : >"$work/said"
    "$gray" -gui -q --verbose --progress=none --size "${SIZE:-1280x720}" --allow-read . "$scene" -o "$work/out.png" \
        >"$work/out" 2>>"$work/said" &
    pid=$!
    said 'on the screen' 1 || { kill $pid; continue; }
    echo "$scene: first picture $(sed -n 's/.*on the screen \([0-9.]*\) ms.*/\1/p' "$work/said" | head -1) ms after building"
    sleep 1
    move orbits
    move walks
    kill $pid
    wait $pid
done
