/* Media change the rays that they affect, and no others. */
#include "tests/harness.h"

#include "material/medium.h"

#include <math.h>

static struct medium inside_of(double ior, struct colour tint, struct colour absorption) {
    return medium_inside(ior, tint, &(struct medium_input){.absorption = absorption});
}

static const struct fog fogs[] = {
    {.kind = FOG_EXPONENTIAL, .density = 0.3, .colour = {0.5, 0.6, 0.7}},
    {.kind = FOG_LINEAR, .near = 1, .far = 6, .colour = {1, 0, 0.25}, .clear_sky = true},
    {.kind = FOG_HEIGHT, .density = 0.4, .base = 0, .scale = 2, .colour = {0.1, 0.1, 0.1}},
};
enum { FOGS = sizeof fogs / sizeof *fogs };

/* The direction is not a unit vector: distances are in world units all the same. */
static const struct ray ray_in_the_open = {.origin = {1, 2, 3}, .direction = {0, 0.6, -3.2}, .t_max = INFINITY};

static bool is_nothing(const struct medium_effect *effect) {
    struct colour t = effect->transmittance, s = effect->source;
    return t.r == 1 && t.g == 1 && t.b == 1 && s.r == 0 && s.g == 0 && s.b == 0;
}

/* Glass in a fog, or in nothing. */
static const struct solid solids[] = {{1, 0}, {2, 1}};
static struct media media_in(const struct fog *fog, struct medium all[3]) {
    all[0] = inside_of(1.3, colour_all(1), colour_all(9));
    all[1] = inside_of(1.5, colour_all(1), colour_make(0.1, 0, 2));
    all[2] = medium_outside(fog);
    return (struct media){solids, all, 2};
}

TEST(fog_affects_lines_of_sight_in_the_open_and_nothing_else) {
    for (int i = 0; i < FOGS; i++) {
        struct medium all[3];
        const struct media media = media_in(&fogs[i], all);
        struct medium_stack stack = {.media = &media};
        struct ray ray = ray_in_the_open;
        struct medium_effect effect;
        CHECK(!medium_transmittance(MEDIUM_RAY_SIGHT, &ray, 4, &effect) && is_nothing(&effect));
        ray.media = &stack;
        CHECK(medium_transmittance(MEDIUM_RAY_SIGHT, &ray, 4, &effect));
        double seen = fog_transmittance(&fogs[i], ray.origin, vec3_normalize(ray.direction), 4);
        CHECK(seen > 0 && seen < 1);
        CHECK_NEAR(effect.transmittance.r, seen, 1e-15);
        CHECK_NEAR(effect.transmittance.b, seen, 1e-15);
        CHECK_NEAR(effect.source.g, fogs[i].colour.g, 0);
        for (int kind = MEDIUM_RAY_SCATTERED; kind <= MEDIUM_RAY_PHOTON; kind *= 2)
            CHECK(!medium_transmittance((enum medium_ray)kind, &ray, 4, &effect) && is_nothing(&effect));
        CHECK(medium_transmittance(MEDIUM_RAY_SIGHT, &ray, INFINITY, &effect) == !fogs[i].clear_sky);
        medium_stack_enter(&stack, 1);
        (void)medium_transmittance(MEDIUM_RAY_SIGHT, &ray, 4, &effect);
        CHECK_NEAR(effect.transmittance.g, 1, 0);
        CHECK_NEAR(effect.transmittance.r, exp(-0.4), 1e-15);
    }
}

TEST(absorption_is_beers_law_for_every_kind_of_ray) {
    struct medium all[3];
    const struct media media = media_in(&fogs[0], all);
    struct medium_stack stack = {.media = &media};
    medium_stack_enter(&stack, 0);
    medium_stack_enter(&stack, 1);
    struct ray ray = ray_in_the_open;
    ray.media = &stack;
    for (int kind = MEDIUM_RAY_SIGHT; kind <= MEDIUM_RAY_PHOTON; kind *= 2) {
        struct medium_effect effect;
        CHECK(medium_transmittance((enum medium_ray)kind, &ray, 1.75, &effect));
        CHECK_NEAR(effect.transmittance.r, exp(-0.175), 1e-15);
        CHECK_NEAR(effect.transmittance.g, 1, 0);
        CHECK_NEAR(effect.transmittance.b, exp(-3.5), 1e-15);
        CHECK_NEAR(effect.source.r, 0, 0);
        CHECK(medium_transmittance((enum medium_ray)kind, &ray, INFINITY, &effect));
        CHECK_NEAR(effect.transmittance.r, 0, 0);
        CHECK_NEAR(effect.transmittance.g, 1, 0);
    }
}

TEST(media_without_effect_affect_no_ray) {
    struct medium all[3];
    const struct media media = media_in(NULL, all);
    struct medium_stack stack = {.media = &media};
    struct medium_effect effect;
    struct ray ray = ray_in_the_open;
    ray.media = &stack;
    for (int inside = 0; inside < 2; inside++) {
        CHECK(!medium_transmittance(MEDIUM_RAY_SIGHT, &ray, 4, &effect) && is_nothing(&effect));
        CHECK(!medium_transmittance(MEDIUM_RAY_PHOTON, &ray, INFINITY, &effect) && is_nothing(&effect));
        all[1] = inside_of(1.5, colour_make(1, 0, 0), colour_all(0));
        medium_stack_enter(&stack, 1);
    }
}

TEST(fog_around_a_solid_is_another_medium_than_nothing_inside) {
    struct medium all[3];
    for (int fog = 0; fog < 2; fog++) {
        const struct media media = media_in(fog ? &fogs[0] : NULL, all);
        struct medium_stack inside = {.media = &media}, outside = inside;
        medium_stack_enter(&inside, 1);
        CHECK(!medium_stacks_equal(&inside, &outside));
        all[1] = inside_of(1, colour_all(1), colour_all(0));
        CHECK(medium_stacks_equal(&inside, &outside) == !fog);
    }
}

/* --- scattering --- */

static struct medium milk(void) {
    struct medium medium = medium_outside(NULL);
    medium.extinction = colour_make(0.5, 1.5, 6);
    medium.scattering = colour_make(0.5, 1.2, 0);
    medium.emission = colour_make(0.3, 0, 2);
    return medium;
}

/* The mean over a grid of samples: the light that passes is the transmittance, and that scattered in each tenth of the
 * distance is the integral of scattering times transmittance, in each channel and for any throughput. */
TEST(samples_of_a_medium_pass_and_scatter_by_beers_law_in_every_channel) {
    enum { N = 1500, PARTS = 10 };
    const struct medium medium = milk();
    const struct colour throughputs[] = {{1, 1, 1}, {0.1, 2, 0.5}, {0, 1, 3}};
    const double distance = 1.3;
    for (int k = 0; k < 3; k++) {
        struct colour passed = {0, 0, 0}, scattered[PARTS] = {{0, 0, 0}};
        for (int i = 0; i < N * N; i++) {
            const struct sample2 u = {(i % N + 0.5) / N, ((double)(i / N) + 0.5) / N};
            struct medium_sample sample = medium_sample(&medium, distance, throughputs[k], u);
            int part = (int)(sample.distance / distance * PARTS);
            struct colour *sum = sample.scatters ? &scattered[part < PARTS ? part : PARTS - 1] : &passed;
            *sum = colour_add_scaled(*sum, colour_mul(throughputs[k], sample.weight), 1.0 / N / N);
        }
        for (int axis = 0; axis < 3; axis++) {
            double t = colour_get(medium.extinction, axis), s = colour_get(medium.scattering, axis);
            double from = colour_get(throughputs[k], axis);
            CHECK_NEAR(colour_get(passed, axis), from * exp(-t * distance), 2e-3 * from);
            for (int i = 0; i < PARTS; i++) {
                double left = exp(-t * distance * i / PARTS) - exp(-t * distance * (i + 1) / PARTS);
                CHECK_NEAR(colour_get(scattered[i], axis), from * s / t * left, 2e-3 * from);
            }
        }
    }
}

TEST(a_medium_that_absorbs_nothing_keeps_the_sum_of_the_throughput) {
    struct medium medium = milk();
    medium.scattering = medium.extinction;
    struct colour throughput = {0.2, 1, 0.7};
    struct test_random random = {5};
    for (int i = 0; i < 2000; i++) {
        const struct sample2 u = {test_uniform(&random, 0, 1), test_uniform(&random, 0, 1)};
        struct medium_sample sample = medium_sample(&medium, i % 3 ? 0.2 : INFINITY, throughput, u);
        CHECK(sample.scatters || i % 3);
        throughput = colour_mul(throughput, sample.weight);
        CHECK_NEAR(throughput.r + throughput.g + throughput.b, 1.9, 1e-9);
    }
}

TEST(the_emission_of_a_medium_is_the_integral_of_its_transmittance) {
    struct medium medium = milk();
    struct colour near = medium_emission(&medium, 2), far = medium_emission(&medium, INFINITY);
    CHECK_NEAR(near.r, 0.3 / 0.5 * (1 - exp(-1)), 1e-15);
    CHECK_NEAR(near.g, 0, 0);
    CHECK_NEAR(far.b, 2.0 / 6, 1e-15);
    medium.extinction = colour_make(0, 1e-12, 1);
    medium.emission = colour_make(1, 1, 1);
    near = medium_emission(&medium, 3);
    CHECK_NEAR(near.r, 3, 0);
    CHECK_NEAR(near.g, 3, 1e-11);
    CHECK_NEAR(near.b, 1 - exp(-3), 1e-15);
}

TEST(where_nothing_is_every_sample_passes) {
    const struct medium medium = medium_outside(NULL);
    struct medium_sample sample = medium_sample(&medium, INFINITY, colour_all(1), (struct sample2){0.5, 1 - 0x1p-32});
    CHECK(!sample.scatters && sample.distance == INFINITY && sample.weight.r == 1 && sample.weight.b == 1);
}
