/* A picture from its start until it is written or cancelled, and the writing of its film as files. */
#ifndef GRAY_OUTPUT_PICTURE_WRITE_H
#define GRAY_OUTPUT_PICTURE_WRITE_H

#include "base/pool.h"
#include "base/share.h"
#include "film/film.h"
#include "film/tile_file.h"
#include "output/picture_files.h"
#include "session/messages.h"
#include "session/options.h"

#include <stdbool.h>

/* The film is owned. */
struct picture {
    bool open;
    char name[NAME_LIMIT];
    struct picture_request request;
    bool written;                                  /* an incomplete picture, for a window */
    bool unfinished;                               /* what is written is an unfinished picture */
    double write_seconds, write_processor_seconds; /* of its files; 0: not written yet */
    struct tile_picture tiles;                     /* the key of its tiles in a tile file */
    struct share memory;
    struct film film;
    const float *alpha;        /* or NULL; of what is written (film_alpha); borrowed */
    const float (*display)[3]; /* or NULL; for a part: its finished numbers for PNG files; borrowed */
};

/* Writes one file. The extension of the target selects the format; every extension except .pfm, .hdr and .exr means
 * PNG. The tone applies only to PNG: the other formats contain light. Views other than FILM_FINAL are not finished.
 * pool: or NULL, for this thread only. */
bool picture_write_view(const struct picture *picture, const struct file_target *target, enum film_view view,
                        struct pool *pool, struct error *error);
/* All files of the picture under that name, denoised if its film has features and the options do not forbid it: itself,
 * its layers, those of -write-...; with --shard the part. */
bool picture_write_files(const struct picture_files *files, const struct picture *picture, const char *name,
                         struct error *error);
/* The rows of its main file as bytes, 3 * width * height, equal to those of a PNG file with 8 bits per channel. */
bool picture_write_bytes(const struct picture_files *files, const struct picture *picture, uint8_t *rgb,
                         struct error *error);
/* How many pixels gray denoises for each pixel of the file: 0, or 1 and more with the rim of a part. */
double picture_denoised_pixels(const struct options *options, const struct picture *picture);

/* A picture whose film borrows from the film of another one. It owns the arrays; each may be NULL. */
struct picture_shown {
    struct picture picture;
    struct film_pixel *pixels;
    float (*display)[3];
    float *floats, *alpha;
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
