#!/bin/sh
# What other programs say of the glTF files that gray writes.
# Usage: tools/check_gltf.sh [validator|blender]...   without: both
# validator: the Khronos validator finds no error and no warning in any demo of data (npm install gltf-validator, in the
# folder GLTF_VALIDATOR or ~). DEMOS: others than all. blender: Cycles draws five scenes as gray does.
# GRAY: the program (build/release/gray). What is not installed is left out, with a line. Exit status 1: something failed.
set -u
here=$(cd "$(dirname "$0")/.." && pwd)
gray=${GRAY:-$here/build/release/gray}
modules=${GLTF_VALIDATOR:-$HOME}/node_modules
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
failed=0
fail() {
    echo "FAILED: $1"
    failed=1
}

check_validator() {
    if ! [ -d "$modules/gltf-validator" ] || ! command -v node >/dev/null; then
        echo "gltf-validator is not installed: left out"
        return
    fi
    cat >"$work/check.js" <<'END'
const validator = require(process.argv[2] + '/gltf-validator'), fs = require('fs');
validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[3]))).then((report) => {
    for (const m of report.issues.messages.filter((m) => m.severity < 2)) console.log(m.code, m.message, m.pointer);
    process.exit(report.issues.numErrors + report.issues.numWarnings > 0 ? 1 : 0);
});
END
    cd "$here" || exit 3
    count=0
    for demo in ${DEMOS:-$(find data -name '*.lua' ! -path 'data/models/*' ! -name 'make_*' | sort)}; do
        "$gray" -q "$demo" --picture 1 -o "$work/x.glb" --force >"$work/said.txt" 2>&1
        grep -q 'renders [0-9]* pictures' "$work/said.txt" && continue
        [ -s "$work/x.glb" ] || { fail "$demo: $(head -n 1 "$work/said.txt")"; continue; }
        node "$work/check.js" "$modules" "$work/x.glb" >"$work/said.txt" || fail "$demo: $(head -n 1 "$work/said.txt")"
        rm -f "$work/x.glb"
        count=$((count + 1))
    done
    echo "the validator has read $count files"
}

check_blender() {
    if ! command -v blender >/dev/null; then
        echo "blender is not installed: left out"
        return
    fi
    cd "$work" || exit 3
    names= number=0
    "$gray" -q "$here/tools/check_gltf.lua" && "$gray" -q -D mask=true "$here/tools/check_gltf.lua" || fail "no pictures"
    for name in sun point spot solids crowd; do
        number=$((number + 1)) names="$names $work/$name"
        "$gray" -q "$here/tools/check_gltf.lua" --picture $number -o $name.glb || fail "$name is not written"
    done
    blender --background --factory-startup --python-exit-code 1 --python "$here/tools/check_gltf.py" -- $names \
        >said.txt 2>&1 || fail "blender: $(tail -n 3 said.txt)"
    grep 'covered otherwise' said.txt
}

for check in ${*:-validator blender}; do
    "check_$check"
done
exit $failed
