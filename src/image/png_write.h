/* PNG out: 8-bit RGB through a struct file_output, so the old picture stays until the new one is whole. */
#ifndef GRAY_IMAGE_PNG_WRITE_H
#define GRAY_IMAGE_PNG_WRITE_H

#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

/* rows(context, y, line) fills 3 * width bytes for row y, called once per row from the top. Missing folders of `path`
 * are made. The bytes of the file depend on the pixels only (no time chunk, fixed zlib level and filter). */
bool png_write(const char *path, uint32_t width, uint32_t height,
               void (*rows)(void *context, uint32_t y, uint8_t *line), void *context, struct error *error);
/* The same with 16 bits a channel: rows fills 3 * width words in the machine's own order. */
bool png_write_16(const char *path, uint32_t width, uint32_t height,
                  void (*rows)(void *context, uint32_t y, uint16_t *line), void *context, struct error *error);
/* (Not png_byte: that is a type of libpng.) floor(255 c + 0.5) after clamping to [0,1]; NaN gives 0. */
uint8_t png_write_byte(double c);

#endif
