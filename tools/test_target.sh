#!/bin/sh
# Renders the scenes of tools/picture_hashes.sh, one variant of each, with the program for another target, and compares
# them with the recorded pictures. What is missing is one line, and no failure. Interrupted, it continues where it was.
# Usage: tools/test_target.sh arm | musl
cd "$(dirname "$0")/.." || exit 1
target=$1
lacks() {
    echo "test-$target: nothing was tested: $*"
    exit 0
}
case $target in
arm)
    run=qemu-aarch64-static
    PKG_CONFIG_LIBDIR=/usr/lib/aarch64-linux-gnu/pkgconfig pkg-config --exists lua5.4 libpng zlib ||
        lacks "needs liblua5.4-dev:arm64 libpng-dev:arm64 zlib1g-dev:arm64 (dpkg --add-architecture arm64)"
    for program in aarch64-linux-gnu-gcc $run; do
        command -v $program >/dev/null || lacks "needs gcc-aarch64-linux-gnu qemu-user-static"
    done
    ;;
musl)
    run=""
    command -v musl-gcc >/dev/null && [ -e "${MUSL:-build/musl-libraries}/lib/liblua.a" ] ||
        lacks "needs musl-tools, and tools/musl_libraries.sh"
    ;;
*) sed -n '2,4p' "$0" >&2; exit 2 ;;
esac
make -s "$target" || exit 1
# Scenes that use a library which the program lacks make other pictures.
version=$($run "build/$target/gray" --version) except=""
case $version in *"EXR pictures by none"*) except="tests/pictures/skies" ;; esac
case $version in *"JPEG pictures by none"*) except="$except tests/pictures/images" ;; esac
case $version in *"glTF by none"* | *"fonts by none"*) except="$except tests/pictures/shapes data/meshes library/show_text" ;; esac
EXCEPT=$except WAYS=tiny RESUME=1 GRAY=build/$target/gray RUN=$run exec tools/picture_hashes.sh check "build/$target/pictures"
