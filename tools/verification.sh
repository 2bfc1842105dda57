#!/bin/sh
# Runs tests that compare means with known values and prints a table of the measurements. Each line has a test, claim
# and value: mean over the seeds, largest standard error of a seed, largest distance in standard errors, seeds.
# docs/design/verification.md has the result. Usage: tools/verification.sh [WORD ...]; the words select tests, by default all of
# the path tracer.
cd "$(dirname "$0")/.." || exit 1
export GRAY_TEST_BINARY="${GRAY_TEST_BINARY:-build/release/gray}"
values=$(mktemp) || exit 1
trap 'rm -f "$values"' EXIT
[ $# -gt 0 ] || set -- test_path.c test_path_estimators test_subsurface slabs_ paths_with_photons_show_what depth_1_is white_layered_surfaces
GRAY_TEST_VALUES=$values build/release/tests/run --long "$@" >&2
status=$?
awk -F'|' '
    {
        key = $1 "|" $2 "|" $3
        if (!(key in count))
            order[++keys] = key
        sigmas = $5 > 0 ? ($4 > $3 ? $4 - $3 : $3 - $4) / $5 : 0
        if (sigmas > most[key]) most[key] = sigmas
        if ($5 > error[key]) error[key] = $5
        sum[key] += $4
        count[key]++
    }
    END {
        print "| claim | value | measured | standard error | distance | runs | test |"
        print "| --- | --- | --- | --- | --- | --- | --- |"
        for (i = 1; i <= keys; i++) {
            split(order[i], part, "|")
            printf "| %s | %.6f | %.6f | %.6f | %.1f | %d | `%s` |\n", part[2], part[3],
                   sum[order[i]] / count[order[i]], error[order[i]], most[order[i]], count[order[i]], part[1]
        }
    }' "$values"
exit $status
