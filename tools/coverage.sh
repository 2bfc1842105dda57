#!/bin/sh
# make coverage: builds with clang's counters, runs the tests (all fast ones, or those that the words match) and reports
# in build/coverage what they cover; a complete run also updates the tables of docs/lab/coverage.md.
cd "$(dirname "$0")/.." || exit 1
command -v clang >/dev/null && command -v llvm-cov >/dev/null && command -v llvm-profdata >/dev/null ||
    { echo "make coverage needs clang and llvm" >&2; exit 1; }
jobs=$(nproc 2>/dev/null || echo 2)
to=${BUILD:-build}/coverage
make -s -j"$jobs" config=coverage ${BUILD:+BUILD="$to"} build-tests all || exit 1
# Every call starts from zero, unless GRAY_COVERAGE_ADD adds to existing results.
[ -n "$GRAY_COVERAGE_ADD" ] || rm -rf $to/raw
GRAY_TEST_BINARY=$to/gray $to/tests/run -j "$jobs" "$@" >$to/test.log 2>&1
grep -vE '^ok ' $to/test.log | grep -A3 -E '^FAILED|passed,'
llvm-profdata merge -o $to/all.profdata $to/raw/*.profraw || exit 1
objects="$to/gray -object $to/tests/run"
for program in gray-gui gray-mpi; do
    [ -x $to/$program ] && objects="$objects -object $to/$program"
done
llvm-cov export $objects -instr-profile $to/all.profdata >$to/export.json 2>$to/llvm.log &&
    llvm-cov export -format=lcov $objects -instr-profile $to/all.profdata >$to/export.lcov 2>$to/llvm.log || exit 1
python3 tools/coverage.py $to || exit 1
echo "files below their mark: $to/files.md; all that is missing: $to/missing.txt"
if [ $# -eq 0 ] && [ -z "$GRAY_COVERAGE_ADD" ]; then
    { sed '/^<!-- tables -->$/q' docs/lab/coverage.md && cat $to/summary.md; } >$to/page.md && cp $to/page.md docs/lab/coverage.md
fi
