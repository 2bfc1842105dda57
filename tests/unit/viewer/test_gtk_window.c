/* The program in a window by GTK, on a virtual display with a window manager, driven by keys and mouse. Its title says
 * what it does. */
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Runs commands beside the program, whose process is $pid; `titled WORDS` waits for a title. They end it themselves. */
static void drive(const char *options, const char *commands, int status) {
    static const char frame[] =
        "openbox >/dev/null 2>&1 & manager=$!\n"
        "titled() { for i in $(seq 600); do xdotool search --name \"$1\" >/dev/null 2>&1 && return 0; sleep 0.05; "
        "done; "
        "kill $pid; exit 99; }\n"
        "until_file() { for i in $(seq 600); do test -s \"$1\" && return 0; sleep 0.05; done; kill $pid; exit 98; }\n"
        "$gray -gui --progress=none %s & pid=$!\n"
        "%s\n"
        "wait $pid; status=$?; kill $manager; exit $status\n";
    char *script, path[4096];
    size_t size = sizeof frame + strlen(options) + strlen(commands);
    script = malloc(size);
    (void)snprintf(script, size, frame, options, commands);
    (void)snprintf(path, sizeof path, "%s/drive.sh", test_folder());
    test_write_text(path, script);
    int got = test_run_shell("timeout 100 xvfb-run -a -s '-screen 0 1400x900x24' sh drive.sh", ">out.txt 2>err.txt");
    char *said = test_read_file(test_path("err.txt"), NULL);
    if (got != status)
        test_fail(__FILE__, __LINE__, "%s\nstatus %d, not %d:\n%s", commands, got, status, said ? said : "");
    free(said);
    free(script);
}

static void need_display(void) {
    char path[4096];
    test_need_window();
    (void)snprintf(path, sizeof path, "%s/scene.lua", test_folder());
    test_write_text(path,
                    "local r = gr.node('root')\n"
                    "r:add_child(gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20))))\n"
                    "gr.render(r, 'out.png', 200, 150, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2},\n"
                    "  {gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0})})\n");
}

static void gives(const char *line, int status) {
    int got = test_run_shell(line, ">>out.txt 2>>err.txt");
    if (got != status)
        test_fail(__FILE__, __LINE__, "%s\nstatus %d, not %d", line, got, status);
}

TEST(gtk_window_makes_the_picture_of_the_program_without) {
    need_display();
    gives("$gray scene.lua -o whole.png", 0);
    drive("scene.lua", "titled 'out.png - ready'; until_file out.png; xdotool key ctrl+q", 0);
    gives("cmp out.png whole.png", 0);
}

/* In a locale that is made here, if this machine has its sources. */
static void edit_in_locale(const char *name) {
    char line[512], locale[64];
    need_display();
    (void)snprintf(locale, sizeof locale, "%s.UTF-8", name);
    (void)snprintf(line, sizeof line, "mkdir locale && localedef -i %s -f UTF-8 locale/%s", name, locale);
    (void)test_run_shell(line, ">/dev/null 2>&1");
    (void)setenv("LOCPATH", test_path("locale"), 1);
    (void)setenv("LC_ALL", locale, 1);
    drive("scene.lua --exposure 0.5",
          "titled 'out.png - ready'\n"
          "xdotool mousemove 600 460 click 1 sleep 0.5 key g\n"
          "xdotool mousemove 600 460 mousedown 1 mousemove 620 460 sleep 0.1 mousemove 700 460 sleep 0.3 mouseup 1\n"
          "sleep 0.3; titled 'out.png - ready'; xdotool key ctrl+s; until_file out-changes1.lua\n"
          "xdotool key ctrl+z sleep 0.3 key ctrl+s; until_file out-changes2.lua; xdotool key ctrl+q",
          0);
    gives("grep -q \"gr.change_node('ball', 2, {1, 0, 0, 0*[.0-9]*[1-9]\" out-changes1.lua", 0);
    gives("! grep -q change_node out-changes2.lua", 0);
    gives("{ echo \"require 'out-changes1'\"; cat scene.lua; } >again.lua; $gray again.lua", 0);
}

/* Numbers have a comma in Germany, and the small letter of I is another one in Turkey. */
TEST(gtk_window_selects_moves_undoes_and_saves_in_german) {
    edit_in_locale("de_DE");
}

TEST(gtk_window_selects_moves_undoes_and_saves_in_turkish) {
    edit_in_locale("tr_TR");
}

TEST(gtk_window_opens_without_a_scene_and_quits) {
    need_display();
    drive("", "titled gray; sleep 0.3; xdotool key ctrl+q", 0);
    test_run_shell("$gray", ">out.txt 2>err.txt");
    char *said = test_read_file(test_path("err.txt"), NULL);
    CHECK(said && strstr(said, "no scene script was given"));
    free(said);
}

TEST(gtk_window_without_a_display_says_so) {
    need_display();
    gives("env -u DISPLAY -u WAYLAND_DISPLAY $gray -gui scene.lua", 3);
    char *said = test_read_file(test_path("err.txt"), NULL);
    CHECK(said && strstr(said, "-gui: no window can be opened: there is no display"));
    free(said);
}

/* A script with an error stays in the window, which renders it as soon as it is mended. */
TEST(gtk_window_shows_an_error_and_renders_the_mended_script) {
    need_display();
    gives("cp scene.lua good.lua; sed '1i gr.shpere()' good.lua >scene.lua", 0);
    drive("scene.lua",
          "sleep 1; cp good.lua scene.lua; titled 'out.png - ready'; until_file out.png; xdotool key ctrl+q", 0);
}

TEST(gtk_window_that_is_closed_early_leaves_no_picture) {
    need_display();
    gives("sed -i 's/200, 150/1200, 900/; 1i for i = 1, 1e7 do local a = math.sin(i) end' scene.lua", 0);
    drive("-full -ss 40 scene.lua", "titled '(scene.lua|out.png) - '; xdotool key ctrl+q", 130);
    gives("test ! -e out.png", 0);
}

/* The newest child is the render process. Each time the window says what has happened, and runs the script again. */
TEST(gtk_window_survives_a_killed_render_process) {
    need_display();
    drive("scene.lua",
          "for i in 1 2 3 4 5; do titled 'out.png - ready'; rm -f out.png; kill -9 $(pgrep -n -P $pid)\n"
          "titled 'waiting for a change'; xdotool key F5; until_file out.png; done; xdotool key ctrl+q",
          0);
    char *said = test_read_file(test_path("err.txt"), NULL);
    CHECK(said && strstr(said, "scene.lua: the render process was killed"));
    free(said);
}

/* Escape keeps the window; Discard leaves no file. */
TEST(gtk_window_asks_before_edits_are_lost) {
    need_display();
    drive("scene.lua",
          "titled 'out.png - ready'; xdotool mousemove 600 460 click 1 sleep 0.5 key x sleep 0.5\n"
          "titled 'out.png - ready'; xdotool key ctrl+q sleep 1 key Escape sleep 0.5; kill -0 $pid || exit 97\n"
          "xdotool key ctrl+q sleep 1 key alt+d",
          0);
    gives("test ! -e out-changes1.lua", 0);
    drive("scene.lua",
          "titled 'out.png - ready'; xdotool mousemove 600 460 click 1 sleep 0.5 key x sleep 0.5\n"
          "titled 'out.png - ready'; xdotool key ctrl+q sleep 1 key alt+s",
          0);
    gives("grep -q \"gr.change_delete('ball'\" out-changes1.lua", 0);
}

/* Without input: it opens, draws, writes the picture, and ends by a signal. */
TEST(gtk_window_opens_under_wayland) {
    need_display();
    test_need_tools("weston");
    gives("chmod 700 . && { weston --backend=headless-backend.so --socket=gray-test >weston.txt 2>&1 & weston=$!; "
          "await 'test -S gray-test'; WAYLAND_DISPLAY=gray-test GDK_BACKEND=wayland DISPLAY= $gray -gui scene.lua & "
          "pid=$!; "
          "await 'test -s out.png'; kill -TERM $pid; wait $pid; status=$?; kill $weston; wait $weston; exit $status; }",
          130);
    gives("! grep 'is not written' err.txt && $gray scene.lua -o whole.png && cmp out.png whole.png", 0);
}

/* A dot of the desktop has two pixels of the screen, and the picture all of them. */
TEST(gtk_window_draws_at_scale_2) {
    need_display();
    CHECK(setenv("GDK_SCALE", "2", 1) == 0);
    drive("--verbose scene.lua", "titled 'out.png - ready'; xdotool key ctrl+q", 0);
    char *said = test_read_file(test_path("err.txt"), NULL);
    CHECK(said && strstr(said, "pixels, density 2"));
    free(said);
}
