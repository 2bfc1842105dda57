/* Tracking through media whose density depends on the point, against closed forms and quadrature. */
#include "tests/harness.h"

#include "material/medium_mix.h"
#include "tests/unit/function_makers.h"

#include <math.h>

/* Along x from -1 to 1 the density is x + 1. */
static const struct density *slope_of(struct arena *arena, double looseness, double bound) {
    struct function_maker maker;
    struct error error = {0};
    function_begin(&maker);
    const struct expr_program *program = function_end(&maker, fn_add(&maker, maker.p[0], fn_number(&maker, 1)), arena);
    const struct fog_field_input field = {
        .density = program, .source = "scene.lua:1", .corner = vec3_all(-1), .size = vec3_all(2)};
    const struct density *density =
        density_of_function(arena, &(struct density_function){&field, bound, looseness}, &error);
    CHECK(density != NULL);
    return density;
}

/* The same as voxels; the first and the last half voxel are constant. */
static const struct density *slope_of_grid(struct arena *arena, double looseness) {
    enum { N = 200 };
    struct error error = {0};
    float *values = arena_alloc_array(arena, N, sizeof *values);
    for (int i = 0; i < N; i++)
        values[i] = (float)((i + 0.5) * 2 / N);
    const struct density_grid grid = {{vec3_all(-1), vec3_all(1)}, {N, 1, 1}, values, looseness, false};
    const struct density *density = density_of_grid(arena, &grid, &error);
    CHECK(density != NULL);
    return density;
}

static struct medium medium_by(const struct density *density, struct colour absorption, struct colour scattering,
                               struct colour emission) {
    return medium_scattering(&(struct medium_input){
        .absorption = absorption, .scattering = scattering, .emission = emission, .density = density});
}

struct means {
    struct colour passed, scattered, emitted, squares, left; /* squares: of emitted */
};

/* Of many paths. passed: the weight of those that come to the end. */
static struct means track(const struct medium_mix *mix, const struct medium_line *line, int count) {
    struct means means = {.left = {0, 0, 0}};
    for (int i = 0; i < count; i++) {
        uint64_t key = random_combine(77, (uint64_t)i);
        const struct medium_draw draw = {
            {random_unit(random_combine(key, 1)), random_unit(random_combine(key, 2))}, random_combine(key, 3), NULL};
        struct medium_track out;
        medium_mix_track(mix, line, colour_make(1, 1, 1), draw, &out);
        struct colour *sum = out.scatterer ? &means.scattered : &means.passed;
        *sum = colour_add_scaled(*sum, out.weight, 1.0 / count);
        means.emitted = colour_add_scaled(means.emitted, out.emitted, 1.0 / count);
        means.squares = colour_add_scaled(means.squares, colour_mul(out.emitted, out.emitted), 1.0 / count);
        means.left = colour_add_scaled(means.left, medium_mix_left(mix, line, random_combine(key, 4)), 1.0 / count);
        CHECK(out.distance <= line->distance);
        /* The sum of the throughput never grows. */
        CHECK(out.weight.r + out.weight.g + out.weight.b <= 3 * (1 + 1e-12));
    }
    return means;
}

static void check_colour(struct colour found, struct colour expected, double tolerance) {
    CHECK_NEAR(found.r, expected.r, tolerance);
    CHECK_NEAR(found.g, expected.g, tolerance);
    CHECK_NEAR(found.b, expected.b, tolerance);
}

/* By function and by grid, with bounds that are too large by any factor. */
TEST_TIMES(what_tracking_leaves_is_beers_law_whatever_the_bounds, 20) {
    const double looseness[] = {1, 2, 10};
    const struct medium_line line = {{-3, 0.2, -0.1}, {1, 0, 0}, 3.5, 0};
    const double depth = 1.5 * 1.5 / 2; /* up to x = 0.5 */
    const int count = 20000 * times;
    for (int grid = 0; grid < 2; grid++) {
        for (int i = 0; i < 3; i++) {
            struct arena arena = {0};
            const struct medium medium =
                medium_by(grid ? slope_of_grid(&arena, looseness[i]) : slope_of(&arena, looseness[i], INFINITY),
                          colour_make(0.1, 0, 0.5), colour_make(0.4, 1, 2.5), colour_all(0));
            const struct medium_mix mix = {1, {&medium}};
            const struct means means = track(&mix, &line, count);
            const struct colour left = {exp(-0.5 * depth), exp(-depth), exp(-3 * depth)};
            check_colour(means.passed, left, 4 * 0.6 / sqrt(count));
            check_colour(means.left, left, 4 * 0.4 / sqrt(count));
            check_colour(medium_mix_dimmed(&mix, &line), left, 2e-4);
            const struct colour albedo = {0.8, 1, 2.5 / 3};
            check_colour(means.scattered, colour_mul(albedo, colour_sub(colour_all(1), left)), 4 * 1.0 / sqrt(count));
            arena_destroy(&arena);
        }
    }
}

/* e / s (1 - exp(-s d)) of each channel, for any absorption, also none; s d is the depth. */
TEST_TIMES(tracking_finds_the_emission_of_a_medium, 20) {
    const struct medium_line line = {{-1, 0, 0}, {1, 0, 0}, 5, 0};
    const struct colour absorption = {0, 0.5, 4}, scattering = {0, 0.5, 1};
    const double depth = 2; /* of the whole box */
    const int count = 20000 * times;
    struct arena arena = {0};
    const struct medium medium = medium_by(slope_of(&arena, 1, INFINITY), absorption, scattering, colour_all(1));
    const struct medium outer = medium_by(NULL, colour_all(0), colour_all(0), colour_all(0.25));
    for (int both = 0; both < 2; both++) {
        const struct medium_mix mix = {both ? 2 : 1, {&medium, &outer}};
        struct colour expected;
        double *out[3] = {&expected.r, &expected.g, &expected.b};
        for (int k = 0; k < 3; k++) {
            double s = colour_get(absorption, k) + colour_get(scattering, k), left = exp(-s * depth);
            *out[k] = s > 0 ? (1 - left) / s : depth;
            /* What is outer adds along the whole line: through the box by quadrature, then 3 behind it. */
            enum { STEPS = 4000 };
            double sum = 3 * left;
            for (int i = 0; i < STEPS; i++) {
                double x = 2 * (i + 0.5) / STEPS;
                sum += exp(-s * x * x / 2) * 2 / STEPS;
            }
            *out[k] += both ? 0.25 * sum : 0;
        }
        const struct means means = track(&mix, &line, count);
        for (int k = 0; k < 3; k++) {
            double mean = colour_get(means.emitted, k), variance = colour_get(means.squares, k) - mean * mean;
            CHECK(variance < 12);
            CHECK_NEAR(mean, colour_get(expected, k), 4 * sqrt(variance / count));
        }
    }
    arena_destroy(&arena);
}

/* Two media in one point are one of the sum, each with its own colour of scattering. */
TEST_TIMES(media_that_overlap_add, 20) {
    const struct medium_line line = {{-1, 0, 0}, {1, 0, 0}, 2, 0};
    const int count = 20000 * times;
    struct arena arena = {0};
    struct error error = {0};
    const struct box box = {{0, -INFINITY, -INFINITY}, {INFINITY, 9, 9}};
    const struct medium slope =
        medium_by(slope_of(&arena, 1, INFINITY), colour_all(0), colour_make(0.5, 1, 0), colour_all(0));
    const struct medium half =
        medium_by(density_of_box(&arena, &box, &error), colour_all(0.25), colour_make(0, 0.25, 1), colour_all(0));
    const struct medium_mix mix = {2, {&slope, &half}};
    const struct colour depth = {0.5 * 2 + 0.25, 2 + 0.5, 1.25};
    const struct colour left = {exp(-depth.r), exp(-depth.g), exp(-depth.b)};
    const struct means means = track(&mix, &line, count);
    check_colour(means.passed, left, 4 * 0.6 / sqrt(count));
    check_colour(means.left, left, 4 * 0.3 / sqrt(count));
    check_colour(medium_mix_dimmed(&mix, &line), left, 1e-9);
    /* Of blue only the half space scatters. */
    CHECK_NEAR(means.scattered.b, (1 - left.b) / 1.25, 4 * 1.0 / sqrt(count));
    arena_destroy(&arena);
}

TEST(densities_above_their_bound_count_as_the_bound_and_the_first_cell_is_noted) {
    const struct medium_line line = {{-1, 0, 0}, {1, 0, 0}, 2, 0};
    struct arena arena = {0};
    struct box cell;
    double bound;
    const struct density *density = slope_of(&arena, 1, 1);
    const struct medium medium = medium_by(density, colour_all(1), colour_all(0), colour_all(0));
    const struct medium_mix mix = {1, {&medium}};
    CHECK(!density_excess(density, &cell, &bound));
    check_colour(track(&mix, &line, 20000).left, colour_all(exp(-1.5)), 0.012);
    CHECK(density_excess(density, &cell, &bound));
    CHECK_NEAR(bound, 1, 0);
    CHECK_NEAR(cell.min.x, 0, 1e-12);
    CHECK_NEAR(cell.max.x, 2.0 / 32, 1e-12);
    arena_destroy(&arena);
}
