/* Pictures of scenes that name no file, no size, no camera or no light. */
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void renders(const char *scene, const char *arguments) {
    struct test_result result = test_gray_scene(scene, arguments, NULL);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "%s: status %d, %s", scene, result.status, result.err);
    test_free_result(&result);
}

static bool says_studio(const char *scene) {
    static const char notice[] = ": the scene has no light, so that of a studio shows it; lights={...} replaces it";
    struct test_result result = test_gray_scene(scene, "--size 8x6 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    const char *first = strstr(result.err, notice);
    bool says = first != NULL;
    CHECK(!says || !strstr(first + 1, notice)); /* once */
    test_free_result(&result);
    return says;
}

static bool is_there(const char *name) {
    FILE *file = fopen(test_path(name), "rb");
    if (file)
        (void)fclose(file);
    return file != NULL;
}

/* Whether two pictures of one scene have the same bytes. */
static bool same_pictures(const char *a, const char *b) {
    size_t sizes[2];
    char *bytes[2] = {test_read_file(test_path(a), &sizes[0]), test_read_file(test_path(b), &sizes[1])};
    bool same = bytes[0] && bytes[1] && sizes[0] == sizes[1] && memcmp(bytes[0], bytes[1], sizes[0]) == 0;
    free(bytes[0]);
    free(bytes[1]);
    return same;
}

/* What a picture of a sphere shows against a background that is its first pixel: the height of the subject, its
 * brightest and darkest pixel. */
struct appearance {
    uint32_t top, bottom;
    int brightest, darkest, background;
    double mean, clipped; /* clipped: the share of white pixels; a few are noise of a path */
};

static struct appearance appearance_of(const struct test_picture *picture) {
    struct appearance shown = {.top = picture->height, .darkest = 255, .background = picture->rgb[0]};
    uint32_t middle = picture->width / 2;
    double sum = 0;
    uint32_t count = 0, white = 0;
    for (uint32_t y = 1; y < picture->height; y++) {
        const uint8_t *row = picture->rgb + (size_t)3 * picture->width * y;
        /* The background changes slowly from row to row, the subject does not begin slowly. */
        if (abs(row[(size_t)3 * middle] - row[0]) < 5)
            continue;
        shown.top = y < shown.top ? y : shown.top;
        shown.bottom = y;
    }
    for (uint32_t y = shown.top; y <= shown.bottom; y++) {
        uint32_t half = (shown.bottom - shown.top) / 4; /* inside of the subject */
        for (uint32_t x = middle - half; x < middle + half; x++, count++) {
            int value = picture->rgb[(size_t)3 * ((size_t)picture->width * y + x)];
            shown.brightest = value > shown.brightest ? value : shown.brightest;
            shown.darkest = value < shown.darkest ? value : shown.darkest;
            sum += value;
            white += value == 255;
        }
    }
    shown.mean = count > 0 ? sum / count : 0;
    shown.clipped = count > 0 ? (double)white / count : 1;
    return shown;
}

static void check_appearance(const char *scene, const char *arguments, int brightest) {
    renders(scene, arguments);
    struct test_picture picture = test_read_picture(test_path("scene.png"));
    uint32_t rows = strstr(arguments, "--size") ? 135 : 540;
    CHECK_EQ_INT(picture.height, rows);
    CHECK_EQ_INT(picture.width, rows * 16 / 9);
    struct appearance shown = appearance_of(&picture);
    double height = (double)(shown.bottom - shown.top + 1) / rows, above = (double)shown.top / rows;
    if (height < 0.66 || height > 0.76 || above < 0.1 || above > 0.2)
        test_fail(__FILE__, __LINE__, "%s: the subject is from row %u to %u", scene, shown.top, shown.bottom);
    if (shown.brightest < brightest || shown.clipped > 0.002 || shown.darkest < 60 || shown.mean < 120)
        test_fail(__FILE__, __LINE__, "%s: from %d to %d, mean %g", scene, shown.darkest, shown.brightest, shown.mean);
    CHECK(shown.brightest - shown.darkest > 50); /* it looks round */
    CHECK(shown.background > 150 && shown.background < 240);
    for (int k = 1; k < 3; k++) /* neutral */
        CHECK(abs(picture.rgb[k] - picture.rgb[0]) < 8);
    free(picture.rgb);
}

TEST(three_lines_give_a_lit_and_framed_picture) {
    check_appearance("gr.render{node = gr.sphere{}}", "-q scene.lua", 180);
    check_appearance("gr.render{node = gr.sphere{}}", "-q --size 240x135 --integrator path --spp 9 scene.lua", 200);
    check_appearance("local white = gr.material{kd = {1, 1, 1}}\nlocal ball = gr.sphere{material = white}\n"
                     "gr.render{node = ball}",
                     "-q --size 240x135 scene.lua", 220);
    /* The same at any size. */
    check_appearance("gr.render{node = gr.sphere{radius = 1e-6, centre = {0, 5e-6, 0}}}", "-q --size 240x135 scene.lua",
                     180);
    check_appearance("gr.render{node = gr.sphere{radius = 1e6}}", "-q --size 240x135 scene.lua", 180);
}

TEST(a_camera_is_fitted_to_any_scene_and_any_size) {
    static const char *const scenes[] = {
        "gr.render{node = gr.cube{}}",
        "gr.render{node = gr.cylinder{from = {0, 0, 0}, to = {0, 50, 0}, radius = 1}}",
        "gr.render{node = gr.cylinder{from = {0, 0, 0}, to = {50, 0, 0}, radius = 1}}",
        "gr.render{node = gr.cylinder{from = {0, 0, 0}, to = {0, 0, 50}, radius = 1}}",
        "gr.render{node = gr.square{}}",
        "gr.render{node = gr.sphere{}, view = {0, -1, 0}}",
        "gr.render{node = gr.sphere{}, up = {0, -1, 0}, fov = 45}",
        "gr.render{node = gr.sphere{}, projection = 'orthographic'}",
        "gr.render{node = gr.csg_intersection(gr.cube{}, gr.quadric{y = 1, constant = -0.5})}",
        "gr.render{node = gr.node('nothing')}",
    };
    static const char *const sizes[] = {"-q --size 80x45 scene.lua", "-q --size 30x90 scene.lua"};
    for (size_t i = 0; i < 2 * (sizeof scenes / sizeof *scenes); i++) {
        renders(scenes[i / 2], sizes[i % 2]);
        struct test_picture picture = test_read_picture(test_path("scene.png"));
        uint32_t w = picture.width, h = picture.height, inside = 0;
        for (uint32_t y = 0; y < h; y++) { /* its edges show background alone, which is the same along a row */
            const uint8_t *row = picture.rgb + (size_t)3 * w * y;
            for (uint32_t x = 0; x < w; x++) {
                bool differs = abs(row[(size_t)3 * x] - row[0]) > 12;
                inside += differs;
                if (differs && (x == w - 1 || y == 0 || y == h - 1))
                    test_fail(__FILE__, __LINE__, "%s: the scene is at %u %u", scenes[i / 2], x, y);
            }
        }
        if (inside == 0 && !strstr(scenes[i / 2], "nothing"))
            test_fail(__FILE__, __LINE__, "%s: nothing is seen", scenes[i / 2]);
        free(picture.rgb);
    }
}

TEST(an_endless_floor_does_not_move_the_fitted_camera) {
    int red[2] = {0};
    for (int k = 0; k < 2; k++) {
        char scene[300];
        (void)snprintf(scene, sizeof scene,
                       "local n = gr.node('n') n:add_child(gr.sphere{material = gr.material{kd = {1, 0, 0}}})\n"
                       "%s gr.render{node = n}",
                       k == 0 ? "" : "n:add_child(gr.quadric{y = 1, constant = 1})");
        renders(scene, "-q --size 96x54 scene.lua");
        struct test_picture picture = test_read_picture(test_path("scene.png"));
        for (const uint8_t *p = picture.rgb; p < picture.rgb + (size_t)3 * 96 * 54; p += 3)
            red[k] += p[0] > p[1] + 60;
        free(picture.rgb);
    }
    CHECK(red[0] > 500);
    CHECK_EQ_INT(red[0], red[1]);
}

TEST(the_studio_light_acts_only_where_a_picture_would_have_no_light) {
    static const char *const dark[] = {
        "gr.render{node = gr.sphere{}}",
        "gr.sphere{}:render{}",
        "gr.render{node = gr.sphere{}, file = 'x.png', width = 9, eye = {0, 0, 5}, integrator = 'path', spp = 1}",
        "gr.render{node = gr.sphere{material = gr.material{kd = {1, 0, 0}}}}",
        "gr.material{kd = {0, 0, 0}, emission = {9, 9, 9}} gr.render{node = gr.sphere{}}", /* it is not in the scene */
        "for i = 1, 3 do gr.render{node = gr.cube{}} end",
        "gr.frames{count = 2, draw = function() return {node = gr.sphere{}} end}",
    };
    static const char *const lit[] = {
        "gr.render{node = gr.sphere{}, lights = {}}",
        "gr.render{node = gr.sphere{}, lights = {gr.light{position = {0, 9, 9}, colour = {1, 1, 1}}}}",
        "gr.render{node = gr.sphere{}, ambient = {0, 0, 0}}",
        "gr.render{node = gr.sphere{}, background = 'gradient'}",
        "gr.render{node = gr.sphere{material = gr.material{kd = {0, 0, 0}, emission = {0, 0.1, 0}}}}",
        "gr.render{node = gr.sphere{material = gr.material{kd = {1, 0, 0}, lit = false}}}",
        "gr.render{node = gr.sphere{material = gr.openpbr_material{emission_luminance = 1}}}",
        "local n = gr.node('n') n:add_child(gr.sphere{}) local deep = gr.node('deep') n:add_child(deep)"
        "deep:add_child(gr.cube{material = gr.marble_pnd_material(gr.material{kd = {1, 1, 1}, lit = false}, .7, 8, 1, "
        "1,"
        "{.3, .3, .3})}) gr.render{node = n}",
        "gr.render{node = gr.csg_union(gr.cube{}, gr.sphere{material = gr.material{kd = {0, 0, 0},"
        "emission = {1, 1, 1}}})}",
        "gr.render(gr.sphere('ball'), 'x.png', 9, 9, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50)",
        "gr.render{node = gr.sphere{}} gr.render(gr.sphere('ball'), 'x.png', 9, 9, {0, 0, 5}, {0, 0, -1},"
        "{0, 1, 0}, 50)",
        "gr.frames{count = 2, draw = function() return {node = gr.sphere{}, lights = {}} end}",
    };
    for (size_t i = 0; i < sizeof dark / sizeof *dark; i++)
        if (!says_studio(dark[i]))
            test_fail(__FILE__, __LINE__, "%s: no studio light", dark[i]);
    for (size_t i = 0; i < sizeof lit / sizeof *lit; i++)
        if (says_studio(lit[i]))
            test_fail(__FILE__, __LINE__, "%s: studio light", lit[i]);
}

/* What a picture leaves out is what it could say. */
TEST(scenes_with_light_keep_their_bytes) {
#define BALL "local ball = gr.sphere{material = gr.material{kd = {.8, .3, .1}, ks = {.5, .5, .5}, shininess = 40}}\n"
#define FILE_AND_CAMERA "width = 48, height = 27, eye = {0, 1, 6}, target = {0, 0, 0}, fov = 30"
#define LIGHTS "lights = {gr.light{position = {5, 9, 9}, colour = {1, 1, 1}}}"
    renders(BALL "gr.render{node = ball, file = 'a.png', " FILE_AND_CAMERA ", " LIGHTS "}", "-q scene.lua");
    renders(BALL "gr.render{node = ball, " FILE_AND_CAMERA ", " LIGHTS "}", "-q scene.lua");
    CHECK(same_pictures("a.png", "scene.png"));
    /* The table after a positional form has the same fields; its background is the one that the table form gets. */
    renders(BALL "gr.render(ball, 'b.png', 48, 27, {0, 1, 6}, {0, -1, -6}, {0, 1, 0}, 30, {0, 0, 0}, {gr.light{"
                 "position = {5, 9, 9}, colour = {1, 1, 1}}}, {background = gr.sky_gradient{stops = {"
                 "{-1, .62, .61, .6}, {0, .8, .81, .82}, {1, .9, .93, .96}}}})",
            "-q scene.lua");
    CHECK(same_pictures("a.png", "b.png"));
    /* A picture without any light stays dark if it says so. */
    renders(BALL "gr.render{node = ball, file = 'c.png', " FILE_AND_CAMERA ", lights = {}}", "-q scene.lua");
    struct test_picture picture = test_read_picture(test_path("c.png"));
    CHECK_EQ_INT(picture.rgb[3 * (48 * 13 + 24)], 0);
    free(picture.rgb);
}

TEST(pictures_without_a_file_are_named_after_the_script) {
    renders("gr.render{node = gr.sphere{}, width = 16}", "-q scene.lua");
    struct test_picture picture = test_read_picture(test_path("scene.png"));
    CHECK_EQ_INT(picture.width, 16);
    CHECK_EQ_INT(picture.height, 9);
    free(picture.rgb);
    renders("gr.render{node = gr.sphere{}, height = 9} gr.cube{}:render{width = 8, height = 8}", "-q scene.lua");
    picture = test_read_picture(test_path("scene-1.png"));
    CHECK_EQ_INT(picture.width, 16);
    free(picture.rgb);
    CHECK(is_there("scene-2.png") && !is_there("scene-3.png"));
    renders("for i = 1, 3 do gr.render{node = gr.sphere{}, width = 8} end", "-q scene.lua");
    CHECK(is_there("scene-3.png") && !is_there("scene-4.png"));
    /* A number that the text does not promise. */
    renders("local function f() gr.render{node = gr.sphere{}, width = 8} end f() f() f() f()", "-q scene.lua");
    CHECK(is_there("scene-4.png"));
}

TEST(a_table_after_a_positional_form_has_only_fields_that_are_no_arguments) {
    static const char form[] = "gr.render(gr.sphere('ball'), 'x.png', 9, 9, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50,"
                               "{1, 1, 1}, {}, {%s})";
    static const struct {
        const char *fields, *says;
    } cases[] = {
        {"background = {1, 0, 0}, samples = 2", NULL},
        {"", NULL},
        {"backgruond = {1, 0, 0}", "gr.render: unknown field 'backgruond'; did you mean 'background'?"},
        {"fov = 40", "gr.render: fov is given twice, as an argument and as a field"},
        {"background = true", "gr.render: background must be a colour {r, g, b}, a sky, a function or 'gradient'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char scene[300];
        (void)snprintf(scene, sizeof scene, form, cases[i].fields);
        struct test_result result = test_gray_scene(scene, "-q scene.lua", NULL);
        CHECK_EQ_INT(result.status, cases[i].says ? 1 : 0);
        if (cases[i].says && !strstr(result.err, cases[i].says))
            test_fail(__FILE__, __LINE__, "%s: %s", scene, result.err);
        test_free_result(&result);
    }
}

TEST(tables_for_frames_have_the_light_background_of_the_table_form) {
    renders("gr.frames{count = 1, draw = function() return {node = gr.node('n'), width = 9, height = 1,"
            "eye = {0, 0, 5}, view = {0, 0, -1}, lights = {}} end}",
            "-q scene.lua");
    struct test_picture picture = test_read_picture(test_path("scene.0001.png"));
    CHECK(abs(picture.rgb[0] - 204) <= 2 && abs(picture.rgb[2] - 209) <= 2);
    free(picture.rgb);
}
