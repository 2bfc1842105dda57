#!/bin/sh
# Nanoseconds per ray of every shape except meshes. See the top of shapes.c.
cd "$(dirname "$0")/.." || exit 1
BUILD=${BUILD:-build/release}
make -s BUILD="$BUILD" "$BUILD/bench/shapes" && "$BUILD/bench/shapes" "$@"
