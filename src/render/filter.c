/* The density is constant in each of FILTER_CELLS cells of half the filter, with the filter's integral over the cell,
 * so one table serves every filter. See filter_internal.h. */
#include "render/filter_internal.h"

#include "base/unreachable.h"
#include "math/elementary.h"

#include <math.h>

static double gaussian(double x, double radius) {
    const double falloff = 2;
    return el_exp(-falloff * x * x) - el_exp(-falloff * radius * radius);
}

/* D. Mitchell and A. Netravali, "Reconstruction Filters in Computer Graphics", SIGGRAPH 1988, with B = C = 1/3. */
static double mitchell(double x) {
    if (x < 1)
        return (7 * x * x * x - 12 * x * x + 16.0 / 3) / 6;
    return (-7.0 / 3 * x * x * x + 12 * x * x - 20 * x + 32.0 / 3) / 6;
}

static double filter_radius(enum filter_kind kind) {
    switch (kind) {
    case FILTER_BOX:
        return 0.5;
    case FILTER_TENT:
        return 1;
    case FILTER_GAUSSIAN:
        return 1.5;
    case FILTER_MITCHELL:
        return 2;
    }
    UNREACHABLE("a filter of no kind");
}

static double filter_value(enum filter_kind kind, double x, double radius) {
    switch (kind) {
    case FILTER_BOX:
        return 1;
    case FILTER_TENT:
        return 1 - x;
    case FILTER_GAUSSIAN:
        return gaussian(x, radius);
    case FILTER_MITCHELL:
        return mitchell(x);
    }
    UNREACHABLE("a filter of no kind");
}

void filter_init(struct filter *filter, enum filter_kind kind) {
    double radius = filter_radius(kind), step = radius / FILTER_CELLS;
    filter->kind = kind;
    filter->radius = radius;
    filter->sums[0] = 0;
    for (int i = 0; i < FILTER_CELLS; i++) {
        double begin = filter_value(kind, i * step, radius), middle = filter_value(kind, (i + 0.5) * step, radius),
               end = filter_value(kind, (i + 1) * step, radius), value = (begin + 4 * middle + end) / 6; /* Simpson */
        filter->negative[i] = value < 0;
        filter->sums[i + 1] = filter->sums[i] + fabs(value);
    }
    for (int i = 1; i <= FILTER_CELLS; i++)
        filter->sums[i] /= filter->sums[FILTER_CELLS];
}

/* Inverts the integral from the centre on both sides; the sign goes into *weight. */
static double sample_axis(const struct filter *filter, double u, double *weight) {
    double side = u < 0.5 ? -1 : 1, target = fabs(2 * u - 1);
    int low = 0, high = FILTER_CELLS;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (filter->sums[middle] <= target)
            low = middle;
        else
            high = middle;
    }
    double inside = filter->sums[low + 1] - filter->sums[low];
    double part = inside > 0 ? (target - filter->sums[low]) / inside : 0;
    if (filter->negative[low])
        *weight = -*weight;
    return 0.5 + side * (low + part) * (filter->radius / FILTER_CELLS);
}

struct filter_sample filter_sample(const struct filter *filter, struct sample2 u) {
    struct filter_sample sample = {u.x, u.y, 1};
    if (filter->kind == FILTER_BOX)
        return sample;
    sample.x = sample_axis(filter, u.x, &sample.weight);
    sample.y = sample_axis(filter, u.y, &sample.weight);
    return sample;
}
