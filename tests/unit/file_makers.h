/* Writes small files that the tests' scenes name into the folder of the test. */
#ifndef GRAY_TESTS_FILE_MAKERS_H
#define GRAY_TESTS_FILE_MAKERS_H

#include "image/png_write.h"
#include "tests/harness.h"

#include <stdio.h>
#include <string.h>

static inline void white_row(void *context, uint32_t y, uint8_t *line) {
    (void)y;
    memset(line, 255, 3 * (size_t) * (const uint32_t *)context);
}

static inline void write_white_png(const char *name, uint32_t width, uint32_t height) {
    struct error error = {0};
    CHECK(png_write_from(FILE_AT(test_path(name)),
                         &(struct png_source){.width = width, .height = height, .bytes = white_row, .context = &width},
                         NULL, &error));
}

#endif
