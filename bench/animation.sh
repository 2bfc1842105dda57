#!/bin/sh
# The cost of an animation besides tracing and writing its pictures: one node moves among 100,000 balls, 640 x 480, one
# sample a pixel, two threads. --stats measures tracing and writing for each frame; the rest is the script, the
# world, and the communication between the processes. The target is 1.15 for 300 frames.
# usage: bench/animation.sh [frames]      GRAY=build/release/gray
set -e
cd "$(dirname "$0")/.."
gray=$PWD/${GRAY:-build/release/gray} frames=${1:-300}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT INT TERM
cat >"$folder/scene.lua" <<'END'
local materials, root = {}, gr.node('root')
for i = 1, 8 do materials[i] = gr.material({0.1 + 0.1 * i, 1 - 0.1 * i, 0.5}, {0, 0, 0}, 1) end
math.randomseed(1)
for i = 1, 100000 do
    local ball = gr.sphere{material = materials[i % 8 + 1], radius = 0.03}
    root:add_child(ball:translate(math.random() * 10 - 5, math.random() * 6 - 3, math.random() * 10 - 5))
end
local mover = gr.sphere{material = materials[1], radius = 0.8}
root:add_child(mover)
gr.frames{count = COUNT, loop = true, draw = function(t)
    mover:reset():translate(2 * math.cos(2 * math.pi * t), 0, 2 * math.sin(2 * math.pi * t))
    return {node = root, width = 640, height = 480, eye = {0, 1, 12}, view = {0, 0, -1}, fov = 45,
            lights = {gr.light({4, 5, 16}, {1, 1, 1}, {1, 0, 0})}}
end}
END
cd "$folder"
begun=$(date +%s.%N)
"$gray" -j 2 -D COUNT="$frames" scene.lua -full -ss 1 --stats=json -o 'x.####.png' >stats 2>errors || { cat errors; exit 1; }
ended=$(date +%s.%N)
python3 - "$begun" "$ended" <<'END'
import json, sys
frames = [json.loads(line) for line in open('stats') if line.startswith('{')]
begun, ended = map(float, sys.argv[1:])
def total(part, clock):
    return sum(frame[part + clock] for frame in frames)
for name, clock in (('clock', '_seconds'), ('processors', '_processor_seconds')):
    build, render, write = (total(part, clock) for part in ('build', 'render', 'write'))
    n = len(frames)
    print(f'{name:<11} a frame: build {1000 * build / n:.1f} ms, trace {1000 * render / n:.1f} ms, '
          f'write {1000 * write / n:.1f} ms; all of it over tracing and writing: '
          f'{(ended - begun if name == "clock" else build + render + write) / (render + write):.3f}')
END
