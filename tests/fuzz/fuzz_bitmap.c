/* Any bytes as a BMP, WebP or TGA (TGA if they begin like none of them): a picture, or one line that names the file. */
#include "image/image.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct error error = {0};
    struct image *image = image_parse("fuzz.tga", data, size, &error);
    if (!image && (error.kind == ERROR_NONE || !strstr(error.text, "fuzz.tga") || strchr(error.text, '\n')))
        abort();
    image_release(image);
    return 0;
}
