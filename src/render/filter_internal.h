/* Reconstruction filters of a pixel, used by importance sampling: samples are placed with a density in proportion to
 * the absolute value of the filter, and count 1 or, where it is negative, -1 (M. Ernst, M. Stamminger and G. Greiner,
 * "Filter Importance Sampling", IEEE Symposium on Interactive Ray Tracing 2006). So a pixel depends on its own samples
 * only, whatever the width of the filter, and tiles stay self-contained. */
#ifndef GRAY_RENDER_FILTER_INTERNAL_H
#define GRAY_RENDER_FILTER_INTERNAL_H

#include "math/sampling.h"
#include "settings/settings.h"

enum { FILTER_CELLS = 256 };

/* A filter f(x) f(y) with f(-x) = f(x). */
struct filter {
    enum filter_kind kind;
    double radius; /* pixels */
    /* Integral of |f| from 0 to cell / FILTER_CELLS * radius, of all 1; unused by the box. */
    double sums[FILTER_CELLS + 1];
    bool negative[FILTER_CELLS];
};

void filter_init(struct filter *filter, enum filter_kind kind);

/* The position of a sample in pixels from the upper left corner of the pixel (its centre is .5, .5), and its weight. */
struct filter_sample {
    double x, y, weight;
};
/* u: a point of the unit square; (.5, .5) is the centre. */
struct filter_sample filter_sample(const struct filter *filter, struct sample2 u);

#endif
