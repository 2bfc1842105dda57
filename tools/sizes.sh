#!/bin/sh
# Prints every file and function of src with a wrong size, and every header with a wrong name; fails if there is any.
#   - A .c file has at most 900 lines.
#   - A function has at most six parameters; more belong in a struct. Nine of ten functions have at most 27 lines.
#   - If no other module includes a header, directly or through another header, its name ends in _internal.h. No other
#     module includes a header with such a name; tests may. The rule does not apply to the last module.
#   - Every function that a header declares is defined in the .c of its name: those of x.h and x_internal.h in x.c.
#     (Functions that a macro defines, as for each instruction set, are not looked for.) At most 8 headers break it.
# tools/sizes.allow has the exceptions, each with its reason; one that is not needed is also a failure.
# tools/sizes.sh --count: the median and the 90th percentile of lines of files and of functions.
cd "$(dirname "$0")/.." || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

# Functions: "parameters lines name file". Definitions begin in the first column and end with a } there.
# shellcheck disable=SC2016
awk '
FNR == 1 { head = ""; open = 0 }
open {
    lines++
    if ($0 ~ /^}/) { print parameters, lines, name, FILENAME; open = 0 }
    next
}
/^[A-Za-z_]/ && head == "" { head = $0; lines = 1; if (head ~ /[;}]$/ || head ~ /^(enum|struct|union|typedef|#)[^(]*$/) head = ""; else check(); next }
head != "" { head = head " " $0; lines++; check(); next }
function check(rest, depth, i, c, found) {
    if (head ~ /;$/) { head = ""; return }
    if (head !~ /\{$/) return
    rest = head
    sub(/^(static |inline |_Noreturn )*/, "", rest)
    gsub(/__attribute__\(\([^()]*(\([^()]*\))?\)\)/, "", rest)
    i = index(rest, "(")
    if (i == 0 || substr(rest, 1, i) ~ /=/) { head = ""; return }
    name = substr(rest, 1, i - 1)
    sub(/.*[ *]/, "", name)
    rest = substr(rest, i + 1)
    depth = 1
    parameters = 1
    found = ""
    for (i = 1; depth > 0 && i <= length(rest); i++) {
        c = substr(rest, i, 1)
        if (c == "(") depth++
        if (c == ")") depth--
        if (c == "," && depth == 1) parameters++
        if (depth > 0) found = found c
    }
    if (found == "void" || found == "") parameters = 0
    head = ""
    open = 1
}' src/*/*.[ch] >"$work/functions"
wc -l src/*/*.c | awk '$2 != "total" { print $1, $2 }' | sort -n >"$work/files"

if [ "$1" = --count ]; then
    percentiles() {
        sort -n | awk -v what="$1" '{ x[NR] = $1 } END {
            printf "%s: %d, median %d, 90th percentile %d, most %d lines\n", what, NR, x[int((NR + 1) / 2)], x[int(0.9 * NR + 0.5)], x[NR] }'
    }
    awk '{ print $1 }' "$work/files" | percentiles "files"
    awk '{ print $2 }' "$work/functions" | percentiles "functions"
    awk '{ n[$1 > 6 ? 7 : $1]++ } END { printf "functions of more than six parameters: %d\n", n[7] }' "$work/functions"
    awk '$1 > 900 { many++ } END { printf "files above 900 lines: %d\n", many }' "$work/files"
    exit
fi

{
    awk '$1 > 900 { print $2 ": " $1 " lines: split it by subject" }' "$work/files"
    awk '{ print $2 }' "$work/functions" | sort -n | awk '{ x[NR] = $1 } END {
        if (x[int(0.9 * NR + 0.5)] > 27) print "src: the 90th percentile of functions is " x[int(0.9 * NR + 0.5)] " lines: at most 27" }'
    sort -u "$work/functions" | awk '$1 > 6 { print $4 ": " $3 " has " $1 " parameters: at most six, or a struct" }'
    last=$(sed -n 's/^MODULES = .* //p' Makefile)
    grep -HE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' src/*/*.[ch] |
        sed -E 's|^src/([^:]*):[^"]*"([^"]*)".*|\1 \2|' | awk -v last="$last" '
        function module(path) { return substr(path, 1, index(path, "/") - 1) }
        { from[NR] = $1; to[NR] = $2; if (module($1) != module($2)) seen[$2] = 1 }
        module($1) != module($2) && $2 ~ /_internal\.h$/ { print "src/" $1 ": includes " $2 ", which is private to its module" }
        END {
            do {
                more = 0
                for (i = 1; i <= NR; i++)
                    if (from[i] ~ /\.h$/ && from[i] in seen && !(to[i] in seen)) { seen[to[i]] = 1; more = 1 }
            } while (more)
            while (("ls src/*/*.h" | getline path) > 0) {
                path = substr(path, 5)
                if (!(path in seen) && module(path) != last && path !~ /_internal\.h$/)
                    print "src/" path ": no other module sees it, so its name ends in _internal.h"
            }
        }'
    # Declarations of functions begin in the first column of a header: "name header".
    awk '
    FNR == 1 { head = "" }
    head == "" && /^[a-z_]/ && !/^(static|typedef|enum [a-z_]* *\{|struct [a-z_]* *\{|union [a-z_]* *\{)/ { head = $0 }
    head != "" && FNR > 1 && $0 != head && !/^[a-z_]/ { head = head " " $0 }
    head ~ /[;{]/ {
        sub(/;.*/, ";", head)
        if (head ~ /^[^={]*\(.*\);$/) { sub(/\(.*/, "", head); sub(/.*[ *]/, "", head); print head, FILENAME }
        head = ""
    }' src/*/*.h >"$work/declared"
    awk '
    FILENAME ~ /functions$/ { if ($4 ~ /\.c$/) where[$3] = where[$3] " " $4; next }
    {
        stem = $2
        sub(/(_internal)?\.h$/, "", stem)
        if (where[$1] != "" && !index(where[$1] " ", " " stem ".c ")) elsewhere[$2] = elsewhere[$2] " " $1
    }
    END { for (header in elsewhere) print header ": not defined in the .c of its name:" elsewhere[header] }' \
        "$work/functions" "$work/declared"
    awk '/^src\/.*\.h / { if (++headers > 8) print "tools/sizes.allow: more than 8 headers" }' tools/sizes.allow
} | sort -u >"$work/bad"
# A line of tools/sizes.allow: the file, or the function; then the reason.
sed -n 's/^\([^# ][^ ]*\) .*/\1/p' tools/sizes.allow >"$work/allow"
awk 'NR == FNR { allow[$1] = 1; next }
    { file = $1; sub(/:$/, "", file); if (file in allow) used[file] = 1; else if ($2 in allow) used[$2] = 1; else print }
    END { for (name in allow) if (!(name in used)) print "tools/sizes.allow: " name ": allows nothing that exists" }' \
    "$work/allow" "$work/bad" >"$work/left"
if [ -s "$work/left" ]; then
    cat "$work/left"
    echo "sizes: $(wc -l <"$work/left") files, functions or headers out of measure" >&2
    exit 1
fi
echo "sizes: files have at most 900 lines, functions six parameters, nine of ten at most 27 lines; headers declare what the .c of their name defines"
