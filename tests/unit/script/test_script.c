/* Complete scripts: the scenes of tests/scripts, the messages of tests/errors, old Lua, files and their names,
 * definitions, answers of a host, and failing allocations. */
#include "base/mem.h"
#include "base/version.h"
#include "image/png_write.h"
#include "tests/unit/script_host.h"

#include <dirent.h>
#include <sys/stat.h>
#include <time.h>

static void expect_done(struct listener *listener, const char *path, const struct script_options *options) {
    struct error error;
    char *traceback;
    if (!listen_to(listener, path, options, &error, &traceback))
        test_fail(__FILE__, __LINE__, "%s\n%s", error.text, traceback ? traceback : "");
    free(traceback);
}

static void expect_text_done(struct listener *listener, const char *text, const struct script_options *options) {
    struct error error;
    if (!listen_to_text(listener, text, options, &error))
        test_fail(__FILE__, __LINE__, "%s: %s", text, error.text);
}

static void expect_text_error(const char *text, const char *message) {
    struct listener listener = {.renders = 0};
    struct error error;
    if (listen_to_text(&listener, text, NULL, &error))
        test_fail(__FILE__, __LINE__, "%s is accepted", text);
    else if (!strstr(error.text, message))
        test_fail(__FILE__, __LINE__, "%s: \"%s\" does not say \"%s\"", text, error.text, message);
}

TEST(scripts_of_old_lua_run) {
    struct listener listener = {.renders = 0};
    expect_done(&listener, "tests/scripts/old_lua.lua", NULL);
    CHECK_EQ_INT(listener.messages, 0);
}

TEST(pairs_has_a_fixed_order_and_strangers_get_no_dangerous_functions) {
    struct listener listener = {.renders = 0};
    expect_done(&listener, "tests/scripts/traverse.lua", NULL);
}

TEST(a_hundred_functions_of_a_course_are_recorded_or_refused_with_the_reason) {
    struct listener listener = {.renders = 0};
    expect_done(&listener, "tests/scripts/functions.lua", NULL);
}

TEST(scripts_may_use_the_names_of_the_library_for_their_variables) {
    struct listener listener = {.renders = 0};
    expect_done(&listener, "tests/scripts/shadowed.lua", NULL);
    CHECK_EQ_INT(listener.renders, 1);
    CHECK_EQ_INT(listener.last.light_count, 1);
}

TEST(every_call_of_the_classic_dialect_runs) {
    struct listener listener = {.renders = 0};
    expect_done(&listener, "tests/scripts/classic.lua", NULL);
    CHECK_TEXT(listener.files, "classic2.png\nmethod.png\n");
    CHECK_EQ_INT(listener.messages, 2);
    CHECK(strstr(listener.said, "classic.lua:36: 'classic2.0.png' is read as 'classic2.png'"));
    CHECK(strstr(listener.said, "classic.lua:36: warning: gr.render: arguments after lights are ignored"));
}

TEST(render_request_holds_what_the_script_said) {
    struct listener listener = {.renders = 0};
    expect_text_done(
        &listener,
        "gr.render{node = gr.node('n'), file = 'a/b.png', width = 20, height = 10.0, eye = {1, 2, 3},\n"
        "target = {4, 5, 6}, up = {0, 0, 1}, fov = 30, ambient = {.1, .2, .3}, background = {1, 2, 3},\n"
        "samples = 5, full = true, area_samples = 7, reflect_limit = 8, refract_limit = 9, seed = 11,\n"
        "side_tolerance = 0.25, corner_tolerance = 0.5, use_tir = true, specular = 'blinn', accel = 'none',\n"
        "lights = {gr.area_light({0, 0, 0}, {2, 0, 0}, {0, 4, 0}, {9, 8, -7}, {1, 2, 3})}}",
        NULL);
    const struct render_request *r = &listener.last;
    CHECK_EQ_INT(r->width, 20);
    CHECK_EQ_INT(r->height, 10);
    CHECK(r->camera.eye.z == 3 && r->camera.view.x == 4 && r->camera.up.z == 1 && r->camera.fov == 30);
    CHECK(r->ambient.g == 0.2 && r->sky.kind == SKY_CONSTANT && r->sky.colour.b == 3);
    const struct settings *s = &r->settings;
    CHECK(s->samples == 5 && s->full && s->area_samples == 7 && s->reflect_limit == 8 && s->refract_limit == 9);
    CHECK(s->seed == 11 && s->side_tolerance == 0.25 && s->corner_tolerance == 0.5 && s->use_tir);
    CHECK(s->specular == SPECULAR_BLINN && s->accel == ACCEL_NONE && s->view_is_target);
    CHECK_EQ_INT(r->light_count, 1);
}

TEST(settings_that_a_script_leaves_out_come_from_the_command_line) {
    struct listener listener = {.renders = 0};
    expect_text_done(
        &listener, "gr.render(gr.node('n'), 'x.png', 8, 8, {0, 0, 9}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})", NULL);
    struct settings standard = settings_default();
    CHECK_EQ_INT(listener.last.settings.samples, standard.samples);
    CHECK(listener.last.sky.kind == SKY_GRADIENT && !listener.last.settings.view_is_target);
}

TEST(lenient_scripts_show_what_can_be_shown) {
    struct listener listener = {.renders = 0};
    struct script_options options = {.transform_order = SCRIPT_ORDER_NEW, .lenient = true};
    expect_done(&listener, "tests/scripts/lenient.lua", &options);
    CHECK_EQ_INT(listener.renders, 1);
    CHECK_EQ_INT(listener.last.light_count, 1);
    CHECK_TEXT(listener.said,
               "tests/scripts/lenient.lua:3: warning: gr.klein_bottle does not exist and is ignored\n"
               "tests/scripts/lenient.lua:7: warning: gr.fog does not exist and is ignored\n"
               "tests/scripts/lenient.lua:10: warning: node:wobble does not exist and is ignored (node 'root')\n"
               "tests/scripts/lenient.lua:11: warning: gr.shiny_material does not exist and is ignored\n"
               "tests/scripts/lenient.lua:14: warning: node:set_material: a plain node has no material (node 'root')\n"
               "tests/scripts/lenient.lua:18: warning: gr.moon_light does not exist and is ignored\n");
}

TEST(a_factor_of_zero_is_a_warning) {
    struct listener listener = {.renders = 0};
    expect_text_done(&listener, "local n = gr.node('n') n:scale(1, 0, 1) n:scale(0, 1, 1)", NULL);
    CHECK_EQ_INT(listener.messages, 1);
    CHECK(strstr(listener.said, "scene.lua:1: warning: node:scale: a factor is 0"));
}

TEST(an_area_light_without_area_is_a_warning) {
    struct listener listener = {.renders = 0};
    expect_text_done(&listener, "gr.area_light({0, 5, 0}, {1, 0, 0}, {-2, 0, 0}, {1, 1, 1}, {1, 0, 0})", NULL);
    CHECK_EQ_INT(listener.messages, 1);
    CHECK(strstr(listener.said, "scene.lua:1: warning: gr.area_light: v1 and v2 are parallel or zero"));
    listener = (struct listener){.renders = 0};
    expect_text_done(&listener, "gr.area_light({0, 5, 0}, {1, 0, 0}, {-2, 0, 1e-6}, {1, 1, 1}, {1, 0, 0})", NULL);
    CHECK_EQ_INT(listener.messages, 0);
}

TEST(numbers_in_file_names_are_repaired_only_where_they_end) {
    struct listener listener = {.renders = 0};
    expect_text_done(&listener,
                     "for _, name in ipairs{'a1.0.png', 'b2.05.png', 'c3.0', 'd4.0_5.0.png', '.0.png'} do\n"
                     "gr.render(gr.node('n'), name, 8, 8, {0, 0, 9}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {}) end",
                     NULL);
    CHECK_TEXT(listener.files, "a1.png\nb2.05.png\nc3\nd4_5.png\n.0.png\n");
    CHECK_EQ_INT(listener.messages, 1);
}

TEST(definitions_are_lua_literals_or_strings) {
    const struct script_define defines[] = {
        {"a", "12"},        {"b", "-1.5e3"}, {"c", "'quoted'"},          {"d", "true"},
        {"e", "nil"},       {"f", "word"},   {"g", "{1, 'x', y = {2}}"}, {"h", "2024-01-05"},
        {"i", "os.exit()"}, {"j", ""},       {"k", "{print}"},           {"l", "'a' .. 'b'"},
        {"m", "{"},         {"n", "0x10"}};
    struct script_options options = {
        .transform_order = SCRIPT_ORDER_NEW, .defines = defines, .define_count = sizeof defines / sizeof defines[0]};
    struct listener listener = {.renders = 0};
    expect_text_done(&listener,
                     "assert(a == 12 and math.type(a) == 'integer' and b == -1500 and c == 'quoted' and d == true)\n"
                     "assert(e == nil and f == 'word' and g[2] == 'x' and g.y[1] == 2)\n"
                     "assert(h == '2024-01-05' and i == 'os.exit()' and j == '' and #k == 0 and m == '{' and n == 16)\n"
                     "assert(l == 'ab')",
                     &options);
}

TEST(random_numbers_depend_only_on_the_seed) {
    const char *text =
        "local n = gr.node('n') local x = math.random() math.randomseed() assert(math.random() == x)\n"
        "math.randomseed(7) assert(math.random() ~= x) n:translate(x, 0, 0) local r = gr.node('r')\n"
        "r:add_child(n) gr.render(r, 'x.png', 8, 8, {0, 0, 9}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})";
    double x[3];
    for (int k = 0; k < 3; k++) {
        struct script_options options = {.transform_order = SCRIPT_ORDER_NEW, .seed = k == 2 ? 5 : 0};
        struct listener listener = {.renders = 0};
        expect_text_done(&listener, text, &options);
        x[k] = listener.first_child[0].m[0][3];
    }
    CHECK(x[0] == x[1] && x[0] != x[2]);
}

TEST(each_render_takes_the_current_tree) {
    struct listener listener = {.renders = 0};
    expect_text_done(&listener,
                     "local r, n = gr.node('r'), gr.node('n') r:add_child(n)\n"
                     "for i = 1, 5 do n:translate(1, 0, 0)\n"
                     "gr.render(r, 'x' .. i .. '.png', 8, 8, {0, 0, 9}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {}) end",
                     NULL);
    CHECK_EQ_INT(listener.renders, 5);
    for (int k = 0; k < 5; k++)
        CHECK(listener.first_child[k].m[0][3] == k + 1);
}

TEST(equal_tables_and_files_are_one_mesh) {
    struct listener listener = {.renders = 0};
    struct assets assets = {0};
    struct script_host host = {.context = &listener,
                               .assets = &assets,
                               .settings = settings_default(),
                               .render = listener_render,
                               .message = listener_message};
    struct script_options options = {.transform_order = SCRIPT_ORDER_NEW};
    struct arena arena = {0};
    struct error error;
    const char *traceback;
    const char *path = test_path("scene.lua");
    test_write_text(path, "for i = 1, 3 do gr.mesh('t' .. i, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}) end\n");
    CHECK(script_run(path, &options, &host, &arena, &traceback, &error));
    CHECK_EQ_INT(assets.mesh_count, 1);
    CHECK(script_run("tests/scripts/classic.lua", &(struct script_options){.library_folder = "lua"}, &host, &arena,
                     &traceback, &error));
    CHECK_EQ_INT(assets.mesh_count, 3); /* the table again, the file, the file through readobj */
    arena_destroy(&arena);
    assets_destroy(&assets);
}

TEST(primitives_and_geometry_nodes_share_shape_and_material) {
    struct listener listener = {.renders = 0};
    expect_text_done(&listener,
                     "local m = gr.material({1, 1, 1}, {0, 0, 0}, 1)\n"
                     "local p = gr.sphere(m) p:translate(1, 0, 0)\n"
                     "local g = gr.geometry('g', p) g:scale(2, 2, 2)\n"
                     "local r = gr.node('r') r:add_child(g) assert(tostring(g) == \"node 'g'\")\n"
                     "gr.render(r, 'x.png', 8, 8, {0, 0, 9}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})",
                     NULL);
    CHECK(listener.first_child[0].m[0][3] == 2 && listener.first_child[0].m[0][0] == 2);
}

TEST(an_error_of_the_host_names_the_line_of_the_call) {
#define CALL "gr.render(gr.node('n'), 'x.png', 8, 8, {0, 0, 9}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})\n"
    struct listener listener = {.renders = 0};
    struct error error;
    error_set(&listener.answer, ERROR_SCENE, "the nodes form a cycle");
    CHECK(!listen_to_text(&listener, "\n" CALL, NULL, &error));
    CHECK(strstr(error.text, "scene.lua:2: gr.render: the nodes form a cycle"));
    CHECK(listen_to_text(&listener,
                         "local ok, why = pcall(function() " CALL " end) assert(not ok)\n"
                         "assert(why:match('scene.lua:1: gr.render: the nodes form a cycle'))",
                         NULL, &error));
}

TEST(failures_of_the_machine_cannot_be_caught) {
    static const char *const texts[] = {
        "while true do pcall(function() " CALL " end) end",
        "while true do xpcall(function() " CALL " end, function() return 'caught' end) end",
        "while true do coroutine.resume(coroutine.create(function() " CALL " end)) end",
        "while true do pcall(coroutine.wrap(function() pcall(function() " CALL " end) end)) end",
        "while true do load(function() " CALL " end) end",
        "while true do local t = setmetatable({}, {__close = function() error('other') end})\n"
        "pcall(function() local x <close> = t " CALL " end) end",
    };
    for (size_t k = 0; k < sizeof texts / sizeof texts[0]; k++) {
        struct listener listener = {.renders = 0};
        struct error error;
        error_set(&listener.answer, ERROR_MACHINE, "the disk is full");
        CHECK(!listen_to_text(&listener, texts[k], NULL, &error));
        CHECK_EQ_INT(error.kind, ERROR_MACHINE);
        CHECK_TEXT(error.text, "the disk is full");
        CHECK_EQ_INT(listener.renders, 1);
    }
}

TEST(a_script_that_runs_forever_can_be_cancelled) {
    static const char *const texts[] = {"while true do end",
                                        "while true do pcall(function() while true do end end) end",
                                        "while true do coroutine.wrap(function() while true do end end)() end"};
    for (size_t k = 0; k < sizeof texts / sizeof texts[0]; k++) {
        struct listener listener = {.cancel_at = 3};
        struct error error;
        CHECK(!listen_to_text(&listener, texts[k], NULL, &error));
        CHECK_EQ_INT(error.kind, ERROR_CANCELLED);
        CHECK_EQ_INT(listener.polls, 3);
    }
}

TEST(os_exit_ends_the_script_and_all_is_well) {
    struct listener listener = {.renders = 0};
    expect_text_done(&listener, CALL "pcall(os.exit) error('not reached')", NULL);
    expect_text_done(&listener, "pcall(os.exit, true) error('not reached')", NULL);
    expect_text_done(&listener, "coroutine.wrap(function() os.exit(0) end)() error('not reached')", NULL);
    CHECK_EQ_INT(listener.renders, 1);
    expect_text_error("os.exit(false)", "scene.lua:1: os.exit: the script reports a failure");
}

TEST(protected_calls_work_as_in_plain_lua) {
    struct listener listener = {.renders = 0};
    expect_text_done(
        &listener,
        "local function same(...) return ... end\n"
        "assert(select('#', pcall(same, 1, nil, 3, nil)) == 5)\n"
        "local ok, e = pcall(error, {code = 7}) assert(not ok and e.code == 7)\n"
        "local ok, a, b = xpcall(same, print, 1, 2) assert(ok and a == 1 and b == 2)\n"
        "local ok, e = xpcall(error, function(m) return m .. '!' end, 'x', 0) assert(not ok and e == 'x!')\n"
        "local co = coroutine.wrap(function() local ok, v = pcall(function() return coroutine.yield(1) + 1 end)\n"
        "  assert(ok and v == 6) return select(2, xpcall(coroutine.yield, print, 2)) end)\n"
        "assert(co() == 1 and co(5) == 2 and co('end') == 'end')\n"
        "assert(select('#', load('return ...')(1, 2)) == 2 and load('x x') == nil)\n"
        "assert(load('return y', 'name', 'bt', {y = 3})() == 3)\n"
        "assert(not pcall(pcall) and not pcall(xpcall, print))",
        NULL);
}

TEST(long_paths_are_traced_in_full) {
    char folder[600], path[1200], text[100] = "\nlocal t\nt.x = 1\n";
    struct listener listener = {.renders = 0};
    struct error error;
    (void)snprintf(folder, sizeof folder, "%s/a_folder_with_a_very_long_name_that_lua_would_shorten_in_messages",
                   test_folder());
    CHECK(mkdir(folder, 0777) == 0);
    (void)snprintf(path, sizeof path, "%s/scene.lua", folder);
    for (int k = 0; k < 2; k++) {
        char expected[1400];
        test_write_text(path, text);
        CHECK(!listen_to(&listener, path, NULL, &error, NULL));
        (void)snprintf(expected, sizeof expected, "%s:3: %s", path,
                       k == 0 ? "attempt to index a nil value (local 't')"
                              : "unexpected symbol near '='; = gives a value, == compares two");
        CHECK_TEXT(error.text, expected);
        strcpy(text, "\n\nlocal x = = 1\n");
    }
}

TEST(a_scene_that_cannot_be_read_is_an_error_without_traceback) {
    struct listener listener = {.renders = 0};
    struct error error;
    char *traceback;
    CHECK(!listen_to(&listener, "nowhere.lua", NULL, &error, &traceback));
    CHECK_EQ_INT(error.kind, ERROR_SCENE);
    CHECK(strncmp(error.text, "nowhere.lua: ", 13) == 0 && !strstr(error.text + 13, "nowhere.lua"));
    CHECK(traceback == NULL);
}

TEST(tracebacks_are_indented_and_lead_through_required_files) {
    struct listener listener = {.renders = 0};
    struct error error;
    char *traceback;
    CHECK(!listen_to(&listener, "tests/errors/in_required_file.lua", NULL, &error, &traceback));
    CHECK(traceback && strstr(traceback, "  stack traceback:\n"));
    CHECK(traceback && strstr(traceback, "tests/errors/lib/raises.lua:2: in ") &&
          strstr(traceback, "tests/errors/in_required_file.lua:2: in "));
    for (const char *line = traceback; line && *line;) {
        CHECK(strncmp(line, "  ", 2) == 0);
        line += strcspn(line, "\n");
        line += *line == '\n';
    }
    free(traceback);
}

/* The value of "-- key: value" in a text, cut out of it; NULL when there is none. */
static char *header(const char *text, const char *key) {
    char start[64];
    (void)snprintf(start, sizeof start, "-- %s: ", key);
    const char *found = strstr(text, start);
    if (!found)
        return NULL;
    found += strlen(start);
    size_t length = strcspn(found, "\n");
    char *value = calloc(1, length + 1);
    if (value)
        memcpy(value, found, length);
    return value;
}

/* tests/errors: `-- expect: FIRST LINE` with SCRIPT for the name of the file, optionally `-- status: N` (default 1) and
 * `-- arguments: ...`. */
static void check_error_script(const char *name) {
    char path[512], arguments[512], expected[2048] = "";
    (void)snprintf(path, sizeof path, "tests/errors/%s", name);
    char *text = test_read_file(path, NULL);
    char *wanted = text ? header(text, "expect") : NULL, *status = text ? header(text, "status") : NULL;
    char *more = text ? header(text, "arguments") : NULL;
    if (!wanted) {
        test_fail(__FILE__, __LINE__, "%s has no line `-- expect: ...`", path);
        return;
    }
    const char *script = strstr(wanted, "SCRIPT");
    (void)snprintf(expected, sizeof expected, "%.*s%s%s", script ? (int)(script - wanted) : (int)strlen(wanted), wanted,
                   script ? name : "", script ? script + 6 : "");
    (void)snprintf(arguments, sizeof arguments, "--transform-order new %s %s", more ? more : "", name);
    struct test_result result = test_gray("tests/errors", arguments);
    char *line = result.err, *end = line + strcspn(line, "\n");
    while (*end && strstr(line, ": warning: ") && strstr(line, ": warning: ") < end) { /* warnings may come before */
        line = end + 1;
        end = line + strcspn(line, "\n");
    }
    *end = '\0';
    if (strcmp(line, expected) != 0)
        test_fail(__FILE__, __LINE__, "%s says \"%s\", not \"%s\"", name, line, expected);
    int wanted_status = status ? atoi(status) : 1;
    if (result.status != wanted_status)
        test_fail(__FILE__, __LINE__, "%s ends with %d, not %d", name, result.status, wanted_status);
    test_free_result(&result);
    free(text);
    free(wanted);
    free(status);
    free(more);
}

TEST(every_script_of_tests_errors_says_what_it_should) {
    DIR *folder = opendir("tests/errors");
    CHECK(folder != NULL);
    int count = 0;
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;) {
        size_t length = strlen(entry->d_name);
        if (length < 5 || strcmp(entry->d_name + length - 4, ".lua") != 0)
            continue;
        check_error_script(entry->d_name);
        count++;
    }
    if (folder)
        closedir(folder);
    CHECK(count > 80);
}

/* Work that grew with the square of these numbers would take longer than a test may. */

TEST_TIMES(making_nodes_is_not_quadratic, 4) {
    struct listener listener = {.renders = 0};
    char text[256];
    (void)snprintf(text, sizeof text,
                   "local r, s = gr.node('r'), gr.sphere('s')\n"
                   "for i = 1, %d do local n = gr.node('n') n:scale(1, 2, 3) n:translate(i, 0, 0)\n"
                   "n:add_child(s) r:add_child(n) end",
                   250000 * times);
    expect_text_done(&listener, text, NULL);
}

TEST(a_million_vertices_are_read) {
    struct listener listener = {.renders = 0};
    expect_text_done(&listener,
                     "local verts = {} for i = 1, 1000000 do verts[i] = {i, 2 * i, 0.5 * i} end\n"
                     "gr.mesh('points', verts, {})",
                     NULL);
}

TEST_TIMES(pairs_of_a_large_table_is_not_quadratic, 5) {
    struct listener listener = {.renders = 0};
    char text[256];
    (void)snprintf(text, sizeof text,
                   "local t, n, last = {}, 0, %d for i = 1, last do t['k' .. i] = i end\n"
                   "for k, v in pairs(t) do n = n + v end assert(n == last * (last + 1) // 2)",
                   200000 * times);
    expect_text_done(&listener, text, NULL);
}

static void white_row(void *context, uint32_t y, uint8_t *line) {
    (void)context;
    (void)y;
    memset(line, 255, 3 * 8);
}

/* A copy of the scene that uses every feature, in the folder of the files it needs. */
static void prepare_everything(char path[512]) {
    const char *folder = test_folder();
    static const char *const names[][2] = {{"tests/scripts/everything.lua", "everything.lua"},
                                           {"tests/scripts/flag.obj", "flag.obj"},
                                           {"tests/scripts/parts/colours.lua", "parts/colours.lua"}};
    struct error error = {0};
    (void)snprintf(path, 512, "%s/parts", folder);
    CHECK(mkdir(path, 0777) == 0);
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        char *text = test_read_file(names[k][0], NULL);
        (void)snprintf(path, 512, "%s/%s", folder, names[k][1]);
        test_write_text(path, text ? text : "");
        free(text);
    }
    (void)snprintf(path, 512, "%s/cross.png", folder);
    CHECK(
        png_write_from(FILE_AT(path), &(struct png_source){.width = 8, .height = 6, .bytes = white_row}, NULL, &error));
    (void)snprintf(path, 512, "%s/everything.lua", folder);
}

TEST(a_scene_that_uses_every_function_runs) {
    char path[512];
    struct listener listener = {.renders = 0};
    prepare_everything(path);
    expect_done(&listener, path, NULL);
    CHECK_TEXT(listener.files, "everything.png\neverything2.png\nnamed.png\n");
}

/* Lua survives most of its own failures by an emergency collection, so the script may also succeed. */
/* Fails the allocations first, first + 3, ...; all of them in one test are beyond the time of a test. */
static void fail_allocations(uint64_t first) {
    char path[512];
    struct listener listener = {.renders = 0};
    struct error error;
    prepare_everything(path);
    uint64_t before = mem_allocations();
    expect_done(&listener, path, NULL);
    uint64_t count = mem_allocations() - before;
    if (count == 0)
        test_skip("allocations fail on demand only in builds with GRAY_FAULTS");
    int failed = 0;
    /* A part of them with a sanitizer, which takes minutes; the debug build of make test-long has the others. */
    uint64_t step = test_has_sanitizer() ? 93 : 3;
    for (uint64_t k = first; k <= count; k += step) {
        listener = (struct listener){.renders = 0};
        mem_fail_at(k);
        bool done = listen_to(&listener, path, NULL, &error, NULL);
        mem_fail_at(0);
        if (!done && error.kind != ERROR_MACHINE)
            test_fail(__FILE__, __LINE__, "allocation %llu: kind %d: %s", (unsigned long long)k, (int)error.kind,
                      error.text);
        failed += !done;
    }
    CHECK((uint64_t)failed > 60 / step);
}

TEST(any_allocation_may_fail_while_every_function_is_used) {
    fail_allocations(1);
}

TEST(any_second_allocation_of_three_may_fail_while_every_function_is_used) {
    fail_allocations(2);
}

TEST(any_third_allocation_of_three_may_fail_while_every_function_is_used) {
    fail_allocations(3);
}
