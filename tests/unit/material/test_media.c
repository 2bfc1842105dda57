/* Media change the rays that they affect, and no others. */
#include "tests/harness.h"

#include "material/medium.h"

#include <math.h>

static const struct fog fogs[] = {
    {.kind = FOG_EXPONENTIAL, .density = 0.3, .colour = {0.5, 0.6, 0.7}},
    {.kind = FOG_LINEAR, .near = 1, .far = 6, .colour = {1, 0, 0.25}, .clear_sky = true},
    {.kind = FOG_HEIGHT, .density = 0.4, .base = 0, .scale = 2, .colour = {0.1, 0.1, 0.1}},
};
enum { FOGS = sizeof fogs / sizeof *fogs };

/* The direction is not a unit vector: distances are in world units all the same. */
static const struct ray ray_in_the_open = {.origin = {1, 2, 3}, .direction = {0, 0.6, -3.2}, .t_max = INFINITY};

static bool is_nothing(const struct medium_effect *effect) {
    struct vec3 t = effect->transmittance, s = effect->source;
    return t.x == 1 && t.y == 1 && t.z == 1 && s.x == 0 && s.y == 0 && s.z == 0;
}

/* Glass in a fog, or in nothing. */
static const struct solid solids[] = {{1, 0}, {2, 1}};
static struct media media_in(const struct fog *fog, struct medium all[3]) {
    all[0] = medium_inside(1.3, vec3_all(1), vec3_all(9));
    all[1] = medium_inside(1.5, vec3_all(1), vec3_make(0.1, 0, 2));
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
        CHECK_NEAR(effect.transmittance.x, seen, 1e-15);
        CHECK_NEAR(effect.transmittance.z, seen, 1e-15);
        CHECK_NEAR(effect.source.y, fogs[i].colour.y, 0);
        for (int kind = MEDIUM_RAY_SCATTERED; kind <= MEDIUM_RAY_PHOTON; kind *= 2)
            CHECK(!medium_transmittance((enum medium_ray)kind, &ray, 4, &effect) && is_nothing(&effect));
        CHECK(medium_transmittance(MEDIUM_RAY_SIGHT, &ray, INFINITY, &effect) == !fogs[i].clear_sky);
        medium_stack_enter(&stack, 1);
        (void)medium_transmittance(MEDIUM_RAY_SIGHT, &ray, 4, &effect);
        CHECK_NEAR(effect.transmittance.y, 1, 0);
        CHECK_NEAR(effect.transmittance.x, exp(-0.4), 1e-15);
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
        CHECK_NEAR(effect.transmittance.x, exp(-0.175), 1e-15);
        CHECK_NEAR(effect.transmittance.y, 1, 0);
        CHECK_NEAR(effect.transmittance.z, exp(-3.5), 1e-15);
        CHECK_NEAR(effect.source.x, 0, 0);
        CHECK(medium_transmittance((enum medium_ray)kind, &ray, INFINITY, &effect));
        CHECK_NEAR(effect.transmittance.x, 0, 0);
        CHECK_NEAR(effect.transmittance.y, 1, 0);
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
        all[1] = medium_inside(1.5, vec3_make(1, 0, 0), vec3_all(0));
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
        all[1] = medium_inside(1, vec3_all(1), vec3_all(0));
        CHECK(medium_stacks_equal(&inside, &outside) == !fog);
    }
}
