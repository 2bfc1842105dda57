/* Fog against its integrals, and the cut-off of rays with small contributions. */
#include "material/medium.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* exp(-integral of the density), by many small steps. */
static double by_steps(double (*density)(const struct fog *fog, struct vec3 p), const struct fog *fog, struct vec3 o,
                       struct vec3 d, double distance) {
    enum { STEPS = 200000 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++)
        sum += density(fog, vec3_add_scaled(o, d, distance * (i + 0.5) / STEPS));
    return exp(-sum * distance / STEPS);
}

static double height_density(const struct fog *fog, struct vec3 p) {
    return fog->density * exp(-(p.y - fog->base) / fog->scale);
}

static double profile_density(const struct fog *fog, struct vec3 p) {
    if (p.y <= fog->heights[0])
        return fog->densities[0];
    for (uint32_t i = 1; i < fog->count; i++) {
        if (p.y < fog->heights[i])
            return fog->densities[i - 1] + (fog->densities[i] - fog->densities[i - 1]) * (p.y - fog->heights[i - 1]) /
                                               (fog->heights[i] - fog->heights[i - 1]);
    }
    return fog->densities[fog->count - 1];
}

static double grid_density(const struct fog *fog, struct vec3 p) {
    uint32_t cell[3];
    for (int axis = 0; axis < 3; axis++) {
        double at = (vec3_get(p, axis) - vec3_get(fog->corner, axis)) / vec3_get(fog->size, axis) * fog->cells[axis];
        if (at < 0 || at >= fog->cells[axis])
            return 0;
        cell[axis] = (uint32_t)at;
    }
    return fog->densities[cell[0] + fog->cells[0] * (cell[1] + fog->cells[1] * cell[2])];
}

TEST(fog_is_the_exponential_of_its_integral) {
    static const double heights[] = {-1, 0.5, 0.5, 2}, levels[] = {0.2, 0.1, 0.6, 0}, sums[] = {0, 0.225, 0.225, 0.675};
    double cells[24];
    struct test_random random = {5};
    for (int i = 0; i < 24; i++)
        cells[i] = test_uniform(&random, 0, 1);
    struct fog height = {.kind = FOG_HEIGHT, .density = 0.4, .base = 0.3, .scale = 0.7};
    struct fog profile = {.kind = FOG_PROFILE, .count = 4, .heights = heights, .densities = levels, .sums = sums};
    struct fog grid = {
        .kind = FOG_GRID, .corner = {-1, -1, -2}, .size = {3, 2, 2}, .cells = {4, 3, 2}, .densities = cells};
    for (int i = 0; i < 40; i++) {
        struct vec3 o, d;
        o.x = test_uniform(&random, -3, 3), o.y = test_uniform(&random, -3, 3), o.z = test_uniform(&random, -3, 3);
        d.x = test_uniform(&random, -1, 1), d.y = i % 8 ? test_uniform(&random, -1, 1) : 0;
        d.z = test_uniform(&random, -1, 1);
        d = vec3_normalize(d);
        double distance = test_uniform(&random, 0.1, 6);
        CHECK_NEAR(fog_transmittance(&height, o, d, distance), by_steps(height_density, &height, o, d, distance), 1e-7);
        CHECK_NEAR(fog_transmittance(&profile, o, d, distance), by_steps(profile_density, &profile, o, d, distance),
                   2e-5);
        CHECK_NEAR(fog_transmittance(&grid, o, d, distance), by_steps(grid_density, &grid, o, d, distance), 2e-4);
    }
    struct vec3 o = {0, 0.3, 0}, up = {0, 1, 0}, down = {0, -1, 0};
    CHECK_NEAR(fog_transmittance(&height, o, up, INFINITY), exp(-0.4 * 0.7), 1e-12);
    CHECK_NEAR(fog_transmittance(&height, o, down, INFINITY), 0, 0);
    CHECK_NEAR(fog_transmittance(&profile, vec3_make(0, -1, 0), up, INFINITY), exp(-0.675), 1e-12);
    CHECK_NEAR(fog_transmittance(&profile, vec3_make(0, 5, 0), up, INFINITY), 1, 0);
    CHECK_NEAR(fog_transmittance(&profile, vec3_make(0, 5, 0), down, INFINITY), 0, 0);
    CHECK_NEAR(fog_transmittance(&grid, vec3_make(50, 0, 0), up, INFINITY), 1, 0);
}

/* Outside and on the borders of the parts of fog, and along axes: the numbers on the right are the closed forms. */
TEST(fog_is_integrated_on_its_borders_and_along_axes) {
    static const double heights[] = {0, 1, 3}, levels[] = {0, 0.4, 0.2}, sums[] = {0, 0.2, 0.8};
    static const double cells[] = {0.1, 0.2, 0.3, 0.4};
    const struct fog profile = {.kind = FOG_PROFILE, .count = 3, .heights = heights, .densities = levels, .sums = sums};
    const struct fog grid = {
        .kind = FOG_GRID, .corner = {0, 0, 0}, .size = {2, 1, 2}, .cells = {2, 1, 2}, .densities = cells};
    const struct fog height = {.kind = FOG_HEIGHT, .density = 0.5, .base = 0, .scale = 1};
    const struct {
        const struct fog *fog;
        struct vec3 from, route;
        double distance, depth;
    } all[] = {{&profile, {0, -5, 0}, {1, 0, 0}, 7, 0},               /* level, below: none */
               {&profile, {0, 0, 0}, {1, 0, 0}, 7, 0},                /* level, on the border */
               {&profile, {0, 0.5, 0}, {1, 0, 0}, 7, 7 * 0.2},        /* level, between */
               {&profile, {0, 9, 0}, {1, 0, 0}, 7, 7 * 0.2},          /* level, above */
               {&profile, {0, 0.5, 0}, {1, 1e-12, 0}, 7, 7 * 0.2},    /* nearly level */
               {&profile, {0, 1e6, 0}, {1, 1e-12, 0}, 7, 7 * 0.2},    /* the same far above */
               {&profile, {0, -5, 0}, {0, 1, 0}, 8, 0.8},             /* from below to the upper border */
               {&profile, {0, 9, 0}, {0, -1, 0}, 20, 0.8 + 6 * 0.2},  /* from above to far below */
               {&grid, {-1, 0.5, 0.5}, {1, 0, 0}, 9, 0.1 + 0.2},      /* along x, from outside */
               {&grid, {0.5, 0.5, 9}, {0, 0, -1}, 99, 0.1 + 0.3},     /* along -z */
               {&grid, {1.5, 0.5, 0.5}, {0, 1, 0}, 99, 0.5 * 0.2},    /* along y, from inside */
               {&grid, {-1, 0.5, 5}, {1, 0, 0}, 9, 0},                /* beside it */
               {&grid, {-1, 0.5, -5}, {1, 0, 0}, 9, 0},               /* on the other side */
               {&grid, {0.5, 0.5, 0.5}, {1, 0, 0}, 0.25, 0.25 * 0.1}, /* ends in its cell */
               {&grid, {2, 0.5, 0.5}, {-1, 0, 0}, 99, 0.1 + 0.2},     /* from its face on */
               {&grid, {0, 0.5, 0}, {0.6, 0, 0.8}, 2.5, 0},           /* on its edge, see below */
               {&height, {0, 1e4, 0}, {0, 1, 0}, INFINITY, 0},        /* where it has ended, and upwards */
               {&height, {0, 0, 0}, {0, 1, 0}, INFINITY, 0.5},        /* all fog above */
               {&height, {0, 0, 0}, {1, 0, 0}, 3, 1.5}};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        double depth = all[i].depth;
        if (all[i].fog == &grid && all[i].route.z > 0) /* leaves cell (0,0) at z = 1, then (0,1) at x = 1, then (1,1) */
            depth = 1.25 * 0.1 + (1 / 0.6 - 1.25) * 0.3 + (2.5 - 1 / 0.6) * 0.4;
        CHECK_NEAR(fog_transmittance(all[i].fog, all[i].from, all[i].route, all[i].distance), exp(-depth), 1e-9);
    }
}

TEST(simple_fogs_follow_their_formulas) {
    struct vec3 o = {1, 2, 3}, d = {0, 0.6, 0.8};
    struct fog fog = {.kind = FOG_EXPONENTIAL, .density = 0.3, .near = 2, .far = 6};
    CHECK_NEAR(fog_transmittance(&fog, o, d, 4), exp(-1.2), 1e-15);
    CHECK_NEAR(fog_transmittance(&fog, o, d, INFINITY), 0, 0);
    fog.kind = FOG_SQUARED;
    CHECK_NEAR(fog_transmittance(&fog, o, d, 4), exp(-1.44), 1e-15);
    fog.density = 0;
    CHECK_NEAR(fog_transmittance(&fog, o, d, INFINITY), 1, 0);
    fog.kind = FOG_LINEAR;
    CHECK_NEAR(fog_transmittance(&fog, o, d, 1), 1, 0);
    CHECK_NEAR(fog_transmittance(&fog, o, d, 3), 0.75, 1e-15);
    CHECK_NEAR(fog_transmittance(&fog, o, d, 7), 0, 0);
}

/* The camera at (0, 0, 10), a mirror at z = 0, fog: the mirror image is attenuated over the whole path. */
TEST(reflected_and_refracted_rays_go_through_the_fog) {
    struct fog fog = {.kind = FOG_EXPONENTIAL, .density = 0.05, .colour = {0, 1, 0}};
    for (int through = 0; through < 2; through++) {
        struct stage s;
        stage_begin(&s, 1);
        struct node *slab = stage_cube(&s, s.root, stage_glass(&s, !through, through, through ? 1.5 : 1));
        struct material *red = stage_phong(&s, colour_make(1, 0, 0), colour_all(0), 1);
        red->phong.unlit = true;
        struct node *wall = stage_cube(&s, s.root, red);
        stage_move(&s, slab, -0.5, -0.5, -1);
        stage_scale(&s, slab, 50, 50, 2);
        stage_move(&s, wall, -0.5, -0.5, 0);
        stage_scale(&s, wall, 50, 50, 1);
        stage_move(&s, wall, 0, 0, through ? -8 : 15); /* its near face: 5 behind the slab or 5 behind the eye */
        s.camera.fov = 1;
        s.fog = &fog;
        s.settings.samples = 1;
        CHECK(stage_render(&s, 1, 1));
        double route = through ? 10 + 5 : 10 + 15;
        CHECK_NEAR(stage_pixel(&s, 0, 0).r, exp(-0.05 * route), 1e-6);
        CHECK_NEAR(stage_pixel(&s, 0, 0).g, 1 - exp(-0.05 * route), 1e-6);
        stage_end(&s);
    }
}

TEST(a_clear_sky_is_seen_through_the_fog) {
    struct fog fog = {.kind = FOG_EXPONENTIAL, .density = 1, .colour = {0, 1, 0}};
    for (int clear = 0; clear < 2; clear++) {
        struct stage s;
        stage_begin(&s, 1);
        fog.clear_sky = clear;
        s.fog = &fog;
        s.sky.colour = colour_make(1, 0, 0);
        CHECK(stage_render(&s, 1, 1));
        CHECK_NEAR(stage_pixel(&s, 0, 0).r, clear, 0);
        CHECK_NEAR(stage_pixel(&s, 0, 0).g, !clear, 0);
        stage_end(&s);
    }
}

TEST(a_hall_of_mirrors_ends_by_the_cut_off) {
    /* Between two mirrors of amount 1/2: the n-th reflection counts 2^-n, so a cut-off of 2^-8 follows 8 of 1000. */
    struct stage s;
    stage_begin(&s, 1);
    for (int i = 0; i < 2; i++) {
        struct node *wall = stage_cube(&s, s.root, stage_glass(&s, 0.5, 0, 1));
        stage_move(&s, wall, -0.5, -0.5, i ? -1 : 0);
        stage_scale(&s, wall, 50, 50, 1);
        stage_move(&s, wall, 0, 0, i ? -5 : 20);
    }
    s.settings.samples = 1;
    s.settings.reflect_limit = 1000;
    s.settings.cutoff = 0x1p-8;
    CHECK(stage_render(&s, 1, 1));
    CHECK_EQ_INT(s.statistics.reflected_rays, 8);
    stage_end(&s);
}

/* The same hall: with four times the brightness, or four times the exposure, two more reflections count. */
TEST(the_cut_off_uses_the_largest_brightness_and_the_display_s_range) {
    static const uint64_t expected[] = {8, 10, 10, 9, 11};
    for (int i = 0; i < 5; i++) {
        struct stage s;
        stage_begin(&s, 1);
        for (int k = 0; k < 2; k++) {
            struct node *wall = stage_cube(&s, s.root, stage_glass(&s, 0.5, 0, 1));
            stage_scale(&s, wall, 50, 50, 1);
            stage_move(&s, wall, -25, -25, k ? -6 : 20);
        }
        s.settings.samples = 1;
        s.settings.reflect_limit = 1000;
        s.settings.cutoff = 0x1p-8;
        if (i == 1)
            s.sky.colour = colour_make(0, 4, 1);
        if (i == 2)
            stage_point_light(&s, vec3_make(0, 0, 5), colour_all(4));
        if (i == 3)
            s.settings.tone.exposure = 1;
        if (i == 4)
            s.settings.tone.srgb = true;
        uint64_t before = s.statistics.reflected_rays;
        CHECK(stage_render(&s, 1, 1));
        CHECK_EQ_INT(s.statistics.reflected_rays - before, expected[i]);
        stage_end(&s);
    }
}
