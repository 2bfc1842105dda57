#!/bin/sh
# Times every demo: seconds to build and render (median of RUNS, default 3), millions of rays by kind, total millions of
# rays per second. Arguments: scripts (default: data/*demo.lua); GRAY: the program; OPTIONS: more options for it.
cd "$(dirname "$0")/.." || exit 1
gray=${GRAY:-./gray}
runs=${RUNS:-3}
[ $# -gt 0 ] || set -- data/*demo.lua
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
here=$(pwd)
case $gray in /*) ;; *) gray=$here/$gray ;; esac
printf '%-22s %8s %8s %9s %9s %9s %9s %9s\n' scene 'build s' 'render s' camera reflected refracted shadow 'Mrays/s'
for script in "$@"; do
    case $script in /*) path=$script ;; *) path=$here/$script ;; esac
    : >"$folder/lines"
    i=0
    while [ $i -lt "$runs" ]; do
        i=$((i + 1))
        # shellcheck disable=SC2086
        (cd "$folder" && "$gray" -q --stats=json $OPTIONS "$path") 2>/dev/null | grep '^{' | tail -n 1 >>"$folder/lines"
    done
    # The last picture of a script counts; figures by name, median over the runs by render time.
    awk -v name="$(basename "$script" .lua)" '
        function figure(key,   at, rest) {
            at = index($0, "\"" key "\":")
            if (!at) return 0
            rest = substr($0, at + length(key) + 3)
            return rest + 0
        }
        { n++; build[n] = figure("build_seconds"); render[n] = figure("render_seconds")
          camera = figure("camera_rays"); mirror = figure("reflected_rays")
          glass = figure("refracted_rays"); shadow = figure("shadow_rays") }
        END {
            if (!n) { printf "%-22s failed\n", name; exit 1 }
            for (i = 1; i <= n; i++) for (j = i + 1; j <= n; j++) if (render[j] < render[i]) {
                t = render[i]; render[i] = render[j]; render[j] = t; t = build[i]; build[i] = build[j]; build[j] = t }
            m = int((n + 1) / 2); total = camera + mirror + glass + shadow
            printf "%-22s %8.3f %8.3f %9.3f %9.3f %9.3f %9.3f %9.3f\n", name, build[m], render[m], camera / 1e6,
                mirror / 1e6, glass / 1e6, shadow / 1e6, (render[m] > 0 ? total / render[m] / 1e6 : 0)
        }' "$folder/lines"
done
