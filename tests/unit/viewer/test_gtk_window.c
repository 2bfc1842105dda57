/* The program in a window by GTK, on a virtual display with a window manager, driven by keys and mouse. Its title says
 * what it does. */
#include "tests/harness.h"

#include "window/actions.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Runs commands beside the program, whose process is $pid, and which they end. `titled WORDS` waits for a title of the
 * window that has the keyboard, `edit KEYS` does what may come too early until the title has the star of unsaved edits,
 * `asked` waits for a dialog. */
static void drive(const char *options, const char *commands, int status) {
    static const char frame[] =
        "openbox >/dev/null 2>&1 & manager=$!; until xdotool get_desktop >/dev/null 2>&1; do sleep 0.05; done\n"
        "is() { xdotool getactivewindow getwindowname 2>/dev/null | grep -Eq \"$1\"; }\n"
        "titled() { for i in $(seq 600); do is \"$1\" && return 0; sleep 0.05; done; kill $pid; exit 99; }\n"
        "edit() { for try in 1 2 3 4 5; do eval \"$1\"; for i in $(seq 150); do is '[*] - ready' && return 0; sleep "
        "0.05; done; done; kill $pid; exit 97; }\n"
        "asked() { for i in $(seq 600); do is . || return 0; sleep 0.05; done; kill $pid; exit 96; }\n"
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
    int got = test_run_shell("screen sh drive.sh", ">out.txt 2>err.txt");
    char *said = test_read_file(test_path("err.txt"), NULL);
    if (got != status)
        test_fail(__FILE__, __LINE__, "%.600s\nstatus %d, not %d:\n%s", commands, got, status,
                  said && strlen(said) > 1500 ? said + strlen(said) - 1500
                  : said                      ? said
                                              : "");
    free(said);
    free(script);
}

/* On standard error. */
static void has_said(const char *text) {
    char *said = test_read_file(test_path("err.txt"), NULL);
    if (!said || !strstr(said, text))
        test_fail(__FILE__, __LINE__, "\"%s\" was not said, but \"%.600s\"", text, said ? said : "");
    free(said);
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

/* Names of actions that change what the next ones need are done last. */
static bool ends_scene(enum window_action action) {
    return action == DO_QUIT || action == DO_NEXT_PICTURE;
}

/* The window asks for a name first. */
static bool asks(int action) {
    return action == DO_EXPORT_MODEL;
}

/* The same key again takes it back; what was deleted is undone. */
static bool repeats(enum window_action action) {
    return action == DO_DELETE || action == DO_FULL_SCREEN || action == DO_HIDE || action == DO_PLAY ||
           action == DO_STOP || action == DO_SOLO;
}

/* A key as xdotool writes it: "<Control><Shift>s" is ctrl+shift+s. */
static void key_for_tool(const char *key, size_t length, char *out, size_t size) {
    static const char *const modifiers[][2] = {{"<Control>", "ctrl+"}, {"<Shift>", "shift+"}, {"<Alt>", "alt+"}};
    out[0] = '\0';
    for (size_t i = 0; i < 6; i++) {
        const char *const *modifier = modifiers[i % 3];
        size_t words = strlen(modifier[0]);
        if (strncmp(key, modifier[0], words) != 0)
            continue;
        (void)snprintf(out + strlen(out), size - strlen(out), "%s", modifier[1]);
        key += words;
        length -= words;
    }
    (void)snprintf(out + strlen(out), size - strlen(out), "%.*s", (int)length, key);
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
          "edit 'xdotool mousemove 600 460 click 1 sleep 0.5 key g mousemove 620 460 sleep 0.1 mousemove 700 460 sleep "
          "0.3 click 1'\n"
          "xdotool key ctrl+s; until_file out-changes1.lua; titled 'out.png - ready'\n"
          "edit 'xdotool key ctrl+z'; xdotool key ctrl+s; until_file out-changes2.lua; titled 'out.png - ready'\n"
          "xdotool key ctrl+q",
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
    has_said("no scene script was given");
}

TEST(gtk_window_without_a_display_says_so) {
    need_display();
    gives("env -u DISPLAY -u WAYLAND_DISPLAY $gray -gui scene.lua", 3);
    has_said("-gui: no window can be opened: there is no display");
}

TEST(gtk_window_without_any_font_says_so) {
    need_display();
    gives("echo '<fontconfig></fontconfig>' >none.conf; export FONTCONFIG_FILE=$PWD/none.conf; screen $gray -gui "
          "scene.lua",
          3);
    has_said("-gui: no window can be opened: fontconfig finds no font");
}

/* A resize while the mouse holds the selection loses neither. */
TEST(gtk_window_keeps_an_edit_during_a_resize) {
    need_display();
    drive("scene.lua",
          "titled 'out.png - ready'; edit 'xdotool mousemove 600 460 click 1 sleep 0.5 key g mousemove 650 460 sleep "
          "0.3'\n"
          "xdotool search --onlyvisible --name out.png windowsize 900 650 sleep 0.5; xdotool click 1 sleep 0.5\n"
          "titled 'out.png[*] - ready'; xdotool key ctrl+s; until_file out-changes1.lua; titled 'out.png - '\n"
          "xdotool key ctrl+q",
          0);
    gives("grep -q \"gr.change_node('ball', 2, {1, 0, 0, 0*[.0-9]*[1-9]\" out-changes1.lua", 0);
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
    drive("-full -ss 40 scene.lua",
          "titled '(scene.lua|out.png) - '\n" /* it may not have the keyboard yet */
          "for k in $(seq 100); do xdotool key ctrl+q sleep 0.2; kill -0 $pid 2>/dev/null || break; done",
          130);
    gives("test ! -e out.png", 0);
}

/* The newest child is the render process. Each time the window says what has happened, and runs the script again. */
TEST(gtk_window_survives_a_killed_render_process) {
    need_display();
    drive("scene.lua",
          "for i in 1 2 3 4 5; do titled 'out.png - ready'; rm -f out.png; kill -9 $(pgrep -n -P $pid)\n"
          "titled 'waiting for a change'; xdotool key F5; until_file out.png; done; xdotool key ctrl+q",
          0);
    has_said("scene.lua: the render process was killed");
}

/* Escape keeps the window; Discard leaves no file. */
TEST(gtk_window_asks_before_edits_are_lost) {
    need_display();
    drive("scene.lua",
          "titled 'out.png - ready'; edit 'xdotool mousemove 600 460 click 1 sleep 0.5 key x'\n"
          "xdotool key ctrl+q; asked; xdotool sleep 0.5 key Escape; titled 'out.png[*] - ready'\n"
          "xdotool key ctrl+q; asked; xdotool sleep 0.5 key alt+d",
          0);
    gives("test ! -e out-changes1.lua", 0);
    drive("scene.lua",
          "titled 'out.png - ready'; edit 'xdotool mousemove 600 460 click 1 sleep 0.5 key x'\n"
          "xdotool key ctrl+q; asked; xdotool sleep 0.5 key alt+s",
          0);
    gives("grep -q \"gr.change_delete('ball'\" out-changes1.lua", 0);
}

TEST(gtk_window_exports_a_model_under_the_name_that_is_typed) {
    need_display();
    drive("scene.lua",
          "titled 'out.png - ready'; xdotool mousemove 600 460 key ctrl+e; titled 'Export a Model'\n"
          "xdotool sleep 0.5 key ctrl+a type --delay 20 $PWD/part.3mf; xdotool key Return; until_file part.3mf\n"
          "sleep 0.5; xdotool key ctrl+q",
          0);
    gives("$gray scene.lua -o same.3mf && cmp part.3mf same.3mf", 0);
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
    has_said("pixels, density 2");
}

static const char animation[] =
    "local r = gr.node('root')\n"
    "r:add_child(gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20))))\n"
    "gr.frames{count = 5, loop = true, draw = function(t) return {node = r, file = 'out.png', width = 200, height = "
    "150, "
    "eye = {0, 0, 6}, view = {0, 0, -1}, fov = 40} end}\n";

/* Every action, by each of its keys in a set: the program reports what it does. Before each, the ball is selected at
 * the camera of the script; after it Esc ends what it began, and what it has changed is undone. */
static void press_every_key(enum window_key_set set) {
    enum { SIZE = 1 << 16 };
    static char commands[SIZE];
    char key[64], path[4096];
    size_t used = 0;
    need_display();
    (void)snprintf(path, sizeof path, "%s/scene.lua", test_folder());
    test_write_text(path, animation);
    test_write_text(test_path("keys.ini"), set == KEYS_OPENSCAD ? "[window]\nkeys=OpenSCAD\n" : "");
    gives("mkdir -p gray && mv keys.ini gray/window.ini", 0);
    used += (size_t)snprintf(
        commands + used, SIZE - used,
        "did() { for i in $(seq 60); do [ $(grep -c \"window: $1\\$\" err.txt) -gt $2 ] && return 0; sleep 0.05; "
        "done; return 1; }\n"
        "press() { for try in 1 2 3 4; do titled ' - (ready|stopped|waiting)'\n"
        "xdotool mousemove 600 460 click 1 sleep $((try / 2)).5; n=$(grep -c \"window: $2\\$\" err.txt)\n"
        "xdotool key $1; did $2 $n && { xdotool key Escape; return 0; }; done\n"
        "echo \"no $2 by $1\" >&2; kill $pid; exit 97; }\n"
        "titled ' - playing'; xdotool key space; titled ' - ready'\n");
    for (int last = 0; last < 2; last++) {
        for (int i = 0; i < WINDOW_ACTION_COUNT; i++) {
            const struct window_action_row *row = &window_action_table[i];
            for (const char *at = row->keys[set]; *at && ends_scene((enum window_action)i) == last && !asks(i);) {
                size_t length = strcspn(at, " ");
                key_for_tool(at, length, key, sizeof key);
                used += i == DO_QUIT ? (size_t)snprintf(commands + used, SIZE - used, "xdotool key %s\n", key)
                                     : (size_t)snprintf(commands + used, SIZE - used, "press %s %s\n", key, row->name);
                if (row->menu == MENU_VIEW)
                    used += (size_t)snprintf(commands + used, SIZE - used, "xdotool key %s\n",
                                             set == KEYS_BLENDER ? "0" : "ctrl+0");
                if (repeats((enum window_action)i))
                    used += (size_t)snprintf(commands + used, SIZE - used, "xdotool key %s sleep 0.5\n",
                                             i == DO_DELETE ? "ctrl+z"
                                             : i == DO_PLAY ? "Escape"
                                                            : key);
                at += length + strspn(at + length, " ");
            }
        }
    }
    (void)used;
    /* The window asks whether it may discard the edits: Alt+D. */
    drive("--verbose scene.lua", strcat(commands, "sleep 0.5; xdotool key alt+d"), 0);
}

TEST_LONG(gtk_window_does_every_action_by_its_keys) {
    press_every_key(KEYS_BLENDER);
}

TEST_LONG(gtk_window_does_every_action_by_the_keys_of_openscad) {
    press_every_key(KEYS_OPENSCAD);
}

/* What a screen reader finds: every widget with a role for input has a name of its own, not that of its class; and
 * every action of the menus can be done without a key or a mouse. */
static const char reader[] =
    "import pyatspi, sys, time\n"
    "roles = {'push button', 'toggle button', 'spin button', 'slider', 'check box', 'combo box', 'text', 'entry', "
    "'list',\n"
    "         'image', 'menu item', 'table', 'tree'}\n"
    "def walk(node):\n"
    "    yield node\n"
    "    for i in range(node.childCount):\n"
    "        child = node.getChildAtIndex(i)\n"
    "        if child: yield from walk(child)\n"
    "def frames():\n"
    "    return [f for app in pyatspi.Registry.getDesktop(0) if app for f in app if f and "
    "f.name.startswith('out.png')]\n"
    "for attempt in range(200):\n"
    "    if frames(): break\n"
    "    time.sleep(0.1)\n"
    "frame = frames()[0]\n"
    "named = [n for n in walk(frame) if n.getRoleName() in roles]\n"
    "for n in named:\n"
    "    if not n.name or n.name.startswith('Gtk'): sys.exit('no name: %s %s' % (n.getRoleName(), n.name))\n"
    "if len(named) < 60: sys.exit('only %d widgets' % len(named))\n"
    "if len(sys.argv) == 1: sys.exit(0)\n"
    "for name in sys.argv[1:]:\n"
    "    action = frame.queryAction()\n"
    "    names = [action.getName(i) for i in range(action.nActions)]\n"
    "    action.doAction(names.index('win.' + name))\n"
    "    time.sleep(0.4)\n";

static void need_reader(void) {
    need_display();
    test_need_tools("dbus-run-session");
    if (test_run_shell("/usr/bin/python3 -c 'import pyatspi' && test -x /usr/libexec/at-spi-bus-launcher",
                       ">/dev/null 2>&1") != 0)
        test_lacks("there is no at-spi2-core with python3-pyatspi");
    test_write_text(test_path("reader.py"), reader);
}

TEST(gtk_window_has_names_for_screen_readers_on_all_widgets) {
    need_reader();
    gives("cat >names.sh <<'END'\n"
          "openbox >/dev/null 2>&1 & manager=$!\n$gray -gui --progress=none scene.lua & pid=$!\n"
          "/usr/bin/python3 reader.py; status=$?; kill $pid; wait $pid; kill $manager; exit $status\nEND\n"
          "screen dbus-run-session -- sh names.sh",
          0);
}

/* Those that need a selection or an animation are not there. */
TEST_LONG(gtk_window_does_every_action_of_its_menus) {
    enum { SIZE = 8192 };
    static char line[SIZE];
    char pattern[64];
    need_reader();
    size_t used = (size_t)snprintf(
        line, SIZE,
        "cat >menus.sh <<'END'\n"
        "openbox >/dev/null 2>&1 & manager=$!\n$gray -gui --verbose --progress=none scene.lua 2>said.txt & pid=$!\n"
        "/usr/bin/python3 reader.py");
    for (int i = 0; i < WINDOW_ACTION_COUNT; i++) {
        enum action_need need = window_action_table[i].need;
        if (need != NEEDS_SELECTION && need != NEEDS_FRAMES && !ends_scene((enum window_action)i) && !asks(i))
            used += (size_t)snprintf(line + used, SIZE - used, " %s", window_action_table[i].name);
    }
    (void)snprintf(line + used, SIZE - used,
                   "; status=$?; kill $pid; wait $pid; kill $manager; exit $status\nEND\n"
                   "screen dbus-run-session -- sh menus.sh");
    gives(line, 0);
    char *said = test_read_file(test_path("said.txt"), NULL);
    for (int i = 0; i < WINDOW_ACTION_COUNT; i++) {
        enum action_need need = window_action_table[i].need;
        (void)snprintf(pattern, sizeof pattern, "window: %s\n", window_action_table[i].name);
        if (need != NEEDS_SELECTION && need != NEEDS_FRAMES && !ends_scene((enum window_action)i) && !asks(i) &&
            (!said || !strstr(said, pattern)))
            test_fail(__FILE__, __LINE__, "%s was not done", window_action_table[i].name);
    }
    free(said);
}

TEST_LONG(gtk_window_survives_a_hundred_killed_render_processes) {
    need_display();
    drive("scene.lua",
          "for k in $(seq 100); do titled 'out.png - ready'; rm -f out.png; kill -9 $(pgrep -n -P $pid)\n"
          "titled 'waiting for a change'; xdotool key F5; until_file out.png; done; xdotool key ctrl+q",
          0);
}

/* g x 1 Return. */
TEST(gtk_window_moves_by_typed_numbers) {
    need_display();
    drive("scene.lua",
          "titled 'out.png - ready'; edit 'xdotool mousemove 600 460 click 1 sleep 1 key g key x key 1 key Return'\n"
          "xdotool key ctrl+s; until_file out-changes1.lua; titled 'out.png - '; xdotool key ctrl+q",
          0);
    gives("grep -q \"gr.change_node('ball', 2, {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0})\" out-changes1.lua", 0);
}

/* Another program's window in the corner, from which files are dragged. */
static const char dragged[] = "import gi, sys\n"
                              "gi.require_version('Gdk', '4.0')\n"
                              "gi.require_version('Gtk', '4.0')\n"
                              "from gi.repository import Gdk, Gio, GObject, Gtk\n"
                              "def show(app):\n"
                              "    files = Gdk.FileList.new_from_list([Gio.File.new_for_path(sys.argv[1])])\n"
                              "    source = Gtk.DragSource()\n"
                              "    source.connect('prepare', lambda *_: Gdk.ContentProvider.new_for_value("
                              "GObject.Value(Gdk.FileList, files)))\n"
                              "    window = Gtk.ApplicationWindow(application=app, title='files', default_width=100, "
                              "default_height=100)\n"
                              "    window.set_child(Gtk.Label(label='files'))\n"
                              "    window.get_child().add_controller(source)\n"
                              "    window.present()\n"
                              "app = Gtk.Application()\n"
                              "app.connect('activate', show)\n"
                              "app.run([])\n";

/* Until the window has the title, since a drag may come too early. */
static void drag(const char *path, const char *title, const char *then) {
    char commands[4096];
    if (test_run_shell("/usr/bin/python3 -c \"import gi; gi.require_version('Gtk', '4.0')\"", ">/dev/null 2>&1") != 0)
        test_lacks("there is no gir1.2-gtk-4.0 with python3-gi");
    test_write_text(test_path("files.py"), dragged);
    (void)snprintf(
        commands, sizeof commands,
        "titled 'out.png - ready'; window=$(xdotool getactivewindow)\n"
        "/usr/bin/python3 files.py %s & source=$!; titled '^files$'; files=$(xdotool getactivewindow)\n"
        "xdotool windowmove --sync $files 1200 700\n"
        "drag() { xdotool windowactivate --sync $files mousemove 1250 760 sleep 0.3 mousedown 1\n"
        "    for i in 1 2 3 4 5 6 7 8 9 10; do xdotool mousemove_relative -- -60 -30 sleep 0.05; done\n"
        "    xdotool mousemove 602 462 sleep 0.5 mousemove 600 460 sleep 0.5 mouseup 1 sleep 0.2\n"
        "    xdotool windowactivate --sync $window; }\n"
        "until_dragged() { for try in 1 2 3 4 5; do drag; for i in $(seq 150); do is '%s' && return 0; sleep "
        "0.05; done; done; kill $pid; exit 95; }\n"
        "until_dragged; kill $source\n%s",
        path, title, then);
    drive("scene.lua", commands, 0);
}

TEST(gtk_window_opens_a_scene_that_is_dropped) {
    need_display();
    gives("sed 's/out.png/other.png/' scene.lua >other.lua", 0);
    drag("other.lua", "other.png - ready", "xdotool key ctrl+q");
    gives("test -s out.png && $gray other.lua -o same.png && cmp other.png same.png", 0);
}

TEST(gtk_window_paints_a_shape_with_a_picture_that_is_dropped_on_it) {
    need_display();
    gives("$gray -q scene.lua -o dots.png", 0);
    drag("dots.png", "[*] - ready",
         "xdotool key ctrl+s; until_file out-changes1.lua; titled 'out.png - '; xdotool key ctrl+q");
    gives("grep -q 'gr.change_texture(1, .*gr.texture(.*dots.png' out-changes1.lua", 0);
}

/* The sizes of the panels and the keys of one run are those of the next. */
TEST(gtk_window_keeps_its_choices) {
    need_display();
    gives("mkdir -p gray && printf '[window]\\nwidth=1100\\nheight=700\\ntree=260\\nkeys=OpenSCAD\\ndark=true\\n' "
          ">gray/window.ini",
          0);
    drive("scene.lua", "titled 'out.png - ready'; xdotool key ctrl+q", 0);
    gives("grep -q ^width=1100 gray/window.ini && grep -q ^tree=260 gray/window.ini && grep -q ^keys=OpenSCAD "
          "gray/window.ini && grep -q ^dark=true gray/window.ini",
          0);
}

/* As where GTK was not there when gray was built: its program for the window is not beside it. */
TEST(gray_without_a_window_says_what_to_install) {
    gives("cp $gray ./alone && ./alone -gui scene.lua", 2);
    char *said = test_read_file(test_path("err.txt"), NULL);
    CHECK(said && strstr(said, "alone-gui does not exist; it is built if pkg-config finds gtk4 (Debian: libgtk-4-dev; "
                               "tools/setup.sh --window)"));
    free(said);
}

/* Where the handles of a selection at the origin are: the camera is at {5, 4, 6}, the pixel of the mouse at 600, 460 is
 * known from its explanation, the size of the picture from --verbose. A line for each: from where to where to drag. */
static const char handles[] =
    "function project(x, y, z,   depth) {\n"
    "    depth = d + L * (x * f[0] + y * f[1] + z * f[2])\n"
    "    px = cx + F * L * (x * r[0] + z * r[2]) / depth; py = cy - F * L * (x * u[0] + y * u[1] + z * u[2]) / depth "
    "}\n"
    "BEGIN {\n"
    "    zoom = wide / 200 < high / 150 ? wide / 200 : high / 150\n"
    "    cx = 600 + (99.5 - ux) * zoom; cy = 460 + (74.5 - uy) * zoom\n"
    "    d = sqrt(77); e[0] = 5; e[1] = 4; e[2] = 6; for (i = 0; i < 3; i++) f[i] = -e[i] / d\n"
    "    n = sqrt(f[0] * f[0] + f[2] * f[2]); r[0] = -f[2] / n; r[2] = f[0] / n\n"
    "    u[0] = -r[2] * f[1]; u[1] = r[2] * f[0] - r[0] * f[2]; u[2] = r[0] * f[1]\n"
    "    F = 75 * zoom * cos(0.34906585) / sin(0.34906585); L = 90 * d / F\n"
    "    for (tool = 0; tool < 3; tool++) for (a = 0; a < 3; a++) {\n"
    "        for (k = 0; k < 2; k++) {\n"
    "            t = (0.5 + 0.4 * k) * 1.57079633; for (i = 0; i < 3; i++) p[i] = 0\n"
    "            if (tool == 1) { p[(a + 1) % 3] = 0.6 * cos(t); p[(a + 2) % 3] = 0.6 * sin(t) }\n"
    "            else p[a] = (tool ? 1.16 : 0.85) + 0.5 * k\n"
    "            project(p[0], p[1], p[2]); printf \"%d %d \", px + 0.5, py + 0.5 }\n"
    "        print tool * 3 + a + 1 } }\n";

/* The matrix of the ball in the file of the saved edits with that number, or false. */
static bool read_matrix(int number, double m[12]) {
    char name[64];
    (void)snprintf(name, sizeof name, "out-changes%d.lua", number);
    char *text = test_read_file(test_path(name), NULL), *at = text ? strstr(text, "gr.change_node('ball', ") : NULL;
    at = at ? strchr(at, '{') : NULL;
    for (int i = 0; at && i < 12; i++)
        m[i] = strtod(at + 1, &at);
    free(text);
    return at != NULL;
}

/* Only along its axis, only about it. */
static void check_handle(int number) {
    int tool = (number - 1) / 3, axis = (number - 1) % 3;
    double m[12];
    if (!read_matrix(number, m)) {
        test_fail(__FILE__, __LINE__, "handle %d did nothing", number);
        return;
    }
    for (int i = 0; i < 12; i++) {
        int row = i / 4, column = i % 4;
        bool own = tool == 0 ? column == 3 && row == axis : tool == 2 && column == row && row == axis;
        bool turned = tool == 1 && column < 3 && row != axis && column != axis;
        double plain = column == row ? 1 : 0;
        if (own || turned ? fabs(m[i] - plain) < 0.02 : fabs(m[i] - plain) > 1e-9)
            test_fail(__FILE__, __LINE__, "handle %d: entry %d of the matrix is %g", number, i, m[i]);
    }
}

TEST_LONG(gtk_window_moves_turns_and_scales_by_the_handles_of_every_axis) {
    need_display();
    test_write_text(test_path("handles.awk"), handles);
    gives("sed -i 's/{0, 0, 6}, {0, 0, -1}/{5, 4, 6}, {-5, -4, -6}/' scene.lua", 0);
    drive(
        "--verbose scene.lua",
        "titled 'out.png - ready'; xdotool mousemove 600 460 sleep 0.3 key p\n"
        "await \"grep -q ', pixel [0-9]*,[0-9]* of' out.txt\"; sleep 1.5; xdotool key Escape sleep 1\n"
        "set -- $(sed -n 's/.*pixels* \\([0-9]*\\),\\([0-9]*\\) of.*/\\1 \\2/p' out.txt | tail -1)\n"
        "size=$(sed -n 's/.*picture of \\([0-9]*\\)x\\([0-9]*\\) pixels.*/-v wide=\\1 -v high=\\2/p' err.txt | tail "
        "-1)\n"
        "xdotool click 1 sleep 1.5; titled 'out.png - ready'\n"
        "awk -v ux=$1 -v uy=$2 $size -f handles.awk >places.txt\n"
        "while read x0 y0 x1 y1 n; do\n"
        "  xdotool mousemove $x0 $y0 sleep 0.2 mousedown 1 sleep 0.2 mousemove $x1 $y1 sleep 0.2 mouseup 1 sleep 0.5\n"
        "  titled 'out.png[*]? - ready'; xdotool key ctrl+s; until_file out-changes$n.lua; xdotool key ctrl+z sleep "
        "0.5\n"
        "done <places.txt; xdotool key ctrl+q sleep 0.5 key alt+d",
        0);
    for (int number = 1; number <= 9; number++)
        check_handle(number);
}

/* g x 1, r z 90, s y 2 and their like, for every tool and axis. */
TEST_LONG(gtk_window_moves_turns_and_scales_by_typed_numbers_along_every_axis) {
    need_display();
    drive("scene.lua",
          "titled 'out.png - ready'; xdotool mousemove 600 460 click 1 sleep 1; n=0\n"
          "for key in 'g x 3' 'g y 3' 'g z 3' 'r x 9 0' 'r y 9 0' 'r z 9 0' 's x 2' 's y 2' 's z 2'; do\n"
          "  n=$((n + 1)); for k in $key; do xdotool key $k sleep 0.1; done; xdotool key Return sleep 0.5\n"
          "  titled 'out.png[*]? - ready'; xdotool key ctrl+s; until_file out-changes$n.lua; xdotool key ctrl+z sleep "
          "0.5\n"
          "done; xdotool key ctrl+q sleep 0.5 key alt+d",
          0);
    for (int number = 1; number <= 9; number++)
        check_handle(number);
}

/* What a new user does: opens a model, frames it, adds a lamp, saves the edits and the picture before it is complete;
 * the edits apply to the model again. */
TEST_LONG(gtk_window_opens_a_model_frames_it_adds_a_lamp_and_saves) {
    need_display();
    test_write_text(test_path("ball.obj"),
                    "v -1 -1 -1\nv 1 -1 -1\nv 0 1 -1\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    drive("",
          "titled gray; sleep 1; xdotool key ctrl+o sleep 2 type \"$PWD/ball.obj\"; xdotool sleep 0.5 key Return\n"
          "titled 'ball.png - .* left'; xdotool mousemove 600 460 click 1 sleep 2 key period sleep 1 key shift+a sleep "
          "1\n"
          "xdotool type spot; xdotool sleep 1 key Return sleep 2 key ctrl+s; until_file ball-changes1.lua\n"
          "xdotool key ctrl+shift+s; until_file ball-view1.png; xdotool key ctrl+q",
          130);
    gives("grep -q 'gr.spot_light{' ball-changes1.lua && grep -q gr.change_view ball-changes1.lua && $gray -q --size "
          "32x18 "
          "--spp 1 ball.obj --edits ball-changes1.lua && $gray -q --size 32x18 --spp 1 ball.obj -o plain.png && "
          "! cmp -s ball.png plain.png",
          0);
}

TEST_LONG(gtk_window_finds_a_node_among_ten_thousand) {
    need_display();
    test_write_text(
        test_path("scene.lua"),
        "local r = gr.node 'root'\nfor i = 1, 10000 do r:add_child(gr.sphere{name = 'tree ' .. i, radius = 0.3, "
        "centre = {i % 100, 0, -(i // 100)}}) end\n"
        "gr.render{node = r, file = 'out.png', width = 200, height = 150, eye = {0, 20, 30}}\n");
    drive("scene.lua",
          "titled 'out.png - ready'; xdotool key ctrl+f sleep 0.5 type 'tree 7777'; xdotool key Return sleep 2 key x "
          "sleep 1\n"
          "titled 'out.png[*] - ready'; xdotool key ctrl+s; until_file out-changes1.lua; titled 'out.png - '\n"
          "xdotool key ctrl+q",
          0);
    gives("grep -q \"gr.change_delete('tree 7777'\" out-changes1.lua", 0);
}

/* Letters of one and a half times the size: the panels are wider, the picture smaller. */
TEST_LONG(gtk_window_has_larger_letters_where_the_desktop_has) {
    need_display();
    test_need_tools("xprop");
    gives("cat >letters.sh <<'END'\n"
          "openbox >/dev/null 2>&1 & manager=$!\nfor dpi in 96 144; do\n"
          "xprop -root -format RESOURCE_MANAGER 8s -set RESOURCE_MANAGER \"Xft.dpi: $dpi\"\nrm -f out.png\n"
          "$gray -gui --verbose --progress=none scene.lua 2>$dpi.txt & pid=$!\nawait 'test -s out.png'\n"
          "kill -INT $pid; wait $pid\nsed -n 's/.*picture of [0-9]*x\\([0-9]*\\) .*/\\1/p' $dpi.txt | tail -1 "
          ">$dpi.high\n"
          "done; kill $manager; test $(cat 144.high) -lt $(cat 96.high)\nEND\n"
          "screen sh letters.sh",
          0);
}
