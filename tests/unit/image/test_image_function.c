/* Pictures as functions: the values of the lookup, bounds by brute force, slopes by differences. */
#include "image/image_function.h"

#include "tests/harness.h"
#include "tests/unit/picture_function.h"

#include <math.h>

static const enum image_filter filters[] = {IMAGE_NEAREST, IMAGE_BILINEAR, IMAGE_MIPMAP};
static const enum image_wrap wraps[] = {IMAGE_CLAMP, IMAGE_REPEAT, IMAGE_MIRROR};

/* For every filter and wrap. */
typedef void check_function(const struct image_function *function, struct test_random *random);

static void for_each_lookup(const struct image *image, check_function *check) {
    struct test_random random = {3};
    for (size_t f = 0; f < sizeof filters / sizeof *filters; f++)
        for (size_t w = 0; w < sizeof wraps / sizeof *wraps; w++) {
            struct image_function function = test_picture_function(image, filters[f], wraps[w]);
            check(&function, &random);
        }
}

static void check_value(const struct image_function *function, struct test_random *random) {
    for (int i = 0; i < 200; i++) {
        double u = test_uniform(random, -3, 3), v = test_uniform(random, -3, 3);
        double x = 1.5 * u + 0.125, y = 1 - (-0.75 * v + 0.25);
        struct image_point at = {function->flip_u ? 1 - x : x, y, 0, 0};
        struct rgba texel = image_lookup(function->image, at, function->sampling);
        CHECK_NEAR(image_function_value(function, u, v, 0), texel.r, 0);
        CHECK_NEAR(image_function_value(function, u, v, 1), 0.5 * texel.g, 0);
        CHECK_NEAR(image_function_value(function, u, v, 2), -2 * texel.b, 0);
        CHECK_NEAR(image_function_value(function, u, v, 3), texel.a, 0);
    }
}

TEST(a_picture_as_a_function_has_the_values_of_its_lookup) {
    struct image *image = test_picture(TEST_PICTURE_WIDTH, TEST_PICTURE_HEIGHT);
    for_each_lookup(image, check_value);
    image_release(image);
}

static double point_in(struct test_random *random, struct image_interval x) {
    double t = test_uniform(random, -0.2, 1.2);
    return t <= 0 ? x.low : t >= 1 ? x.high : x.low + t * (x.high - x.low);
}

static struct image_interval random_interval(struct test_random *random) {
    double size = pow(10, test_uniform(random, -4, 0.5));
    double low = test_uniform(random, -2, 2);
    if (test_uniform(random, 0, 1) < 0.2)
        low = floor(low);
    return (struct image_interval){low, low + size, false};
}

static void check_bounds(const struct image_function *function, struct test_random *random) {
    for (int i = 0; i < 400; i++) {
        struct image_interval u = random_interval(random), v = random_interval(random);
        int channel = i % TEXEL_CHANNELS;
        struct image_interval bounds = image_function_bounds(function, u, v, channel);
        CHECK(!bounds.may_be_nan && bounds.low <= bounds.high);
        for (int k = 0; k < 30; k++) {
            double value = image_function_value(function, point_in(random, u), point_in(random, v), channel);
            if (!(value >= bounds.low && value <= bounds.high))
                test_fail(__FILE__, __LINE__, "filter %d, wrap %d: %a is not in %a..%a", function->sampling.filter,
                          function->sampling.wrap_u, value, bounds.low, bounds.high);
        }
    }
}

TEST(bounds_of_a_picture_contain_its_values) {
    struct image *small = test_picture(TEST_PICTURE_WIDTH, TEST_PICTURE_HEIGHT), *large = test_picture(250, 131);
    for_each_lookup(small, check_bounds);
    for_each_lookup(large, check_bounds);
    image_release(small);
    image_release(large);
}

/* The least and the greatest of four texels, whose centres are the corners of the box. */
TEST(bounds_between_four_texels_are_those_of_the_texels) {
    struct image *image = test_picture(64, 64);
    struct image_function function = {
        .image = image, .sampling = {IMAGE_BILINEAR, IMAGE_CLAMP, IMAGE_CLAMP}, .scale = {1, 1}, .tint = {1, 1, 1}};
    for (uint32_t k = 0; k < 60; k++) {
        double low = INFINITY, high = -INFINITY, at = (k + 0.5) / 64;
        for (uint32_t c = 0; c < 4; c++) {
            double value = image_function_value(&function, at + (c & 1) / 64.0, at + (c >> 1) / 64.0, 3);
            low = fmin(low, value);
            high = fmax(high, value);
        }
        const struct image_interval box = {at + 0.002, at + 1 / 64.0 - 0.002, false};
        struct image_interval bounds = image_function_bounds(&function, box, box, 3);
        CHECK_NEAR(bounds.low, low, 1e-12);
        CHECK_NEAR(bounds.high, high, 1e-12);
    }
    image_release(image);
}

static void check_slopes(const struct image_function *function, struct test_random *random) {
    const double h = 1e-7;
    for (int i = 0; i < 200; i++) {
        double u = test_uniform(random, -2, 2), v = test_uniform(random, -2, 2), slopes[2], back[2], forth[2];
        int channel = i % TEXEL_CHANNELS;
        image_function_slopes(function, u, v, channel, slopes);
        back[0] = image_function_value(function, u - h, v, channel);
        forth[0] = image_function_value(function, u + h, v, channel);
        back[1] = image_function_value(function, u, v - h, channel);
        forth[1] = image_function_value(function, u, v + h, channel);
        double middle = image_function_value(function, u, v, channel);
        for (int k = 0; k < 2; k++) /* not where a texel begins */
            if (fabs(forth[k] + back[k] - 2 * middle) < 1e-9 && fabs(forth[k] - back[k]) < 1e-3)
                CHECK_NEAR(slopes[k], (forth[k] - back[k]) / (2 * h), 1e-4);
    }
}

TEST(slopes_of_a_picture_are_differences_of_its_values) {
    struct image *image = test_picture(TEST_PICTURE_WIDTH, TEST_PICTURE_HEIGHT);
    for_each_lookup(image, check_slopes);
    image_release(image);
}

TEST(coordinates_that_are_no_numbers_read_some_texel) {
    struct image *image = test_picture(TEST_PICTURE_WIDTH, TEST_PICTURE_HEIGHT);
    const double wild[] = {(double)NAN, (double)INFINITY, -(double)INFINITY, 1e300, -1e300, 1e-310};
    for (size_t w = 0; w < 3; w++) {
        struct image_function function = test_picture_function(image, IMAGE_BILINEAR, wraps[w]);
        const struct image_interval all = {-(double)INFINITY, (double)INFINITY, true};
        struct image_interval bounds = image_function_bounds(&function, all, all, 0);
        for (int i = 0; i < 36; i++) {
            double value = image_function_value(&function, wild[i / 6], wild[i % 6], 0);
            CHECK(value >= bounds.low && value <= bounds.high);
        }
    }
    image_release(image);
}
