/* Pictures of linear light without limits: PFM and Radiance HDR, through a struct file_output. */
#ifndef GRAY_IMAGE_FLOAT_WRITE_H
#define GRAY_IMAGE_FLOAT_WRITE_H

#include "base/error.h"
#include "base/file_output.h"

#include <stdint.h>

typedef void float_rows(void *context, uint32_t y, float *line); /* fills 3 * width floats; row 0 on top */

/* PF, little-endian, rows from the bottom (Debevec's portable float map). */
bool pfm_write(const struct file_target *target, uint32_t width, uint32_t height, float_rows *rows, void *context,
               struct error *error);
/* 32-bit_rle_rgbe, rows from the top, run lengths where the width allows them. Negative light becomes 0. */
bool hdr_write(const struct file_target *target, uint32_t width, uint32_t height, float_rows *rows, void *context,
               struct error *error);
/* Mantissas and common exponent of Ward, "Real Pixels", Graphics Gems II, 1991; rounded down. */
void hdr_pixel(const float rgb[3], uint8_t out[4]);

#endif
