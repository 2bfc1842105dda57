#!/bin/sh
# Prints every identifier of the C code, and every file, that has a word of tools/names.list as a component (split at _),
# or is a struct, union or enum of a name listed there as a tag; fails when there is any. tools/names.allow has the
# exceptions, each with its reason; names of tests are sentences and not looked at. Needs awk alone.
# tools/names.sh --count: how many identifiers and files have each word.
cd "$(dirname "$0")/.." || exit 1
found=$(mktemp) || exit 1
trap 'rm -f "$found"' EXIT

# shellcheck disable=SC2016
find src tests bench -name '*.[ch]' | sort | xargs awk '
BEGIN {
    while ((getline line <"tools/names.list") > 0) {
        n = split(line, field, " ")
        if (n >= 2 && field[1] == "part") bad[field[2]] = 1
        if (n >= 2 && field[1] == "tag") bad_tag[field[2]] = 1
    }
}
FNR == 1 {
    comment = 0
    tag = 0
    name = FILENAME
    sub(/.*\//, "", name)
    sub(/\.[ch]$/, "", name)
    look(name, "file")
}
function look(word, kind, low, n, i, part) {
    low = tolower(word)
    n = split(low, part, "_")
    for (i = 1; i <= n; i++)
        if (part[i] in bad && !((FILENAME, word) in seen)) {
            seen[FILENAME, word] = 1
            print part[i], word, FILENAME, kind
        }
}
{
    line = $0
    if (comment) {
        if (!match(line, /\*\//)) next
        line = substr(line, RSTART + 2)
        comment = 0
    }
    if (line ~ /^[ \t]*#[ \t]*include/) next
    if (line ~ /["\/\047]/) {
        gsub(/\\./, "", line)
        # Takes whichever begins first: a string, a character constant or a comment.
        out = ""
        while (match(line, /"[^"]*"|\047[^\047]*\047|\/\*|\/\//)) {
            token = substr(line, RSTART, 2)
            out = out substr(line, 1, RSTART - 1) " "
            rest = substr(line, RSTART + RLENGTH)
            if (token == "//") { line = ""; break }
            if (token == "/*") {
                at = index(rest, "*/")
                if (at == 0) { comment = 1; line = ""; break }
                rest = substr(rest, at + 2)
            }
            line = rest
        }
        line = out line
    }
    n = split(line, word, /[^A-Za-z0-9_]+/)
    for (i = 1; i <= n; i++) {
        if (word[i] ~ /^[A-Za-z_]/ && test) {
            test = 0
        } else if (word[i] ~ /^[A-Za-z_]/) {
            look(word[i], "identifier")
            test = word[i] ~ /^TEST(_[A-Z]+)?$/
            if (tag && word[i] in bad_tag && !((FILENAME, "tag " word[i]) in seen)) {
                seen[FILENAME, "tag " word[i]] = 1
                print word[i], word[i], FILENAME, "struct"
            }
        }
        if (word[i] != "")
            tag = word[i] ~ /^(struct|union|enum)$/
    }
}' >"$found" || exit 1

if [ "$1" = --count ]; then
    awk '{ print $1 }' "$found" | sort | uniq -c | sort -rn
    exit
fi

# A line of names.allow: WORD FILES IDENTIFIERS reason; patterns of the shell, * for any.
# shellcheck disable=SC2016
awk '
function pattern(glob) {
    gsub(/[.]/, "\\.", glob)
    gsub(/[*]/, ".*", glob)
    return "^(" glob ")$"
}
FILENAME == "tools/names.allow" {
    if ($0 ~ /^#/ || NF == 0) next
    if (NF < 4) { print FILENAME ":" FNR ": WORD FILES IDENTIFIERS reason"; next }
    count++
    allowed[count] = $1
    file[count] = pattern($2)
    gsub(/,/, "|", file[count])
    identifier[count] = pattern($3)
    gsub(/,/, "|", identifier[count])
    line[count] = FNR
    next
}
{
    for (i = 1; i <= count; i++)
        if ($1 == allowed[i] && $3 ~ file[i] && $2 ~ identifier[i]) { used[i] = 1; next }
    print $3 ": " $2 " (" $4 "): the word " $1
}
END {
    for (i = 1; i <= count; i++)
        if (!used[i]) print "names: tools/names.allow:" line[i] " allows nothing that exists" >"/dev/stderr"
}' tools/names.allow "$found" >"$found.bad"
if [ -s "$found.bad" ]; then
    cat "$found.bad"
    echo "names: $(wc -l <"$found.bad") lines; docs/glossary.md has the words of the field" >&2
    rm -f "$found.bad"
    exit 1
fi
rm -f "$found.bad"
echo "names: no identifier and no file has a word of tools/names.list"
