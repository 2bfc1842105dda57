/* The choice of a reader. What no reader knows is told by the PNG reader, which names what it seems to be. */
#include "image/image_file.h"

#include "base/file.h"
#include "image/exr.h"
#include "image/float_read.h"
#include "image/jpeg_read.h"
#include "image/levels.h"

#include <string.h>

#define FILE_LIMIT ((size_t)1 << 32)

struct image *image_parse(const char *path, const uint8_t *data, size_t size, struct error *error) {
    if (size >= 3 && memcmp(data, "\xff\xd8\xff", 3) == 0)
        return image_parse_jpeg(path, data, size, error);
    if (hdr_is(data, size))
        return image_parse_hdr(path, data, size, error);
    if (exr_is(data, size))
        return image_parse_exr(path, data, size, error);
    if (pfm_is(data, size))
        return image_parse_pfm(path, data, size, error);
    return image_parse_png(path, data, size, error);
}

struct image *image_read(const char *path, struct error *error) {
    struct file_bytes file;
    if (!file_map(path, FILE_LIMIT, &file, error))
        return NULL;
    struct image *image = image_parse(path, file.data, file.size, error);
    file_unmap(&file);
    return image;
}
