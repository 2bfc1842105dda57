/* Rare features of scripts, one short text each: it runs, or it is refused with these words. Also scripts of an older
 * Lua, unknown names under --lenient, values of -D, truncated texts for the transform order. */
#include "base/document.h"
#include "base/fault.h"
#include "compat/order.h"
#include "script/document.h"
#include "script/table_internal.h"
#include "tests/unit/file_makers.h"
#include "tests/unit/script_host.h"

#include <sys/stat.h>

/* long(x): a table of 41 entries whose length is 2^40, since Lua searches its border by doubling. */
static const char preparation[] =
    "glass = gr.rr_material({1, 1, 1}, {1, 1, 1}, 10, 0.5, 0.5, 1.5) ball = gr.sphere('ball') "
    "lamp = gr.light({0, 0, 0}, {1, 1, 1}, {1, 0, 0}) function long(x) local s = {} for k = 0, 40 do s[k + 1] = "
    "('[%d] = x'):format(2 ^ k) end return load('local x = ... return {' .. table.concat(s, ', ') .. '}')(x) end\n";

static const struct corner corners[] = {
    /* numbers and texts of an older Lua */
    {"assert(table.maxn{a = 1, 5, [7.5] = 1} == 7.5)", NULL},
    {"assert(math.ldexp(1, 20000) == math.huge and math.ldexp(1, -20000) == 0 and math.ldexp(3, 2) == 12)", NULL},
    {"math.randomseed(1e300) math.randomseed(1.5) math.randomseed(3) math.randomseed()", NULL},
    {"assert(string.format('%d %5.1f%%', 3.0, 2) == '3   2.0%')", NULL},
    /* a NaN has no sign, on any machine */
    {"local z = 0 for _, n in ipairs{z / z, -(z / z), math.huge - math.huge} do assert(tostring(n) == 'nan' and n .. "
     "'' "
     "== 'nan' and ('%g %5.1f %E'):format(n, n, n) == 'nan   nan NAN' and table.concat{n} == 'nan' and "
     "('>d'):pack(n) == '\\x7f\\xf8\\0\\0\\0\\0\\0\\0' and ('>f'):pack(n) == '\\x7f\\xc0\\0\\0') end",
     NULL},
    {"assert(('<i4d'):pack(-7, 0.5) == '\\xf9\\xff\\xff\\xff\\0\\0\\0\\0\\0\\0\\xe0\\x3f' and -1 / 0 .. '' == '-inf')",
     NULL},
    /* fractions of positions and counts are cut, toward zero; those of values stay */
    {"assert(('abcdef'):sub(1, 7 / 2) == 'abc' and ('abcdef'):sub(-2.5) == 'ef' and ('ab'):rep(5 / 2, '-') == 'ab-ab')",
     NULL},
    {"assert(string.char(65.7, 66.2) == 'AB' and select('#', ('ABC'):byte(1.9, 2.9)) == 2 and ('XX'):find('X', 2.9) == "
     "2)",
     NULL},
    {"assert(select(2.5, 1, 2, 3) == 2 and table.concat({1, 2, 3}, ',', 1.5, 2.7) == '1,2' and unpack({7, 8}, 2.5) == "
     "8)",
     NULL},
    {"local t = {1, 2} table.insert(t, 2.5, 9) table.insert(t, 0.5) assert(t[4] == 0.5 and table.remove(t, 2.5) == 9)",
     NULL},
    {"('a'):sub({})", "scene.lua:2: bad argument #1 to 'sub' (number expected, got table)"},
    {"('a'):rep(0 / 0)", "scene.lua:2: bad argument #1 to 'rep' (number has no integer representation)"},
    /* errors of replaced functions name the line and the function, as those of Lua do */
    {"math.random(0, -1)", "scene.lua:2: bad argument #1 to 'random' (interval is empty)"},
    {"string.format('%.2f', {})", "scene.lua:2: bad argument #2 to 'format' (number expected, got table)"},
    {"load()", "scene.lua:2: bad argument #1 to 'load' (function expected, got no value)"},
    {"coroutine.resume(1)", "scene.lua:2: bad argument #1 to 'resume' (thread expected, got number)"},
    {"coroutine.wrap(1)", "scene.lua:2: bad argument #1 to 'wrap' (function expected, got number)"},
    {"math.randomseed(3) local x = math.random(1e6) math.randomseed(3) assert(math.random(1e6 + 0.5) == x)", NULL},
    {"assert(not pcall(string.format, '%5') and not pcall(string.format, '%d', 1e300))", NULL},
    {"assert(not pcall(string.format, '%d', 0 / 0) and string.format('%d', 1.0) == '1')", NULL},
    /* environments */
    {"assert(getfenv(1) == _G and getfenv(0) == _G and getfenv(print) == _G and getfenv(150) == _G)", NULL},
    {"assert(getfenv(-1) == _G and getfenv(201) == _G and getfenv(function() return 1 end) == _G)", NULL},
    {"local _, _E, _EN, _ENx, _ENVx, a = 1, 2, 3, 4, 5, 6 local function f() return a, _, _E, _EN, _ENx, _ENVx, q end "
     "setfenv(f, {q = 7}) assert(select(7, f()) == 7 and getfenv(f).q == 7)",
     NULL},
    {"setfenv(function() return 1 end, {}) setfenv(1, {assert = assert}) assert(not gr)", NULL},
    {"setfenv(print, {})", "setfenv: there is no such Lua function"},
    {"setfenv(150, {})", "setfenv: there is no such Lua function"},
    {"setfenv(-2, {})", "setfenv: there is no such Lua function"},
    {"setfenv(1000, {})", "setfenv: there is no such Lua function"},
    {"local t = {} package.seeall(t) assert(t.print == print)", NULL},
    {"local t = setmetatable({}, {}) package.seeall(t) assert(t.print == print)", NULL},
    {"a = {b = {}} module('a.b', package.seeall) assert(_NAME == 'a.b')", NULL},
    {"module('one', 5) module('one')", "attempt to call"},
    {"pcall(module, 'two') assert(package.loaded.two)", NULL},
    {"coroutine.wrap(module)('three') assert(package.loaded.three)", NULL},
    {"assert(table.foreach({a = 1}, function() return 5 end) == 5)", NULL},
    {"assert(table.foreachi({1, 2}, function(i) if i == 2 then return 6 end end) == 6)", NULL},
    /* scenes of courses */
    {"gr.mesh('m', 'flag') gr.mesh('flag', 'torso') gr.joint('knee') gr.joint('hip', {-10, 0, 10})", NULL},
    {"gr.mesh('m', 'nothing')", "cannot find 'nothing'"},
    {"gr.mesh('m', 'flag.ply')", "cannot find 'flag.ply'"},
    {"local up, v = {0, 0, 1}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}} gr.mesh('m', v, {up, up, up}, {{0, 1, 2}})", NULL},
    {"gr.mesh('m', {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}}, {{0, 1, 2}})", "normals ends with number 0"},
    {"require('readobj') local v, f = readobj('elsewhere/pole.obj') assert(#v == 3 and #f == 1)", NULL},
    {"require('readobj') local v, f = readobj('pole.obj') assert(#v == 3 and #f == 1)", NULL},
    /* handles and other values */
    {"gr.sphere(io.stdout)", "a userdata"},
    {"gr.sphere(coroutine.create(print))", "a coroutine"},
    {"ball.scale()", "nothing"},
    {"ball.scale(glass, 1, 2, 3)", "a material"},
    {"ball.scale(7)", "a number"},
    {"assert(tostring(glass) == 'material' and tostring(ball) == \"node 'ball'\" and tostring(lamp) == 'light')", NULL},
    {"assert(gr[5] == nil and ball[5] == nil and ball[{}] == nil)", NULL},
    {"ball[5]()", "attempt to call"},
    {"for k in pairs({[{}] = 1, [{1}] = 2, [io.stdout] = 3, [ball] = 4, [true] = 5, x = 6, [1.5] = 7}) do end", NULL},
    {"local t = setmetatable({}, {__pairs = function(t) coroutine.yield() return next, {1}, nil end}) "
     "local c = coroutine.wrap(function() local n = 0 for k in pairs(t) do n = n + k end return n end) c() "
     "assert(c() == 1)",
     NULL},
    /* arguments */
    {"gr.node{name = 5} gr.node{name = 1.5}", NULL},
    {"ball:rotate('', 20)", "axis"},
    {"gr.lathe{points = {{1, 1}, 7}}", "points[2] must be a table of 2 numbers"},
    {"gr.mesh{verts = {{0, 0, 0}}, faces = {{0, 1, 5e9}}}", "indices count from 0"},
    {"gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, caustics = {zeta = 1, alpha = 2, "
     "omega = 3}}",
     "alpha"},
    {"gr.sphere{zeta = 1, alpha = 2, omega = 3}", "alpha"},
    {"ball:rotate_quat('x')", "rotate_quat"},
    {"gr.mesh{file = 'flag.obj', materials = {a = 5}}", "materials['a'] must be a material, not a number"},
    {"local m = {} for i = 1, 1001 do m['a' .. i] = glass end gr.mesh{file = 'flag.obj', materials = m}",
     "materials has more than 1000 entries"},
    /* tables that pretend to be long: see the preparation */
    {"gr.node{children = long(ball)}", "has too many entries"},
    {"gr.mesh{verts = {{0, 0, 0}}, faces = {long(0)}}", "too many corners"},
    {"gr.height_field{heights = {long(0), long(0)}}", "has too many entries"},
    {"gr.union('u', ball, nil, ball)", "b is missing"},
    {"gr.union('u', ball, ball, 5)", NULL},
    {"gr['sphere[']()", "sphere["},
    {"gr.xy()", "xy"},
    {"gr.aaaaaaaaaabbbbbbbbbbccccccccccddddddddddeeeeeeeeee()", "aaaa"},
    {"gr.SPHERE()", "did you mean gr.sphere"},
    /* chunks from texts, and places in messages */
    {"assert(load('gr.sphere(true)', '=piece'))()", "gr.sphere: "},
    {"assert(load(\"error('here')\"))()", "[string \""},
    {"error('scene.lua:12 x', 0)", "scene.lua:12 x"},
    {"error('scene.lua:12:x', 0)", "scene.lua:12:x"},
    {"error('scene.luax', 0)", "scene.luax"},
    {"coroutine.wrap(function() error('inside') end)()", "inside"},
    {"local ok, m = pcall(error, 'deep') error(m)", "deep"},
    {"error(setmetatable({}, {__tostring = function() error('worse') end}))", "worse"},
    /* files */
    {"assert(not pcall(io.open, 'scene.lua', '') and not pcall(io.open, 'scene.lua', 'x'))", NULL},
    {"assert(not pcall(io.open, 'scene.lua', 'rz') and io.open('scene.lua', 'rb')):close()", NULL},
    {"pcall(io.lines) for a, b in io.lines('scene.lua', 1, 2) do assert(#a == 1) break end", NULL},
    {"io.lines('missing.txt')", "missing.txt"},
    {"io.input('missing.txt')", "missing.txt"},
    {"assert(package.searchpath('scene', './?.lua;' .. arg_folder .. '?.lua'))", NULL},
    {"assert(not package.searchpath('x', '') and not package.searchpath('x', '?', '') and not "
     "package.searchpath('x.y', "
     "'?', '.', '_'))",
     NULL},
    {"package.path = nil require('x')", "package.path must be a string"},
    {"package.path = ';;?;' .. ('y'):rep(5000) require('x')", "x"},
    {"package.searchers = nil require('x')", "'package.searchers' must be a table"},
    {"table.insert(package.searchers, function() return nil end) require('x')", "module 'x' not found"},
    {"require('shapes.of.none')", "shapes"},
    {"package.loaded.package = nil require('meshes')", NULL},
    {"package.path = nil package.loaded.package = 5 pcall(require, 'meshes')", NULL},
    {"package.path = '' pcall(require, 'meshes')", NULL},
    {"dofile('/missing.lua')", "missing.lua"},
    {"dofile('../../../../../../../../missing.lua')", "missing.lua"},
    {"dofile('bad.lua')", "bad.lua:1"},
    {"dofile('thrower.lua')", "attempt to index"},
    {"assert(loadfile('good.lua'))() assert(loadfile('good.lua', 't', {}))() assert(not loadfile('missing.lua'))",
     NULL},
    {"assert(loadfile('plain.lua', 't', {}))()", NULL},
    {"dofile('hash.lua') dofile('hash_only.lua') dofile('empty.lua') dofile('mark.lua')", NULL},
    {"dofile('wide.lua')", "wide.lua:1: this is UTF-16 text; save it as UTF-8"},
    {"require('wide_plain')", "wide_plain.lua:1: this is UTF-16 text; save it as UTF-8"},
    {"gr.image_material(glass, 'pic' .. 1.0 .. '.png')", NULL},
    {"gr.image_material(glass, '/missing.png')", "missing.png"},
    {"gr.image_material(glass, ('x'):rep(5000))", "xxx"},
    /* the sandbox */
    {"local c = coroutine.create(function() coroutine.yield() end) coroutine.resume(c) assert(debug.getinfo(c, 0, "
     "'Sl'))",
     NULL},
    {"assert(debug.getinfo(-1) == nil and debug.getinfo(2000000) == nil and debug.getinfo(print).source)", NULL},
    {"assert(os.getenv('GRAY_NOTHING') == nil and os.getenv('HOME') == nil)", NULL},
    {"assert(collectgarbage('incremental') == 'incremental' and collectgarbage('generational') == 'incremental')",
     NULL},
    {"assert(not pcall(setmetatable, {}, 5) and not pcall(setmetatable, 5, {}))", NULL},
    {"finalized = setmetatable({}, {__gc = function() pcall(gr.node, 'late') xpcall(error, print, 'late') end})", NULL},
};

static void put(const char *name, const char *text, size_t size) {
    test_write_file(test_path(name), text, size);
}

static void write_files(void) {
    write_white_png("pic1.png", 8, 8);
    put("flag.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\ng a\nf 1 2 3\n", 36);
    CHECK_EQ_INT(mkdir(test_path("meshes"), 0777), 0);
    put("meshes/pole.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 32);
    put("bad.lua", "x = = 1", 7);
    put("thrower.lua", "local x = nil; return x.y", 25);
    put("good.lua", "return 5", 8);
    put("plain.lua", "local a = 1", 11);
    put("hash.lua", "#!/usr/bin/gray\nx = 1", 21);
    put("hash_only.lua", "#", 1);
    put("empty.lua", "", 0);
    put("mark.lua", "\xEF\xBB\xBFx = 2", 8);
    put("wide.lua",
        "\xFF\xFEx\0=\0"
        "2\0",
        8);
    put("wide_plain.lua",
        "\0x\0=\0"
        "2",
        6);
}

static void check(const struct corner *corner, const struct script_options *options) {
    check_corner(preparation, corner, options);
}

TEST(rare_forms_of_scripts_run_or_are_reported) {
    write_files();
    for (size_t i = 0; i < sizeof corners / sizeof corners[0]; i++)
        check(&corners[i], NULL);
}

TEST(names_that_do_not_exist_are_ghosts_everywhere_under_lenient) {
    static const struct corner ghosts[] = {
        {"local g = gr.unknown() gr.union('u', ball, g) gr.union('u', g, ball) gr.union('u', g, g)", NULL},
        {"local g = gr.unknown() gr.difference('d', g, ball) gr.difference('d', ball, g) gr.inverse(g)", NULL},
        {"local g = gr.unknown() gr.clipped_by{object = g, by = ball} gr.clipped_by{object = ball, by = g}", NULL},
        {"local g = gr.unknown() gr.union{operands = {g, ball}} gr.union('u', ball, g, ball)", NULL},
        {"local g = gr.unknown() ball:set_texture(g) gr.image_material(glass, g) gr.sphere(g) gr.geometry('g', g)",
         NULL},
        {"local g = gr.unknown() gr.mesh{file = 'flag.obj', materials = {a = g}}", NULL},
        {"local g = gr.unknown() ball.scale(g, 1, 2, 3) g:scale(1, 2, 3) ball:add_child(g) ball:unknown(5):scale(1, 2, "
         "3)",
         NULL},
        {"local g = gr.unknown() g:bounds() ball.bounds(g) ball.faces(g) gr.other(ball) gr.other(g)", NULL},
        {"local g = gr.unknown() gr.render{node = g, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}}", NULL},
        {"local g = gr.unknown() gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, lights "
         "= "
         "{g, lamp}, background = g, fog = g}",
         NULL},
        {"local g = gr.unknown() gr.render(ball, 'x.png', 4, 4, {0, 0, 9}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {g})",
         NULL},
        {"local g = gr.unknown() gr.node{children = {g, ball}} tostring(g) gr.sky_light{sky = g}", NULL},
        {"gr.unknown.deep()", NULL},
    };
    const struct script_options lenient = {
        .transform_order = SCRIPT_ORDER_NEW, .library_folder = "lua", .lenient = true};
    write_files();
    for (size_t i = 0; i < sizeof ghosts / sizeof ghosts[0]; i++)
        check(&ghosts[i], &lenient);
}

TEST(values_of_defines_are_numbers_texts_tables_or_the_text_itself) {
    struct script_define defines[] = {{"a", "'x'"},     {"b", "'x\""},       {"c", "'a\\"},   {"d", "{function() end}"},
                                      {"e", "'a'+'b'"}, {"f", "'a' == 'a'"}, {"g", "{1, 2}"}, {"h", "{,}"},
                                      {"i", "7"},       {"j", "true"},       {"k", "nil"},    {"l", ""},
                                      {"m", "\"y\""},   {"n", "plain"},      {"o", "'a\\'"},  {"p", "'"}};
    const struct script_options options = {.transform_order = SCRIPT_ORDER_NEW,
                                           .library_folder = "lua",
                                           .defines = defines,
                                           .define_count = sizeof defines / sizeof defines[0]};
    static const struct corner all = {
        "assert(a == 'x' and b == [['x\"]] and d == '{function() end}' and e == [['a'+'b']] and f == [['a' == 'a']])\n"
        "assert(g[2] == 2 and h == '{,}' and i == 7 and j == true and k == nil and l == '' and m == 'y' and n == "
        "'plain')",
        NULL};
    check(&all, &options);
}

/* Without a library, with a missing one, with a broken module in it; without the sandbox. */
TEST(libraries_that_are_missing_or_broken_are_reported) {
    char folder[512], file[600];
    static const struct corner missing = {"require('meshes')", "is not a folder"},
                               broken = {"require('broken')", "broken.lua:1"},
                               plain = {"print('a') os.getenv('HOME')", NULL};
    (void)snprintf(folder, sizeof folder, "%s/library", test_folder());
    CHECK(mkdir(folder, 0777) == 0);
    (void)snprintf(file, sizeof file, "%s/broken.lua", folder);
    test_write_text(file, "x = = 1");
    write_files();
    struct script_options options = {.transform_order = SCRIPT_ORDER_NEW, .library_folder = ""};
    check(&missing, &options);
    options.library_folder = "/nothing/there";
    check(&missing, &options);
    options.library_folder = folder;
    check(&broken, &options);
    options.library_folder = NULL;
    struct error error;
    struct listener listener = {.renders = 0};
    (void)listen_to_text(&listener, "require('meshes')", &options, &error);
    options.no_sandbox = true;
    check(&plain, &options);
    options.transform_order = SCRIPT_ORDER_AUTO;
    options.library_folder = "/nothing/there";
    check(&plain, &options);
}

TEST(a_path_that_is_too_long_is_an_error) {
    struct listener listener = {.renders = 0};
    struct error error;
    char *path = malloc(6000);
    memset(path, 'a', 5990);
    strcpy(path + 5990, ".lua");
    CHECK(!listen_to(&listener, path, NULL, &error, NULL));
    CHECK(strstr(error.text, "the path is too long") != NULL);
    struct script_options automatic = {.transform_order = SCRIPT_ORDER_AUTO};
    CHECK(!listen_to(&listener, path, &automatic, &error, NULL));
    struct order_finding finding;
    path[5900] = '/';
    CHECK(order_detect(path, NULL, NULL, &finding, &error));
    free(path);
}

/* Every prefix of a text, in memory of exactly its size. */
TEST(the_transform_order_of_a_text_cut_anywhere_is_found) {
    static const char text[] =
        "-- a comment\n--[==[ long\n ]=] ]== ]==] \t\r\f\v local s = [[a]=]b]] .. 'it\\'s' .. \"two\\\n\" - 1 -[=x\n"
        "local m = gr.material({1}, {2}, 3) local n = x.gr y:gr() [==\n"
        "gr.mesh('a', {1}, {2}) gr.mesh(m, 'file.obj', 3) gr.mesh('b', 'c', m) gr.mesh('d', {(1)}, gr.mesh('e', {}, "
        "{}))\n"
        "gr.mesh('f', readobj('x')) x.readobj() gr.sphere(m) sphere(m) x(gr.cube(m)) q{a = 1} gr.node({name = 1}) "
        "(x({b = "
        "1})) y.z({c = 1}) gr.transform_order('new') loadfile('x') dofile 'y' require('a.b') require ''\n";
    for (size_t size = 0; size < sizeof text; size++) {
        struct order_finding finding;
        char *copy = malloc(size ? size : 1);
        memcpy(copy, text, size);
        order_of_text(copy, size, &finding);
        CHECK(finding.order == TRANSFORM_ORDER_NEW || finding.order == TRANSFORM_ORDER_OLD);
        free(copy);
    }
    char *many = malloc(70 * 40);
    size_t used = 0;
    for (int i = 0; i < 70; i++)
        used += (size_t)sprintf(many + used, "local m%d = gr.material(1)\n", i);
    struct order_finding finding;
    order_of_text(many, used, &finding);
    free(many);
}

TEST(files_that_a_script_names_are_looked_at_for_the_order_wherever_they_are) {
    char path[512], text[2048];
    struct order_finding finding;
    struct error error = {0};
    (void)snprintf(path, sizeof path, "%s/lua", test_folder());
    CHECK(mkdir(path, 0777) == 0);
    put("lua/inner.lua", "gr.transform_order('old')", 25);
    put("pictures.lua.d", "x", 1);
    (void)snprintf(path, sizeof path, "%s/neighbour.lua", test_folder());
    CHECK(mkdir(path, 0777) == 0); /* a folder with the name of a script */
    put("other.lua", "local a = gr.unknown", 20);
    put("seen.lua", "readobj 'x' gr.sphere()", 23);
    (void)snprintf(path, sizeof path, "%s/main.lua", test_folder());
    (void)snprintf(text, sizeof text,
                   "require 'a.b.lua' require 'other.lua' loadfile('%s/other.lua') dofile 'inner.lua' require '%0600d' "
                   "dofile('') dofile('lua/inner.lua')",
                   test_folder(), 7);
    test_write_text(path, text);
    CHECK(order_detect(path, "lua", NULL, &finding, &error));
    CHECK(order_detect(path, "/nothing/there", NULL, &finding, &error));
    CHECK(order_detect(path, NULL, NULL, &finding, &error));
#ifdef GRAY_FAULTS
    for (int kind = 0; kind < 2; kind++)
        for (uint64_t k = 1, over = 0; !over; k++) {
            uint64_t before = fault_count((enum fault_kind)kind);
            fault_at((enum fault_kind)kind, k);
            bool ok = order_detect(path, "lua", NULL, &finding, &error);
            fault_at((enum fault_kind)kind, 0);
            over = fault_count((enum fault_kind)kind) - before < k;
            /* a call that fails while the scene itself is read is an error that names it */
            CHECK(ok || error.kind == ERROR_MACHINE || (kind > 0 && strstr(error.text, "main.lua")));
        }
#endif
}

#ifdef GRAY_FAULTS
TEST(documents_survive_any_allocation_that_fails) {
    for (uint64_t k = 1, over = 0; !over; k++) {
        struct arena arena = {0};
        uint64_t before = fault_count(FAULT_OF_ALLOCATION);
        fault_at(FAULT_OF_ALLOCATION, k);
        struct document manual = {.arena = &arena}, page = {.arena = &arena, .is_roff = true};
        struct document annotations = {.arena = &arena};
        script_describe_function(&manual, NULL);
        script_describe_function(&page, NULL);
        script_annotations(&annotations);
        script_describe_field(&page, "radius");
        fault_at(FAULT_OF_ALLOCATION, 0);
        over = fault_count(FAULT_OF_ALLOCATION) - before < k;
        CHECK((manual.failed || page.failed || annotations.failed) == !over);
        arena_destroy(&arena);
    }
}
#endif
