/* Phase functions and the ends of rays in media: closed forms and integrals. */
#include "tests/harness.h"

#include "material/interaction.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

static const struct phase phases[] = {
    {PHASE_HENYEY_GREENSTEIN, 0},     {PHASE_HENYEY_GREENSTEIN, 1e-9}, {PHASE_HENYEY_GREENSTEIN, 0.3},
    {PHASE_HENYEY_GREENSTEIN, -0.75}, {PHASE_HENYEY_GREENSTEIN, 0.97}, {PHASE_RAYLEIGH, 0},
};
enum { PHASES = sizeof phases / sizeof *phases };

/* At an angle whose deflection has this cosine. */
static struct vec3 deflected(double cosine) {
    return vec3_make(sqrt(1 - cosine * cosine), 0, cosine);
}
static const struct vec3 back = {0, 0, -1};

/* The integral of f(cosine) times the phase function over the directions up to a cosine, by Gauss's rule with three
 * points in steps that become small towards +1 and -1. */
static double integral(const struct phase *phase, double until, bool cosine) {
    enum { STEPS = 4000 };
    double sum = 0, end = acos(until);
    for (int i = 0; i < STEPS; i++) {
        double a = pi + (end - pi) * i / STEPS, b = pi + (end - pi) * (i + 1) / STEPS;
        for (int k = -1; k <= 1; k++) {
            double angle = (a + b) / 2 + k * sqrt(0.6) * (b - a) / 2,
                   weight = (k == 0 ? 8.0 / 9 : 5.0 / 9) * (a - b) / 2;
            double c = cos(angle), f = phase_eval(phase, back, deflected(c));
            sum += weight * 2 * pi * sin(angle) * f * (cosine ? c : 1);
        }
    }
    return sum;
}

TEST(phase_functions_scatter_all_light_with_their_mean_cosine) {
    for (int i = 0; i < PHASES; i++) {
        CHECK_NEAR(integral(&phases[i], 1, false), 1, 1e-9);
        CHECK_NEAR(integral(&phases[i], 1, true), phases[i].g, 1e-9);
    }
}

TEST(an_isotropic_phase_function_is_the_same_everywhere) {
    for (int i = -4; i <= 4; i++)
        CHECK_NEAR(phase_eval(&phases[0], back, deflected(i / 4.0)), 1 / (4 * pi), 1e-16);
}

/* The share of the directions below a sampled cosine is the number that it was sampled by. */
TEST(phase_functions_are_sampled_by_the_inverse_of_their_integral) {
    for (int i = 0; i < PHASES; i++) {
        for (double u = 0.0005; u < 1; u += 0.0999) {
            struct vec3 wi = phase_sample(&phases[i], back, (struct sample2){u, 0.37});
            CHECK_NEAR(vec3_length(wi), 1, 1e-12);
            CHECK_NEAR(integral(&phases[i], wi.z, false), u, 1e-8);
        }
    }
}

TEST(phase_functions_have_no_preferred_side) {
    struct vec3 wo = vec3_normalize(vec3_make(0.3, -0.8, 0.4));
    for (int i = 0; i < PHASES; i++) {
        enum { SIDES = 64 };
        struct vec3 sum = {0, 0, 0};
        for (int k = 0; k < SIDES; k++) {
            struct vec3 wi = phase_sample(&phases[i], wo, (struct sample2){0.7, (k + 0.5) / SIDES});
            CHECK_NEAR(phase_eval(&phases[i], wo, wi), phase_eval(&phases[i], wi, wo), 1e-15);
            sum = vec3_add_scaled(sum, wi, 1.0 / SIDES);
        }
        double forward = -vec3_dot(sum, wo);
        CHECK_NEAR(vec3_length(vec3_add_scaled(sum, wo, forward)), 0, 1e-12);
    }
}

TEST(the_ends_of_the_range_of_samples_give_directions) {
    for (int i = 0; i < PHASES; i++) {
        for (int k = 0; k < 4; k++) {
            struct sample2 u = {k & 1 ? 0 : 1 - 0x1p-53, k & 2 ? 0 : 1 - 0x1p-53};
            struct vec3 wi = phase_sample(&phases[i], back, u);
            CHECK_NEAR(vec3_length(wi), 1, 1e-12);
            CHECK(phase_eval(&phases[i], back, wi) > 0);
        }
    }
}

TEST(the_end_of_a_ray_in_a_medium_answers_by_its_phase_function) {
    for (int i = 0; i < PHASES; i++) {
        const struct interaction at = {.lobes = 1, .wo = back, .phase = &phases[i]};
        struct bsdf_sample sample;
        CHECK(interaction_sample(&at, BSDF_RADIANCE, (struct sample2){0.6, 0.2}, &sample));
        double f = phase_eval(&phases[i], back, sample.direction);
        CHECK_NEAR(sample.pdf, f, 0);
        CHECK_NEAR(interaction_pdf(&at, sample.direction), f, 0);
        CHECK_NEAR(interaction_eval(&at, 1, BSDF_RADIANCE, sample.direction).g, f, 0);
        CHECK_NEAR(interaction_eval(&at, 0, BSDF_RADIANCE, sample.direction).g, 0, 0);
        CHECK_NEAR(sample.weight.r, 1, 0);
        CHECK(!(sample.flags & (BSDF_DELTA | BSDF_TRANSMITS | BSDF_REFLECTS)));
    }
}

TEST(the_end_of_a_ray_on_a_surface_answers_by_its_bsdf) {
    struct bsdf bsdf = {
        .count = 1, .normal = {0, 0, 1}, .lit = {0, 0, 1}, .side = {0, 0, 1}, .geometric_side = {0, 0, 1}};
    bsdf.lobes[0] = (struct lobe){.kind = LOBE_DIFFUSE, .weight = {0.2, 0.4, 0.8}};
    const struct interaction at = {.bsdf = &bsdf, .lobes = 1, .wo = vec3_normalize(vec3_make(1, 0, 1))};
    struct bsdf_sample sample, same;
    const struct sample2 u = {0.3, 0.8};
    CHECK(interaction_sample(&at, BSDF_RADIANCE, u, &sample) && bsdf_sample(&bsdf, 1, BSDF_RADIANCE, at.wo, u, &same));
    CHECK_NEAR(vec3_length(vec3_sub(sample.direction, same.direction)), 0, 0);
    CHECK_NEAR(interaction_pdf(&at, sample.direction), bsdf_pdf(&bsdf, 1, at.wo, same.direction), 0);
    CHECK_NEAR(interaction_eval(&at, 1, BSDF_RADIANCE, sample.direction).b, 0.8 * same.direction.z / pi, 1e-15);
}
