/* What newcomers meet first: defaults of positional calls, and messages about common mistakes. */
#include "tests/harness.h"

#include "output/progress.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void says(const char *scene, const char *text) {
    struct test_result result = test_gray_scene(scene, "-q scene.lua", NULL);
    CHECK_EQ_INT(result.status, text ? 1 : 0);
    if (text && !strstr(result.err, text))
        test_fail(__FILE__, __LINE__, "%s says %s, not %s", scene, result.err, text);
    if (!text && result.err[0] != '\0')
        test_fail(__FILE__, __LINE__, "%s says %s", scene, result.err);
    test_free_result(&result);
}

#define RENDER(rest)                                                                                                   \
    "gr.render(gr.sphere(gr.material({.8, .1, .1})), 'x.png', 4, 4, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50" rest ")"

TEST(positional_calls_have_the_defaults_of_the_manual) {
    says(RENDER(""), NULL);
    says(RENDER(", {1, 1, 1}"), NULL);
    says("gr.material({1, 1, 1}, {0, 0, 0})", NULL);
    says("gr.material()", "gr.material: kd is missing");
}

TEST(nil_as_lights_is_no_default) {
    says(RENDER(", {1, 1, 1}, lamps"), "gr.render: lights is nil");
    says(RENDER(", ambience, {}"), "gr.render: ambient is nil");
}

TEST(an_unknown_field_lists_the_valid_ones) {
    says("gr.sphere{wobble = 1}",
         "gr.sphere: unknown field 'wobble'; the fields are name, material, thin_walled, medium, centre, radius");
    says("gr.sphere{raduis = 1}", "did you mean 'radius'?");
}

TEST(a_dot_for_a_colon_is_named) {
    says("local a, b = gr.node('a'), gr.node('b') a.add_child(b)",
         "node:add_child: node is missing; methods are called with a colon, as in n:add_child(...) (node 'b')");
}

TEST(a_cycle_is_reported_where_it_is_closed) {
    says("local a, b, c = gr.node('a'), gr.node('b'), gr.node('c')\na:add_child(b)\nb:add_child(c)\nc:add_child(a)",
         "scene.lua:4: node:add_child: 'c' is below 'a': the nodes would form a cycle (node 'c')");
    says("local a = gr.node('a') a:add_child(a)", "a node cannot be its own child");
}

TEST(a_colour_in_bytes_is_a_warning) {
    struct test_result result = test_gray_scene("gr.material({200, 50, 0}) gr.material({2, 2, 2})", "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK(strstr(result.err, "warning: gr.material: kd {200, 50, 0} looks like bytes"));
    test_free_result(&result);
}

static void notes(const char *scene, const char *text) {
    struct test_result result = test_gray_scene(scene, "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    if (!strstr(result.err, text))
        test_fail(__FILE__, __LINE__, "%s prints %s, not %s", scene, result.err, text);
    test_free_result(&result);
}

static void notes_not(const char *scene, const char *text) {
    struct test_result result = test_gray_scene(scene, "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    if (strstr(result.err, text))
        test_fail(__FILE__, __LINE__, "%s prints %s", scene, result.err);
    test_free_result(&result);
}

TEST(colours_in_bytes_of_lights_and_pictures_are_warnings_too) {
    notes("gr.material{kd = {1, 1, 1}, ks = {255, 255, 255}}", "gr.material: ks {255, 255, 255} looks like bytes");
    notes("gr.light({0, 9, 0}, {255, 240, 220})", "gr.light: colour {255, 240, 220} looks like bytes");
    notes("gr.directional_light{direction = {0, -1, 0}, colour = {200, 200, 200}}", "looks like bytes");
    notes(RENDER(", {40, 40, 40}"), "gr.render: ambient {40, 40, 40} looks like bytes");
    notes("gr.render{node = gr.sphere{material = gr.material{kd = {1, 1, 1}}}, file = 'x.png', width = 4, height = 4,"
          "eye = {0, 0, 5}, background = {30, 60, 120}}",
          "gr.render: background {30, 60, 120} looks like bytes");
    /* Lights that fade may be strong. */
    notes_not("gr.light{position = {0, 9, 0}, colour = {200, 200, 200}, falloff = {0, 0, 1}}"
              "gr.light{position = {0, 9, 0}, colour = {200, 200, 200}, intensity = 2}"
              "gr.spherical_light{position = {0, 9, 0}, radius = 1, emission = {100, 100, 100}}"
              "gr.directional_light{direction = {0, -1, 0}, colour = {20, 19, 18}}",
              "bytes");
}

TEST(a_warning_about_a_missing_material_names_the_line_of_the_node) {
    notes("local s = gr.node('scene')\nlocal b = gr.sphere('ball')\ns:add_child(b)\n"
          "gr.render(s, 'x.png', 4, 4, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50)",
          "node 'ball' has no material and is shown in plain gray (made at scene.lua:2)");
    notes("function ball()\nreturn gr.sphere{}\nend\n"
          "gr.render(ball(), 'x.png', 4, 4, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50)",
          "(made at scene.lua:2)");
}

TEST(a_picture_that_replaces_another_of_the_run_is_a_notice) {
    notes(RENDER("") " " RENDER(""),
          "gray: notice: x.png replaces a picture that this run wrote before under the same name");
    notes_not(RENDER(""), "replaces");
    notes_not(RENDER(""), "replaces"); /* that of an earlier run */
}

TEST(an_ending_that_is_not_written_is_an_error_before_the_run) {
    test_write_text(test_path("scene.lua"), "print('runs')");
    test_shell("$gray -o x.JPG scene.lua", 2, "gray: -o x.JPG: gray writes no .JPG files; a name ends in .png, ");
    test_shell("$gray -o x.JPG scene.lua 2>&1 | grep runs", 1, "");
    test_write_text(test_path("scene.lua"), RENDER(""));
    test_shell("rm -f x*; $gray -o x.JPG --force scene.lua && head -c 4 x.JPG", 0, "PNG");
    test_shell("$gray -o x scene.lua && head -c 4 x.png", 0, "gray: notice: 'x' has no ending of a picture");
    test_shell("$gray -q -o /dev/null scene.lua && $gray -q -o - scene.lua | head -c 4", 0, "PNG");
    says("gr.render(gr.sphere(gr.material({1, 1, 1})), 'x.jpg', 4, 4, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50)",
         "gr.render: x.jpg: the name of a picture ends in .png, ");
}

TEST(a_script_that_computes_long_says_so_on_a_terminal) {
    struct progress progress = {.mode = PROGRESS_BAR};
    char line[200] = "";
    CHECK(!progress_script_line(&progress, "a.lua", true, line, sizeof line));
    progress.script_since -= 2.5; /* it began earlier */
    CHECK(progress_script_line(&progress, "a.lua", true, line, sizeof line));
    CHECK(strstr(line, "a.lua is still running after 2"));
    CHECK(!progress_script_line(&progress, "a.lua", true, line, sizeof line));
    progress.script_since -= 2;
    CHECK(progress_script_line(&progress, "a.lua", true, line, sizeof line));
    CHECK(strstr(line, "after 4"));
    CHECK(!progress_script_line(&progress, "a.lua", false, line, sizeof line)); /* a picture is made */
    CHECK(!progress_script_line(&progress, "a.lua", true, line, sizeof line));
    struct progress in_file = {.mode = PROGRESS_LINES};
    (void)progress_script_line(&in_file, "a.lua", true, line, sizeof line);
    in_file.script_since -= 100;
    CHECK(!progress_script_line(&in_file, "a.lua", true, line, sizeof line));
}

TEST(a_script_without_a_picture_says_so) {
    struct test_result result = test_gray_scene("gr.sphere('ball')", "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK(strstr(result.err, "scene.lua: no picture was rendered, because the script did not call gr.render"));
    test_free_result(&result);
    says("gr.sphere('ball')", NULL); /* not with -q */
    result = test_gray_scene(RENDER(""), "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK(!strstr(result.err, "no picture"));
    test_free_result(&result);
}

static void check_corner(const char *scene, int r, int g, int b) {
    says(scene, NULL);
    struct test_picture picture = test_read_picture(test_path("x.png"));
    const uint8_t *p = picture.rgb;
    if (abs(p[0] - r) > 2 || abs(p[1] - g) > 2 || abs(p[2] - b) > 2)
        test_fail(__FILE__, __LINE__, "%s: the corner is %d %d %d", scene, p[0], p[1], p[2]);
    free(picture.rgb);
}

/* The corner of a picture of one row has a direction whose y is nearly 0. */
TEST(only_pictures_that_are_all_named_have_a_light_background) {
    const char *table = "gr.render{node = gr.node('n'), file = 'x.png', width = 9, height = 1, eye = {0, 0, 5}}";
    char both[400];
    check_corner(table, 204, 207, 209);
    check_corner("gr.render(gr.node('n'), 'x.png', 9, 1, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50)", 0, 0, 128);
    (void)snprintf(both, sizeof both, "if x then gr.render(1) end %s", table);
    check_corner(both, 0, 0, 128);
    (void)snprintf(both, sizeof both, "%s if x then gr.render{background = 1} end", table);
    check_corner(both, 0, 0, 128);
}

#define RED "red = gr.material({1, 0, 0})\n"

TEST(nil_for_a_material_names_the_variable_and_one_that_is_spelt_like_it) {
    says(RED "gr.sphere(redd)",
         "scene.lua:2: gr.sphere: material or name is missing; 'redd' is nil, did you mean 'red'?");
    says("local " RED "gr.nh_sphere(rad,\n {0, 0, 0}, 1)",
         "scene.lua:2: gr.nh_sphere: name or material is missing; 'rad'");
    says(RED "gr.sphere('b'):set_material(rad)",
         "scene.lua:2: node:set_material: material is missing; 'rad' is nil, did");
    says(RED "gr.sphere{material = rad}",
         "scene.lua:2: gr.sphere: material is missing; 'rad' is nil, did you mean 'red'?");
    says(RED "gr.sphere{\n material = zzzzz}", "gr.sphere: material is missing; 'zzzzz' is nil\n");
    says("ball = gr.sphere('b')\ngr.node('a'):add_child(bal)", "node is missing; 'bal' is nil, did you mean 'ball'?");
}

TEST(names_of_functions_on_the_same_line_are_no_hints) {
    says("local f = function(t) return t end; gr.sphere('s'):set_material(nil)", "material is missing (node 's')");
    says("gr.sphere('s'):set_material((function(t) return t end)(nil))", "material is missing (node 's')");
    says("local f = function(t) return qqq end; gr.sphere('s'):set_material(zzz)", "'zzz' is nil");
    says("local s = gr.sphere('s'); local function g(q) s:set_material(zzz) end\ng(1)", "'zzz' is nil");
    says("local s = gr.sphere('s'); for i, t in ipairs{1} do s:set_material(nil) end",
         "material is missing (node 's')");
}

TEST(a_material_that_may_be_nil_is_no_error) {
    says("local function ball(m) return gr.sphere{material = m} end ball() ball(nil)", NULL);
    says("opts = {} gr.sphere{material = opts.material}", NULL);
    says("gr.sphere{material = nil}", NULL);
    says("local _ENV = {gr = gr} gr.sphere{material = nothing}", NULL);
    says("gr.sphere()", "gr.sphere: material or name is missing\n");
}

TEST(errors_of_lua_suggest_names_and_name_the_sandbox) {
    says("os.execute('ls')", "(field 'execute'); the sandbox has no os.execute (docs/security.md)");
    says("io.popen('ls')", "the sandbox has no io.popen (docs/security.md)");
    says("local execute = os.execute\nlocal t = {}\nexecute('ls')", "(local 'execute'); the sandbox has no os.execute");
    says("local run = io.popen function list() return run('ls') end list()",
         "(upvalue 'run'); the sandbox has no io.popen");
    says("local t = {} local x = t.execute x()", "attempt to call a nil value (local 'x')\n");
    says("os.tiem()", "(field 'tiem'); did you mean 'os.time'?");
    says("local m = require 'lathe' m.trun()", "(field 'trun'); did you mean 'm.turn'?");
    says("pirnt(1)", "(global 'pirnt'); did you mean 'print'?");
    says("local t = {} t.x()", "attempt to call a nil value (field 'x')\n");
    struct test_result result = test_gray_scene("os.execute('ls', 1, x.y)", "--no-sandbox -q scene.lua", NULL);
    CHECK(!strstr(result.err, "the sandbox has no"));
    test_free_result(&result);
}
