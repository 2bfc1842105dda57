#!/bin/sh
# Installs what the build needs and what is missing, from the Debian archive the machine is set up with; says so first.
# Nothing is done when everything is there. Elsewhere than on Debian and its relatives: names what to install by hand.
# Usage: tools/setup.sh [--check]    --check only tells what is missing (exit status 1)
set -u
missing=""
need() { # need PACKAGE COMMAND...: the command tells whether it is there
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
[ -z "$missing" ] && exit 0

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
