#!/bin/sh
# Makes the pictures of the window in docs/window: the program under a display without a screen (Xvfb), keys and mouse
# by xdotool, pictures by ImageMagick. Waits for signs in the window's title, not for times.
cd "$(dirname "$0")/.." || exit 1
gray=$PWD/build/release/gray
out=$PWD/docs/window
if [ "$1" != inside ]; then
    for tool in Xvfb xvfb-run xdotool import; do
        command -v $tool >/dev/null || { echo "$tool is missing" >&2; exit 1; }
    done
    mkdir -p "$out"
    exec xvfb-run -a -s "-screen 0 1000x760x24" sh "$0" inside
fi

work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cp -r data/12demo.lua data/stage.lua "$work" 2>/dev/null
cd "$work" || exit 1

titled() { # waits until the title holds the word
    for i in $(seq 400); do
        xdotool search --name "$1" >/dev/null 2>&1 && return 0
        sleep 0.05
    done
    echo "the title never said $1" >&2
    exit 1
}
take() {
    sleep 0.4
    import -window "$(xdotool search --onlyvisible --name . | head -1)" "$work/$1.png"
    convert "$work/$1.png" -strip +dither -colors 160 "$out/$1.png"
}

"$gray" -gui --watch -q --progress=none 12demo.lua >story.txt 2>said.txt &
pid=$!
titled '(building|%)'
titled '[2-9][0-9] %  '
take making
titled ready
take ready
xdotool mousemove 500 320 click 1
take picked
xdotool key p
take story
xdotool key Escape mousemove 541 301 click 1 sleep 0.5 key m
xdotool mousemove 520 340 mousedown 1 mousemove 540 340 sleep 0.1 mousemove 620 350 sleep 0.2 mouseup 1
sleep 0.5
titled ready
take moved
xdotool key Escape mousemove 600 560 click 1 sleep 0.5 mousemove 265 162 click 1 sleep 1
titled ready
take added
cp 12demo.lua keep.lua
sed '5i gr.shpere()' keep.lua >12demo.lua
titled shpere
take error
kill $pid
