#!/bin/sh
# How fast frames of 640 x 480 become one file: processor time of `gray merge` for a frame, reading its PNG file included,
# and frames per second on one core. The target is 30 for .apng and .gif. Frames: those of data/animation/clockwork.lua.
# usage: bench/assemble.sh [frames]      GRAY=build/release/gray
set -e
cd "$(dirname "$0")/.."
gray=$PWD/${GRAY:-build/release/gray} frames=${1:-24} scene=$PWD/data/animation/clockwork.lua
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT INT TERM
cd "$folder"
"$gray" -q --size 640x480 -ss 2 --frames "1-$frames" -o 'x.####.png' "$scene"
python3 - "$gray" "$frames" <<'END'
import glob, os, resource, subprocess, sys
gray, frames = sys.argv[1], int(sys.argv[2])
files = sorted(glob.glob('x.*.png'))
def processor_time():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime
for name in 'x.apng', 'x.gif --palette all', 'x.gif --palette frame', 'x.webp', 'x.y4m':
    best = float('inf')
    for _ in range(3):
        begun = processor_time()
        if subprocess.run([gray, 'merge', '-q', '-o'] + name.split() + files, stderr=subprocess.DEVNULL).returncode != 0:
            break
        best = min(best, processor_time() - begun)
    size = os.path.getsize(name.split()[0]) if best < float('inf') else 0
    print(f'{name:22} {1000 * best / frames:6.1f} ms a frame, {frames / best:6.1f} frames a second, {size / frames / 1024:6.1f} KiB a frame')
END
