/* The path tracer against closed forms. Each render has a fixed number of samples; its standard error, from the pixels,
 * which are independent, is at most 0.1 % of the value, and the mean is within 4 of it. */
#include "shape/planar.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <string.h>

enum { SIZE = 16 };

struct estimate {
    double mean, error;
};

static struct estimate estimate_of(struct stage *s, int channel) {
    double sum = 0, squares = 0, count = (double)s->film.width * s->film.height;
    for (size_t i = 0; i < (size_t)s->film.width * s->film.height; i++) {
        double value = (double)s->film.pixels[i].rgb[channel];
        sum += value;
        squares += value * value;
    }
    double variance = squares / count - sum / count * (sum / count);
    return (struct estimate){sum / count, sqrt(variance > 0 ? variance / count : 0)};
}

static struct estimate render_path(struct stage *s, int samples, int depth, uint64_t seed) {
    s->settings.integrator = INTEGRATOR_PATH;
    s->settings.path_samples = samples;
    s->settings.max_depth = depth;
    s->settings.seed = seed;
    CHECK(stage_render(s, SIZE, SIZE));
    return estimate_of(s, 0);
}

/* The error of a picture whose pixels differ: from two pictures with different random numbers. */
static struct estimate render_twice(struct stage *s, int samples, int depth, uint64_t seed) {
    static struct film_pixel first[SIZE * SIZE];
    double squares = 0;
    struct estimate a = render_path(s, samples, depth, seed + 1000);
    memcpy(first, s->film.pixels, sizeof first);
    struct estimate b = render_path(s, samples, depth, seed);
    for (size_t i = 0; i < SIZE * SIZE; i++)
        squares += pow((double)(s->film.pixels[i].rgb[0] - first[i].rgb[0]), 2);
    return (struct estimate){(a.mean + b.mean) / 2, sqrt(squares) / (2 * SIZE * SIZE)};
}

/* An allowance for the rounding of pixels to float. */
static void check_estimate(struct estimate e, double value) {
    CHECK(e.error <= 0.001 * value);
    CHECK_NEAR(e.mean, value, 4 * e.error + 1e-6 * value);
}

/* Seeds 1 to `seeds`. */
static void check_mean(struct stage *s, int samples, int depth, int seeds, double value) {
    for (int seed = 1; seed <= seeds; seed++)
        check_estimate(render_path(s, samples, depth, (uint64_t)seed), value);
}

static struct material *glowing(struct stage *s, double emission, double kd, double ks) {
    struct material *material = stage_phong(s, vec3_all(kd), vec3_all(ks), 1);
    material->phong.emission = vec3_all(emission);
    material->phong.two_sided = true;
    material->phong.reflect = ks > 0 ? 1 : 0;
    return material;
}

static struct node *add_planar(struct stage *s, const struct material *material, struct planar planar) {
    struct node *node = stage_sphere(s, s->root, material);
    node->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = planar};
    return node;
}

static struct node *add_rectangle(struct stage *s, const struct material *material, struct vec3 corner,
                                  struct vec3 along, struct vec3 up) {
    return add_planar(s, material, planar_parallelogram(corner, along, up));
}

/* A room that is a sphere about the origin, with blocks in it, all of one material. */
static void begin_room(struct stage *s, double emission, double kd, double ks) {
    stage_begin(s, 1);
    struct material *material = glowing(s, emission, kd, ks);
    struct node *room = stage_sphere(s, s->root, material);
    stage_scale(s, room, 8, 8, 8);
    struct node *block = stage_cube(s, s->root, material);
    stage_move(s, block, 0.5, -1, -4);
    stage_rotate(s, block, 1, 30);
    struct node *ball = stage_sphere(s, s->root, material);
    stage_move(s, ball, -2, 1, -5);
    s->camera = (struct camera){{0, 0, 3}, {0, 0, -1}, {0, 1, 0}, 60};
}

/* --- closed scenes --- */

TEST(a_closed_diffuse_scene_shows_its_emission_over_one_minus_albedo) {
    struct stage s;
    begin_room(&s, 0.5, 0.5, 0);
    check_mean(&s, 256, 1000, 1, 0.5 / (1 - 0.5));
    stage_end(&s);
}

TEST(a_path_of_depth_n_has_n_bounces) {
    struct stage s;
    begin_room(&s, 1, 0.5, 0);
    for (int depth = 0; depth <= 3; depth++)
        check_mean(&s, 1024, depth, 1, (1 - pow(0.5, depth + 1)) / (1 - 0.5));
    stage_end(&s);
}

TEST(diffuse_and_mirrored_light_add_up_in_a_closed_scene) {
    struct stage s;
    begin_room(&s, 1, 0.3, 0.2);
    check_mean(&s, 512, 1000, 1, 1 / (1 - 0.3 - 0.2));
    stage_end(&s);
}

TEST_LONG(closed_scenes_show_the_sum_of_their_bounces) {
    static const double albedos[][2] = {{0.2, 0}, {0.5, 0}, {0.8, 0}, {0.95, 0}, {0.3, 0.2}, {0.1, 0.8}, {0, 0.5}};
    for (size_t i = 0; i < sizeof albedos / sizeof *albedos; i++) {
        struct stage s;
        double kd = albedos[i][0], ks = albedos[i][1];
        begin_room(&s, 1, kd, ks);
        check_mean(&s, kd + ks > 0.85 ? 8192 : 2048, 1000, 3, 1 / (1 - kd - ks));
        if (ks == 0) {
            for (int depth = 0; depth <= 5; depth++)
                check_mean(&s, 2048, depth, 3, (1 - pow(kd, depth + 1)) / (1 - kd));
        }
        stage_end(&s);
    }
}

/* Without roughness the remaining light is uniform, as always in a sphere. E / pi is I cos / d^2 of a light of
 * intensity I; its mean over a sphere of radius R is I / R^2 wherever the light is. */
static void check_lit_sphere(double albedo, int samples, int seeds, struct vec3 at) {
    enum { RADIUS = 8 };
    struct stage s;
    stage_begin(&s, 1);
    struct node *room = stage_sphere(&s, s.root, glowing(&s, 0, albedo, 0));
    stage_scale(&s, room, RADIUS, RADIUS, RADIUS);
    s.camera = (struct camera){{0, 0, 3}, {0, 0, -1}, {0, 1, 0}, 60};
    stage_point_light(&s, at, vec3_all(1));
    s.lights[0].attenuation = ATTENUATION_INVERSE_SQUARE;
    s.lights[0].intensity = 64;
    for (int seed = 1; seed <= seeds; seed++) {
        static struct film_pixel direct[SIZE * SIZE];
        (void)render_path(&s, samples, 1, (uint64_t)seed);
        memcpy(direct, s.film.pixels, sizeof direct);
        (void)render_path(&s, samples, 1000, (uint64_t)seed);
        for (size_t i = 0; i < SIZE * SIZE; i++) /* the indirect part of the surface's colour */
            s.film.pixels[i].rgb[0] = (s.film.pixels[i].rgb[0] - direct[i].rgb[0]) / (float)albedo;
        check_estimate(estimate_of(&s, 0), 64 / (double)(RADIUS * RADIUS) * albedo / (1 - albedo));
    }
    stage_end(&s);
}

TEST(indirect_light_in_a_sphere_is_the_same_wherever_the_light_is) {
    check_lit_sphere(0.5, 1024, 1, vec3_make(0, 0, 0));
    check_lit_sphere(0.5, 2048, 1, vec3_make(1, 0.5, -1.5));
}

TEST_LONG(indirect_light_in_spheres_is_the_same_wherever_the_light_is) {
    check_lit_sphere(0.2, 4096, 3, vec3_make(3, 0, 0));
    check_lit_sphere(0.5, 4096, 3, vec3_make(2, 1, -3));
    check_lit_sphere(0.8, 8192, 3, vec3_make(-1, 4, 2));
}

/* B1 = 1 + .5 B2, B2 = .8 B1. */
static void check_planes(int samples, int seeds) {
    struct stage s;
    stage_begin(&s, 1);
    (void)add_planar(&s, glowing(&s, 1, 0.5, 0), planar_plane(vec3_make(0, 0, 1), -1));
    (void)add_planar(&s, glowing(&s, 0, 0.8, 0), planar_plane(vec3_make(0, 0, -1), -1));
    s.camera = (struct camera){{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 60};
    check_mean(&s, samples, 1000, seeds, 1 / (1 - 0.5 * 0.8));
    s.camera.view = vec3_make(0, 0, 1);
    check_mean(&s, samples, 1000, seeds, 0.8 / (1 - 0.5 * 0.8));
    stage_end(&s);
}

TEST(parallel_planes_light_each_other) {
    check_planes(1024, 1);
}
TEST_LONG(parallel_planes_light_each_other_for_every_seed) {
    check_planes(8192, 3);
}

/* --- form factors: a white surface shows E / pi of a lamp of radiance 1 --- */

static void camera_along_z(struct stage *s, double height, double z) {
    s->camera = (struct camera){{0, 0, z}, {0, 0, -1}, {0, 1, 0}, 50};
    s->settings.lens.projection = PROJECTION_ORTHOGRAPHIC;
    s->settings.lens.view_height = height;
}

/* The face at z = -1/2 of a cube of side 1 is white, another one glows. */
static void check_cube(bool opposite, int samples, int seeds) {
    struct stage s;
    stage_begin(&s, 1);
    (void)add_rectangle(&s, glowing(&s, 0, 1, 0), vec3_make(-0.5, -0.5, -0.5), vec3_make(1, 0, 0), vec3_make(0, 1, 0));
    if (opposite)
        (void)add_rectangle(&s, glowing(&s, 1, 0, 0), vec3_make(-0.5, -0.5, 0.5), vec3_make(1, 0, 0),
                            vec3_make(0, 1, 0));
    else
        (void)add_rectangle(&s, glowing(&s, 1, 0, 0), vec3_make(-0.5, -0.5, -0.5), vec3_make(1, 0, 0),
                            vec3_make(0, 0, 1));
    camera_along_z(&s, 1, 0);
    for (int seed = 1; seed <= seeds; seed++)
        check_estimate(render_twice(&s, samples, 1, (uint64_t)seed), opposite ? 0.199825 : 0.200044);
    stage_end(&s);
}

TEST(faces_of_a_cube_light_each_other_by_their_form_factors) {
    check_cube(true, 2048, 1);
    check_cube(false, 2048, 1);
}
TEST_LONG(faces_of_a_cube_light_each_other_by_their_form_factors_for_every_seed) {
    check_cube(true, 16384, 3);
    check_cube(false, 16384, 3);
}

static void check_discs(int samples, int seeds) {
    struct stage s;
    stage_begin(&s, 1);
    (void)add_planar(&s, glowing(&s, 0, 1, 0), planar_disc(vec3_make(0, 0, -0.5), vec3_make(0, 0, 1), 1, 0));
    (void)add_planar(&s, glowing(&s, 1, 0, 0), planar_disc(vec3_make(0, 0, 0.5), vec3_make(0, 0, -1), 1, 0));
    camera_along_z(&s, 2, 0);
    for (int seed = 1; seed <= seeds; seed++) {
        struct estimate square = render_twice(&s, samples, 1, (uint64_t)seed);
        double disc = 4 / 3.14159265358979323846;
        check_estimate((struct estimate){square.mean * disc, square.error * disc}, 0.381966);
    }
    stage_end(&s);
}

TEST(coaxial_discs_light_each_other_by_their_form_factor) {
    check_discs(2048, 1);
}
TEST_LONG(coaxial_discs_light_each_other_by_their_form_factor_for_every_seed) {
    check_discs(16384, 3);
}

/* --- glass --- */

/* Red light arrives by reflection, green light through the pane. */
static void check_pane(int samples, int seeds) {
    struct stage s;
    stage_begin(&s, 1);
    struct material *glass = stage_glass(&s, 0, 0, 1.5), *behind = glowing(&s, 0, 0, 0), *before = glowing(&s, 0, 0, 0);
    glass->fresnel = true;
    before->phong.emission = vec3_make(1, 0, 0);
    behind->phong.emission = vec3_make(0, 1, 0);
    struct node *pane = stage_cube(&s, s.root, glass);
    stage_move(&s, pane, -0.5, -0.5, -0.5);
    stage_scale(&s, pane, 10, 10, 1);
    (void)add_planar(&s, behind, planar_plane(vec3_make(0, 0, 1), -5));
    (void)add_planar(&s, before, planar_plane(vec3_make(0, 0, -1), -5));
    camera_along_z(&s, 1, 3);
    for (int seed = 1; seed <= seeds; seed++) {
        (void)render_path(&s, samples, 100, (uint64_t)seed);
        check_estimate(estimate_of(&s, 0), 1.0 / 13);
        check_estimate(estimate_of(&s, 1), 12.0 / 13);
    }
    stage_end(&s);
}

TEST(a_pane_of_glass_reflects_a_thirteenth) {
    check_pane(4096, 1);
}
TEST_LONG(a_pane_of_glass_reflects_a_thirteenth_for_every_seed) {
    check_pane(16384, 3);
}

TEST(rough_glass_of_index_1_is_invisible) {
    struct stage with, without;
    for (int i = 0; i < 2; i++) {
        struct stage *s = i ? &with : &without;
        stage_begin(s, 1);
        struct material *stripes = glowing(s, 0.25, 0, 0);
        (void)add_rectangle(s, stripes, vec3_make(-2, -2, -3), vec3_make(2, 0, 0), vec3_make(0, 4, 0));
        s->sky.colour = vec3_all(0.75);
        if (i) {
            struct material *glass = stage_glass(s, 0, 0, 1);
            glass->fresnel = true;
            glass->phong.roughness = 0.5;
            (void)stage_sphere(s, s->root, glass);
        }
        s->camera = (struct camera){{0, 0, 4}, {0, 0, -1}, {0, 1, 0}, 30};
        (void)render_path(s, 16, 16, 5);
    }
    for (size_t i = 0; i < SIZE * SIZE; i++)
        CHECK_NEAR(with.film.pixels[i].rgb[0], without.film.pixels[i].rgb[0], 1e-6);
    stage_end(&with);
    stage_end(&without);
}
