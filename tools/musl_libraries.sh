#!/bin/sh
# Compiles Lua, zlib and libpng for the C library musl, from Debian's source packages, for `make musl`.
# Usage: tools/musl_libraries.sh [FOLDER]    (build/musl-libraries); needs musl-tools and the archive
mkdir -p "${1:-build/musl-libraries}" && cd "${1:-build/musl-libraries}" || exit 1
prefix=$PWD
mkdir -p lists lib/pkgconfig include
# The sources of the archive that this machine uses.
apt-cache policy | awk '$2 ~ /^http/ && $3 !~ /-security\// { split($3, suite, "/"); print "deb-src", $2, suite[1], suite[2] }' | sort -u >sources.list
apt() {
    apt-get -q -o Dir::Etc::SourceList="$prefix/sources.list" -o Dir::Etc::SourceParts=- \
        -o Dir::State::Lists="$prefix/lists" -o APT::Sandbox::User=root "$@" || exit 1
}
{ apt update && apt source --download-only lua5.4 zlib libpng1.6; } >&2
for archive in *.orig.tar.*; do tar -xf "$archive" || exit 1; done
export CC=musl-gcc
(cd zlib-*/ && ./configure --static --prefix="$prefix" && make install) >&2 || exit 1
(cd libpng-*/ && ./configure --host=x86_64-linux-musl --disable-shared --prefix="$prefix" CPPFLAGS="-I$prefix/include" \
    LDFLAGS="-L$prefix/lib" && make install) >&2 || exit 1
(cd lua-*/src && rm -f lua.c luac.c && musl-gcc -O2 -std=gnu99 -DLUA_COMPAT_5_3 -DLUA_USE_POSIX -c ./*.c &&
    ar rcs "$prefix/lib/liblua.a" ./*.o && cp lua.h luaconf.h lualib.h lauxlib.h "$prefix/include") >&2 || exit 1
cat >lib/pkgconfig/lua5.4.pc <<END
Name: Lua
Description: Lua
Version: 5.4
Cflags: -I$prefix/include
Libs: -L$prefix/lib -llua -lm
END
