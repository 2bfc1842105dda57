#!/bin/sh
# Prints every include that violates the order of modules (docs/design/architecture.md), every include by which session or
# output reach scene, world or script through any number of headers, every cycle of headers that include one another,
# every use of files or memory outside the module that owns them, and every module that has more than a tenth of the
# lines; fails if there is any. tools/layers.allow has the exceptions; one that is not needed is also a failure.
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
    kinds = 5
    calls[1] = "malloc|calloc|realloc|free|posix_memalign|aligned_alloc|strdup|strndup|asprintf|alloca"
    owner[1] = "^src/base/mem[.]c$"
    rule[1] = "memory outside base/mem"
    calls[2] = "fopen|freopen|open|openat|creat|rename|renameat|unlink|mkdir|opendir|tmpfile|mkstemp"
    owner[2] = "^src/base/(fault|file|file_output|path_policy|process)[.]c$"
    rule[2] = "files outside base/file and base/path_policy"
    calls[3] = "mmap|munmap"
    owner[3] = "^src/base/(fault|file|mem|share)[.]c$"
    rule[3] = "mappings outside base/"
    calls[4] = "sin|cos|tan|asin|acos|atan|atan2|exp|exp2|log|log2|log10|pow|cbrt|hypot|sincos|fma"
    owner[4] = "^src/sandbox/libraries[.]c$"
    rule[4] = "elementary functions come from math/elementary"
    calls[5] = "fmin|fmax|fminf|fmaxf"
    owner[5] = "^$"
    rule[5] = "libraries differ about the sign of zero: math_min and math_max of math/portable.h"
    apart["session"] = apart["output"] = " scene world sandbox record call compat script "
    for (i = 1; i <= kinds; i++)
        calls[i] = "(^|[^A-Za-z0-9_.>])(" calls[i] ")[ \t]*[(]"
}
FNR == 1 {
    split(FILENAME, path, "/")
    for (i = 1; i <= kinds; i++)
        applies[i] = FILENAME !~ owner[i]
    if (path[2] in apart)
        start[++starts] = substr(FILENAME, 5)
}
FILENAME == "tools/layers.allow" {
    if (/^[^#]/)
        allowed[$1 == "include" ? $2 " " $3 : $2] = FNR
    next
}
{ lines[path[2]]++; total++ }
/^[ \t]*#[ \t]*include[ \t]*"/ {
    split($0, quoted, "\"")
    where = FILENAME ":" FNR ":" $0
    if (quoted[2] !~ /\//) {
        print where ": an include names its module: \"" path[2] "/" quoted[2] "\""
        next
    }
    from = substr(FILENAME, 5)
    included[from, ++includes[from]] = quoted[2]
    line_of[from, includes[from]] = where
    to = module(quoted[2])
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
}
function module(path) {
    return substr(path, 1, index(path, "/") - 1)
}
# Follows the includes of a file of session or output, as the compiler does; an include that is reported or allowed is
# not followed. The direct includes of all files keep the order of modules, so what they reach keeps it too.
function follow(file, apart_from,    seen, queue, first, last, k, at, next_one) {
    queue[last = 1] = file
    for (first = 1; first <= last; first++) {
        at = queue[first]
        for (k = 1; k <= includes[at]; k++) {
            next_one = included[at, k]
            if (index(apart_from, " " module(next_one) " ") == 0) {
                if (!(next_one in seen))
                    seen[queue[++last] = next_one] = 1
            } else if ((at " " next_one) in allowed)
                used[at " " next_one] = 1
            else if (!((at, k) in reported)) {
                reported[at, k] = 1
                print line_of[at, k] ": src/" file " must not reach " module(next_one)
            }
        }
    }
}
END {
    for (i = 1; i <= starts; i++)
        follow(start[i], apart[module(start[i])])
    for (i = 1; i <= count; i++)
        if (lines[names[i]] > total / 10) {
            if (names[i] in allowed)
                used[names[i]] = 1
            else
                print "src/" names[i] ": " lines[names[i]] " of " total " lines: at most a tenth"
        }
    for (exception in allowed)
        if (!(exception in used))
            print "tools/layers.allow:" allowed[exception] ": allows nothing that exists"
}' tools/layers.allow src/*/*.c src/*/*.h >"$bad" || echo "layers: awk failed" >>"$bad"

# Headers in an order in which each precedes those that it includes; tsort prints the cycles.
grep -HE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' src/*/*.h 2>/dev/null |
    sed -E 's|^src/([^:]*):[^"]*"([^"]*)".*|\1 \2|' | tsort 2>&1 >/dev/null | grep -v 'contains a loop' |
    sed 's|^tsort: \(.*\)|src/\1: includes itself by way of the other headers named here|' >>"$bad"

if [ -s "$bad" ]; then
    cat "$bad"
    echo "layers: $(wc -l <"$bad") lines against the order of modules" >&2
    exit 1
fi
echo "layers: every include points the right way, no module is too large; memory, files and elementary functions stay in their modules"
