/* --dialect (docs/dialects.md): a file of Lua that runs before the scene. */
#define _GNU_SOURCE
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void put(const char *name, const char *text) {
    test_write_text(test_path(name), text);
}

/* Runs the program in the folder of the test; `text` is on standard error. */
static void gives(const char *arguments, int status, const char *text) {
    struct test_result result = test_gray(NULL, arguments);
    if (result.status != status || !strstr(result.err, text))
        test_fail(__FILE__, __LINE__, "%s: status %d, not %d; printed: %s; expected: %s", arguments, result.status,
                  status, result.err, text);
    test_free_result(&result);
}

static void check_pixel(const struct test_picture *picture, uint32_t x, uint32_t y, int r, int g, int b) {
    const uint8_t *p = picture->rgb + 3 * ((size_t)y * picture->width + x);
    if (abs(p[0] - r) > 1 || abs(p[1] - g) > 1 || abs(p[2] - b) > 1)
        test_fail(__FILE__, __LINE__, "pixel %u, %u is %d %d %d, not %d %d %d", x, y, p[0], p[1], p[2], r, g, b);
}

#define RENDER(root, file) "gr.render(" root ", '" file "', 40, 30, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 40)\n"

TEST(a_dialect_defines_functions_methods_and_an_end) {
    put("d.lua", "local root = gr.node('root')\n"
                 "function ball(x) local b = gr.sphere('ball') b:translate(x, 0, 0) root:add_child(b) return b end\n"
                 "return {methods = {paint = function(n, r, g, b)\n"
                 "  return n:set_material(gr.material({r, g, b})) end},\n"
                 "  finish = function() " RENDER("root", "a.png") " end}\n");
    put("a.lua", "ball(0.5):paint(1, 0.5, 0)\n");
    put("b.lua", "local r, b = gr.node('root'), gr.sphere('ball') b:translate(0.5, 0, 0) r:add_child(b)\n"
                 "b:set_material(gr.material({1, 0.5, 0}))\n" RENDER("r", "b.png"));
    gives("-q b.lua", 0, "");
    gives("-q --dialect d.lua a.lua", 0, "");
    CHECK(test_same_files("a.png", "b.png"));
    gives("-q a.lua", 1, "a.lua:1: ");
}

TEST(a_method_of_a_dialect_may_use_the_one_it_replaces) {
    put("d.lua", "local translate = gr.node('any').translate\n"
                 "return {methods = {translate = function(n, v) return translate(n, 2 * v.x, 0, 0) end}}\n");
    put("a.lua", "local b = gr.sphere('ball') b:translate{x = 0.25}\n" RENDER("b", "a.png"));
    put("b.lua", "local b = gr.sphere('ball') b:translate(0.5, 0, 0)\n" RENDER("b", "b.png"));
    gives("-q --dialect ./d.lua a.lua", 0, "");
    gives("-q b.lua", 0, "");
    CHECK(test_same_files("a.png", "b.png"));
}

TEST(a_dialect_of_camel_case_gives_the_bytes_of_the_scene_in_gr) {
    put("a.lua", "local s = rt.node('s')\n"
                 "s:addChild(rt.nhSphere('b', {0, 0, 0}, 1):setMaterial(rt.material({1, .5, .2})):rotateAxis({1, 0, "
                 "0}, 9))\n" RENDER("s", "a.png"));
    put("b.lua",
        "local s = gr.node('s')\n"
        "s:add_child(gr.nh_sphere('b', {0, 0, 0}, 1):set_material(gr.material({1, .5, .2})))\n" RENDER("s", "b.png"));
    gives("-q --dialect camel a.lua", 0, "");
    gives("-q b.lua", 0, "");
    CHECK(test_same_files("a.png", "b.png"));
}

TEST(a_dialect_of_icesl_renders_what_is_emitted) {
    put("a.lua", "set_brush_color(1, 1, 0, 0)\n"
                 "emit(difference(ccube(20), translate(0, 0, 10) * sphere(8)), 1)\n"
                 "emit(translate(30 * Z) * rotate(90, X) * scale(2) * ccylinder(2, 4) )\n"
                 "emit(translate(0, 0, -20) * linear_extrude(v(0, 0, 4), {v(0, 0), v(8, 0), v(0, 8)}))\n"
                 "emit(mirror(X) * translate(9, 0, 0) * U{cone(4, 2, 9), D(cube(3), cylinder(1, 3))})\n"
                 "assert(ui_number('wall', 3, 1, 9) == 3 and (X + 2 * Y - Z)[2] == 2)\n"
                 "assert(load('return 7')() == 7)\n");
    gives("-q --dialect icesl a.lua", 0, "");
    struct test_picture picture = test_read_picture(test_path("icesl.png"));
    CHECK(picture.width == 640 && picture.height == 480);
    check_pixel(&picture, 0, 0, 242, 242, 242);
    const uint8_t *p = picture.rgb;
    size_t red = 0;
    for (size_t i = 0; i < 640 * 480; i++)
        red += p[3 * i] > 60 && p[3 * i + 1] == 0;
    CHECK(red > 5000);
    free(picture.rgb);
}

TEST(a_dialect_of_processing_draws_in_pixels_from_the_upper_left) {
    put("a.lua",
        "function setup() size(80, 60, P3D) end\n"
        "function draw()\n  background(40, 60, 90) ambientLight(255) noStroke()\n"
        "  pushMatrix() translate(20, 15) fill(200, 100, 0) box(10) popMatrix()\n"
        "  fill(0, 150, 0) translate(width / 2, height / 2, 0) rotateZ(HALF_PI) translate(20, 0, 0) sphere(5)\n"
        "end\n");
    gives("-q --dialect processing a.lua", 0, "");
    struct test_picture picture = test_read_picture(test_path("sketch.png"));
    CHECK(picture.width == 80 && picture.height == 60);
    check_pixel(&picture, 79, 0, 40, 60, 90);
    check_pixel(&picture, 20, 15, 200, 100, 0);
    check_pixel(&picture, 40, 50, 0, 150, 0);
    free(picture.rgb);
}

TEST(a_missing_dialect_lists_those_there_are) {
    put("a.lua", RENDER("gr.sphere('b')", "a.png"));
    gives("-q --dialect camle a.lua", 2,
          "gray: --dialect: there is no dialect 'camle'; did you mean 'camel'?; the library has camel, icesl, "
          "processing");
    gives("-q --dialect none.lua a.lua", 1, "none.lua: cannot be read");
    gives("-q --dialect", 2, "needs a value");
}

TEST(an_error_of_a_dialect_names_its_file_and_line) {
    put("a.lua", "ball()\n");
    put("d.lua", "\nlocal x = = 1\n");
    gives("-q --dialect d.lua a.lua", 1, "d.lua:2: unexpected symbol");
    put("d.lua", "\n\ngr.sphere{radius = -1}\n");
    gives("-q --dialect d.lua a.lua", 1, "d.lua:3: gr.sphere: radius must be > 0");
    put("d.lua", "function ball()\n return gr.sphere{radius = -1} end\n");
    gives("-q --dialect d.lua a.lua", 1, "d.lua:2: gr.sphere: radius must be > 0");
    gives("-q --dialect d.lua a.lua", 1, "a.lua:1: in main chunk");
    put("d.lua", "function ball() end return 7\n");
    gives("-q --dialect d.lua a.lua", 1, "d.lua: a dialect returns a table or nothing, not a number");
    put("d.lua", "function ball() end return {finish = 7}\n");
    gives("-q --dialect d.lua a.lua", 1, "d.lua: finish must be a function, not a number");
    put("d.lua", "function ball() end return {methods = {7}}\n");
    gives("-q --dialect d.lua a.lua", 1, "d.lua: methods must hold functions by name");
}

TEST(a_dialect_reads_its_own_folder_inside_the_sandbox) {
    CHECK(mkdir(test_path("w"), 0777) == 0 && mkdir(test_path("w/s"), 0777) == 0 && mkdir(test_path("far"), 0777) == 0);
    put("far/part.lua", "return 0.25");
    put("far/d.lua", "radius = require 'part'\nassert(not os.execute)\n");
    put("w/s/a.lua", RENDER("gr.sphere{radius = radius}", "a.png"));
    const char *folder = test_path("w");
    struct test_result result = test_gray(folder, "-q --dialect ../far/d.lua s/a.lua");
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.err, "");
    test_free_result(&result);
    /* A link leads to the file, not to its folder. */
    CHECK(symlink("../far/d.lua", test_path("w/link.lua")) == 0);
    result = test_gray(folder, "-q --dialect link.lua s/a.lua");
    CHECK_EQ_INT(result.status, 1);
    CHECK(strstr(result.err, "link.lua:1: require: cannot find module 'part'"));
    test_free_result(&result);
}

TEST(a_dialect_belongs_to_the_scene_in_parts_and_checkpoints) {
    put("a.lua", "local b = gr.sphere{radius = radius}\n" RENDER("b", "a.png"));
    put("d.lua", "radius = 1\n");
    gives("-q --dialect d.lua a.lua -o whole.png", 0, "");
    gives("-q --dialect d.lua --shard 1/2 a.lua -o p.png", 0, "");
    gives("-q --dialect d.lua --shard 2/2 a.lua -o p.png", 0, "");
    gives("-q merge p.png.1-of-2.part p.png.2-of-2.part", 0, "");
    CHECK(test_same_files("whole.png", "p.png"));
    put("d.lua", "radius = 1.5\n");
    CHECK(unlink(test_path("p.png")) == 0 && unlink(test_path("p.png.2-of-2.part")) == 0);
    gives("-q --dialect d.lua --shard 2/2 a.lua -o p.png", 0, "");
    gives("-q merge p.png.1-of-2.part p.png.2-of-2.part", 1, "the scene, or a file it reads, has changed");
}
