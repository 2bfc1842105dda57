/* Light that is scattered under a surface: against its colour, Lambert's lobe and closed forms. */
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/path_estimate.h"

#include "material/openpbr.h"

#include <math.h>

enum { SIDE = 8, WITHOUT_END = 1000 };

/* A matt material whose light is scattered under the surface alone. */
static struct openpbr *wax(struct stage *s, struct material **material) {
    struct openpbr *layers = arena_alloc(&s->scene.arena, sizeof *layers);
    *material = stage_phong(s, colour_all(0.3), colour_all(1), 1);
    (*material)->kind = MATERIAL_OPENPBR;
    (*material)->openpbr = layers;
    *layers = openpbr_defaults();
    layers->subsurface_weight = 1;
    layers->subsurface_radius = 0.01;
    layers->specular_weight = 0;
    return layers;
}

/* In light that is 1 from everywhere. */
static void begin(struct stage *s) {
    stage_begin(s, 2);
    struct material *glow = stage_phong(s, colour_all(0), colour_all(0), 1);
    glow->phong.emission = colour_all(1);
    struct node *room = stage_sphere(s, s->root, glow);
    stage_scale(s, room, 100, 100, 100);
    s->settings.integrator = INTEGRATOR_PATH;
}

/* Fills the picture; its normal is at 25 degrees to the view. */
static void add_plane(struct stage *s, const struct material *material) {
    struct node *plane = stage_sphere(s, s->root, material);
    struct planar square = planar_parallelogram(vec3_make(-50, -50, 0), vec3_make(100, 0, 0), vec3_make(0, 100, 0));
    plane->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = square};
    stage_rotate(s, plane, 0, 25);
}

/* Within four standard errors and an allowance. */
static void check(const char *claim, double value, struct estimate e, double allowed) {
    estimate_record(claim, value, e, 1);
    if (!(fabs(e.mean - value) <= 4 * e.error + allowed))
        test_fail(__FILE__, __LINE__, "%s: %.6f +- %.2g, not %.6f", claim, e.mean, e.error, value);
}

/* In the long forms, of more samples, for three seeds. */
static void check_channels(const char *claim, struct stage *s, struct colour value, int samples) {
    for (int seed = 1; seed <= (samples > 64 ? 3 : 1); seed++) {
        (void)estimate_render(s, &(struct effort){SIDE, samples, 1}, WITHOUT_END, seed);
        for (int c = 0; c < 3; c++)
            check(claim, colour_get(value, c), estimate_of(s, c), fmax(0.005 * colour_get(value, c), 0.001));
    }
}

/* The coat and the gloss of a plane take their share of the view, as they do of Lambert's. */
TEST_TIMES(a_plane_shows_its_subsurface_colour_in_uniform_light, 64) {
    static const double g[] = {-0.5, 0, 0.8};
    static const struct colour colours[] = {{0.05, 0.1, 0.2}, {0.4, 0.6, 0.8}, {0.9, 0.95, 0.99}};
    for (int i = 0; i < 9; i++) {
        struct stage s;
        struct material *material;
        begin(&s);
        struct openpbr *layers = wax(&s, &material);
        layers->subsurface_colour = colours[i % 3];
        layers->subsurface_anisotropy = g[i / 3];
        layers->subsurface_radius_scale = i == 4 ? layers->subsurface_radius_scale : colour_all(1);
        add_plane(&s, material);
        check_channels("a plane", &s, colours[i % 3], 64 * times);
        stage_end(&s);
    }
}

/* Of a thousand mean free paths; a plane reflects .3 as they do, but a ball of a hundred .304. */
TEST_TIMES(a_large_ball_shows_the_colour_of_a_plane, 512) {
    for (int boxed = 0; boxed < 2; boxed++) {
        struct stage s;
        struct material *material;
        begin(&s);
        struct openpbr *layers = wax(&s, &material);
        layers->subsurface_colour = colour_make(0.3, 0.6, 0.9);
        layers->subsurface_radius = 0.001;
        struct node *node = boxed ? stage_cube(&s, s.root, material) : stage_sphere(&s, s.root, material);
        stage_scale(&s, node, boxed ? 20 : 1, boxed ? 20 : 1, 1);
        if (boxed)
            stage_move(&s, node, -10, -10, 0);
        s.camera.fov = 2;
        check_channels(boxed ? "a box" : "a ball", &s, layers->subsurface_colour, 64 * times);
        stage_end(&s);
    }
}

/* Whatever its layers: in and out by walks, of colours that are scattered at different distances. */
TEST_TIMES(white_wax_is_invisible_in_uniform_light, 128) {
    for (int i = 0; i < 4; i++) {
        struct stage s;
        struct material *material;
        begin(&s);
        struct openpbr *layers = wax(&s, &material);
        layers->subsurface_colour = colour_all(1);
        layers->subsurface_radius = i < 2 ? 1 : 0.2;
        layers->subsurface_anisotropy = 0.3 * i;
        layers->specular_weight = i & 1;
        layers->coat_weight = 0.25 * i;
        layers->coat_darkening = 0;
        layers->fuzz_weight = i == 3;
        material->phong.kd = colour_all(1);
        layers->subsurface_weight = i == 3 ? 0.6 : 1;
        (void)(i == 2 ? stage_cube(&s, s.root, material) : stage_sphere(&s, s.root, material));
        s.camera.fov = 15;
        check_channels("white wax", &s, colour_all(1), 64 * times);
        stage_end(&s);
    }
}

/* The same pictures, bit by bit. */
TEST(the_radius_zero_is_lamberts_diffuse_light) {
    static float seen[3 * SIDE * SIDE];
    for (int i = 0; i < 2; i++) {
        struct stage s;
        struct material *material;
        begin(&s);
        struct openpbr *layers = wax(&s, &material);
        layers->specular_weight = 1;
        layers->subsurface_radius = 0;
        layers->subsurface_weight = i;
        material->phong.kd = layers->subsurface_colour = colour_make(0.2, 0.5, 0.8);
        (void)stage_sphere(&s, s.root, material);
        s.camera.fov = 15;
        (void)estimate_render(&s, &(struct effort){SIDE, 4, 1}, 4, 1);
        for (int k = 0; k < 3 * SIDE * SIDE; k++) {
            CHECK(i == 0 || seen[k] == s.film.pixels[k / 3].rgb[k % 3]);
            seen[k] = s.film.pixels[k / 3].rgb[k % 3];
        }
        stage_end(&s);
    }
}

/* What a thin wall shows of white light above or below it; half of its light goes through where g is 0. */
TEST(a_thin_wall_of_wax_divides_its_colour_between_its_sides) {
    static const double g[] = {0, 0.5, -0.8};
    for (int i = 0; i < 3; i++)
        for (int above = 0; above < 2; above++) {
            struct stage s;
            struct material *material;
            stage_begin(&s, 2);
            struct openpbr *layers = wax(&s, &material);
            layers->thin_walled = true;
            layers->subsurface_anisotropy = g[i];
            layers->subsurface_colour = colour_make(0.3, 0.6, 0.9);
            add_plane(&s, material);
            struct material *glow = stage_phong(&s, colour_all(0), colour_all(0), 1);
            glow->phong.emission = colour_all(1);
            struct node *lamp = stage_sphere(&s, s.root, glow);
            stage_rotate(&s, lamp, 0, 25);
            struct planar square = planar_parallelogram(vec3_make(-5e3, -5e3, above ? 20 : -20), vec3_make(1e4, 0, 0),
                                                        vec3_make(0, 1e4, 0));
            lamp->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = square};
            s.camera.fov = 20;
            double share = (1 + (above ? -g[i] : g[i])) / 2;
            check_channels(above ? "reflected" : "through", &s, colour_scale(layers->subsurface_colour, share), 64);
            stage_end(&s);
        }
}

/* One scattering of the path, however many there are under the surface. */
TEST(light_from_under_a_surface_is_direct_light) {
    struct stage s;
    struct material *material;
    begin(&s);
    struct openpbr *layers = wax(&s, &material);
    layers->subsurface_colour = colour_all(0.8);
    layers->subsurface_radius_scale = colour_all(1);
    add_plane(&s, material);
    check("direct", 0.8, estimate_render(&s, &(struct effort){SIDE, 256, 1}, 1, 1), 0.001);
    check("none", 0, estimate_render(&s, &(struct effort){SIDE, 4, 1}, 0, 1), 0);
    s.settings.integrator = INTEGRATOR_WHITTED;
    stage_point_light(&s, vec3_make(0, 0, 10), colour_all(1));
    CHECK(stage_render(&s, 1, 1));
    CHECK_NEAR(stage_pixel(&s, 0, 0).r, 0.8 * cos(25 * 3.14159265358979323846 / 180), 1e-3);
    stage_end(&s);
}

/* --- scattering inside of transparent solids --- */

/* A solid of index 1.5 whose inside has the extinction 1 / radius in every channel. */
static struct openpbr *milk(struct stage *s, struct material **material, struct colour albedo, double radius) {
    struct openpbr *layers = wax(s, material);
    layers->subsurface_weight = 0;
    layers->specular_weight = 1;
    layers->deep = true;
    layers->transmission_scattering = colour_scale(albedo, 1 / radius);
    (*material)->phong.absorption = colour_scale(colour_sub(colour_all(1), albedo), 1 / radius);
    (*material)->phong.refract = 1;
    (*material)->phong.has_ior = true;
    (*material)->phong.ior = 1.5;
    return layers;
}

/* Half spaces under a polished surface, its reflection included, by doubling. */
TEST_TIMES(half_spaces_under_glass_reflect_what_doubling_says, 384) {
    struct stage s;
    struct material *material;
    begin(&s);
    (void)milk(&s, &material, colour_make(0.9, 0.99, 0), 1e-3);
    struct node *node = stage_cube(&s, s.root, material);
    stage_scale(&s, node, 20, 20, 1);
    stage_move(&s, node, -10, -10, 0);
    s.camera.fov = 0.5;
    check_channels("under glass", &s, colour_make(0.2600, 0.6020, 0.04), 64 * times);
    /* In diffuse light: the mean over views, with the cosine. */
    const int views = times > 1 ? 64 : 12, seeds = times > 1 ? 3 : 1;
    for (int seed = 1; seed <= seeds; seed++) {
        const struct effort effort = {4, times > 1 ? 2048 : 64, 1};
        double mean = 0, squares = 0;
        for (int i = 0; i < views; i++) {
            double cosine = sqrt((i + 0.5) / views);
            s.camera.view = vec3_make(-sqrt(1 - cosine * cosine), 0, -cosine);
            s.camera.eye = vec3_add_scaled(vec3_make(0, 0, 1), s.camera.view, -9);
            (void)estimate_render(&s, &effort, WITHOUT_END, 1000 * seed + i);
            struct estimate e = estimate_of(&s, 1);
            mean += e.mean / views;
            squares += pow(e.error / views, 2);
        }
        const struct estimate all = {mean, sqrt(squares)};
        estimate_record("isotropic half space under an index of 1.5, diffuse light; albedo .99", 0.632, all, seed);
        CHECK(all.error < (times > 1 ? 0.001 : 0.02) * mean);
        CHECK_NEAR(mean, 0.632, 0.001 + 4 * all.error);
    }
    stage_end(&s);
}

/* Roughness, forward scattering, and extinctions that differ by channel. */
TEST_TIMES(white_milk_is_invisible_in_uniform_light, 144) {
    for (int i = 0; i < 4; i++) {
        struct stage s;
        struct material *material;
        begin(&s);
        struct openpbr *layers = milk(&s, &material, colour_all(1), i < 2 ? 1 : 0.25);
        layers->transmission_anisotropy = i & 1 ? 0.8 : 0;
        if (i == 3)
            layers->transmission_scattering = colour_make(0.1, 1, 10);
        material->phong.roughness = i == 2 ? 0.3 : 0;
        (void)stage_sphere(&s, s.root, material);
        s.camera.fov = 15;
        check_channels("white milk", &s, colour_all(1), 64 * times);
        stage_end(&s);
    }
}

/* Light of a lamp outside comes into milk only by refraction, so shadow rays inside go to a lamp inside alone. */
TEST(lamps_inside_of_milk_light_it) {
    for (int inside = 0; inside < 2; inside++) {
        struct stage s;
        struct material *material;
        stage_begin(&s, 1);
        (void)milk(&s, &material, colour_all(0.9), 0.5);
        (void)stage_sphere(&s, s.root, material);
        stage_point_light(&s, vec3_make(0, inside ? 0.5 : 5, 0), colour_all(1));
        s.camera.fov = 2;
        struct estimate e = estimate_render(&s, &(struct effort){SIDE, 64, 1}, 100, 1);
        CHECK(inside ? e.mean > 0.01 : e.mean == 0);
        CHECK((s.statistics.shadow_rays > SIDE * SIDE * 64) == (inside == 1));
        stage_end(&s);
    }
}
