/* Rare paths through the binding: solids nested very deeply, thousands of changes, a library with modules of every
 * kind, code that runs after the end of a script, messages that only seem to contain a position, and failures of each
 * allocation and system call on such paths. */
#define _GNU_SOURCE
#include "base/fault.h"
#include "compat/order.h"
#include "sandbox/limits.h"
#include "script/table_internal.h"
#include "tests/unit/file_makers.h"
#include "tests/unit/script_host.h"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const char preparation[] =
    "glass = gr.rr_material({1, 1, 1}, {1, 1, 1}, 10, 0.5, 0.5, 1.5) ball = gr.sphere('ball') "
    "picture = {node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}}\n";

/* 26 unknown fields, so that in any iteration order some come after a smaller one. */
#define MANY "local t = {} for i = 0, 25 do t[string.char(97 + i) .. '_'] = i end "

static const struct corner corners[] = {
    /* bounds */
    {"local n = ball for i = 1, 2001 do n = gr.inverse(n) end n:bounds()", "nested more than 2000 deep"},
    {"gr.intersection('i', ball, gr.sphere{centre = {10, 0, 0}}):bounds()", "no shape is below this node"},
    /* changes */
    {"for i = 1, 4097 do gr.change_delete{name = 'x', serial = i} end", "more than 4096 changes"},
    {"gr.change_look(1, 'reflect', -1)", "value of reflect must be from 0 to 1, not -1"},
    {"gr.change_look(1, 'reflect', {1, 2})", "value has 2 numbers, but reflect has 1"},
    {"gr.change_delete{name = ('n'):rep(100), serial = 7} gr.node(('n'):rep(100)):add_child(ball) gr.render(picture)",
     NULL},
    /* arguments */
    {"gr.mesh{file = 'flag.obj', materials = {}}", NULL},
    {"gr.mesh{file = 'flag.obj', materials = {" /* longer than any word that is compared */
     "wrong_wrong_wrong_wrong_wrong = glass}}",
     "has no part 'wrong_wrong_wrong_wrong_wrong'"},
    {"gr.union{operands = {ball, gr.cube('c')}, b = gr.cube('d')}", NULL},
    {"gr.union{ball, gr.cube('c'), b = gr.cube('d')}", NULL},
    {"gr.polygon{points = {{0, 0, 0}, {1, 0, 0}}}", "points has 2 corners, not 3 or more"},
    {"gr.prism{outline = {{0, 0}, {1, 0}, {0, 1}}, holes = {{5}}}", "holes[1][1] must be a pair of numbers"},
    {MANY "gr.sphere(t)", "unknown field 'a_'"},
    {MANY "picture.caustics = t gr.render(picture)", "not 'a_'"},
    /* environments of an older Lua */
    {"local m = module m('one') m('one')", NULL},
    {"local m = module local function f() m('two') end f() assert(package.loaded.two)", NULL},
    /* files */
    {"gr.mesh{file = 'tests/scripts/flag.obj'} dofile('lua/knot.lua') error('...x', 0)", "...x"},
    {"gr.mesh{file = 'asset.obj'}", NULL},
    {"gr.image_material(glass, 'none1.0.png')", "cannot find 'none1.0.png'"},
    {"gr.image_material(glass, arg_folder .. 'none.png')", "cannot find '/"},
    {"dofile('huge.lua')", "huge.lua"},
    {"require('lua.knot')", NULL},
    /* positions in messages and text that resembles one */
    {"error('...' .. (arg_folder .. 'scene.lua'):sub(-56) .. ' x', 0)", "scene.lua x"},
    {"error(arg_folder .. 'scene.luax', 0)", "scene.luax"},
    {"error('[string \"x\"] y', 0)", "] y"},
    {"error('[string \"x\"]:12 y', 0)", "]:12 y"},
    {"error('[string \"x\"]:12:y', 0)", "]:12:y"},
    /* after the end */
    {"local c <close> = setmetatable({}, {__close = function() gr.node('late') end}) os.exit()", NULL},
    {"xpcall(os.exit, error)", NULL},
    {"assert(getmetatable(setmetatable(setmetatable({}, {}), nil)) == nil)", NULL},
};

static void put(const char *name, const char *text) {
    test_write_text(test_path(name), text);
}

static void make_folder(const char *name) {
    CHECK(mkdir(test_path(name), 0777) == 0);
}

static void make_huge(const char *name, off_t size) {
    const char *path = test_path(name);
    test_write_text(path, "");
    CHECK(truncate(path, size) == 0);
}

static const char flag[] =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\ng a_group_with_a_name_that_is_longer_than_forty_letters\nf 1 2 3\n";

static void write_files(void) {
    write_white_png("pic1.png", 8, 8);
    make_folder("Assets");
    put("Assets/asset.obj", flag);
    put("flag.obj", flag);
    put("good.lua", "return 5");
    make_huge("huge.lua", ((off_t)1 << 28) + 1);
}

TEST(the_rarest_forms_of_scripts_run_or_are_reported) {
    write_files();
    for (size_t i = 0; i < sizeof corners / sizeof corners[0]; i++)
        check_corner(preparation, &corners[i], NULL);
}

/* The first 3354 are measured corner by corner, the others by the corners of a box. */
TEST(bounds_of_millions_of_faces_are_those_of_a_few) {
    static const struct corner many = {
        "local faces, at = {}, {} for i = 1, 5000 do faces[i] = {0, 1, 2} end for i = 1, 3400 do at[i] = {i, 0, 0} end "
        "local sheet = gr.mesh{verts = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, faces = faces} "
        "local low, high = gr.instances{of = sheet, at = at}:bounds() "
        "assert(low[1] == 1 and low[2] == 0 and high[1] == 3401 and high[2] == 1)",
        NULL};
    check_corner("", &many, NULL);
}

TEST(ghosts_follow_lists_of_materials_and_forms_of_arguments) {
    static const struct corner ghosts[] = {
        {"local g = gr.unknown() gr.mesh{verts = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, faces = {{0, 1, 2}, {0, 2, 1}}, "
         "materials = {g, glass}, face_materials = {1, 2}}",
         NULL},
        {"local g = gr.unknown() gr.union('u', ball, gr.cube('c'), g, gr.cube('d'))", NULL},
    };
    const struct script_options lenient = {
        .transform_order = SCRIPT_ORDER_NEW, .library_folder = "lua", .lenient = true};
    for (size_t i = 0; i < sizeof ghosts / sizeof ghosts[0]; i++)
        check_corner(preparation, &ghosts[i], &lenient);
}

/* Otherwise messages would contain this name instead of the node's own. */
TEST(no_method_takes_a_text) {
    for (int f = 0; f < function_count(); f++)
        for (int p = 0; p < function_at(f)->parameter_count; p++)
            CHECK(function_at(f)->owner == OWNER_GR || function_at(f)->parameters[p].kind != KIND_TEXT);
}

TEST(the_newest_change_of_a_view_and_of_the_exposure_counts) {
    struct listener listener = {.renders = 0};
    struct error error;
    static const char text[] =
        "local ball = gr.sphere('ball')\n"
        "gr.change_view{picture = 'x.png', eye = {0, 0, 5}, view = {0, 0, -1}, up = {0, 1, 0}, fov = 30}\n"
        "gr.change_view{picture = 'x.png', eye = {0, 0, 7}, view = {0, 0, -1}, up = {0, 1, 0}, fov = 40}\n"
        "gr.change_view{picture = 'y.png', eye = {0, 0, 6}, view = {0, 0, -1}, up = {0, 1, 0}, fov = 20}\n"
        "gr.change_exposure{picture = 'x.png', stops = 1} gr.change_exposure{picture = 'x.png', stops = 2}\n"
        "gr.change_view{picture = 'x.png', eye = {0, 0, 7}, view = {0, 0, -1}, up = {0, 1, 0}, fov = 40}\n"
        "gr.change_exposure{picture = 'y.png', stops = 3}\n"
        "gr.render{node = ball, file = 'y.png', width = 4, height = 4, eye = {0, 0, 9}}\n"
        "gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}}\n";
    CHECK(listen_to_text(&listener, text, NULL, &error));
    CHECK(listener.last.camera.eye.z == 7 && listener.last.camera.fov == 40);
    CHECK(listener.last.settings.tone.exposure == 2);
}

TEST(a_change_that_fits_nothing_is_reported_once_for_all_pictures) {
    struct listener listener = {.renders = 0};
    struct error error;
    static const char text[] =
        "local ball = gr.sphere('ball') gr.change_delete{name = 'nobody', serial = 7}\n"
        "for i = 1, 3 do gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, lights = {}} "
        "end\n";
    CHECK(listen_to_text(&listener, text, NULL, &error));
    CHECK_EQ_INT(listener.renders, 3);
    CHECK_EQ_INT(listener.messages, 1);
}

/* coroutine.wrap and error each prepend a position: only the innermost is reported. */
TEST(an_error_that_was_caught_and_raised_again_names_one_line) {
    struct listener listener = {.renders = 0};
    struct error error;
    CHECK(!listen_to_text(&listener, "local ok, m = pcall(function()\nerror('deep') end)\nerror(m)", NULL, &error));
    const char *position = strstr(error.text, "scene.lua:2: deep");
    CHECK(position && !strstr(position + 1, "scene.lua:") && !strstr(error.text, "scene.lua:3"));
}

/* A __close handler has no effect while an error propagates that scripts cannot catch. */
TEST(nothing_is_made_after_a_picture_that_failed_for_good) {
    struct listener listener = {.renders = 0};
    struct error error;
    error_set(&listener.answer, ERROR_MACHINE, "the disc is full");
    static const char text[] =
        "local ball = gr.sphere('ball')\n"
        "local c <close> = setmetatable({}, {__close = function() gr.node('late') print('never') end})\n"
        "gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}}\n";
    CHECK(!listen_to_text(&listener, text, NULL, &error));
    CHECK(error.kind == ERROR_MACHINE);
    CHECK(strstr(error.text, "the disc is full") != NULL);
    CHECK_EQ_INT(listener.renders, 1);
}

/* Limits. */

TEST(scripts_end_where_memory_ends_whatever_they_are_doing) {
    static const char *const texts[] = {
        /* nearly all of the memory requested here is a chunk for setfenv */
        "local e, hold = {}, {} local function f() return x end while true do hold = {hold} setfenv(f, e) end",
        /* a handler that would be called for an error during __close */
        "xpcall(function() local c <close> = setmetatable({}, {__close = function() error('again') end})\n"
        "local t = {} while true do t[#t + 1] = {} end end, function(m) return m end)",
    };
    const struct script_options small = {.transform_order = SCRIPT_ORDER_NEW, .memory_limit = 1 << 20};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        struct listener listener = {.renders = 0};
        struct error error;
        CHECK(!listen_to_text(&listener, texts[i], &small, &error));
        CHECK(strstr(error.text, "used up its memory of 1 MiB") != NULL);
    }
}

TEST(warnings_count_as_output_too) {
    const struct script_options lenient = {
        .transform_order = SCRIPT_ORDER_NEW, .lenient = true, .output_limit = 1 << 20};
    struct listener listener = {.renders = 0};
    struct error error;
    CHECK(!listen_to_text(&listener, "local b = gr.sphere('b') for i = 1, 1e6 do local _ = b['x' .. i] end", &lenient,
                          &error));
    CHECK(strstr(error.text, "printed more than its 1 MiB") != NULL);
}

/* Lua repeats the request after it has collected its garbage; success of another request does not undo the refusal. */
TEST(memory_that_was_refused_is_forgotten_only_when_it_is_got_after_all) {
    struct limits limits = {.account = {.limit = 10000}};
    (void)mem_charge(&limits.account);
    char *kept = limits_allocate(&limits, NULL, 0, 100), *large = limits_allocate(&limits, NULL, 0, 9000);
    CHECK(kept && large && !limits.memory_out);
    CHECK(!limits_allocate(&limits, kept, 100, 2000) && limits.memory_out);
    CHECK(!limits_allocate(&limits, large, 9000, 0));
    kept = limits_allocate(&limits, kept, 100, 2000); /* garbage was collected, and now it fits */
    CHECK(kept && !limits.memory_out);
    large = limits_allocate(&limits, NULL, 0, 7000);
    CHECK(!limits_allocate(&limits, kept, 2000, 8000) && limits.memory_out);
    large = limits_allocate(&limits, large, 7000, 50); /* shrinking a block is not a request */
    CHECK(large && !limits.refused_for_good);
    void *same_size = limits_allocate(&limits, NULL, 0, 8000); /* for another caller */
    CHECK(!same_size && limits.memory_out);
    CHECK(!limits_allocate(&limits, large, 50, 0));
    kept = limits_allocate(&limits, kept, 2000, 8000);
    CHECK(kept && limits.memory_out); /* too late */
    CHECK(!limits_allocate(&limits, kept, 8000, 0));
    /* Another request was granted first. */
    limits.memory_out = limits.refused_for_good = false;
    kept = limits_allocate(&limits, NULL, 0, 100);
    CHECK(!limits_allocate(&limits, kept, 100, 20000) && limits.memory_out);
    void *other = limits_allocate(&limits, NULL, 0, 20), *more = limits_allocate(&limits, other, 20, 200);
    CHECK(more && limits.memory_out && limits.refused_for_good);
    CHECK(!limits_allocate(&limits, more, 200, 0) && !limits_allocate(&limits, kept, 100, 0));
    CHECK_EQ_INT((long long)limits.account.held, 0);
    (void)mem_charge(NULL);
}

/* The library. */

static void write_library(void) {
    make_folder("lib");
    put("lib/outer.lua", "return {get = function(name) return require(name) end}");
    put("lib/inner.lua", "return 'library'");
    put("lib/broken.lua", "x = = 1");
    put("inner.lua", "return 'mine'");
    put("broken.lua", "return 'mine too'");
    put("libx.lua", "return 'beside'");
}

TEST(modules_of_the_library_find_each_other_and_not_those_of_the_scene) {
    static const struct corner all[] = {
        {"assert(outer.get('inner') == 'library' and outer.get('inner') == 'library' and require('inner') == 'mine')",
         NULL},
        {"outer.get('broken')", "lib/broken.lua:1"},
        {"outer.get('a.b')", "cannot find module 'a.b'"},
        {"outer.get(('x'):rep(5000))", "cannot find module 'xxx"},
        {"outer.get('nothing')", "cannot find module 'nothing'"},
        {"assert(dofile('libx.lua') == 'beside')", NULL},
        {"package.path = nil outer.get('inner')", "package.path must be a string"},
        {"package.path = '' outer.get('inner')", "cannot find module 'inner'"},
    };
    const struct script_options options = {.transform_order = SCRIPT_ORDER_AUTO, .library_folder = test_path("lib")};
    write_library();
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        check_corner("outer = require('outer') ", &all[i], &options);
}

TEST(an_empty_name_of_the_library_is_none_where_there_is_no_sandbox) {
    const struct script_options options = {
        .transform_order = SCRIPT_ORDER_NEW, .library_folder = "", .no_sandbox = true};
    static const struct corner none = {"dofile('good.lua') require('knot')", "cannot find module 'knot'"};
    put("good.lua", "return 5");
    check_corner("", &none, &options);
}

/* Without the sandbox a chunk may be byte code, possibly without globals that setfenv could replace. */
TEST(byte_code_without_globals_is_loaded_where_there_is_no_sandbox) {
    static const struct corner all[] = {
        {"local function put(name) local f = assert(io.open(arg_folder .. name, 'wb')) "
         "f:write(string.dump(load('local function f() return 7 end return f')())) f:close() end "
         "put('lib/byte.lua') put('byte.out') assert(require('byte') == 7) "
         "assert(loadfile('byte.out', 'b', {})() == 7)",
         NULL},
    };
    const struct script_options options = {
        .transform_order = SCRIPT_ORDER_NEW, .library_folder = test_path("lib"), .no_sandbox = true};
    make_folder("lib");
    check_corner("", &all[0], &options);
}

TEST(modules_beside_and_above_are_named_by_relative_paths) {
    static const char beside[] = "package.path = './?.lua' require('module')",
                      above[] = "package.path = '../?.lua' assert(require('above') == 8)";
    struct listener listener = {.renders = 0};
    struct error error;
    const struct script_options options = {.transform_order = SCRIPT_ORDER_NEW};
    put("module.lua", "local t = nil; return t.x");
    put("above.lua", "return 8");
    make_folder("Assets");
    make_folder("scenes");
    put("Assets/asset.obj", flag);
    put("scenes/scene.lua", "gr.mesh{file = 'asset.obj'}");
    CHECK(chdir(test_folder()) == 0);
    CHECK(!listen_to_text(&listener, beside, &options, &error));
    CHECK(strncmp(error.text, "module.lua:1: ", 14) == 0);
    CHECK(chdir("scenes") == 0);
    CHECK(listen_to_text(&listener, above, &options, &error));
    CHECK(listen_to(&listener, test_path("scenes/scene.lua"), &options, &error, NULL));
}

/* A file without read permission, opened by a user other than root: the message contains the reason of the system. */
TEST(errors_of_the_system_are_reported_in_its_words_without_a_sandbox) {
    const struct script_options options = {.transform_order = SCRIPT_ORDER_NEW, .no_sandbox = true};
    static const struct corner refused = {"assert(io.open(arg_folder .. 'closed.txt'))",
                                          "closed.txt: Permission denied"};
    char path[512];
    (void)snprintf(path, sizeof path, "%s/closed.txt", test_folder());
    test_write_text(path, "x");
    (void)snprintf(path, sizeof path, "%s/scene.lua", test_folder());
    test_write_text(path, "");
    CHECK(chmod(path, 0666) == 0);
    /* The folder, and those of the runner above it. */
    for (char *slash; (slash = strrchr(path, '/')) != NULL && slash > path && strcmp(path, "/tmp") != 0;) {
        *slash = '\0';
        if (strcmp(path, "/tmp") != 0)
            (void)chmod(path, 0755);
    }
    (void)snprintf(path, sizeof path, "%s/closed.txt", test_folder());
    CHECK(chmod(path, 0) == 0);
    uid_t me = geteuid();
    if (me == 0)
        CHECK(seteuid(65534) == 0);
    check_corner("", &refused, &options);
    CHECK(seteuid(me) == 0);
}

/* The order of transforms. */

TEST(arguments_of_mesh_calls_decide_the_transform_order) {
    static const struct {
        const char *text;
        enum transform_order order;
        const char *reason;
    } all[] = {
        {"gr.mesh(gr.material({1}), {2}, {3})", TRANSFORM_ORDER_NEW, "gr.mesh is given a material (line 1)"},
        {"gr.mesh(t[1], {2}, {3})", TRANSFORM_ORDER_OLD, "gr.mesh is given vertex tables (line 1)"},
        {"\ngr.mesh(t[1], u, v)", TRANSFORM_ORDER_OLD, "gr.mesh is given vertex tables (line 2)"},
        {"gr.mesh(t, u, )", TRANSFORM_ORDER_NEW, ""},
        {"gr.mesh('a', 'b.obj')", TRANSFORM_ORDER_NEW, "gr.mesh reads a file (line 1)"},
    };
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        struct order_finding finding;
        order_of_text(all[i].text, strlen(all[i].text), &finding);
        CHECK(finding.order == all[i].order);
        CHECK_TEXT(finding.reason, all[i].reason);
    }
}

static struct order_finding order_of_scene(const char *name, const char *text, const char *library) {
    struct order_finding finding;
    struct error error = {0};
    const char *path = test_path(name);
    if (text)
        test_write_text(path, text);
    CHECK(order_detect(path, library, NULL, &finding, &error));
    return finding;
}

TEST(the_transform_order_is_looked_for_in_files_wherever_require_finds_them) {
    char library[512], many[4096] = "", path[8192];
    struct order_finding finding;
    struct error error = {0};
    make_folder("lib");
    make_folder("lua");
    make_folder("scenes");
    (void)snprintf(library, sizeof library, "%s/lib", test_folder());
    put("libx.lua", "readobj('x') gr.x()");
    put("lib/in_library.lua", "readobj('x') gr.x()");
    put("lua/shared.lua", "readobj('x') gr.x()");
    CHECK(order_of_scene("scenes/a.lua", "require('shared')", library).order == TRANSFORM_ORDER_OLD);
    CHECK(order_of_scene("a.lua", "require('lib.in_library') gr.mesh('a', 'b.obj')", library).order ==
          TRANSFORM_ORDER_NEW);
    CHECK(order_of_scene("a.lua", "require('libx')", library).order == TRANSFORM_ORDER_OLD);
    CHECK(order_of_scene("scenes/b.lua", "require('tests.scripts.classic')", library).order ==
          order_of_scene("scenes/b.lua", "dofile('tests/scripts/classic.lua')", library).order);
    CHECK(strstr(order_of_scene("missing.lua", NULL, library).reason, "of its neighbour libx.lua") != NULL);
    /* The 64th file is the last one inspected. */
    for (int i = 1; i <= 70; i++) {
        char name[32];
        (void)snprintf(name, sizeof name, "scenes/m%d.lua", i);
        put(name, i == 70 ? "readobj('x') gr.x()" : "gr.mesh('a', 'b.obj')");
        (void)snprintf(many + strlen(many), sizeof many - strlen(many), "require 'm%d' ", i);
    }
    CHECK(order_of_scene("scenes/c.lua", many, library).order == TRANSFORM_ORDER_NEW);
    /* A path that is nearly too long, and a name that makes it so. */
    (void)snprintf(path, sizeof path, "%s/scenes/", test_folder());
    while (strlen(path) < 4000)
        strcat(path, "./");
    strcat(path, "d.lua");
    (void)snprintf(many, sizeof many, "require '%0300d'", 1);
    put("scenes/d.lua", many);
    CHECK(order_detect(path, library, NULL, &finding, &error));
}

TEST(old_neighbours_are_counted_and_the_first_is_named) {
    put("one.lua", "readobj('x') gr.x()");
    put("two.lua", "readobj('y') gr.x()");
    put("none.lua", "print(1)");
    make_huge("huge.lua", (1 << 20) + 1);
    struct order_finding finding = order_of_scene("zero.lua", "gr.x()", NULL);
    CHECK(finding.order == TRANSFORM_ORDER_OLD);
    CHECK(strstr(finding.reason, "of its neighbour ") && strstr(finding.reason, ".lua: it uses readobj (line 1)"));
}

/* Failures on demand. */
#ifdef GRAY_FAULTS

/* Runs the text repeatedly, with each possible failure after its picture. own: words of the error with which it ends by
 * itself, or NULL. */
static void fail_after_picture(const char *text, enum fault_kind kind, const struct script_options *options,
                               const char *own) {
    char whole[4096];
    (void)snprintf(whole, sizeof whole, "%s gr.render(picture) %s\n", preparation, text);
    for (uint64_t k = 1;; k++) {
        struct error error;
        struct listener listener = {.fail_at = k, .fail_kind = kind};
        bool done = listen_to_text(&listener, whole, options, &error);
        bool over = fault_count(kind) < listener.failing;
        fault_at(kind, 0);
        bool expected = own ? !done && strstr(error.text, own) : done;
        bool reported =
            !done && error.kind == (kind == FAULT_OF_ALLOCATION ? ERROR_MACHINE : error.kind) && error.text[0];
        if (over ? !expected : !expected && !reported)
            test_fail(__FILE__, __LINE__, "%s: failure %llu: %s (kind %d)", text, (unsigned long long)k,
                      done ? "runs" : error.text, (int)error.kind);
        if (over || listener.failing == 0)
            break;
    }
}

TEST(memory_may_end_on_the_rarest_paths) {
    const struct script_options lenient = {
        .transform_order = SCRIPT_ORDER_NEW, .library_folder = "lua", .lenient = true};
    write_files();
    fail_after_picture("gr.union('u', ball, gr.unknown())", FAULT_OF_ALLOCATION, &lenient, NULL);
    fail_after_picture("gr.sphere(5) gr.sphere(1.5)", FAULT_OF_ALLOCATION, NULL, NULL);
    fail_after_picture("gr.image_material(glass, 'pic1.0.png')", FAULT_OF_ALLOCATION, NULL, NULL);
    fail_after_picture("gr.change_delete{name = 'ball', serial = 0} gr.render(picture)", FAULT_OF_ALLOCATION, NULL,
                       NULL);
    fail_after_picture(
        "picture.lights = {gr.light({0, 0, 9}, {1, 1, 1}, {1, 0, 0})}\n"
        "gr.change_node('ball', 0, {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0}) gr.change_add('ball', 0, 'cube')\n"
        "gr.change_add('ball', 0, 'copy', {1, 1, 1}, 0) gr.change_light(1, {1, 0, 0})\n"
        "gr.change_delete_light(1) gr.change_add_light({1, 2, 3}, {1, 1, 1}) gr.render(picture)",
        FAULT_OF_ALLOCATION, NULL, NULL);
    fail_after_picture("local function f()\nerror('first\\n\\tsecond') end f()", FAULT_OF_ALLOCATION, NULL, "first");
    fail_after_picture("dofile('good.lua')", FAULT_OF_ALLOCATION, NULL, NULL);
}

TEST(calls_to_the_system_may_fail_on_the_rarest_paths) {
    const struct script_options options = {.transform_order = SCRIPT_ORDER_NEW, .library_folder = test_path("lib")};
    write_files();
    write_library();
    fail_after_picture("gr.mesh{file = 'flag.obj'}", FAULT_OF_CALL, NULL, NULL);
    fail_after_picture("gr.image_material(glass, 'pic1.png')", FAULT_OF_CALL, NULL, NULL);
    fail_after_picture("dofile('good.lua')", FAULT_OF_CALL, NULL, NULL);
    fail_after_picture("require('outer').get('inner')", FAULT_OF_CALL, &options, NULL);
}

TEST(memory_may_end_while_the_transform_order_is_looked_for) {
    const struct script_options automatic = {.transform_order = SCRIPT_ORDER_AUTO};
    int failed = 0;
    for (uint64_t k = 1; k <= 8; k++) {
        struct listener listener = {.renders = 0};
        struct error error;
        char path[512];
        (void)snprintf(path, sizeof path, "%s/scene.lua", test_folder());
        test_write_text(path, "gr.node('n')");
        fault_at(FAULT_OF_ALLOCATION, k);
        bool done = listen_to(&listener, path, &automatic, &error, NULL);
        fault_at(FAULT_OF_ALLOCATION, 0);
        CHECK(done || error.kind == ERROR_MACHINE);
        failed += !done;
    }
    CHECK(failed > 2);
}
#endif

/* In the window one walks past the point. */
TEST(a_camera_that_was_moved_past_the_point_in_focus_focuses_at_the_distance_of_the_point) {
    test_write_text(test_path("a.lua"),
                    "if moved then gr.change_view('a.png', {0, 0, -3}, {0, .5, -1}, {0, 1, 0}, 40) end\n"
                    "gr.render{node = gr.sphere{centre = {0, 3, -9}}, file = 'a.png', width = 40, height = 30, "
                    "eye = moved and {0, 0, 9} or {0, 0, -3}, view = {0, .5, -1}, fov = 40, aperture = .4, "
                    "focus = not moved and 5 or nil, focus_point = moved and {0, 3, 1} or nil}\n");
    test_shell_errors("$gray -q a.lua -o b.png && $gray -q a.lua -D moved=true && cmp a.png b.png", 0, NULL);
}
