#!/bin/sh
# Installs missing packages from the Debian archive of the machine, after a message: those that the build needs, and
# optional libraries (a window (SDL2), JPEG and EXR pictures, glTF meshes, fonts). If an optional one cannot be installed,
# it prints its name and continues. Does nothing if everything is installed. For a user who may not install packages, it
# prints one line with the command. On systems not derived from Debian it lists the packages to install by hand.
# Usage: tools/setup.sh [--minimal | --check | --tests]
#   --minimal   only the packages that the build needs
#   --check     only prints the missing packages; exit status 1 if the build needs one of them
#   --tests     the packages that the build needs, and those of some tests (clang); without them these tests are skipped
set -u
mode=${1:-}
missing=""
optional=""
need() { # need PACKAGE COMMAND...: the command shows whether it is installed
    package=$1
    shift
    "$@" >/dev/null 2>&1 || missing="$missing $package"
}
want() {
    package=$1
    shift
    "$@" >/dev/null 2>&1 || optional="$optional $package"
}

have_lua() {
    for name in lua5.4 lua-5.4 lua54; do
        pkg-config --exists "$name" && return 0
    done
    return 1
}

# Headers of the C library: a compiler alone cannot build anything.
have_headers() {
    echo '#include <stdio.h>' | "${CC:-gcc}" -E -x c -
}

need make command -v make
need gcc command -v "${CC:-gcc}"
need libc6-dev have_headers
need pkg-config command -v pkg-config
need liblua5.4-dev have_lua
need libpng-dev pkg-config --exists libpng
need zlib1g-dev pkg-config --exists zlib
case $mode in
--minimal) ;;
--tests) want clang command -v clang ;;
*)
    want libsdl2-dev pkg-config --exists sdl2
    want libjpeg-dev pkg-config --exists libjpeg
    want libjansson-dev pkg-config --exists jansson
    want libfreetype-dev pkg-config --exists freetype2
    want libopenexr-dev pkg-config --exists OpenEXR
    want libwebp-dev pkg-config --exists libwebpmux
    ;;
esac

[ -n "$missing$optional" ] || exit 0
[ -n "$missing" ] || failure=0
if [ "$mode" = --check ]; then
    [ -z "$missing" ] || echo "missing:$missing" >&2
    [ -z "$optional" ] || echo "missing, optional:$optional" >&2
    exit "${failure:-1}"
fi
case $mode in
--tests) without="tests that need it are skipped" ;;
*) without="it is left out" ;;
esac
[ -n "$missing" ] && what="gray needs packages" || what="optional packages are missing"
if ! command -v apt-get >/dev/null 2>&1; then
    echo "$what; this machine has no apt-get, please install what your system calls$missing$optional" >&2
    exit "${failure:-1}"
fi
as_root=""
if [ "$(id -u)" -ne 0 ]; then
    as_root="sudo -n"
    if ! $as_root true 2>/dev/null; then
        echo "$what; to install them: sudo apt-get install -y --no-install-recommends$missing$optional" >&2
        exit "${failure:-1}"
    fi
fi

# The lists of a fresh machine may be absent or old: they are fetched when the first try fails.
install() { # install SECONDS OPTION... PACKAGE...
    seconds=$1
    shift
    # shellcheck disable=SC2086
    $as_root env DEBIAN_FRONTEND=noninteractive timeout "$seconds" \
        apt-get install -y --no-install-recommends "$@" >&2
}
if [ -n "$missing" ]; then
    echo "installing with apt-get:$missing" >&2
    # shellcheck disable=SC2086
    install 3600 $missing || { $as_root apt-get update >&2 && install 3600 $missing; } ||
        { echo "the packages could not be installed:$missing" >&2; exit 1; }
fi
if [ -n "$optional" ]; then
    # Never waits long for a network, never fails: together, and if that is not possible one by one.
    quick="-o Acquire::Retries=0 -o Acquire::http::Timeout=10 -o Acquire::https::Timeout=10"
    echo "installing with apt-get (optional):$optional" >&2
    # shellcheck disable=SC2086
    if ! install 600 $quick $optional; then
        $as_root timeout 60 apt-get $quick update >&2
        for package in $optional; do
            install 240 $quick "$package" || echo "$package could not be installed: $without" >&2
        done
    fi
fi
exit 0
