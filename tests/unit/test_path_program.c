/* One picture of paths, however the program makes it. */
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char scene[] =
    "local function matte(r, g, b) return gr.material {kd={r, g, b}, two_sided=true} end\n"
    "local room = gr.node 'room'\n"
    "room:add_child(gr.nh_sphere(matte(.7, .3, .2), {-.9, 0, 0}, 1))\n"
    "room:add_child(gr.nh_sphere(gr.material {kd={0, 0, 0}, ks={.9, .9, .9}, refract=1, ior=1.5}, {1.2, .2, .5}, .8))\n"
    "room:add_child(gr.box(matte(.6, .6, .6), {-4, -2, -4}, {4, -1, 4}))\n"
    "local lamp = gr.area_light {corner={-.5, 4, 2}, v1={1, 0, 0}, v2={0, 0, 1}, emission={8, 7, 6}}\n"
    "gr.render {node=room, file='out.pfm', width=100, height=70, integrator='path', spp=9, seed=3, eye={0, 1, 7},\n"
    "           view={0, -.1, -1}, fov=45, background={.1, .2, .4}, lights={lamp}}\n";

static char *picture(size_t *size) {
    char path[600];
    (void)snprintf(path, sizeof path, "%s/out.pfm", test_folder());
    char *bytes = test_read_file(path, size);
    (void)remove(path);
    return bytes;
}

static void run(const char *arguments) {
    struct test_result result = test_gray_scene(scene, arguments, NULL);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "%s: %s", arguments, result.err);
    free(result.out);
    free(result.err);
}

static void check_same(const char *arguments, const char *whole, size_t size) {
    size_t now = 0;
    char *bytes = picture(&now);
    if (!bytes || now != size || memcmp(bytes, whole, size) != 0)
        test_fail(__FILE__, __LINE__, "%s makes another picture", arguments);
    free(bytes);
}

static void check_runs(const char *common, const char *const runs[], size_t count) {
    char line[300];
    size_t size = 0;
    (void)snprintf(line, sizeof line, "-q -j 1 %s scene.lua", common);
    run(line);
    char *whole = picture(&size);
    CHECK(whole && size > (size_t)100 * 70 * 12);
    for (size_t i = 0; i < count; i++) {
        (void)snprintf(line, sizeof line, "-q %s %s scene.lua", common, runs[i]);
        run(line);
        check_same(line, whole, size);
    }
    (void)snprintf(line, sizeof line, "-q %s --shard 1/2 scene.lua", common);
    run(line);
    (void)snprintf(line, sizeof line, "-q %s --shard 2/2 scene.lua", common);
    run(line);
    run("-q merge out.pfm.1-of-2.part out.pfm.2-of-2.part");
    check_same("merge", whole, size);
    free(whole);
}

TEST(a_picture_of_paths_is_the_same_by_threads_instruction_sets_displays_checkpoints_and_shards) {
    static const char *const runs[] = {"-j 3", "-j 2 --isa base", "-j 2 --display term:blocks",
                                       "-j 2 --checkpoint c.tiles", "--accel grid"};
    check_runs("", runs, sizeof runs / sizeof *runs);
}

TEST(a_picture_of_paths_with_a_noise_and_a_filter_is_the_same_by_threads_displays_and_shards) {
    static const char *const runs[] = {"-j 3",
                                       "-j 2 --display term:blocks",
                                       "-j 2 --partial",
                                       "-j 2 --progress=json",
                                       "-j 2 --checkpoint c.tiles",
                                       "--time-limit 1000"};
    check_runs("--noise 0.1 --spp 64 --filter mitchell --caustics 2000", runs, sizeof runs / sizeof *runs);
}

/* The brightest paths come first, each with the surfaces that it met. */
TEST(a_path_traced_pixel_is_explained_by_its_mean_its_error_and_its_brightest_paths) {
    struct test_result result = test_gray_scene(scene, "--pixel 30,38 --spp 32 scene.lua", NULL);
    double before = INFINITY, colour;
    int count = 0, vertices = 0;
    CHECK_EQ_INT(result.status, 0);
    CHECK(strstr(result.out, "standard error") && strstr(result.out, "of 32 samples;"));
    CHECK(strstr(result.out, "light 1, area light at "));
    CHECK(!strstr(result.out, "ambient"));
    for (const char *at = result.out; (at = strstr(at, "\n  colour (")) != NULL; at++, count++) {
        double r = 0, g = 0, b = 0;
        CHECK_EQ_INT(sscanf(at, "\n  colour (%lf, %lf, %lf)", &r, &g, &b), 3);
        colour = r + g + b;
        CHECK(colour <= before * (1 + 1e-5));
        before = colour;
    }
    for (const char *at = result.out; (at = strstr(at, ", reflected, weight ")) != NULL; at++)
        vertices++;
    CHECK_EQ_INT(count, 8);
    CHECK(vertices >= 8);
    free(result.out);
    free(result.err);
    result = test_gray_scene(scene, "--pixel 30,38 --noise 0.1 --spp 20 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK(strstr(result.out, "of 20 samples (--spp; --noise may need fewer)"));
    free(result.out);
    free(result.err);
}

/* The line names the file that is written. */
TEST(with_a_time_limit_a_line_names_the_picture_and_its_samples) {
    static const char frames[] =
        "local r = gr.node 'r'\n"
        "r:add_child(gr.sphere(gr.material {kd={1, 1, 1}}))\n"
        "gr.frames {count=2, draw=function(t) return {node=r, width=8, height=8, eye={0, 0, 5 + t},\n"
        "    integrator='path'} end}\n";
    static const struct {
        const char *scene, *arguments, *line;
    } cases[] = {{scene, "--time-limit 0.001 --spp 1 scene.lua", "scene.lua: out.pfm: 1 sample per pixel in"},
                 {scene, "--time-limit 0.001 --spp 1 -o a.pfm scene.lua", "scene.lua: a.pfm: 1 sample per pixel in"},
                 {scene, "--noise 9 --spp 16 -o a.pfm scene.lua", "scene.lua: a.pfm: 16.0 samples per pixel"},
                 {frames, "--time-limit 9 --spp 2 -o b%d.png scene.lua", "scene.lua: b2.png: 2 samples per pixel in"},
                 {frames, "--time-limit 9 --spp 2 scene.lua", "scene.lua: scene.0002.png: 2 samples per pixel in"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct test_result result = test_gray_scene(cases[i].scene, cases[i].arguments, NULL);
        CHECK_EQ_INT(result.status, 0);
        if (!strstr(result.err, cases[i].line))
            test_fail(__FILE__, __LINE__, "%s: not '%s' but: %s", cases[i].arguments, cases[i].line, result.err);
        free(result.out);
        free(result.err);
    }
}

TEST(an_option_that_a_field_overrides_has_one_notice) {
    static const char twice[] =
        "local r = gr.node 'r'\n"
        "r:add_child(gr.sphere(gr.material {kd={1, 1, 1}}))\n"
        "for i = 1, 2 do gr.render {node=r, file=i .. '.png', width=8, height=8, eye={0, 0, 5},\n"
        "    integrator='path', spp=2, exposure=1, full=true, specular='blinn'} end\n";
    static const struct {
        const char *arguments, *line;
    } cases[] = {{"--integrator path --integrator whitted scene.lua", "--integrator whitted has no effect"},
                 {"--exposure 0 scene.lua", "--exposure 0 has no effect"},
                 {"--specular phong scene.lua", "--specular phong has no effect"},
                 {"--integrator path --exposure 1 -full --spp 1 --max-depth 3 scene.lua", NULL},
                 {"-q --integrator whitted scene.lua", NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct test_result result = test_gray_scene(twice, cases[i].arguments, NULL);
        const char *notice = strstr(result.err, "has no effect");
        CHECK_EQ_INT(result.status, 0);
        if (cases[i].line)
            CHECK(strstr(result.err, cases[i].line) && notice && !strstr(notice + 1, "has no effect"));
        else
            CHECK(!notice);
        free(result.out);
        free(result.err);
    }
}
