#!/bin/sh
# Installs missing packages, builds, renders every demo and writes gallery/index.html, screenshot01.png and screenshot02.png.
# Continues after a failure; at the end it lists the failures and exits with 1. data/gallery.txt has the order of the
# scenes and their times, from which the time left is estimated.
# A scene describes itself in comments of its first lines:
#   -- TITLE: its name in the gallery           -- OPTIONS: words for the command line
# A scene that takes far longer than its part of the plan is ended; GRAY_SCENE_LIMIT sets another limit, in seconds.
# Usage: ./render_all.sh [--minimal]
#   --minimal   installs only the packages that the build needs
cd "$(dirname "$0")" || exit 1
case $#${1:-} in 0 | 1--minimal) ;; *) sed -n '2,9s/^# \{0,1\}//p' render_all.sh >&2; exit 2 ;; esac
gallery=gallery
failed=""

# The plan: lines "[title]" and "SCRIPT SECONDS". Scenes that data/gallery.txt does not name come before its last part.
plan() {
    unlisted=""
    for script in data/*demo.lua data/gallery/*.lua data/path/*.lua data/csg/*.lua data/functions/*.lua data/animation/*.lua data/teaching/*.lua \
        data/library/show_*.lua data/print/*.lua \
        data/classic/*.lua; do
        case $script in */make_*) continue ;; esac # writes models, is not a scene
        [ ! -f "$script" ] || grep -q "^$script " data/gallery.txt || unlisted="$unlisted$script 10
"
    done
    last=$(grep -n '^\[' data/gallery.txt | tail -n 1 | cut -d : -f 1)
    head -n $((last - 1)) data/gallery.txt | grep -v '^#'
    [ -z "$unlisted" ] || printf '[More]\n%s' "$unlisted"
    tail -n +"$last" data/gallery.txt
}

# "about 6 minutes", of seconds
about_time() {
    awk -v s="$1" 'BEGIN {
        if (s < 90) printf "about %d seconds", s < 1 ? 1 : s + 0.5
        else printf "about %d minutes", s / 60 + 0.5
    }'
}

# Seconds that a scene of this cost may take: thirty times its time on this machine, and five minutes.
limit_of() { # limit_of COST
    [ -z "${GRAY_SCENE_LIMIT:-}" ] || { echo "$GRAY_SCENE_LIMIT"; return; }
    awk "BEGIN { slow = $planned > 5 && $taken_all > $planned ? $taken_all / $planned : 1
                 printf \"%d\", 300 + 30 * slow * $1 / $processors }"
}

processors=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)
plan=$(plan)
scenes=$(echo "$plan" | grep -c '^data/')
total=$(echo "$plan" | awk -v n="$processors" '/^data/ { s += $2 / n + 0.1 } END { print s }')
building=""
[ -x build/release/gray ] || building=", plus the build"
echo "rendering $scenes scenes takes $(about_time "$total") with $processors processors$building"

tools/setup.sh "$@" --no-window || exit 1
make -s -j2 || { echo "render_all.sh: the build failed" >&2; exit 1; }
mkdir -p "$gallery" || exit 1
rm -f "$gallery"/*.png "$gallery"/*.apng "$gallery"/*.txt "$gallery"/*.err "$gallery"/index.html

# The rest of the first comment line that begins with the word.
about() { # about SCRIPT WORD
    head -n 20 "$1" | sed -n "s/^-- *$2: *//p" | head -n 1
}

as_html() {
    sed -e 's/&/\&amp;/g' -e 's/</\&lt;/g' -e 's/>/\&gt;/g' -e 's/"/\&quot;/g'
}

fail() { # fail SCRIPT WHY: also as the last line of what it said
    echo "render_all.sh: $1 $2" | tee -a "$gallery/$name.err" >&2
    failed="$failed $1"
}

# Renders a scene into gallery/NAME-01.png ...; a single picture is called gallery/NAME.png, and an animation
# gallery/NAME.apng.
render() { # render SCRIPT NAME COST
    script=$1
    name=$2
    limit=$(limit_of "$3")
    options=$(about "$script" OPTIONS)
    case $name in
    10demo | 14demo) options="${options:+$options }--size 1280x960 -ss 3 -al-samples 8" ;;
    esac
    output="$gallery/$name-%02d.png"
    case $script in data/animation/* | data/teaching/radiosity.lua) output="$gallery/$name.apng" ;; esac
    # shellcheck disable=SC2086
    echo "scene $number of $scenes: $script" $options
    options="${options:+$options }-o $output"
    begun=$(date +%s%N)
    # What it says is seen at once, and kept for the page.
    # shellcheck disable=SC2086
    {
        timeout -k 10 "$limit" ./gray $options "$script" 2>&1 >"$gallery/$name.txt"
        echo $? >"$gallery/status"
    } | tee "$gallery/$name.err" >&2
    read -r status <"$gallery/status"
    ended=$(date +%s%N)
    seconds=$(awk "BEGIN { printf \"%.1f\", ($ended - $begun) / 1e9 }")
    case $status in
    0) ;;
    124 | 137) fail "$script" "was ended at its limit of $limit seconds; GRAY_SCENE_LIMIT=SECONDS sets another" ;;
    *) fail "$script" "failed with status $status" ;;
    esac
    set -- "$gallery/$name"-[0-9]*.png
    [ $# -eq 1 ] && [ -f "$1" ] && mv -- "$1" "$gallery/$name.png"
    [ -s "$gallery/$name.txt" ] || rm -f "$gallery/$name.txt"
}

# "WIDTH HEIGHT" of a PNG file, "1 1" of another.
size_of() {
    od -An -tu1 -N24 -v -w24 "$1" | awk '{
        w = ($17 * 256 + $18) * 65536 + $19 * 256 + $20
        h = ($21 * 256 + $22) * 65536 + $23 * 256 + $24
        print (w * h > 0 ? w " " h : "1 1")
    }'
}

# One entry of the page: pictures, title, time, the command, and what the script printed.
describe() { # describe SCRIPT NAME SECONDS
    title=$(about "$1" TITLE)
    title=$(printf '%s' "${title:-$2}" | as_html)
    set -- "$1" "$2" "$3" "$gallery/$2.png" "$gallery/$2.apng" "$gallery/$2"-[0-9]*.png "$gallery"/?*"$2"-[0-9]*.png
    script=$1
    name=$2
    taken=$3
    shift 3
    shown=0
    large="${script%.lua}.png"
    loop="${script%.lua}.mp4"
    for picture in "$@"; do
        [ -f "$picture" ] || continue
        shown=$((shown + 1))
        file=$(basename "$picture" | as_html)
        size=$(size_of "$picture")
        [ $shown -ne 1 ] || echo "<figure style=\"--shape: $(echo "$size" | awk '{ print $1 / $2 }')\">"
        [ $shown -ne 2 ] || echo "<div class=\"more\">"
        link=$file
        [ $shown -ne 1 ] || [ ! -f "$large" ] || link=../$large # a click shows the finished one
        echo "<a class=\"picture\" href=\"$link\"><img src=\"$file\" width=\"${size% *}\" height=\"${size#* }\" alt=\"$title\" loading=\"lazy\"></a>"
    done
    [ $shown -lt 2 ] || echo "</div>"
    [ ! -f "$large" ] || echo "<p><a href=\"../$large\">finished, $(size_of "$large" | sed 's/ / x /')</a></p>"
    if [ -f "$loop" ]; then
        echo "<video src=\"../$loop\" autoplay loop muted playsinline controls></video>"
    elif grep -q '^-- LOOP: ' "$script"; then
        echo "<p>as a loop: <code>tools/gallery.sh --loop $(basename "$script" .lua)</code></p>"
    fi
    why=$(sed -e '/ left$/d' -e '/^ /d' "$gallery/$name.err" | head -n 9 | as_html)
    [ $shown -gt 0 ] || echo "<figure style=\"--shape: 1\"><p class=\"none\">no picture: ${why:-the script makes none}</p>"
    command="./gray $(printf '%s' "$options" | as_html)"
    echo "<figcaption><b>$title</b>, $taken s<br><code>$command <a href=\"../$script\">$script</a></code></figcaption>"
    [ ! -s "$gallery/$name.txt" ] ||
        printf '<details><summary>what it prints</summary><pre>%s</pre></details>\n' "$(head -c 4000 "$gallery/$name.txt" | as_html)"
    rm -f "$gallery/$name.err" "$gallery/status"
    echo "</figure>"
}

: >"$gallery/body.html"
number=0
open=no
planned=0 # seconds of the scenes so far, as planned and as they were
taken_all=0
while read -r script cost <&3; do
    case $script in
    \[*)
        [ $open = no ] || echo "</div>" >>"$gallery/body.html"
        open=yes
        title="$script${cost:+ $cost}"
        title=${title#?}
        echo "<h2>$(printf '%s' "${title%?}" | as_html)</h2><div class=\"part\">" >>"$gallery/body.html"
        continue
        ;;
    data/*) ;;
    *) continue ;;
    esac
    number=$((number + 1))
    base=$(basename "$script" .lua)
    case $script in data/classic/* | data/gallery/*) base="$(basename "$(dirname "$script")")-$base" ;; esac
    render "$script" "$base" "$cost"
    # The plan is for one kind of machine: after some seconds, what was taken so far corrects it.
    planned=$(awk "BEGIN { print $planned + $cost / $processors + 0.1 }")
    taken_all=$(awk "BEGIN { print $taken_all + $seconds }")
    left=$(awk "BEGIN { f = $planned > 5 ? $taken_all / $planned : 1; print ($total - $planned) * f }")
    [ "$number" -eq "$scenes" ] && echo "   $seconds s" || echo "   $seconds s, $(about_time "$left") left"
    describe "$script" "$base" "$seconds" >>"$gallery/body.html"
done 3<<PLAN
$plan
PLAN
[ $open = no ] || echo "</div>" >>"$gallery/body.html"

# The page opens with the first picture that is there at full size.
best=
for script in $(printf '%s\n' "$plan" | sed -n 's/^\(data[^ ]*\).*/\1/p'); do
    [ ! -f "${script%.lua}.png" ] || { best=${script%.lua}.png && break; }
done
{
    cat data/gallery.html
    if [ -n "$best" ]; then
        size=$(size_of "$best")
        echo "<p><img class=\"best\" src=\"../$best\" width=\"${size% *}\" height=\"${size#* }\" alt=\"$(about "${best%.png}.lua" TITLE | as_html)\"></p>"
    fi
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

next="open $gallery/index.html in a browser; docs/start.md leads to your first scene"
if [ -n "$failed" ]; then
    echo "render_all.sh: these failed:$failed; the reasons are above and in the page: $next" >&2
    exit 1
fi
echo "done: $next; screenshot01.png and screenshot02.png show 10demo and 14demo"
