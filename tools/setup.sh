#!/bin/sh
# Installs missing packages from the Debian archive of the machine, after a line for each group of them: those that the
# build needs, the window (GTK 4), and libraries (JPEG, EXR and WebP pictures, glTF meshes, fonts). If one that the build
# does not need cannot be installed, it prints its name and continues. Does nothing if everything is installed. For a user who may not
# install packages, and on Fedora, Arch and Alpine, it prints one line with the command. On other systems it lists the
# packages to install by hand.
# GTK 4 is large: it is installed with --window, or where a display is set and apt-get would add fewer than 100 packages.
# Usage: tools/setup.sh [--minimal | --check | --tests] [--window | --no-window] [--for SYSTEM]
#   --minimal   only the packages that the build needs
#   --check     only prints the missing packages; exit status 1 if the build needs one of them
#   --tests     everything that make test can use: also clang, MPI, readers of animations, and, where GTK is installed
#               or wanted, screens without a monitor
#   --for       only prints the command that installs all of it on fedora, arch or alpine
set -u
mode="" window="" system=""
while [ $# -gt 0 ]; do
    case $1 in
    --window | --no-window) window=$1 ;;
    --for) system=${2:-none} && shift ;;
    *) mode=$1 ;;
    esac
    [ $# -eq 0 ] || shift
done
missing=""
wanted="" # lines "GROUP PACKAGE"
need() { # need PACKAGE COMMAND...: the command shows whether it is installed
    package=$1
    shift
    { [ -z "$system" ] && "$@" >/dev/null 2>&1; } || missing="$missing $package"
}
want() { # want GROUP PACKAGE COMMAND...
    row="$1 $2"
    shift 2
    { [ -z "$system" ] && "$@" >/dev/null 2>&1; } || wanted="$wanted$row
"
}
packages_of() { # packages_of [GROUP]
    printf '%s' "$wanted" | awk -v group="${1:-}" 'group == "" || $1 == group { printf " %s", $2 }'
}

have_lua() {
    for name in lua5.4 lua-5.4 lua54; do
        pkg-config --exists "$name" && return 0
    done
    pkg-config --exists 'lua >= 5.4' 'lua < 5.5'
}

have_ctags() {
    ctags --version 2>/dev/null | grep -q '^Universal Ctags'
}

have_mpi() {
    pkg-config --exists ompi-c || pkg-config --exists mpich
}

# Whether the window is wanted here; prints what it costs where nobody has asked for it.
want_gtk() {
    [ -z "$system" ] && pkg-config --exists gtk4 && return 0
    [ "$window" != --window ] || return 0
    [ "$window" != --no-window ] && [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ] || return 1
    plan=$(apt-get install --assume-no --no-install-recommends libgtk-4-dev 2>/dev/null)
    count=$(echo "$plan" | sed -n 's/.*upgraded, \([0-9]*\) newly installed.*/\1/p')
    [ "${count:-100}" -lt 100 ] || return 1
    echo "GTK 4: $count packages, $(echo "$plan" | sed -n 's/^After this operation, \(.*\) of additional.*/\1/p')" >&2
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
if [ "$mode" != --minimal ]; then
    gtk=""
    want_gtk && gtk=yes && want window libgtk-4-dev pkg-config --exists gtk4
    want libraries libjpeg-dev pkg-config --exists libjpeg
    want libraries libjansson-dev pkg-config --exists jansson
    want libraries libfreetype-dev pkg-config --exists freetype2
    want libraries libopenexr-dev pkg-config --exists OpenEXR
    want libraries libwebp-dev pkg-config --exists libwebpmux
fi
if [ "$mode" = --tests ]; then
    want compiler clang command -v clang
    want compiler llvm command -v llvm-link
    if [ -n "$gtk" ]; then
        want window xvfb command -v xvfb-run
        want window xauth command -v xauth
        want window xdotool command -v xdotool
        want window openbox command -v openbox
        want window weston command -v weston
        want window dbus command -v dbus-run-session
        want window at-spi2-core test -e /usr/libexec/at-spi-bus-launcher
        want window python3-pyatspi /usr/bin/python3 -c 'import pyatspi'
        want window gir1.2-gtk-4.0 /usr/bin/python3 -c "import gi; gi.require_version('Gtk', '4.0')"
    fi
    want machines libopenmpi-dev have_mpi
    want machines openmpi-bin command -v mpirun
    want animations ffmpeg command -v ffmpeg
    want animations apngdis command -v apngdis
    want shells zsh command -v zsh
    want shells fish command -v fish
    want pages man-db command -v man
    want tools universal-ctags have_ctags
    want tools patch command -v patch
    want tools gzip command -v gzip
    want tools procps command -v pgrep
    want tools mount command -v mount
    want tools btrfs-progs command -v mkfs.btrfs
fi
optional=$(packages_of)

# Other systems' names of the packages, where one is not Debian's: Debian, Fedora, Arch, Alpine; -: none.
command_of() { # command_of SYSTEM PACKAGE...
    case $1 in fedora) command="dnf install" ;; arch) command="pacman -S --needed" ;; alpine) command="apk add" ;; esac
    printf 'sudo %s' "$command"
    column=$1
    shift
    printf '%s\n' "$@" | awk -v on="$column" '
        BEGIN { column = on == "fedora" ? 2 : on == "arch" ? 3 : 4 }
        NR == FNR { name[$1] = $column; next }
        { word = $1 in name ? name[$1] : $1; if (word != "-" && !seen[word]++) printf " %s", word }
        END { print "" }' /dev/fd/3 - 3<<'END'
libc6-dev glibc-devel glibc musl-dev
pkg-config pkgconf-pkg-config pkgconf pkgconf
liblua5.4-dev lua-devel lua lua5.4-dev
libpng-dev libpng-devel libpng libpng-dev
zlib1g-dev zlib-devel zlib zlib-dev
libjpeg-dev libjpeg-turbo-devel libjpeg-turbo libjpeg-turbo-dev
libjansson-dev jansson-devel jansson jansson-dev
libfreetype-dev freetype-devel freetype2 freetype-dev
libopenexr-dev openexr-devel openexr openexr-dev
libwebp-dev libwebp-devel libwebp libwebp-dev
libgtk-4-dev gtk4-devel gtk4 gtk4.0-dev
xvfb xorg-x11-server-Xvfb xorg-server-xvfb xvfb
xauth xorg-x11-xauth xorg-xauth xauth
dbus dbus-daemon dbus dbus
python3-pyatspi python3-pyatspi python-atspi py3-atspi
gir1.2-gtk-4.0 gtk4 gtk4 gtk4.0
libopenmpi-dev openmpi-devel openmpi openmpi-dev
openmpi-bin openmpi openmpi openmpi
apngdis - - -
universal-ctags ctags ctags ctags
procps procps-ng procps-ng procps-ng
mount util-linux util-linux util-linux
END
}
case $system in
"") ;;
# shellcheck disable=SC2086
fedora | arch | alpine) command_of "$system" $missing $optional; exit 0 ;;
*) echo "setup.sh: --for is fedora, arch or alpine" >&2; exit 2 ;;
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
    for pair in dnf:fedora pacman:arch apk:alpine; do
        command -v "${pair%:*}" >/dev/null 2>&1 || continue
        # shellcheck disable=SC2086
        echo "$what; to install them: $(command_of "${pair#*:}" $missing $optional)" >&2
        exit "${failure:-1}"
    done
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

said=$(mktemp) || exit 1
trap 'rm -f "$said"' EXIT
as_installer() {
    # shellcheck disable=SC2086
    $as_root env DEBIAN_FRONTEND=noninteractive "$@" </dev/null >"$said" 2>&1
}
install() { # install SECONDS OPTION... PACKAGE...
    seconds=$1
    shift
    as_installer timeout "$seconds" apt-get install -y --no-install-recommends "$@"
}

# The lists of a fresh machine may be absent or old: they are fetched when the first try fails.
if [ -n "$missing" ]; then
    echo "installing with apt-get (build):$missing" >&2
    # shellcheck disable=SC2086
    install 3600 $missing || { as_installer apt-get update && install 3600 $missing; } ||
        { cat "$said" >&2; echo "the packages could not be installed:$missing" >&2; exit 1; }
fi

# Optional packages never wait long for a network and never fail: a group together, and if that is not possible one by
# one.
quick="-o Acquire::Retries=0 -o Acquire::http::Timeout=10 -o Acquire::https::Timeout=10"
archive=unknown
install_optional() { # install_optional PACKAGE...
    [ $archive != silent ] || return 1
    # shellcheck disable=SC2086
    install 600 $quick "$@" && return 0
    if [ $archive = unknown ]; then
        # shellcheck disable=SC2086
        as_installer timeout 60 apt-get $quick -o APT::Update::Error-Mode=any update && archive=read || archive=silent
        # shellcheck disable=SC2086
        install 600 $quick "$@" && archive=read && return 0
        [ $archive = read ] || return 1
    fi
    for package in "$@"; do
        # shellcheck disable=SC2086
        install 240 $quick "$package" || echo "$package could not be installed: $without" >&2
    done
}
for group in $(printf '%s' "$wanted" | awk '!seen[$1]++ { print $1 }'); do
    echo "installing with apt-get ($group):$(packages_of "$group")" >&2
    # shellcheck disable=SC2046
    install_optional $(packages_of "$group") || { echo "the archive does not answer: $without" >&2; break; }
done
exit 0
