/* The contents of the files of a picture, from its film: the requested part, denoised if the film has features, and
 * finished. */
#ifndef GRAY_OUTPUT_PICTURE_SHOWN_INTERNAL_H
#define GRAY_OUTPUT_PICTURE_SHOWN_INTERNAL_H

#include "base/pool.h"
#include "output/picture_write.h"
#include "session/options.h"

#include <stdbool.h>

/* A picture whose film borrows from the film of another one. It owns the arrays; each may be NULL. */
struct picture_shown {
    struct picture picture;
    struct film_pixel *pixels;
    float (*display)[3];
    float *floats;
    uint8_t *marked;
    float (*layers)[3];
};

/* How a picture is denoised. DENOISER_NONE shows the film as it is, and so does a film without features. */
struct denoising {
    enum denoiser denoiser;
    struct pool *pool;                      /* of DENOISER_GRAY */
    const struct file_interrupt *interrupt; /* of DENOISER_OIDN; or NULL */
};

/* NULL: an error, no memory, interrupted; with DENOISER_OIDN that the program is missing or has failed. It is not on
 * the stack, which may be small. */
struct picture_shown *picture_shown_make(const struct picture *picture, struct denoising denoising,
                                         struct error *error);
/* shown: or NULL. */
void picture_shown_destroy(struct picture_shown *shown);

#endif
