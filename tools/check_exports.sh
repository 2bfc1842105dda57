#!/bin/sh
# Opens the models that gray writes in other programs: each must take every file as a closed solid, without repair.
# Usage: tools/check_exports.sh [PROGRAM...]   PROGRAM: admesh openscad blender prusa-slicer; without: all of them
# GRAY: the program (build/release/gray). What is not installed is left out, with a line. Exit status 1: something failed.
set -u
here=$(cd "$(dirname "$0")/.." && pwd)
gray=${GRAY:-$here/build/release/gray}
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 3
failed=0
fail() {
    echo "FAILED: $1"
    failed=1
}

if ! "$gray" -q "$here/tools/check_exports.lua"; then
    fail "the solids are not written"
    exit 1
fi
for demo in phone_stand gear_box vase gyroid_lamp; do
    for ending in stl 3mf; do
        "$gray" -q "$here/data/print/$demo.lua" --tolerance 0.3 -o "$demo.$ending" || fail "$demo.$ending is not written"
    done
done
count=$(ls ./*.stl | wc -l)

check_admesh() {
    admesh --version | head -n 1
    for file in *.stl; do
        admesh "$file" >said.txt 2>&1 || fail "admesh $file"
        # Total disconnected, degenerate, edges fixed, facets removed, added, reversed, backwards edges, normals fixed.
        grep -E '^(Total disc|Degenerate|Edges fixed|Facets |Backwards|Normals fixed)' said.txt |
            grep -vE '^Facets with|: +0( +0)?$' && fail "admesh repairs $file"
    done
}

# The intersection needs exact polyhedra (CGAL), which an open or self-intersecting surface does not give.
check_openscad() {
    openscad --version 2>&1; echo
    for file in *.stl *.3mf; do
        echo "intersection() { import(\"$file\"); translate([-500, -500, -500]) cube(1000); }" >in.scad
        openscad --render -o out.off in.scad >said.txt 2>&1 || fail "openscad $file"
        grep -q 'Simple: *yes' said.txt || fail "openscad $file: not simple"
        grep -E 'ERROR|WARNING|not closed' said.txt && fail "openscad $file"
    done
}

check_prusa_slicer() {
    prusa-slicer --help 2>/dev/null | grep -o '^PrusaSlicer-[0-9.]*'
    for file in *.stl *.3mf *.obj; do
        prusa-slicer --info "$file" >said.txt 2>&1 || fail "prusa-slicer $file"
        grep -q 'manifold = yes' said.txt || fail "prusa-slicer $file: not manifold"
        grep -iE 'repair|open_edges|degenerate|backwards|error' said.txt && fail "prusa-slicer $file"
    done
    for file in *.3mf; do
        prusa-slicer --export-gcode --support-material --center 100,100 -o out.gcode "$file" >said.txt 2>&1 ||
            fail "prusa-slicer slices $file: $(tail -n 1 said.txt)"
        grep -iE 'repair|open_edges|manifold' said.txt && fail "prusa-slicer slices $file"
        grep -q 'G1 .*E' out.gcode || fail "prusa-slicer $file: no layers"
        rm -f out.gcode
    done
}

check_blender() {
    blender --version | head -n 1
    cat >check.py <<'END'
import bmesh, bpy, glob, sys
readers = {'stl': bpy.ops.import_mesh.stl, 'ply': bpy.ops.import_mesh.ply, 'obj': bpy.ops.wm.obj_import}
for name in sorted(sum((glob.glob('*.' + ending) for ending in readers), [])):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    readers[name[-3:]](filepath=name)
    objects = [o for o in bpy.data.objects if o.type == 'MESH']
    wrong = [] if objects else ['no object']
    for o in objects:
        b = bmesh.new()
        b.from_mesh(o.data)
        wrong += ['%d edges' % sum(not e.is_manifold or not e.is_contiguous for e in b.edges)]
        wrong += ['%d vertices' % sum(not v.is_manifold for v in b.verts)]
        wrong += ['%d faces without area' % sum(not f.calc_area() > 0 for f in b.faces)]
        wrong += [] if b.calc_volume(signed=True) > 0 else ['inside out']
        changed = o.data.validate()
        wrong += ['changed by validate'] if changed else []
    wrong = [w for w in wrong if not w.startswith('0 ')]
    if wrong:
        print('FAILED: blender', name, ', '.join(wrong))
END
    blender --background --factory-startup --python-exit-code 1 --python check.py >said.txt 2>&1 || fail "blender: $(tail -n 3 said.txt)"
    grep '^FAILED' said.txt && failed=1
}

for program in ${*:-admesh openscad prusa-slicer blender}; do
    if ! command -v "$program" >/dev/null; then
        echo "$program is not installed: left out"
        continue
    fi
    "check_$(echo "$program" | tr - _)"
    echo "$program has opened $count solids"
done
exit $failed
