/* Light that glass divides by its wavelength: white stays white where nothing separates the colours, and what is
 * separated adds up to white. */
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/path_estimate.h"

#include "film/path_film.h"
#include "material/openpbr.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Rough or smooth glass, strongly dispersive. */
static struct material *flint(struct stage *s, bool layered, double roughness) {
    struct material *glass = stage_glass(s, 0, 1, 1.7);
    glass->phong.dispersion = (struct dispersion){0.08, 0};
    glass->phong.roughness = roughness;
    glass->fresnel = !layered;
    if (layered) {
        struct openpbr *numbers = arena_alloc(&s->scene.arena, sizeof *numbers);
        *numbers = openpbr_defaults();
        numbers->specular_ior = 1.7;
        glass->openpbr = numbers;
        glass->phong.kd = colour_all(1);
    }
    return glass;
}

static void begin(struct stage *s) {
    stage_begin(s, 1);
    s->settings.integrator = INTEGRATOR_PATH;
    s->sky.colour = colour_all(1);
}

static void check_white(const char *claim, struct stage *s, const struct effort *effort, double precision) {
    static const char *const channels[] = {"red", "green", "blue"};
    for (int seed = 1; seed <= effort->seeds; seed++) {
        for (int c = 0; c < 3; c++) {
            char text[128];
            (void)snprintf(text, sizeof text, "%s, %s", claim, channels[c]);
            struct estimate e = c == 0 ? estimate_render(s, effort, 1000, seed) : estimate_of(s, c);
            estimate_check(text, 1, e, seed, precision);
        }
    }
}

TEST_TIMES(a_pane_of_dispersive_glass_shows_white_for_white, 16) {
    const struct effort effort = {ESTIMATE_SIZE_MAX, times > 1 ? 1024 : 64, times > 1 ? 3 : 1};
    for (int layered = 0; layered < 2; layered++) {
        struct stage s;
        begin(&s);
        struct node *pane = stage_cube(&s, s.root, flint(&s, layered, 0));
        stage_scale(&s, pane, 60, 60, 1);
        stage_move(&s, pane, -30, -30, -1);
        stage_rotate(&s, pane, 1, 30);
        check_white(layered ? "pane of layered flint" : "pane of classic flint", &s, &effort,
                    times > 1 ? 0.001 : 0.005);
        stage_end(&s);
    }
}

/* The furnace of a ball, which separates the colours: each is as bright as before. */
TEST_TIMES(a_ball_of_dispersive_glass_is_invisible_in_white_light, 16) {
    /* Rough glass keeps few paths for long, which are bright. */
    const struct effort smooth = {ESTIMATE_SIZE_MAX, times > 1 ? 2048 : 128, times > 1 ? 3 : 1};
    const struct effort facets = {ESTIMATE_SIZE_MAX, 256, 1};
    for (int rough = 0; rough < 2; rough++) {
        struct stage s;
        begin(&s);
        (void)stage_sphere(&s, s.root, flint(&s, true, rough ? 0.2 : 0));
        s.camera.fov = 10;
        if (rough)
            check_white("ball of rough flint", &s, &facets, 0.015);
        else
            check_white("ball of flint", &s, &smooth, times > 1 ? 0.001 : 0.004);
        stage_end(&s);
    }
}

/* The guides of the denoiser see a wall behind flint in its own colour, whatever wavelengths the paths have. */
TEST(denoisers_see_what_is_behind_dispersive_glass_without_its_colours) {
    struct stage s;
    begin(&s);
    struct node *pane = stage_cube(&s, s.root, flint(&s, true, 0));
    struct node *wall = stage_cube(&s, s.root, stage_phong(&s, colour_make(0.6, 0.5, 0.4), colour_all(0), 1));
    stage_scale(&s, pane, 60, 60, 1);
    stage_move(&s, pane, -30, -30, -1);
    stage_scale(&s, wall, 60, 60, 1);
    stage_move(&s, wall, -30, -30, -6);
    s.settings.denoise = DENOISER_GRAY;
    s.settings.path_samples = 64;
    CHECK(stage_render(&s, 8, 8));
    for (size_t i = 0; i < 64; i++) {
        struct path_pixel pixel = path_film_load(&s.film, i);
        double r = path_pixel_feature(&pixel, 0, PATH_ALBEDO), b = path_pixel_feature(&pixel, 0, PATH_ALBEDO + 2);
        /* The first reflection of the pane has no colour, either. */
        CHECK(r > 0.4 && b > 0.2 && r / b > 1.2 && r / b < 1.6);
    }
    stage_end(&s);
}

/* A lamp above a slab, and the floor below it: the light of photons has the same mean with and without dispersion. */
static struct colour light_below(double amount, int photons) {
    struct stage s;
    struct colour sum = {0, 0, 0};
    begin(&s);
    s.sky.colour = colour_all(0);
    struct material *glass = flint(&s, false, 0), *white = stage_phong(&s, colour_all(0.8), colour_all(0), 1);
    glass->phong.dispersion.amount = amount;
    struct node *slab = stage_cube(&s, s.root, glass), *floor = stage_cube(&s, s.root, white);
    stage_scale(&s, slab, 4, 1, 4);
    stage_move(&s, slab, -2, 1, -2);
    stage_scale(&s, floor, 20, 1, 20);
    stage_move(&s, floor, -10, -1, -10);
    stage_point_light(&s, vec3_make(0, 6, 0), colour_all(40));
    s.settings.caustics.photons = photons;
    s.settings.path_samples = 16;
    s.camera = (struct camera){{0, 0.9, 3}, {0, -0.6, -1}, {0, 1, 0}, 40};
    CHECK(stage_render(&s, 16, 16));
    for (uint32_t i = 0; i < 256; i++)
        sum = colour_add_scaled(sum, stage_pixel(&s, i % 16, i / 16), 1.0 / 256);
    stage_end(&s);
    return sum;
}

TEST_TIMES(photons_of_all_wavelengths_together_are_white, 16) {
    int photons = 100000 * times;
    double precision = times > 1 ? 0.015 : 0.06;
    struct colour plain = light_below(0, photons), split = light_below(0.08, photons);
    CHECK(plain.g > 0.01);
    CHECK_NEAR(split.r / plain.r, 1, precision);
    CHECK_NEAR(split.g / plain.g, 1, precision);
    CHECK_NEAR(split.b / plain.b, 1, precision);
    CHECK(split.r != plain.r);
}

TEST(whitted_s_integrator_has_one_notice_of_dispersion) {
    static const char scene[] = "local ball = gr.sphere(gr.glass{glass = 'F2'})\n"
                                "local other = gr.sphere(gr.material{kd = {0, 0, 0}, ks = {1, 1, 1}, refract = 0.9, "
                                "glass = 'water'})\n"
                                "other:translate(3, 0, 0)\n"
                                "local root = gr.node() root:add_child(ball) root:add_child(other)\n"
                                "gr.render{node = root, eye = {0, 0, 9}, view = {0, 0, -1}, fov = 60}\n";
    static const char notice[] = "glass with dispersion is shown with one index of refraction";
    struct test_result result = test_gray_scene(scene, "--size 8x8 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    const char *first = strstr(result.err, notice);
    CHECK(first && !strstr(first + 1, notice));
    test_free_result(&result);
    result = test_gray_scene(scene, "--size 8x8 --integrator path --spp 1 scene.lua", NULL);
    CHECK(!strstr(result.err, notice));
    test_free_result(&result);
}

TEST(the_trace_of_a_pixel_has_the_wavelength_of_its_path) {
    static const char scene[] = "gr.render{node = gr.sphere(gr.glass{glass = 'F2'}), eye = {0.3, 0.2, 9}, "
                                "target = {0, 0, 0}, fov = 10, integrator = 'path'}\n";
    struct test_result result = test_gray_scene(scene, "-q --size 9x9 --spp 2 --pixel 4,4 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    const char *text = strstr(result.out, ", wavelength ");
    double nanometres = text ? strtod(text + strlen(", wavelength "), NULL) : 0;
    CHECK(nanometres > 380 && nanometres < 760);
    test_free_result(&result);
}

/* Beside a bright bar behind a ball of flint are colours that no display shows. */
TEST(colours_outside_of_the_display_keep_their_sign_in_files_of_light) {
    static const char scene[] =
        "local ball = gr.sphere(gr.glass{glass = 'N-SF66'})\n"
        "local bar = gr.cube(gr.material{kd = {0, 0, 0}, emission = {9, 9, 9}})\n"
        "bar:scale(0.2, 4, 0.1) bar:translate(1.5, -2, -9)\n"
        "local root = gr.node() root:add_child(ball) root:add_child(bar)\n"
        "gr.render{node = root, eye = {0, 0, 6}, view = {0, 0, -1}, fov = 8, background = {0, 0, 0}, "
        "integrator = 'path'}\n";
    struct test_result result = test_gray_scene(scene, "-q --size 48x24 --spp 64 -o a.pfm scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/a.pfm", test_folder());
    FILE *file = fopen(path, "rb");
    float value;
    int negative = 0, positive = 0;
    CHECK(file && fseek(file, (long)strlen("PF\n48 24\n-1.0\n"), SEEK_SET) == 0);
    for (int i = 0; file && i < 48 * 24 * 3 && fread(&value, sizeof value, 1, file) == 1; i++) {
        negative += value < -0.01F;
        positive += value > 0.01F;
    }
    if (file)
        (void)fclose(file);
    CHECK(negative >= 3 && positive > 50);
}
