/* Any bytes as a JPEG: a picture, or one line that names the file. */
#include "image/jpeg_read.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct error error = {0};
    struct image *image = image_parse_jpeg("fuzz.jpg", data, size, &error);
    if (!image && (error.kind == ERROR_NONE || !strstr(error.text, "fuzz.jpg") || strchr(error.text, '\n')))
        abort();
    image_release(image);
    return 0;
}
