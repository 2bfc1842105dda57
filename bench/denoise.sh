#!/bin/sh
# The error of denoised pictures against raw ones: relMSE, the mean of (x - r)^2 / (r^2 + .01), of 64 samples a pixel
# denoised and of 64, 256 and 512 raw, at SIZE (default 128x128), against a reference r of REFERENCE samples (default
# 8192). Arguments: scenes (default: the Cornell box and those of bench/denoise). GRAY: the program; THREADS: for it.
# The last line has the geometric mean of the error of 64 denoised samples divided by that of 512 raw ones. Exit status 1:
# this mean is above 1, or in some scene 64 denoised samples have more error than 256 raw ones.
cd "$(dirname "$0")/.." || exit 1
gray=${GRAY:-./gray}
size=${SIZE:-128x128}
[ $# -gt 0 ] || set -- data/path/cornell.lua bench/denoise/*.lua
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
for script in "$@"; do
    name=$folder/$(basename "$script" .lua)
    for picture in "raw64 64 1" "den64 64 1 --denoise" "raw256 256 2" "raw512 512 3" "reference ${REFERENCE:-8192} 4"; do
        # shellcheck disable=SC2086
        set_of() { kind=$1 spp=$2 seed=$3; shift 3; more=$*; }
        # shellcheck disable=SC2086
        set_of $picture
        # shellcheck disable=SC2086
        "$gray" -q ${THREADS:+-j $THREADS} --integrator path --size "$size" --spp "$spp" --seed "$seed" $more \
            --allow-read textures -o "$name.$kind.pfm" "$script" || exit 1
    done
    echo "$name"
done >"$folder/list"
python3 - "$folder/list" <<'PY'
import math
import os
import struct
import sys


def pfm(name):
    with open(name, 'rb') as file:
        file.readline()
        width, height = map(int, file.readline().split())
        file.readline()
        return struct.unpack('<%df' % (3 * width * height), file.read())


print('%-12s %9s %9s %9s %9s %9s' % ('scene', 'raw 64', 'raw 256', 'raw 512', 'denoised', '/ raw 512'))
ratios, failed = [], False
for name in open(sys.argv[1]).read().split():
    reference = pfm(name + '.reference.pfm')
    errors = []
    for kind in ('raw64', 'raw256', 'raw512', 'den64'):
        errors.append(sum((x - r) ** 2 / (r * r + .01) for x, r in zip(pfm(f'{name}.{kind}.pfm'), reference)) /
                      len(reference))
    ratios.append(errors[3] / errors[2])
    failed = failed or errors[3] > errors[1]
    print('%-12s %9.6f %9.6f %9.6f %9.6f %9.2f' % (os.path.basename(name), *errors, ratios[-1]))
mean = math.exp(sum(map(math.log, ratios)) / len(ratios))
print('geometric mean: denoised 64 has %.2f of the error of raw 512' % mean)
sys.exit(failed or mean > 1)
PY
