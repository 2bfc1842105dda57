#!/bin/sh
# Prints every include that points against the order of modules (docs/architecture.md), every cycle of headers that
# include one another, and every use of files or memory outside the module that owns them; fails if there is any.
cd "$(dirname "$0")/.." || exit 1
modules=$(sed -n 's/^MODULES = //p' Makefile) # in their order
bad=$(mktemp) || exit 1
trap 'rm -f "$bad"' EXIT

rank() {
    n=0
    for module in $modules; do
        n=$((n + 1))
        [ "$module" = "$1" ] && { echo $n; return; }
    done
    echo 0
}

grep -nE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' src/*/*.c src/*/*.h 2>/dev/null | while IFS= read -r line; do
    file=${line%%:*}
    include=$(printf '%s\n' "$line" | sed 's/^[^"]*"\([^"]*\)".*/\1/')
    from=$(printf '%s\n' "$file" | cut -d/ -f2)
    case $include in
    */*) to=${include%%/*} ;;
    *) echo "$line: an include names its module: \"$from/$include\"" >>"$bad"; continue ;;
    esac
    from_rank=$(rank "$from")
    to_rank=$(rank "$to")
    if [ "$to_rank" -eq 0 ]; then
        echo "$line: no such module" >>"$bad"
    elif [ "$to_rank" -gt "$from_rank" ]; then
        echo "$line: $from must not use $to" >>"$bad"
    fi
done

# Headers in an order in which each precedes those that it includes; tsort prints the cycles.
grep -HE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' src/*/*.h 2>/dev/null |
    sed -E 's|^src/([^:]*):[^"]*"([^"]*)".*|\1 \2|' | tsort 2>&1 >/dev/null | grep -v 'contains a loop' |
    sed 's|^tsort: \(.*\)|src/\1: includes itself by way of the other headers named here|' >>"$bad"

# Calls by name, comments and strings aside.
calls() {
    pattern=$1
    shift
    sed_script='s://.*$::; s:/\*[^*]*\*/::g; s:"([^"\\]|\\.)*":"":g; /^[[:space:]]*(\*|\/\*)/d'
    for file in "$@"; do
        sed -E "$sed_script" "$file" | grep -nE "(^|[^A-Za-z0-9_.>])($pattern)[[:space:]]*\(" | sed "s|^|$file:|"
    done
}
sources=$(ls src/*/*.c src/*/*.h 2>/dev/null)
# shellcheck disable=SC2086
{
    calls 'malloc|calloc|realloc|free|posix_memalign|aligned_alloc|strdup|strndup|asprintf|alloca' \
        $(printf '%s\n' $sources | grep -v '^src/base/mem\.c$') | sed 's/$/   <- memory outside base\/mem/'
    calls 'fopen|freopen|open|openat|creat|rename|renameat|unlink|mkdir|opendir|tmpfile|mkstemp' \
        $(printf '%s\n' $sources | grep -vE '^src/base/(file|file_output|system|path_policy|mem)\.c$') | sed 's/$/   <- files outside base\/file and base\/path_policy/'
    calls 'mmap|munmap' $(printf '%s\n' $sources | grep -vE '^src/base/(mem|file|system)\.c$') | sed 's/$/   <- mappings outside base/'
    calls 'sin|cos|tan|asin|acos|atan|atan2|exp|exp2|log|log2|log10|pow|cbrt|hypot|sincos|fma' \
        $(printf '%s\n' $sources | grep -vE '^src/script/sandbox\.c$') |
        sed 's/$/   <- elementary functions come from math\/elementary/'
} >>"$bad"

if [ -s "$bad" ]; then
    cat "$bad"
    echo "layers: $(wc -l <"$bad") lines against the order of modules" >&2
    exit 1
fi
echo "layers: every include points the right way; memory, files and elementary functions stay in their modules"
