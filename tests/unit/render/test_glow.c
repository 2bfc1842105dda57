/* Media that emit light by place, as lights: against closed forms, and next-event estimation against scattered rays. */
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/path_estimate.h"

#include "material/density.h"
#include "material/glow.h"
#include "material/medium_mix.h"
#include "math/spectrum.h"

#include <math.h>

static const struct density *grid_of(struct arena *arena, struct box box, const float values[8]) {
    struct error error = {0};
    return density_of_grid(arena, &(struct density_grid){box, {2, 2, 2}, values, 1, false}, &error);
}

/* The integral of the emission is what a small lamp sends in each direction. In the world, in a cube that is turned and
 * scaled, and in two of them. */
TEST(a_small_glowing_grid_lights_as_a_lamp_of_its_power) {
    static const float values[8] = {0, 0, 9, 0, 1, 0, 0, 6};
    for (int i = 0; i < 3; i++) {
        struct arena arena = {0};
        struct box world = {{-0.1, 7.9, -0.1}, {0.1, 8.1, 0.1}}, own = {vec3_all(0), vec3_all(1)};
        const struct medium_input in = {.emission = colour_make(100, 50, 25),
                                        .density = grid_of(&arena, i == 0 ? world : own, values)};
        const struct medium outside = medium_scattering(&in), inside = medium_filling(&in);
        struct stage s;
        stage_floor(&s);
        s.light_count = 0;
        s.medium = i == 0 ? &outside : NULL;
        for (int k = 0; k < i; k++) {
            struct node *cube = stage_cube(&s, s.root, stage_filling(&s, &inside));
            stage_move(&s, cube, -0.5, -0.5, -0.5);
            stage_scale(&s, cube, 0.2, 0.2, 0.2);
            stage_rotate(&s, cube, 0, 20);
            stage_move(&s, cube, 0, 8, 0);
        }
        s.camera.eye = vec3_make(0, 1, 0.001);
        s.camera.view = vec3_make(0, -1, 0);
        s.camera.up = vec3_make(0, 0, 1);
        s.camera.fov = 0.01;
        double power = (i == 2 ? 2 : 1) * 100 * 2 * 0.2 * 0.2 * 0.2;
        struct estimate e = estimate_render(&s, &(struct effort){4, 4096, 1}, 1, 1);
        CHECK(e.error < 0.005 * e.mean);
        CHECK_NEAR(e.mean, power / (3.14159265358979323846 * 64), 4 * e.error + 0.002 * e.mean);
        stage_end(&s);
        arena_destroy(&arena);
    }
}

/* A flame by temperatures in smoke that scatters, behind a ball, above a floor. */
static struct estimate flame(enum path_strategy strategy, int samples, int depth, int seed) {
    static const float kelvin[8] = {1500, 0, 0, 1200, 2500, 0, 800, 0}, smoke[8] = {3, 1, 2, 0, 4, 1, 1, 2};
    struct arena arena = {0};
    struct error error = {0};
    struct box box = {{-0.2, 0.3, -0.2}, {0.2, 0.7, 0.2}};
    const struct medium_input in = {.absorption = colour_all(2),
                                    .scattering = colour_make(1, 2, 3),
                                    .emission = colour_all(3),
                                    .phase = {PHASE_HENYEY_GREENSTEIN, 0.4},
                                    .density = grid_of(&arena, box, smoke),
                                    .heat = heat_make(&arena, grid_of(&arena, box, kelvin), &error)};
    const struct medium inside = medium_filling(&in);
    struct stage s;
    stage_floor(&s);
    s.light_count = 0;
    struct node *ball = stage_sphere(&s, s.root, stage_filling(&s, &inside)),
                *other = stage_sphere(&s, s.root, stage_phong(&s, colour_all(0.5), colour_all(0), 1));
    stage_scale(&s, ball, 0.25, 0.25, 0.25);
    stage_move(&s, ball, 0, 0.5, 0);
    stage_scale(&s, other, 0.2, 0.2, 0.2);
    stage_move(&s, other, 0.5, 0.2, -0.3);
    s.camera.eye = vec3_make(1, 0.7, 0.5);
    s.camera.view = vec3_make(-0.3, -1, 0);
    s.camera.fov = 40;
    s.settings.path_strategy = strategy;
    struct estimate e = estimate_render_twice(&s, &(struct effort){ESTIMATE_SIZE_MAX, samples, 1}, depth, seed);
    stage_end(&s);
    arena_destroy(&arena);
    return e;
}

/* Weights add up to one, whatever finds the light. */
TEST_TIMES(a_flame_lights_the_same_with_and_without_next_event_estimation, 16) {
    for (int seed = 1; seed <= (times > 1 ? 3 : 1); seed++) {
        struct estimate both = flame(PATH_STRATEGY_MIS, 32 * times, 4, seed);
        struct estimate rays = flame(PATH_STRATEGY_BSDF, 2048 * times, 4, seed);
        estimate_check_equal("a flame: both and rays alone", both, rays, seed, times > 1 ? 0.025 : 0.1);
    }
}

TEST(the_direct_light_of_a_flame_has_a_hundredth_of_the_variance_of_rays_alone) {
    struct estimate both = flame(PATH_STRATEGY_MIS, 16, 1, 1), rays = flame(PATH_STRATEGY_BSDF, 1024, 1, 1);
    CHECK(both.error * both.error * 16 < 0.01 * rays.error * rays.error * 1024);
}

/* Points are where the cells say that they are: the integral of 1 over the density of samples is the volume that
 * emits. */
TEST(glowing_points_have_the_density_that_they_are_said_to_have) {
    static const float values[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    enum { COUNT = 4096 };
    struct arena arena = {0};
    struct error error = {0};
    const struct medium_placement placement = {{{{2, 0, 0, 1}, {0, 0, 1, 2}, {0, -1, 0, 0.5}}},
                                               {{{2, 0, 0, 3}, {0, 0, 1, 2}, {0, -1, 0, 0.5}}}};
    struct medium media[3] = {{.ior = 1}, {.ior = 1}, {.ior = 1}};
    for (int i = 1; i < 3; i++) {
        media[i] = medium_filling(&(struct medium_input){
            .emission = colour_all(i), .density = grid_of(&arena, (struct box){vec3_all(-1), vec3_all(1)}, values)});
        media[i].placement = i == 2 ? &placement : NULL;
    }
    const struct glow *glow = NULL;
    CHECK(glow_build(&glow, media, 3, &arena, &error) && glow);
    double volume[3] = {0};
    for (int i = 0; glow && i < COUNT; i++) {
        struct glow_sample at;
        struct sample2 u = {(i + 0.5) / COUNT, random_unit(random_combine(1, (uint64_t)i))},
                       v = {random_unit(random_combine(2, (uint64_t)i)), random_unit(random_combine(3, (uint64_t)i))};
        CHECK(glow_sample(glow, 0.5, u, v, &at));
        CHECK_NEAR(at.pdf, glow_pdf(glow, at.medium, at.point, 0.5), 1e-12 * at.pdf);
        CHECK(medium_density(at.medium, at.point, 0.5) > 0);
        volume[at.medium - media] += 1 / at.pdf / COUNT;
    }
    CHECK_NEAR(volume[1], 8, 0.1);
    CHECK_NEAR(volume[2], 4, 0.1);
    CHECK(!glow || glow_pdf(glow, &media[0], vec3_all(0), 0) == 0);
    CHECK(glow_build(&glow, media, 1, &arena, &error) && !glow);
    arena_destroy(&arena);
}

TEST(heat_is_the_light_of_black_bodies) {
    struct arena arena = {0};
    struct error error = {0};
    for (double kelvin = 600; kelvin < 9e4; kelvin *= 1.7) {
        const float values[8] = {(float)kelvin, (float)kelvin, (float)kelvin, (float)kelvin,
                                 (float)kelvin, (float)kelvin, (float)kelvin, 0};
        const struct heat *heat =
            heat_make(&arena, grid_of(&arena, (struct box){vec3_all(0), vec3_all(1)}, values), &error);
        for (double share = 0.3; share <= 1; share += 0.1) {
            /* Along the edge to the voxel of 0. */
            struct vec3 p = {0.25 + (1 - share) / 2, 0.75, 0.75};
            struct colour found = heat_at(heat, p, 0), right = spectrum_black_body((double)(float)kelvin * share);
            CHECK_NEAR(found.r, right.r, 1e-3 * right.r + 1e-8);
            CHECK_NEAR(found.g, right.g, 1e-3 * right.g + 1e-8);
            CHECK_NEAR(found.b, right.b, 1e-3 * right.b + 1e-8);
        }
    }
    arena_destroy(&arena);
}
