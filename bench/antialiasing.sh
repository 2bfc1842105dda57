#!/bin/sh
# Anti-aliasing of Whitted's integrator: renders scenes with --aa-pattern grid and rotated, compares each with a reference
# of 16 x 16 samples for every pixel, and measures processor time. Prints for each scene the mean error in levels, the
# fraction of pixels with an error above 8 levels in some channel, and seconds (the minimum of RUNS, one thread,
# interleaved); the last line has the geometric means and their ratios. Exit status 1: an error decreases by less than
# a fifth, or the time grows by more than a quarter.
# Arguments: scripts; GRAY: the program (gray); BASE: an older program that has only the grid (GRAY); SIZE: of the
# pictures (320x240); RUNS: repetitions (3); REFERENCES: a folder where references are kept (build/antialiasing-SIZE).
cd "$(dirname "$0")/.." || exit 1
here=$(pwd)
absolute() { case $1 in /*) echo "$1" ;; *) echo "$here/$1" ;; esac; }
gray=$(absolute "${GRAY:-gray}")
base=$(absolute "${BASE:-$gray}")
grid='--aa-pattern grid'
[ -z "${BASE:-}" ] || grid=
size=${SIZE:-320x240}
references=$(absolute "${REFERENCES:-build/antialiasing-$size}")
[ $# -gt 0 ] || set -- data/01demo.lua data/02demo.lua data/05demo.lua data/06demo.lua data/08demo.lua data/09demo.lua \
    data/13demo.lua data/classic/stairs.lua data/csg/machine.lua data/light.lua
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
mkdir -p "$references" || exit 1
for script in "$@"; do
    name=$(basename "$script" .lua)
    if [ ! -f "$references/$name.png" ]; then
        # shellcheck disable=SC2086
        "$base" -q --size "$size" -full -ss 16 $grid -o "$work/reference.png" "$script" >"$work/out" 2>&1 &&
            mv "$work/reference.png" "$references/$name.png" || { cat "$work/out" >&2; exit 1; }
    fi
    for _ in $(seq "${RUNS:-3}"); do
        for pattern in grid rotated; do
            program=$gray
            options='--aa-pattern rotated'
            [ $pattern = rotated ] || { program=$base; options=$grid; }
            # shellcheck disable=SC2086
            python3 - "$work/$name.$pattern.seconds" "$program" -q -j 1 --size "$size" $options \
                -o "$work/$name.$pattern.png" "$script" <<'EOF' || exit 1
import os, subprocess, sys
subprocess.run(sys.argv[2:], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
times = os.times()
with open(sys.argv[1], "a") as file:
    file.write("%.3f\n" % (times.children_user + times.children_system))
EOF
        done
    done
    echo "$name"
done >"$work/names" || exit 1
python3 - "$work" "$references" "$gray" <<'EOF'
import math, re, subprocess, sys

work, references, gray = sys.argv[1:]
names = open(work + "/names").read().split()
patterns = ["grid", "rotated"]
logs = {pattern: [0.0, 0.0, 0.0] for pattern in patterns}
print("%-10s %8s %8s  %8s %8s  %7s %7s" % ("scene", "error", "rotated", "off %", "rotated", "seconds", "rotated"))
for name in names:
    row = []
    for pattern in patterns:
        pictures = ["%s/%s.%s.png" % (work, name, pattern), "%s/%s.png" % (references, name)]
        said = subprocess.run([gray, "compare", "--threshold", "8"] + pictures, capture_output=True, text=True).stdout
        error, off = map(float, re.search(r"mean difference +(\S+)\npixels beyond 8 +(\S+) %", said).groups())
        seconds = min(map(float, open("%s/%s.%s.seconds" % (work, name, pattern))))
        row.append((error, off, seconds))
        for i, x in enumerate(row[-1]):
            logs[pattern][i] += math.log(max(x, 1e-9)) / len(names)
    print("%-10s %8.4f %8.4f  %8.3f %8.3f  %7.2f %7.2f" % ((name,) + tuple(x for pair in zip(*row) for x in pair)))
means = [[math.exp(x) for x in logs[pattern]] for pattern in patterns]
ratios = [new / old for old, new in zip(*means)]
print("%-10s %8.4f %8.4f  %8.3f %8.3f  %7.2f %7.2f" % (("means",) + tuple(x for pair in zip(*means) for x in pair)))
print("ratios: error %.3f, pixels off %.3f, seconds %.3f" % tuple(ratios))
sys.exit(ratios[0] > 0.8 or ratios[1] > 0.8 or ratios[2] > 1.25)
EOF
