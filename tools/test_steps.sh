#!/bin/sh
# tools/test_steps.sh PID PARENT [--long [NAME ...]]: the steps of make test. Checks the layers, compiles all sources with
# clang, builds and runs the tests of the release build, then some of the same tests with the address and undefined
# behaviour sanitizers. Warnings are errors, unless WERROR is set and empty. --long: all other tests. Ends with one line
# "N passed, N failed, N skipped". With GRAY_CI=1 what is skipped because a tool is missing fails. A line at least every GRAY_TEST_PROGRESS seconds (15) reports the current step.
# It leads a session, which ends when process PID (tools/test.sh) has ended or has lost its parent PARENT (if not empty).
interval=${GRAY_TEST_PROGRESS:-15}

# Twice a second: do this process and the other one exist? A zombie (Z) does not count.
# If not, end the whole session.
sh -c '
there() {
    read -r _ _ state parent _ 2>/dev/null <"/proc/$1/stat" && [ "$state" != Z ] && [ "$parent" = "${2:-$parent}" ]
}
. tools/test_session.sh
trap "kill \$! 2>/dev/null; wait; exit" TERM
while there "$1" "$2" && there "$3"; do
    sleep 0.4 &
    wait $!
done
trap "" TERM
end_group "$3" $$
kill -s KILL 0' test-watchdog "$1" "$2" $$ >/dev/null 2>&1 </dev/null &
watchdog=$!

# finish STATUS: ends this process.
finish() {
    kill "$watchdog"
    wait 2>/dev/null
    exit "$1"
}

# step WHAT COMMAND ...: runs a command without progress output.
step() {
    what=$1
    shift
    sh -c '
trap "kill \$! 2>/dev/null; wait; exit" TERM
begun=$(date +%s)
while :; do
    sleep "$2" >/dev/null 2>&1 &
    wait $!
    echo "   $1, $(($(date +%s) - begun)) s"
done' ticker "$what" "$interval" &
    ticker=$!
    "$@"
    status=$?
    kill $ticker
    wait $ticker 2>/dev/null
    return $status
}

shift 2
long=no
if [ "$1" = --long ]; then
    long=yes
    shift
fi
jobs=$(nproc 2>/dev/null || echo 2)
tests=$((jobs + 2)) # at once: many wait for the disk
passed=0 failed=0 skipped=0

# The folder of a configuration: what make takes for BUILD.
folder_of() {
    case $1 in
    release) echo "${BUILD:-build/release}" ;;
    *) echo "${BUILD:-build}/$1" ;;
    esac
}

# The folder is named only if the caller has named one.
build() {
    step "building $1" make -s -j"$jobs" config="$1" ${BUILD:+BUILD="$(folder_of "$1")"} WERROR="${WERROR-1}" build-tests all || { echo "the $1 build failed" >&2; finish 1; }
}

# Runs a test binary, which prints failures and progress; adds up its final counts.
run() {
    config=$1
    shift
    echo "== $config: $*"
    folder=$(folder_of "$config")
    log=$folder/test.log
    rm -f "$log"
    ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1 UBSAN_OPTIONS=print_stacktrace=1 \
        TSAN_OPTIONS=halt_on_error=1 GRAY_TEST_BINARY="$folder/gray" \
        "$folder/tests/run" --log "$log" -j "$tests" "$@"
    status=$?
    counts=$(tail -n 1 "$log" 2>/dev/null)
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

# check WHAT COMMAND ...: a step that passes or fails.
check() {
    if step "$@"; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
}

# lacks TOOL WHAT: a step that cannot be done.
lacks() {
    echo "skipped: $2 needs $1, which is not installed"
    if [ -n "${GRAY_CI:-}" ]; then failed=$((failed + 1)); else skipped=$((skipped + 1)); fi
}

check "checking layers" tools/layers.sh
if command -v clang >/dev/null; then
    check "reading the sources with clang" make -s -j"$jobs" config=clang ${BUILD:+BUILD="$(folder_of clang)"} \
        WERROR="${WERROR-1}" read-sources
else
    lacks clang "reading the sources"
fi
build release
build asan
if [ $long = no ]; then
    run release
    run asan smoke errors_ test_script '*script*' allocation png obj ply stl gltf mtl jpeg font_ gzip mesh_faces test_program test_channel test_options \
        window_survives_random window_outlines window_shows_and window_stops_b \
        -hostile_no_script -smoke_every_demo_of_the_library -smoke_scenes_of_combined -smoke_path_traced -progress_can_be_a_bar -any_word_of_a_gltf \
        -may_fail_while_every_function -any_allocation_of_caustics -test_frame_writing -the_scene_of_the_readme -swept_shapes_survive
else
    build tsan
    run release --long "$@"
    if [ $# -eq 0 ]; then
        build debug
        run debug --long faults_
        run debug allocation any_
        run asan
        run tsan
        if command -v clang >/dev/null; then # four hours for all targets together
            check fuzzing make -s fuzz FUZZ_SECONDS="${FUZZ_SECONDS:-850}"
        else
            lacks clang fuzzing
        fi
    fi
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
finish $?
