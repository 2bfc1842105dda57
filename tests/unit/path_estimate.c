/* See path_estimate.h. */
#include "tests/unit/path_estimate.h"

#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct estimate estimate_of(const struct stage *s, int channel) {
    double sum = 0, squares = 0, count = (double)s->film.width * s->film.height;
    for (size_t i = 0; i < (size_t)s->film.width * s->film.height; i++) {
        double value = (double)s->film.pixels[i].rgb[channel];
        sum += value;
        squares += value * value;
    }
    double variance = (squares - sum * sum / count) / (count - 1);
    return (struct estimate){sum / count, sqrt(variance > 0 ? variance / count : 0)};
}

static void render(struct stage *s, const struct effort *effort, int depth, uint64_t seed) {
    s->settings.integrator = INTEGRATOR_PATH;
    s->settings.path_samples = effort->samples;
    s->settings.max_depth = depth;
    s->settings.seed = seed;
    CHECK(stage_render(s, effort->size, effort->size));
}

struct estimate estimate_render(struct stage *s, const struct effort *effort, int depth, int seed) {
    render(s, effort, depth, (uint64_t)seed);
    return estimate_of(s, 0);
}

struct estimate estimate_render_twice(struct stage *s, const struct effort *effort, int depth, int seed) {
    static struct film_pixel first[ESTIMATE_SIZE_MAX * ESTIMATE_SIZE_MAX];
    size_t count = (size_t)effort->size * effort->size;
    double squares = 0;
    struct estimate a = estimate_render(s, effort, depth, seed + 1000);
    memcpy(first, s->film.pixels, count * sizeof *first);
    struct estimate b = estimate_render(s, effort, depth, seed);
    for (size_t i = 0; i < count; i++)
        squares += pow((double)(s->film.pixels[i].rgb[0] - first[i].rgb[0]), 2);
    return (struct estimate){(a.mean + b.mean) / 2, sqrt(squares) / (2 * (double)count)};
}

void estimate_record(const char *claim, double value, struct estimate e, int seed) {
    const char *name = getenv("GRAY_TEST_VALUES");
    FILE *file = name ? fopen(name, "a") : NULL;
    if (!file)
        return;
    (void)fprintf(file, "%s|%s|%.6f|%.6f|%.6f|%d\n", test_name(), claim, value, e.mean, e.error, seed);
    (void)fclose(file);
}

void estimate_check(const char *claim, double value, struct estimate e, int seed, double precision) {
    estimate_record(claim, value, e, seed);
    if (!(e.error <= precision * value))
        test_fail(__FILE__, __LINE__, "%s, seed %d: standard error %g of %g", claim, seed, e.error, value);
    if (!(fabs(e.mean - value) <= 4 * e.error + 1e-6 * value))
        test_fail(__FILE__, __LINE__, "%s, seed %d: %.7g +- %.2g, not %.7g", claim, seed, e.mean, e.error, value);
}

void estimate_check_equal(const char *claim, struct estimate a, struct estimate b, int seed, double precision) {
    double error = sqrt(a.error * a.error + b.error * b.error);
    estimate_record(claim, 1, (struct estimate){b.mean / a.mean, error / fabs(a.mean)}, seed);
    if (!(a.error <= precision * a.mean && b.error <= precision * b.mean))
        test_fail(__FILE__, __LINE__, "%s, seed %d: standard errors %g and %g of %g", claim, seed, a.error, b.error,
                  a.mean);
    if (!(fabs(a.mean - b.mean) <= 4 * error + 1e-6 * fabs(a.mean)))
        test_fail(__FILE__, __LINE__, "%s, seed %d: %.7g +- %.2g and %.7g +- %.2g", claim, seed, a.mean, a.error,
                  b.mean, b.error);
}

void estimate_check_mean(const char *claim, double value, struct stage *s, const struct effort *effort, int depth) {
    for (int seed = 1; seed <= effort->seeds; seed++)
        estimate_check(claim, value, estimate_render(s, effort, depth, seed), seed, effort_precision(effort));
}
