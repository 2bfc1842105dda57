#!/bin/sh
# Prints everything that the pieces of a path (src/render/path_pieces_internal.h) must not reach by any chain of calls: an
# allocator, a call through a pointer, and a function that calls itself. Fails if there is anything. What is below the
# search of the nearest and of any surface is left out. gcc writes the calls of each file (-fcallgraph-info).
#   tools/pieces.sh [FOLDER]    objects and calls go to FOLDER (build/pieces)
cd "$(dirname "$0")/.." || exit 1
folder=${1:-build/pieces}
modules=$(sed -n 's/^MODULES = //p' Makefile)
gcc --version >/dev/null 2>&1 || { echo "pieces: gcc is not installed: left out"; exit 0; }

# The modules that a path reaches: all up to render. Without optimisation no call is lost.
objects=
for module in $modules; do
    for file in src/"$module"/*.c; do
        objects="$objects $folder/${file%.c}.o"
    done
    [ "$module" != render ] || break
done
# shellcheck disable=SC2086
CCACHE_DISABLE=1 make -s -j"$(nproc 2>/dev/null || echo 2)" CC=gcc config=debug BUILD="$folder" CFLAGS=-fcallgraph-info $objects || exit 1

find "$folder" -name '*.ci' -exec cat {} + | awk '
function visit(name, chain, i, n, to, short) {
    state[name] = 1
    functions++
    n = calls[name]
    for (i = 1; i <= n; i++) {
        to = call[name, i]
        short = to
        sub(/.*:/, "", short)
        if (short in below)
            continue
        if (to == "__indirect_call")
            report("a call through a pointer", name, chain, at[name, i])
        else if (to in allocators)
            report("calls " to, name, chain, at[name, i])
        else if (!(to in state))
            visit(to, short " < " chain)
        else if (state[to] == 1)
            report(short " calls itself", name, chain, at[name, i])
    }
    state[name] = 2
}
function report(what, name, chain, where) {
    print where ": " what ": " chain
    bad++
}
BEGIN {
    split("world_nearest_crossing world_nearest_surface world_nearest world_any world_ask_nearest world_ask_any", words, " ")
    for (i in words)
        below[words[i]]
    split("malloc calloc realloc free mem_alloc mem_alloc_zero mem_alloc_aligned mem_resize mem_resize_array mem_resize_known mem_free arena_alloc arena_alloc_array", words, " ")
    for (i in words)
        allocators[words[i]]
}
/^edge: / {
    split($0, part, "\"")
    from = part[2]
    if (!((from, part[4]) in known)) {
        known[from, part[4]]
        call[from, ++calls[from]] = part[4]
        at[from, calls[from]] = part[6]
    }
}
END {
    pieces = split("begin extend shade shadow", root, " ")
    for (i = 1; i <= pieces; i++) {
        name = "src/render/path_trace.c:" root[i]
        if (!(name in calls)) {
            print "pieces: there is no " name
            bad++
        } else if (!(name in state)) {
            visit(name, root[i])
        }
    }
    if (bad)
        exit 1
    print "pieces: " functions " functions below begin, extend, shade and shadow: no allocator, no call through a pointer, no recursion"
}'
