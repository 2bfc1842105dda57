#!/bin/sh
# tools/fuzz.sh libfuzzer|afl SECONDS TARGET...: runs fuzz targets (tests/fuzz/fuzz_TARGET.c) one after the other. make fuzz and
# make fuzz-afl build them first. New inputs are kept in build/fuzz/corpus and used by the next run of either fuzzer; an
# input that fails is left under build/fuzz/TARGET-..., and becomes a test when it is copied into
# tests/fuzz/found/TARGET.
cd "$(dirname "$0")/.." || exit 1
root=$PWD
fuzz=${BUILD:-build}/fuzz afl=${BUILD:-build}/afl
with=$1 seconds=$2
shift 2
status=0
mkdir -p $fuzz
export ASAN_OPTIONS="allocator_may_return_null=1:detect_leaks=1:abort_on_error=1:symbolize=${FUZZ_SYMBOLS:-1}:$ASAN_OPTIONS"
export UBSAN_OPTIONS="print_stacktrace=1:halt_on_error=1:$UBSAN_OPTIONS"

# Seconds of processor time of all processes that this shell has waited for (not in a subshell, which has none).
clock=$fuzz/clock.$$ # two simultaneous runs do not interfere
processor() {
    times >"$clock"
    tail -n 1 "$clock" | awk '{ split($1, u, /[ms]/); split($2, s, /[ms]/); print u[1] * 60 + u[2] + s[1] * 60 + s[2] }' >"$1"
}

seeds() {
    for folder in "tests/fuzz/corpus/$1" "tests/fuzz/found/$1"; do
        [ -d "$folder" ] && echo "$root/$folder"
    done
}

libfuzzer() {
    set -- "$1" "$fuzz/$1.log"
    [ -f "tests/fuzz/$1.dict" ] && dictionary="-dict=$root/tests/fuzz/$1.dict" || dictionary=
    # shellcheck disable=SC2046,SC2086
    "$fuzz/fuzz_$1" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=3000 -max_len=32768 \
        -artifact_prefix="$(realpath "$fuzz")/$1-" -print_final_stats=1 -verbosity=1 $dictionary \
        "$(realpath "$fuzz")/corpus/$1" $(seeds "$1") >"$2" 2>&1 || return 1
    runs=$(awk '/stat::number_of_executed_units/ { print $2 }' "$2")
}

afl() {
    out=$fuzz/afl/$1
    mkdir -p "$out/in"
    printf 'x\n' >"$out/in/x"
    for folder in $(seeds "$1") "$fuzz/corpus/$1"; do
        cp "$folder"/* "$out/in" 2>/dev/null
    done
    rm -rf "$out/out"
    [ -f "tests/fuzz/$1.dict" ] && dictionary="-x tests/fuzz/$1.dict" || dictionary=
    # shellcheck disable=SC2086
    AFL_SKIP_CPUFREQ=1 AFL_I_DONT_CARE_ABOUT_MISSING_CRASHES=1 AFL_NO_UI=1 AFL_NO_AFFINITY=1 \
        AFL_IGNORE_PROBLEMS=1 ASAN_OPTIONS="$ASAN_OPTIONS:symbolize=0:detect_leaks=0" \
        afl-fuzz -V "$seconds" -t 10000 -m none -G 32768 $dictionary -i "$out/in" -o "$out/out" -- \
        "$afl/fuzz_$1" >"$fuzz/$1.afl.log" 2>&1 || return 1
    runs=$(awk '/^execs_done/ { print $3 }' "$out/out/default/fuzzer_stats")
    wall=$(awk '/^run_time/ { print $3 }' "$out/out/default/fuzzer_stats") # it does not wait for its targets
    cp "$out/out/default/queue/"id* "$fuzz/corpus/$1/" 2>/dev/null
    found=0
    for file in "$out/out/default/crashes/"id* "$out/out/default/hangs/"id*; do
        [ -f "$file" ] && found=1 && cp "$file" "$fuzz/$1-afl-$(sha1sum "$file" | cut -c1-12)"
    done
    return $found
}

for name in "$@"; do
    mkdir -p "$fuzz/corpus/$name"
    processor $clock.before
    runs=0 wall=
    if "$with" "$name"; then word="no finding"; else word="FOUND: $fuzz/$name-* and $fuzz/$name*.log" status=1; fi
    processor $clock.after
    echo "$name $with ${runs:-0} $(cat $clock.before $clock.after | tr '\n' ' ')" | awk -v word="$word" -v wall="$wall" \
        '{ t = wall ? wall : $5 - $4; printf "%-9s %-8s %7.0f s%s, %9d runs, %6.0f a second, %s\n", $1, $2, t, (wall ? "" : " of processor time"), $3, (t > 0 ? $3 / t : 0), word }'
done
rm -f "$clock" "$clock.before" "$clock.after"
exit $status
