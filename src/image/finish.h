/* Finishing: operations on the whole picture after rendering and before writing. Bloom, vignette and gray change light,
 * before exposure and tone curve. Edges and FXAA change the displayed numbers. Dithering rounds these to 8 bits. The
 * zero value changes nothing. Every function is safe for any number. A pixel depends only on pixels at most finish_rim
 * away, and on its position in the whole picture: a part with a rim of that width gives exactly the pixels of the whole
 * picture. */
#ifndef GRAY_IMAGE_FINISH_H
#define GRAY_IMAGE_FINISH_H

#include "base/error.h"
#include "base/list.h"

#include <stdbool.h>
#include <stdint.h>

#define DITHERS(X)                                                                                                     \
    X(DITHER_NONE, "none")                                                                                             \
    X(DITHER_ORDERED, "ordered")                                                                                       \
    X(DITHER_BLUE, "blue")
enum dither { DITHERS(LIST_MEMBER) };

struct finish {
    double bloom;    /* 0..1: the weight of light above white that spreads around it */
    double vignette; /* 0..1: with 1 the corners have a quarter of their light */
    bool gray;       /* luminance */
    bool edges;      /* Sobel's operator */
    bool fxaa;
    enum dither dither; /* of PNG files with 8 bits a channel */
};

/* A part of a picture. */
struct finish_area {
    uint32_t x0, y0, width, height, full_width, full_height;
};

static inline bool finish_changes_light(const struct finish *finish) {
    return finish->bloom > 0 || finish->vignette > 0 || finish->gray;
}
static inline bool finish_changes_display(const struct finish *finish) {
    return finish->edges || finish->fxaa;
}
static inline bool finish_is_plain(const struct finish *finish) {
    return !finish_changes_light(finish) && !finish_changes_display(finish) && finish->dither == DITHER_NONE;
}

/* The number of pixels around a part on which its pixels depend. */
uint32_t finish_rim(const struct finish *finish, uint32_t full_height);
/* rgb: width * height pixels of linear light, top row first. exposure, in stops, defines white. False: no memory. */
bool finish_light(const struct finish *finish, double exposure, const struct finish_area *area, float (*rgb)[3],
                  struct error *error);
/* rgb: the numbers of the picture file, clamped to 0..1. False: no memory. */
bool finish_display(const struct finish *finish, const struct finish_area *area, float (*rgb)[3], struct error *error);

/* The byte for a number in 0..1 (others are clamped, NaN gives 0) at a pixel of the whole picture. Numbers k / 255 give
 * k, and the mean over the mask is the number. ORDERED: B. Bayer, "An optimum method for two-level rendition of
 * continuous-tone pictures", ICC 1973, 8 x 8. BLUE: a mask of 64 x 64 by void-and-cluster (tools/blue_noise.py). NONE:
 * the nearest byte. */
uint8_t dither_byte(enum dither dither, uint32_t x, uint32_t y, double c);

#endif
