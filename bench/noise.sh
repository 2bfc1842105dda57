#!/bin/sh
# The claim of --noise X: renders scenes with it, and compares each whole tile with a picture of many samples. The error
# of a tile is the square root of the mean of (a - b)^2 / (b^2 + 0.01) over its pixels and channels.
# Prints a line for each scene (tiles, the median and the largest error over X), and how many tiles are within 1.25 X;
# exit status 1: less than 99 %.
# Arguments: scripts; GRAY: the program (gray); NOISE: X (0.1); SIZE: of the pictures (64x32); SPP: of the references
# (2048); SEEDS: pictures of a scene (3); WORK: a folder where all pictures are kept (a temporary one).
cd "$(dirname "$0")/.." || exit 1
gray=${GRAY:-gray}
noise=${NOISE:-0.1}
work=${WORK:-$(mktemp -d)}
[ -n "${WORK:-}" ] || trap 'rm -rf "$work"' EXIT
[ $# -gt 0 ] || set -- data/0[1245678]demo.lua data/09demo.lua data/12demo.lua data/13demo.lua data/classic/chess.lua \
    data/classic/cows.lua data/classic/dodeca.lua data/classic/henge.lua data/classic/hier.lua data/classic/puppet.lua \
    data/classic/snowman.lua data/classic/solar.lua data/classic/stairs.lua data/csg/bottle.lua data/csg/chess.lua \
    data/functions/creature.lua data/functions/planet.lua data/light.lua data/meshes.lua data/path/cornell.lua \
    data/path/plates.lua data/path/table.lua data/solids.lua data/swept.lua
mkdir -p "$work" || exit 1
for script in "$@"; do
    name=$(echo "${script%.lua}" | tr / -)
    for seed in reference $(seq "${SEEDS:-3}"); do
        quality="--seed $seed --noise $noise"
        [ "$seed" != reference ] || quality="--seed 99 --spp ${SPP:-2048}"
        # shellcheck disable=SC2086
        [ -f "$work/$name.$seed.pfm" ] || "$gray" -q --integrator path --size "${SIZE:-64x32}" $quality \
            -o "$work/$name.$seed.pfm" "$script" >"$work/out" 2>&1 || { cat "$work/out" >&2; exit 1; }
    done
    echo "$name"
done >"$work/names" || exit 1
python3 - "$work" "$noise" "${SEEDS:-3}" <<'EOS'
import math, struct, sys

work, noise, seeds = sys.argv[1], float(sys.argv[2]), int(sys.argv[3])


def read(name):
    lines = open("%s/%s.pfm" % (work, name), "rb").read().split(b"\n", 3)
    width, height = map(int, lines[1].split())
    return width, height, struct.unpack("<%df" % (3 * width * height), lines[3])


errors = []
for name in open(work + "/names").read().split():
    width, height, b = read(name + ".reference")
    own = []
    for seed in range(1, seeds + 1):
        a = read("%s.%d" % (name, seed))[2]
        for top in range(height - 32, -1, -32):  # tiles begin at the top, rows at the bottom
            for left in range(0, width - 31, 32):
                at = [3 * (y * width + left) + i for y in range(top, top + 32) for i in range(96)]
                own.append(math.sqrt(sum((a[i] - b[i]) ** 2 / (b[i] ** 2 + 0.01) for i in at) / len(at)) / noise)
    own.sort()
    errors += own
    print("%-28s %3d tiles, median %.2f, largest %.2f" % (name, len(own), own[len(own) // 2], own[-1]), flush=True)
within = sum(error <= 1.25 for error in errors) / len(errors)
print("%d tiles: %.1f %% within 1.25 X, largest %.2f X" % (len(errors), 100 * within, max(errors)))
sys.exit(within < 0.99)
EOS
