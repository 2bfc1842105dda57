/* Pictures of linear light without limits: Radiance HDR and PFM, as images of 32 bits a channel. */
#ifndef GRAY_IMAGE_FLOAT_READ_INTERNAL_H
#define GRAY_IMAGE_FLOAT_READ_INTERNAL_H

#include "base/error.h"
#include "image/image.h"

#include <stddef.h>
#include <stdint.h>

/* Whether bytes begin like one. */
bool hdr_is(const uint8_t *data, size_t size);
bool pfm_is(const uint8_t *data, size_t size);
/* Rows of either direction, run lengths of both kinds, EXPOSURE taken out. Errors name the path: no 32-bit_rle_rgbe,
 * columns first, more pixels than the bytes can hold. */
struct image *image_parse_hdr(const char *path, const uint8_t *data, size_t size, struct error *error);
/* PF and Pf of either byte order; the size of the scale multiplies. NaN and negative light become 0. */
struct image *image_parse_pfm(const char *path, const uint8_t *data, size_t size, struct error *error);

#endif
