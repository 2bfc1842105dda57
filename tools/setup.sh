#!/bin/sh
# Installs missing packages that the build needs, from the Debian archive of the machine; announces it first.
# Does nothing if everything is installed. On systems not derived from Debian it lists what to install by hand.
# Usage: tools/setup.sh [--check | --tests]
#   --check   only prints what is missing (exit status 1)
#   --tests   also installs what only some tests need (clang); if that fails, they are skipped
set -u
missing=""
need() { # need PACKAGE COMMAND...: the command shows whether it is installed
    package=$1
    shift
    "$@" >/dev/null 2>&1 || missing="$missing $package"
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

# Optional packages: never asks for a password, never waits long for a network, never fails.
install_optional() { # install_optional PACKAGE
    without="tests that need it are skipped"
    as_root=
    [ "$(id -u)" -eq 0 ] || as_root="sudo -n"
    if ! command -v apt-get >/dev/null 2>&1 || ! $as_root true 2>/dev/null; then
        echo "$1 is not installed, and this user cannot install it: $without" >&2
        return
    fi
    echo "installing with apt-get: $1 (optional)" >&2
    quick="-o Acquire::Retries=0 -o Acquire::http::Timeout=10 -o Acquire::https::Timeout=10"
    # shellcheck disable=SC2086
    {
        $as_root env DEBIAN_FRONTEND=noninteractive timeout 240 apt-get $quick install -y --no-install-recommends "$1" ||
            { $as_root timeout 60 apt-get $quick update &&
                $as_root env DEBIAN_FRONTEND=noninteractive timeout 240 \
                    apt-get $quick install -y --no-install-recommends "$1"; }
    } >&2 || echo "$1 could not be installed: $without" >&2
}
if [ -z "$missing" ]; then
    [ "${1:-}" != --tests ] || command -v clang >/dev/null 2>&1 || install_optional clang
    exit 0
fi

echo "missing:$missing" >&2
[ "${1:-}" = --check ] && exit 1
if ! command -v apt-get >/dev/null 2>&1; then
    echo "this machine has no apt-get; please install the packages of these names (or what your system calls them)" >&2
    exit 1
fi
as_root=""
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null 2>&1; then
        echo "installing needs root: run as root: apt-get install$missing" >&2
        exit 1
    fi
    as_root=sudo
fi
echo "installing with apt-get:$missing" >&2
export DEBIAN_FRONTEND=noninteractive
# The lists of a fresh machine may be absent or old: fetch them when the first try fails.
# shellcheck disable=SC2086
$as_root apt-get install -y --no-install-recommends $missing >&2 ||
    { $as_root apt-get update >&2 && $as_root apt-get install -y --no-install-recommends $missing >&2; } ||
    { echo "the packages could not be installed:$missing" >&2; exit 1; }
[ "${1:-}" != --tests ] || command -v clang >/dev/null 2>&1 || install_optional clang
