#!/bin/sh
# Prints every include that violates the order of modules (docs/design/architecture.md), every cycle of headers that
# include one another, and every use of files or memory outside the module that owns them; fails if there is any.
cd "$(dirname "$0")/.." || exit 1
modules=$(sed -n 's/^MODULES = //p' Makefile) # in their order
bad=$(mktemp) || exit 1
trap 'rm -f "$bad"' EXIT

# Includes, and calls by name with comments and strings left out.
awk -v modules="$modules" '
BEGIN {
    count = split(modules, names, " ")
    for (i = 1; i <= count; i++)
        rank[names[i]] = i
    kinds = 4
    calls[1] = "malloc|calloc|realloc|free|posix_memalign|aligned_alloc|strdup|strndup|asprintf|alloca"
    owner[1] = "^src/base/mem[.]c$"
    rule[1] = "memory outside base/mem"
    calls[2] = "fopen|freopen|open|openat|creat|rename|renameat|unlink|mkdir|opendir|tmpfile|mkstemp"
    owner[2] = "^src/base/(file|file_output|system|path_policy|mem)[.]c$"
    rule[2] = "files outside base/file and base/path_policy"
    calls[3] = "mmap|munmap"
    owner[3] = "^src/base/(mem|file|system)[.]c$"
    rule[3] = "mappings outside base/"
    calls[4] = "sin|cos|tan|asin|acos|atan|atan2|exp|exp2|log|log2|log10|pow|cbrt|hypot|sincos|fma"
    owner[4] = "^src/script/sandbox[.]c$"
    rule[4] = "elementary functions come from math/elementary"
    for (i = 1; i <= kinds; i++)
        calls[i] = "(^|[^A-Za-z0-9_.>])(" calls[i] ")[ \t]*[(]"
}
FNR == 1 {
    split(FILENAME, path, "/")
    for (i = 1; i <= kinds; i++)
        applies[i] = FILENAME !~ owner[i]
}
/^[ \t]*#[ \t]*include[ \t]*"/ {
    split($0, quoted, "\"")
    where = FILENAME ":" FNR ":" $0
    if (quoted[2] !~ /\//) {
        print where ": an include names its module: \"" path[2] "/" quoted[2] "\""
        next
    }
    to = quoted[2]
    sub(/\/.*/, "", to)
    if (!(to in rank))
        print where ": no such module"
    else if (rank[to] > rank[path[2]])
        print where ": " path[2] " must not use " to
    next
}
/[(]/ && !/^[ \t]*([*]|\/[*])/ {
    line = $0
    sub(/\/\/.*$/, "", line)
    gsub(/\/[*][^*]*[*]\//, "", line)
    gsub(/"([^"\\]|\\.)*"/, "", line)
    for (i = 1; i <= kinds; i++)
        if (applies[i] && line ~ calls[i])
            print FILENAME ":" FNR ":" line "   <- " rule[i]
}' src/*/*.c src/*/*.h >"$bad" || echo "layers: awk failed" >>"$bad"

# Headers in an order in which each precedes those that it includes; tsort prints the cycles.
grep -HE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' src/*/*.h 2>/dev/null |
    sed -E 's|^src/([^:]*):[^"]*"([^"]*)".*|\1 \2|' | tsort 2>&1 >/dev/null | grep -v 'contains a loop' |
    sed 's|^tsort: \(.*\)|src/\1: includes itself by way of the other headers named here|' >>"$bad"

if [ -s "$bad" ]; then
    cat "$bad"
    echo "layers: $(wc -l <"$bad") lines against the order of modules" >&2
    exit 1
fi
echo "layers: every include points the right way; memory, files and elementary functions stay in their modules"
