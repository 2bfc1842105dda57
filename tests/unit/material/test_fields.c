/* Functions of a point or a direction in the place of numbers: fog, skies, colours of lights, against closed forms. */
#include "base/random.h"
#include "expr/expr_field.h"
#include "light/light.h"
#include "light/sky_light_internal.h"
#include "material/fog_field.h"
#include "material/medium.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/function_makers.h"
#include "tests/unit/script_host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static struct vec3 random_direction(struct test_random *random) {
    double z = test_uniform(random, -1, 1), a = test_uniform(random, 0, 2 * pi), r = sqrt(1 - z * z);
    return vec3_make(r * cos(a), r * sin(a), z);
}

/* --- fog --- */

static const struct fog_field *field_of(struct arena *arena, const struct expr_program *density,
                                        const struct expr_program *colour, double half) {
    struct error error = {0};
    const struct fog_field_input in = {.density = density,
                                       .source = "scene.lua:1",
                                       .colour = colour,
                                       .corner = vec3_all(-half),
                                       .size = vec3_all(2 * half)};
    const struct fog_field *field = fog_field_build(arena, &in, &error);
    if (!field)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return field;
}

static double seen(const struct fog_field *field, struct vec3 o, struct vec3 d, double distance) {
    struct colour source;
    return fog_field_transmittance(field, &(struct medium_line){o, d, distance, 0}, &source);
}

/* The part of the line in the cube from -half to half. */
static bool clip(struct vec3 o, struct vec3 d, double half, double *from, double *to) {
    for (int k = 0; k < 3; k++) {
        double a = (-half - vec3_get(o, k)) / vec3_get(d, k), b = (half - vec3_get(o, k)) / vec3_get(d, k);
        *from = fmax(*from, fmin(a, b));
        *to = fmin(*to, fmax(a, b));
    }
    return *from < *to;
}

TEST(fog_of_a_linear_density_transmits_the_exponential_of_its_integral) {
    struct arena arena = {0};
    struct test_random random = {11};
    struct function_maker m;
    const double g[3] = {0.3, -0.2, 0.1}, base = 0.9, half = 1.5; /* at least 0.9 - 0.6 * 1.5 */
    function_begin(&m);
    uint32_t sum = fn_number(&m, base);
    for (int k = 0; k < 3; k++)
        sum = fn_add(&m, sum, fn_scaled(&m, g[k], m.p[k]));
    const struct fog_field *field = field_of(&arena, function_end(&m, sum, &arena), NULL, half);
    int inside = 0;
    for (int i = 0; i < 500; i++) {
        struct vec3 o = vec3_scale(random_direction(&random), test_uniform(&random, 0, 4));
        struct vec3 d = random_direction(&random);
        double from = 0, to = i % 3 ? INFINITY : test_uniform(&random, 0.1, 5), distance = to, depth = 0;
        if (clip(o, d, half, &from, &to)) {
            struct vec3 middle = vec3_add_scaled(o, d, (from + to) / 2);
            depth = (to - from) * (base + g[0] * middle.x + g[1] * middle.y + g[2] * middle.z);
            inside++;
        }
        CHECK_NEAR(seen(field, o, d, distance), exp(-depth), 1e-12);
    }
    CHECK(inside > 150);
    arena_destroy(&arena);
}

/* strength * max(0, 1 - r^2), whose integral over a chord of half length h is strength * 4/3 h^3; or strength inside of
 * the ball, 0 outside: strength * 2 h. */
static const struct fog_field *ball_of_fog(struct arena *arena, double strength, bool has_edge) {
    struct function_maker m;
    function_begin(&m);
    uint32_t inside = fn_scaled(&m, -strength, fn_ball(&m, vec3_all(0), 1, false)), zero = fn_number(&m, 0);
    uint32_t is_inside = fn_two(&m, EXPR_LESS, zero, inside);
    uint32_t density = has_edge ? expr_operation(&m.graph, EXPR_SELECT, is_inside, fn_number(&m, strength), zero)
                                : fn_two(&m, EXPR_MAX, inside, zero);
    return field_of(arena, function_end(&m, density, arena), NULL, 1.3);
}

TEST(balls_of_fog_transmit_by_their_chords) {
    struct arena arena = {0};
    struct test_random random = {12};
    const struct fog_field *soft = ball_of_fog(&arena, 2.5, false), *hard = ball_of_fog(&arena, 0.8, true);
    double worst_soft = 0, worst_hard = 0;
    for (int i = 0; i < 2000; i++) {
        struct vec3 o = vec3_scale(random_direction(&random), 3), to = vec3_scale(random_direction(&random), 1);
        struct vec3 d = vec3_normalize(vec3_sub(to, o));
        double nearest = vec3_length(vec3_cross(o, d)), h = nearest < 1 ? sqrt(1 - nearest * nearest) : 0;
        worst_soft = fmax(worst_soft, fabs(seen(soft, o, d, INFINITY) - exp(-2.5 * 4 / 3 * h * h * h)));
        worst_hard = fmax(worst_hard, fabs(seen(hard, o, d, INFINITY) - exp(-0.8 * 2 * h)));
    }
    CHECK_NEAR(worst_soft, 0, 1e-3);
    CHECK_NEAR(worst_hard, 0, 0.03);
    CHECK_NEAR(seen(hard, vec3_make(0, 1.2, 5), vec3_make(0, 0, -1), INFINITY), 1, 0); /* only empty cells */
    CHECK_NEAR(seen(hard, vec3_make(0, 0, 5), vec3_make(0, 0, -1), 3.9), 1, 0);
    arena_destroy(&arena);
}

/* Half of the chord in a ball around the origin of a line at this distance from it. */
static double half_chord(double radius, double nearest) {
    return nearest < radius ? sqrt(radius * radius - nearest * nearest) : 0;
}

/* A layer of a twentieth of a cell. */
TEST(thin_dense_layers_of_fog_are_not_missed) {
    struct arena arena = {0};
    struct test_random random = {13};
    struct function_maker m;
    const double width = 0.004, strength = 150;
    function_begin(&m);
    uint32_t off = fn_of(&m, EXPR_ABS, fn_ball(&m, vec3_all(0), 1, true));
    uint32_t is_inside = fn_two(&m, EXPR_LESS, off, fn_number(&m, width / 2));
    uint32_t density = expr_operation(&m.graph, EXPR_SELECT, is_inside, fn_number(&m, strength), fn_number(&m, 0));
    const struct fog_field *field = field_of(&arena, function_end(&m, density, &arena), NULL, 1.3);
    double worst = 0, sum = 0;
    for (int i = 0; i < 2000; i++) {
        struct vec3 o = vec3_scale(random_direction(&random), 3), to = vec3_scale(random_direction(&random), 0.9);
        struct vec3 d = vec3_normalize(vec3_sub(to, o));
        double nearest = vec3_length(vec3_cross(o, d));
        double depth = 2 * strength * (half_chord(1 + width / 2, nearest) - half_chord(1 - width / 2, nearest));
        double error = seen(field, o, d, INFINITY) - exp(-depth);
        worst = fmax(worst, fabs(error));
        sum += error;
    }
    if (worst > 0.06 || fabs(sum / 2000) > 0.002)
        test_fail(__FILE__, __LINE__, "errors up to %g, %g in the mean", worst, sum / 2000);
    arena_destroy(&arena);
}

/* With density s and colour x along the x axis: the integral of s e^(-s t) (x0 + t) from 0 to L. */
TEST(fog_with_a_colour_function_adds_the_integral_of_its_emission) {
    struct arena arena = {0};
    struct function_maker m;
    const double s = 1.7, half = 1;
    function_begin(&m);
    const struct expr_program *density = function_end(&m, fn_number(&m, s), &arena);
    function_begin(&m);
    const struct expr_program *colour = function_end(&m, fn_add(&m, m.p[0], fn_number(&m, 1)), &arena);
    const struct fog fog = {.kind = FOG_FIELD, .field = field_of(&arena, density, colour, half)};
    struct medium outside = medium_outside(&fog);
    const struct media media = {NULL, &outside, 0};
    const struct medium_stack open = {.media = &media};
    const struct ray ray = {.origin = {-3, 0.2, 0.1}, .direction = {2, 0, 0}, .t_max = INFINITY, .media = &open};
    struct medium_effect effect;
    CHECK(medium_transmittance(MEDIUM_RAY_SIGHT, &ray, INFINITY, &effect));
    double left = exp(-s * 2), added = (1 - left * (1 + 2 * s)) / s;
    CHECK_NEAR(effect.transmittance.r, left, 1e-12);
    /* Steps of constant colour: their error falls with the square of their number. */
    CHECK_NEAR(effect.source.r * (1 - left), added, 1e-3);
    CHECK_NEAR(fog_field_brightest(fog.field), 2, 1e-6);
    CHECK(!medium_transmittance(MEDIUM_RAY_PHOTON, &ray, INFINITY, &effect));
    arena_destroy(&arena);
}

/* --- directions --- */

TEST(bounds_over_directions_contain_every_direction) {
    struct test_random random = {13};
    for (int i = 0; i < 40; i++) {
        struct arena arena = {0};
        struct function_maker m;
        double largest;
        function_begin(&m);
        const struct expr_program *program = function_end(&m, fn_random_leaf(&m, &random, i % 9), &arena);
        CHECK(expr_field_largest(program, &largest));
        for (int k = 0; k < 2000; k++)
            CHECK(expr_field_at(program, random_direction(&random)).r <= largest);
        arena_destroy(&arena);
    }
    struct arena arena = {0};
    struct function_maker m;
    double largest;
    function_begin(&m);
    CHECK(expr_field_largest(function_end(&m, m.p[1], &arena), &largest) && largest >= 1 && largest < 1.0001);
    arena_destroy(&arena);
}

/* max(0, d.axis)^power */
static const struct expr_program *lobe(struct arena *arena, int axis, double sign, double power) {
    struct function_maker m;
    function_begin(&m);
    uint32_t x = fn_two(&m, EXPR_MAX, fn_scaled(&m, sign, m.p[axis]), fn_number(&m, 0));
    return function_end(&m, fn_two(&m, EXPR_POWER, x, fn_number(&m, power)), arena);
}

/* The sky max(0, y)^3 gives a level surface the integral of cos^4 over the hemisphere, 2 pi / 5. */
TEST(a_sky_function_lights_a_surface_by_its_integral) {
    struct stage s;
    struct error error;
    stage_begin(&s, 1);
    struct sky sky;
    CHECK(sky_from_function(lobe(&s.arena, 1, 1, 3), &sky, &error));
    CHECK_NEAR(sky_colour(&sky, vec3_make(0.6, 0.8, 0), 0).g, 0.512, 1e-15);
    CHECK_NEAR(sky_brightest(&sky), 1, 1e-4);
    struct light light = {.kind = LIGHT_SKY, .emissive = true, .colour = {1, 1, 1}, .sky = &sky};
    struct light_context context;
    CHECK(light_prepare(&light, &s.arena, s.pool, &error));
    CHECK(light_context_make(&light, vec3_all(0), vec3_all(0), &context));
    enum { N = 400 };
    double sum = 0, worst = 0;
    for (int i = 0; i < N * N; i++) {
        struct sample2 xi = {(i % N + 0.5) / N, (i / N + 0.5) / N};
        struct light_sample sample = light_sample(&light, &context, xi);
        double cosine = fmax(0, sample.direction.y);
        sum += sample.radiance.r * cosine / sample.pdf;
        worst = fmax(worst, fabs(light_pdf(&light, &context, sample.direction, NULL) - sample.pdf) / sample.pdf);
    }
    CHECK_NEAR(sum / (N * N), 2 * pi / 5, 1e-3);
    CHECK(worst < 1); /* on the border of cells the neighbour may be taken */
    stage_end(&s);
}

/* A disc of radius r at height h whose radiance falls with cos^n from its normal gives the surface below its middle
 * 2 pi (1 - cos^(n + 2)) / (n + 2), with the cosine of the angle of its rim. */
TEST(lamps_with_a_profile_light_a_surface_by_their_integral) {
    struct arena arena = {0};
    struct error error;
    struct light light = {.kind = LIGHT_DISC, .emissive = true, .one_sided = true, .colour = {2, 1, 1}, .radius = 0.75};
    light.position = vec3_make(0, 1, 0);
    light.direction = vec3_make(0, -1, 0);
    CHECK(light_set_profile(&light, lobe(&arena, 1, -1, 3), &error));
    CHECK(light_prepare(&light, &arena, NULL, &error));
    struct light_context context;
    CHECK(light_context_make(&light, vec3_all(0), vec3_all(0), &context));
    enum { N = 300 };
    double sum = 0;
    for (int i = 0; i < N * N; i++) {
        struct light_sample sample =
            light_sample(&light, &context, (struct sample2){(i % N + 0.5) / N, (i / N + 0.5) / N});
        struct ray ray = {.direction = sample.target.at, .t_max = INFINITY};
        struct light_hit hit;
        sum += sample.radiance.r * sample.direction.y / sample.pdf;
        /* A ray sees what the sample says. */
        if (light_meets_ray(&light, &ray, &hit))
            CHECK_NEAR(light_emitted(&light, &ray, &hit).r, sample.radiance.r, 1e-12);
    }
    double rim = 1 / sqrt(1 + 0.75 * 0.75);
    CHECK_NEAR(sum / (N * N), 2 * 2 * pi * (1 - pow(rim, 5)) / 5, 1e-4);
    arena_destroy(&arena);
}

TEST(lights_without_a_body_have_the_colour_of_their_direction) {
    struct arena arena = {0};
    struct error error;
    struct test_random random = {14};
    struct light light = {.kind = LIGHT_POINT, .colour = {3, 2, 1}, .falloff = {1, 0, 0}, .position = {1, 2, 3}};
    CHECK(light_set_profile(&light, lobe(&arena, 1, -1, 2), &error));
    CHECK_NEAR(light_brightest(&light), 3, 1e-3);
    struct light_emitter emitter;
    CHECK(light_emitter_make(&light, 0, 0, 1, &emitter));
    for (int i = 0; i < 100; i++) {
        struct vec3 d = random_direction(&random), at = vec3_add_scaled(light.position, d, 2);
        double factor = d.y < 0 ? d.y * d.y : 0;
        struct light_arrival arrival;
        struct light_context context;
        CHECK(light_arrive(&light, at, &arrival) && light_context_make(&light, at, at, &context));
        CHECK_NEAR(arrival.colour.r * arrival.strength, 3 * factor, 1e-12);
        CHECK_NEAR(light_sample(&light, &context, (struct sample2){0.5, 0.5}).radiance.g, 2 * factor, 1e-12);
        CHECK_NEAR(light_photon(&emitter, d, (struct sample2){0.5, 0.5}).power.b, factor, 1e-12);
    }
    arena_destroy(&arena);
}

/* A lamp whose light falls with the cosine of its direction. */
TEST(paths_find_lights_without_a_body_in_the_colour_of_their_direction) {
    struct arena arena = {0};
    struct stage s;
    struct error error;
    double light[2];
    stage_floor(&s);
    s.camera = (struct camera){{0, 4, 0}, {0, -1, 0}, {0, 0, -1}, 40};
    s.lights[0] = (struct light){.kind = LIGHT_POINT, .colour = {1, 1, 1}, .falloff = {1, 0, 0}, .position = {0, 2, 0}};
    CHECK(light_set_profile(&s.lights[0], lobe(&arena, 1, -1, 1), &error));
    s.settings.full = true;
    s.settings.path_samples = 16;
    s.settings.max_depth = 1;
    for (int i = 0; i < 2; i++) {
        s.settings.integrator = i ? INTEGRATOR_PATH : INTEGRATOR_WHITTED;
        CHECK(stage_render(&s, 9, 9));
        light[i] = 0;
        for (uint32_t k = 0; k < 81; k++)
            light[i] += stage_pixel(&s, k % 9, k / 9).r / 81;
    }
    CHECK(light[0] > 0.1 && light[0] < 0.9);
    CHECK_NEAR(light[1], light[0], 0.01 * light[0]);
    stage_end(&s);
    arena_destroy(&arena);
}

/* --- the language --- */

static void runs(const char *text) {
    check_corner("", &(struct corner){text, NULL}, NULL);
}

TEST(functions_are_colours_of_lights_skies_and_fogs) {
    runs("gr.light{position = {0, 1, 0}, colour = function(d) return d * 0.5 + 0.5 end}");
    runs("gr.light({0, 1, 0}, function(d) return 1 end)");
    runs("gr.spot_light{position = {0, 1, 0}, colour = gr.fn(function(d) return d.x end)}");
    runs("gr.spherical_light{position = {0, 1, 0}, radius = 1, emission = {1, 1, 1}, colour = function(d) return d.y "
         "end}");
    runs("gr.sky_light(function(d) return {1, d.y, 0} end)");
    runs("gr.sky_light(gr.sky_function{f = function(d) return d.y end, intensity = 2, rotation = 30})");
    runs("gr.fog_field({-1, -1, -1}, 2, function(p, s) return p.x * p.x + s.time end, {1, 1, 1})");
    runs("gr.fog_field{corner = {0, 0, 0}, size = {1, 2, 3}, density = function(p) return p.y end,"
         " colour = function(p, s) return s.view * 0.5 + 0.5 end}");
    /* a unit direction is never longer than 1: the comparison with Lua stays on the sphere */
    runs("gr.sky_light(function(d) if d:length() > 1.001 then error('long') end return d.y end)");
}
