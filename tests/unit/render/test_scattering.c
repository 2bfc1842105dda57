/* Light that a medium scatters, along paths: against closed forms and integrals. */
#include "tests/harness.h"

#include "tests/stage.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

static struct medium medium_of(struct vec3 absorption, struct vec3 scattering, double g) {
    return medium_scattering(&(struct medium_input){
        .absorption = absorption, .scattering = scattering, .phase = {PHASE_HENYEY_GREENSTEIN, g}});
}

/* A room with a ball of radius 1 as its only wall, seen from the middle. */
static struct material *begin_room(struct stage *s, const struct medium *medium) {
    stage_begin(s, 2);
    struct material *wall = stage_phong(s, vec3_all(0), vec3_all(0), 1);
    (void)stage_sphere(s, s->root, wall);
    s->camera.eye = vec3_all(0);
    s->medium = medium;
    s->settings.integrator = INTEGRATOR_PATH;
    return wall;
}

static struct vec3 mean_of(struct stage *s, uint32_t side, int samples, int depth) {
    struct vec3 sum = {0, 0, 0};
    s->settings.path_samples = samples;
    s->settings.max_depth = depth;
    CHECK(stage_render(s, side, side));
    for (uint32_t i = 0; i < side * side; i++)
        sum = vec3_add(sum, stage_pixel(s, i % side, i / side));
    return vec3_scale(sum, 1.0 / (side * side));
}

TEST(what_is_not_scattered_is_beers_law_of_absorption_and_scattering) {
    const struct medium medium = medium_of(vec3_make(0.1, 0.5, 0), vec3_make(0.3, 0.5, 2), 0.4);
    struct stage s;
    begin_room(&s, &medium)->phong.emission = vec3_all(1);
    struct vec3 mean = mean_of(&s, 8, 1024, 0);
    CHECK_NEAR(mean.x, exp(-0.4), 4e-3);
    CHECK_NEAR(mean.y, exp(-1), 4e-3);
    CHECK_NEAR(mean.z, exp(-2), 4e-3);
    stage_end(&s);
}

/* A medium that absorbs nothing, in uniform light, whatever its density and its phase function. */
TEST(white_media_are_invisible_in_uniform_light) {
    const double g[] = {0, 0.75, -0.5};
    for (int i = 0; i < 3; i++) {
        const struct medium medium = medium_of(vec3_all(0), vec3_make(0.1, 1, 10), g[i]);
        for (int strategy = PATH_STRATEGY_MIS; strategy <= PATH_STRATEGY_BSDF; strategy += 2) {
            struct stage s;
            begin_room(&s, &medium)->phong.emission = vec3_all(1);
            s.settings.path_strategy = (enum path_strategy)strategy;
            struct vec3 mean = mean_of(&s, 4, 1024, 1000);
            CHECK_NEAR(mean.x, 1, 0.015);
            CHECK_NEAR(mean.y, 1, 0.015);
            CHECK_NEAR(mean.z, 1, 0.03);
            CHECK_NEAR((mean.x + mean.y + mean.z) / 3, 1, 0.01);
            stage_end(&s);
        }
    }
}

/* Along -z through a lamp's light: the integral of scattering, phase function and attenuation in the room. */
TEST(light_of_a_lamp_that_is_scattered_once_is_the_integral_along_the_line_of_sight) {
    const double g[] = {0, 0.7, -0.6};
    for (int i = 0; i < 3; i++) {
        const struct medium medium = medium_of(vec3_all(0.2), vec3_make(0.5, 0.25, 1.5), g[i]);
        struct stage s;
        (void)begin_room(&s, &medium);
        struct vec3 lamp = {0.3, 0, -0.4};
        s.lights[s.light_count++] = (struct light){.kind = LIGHT_POINT,
                                                   .position = lamp,
                                                   .colour = {1, 1, 1},
                                                   .attenuation = ATTENUATION_INVERSE_SQUARE,
                                                   .intensity = 1};
        s.camera.fov = 0.01;
        struct vec3 mean = mean_of(&s, 4, 8192, 1);
        enum { STEPS = 20000 };
        for (int axis = 0; axis < 3; axis++) {
            double sum = 0, e = vec3_get(medium.extinction, axis), scattering = vec3_get(medium.scattering, axis);
            for (int k = 0; k < STEPS; k++) {
                double t = (k + 0.5) / STEPS, z = -t, r2 = lamp.x * lamp.x + (lamp.z - z) * (lamp.z - z), r = sqrt(r2);
                double cosine = -(lamp.z - z) / r, q = 1 + g[i] * g[i] - 2 * g[i] * cosine;
                double phase = (1 - g[i] * g[i]) / (4 * pi * q * sqrt(q));
                sum += scattering * phase / r2 * exp(-e * (t + r)) / STEPS;
            }
            CHECK_NEAR(vec3_get(mean, axis) / pi, sum, 0.015 * sum);
        }
        stage_end(&s);
    }
}

TEST(samples_of_lights_and_of_phase_functions_find_the_same_light) {
    const struct medium medium = medium_of(vec3_make(0.1, 0.3, 0), vec3_make(1, 0.5, 2), 0.5);
    struct vec3 means[3];
    for (int strategy = PATH_STRATEGY_MIS; strategy <= PATH_STRATEGY_BSDF; strategy++) {
        struct stage s;
        (void)begin_room(&s, &medium);
        struct material *glow = stage_phong(&s, vec3_all(0), vec3_all(0), 1);
        glow->phong.emission = vec3_make(4, 5, 6);
        struct node *ball = stage_sphere(&s, s.root, glow);
        stage_move(&s, ball, 0.5, 0.2, -0.3);
        stage_scale(&s, ball, 0.3, 0.3, 0.3);
        s.settings.path_strategy = (enum path_strategy)strategy;
        means[strategy] = mean_of(&s, 8, 2048, 8);
        stage_end(&s);
    }
    for (int i = 1; i < 3; i++) {
        CHECK_NEAR(means[i].x, means[0].x, 0.02 * means[0].x);
        CHECK_NEAR(means[i].y, means[0].y, 0.02 * means[0].y);
        CHECK_NEAR(means[i].z, means[0].z, 0.02 * means[0].z);
    }
}

/* e / s (1 - exp(-s d)), by both integrators; the room is black. */
TEST(the_emission_of_a_medium_is_seen_by_both_integrators) {
    struct medium medium = medium_of(vec3_all(1), vec3_all(0), 0);
    medium.emission = vec3_make(1, 0.5, 0);
    for (int scatters = 0; scatters < 2; scatters++) {
        struct stage s;
        (void)begin_room(&s, &medium);
        for (int i = 0; i < 2; i++) {
            s.settings.integrator = i ? INTEGRATOR_PATH : INTEGRATOR_WHITTED;
            struct vec3 mean = mean_of(&s, 2, 64, 0);
            CHECK_NEAR(mean.x, 0.632121, 1e-6);
            CHECK_NEAR(mean.y, 0.632121 / 2, 1e-6);
            CHECK_NEAR(mean.z, 0, 0);
        }
        stage_end(&s);
        medium.scatters = true;
    }
}
