/* Means of path-traced pictures beside known values. Pixels have independent random numbers, so their differences give
 * the standard error of the mean of a picture. */
#ifndef GRAY_TESTS_PATH_ESTIMATE_H
#define GRAY_TESTS_PATH_ESTIMATE_H

#include "tests/stage.h"

enum { ESTIMATE_SIZE_MAX = 16 };

/* Pictures of size x size pixels with that many samples each, for the seeds 1 to `seeds`. */
struct effort {
    uint32_t size;
    int samples, seeds;
};
/* The largest standard error as a share of the value: .1 % where there are several seeds (make test-long). */
static inline double effort_precision(const struct effort *effort) {
    return effort->seeds > 1 ? 0.001 : 0.002;
}

struct estimate {
    double mean, error; /* error: standard error of the mean */
};

/* Of a channel of the last picture, all of whose pixels have the same expected value. */
struct estimate estimate_of(const struct stage *s, int channel);
struct estimate estimate_render(struct stage *s, const struct effort *effort, int depth, int seed);
/* Of a picture whose pixels differ: from two pictures with different random numbers. */
struct estimate estimate_render_twice(struct stage *s, const struct effort *effort, int depth, int seed);

/* Appends a comparison as a line to the file that the environment variable GRAY_TEST_VALUES names, if it is set
 * (tools/verification.sh). The checks below do so themselves. */
void estimate_record(const char *claim, double value, struct estimate e, int seed);
/* The standard error is at most this share of the value, and the mean within four of it, with an allowance for the
 * rounding of pixels to float. */
void estimate_check(const char *claim, double value, struct estimate e, int seed, double precision);
/* Two means that agree within four standard errors of their difference; each has a standard error of at most
 * `precision` of its value. */
void estimate_check_equal(const char *claim, struct estimate a, struct estimate b, int seed, double precision);
/* estimate_check for every seed. */
void estimate_check_mean(const char *claim, double value, struct stage *s, const struct effort *effort, int depth);

#endif
