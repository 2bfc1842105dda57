#!/bin/sh
# Renames files and identifiers in the whole tree by maps, and changes nothing else; with --commit it also makes the
# commit.
#   tools/rename.sh [-f] MAP...                              changes the working tree
#   tools/rename.sh --commit "area: Sentence" MAP...         the tree is clean except for the maps
# A commit that renames contains only the changes of this script and its map, and a line "Renames: MAP" at the end of
# its message: tools/carry.sh then carries branches over it. The same map on the same tree gives the same bytes; a
# second run changes nothing.
# -f accepts new names that already exist. RENAME_LIST=1 lists every identifier.
#
# Lines of a map (tools/renames/NN-subject.map); @GLOB,GLOB behind the first word limits a line to these paths:
#   file OLD NEW          moves a file or a folder; includes, guards and mentions of it follow
#   fold OLD NEW [first]  puts a C file (or a header) at the end of another, first: at its beginning; includes merge, and the
#                         comment that it opened with heads its part
#   word OLD NEW [merge]  an identifier; one * stands for the rest of it: word reach_* path_policy_*
#   tag OLD NEW [merge]   the same, only behind struct, enum or union
#   part OLD NEW [merge]  a component of identifiers between underscores, except in names of tests; capitals stay
#   capitals keep NAME             an identifier (or pattern) that the lines above leave alone
#   comment OLD NEW       a word in comments of C code
#   text "OLD" "NEW"      any text, strings included
# Identifiers are renamed in C code, not in strings; in comments and documents where they have an underscore, a
# parenthesis behind or struct before them. NEW must not exist yet where the line changes something (without a GLOB:
# anywhere), unless it says merge.
here=$(cd "$(dirname "$0")" && pwd) || exit 1
cd "$(git rev-parse --show-toplevel)" || exit 1
if [ "$1" != --commit ]; then
    [ $# -gt 0 ] || { sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$0" >&2; exit 2; }
    exec python3 "$here/rename.py" "$@"
fi
subject=$2
shift 2
[ -n "$subject" ] && [ $# -gt 0 ] || { echo "tools/rename.sh --commit SUBJECT MAP..." >&2; exit 2; }
for map in "$@"; do
    [ -f "$map" ] || { echo "$map: no such map" >&2; exit 2; }
    git add -- "$map"
    trailers="${trailers}Renames: $map
"
done
other=$(git status --porcelain | grep -v '^A  tools/renames/')
[ -z "$other" ] || { echo "the tree has other changes:" >&2; echo "$other" >&2; git reset -q -- "$@"; exit 1; }
python3 "$here/rename.py" "$@" || { git reset -q -- "$@"; exit 1; }
git add -A && printf '%s\n\n%s' "$subject" "$trailers" | git commit -q -F - && git show --stat --format='%h %s' HEAD | tail -1
