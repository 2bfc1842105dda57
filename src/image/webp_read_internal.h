/* WebP in, by libwebp, if the build found it. */
#ifndef GRAY_IMAGE_WEBP_READ_INTERNAL_H
#define GRAY_IMAGE_WEBP_READ_INTERNAL_H

#include "image/levels.h"

/* Whether bytes begin like one. */
bool webp_is(const uint8_t *data, size_t size);
/* The picture, or the first frame of an animation. Errors name the path. */
struct image *image_parse_webp(const char *path, const uint8_t *data, size_t size, struct error *error);

#endif
