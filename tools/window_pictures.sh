#!/bin/sh
# Makes the pictures of the window in docs/window or the given folder: the program on a virtual
# display (Xvfb), keys and mouse by xdotool, pictures by ImageMagick. Waits for changes of the window's title, not for
# times.
cd "$(dirname "$0")/.." || exit 1
gray=$PWD/build/release/gray demos=$PWD/data
[ "$1" = inside ] && out=$2 || out=${1:-$PWD/docs/window}
export SDL_RENDER_DRIVER=software SDL_FRAMEBUFFER_ACCELERATION=0
if [ "$1" != inside ]; then
    for tool in Xvfb xvfb-run xdotool import; do
        command -v $tool >/dev/null || { echo "$tool is missing" >&2; exit 1; }
    done
    mkdir -p "$out"
    exec xvfb-run -a -s "-screen 0 1000x760x24" sh "$0" inside "$(cd "$out" && pwd)"
fi

work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cp -r data/12demo.lua data/stage.lua "$work" 2>/dev/null
cd "$work" || exit 1

titled() { # waits until the title holds the word
    for i in $(seq 2400); do
        xdotool search --name "$1" >/dev/null 2>&1 && return 0
        sleep 0.05
    done
    echo "the title never said $1" >&2
    exit 1
}
take() {
    sleep "${2:-0.4}"
    import -window "$(xdotool search --onlyvisible --name . | head -1)" "$work/$1.png"
    convert "$work/$1.png" -strip +dither -colors 160 "$out/$1.png"
}

"$gray" -gui --watch -q --progress=none 12demo.lua >story.txt 2>said.txt &
pid=$!
titled '(building|%)'
titled '[2-9][0-9] %[^(]*frames'
take making 0
titled ready
take ready
xdotool mousemove 500 320 click 1
take picked
xdotool key b sleep 0.5
titled ready
take boxes
xdotool key g sleep 0.5
titled ready
take grid
xdotool key g key r sleep 0.4 key x
titled stopped
take stopped
xdotool key x sleep 0.3
titled ready
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
wait $pid 2>/dev/null

cat >still.lua <<'END'
local function phong(kd, s, n) return gr.material(kd, {s, s, s}, n) end
local clay, blue, wood = phong({0.75, 0.45, 0.3}, 0.15, 20), phong({0.15, 0.3, 0.7}, 0.5, 80), phong({0.55, 0.5, 0.45}, 0.05, 5)
local glass = gr.rr_material({0.02, 0.02, 0.02}, {0.9, 0.95, 0.92}, 200, 0.1, 0.85, 1.5)
local function ball(name, m, x, y, z, r) return gr.geometry(name, gr.sphere(m)):scale(r, r, r):translate(x, y, z) end
local still = gr.node('still life')
still:add_child(gr.geometry('table', gr.cube(wood)):scale(14, 1, 9):translate(-7, -1, -6))
local stump = gr.geometry('stump', gr.cylinder {material = clay, from = {0, 0, 0}, to = {0, 1.5, 0}, radius = 2})
local foot = gr.csg_intersection('foot', ball('body', clay, 0, 1.05, 0, 1.25), stump)
still:add_child(gr.csg_difference('bowl', foot, ball('hollow', blue, 0, 1.35, 0.1, 1.05)):translate(-1.3, 0, 0.2))
still:add_child(ball('marble', glass, 1.3, 0.6, 1.2, 0.6))
still:add_child(ball('apple', phong({0.7, 0.12, 0.1}, 0.4, 40), 0.9, 0.8, -1.2, 0.8))
local faces = gr.geometry('faces', gr.cube(phong({0.85, 0.82, 0.75}, 0.3, 30))):translate(-0.5, -0.5, -0.5)
still:add_child(gr.csg_intersection('die', faces, ball('edges', clay, 0, 0, 0, 0.72)):rotate('y', 25):translate(3, 0.5, 0.4))
gr.render {node = still, file = 'still.png', width = 800, height = 600, eye = {0.3, 4.4, 10.6}, target = {0.2, 1.55, 0}, fov = 36,
    ambient = {0.05, 0.05, 0.06}, background = {0.16, 0.19, 0.26},
    lights = {
        gr.spot_light {position = {-1.2, 3.6, 1.6}, target = {-1, 0.4, 0}, colour = {0.7, 0.6, 0.45}, inner = 18, outer = 24},
        gr.area_light({1.5, 3.2, -2.5}, {1.6, 0, 0}, {0, 0.6, 1}, {0.35, 0.35, 0.4}, {1, 0, 0}),
        gr.sun_light {sun = {1, 0.9, 0.4}, colour = {0.2, 0.18, 0.14}},
        gr.sky_light {sky = {0.16, 0.19, 0.26}},
    }}
END
"$gray" -gui -q --progress=none still.lua 2>>said.txt &
pid=$!
titled 'still.*ready'
xdotool key i key period key t mousemove 500 600 mousedown 1 mousemove 505 600 sleep 0.1 mousemove 530 590 sleep 0.2 mouseup 1
sleep 0.5
titled ready
take lights
xdotool key i key Escape mousemove 375 388 keydown ctrl click 1 sleep 0.5 keyup ctrl sleep 0.5 key m
xdotool mousemove 400 600 mousedown 1 mousemove 405 590 sleep 0.1 mousemove 430 575 sleep 0.2 mouseup 1
sleep 0.5
titled ready
take operand
xdotool key q
wait $pid

"$gray" -gui -q --progress=none --size 640x480 "$demos/animation/waves.lua" 2>>said.txt &
pid=$!
titled playing
xdotool key k sleep 0.2 mousemove 400 612 click 1 sleep 1
titled 'ready.*frame 13'
take playing
xdotool key q
wait $pid
