/* Scarce resources: descriptors, stack, threads, long names. The program reports what is missing with status 3, refuses
 * a scene's invalid name with status 1, or makes the same picture as without limits. */
#define _GNU_SOURCE
#include "base/pool.h"
#include "tests/harness.h"
#include "tests/unit/file_makers.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

enum { NO_LIMIT = -1, CRASHED = 128, SECONDS = 120, WORDS = 32, SCENE_SIZE = 16384 };

/* A run of the program in the test's folder. */
struct program_run {
    int status; /* exit status, or 128 + signal */
    char *out, *err;
};

static void be_program(const char *arguments, int resource, long limit) {
    static char copy[4096];
    static char *words[WORDS];
    char *binary = (char *)(uintptr_t)test_program();
    int count = 0;
    if (chdir(test_folder()) != 0)
        _exit(126);
    (void)snprintf(copy, sizeof copy, "%s", arguments);
    words[count++] = binary;
    for (char *word = strtok(copy, " "); word && count + 1 < WORDS; word = strtok(NULL, " "))
        words[count++] = word;
    int out = open("out.txt", O_WRONLY | O_CREAT | O_TRUNC, 0666);
    int err = open("err.txt", O_WRONLY | O_CREAT | O_TRUNC, 0666);
    (void)dup2(out, STDOUT_FILENO);
    (void)dup2(err, STDERR_FILENO);
    for (int descriptor = 3; descriptor < 64; descriptor++)
        (void)close(descriptor);
    if (resource == RLIMIT_NOFILE) { /* the leak checker opens files */
        char options[512];
        const char *given = getenv("ASAN_OPTIONS");
        (void)snprintf(options, sizeof options, "%s%sdetect_leaks=0", given ? given : "", given ? ":" : "");
        (void)setenv("ASAN_OPTIONS", options, 1);
    }
    struct rlimit both = {(rlim_t)limit, (rlim_t)limit};
    if (limit != NO_LIMIT && syscall(SYS_prlimit64, 0, resource, &both, NULL) != 0)
        _exit(125);
    (void)alarm(SECONDS);
    (void)execv(binary, words);
    _exit(127);
}

static struct program_run run_limited(const char *arguments, int resource, long limit) {
    struct program_run run = {0};
    int how = 0;
    (void)test_folder(); /* made by this process, not by the child */
    pid_t child = fork();
    if (child == 0)
        be_program(arguments, resource, limit);
    (void)waitpid(child, &how, 0);
    run.status = WIFEXITED(how) ? WEXITSTATUS(how) : CRASHED + WTERMSIG(how);
    run.out = test_read_file(test_path("out.txt"), NULL);
    run.err = test_read_file(test_path("err.txt"), NULL);
    return run;
}

static void forget(struct program_run *run) {
    free(run->out);
    free(run->err);
}

static void put_scene(const char *text) {
    test_write_text(test_path("scene.lua"), text);
}

static bool is_there(const char *name) {
    struct stat status;
    return stat(test_path(name), &status) == 0;
}

static void fail(const char *what, long limit, const struct program_run *run) {
    test_fail(__FILE__, __LINE__, "%s, limit %ld: status %d: %.300s", what, limit, run->status, run->err);
}

/* --- stack --- */

#define PICTURE                                                                                                        \
    "gr.render{node = r, file = 'x.pfm', width = 8, height = 6, eye = {0, 0, 9}, lights = {gr.light({0, 5, 5}, {1, "   \
    "1, 1})}}\n"
#define MIRROR "m = gr.material{kd = {0, 0, 0}, ks = {1, 1, 1}, reflect = 1}\n"
#define GLASS "m = gr.rr_material{kd = {0, 0, 0}, ks = {1, 1, 1}, refract = 1, ior = 1.5}\n"
#define BALL "a = gr.sphere('s') c = gr.cube('c')\n"

struct deep {
    const char *what, *text;
};

static const struct deep deep_solids[] = {
    {"a union of unions", BALL "for i = 1, 9990 do a = gr.union('u', a, c) end r = a " PICTURE},
    {"a difference of differences", BALL "for i = 1, 3000 do a = gr.difference('d', c, a) end r = a " PICTURE},
    {"an inverse of inverses",
     BALL "for i = 1, 9990 do a = gr.inverse('i', a) end r = gr.intersection('n', a, c) " PICTURE},
    {"groups in a solid",
     BALL "for i = 1, 9900 do n = gr.node('n') n:add_child(a) a = n end r = gr.union('u', a, c) " PICTURE},
    {"solids beyond the limit", BALL "for i = 1, 20000 do a = gr.union('u', a, c) end r = a " PICTURE},
};

static const struct deep deep_bounds[] = {
    {"a bound of bounds",
     BALL "for i = 1, 2000 do c = gr.bounded_by(gr.sphere('s'), c) end r = gr.union('u', c, a) " PICTURE},
    {"clips of clips", BALL "for i = 1, 2000 do a = gr.clipped_by(a, c) end r = a " PICTURE},
};

static const struct deep deep_paths[] = {
    {"a thousand reflections", MIRROR
     "r = gr.box{min = {-10, -10, -10}, max = {10, 10, 10}, material = m}\n"
     "gr.render{node = r, file = 'x.pfm', width = 4, height = 3, eye = {0, 0, 9}, reflect_limit = 1000, cutoff = "
     "0}\n"},
    {"a thousand refractions",
     GLASS "r = gr.node('r') for i = 1, 500 do r:add_child(gr.box{min = {-10, -10, -i}, max = {10, 10, 0.5 - i}, "
           "material = m}) end\n"
           "gr.render{node = r, file = 'x.pfm', width = 2, height = 2, eye = {0, 0, 9}, reflect_limit = 0, "
           "refract_limit = 1000, cutoff = 0}\n"},
};

static const struct deep deep_nodes[] = {
    {"nodes in nodes", BALL "for i = 1, 50000 do n = gr.node('n') n:add_child(a) a = n end r = a " PICTURE},
    {"bounds of nodes in nodes",
     BALL "for i = 1, 1990 do n = gr.node('n') n:add_child(a) a = n end a:bounds() r = a " PICTURE},
    {"bounds beyond the limit",
     BALL "for i = 1, 30000 do n = gr.node('n') n:add_child(a) a = n end a:bounds() r = a " PICTURE},
    {"nodes that move in nodes",
     BALL "for i = 1, 2000 do n = gr.node('n') n:velocity(1e-6, 0, 0) n:add_child(a) a = n end r = a " PICTURE},
    {"materials over materials",
     BALL "m = gr.material{kd = {1, 1, 1}} for i = 1, 990 do m = gr.marble_pnd_material(m, 1, 1, 1, 0, {1, 0, 0}) end "
          "a:set_material(m) r = a " PICTURE},
};

static const struct deep deep_scripts[] = {
    {"recursion in Lua", "function f(n) return 1 + f(n + 1) end f(1)"},
    {"recursion by pcall", "function f(n) return (select('#', pcall(f, n + 1))) end print(f(1))"},
    {"recursion by gsub", "function f(s) return (s:gsub('.', f)) end print(pcall(f, 'a'))"},
    {"recursion by sort",
     "function f() table.sort({3, 2, 1}, function(a, b) f() return a < b end) end print(pcall(f))"},
    {"recursion by tostring",
     "t = setmetatable({}, {__tostring = function(t) return tostring(t) end}) print(pcall(tostring, t))"},
    {"recursion by metamethods", "m = {} m.__index = function(t, k) return t[k + 1] end print(pcall(function() return "
                                 "setmetatable({}, m)[1] end))"},
    {"coroutines in coroutines",
     "function f(n) return coroutine.wrap(function() return f(n + 1) end)() end print(pcall(f, 1))"},
    {"variables to be closed",
     "function f() local x <close> = setmetatable({}, {__close = function() f() end}) end print((pcall(f)))"},
    {"modules in modules",
     "for i = 1, 300 do package.preload['m' .. i] = function() return require('m' .. (i + 1)) end end "
     "print((pcall(require, 'm1')))"},
    {"text that nests",
     "for _, t in ipairs{'(', '{', 'function f() ', 'do ', 'not ', 'if x then ', 'a..', '-'} do for _, n in "
     "ipairs{150, "
     "199, 5000} do local f, e = load('x = ' .. t:rep(n)) print(e and #e > 0) print(load(t:rep(n)) == nil) end end"},
    {"patterns",
     "print((pcall(string.find, ('a'):rep(1000), ('a?'):rep(1000) .. 'b'))) print((pcall(string.match, "
     "('('):rep(300000) .. (')'):rep(300000), '%b()'))) print((pcall(string.match, ('x'):rep(300000), ('x-'):rep(190) "
     ".. 'x')))"},
};

/* The bytes of the picture, or NULL. */
static char *picture(size_t *size) {
    return is_there("x.pfm") ? test_read_file(test_path("x.pfm"), size) : NULL;
}

/* With each stack limit the result is the same as without. */
static void same_with_any_stack(const struct deep *cases, size_t count, const long *kibibytes) {
    for (size_t i = 0; i < count; i++) {
        put_scene(cases[i].text);
        (void)unlink(test_path("x.pfm"));
        struct program_run whole = run_limited("-q scene.lua", RLIMIT_STACK, NO_LIMIT);
        size_t size = 0, other_size = 0;
        char *bytes = picture(&size);
        if (whole.status > 1 || (whole.status == 1) != (whole.err[0] != '\0'))
            fail(cases[i].what, NO_LIMIT, &whole);
        for (const long *limit = kibibytes; *limit; limit++) {
            (void)unlink(test_path("x.pfm"));
            struct program_run run = run_limited("-q scene.lua", RLIMIT_STACK, *limit * 1024);
            char *other = picture(&other_size);
            bool same = run.status == whole.status && strcmp(run.err, whole.err) == 0 &&
                        strcmp(run.out, whole.out) == 0 && !bytes == !other && size == other_size &&
                        (!bytes || memcmp(bytes, other, size) == 0);
            if (!same)
                fail(cases[i].what, *limit, &run);
            free(other);
            forget(&run);
        }
        free(bytes);
        forget(&whole);
    }
}

#define EACH(cases) cases, sizeof(cases) / sizeof(cases)[0]
static const long smallest[] = {128, 0}, every[] = {128, 256, 512, 1024, 2048, 4096, 0};

TEST(solids_nested_ten_thousand_deep_do_not_need_the_stack_of_the_shell) {
    same_with_any_stack(EACH(deep_solids), smallest);
}

TEST(solids_within_bounds_and_clips_do_not_need_the_stack_of_the_shell) {
    same_with_any_stack(EACH(deep_bounds), smallest);
}

TEST(a_thousand_reflections_do_not_need_the_stack_of_the_shell) {
    same_with_any_stack(EACH(deep_paths), smallest);
}

TEST(nodes_and_materials_do_not_need_the_stack_of_the_shell) {
    same_with_any_stack(EACH(deep_nodes), smallest);
}

TEST(recursion_of_a_script_does_not_need_the_stack_of_the_shell) {
    same_with_any_stack(EACH(deep_scripts), smallest);
}

TEST_LONG(no_depth_of_a_scene_depends_on_any_limit_of_the_stack) {
    same_with_any_stack(EACH(deep_solids), every);
    same_with_any_stack(EACH(deep_bounds), every);
    same_with_any_stack(EACH(deep_paths), every);
    same_with_any_stack(EACH(deep_nodes), every);
    same_with_any_stack(EACH(deep_scripts), every);
}

/* Everything that the program does besides rendering, and rendering in one process. */
TEST(every_action_works_with_a_stack_of_128_kilobytes) {
    if (test_has_sanitizer())
        test_skip("frames are several times as large under a sanitizer");
    static const char *const arguments[] = {
        "--version",
        "--help",
        "--man",
        "--annotations",
        "-q scene.lua",
        "-q --check scene.lua",
        "-q --no-fork scene.lua",
        "-q --no-sandbox scene.lua",
        "-q --dump-scene scene.lua",
        "-q --pixel 3,2 --json scene.lua",
        "-q --overlay boxes scene.lua",
        "-q -o x.png --deep --aov all scene.lua",
        "-q -o x.hdr --stats scene.lua",
        "-q --progress=json scene.lua",
        "-q --checkpoint c --partial -write-pre-aa pre- -write-aa-targets t- scene.lua",
        "-q --checkpoint c --resume scene.lua",
        "-q --shard 1/2 scene.lua",
        "-q --shard 2/2 scene.lua",
        "merge x.pfm.1-of-2.part x.pfm.2-of-2.part -o m.png"};
    put_scene(BALL "r = gr.difference('d', a, c) " PICTURE);
    for (size_t i = 0; i < sizeof arguments / sizeof arguments[0]; i++) {
        struct program_run run = run_limited(arguments[i], RLIMIT_STACK, 128 * 1024);
        if (run.status != 0)
            fail(arguments[i], 128, &run);
        forget(&run);
    }
    CHECK(is_there("m.png"));
}

static void count_call(void *context) {
    ++*(int *)context;
}

/* The limit of the shell is too small, and no thread can be created. */
TEST(a_stack_that_cannot_be_had_is_one_line_and_status_3) {
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
    test_skip("sanitizers need more addresses than a limit leaves");
#endif
    struct rlimit stack = {256 << 10, 256 << 10}, addresses = {1 << 20, 1 << 20};
    struct error error = {0};
    int calls = 0;
    CHECK(setrlimit(RLIMIT_STACK, &stack) == 0);
    CHECK(setrlimit(RLIMIT_AS, &addresses) == 0);
    CHECK(!pool_call_with_stack(count_call, &calls, &error) && calls == 0);
    CHECK_EQ_INT(error.kind, ERROR_MACHINE);
    CHECK(strstr(error.text, "there is no stack of 32 MiB (ulimit -s allows less): "));
}

/* --- descriptors --- */

/* The number of messages, or -1 if one of them has no text. */
static int messages(const char *text) {
    int count = 0;
    for (const char *line = text; *line; line = strchr(line, '\n') + 1) {
        count += line[0] != ' ';
        if (!strchr(line, '\n'))
            return -1;
    }
    return count;
}

/* With few descriptors one line names the problem, with more there is a picture; nothing else happens in between. */
/* Each of the `scripts` may report it once. */
static void descriptors_up_to_40(const char *arguments, const char *made, int scripts) {
    bool worked = false;
    for (int limit = 3; limit <= 40; limit += limit < 16 ? 1 : 6) {
        (void)unlink(test_path(made));
        (void)unlink(test_path("c"));
        struct program_run run = run_limited(arguments, RLIMIT_NOFILE, limit);
        /* Before main the dynamic linker reports it in its own words. */
        bool unstarted = run.status == 127 && strstr(run.err, "error while loading shared libraries");
        bool refused = run.status == 3 && strstr(run.err, strerror(EMFILE)) && messages(run.err) >= 1 &&
                       messages(run.err) <= scripts;
        bool right = run.status == 0 ? is_there(made) : (unstarted || refused) && !worked && !is_there(made);
        if (!right)
            fail(arguments, limit, &run);
        worked = run.status == 0;
        forget(&run);
    }
    CHECK(worked);
}

static void put_files(void) {
    test_write_text(test_path("mod.lua"), "return require 'mod2'\n");
    test_write_text(test_path("mod2.lua"), "return {}\n");
    test_write_text(test_path("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_white_png("t.png", 8, 8);
}

static const char scene_with_files[] = "require 'mod' s = gr.sphere('s') s:set_texture('t.png')\n"
                                       "r = gr.node('n') r:add_child(s) r:add_child(gr.mesh{file = 'a.obj'}) " PICTURE;

TEST(few_descriptors_are_one_line_and_status_3) {
    put_files();
    put_scene(scene_with_files);
    descriptors_up_to_40("-q scene.lua", "x.pfm", 1);
    descriptors_up_to_40("-q --no-sandbox -o x.png scene.lua", "x.png", 1);
    descriptors_up_to_40("-q --no-fork scene.lua", "x.pfm", 1);
    descriptors_up_to_40("-q --checkpoint c -write-pre-aa pre- scene.lua", "x.pfm", 1);
    descriptors_up_to_40("-q --allow-read /usr -o folder/x.pfm scene.lua", "folder/x.pfm", 1);
}

TEST(few_descriptors_are_one_line_for_parts_and_several_scripts) {
    put_files();
    put_scene(scene_with_files);
    struct program_run run = run_limited("-q --shard 1/1 scene.lua", RLIMIT_NOFILE, NO_LIMIT);
    CHECK_EQ_INT(run.status, 0);
    forget(&run);
    descriptors_up_to_40("merge x.pfm.1-of-1.part -o m.png", "m.png", 1);
    descriptors_up_to_40("-q -o out-%d.pfm scene.lua scene.lua scene.lua", "out-3.pfm", 3);
}

/* A scene that opens all but `left` of its possible descriptors and then continues. */
TEST(descriptors_that_a_scene_holds_are_missed_with_status_3) {
    static const struct {
        const char *then;
        int needs; /* descriptors */
    } cases[] = {{"require 'mod'", 1},
                 {"dofile 'mod2.lua'", 1},
                 {"loadfile 'mod2.lua'", 1},
                 {"gr.texture('t.png')", 1},
                 {"gr.mesh{file = 'a.obj'}", 1},
                 {"pcall(gr.mesh, {file = 'a.obj'})", 1},
                 {"pcall(require, 'mod')", 1},
                 {"r = gr.sphere('s') " PICTURE, 1},
                 {"pcall(function() r = gr.sphere('s') " PICTURE " end)", 1}};
    put_files();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int left = 0; left <= 2; left++) {
            char text[2048];
            (void)snprintf(text, sizeof text,
                           "local held = {} while true do local f = io.open('mod2.lua') if not f then break end "
                           "held[#held + 1] = f end "
                           "for i = 1, %d do held[#held]:close() held[#held] = nil end\n%s\n",
                           left, cases[i].then);
            put_scene(text);
            struct program_run run = run_limited("-q scene.lua", RLIMIT_NOFILE, 30);
            bool sufficient = left >= cases[i].needs;
            bool right = sufficient ? run.status == 0
                                    : run.status == 3 && strstr(run.err, strerror(EMFILE)) && messages(run.err) == 1;
            if (!right)
                fail(text, left, &run);
            forget(&run);
        }
    }
}

/* --- names --- */

/* `text` with each NAME replaced by a name of `length` bytes. */
static void with_name(const char *text, size_t length, char *out, size_t size) {
    size_t used = 0;
    for (const char *at = text; *at && used + length + 2 < size; at++) {
        if (strncmp(at, "NAME", 4) != 0) {
            out[used++] = *at;
            continue;
        }
        memset(out + used, 'n', length);
        used += length;
        at += 3;
    }
    out[used] = '\0';
}

TEST(names_that_no_file_can_have_are_refused_with_status_1) {
    const char *too_long = strerror(ENAMETOOLONG);
    const struct {
        const char *text, *words;
    } cases[] = {
        {"gr.texture('NAME')", "gr.texture: cannot find '"},
        {"gr.texture('NAME.png')", "gr.texture: cannot find '"},
        {"gr.texture('folder/NAME/x.png')", "gr.texture: cannot find '"},
        {"gr.sphere('s'):set_texture('NAME')", "node:set_texture: cannot find '"},
        {"gr.bump('NAME')", "gr.bump: cannot find '"},
        {"gr.mesh{file = 'NAME'}", "gr.mesh: cannot find '"},
        {"gr.mesh{file = 'NAME.obj'}", "gr.mesh: cannot find '"},
        {"gr.sky_map{image = 'NAME'}", "gr.sky_map: cannot find '"},
        {"gr.height_field{image = 'NAME'}", "gr.height_field: cannot find '"},
        {"require 'NAME'", "require: cannot find module '"},
        {"require 'mod.NAME'", "require: cannot find module '"},
        {"dofile 'NAME'", "dofile: cannot find '"},
        {"error((select(2, loadfile 'NAME')))", "cannot find '"},
        {"error((select(2, io.open 'NAME')))", too_long},
        {"for line in io.lines 'NAME' do end", too_long},
    };
    static const size_t lengths[] = {256, 257, 300, 4000, 4096, 5000};
    put_files();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (size_t k = 0; k < sizeof lengths / sizeof lengths[0]; k++) {
            char text[SCENE_SIZE];
            with_name(cases[i].text, lengths[k], text, sizeof text);
            put_scene(text);
            struct program_run run = run_limited("-q scene.lua", RLIMIT_NOFILE, NO_LIMIT);
            char *name = strstr(run.err, "nnnnnn");
            bool cut = name && strspn(name, "n") < lengths[k];
            bool explained = strstr(run.err, "has at most") || strstr(run.err, "no such file") ||
                             strstr(run.err, "too long") || !cut;
            if (run.status != 1 || messages(run.err) != 1 || !strstr(run.err, cases[i].words) || !explained)
                fail(cases[i].text, (long)lengths[k], &run);
            forget(&run);
        }
    }
}

TEST(names_of_255_bytes_are_read) {
    char name[256], text[2048], path[1024];
    memset(name, 'n', 255);
    name[255] = '\0';
    put_files();
    (void)snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    CHECK(rename(test_path("t.png"), path) == 0);
    (void)snprintf(text, sizeof text, "s = gr.sphere('s') s:set_texture('%s') r = s " PICTURE, name);
    put_scene(text);
    struct program_run run = run_limited("-q scene.lua", RLIMIT_NOFILE, NO_LIMIT);
    if (run.status != 0)
        fail("a texture", 255, &run);
    forget(&run);
}

/* A name in a mesh file gives a warning, like other missing files. */
TEST(long_names_in_mesh_files_are_warnings) {
    static const size_t lengths[] = {256, 1000, 5000};
    for (size_t k = 0; k < sizeof lengths / sizeof lengths[0]; k++) {
        char text[SCENE_SIZE];
        with_name("mtllib NAME\nmtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n", lengths[k], text,
                  sizeof text);
        test_write_text(test_path("a.obj"), text);
        with_name("newmtl m\nmap_Kd NAME.png\n", lengths[k], text, sizeof text);
        test_write_text(test_path("a.mtl"), text);
        put_scene("r = gr.mesh{file = 'a.obj'} " PICTURE);
        struct program_run run = run_limited("scene.lua", RLIMIT_NOFILE, NO_LIMIT);
        if (run.status != 0 || !is_there("x.pfm") || !strstr(run.err, "is not there"))
            fail("a mesh file", (long)lengths[k], &run);
        forget(&run);
    }
}

TEST(a_scene_with_a_long_name_is_refused_with_status_1) {
    static const size_t lengths[] = {256, 300, 3000};
    for (size_t k = 0; k < sizeof lengths / sizeof lengths[0]; k++) {
        char arguments[4000];
        with_name("-q NAME.lua", lengths[k], arguments, sizeof arguments);
        struct program_run run = run_limited(arguments, RLIMIT_NOFILE, NO_LIMIT);
        if (run.status != 1 || messages(run.err) != 1)
            fail("a scene", (long)lengths[k], &run);
        forget(&run);
    }
}
