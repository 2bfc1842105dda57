/* What estimates lose at silhouettes; see denoise.c. Functions of a pool over rows; their context is a denoise_run. */
#ifndef GRAY_DENOISE_DENOISE_RESIDUALS_INTERNAL_H
#define GRAY_DENOISE_DENOISE_RESIDUALS_INTERNAL_H

#include <stdint.h>

enum {
    DENOISE_RESIDUAL_WINDOW = 3, /* radius of the mean of residuals */
    DENOISE_EVIDENCE_WINDOW = 6, /* radius of the mean that compares these with their noise */
};

/* Stores mean residuals in `out`. The first pass finds silhouettes. */
void denoise_find_residuals(void *context, uint32_t y, int worker);
/* Adds the residuals; a value remains at least a quarter of what it was. */
void denoise_add_residuals(void *context, uint32_t y, int worker);

#endif
