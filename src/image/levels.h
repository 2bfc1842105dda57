/* The inside of an image, for src/image and for filters of more than a rectangle (the sky's cube): the mip levels and
 * their texels.
 *
 * Every level keeps straight (not premultiplied) RGBA, so that an image of one colour has exactly that colour in every
 * level. Level 0 has the file's 8 or 16 bits; the levels above always have 16, so that rounding does not add up from
 * level to level. High dynamic range images have floats in every level, where 1 corresponds to 65535 elsewhere.
 * Everything is measured in "units": 0 .. 65535 for a channel, premultiplied colours and alpha in units squared (alpha
 * times 65535). A double holds all of these exactly. */
#ifndef GRAY_IMAGE_LEVELS_H
#define GRAY_IMAGE_LEVELS_H

#include "base/error.h"
#include "image/image.h"

#include <stdatomic.h>
#include <stdint.h>

enum { IMAGE_MAX_LEVELS = 17, IMAGE_MAX_SIDE = 1 << 15, IMAGE_MAX_TEXELS = 1 << 28 };

struct image_level {
    uint32_t width, height;
    void *texels; /* uint8_t[4], uint16_t[4] or float[4] each, row-major; points into the image's one block */
};

/* The result of image_largest, once it is known. The thread that changes the state to SETTING writes it. */
enum image_memo_state { IMAGE_MEMO_UNKNOWN, IMAGE_MEMO_SETTING, IMAGE_MEMO_KNOWN };
struct image_memo {
    _Atomic int state;
    struct rgba largest;
};

/* Immutable once built, except the memo. Owns `block` (all levels), `memo` and `name`. */
struct image {
    _Atomic uint32_t owners;
    int bits; /* of level 0: 8, 16 or 32 (float) */
    int level_count;
    struct image_level levels[IMAGE_MAX_LEVELS];
    void *block;
    size_t block_size;
    struct image_memo *memo;
    char *name;
    struct transfer_function
        transfer;                /* as its file states it; of the results of image_decode: that which was decoded */
    char *colours;               /* what image_colours returns, or NULL; owned */
    struct image *decoded;       /* the first result of image_decode, in which it is the next one; owned */
    struct image_ranges *ranges; /* of image_make_ranges (image_function.h), or NULL; owned */
};

/* All levels allocated, texels not yet set: fill level 0, then call image_build_levels. NULL without memory or when the
 * size is refused. */
struct image *image_allocate(const char *name, uint32_t width, uint32_t height, int bits, struct error *error);
bool image_build_levels(struct image *image, struct error *error);
/* The image with its levels; NULL, after releasing it, if it was not read (`ok`), or without memory. */
struct image *image_finish(struct image *image, bool ok, struct error *error);
/* Of 8 bits: opaque if alpha is 0 everywhere, as programs write it that do not know alpha. */
void image_fill_empty_alpha(struct image *image);
/* One texel, premultiplied, in units squared. */
static inline struct rgba image_level_texel(const struct image *image, int level, uint32_t x, uint32_t y) {
    const struct image_level *l = &image->levels[level];
    size_t at = ((size_t)y * l->width + x) * 4;
    double r, g, b, a;
    if (image->bits == 32) {
        const float *t = (const float *)l->texels + at;
        r = 65535 * (double)t[0], g = 65535 * (double)t[1], b = 65535 * (double)t[2], a = 65535 * (double)t[3];
    } else if (level == 0 && image->bits == 8) {
        const uint8_t *t = (const uint8_t *)l->texels + at;
        r = (double)(t[0] * 257), g = (double)(t[1] * 257), b = (double)(t[2] * 257), a = (double)(t[3] * 257);
    } else {
        const uint16_t *t = (const uint16_t *)l->texels + at;
        r = (double)t[0], g = (double)t[1], b = (double)t[2], a = (double)t[3];
    }
    return (struct rgba){r * a, g * a, b * a, a * 65535};
}

/* From units squared to 0..1. */
static inline struct rgba image_from_units(struct rgba c) {
    const double one = 65535.0 * 65535.0;
    return (struct rgba){c.r / one, c.g / one, c.b / one, c.a / one};
}

/* a + (b - a) t: gives a exactly where a = b, so constant pictures stay constant. */
static inline struct rgba image_mix(struct rgba a, struct rgba b, double t) {
    return (struct rgba){a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t, a.a + (b.a - a.a) * t};
}

#endif
