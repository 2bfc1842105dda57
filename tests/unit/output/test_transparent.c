/* background = 'transparent': alpha of both integrators, against closed forms and against pictures with a background.
 */
#include "tests/harness.h"

#include "base/error.h"
#include "image/exr.h"
#include "image/image.h"

#include <stdio.h>

/* Emissive balls, one behind a sheet of holes, under the options; BG, or transparent. */
static const char balls[] =
    "local sheet = gr.material{kd = {0, 0, 0}, emission = {.2, .3, .1}, opacity = .25}\n"
    "local paint = gr.material{kd = {0, 0, 0}, emission = {.7, .4, .2}}\n"
    "local scene = gr.node{name = 'scene', children = {\n"
    "    gr.sphere{material = paint, centre = {-1, 0, 0}}, gr.sphere{material = paint, centre = {.9, .3, -1}},\n"
    "    gr.mesh{material = sheet, verts = {{0, -1, 1}, {2, -1, 1}, {2, .5, 1}, {0, .5, 1}}, faces = {{0, 1, 2, "
    "3}}}}}\n"
    "gr.render{node = scene, file = 'out.png', width = 70, height = 50, eye = {0, 0, 6}, fov = 40, colour = "
    "'classic',\n"
    "    lights = {}, spp = 16, background = BG or 'transparent'}\n";

static struct image *read_picture(const char *name) {
    struct error error;
    struct image *image = image_read(test_path(name), &error);
    if (!image)
        test_fail(__FILE__, __LINE__, "%s: %s", name, error.text);
    return image;
}

/* A square covers the left half of the picture and half of the pixels of column 3. */
TEST(a_square_over_half_of_a_pixel_has_alpha_one_half) {
    static const char scene[] =
        "local paint = gr.material{kd = {0, 0, 0}, emission = {.5, .25, .75}}\n"
        "local square = gr.mesh(paint, {{-9, -9, 0}, {-.25, -9, 0}, {-.25, 9, 0}, {-9, 9, 0}}, {{0, 1, 2, 3}})\n"
        "gr.render{node = square, file = 'out.png', width = 8, height = 8, projection = 'orthographic',\n"
        "    view_height = 4, eye = {0, 0, 5}, colour = 'classic', lights = {}, samples = 4, spp = 64,\n"
        "    background = 'transparent'}\n";
    static const char *const options[] = {"", "-full", "--integrator path", "--integrator path --noise 0.01"};
    static const double alpha[] = {1, 1, 1, 0.5, 0, 0, 0, 0};
    for (size_t k = 0; k < sizeof options / sizeof *options; k++) {
        char arguments[128];
        (void)snprintf(arguments, sizeof arguments, "-q --force %s scene.lua", options[k]);
        struct test_result result = test_gray_scene(scene, arguments, NULL);
        CHECK_EQ_INT(result.status, 0);
        test_free_result(&result);
        struct image *image = read_picture("out.png");
        for (uint32_t x = 0; image && x < 8; x++) {
            struct rgba texel = image_texel(image, x, 4);
            CHECK_NEAR(texel.a, alpha[x], 0.003);
            CHECK_NEAR(texel.b, alpha[x] > 0 ? 0.75 : 0, 0.003);
        }
        image_release(image);
    }
}

/* The transparent picture over the background is the picture with the background. */
static void check_composition(const char *options) {
    static const double behind[3] = {0.2, 0.4, 0.6};
    char line[512];
    (void)snprintf(line, sizeof line,
                   "$gray -q --force %s scene.lua -o clear.png && $gray -q --force %s -D 'BG={.2, .4, .6}' scene.lua",
                   options, options);
    test_shell(line, 0, NULL);
    struct image *clear = read_picture("clear.png"), *whole = read_picture("out.png");
    uint32_t parts = 0;
    for (uint32_t i = 0; clear && whole && i < 70 * 50; i++) {
        struct rgba a = image_texel(clear, i % 70, i / 70), b = image_texel(whole, i % 70, i / 70);
        const double over[3] = {a.r, a.g, a.b}, seen[3] = {b.r, b.g, b.b};
        for (int c = 0; c < 3; c++)
            CHECK_NEAR(a.a * over[c] + (1 - a.a) * behind[c], seen[c], 2.1 / 255);
        parts += a.a > 0 && a.a < 1;
    }
    CHECK(parts > 50);
    image_release(clear);
    image_release(whole);
}

TEST(a_transparent_picture_over_a_colour_is_the_picture_with_that_background) {
    test_write_text(test_path("scene.lua"), balls);
    check_composition("-full");
    check_composition("-full --line-width 2");
    check_composition("--integrator path");
    check_composition("--integrator path --filter gaussian");
    check_composition("--integrator path --line-width 2 --aov all");
}

TEST(a_transparent_picture_has_its_bytes_for_any_threads_parts_and_runs) {
    static const char *const options[] = {"", "--integrator path", "--integrator path --denoise"};
    test_write_text(test_path("scene.lua"), balls);
    for (size_t k = 0; k < sizeof options / sizeof *options; k++) {
        char line[1024];
        (void)snprintf(
            line, sizeof line,
            "o='-q --force %s scene.lua'; $gray $o -j 1 -o one.png && $gray $o -j 3 && cmp one.png out.png && "
            "for i in 1 2; do $gray $o --shard $i/2 || exit 3; done; rm out.png; $gray merge -q *.part && "
            "cmp one.png out.png && rm *.part",
            options[k]);
        test_shell(line, 0, NULL);
    }
}

TEST(colours_of_exr_files_are_multiplied_by_alpha_and_files_without_alpha_are_refused) {
    test_write_text(test_path("scene.lua"), balls);
    test_shell_errors("$gray -q scene.lua -o x.pfm", 1,
                      "x.pfm: background 'transparent' needs a file with alpha: .png or .exr");
    test_shell_errors("$gray -q scene.lua -o x.gif", 1, "background 'transparent' needs a file with alpha");
    if (!exr_can_write())
        test_lacks("OpenEXR");
    test_shell("$gray -q scene.lua -o out.exr && head -c 600 out.exr | tr -d '\\000\\n' | LC_ALL=C grep -aq "
               "'chlist.*A.*B.*G.*R'",
               0, NULL);
    struct image *light = read_picture("out.exr");
    /* Far from the balls nothing is seen. */
    CHECK(light && image_texel(light, 0, 0).r == 0 && image_texel(light, 0, 0).b == 0);
    image_release(light);
}

TEST(mirrors_see_the_background_that_a_transparent_picture_would_have) {
    static const char scene[] =
        "local mirror = gr.material{kd = {0, 0, 0}, ks = {1, 1, 1}, reflect = 1}\n"
        "gr.render{node = gr.sphere{material = mirror}, file = 'out.png', width = 20, height = 20, eye = {0, 0, 5},\n"
        "    fov = 40, lights = {}, background = 'transparent'}\n";
    test_write_text(test_path("scene.lua"), scene);
    test_shell("$gray -q scene.lua", 0, NULL);
    struct image *image = read_picture("out.png");
    struct rgba middle = image_texel(image, 10, 10), corner = image_texel(image, 0, 0);
    CHECK(middle.a == 1 && middle.r > 0.3 && middle.b > 0.3);
    CHECK(corner.a == 0);
    image_release(image);
}
