#!/bin/sh
# Compiles the files of src/device/sources.list for a card, without one, and checks what the promise of equal bytes needs:
#   tools/device_scan.sh calls    every file compiles for NVIDIA's cards; the kernels named there reach nothing but the
#                                 listed files, and each of these
#   tools/device_scan.sh shared   and compiles what the kernels reach, from the same bitcode, for this processor (x86-64):
#                                 kernels.so, where bitcode_thread and bitcode_threads say which thread of the card runs
#   tools/device_scan.sh          also for AMD's cards; in the PTX, every operation on floats and doubles rounds to
#                                 nearest, none is fused, approximate or flushes denormals, minima and maxima keep the
#                                 sign of zero, and frames of functions that every ray passes are small
#   tools/device_scan.sh digest   prints the digest of what the kernels are made from
# With KERNELS=FILE it writes the kernels there: a line with that digest, then of each kernel a line with its name and its
# bytes, and a module of its own: PTX, or with ptxas and fatbinary of CUDA also the code of the cards in CARDS (numbers of
# capabilities, default "75 80 90 100 120"; those that ptxas does not know are left out).
# Needs clang and the tools of its LLVM (14 or newer); without them it says so, with status 0. Writes into build/device.
cd "$(dirname "$0")/.." || exit 1
out=${BUILD:-build}/device list=src/device/sources.list
digest=$({ sed -n 's/^\([a-z].*\.c\)$/src\/\1/p' "$list"; ls src/*/*.h; echo "$list" "$0"; } | xargs cat | sha256sum | cut -c 1-32)
[ "${1:-}" = digest ] && { echo "$digest"; exit 0; }
suffix=$(clang --version 2>/dev/null | sed -n 's/.*clang version \([0-9]*\).*/-\1/p')
command -v "llvm-link$suffix" >/dev/null || suffix=
for tool in clang llvm-link$suffix llvm-nm$suffix llvm-dis$suffix opt$suffix llc$suffix; do
    command -v "$tool" >/dev/null || { echo "device_scan.sh: nothing was checked: there is no $tool"; exit 0; }
done
mkdir -p "$out" || exit 1
sources=$(sed -n 's/^\([a-z].*\.c\)$/src\/\1/p' "$list")
roots=$(sed -n 's/^root //p' "$list" | tr '\n' ',' | sed 's/,$//')
wanted=${1:-all}
# Structures that functions take by value lose the alignment of their doubles when clang inlines these; no double of gray
# lies elsewhere (-fsanitize=alignment). A load of bytes takes a card eight loads and as many shifts.
export align='/(load|store) (volatile )?(double|<2 x double>)/s/, align 1$/, align 8/; /(load|store) (volatile )?(double|<2 x double>)/s/, align 1, /, align 8, /'
# The headers of the C library ask for the processor of the host.
export wanted FLAGS="-std=gnu11 -ffp-contract=off -fno-fast-math -fno-math-errno -DNDEBUG -DGRAY_DEVICE -DGRAY_NO_SIMD -DGRAY_NO_JUMPS
    -D__$(uname -m)__ -isystem /usr/include/$(uname -m)-linux-gnu -Isrc -Wno-everything"

# For NVIDIA's cards only what is newer than what was made of it.
echo "$sources" | OUT=$out xargs -P "$(nproc)" -n 1 sh -c '
    object=$OUT/$(echo "$1" | tr / _).bc
    [ "$wanted" != all ] || clang --target=amdgcn-amd-amdhsa -nogpulib $FLAGS -fsyntax-only "$1" || exit 255
    [ "$object" -nt "$1" ] && [ -z "$(find src -name "*.h" -newer "$object")" ] && exit 0
    clang --target=nvptx64-nvidia-cuda -march=sm_70 -O2 -mllvm -inline-threshold=45 $FLAGS -emit-llvm -c "$1" -o "$object"
' sh || { echo "device_scan.sh: a file does not compile for a card" >&2; exit 1; }

objects=$(echo "$sources" | while read -r file; do echo "$out/$(echo "$file" | tr / _).bc"; done)
cd "$out" || exit 1
# shellcheck disable=SC2086
llvm-link"$suffix" $(for object in $objects; do basename "$object"; done) -o all.bc &&
    opt"$suffix" -internalize -internalize-public-api-list="$roots" -globaldce all.bc -o reached.bc || exit 1
llvm-nm"$suffix" reached.bc >reached.txt
bad=0
for name in $(awk '$1 == "U" && $2 !~ /^llvm[.]/ { print $2 }' reached.txt); do
    echo "device_scan.sh: $name is called, and in no file of $list" >&2
    bad=1
done
for name in $(echo "$roots" | tr ',' ' '); do
    grep -q " T $name\$" reached.txt || { echo "device_scan.sh: there is no function $name" >&2; bad=1; }
done
# A file gives a function or data that is reached.
awk '$1 != "U" { print $NF }' reached.txt | sort -u >names.txt
for object in $objects; do
    object=$(basename "$object")
    llvm-nm"$suffix" "$object" | awk '$2 ~ /^[A-Z]$/ { print $NF }' | sort -u | comm -12 - names.txt | grep -q . ||
        { echo "device_scan.sh: nothing of $object is reached" >&2; bad=1; }
done
[ "$bad" = 0 ] || exit 1
echo "$(echo "$objects" | wc -l) files, $(grep -c -i ' t ' reached.txt) functions"
[ "$wanted" = calls ] && exit 0
if [ "$wanted" = shared ]; then
    [ "$(uname -m)" = x86_64 ] || { echo "device_scan.sh: nothing was checked: this is no x86-64"; exit 0; }
    llvm-dis"$suffix" reached.bc -o - | sed -E "$align" | sed -e 's/^target triple.*/target triple = "x86_64-unknown-linux-gnu"/' \
        -e 's/^target datalayout.*/target datalayout = "e-m:e-p270:32:32-p271:32:32-p272:64:64-i64:64-f80:128-n8:16:32:64-S128"/' \
        -e 's/"target-cpu"="[^"]*"//; s/"target-features"="[^"]*"//' \
        -e 's/@llvm\.nvvm\.read\.ptx\.sreg\.\([a-z]*\)\.x/@bitcode_\1/g' >shared.ll || exit 1
    cat >shared.c <<'END'
unsigned bitcode_thread, bitcode_threads;
unsigned bitcode_tid(void) { return bitcode_thread; }
unsigned bitcode_ctaid(void) { return 0; }
unsigned bitcode_ntid(void) { return bitcode_threads; }
unsigned bitcode_nctaid(void) { return 1; }
END
    llc"$suffix" -O1 -relocation-model=pic -filetype=obj shared.ll -o shared.o &&
        clang -shared -fPIC -O1 shared.c shared.o -lm -o kernels.so && echo kernels.so
    exit
fi

# clang's C of that age has no word for a kernel: it is a note beside the function.
llvm-dis"$suffix" reached.bc -o - | awk '
/^target/ { print }
/^define .*@kernel_/ {
    name = $0
    sub(/.*@/, "", name)
    sub(/\(.*/, "", name)
    types = $0
    sub(/[^(]*\(/, "", types)
    sub(/\).*/, "", types)
    gsub(/ (noundef )?%[0-9A-Za-z._]+/, "", types)
    print "declare void @" name "(" types ")"
    notes[count++] = "!{void (" types ")* @" name ", !\"kernel\", i32 1}"
}
END {
    for (i = 0; i < count; i++) {
        print "!" i " = " notes[i]
        list = list (i ? ", " : "") "!" i
    }
    print "!nvvm.annotations = !{" list "}"
}' >notes.ll
llvm-link"$suffix" reached.bc notes.ll -o noted.bc || exit 1
# One module for each kernel, with what it needs: small modules are compiled quickly, and fit the caches of a card.
rm -f kernel_*.ptx kernel_*.cubin
echo "$roots" | tr ',' '\n' | suffix=$suffix xargs -P "$(nproc)" -n 1 sh -c '
    opt"$suffix" -internalize -internalize-public-api-list="$1" -globaldce noted.bc -o "$1.bc" &&
        opt"$suffix" -O3 -inline-threshold=45 -vectorize-loops=false -vectorize-slp=false "$1.bc" -S -o "$1.ll" 2>"$1.txt" &&
        sed -E "$align" "$1.ll" | llc"$suffix" -O3 -mcpu=sm_70 -o "$1.ptx" || exit 255
' sh || exit 1
for name in $(echo "$roots" | tr ',' ' '); do
    grep -q "[.]entry $name(" "$name.ptx" || { echo "device_scan.sh: $name is no kernel of $name.ptx" >&2; exit 1; }
done
# Frames of the functions that every ray passes; those of expressions are larger until they have another memory there.
awk -v frame=8192 '
function complain(what) {
    print "device_scan.sh: " FILENAME ":" FNR ": " what ": " $0 >"/dev/stderr"
    bad = 1
}
/^[ \t]*\/\// { next }
/[.]func|[.]entry/ {
    name = $0
    sub(/.*[.](func|entry)[ \t]*/, "", name)
    sub(/^\([^)]*\)[ \t]*/, "", name)
    sub(/[^A-Za-z0-9_$].*/, "", name)
}
/__local_depot[0-9]+\[/ {
    size = $0
    sub(/.*\[/, "", size)
    sub(/\].*/, "", size)
    if (size + 0 > frame && name ~ /^(path|world|triangle|box_tree|traverse|camera|light|bsdf)_/)
        complain("a frame of " size " bytes in " name)
}
$1 ~ /[.]f(32|64)$/ || $1 ~ /^(fma|mad)[.]/ {
    split($1, parts, ".")
    operation = parts[1]
    if ($1 ~ /[.](ftz|approx|full|sat)/)
        complain("not exact")
    else if (operation ~ /^(fma|mad)$/ && $1 !~ /[.](lo|hi|wide)[.]/)
        complain("fused")
    else if (operation ~ /^(add|sub|mul|div|rcp|sqrt)$/) {
        rounded++
        if ($1 !~ /[.]rn[.]f/)
            complain("not rounded to nearest")
    }
    else if (operation ~ /^(sin|cos|ex2|lg2|rsqrt|tanh)$/)
        complain("not a function of gray")
    else if (operation == "min" && $0 ~ /0[df]0+;/ && name != "expr_run_slopes_base") # bounds: zeros are compared alone
        complain("the sign of zero")
    else if ($1 ~ /^(min|max)[.]f32$/ && name ~ /^device_search_/) # boxes only propose (accel/float_tree.h)
        proposed++
    else if (operation ~ /^(min|max)$/ && $0 !~ /0[df][0-9A-F]+;/)
        complain("the sign of zero or NaN")
}
END {
    if (!bad)
        print rounded " operations are rounded to nearest"
    exit bad
}' $(echo "$roots" | sed 's/,/.ptx /g; s/$/.ptx/') || exit 1
[ -n "${KERNELS:-}" ] || exit 0

# Code for cards; -Ofc min: seconds in place of minutes, and kernels that are hardly slower.
cards=
if command -v ptxas >/dev/null && command -v fatbinary >/dev/null; then
    for card in ${CARDS:-75 80 90 100 120}; do
        ptxas -arch="sm_$card" -Ofc min kernel_finish.ptx -o kernel_finish.cubin 2>/dev/null && cards="$cards $card"
    done
fi
for card in $cards; do
    echo "$roots" | tr ',' '\n' | sed "s/\$/ $card/"
done | xargs -P "$(nproc)" -n 2 sh -c 'ptxas -arch="sm_$2" -Ofc min "$1.ptx" -o "$1.$2.cubin" 2>"$1.txt" || { cat "$1.txt" >&2; exit 255; }' sh || exit 1
for name in $(echo "$roots" | tr ',' ' '); do
    images=$(for card in $cards; do echo "--image3=kind=elf,sm=$card,file=$name.$card.cubin"; done)
    # shellcheck disable=SC2086
    if [ -n "$cards" ]; then
        fatbinary --64 --compress-all --create="$name.module" --image3="kind=ptx,sm=70,file=$name.ptx" $images || exit 1
    else
        cp "$name.ptx" "$name.module" && printf '\0' >>"$name.module" || exit 1
    fi
done
{
    echo "gray kernels $digest"
    for name in $(echo "$roots" | tr ',' ' '); do
        echo "$name $(wc -c <"$name.module")"
        cat "$name.module"
    done
} >"$KERNELS.new" && mv "$KERNELS.new" "$KERNELS" && echo "$KERNELS: $(($(wc -c <"$KERNELS") / 1000000)) MB, code of cards:${cards:- none}"
