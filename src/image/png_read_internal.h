/* PNG in. */
#ifndef GRAY_IMAGE_PNG_READ_INTERNAL_H
#define GRAY_IMAGE_PNG_READ_INTERNAL_H

#include "image/levels.h"

/* A PNG file in memory: every colour type, bit depth and interlace; texels are not changed by cICP, iCCP, sRGB and gAMA
 * (transfer); tRNS gives alpha. Errors name `path` and what libpng said; sizes over 2^15 per side or 2^28 pixels
 * are errors before memory is allocated. */
struct image *image_parse_png(const char *path, const uint8_t *data, size_t size, struct error *error);

#endif
