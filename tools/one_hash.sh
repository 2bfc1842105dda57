#!/bin/bash
# tools/one_hash.sh [PROGRAM [SCENE [OPTION ...]]]: renders one picture under every condition that must not matter, and prints a
# table of the conditions and the hashes of the files; fails if two hashes differ. Conditions that this machine does not
# support are skipped with a message.
gray=$(realpath "${1:-build/release/gray}") || exit 2
scene=$(realpath "${2:-$(dirname "$0")/../tests/scripts/one_hash.lua}") || exit 2
[ $# -lt 2 ] || shift 2
common=("$@") # options of every run
folder=$(mktemp -d) || exit 2
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 2
cp "$scene" scene.lua
status=0

hash_of() { sha256sum "$1" 2>/dev/null | cut -c 1-16; }
"$gray" -q "${common[@]}" scene.lua -o first.png || exit 2
first=$(hash_of first.png)

# row WHAT HASH...: one line of the table.
row() {
    what=$1
    shift
    different=$(printf '%s\n' "$@" | sort -u | grep -vx "$first" | tr '\n' ' ')
    [ -z "$different" ] || status=1
    printf '| %-58s | %4d | %s |\n' "$what" "$#" "${different:-$first}"
}

# hashes "OPTIONS" ...: one run for each list of options.
hashes() {
    for options in "$@"; do
        rm -f out.png
        # shellcheck disable=SC2086
        "$gray" -q "${common[@]}" scene.lua -o out.png $options || { echo "failed:$options" | tr ' ' _; continue; }
        hash_of out.png
    done
}

printf '| %-58s | %4s | %-16s |\n| --- | --- | --- |\n' "made with" runs "SHA-256, begin"
row "1 to 8 threads" $(hashes "-j 1" "-j 2" "-j 3" "-j 4" "-j 5" "-j 6" "-j 7" "-j 8")
sets=
for isa in base avx2 avx512; do
    if "$gray" -q --check --isa $isa scene.lua 2>/dev/null; then sets="$sets $isa"; else echo "(no $isa here)"; fi
done
# shellcheck disable=SC2046,SC2086
row "--isa:$sets" $(hashes $(for isa in $sets; do echo "--isa=$isa"; done))
row "--accel auto, grid, bvh, kdtree, none" $(hashes --accel=auto --accel=grid --accel=bvh --accel=kdtree --accel=none)

masks="-FMA,-AVX2 -FMA,-AVX2,-AVX,-FMA4,-AVX512F -FMA -AVX512F,-AVX512VL -SSE4_1,-AVX,-AVX2,-FMA"
row "glibc without FMA, AVX2, AVX, AVX-512, SSE4.1 (5 masks)" $(for mask in $masks; do
    export GLIBC_TUNABLES=glibc.cpu.hwcaps=$mask
    hashes "-j 2"
done)

shards=
for count in $(seq 16); do
    rm -f out.png*
    for i in $(seq "$count"); do
        "$gray" -q "${common[@]}" scene.lua -o out.png -j $((i % 8 + 1)) --shard "$i/$count" || break
    done
    "$gray" merge -q out.png.*-of-"$count".part && shards="$shards $(hash_of out.png)" || shards="$shards failed"
done
# shellcheck disable=SC2086
row "1 to 16 shards, each with 1 to 8 threads, merged" $shards

resumed=
before=0 among=0 after=0
for moment in 0.02 0.05 0.1 0.2 0.3 0.4 0.6 0.8 1 1.3 1.7 2.2; do
    rm -f out.png c.tiles
    "$gray" -q "${common[@]}" scene.lua -o out.png -j 2 --checkpoint c.tiles --checkpoint-every 0 &
    run=$!
    disown $run
    sleep $moment
    kill -9 $run 2>/dev/null
    if [ -s out.png ]; then after=$((after + 1)); elif [ -s c.tiles ]; then among=$((among + 1)); else before=$((before + 1)); fi
    "$gray" -q "${common[@]}" scene.lua -o out.png -j 3 --checkpoint c.tiles --resume && resumed="$resumed $(hash_of out.png)" ||
        resumed="$resumed failed"
done
# shellcheck disable=SC2086
row "kill -9 ($before before a tile, $among among them, $after after), --resume" $resumed

if [ -x "$gray-mpi" ] && command -v mpirun >/dev/null; then
    ranks=
    for count in 1 2 3 4; do
        rm -f out.png
        OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 TMPDIR=/tmp \
            mpirun --oversubscribe -n $count "$gray" --mpi -q "${common[@]}" -j $((count % 2 + 1)) scene.lua -o out.png &&
            ranks="$ranks $(hash_of out.png)" || ranks="$ranks failed"
    done
    # shellcheck disable=SC2086
    row "MPI, 1 to 4 ranks" $ranks
else
    echo "(no MPI here)"
fi
row "--no-fork; --no-sandbox" $(hashes --no-fork --no-sandbox)
[ $status = 0 ] && echo "one hash: $(sha256sum <first.png | cut -d ' ' -f 1)"
exit $status
