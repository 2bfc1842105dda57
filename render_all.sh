#!/bin/sh
# Installs what is missing, builds, renders every demo and writes gallery/index.html, screenshot01.png and screenshot02.png.
# Continues after a failure; at the end it lists the failures and exits with 1.
# A scene describes itself in comments of its first lines:
#   -- TITLE: its name in the gallery           -- OPTIONS: words for the command line
cd "$(dirname "$0")" || exit 1
gallery=gallery
limit=${GRAY_SCENE_LIMIT:-300} # seconds for one scene
failed=""

tools/setup.sh || exit 1
make -s -j2 || { echo "render_all.sh: the build failed" >&2; exit 1; }
mkdir -p "$gallery" || exit 1
rm -f "$gallery"/*.png "$gallery"/*.txt "$gallery"/index.html

# The rest of the first comment line that begins with the word.
about() { # about SCRIPT WORD
    head -n 20 "$1" | sed -n "s/^-- *$2: *//p" | head -n 1
}

as_html() {
    sed -e 's/&/\&amp;/g' -e 's/</\&lt;/g' -e 's/>/\&gt;/g' -e 's/"/\&quot;/g'
}

# Renders a scene into gallery/NAME-01.png ...; a single picture is called gallery/NAME.png.
render() { # render SCRIPT NAME
    script=$1
    name=$2
    options=$(about "$script" OPTIONS)
    case $name in
    10demo | 14demo) options="$options --size 1280x960 -ss 4 -al-samples 8" ;;
    esac
    echo "$script $options"
    begun=$(date +%s%N)
    # shellcheck disable=SC2086
    timeout "$limit" ./gray $options -o "$gallery/$name-%02d.png" -- "$script" >"$gallery/$name.txt"
    status=$?
    ended=$(date +%s%N)
    seconds=$(awk "BEGIN { printf \"%.1f\", ($ended - $begun) / 1e9 }")
    if [ $status -ne 0 ]; then
        echo "render_all.sh: $script failed with status $status" >&2
        failed="$failed $script"
    fi
    set -- "$gallery/$name"-[0-9]*.png
    [ $# -eq 1 ] && [ -f "$1" ] && mv -- "$1" "$gallery/$name.png"
    [ -s "$gallery/$name.txt" ] || rm -f "$gallery/$name.txt"
    echo "   $seconds s"
}

# One entry of the page: pictures, title, script, time, and what the script printed.
describe() { # describe SCRIPT NAME SECONDS
    title=$(about "$1" TITLE)
    title=$(printf '%s' "${title:-$2}" | as_html)
    echo "<figure>"
    shown=no
    for picture in "$gallery/$2.png" "$gallery/$2"-[0-9]*.png "$gallery"/?*"$2"-[0-9]*.png; do
        [ -f "$picture" ] || continue
        shown=yes
        file=$(basename "$picture" | as_html)
        echo "<a href=\"$file\"><img src=\"$file\" alt=\"$title\" loading=\"lazy\"></a>"
    done
    [ $shown = yes ] || echo "<p class=\"none\">no picture</p>"
    echo "<figcaption><b>$title</b><br><a href=\"../$1\">$1</a>, $3 s</figcaption>"
    if [ -s "$gallery/$2.txt" ]; then
        echo "<pre>"
        head -c 4000 "$gallery/$2.txt" | as_html
        echo "</pre>"
    fi
    echo "</figure>"
}

section() { # section TITLE CLASS SCRIPT...
    heading=$1
    class=$2
    shift 2
    echo "<h2>$heading</h2><div class=\"$class\">" >>"$gallery/body.html"
    for script in "$@"; do
        [ -f "$script" ] || continue
        case $script in */make_*) continue ;; esac # writes models, is not a scene
        base=$(basename "$script" .lua)
        [ "$class" = small ] && base="classic-$base"
        render "$script" "$base"
        describe "$script" "$base" "$seconds" >>"$gallery/body.html"
    done
    echo "</div>" >>"$gallery/body.html"
}

: >"$gallery/body.html"
section "Demos" large data/*demo.lua data/pyramid-fog.lua data/light.lua data/relief.lua
section "Path tracing" large data/path/*.lua
section "Solids" large data/solids.lua data/swept.lua data/csg/*.lua data/functions/*.lua data/meshes.lua
section "The Lua library" large data/library/show_*.lua
section "Classic scenes" small data/classic/*.lua

{
    cat <<'HEAD'
<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>gray: gallery</title>
<meta name="viewport" content="width=device-width">
<style>
body { font: 16px/1.4 sans-serif; margin: 2em auto; max-width: 84em; padding: 0 1em; background: #222; color: #ddd }
a { color: #9cf }
.large, .small { display: flex; flex-wrap: wrap; gap: 1.5em }
figure { margin: 0; max-width: 100% }
.large figure { width: 26em }
.small figure { width: 12em }
figure img { max-width: 100%; display: block; margin-bottom: .3em }
pre { white-space: pre-wrap; font-size: 12px }
.none { color: #f88 }
</style></head><body>
<h1>gray: gallery</h1>
HEAD
    cat "$gallery/body.html"
    echo "</body></html>"
} >"$gallery/index.html"
rm -f "$gallery/body.html"

number=1
for name in 10demo 14demo; do
    if [ -f "$gallery/$name.png" ]; then
        cp "$gallery/$name.png" "screenshot0$number.png"
    else
        failed="$failed screenshot0$number.png"
    fi
    number=$((number + 1))
done

if [ -n "$failed" ]; then
    echo "render_all.sh: failed:$failed" >&2
    exit 1
fi
echo "done: $gallery/index.html, screenshot01.png, screenshot02.png"
