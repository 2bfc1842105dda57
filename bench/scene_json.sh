#!/bin/sh
# Scenes in JSON of 100,000 nodes (or NODES): flat, nested, and with a mesh in every other node; materials and a mesh are
# shared. Prints the processor seconds of reading without rendering, and of reading and writing. GRAY: the program.
cd "$(dirname "$0")/.." || exit 1
gray=${GRAY:-./gray} nodes=${NODES:-100000}
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT

make_scene() {
    awk -v kind="$1" -v nodes="$2" '
    function transform(i) {
        return sprintf("\"transform\": [{\"rotate\": [\"y\", %d]}, {\"translate\": [%.3f, %.3f, %.3f]}]}", i * 7 % 360,
                       i * 37 % 1009 / 10 - 50, i * 61 % 997 / 10 - 50, i * 89 % 991 / 10 - 50)
    }
    BEGIN {
        mesh = "\"type\": \"mesh\", \"verts\": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], " \
               "\"faces\": [[0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]], \"material\": {\"ref\": \"m%d\"}"
        printf "{\"gray\": 1, \"define\": {"
        for (m = 0; m < 20; m++) printf "\"m%d\": {\"type\": \"material\", \"kd\": [%g, 0.5, 0.25]}, ", m, m / 20
        printf "\"part\": {" mesh "}}, \"picture\": {\"eye\": [0, 2, 120]}, \"nodes\": [", 0
        for (i = 0; i < nodes; i++) {
            if (kind == "nested" && i % 20 == 0)
                printf "%s{\"type\": \"node\", \"children\": [", i ? "]}," : ""
            else if (i) printf ","
            if (kind == "meshes" && i % 2) printf "{\"name\": \"mesh%d\", " mesh ", ", i, i % 20
            else if (i % 3 == 0) printf "{\"type\": \"node\", \"name\": \"copy%d\", \"children\": [{\"ref\": \"part\"}], ", i
            else printf "{\"type\": \"sphere\", \"name\": \"ball%d\", \"radius\": 0.4, \"material\": {\"ref\": \"m%d\"}, ", i, i % 20
            printf "%s", transform(i)
        }
        print kind == "nested" ? "]}]}" : "]}"
    }'
}

# The smallest of three.
seconds() {
    for _ in 1 2 3; do
        (
            "$@" >/dev/null || exit 1
            times >"$folder/times" # a pipe would have its own
        )
        tail -n 1 "$folder/times"
    done | awk '{ split($1, u, /[ms]/); split($2, s, /[ms]/); t = u[1] * 60 + u[2] + s[1] * 60 + s[2]
                  if (NR == 1 || t < least) least = t } END { printf "%9.2f", least }'
}

printf '%-8s %6s %9s %9s\n' scene MB 'read s' 'written s'
for kind in flat nested meshes; do
    make_scene $kind "$nodes" >"$folder/$kind.json"
    printf '%-8s %6.1f %s %s\n' $kind "$(wc -c <"$folder/$kind.json" | awk '{ print $1 / 1e6 }')" \
        "$(seconds "$gray" -q --check "$folder/$kind.json")" "$(seconds "$gray" -q --to-json "$folder/$kind.json")"
done
