/* What Ctrl-C, SIGTERM and a closed window leave: NAME.partial.png, and tiles for --resume. */
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Shells start background children with SIGINT ignored: env resets it. */
#define ENDED(options, moment, signal)                                                                                 \
    "env --default-signal=INT $gray scene.lua " options " 2>said.txt & p=$!; sleep " moment "; kill -" signal          \
    " $p 2>kill.txt; wait $p; s=$?; "
#define MOMENTS "0.02 0.05 0.1 0.15 0.2 0.3 0.4 0.6 0.9 1.3"
/* Until an interruption leaves the file. */
#define UNTIL(file, options, signal)                                                                                   \
    "for m in " MOMENTS " 2 3 5 8; do " ENDED(options, "$m", signal) "test -e " file " && break; rm -f out.png; "      \
                                                                     "done; "

static const char scene[] =
    "local r = gr.node('root')\n"
    "r:add_child(gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20))))\n"
    "local l = gr.area_light({4, 5, 6}, {1, 0, 0}, {0, 1, 0}, {0.9, 0.9, 0.9}, {1, 0, 0})\n"
    "local function picture(name)\n"
    "  gr.render(r, name, 330, 250, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2}, {l})\n"
    "end\n";

static void put_scene(const char *more) {
    char text[2048];
    (void)snprintf(text, sizeof text, "%s%s", scene, more);
    test_write_text(test_path("scene.lua"), text);
}

TEST(a_picture_that_ends_at_any_of_ten_moments_goes_on_to_the_bytes_of_one_run) {
    put_scene("picture('out.png')\n");
    test_shell_errors(
        "$gray scene.lua -q -full -ss 2 -o whole.png; signal=INT; for m in " MOMENTS "; do "
        "rm -f out.png; " ENDED(
            "-full -ss 2 --checkpoint auto", "$m",
            "$signal") "test $signal = INT && signal=TERM || signal=INT; test $s = 0 || test $s = 130 || exit 1; "
                       "test -e out.png && ! cmp out.png whole.png && exit 2; "
                       "$gray scene.lua -q -full -ss 2 --resume && cmp out.png whole.png || exit 3; "
                       "ls | grep -q 'partial\\|checkpoint' && exit 4; done; exit 0",
        0, NULL);
}

TEST(an_animation_that_ends_at_any_of_ten_moments_goes_on_to_the_bytes_of_one_run) {
    put_scene("gr.frames{count = 6, draw = function(time) r:translate(time / 9, 0, 0)\n"
              "  return {node = r, file = 'f.png', width = 160, height = 120, eye = {0, 0, 6}, lights = {l}} end}\n");
    test_shell_errors(
        "$gray scene.lua -q -o whole.gif; signal=INT; for m in " MOMENTS "; do rm -f x.gif; " ENDED(
            "-o x.gif", "$m",
            "$signal") "test $signal = INT && signal=TERM || signal=INT; test $s = 0 || test $s = 130 || exit 1; "
                       "test -e x.gif && ! cmp x.gif whole.gif && exit 2; "
                       "$gray scene.lua -q -o x.gif --resume && cmp x.gif whole.gif || exit 3; "
                       "ls | grep -q 'partial\\|frames' && exit 4; done; exit 0",
        0, NULL);
}

TEST(an_interrupted_picture_leaves_a_partial_one_beside_the_old_one_and_a_finished_run_removes_it) {
    put_scene("picture('out.png')\n");
    test_shell_errors(
        "printf 'PF\\n1 old' >out.pfm; for m in " MOMENTS " 2 3 5 8; do " ENDED(
            "-full -ss 6 -o out.pfm", "$m",
            "INT") "test -e out.partial.png && break; done; "
                   "cat said.txt >&2; grep -q old out.pfm || exit 1; test -e out.pfm.checkpoint && exit 2; exit $s",
        130, "tiles (--checkpoint auto keeps them for --resume)");
    struct test_picture picture = test_read_picture(test_path("out.partial.png"));
    CHECK_EQ_INT(picture.width, 330);
    free(picture.rgb);
    test_shell_errors("$gray scene.lua -q -o out.pfm; ls | grep partial", 1, NULL);
    /* Nothing is left on request, and of a picture without a name. */
    test_shell_errors("rm out.pfm; for m in .1 .3 .6 1.2; do " ENDED("-full -ss 6 --partial=no", "$m", "INT")
                          ENDED("-full -ss 6 -o - >piped", "$m", "TERM") "done; ls | grep 'checkpoint\\|partial'",
                      1, NULL);
}

/* `touch` is a command that makes a file of that name. */
TEST(a_file_of_the_user_with_the_name_of_a_partial_picture_stays) {
    static const char *const files[] = {"echo mine >out.partial.png",      ": >out.partial.png",
                                        "cp other.png out.partial.png",    "mkdir out.partial.png",
                                        "ln -s other.png out.partial.png", "mkfifo out.partial.png"};
    put_scene("picture('out.png')\n");
    test_shell_errors("$gray scene.lua -q --size 40x30 -o other.png", 0, NULL);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char line[1024];
        (void)snprintf(line, sizeof line,
                       "rm -rf out.partial.png; %s; ls -li --time-style=full-iso >before; cp other.png keep.png; "
                       "$gray scene.lua -q --size 40x30; rm out.png keep.png; ls -li --time-style=full-iso >after; "
                       "grep partial before >a; grep partial after >b; cmp a b",
                       files[i]);
        test_shell_errors(line, 0, NULL);
    }
    test_shell_errors("rm -rf out.partial.png; cp other.png out.partial.png; for m in " MOMENTS " 2 3 5 8; do " ENDED(
                          "-full -ss 6", "$m", "INT") "grep -q partial said.txt && break; done; cat said.txt >&2; "
                                                      "cmp out.partial.png other.png && exit $s",
                      130, "out.partial.png: exists already and is not an unfinished picture\n");
}

/* The clock goes on while the program is stopped. */
TEST_LONG(a_run_that_ends_after_a_minute_leaves_the_checkpoint_that_resume_finds) {
    put_scene("picture('a.png') picture('out.png')\n");
    test_shell_errors(
        "$gray scene.lua -q -full -ss 6 -o whole%d.png; env --default-signal=INT $gray scene.lua -full "
        "-ss 6 2>said.txt & p=$!; await 'test -e a.png'; sleep .2; all=\"$p $(cat /proc/$p/task/$p/children)"
        "\"; kill -STOP $all; sleep 61; kill -CONT $all; kill -INT $p; wait $p; s=$?; "
        "cat said.txt >&2; test -e out.png && exit 1; test -e out.partial.png && exit $s",
        130, "gray: notice: a.png.checkpoint holds ");
    test_shell_errors("$gray scene.lua -full -ss 6 --resume && cmp out.png whole2.png && cmp a.png whole1.png && "
                      "ls | grep -c 'checkpoint\\|partial'",
                      1, "come from the checkpoint");
}
