/* Anti-aliasing with --aa-pattern rotated (docs/language.md 10.4): thin lines and small balls in pictures of one unit a
 * pixel, with what is white on black, so that the sum of the bytes is an area. */
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 48 };

static const double pi = 3.14159265358979323846;

static void renders(const char *scene, const char *arguments) {
    struct test_result result = test_gray_scene(scene, arguments, NULL);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "status %d: %s", result.status, result.err);
    test_free_result(&result);
}

static double value(const struct test_picture *p, uint32_t x, uint32_t y) {
    return p->rgb[3 * ((size_t)y * p->width + x)] / 255.0;
}

/* --- lines --- */

/* Lines of the width W through the picture, at the angles and offsets of the tables below. */
#define LINES                                                                                                          \
    "local white = gr.material({1,1,1}, {0,0,0}, 1)\n"                                                                 \
    "local make = {\n"                                                                                                 \
    "  cylinder = function() local c = gr.cylinder(white) c:scale(W/2, 100, W/2) c:rotate('z', 90) return c end,\n"    \
    "  box = function() return gr.box(white, {-100, -W/2, -W/2}, {100, W/2, W/2}) end,\n"                              \
    "  rectangle = function() return gr.rectangle(white, {-100, -W/2, 0}, {200, 0, 0}, {0, W, 0}) end,\n"              \
    "  curve = function() return gr.curve(white, {{-100,0,0}, {-30,0,0}, {30,0,0}, {100,0,0}}, W) end}\n"              \
    "local function line(shape, degrees, offset, name, more)\n"                                                        \
    "  local root, node = gr.node('root'), make[shape]()\n"                                                            \
    "  node:rotate('z', degrees)\n"                                                                                    \
    "  local steep = degrees > 45 and degrees < 135\n"                                                                 \
    "  node:translate(steep and offset or 0, steep and 0 or offset, 0)\n"                                              \
    "  root:add_child(node)\n"                                                                                         \
    "  local picture = {node=root, file=name, width=48, height=48, eye={0,0,10}, view={0,0,-1}, up={0,1,0},\n"         \
    "    projection='orthographic', view_height=48, ambient={1,1,1}, background={0,0,0}}\n"                            \
    "  for key, value in pairs(more or {}) do picture[key] = value end\n"                                              \
    "  gr.render(picture)\n"                                                                                           \
    "end\n"

static const double angles[] = {0,  1,  3.7,    11, 18.435, 22.5, 26.565, 30,  40,
                                45, 52, 63.435, 77, 90,     101,  120,    135, 178};
static const double offsets[] = {0, 0.15, 0.35, 0.5, 0.77};
enum { ANGLES = sizeof angles / sizeof angles[0], OFFSETS = sizeof offsets / sizeof offsets[0] };

struct line_seen {
    double columns;    /* the share of columns, or of rows of a steep line, where it shows */
    double brightness; /* relative to its area */
};

/* In the middle of the picture, which the line leaves through its sides, or through top and bottom. */
static struct line_seen see_line(const char *name, double degrees, double width) {
    enum { MARGIN = 2 };
    struct test_picture p = test_read_picture(test_path(name));
    bool steep = degrees > 45 && degrees < 135;
    double sum = 0, shown = 0, a = degrees * pi / 180;
    for (uint32_t along = MARGIN; along < SIDE - MARGIN; along++) {
        double column = 0;
        for (uint32_t across = 0; across < SIDE; across++)
            column += steep ? value(&p, across, along) : value(&p, along, across);
        sum += column;
        shown += column > 0;
    }
    free(p.rgb);
    double count = SIDE - 2 * MARGIN, area = width / fabs(steep ? sin(a) : cos(a));
    return (struct line_seen){shown / count, sum / count / area};
}

static void check_lines(const char *shape, double width, const char *options) {
    char scene[8000], arguments[100];
    int length = snprintf(scene, sizeof scene, "local W = %g\n" LINES "for i, a in ipairs{", width);
    for (int i = 0; i < ANGLES; i++)
        length += snprintf(scene + length, sizeof scene - (size_t)length, "%g,", angles[i]);
    length += snprintf(scene + length, sizeof scene - (size_t)length, "} do for j, o in ipairs{");
    for (int i = 0; i < OFFSETS; i++)
        length += snprintf(scene + length, sizeof scene - (size_t)length, "%g,", offsets[i]);
    (void)snprintf(scene + length, sizeof scene - (size_t)length,
                   "} do line('%s', a, o, string.format('l%%d-%%d.png', i - 1, j - 1)) end end\n", shape);
    (void)snprintf(arguments, sizeof arguments, "--aa-pattern rotated %s scene.lua", options);
    renders(scene, arguments);
    for (int i = 0; i < ANGLES; i++) {
        double columns = 0;
        for (int j = 0; j < OFFSETS; j++) {
            char name[40];
            (void)snprintf(name, sizeof name, "l%d-%d.png", i, j);
            struct line_seen seen = see_line(name, angles[i], width);
            columns += seen.columns / OFFSETS;
            if (seen.brightness < 0.8 || seen.brightness > 1.2)
                test_fail(__FILE__, __LINE__, "%s at %g degrees, offset %g: %g of its brightness", shape, angles[i],
                          offsets[j], seen.brightness);
        }
        if (columns < 0.95)
            test_fail(__FILE__, __LINE__, "%s at %g degrees: %g of its columns", shape, angles[i], columns);
    }
}

TEST(a_cylinder_of_0_3_pixels_shows_at_every_angle_with_its_brightness) {
    check_lines("cylinder", 0.3, "");
}
TEST(a_box_of_0_3_pixels_shows_at_every_angle_with_its_brightness) {
    check_lines("box", 0.3, "");
}
TEST(a_rectangle_of_0_3_pixels_shows_at_every_angle_with_its_brightness) {
    check_lines("rectangle", 0.3, "");
}
TEST(a_curve_of_0_3_pixels_shows_at_every_angle_with_its_brightness) {
    check_lines("curve", 0.3, "");
}
TEST(lines_of_0_8_pixels_show_with_their_brightness) {
    check_lines("cylinder", 0.8, "");
    check_lines("rectangle", 0.8, "");
}
TEST(full_pictures_of_thin_lines_have_their_brightness) {
    check_lines("cylinder", 0.3, "-full");
}

/* A line across the middle shows in nearly all columns of the middle. With these numbers a pixel there is about one
 * unit (in the panorama: less than two). */
TEST(thin_lines_show_in_every_projection) {
    static const char *const cameras[] = {
        "{projection='perspective', eye={0,0,24}, fov=90}",
        "{projection='perspective', eye={0,0,24}, fov=90, shift_y=0.1}",
        "{projection='fisheye', eye={0,0,24}, angle=115}", "{projection='panorama', eye={0,0,7.6}}",
        "{projection='perspective', eye={0,0,24}, fov=90, stereo='anaglyph', screen=24}"};
    for (size_t i = 0; i < sizeof cameras / sizeof cameras[0]; i++) {
        char scene[6000];
        (void)snprintf(scene, sizeof scene,
                       "local W = 0.3\n" LINES "line('cylinder', 2, 0.3, 't.png', %s)\n"
                       "line('curve', 2, 0.3, 'c.png', %s)\n",
                       cameras[i], cameras[i]);
        renders(scene, "--aa-pattern rotated scene.lua");
        for (int which = 0; which < 2; which++) {
            struct test_picture p = test_read_picture(test_path(which ? "c.png" : "t.png"));
            int shown = 0;
            for (uint32_t x = 17; x < 31; x++) {
                double column = 0;
                for (uint32_t y = 0; y < SIDE; y++)
                    column += value(&p, x, y);
                shown += column > 0;
            }
            if (shown < 13)
                test_fail(__FILE__, __LINE__, "%s: %d of 14 columns", cameras[i], shown);
            free(p.rgb);
        }
    }
}

/* --- small balls --- */

TEST(no_ball_of_half_a_pixel_is_lost_at_100_positions) {
    renders(
        "local white, root = gr.material({1,1,1}, {0,0,0}, 1), gr.node('root')\n"
        "for i = 0, 9 do for j = 0, 9 do root:add_child(gr.nh_sphere(white, {-45 + 10.1 * i + .01 * j, 45 - 10.1 * j "
        "- .01 * i, 0}, .25)) end end\n"
        "gr.render{node=root, file='t.png', width=110, height=110, eye={0,0,10}, view={0,0,-1}, up={0,1,0}, "
        "projection='orthographic', view_height=110, ambient={1,1,1}, background={0,0,0}}\n",
        "--aa-pattern rotated scene.lua");
    struct test_picture p = test_read_picture(test_path("t.png"));
    double sum = 0;
    int lost = 0;
    for (int i = 0; i < 10; i++) {
        for (int j = 0; j < 10; j++) {
            int x = (int)(10 + 10.1 * i + 0.01 * j), y = (int)(10 + 10.1 * j + 0.01 * i);
            double own = 0;
            for (int k = 0; k < 25; k++)
                own += value(&p, (uint32_t)(x + k % 5 - 2), (uint32_t)(y + k / 5 - 2));
            lost += own == 0;
            sum += own;
        }
    }
    CHECK_EQ_INT(lost, 0);
    CHECK_NEAR(sum / 100, pi / 16, 0.1 * pi / 16);
    free(p.rgb);
}

/* --- marks --- */

#define MIXED                                                                                                          \
    "local root = gr.node('root')\n"                                                                                   \
    "for i = 1, 30 do local c = {math.random(), math.random(), math.random()}\n"                                       \
    "root:add_child(gr.nh_sphere(gr.material(c, {.3,.3,.3}, 20), {math.random()*6-3, math.random()*4-2, "              \
    "math.random()*2-1}, .1+math.random()*.4)) end\n"                                                                  \
    "for i = 1, 40 do local a = math.random() * 6 root:add_child(gr.curve(gr.material({.9,.9,.5},{0,0,0},1), "         \
    "{{-3, math.random()*4-2, 1}, {0, math.random()*4-2, 1}, {3, math.random()*4-2, a - 3}}, .01)) end\n"              \
    "gr.render(root, 't.png', 117, 83, {0,0,8}, {0,0,-1}, {0,1,0}, 35, {.3,.3,.3}, {gr.light({3,5,6}, {.8,.8,.8}, "    \
    "{1,0,0})})\n"

static bool is_red(const uint8_t *c) {
    return c[0] == 255 && c[1] == 0 && c[2] == 0;
}

TEST(pixels_that_are_not_marked_keep_the_first_pass_and_those_of_the_grid_are_marked_too) {
    renders(MIXED, "--aa-pattern grid -write-aa-targets old- scene.lua");
    renders(MIXED, "--aa-pattern rotated -write-pre-aa pre- -write-aa-targets new- scene.lua");
    struct test_picture pre = test_read_picture(test_path("pre-t.png")),
                        old = test_read_picture(test_path("old-t.png")),
                        new = test_read_picture(test_path("new-t.png")), done = test_read_picture(test_path("t.png"));
    int touched = 0, missing = 0, shown = 0, more = 0;
    for (size_t i = 0; i < 3 * (size_t)117 * 83; i += 3) {
        bool red = is_red(new.rgb + i);
        touched += !red && memcmp(pre.rgb + i, done.rgb + i, 3) != 0;
        shown += !red && memcmp(pre.rgb + i, new.rgb + i, 3) != 0;
        missing += !red && is_red(old.rgb + i);
        more += red && !is_red(old.rgb + i);
    }
    CHECK_EQ_INT(touched, 0);
    CHECK_EQ_INT(shown, 0);
    CHECK_EQ_INT(missing, 0);
    CHECK(more > 100);
    free(pre.rgb);
    free(old.rgb);
    free(new.rgb);
    free(done.rgb);
}

TEST(tolerances_above_every_difference_mark_nothing) {
    renders(MIXED, "--aa-pattern rotated -side-tolerance 3 -corner-tolerance 3 -write-pre-aa pre- scene.lua");
    struct test_picture pre = test_read_picture(test_path("pre-t.png")), done = test_read_picture(test_path("t.png"));
    CHECK(memcmp(pre.rgb, done.rgb, 3 * (size_t)117 * 83) == 0);
    free(pre.rgb);
    free(done.rgb);
}

/* --- the same bytes --- */

TEST(rotated_pictures_are_the_same_for_threads_crops_accelerators_and_full_where_they_are_marked) {
    renders(MIXED, "--aa-pattern rotated -j 1 -write-aa-targets targets- scene.lua");
    struct test_picture whole = test_read_picture(test_path("t.png")),
                        targets = test_read_picture(test_path("targets-t.png"));
    static const char *const same[] = {"-j 4", "--accel bvh -j 2", "--isa base -j 3"};
    for (size_t i = 0; i < sizeof same / sizeof same[0]; i++) {
        char arguments[100];
        (void)snprintf(arguments, sizeof arguments, "--aa-pattern rotated %s -o same.png scene.lua", same[i]);
        renders(MIXED, arguments);
        struct test_picture p = test_read_picture(test_path("same.png"));
        CHECK(memcmp(p.rgb, whole.rgb, 3 * (size_t)117 * 83) == 0);
        free(p.rgb);
    }
    renders(MIXED, "--aa-pattern rotated --crop 41,13,50,37 -o crop.png scene.lua");
    renders(MIXED, "--aa-pattern rotated -full -o full.png scene.lua");
    struct test_picture crop = test_read_picture(test_path("crop.png")),
                        full = test_read_picture(test_path("full.png"));
    int wrong = 0;
    for (size_t y = 0; y < 37; y++)
        wrong += memcmp(crop.rgb + 3 * y * 50, whole.rgb + 3 * ((y + 13) * 117 + 41), (size_t)3 * 50) != 0;
    for (size_t i = 0; i < 3 * (size_t)117 * 83; i += 3)
        wrong += is_red(targets.rgb + i) && memcmp(full.rgb + i, whole.rgb + i, 3) != 0;
    CHECK_EQ_INT(wrong, 0);
    free(crop.rgb);
    free(full.rgb);
    free(targets.rgb);
    free(whole.rgb);
}

/* --- the rotated grid --- */

/* The right edge of a white square crosses the pixels of column 10 at the fraction 0.28 of their width; every column of
 * N^2 has one sample. */
TEST(upright_edges_have_n_squared_steps) {
    for (int n = 1; n <= 5; n++) {
        char arguments[100];
        (void)snprintf(arguments, sizeof arguments, "--aa-pattern rotated -ss %d scene.lua", n);
        renders(
            "local r = gr.node('r') r:add_child(gr.nh_box(gr.material({1,1,1},{0,0,0},1), {-99.72, -50, -100}, 100))\n"
            "gr.render{node=r, file='t.png', width=20, height=20, eye={0,0,10}, fov=90, ambient={1,1,1}, "
            "background={0,0,0}}\n",
            arguments);
        struct test_picture p = test_read_picture(test_path("t.png"));
        double covered = floor(0.28 * n * n + 0.5) / (n * n);
        for (uint32_t y = 2; y < 18; y++)
            CHECK_NEAR(value(&p, 10, y), covered, 0.51 / 255);
        free(p.rgb);
    }
}

/* --- shadows of lamps --- */

/* The lamp has 3 x 3 shadow rays for a sample, as by default. A single sample of each pixel differs by up to a fifth of
 * the range: that is the grain. Where neighbours differ, more samples follow. */
TEST(penumbrae_of_nine_shadow_rays_have_no_grain) {
    static const char scene[] =
        "local r = gr.node('r')\n"
        "r:add_child(gr.plane{material = gr.material{kd = {.7, .7, .7}}, normal = {0, 1, 0}})\n"
        "r:add_child(gr.box{material = gr.material{kd = {.7, .3, .2}}, min = {-3, .8, -1}, max = {0, 1, 1}})\n"
        "gr.render{node = r, file = 't.png', width = 80, height = 60, eye = {0, 5, 6}, target = {0, 0, 0}, fov = 40, "
        "lights = "
        "{gr.area_light({-1.5, 5, -1}, {3, 0, 0}, {0, 0, 3}, {.9, .9, .9}, {1, 0, 0})}}\n";
    struct test_picture pictures[3];
    static const char *const options[] = {"scene.lua", "-full -ss 1 scene.lua",
                                          "-full -ss 3 --default area_samples=12 scene.lua"};
    for (int i = 0; i < 3; i++) {
        renders(scene, options[i]);
        pictures[i] = test_read_picture(test_path("t.png"));
    }
    int grain = 0, left = 0;
    for (size_t i = 0; i < 3 * (size_t)80 * 60; i++) {
        left = (int)fmax(left, abs(pictures[0].rgb[i] - pictures[2].rgb[i]));
        grain = (int)fmax(grain, abs(pictures[1].rgb[i] - pictures[2].rgb[i]));
    }
    CHECK(grain > 40);
    CHECK(left < 16);
    for (int i = 0; i < 3; i++)
        free(pictures[i].rgb);
}
