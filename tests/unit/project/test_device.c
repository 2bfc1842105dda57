/* The text that cards will run, as far as it can be checked without one. */
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void scan(const char *what, const char *says) {
    char line[8400], *root = realpath(".", NULL);
    test_need_tools("clang");
    (void)snprintf(line, sizeof line, "BUILD=$PWD '%s/tools/device_scan.sh' %s", root, what);
    free(root);
    test_shell(line, 0, "");
    char *output = test_read_file(test_path("out.txt"), NULL);
    if (strstr(output, "nothing was checked"))
        test_skip("%.100s", output);
    if (!strstr(output, says))
        test_fail(__FILE__, __LINE__, "no \"%s\" in %.1000s", says, output);
    free(output);
}

/* Before a script; make test-gpu says gpu. */
#define DEVICE "other=${GRAY_TEST_DEVICE:-emulate}; "

/* Every scene, as threads make it and as a device process makes it. */
static void compare(const char *scenes, const char *options) {
    char line[4096], *root = realpath(".", NULL);
    (void)snprintf(line, sizeof line,
                   DEVICE
                   "bad=0; for scene in $(cd '%s' && echo %s); do rm -f *.pfm; for device in cpu $other; do "
                   "$gray -q %s --allow-read '%s' --device $device -o $device-%%02d.pfm '%s'/$scene "
                   ">$device.out 2>$device.txt || { bad=1; cat $device.txt; }; done; "
                   "cmp cpu.txt $other.txt || bad=1; n=0; for picture in cpu-*.pfm; do n=$((n + 1)); "
                   "cmp $picture $other-${picture#cpu-} || { bad=1; echo $scene; }; done; done; echo $n; exit $bad",
                   root, scenes, options, root, root);
    free(root);
    test_shell(line, 0, "");
}

TEST(a_device_process_gives_the_bytes_of_threads_in_twenty_scenes) {
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
    test_skip("too slow in this build; the release build renders them");
#endif
    compare("data/path/*.lua tests/pictures/*.lua", "--integrator path --size 32x24 --spp 3");
}

TEST_LONG(a_device_process_gives_the_bytes_of_threads_in_every_scene) {
    compare("data/[0-9]*.lua data/[lmprs][ieowy][!ao]*.lua data/csg/*.lua data/functions/*.lua data/library/show_*.lua "
            "data/gallery/*.lua",
            "--integrator path --size 24x18 --spp 2");
}

TEST(a_device_process_gives_the_bytes_of_threads_in_every_kind_of_render) {
    compare("data/path/table.lua", "--integrator path --size 40x30 --spp 20 --noise .2");
    compare("data/path/table.lua", "--integrator path --size 40x30 --spp 4 --aov all");
    compare("data/path/table.lua", "--integrator path --size 64x48 --spp 4 --crop 10,9,33,20");
    compare("data/path/table.lua", "--integrator path --size 40x30 --spp 4 --line-width 2 --denoise");
}

TEST(parts_frames_and_resumed_pictures_are_the_same_with_and_without_a_device) {
    char *root = realpath(".", NULL), line[4096];
    (void)snprintf(
        line, sizeof line,
        DEVICE "scene='%s/data/path/table.lua'; set -- -q --integrator path --size 70x50 --spp 6 --allow-read '%s'; "
               "$gray \"$@\" -o whole.png $scene && $gray \"$@\" --shard 1/2 --device $other -o x.png $scene && "
               "$gray \"$@\" --shard 2/2 -o x.png $scene && $gray merge -q x.png.*.part -o x.png && "
               "cmp whole.png x.png && "
               "printf \"gr.frames(2, function(f) return { node = gr.sphere {}, file = 'f.png', width = 40, "
               "height = 30, eye = { f, 0, 5 }, target = { 0, 0, 0 }, fov = 40, integrator = 'path', "
               "spp = 4, background = { .5, .6, .7 } } end)\" >f.lua && "
               "$gray -q -o 'a%%d.png' f.lua && $gray -q --device $other -o 'b%%d.png' f.lua && "
               "cmp a1.png b1.png && cmp a2.png b2.png && "
               "{ timeout -s KILL .3 $gray \"$@\" --spp 150 --device $other --checkpoint 0.05 -o y.png $scene; "
               "$gray \"$@\" --spp 150 --resume -o y.png $scene && $gray \"$@\" --spp 150 -o z.png $scene && "
               "cmp y.png z.png; }",
        root, root);
    free(root);
    test_shell(line, 0, "");
}

TEST(a_fault_of_a_function_has_its_warning_with_a_device) {
    static const char scene[] =
        "local f = gr.material { kd = function(p) return math.sqrt(p.x - 0.3) end }\n"
        "gr.render { node = gr.sphere { radius = 1, material = f }, file = 'n.pfm', width = 70, height = 40,\n"
        "    eye = { 0, 0, 5 }, target = { 0, 0, 0 }, fov = 40, integrator = 'path', spp = 4, background = { .5, .6, "
        ".7 } }\n";
    test_write_file(test_path("scene.lua"), scene, sizeof scene - 1);
    test_shell(DEVICE
               "for device in cpu $other; do $gray --device $device -o $device.pfm scene.lua 2>$device.txt; done; "
               "cmp cpu.pfm $other.pfm && cmp cpu.txt $other.txt && cat cpu.txt",
               0, "NaN");
}

static const char room[] =
    "local r = gr.node('r')\n"
    "r:add_child(gr.sphere { radius = 1, material = gr.material { kd = { .7, .3, .2 } } })\n"
    "r:add_child(gr.rectangle { corner = { -9, -1, 9 }, along = { 18, 0, 0 }, up = { 0, 0, -18 },\n"
    "    material = gr.material { kd = { .6, .6, .6 } } })\n"
    "gr.render { node = r, file = 'room.pfm', width = 64, height = 64, eye = { 0, 1, 6 }, target = { 0, 0, 0 }, fov = "
    "40,\n"
    "    integrator = 'path', spp = 600, background = { .6, .8, 1 } }\n";

/* The second child of the program is the device process. */
static void kill_at(const char *sleeps) {
    char line[2048];
    (void)snprintf(
        line, sizeof line,
        DEVICE
        "$gray -q -o whole.pfm scene.lua && for seconds in %s; do "
        "$gray --device $other -o killed.pfm --force scene.lua 2>killed.txt & process=$!; "
        "await \"[ \\$(pgrep -P $process | wc -l) -ge 2 ]\"; sleep $seconds; "
        "kill -9 $(pgrep -P $process | tail -n +2); wait $process || exit 1; "
        "grep -q 'the device process was killed (signal 9, Killed); the processor goes on' killed.txt || exit 2; "
        "cmp whole.pfm killed.pfm || exit 3; done; "
        "$gray -q --device $other -o killed.pfm --force scene.lua & process=$!; "
        "await \"[ \\$(pgrep -P $process | wc -l) -ge 2 ]\"; device=$(pgrep -P $process | tail -n +2); "
        "kill -TERM $process; wait $process; [ $? -ge 128 ] && ! kill -0 $device",
        sleeps);
    test_write_file(test_path("scene.lua"), room, sizeof room - 1);
    test_need_tools("pgrep");
    test_shell(line, 0, "");
}

TEST(the_processor_goes_on_when_the_device_process_is_killed) {
    kill_at("0 .02 .1");
}

TEST_LONG(the_processor_goes_on_whenever_the_device_process_is_killed) {
    kill_at("$(seq 0 .002 .4)");
}

/* The program itself, or its first child, the render process: what was there before stays, and no process does. */
static void kill_other_at(const char *which, const char *sleeps) {
    char line[2048];
    (void)snprintf(
        line, sizeof line,
        DEVICE
        "$gray -q -o whole.pfm scene.lua && cp whole.pfm killed.pfm && for seconds in %s; do "
        "$gray -q --device $other --partial=no -o killed.pfm --force scene.lua 2>killed.txt & process=$!; "
        "await \"[ \\$(pgrep -P $process | wc -l) -ge 2 ]\"; all=\"$process $(pgrep -P $process)\"; "
        "set -- $all; sleep $seconds; kill -9 %s 2>killed.txt; wait $process; cmp whole.pfm killed.pfm || exit 1; "
        "for one in $all; do await \"! kill -0 $one 2>killed.txt\"; done; done; "
        "[ $(ls | wc -l) = 5 ] || { ls; exit 2; }",
        sleeps, which);
    test_write_file(test_path("scene.lua"), room, sizeof room - 1);
    test_need_tools("pgrep");
    test_shell(line, 0, "");
}

TEST(what_is_left_of_a_run_with_a_device_whose_processes_are_killed_is_the_old_picture) {
    kill_other_at("$1", "0 .05");
    kill_other_at("$2", "0 .05");
}

TEST_LONG(whenever_a_process_of_a_run_with_a_device_is_killed_the_old_picture_is_left) {
    kill_other_at("$1", "$(seq 0 .002 .4)");
    kill_other_at("$2", "$(seq 0 .002 .4)");
}

TEST(what_device_there_is_is_an_option_or_in_the_environment) {
    test_write_file(test_path("scene.lua"), room, sizeof room - 1);
    test_shell("for options in '--integrator whitted' '--caustics 100'; do "
               "$gray -q -o cpu.pfm $options scene.lua && $gray -q --device emulate -o other.pfm $options scene.lua && "
               "cmp cpu.pfm other.pfm && rm *.pfm || exit 1; done",
               0, "");
    test_shell("$gray --device gpu -o x.pfm scene.lua --caustics 100 2>&1; s=$?; ls x.pfm 2>/dev/null; exit $s", 1,
               "--device gpu: a device has no photons (--caustics)");
    test_shell("$gray --device gpu -o x.pfm scene.lua --integrator whitted 2>&1", 1,
               "--device gpu: a device has no integrator but path");
    test_shell("GRAY_DEVICE=emulate $gray --spp 1 --verbose scene.lua --integrator whitted 2>&1", 0,
               "gray: the processor renders: a device has no integrator but path");
    test_shell("GRAY_DEVICE=emulate $gray --spp 1 --verbose --force scene.lua --caustics 100 2>&1", 0,
               "gray: the processor renders: a device has no photons (--caustics)");
    test_shell("GRAY_DEVICE=card $gray --spp 1 scene.lua 2>&1", 2,
               "GRAY_DEVICE is 'card', not one of cpu|gpu|auto|emulate");
    test_shell("$gray --device card scene.lua 2>&1", 2, "--device");
}

TEST_LONG(every_operation_for_cards_is_rounded_and_none_is_fused) {
    scan("", " operations are rounded to nearest");
}

/* A library of the driver's name that has the first calls of it. */
TEST(a_card_that_is_not_there_is_an_error_with_gpu_and_a_line_with_auto) {
    char *root = realpath(".", NULL), line[4096];
    (void)snprintf(
        line, sizeof line,
        "scene='%s/docs/first.lua'; cp -L $gray own && mkdir lib && "
        "export GRAY_LUA='%s/lua'; try() { LD_LIBRARY_PATH=$PWD/lib ./own -q --integrator path --size 16x12 --spp 2 "
        "\"$@\" -o "
        "$name.png "
        "$scene 2>&1 | tail -n 1 | sed \"s#.*/own#own#; s#$PWD/##; s#^[^ ]*first.lua: ##\"; }; "
        "name=cpu; try && "
        "echo 'int cuInit(unsigned f) { return f ? 1 : 100; }' | cc -shared -o lib/libcuda.so.1 -x c - && name=gpu; "
        "try --device gpu; "
        "{ echo 'int cuGetErrorString(int e, const char **t) { *t = e == 100 ? \"no card\" : \"?\"; return 0; }'; "
        "for call in cuInit $(sed -n 's/.*X([a-z_]*, \"\\(cu[A-Za-z0-9_]*\\)\".*/\\1/p' '%s/src/device/cuda_calls.h' | "
        "grep -v -e cuInit -e cuGetErrorString) cuLaunchKernel; do echo \"int $call(void) { return 100; }\"; done; } | "
        "sort -u | cc -shared -o lib/libcuda.so.1 -x c - && try --device gpu; "
        "echo 'gray kernels of yesterday' >gray-kernels; try --device gpu; "
        "{ echo gray kernels $(cd '%s' && tools/device_scan.sh digest); echo text; } >gray-kernels; try --device gpu; "
        "name=auto; GRAY_DEVICE=auto try; ls *.png; cmp cpu.png auto.png; "
        "for size in '16x12 --spp 20' '320x240 --spp 60000'; do LD_LIBRARY_PATH=$PWD/lib ./own --verbose --device "
        "auto --integrator path "
        "--size $size --time-limit .1 -o auto.png --force $scene 2>&1 | grep 'processor renders' | "
        "sed 's/about [0-9.]* s/about N s/'; done",
        root, root, root, root);
    free(root);
    test_shell(line, 0,
               "--device gpu: the driver of the card is too old: libcuda.so.1 has no cuDriverGetVersion\n"
               "--device gpu: there are no kernels for a card: gray-kernels: cannot be read: No such file or "
               "directory; make gpu writes them\n"
               "--device gpu: gray-kernels was made from other sources than this program; make gpu writes it again\n"
               "--device gpu: the card cannot be used: init: no card\n"
               "auto.png\ncpu.png\n"
               "gray: the processor renders: it needs about N s\n"
               "gray: the processor renders: the card cannot be used: init: no card\n");
}
