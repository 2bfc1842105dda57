#!/bin/sh
# The same rays through gray's mesh kernel and Embree's single rays, interleaved, on one thread and on two (THREADS:
# numbers of threads, default "1 2"). See the top of rays.c.
# MODELS: the folder with the OBJ files (default ../shared/models); scenes that need a missing file are left out.
cd "$(dirname "$0")/.." || exit 1
BUILD=${BUILD:-build/release}
make -s BUILD="$BUILD" "$BUILD/bench/rays" || exit 1
for threads in ${THREADS:-1 2}; do
    echo "threads: $threads" >&2
    "$BUILD/bench/rays" --models "${MODELS:-../shared/models}" --threads "$threads" "$@" || exit 1
done
