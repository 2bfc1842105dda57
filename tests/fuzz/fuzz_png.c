/* Any bytes as a PNG file: an image whose every level can be looked up anywhere, or one line that names the file. If
 * the last byte is odd, the checksums of the chunks are corrected first; otherwise hardly any input would pass them. */
#include "image/levels.h"
#include "image/png_read_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void repair(uint8_t *bytes, size_t size) {
    for (size_t at = 8; at + 12 <= size;) {
        size_t length =
            (size_t)bytes[at] << 24 | (size_t)bytes[at + 1] << 16 | (size_t)bytes[at + 2] << 8 | bytes[at + 3];
        if (length > size - at - 12)
            return;
        unsigned long sum = crc32(0, bytes + at + 4, (unsigned)length + 4);
        for (size_t i = 0; i < 4; i++)
            bytes[at + 8 + length + i] = (uint8_t)(sum >> (24 - 8 * i));
        at += length + 12;
    }
}

static void lookup_everywhere(const struct image *image) {
    static const double coordinates[] = {0, 1, 0.5, -0.25, 1e300, -1e-300, 3.75, INFINITY, NAN};
    static const double widths[] = {0, 1e-9, 0.1, 1, 1e9, INFINITY, NAN};
    for (size_t i = 0; i < sizeof coordinates / sizeof coordinates[0]; i++)
        for (size_t k = 0; k < sizeof widths / sizeof widths[0]; k++)
            for (int mode = 0; mode < 9; mode++) {
                struct rgba c =
                    image_lookup(image, (struct image_point){coordinates[i], coordinates[k], widths[k], widths[i % 7]},
                                 (struct image_sampling){(enum image_filter)(mode % 3), (enum image_wrap)(mode / 3),
                                                         (enum image_wrap)(mode % 3)});
                if (!(c.r >= 0 && c.r <= c.a && c.g >= 0 && c.g <= c.a && c.b >= 0 && c.b <= c.a && c.a <= 1))
                    abort();
            }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    uint8_t *bytes = malloc(size + 1);
    if (!bytes)
        return 0;
    if (size)
        memcpy(bytes, data, size);
    if (size && data[size - 1] % 2)
        repair(bytes, size);
    struct error error = {0};
    struct image *image = image_parse_png("fuzz.png", bytes, size, &error);
    free(bytes);
    if (image)
        lookup_everywhere(image);
    else if (error.kind == ERROR_NONE || !strstr(error.text, "fuzz.png") || strchr(error.text, '\n'))
        abort();
    image_release(image);
    return 0;
}
