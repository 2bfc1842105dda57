/* What a scene could print as if it were the program, learn from error messages, or see of the program's internal
 * values; and output that cannot be written. */
#define _GNU_SOURCE
#include "output/progress.h"
#include "tests/harness.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static void free_result(struct test_result *result) {
    test_free_result(result);
}

/* --- internal values --- */

/* C functions that run as __close after an error that nothing catches; they receive a value for it. */
static const char *const closers = "local function closing(f) return setmetatable({}, {__close = f}) end\n"
                                   "local function guarded(deed)\n"
                                   "  local a <close> = closing(print)\n"
                                   "  local b <close> = closing(pcall)\n"
                                   "  local c <close> = closing(setmetatable({}, {__call = print}))\n"
                                   "  local d <close> = closing(coroutine.wrap(print))\n"
                                   "  local e <close> = closing(io.write)\n"
                                   "  for _ in function() return 1 end, nil, nil, closing(print) do deed() end\n"
                                   "end\n"
                                   "local function in_coroutine(deed)\n"
                                   "  local co = coroutine.create(function() guarded(deed) end)\n"
                                   "  coroutine.resume(co) coroutine.close(co) print(coroutine.status(co))\n"
                                   "end\n"
                                   "local function handled(deed) xpcall(guarded, print, deed) end\n";

TEST(hostile_no_value_of_the_program_reaches_a_script_after_its_end) {
    static const char *const deeds[] = {
        "function() os.exit(true) end",
        "function() os.exit(false) end",
        "function() while true do end end",
        "function() local t = {} for i = 1, 1e9 do t[i] = {i} end end",
        "function() io.write(('x'):rep(1100000)) end",
        "function() load(function() os.exit(true) end) end",
        "function() table.sort({1, 2, 3}, function() os.exit(true) end) end",
        "function() gr.render(gr.node('r'), 'x.png', 1e6, 1e6, {0,0,9}, {0,0,-1}, {0,1,0}, 50, {1,1,1}, {}) end",
    };
    static const char *const variants[] = {"guarded", "in_coroutine", "handled"};
    for (size_t d = 0; d < sizeof deeds / sizeof *deeds; d++)
        for (size_t w = 0; w < sizeof variants / sizeof *variants; w++) {
            char text[4096];
            (void)snprintf(text, sizeof text, "%s%s(%s)\n", closers, variants[w], deeds[d]);
            struct test_result result =
                test_gray_scene(text, "--script-time 0.1 --script-memory 64 --script-output 1 scene.lua", NULL);
            if (result.status > 3 || strstr(result.out, "userdata: ") || strstr(result.err, "userdata: "))
                test_fail(__FILE__, __LINE__, "%s by %s ends with %d and \"%.200s\"", deeds[d], variants[w],
                          result.status, result.out);
            free_result(&result);
        }
}

/* --- standard output that cannot be written --- */

#define PICTURE(name) "gr.render(gr.sphere('s'), '" name "', 8, 8, {0,0,5}, {0,0,-1}, {0,1,0}, 40, {1,1,1}, {})\n"

static int shell(const char *line) {
    return test_run_shell(line, "");
}

static const char *const lost = "gray: standard output cannot be written\n";

/* If its standard output cannot be written, the program ends with status 3 and reports it once. */
static void check_lost(const char *arguments) {
    static const char *const outputs[] = {">/dev/full", ">&-", "| true"};
    for (size_t i = 0; i < sizeof outputs / sizeof *outputs; i++) {
        char line[1024];
        bool piped = outputs[i][0] == '|';
        /* The reader is gone before the writer begins. */
        (void)snprintf(line, sizeof line, "{ %s\"$gray\" %s 2>err.txt %s; echo $? >status; } %s",
                       piped ? "sleep 0.2; " : "", arguments, piped ? "" : outputs[i], piped ? outputs[i] : "");
        (void)shell(line);
        char *status = test_read_file(test_path("status"), NULL), *said = test_read_file(test_path("err.txt"), NULL);
        bool silent = piped && (strncmp(arguments, "--", 2) == 0 && !strchr(arguments, ' ')); /* --help | head */
        const char *found = said ? strstr(said, lost) : NULL;
        if (silent)
            found = said && said[0] == '\0' ? lost : NULL;
        if (!status || strcmp(status, "3\n") != 0 || !found || strstr(found + strlen(lost), lost))
            test_fail(__FILE__, __LINE__, "gray %s %s: status %s, \"%s\"", arguments, outputs[i], status, said);
        free(status);
        free(said);
    }
}

TEST(hostile_what_standard_output_does_not_take_is_status_3) {
    if (access("/dev/full", W_OK) != 0)
        test_skip("there is no /dev/full");
    test_write_text(test_path("picture.lua"), PICTURE("a.png"));
    test_write_text(test_path("print.lua"), "print('x')\n" PICTURE("b.png"));
    test_write_text(test_path("write.lua"), "io.write('x')\n");
    test_write_text(test_path("method.lua"), "io.stdout:write('x')\nio.stdout:flush()\n");
    test_write_text(test_path("full.lua"), "io.stdout:setvbuf('full') print('x')\n");
    test_write_text(test_path("none.lua"), "io.stdout:setvbuf('no') print('x') io.stdout:seek('set')\n");
    test_write_text(test_path("long.lua"), "for i = 1, 3000 do print(i) end\n");
    test_write_text(test_path("fails.lua"), "print('x') error('wrong')\n");
    test_write_text(test_path("exits.lua"), "io.write('x') os.exit(true)\n");
    static const char *const arguments[] = {"--help",
                                            "--man",
                                            "--version",
                                            "--annotations",
                                            "print.lua",
                                            "write.lua",
                                            "method.lua",
                                            "full.lua",
                                            "none.lua",
                                            "long.lua",
                                            "fails.lua",
                                            "exits.lua",
                                            "--no-fork print.lua",
                                            "--no-sandbox print.lua",
                                            "picture.lua print.lua",
                                            "print.lua print.lua",
                                            "--stats=json picture.lua",
                                            "--stats=json print.lua",
                                            "--stats=json --no-fork picture.lua",
                                            "--dump-scene picture.lua",
                                            "--dump-scene --json picture.lua",
                                            "--dump-scene --no-fork picture.lua",
                                            "--pixel 3,3 picture.lua",
                                            "--pixel 3,3 --json picture.lua",
                                            "--check print.lua"};
    for (size_t i = 0; i < sizeof arguments / sizeof *arguments; i++)
        check_lost(arguments[i]);
    CHECK(access(test_path("b.png"), F_OK) == 0);                  /* the picture exists nevertheless */
    CHECK_EQ_INT(shell("\"$gray\" -q picture.lua >/dev/full"), 0); /* nothing was printed */
    CHECK_EQ_INT(shell("\"$gray\" -q print.lua >/dev/null"), 0);
}

/* --- files outside --- */

/* The scene is in a/s, so it may read below a. The contents of out and of the hidden folders a/.hid and a/s/.hid are
 * brought into each of these states. */
static const char *const states[] = {
    ":",                                                                         /* nothing exists */
    "mkdir $o",                                                                  /* an empty folder */
    "mkdir $o && for e in '' .lua .obj .png .mtl; do echo \"$t\" >$o/x$e; done", /* files that suggest the old order
                                                                                  */
    "for e in '' .lua .obj .png .mtl; do mkdir -p $o/x$e && echo \"$t\" >$o/x$e/y; done", /* folders */
    "mkdir $o && for e in '' .lua .obj .png .mtl; do mkfifo $o/x$e; done",                /* pipes without a writer */
    "mkdir $o && for e in '' .lua .obj .png .mtl; do echo \"$t\" >$o/x$e && chmod 0 $o/x$e; done", /* unreadable ones */
    "mkdir $o && for e in '' .lua .obj .png .mtl; do ln -s x$e $o/x$e; done",           /* links to themselves */
    "mkdir $o && for e in '' .lua .obj .png .mtl; do ln -s ../a/s/in.txt $o/x$e; done", /* links that lead back inside
                                                                                         */
    "echo \"$t\" >$o",                             /* a file instead of the folder */
    "mkdir $o && echo \"$t\" >$o/x && chmod 0 $o", /* a closed folder */
    "ln -s /nowhere/at/all $o",                    /* a dangling link */
};
enum { STATES = sizeof states / sizeof *states };

static void prepare_links(void) {
    static const char *const links =
        "umask 022; mkdir -p a/s/sub a/q; cd a/s; echo text >in.txt; o=../../out; for e in '' .lua .obj .png .mtl; do\n"
        "ln -s $o/x$e link$e; ln -s $PWD/$o/x$e abs$e; ln -s link$e chain$e; ln -s .hid/x$e hid$e; ln -s ../.hid/x$e "
        "hid2$e\n"
        "ln -s $o/x$e/y deep$e; done; ln -s $o dir; ln -s $o/x dirx; ln -s dir dir2; ln -s .hid hiddir; ln -s ../.. "
        "up\n"
        "ln -s $PWD/$o absdir; ln -s sub/../dir/x bent; ln -s loop loop; ln -s missing gone\n"
        "printf 'mtllib link.mtl\nmtllib hid.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n' >own.obj\n"
        "printf 'newmtl m\nmap_Kd link.png\nmap_Ks dir/x.png\nmap_Ke .hid/x.png\n' >own.mtl\n"
        "printf 'mtllib own.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n' >own2.obj\n"
        "echo '{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"link\",\"byteLength\":9}],\"meshes\":[]}' "
        ">own.gltf";
    CHECK_EQ_INT(shell(links), 0);
}

static void enter_state(int state) {
    char line[2048];
    (void)snprintf(line, sizeof line,
                   "umask 022; t='readobj(1) gr.x()'; for o in out a/.hid a/s/.hid; do chmod -R u+rwx $o 2>/dev/null; "
                   "rm -rf $o; %s; done; true",
                   states[state]);
    CHECK_EQ_INT(shell(line), 0);
}

static const char *const probes =
    "local names = {'link', 'abs', 'chain', 'hid', 'hid2', 'deep', 'dir', 'dir/', 'dir/x', 'dir/x/y', 'dirx/y', "
    "'dir2/x',\n"
    "  'dir/../out/x', 'dir/../a/s/in.txt', 'dir/./x', 'up/out/x', 'up/out', 'absdir/x', 'bent', 'hiddir/x', '.hid/x', "
    "'.hid',\n"
    "  '../.hid/x', 'sub/../.hid/x', 'sub/../../../out/x', '../../out/x', '../../out', '../../out/x/y', "
    "'../../out/../a/s/in.txt',\n"
    "  '.hid/../in.txt', 'hiddir/../in.txt', 'gone/../link', 'link/../in.txt', 'link/x/y', TOP .. '/out/x', TOP .. "
    "'/out/../a/s/in.txt',\n"
    "  TOP .. '/a/s/link', TOP .. '/a/.hid/x', '//' .. TOP .. '/out/x', '/nowhere/x', '/etc/passwd', '/etc/no', "
    "'/opt/x'}\n"
    "local function show(way, name, ...)\n"
    "  io.write(way, ' ', name, ':')\n"
    "  for i = 1, select('#', ...) do\n"
    "    local v = select(i, ...)\n"
    "    io.write(' ', type(v) == 'userdata' and 'userdata' or (tostring(v):gsub('0x%x+', '')))\n"
    "  end\n"
    "  print()\n"
    "end\n"
    "for _, base in ipairs(names) do\n"
    "  for _, mode in ipairs{'r', 'rb', 'r+', 'w', 'a', 'w+b'} do show(mode, base, io.open(base, mode)) end\n"
    "  for _, ending in ipairs{'', '.lua', '.obj', '.png'} do\n"
    "    local n = base .. ending\n"
    "    show('open', n, io.open(n))\n"
    "    show('lines', n, pcall(io.lines, n))\n"
    "    show('input', n, pcall(io.input, n))\n"
    "    show('output', n, pcall(io.output, n))\n"
    "    show('loadfile', n, loadfile(n))\n"
    "    show('dofile', n, pcall(dofile, n))\n"
    "    show('require', n, pcall(require, n))\n"
    "    show('search', n, package.searchpath(n, '?;?.lua;./?;../s/?', ''))\n"
    "    show('mesh', n, pcall(gr.mesh, {file = n}))\n"
    "    show('texture', n, pcall(gr.texture, n))\n"
    "    show('bump', n, pcall(gr.bump, n))\n"
    "    show('font', n, pcall(gr.glyphs, {font = n, text = 'a'}))\n"
    "    show('remove', n, os.remove(n))\n"
    "    show('rename', n, os.rename(n, 'z'))\n"
    "    show('rename to', n, os.rename('in.txt', n))\n"
    "  end\n"
    "end\n"
    "for _, n in ipairs{'own.obj', 'own2.obj', 'own.gltf'} do show('mesh', n, pcall(gr.mesh, {file = n})) end\n"
    "dofile('in.txt')\n";

/* The whole result of a run: its status, output and messages. */
static char *all_of(const char *folder, const char *arguments) {
    struct test_result result = test_gray(folder, arguments);
    char *all = NULL;
    if (asprintf(&all, "%d\n%s\n%s", result.status, result.out, result.err) < 0)
        exit(1);
    free_result(&result);
    return all;
}

static void check_state_is_not_seen(const char *arguments) {
    const char *folder = test_path("a/s");
    char *first = NULL;
    for (int state = 0; state < STATES; state++) {
        enter_state(state);
        char *all = all_of(folder, arguments);
        size_t at = 0;
        while (first && first[at] && first[at] == all[at])
            at++;
        while (at > 0 && first && first[at - 1] != '\n')
            at--;
        if (first && strcmp(first, all) != 0)
            test_fail(__FILE__, __LINE__, "%s: outside \"%.40s\": \"%.*s\" and not \"%.*s\"", arguments, states[state],
                      (int)strcspn(all + at, "\n"), all + at, (int)strcspn(first + at, "\n"), first + at);
        if (first)
            free(all);
        else
            first = all;
    }
    free(first);
    enter_state(0);
}

TEST(hostile_no_route_shows_what_lies_outside_or_is_hidden) {
    char *text = NULL;
    prepare_links();
    CHECK(asprintf(&text, "local TOP = '%s'\n%s", test_folder(), probes) > 0);
    test_write_text(test_path("a/s/scene.lua"), text);
    free(text);
    check_state_is_not_seen("scene.lua");
    check_state_is_not_seen("--no-fork scene.lua");
    struct test_result result = test_gray(test_path("a/s"), "scene.lua");
    if (result.status != 1 || !strstr(result.err, "in.txt:2: ")) /* it came to its end */
        test_fail(__FILE__, __LINE__, "%d: %s", result.status, result.err);
    CHECK(strstr(result.out, "r link: nil link: cannot be read by scenes, or is not a regular file 13\n"));
    CHECK(strstr(result.out, "r ../../out/x: nil ../../out/x: lies outside the folders that scenes may read"));
    CHECK(strstr(result.out, "r gone/../link: nil gone/../link: No such file or directory 2\n"));
    free_result(&result);
}

TEST(hostile_a_scene_that_may_write_does_not_see_what_lies_outside) {
    static const char *const text =
        "for _, n in ipairs{'link', 'abs', 'chain', 'dir/x', 'dir/new', 'dir/x/y', 'dir/../out/x', "
        "'up/out/x',\n"
        "  '../../out/x', '../x', '/etc/x', '/nowhere/x', 'dir2/new'} do\n"
        "  for _, mode in ipairs{'w', 'a', 'r+', 'w+', 'r'} do print(n, mode, io.open(n, mode)) end\n"
        "  print(n, os.rename('in.txt', n .. '/x')) print(n, os.rename(n .. '/x', 'z')) print(n, os.remove(n .. "
        "'/x'))\n"
        "end\n"
        "for _, n in ipairs{'dir/x', 'dir/../out/x', 'up/out', '../../out/x', 'absdir/x'} do\n"
        "  print(n, os.remove(n)) print(n, os.rename(n, 'z')) print(n, os.rename('in.txt', n))\n"
        "end\n";
    prepare_links();
    test_write_text(test_path("a/s/scene.lua"), text);
    check_state_is_not_seen("--allow-write . scene.lua");
    CHECK(access(test_path("a/s/in.txt"), F_OK) == 0 && access(test_path("a/s/z"), F_OK) != 0);
}

TEST_TIMES(hostile_the_name_of_a_picture_does_not_show_what_lies_outside, 4) {
    static const char *const names[] = {"dir/x.png",        "dir/x",        "dir/n/y.png",  "dir2/x.png",
                                        "dirx/y.png",       "absdir/x.png", "up/out/x.png", "sub/../dir/x.png",
                                        "../../out/x.png",  "hiddir/x.png", ".hid/x.png",   "dir/../out/x.png",
                                        "gone/../dir/x.png"};
    prepare_links();
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char text[512];
        (void)snprintf(text, sizeof text,
                       "gr.render(gr.node('r'), '%s', 4, 4, {0,0,5}, {0,0,-1}, {0,1,0}, 40, {1,1,1}, {})\n", names[i]);
        test_write_text(test_path("a/s/scene.lua"), text);
        if (times > 1 || i % 4)
            check_state_is_not_seen("scene.lua");
        if (times > 1 || i % 4 == 0)
            check_state_is_not_seen("--check scene.lua");
    }
}

TEST(hostile_hidden_files_and_those_outside_do_not_influence_the_transform_order) {
    static const char *const texts[] = {
        "local n = gr.node('r')\n",  "dofile('link')\n",         "dofile('link.lua')\n",  "require('link')\n",
        "require 'hid'\n",           "loadfile('.hid/x.lua')\n", "dofile('dir/x.lua')\n", "dofile('../../out/x.lua')\n",
        "dofile('../.hid/x.lua')\n", "dofile('/etc/passwd')\n",
    };
    prepare_links();
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        test_write_text(test_path("a/s/scene.lua"), texts[i]);
        check_state_is_not_seen("scene.lua");
    }
    /* Hidden neighbours, more of them than are inspected, and links to hidden files. */
    test_write_text(test_path("a/s/scene.lua"), texts[0]);
    test_write_text(test_path("a/s/new.lua"), "gr.geometry('x', 1)\n");
    char *before = all_of(test_path("a/s"), "scene.lua");
    CHECK_EQ_INT(shell("cd a/s && mkdir .hid; for i in $(seq 400); do echo 'readobj(1) gr.x()' >.old$i.lua; done; "
                       "for i in 1 2 3; do cp .old1.lua .hid/$i.lua; ln -s .hid/$i.lua seen$i.lua; "
                       "ln -s .old$i.lua near$i.lua; done"),
                 0);
    char *after = all_of(test_path("a/s"), "scene.lua");
    CHECK_TEXT(after, before);
    CHECK_TEXT(before, "0\n\nscene.lua: no picture was rendered, because the script did not call gr.render\n");
    free(before);
    free(after);
}

/* A folder that was named by another path can be reached by that path, too. */
TEST(a_scene_behind_a_link_reaches_its_files) {
    CHECK_EQ_INT(
        shell("mkdir -p deep/er/real x/y && ln -s ../../deep/er/real x/y/link && echo text >deep/er/real/t.txt && "
              "echo 'return 1' >deep/er/real/m.lua"),
        0);
    char *text = NULL;
    CHECK(asprintf(&text,
                   "local top = '%s/x/y/link/'\n"
                   "for _, n in ipairs{'t.txt', top .. 't.txt', top .. './t.txt', top .. '../real/t.txt'} do\n"
                   "  assert(io.open(n)):close() end\n"
                   "assert(dofile('m.lua') == 1 and dofile(top .. 'm.lua') == 1 and require('m') == 1)\n"
                   "assert(not io.open(top .. '../../x/y/z') and not io.open('%s/x/t.txt'))\n",
                   test_folder(), test_folder()) > 0);
    test_write_text(test_path("deep/er/real/scene.lua"), text);
    free(text);
    char *absolute = NULL, *allowed = NULL;
    CHECK(asprintf(&absolute, "%s/x/y/link/scene.lua", test_folder()) > 0);
    CHECK(asprintf(&allowed, "--allow-read %s/x/y/link deep/er/real/scene.lua", test_folder()) > 0);
    const char *const arguments[] = {absolute, "x/y/link/scene.lua", allowed};
    for (int i = 0; i < 3; i++) {
        if (i == 1)
            continue; /* then the folder has no absolute name but its own */
        struct test_result result = test_gray(i == 0 ? "/" : NULL, arguments[i]);
        if (result.status != 0)
            test_fail(__FILE__, __LINE__, "%s: %s", arguments[i], result.err);
        free_result(&result);
    }
    free(absolute);
    free(allowed);
}

/* --- lines of standard error --- */

/* The number of bytes at `at` that are invisible or control the terminal: controls except tab, escape sequences,
 * invisible characters. 0: none. */
static size_t unseen(const char *at) {
    static const char *const invisible[] = {"\xe2\x80\x8b", "\xe2\x80\x8c", "\xe2\x80\x8d",    "\xe2\x81\xa0",
                                            "\xef\xbb\xbf", "\xc2\xad",     "\xcc\x81",        "\xcd\x8f",
                                            "\xe2\x80\xae", "\xe2\x80\x8e", "\xf3\xa0\x81\xa7"};
    if (at[0] == '\33' && at[1] == '[')
        return 2 + strspn(at + 2, "0123456789;?") + 1;
    if (((unsigned char)at[0] < 32 && at[0] != '\t') || at[0] == 127)
        return 1;
    for (size_t i = 0; i < sizeof invisible / sizeof *invisible; i++)
        if (strncmp(at, invisible[i], strlen(invisible[i])) == 0)
            return strlen(invisible[i]);
    return 0;
}

/* A line that a terminal shows like a message of the program although the program did not write it. */
static const char *forged_line(const char *said) {
    static const char *const own[] = {"gray: warning: --no-fork: ", "gray: confined by "};
    for (const char *line = said; *line;) {
        char seen[6] = "";
        for (const char *at = line; *at && *at != '\n' && strlen(seen) < 5;) {
            size_t step = unseen(at);
            if (step == 0)
                strncat(seen, at, 1);
            else if (*at == '\r' || *at == '\33' || *at == '\b' || *at == '\v' || *at == '\f')
                seen[0] = '\0'; /* the cursor is elsewhere */
            at += step ? step : 1;
        }
        bool is_own = false;
        for (size_t i = 0; i < sizeof own / sizeof *own; i++)
            is_own = is_own || strncmp(line, own[i], strlen(own[i])) == 0;
        if (strcmp(seen, "gray:") == 0 && !is_own)
            return line;
        line += strcspn(line, "\n\r\v\f\33\b");
        line += *line != '\0';
    }
    return NULL;
}

struct impostor {
    const char *text, *arguments; /* NULL: scene.lua alone */
    bool marked;                  /* the line is shown with its mark; else it is made harmless in another way */
};

TEST(hostile_no_scene_begins_a_line_as_the_program_does) {
    static const struct impostor impostors[] = {
        {"io.stderr:write('gray: x\\n')", NULL, true},
        {"io.stderr:write('gray: x')", NULL, true},
        {"io.stderr:write('g', 'ray', ': x\\n')", NULL, true},
        {"for c in ('gray: x\\n'):gmatch('.') do io.stderr:write(c) end", NULL, true},
        {"for c in ('gray: x\\n'):gmatch('.') do io.stderr:write(c) io.stderr:flush() end", NULL, true},
        {"io.stderr:setvbuf('full') io.stderr:write('gra') io.stderr:write('y: x\\n')", NULL, true},
        {"io.stderr:setvbuf('full', 2) io.stderr:write('gra') io.stderr:write('y: x\\n')", NULL, true},
        {"io.stderr:setvbuf('line') io.stderr:write('gra') io.stderr:write('y: x\\n')", NULL, true},
        {"io.output(io.stderr) io.write('a\\ngray: x\\n')", NULL, true},
        {"io.output(io.stderr):write('gray'):write(': x\\n')", NULL, true},
        {"io.stderr:write('a\\rgray: x\\n')", NULL, true},
        {"io.stderr:write('a\\r') io.stderr:write('gray: x\\n')", NULL, true},
        {"io.stderr:write('0000: x\\rgray\\n')", NULL, false},
        {"io.stderr:write('xray: x\\rg\\n')", NULL, false},
        {"io.stderr:write('xgray: x\\r\\27[P\\n')", NULL, false},
        {"io.stderr:write('    : x\\27[4Dy\\27[2Da\\27[2Dr\\27[2Dg\\n')", NULL, false},
        {"io.stderr:write('\\27[2K\\27[1Ggray: x\\n')", NULL, true},
        {"io.stderr:write('\\27[31mgray: x\\27[0m\\n')", NULL, true},
        {"io.stderr:write('\\27]0;title\\7gray: x\\n')", NULL, true},
        {"io.stderr:write('\\27', '[2K', '\\27[A', 'gray: x\\n')", NULL, true},
        {"io.stderr:write('a\\8gray: x\\n')", NULL, true},
        {"io.stderr:write('a\\11gray: x\\n', 'b\\12gray: y\\n')", NULL, true},
        {"io.stderr:write('a\\0gray: x\\n')", NULL, true},
        {"io.stderr:write('\\0gray: x\\n')", NULL, true},
        {"io.stderr:write('a\\u{85}gray: x\\n')", NULL, true},
        {"io.stderr:write('a\\u{2028}gray: x\\n')", NULL, true},
        {"io.stderr:write('\\u{9b}2Kgray: x\\n', '\\x9b2Kgray: x\\n')", NULL, true},
        {"io.stderr:write('\\u{200b}gray: x\\n')", NULL, true},
        {"io.stderr:write('\\u{feff}', 'gr\\u{200d}ay: x\\n')", NULL, true},
        {"io.stderr:write('g\\xe2', '\\x80', '\\x8bray: x\\n')", NULL, true},
        {"io.stderr:write('\\u{301}gray: x\\n')", NULL, true},
        {"io.stderr:write('\\u{e0067}gray: x\\n')", NULL, true},
        {"io.stderr:write('\\u{202e}x :yarg\\n')", NULL, false},
        {"io.stderr:write('g' .. ('\\u{200b}'):rep(500) .. 'ray: x\\n')", NULL, true},
        {"io.stderr:write('gra') " PICTURE("a.png") " io.stderr:write('y: x\\n')", NULL, false},
        {"io.stderr:write('gra') gr.sphere('s', 1) io.stderr:write('y: x\\n')", NULL, false},
        {"io.stderr:write('a') gr.sphere('s', 1) io.stderr:write('gray: x\\n')", NULL, true},
        {"io.stderr:write('\\xef\\xbb') gr.sphere('s', 1) io.stderr:write('\\xbfgray: x\\n')", NULL, false},
        {"io.stderr:write('gra')", "scene.lua more.lua", false},
        {"io.stderr:write('gray: ') string.rep('x', 99):rep(99):find(('x*'):rep(9) .. 'y')",
         "--script-time 0.1 scene.lua more.lua", true},
        {"print('gray: x')", "-o - scene.lua", true},
        {"print('a', 'gray: x') print('gray: y')", "-o - scene.lua", true},
        {"io.write('gra') io.stderr:write('y: x\\n')", "-o - scene.lua", true},
        {"io.stderr:write('gra') io.stdout:write('y: x\\n')", "-o - scene.lua", true},
        {"io.stdout:setvbuf('full') print('gray: x')", "-o - scene.lua", true},
        {"print(setmetatable({}, {__tostring = function() return 'gray: x' end}))", "-o - scene.lua", true},
        {"print('gray: x')", "-o - --no-fork scene.lua", true},
        {"io.stderr:write('a\\rgray: x\\n')", "--no-fork scene.lua", true},
        {"io.stderr:write('gray: x\\n')", "-q scene.lua", true},
        {"io.stderr:write('gray: x\\n')", "--progress json scene.lua", true},
        {"error('gray: x', 0)", NULL, false},
        {"error('\\ngray: x')", NULL, false},
        {"error('a\\n  gray: x')", NULL, false},
        {"error(setmetatable({}, {__tostring = function() return 'gray: x' end}))", NULL, false},
        {"load('error(\"x\")', '=gray: notice')()", NULL, true},
        {"load('error(\"x\")', '@gray: notice')()", NULL, true},
        {"load('error(\"x\")', '=\\u{200b}gr\\u{200c}ay: notice')()", NULL, true},
        {"load('error(\"x\")', '@gray')()", NULL, true},
        {"load('error(\"x\")', '\\ngray: notice')()", NULL, false},
        {"load('x =', '=gray: notice')() ", NULL, false},
        {"error((select(2, load('x =', '=gray: notice'))), 0)", NULL, false},
        {"load('gr.sphere(\"s\", 1)', '=gray: notice')()", NULL, true},
        {"load('gr.sphere(\"s\", 1)', '@gray: notice')()", NULL, true},
        {"load('gr.sphere(1, 2)', '@gray: notice')()", NULL, true},
        {"load('gr.no()', '=gray: notice')()", "--lenient scene.lua", true},
        {"load('gr.mesh(\"m\", \"x1.0.obj\")', '=gray: notice')()", NULL, true},
        {"load('os.exit(false)', '=gray: notice')()", NULL, true},
        {"load('while true do end', '=gray: notice')()", "--script-time 0.1 scene.lua", true},
        {"load('t = {} while true do t[#t + 1] = {t} end', '=gray: notice')()", "--script-memory 20 scene.lua", false},
        {"load('io.write((\"x\"):rep(2e6))', '=gray: notice')()", "--script-output 1 scene.lua", true},
        {"coroutine.wrap(load('error(\"x\")', '=gray: notice'))()", NULL, false},
        {"xpcall(load('error(\"x\")', '=gray: notice'), function(m) error(m, 0) end) error(1)", NULL, false},
        {"dofile('gray')", NULL, true},
        {"require('gray')", NULL, false},
        {"dofile('gray: notice')", NULL, true},
        {"gr.mesh{file = 'gray: x.obj'}", NULL, false},
        {"local s = gr.sphere('gray: s') " PICTURE("a.png"), NULL, false},
        {PICTURE("gray: notice: a.png"), NULL, false},
        {PICTURE("gray: notice: a.png"), "--verbose scene.lua", false},
        {PICTURE("gray: notice: a.png"), "--stats scene.lua", true},
        {PICTURE("gray: notice: a.png"), "--progress bar scene.lua", true},
        {PICTURE("gr\\u{200b}ay: notice: a.png"), "--progress bar scene.lua", true},
        {PICTURE("a/xxxxxxxxxxxxxgray: notice: all is well.png"), "--progress bar scene.lua", false},
        {PICTURE("gray: notice: a.png"), "--progress json scene.lua", false},
        {PICTURE("gray: notice: full/a.png"), NULL, false},
        {PICTURE("gray: folder/"), NULL, false},
        {PICTURE("gray: notice: a.exr"), NULL, false},
        {PICTURE("\\ngray: a.png"), "--progress bar scene.lua", false},
        {PICTURE("\\u{202e}a.png"), "--progress bar scene.lua", false},
        {PICTURE("\\u{9b}2Ka.png"), "--progress bar scene.lua", false},
        {"warn('@on') warn('gray: x')", NULL, false},
        {"debug.traceback('gray: x') print(debug.traceback('gray: x'))", "-o - scene.lua", true},
        {"x = 1", "gray", false},
        {"x = 1", "gray.bad", true},
    };
    test_write_text(test_path("more.lua"), "io.stderr:write('y: x\\n')\n");
    test_write_text(test_path("gray"), "error('x')\n");
    test_write_text(test_path("gray: notice"), "error('x')\n");
    test_write_text(test_path("gray.lua"), "error('x')\n");
    test_write_text(test_path("gray.bad"), "load('error(\"x\")', '=gray: y')()\n");
    test_write_text(test_path("gray: notice: full"), "x");
    for (size_t i = 0; i < sizeof impostors / sizeof *impostors; i++) {
        const struct impostor *impostor = &impostors[i];
        const char *arguments = impostor->arguments ? impostor->arguments : "scene.lua";
        struct test_result result = test_gray_scene(impostor->text, arguments, NULL);
        const char *forged = forged_line(result.err);
        bool marked = strstr(result.err, "scene: ") != NULL;
        if (forged || (impostor->marked && !marked) || result.status > 3)
            test_fail(__FILE__, __LINE__, "%s: %s ends with %d and \"%.300s\"", arguments, impostor->text,
                      result.status, result.err);
        if (strstr(result.err, "\u202e") || strstr(result.err, "\x9b") || strstr(result.err, "\33["))
            test_fail(__FILE__, __LINE__, "%s: %s steers the terminal", arguments, impostor->text);
        free_result(&result);
    }
}

/* Fragments, lines of the program and text without a line end are printed completely and in order. */
TEST(hostile_words_of_a_scene_and_of_the_program_keep_their_order) {
    static const char *const text = "io.stderr:write('one\\n', 2, ' ', 3.5, '\\n', 'gr')\n"
                                    "gr.sphere('s', 1)\n"
                                    "io.stderr:write('een\\nfour')\n"
                                    "gr.cube('c', 1)\n"
                                    "io.stderr:write('five\\n')\n"
                                    "io.stderr:write('gra')\n";
    static const char *const wanted = "one\n2 3.5\ngr\n"
                                      "scene.lua:2: warning: gr.sphere: arguments after name are ignored; with names: "
                                      "gr.sphere{material = ..., centre = ..., radius = ...} (node 's')\n"
                                      "een\nfour\n"
                                      "scene.lua:4: warning: gr.cube: arguments after name are ignored; with names: "
                                      "gr.cube{material = ..., corner = ..., size = ...} (node 'c')\n"
                                      "five\ngra\n"
                                      "scene.lua: no picture was rendered, because the script did not call gr.render\n";
    static const char *const arguments[] = {"scene.lua", "--no-fork scene.lua"};
    for (int i = 0; i < 20; i++) {
        struct test_result result = test_gray_scene(text, arguments[i % 2], NULL);
        const char *said = result.err;
        if (i % 2 && strncmp(said, "gray: warning: --no-fork", 24) == 0)
            said = strchr(said, '\n') + 1;
        CHECK_EQ_INT(result.status, 0);
        CHECK_TEXT(said, wanted);
        free_result(&result);
    }
    struct test_result result = test_gray_scene("io.stderr:write('words') error('x')", "scene.lua", NULL);
    CHECK(strncmp(result.err, "words\nscene.lua:1: x\n", 21) == 0);
    free_result(&result);
    result = test_gray_scene("io.stderr:write('more words')", "-q scene.lua", NULL);
    CHECK_TEXT(result.err, "more words");
    free_result(&result);
    result = test_gray_scene("io.stderr:write('\\27[1mgray: x')", "--no-sandbox -q scene.lua", NULL);
    CHECK_TEXT(result.err, "\33[1mgray: x"); /* then a scene may call anything */
    free_result(&result);
}

/* Runs the program in the test's folder with standard error in a pipe that nobody reads; returns the status after a
 * signal. */
static int status_unread(const char *script, int signal_number) {
    const char *binary = test_program();
    int ends[2], how = 0;
    CHECK(pipe(ends) == 0);
    (void)fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        (void)signal(SIGINT, SIG_DFL);
        (void)signal(SIGTERM, SIG_DFL);
        if (dup2(ends[1], 2) < 0 || chdir(test_folder()) != 0)
            _exit(99);
        (void)close(ends[0]);
        (void)close(ends[1]);
        (void)execl(binary, "gray", "--script-output", "10000", script, (char *)NULL);
        _exit(98);
    }
    (void)close(ends[1]);
    /* The script has begun to write; it soon waits. */
    for (int size = 0; size == 0 && ioctl(ends[0], FIONREAD, &size) == 0;)
        (void)usleep(10000);
    (void)usleep(700000);
    (void)kill(child, signal_number);
    CHECK(waitpid(child, &how, 0) == child);
    (void)close(ends[0]);
    return WIFEXITED(how) ? WEXITSTATUS(how) : -1;
}

TEST(hostile_a_reader_of_standard_error_that_stops_does_not_hold_the_program) {
    test_write_text(test_path("writes.lua"), "while true do io.stderr:write(('x'):rep(100), '\\n') end\n");
    test_write_text(test_path("warns.lua"), "for i = 1, 1e9 do gr.sphere('s', i) end\n");
    test_write_text(test_path("both.lua"),
                    "for i = 1, 1e9 do io.stderr:write(i) load('gr.cube(\"s\", 1)', '=' .. i)() end\n");
    static const char *const scripts[] = {"writes.lua", "warns.lua", "both.lua"};
    for (int i = 0; i < 6; i++) {
        int status = status_unread(scripts[i % 3], i < 3 ? SIGTERM : SIGINT);
        if (status != 130)
            test_fail(__FILE__, __LINE__, "%s, signal %d: %d", scripts[i % 3], i < 3 ? SIGTERM : SIGINT, status);
    }
}

/* The bar shows the end of a long name, wherever that begins. */
TEST(hostile_the_bar_of_a_picture_cannot_imitate_a_line_of_the_program) {
    static const char *const names[] = {
        "gray: notice: a.png",
        "folder/of/some/length/gray: all is well.......png",
        "folder/of/some/length/xxx/gray: well.png",
        "\xe2\x80\x8bgray: a.png",
        "\xc2\x9b[2Ka.png",
        "\x9b[2Ka.png",
        "\xe2\x80\xae:yarg",
        "x\xe2\x80\x8b\xe2\x80\x8b\xe2\x80\x8b\xe2\x80\x8b\xe2\x80\x8b\xe2\x80\x8b\xe2\x80\x8bgray: b"};
    const char *path = test_path("said");
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        for (size_t from = 0; from < strlen(names[i]); from++) {
            struct progress_estimate progress_estimate = {.begun = 0};
            struct progress progress;
            int kept = dup(2), file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
            (void)dup2(file, 2);
            progress_init(&progress, PROGRESS_BAR, false, 1);
            progress_begin(&progress, names[i] + from, 10, 10, 0);
            for (uint32_t count = 0; count <= 10; count += 10) {
                progress.shown = -1;
                progress_update(&progress, 5, count, &progress_estimate);
            }
            progress_end(&progress, PROGRESS_WRITTEN);
            (void)dup2(kept, 2);
            (void)close(kept);
            (void)close(file);
            char *said = test_read_file(path, NULL);
            if (!said || strlen(said) < 20 || forged_line(said) || strstr(said, "\xe2\x80\xae") ||
                strstr(said, "\xc2\x9b") || said[strcspn(said, "\x9b\33")])
                test_fail(__FILE__, __LINE__, "%s: \"%s\"", names[i] + from, said);
            free(said);
        }
}
