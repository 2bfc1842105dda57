#!/bin/sh
# Prints every identifier and every file of src, tests, bench, tools and lua that has a word of tools/names.list as a
# component (split at _), and every struct, union or enum with a name that is listed there as a tag; fails if there is
# any. tools/names.allow has the exceptions, each with its reason; an exception that is not needed is also a failure.
# Universal Ctags finds the identifiers: functions, variables, parameters, members, types, macros, enumerators and tests
# of C, functions and variables of Lua, shell and Python. Without it nothing is checked, and with GRAY_CI that fails.
# tools/names.sh --count: how many identifiers and files have each word.
cd "$(dirname "$0")/.." || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
folders="src tests bench tools lua"

if ! ctags --version 2>/dev/null | grep -q '^Universal Ctags'; then
    echo "names: not checked, there is no Universal Ctags (Debian: universal-ctags)" >&2
    [ -z "${GRAY_CI:-}" ]
    exit
fi
# Lines "NAME FILE KIND".
# shellcheck disable=SC2086
find $folders -name '*.c' -o -name '*.h' -o -name '*.cc' -o -name '*.lua' -o -name '*.sh' -o -name '*.py' | sort |
    ctags --options=NONE -x --_xformat='%N %F %K' --langmap=C:.c.h,C++:.cc --kinds-C=+lzp --kinds-C++=+lzp \
        --regex-C='/^TEST(_[A-Z]+)?\(([A-Za-z0-9_]+)/\2/k,test/' -L - >"$work/identifiers" 2>/dev/null || exit 1
# Files, by their names without the ending; data of tests is named after what it holds.
find src tests/unit tests/fuzz tests/*.[ch] bench tools lua -name '*.*' -type f ! -path 'tests/fuzz/*/*' |
    sed 's|^\(.*/\)\([^./]*\)\(\..*\)$|\2 \1\2\3 file|' >>"$work/identifiers"
[ "$(wc -l <"$work/identifiers")" -gt 10000 ] || { echo "names: found no identifiers" >&2; exit 1; }

awk '
FILENAME == "tools/names.list" {
    if ($1 == "part") bad[$2] = 1
    if ($1 == "tag") bad_tag[$2] = 1
    next
}
($0 in seen) { next }
{
    seen[$0] = 1
    n = split(tolower($1), part, /[^a-z0-9]+/)
    for (i = 1; i <= n; i++)
        if (part[i] in bad) print part[i], $1, $2, $3
    if ($1 in bad_tag && $3 ~ /^(struct|union|enum)$/ && $2 ~ /\.[ch]$/) print $1, $1, $2, $3
}' tools/names.list "$work/identifiers" | sort -u >"$work/found"

if [ "$1" = --count ]; then
    awk '{ print $1 }' "$work/found" | sort | uniq -c | sort -rn
    exit
fi

# A line of names.allow: WORD FILES IDENTIFIERS reason; patterns of the shell, * for any.
# shellcheck disable=SC2016
awk '
function pattern(glob) {
    gsub(/[.]/, "\\.", glob)
    gsub(/[*]/, ".*", glob)
    gsub(/,/, "|", glob)
    return "^(" glob ")$"
}
FILENAME == "tools/names.allow" {
    if ($0 ~ /^#/ || NF == 0) next
    if (NF < 4) { print FILENAME ":" FNR ": WORD FILES IDENTIFIERS reason"; next }
    count++
    allowed[count] = $1
    file[count] = pattern($2)
    identifier[count] = pattern($3)
    line[count] = FNR
    next
}
{
    ok = 0
    for (i = 1; i <= count; i++)
        if ($1 == allowed[i] && $3 ~ file[i] && $2 ~ identifier[i]) ok = used[i] = 1
    if (!ok) print $3 ": " $2 " (" $4 "): the word " $1
}
END {
    for (i = 1; i <= count; i++)
        if (!used[i]) print "tools/names.allow:" line[i] ": allows nothing that exists"
}' tools/names.allow "$work/found" >"$work/bad"
if [ -s "$work/bad" ]; then
    cat "$work/bad"
    echo "names: $(wc -l <"$work/bad") lines; docs/design/glossary.md has the words of the field" >&2
    exit 1
fi
echo "names: no identifier and no file has a word of tools/names.list"
