/* The formats of pictures that gray writes: one list makes names, help and messages, and one function writes a file. */
#ifndef GRAY_IMAGE_PICTURE_FILE_H
#define GRAY_IMAGE_PICTURE_FILE_H

#include "base/error.h"
#include "base/file_output.h"
#include "base/list.h"
#include "base/pool.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Formats with their extensions: of numbers for a display, and of linear light without limits. */
#define DISPLAY_FORMATS(X) X(PICTURE_PNG, ".png")
#define LIGHT_FORMATS(X)                                                                                               \
    X(PICTURE_PFM, ".pfm") X(PICTURE_HDR, ".hdr") X(PICTURE_EXR, ".exr") X(PICTURE_LIGHT_FIELD, ".lf")
#define PICTURE_FORMATS(X) DISPLAY_FORMATS(X) LIGHT_FORMATS(X)
/* PICTURE_OTHER: any other name, which is PNG. */
enum picture_format { PICTURE_FORMATS(LIST_MEMBER) PICTURE_OTHER };
/* For help, after a colon. */
#define PICTURE_FORMATS_HELP DISPLAY_FORMATS(LIST_BLANK_WORD) ", for linear light" LIGHT_FORMATS(LIST_BLANK_WORD)

/* By the extension of the name, in upper or lower case. */
enum picture_format picture_format(const char *name);
/* All extensions in a sentence: ".png, .pfm or .exr". */
enum { PICTURE_EXTENSIONS_SIZE = 128 };
const char *picture_extensions(char out[PICTURE_EXTENSIONS_SIZE]);
/* Whether a file that begins so (FILE_HEAD_SIZE bytes) is a picture of a format that gray reads or writes. Stricter
 * than the readers for short signatures, because a new picture may replace such a file. */
bool picture_file_is(const uint8_t *head, size_t size);

struct light_field_head;
/* The rows of a picture, from the top: each function fills the 3 * width numbers of row y. */
struct picture_source {
    uint32_t width, height;
    void (*bytes)(void *context, uint32_t y, uint8_t *line);
    void (*words)(void *context, uint32_t y, uint16_t *line);
    void (*light)(void *context, uint32_t y, float *line); /* linear, without limits */
    void *context;
    bool deep;                            /* 16 bits per channel, if the format has them */
    bool srgb;                            /* bytes and words are encoded with the sRGB function */
    bool unfinished;                      /* see struct png_source */
    bool alpha;                           /* bytes and words have 4 numbers a pixel; only for PNG */
    const struct light_field_head *field; /* of a picture that shows the views of a light field; or NULL */
};

/* Writes a file in the format of its name. With a pool, its threads may request rows at the same time. */
bool picture_file_write(const struct file_target *target, const struct picture_source *source, struct pool *pool,
                        struct error *error);

#endif
