#!/bin/sh
# Complete pictures compared with POV-Ray on the paired scenes of bench/pov: only rendering, without reading and building,
# one thread each (THREADS), both with adaptive anti-aliasing that marks pixels by colours and takes 9 samples on a grid
# (gray's --aa-pattern grid; PATTERN=rotated is gray's default, which marks more), both without rays that
# change a pixel by less than 1/255 (POV-Ray's adc_bailout, --cutoff); runs interleaved, medians of RUNS (default 3).
# User is the processor time that each program reports for its trace, wall is elapsed time; memory is the peak of
# each process. ksmp is thousands of samples. Pictures go to OUT (default build/bench), side by side in OUT/scenes.html.
# MODELS: the folder with stanford-bunny.obj (default ../shared/models). Arguments: scenes (default: all).
cd "$(dirname "$0")/.." || exit 1
here=$(pwd)
gray=${GRAY:-$here/gray}
runs=${RUNS:-3}
threads=${THREADS:-1}
pattern=${PATTERN:-grid}
models=$(cd "${MODELS:-../shared/models}" 2>/dev/null && pwd)
out=${OUT:-$here/build/bench}
command -v povray >/dev/null 2>&1 || { echo "povray is not installed: left out"; exit 0; }
[ -x "$gray" ] || { echo "no program $gray: make first"; exit 1; }
mkdir -p "$out" && cd "$out" || exit 1
[ $# -gt 0 ] || set -- primitives solids bunny
[ -x /usr/bin/time ] && timer=/usr/bin/time || timer=

# Runs a program; its peak memory in kilobytes goes to memory.kb if GNU time is installed.
measured() {
    if [ -n "$timer" ]; then "$timer" -f %M -o memory.kb "$@"; else echo 0 >memory.kb && "$@"; fi
}

median() { sort -n | awk '{ v[NR] = $1 } END { print NR ? v[int((NR + 1) / 2)] : "-" }'; }

# POV-Ray prints wall and processor seconds of its trace on stderr. Its file is written without gamma, like gray's; its
# anti-aliasing nevertheless compares colours with its own gamma.
pov_once() {
    measured povray +I"$here/bench/pov/$1.pov" +L"$out" +O"$out/$1-pov.png" +W640 +H480 -D -V +WT"$threads" +FN File_Gamma=1.0 \
        +A0.05 +AM1 +R3 -J 2>"$1.log" >/dev/null
    awk '/^ *Trace Time:/ { sub(/.*\(/, ""); wall = $1; getline; sub(/.*with /, ""); user = $1 }
         /Samples:/ { sub(/.*Samples: */, ""); samples = $1 }
         END { printf "%s %s %s ", user, wall, samples }' "$1.log" >>"$1-pov.times"
    cat memory.kb >>"$1-pov.times"
}

gray_once() {
    scene=$1
    shift
    measured "$gray" -q -j "$threads" --stats=json --cutoff 0.0039 --aa-pattern "$pattern" -o "$out/$scene-gray.png" "$@" "$here/bench/pov/$scene.lua" 2>"$scene-gray.log" >"$scene.json"
    [ -s "$scene.json" ] || { cat "$scene-gray.log"; return 1; }
    awk 'function figure(key) { return substr($0, index($0, "\"" key "\":") + length(key) + 3) + 0 }
         { printf "%s %s %s ", figure("render_processor_seconds"), figure("render_seconds"), figure("samples") }' \
        "$scene.json" >>"$scene-gray.times"
    cat memory.kb >>"$scene-gray.times"
}

column() { cut -d ' ' -f "$2" "$1" | median; }

# A row of the page with both pictures side by side, gray's on the left.
show() {
    printf '<h2>%s</h2><pre>%s</pre><p><img src="%s-gray.png" alt="gray"> <img src="%s-pov.png" alt="POV-Ray"></p>\n' "$1" "$2" "$1" "$1" >>scenes.html
}

pair() {
    scene=$1
    shift
    : >"$scene-pov.times"
    : >"$scene-gray.times"
    i=0
    while [ $i -lt "$runs" ]; do
        i=$((i + 1))
        pov_once "$scene"
        gray_once "$scene" "$@" || return 1
    done
    line=$(for k in 1 2 3 4; do echo "$(column "$scene-pov.times" $k) $(column "$scene-gray.times" $k)"; done |
        awk -v scene="$scene" '{ pov[NR] = $1; gray[NR] = $2 }
            END { printf "%-12s %8.3f %8.3f %6.2f %8.3f %8.3f %6.2f %8.0f %8.0f %8.1f %8.1f", scene, pov[1], gray[1],
                  pov[1] / gray[1], pov[2], gray[2], pov[2] / gray[2], pov[3] / 1000, gray[3] / 1000, pov[4] / 1024, gray[4] / 1024 }')
    echo "$line" | tee -a scenes.table
    show "$scene" "$head
$line"
}

head=$(printf '%-12s %8s %8s %6s %8s %8s %6s %8s %8s %8s %8s' scene 'pov user' gray ratio 'pov wall' gray ratio 'pov ksmp' gray 'pov MB' gray)
echo '<!DOCTYPE html><meta charset="utf-8"><title>gray and POV-Ray</title><style>img { width: 49% }</style>' >scenes.html
: >scenes.table
echo "$head"
for scene in "$@"; do
    case $scene in
    primitives) pair primitives -reflect-limit 8 -refract-limit 8 ;;
    solids) pair solids ;;
    bunny)
        if [ -f "$models/stanford-bunny.obj" ]; then
            "$gray" -q --allow-read "$models" -D MODEL="$models/stanford-bunny.obj" -D EXPORT=yes "$here/bench/pov/bunny.lua" >mesh.inc &&
                pair bunny -reflect-limit 4 --allow-read "$models" -D MODEL="$models/stanford-bunny.obj"
        else
            echo "bunny: no stanford-bunny.obj in MODELS: left out"
        fi
        ;;
    *) echo "no scene $scene: primitives, solids, bunny" ;;
    esac
done
awk '{ user += log($4); wall += log($7); n++ }
    END { if (n) printf "geometric mean of %d: user %.2f, wall %.2f\n", n, exp(user / n), exp(wall / n) }' scenes.table
echo "pictures: $out/scenes.html"
