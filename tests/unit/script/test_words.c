/* Short words for light and materials: gr.studio, gr.daylight, exposure = 'auto', a sky in one field, gr.mirror and its
 * like; and the forty materials of the library. */
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Without any message. */
static struct test_picture quiet_picture(const char *scene, const char *arguments, const char *name) {
    struct test_result result = test_gray_scene(scene, arguments, NULL);
    if (result.status != 0 || result.err[0] != '\0')
        test_fail(__FILE__, __LINE__, "%s: status %d, %s", scene, result.status, result.err);
    test_free_result(&result);
    return test_read_picture(test_path(name));
}

static double mean_of(const struct test_picture *picture, uint32_t y0, uint32_t y1) {
    size_t first = (size_t)3 * picture->width * y0, end = (size_t)3 * picture->width * y1;
    double sum = 0;
    for (size_t i = first; i < end; i++)
        sum += picture->rgb[i];
    return sum / (double)(end - first);
}

static void expect_error(const char *line, const char *says) {
    struct test_result result = test_gray_scene(line, "-q --check scene.lua", NULL);
    if (result.status != 1 || !strstr(result.err, says) || !strstr(result.err, "scene.lua:1: gr."))
        test_fail(__FILE__, __LINE__, "%s: %s", line, result.err);
    test_free_result(&result);
}

TEST(a_studio_is_lit_at_any_size_and_with_both_integrators) {
    static const char scene[] =
        "gr.render(gr.studio{node = gr.sphere{radius = R, material = gr.paint{}}, file = 'a.png', "
        "width = 48, height = 27, colour = 'linear'})";
    static const char *const arguments[] = {"-q -D R=1 scene.lua", "-q -D R=1024 scene.lua",
                                            "-q -D R=1 --integrator path --spp 16 scene.lua"};
    double means[3], floors[3];
    for (int i = 0; i < 3; i++) {
        struct test_picture picture = quiet_picture(scene, arguments[i], "a.png");
        means[i] = mean_of(&picture, 0, picture.height);
        floors[i] = mean_of(&picture, picture.height - 2, picture.height);
        free(picture.rgb);
    }
    CHECK(means[0] > 120 && means[0] < 235);
    CHECK(floors[0] > 120 && floors[0] < 235);
    CHECK(fabs(means[1] - means[0]) < 2);
    CHECK(fabs(means[2] - means[0]) < 25); /* with indirect light */
}

TEST(fields_of_a_picture_pass_through_words_and_have_priority) {
    struct test_picture picture = quiet_picture("gr.render(gr.studio{node = gr.node 'none', sweep = false, background "
                                                "= {0, 1, 0}, lights = {}, file = 'a.png', "
                                                "width = 4, height = 4})",
                                                "-q scene.lua", "a.png");
    CHECK(picture.rgb[0] == 0 && picture.rgb[1] == 255);
    free(picture.rgb);
    picture =
        quiet_picture("local ball = gr.sphere{material = gr.plastic{}}\n"
                      "gr.frames{count = 2, draw = function() return gr.daylight{node = ball, width = 8, height = 4, "
                      "exposure = -100} end}",
                      "-q -o a%d.png scene.lua", "a2.png");
    CHECK(mean_of(&picture, 0, 4) < 1);
    free(picture.rgb);
}

/* I. Reda and A. Andreas, "Solar Position Algorithm for Solar Radiation Applications", NREL 2004, its example; the
 * elevation is that without refraction. */
TEST(the_sun_of_daylight_is_where_a_published_table_has_it) {
    struct test_result result = test_gray_scene("gr.render(gr.daylight{node = gr.sphere{}, zone = -7,\n"
                                                "place = {39.742476, -105.1786}, time = {2003, 10, 17, 12, 30.5}})",
                                                "-q --dump-scene scene.lua", NULL);
    const char *at = strstr(result.out, "a lamp at (");
    double east = 0, up = 0, south = 0, degree = 3.14159265358979 / 180;
    CHECK(at && sscanf(at, "a lamp at (%lf, %lf, %lf)", &east, &up, &south) == 3);
    double length = sqrt(east * east + up * up + south * south);
    CHECK(fabs(asin(up / length) / degree - 39.872046) < 0.01);
    CHECK(fabs(atan2(east, -south) / degree + 360 - 194.340241) < 0.01);
    test_free_result(&result);
}

TEST(wrong_values_of_words_are_errors_that_say_what_is_right) {
    static const char *const wrong[][2] = {
        {"gr.studio{}", "gr.studio: node is missing"},
        {"gr.studio{node = gr.sphere{}, swep = true}", "unknown field 'swep'; did you mean 'sweep'?"},
        {"gr.studio{node = gr.sphere{}, widht = 7}", "unknown field 'widht'; did you mean 'width'?"},
        {"gr.daylight{sun = {azimuth = 3}}", "sun must be a direction {x, y, z} or {azimuth = ..., elevation = ...}"},
        {"gr.daylight{sun = {azimuth = 3, elevation = 95}}", "sun.elevation must be a number between -90 and 90"},
        {"gr.daylight{sun = {0, 0, 0}}", "sun must not be zero"},
        {"gr.glass{glass = 'F2', ior = 1.5}", "gr.glass: glass has an index of its own: ior is not needed"},
        {"gr.daylight{sun = {0, 1, 0}, place = 'rome'}", "sun excludes place, time and zone"},
        {"gr.daylight{time = {2025, 6, 21}}", "time and zone need place"},
        {"gr.daylight{place = 'lodnon'}", "place 'lodnon' is not known; there are berlin, cairo,"},
        {"gr.daylight{place = {95, 0}}", "place[1] must be a number from -90 to 90, not 95"},
        {"gr.daylight{place = 'rome', time = 12}", "time must be {year, month, day, hour, minute}"},
        {"gr.daylight{place = 'rome', time = {2025, 2, 29}}",
         "time[3], the day, must be a whole number from 1 to 28, not 29"},
        {"gr.daylight{place = 'rome', time = {2025, 2.5, 9}}", "time[2], the month, must be a whole number"},
        {"gr.daylight{place = 'rome', time = {2025, 4, 30, 25}}", "time[4], the hour, must be a number from 0 to 24"},
        {"gr.paint('#ff0000', 'glossy')", "finish must be 'matt', 'satin', 'gloss' or 'car', not 'glossy'"},
        {"gr.metal 'steel'", "metal must be"},
        {"gr.glass{ior = 0.5}", "ior must be between 1 and 4"},
        {"gr.render{node = gr.sphere{}, exposure = 'automatic'}", "exposure must be 'auto', not 'automatic'"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        expect_error(wrong[i][0], wrong[i][1]);
}

static const char metered[] =
    "local s = gr.node{children = {gr.plane{normal = {0, 1, 0}, material = gr.paint{}},\n"
    "    gr.sphere{centre = {0, 1, 0}, material = gr.plastic '#c03020'}}}\n"
    "gr.render{node = s, file = 'whole.png', width = 80, height = 60, eye = {0, 2, 8}, view = {0, -0.1, -1},\n"
    "    sky = gr.clear_sky{hour = 9, intensity = 0.01}, exposure = 'auto', spp = 4, integrator = 'path'}";

TEST(a_light_meter_gives_the_same_bytes_for_any_threads_shards_and_crop) {
    struct test_picture whole = quiet_picture(metered, "-q -j 1 scene.lua", "whole.png");
    CHECK(mean_of(&whole, 0, 60) > 90); /* else it is nearly black */
    size_t size, other_size;
    char *bytes = test_read_file(test_path("whole.png"), &size);
    static const char *const others[] = {"-q -j 3 -o threads.png scene.lua", "-q --shard 1/2 -o part.png scene.lua",
                                         "-q --shard 2/2 -o part.png scene.lua",
                                         "merge -q -o merged.png part.png.1-of-2.part part.png.2-of-2.part"};
    for (int i = 0; i < 4; i++) {
        struct test_result result = test_gray(test_folder(), others[i]);
        if (result.status != 0)
            test_fail(__FILE__, __LINE__, "%s: %s", others[i], result.err);
        test_free_result(&result);
    }
    CHECK(test_same_files("whole.png", "threads.png"));
    char *merged = test_read_file(test_path("merged.png"), &other_size);
    CHECK(merged && other_size == size && memcmp(merged, bytes, size) == 0);
    struct test_picture part = quiet_picture(metered, "-q --crop 30,20,11,7 -o crop.png scene.lua", "crop.png");
    for (uint32_t y = 0; y < 7; y++)
        CHECK(memcmp(part.rgb + (size_t)33 * y, whole.rgb + (size_t)3 * (80 * (20 + y) + 30), 33) == 0);
    free(bytes);
    free(merged);
    free(part.rgb);
    free(whole.rgb);
}

TEST(a_light_meter_evens_out_the_strength_of_light) {
    static const char *const scenes[] = {
        "gr.render{node = gr.sphere{material = gr.paint{}}, sky = gr.sky_gradient{stops = {{0, 1, 1, 1}}, intensity = "
        "1e-3},"
        " exposure = 'auto', width = 32, height = 24, file = 'a.png'}",
        "gr.render{node = gr.sphere{material = gr.paint{}}, sky = gr.sky_gradient{stops = {{0, 1, 1, 1}}, intensity = "
        "1e3},"
        " exposure = 'auto', width = 32, height = 24, file = 'a.png'}",
    };
    double means[2];
    for (int i = 0; i < 2; i++) {
        struct test_picture picture = quiet_picture(scenes[i], "-q scene.lua", "a.png");
        means[i] = mean_of(&picture, 0, 24);
        free(picture.rgb);
    }
    CHECK(fabs(means[0] - means[1]) < 3 && means[0] > 120);
    struct test_result nothing = test_gray_scene(
        "gr.render{node = gr.node 'none', background = {0, 0, 0}, width = 8, height = 8, exposure = 'auto'}",
        "-q scene.lua", NULL);
    CHECK_EQ_INT(nothing.status, 0); /* no light: 0 stops */
    test_free_result(&nothing);
}

TEST(a_sky_in_one_field_is_background_and_light) {
    static const char *const scenes[] = {
        ("local sky = gr.sky_map{image = 'wide.pfm'} gr.render{node = gr.sphere{material = gr.paint{}}, "
         "background = sky, lights = {gr.sky_light{sky = sky}}, file = 'a.png', width = 20, height = 20}"),
        "gr.render{node = gr.sphere{material = gr.paint{}}, sky = 'wide.pfm', file = 'b.png', width = 20, height = 20}",
        ("gr.render{node = gr.sphere{material = gr.paint{}}, sky = gr.sky_map{image = 'wide.pfm'}, file = 'b.png', "
         "width = 20, height = 20}"),
    };
    float wide[4 * 8 * 3];
    char file[sizeof wide + 32];
    for (int i = 0; i < 4 * 8 * 3; i++)
        wide[i] = i > 48 ? 0.9F : 0.2F;
    int head = snprintf(file, sizeof file, "PF\n8 4\n-1.0\n");
    memcpy(file + head, wide, sizeof wide);
    test_write_file(test_path("wide.pfm"), file, (size_t)head + sizeof wide);
    for (int i = 0; i < 4; i++) {
        const char *arguments = i < 2 ? "-q scene.lua" : "-q --integrator path --spp 4 scene.lua";
        struct test_picture a = quiet_picture(scenes[0], arguments, "a.png");
        struct test_picture b = quiet_picture(scenes[1 + i % 2], arguments, "b.png");
        CHECK(memcmp(a.rgb, b.rgb, 1200) == 0);
        CHECK(mean_of(&a, 10, 11) > 40);
        free(a.rgb);
        free(b.rgb);
    }
}

/* In a white sky of radiance 1 every pixel is at most 1, which is 128 here; a little more, and a pixel in a thousand,
 * is noise. */
static void check_furnace(const char *materials, const char *arguments, int limit) {
    char scene[2048];
    (void)snprintf(scene, sizeof scene,
                   "local list, s = %s, gr.node 'furnace'\n"
                   "for k, m in ipairs(list) do\n"
                   "    s:add_child(gr.sphere{material = m, centre = {k %% 8 * 2.2, k // 8 * 2.2, 0}})\n"
                   "end\n"
                   "gr.render{node = s, width = 96, height = 72, projection = 'orthographic', view = {0, 0, -1},\n"
                   "    sky = gr.sky_gradient{{0, 1, 1, 1}}, exposure = -1, colour = 'linear', srgb = false,\n"
                   "    file = 'a.png'}",
                   materials);
    struct test_picture picture = quiet_picture(scene, arguments, "a.png");
    int above = 0;
    for (size_t i = 0; i < (size_t)3 * 96 * 72; i++)
        above += picture.rgb[i] > limit;
    if (above > 24 || mean_of(&picture, 0, 72) > 128.1)
        test_fail(__FILE__, __LINE__, "%s, %s: %d numbers above %d, mean %g", materials, arguments, above, limit,
                  mean_of(&picture, 0, 72));
    CHECK(mean_of(&picture, 0, 72) > 60);
    free(picture.rgb);
}

static const char white_words[] =
    "(function() local w = {1, 1, 1} return {gr.mirror(w), gr.mirror(w, 0.4), gr.glass(), gr.glass(nil, 0.4), "
    "gr.glass{thin = true}, gr.metal{colour = w}, gr.metal{colour = w, roughness = 0.6, brushed = 0.8}, gr.metal "
    "'gold', "
    "gr.plastic(w), gr.plastic(w, 0), gr.plastic(w, 1), gr.paint(w, 'matt'), gr.paint(w, 'satin'), gr.paint(w, "
    "'gloss'), "
    "gr.paint(w, 'car'), gr.cloth(w), gr.cloth(w, 'velvet'), gr.cloth(w, 'silk'), gr.plastic(function(p) return w "
    "end)} "
    "end)()";

TEST(short_materials_reflect_no_more_light_than_arrives_with_both_integrators) {
    check_furnace(white_words, "-q --integrator whitted -ss 2 scene.lua", 136);
    check_furnace(white_words, "-q --integrator path --spp 64 scene.lua", 160);
}

TEST(forty_materials_render_without_warnings_and_reflect_no_more_light_than_arrives) {
    static const char all[] = "(function() local m, t = require 'materials', {} for k, name in ipairs(m.names()) do\n"
                              "t[k] = m.named(name) end assert(#t == 40) return t end)()";
    check_furnace(all, "-q --integrator whitted -ss 1 scene.lua", 136);
    check_furnace(all, "-q --integrator path --spp 16 scene.lua", 150);
}

TEST(materials_are_found_by_name) {
    struct test_result result = test_gray_scene("require('materials').named 'oack'", "-q scene.lua", NULL);
    CHECK(result.status == 1);
    CHECK(strstr(result.err, "scene.lua:1: materials.named: there is no material 'oack'; did you mean 'oak'?"));
    test_free_result(&result);
}

/* Whitted's integrator with classic = true and without: about as bright. */
TEST(classic_layers_resemble_the_layers) {
    static const char scene[] = "gr.render(gr.studio{node = gr.sphere{material = gr.openpbr_material{base_color = "
                                "{0.6, 0.3, 0.1}, coat_weight = 1,\n"
                                "classic = C}}, file = 'a.png', width = 24, height = 24, colour = 'linear'})";
    double means[2];
    for (int i = 0; i < 2; i++) {
        struct test_picture picture =
            quiet_picture(scene, i == 0 ? "-q -D C=true scene.lua" : "-q -D C=false scene.lua", "a.png");
        means[i] = mean_of(&picture, 0, 24);
        free(picture.rgb);
    }
    CHECK(fabs(means[0] - means[1]) < 12);
    struct test_result traced = test_gray_scene("gr.render{node = gr.sphere{material = gr.plastic{}}, eye = {0, 0, 4}, "
                                                "lights = {gr.light({0, 0, 9}, {1, 1, 1})}, "
                                                "width = 9, height = 9}",
                                                "-q --pixel 4,4 scene.lua", NULL);
    CHECK_EQ_INT(traced.status, 0);
    CHECK(strstr(traced.out, "openpbr") && strstr(traced.out, "phong"));
    test_free_result(&traced);
}

static struct test_picture metal_picture(const char *colour) {
    char scene[512];
    (void)snprintf(scene, sizeof scene,
                   "gr.render{node = gr.sphere{material = gr.metal{colour = %s, roughness = 0}}, eye = {0, 0, 4},\n"
                   "sky = gr.clear_sky{hour = 9}, file = 'a.png', width = 16, height = 16, colour = 'linear'}",
                   colour);
    return quiet_picture(scene, "-q scene.lua", "a.png");
}

TEST(the_texture_of_a_classic_metal_colours_its_reflections) {
    struct test_picture texture = metal_picture("'#bc8040'"), number = metal_picture("gr.linear '#bc8040'");
    CHECK(memcmp(texture.rgb, number.rgb, 768) == 0);
    const uint8_t *middle = texture.rgb + (size_t)3 * (16 * 8 + 8);
    CHECK(middle[0] > middle[2] + 40);
    free(texture.rgb);
    free(number.rgb);
}
