/* Any bytes as a Radiance, PFM or EXR picture (Radiance if they begin like none of them): an image whose every
 * level can be looked up, or one line that names the file. */
#include "image/exr.h"
#include "image/float_read_internal.h"
#include "image/levels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct error error = {0};
    struct image *image;
    if (pfm_is(data, size))
        image = image_parse_pfm("fuzz.pfm", data, size, &error);
    else if (exr_is(data, size))
        image = image_parse_exr("fuzz.exr", data, size, &error);
    else
        image = image_parse_hdr("fuzz.hdr", data, size, &error);
    if (image) {
        for (int i = 0; i < 64; i++) {
            struct rgba c =
                image_lookup(image, (struct image_point){i / 8 / 7.0, i % 8 / 7.0, i % 5 * 0.1, i % 3 * 0.2},
                             (struct image_sampling){IMAGE_MIPMAP, IMAGE_REPEAT, IMAGE_CLAMP});
            if (!(c.r >= 0 && c.g >= 0 && c.b >= 0 && c.a == 1))
                abort();
        }
    } else if (error.kind == ERROR_NONE || !strstr(error.text, "fuzz.") || strchr(error.text, '\n')) {
        abort();
    }
    image_release(image);
    return 0;
}
