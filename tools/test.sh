#!/bin/sh
# make test: builds and runs the tests of the release build, then a smoke of the same tests under the address and undefined
# sanitizers. make test-long: everything else (ONLY="name ..." restarts single tests). Ends with one line
# "N passed, N failed, N skipped".
cd "$(dirname "$0")/.." || exit 1
long=no
if [ "$1" = --long ]; then
    long=yes
    shift
fi
tools/setup.sh || exit 1
jobs=$(nproc 2>/dev/null || echo 2)
passed=0 failed=0 skipped=0

build() {
    make -s -j"$jobs" config="$1" build-tests all || { echo "the $1 build failed" >&2; exit 1; }
}

# Runs a test binary, shows its lines, adds its closing counts up.
run() {
    config=$1
    shift
    echo "== $config: $*"
    log=build/$config/test.log
    ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1 UBSAN_OPTIONS=print_stacktrace=1 \
        TSAN_OPTIONS=halt_on_error=1 GRAY_TEST_BINARY="build/$config/gray" \
        "build/$config/tests/run" -j "$jobs" "$@" >"$log" 2>&1
    status=$?
    grep -vE '^ok ' "$log" | grep -vE '^[0-9]+ passed, '
    counts=$(tail -n 1 "$log")
    case $counts in
    *" passed, "*" failed, "*" skipped")
        echo "   $counts"
        set -- $(echo "$counts" | tr -d ,)
        passed=$((passed + $1)) failed=$((failed + $3)) skipped=$((skipped + $5))
        ;;
    *)
        echo "   the runner ended early (status $status)"
        failed=$((failed + 1))
        ;;
    esac
}

if tools/layers.sh; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
build release
build asan
if [ $long = no ]; then
    run release
    run asan smoke errors_ script allocation png obj ply stl gltf mtl jpeg font_ gzip mesh_faces test_program test_channel test_options \
        window_survives_random window_outlines window_shows_and window_stops_b
else
    build tsan
    run release --long "$@"
    if [ $# -eq 0 ]; then
        build debug
        run debug --long faults_
        run asan
        run tsan
        if command -v clang >/dev/null; then # four hours for all targets together
            if make -s fuzz FUZZ_SECONDS="${FUZZ_SECONDS:-850}"; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
        else
            echo "fuzzing needs clang"
            skipped=$((skipped + 1))
        fi
    fi
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
