#!/bin/sh
# Renders every scene of the repository in a small size, in several variants, and compares the files with recorded hashes:
# the check for a change that must not change pictures.
#   tools/picture_hashes.sh check [DIR]    renders into DIR (build/pictures), lists differences; status 1 if there are any
#   tools/picture_hashes.sh record [DIR]   renders, and writes the hashes to tests/picture_hashes.txt
# WAYS="default j1 bvh base tiny" selects variants; ONLY="word ..." selects scenes whose path contains one of the words,
# EXCEPT="word ..." leaves out those.
# RESUME=1 keeps the scenes that the program has rendered before. GRAY="PROGRAM" is another program, RUN="COMMAND" what
# runs it. The hashes are of pixels; gray compare shows by how many levels two pictures differ.
cd "$(dirname "$0")/.." || exit 1
action=${1:-check}
folder=${2:-build/pictures}
list=tests/picture_hashes.txt
variants=${WAYS:-default j1 bvh base tiny}
gray=$PWD/${GRAY:-gray}
case $action in check | record) ;; *) sed -n '2,9p' "$0" >&2; exit 2 ;; esac
[ -x "$gray" ] || { echo "picture_hashes.sh: there is no $gray; run make first" >&2; exit 2; }
mkdir -p "$folder/done" || exit 1
[ -n "${RESUME:-}" ] || rm -f "$folder"/*.* "$folder"/done/*
folder=$(cd "$folder" && pwd)
pixels=$folder/done/.pixels
# shellcheck disable=SC2046
${CC:-cc} -O1 tools/pixels.c $(pkg-config --cflags --libs libpng) -o "$pixels" || exit 1

options_of() {
    case $1 in
    default) echo "-j 2" ;;
    j1) echo "-j 1" ;;
    bvh) echo "-j 2 --accel bvh" ;;
    base | tiny) echo "-j 2 --isa base" ;;
    esac
}

wanted() { # wanted PATH
    for word in ${EXCEPT:-}; do
        case $1 in *"$word"*) return 1 ;; esac
    done
    [ -z "${ONLY:-}" ] && return 0
    for word in $ONLY; do
        case $1 in *"$word"*) return 0 ;; esac
    done
    return 1
}

# What a picture has whose script does not set the fields itself.
small='--default samples=2 --default area_samples=2'
first='--default samples=1 --default area_samples=1 --default full=yes --default deep=yes'

# Scenes read only their own files; their output is part of the list, too.
render() { # render NAME SCENE OPTION...
    name=$1
    scene=$2
    shift 2
    # shellcheck disable=SC2086
    ${RUN:-} "$gray" -q -D quick=true --allow-read . --script-time 600 "$@" -- "$scene" >"$folder/$name.txt" 2>&1 ||
        echo "status $?" >>"$folder/$name.txt"
    [ -s "$folder/$name.txt" ] || rm -f "$folder/$name.txt"
}

scenes=$(ls data/*.lua data/csg/*.lua data/functions/*.lua data/library/show_*.lua data/classic/*.lua docs/first.lua tests/pictures/*.lua 2>/dev/null |
    grep -vE '/(make_[^/]*|room|stage)\.lua$')
for scene in $scenes; do
    wanted "$scene" || continue
    base=$(echo "${scene%.lua}" | tr / -)
    [ "$folder/done/$base" -nt "$gray" ] && continue
    rm -f "$folder/$base".*
    # The options of the first lines, without those that set another size.
    options=$(head -n 20 "$scene" | sed -n 's/^-- *OPTIONS: *//p' | head -n 1)
    single=$(echo "$options" | sed 's/-ss [0-9]*//') # one sample in all
    for variant in $variants; do
        looks="--size 96x72 $small $options"
        [ "$variant" = tiny ] && looks="--size 32x24 $first $single"
        # shellcheck disable=SC2046,SC2086
        render "$base.$variant" "$scene" $looks $(options_of "$variant") -o "$folder/$base.$variant-%02d.png"
    done
    case " $variants " in *" default "*) ;; *) touch "$folder/done/$base"; continue ;; esac
    # shellcheck disable=SC2086
    case $scene in
    *0[2-9]demo.lua | *1[0-4]demo.lua | tests/pictures/*)
        render "$base.aov" "$scene" --size 64x48 $small $options -j 1 --isa avx2 --aov all -o "$folder/$base.aov-%02d.pfm"
        ;;
    esac
    # shellcheck disable=SC2086
    render "$base.pixel" "$scene" --size 96x72 --default area_samples=2 $options --isa avx2 --pixel 48,40 --pixel 20,60
    # shellcheck disable=SC2086
    render "$base.first" "$scene" --size 96x72 $first $single -o "$folder/$base.first-%02d.png"
    touch "$folder/done/$base"
done

(cd "$folder" && ls -d -- *.* | while read -r file; do
    case $file in
    *.png) "$pixels" "$file" | sha256sum | sed "s#-\$#$file#" ;;
    # Times that scripts print differ from run to run.
    *.txt) sed -E -e "s#$folder#DIR#g" -e 's/[0-9]+\.[0-9]+ s( of processor time)?$/TIME/' "$file" | sha256sum | sed "s#-\$#$file#" ;;
    *) sha256sum "$file" ;;
    esac
done) | sort -k 2 >"$folder/hashes"
if [ "$action" = record ]; then
    # Scenes that were not rendered keep their lines.
    [ -n "${ONLY:-}${WAYS:-}" ] && join -1 2 -2 2 -v 1 -o 1.1,1.2 "$list" "$folder/hashes" | sed 's/ /  /' >"$folder/kept"
    cat "$folder/hashes" "$folder/kept" 2>/dev/null | sort -k 2 >"$list.new"
    mv "$list.new" "$list"
    echo "$(wc -l <"$list") files recorded in $list"
    exit 0
fi
# Only rendered scenes count.
join -1 2 -2 2 -a 2 -e missing -o 0,1.1,2.1 "$list" "$folder/hashes" >"$folder/joined"
different=$(awk '$2 != $3 { print "   " $1 ($2 == "missing" ? " (not in the list)" : "") }' "$folder/joined")
count=$(wc -l <"$folder/joined")
if [ -z "${ONLY:-}${WAYS:-}" ]; then
    gone=$(join -1 2 -2 2 -v 1 "$list" "$folder/hashes" | sed 's/ .*//; s/^/   /; s/$/ (not made)/')
    different=$(printf '%s\n%s' "$different" "$gone" | sed '/^$/d')
fi
[ -z "$different" ] && { echo "$count files, all as recorded"; exit 0; }
echo "$different"
echo "$(echo "$different" | wc -l) of $count files differ"
exit 1
