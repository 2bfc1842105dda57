/* OpenEXR pictures, if the C library of OpenEXR was found when gray was built (HAVE_EXR). */
#ifndef GRAY_IMAGE_EXR_H
#define GRAY_IMAGE_EXR_H

#include "base/error.h"
#include "base/file_output.h"
#include "image/float_write.h"
#include "image/image.h"

#include <stddef.h>
#include <stdint.h>

/* "OpenEXR 3.1.5" or "none". */
const char *exr_library(void);
bool exr_can_write(void);
/* Scan lines of floats R, G, B, zip-compressed. Errors: no library, no memory, the file. */
bool exr_write(const struct file_target *target, uint32_t width, uint32_t height, float_rows *rows, void *context,
               struct error *error);
/* A named channel ("depth.Z" is the channel Z of the layer depth) in memory: the value of pixel x, y is
 * values[(y * width + x) * stride]. */
struct exr_channel {
    const char *name;
    const float *values;
    uint32_t stride;
};
/* The same with any channels, at most EXR_CHANNELS. */
enum { EXR_CHANNELS = 64 };
bool exr_write_channels(const struct file_target *target, uint32_t width, uint32_t height,
                        const struct exr_channel *channels, uint32_t count, struct error *error);
bool exr_is(const uint8_t *data, size_t size);
/* The display window of the first part, black outside of the data window, in scan lines or tiles (of these the largest
 * level): R, G, B, or Y with RY and BY or without; other channels are ignored. NaN and negative light become 0. Errors
 * name the path. */
struct image *image_parse_exr(const char *path, const uint8_t *data, size_t size, struct error *error);

#endif
