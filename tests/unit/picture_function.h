/* Pictures for tests of EXPR_TEXEL: random texels with alpha, 13 x 7, with every filter and wrap. They live as long as
 * the process. */
#ifndef GRAY_TESTS_UNIT_PICTURE_FUNCTION_H
#define GRAY_TESTS_UNIT_PICTURE_FUNCTION_H

#include "base/random.h"
#include "expr/expr_operations.h"
#include "tests/harness.h"

enum { TEST_PICTURE_WIDTH = 13, TEST_PICTURE_HEIGHT = 7 };

/* Owner: the caller. */
static inline struct image *test_picture(uint32_t width, uint32_t height) {
    static uint8_t texels[256 * 256 * 4];
    struct error error = {0};
    CHECK(width * height <= 256 * 256);
    for (uint32_t i = 0; i < width * height * 4; i++)
        texels[i] = (uint8_t)(random_mix(i) >> 20);
    struct image *image = image_create("test.png", width, height, 8, texels, &error);
    CHECK(image && image_make_ranges(image, &error));
    return image;
}

static inline struct image_function test_picture_function(const struct image *image, enum image_filter filter,
                                                          enum image_wrap wrap) {
    return (struct image_function){.image = image,
                                   .sampling = {filter, wrap, wrap},
                                   .scale = {1.5, -0.75},
                                   .offset = {0.125, 0.25},
                                   .flip_u = wrap == IMAGE_MIRROR,
                                   .tint = {1, 0.5, -2}};
}

/* Number 0: the nearest texel; 1, 2 and 3: bilinear, with each wrap. Channel: the same number. */
static inline int64_t test_picture_operand(int number) {
    static struct image_function functions[4];
    if (!functions[0].image) {
        const struct image *image = test_picture(TEST_PICTURE_WIDTH, TEST_PICTURE_HEIGHT);
        for (int k = 0; k < 4; k++)
            functions[k] = test_picture_function(image, k == 0 ? IMAGE_NEAREST : IMAGE_BILINEAR,
                                                 k == 0 ? IMAGE_REPEAT : (enum image_wrap)(k - 1));
    }
    return expr_texel_operand(&functions[number], number);
}

#endif
