#!/bin/sh
# The cost of caustics. For each scene, in seconds of one thread: tracing a million photons and building their map (best
# of RUNS, default 3), the picture without photons, and the time that gathering adds. A scene takes the number of
# photons from the global PHOTONS; 0 is none. Arguments: scripts (default: bench/photons.lua, data/07demo.lua); GRAY:
# the program; PHOTONS: traced (default 1000000); SIZE: of the pictures (default 320x240); OPTIONS: more options.
cd "$(dirname "$0")/.." || exit 1
gray=${GRAY:-./gray}
size=${SIZE:-320x240}
photons=${PHOTONS:-1000000}
[ $# -gt 0 ] || set -- bench/photons.lua data/07demo.lua
picture=$(mktemp) || exit 1
trap 'rm -f "$picture"' EXIT
# The minimum render, photon and map seconds of several runs: script, photons.
measure() {
    i=0
    while [ $i -lt "${RUNS:-3}" ]; do
        i=$((i + 1))
        # shellcheck disable=SC2086
        "$gray" -q -j1 --stats=json --size "$size" $OPTIONS -D "PHOTONS=$2" -o "$picture.png" "$1" | grep '^{' | tail -n 1
    done | awk '
        function figure(key,   at) {
            at = index($0, "\"" key "\":")
            return at ? substr($0, at + length(key) + 3) + 0 : 0
        }
        { render = figure("render_seconds"); all = figure("photon_seconds"); map = figure("photon_map_seconds"); n++
          picture = render - all; trace = all - map
          if (n == 1 || picture < p) p = picture
          if (n == 1 || trace < t) t = trace
          if (n == 1 || map < m) m = map }
        END { printf "%.2f %.2f %.2f", t, m, p }'
    rm -f "$picture.png"
}
printf '%-12s %10s %8s %10s %12s %8s\n' scene 'tracing s' 'map s' 'picture s' 'gathering s' times
for script in "$@"; do
    with=$(measure "$script" "$photons")
    without=$(measure "$script" 0)
    echo "$with $without" | awk -v name="$(basename "$script" .lua)" '
        { printf "%-12s %10.2f %8.2f %10.2f %12.2f %8.2f\n", name, $1, $2, $6, $3 - $6, ($6 > 0 ? $3 / $6 : 0) }'
done
