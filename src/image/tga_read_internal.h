/* TGA in. */
#ifndef GRAY_IMAGE_TGA_READ_INTERNAL_H
#define GRAY_IMAGE_TGA_READ_INTERNAL_H

#include "image/levels.h"

/* Whether the bytes have the footer of TGA 2, or the name ends in .tga and the header is that of a picture: the format
 * has no first bytes of its own. */
bool tga_is(const char *path, const uint8_t *data, size_t size);
/* Palettes, colours of 15 to 32 bits and gray, plain and in runs, from any corner. Errors name the path. */
struct image *image_parse_tga(const char *path, const uint8_t *data, size_t size, struct error *error);

#endif
