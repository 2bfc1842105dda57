/* Writing PNG: through a struct file_output the old picture stays until the new one is complete. */
#ifndef GRAY_IMAGE_PNG_WRITE_H
#define GRAY_IMAGE_PNG_WRITE_H

#include "base/error.h"
#include "base/file_output.h"
#include "base/pool.h"

#include <stdbool.h>
#include <stdint.h>

/* The source of the rows: bytes(context, y, line) fills 3 * width bytes, with alpha 4 * width, for row y, words the
 * same with 16 bits per channel in native byte order; one of the two. */
struct png_source {
    uint32_t width, height;
    void (*bytes)(void *context, uint32_t y, uint8_t *line);
    void (*words)(void *context, uint32_t y, uint16_t *line);
    void *context;
    bool alpha;      /* the fourth number of a pixel; colours are not multiplied by it */
    bool srgb;       /* the numbers are encoded with the sRGB function: the file states it */
    bool unfinished; /* the file states that, too: png_is_unfinished */
};

/* Receives the bytes of a file, one piece after the other. */
typedef bool png_sink(void *sink, const void *bytes, size_t size, struct error *error);
/* Sides from 1 to 2^28 pixels. */
bool png_encode(const struct png_source *rows, struct pool *pool, png_sink *put, void *sink, struct error *error);
/* Creates missing folders of the target. The bytes of the file depend only on the pixels. With a pool, its threads
 * request rows at the same time; without one, each row is requested once, from the top. */
bool png_write_from(const struct file_target *target, const struct png_source *rows, struct pool *pool,
                    struct error *error);
/* Whether a file that begins so (FILE_HEAD_SIZE bytes) was written as unfinished. */
bool png_is_unfinished(const uint8_t *head, size_t size);
/* The number of stripes of a picture of that size: more threads have no work. Sides from 1. */
uint32_t png_write_stripes(uint32_t width, uint32_t height, int bits);

/* (Not png_byte: that is a type of libpng.) floor(255 c + 0.5) after clamping to [0,1]; NaN gives 0. */
uint8_t png_write_byte(double c);

#endif
