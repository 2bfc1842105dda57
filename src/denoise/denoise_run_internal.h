/* What the stages of the denoiser share: the planes of a picture and of its coarser level, and what a run has computed.
 */
#ifndef GRAY_DENOISE_DENOISE_RUN_INTERNAL_H
#define GRAY_DENOISE_DENOISE_RUN_INTERNAL_H

#include "denoise/denoise_internal.h"

enum { LEVELS = 2, GLOW = DENOISE_FEATURES };

/* A picture as planes of floats. */
struct level {
    int width, height;
    uint32_t x0, y0;     /* position in the whole picture, in pixels of this level */
    float *colour[2][3]; /* the halves without glow and outliers */
    float *variance[3];  /* of a half */
    float *feature[DENOISE_FEATURES];
    float *estimate[2][3]; /* of the halves */
};

struct denoise_run {
    const struct denoise_source *source;
    struct pool *pool;
    float (*out)[3];
    struct level levels[LEVELS]; /* each level has half of the width and height of the one before */
    struct level *level;         /* the one at work */
    float *loaded[2][3];         /* the colours with outliers */
    float *sampled[3];           /* the variance of a half, from its samples */
    float *evidence;             /* of silhouettes: squared mean residual, in units of its variance; others: -1 */
    float *agreement;            /* the same with the product of the mean residuals of the halves */
    int pass;                    /* of residuals */
    /* Of features and of glow, which is filtered like them: measured values and their variance. */
    float *mean[GLOW + 3], *noise[GLOW + 3];
    float *glow[3];             /* its noise before it is smooth, then glow without noise */
    int first_feature, group;   /* those that are filtered, and how many */
    float **filtered;           /* where to */
    struct denoise_pixel *rows; /* three of each worker */
    struct denoise_scratch *scratch;
    const struct denoise_kernels *kernels;
};

static inline int clamp_int(int x, int low, int high) {
    return x < low ? low : x > high ? high : x;
}

static inline size_t pixel_at(const struct level *d, int x, int y) {
    return (size_t)y * (size_t)d->width + (size_t)x;
}

/* The nearest pixel of the picture. */
static inline size_t nearest_at(const struct level *d, int x, int y) {
    return pixel_at(d, clamp_int(x, 0, d->width - 1), clamp_int(y, 0, d->height - 1));
}

/* Copies a square of a plane; outside of the picture it repeats the nearest pixel. */
static inline float mean_of_halves(const struct level *level, int c, size_t at) {
    return 0.5F * (level->estimate[0][c][at] + level->estimate[1][c][at]);
}

#endif
