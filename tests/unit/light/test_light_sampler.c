/* Choosing one light of many: probabilities, lights that must have a chance, and the gain in a corridor of lamps. */
#include "base/error.h"
#include "base/random.h"
#include "light/light_sampler.h"
#include "tests/harness.h"

#include <math.h>
#include <string.h>

struct lights {
    struct arena arena;
    struct error error;
    struct light *all;
    uint32_t count;
    struct light_sampler sampler;
};

static double number(uint64_t seed, uint64_t index, double low, double high) {
    return low + (high - low) * random_unit(random_combine(seed, index));
}

static struct vec3 vector(uint64_t seed, uint64_t index, double spread) {
    return vec3_make(number(seed, 3 * index, -spread, spread), number(seed, 3 * index + 1, -spread, spread),
                     number(seed, 3 * index + 2, -spread, spread));
}

/* Every kind that needs no scene, with every falloff, on both sides, some of them dark. */
static struct light random_light(uint64_t seed, uint64_t i) {
    static const enum light_kind kinds[] = {LIGHT_POINT, LIGHT_PARALLELOGRAM, LIGHT_SPOT, LIGHT_DISC, LIGHT_SPHERE};
    static const double falloffs[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0.25, 0.125}};
    uint64_t key = random_combine(seed, i), turn = random_combine(key, 1) % 5;
    struct light light = {.kind = kinds[random_combine(key, 0) % 5], .colour = {3, 2, 1}};
    light.colour = colour_scale(light.colour, random_combine(key, 2) % 16 == 0 ? 0 : number(key, 3, 0.1, 4));
    memcpy(light.falloff, falloffs[turn], sizeof light.falloff);
    light.attenuation = turn > 2 ? ATTENUATION_COEFFICIENTS : turn > 1 ? ATTENUATION_RANGE : ATTENUATION_INVERSE_SQUARE;
    light.range = number(key, 4, 1, 6);
    light.intensity = number(key, 5, 0.1, 5);
    light.position = vector(key, 6, 5);
    light.direction = vec3_normalize(vector(key, 7, 1));
    light.cos_outer = number(key, 8, -1, 0.9);
    light.cos_inner = light.cos_outer + number(key, 9, 0, 1 - light.cos_outer);
    light.radius = number(key, 10, 0.05, 0.6);
    light.edge1 = vector(key, 11, 0.6);
    light.edge2 = vector(key, 12, 0.6);
    light.corner = vec3_sub(light.position, vec3_scale(vec3_add(light.edge1, light.edge2), 0.5));
    light.emissive = light.kind != LIGHT_POINT && light.kind != LIGHT_SPOT && random_combine(key, 13) % 2;
    light.one_sided = random_combine(key, 14) % 2;
    CHECK(light_prepare(&light, NULL, NULL, NULL));
    return light;
}

static void lights_begin(struct lights *l, uint32_t count, uint64_t seed, uint32_t directional) {
    *l = (struct lights){.count = count};
    l->all = arena_alloc_array(&l->arena, count, sizeof *l->all);
    for (uint32_t i = 0; i < count; i++)
        l->all[i] = i < directional
                        ? (struct light){.kind = LIGHT_DIRECTIONAL, .colour = {1, 1, 1}, .direction = {0, -1, 0}}
                        : random_light(seed, i);
}

/* Of lights with one part. */
static struct light_part part_of(uint32_t light) {
    return (struct light_part){light, 0};
}

static void lights_sampler(struct lights *l, enum light_choice choice) {
    CHECK(light_sampler_build(&l->sampler, (struct light_sampler_options){choice, NULL}, l->all, l->count, &l->arena,
                              &l->error));
}

TEST(probabilities_of_all_lights_sum_to_one) {
    static const uint32_t counts[] = {1, 2, 3, 17, 400};
    for (int choice = LIGHT_CHOICE_TREE; choice <= LIGHT_CHOICE_UNIFORM; choice++) {
        for (int c = 0; c < 10; c++) {
            struct lights l;
            lights_begin(&l, counts[c % 5], (uint64_t)c, c < 5 ? 0 : 1 + counts[c % 5] / 3);
            lights_sampler(&l, (enum light_choice)choice);
            for (uint64_t i = 0; i < 40; i++) {
                struct vec3 point = vector(100, i, 6), normal = vec3_normalize(vector(101, i, 1));
                if (i % 4 == 0)
                    normal = vec3_all(0);
                double sum = 0, pmf;
                for (uint32_t k = 0; k < l.count; k++)
                    sum += light_sampler_pmf(&l.sampler, point, normal, part_of(k));
                bool some = light_sampler_sample(&l.sampler, point, normal, 0.5, &pmf).light != LIGHT_NONE;
                CHECK(sum <= 1 + 1e-12);
                if (some) /* a descent may end at a light that contributes nothing: then the probabilities sum to less
                             than 1 */
                    CHECK(sum > 0.9 || choice == LIGHT_CHOICE_TREE);
                if (choice != LIGHT_CHOICE_TREE && some)
                    CHECK_NEAR(sum, 1, 1e-12);
                if (c >= 5 && l.count == 1)
                    CHECK_NEAR(sum, 1, 1e-12);
            }
            arena_destroy(&l.arena);
        }
    }
}

/* Chi-square over the lights; lights with few expected choices are joined, and "no light" counts as one more. */
TEST(lights_are_chosen_as_often_as_their_probability_says) {
    enum { LIGHTS = 60, N = 200000 };
    for (int choice = LIGHT_CHOICE_TREE; choice <= LIGHT_CHOICE_UNIFORM; choice++) {
        for (uint64_t k = 0; k < 4; k++) {
            struct lights l;
            static int counted[LIGHTS + 1];
            memset(counted, 0, sizeof counted);
            lights_begin(&l, LIGHTS, k, (uint32_t)k);
            lights_sampler(&l, (enum light_choice)choice);
            struct vec3 point = vector(200, k, 5), normal = vec3_normalize(vector(201, k, 1));
            for (uint64_t i = 0; i < N; i++) {
                double pmf, u = ((double)i + random_unit(random_combine(7, i))) / N; /* stratified: less than random */
                uint32_t light = light_sampler_sample(&l.sampler, point, normal, u, &pmf).light;
                counted[light == LIGHT_NONE ? LIGHTS : light]++;
                if (light != LIGHT_NONE && i % 64 == 0)
                    CHECK_NEAR(light_sampler_pmf(&l.sampler, point, normal, part_of(light)) / pmf, 1, 1e-9);
            }
            double chi = 0, all = 0;
            for (uint32_t i = 0; i < LIGHTS; i++) {
                double expected = N * light_sampler_pmf(&l.sampler, point, normal, part_of(i));
                all += expected;
                chi += expected > 0 ? (counted[i] - expected) * (counted[i] - expected) / expected : counted[i];
            }
            CHECK_NEAR(counted[LIGHTS], N - all, 2);
            CHECK(chi < LIGHTS);
            arena_destroy(&l.arena);
        }
    }
}

/* The brightest classic intensity times cosine that any of its samples brings to a surface. */
static double brings(const struct light *light, struct vec3 point, struct vec3 normal) {
    struct light_context context;
    double max = 0;
    if (!light_context_make(light, point, point, &context))
        return 0;
    for (uint64_t i = 0; i < 16; i++) {
        struct sample2 xi = {random_unit(random_combine(5, i)), random_unit(random_combine(6, i))};
        struct light_sample sample = light_sample(light, &context, xi);
        max = fmax(max, colour_max_abs(sample.intensity) * fabs(vec3_dot(sample.direction, normal)));
    }
    return max;
}

TEST(every_light_that_reaches_a_point_has_a_chance) {
    enum { LIGHTS = 120 };
    struct lights l;
    int lit = 0, dark = 0;
    lights_begin(&l, LIGHTS, 31, 0);
    lights_sampler(&l, LIGHT_CHOICE_TREE);
    for (uint64_t i = 0; i < 300; i++) {
        struct vec3 point = vector(300, i, 6), normal = vec3_normalize(vector(301, i, 1));
        if (i < LIGHTS) /* at the position of the light */
            point = l.all[i].position;
        for (uint32_t k = 0; k < LIGHTS; k++) {
            double pmf = light_sampler_pmf(&l.sampler, point, normal, part_of(k));
            if (brings(&l.all[k], point, normal) > 1e-12) {
                CHECK(pmf > 0);
                lit++;
            }
            dark += pmf == 0;
        }
    }
    CHECK(lit > 1000 && dark > 1000);
    arena_destroy(&l.arena);
}

TEST(the_same_lights_make_the_same_sampler) {
    struct lights a, b;
    lights_begin(&a, 300, 8, 5);
    lights_begin(&b, 300, 8, 5);
    lights_sampler(&a, LIGHT_CHOICE_TREE);
    lights_sampler(&b, LIGHT_CHOICE_TREE);
    CHECK_EQ_INT(a.sampler.node_count, b.sampler.node_count);
    CHECK(memcmp(a.sampler.nodes, b.sampler.nodes, a.sampler.node_count * sizeof *a.sampler.nodes) == 0);
    arena_destroy(&a.arena);
    arena_destroy(&b.arena);
}

TEST(coincident_and_distant_lights_make_a_tree_that_is_not_deep) {
    enum { LIGHTS = 3000 };
    for (int apart = 0; apart < 2; apart++) {
        struct lights l;
        lights_begin(&l, LIGHTS, 4, 0);
        for (uint32_t i = 0; i < LIGHTS; i++) {
            double x = apart ? ldexp(1, (int)(i % 190) - 95) : 1;
            l.all[i] = (struct light){.kind = LIGHT_POINT, .colour = {1, 1, 1}, .position = {x, 0, 0}};
        }
        lights_sampler(&l, LIGHT_CHOICE_TREE);
        CHECK_EQ_INT(l.sampler.node_count, 2 * LIGHTS - 1);
        for (uint32_t i = 0; i < LIGHTS; i++) {
            int depth = 0;
            for (uint32_t at = l.sampler.leaf_of[i]; at != 0; at = l.sampler.nodes[at].parent)
                depth++;
            CHECK(depth < 64 + 14);
        }
        arena_destroy(&l.arena);
    }
}

/* 1,000 lamps of equal power below the ceiling of a corridor of 3 x 3 x 200. The variance of one choice is exact: the
 * sum of f^2 / p minus the square of the sum of f, where f is the light of a lamp from its centre. */
static double relative_variance(const struct lights *l, struct vec3 point, struct vec3 normal) {
    double sum = 0, squares = 0;
    for (uint32_t i = 0; i < l->count; i++) {
        struct light_context context;
        if (!light_context_make(&l->all[i], point, point, &context))
            continue;
        struct light_sample sample = light_sample(&l->all[i], &context, (struct sample2){0.5, 0.5});
        double f = sample.intensity.g * fmax(0, vec3_dot(sample.direction, normal));
        double pmf = light_sampler_pmf(&l->sampler, point, normal, part_of(i));
        CHECK(pmf > 0 || f == 0);
        sum += f;
        squares += f > 0 ? f * f / pmf : 0;
    }
    return squares / (sum * sum) - 1;
}

TEST(a_thousand_lamps_in_a_corridor_have_a_tenth_of_the_variance_of_uniform_choice) {
    for (int shape = 0; shape < 3; shape++) {
        struct lights tree;
        lights_begin(&tree, 1000, 1, 0);
        for (uint32_t i = 0; i < tree.count; i++) {
            struct vec3 at = {number(3, i, -1.4, 1.4), 2.9, 0.2 * i + number(4, i, 0, 0.2)};
            struct light *light = &tree.all[i];
            *light = (struct light){
                .kind = LIGHT_SPHERE, .position = at, .radius = 0.04, .emissive = true, .colour = {1, 1, 1}};
            if (shape == 1)
                *light = (struct light){.kind = LIGHT_DISC,
                                        .position = at,
                                        .direction = {0, -1, 0},
                                        .radius = 0.05,
                                        .one_sided = true,
                                        .emissive = true,
                                        .colour = {1, 1, 1}};
            if (shape == 2)
                *light = (struct light){.kind = LIGHT_POINT,
                                        .position = at,
                                        .colour = {1, 1, 1},
                                        .attenuation = ATTENUATION_INVERSE_SQUARE,
                                        .intensity = 1};
        }
        double of_tree[10];
        for (int run = 0; run < 2; run++) {
            lights_sampler(&tree, run == 0 ? LIGHT_CHOICE_TREE : LIGHT_CHOICE_UNIFORM);
            for (int i = 0; i < 10; i++) {
                struct vec3 point = {0.25 * (i % 5) - 0.5, 0, 10 + 19.3 * i}, normal = {0, 1, 0};
                if (i % 3 == 1)
                    point = vec3_make(-1.5, 1.2, point.z), normal = vec3_make(1, 0, 0);
                double variance = relative_variance(&tree, point, normal);
                if (run == 0)
                    of_tree[i] = variance;
                else
                    CHECK(10 * of_tree[i] < variance);
            }
        }
        arena_destroy(&tree.arena);
    }
}
