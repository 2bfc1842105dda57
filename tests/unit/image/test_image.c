/* Images as textures: closed forms of the filters, mips of any size, wraps, rectangles. */
#include "base/mem.h"
#include "base/pool.h"
#include "image/image.h"
#include "image/levels.h"
#include "tests/harness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct image *make(uint32_t width, uint32_t height, int bits, const void *texels) {
    struct error error = {0};
    struct image *image = image_create("test", width, height, bits, texels, &error);
    if (!image) {
        test_fail(__FILE__, __LINE__, "%s", error.text);
        abort();
    }
    return image;
}

/* Random texels, opaque unless `alpha`. */
static struct image *make_random(uint32_t width, uint32_t height, int bits, bool alpha, uint64_t seed) {
    struct test_random random = {seed};
    size_t count = (size_t)width * height * 4;
    uint16_t *words = malloc(count * sizeof *words);
    uint8_t *bytes = malloc(count);
    for (size_t i = 0; i < count; i++) {
        words[i] = (uint16_t)(i % 4 == 3 && !alpha ? 65535 : test_uniform(&random, 0, 65536));
        bytes[i] = (uint8_t)(words[i] >> 8);
    }
    struct image *image = make(width, height, bits, bits == 8 ? (void *)bytes : (void *)words);
    free(words);
    free(bytes);
    return image;
}

static struct rgba clamped(const struct image *image, double u, double v, double width, enum image_filter filter) {
    return image_lookup(image, (struct image_point){u, v, width, width},
                        (struct image_sampling){filter, IMAGE_CLAMP, IMAGE_CLAMP});
}

static struct rgba premultiplied(const struct image *image, uint32_t x, uint32_t y) {
    struct rgba c = image_texel(image, x, y);
    return (struct rgba){c.r * c.a, c.g * c.a, c.b * c.a, c.a};
}

static void check_same(struct rgba a, struct rgba b, double tolerance) {
    CHECK_NEAR(a.r, b.r, tolerance);
    CHECK_NEAR(a.g, b.g, tolerance);
    CHECK_NEAR(a.b, b.b, tolerance);
    CHECK_NEAR(a.a, b.a, tolerance);
}

TEST(image_texels_come_back_as_they_were) {
    static const uint8_t bytes[8] = {0, 51, 255, 102, 1, 2, 3, 4};
    static const uint16_t words[4] = {0, 13107, 65535, 1};
    struct image *a = make(2, 1, 8, bytes), *b = make(1, 1, 16, words);
    check_same(image_texel(a, 0, 0), (struct rgba){0, 0.2, 1, 0.4}, 0);
    check_same(image_texel(a, 1, 0), (struct rgba){1 / 255.0, 2 / 255.0, 3 / 255.0, 4 / 255.0}, 0);
    check_same(image_texel(b, 0, 0), (struct rgba){0, 13107 / 65535.0, 1, 1 / 65535.0}, 0);
    CHECK_EQ_INT(image_width(a), 2);
    CHECK_EQ_INT(image_height(a), 1);
    CHECK_TEXT(image_name(a), "test");
    CHECK(image_memory(a) >= 8);
    CHECK(image_share(a) == a);
    image_release(a);
    check_same(image_texel(a, 0, 0), (struct rgba){0, 0.2, 1, 0.4}, 0);
    image_release(a);
    image_release(b);
    image_release(NULL);
}

TEST(image_bilinear_is_exact_at_texel_centres) {
    struct image *images[2] = {make_random(8, 4, 8, true, 1), make_random(8, 4, 16, true, 2)};
    for (int k = 0; k < 2; k++) {
        for (uint32_t y = 0; y < 4; y++)
            for (uint32_t x = 0; x < 8; x++) {
                double u = (x + 0.5) / 8, v = (y + 0.5) / 4;
                check_same(clamped(images[k], u, v, 0, IMAGE_BILINEAR), premultiplied(images[k], x, y), 1e-15);
                check_same(clamped(images[k], u, v, 0, IMAGE_NEAREST), premultiplied(images[k], x, y), 1e-15);
                check_same(clamped(images[k], u, v, 0, IMAGE_MIPMAP), premultiplied(images[k], x, y), 1e-15);
            }
        image_release(images[k]);
    }
}

TEST(image_bilinear_is_linear_between_centres) {
    static const uint8_t texels[8] = {0, 100, 200, 255, 200, 50, 0, 255};
    struct image *image = make(2, 1, 8, texels);
    for (int i = 0; i <= 64; i++) {
        double u = i / 64.0, t = fmin(fmax((u - 0.25) * 2, 0), 1);
        struct rgba c = clamped(image, u, 0.3, 0, IMAGE_BILINEAR);
        CHECK_NEAR(c.r, t * 200 / 255, 1e-15);
        CHECK_NEAR(c.g, (100 - t * 50) / 255, 1e-15);
        CHECK_NEAR(c.b, (1 - t) * 200 / 255, 1e-15);
        CHECK_NEAR(c.a, 1, 0);
    }
    image_release(image);
}

TEST(image_nearest_takes_the_texel_that_holds_the_point) {
    struct image *image = make_random(5, 3, 8, false, 3);
    for (int i = 0; i < 500; i++) {
        double u = (i + 0.5) / 500, v = fmod(i * 0.37, 1);
        check_same(clamped(image, u, v, 0, IMAGE_NEAREST),
                   image_texel(image, (uint32_t)floor(u * 5), (uint32_t)floor(v * 3)), 1e-15);
    }
    check_same(clamped(image, 1, 1, 0, IMAGE_NEAREST), image_texel(image, 4, 2), 0);
    check_same(clamped(image, 0, 0, 0, IMAGE_NEAREST), image_texel(image, 0, 0), 0);
    image_release(image);
}

TEST(image_wraps_repeat_mirror_and_clamp) {
    struct image *image = make_random(4, 4, 8, false, 4);
    for (int filter = IMAGE_NEAREST; filter <= IMAGE_MIPMAP; filter++)
        for (int i = 0; i < 200; i++) {
            double u = (i + 0.5) / 256, v = 0.3125, w = filter == IMAGE_MIPMAP ? 0.5 : 0;
            enum image_filter f = (enum image_filter)filter;
            struct rgba inside = image_lookup(image, (struct image_point){u, v, w, w},
                                              (struct image_sampling){f, IMAGE_REPEAT, IMAGE_CLAMP});
            check_same(image_lookup(image, (struct image_point){u + 3, v, w, w},
                                    (struct image_sampling){f, IMAGE_REPEAT, IMAGE_CLAMP}),
                       inside, 1e-14);
            check_same(image_lookup(image, (struct image_point){u - 2, v, w, w},
                                    (struct image_sampling){f, IMAGE_REPEAT, IMAGE_CLAMP}),
                       inside, 1e-14);
            inside = image_lookup(image, (struct image_point){u, v, w, w},
                                  (struct image_sampling){f, IMAGE_MIRROR, IMAGE_CLAMP});
            check_same(image_lookup(image, (struct image_point){-u, v, w, w},
                                    (struct image_sampling){f, IMAGE_MIRROR, IMAGE_CLAMP}),
                       inside, 1e-14);
            check_same(image_lookup(image, (struct image_point){2 + u, v, w, w},
                                    (struct image_sampling){f, IMAGE_MIRROR, IMAGE_CLAMP}),
                       inside, 1e-14);
            check_same(image_lookup(image, (struct image_point){2 - u, v, w, w},
                                    (struct image_sampling){f, IMAGE_MIRROR, IMAGE_CLAMP}),
                       inside, 1e-14);
        }
    /* A repeated image is continuous across its edge: half way between the last and the first texel it has their mean.
     */
    struct rgba a = image_texel(image, 3, 1), b = image_texel(image, 0, 1);
    struct rgba seam = image_lookup(image, (struct image_point){0, 0.375, 0, 0},
                                    (struct image_sampling){IMAGE_BILINEAR, IMAGE_REPEAT, IMAGE_CLAMP});
    check_same(seam, (struct rgba){(a.r + b.r) / 2, (a.g + b.g) / 2, (a.b + b.b) / 2, 1}, 1e-15);
    check_same(image_lookup(image, (struct image_point){1, 0.375, 0, 0},
                            (struct image_sampling){IMAGE_BILINEAR, IMAGE_REPEAT, IMAGE_CLAMP}),
               seam, 1e-15);
    check_same(image_lookup(image, (struct image_point){-7, 0.375, 0, 0},
                            (struct image_sampling){IMAGE_BILINEAR, IMAGE_CLAMP, IMAGE_CLAMP}),
               b, 1e-15);
    check_same(image_lookup(image, (struct image_point){1e300, 0.375, 0, 0},
                            (struct image_sampling){IMAGE_BILINEAR, IMAGE_CLAMP, IMAGE_CLAMP}),
               a, 1e-15);
    image_release(image);
}

TEST(image_lookups_survive_any_number) {
    static const double numbers[] = {0, -0.0, 1, -1e-320, 1e308, -1e308, INFINITY, -INFINITY, NAN};
    struct image *image = make_random(7, 5, 8, true, 5);
    for (int i = 0; i < 9 * 9 * 9 * 9; i++) {
        struct rgba c = image_lookup(
            image, (struct image_point){numbers[i % 9], numbers[i / 9 % 9], numbers[i / 81 % 9], numbers[i / 729]},
            (struct image_sampling){(enum image_filter)(i % 3), (enum image_wrap)(i / 3 % 3),
                                    (enum image_wrap)(i / 9 % 3)});
        CHECK(c.r >= 0 && c.r <= 1 && c.g >= 0 && c.g <= 1 && c.b >= 0 && c.b <= 1 && c.a >= 0 && c.a <= 1);
    }
    image_release(image);
}

TEST(image_of_one_colour_is_that_colour_at_every_level) {
    struct test_random random = {6};
    for (int i = 0; i < 40; i++) {
        uint32_t w = 1 + (uint32_t)test_uniform(&random, 0, 70), h = 1 + (uint32_t)test_uniform(&random, 0, 70);
        uint8_t *bytes = malloc((size_t)w * h * 4);
        static const uint8_t colour[4] = {255, 17, 130, 99};
        for (size_t k = 0; k < (size_t)w * h * 4; k++)
            bytes[k] = colour[k % 4];
        struct image *image = make(w, h, 8, bytes);
        struct rgba wanted = clamped(image, 0.5 / w, 0.5 / h, 0, IMAGE_NEAREST);
        for (int k = 0; k < 100; k++) {
            double u = test_uniform(&random, -1, 2), v = test_uniform(&random, -1, 2);
            struct rgba c = image_lookup(
                image, (struct image_point){u, v, test_uniform(&random, 0, 1), test_uniform(&random, 0, 1)},
                (struct image_sampling){IMAGE_MIPMAP, (enum image_wrap)(k % 3), (enum image_wrap)(k / 3 % 3)});
            check_same(c, wanted, 1e-15);
        }
        image_release(image);
        free(bytes);
    }
}

/* The mean over one level, premultiplied. */
static struct rgba level_mean(const struct image *image, int level) {
    const struct image_level *l = &image->levels[level];
    struct rgba sum = {0, 0, 0, 0};
    for (uint32_t y = 0; y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++) {
            struct rgba c = image_from_units(image_level_texel(image, level, x, y));
            sum.r += c.r, sum.g += c.g, sum.b += c.b, sum.a += c.a;
        }
    double n = (double)l->width * l->height;
    return (struct rgba){sum.r / n, sum.g / n, sum.b / n, sum.a / n};
}

TEST(image_mips_keep_the_mean_at_any_size) {
    static const uint32_t sizes[][2] = {{64, 64},  {1, 1},   {1, 37}, {37, 1}, {63, 65},
                                        {100, 30}, {7, 200}, {2, 3},  {48, 36}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++)
        for (int bits = 8; bits <= 16; bits += 8) {
            struct image *image = make_random(sizes[i][0], sizes[i][1], bits, true, i);
            struct rgba mean = level_mean(image, 0);
            int last = image->level_count - 1;
            CHECK_EQ_INT(image->levels[last].width, 1);
            CHECK_EQ_INT(image->levels[last].height, 1);
            for (int level = 1; level <= last; level++)
                check_same(level_mean(image, level), mean, 4.0 / 65535);
            image_release(image);
        }
}

TEST(image_transparent_texels_have_no_colour) {
    static const uint8_t texels[8] = {255, 0, 0, 0, 0, 200, 0, 255};
    struct image *image = make(2, 1, 8, texels);
    struct rgba c = clamped(image, 0.5, 0.5, 0, IMAGE_BILINEAR);
    check_same(c, (struct rgba){0, 100 / 255.0, 0, 0.5}, 1e-15);
    c = clamped(image, 0.5, 0.5, 10, IMAGE_MIPMAP);
    check_same(c, (struct rgba){0, 100 / 255.0, 0, 0.5}, 1e-5);
    image_release(image);
}

TEST(image_wide_footprints_average_and_narrow_ones_do_not) {
    uint8_t *stripes = malloc(64 * 64 * 4); /* alternate black and white columns */
    for (size_t i = 0; i < 64 * 64 * 4; i++)
        stripes[i] = i % 4 == 3 || (i / 4 % 2) ? 255 : 0;
    struct image *image = make(64, 64, 8, stripes);
    double u = 21.5 / 64;
    CHECK_NEAR(clamped(image, u, 0.4, 1 / 64.0, IMAGE_MIPMAP).r, 1, 0);
    CHECK_NEAR(clamped(image, u, 0.4, 1 / 8.0, IMAGE_MIPMAP).r, 0.5, 1e-4);
    CHECK_NEAR(clamped(image, u, 0.4, 1 / 8.0, IMAGE_BILINEAR).r, 1, 0);
    /* A footprint that is wide only along the stripes keeps them sharp; across them it gives gray. */
    struct rgba along = image_lookup(image, (struct image_point){u, 0.4, 1 / 64.0, 8 / 64.0},
                                     (struct image_sampling){IMAGE_MIPMAP, IMAGE_REPEAT, IMAGE_REPEAT});
    struct rgba across = image_lookup(image, (struct image_point){u, 0.4, 8 / 64.0, 1 / 64.0},
                                      (struct image_sampling){IMAGE_MIPMAP, IMAGE_REPEAT, IMAGE_REPEAT});
    CHECK_NEAR(along.r, 1, 1e-12);
    CHECK_NEAR(across.r, 0.5, 0.01);
    image_release(image);
    free(stripes);
}

TEST(image_lookup_is_continuous_in_the_footprint) {
    struct image *image = make_random(33, 20, 8, true, 8);
    double step = 1e-7;
    for (int i = 0; i < 400; i++) {
        double width = 2 * i / 400.0;
        struct rgba a = clamped(image, 0.31, 0.77, width, IMAGE_MIPMAP);
        struct rgba b = clamped(image, 0.31, 0.77, width + step, IMAGE_MIPMAP);
        check_same(a, b, 1e-4);
    }
    for (int last = 0; last < 6; last++)
        for (int k = 1; k < 300; k++) {
            double level = image_level_for(k / 8.0, last), wanted = fmin(fmax(log2(k / 8.0), 0), last);
            CHECK_NEAR(level, wanted, 0.0861);
        }
    image_release(image);
}

TEST(image_sizes_out_of_bounds_are_refused_before_memory_is_taken) {
    static const uint32_t sizes[][2] = {{0, 1}, {1, 0}, {32769, 1}, {1, 4000000000}, {32768, 32768}, {16385, 16384}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct error error = {0};
        CHECK(image_create("big", sizes[i][0], sizes[i][1], 8, "", &error) == NULL);
        CHECK_EQ_INT(error.kind, ERROR_SCENE);
        CHECK(strncmp(error.text, "big: ", 5) == 0);
    }
    uint8_t *line = calloc(32768, 4);
    struct image *image = make(32768, 1, 8, line);
    CHECK_EQ_INT(image->levels[image->level_count - 1].width, 1);
    image_release(image);
    image = make(1, 32768, 8, line);
    CHECK_EQ_INT(image->levels[image->level_count - 1].height, 1);
    image_release(image);
    free(line);
}

TEST(image_create_survives_every_failed_allocation) {
    static const uint8_t texels[16] = {0};
    uint64_t before = mem_allocations();
    image_release(make(2, 2, 8, texels));
    uint64_t count = mem_allocations() - before;
    if (count == 0)
        test_skip("this build cannot make allocations fail");
    for (uint64_t k = 1; k <= count; k++) {
        struct error error = {0};
        mem_fail_at(k);
        CHECK(image_create("test", 2, 2, 8, texels, &error) == NULL);
        mem_fail_at(0);
        CHECK_EQ_INT(error.kind, ERROR_MACHINE);
    }
}

struct largest_calls {
    const struct image *image;
    struct rgba found[64];
};

static void call_largest(void *context, uint32_t item, int worker) {
    struct largest_calls *calls = context;
    (void)worker;
    calls->found[item] = image_largest(calls->image);
}

/* Every frame and every material asks again. */
TEST(the_largest_texel_is_that_of_all_texels_and_found_once) {
    static const int bits[] = {8, 16};
    char warning[256];
    struct pool *pool = pool_create(4, warning);
    for (int k = 0; k < 2; k++) {
        struct image *image = make_random(37, 29, bits[k], true, 5);
        struct rgba want = {0, 0, 0, 1};
        for (uint32_t i = 0; i < 37 * 29; i++) {
            struct rgba t = image_texel(image, i % 37, i / 37);
            want = (struct rgba){fmax(want.r, t.r), fmax(want.g, t.g), fmax(want.b, t.b), fmin(want.a, t.a)};
        }
        struct largest_calls calls = {.image = image};
        CHECK(pool_run(pool, 64, call_largest, &calls));
        for (int i = 0; i < 64; i++)
            CHECK(memcmp(&calls.found[i], &want, sizeof want) == 0);
        CHECK_EQ_INT(atomic_load(&image->memo->state), IMAGE_MEMO_KNOWN);
        memset(image->levels[0].texels, 0, 37 * 29 * 4); /* the next call does not read the texels */
        struct rgba again = image_largest(image);
        CHECK(memcmp(&again, &want, sizeof want) == 0);
        image_release(image);
    }
    pool_destroy(pool);
}
