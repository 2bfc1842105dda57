/* Denoising of a path-traced picture: first-order regression on features with weights of non-local means (B.
 * Bitterli et al., "Nonlinearly Weighted First-order Regression for Denoising Monte Carlo Renderings", EGSR 2016; F.
 * Rousselle, M. Manzi, M. Zwicker, "Robust Denoising using Feature and Color Information", Pacific Graphics 2013).
 *
 * A pixel depends only on pixels at most DENOISE_RIM away in each direction. So a part with a rim of that width, or
 * at the edge of the picture, gets the same values as in the whole picture. */
#ifndef GRAY_DENOISE_DENOISE_H
#define GRAY_DENOISE_DENOISE_H

#include "base/error.h"
#include "base/pool.h"

#include <stdbool.h>
#include <stdint.h>

enum denoise_feature {
    DENOISE_ALBEDO,     /* 3 channels, 0 to 1 */
    DENOISE_NORMAL = 3, /* 3 */
    DENOISE_DEPTH = 6,  /* along the ray, world units */
    DENOISE_FEATURES
};

/* The measurements of a pixel by two independent halves of its samples. All numbers are finite. */
struct denoise_pixel {
    float colour[2][3];
    float features[2][DENOISE_FEATURES];
    float glow[2]
              [3]; /* the part of the colour of directly visible lamps and skies: noisy only where they are blurred */
    float share;   /* weight of half 0 in the picture, 0 to 1; the rest belongs to half 1 */
    float variance[3]; /* variance of the mean of all samples, as if they were independent; at least 0 */
};

/* A picture, or a part of one. */
struct denoise_source {
    uint32_t width, height;
    uint32_t x0, y0; /* position in the whole picture */
    /* Returns the pixels of row y, counted from 0; called from any thread. */
    void (*row)(void *context, uint32_t y, struct denoise_pixel *row);
    void *context;
};

enum { DENOISE_RIM = 60 };

/* Denoises into out[width * height]. The same bytes for any number of threads. Errors: no memory, cancelled. */
bool denoise(const struct denoise_source *source, struct pool *pool, float (*out)[3], struct error *error);

#endif
