/* The choice of a reader. For unknown formats the PNG reader makes the error; it names the probable format. */
#include "image/image_file.h"

#include "base/file.h"
#include "base/mem.h"
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

/* Stricter than the readers where their words are short: what it finds is replaced. */
bool image_is_picture(const uint8_t *head, size_t size) {
    static const struct {
        size_t size;
        const char *bytes;
    } signatures[] = {
        {8, "\x89PNG\r\n\x1a\n"}, {3, "\xff\xd8\xff"}, {10, "#?RADIANCE"}, {6, "#?RGBE"}, {4, "\x76\x2f\x31\x01"},
    };
    for (size_t i = 0; i < sizeof signatures / sizeof *signatures; i++) {
        if (size >= signatures[i].size && memcmp(head, signatures[i].bytes, signatures[i].size) == 0)
            return true;
    }
    return pfm_is(head, size) && size >= 4 && (head[3] == '\n' || (head[3] >= '0' && head[3] <= '9'));
}

struct image *image_read(const char *path, struct error *error) {
    struct file_bytes file;
    uint64_t refusals = mem_refusals();
    if (!file_map(path, FILE_LIMIT, &file, error))
        return NULL;
    struct image *image = image_parse(path, file.data, file.size, error);
    file_unmap(&file);
    if (!image)
        (void)error_of_file(error, path, refusals);
    return image;
}
