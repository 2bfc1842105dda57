#!/bin/sh
# Mesh files: MB/s of our readers on a million triangles in every format, compared with Assimp and tinyobjloader if
# their headers are installed (Debian: libassimp-dev, libtinyobjloader-dev). Writes only below build/bench.
cd "$(dirname "$0")/.." || exit 1
out=${BUILD:-build/release}/bench
mkdir -p "$out"
make -s BUILD="${BUILD:-build/release}" "$out/formats" || exit 1
peers=""
libraries=""
has() { echo "#include <$1>" | "${CXX:-c++}" -E -x c++ - >/dev/null 2>&1; }
has assimp/Importer.hpp && peers="$peers -DPEER_ASSIMP" libraries="$libraries -lassimp"
has tiny_obj_loader.h && peers="$peers -DPEER_TINYOBJ" libraries="$libraries -ltinyobjloader"
if [ -n "$peers" ]; then
    # shellcheck disable=SC2086
    "${CXX:-c++}" -O3 $peers -o "$out/formats_peers" bench/formats_peers.cc $libraries || peers=""
else
    echo "neither Assimp nor tinyobjloader is there"
fi
# A wavy sheet of 1000 x 500 quads.
[ -s "$out/sheet.obj" ] || awk -v out="$out/sheet" 'BEGIN {
    w = 1000; h = 500
    obj = out ".obj"; ply = out ".ply"
    printf "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n", (w+1)*(h+1) > ply
    printf "element face %d\nproperty list uchar int vertex_indices\nend_header\n", 2*w*h > ply
    for (y = 0; y <= h; y++) for (x = 0; x <= w; x++) {
        z = 0.1 * sin(x / 20) * cos(y / 30)
        printf "v %.6f %.6f %.6f\n", x / 100, y / 100, z > obj
        printf "%.6f %.6f %.6f\n", x / 100, y / 100, z > ply
    }
    for (y = 0; y < h; y++) for (x = 0; x < w; x++) {
        a = y * (w + 1) + x; b = a + 1; c = a + w + 1; d = c + 1
        printf "f %d %d %d\nf %d %d %d\n", a+1, b+1, d+1, a+1, d+1, c+1 > obj
        printf "3 %d %d %d\n3 %d %d %d\n", a, b, d, a, d, c > ply
    }
}'
[ -s "$out/sheet.stl" ] || "$out/formats" --stl "$out/sheet.obj" "$out/sheet.stl"
[ -s "$out/text_writer_binary.ply" ] || "$out/formats" --ply "$out/sheet.obj" "$out/text_writer_binary.ply"
set -- "$out/sheet.obj" "$out/sheet.ply" "$out/text_writer_binary.ply" "$out/sheet.stl"
for model in ../shared/models/igea.ply ../shared/models/nefertiti.obj ../shared/models/stanford-bunny.obj; do
    [ -f "$model" ] && set -- "$@" "$model"
done
[ -s "$out/sheet.obj.gz" ] || gzip -k "$out/sheet.obj"
"$out/formats" "$@" "$out/sheet.obj.gz"
[ -n "$peers" ] && "$out/formats_peers" "$@"
exit 0
