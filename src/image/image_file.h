/* Pictures of any format that this build reads; the first bytes select the format. */
#ifndef GRAY_IMAGE_IMAGE_FILE_H
#define GRAY_IMAGE_IMAGE_FILE_H

#include "base/error.h"
#include "image/image.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Errors name the path. What JPEG stores is 8 bits a channel, without alpha. */
struct image *image_read(const char *path, struct error *error);
/* From memory; `path` is for messages. */
struct image *image_parse(const char *path, const uint8_t *data, size_t size, struct error *error);
/* Whether a file that begins so (FILE_HEAD_SIZE bytes) is a picture of a format that gray reads or writes. */
bool image_is_picture(const uint8_t *head, size_t size);

#endif
