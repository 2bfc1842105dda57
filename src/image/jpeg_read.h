/* Reading JPEG with libjpeg (libjpeg-turbo), if the build found it. */
#ifndef GRAY_IMAGE_JPEG_READ_H
#define GRAY_IMAGE_JPEG_READ_H

#include "base/error.h"
#include "image/image.h"

#include <stddef.h>
#include <stdint.h>

/* Gray, YCbCr, RGB, CMYK and YCCK, baseline and progressive; truncated and damaged files are errors. `path` is for
 * messages. In a build without libjpeg every file is an error that says so. */
struct image *image_parse_jpeg(const char *path, const uint8_t *data, size_t size, struct error *error);
/* The text of --version: "libjpeg 62 (libjpeg-turbo 2.1.5)" or "none". */
const char *jpeg_library(void);

#endif
