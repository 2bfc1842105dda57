#!/bin/sh
# Makes the pictures of the window in docs/window or the given folder: the program on a virtual display (Xvfb) with a
# window manager, keys and mouse by xdotool, pictures by ImageMagick. Waits for changes of the title, not for times.
cd "$(dirname "$0")/.." || exit 1
gray=$PWD/build/release/gray demos=$PWD/data
[ "$1" = inside ] && out=$2 || out=${1:-$PWD/docs/window}
if [ "$1" != inside ]; then
    for tool in Xvfb xvfb-run xdotool openbox import; do
        command -v $tool >/dev/null || { echo "$tool is missing" >&2; exit 1; }
    done
    mkdir -p "$out"
    exec xvfb-run -a -s "-screen 0 2600x1700x24 -noreset" sh "$0" inside "$(cd "$out" && pwd)"
fi

work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
export HOME="$work" XDG_DATA_HOME="$work" XDG_CONFIG_HOME="$work" XDG_CACHE_HOME="$work" XDG_RUNTIME_DIR="$work"
export GDK_DEBUG=gl-disable GSK_RENDERER=cairo
cp -r data/12demo.lua data/stage.lua "$work" 2>/dev/null
cd "$work" || exit 1
openbox >/dev/null 2>&1 &
manager=$!

titled() { # waits until the title holds the words, and still does a moment later
    for i in $(seq 2400); do
        xdotool search --name "$1" >/dev/null 2>&1 && sleep 0.2 && xdotool search --name "$1" >/dev/null 2>&1 && return 0
        sleep 0.05
    done
    echo "the title never said $1" >&2
    exit 1
}
take() { # take NAME: the screen where the window is, once something is drawn; twice as many pixels become half of them
    case $1 in *scale2) size=50% ;; *) size=100% ;; esac
    for i in $(seq 100); do
        sleep 0.6
        import -window root "$work/$1.png"
        [ "$(identify -format %k "$work/$1.png")" -gt 1 ] && break
    done
    convert "$work/$1.png" -trim +repage -resize $size -strip +dither -colors 200 "$out/$1.png"
}
open() { # open TITLE OPTIONS...: the window in the upper left corner
    title=$1
    shift
    "$gray" -gui -q --progress=none "$@" >/dev/null 2>said.txt &
    pid=$!
    titled "$title"
    xdotool search --onlyvisible --name "$title" windowmove 0 0 sleep 0.5
}
leave() {
    kill $pid
    wait $pid 2>/dev/null
}

open gray
take start
leave
open 'png - ready' 12demo.lua
take ready
xdotool mousemove 560 420 click 1 sleep 1
titled 'png - ready'
take picked
xdotool key p sleep 1
take story
xdotool key Escape sleep 0.3 key F1 sleep 1
take keys
xdotool key Escape sleep 0.3
cp 12demo.lua keep.lua
sed '5i gr.shpere()' keep.lua >12demo.lua
sleep 2
take error
cp keep.lua 12demo.lua
leave
selected() { # selected NAME [X Y]: a click selects a ball; the demo, in a theme and at a scale of the environment
    open 'png - ready' 12demo.lua
    xdotool mousemove "${2:-560}" "${3:-420}" click 1 sleep 1
    titled 'png - ready$'
    take "$1"
    leave
}
scales() { # scales PREFIX: twice as many pixels, and letters of one and a half times the size
    export GDK_SCALE=2
    selected "${1}scale2" 1120 840
    unset GDK_SCALE
    if command -v xprop >/dev/null; then
        xprop -root -format RESOURCE_MANAGER 8s -set RESOURCE_MANAGER 'Xft.dpi: 144'
        selected "${1}letters"
        xprop -root -remove RESOURCE_MANAGER
    fi
}
scales ""
export GTK_THEME=Adwaita:dark
selected dark
scales dark-
unset GTK_THEME
open ' - playing' --size 640x480 "$demos/animation/waves.lua"
xdotool key space sleep 1
titled 'png - ready'
take playing
leave
kill $manager
