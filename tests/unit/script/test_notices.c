/* Notices about what has no effect and about pictures of nothing, and hints for errors of Lua; and that right scripts
 * get none. */
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BALL                                                                                                           \
    "local red = gr.material({.8, .2, .1}, {.4, .4, .4}, 30) local s = gr.node('s') s:add_child(gr.sphere(red))\n"
#define PICTURE                                                                                                        \
    "gr.render{node = s, file = 'x.png', width = 8, height = 6, eye = {0, 0, 8}, fov = 40, "                           \
    "lights = {gr.light({3, 5, 8}, {.9, .9, .9})}"

/* The run prints these texts, separated by '|'; NULL: nothing. */
static void prints(const char *options, const char *scene, const char *texts) {
    char arguments[256];
    (void)snprintf(arguments, sizeof arguments, "%s scene.lua", options);
    struct test_result result = test_gray_scene(scene, arguments, NULL);
    if (!texts && result.err[0] != '\0')
        test_fail(__FILE__, __LINE__, "%s: %s prints %s", options, scene, result.err);
    for (const char *at = texts; at && *at;) {
        char text[256];
        size_t length = strcspn(at, "|");
        (void)snprintf(text, sizeof text, "%.*s", (int)length, at);
        if (!strstr(result.err, text))
            test_fail(__FILE__, __LINE__, "%s: %s prints %s, not %s", options, scene, result.err, text);
        at += length + (at[length] == '|');
    }
    test_free_result(&result);
}

TEST(an_option_without_effect_has_one_notice) {
    const char *ball = BALL PICTURE "}";
    prints("--spp 256", ball, "scene.lua:2: gr.render: --spp has no effect: it is for integrator path");
    prints("--denoise", ball, "--denoise has no effect");
    prints("--max-depth 3", ball, "--max-depth has no effect");
    prints("--integrator path --spp 1 -ss 4", ball, "-ss has no effect: it is for integrators whitted and radiosity");
    prints("--tone filmic -o x.pfm", ball, "--tone has no effect: it is for PNG files");
    prints("--deep --dither ordered", ball, "--dither has no effect: it is for PNG files of 8 bits");
    prints("--toon-steps 5", ball, "--toon-steps has no effect: it is for style toon");
    prints("--fps 24", ball, "--fps has no effect: it is for animations");
    prints("--caustics 1000", ball, "caustics have no effect");
    prints("-ss 2 -reflect-limit 3 --tone filmic", ball, NULL);
    prints("--denoise=none --style none --caustics 0", ball, NULL);
    prints("--frames 2 --fps 24 -o x%d.png", BALL PICTURE ", seed = gr.frame}", NULL);
    struct test_result result = test_gray_scene(BALL "for i = 1, 2 do\n" PICTURE "} end", "--spp 256 scene.lua", NULL);
    const char *first = strstr(result.err, "--spp");
    CHECK(first && !strstr(first + 1, "--spp"));
    test_free_result(&result);
}

TEST(a_file_that_hides_a_module_of_the_library_has_one_notice) {
    test_write_text(test_path("easing.lua"), "return 'mine'\n");
    const char *scene = "assert(require 'easing' == 'mine')\nassert(require 'easing' == 'mine')\nrequire 'colour'\n";
    struct test_result result = test_gray_scene(scene, "scene.lua", NULL);
    const char *notice = "scene.lua:1: 'easing' is easing.lua, which hides the module of the library with this name\n";
    const char *found = strstr(result.err, notice);
    CHECK_EQ_INT(result.status, 0);
    CHECK(found && !strstr(found + strlen(notice), "hides"));
    test_free_result(&result);
}

#define PANE(fields)                                                                                                   \
    "local glass = gr.material{kd = {0, 0, 0}, ks = {1, 1, 1}, refract = 1, ior = 1.5} local s = gr.node('s')\n"       \
    "s:add_child(gr.instances{of = gr.square{name = 'pane', material = glass" fields                                   \
    "}, at = {{0, 0, 0}, {0, 1, 0}}})\n"
TEST(an_open_transparent_surface_has_one_notice_for_its_node_unless_the_node_decides) {
    prints(
        "--integrator path --spp 1", PANE("") PICTURE "}",
        "gr.render: 'pane' is transparent and open, so it is a thin wall, which does not refract (thin_walled = true "
        "says so, thin_walled = false refracts)");
    prints("--caustics 100", PANE("") PICTURE "}", "'pane' is transparent and open");
    prints("", PANE("") PICTURE "}", NULL);
    prints("--integrator path --spp 1", PANE(", thin_walled = true") PICTURE "}", NULL);
    prints("--integrator path --spp 1", PANE(", thin_walled = false") PICTURE "}", NULL);
    struct test_result result =
        test_gray_scene(PANE("") "for i = 1, 2 do\n" PICTURE "} end", "--integrator path --spp 1 scene.lua", NULL);
    const char *first = strstr(result.err, "'pane'");
    CHECK(first && !strstr(first + 1, "'pane'"));
    test_free_result(&result);
}

#define WAX(fields)                                                                                                    \
    "local s = gr.node('s') s:add_child(gr.sphere(gr.openpbr_material{subsurface_weight = 1" fields "}))\n"
TEST(light_under_a_surface_has_a_notice_of_whitteds_integrator_alone) {
    prints("", WAX("") PICTURE "}", "shown as diffuse light of subsurface_color; --integrator path follows it");
    prints("", WAX(", subsurface_radius = 0") PICTURE "}", NULL);
    prints("--integrator path --spp 1", WAX("") PICTURE "}", NULL);
}

TEST(a_field_without_effect_has_one_notice_for_its_line) {
    prints("", BALL PICTURE ", spp = 4}", "scene.lua:2: gr.render: spp has no effect: it is for integrator path");
    prints("", BALL PICTURE ", blades = 5}", "blades has no effect without aperture");
    prints("",
           "gr.render{node = gr.sphere(gr.material({.8, .2, .1})), file = 'x.png', width = 8, height = 6, lights = "
           "{gr.light({3, 5, 8}, {.9, "
           ".9, .9})}}",
           NULL); /* what a fitted camera sets is not given */
    prints("", BALL PICTURE ", view_height = 5}", "view_height has no effect without projection = 'orthographic'");
    prints("--integrator whitted", BALL PICTURE ", integrator = 'path', spp = 4}", "replaces the field integrator");
    prints("", BALL "s:add_child(gr.cube(gr.material{kd = {1, 0, 0}, ior = 1.5}))" PICTURE "}",
           "ior has no effect in a material without refract");
    prints("", BALL PICTURE ", spp = 4, integrator = 'path'}", NULL);
}

TEST(an_animation_of_one_frame_or_of_equal_frames_has_a_notice) {
    prints("-o x.gif", BALL PICTURE "}", "x.gif has one frame");
    prints("--frames 3 -o x.gif", BALL PICTURE "}", "all 3 frames are equal|gr.time");
    prints("--frames 3 -o x.gif", BALL "s:translate(gr.frame / 9, 0, 0)" PICTURE "}", NULL);
    prints("--turntable 3 -o x.gif", BALL "s:add_child(gr.cube(red))" PICTURE "}", NULL);
}

TEST(a_picture_of_nothing_has_a_notice) {
    prints("", BALL "s:translate(0, 500, 0)" PICTURE "}",
           "scene.lua:2: gr.render: nothing is in view|outside of the picture");
    prints("", BALL "s:translate(0, 0, 50)" PICTURE "}", "behind the eye");
    prints("", BALL "s:scale(1e-4, 1e-4, 1e-4)" PICTURE "}", "smaller than a pixel");
    prints("", "local s = gr.node('s')" PICTURE "}", "the node has no shapes");
    prints("", BALL PICTURE ", target = {0, 0, 99}}", "behind the eye");
    prints("", BALL PICTURE ", projection = 'orthographic', shift_x = 30}", "outside of the picture");
    prints("", BALL "gr.render{node = s, file = 'x.png', width = 8, height = 6, eye = {0, 0, 8}, lights = {}}",
           "there is no light");
    prints("--integrator path --spp 1",
           BALL "gr.render{node = s, file = 'x.png', width = 8, height = 6, eye = {0, 0, 8}, background = {0, 0, 0}}",
           "there is no light");
    prints("", BALL "gr.sun_light{colour = {1, 1, 1}, hour = 2}" PICTURE "}", "below the horizon");
    prints("", BALL PICTURE ", eye_to = {0, 0, 0}}", NULL);
}

TEST(an_eye_or_a_light_inside_an_opaque_solid_has_a_notice) {
    prints("", BALL "s:translate(0, 0, 8)" PICTURE "}", "the eye is inside 'sphere', an opaque solid");
    prints("", BALL "s:translate(3, 5, 8)" PICTURE ", target = {3, 5, 8}}",
           "the light at {3, 5, 8} is inside 'sphere', an opaque solid");
    prints("",
           BALL "s:add_child(gr.box(gr.material{kd = {.7, .7, .7}, two_sided = true}, {-9, -9, -9}, {9, 9, 9}))" PICTURE
                "}",
           NULL);
    prints("",
           BALL "s:add_child(gr.nh_sphere(gr.rr_material({0, 0, 0}, {1, 1, 1}, 9, 1, 1, 1.3), {0, 0, 8}, 3))" PICTURE
                "}",
           NULL);
    prints("--integrator path --spp 2",
           BALL "s:add_child(gr.cube(gr.material{kd = {0, 0, 0}, emission = {5, 5, 5}}))"
                "gr.render{node = s, file = 'x.png', width = 8, height = 6, eye = {0, 0, 8}, background = {0, 0, 0}}",
           NULL);
}

TEST(empty_solids_and_children_added_twice_have_a_notice) {
    prints("",
           BALL "s:add_child(gr.intersection(gr.sphere(red), gr.sphere{material = red, centre = {5, 0, 0}}))" PICTURE
                "}",
           "is empty|(made at scene.lua:2)");
    prints("", BALL "local b = gr.cube(red) s:add_child(b)\ns:add_child(b)" PICTURE "}",
           "scene.lua:3: warning: node:add_child: 'cube' is a child of 's' already");
    prints("",
           BALL "local b = gr.cube(red) s:add_child(b) s:add_child(gr.node{name = 'n', children = {b}})" PICTURE "}",
           NULL);
}

TEST(radians_for_degrees_have_a_warning) {
    prints("", BALL "s:rotate('y', math.pi / 2)" PICTURE "}",
           "scene.lua:2: warning: node:rotate: angle 1.5708 is 0.5 pi");
    prints("", BALL "s:rotate('y', 3.14159)" PICTURE "}", "degrees");
    prints("", BALL "s:rotate('y', 1.5):rotate('x', 3):rotate('z', 90)" PICTURE "}", NULL);
}

TEST(syntax_errors_have_the_habit_that_they_come_from) {
    static const char *const cases[][2] = {
        {"local t = {\n  a = 1\n  b = 2,\n}", "scene.lua:3: |a comma is missing after '1'"},
        {"gr.sphere(red\ngr.vec())", "a comma is missing after 'red'"},
        {"gr.sphere(radius = 2)", "gr.sphere{radius = ...}"},
        {"local n = 1\nif n = 3 then end", "scene.lua:2: |== compares"},
        {"local n = 1\nn += 1", "n = n + "},
        {"local n = 1\nn++", "write n = n + 1"},
        {"// words", "a comment begins with --"},
        {"local n = \xE2\x80\x9Cn\xE2\x80\x9D", "\xE2\x80\x9C is a curly quotation mark"},
        {"if 1 != 2 then end", "'not equal' is ~="},
        {"if a && b then end", "'&&' is and"},
        {"if a || b then end", "'||' is or"},
        {"if a == 1 {\n}", "no braces"},
        {"function f() {\n}", "no braces"},
        {"var n = 3", "made by local"},
        {"local n == 3", "= gives a value"},
        {"if a then\nelse if b then\nend", "write elseif"},
        {"if a then\nelif b then\nend", "'elif' is elseif"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        prints("", cases[i][0], cases[i][1]);
        struct test_result result = test_gray_scene(cases[i][0], "scene.lua", NULL);
        CHECK_EQ_INT(result.status, 1);
        CHECK(strchr(result.err, '\n') == strrchr(result.err, '\n')); /* no traceback of C alone */
        test_free_result(&result);
    }
}

TEST(errors_of_lua_have_their_cause) {
    prints("", BALL "s.radius = 2", "scene.lua:2: radius of a node cannot be set|gr.sphere{radius = 2}");
    prints("", BALL "print(red.kd)", "the field kd of a material cannot be read");
    prints("", "local f = io.open('log.txt', 'w')\nf:write('x')", "scene.lua:2: |io.open returned nil|--allow-write");
    prints("", "local m = rt.material({1, 0, 0})", "--dialect camel");
    prints("", "size(64, 48)", "--dialect processing");
    prints("", "sphere(3)", "did you mean 'gr.sphere'?");
    prints("", BALL "local function make() end\ns:add_child(make())",
           "scene.lua:3: |node is missing: nothing was given");
    prints("", "local meshes = require 'meshes'\nmeshes.load('a')", "there is no meshes.load; meshes has area, bounds");
}

TEST(errors_in_the_library_have_the_line_of_the_scene) {
    prints("", "local patterns = require 'patterns'\npatterns.wood{}", "scene.lua:2: patterns.wood: p must be a point");
    prints("", "local text = require 'text'\ntext.node('hi', {size = 1, material = 'gold'})",
           "scene.lua:2: text.node: gr.prism: material must be a material");
    prints("", "local meshes = require 'meshes'\nmeshes.smooth(gr.node('n'))",
           "scene.lua:2: meshes.smooth: verts must be a table, not a node");
    prints("", "local patterns = require 'patterns'\ngr.material{kd = function(p) return patterns.cheker(p) end}",
           "scene.lua:2: |did you mean 'patterns.checker'?");
    prints("", "local patterns = require 'patterns'\ngr.material{kd = patterns.wood}",
           "function(p) return patterns.wood(p) end");
}

TEST(a_time_limit_ends_pictures_of_whitted) {
    const char *slow =
        BALL "gr.render{node = s, file = 'x.png', width = 1200, height = 900, eye = {0, 0, 3}, "
             "lights = {gr.area_light{colour = {1, 1, 1}, corner = {0, 5, 5}, v1 = {1, 0, 0}, v2 = {0, 1, 0}}}}";
    prints("--time-limit 0.2 -full -ss 16 -j 2", slow, "of the pixels have fewer samples|--time-limit ended the rest");
    prints("--time-limit 1000", BALL PICTURE "}", NULL);
}
