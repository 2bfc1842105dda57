#!/bin/sh
# Samples of paths a second by a card and by the threads of the processor, five scenes of 512 x 512 pixels with 64 samples
# (SIZE, SPP), interleaved, medians of RUNS (default 3). The times are those of the render (--stats), with all orders; start
# is driver, kernels, upload and the samples that try the card, before them. Last column: whether both wrote the same bytes.
# DEVICE: gpu, or emulate.
# device.sh walk: pictures of one sample a second at 1280 x 960 (SIZE) in the window while the camera moves, from its change
# to the tone-mapped picture in the memory of the supervisor, for 10 s (WALK), without a display (moving.c).
cd "$(dirname "$0")/.." || exit 1
gray=${GRAY:-$(pwd)/gray} runs=${RUNS:-3} device=${DEVICE:-gpu} out=${OUT:-build/bench}
[ -x "$gray" ] || { echo "no program $gray: make first"; exit 1; }
mkdir -p "$out"
problem=$("$gray" -q --device "$device" --integrator path --size 16x12 --spp 1 -o /dev/null docs/first.lua 2>&1) ||
    { echo "left out: $(echo "$problem" | head -n 1)"; exit 0; }

moving() {
    BUILD=${BUILD:-build/release}
    make -s BUILD="$BUILD" "$BUILD/bench/moving" || exit 1
    kernels=$(dirname "$(readlink -f "$gray")")/gray-kernels # they are beside the program
    [ ! -e "$kernels" ] || cp "$kernels" "$BUILD/bench/" || exit 1
    for _ in $(seq "$runs"); do
        "$BUILD/bench/moving" "${WALK:-10}" --device "$device" --integrator path --size "${SIZE:-1280x960}" \
            --spp 16 -o "$out/walk.png" --force data/path/cornell.lua >"$out/walk.txt" 2>&1 || { cat "$out/walk.txt"; exit 1; }
        sed -n 's/.*: \([0-9]*\) pictures of the integrator in \([0-9.]*\) s, the first after \(.*\)/\1 \2 \3/p' "$out/walk.txt" |
            tail -n 1 | awk -v d="$device" '{ n++; printf "%s: %.1f pictures a second, the first after %s %s\n", d, $1 / $2, $3, $4 }
                END { exit !n }' || { echo "the device made none:"; cat "$out/walk.txt"; }
    done
}
[ "$1" != walk ] || { moving; exit; }

figure() { sed -n "s/.*\"$1\":\"*\([^,\"]*\).*/\1/p" "$2"; }
median() { sort -n | awk '{ v[NR] = $1 } END { print NR ? v[int((NR + 1) / 2)] : "-" }'; }
render() { # device scene
    "$gray" -q --device "$1" --integrator path --size "${SIZE:-512x512}" --spp "${SPP:-64}" --stats=json \
        -o "$out/device-$1.pfm" --force "$2" >"$out/device.json" 2>"$out/device.txt" || { cat "$out/device.txt"; exit 1; }
    echo "$(figure samples "$out/device.json") $(figure render_seconds "$out/device.json")" |
        awk '{ print 1e-6 * $1 / $2 }' >>"$out/device-$1.rates"
}

printf '%-9s %12s %12s %8s %8s  %s\n' scene "threads M/s" "$device M/s" ratio "start s" bytes
for scene in data/path/cornell.lua bench/denoise/mesh_sky.lua bench/path/tori.lua data/path/table.lua data/path/plates.lua; do
    rm -f "$out/device-cpu.rates" "$out/device-$device.rates"
    for _ in $(seq "$runs"); do
        render cpu "$scene"
        render "$device" "$scene"
    done
    name=$(basename "$scene" .lua) bytes=differ
    cmp -s "$out/device-cpu.pfm" "$out/device-$device.pfm" && bytes=same
    threads=$(median <"$out/device-cpu.rates") card=$(median <"$out/device-$device.rates")
    printf '%-9s %12.2f %12.2f %8.2f %8.2f  %s\n' "$name" "$threads" "$card" "$(echo "$card $threads" | awk '{ print $1 / $2 }')" \
        "$(figure device_start_seconds "$out/device.json")" "$bytes"
done
echo "$(figure device "$out/device.json"): $(figure lanes "$out/device.json") lanes, $(figure device_bytes "$out/device.json") bytes"
