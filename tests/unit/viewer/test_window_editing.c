/* Edits in the real window (under Xvfb, driven by xdotool): the screen shows what the saved changes give without a
 * window, byte for byte; after undo it shows the script's picture. The tests do not depend on time: saved pictures are
 * compared repeatedly until they are right or a long limit has passed. */
#define _GNU_SOURCE
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>

/* `finds NAME`: S is pressed until a saved picture has the bytes of NAME. `changes N`: C writes the N-th file of
 * changes, and again.png is its picture. `until_says PATTERN STEPS MEND`: repeats the steps (the answer to a click
 * takes time) until a file of changes contains the pattern; n is its number. `drag DX DY`: with the left button, from
 * the middle of the picture. */
static const char helpers[] =
    "titled() { for i in $(seq 3000); do xdotool search --name \"$1\" >/dev/null && return 0; sleep 0.05; done; "
    "echo the title never said $1 >&2; exit 9; }\n"
    "there() { for i in $(seq 3000); do test -s \"$1\" && return 0; sleep 0.05; done; echo no $1 >&2; exit 8; }\n"
    "saved() { ls out-view*.png 2>/dev/null | wc -l; }\n"
    "finds() { for i in $(seq 200); do k=$(saved); xdotool key s; for j in $(seq 60); do [ $(saved) -gt $k ] && break; "
    "sleep 0.05; done; for view in $(ls -t out-view*.png 2>/dev/null | head -2); do cmp -s $view $1 && return 0; done; "
    "sleep 0.2; done; echo nothing like $1 >&2; exit 7; }\n"
    "changes() { xdotool key c; there out-changes$1.lua; sleep 0.1; "
    "{ echo \"require 'out-changes$1'\"; cat scene.lua; } >again.lua; "
    "$gray -q again.lua -o again.png || exit 6; }\n"
    "drag() { xdotool mousemove 450 380 mousedown 1 mousemove $((450 + $1 / 2)) $((380 + $2 / 2)) mousemove "
    "$((450 + $1)) $((380 + $2)) mouseup 1; }\n"
    "until_says() { for i in $(seq 20); do eval \"$2\"; n=$((n + 1)); xdotool key c; there out-changes$n.lua; sleep "
    "0.1; "
    "grep -q \"$1\" out-changes$n.lua && return 0; eval \"$3\"; done; echo never $1 >&2; cat out-changes$n.lua >&2; "
    "exit 5; }\n"
    "says() { grep -q \"$1\" out-changes1.lua || { echo no $1 >&2; cat out-changes1.lua >&2; exit 5; }; }\n"
    "$gray -gui -q --progress=none scene.lua & pid=$!\n"
    "there out.png; cp out.png first.png; titled ready\n";

static void file(const char *name, const char *text) {
    test_write_text(test_path(name), text);
}

static int shell(const char *line) {
    return test_run_shell(line, ">out.txt 2>err.txt");
}

/* Runs the steps, which may call the helpers, with the window of the scene. */
static void drive(const char *scene, const char *steps) {
    test_need_window();
    char *script = NULL, path[4096];
    CHECK(asprintf(&script, "%s%s\nxdotool key q; wait $pid\n", helpers, steps) > 0);
    file("scene.lua", scene);
    file("steps.sh", script);
    free(script);
    int status = shell("timeout 250 xvfb-run -a -s '-screen 0 900x700x24' sh steps.sh");
    (void)snprintf(path, sizeof path, "%s/err.txt", test_folder());
    char *said = test_read_file(path, NULL);
    if (status != 0)
        test_fail(__FILE__, __LINE__, "status %d:\n%s", status, said ? said : "");
    free(said);
}

#define BALL                                                                                                           \
    "local red = gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20)\nlocal r = gr.node('root')\n"                       \
    "r:add_child(gr.geometry('ball', gr.sphere(red)))\n"
#define RENDER(lights)                                                                                                 \
    "gr.render(r, 'out.png', 320, 240, {0, 1, 6}, {0, -0.15, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2}, {" lights "})\n"

TEST(window_that_turns_sizes_and_deletes_lights_saves_what_gives_the_same_bytes) {
    drive(BALL RENDER("gr.directional_light{direction={-1, -1, -0.5}, colour={0.4, 0.3, 0.3}}, "
                      "gr.area_light({-1, 3, 0}, {2, 0, 0}, {0, 0, 2}, {0.3, 0.3, 0.4}, {1, 0, 0}), "
                      "gr.spot_light{position={3, 1, 3}, direction={-3, -1, -3}, colour={0.5, 0.5, 0}, inner=5, "
                      "outer=8}, gr.sky_light{sky={0.2, 0.2, 0.3}}"),
          "xdotool key period key t; drag 60 40; xdotool key period key z; drag 0 -60; xdotool key period; drag 0 -70; "
          "xdotool key t; drag 30 10; xdotool key period key Delete\n"
          "changes 1; finds again.png; cmp -s again.png first.png && exit 4\n"
          "says 'change_light(1, {0, 0, 0}, {1, 1, 1}, {'; says 'change_light(2'; says 'change_light(3'; "
          "says 'change_delete_light(4'\n"
          "for i in 1 2 3 4 5; do xdotool key ctrl+z; done; finds first.png\n"
          "for i in 1 2 3 4 5; do xdotool key ctrl+y; done; finds again.png");
}

TEST(window_that_gives_a_shape_a_material_saves_what_gives_the_same_bytes) {
    /* In the panel: "A material of its own", the sliders of red and green; then emission, and its blue. */
    drive("local r = gr.node('root')\nr:add_child(gr.geometry('ball', gr.sphere('plain')))\n"
          "gr.render(r, 'out.png', 800, 600, {0, 1, 6}, {0, -0.15, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2}, "
          "{gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0})})\n",
          "at() { xdotool mousemove $1 $2 sleep 0.1 mousedown 1 sleep 0.1 mouseup 1 sleep 0.2; }\n"
          "pick() { xdotool mousemove 450 370 click 1 sleep 0.5; }\n"
          "until_says change_own 'pick; at 660 142'\n"
          "until_says 'change_material(2147483647, ' 'pick; at 800 166; at 640 176'\n"
          "until_says 'change_look(2147483647, .emission., ' 'pick; at 720 154; at 660 186'\n"
          "changes $((n + 1)); finds again.png; cmp -s again.png first.png && exit 4\n"
          "for i in $(seq 40); do xdotool key ctrl+z; done; finds first.png\n"
          "for i in $(seq 40); do xdotool key ctrl+y; done; finds again.png\n");
}

TEST(window_that_changes_operands_of_a_solid_saves_what_gives_the_same_bytes) {
    /* A ball is subtracted from a larger one: Ctrl-click in the middle selects the hollow. */
    drive(
        "local function m(r, g, b) return gr.material({r, g, b}, {0.4, 0.4, 0.4}, 20) end\nlocal r = gr.node('root')\n"
        "local a, b = gr.geometry('a', gr.sphere(m(0.8, 0.2, 0.1))), gr.geometry('b', gr.sphere(m(0.1, 0.8, 0.1)))\n"
        "a:scale(1.5, 1.5, 1.5)\nb:translate(0, 0, 1.2)\nr:add_child(gr.csg_difference('cut', a, b))\n"
        "gr.render(r, 'out.png', 320, 240, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2}, "
        "{gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0})})\n",
        "pick() { xdotool mousemove 450 380 keydown ctrl click 1 sleep 0.1 keyup ctrl sleep 0.5; }\n"
        "until_says \"change_node('b'\" 'xdotool key Home; pick; xdotool key m; drag 20 -12; xdotool key m sleep 0.2'\n"
        "xdotool key z; drag 0 20; xdotool key t; drag 10 10; xdotool key t Home\n"
        "n=$((n + 1)); changes $n; finds again.png; cmp -s again.png first.png && exit 4\n"
        "grep -q \"'cut'\\|'a'\" out-changes$n.lua && exit 3\n"
        "for i in $(seq 9); do xdotool key ctrl+z; done; finds first.png\n"
        /* Without the hollow; and without the whole solid. */
        "until_says \"change_delete('b'\" 'pick; xdotool key Delete sleep 0.2' 'xdotool key ctrl+z'\n"
        "n=$((n + 1)); changes $n; finds again.png; cmp -s again.png first.png && exit 2; xdotool key ctrl+z\n"
        "until_says \"change_delete('cut'\" 'pick; xdotool key Prior sleep 0.5 key Delete sleep 0.2' "
        "'xdotool key ctrl+z'\n"
        "n=$((n + 1)); changes $n; finds again.png; xdotool key ctrl+z; finds first.png\n");
}

TEST(window_that_turns_a_sky_turns_what_is_seen_behind_and_saves_what_gives_the_same_bytes) {
    drive(BALL
          "local s = gr.clear_sky{sun={0.6, 0.5, 1}, intensity=0.05}\n"
          "gr.render{node=r, file='out.png', width=320, height=240, eye={0, 1, 6}, view={0, -0.15, -1}, up={0, 1, 0}, "
          "fov=40, ambient={0, 0, 0}, background=s, lights={gr.sky_light{sky=s, samples=1}}}\n",
          "xdotool key period key t; drag 70 -20\n" /* also upwards, which has no effect */
          "changes 1; finds again.png; cmp -s again.png first.png && exit 4\n"
          "says 'change_light(1, {0, 0, 0}, {1, 1, 1}, {0[.][0-9]*, 0, 0[.][0-9]*, 0, 1, 0, '\n"
          "xdotool key ctrl+z; finds first.png\n");
}

TEST(window_that_has_more_lights_than_one_message_changes_the_last_one) {
    drive(BALL "local lamps = {}\nfor i = 1, 70 do lamps[i] = gr.light({math.sin(i) * 5, 3, math.cos(i) * 5}, {0.005, "
               "0.005, 0.005}, {1, 0, 0}) end\nlamps[71] = gr.sun_light{sun={1, 2, 3}, colour={0.4, 0.4, 0.3}}\n"
               "gr.render(r, 'out.png', 320, 240, {0, 1, 6}, {0, -0.15, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2}, lamps)\n",
          "xdotool key i key comma key t; drag 70 -20\n"
          "changes 1; finds again.png; cmp -s again.png first.png && exit 4\n"
          "says 'change_light(71, '\n"
          "xdotool key ctrl+z; finds first.png\n");
}
