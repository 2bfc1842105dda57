/* Drawn pictures: toon and Gooch shading at points by their formulas, lines where objects, normals and depths change,
 * however the picture is divided. */
#define _GNU_SOURCE
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

enum { W = 160, H = 120 };

/* A picture of floats as gray wrote it, top row first. */
struct light {
    float rgb[H][W][3];
};

static bool read_light(const char *name, struct light *out) {
    size_t size, bytes = sizeof out->rgb;
    char *file = test_read_file(test_path(name), &size);
    bool ok = file && size > bytes;
    for (int y = 0; ok && y < H; y++)
        memcpy(out->rgb[H - 1 - y], file + size - bytes + (size_t)y * sizeof out->rgb[0], sizeof out->rgb[0]);
    free(file);
    return ok;
}

static void render(const char *scene, const char *options, struct light *out) {
    char line[256];
    (void)snprintf(line, sizeof line, "-q scene.lua -o out.pfm %s", options);
    struct test_result result = test_gray_scene(scene, line, NULL);
    if (result.status != 0 || !read_light("out.pfm", out))
        test_fail(__FILE__, __LINE__, "%s: status %d: %s", options, result.status, result.err);
    test_free_result(&result);
}

/* A unit ball seen along -z without perspective: pixel (x, y) is its point (px, py, sqrt(1 - px^2 - py^2)). */
#define BALL                                                                                                           \
    "local r = gr.node('r')\n"                                                                                         \
    "r:add_child(gr.sphere{material = gr.material{kd = {.6, .3, .2}}, name = 'ball'})\n"                               \
    "gr.render{node = r, file = 'out.pfm', width = 160, height = 120, eye = {0, 0, 5}, projection = 'orthographic',\n" \
    "  view_height = 3, ambient = {.1, .2, .3}, background = {1, 1, 1}, lights = {gr.light({3, 4, 12}, {.8, .6, .4},"  \
    " {1, 0, 0})}}\n"

/* False: the pixel is not on the ball, or near its edge. */
static bool point_of(int x, int y, double p[3]) {
    p[0] = (x + 0.5 - W / 2.0) * 3 / H;
    p[1] = -(y + 0.5 - H / 2.0) * 3 / H;
    double squared = p[0] * p[0] + p[1] * p[1];
    p[2] = squared < 0.9 ? sqrt(1 - squared) : 0;
    return squared < 0.9;
}

/* The cosine between the normal and the direction to the light. */
static double cosine_of(const double p[3]) {
    double d[3] = {3 - p[0], 4 - p[1], 12 - p[2]};
    return (p[0] * d[0] + p[1] * d[1] + p[2] * d[2]) / sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

TEST(gooch_shading_at_points_is_its_formula) {
    static const double kd[3] = {0.6, 0.3, 0.2}, blue[3] = {0, 0, 0.4}, yellow[3] = {0.4, 0.4, 0};
    static struct light light;
    render(BALL, "--style gooch --line-width 0 -ss 1", &light);
    for (int y = 0; y < H; y++) {
        for (int x = 0; x < W; x++) {
            double p[3];
            if (!point_of(x, y, p))
                continue;
            double t = (1 + cosine_of(p)) / 2;
            for (int c = 0; c < 3; c++)
                CHECK_NEAR(light.rgb[y][x][c], t * (yellow[c] + 0.6 * kd[c]) + (1 - t) * (blue[c] + 0.2 * kd[c]), 1e-6);
        }
    }
}

TEST(toon_shading_at_points_is_its_formula) {
    static const double kd[3] = {0.6, 0.3, 0.2}, ambient[3] = {0.1, 0.2, 0.3}, lamp[3] = {0.8, 0.6, 0.4};
    static struct light light;
    for (int steps = 1; steps <= 5; steps += 2) {
        char options[100];
        int levels = 0;
        double before = -1;
        (void)snprintf(options, sizeof options, "--style toon --line-width 0 -ss 1 --toon-steps %d", steps);
        render(BALL, options, &light);
        for (int y = 0; y < H; y++) {
            for (int x = 0; x < W; x++) {
                double p[3];
                if (!point_of(x, y, p))
                    continue;
                double max = 0.8 * fmax(cosine_of(p), 0), step = floor(max * steps + 0.5) / steps;
                if (fabs(max * steps + 0.5 - rint(max * steps + 0.5)) < 1e-6)
                    continue;
                for (int c = 0; c < 3; c++)
                    CHECK_NEAR(light.rgb[y][x][c], kd[c] * (ambient[c] + lamp[c] / 0.8 * step), 1e-6);
                levels += before >= 0 && fabs(step - before) > 0.01;
                before = step;
            }
        }
        CHECK(levels > 0);
    }
}

/* The darkness of a picture on white paper at a pixel. */
static double dark(const struct light *light, int x, int y) {
    return x < 0 || x >= W || y < 0 || y >= H ? 0 : 1 - (double)light->rgb[y][x][0];
}

/* A line around (cx, cy): in each direction its middle is within half a pixel of the radius, and it is as wide as it
 * should be. */
static void expect_circle(const struct light *light, double cx, double cy, double radius, double width) {
    enum { DIRECTIONS = 90 };
    double sums[DIRECTIONS] = {0}, radii[DIRECTIONS] = {0}, all = 0;
    for (int y = 0; y < H; y++) {
        for (int x = 0; x < W; x++) {
            double dx = x + 0.5 - cx, dy = y + 0.5 - cy, r = sqrt(dx * dx + dy * dy);
            double d = r < H / 2.0 - 1 ? dark(light, x, y) : 0; /* beyond it a fisheye has no picture */
            int direction = (int)((atan2(dy, dx) / (2 * M_PI) + 1) * DIRECTIONS) % DIRECTIONS;
            sums[direction] += d;
            radii[direction] += d * r;
            all += d;
            CHECK(d == 0 || fabs(r - radius) < width / 2 + 1);
        }
    }
    for (int i = 0; i < DIRECTIONS; i++) {
        if (!(sums[i] > 0) || !(fabs(radii[i] / sums[i] - radius) < 0.5))
            test_fail(__FILE__, __LINE__, "direction %d of %d: radius %g, not %g", i, DIRECTIONS, radii[i] / sums[i],
                      radius);
    }
    CHECK_NEAR(all / (2 * M_PI * radius * width), 1, 0.1);
}

TEST(the_contour_of_a_ball_is_within_half_a_pixel_of_its_circle) {
    static struct light light;
    for (int width = 1; width <= 5; width++) {
        char options[100];
        (void)snprintf(options, sizeof options, "--style ink --line-width %d", width);
        render(BALL, options, &light);
        expect_circle(&light, W / 2.0, H / 2.0, H / 3.0, width);
    }
    /* In perspective the ball at distance 5 ends at the angle asin(1/5); a fisheye shows angles. */
    render("local r = gr.node('r')\nr:add_child(gr.sphere(gr.material({1, 1, 1}, {0, 0, 0}, 1)))\n"
           "gr.render{node = r, file = 'out.pfm', width = 160, height = 120, eye = {0, 0, 5}, fov = 40}\n",
           "--style ink", &light);
    expect_circle(&light, W / 2.0, H / 2.0, tan(asin(0.2)) / tan(M_PI / 9) * H / 2, 2);
    render("local r = gr.node('r')\nr:add_child(gr.sphere(gr.material({1, 1, 1}, {0, 0, 0}, 1)))\n"
           "gr.render{node = r, file = 'out.pfm', width = 160, height = 120, eye = {0, 0, 5}, projection = 'fisheye', "
           "angle = 40}\n",
           "--style ink", &light);
    expect_circle(&light, W / 2.0, H / 2.0, asin(0.2) / (M_PI / 9) * H / 2, 2);
}

/* Squares in the plane z = 0; one unit is 40 pixels. */
#define SQUARES                                                                                                        \
    "local a, b = gr.material({1, 0, 0}, {0, 0, 0}, 1), gr.material({0, 1, 0}, {0, 0, 0}, 1)\n"                        \
    "local r = gr.node('r')\n"                                                                                         \
    "local function show(eye)\n"                                                                                       \
    "  gr.render{node = r, file = 'out.pfm', width = 160, height = 120, eye = eye, target = {0, 0, 0},\n"              \
    "    projection = 'orthographic', view_height = 3}\nend\n"

static void expect_line_at(const struct light *light, int x, int y, bool wanted) {
    bool found = dark(light, x, y) > 0.9;
    if (found != wanted)
        test_fail(__FILE__, __LINE__, "%s line at %d, %d", found ? "there is a" : "there is no", x, y);
}

TEST(lines_are_where_objects_normals_and_depths_change_and_nowhere_else) {
    static struct light light;
    /* Two triangles of one mesh in a plane have no line between them, two materials have one. */
    render(SQUARES
           "r:add_child(gr.mesh(a, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}))\n"
           "r:add_child(gr.mesh(b, {{0, -.5, .001}, {.5, -.5, .001}, {.5, .5, .001}, {0, .5, .001}}, {{0, 1, 2, 3}}))\n"
           "show{0, 0, 9}\n",
           "--style ink", &light);
    expect_line_at(&light, 40, 60, true);
    expect_line_at(&light, 120, 60, true);
    expect_line_at(&light, 80, 60, true);
    expect_line_at(&light, 90, 60, false);
    expect_line_at(&light, 60, 40, false);
    expect_line_at(&light, 60, 60, false);
    expect_line_at(&light, 5, 5, false);
    /* A roof of 90 degrees has a crease, one of 20 degrees has none. */
    for (int steep = 0; steep < 2; steep++) {
        char scene[1024];
        (void)snprintf(scene, sizeof scene,
                       SQUARES
                       "local h = %g\nr:add_child(gr.mesh(a, {{-1, -1, -h}, {0, -1, 0}, {0, 1, 0}, {-1, 1, -h}, "
                       "{1, -1, -h}, {1, 1, -h}}, {{0, 1, 2, 3}, {1, 4, 5, 2}}))\nshow{0, 0, 9}\n",
                       steep ? 1.0 : 0.17);
        render(scene, "--style ink", &light);
        expect_line_at(&light, 80, 60, steep);
        expect_line_at(&light, 60, 60, false);
    }
    /* One mesh of two parallel squares, 1 apart: the nearer one hides a part of the other. */
    render(SQUARES
           "r:add_child(gr.mesh(a, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {-.5, -.5, 1}, {.5, -.5, 1}, "
           "{.5, .5, 1}, {-.5, .5, 1}}, {{0, 1, 2, 3}, {4, 5, 6, 7}}))\nshow{0, 0, 9}\n",
           "--style ink", &light);
    expect_line_at(&light, 60, 60, true);
    expect_line_at(&light, 80, 60, false);
    /* A plane that is seen at an angle of 3 degrees has no line in itself. */
    render(SQUARES "r:add_child(gr.mesh(a, {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}, {{0, 1, 2, 3}}))\n"
                   "show{0, -9, .5}\n",
           "--style ink", &light);
    expect_line_at(&light, 80, 60, false);
    expect_line_at(&light, 80, 58, false);
}

/* --- whole pictures --- */

/* A ball that shines in white, before white: the path tracer has no noise, and only lines are dark. */
#define SHINING                                                                                                        \
    "local r = gr.node('r')\n"                                                                                         \
    "r:add_child(gr.sphere{material = gr.material{kd = {0, 0, 0}, emission = {1, 1, 1}}})\n"                           \
    "gr.render{node = r, file = 'out.pfm', width = 160, height = 120, eye = {0, 0, 5}, projection = 'orthographic',\n" \
    "  view_height = 3, background = {1, 1, 1}, integrator = 'path', spp = 2}\n"

TEST(lines_over_path_traced_pictures_are_those_of_drawn_ones) {
    static struct light line, below, drawn;
    for (int width = 1; width <= 4; width++) {
        char options[100];
        (void)snprintf(options, sizeof options, "--line-width %d", width);
        render(SHINING, options, &line);
        expect_circle(&line, W / 2.0, H / 2.0, H / 3.0, width);
    }
    /* They cover the light, denoised or not, in few or many samples. */
    static const char *const options_of_light[] = {"--spp 5", "--noise .2 --spp 40", "--spp 8 --denoise",
                                                   "--spp 3 --aov diffuse_direct"};
    for (size_t i = 0; i < sizeof options_of_light / sizeof *options_of_light; i++) {
        char options[100];
        (void)snprintf(options, sizeof options, "--integrator path %s", options_of_light[i]);
        render(BALL, options, &below);
        (void)snprintf(options, sizeof options, "--integrator path --line-width 4 %s", options_of_light[i]);
        render(BALL, options, &drawn);
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++)
                CHECK_NEAR((double)drawn.rgb[y][x][0], (double)below.rgb[y][x][0] * (1 - dark(&line, x, y)), 1e-6);
    }
}

TEST(drawn_pictures_of_threads_shards_and_crops_have_the_same_bytes) {
    test_write_text(test_path("scene.lua"), BALL);
    static const char *const styles[] = {"--style toon --line-width 7", "--style gooch", "--line-width 2.5",
                                         "--line-width 3 --integrator path --spp 3"};
    for (size_t i = 0; i < sizeof styles / sizeof *styles; i++) {
        char line[600];
        (void)snprintf(line, sizeof line,
                       "o='-q scene.lua %s'; $gray $o -o a.png -j 1 -write-pre-aa p- && $gray $o -o b.png -j 2 && "
                       "cmp a.png b.png && for i in 1 2 3; do $gray $o -o c.png --shard $i/3; done; "
                       "$gray merge -write-pre-aa p- c.png.*.part && cmp a.png c.png && cmp p-a.png p-c.png && "
                       "$gray $o --crop 37,21,60,50 -o d.png",
                       styles[i]);
        test_shell_errors(line, 0, NULL);
        struct test_picture whole = test_read_picture(test_path("a.png")), part = test_read_picture(test_path("d.png"));
        for (uint32_t y = 0; whole.rgb && part.rgb && y < 50; y++)
            CHECK(memcmp(part.rgb + (size_t)3 * 60 * y, whole.rgb + 3 * ((size_t)(y + 21) * W + 37), 180) == 0);
        free(whole.rgb);
        free(part.rgb);
    }
}

TEST(wrong_values_of_styles_are_refused) {
    test_write_text(test_path("scene.lua"), BALL);
    test_shell_errors("$gray -q scene.lua --style crayon", 2, "--style needs one of none|ink|toon|gooch, not 'crayon'");
    test_shell_errors("$gray -q scene.lua --line-width 33", 2,
                      "--line-width needs PIXELS, a number from 0 to 32, not '33'");
    test_shell_errors("$gray -q scene.lua --toon-steps 0", 2,
                      "--toon-steps needs a whole number from 1 to 64, not '0'");
    test_shell_errors(
        "$gray -q scene.lua --style ink --integrator path", 1,
        "styles are for the integrator 'whitted', not for 'path'; --line-width draws lines over its pictures");
    test_shell_errors("$gray -q scene.lua --style none --integrator path --spp 1", 0, NULL);
}
