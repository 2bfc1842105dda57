#!/bin/sh
# The accuracy of the time left: renders every demo with --progress=json on one thread. For each picture, the worst
# error in percent after a third of its time, in the program's processor time, which other programs do not change:
#   whole   of the predicted total time (elapsed and left);
#   left    of the time left, relative to itself, until LEAST of the total (default 0.05) is left;
#   to end  the same until the last line that is printed;
#   clock   like left, by wall-clock time and the number on the screen.
# The last 5 % are left out because they are a few dozen tiles, or 3 s of a minute: too short to matter.
# The size of the scenes makes them take seconds. OPTIONS: more options for gray; SCENES: the scripts; RUNS: how many
# runs a median has.
cd "$(dirname "$0")/.." || exit 1
gray=${GRAY:-./gray}
out=${OUT:-build/bench}
runs=${RUNS:-1}
least=${LEAST:-0.05}
mkdir -p "$out"

once() {
    # shellcheck disable=SC2086
    "$gray" --no-fork -j 1 --progress=json $OPTIONS $2 --shard-pictures 1/1000 -o "$out/progress-%d.png" "$1" \
        2>"$out/progress.log" >/dev/null
    awk -v least="$least" '
            function field(name,    at) {
                at = index($0, "\"" name "\":")
                return at ? substr($0, at + length(name) + 3) + 0 : -1
            }
            function worse(old, error, of) {
                error = error < 0 ? -error / of : error / of
                return error > old ? error : old
            }
            { clock = field("processor") }
            /"event":"(begin|build)"/ || /"event":"render"/ && field("share") <= 0 { begun = clock }
            /"event":"render"/ && field("share") > 0 {
                n++; at[n] = clock; share[n] = field("share"); left[n] = field("left"); wall[n] = field("seconds")
            }
            /"event":"written"/ { end = clock; end_wall = field("seconds") }
            END {
                whole = end - begun
                for (i = 1; i <= n; i++) {
                    so_far = at[i] - begun; rest = end - at[i]
                    if (so_far < whole / 3 || rest <= 0)
                        continue
                    error = so_far * (1 - share[i]) / share[i] - rest
                    worst = worse(worst, error, whole)
                    to_end = worse(to_end, error, rest)
                    if (rest < least * whole)
                        continue
                    worst_left = worse(worst_left, error, rest)
                    if (end_wall > wall[i])
                        worst_clock = worse(worst_clock, left[i] - (end_wall - wall[i]), end_wall - wall[i])
                }
                printf "%.2f %d %.1f %.1f %.1f %.1f\n", whole, n, 100 * worst, 100 * worst_left, 100 * to_end, 100 * worst_clock
            }' "$out/progress.log"
}

median() { sort -n | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }

printf '%-12s %8s %6s %8s %8s %8s %8s\n' scene seconds lines whole left 'to end' clock
for scene in ${SCENES:-data/??demo.lua data/light.lua data/meshes.lua data/pyramid-fog.lua data/relief.lua data/solids.lua data/swept.lua}; do
    case $scene in
    *03demo* | *04demo* | *06demo* | *09demo* | *11demo* | *12demo* | *pyramid-fog*) size='--size 2560x1920' ;;
    *01demo* | *02demo* | *05demo* | *08demo* | *13demo* | *meshes*) size='--size 1920x1440' ;;
    *10demo* | *14demo* | *relief* | *solids*) size='--size 1280x960' ;;
    *) size= ;;
    esac
    run=0
    while [ $run -lt "$runs" ]; do
        run=$((run + 1))
        once "$scene" "$size"
    done >"$out/progress.lines"
    # shellcheck disable=SC2046
    printf '%-12s %8.2f %6d %8.1f %8.1f %8.1f %8.1f\n' "$(basename "$scene" .lua)" $(for k in 1 2 3 4 5 6; do cut -d ' ' -f $k "$out/progress.lines" | median; done)
done
