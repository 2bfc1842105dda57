#!/bin/sh
# The same rays through gray's mesh kernel and Embree's single rays, interleaved on one thread. See the top of rays.c.
# MODELS: the folder with the OBJ files (default ../shared/models); scenes that need a missing file are left out.
cd "$(dirname "$0")/.." || exit 1
BUILD=${BUILD:-build/release}
make -s BUILD="$BUILD" "$BUILD/bench/rays" && "$BUILD/bench/rays" --models "${MODELS:-../shared/models}" "$@"
