/* PNG out: RGB through a struct file_output, so the old picture stays until the new one is whole. */
#ifndef GRAY_IMAGE_PNG_WRITE_H
#define GRAY_IMAGE_PNG_WRITE_H

#include "base/error.h"
#include "base/file_output.h"
#include "base/pool.h"

#include <stdbool.h>
#include <stdint.h>

/* Where the rows come from: bytes(context, y, line) fills 3 * width bytes for row y, words the same with 16 bits a
 * channel in the machine's own order; one of the two. */
struct png_source {
    uint32_t width, height;
    void (*bytes)(void *context, uint32_t y, uint8_t *line);
    void (*words)(void *context, uint32_t y, uint16_t *line);
    void *context;
};

/* Missing folders of the target are made. The bytes of the file depend on the pixels only. With a pool its threads ask
 * for rows at the same time; without one they come once each from the top. */
bool png_write_from(const struct file_target *target, const struct png_source *rows, struct pool *pool,
                    struct error *error);
/* Into how many parts a picture of that size falls: more threads have nothing to do. Sides from 1. */
uint32_t png_write_stripes(uint32_t width, uint32_t height, int bits);

/* Seconds of processor time that packing such a picture takes this thread; nothing is written. Negative: no memory. */
double png_write_trial(const struct png_source *source);

/* Writing in this thread alone, with 8 and with 16 bits. */
bool png_write(const struct file_target *target, uint32_t width, uint32_t height,
               void (*rows)(void *context, uint32_t y, uint8_t *line), void *context, struct error *error);
bool png_write_16(const struct file_target *target, uint32_t width, uint32_t height,
                  void (*rows)(void *context, uint32_t y, uint16_t *line), void *context, struct error *error);
/* (Not png_byte: that is a type of libpng.) floor(255 c + 0.5) after clamping to [0,1]; NaN gives 0. */
uint8_t png_write_byte(double c);

#endif
