/* Balls of layered materials in light that is 1 from everywhere: white ones are invisible. Paths are followed by the
 * BSDF alone, in and out of the ball, without a limit that they reach. */
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/path_estimate.h"
#include "tests/unit/surface_makers.h"

#include "material/material_inputs.h"
#include "material/openpbr.h"

#include <math.h>

enum { TENTHS = 10, LONGEST = 3000, CHOICES = 21, STRIDE = 13 };

struct ball {
    struct openpbr numbers;
    struct material material;
    struct medium medium;
    bool striped;      /* `refract` is 1 in half of the stripes and 0 in the others */
    double scattering; /* of the inside, by length */
    struct phase phase;
};

static void ball_init(struct ball *ball) {
    *ball = (struct ball){.numbers = openpbr_defaults(), .material = {.kind = MATERIAL_OPENPBR, .depth = 1}};
    ball->material.openpbr = &ball->numbers;
    ball->material.phong.kd = ball->material.phong.ks = colour_all(1);
    ball->material.phong.refract = 1;
}

/* The inside of the ball. */
static const struct solid solid = {4, 0};
static struct media inside_of(struct ball *ball) {
    ball->medium.ior = openpbr_ior(ball->numbers.specular_ior, ball->numbers.specular_weight);
    return (struct media){&solid, &ball->medium, 0};
}

/* The surface at a point of the ball of radius 1, seen by a ray. */
static struct bsdf describe(struct ball *ball, struct vec3 n, struct vec3 ray, const struct medium_stack *media) {
    const struct material_context context = {.total_reflection = true};
    struct hit hit = {.view = vec3_negate(ray), .front = vec3_dot(ray, n) < 0, .primitive = 4, .dpdu = {-n.y, n.x, 0}};
    struct bsdf bsdf;
    hit.normal = hit.normal_geometric = n;
    if (ball->striped)
        ball->material.phong.refract = fmod(8 * n.z + 8, 2) < 1;
    surface_eval(&ball->material, &hit, media, &context, &bsdf);
    return bsdf;
}

/* One of several directions, which are those of a lattice, chosen by its weight; `light` is multiplied by their mean.
 * False: all are black. */
static bool step(const struct bsdf *bsdf, struct vec3 wo, struct test_random *random, struct bsdf_sample *out,
                 double *light) {
    struct bsdf_sample samples[CHOICES];
    double sums[CHOICES], sum = 0, dx = test_uniform(random, 0, 1), dy = test_uniform(random, 0, 1);
    for (int i = 0; i < CHOICES; i++) {
        struct sample2 u = {(i + dx) / CHOICES, fmod((double)(i * STRIDE) / CHOICES + dy, 1)};
        if (bsdf_sample(bsdf, BSDF_ALL, BSDF_IMPORTANCE, wo, u, &samples[i]))
            sum += samples[i].weight.g;
        sums[i] = sum;
    }
    double at = test_uniform(random, 0, sum);
    int chosen = 0;
    while (chosen < CHOICES - 1 && sums[chosen] <= at)
        chosen++;
    *out = samples[chosen];
    *light *= sum / CHOICES;
    return sum > 0;
}

/* From a point of the surface through the inside to the next one; the medium there may scatter the ray. */
static struct vec3 cross_inside(const struct ball *ball, struct vec3 point, struct vec3 *ray,
                                struct test_random *random) {
    for (;;) {
        double along = vec3_dot(point, *ray);
        double end = sqrt(fmax(along * along + 1 - vec3_dot(point, point), 0)) - along, length = INFINITY;
        if (ball->scattering > 0)
            length = -log(1 - test_uniform(random, 0, 1)) / ball->scattering;
        if (length >= end)
            return vec3_normalize(vec3_add_scaled(point, *ray, end));
        point = vec3_add_scaled(point, *ray, length);
        double x = test_uniform(random, 0, 1), y = test_uniform(random, 0, 1);
        *ray = phase_sample(&ball->phase, vec3_negate(*ray), (struct sample2){x, y});
    }
}

/* The light that a ray sees which hits the ball beside its middle. Refraction scales radiance on the way in and back on
 * the way out. */
static double path_light(struct ball *ball, double beside, struct test_random *random) {
    struct media inside = inside_of(ball);
    struct medium_stack media = {.media = &inside};
    struct vec3 ray = {0, 0, -1}, n = {beside, 0, sqrt(1 - beside * beside)};
    double light = 1;
    for (int k = 0; k < LONGEST; k++) {
        struct bsdf bsdf = describe(ball, n, ray, &media);
        struct bsdf_sample sample;
        if (!step(&bsdf, vec3_negate(ray), random, &sample, &light))
            return 0;
        if (sample.flags & BSDF_TRANSMITS)
            medium_stack_cross(&media, &bsdf.boundary);
        ray = sample.direction;
        if (vec3_dot(ray, n) > 0)
            return light;
        n = cross_inside(ball, n, &ray, random);
    }
    return 0;
}

struct brightness {
    double tenth[TENTHS], tenth_error[TENTHS];
    double mean, error; /* over the disc that is seen */
};

static struct brightness ball_brightness(struct ball *ball, uint64_t seed, int paths) {
    struct test_random random = {seed};
    struct brightness out = {.mean = 0};
    for (int i = 0; i < TENTHS; i++) {
        double sum = 0, sum2 = 0, part = (2 * i + 1) / (double)(TENTHS * TENTHS);
        for (int k = 0; k < paths; k++) {
            double within = (k + test_uniform(&random, 0, 1)) / paths;
            double x = path_light(ball, sqrt(i * i + (2 * i + 1) * within) / TENTHS, &random);
            sum += x;
            sum2 += x * x;
        }
        out.tenth[i] = sum / paths;
        out.tenth_error[i] = sqrt(fmax(sum2 / paths - out.tenth[i] * out.tenth[i], 0) / paths);
        out.mean += part * out.tenth[i];
        out.error += part * part * out.tenth_error[i] * out.tenth_error[i];
    }
    out.error = sqrt(out.error);
    return out;
}

static void check_ball(const char *name, struct ball *ball, int paths, uint64_t seed) {
    struct brightness b = ball_brightness(ball, seed, paths);
    for (int i = 0; i < TENTHS; i++)
        if (!(fabs(b.tenth[i] - 1) < 0.005 + 4 * b.tenth_error[i]))
            test_fail(__FILE__, __LINE__, "%s, tenth %d: %.5f +- %.5f", name, i + 1, b.tenth[i], b.tenth_error[i]);
    if (!(fabs(b.mean - 1) < 0.002 + 4 * b.error))
        test_fail(__FILE__, __LINE__, "%s: %.5f +- %.5f", name, b.mean, b.error);
}

/* --- single layers --- */

TEST_TIMES(clear_balls_with_rough_coats_or_fuzz_are_invisible_in_uniform_light, 60) {
    for (uint64_t seed = 1; seed <= (times > 1 ? 3 : 1); seed++) {
        for (int k = 0; k < 6; k++) {
            static const char *const names[] = {"rough coat", "polished coat", "half of a rough coat",
                                                "rough both", "fuzz",          "all"};
            static const double coat[] = {1, 1, 0.5, 1, 0, 0.7}, roughness[] = {0, 0.4, 0, 0.4, 0, 0.1};
            static const double coat_roughness[] = {0.5, 0, 0.7, 0.3, 0, 0.4};
            struct ball ball;
            ball_init(&ball);
            ball.numbers.coat_weight = coat[k];
            ball.numbers.coat_roughness = coat_roughness[k];
            ball.numbers.fuzz_weight = k == 4 ? 1 : k == 5 ? 0.4 : 0;
            ball.material.phong.roughness = roughness[k];
            check_ball(names[k], &ball, 50 * times, seed);
        }
    }
}

TEST_TIMES(clear_rough_balls_below_films_are_invisible_in_uniform_light, 20) {
    for (int k = 0; k < (times > 1 ? 4 : 1); k++) {
        static const char *const names[] = {"dense film", "thick film", "rare film", "stretched facets"};
        static const double film_ior[] = {2.48, 1.8, 1.1, 2}, thickness[] = {1.4, 1.5, 0.5, 0.3};
        struct ball ball;
        ball_init(&ball);
        ball.material.phong.roughness = 0.6;
        ball.numbers.specular_ior = 2.1;
        ball.numbers.specular_anisotropy = k == 3 ? 0.7 : 0;
        ball.numbers.film_weight = 1;
        ball.numbers.film_ior = film_ior[k];
        ball.numbers.film_thickness = thickness[k];
        check_ball(names[k], &ball, 50 * times, 1);
    }
}

TEST_TIMES(balls_that_transmit_half_of_the_light_are_invisible_in_uniform_light, 30) {
    struct texture half = texture_number(0.5);
    for (int k = 0; k < 5; k++) {
        static const char *const names[] = {"half", "half by a texture", "stripes", "stripes below a coat", "a tenth"};
        struct ball ball;
        ball_init(&ball);
        ball.material.phong.refract = k == 4 ? 0.1 : 0.5;
        ball.material.inputs[INPUT_REFRACT] = k == 1 ? &half : NULL;
        ball.striped = k == 2 || k == 3;
        ball.numbers.coat_weight = k == 3;
        ball.numbers.coat_roughness = 0.3;
        check_ball(names[k], &ball, 50 * times, 1);
    }
}

/* --- all layers --- */

/* In [0, 1]; each end has a sixth of the numbers. */
static double random_share(struct test_random *random) {
    return fmin(fmax(test_uniform(random, -0.25, 1.25), 0), 1);
}

/* specular_weight below 1 is a factor of metals, which absorb the rest. */
static void random_material(struct ball *ball, struct test_random *random) {
    ball_init(ball);
    struct openpbr *v = &ball->numbers;
    ball->material.phong.refract = random_share(random);
    ball->material.phong.roughness = random_share(random);
    double *const shares[] = {&v->base_metalness, &v->base_diffuse_roughness, &v->specular_anisotropy, &v->coat_weight,
                              &v->coat_roughness, &v->coat_anisotropy,        &v->coat_darkening,      &v->fuzz_weight,
                              &v->fuzz_roughness};
    for (size_t i = 0; i < sizeof shares / sizeof *shares; i++)
        *shares[i] = random_share(random);
    v->base_metalness = test_uniform(random, 0, 1) < 0.5 ? v->base_metalness : 0;
    v->specular_weight = v->base_metalness > 0 ? 1 : random_share(random);
    v->specular_ior = test_uniform(random, 1.05, 2.5);
    v->coat_ior = test_uniform(random, 1.05, 2.5);
    v->film_weight = test_uniform(random, 0, 1) < 0.5 ? random_share(random) : 0;
    v->film_thickness = test_uniform(random, 0, 1.5);
    v->film_ior = test_uniform(random, 1.05, 2.5);
    v->subsurface_weight = test_uniform(random, 0, 1) < 0.5 ? random_share(random) : 0;
    v->subsurface_colour = colour_all(1);
    v->subsurface_radius = test_uniform(random, 0, 0.5);
    v->subsurface_anisotropy = test_uniform(random, -0.5, 0.8);
}

/* With a medium inside if `scatters`. */
static void check_random_balls(bool scatters, int count, int seeds, int paths) {
    double mean = 0;
    struct test_random random = {20};
    for (int k = 0; k < count; k++) {
        struct ball ball;
        random_material(&ball, &random);
        if (scatters) {
            ball.numbers.deep = true;
            ball.scattering = test_uniform(&random, 0, 3);
            ball.phase = (struct phase){PHASE_HENYEY_GREENSTEIN, test_uniform(&random, -0.5, 0.8)};
        }
        struct brightness sum = {.mean = 0};
        for (int seed = 1; seed <= seeds; seed++) {
            struct brightness b = ball_brightness(&ball, (uint64_t)seed, paths);
            for (int i = 0; i < TENTHS; i++) {
                sum.tenth[i] += b.tenth[i] / seeds;
                sum.tenth_error[i] += b.tenth_error[i] / seeds;
            }
            sum.mean += b.mean / seeds;
            sum.error += b.error / seeds;
        }
        double root = sqrt(seeds);
        mean += sum.mean / count;
        if (!(fabs(sum.mean - 1) < 0.01 + 4 * sum.error / root))
            test_fail(__FILE__, __LINE__, "material %d: %.4f +- %.4f", k, sum.mean, sum.error / root);
        for (int i = 0; i < TENTHS; i++)
            if (!(fabs(sum.tenth[i] - 1) < 0.04 + 4 * sum.tenth_error[i] / root))
                test_fail(__FILE__, __LINE__, "material %d, tenth %d: %.4f +- %.4f", k, i + 1, sum.tenth[i],
                          sum.tenth_error[i] / root);
    }
    CHECK_NEAR(mean, 1, seeds > 1 ? 0.002 : 0.01);
}

TEST_TIMES(balls_of_random_white_materials_are_invisible_in_uniform_light, 20) {
    check_random_balls(false, 10 * times, times > 1 ? 3 : 1, times > 1 ? 30 : 40);
}

TEST_TIMES(balls_of_random_white_materials_with_media_inside_are_invisible_in_uniform_light, 20) {
    check_random_balls(true, 3 * times, times > 1 ? 3 : 1, times > 1 ? 30 : 40);
}

static struct colour random_colour(struct test_random *random) {
    double r = test_uniform(random, 0, 1), g = test_uniform(random, 0, 1);
    return colour_make(r, g, test_uniform(random, 0, 1));
}

/* Paths of the renderer, under a white sky, through media whose scattering differs by channel. A few rare paths are
 * bright, so its means are less precise than those above. */
TEST(balls_with_white_insides_are_invisible_to_the_renderer_in_uniform_light) {
    const struct effort effort = {8, 128, 1};
    struct test_random random = {23};
    for (int k = 0; k < 5; k++) {
        struct ball ball;
        random_material(&ball, &random);
        struct openpbr *v = &ball.numbers;
        v->deep = true;
        v->transmission_scattering = colour_scale(random_colour(&random), 2);
        v->transmission_anisotropy = test_uniform(&random, -0.5, 0.8);
        struct stage s;
        stage_begin(&s, 1);
        s.light_count = 0;
        s.sky = (struct sky){.kind = SKY_CONSTANT, .colour = colour_all(1)};
        struct material *surface = stage_glass(&s, 0, 0, 1);
        *surface = ball.material;
        (void)stage_sphere(&s, s.root, surface);
        s.camera.fov = 10;
        struct estimate e = estimate_render(&s, &effort, 1000, k + 1);
        if (!(fabs(e.mean - 1) < 0.01 + 4 * e.error && e.error < 0.05))
            test_fail(__FILE__, __LINE__, "material %d: %.4f +- %.4f", k, e.mean, e.error);
        stage_end(&s);
    }
}

/* Under a sky that grows brighter to the top, beside a large lamp. */
TEST_TIMES(balls_of_random_materials_are_the_same_with_and_without_sampled_lights, 50) {
    static const double stops[2][4] = {{-0.5, 0.1, 0.2, 0.3}, {1, 1, 0.8, 0.6}};
    const struct effort effort = {ESTIMATE_SIZE_MAX, times > 1 ? 25 : 12, 1};
    struct test_random random = {times > 1 ? 21 : 22};
    for (int k = 0; k < 4 * times; k++) {
        struct ball ball;
        random_material(&ball, &random);
        struct openpbr *v = &ball.numbers;
        ball.material.phong.kd = random_colour(&random);
        ball.material.phong.ks = random_colour(&random);
        v->transmission_colour = random_colour(&random);
        v->coat_colour = random_colour(&random);
        v->fuzz_colour = random_colour(&random);
        /* Every other one has an inside. */
        if (k % 2 == 0) {
            v->deep = true;
            v->transmission_scattering = random_colour(&random);
            v->transmission_anisotropy = test_uniform(&random, -0.5, 0.8);
            ball.material.phong.absorption = colour_scale(random_colour(&random), 0.5);
        }
        struct stage s;
        stage_begin(&s, 1);
        s.sky = (struct sky){.kind = SKY_STOPS, .stops = stops, .stop_count = 2};
        struct material *surface = stage_glass(&s, 0, 0, 1), *lamp = stage_phong(&s, colour_all(0), colour_all(0), 1);
        *surface = ball.material;
        lamp->phong.emission = colour_all(2);
        (void)stage_sphere(&s, s.root, surface);
        struct node *node = stage_sphere(&s, s.root, lamp);
        stage_scale(&s, node, 1.5, 1.5, 1.5);
        stage_move(&s, node, 2.5, 2, 1);
        s.camera.fov = 10;
        struct estimate by[2];
        for (int i = 0; i < 2; i++) {
            s.settings.path_strategy = i == 0 ? PATH_STRATEGY_MIS : PATH_STRATEGY_BSDF;
            by[i] = estimate_render_twice(&s, &effort, 12, k + 1 + 500 * i);
        }
        estimate_check_equal("random materials: both and BSDFs alone", by[0], by[1], k, times > 1 ? 0.03 : 0.1);
        stage_end(&s);
    }
}

/* --- from inside --- */

/* The weights of the lobes that transmit, without the factors of facets. */
static struct colour passing(const struct bsdf *bsdf) {
    struct colour sum = {0, 0, 0};
    for (int i = 0; i < bsdf->count; i++)
        if (lobe_flags(bsdf->lobes[i].kind) & BSDF_TRANSMITS)
            sum = colour_add(sum, bsdf->lobes[i].weight);
    return sum;
}

TEST(polished_layers_pass_the_same_light_in_and_out) {
    for (double sine = 0.05; sine < 1; sine += 0.1) {
        struct ball ball;
        ball_init(&ball);
        ball.numbers.coat_weight = 0.8;
        ball.numbers.coat_colour = colour_make(0.9, 0.5, 0.2);
        ball.numbers.fuzz_weight = 0.5;
        ball.numbers.base_metalness = 0.1;
        ball.numbers.transmission_colour = colour_make(0.5, 1, 0.7);
        struct media inside = inside_of(&ball);
        struct medium_stack media = {.media = &inside};
        struct vec3 n = {0, 0, 1}, ray = {sine, 0, -sqrt(1 - sine * sine)};
        struct bsdf in = describe(&ball, n, ray, &media);
        medium_stack_cross(&media, &in.boundary);
        struct bsdf out = describe(&ball, n, vec3_negate(in.through), &media);
        struct colour a = passing(&in), b = passing(&out);
        CHECK(a.r > 0.01 && a.r > a.b);
        CHECK_NEAR(out.through.x, -sine, 1e-14);
        CHECK_NEAR(a.r, b.r, 1e-14);
        CHECK_NEAR(a.g, b.g, 1e-14);
        CHECK_NEAR(a.b, b.b, 1e-14);
    }
}

/* The share of uniform light from one side that passes. */
static double passed(struct ball *ball, bool front, int views) {
    double sum = 0;
    for (int i = 0; i < views; i++) {
        struct test_random random = {(uint64_t)i + 1};
        double cosine = sqrt((i + 0.5) / views);
        struct media inside = inside_of(ball);
        struct medium_stack media = {.media = &inside};
        struct vec3 n = {0, 0, 1}, ray = {sqrt(1 - cosine * cosine), 0, front ? -cosine : cosine};
        if (!front)
            medium_stack_enter(&media, 0);
        struct bsdf bsdf = describe(ball, n, ray, &media);
        for (int k = 0; k < 400; k++) {
            struct sample2 u = {(k % 20 + test_uniform(&random, 0, 1)) / 20,
                                test_uniform(&random, k / 20, k / 20 + 1) / 20};
            struct bsdf_sample sample;
            if (bsdf_sample(&bsdf, BSDF_ALL, BSDF_IMPORTANCE, vec3_negate(ray), u, &sample))
                sum += sample.flags & BSDF_TRANSMITS ? sample.weight.g : 0;
        }
    }
    return sum / (400.0 * views);
}

/* Of light that is the same in all directions, the square of the index times as much passes to the inside. */
TEST(rough_layers_pass_the_same_light_in_and_out_within_three_percent) {
    for (int k = 0; k < 8; k++) {
        struct ball ball;
        ball_init(&ball);
        ball.numbers.coat_weight = 1;
        ball.numbers.coat_roughness = k & 1 ? 0.5 : 0;
        ball.numbers.fuzz_weight = k & 2 ? 0.5 : 0;
        ball.material.phong.roughness = k & 4 ? 0.7 : 0.3;
        double in = passed(&ball, true, 100), out = passed(&ball, false, 100);
        CHECK(in > 0.6);
        CHECK_NEAR(2.25 * out / in, 1, 0.03);
    }
}
