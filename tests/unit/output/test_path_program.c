/* One picture of paths, however the program makes it. */
#define _GNU_SOURCE
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
    const char *path = test_path("out.pfm");
    char *bytes = test_read_file(path, size);
    (void)remove(path);
    return bytes;
}

static void run(const char *arguments) {
    struct test_result result = test_gray_scene(scene, arguments, NULL);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "%s: %s", arguments, result.err);
    test_free_result(&result);
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
    test_free_result(&result);
    result = test_gray_scene(scene, "--pixel 30,38 --noise 0.1 --spp 20 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK(strstr(result.out, "of 20 samples (--spp; --noise may need fewer)"));
    test_free_result(&result);
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
        test_free_result(&result);
    }
}

/* The notices of three pictures with fields; each picture has the bytes of a scene whose fields are the options. */
#define PICTURES                                                                                                       \
    "local r = gr.node 'r'\n"                                                                                          \
    "r:add_child(gr.sphere(gr.material {kd={1, 1, 1}, refract=1, ior=1.5}))\n"                                         \
    "for i = 1, 3 do gr.render {node=r, file=i .. '.pfm', width=16, height=12, eye={0, 0, 5}"
#define FIELDS                                                                                                         \
    ", integrator='whitted', style=i == 1 and 'ink' or 'none', samples=5, full=i ~= 2, exposure=1, specular='blinn',"  \
    " spp=3, denoise=true, seed=4, caustics={photons=1000, radius=.2}, tone=function(x) return x end"
#define PICTURES_END "} end\n"

/* The bytes of the three pictures, and what was said. */
static char *three_pictures(const char *script, const char *arguments, char **said, size_t *size) {
    struct test_result result = test_gray_scene(script, arguments, NULL);
    char *all = NULL;
    *size = 0;
    CHECK_EQ_INT(result.status, 0);
    for (int i = 1; i <= 3; i++) {
        char path[600];
        size_t length = 0;
        (void)snprintf(path, sizeof path, "%s/%d.pfm", test_folder(), i);
        char *bytes = test_read_file(path, &length);
        CHECK(bytes != NULL);
        all = realloc(all, *size + length);
        memcpy(all + *size, bytes, length);
        *size += length;
        (void)remove(path);
        free(bytes);
    }
    free(result.out);
    *said = result.err;
    return all;
}

/* Leaves out the lines about the scene itself: that it has no light, and fields without effect. */
static void leave_out_notices(char *text) {
    char *to = text;
    for (char *line = text; *line;) {
        size_t length = strcspn(line, "\n") + 1;
        bool is_about_scene = memmem(line, length, " no effect", 10) || memmem(line, length, "of a studio", 11);
        if (!is_about_scene) {
            memmove(to, line, length);
            to += length;
        }
        line += length;
    }
    *to = '\0';
}

/* The first scene with these options makes the pictures of the second one without, and says only these lines about
 * them. */
static void same_pictures(const char *script, const char *options, const char *other, const char *lines) {
    char arguments[200], *said, *nothing;
    size_t size, size_of_other;
    (void)snprintf(arguments, sizeof arguments, "--progress none %s scene.lua", options);
    char *bytes = three_pictures(script, arguments, &said, &size);
    char *bytes_of_other = three_pictures(other, "-q scene.lua", &nothing, &size_of_other);
    leave_out_notices(said);
    CHECK_TEXT(said, lines);
    if (size != size_of_other || memcmp(bytes, bytes_of_other, size) != 0)
        test_fail(__FILE__, __LINE__, "%s does not make the pictures of its fields", options);
    free(bytes);
    free(bytes_of_other);
    free(said);
    free(nothing);
}

#define SCENE_WITH(...) PICTURES FIELDS __VA_ARGS__ PICTURES_END

TEST(an_option_wins_over_the_field_in_every_picture) {
    static const char script[] = SCENE_WITH("");
    same_pictures(script, "--integrator path --spp 2 --denoise=none",
                  SCENE_WITH(", integrator='path', style='none', spp=2, denoise=false"),
                  "scene.lua: --integrator path replaces the fields integrator and style of 3 pictures\n"
                  "scene.lua: --spp 2 replaces the field spp of 3 pictures\n"
                  "scene.lua: --denoise=none replaces the field denoise of 3 pictures\n");
    same_pictures(script, "-full=no -ss 2", SCENE_WITH(", full=false, samples=2"),
                  "scene.lua: -ss 2 replaces the field samples of 3 pictures\n"
                  "scene.lua: -full=no replaces the field full of 2 pictures\n");
    same_pictures(script, "--full", SCENE_WITH(", full=true"),
                  "scene.lua: -full replaces the field full of 1 picture\n");
    same_pictures(script, "--caustics 0 --tone none", SCENE_WITH(", caustics=0, tone='none'"),
                  "scene.lua: --tone none replaces the field tone of 3 pictures\n"
                  "scene.lua: --caustics 0 replaces the field caustics of 3 pictures\n");
    same_pictures(script, "--style toon", SCENE_WITH(", style='toon'"),
                  "scene.lua: --style toon replaces the field style of 3 pictures\n");
    same_pictures(SCENE_WITH(", integrator='path', style='none'"), "--style toon", SCENE_WITH(", style='toon'"),
                  "scene.lua: --style toon replaces the fields style and integrator of 3 pictures\n");
    /* Equal values, the field seed, and what -q silences. */
    same_pictures(script, "--exposure 1 --specular blinn -ss 5 --seed 9 --denoise=auto", script, "");
    same_pictures(script, "-q -ss 2", SCENE_WITH(", samples=2"), "");
}

TEST(fields_that_exclude_each_other_are_an_error_unless_one_has_priority) {
    static const char plain[] = PICTURES PICTURES_END;
    static const char *const errors[] = {"--integrator path --style ink scene.lua",
                                         "--default integrator=path --default style=ink scene.lua"};
    for (int i = 0; i < 2; i++) {
        struct test_result result = test_gray_scene(plain, errors[i], NULL);
        CHECK_EQ_INT(result.status, 1);
        CHECK(strstr(result.err, "styles are for the integrator 'whitted', not for 'path'"));
        test_free_result(&result);
    }
    same_pictures(plain, "--default integrator=path --style ink", PICTURES ", style='ink'" PICTURES_END, "");
    same_pictures(PICTURES ", integrator='path', spp=2" PICTURES_END, "--default style=ink",
                  PICTURES ", integrator='path', spp=2" PICTURES_END, "");
}

TEST(a_default_is_for_pictures_whose_script_does_not_set_the_field) {
    static const char plain[] = PICTURES PICTURES_END, script[] = SCENE_WITH("");
    same_pictures(plain, "--default samples=2 --default=full=yes --default seed=7",
                  PICTURES ", samples=2, full=true, seed=7" PICTURES_END, "");
    same_pictures(script, "--default samples=2 --default full=no --default denoise=none --default caustics=9", script,
                  "");
    same_pictures(PICTURES ", integrator='path', spp=2, denoise=true" PICTURES_END, "--default denoise=none",
                  PICTURES ", integrator='path', spp=2, denoise=true" PICTURES_END, "");
    same_pictures(plain, "--default integrator=path --default spp=2 --default srgb=no --spp 3",
                  PICTURES ", integrator='path', spp=3, srgb=false" PICTURES_END, "");
}

/* The count includes all runs of a script and all pictures of a call. */
TEST(a_notice_of_an_option_counts_the_pictures_of_an_animation) {
    static const char call[] = "local r = gr.node 'r'\n"
                               "r:add_child(gr.sphere(gr.material {kd={1, 1, 1}}))\n"
                               "gr.render {node=r, file='a%d.png', width=4, height=3, eye={0, 0, 5}, samples=5}\n";
    static const char *const runs[] = {"--frames 2-4 -ss 2 -o b%d.png scene.lua",
                                       "--turntable 3 -ss 2 -o c%d.png scene.lua"};
    for (int i = 0; i < 2; i++) {
        struct test_result result = test_gray_scene(call, runs[i], NULL);
        CHECK_EQ_INT(result.status, 0);
        CHECK(strstr(result.err, "scene.lua: -ss 2 replaces the field samples of 3 pictures\n"));
        test_free_result(&result);
    }
}
