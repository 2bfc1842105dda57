#!/bin/sh
# Path tracing compared with Cycles (blender) and Embree's tutorial pathtracer (embree-tools). One thread each, runs
# interleaved, medians of RUNS (default 5), processor time. If the other program is not installed, a message says so.
#   speed    samples a second against Cycles at depth 8 without Russian roulette: the Cornell box with blocks, and with a
#            mirror and a ball of glass
#   error    relMSE, the mean of (x - r)^2 / (r^2 + .01), after SECONDS_EACH (default 10) of rendering at 128 x 128 against
#            REFERENCE samples (default 16384) of the same program, which are kept in OUT
#   media    error of three scenes with media, at larger depths: fog with a lamp and a spot, a tumbler of milk, smoke from a
#            grid (its file for Cycles needs python3-openvdb)
#   embree   samples a second against `pathtracer --max-path-length 8` on its Cornell box
#   denoise  the error of 64 denoised samples against that of 512 raw ones (bench/denoise.sh); seconds for 1280 x 960
#   threads  the speed of two threads relative to one; and 2 reduced by additional processor time and idle threads
#   memory   bytes a pixel beyond Whitted's, at 1280 x 960
# Both programs: box filter, all caustics, no clamps, no adaptive sampling; Cycles as bench/path/cycles.py sets it.
# Errors are scaled to exactly that time, because they are inversely proportional to the number of samples.
# Arguments: rows (default: all). SCENES: of the rows error and media; GRAY: the program; OUT: pictures and times, not for two runs
# at once (default build/bench/path); SHORT=1: one run of 2 seconds against 1024 samples.
cd "$(dirname "$0")/.." || exit 1
gray=${GRAY:-./gray}
if [ -n "$SHORT" ]; then RUNS=${RUNS:-1} SECONDS_EACH=${SECONDS_EACH:-2} REFERENCE=${REFERENCE:-1024}; fi
runs=${RUNS:-5}
seconds=${SECONDS_EACH:-10}
reference=${REFERENCE:-16384}
out=${OUT:-build/bench/path}
depth=8
models=/usr/share/doc/embree3/models
[ -x "$gray" ] || { echo "no program $gray: make first"; exit 1; }
mkdir -p "$out" || exit 1
[ $# -gt 0 ] || set -- speed error media embree denoise threads memory
[ -x /usr/bin/time ] && timer=/usr/bin/time || timer=

median() { sort -g | awk '{ v[NR] = $1 } END { print NR ? v[int((NR + 1) / 2)] : "-" }'; }
installed() { command -v "$1" >/dev/null 2>&1 || { echo "$1 is not installed: $2 left out"; return 1; }; }

script_of() {
    case $1 in
    cornell) echo data/path/cornell.lua ;;
    spheres | fog | milk | smoke) echo "bench/path/$1.lua" ;;
    *) echo "bench/denoise/$1.lua" ;;
    esac
}

# gray_run SCRIPT PICTURE SPP SEED [options]: prints processor seconds of rendering, and scattering events of a sample.
gray_run() {
    script=$1 picture=$2 spp=$3 seed=$4
    shift 4
    "$gray" -q --no-fork -j 1 --stats=json --integrator path --size 128x128 --allow-read textures --allow-read build/bench --max-depth "$depth" \
        --spp "$spp" --seed "$seed" -o "$out/$picture.pfm" "$@" "$script" |
        awk 'function figure(key) { return substr($0, index($0, "\"" key "\":") + length(key) + 3) + 0 }
             { printf "%.3f %.3f\n", figure("render_processor_seconds"),
                      (figure("reflected_rays") + figure("refracted_rays")) / figure("camera_rays") }'
}

# cycles_run SCENE NAME:SPP:SEED:ROULETTE...: prints a line "NAME SPP processor-seconds wall-seconds" for each.
cycles_run() {
    scene=$1
    shift
    blender -b -noaudio --factory-startup -P bench/path/cycles.py -- "$scene" "$out" "$depth" "$@" 2>/dev/null |
        sed -n 's/^cycles //p'
}

# Processor seconds of one more sample a pixel, from the lines of the last two runs.
per_pass() { awk '{ t0 = t; n0 = n; t = $3; n = $2 } END { print (t - t0 > 1e-4 ? t - t0 : 1e-4) / (n - n0) }'; }

prepare() {
    [ -s "$out/sky.hdr" ] || "$gray" -q -o "$out/sky.hdr" bench/path/sky.lua || exit 1
    [ -s "$out/meshes.obj" ] || "$gray" -q bench/path/meshes.lua >"$out/meshes.obj" || exit 1
}

# cycles_pass SCENE SPP SEED, embree_pass SCENE SPP SEED: processor seconds of one more sample a pixel of the peer.
cycles_pass() { cycles_run "$1" speed:2:1:0 speed:1:1:0 "speed:$2:$3:0" | per_pass; }

embree_once() {
    $timer -f %U -o "$out/embree.time" pathtracer -c "$models/$1.ecs" --threads 1 --size 128 128 --spp "$2" \
        --max-path-length $depth -o "$out/embree.ppm" >/dev/null 2>&1
    echo "$1 $2 $(tail -n 1 "$out/embree.time")"
}

embree_pass() { { embree_once "$1" 1; embree_once "$1" "$2"; } | per_pass; }

# speed_row SCENE SCRIPT PASS: thousands of samples a second of gray and of the peer, whose passes PASS measures.
speed_row() {
    row_scene=$1 row_script=$2 pass=$3
    spp=$(gray_run "$row_script" speed 8 1 --roulette-depth $depth |
        awk -v s="$seconds" '{ n = int(8 * s / ($1 > .01 ? $1 : .01)); print (n > 8 ? n : 8) }')
    run=0
    : >"$out/speed.peer"
    : >"$out/speed.gray"
    while [ $run -lt "$runs" ]; do
        run=$((run + 1))
        gray_run "$row_script" speed "$spp" $run --roulette-depth $depth >>"$out/speed.gray"
        $pass "$row_scene" "$spp" $run >>"$out/speed.peer"
    done
    g=$(awk -v n="$spp" '{ print 16.384 * n / $1 }' "$out/speed.gray" | median)
    p=$(awk '{ print 16.384 / $1 }' "$out/speed.peer" | median)
    awk -v scene="$row_scene" -v g="$g" -v p="$p" -v e="$(cut -d ' ' -f 2 "$out/speed.gray" | median)" \
        'BEGIN { printf "%-12s %9.1f %9.1f %6.2f %7.2f\n", scene, g, p, g / p, e }'
}

speed_heading() {
    echo "thousands of samples a second, no roulette; events: scattering events of a sample of gray"
    printf '%-12s %9s %9s %6s %7s\n' scene gray "$1" ratio events
}

speed() {
    installed blender 'samples a second against Cycles' || return
    speed_heading Cycles
    for scene in cornell spheres; do speed_row $scene "$(script_of $scene)" cycles_pass; done
}

# error_of REFERENCE PICTURE SECONDS: relMSE scaled to the time of the row, and the mean of the reference.
error_of() {
    python3 bench/path/compare.py "$out/$1" "$out/$2" | awk -v t="$3" -v s="$seconds" '{ print $1 * t / s, $2 }'
}

error() {
    installed blender 'error at equal time against Cycles' || return
    prepare
    echo "relMSE after $seconds s against $reference samples, with roulette; spp: samples a pixel in that time"
    printf '%-12s %9s %6s %9s %6s %6s %9s %9s\n' scene gray spp Cycles spp ratio 'mean gray' Cycles
    : >"$out/error.ratios"
    for scene in ${SCENES:-cornell spheres mesh_sky lamps glossy}; do
        script=$(script_of $scene)
        case $scene in
        milk) depth=256 ;;
        smoke) depth=64 ;;
        *) depth=8 ;;
        esac
        cref=cycles-$scene-$reference gref=gray-$scene-$reference
        [ -s "$out/$gref.pfm" ] || gray_run "$script" "$gref" "$reference" 1000 >/dev/null
        [ -s "$out/$cref.exr" ] || cycles_run $scene "$cref:$reference:1000:1" >/dev/null
        gspp=$(gray_run "$script" trial 8 1 | awk -v s="$seconds" '{ n = int(8 * s / ($1 > .01 ? $1 : .01)); print (n > 1 ? n : 1) }')
        cspp=$(cycles_run $scene trial:1:1:1 trial:2:1:1 trial:18:1:1 | per_pass | awk -v s="$seconds" '{ n = int(s / $1); print (n > 1 ? n : 1) }')
        run=0
        : >"$out/error.lines"
        while [ $run -lt "$runs" ]; do
            run=$((run + 1))
            g=$(gray_run "$script" trial "$gspp" $run | cut -d ' ' -f 1)
            c=$(cycles_run $scene trial:2:1:1 trial:1:1:1 "trial:$cspp:$run:1" | per_pass)
            c=$(awk -v c="$c" -v n="$cspp" 'BEGIN { print c * n }')
            echo "$(error_of "$gref.pfm" trial.pfm "$g") $(error_of "$cref.exr" trial.exr "$c")" >>"$out/error.lines"
        done
        awk -v scene=$scene -v g="$(cut -d ' ' -f 1 "$out/error.lines" | median)" \
            -v c="$(cut -d ' ' -f 3 "$out/error.lines" | median)" -v gs="$gspp" -v cs="$cspp" \
            -v gm="$(cut -d ' ' -f 2 "$out/error.lines" | median)" -v cm="$(cut -d ' ' -f 4 "$out/error.lines" | median)" \
            -v ratios="$out/error.ratios" 'BEGIN {
                printf "%-12s %9.6f %6d %9.6f %6d %6.2f %9.4f %9.4f\n", scene, g, gs, c, cs, g / c, gm, cm
                print g / c >>ratios
            }'
    done
    awk '{ s += log($1); n += $1 <= 1 } END { printf "geometric mean %.2f; %d of %d at most 1\n", exp(s / NR), n, NR }' "$out/error.ratios"
    depth=8
}

media() {
    installed blender 'error at equal time against Cycles' || return
    grid=build/bench/path # where bench/path/smoke.lua reads it
    mkdir -p $grid && { [ -s $grid/smoke.vdb ] || /usr/bin/python3 bench/path/smoke_grid.py $grid; }
    if [ -s $grid/smoke.vdb ]; then cp $grid/smoke.vdb "$out" 2>/dev/null; fi
    if [ -s "$out/smoke.vdb" ]; then SCENES=${SCENES:-fog milk smoke} error; else SCENES=${SCENES:-fog milk} error; fi
}

embree() {
    installed pathtracer "samples a second against Embree's pathtracer" || return
    [ -r $models/cornell_box.ecs ] || { echo "no $models/cornell_box.ecs: Embree's pathtracer left out"; return; }
    [ -n "$timer" ] || { echo "GNU time is not installed: Embree's pathtracer left out"; return; }
    speed_heading Embree
    speed_row cornell_box bench/path/embree_box.lua embree_pass
}

large() {
    "$gray" -q --no-fork --stats=json --size 1280x960 -o "$out/large.pfm" "$@" data/path/cornell.lua
}

denoise() {
    echo 'denoised 64 samples against raw ones'
    GRAY=$gray REFERENCE=${SHORT:+1024} bench/denoise.sh data/path/cornell.lua bench/path/spheres.lua bench/denoise/*.lua
    [ -n "$timer" ] || { echo 'GNU time is not installed: the time of denoising left out'; return; }
    timed() { $timer -f '%e %U' -o "$out/denoise.time" "$gray" -q --no-fork --integrator path --spp 1 -j 2 \
        --size 1280x960 -o "$out/large.pfm" "$@" data/path/cornell.lua && tail -n 1 "$out/denoise.time"; }
    echo "$(timed) $(timed --denoise)" |
        awk '{ printf "denoising 1280 x 960, two threads: %.1f s, %.1f s of processor time\n", $3 - $1, $4 - $2 }'
}

threads() {
    run=0
    : >"$out/threads"
    while [ $run -lt "$runs" ]; do
        run=$((run + 1))
        for j in 1 2; do
            large --integrator path --spp 4 -j $j |
                awk 'function figure(key) { return substr($0, index($0, "\"" key "\":") + length(key) + 3) + 0 }
                     { printf "%f %f %f ", figure("render_seconds"), figure("render_processor_seconds"), figure("idle_seconds") }'
        done >>"$out/threads"
        echo >>"$out/threads"
    done
    echo "two threads: $(awk '{ print $1 / $4 }' "$out/threads" | median) times the speed of one (elapsed time: needs an idle machine)"
    work=$(awk '{ print $5 / $2 }' "$out/threads" | median) idle=$(awk '{ print $6 / $4 / 2 }' "$out/threads" | median)
    awk -v work="$work" -v idle="$idle" 'BEGIN {
        printf "processor time of two over that of one: %.3f; idle at the end: %.1f %%; expected on an idle machine: %.2f\n",
               work, 100 * idle, 2 * (1 - idle) / work
    }'
}

memory() {
    [ -n "$timer" ] || { echo 'GNU time is not installed: memory left out'; return; }
    # A scene that leaves the integrator to the option.
    kb() {
        $timer -f %M -o "$out/memory.kb" "$gray" -q --no-fork --size 1280x960 -o "$out/large.pfm" "$@" data/01demo.lua &&
            tail -n 1 "$out/memory.kb"
    }
    whitted=$(kb --integrator whitted -ss 1 -j 1)
    path=$(kb --integrator path --spp 1 -j 1)
    two=$(kb --integrator path --spp 1 -j 2)
    denoised=$(kb --integrator path --spp 1 --denoise -j 1)
    awk -v w="$whitted" -v p="$path" -v t="$two" -v d="$denoised" 'BEGIN {
        pixels = 1280 * 960 / 1024
        printf "bytes a pixel beyond Whitted: %.0f; with --denoise %.0f; a second thread: %.1f MB\n", (p - w) / pixels,
               (d - w) / pixels, (t - p) / 1024
    }'
}

for row in "$@"; do
    case $row in
    speed | error | media | embree | denoise | threads | memory) $row ;;
    *) echo "no row '$row': speed, error, media, embree, denoise, threads, memory" && exit 1 ;;
    esac
done
