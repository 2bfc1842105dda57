#!/bin/sh
# The error of denoised pictures against raw ones: relMSE, the mean of (x - r)^2 / (r^2 + .01), of 64 samples a pixel
# denoised and of 64, 256 and 512 raw, at SIZE (default 128x128), against a reference r of REFERENCE samples (default
# 8192). Arguments: scenes (default: both Cornell boxes and those of bench/denoise). GRAY: the program; THREADS: for it;
# SEEDS: pictures of 64 samples, for means (default 2); RAW_SEEDS: pictures of 512 (default 4: the contrast of one of
# them has an error of 2 % where the noise is strong); OUT: a folder that keeps the pictures, which are not rendered again.
#
# It also measures the contrast of edges, (a - b) / (a + b) for neighbours a and b in a channel. An edge of albedo: the
# albedo differs by more than .1 in a channel; of depth: by more than 10 %. It counts if the difference of a and b is
# at least a fifth of their mean in the reference. Printed: the mean contrast of the denoised picture, divided by
# that of 512 raw samples at the same edges: selecting edges in the reference favours its own noise. In brackets: divided
# by that of the 64 raw samples that were denoised, whose own noise in a + b reduces the contrast.
#
# The last line has the geometric mean of the error of 64 denoised samples divided by that of 512 raw ones. Exit status 1:
# this mean is above 1, in some scene 64 denoised samples have more error than 256 raw ones, or edges of albedo or depth
# keep less than 95 % of their contrast.
cd "$(dirname "$0")/.." || exit 1
gray=${GRAY:-./gray}
size=${SIZE:-128x128}
seeds=${SEEDS:-2}
raw_seeds=${RAW_SEEDS:-4}
[ $# -gt 0 ] || set -- data/path/cornell.lua bench/path/spheres.lua bench/denoise/*.lua
folder=${OUT:-$(mktemp -d)} || exit 1
[ -n "$OUT" ] || trap 'rm -rf "$folder"' EXIT
mkdir -p "$folder" || exit 1

# render SCENE KIND SPP SEED [options]
render() {
    scene=$1 picture=$folder/$(basename "$1" .lua).$2.pfm spp=$3 seed=$4
    shift 4
    [ -s "$picture" ] || "$gray" -q ${THREADS:+-j $THREADS} --integrator path --size "$size" --spp "$spp" --seed "$seed" "$@" \
        --allow-read textures -o "$picture" "$scene" || exit 1
}

for script in "$@"; do
    number=1
    while [ "$number" -le "$seeds" ]; do
        # The raw picture is a layer of the denoised one.
        render "$script" "den64-$number" 64 "$((10 + number))" --denoise --aov raw
        number=$((number + 1))
    done
    render "$script" raw256 256 2
    render "$script" raw512-1 512 3 --aov albedo,depth
    number=2
    while [ "$number" -le "$raw_seeds" ]; do
        render "$script" "raw512-$number" 512 "$((100 + number))"
        number=$((number + 1))
    done
    render "$script" reference "${REFERENCE:-8192}" 4
    basename "$script" .lua
done >"$folder/list" || exit 1
python3 - "$folder" "$seeds" "$raw_seeds" <<'PY'
import math
import struct
import sys


def pfm(name):
    with open(f'{folder}/{name}.pfm', 'rb') as file:
        channels = 3 if file.readline().strip() == b'PF' else 1
        width, height = map(int, file.readline().split())
        file.readline()
        values = struct.unpack('<%df' % (channels * width * height), file.read())
    return width, [values[i:i + channels] for i in range(0, len(values), channels)]


def error(picture, reference):
    return sum((a - b) ** 2 / (b * b + .01) for x, r in zip(picture, reference) for a, b in zip(x, r)) / \
        (3 * len(reference))


def edges(width, albedo, depth, reference):
    """Pairs of neighbours with an edge of albedo, and with one of depth: two pixels, a channel, a sign."""
    found = [], []
    for p in range(len(reference)):
        for q in (p + 1, p + width):
            if q >= len(reference) or q == p + 1 and q % width == 0:
                continue
            near = min(depth[p][0], depth[q][0])
            kinds = (max(abs(a - b) for a, b in zip(albedo[p], albedo[q])) > .1,
                     abs(depth[p][0] - depth[q][0]) > .1 * near)
            for c in range(3):
                a, b = reference[p][c], reference[q][c]
                if abs(a - b) < .2 * ((a + b) / 2 + .01):
                    continue
                for kind in (0, 1):
                    if kinds[kind]:
                        found[kind].append((p, q, c, 1 if a > b else -1))
    return found


def contrast(picture, pairs):
    total = 0
    for p, q, c, sign in pairs:
        a, b = max(picture[p][c], 0), max(picture[q][c], 0)
        total += sign * (a - b) / (a + b + .001)
    return total / max(len(pairs), 1)


def mean_contrast(pictures, pairs):
    return sum(contrast(picture, pairs) for picture in pictures) / len(pictures)


folder, seeds, raw_seeds = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
print('%-12s %9s %9s %9s %9s %6s %6s   edges kept, %%' % ('', 'raw 64', 'raw 256', 'raw 512', 'denoised', '/ 512', '/ 256'))
ratios, failed = [], False
for name in open(f'{folder}/list').read().split():
    width, reference = pfm(name + '.reference')
    raw256 = pfm(name + '.raw256')[1]
    raw512 = [pfm(f'{name}.raw512-{seed}')[1] for seed in range(1, raw_seeds + 1)]
    denoised = [pfm(f'{name}.den64-{seed}')[1] for seed in range(1, seeds + 1)]
    raw64 = [pfm(f'{name}.den64-{seed}.raw')[1] for seed in range(1, seeds + 1)]
    errors = [sum(error(x, reference) for x in pictures) / len(pictures)
              for pictures in (raw64, [raw256], raw512, denoised)]
    pairs = edges(width, pfm(name + '.raw512-1.albedo')[1], pfm(name + '.raw512-1.depth')[1], reference)
    kept = [100 * mean_contrast(denoised, kind) / (mean_contrast(raw512, kind) or 1) for kind in pairs]
    kept_of_64 = [100 * mean_contrast(denoised, kind) / (mean_contrast(raw64, kind) or 1) for kind in pairs]
    ratios.append(errors[3] / errors[2])
    failed = failed or errors[3] > errors[1] or min(kept) < 95
    print('%-12s %9.6f %9.6f %9.6f %9.6f %6.2f %6.2f   albedo %.1f (%.1f) at %d, depth %.1f (%.1f) at %d' %
          (name, *errors, ratios[-1], errors[3] / errors[1], kept[0], kept_of_64[0], len(pairs[0]),
           kept[1], kept_of_64[1], len(pairs[1])))
mean = math.exp(sum(map(math.log, ratios)) / len(ratios))
print('geometric mean: denoised 64 has %.2f of the error of raw 512' % mean)
sys.exit(failed or mean > 1)
PY
