/* BMP in. */
#ifndef GRAY_IMAGE_BMP_READ_INTERNAL_H
#define GRAY_IMAGE_BMP_READ_INTERNAL_H

#include "image/levels.h"

/* Whether bytes begin like one. */
bool bmp_is(const uint8_t *data, size_t size);
/* Palettes of up to 8 bits, 16, 24 and 32 bits, runs of 4 and 8 bits, masks of bits, alpha where a mask states it;
 * headers of Windows and of OS/2; rows of either direction. Errors name the path. */
struct image *image_parse_bmp(const char *path, const uint8_t *data, size_t size, struct error *error);

#endif
