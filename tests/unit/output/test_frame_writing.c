/* While the files of a frame are written, the script of the next frame runs. No script, no reader of the output and no
 * interrupted run can see the difference. */
#define _GNU_SOURCE
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* BODY runs in draw before the frame; the pictures are large enough that writing them takes some milliseconds. */
#define SCENE                                                                                                          \
    "local root, ball = gr.node('r'), gr.sphere(gr.material({0.9, 0.4, 0.2}, {0.5, 0.5, 0.5}, 20))\n"                  \
    "root:add_child(ball)\n"                                                                                           \
    "local function name(k) return string.format('x.%04d.png', k) end\n"                                               \
    "local function draw(t, k)\n"                                                                                      \
    "  BODY\n"                                                                                                         \
    "  ball:translate(0.1, 0, 0)\n"                                                                                    \
    "  return {node = root, width = 400, height = 300, eye = {0, 0, 6}, view = {0, 0, -1}, fov = 40,\n"                \
    "          background = function(d) return {d.x * d.x, d.y * d.y, 0.5} end, lights = {}}\n"                        \
    "end\n"                                                                                                            \
    "local function all() gr.frames{count = 4, draw = draw} end\n"

static void put_scene(const char *body, const char *end) {
    const char *at = strstr(SCENE, "BODY");
    char *text = NULL;
    if (asprintf(&text, "%.*s%s%s%s\n", (int)(at - SCENE), SCENE, body, at + strlen("BODY"), end) < 0)
        exit(1);
    test_write_text(test_path("scene.lua"), text);
    free(text);
}

TEST(a_script_that_reads_the_frame_before_finds_its_whole_file) {
    static const char *const reads[] = {
        "if k > 1 then local f = assert(io.open(name(k - 1), 'rb')) local text = f:read('a') f:close()\n"
        "assert(text:find('IEND', -8, true)) end",
        "if k > 1 then assert(package.searchpath(string.format('x.%04d', k - 1), '?.png', '')) end",
        "if k > 1 then ball:set_texture(name(k - 1)) end",
        "if k > 1 then ball:set_material(gr.image_material{material = gr.material({1, 1, 1}), image = name(k - 1)}) "
        "end"};
    for (size_t i = 0; i < sizeof reads / sizeof *reads; i++) {
        put_scene(reads[i], "all()");
        test_shell("rm -f x.*; $gray -q scene.lua -o 'x.####.png' && mv x.0004.png last.png && "
                   "$gray -q --no-sandbox scene.lua -o 'x.####.png' 2>/dev/null && cmp x.0004.png last.png && "
                   "$gray -q --no-fork scene.lua -o 'x.####.png' && cmp x.0004.png last.png",
                   0, "");
    }
    put_scene("", "all() local f = assert(io.open(name(4), 'rb')) assert(f:read('a'):find('IEND', -8, true))");
    test_shell("rm -f x.*; $gray -q scene.lua -o 'x.####.png'", 0, "");
}

TEST(what_a_script_prints_comes_after_the_statistics_of_the_frame_before) {
    put_scene("print('draw ' .. k)", "all() print('end')");
    test_shell(
        "rm -f x.*; $gray -q --stats=json scene.lua -o 'x.####.png' >lines; sed 's/^{.*/frame/' lines | tr '\\n' ' '",
        0, "draw 1 frame draw 2 frame draw 3 frame draw 4 frame end ");
    put_scene("io.stderr:write('draw ', k, '\\n')", "all()");
    test_shell(
        "$gray --stats scene.lua -o 'x.####.png' 2>&1 | grep -o 'draw .\\|^x.000[1-4].png' | uniq | tr '\\n' ' '", 0,
        "draw 1 x.0001.png draw 2 x.0002.png draw 3 x.0003.png draw 4 "
        "x.0004.png ");
}

/* One of the two processes is killed: while the script of frame 4 runs, which does not end, or while the supervisor is
 * stopped, so that a frame is done and not written. A run whose render process lives is not resumed. */
TEST(a_kill_in_the_script_of_a_frame_loses_no_frame_before_it) {
    static const struct {
        int written; /* frames before the kill */
        const char *kill;
    } cases[] = {{3, "kill -9 $c; wait $p; test $? = 3"},
                 {3, "kill -9 $p; wait $p"},
                 {2, "kill -STOP $p; sleep 0.3; kill -9 $c; kill -CONT $p; wait $p; test $? = 3"},
                 {2, "kill -STOP $p; sleep 0.3; kill -9 $p; wait $p"}};
    put_scene("while k == 4 and not package.searchpath('go', '?', '') do end", "all()");
    test_shell("touch go && $gray -q scene.lua -o one.gif", 0, "");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char line[1024];
        (void)snprintf(line, sizeof line,
                       "rm -f go; $gray -q scene.lua -o x.gif & p=$!; "
                       "await 'test -e x.gif.frames/00000%d.png'; c=$(pgrep -P $p); %s; "
                       "await '! kill -0 $c 2>/dev/null'; test $(ls x.gif.frames/*.png | wc -l) -ge %d && touch go && "
                       "$gray -q scene.lua -o x.gif --resume && cmp x.gif one.gif && rm x.gif",
                       cases[i].written, cases[i].kill, cases[i].written);
        test_shell(line, 0, "");
    }
}

/* A file system with room for some of the frames. %d: the room in KiB. */
#define SMALL_DISK                                                                                                     \
    "rm -rf disk; mkdir disk; unshare -rm sh -c \"mount -t tmpfs -o size=${room}k t disk && cp scene.lua disk && "     \
    "cd disk && $gray -q scene.lua -o 'x.####.png'; s=\\$?; rm scene.lua; "                                            \
    "for f in *; do cmp \\$f ../whole/\\$f || exit 9; done; ls | wc -l; exit \\$s\""

TEST(a_frame_that_cannot_be_written_is_named_whatever_the_script_does_next) {
    if (system("unshare -rm sh -c 'mount -t tmpfs -o size=8k t /mnt' 2>/dev/null") != 0)
        test_skip("this user may not mount a small file system");
    static const struct {
        const char *body, *end;
        int kept; /* frames; there is no room for the next one */
    } cases[] = {{"", "all()", 3},
                 {"", "print(pcall(all)) print('after')", 2},
                 {"if k == 4 then error('no') end", "all()", 2},
                 {"if k == 3 then error('no') end", "pcall(all)", 1},
                 {"print(k)", "all()", 2},
                 {"if k == 3 then os.exit() end", "all()", 1}};
    put_scene("", "all()");
    test_shell("mkdir whole && cd whole && $gray -q ../scene.lua -o 'x.####.png'", 0, "");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char line[1200], says[128];
        put_scene(cases[i].body, cases[i].end);
        (void)snprintf(line, sizeof line,
                       "room=$(for k in $(seq %d); do stat -c %%s whole/x.000$k.png; done | "
                       "awk '{pages += int(($1 + 4095) / 4096)} END {print 4 * pages + 8}'); " SMALL_DISK,
                       cases[i].kept);
        (void)snprintf(says, sizeof says, "x.000%d.png: cannot be written: No space left on device\n",
                       cases[i].kept + 1);
        test_shell(line, 3, says);
        (void)snprintf(says, sizeof says, "%d\n", cases[i].kept);
        char *said = test_read_file(test_path("out.txt"), NULL);
        CHECK(said && strlen(said) > 2 && strcmp(said + strlen(said) - 2, says) == 0);
        free(said);
    }
}
