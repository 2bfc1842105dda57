#!/bin/sh
# The cost of an animation besides tracing and writing its pictures: one node moves among 100,000 balls, 640 x 480, one
# sample a pixel, two threads. The script, the world and the communication between the processes are the rest. gray
# writes a frame while the script of the next one runs, so tracing and writing alone are measured in a run of one process
# (--no-fork), where they follow each other. The target is 1.15 for 300 frames.
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
python3 - "$gray" "$frames" <<'END'
import json, resource, subprocess, sys, time
gray, frames = sys.argv[1], int(sys.argv[2])
def processors():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime
def run(*options):
    begun, worked = time.time(), processors()
    done = subprocess.run([gray, '-j', '2', '-D', f'COUNT={frames}', 'scene.lua', '-full', '-ss', '1', '--stats=json',
                           '-o', 'x.####.png', *options], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr)
    stats = [json.loads(line) for line in done.stdout.splitlines() if line.startswith('{')]
    return stats, (time.time() - begun, processors() - worked)
def mean(stats, part, clock):
    return 1000 * sum(frame[part + clock] for frame in stats) / frames
alone, _ = run('--no-fork')
stats, whole = run()
for name, clock, seconds in (('clock', '_seconds', whole[0]), ('processors', '_processor_seconds', whole[1])):
    trace, write = (mean(alone, part, clock) for part in ('render', 'write'))
    parts = ', '.join(f'{part} {mean(stats, part, clock):.1f}' for part in ('build', 'render', 'write'))
    print(f'{name:<11} a frame: {1000 * seconds / frames:.1f} ms ({parts}); alone: trace {trace:.1f} ms, '
          f'write {write:.1f} ms; the frame over both: {1000 * seconds / frames / (trace + write):.3f}')
END
