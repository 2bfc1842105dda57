/* High dynamic range images: Radiance HDR and PFM files of every variant give back what was written; broken files give
 * one line. */
#include "base/mem.h"
#include "image/exr.h"
#include "image/float_write.h"
#include "image/image.h"
#include "image/levels.h"
#include "light/sky.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { H = 6 };

static float light(uint32_t x, uint32_t y, uint32_t c) {
    if (y == 3)
        return c == 1 ? 0 : 0.5f; /* long runs */
    return (float)ldexp(1 + (double)(x * 7 + y * 13 + c * 29) / 4096, (int)(x / 9 % 30) - 15);
}

static void light_row(void *context, uint32_t y, float *line) {
    uint32_t width = *(uint32_t *)context;
    for (uint32_t x = 0; x < width; x++)
        for (uint32_t c = 0; c < 3; c++)
            line[3 * x + c] = light(x, y, c);
}

static struct image *parse(const char *name, const void *data, size_t size, struct error *error) {
    /* A buffer of exactly this size, so that a sanitizer detects a read beyond it. */
    uint8_t *exact = malloc(size ? size : 1);
    memcpy(exact, data, size);
    *error = (struct error){0};
    struct image *image = image_parse(name, exact, size, error);
    free(exact);
    return image;
}

TEST(radiance_and_pfm_pictures_are_read_as_they_were_written) {
    static const uint32_t widths[] = {300, 8, 5, 1};
    for (int i = 0; i < 8; i++) {
        char path[512];
        uint32_t width = widths[i / 2];
        struct error error = {0};
        (void)snprintf(path, sizeof path, "%s/a.%s", test_folder(), i % 2 ? "pfm" : "hdr");
        CHECK((i % 2 ? pfm_write : hdr_write)(FILE_AT(path), width, H, light_row, &width, &error));
        struct image *image = image_read(path, &error);
        if (!image) {
            test_fail(__FILE__, __LINE__, "%s", error.text);
            return;
        }
        CHECK_EQ_INT(image_width(image), width);
        CHECK_EQ_INT(image_height(image), H);
        for (uint32_t p = 0; p < width * H; p++) {
            uint32_t x = p % width, y = p / width;
            struct rgba c = image_texel(image, x, y);
            double max = fmax(light(x, y, 0), fmax(light(x, y, 1), light(x, y, 2)));
            const double got[3] = {c.r, c.g, c.b};
            for (uint32_t k = 0; k < 3; k++)
                CHECK_NEAR(got[k], (double)light(x, y, k), i % 2 ? 0 : max / 256);
            CHECK_NEAR(c.a, 1, 0);
        }
        image_release(image);
    }
}

static double first_red(const char *name, const char *text, size_t size, uint32_t x, uint32_t y) {
    struct error error;
    struct image *image = parse(name, text, size, &error);
    if (!image) {
        test_fail(__FILE__, __LINE__, "%s", error.text);
        return -1;
    }
    double red = image_texel(image, x, y).r;
    image_release(image);
    return red;
}

#define WHOLE(text) text, sizeof text - 1

TEST(radiance_pictures_of_every_spelling_are_read) {
    /* 128 with the exponent 129 is (128 + 1/2) / 128. */
    const double one = 128.5 / 128;
#define HEAD "#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\n"
    CHECK_NEAR(first_red("a", WHOLE(HEAD "\n-Y 1 +X 2\n\x80\0\0\x81\x40\0\0\x81"), 0, 0), one, 0);
    CHECK_NEAR(first_red("a", WHOLE(HEAD "\n-Y 1 -X 2\n\x80\0\0\x81\x40\0\0\x81"), 1, 0), one, 0);
    CHECK_NEAR(first_red("a", WHOLE(HEAD "\n+Y 2 +X 1\n\x80\0\0\x81\x40\0\0\x81"), 0, 1), one, 0);
    CHECK_NEAR(first_red("a", WHOLE(HEAD "EXPOSURE=2\nEXPOSURE= 2.0\n\n-Y 1 +X 1\n\x80\0\0\x81"), 0, 0), one / 4, 0);
    /* Repeated pixels, 2 and then 1 * 256 of them. */
    CHECK_NEAR(first_red("a", WHOLE(HEAD "\n-Y 1 +X 259\n\x80\0\0\x81\1\1\1\2\1\1\1\1"), 258, 0), one, 0);
    /* A row too long for run-length coding per channel, in a file that is long enough for it. */
    static char row[1024];
    int head = snprintf(row, sizeof row, HEAD "#%0500d\n\n-Y 1 +X 32768\n", 0);
    memcpy(row + head, "\x80\0\0\x81\1\1\1\xff\1\1\1\x7f", 12);
    CHECK_NEAR(first_red("a", row, (size_t)head + 12, 32767, 0), one, 0);
    /* Run-length coded channels, with literal and repeated runs. */
    CHECK_NEAR(first_red("a", WHOLE(HEAD "\n-Y 1 +X 8\n\2\2\0\x08\x03\0\0\0\x85\x80\x88\0\x88\0\x88\x81"), 7, 0), one,
               0);
    /* PFM of both byte orders, with a scale, and of one channel. */
    CHECK_NEAR(first_red("a", WHOLE("PF\n1 2\n-1.0\n\0\0\x80?\0\0\0\0\0\0\0\0\0\0\0@\0\0\0\0\0\0\0\0"), 0, 1), 1, 0);
    CHECK_NEAR(first_red("a", WHOLE("PF\n1 2\n0.5\n?\x80\0\0\0\0\0\0\0\0\0\0@\0\0\0\0\0\0\0\0\0\0\0"), 0, 0), 1, 0);
    CHECK_NEAR(first_red("a", WHOLE("Pf 1 1 -1 \0\0\x80?"), 0, 0), 1, 0);
    /* Comments and line ends of Windows. */
    CHECK_NEAR(first_red("a", WHOLE("PF\r\n1 2\r\n0.5\r\n?\x80\0\0\0\0\0\0\0\0\0\0@\0\0\0\0\0\0\0\0\0\0\0"), 0, 0), 1,
               0);
    CHECK_NEAR(first_red("a", WHOLE("Pf\n# made by\n#\n1 # wide\n1\n# order\n-1\n\0\0\x80?"), 0, 0), 1, 0);
    CHECK_NEAR(first_red("a", WHOLE("#?RGBE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 1 +X 1\r\n\x80\0\0\x81"), 0, 0), one,
               0);
    /* NaN and negative light become 0. */
    CHECK_NEAR(first_red("a", WHOLE("Pf\n1 1\n-1\n\0\0\xc0\x7f"), 0, 0), 0, 0);
    CHECK_NEAR(first_red("a", WHOLE("Pf\n1 1\n-1\n\0\0\x80\xbf"), 0, 0), 0, 0);
}

TEST(broken_pictures_of_light_are_one_line) {
    static const struct {
        const char *text;
        size_t size;
        const char *says;
    } cases[] = {
        {WHOLE("#?RADIANCE\n"), "no end"},
        {WHOLE("#?RADIANCE\n\n-Y 1 +X 1\n\0\0\0\0"), "FORMAT"},
        {WHOLE("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n\0\0\0\0"), "FORMAT"},
        {WHOLE(HEAD "EXPOSURE=0\n\n-Y 1 +X 1\n\0\0\0\0"), "EXPOSURE"},
        {WHOLE(HEAD "\n+X 1 +Y 1\n\0\0\0\0"), "columns"},
        {WHOLE(HEAD "\n-Y 1 +Y 1\n\0\0\0\0"), "columns"},
        {WHOLE(HEAD "\n-Y one +X 1\n\0\0\0\0"), "size"},
        {WHOLE(HEAD "\n-Y 0 +X 1\n\0\0\0\0"), "at least one pixel"},
        {WHOLE(HEAD "\n-Y 32768 +X 8192\n\0\0\0\0"), "too short"},
        {WHOLE(HEAD "\n-Y 99999999 +X 99999999\n\0\0\0\0"), "too many"},
        {WHOLE(HEAD "\n-Y 1 +X 2\n\1\1\1\2\1\1\1\2"), "run"},
        {WHOLE(HEAD "\n-Y 1 +X 2\n\2\2\2\2\1\1\1\7"), "run"},
        {WHOLE(HEAD "\n-Y 1 +X 8\n\2\2\0\x09\x88\0\x88\0\x88\0\x88\0"), "width"},
        {WHOLE(HEAD "\n-Y 1 +X 8\n\2\2\0\x08\x89\0\x88\0\x88\0\x88\0"), "run"},
        {WHOLE(HEAD "\n-Y 1 +X 8\n\2\2\0\x08\0\0\x88\0\x88\0\x88\0"), "run"},
        {WHOLE("PF\n"), "size"},
        {WHOLE("PF\n-1 1\n-1\n"), "size"},
        {WHOLE("PF\n# no end"), "size"},
        {WHOLE("PF\n1 1\n0\n"), "scale"},
        {WHOLE("PF\n1 1\n-1x\n"), "scale"},
        {WHOLE("PF\n2 1\n-1\n01234567890"), "too short"},
        {WHOLE("PF\n99999 99999\n-1\n"), "too many"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct error error;
        struct image *image = parse("t.hdr", cases[i].text, cases[i].size, &error);
        if (image || strncmp(error.text, "t.hdr: ", 7) != 0 || !strstr(error.text, cases[i].says) ||
            strchr(error.text, '\n'))
            test_fail(__FILE__, __LINE__, "case %zu: %s", i, image ? "is a picture" : error.text);
        image_release(image);
    }
}

static void no_cut_is_a_picture(const char *file, size_t size) {
    for (size_t cut = 0; cut < size; cut++) {
        struct error error = {0};
        struct image *image = parse("t", file, cut, &error);
        if (image || strncmp(error.text, "t: ", 3) != 0 || strchr(error.text, '\n'))
            test_fail(__FILE__, __LINE__, "cut at %zu: %s", cut, image ? "is a picture" : error.text);
        image_release(image);
    }
}

TEST(pictures_of_light_cut_anywhere_are_one_line) {
    for (int i = 0; i < 2; i++) {
        char path[512];
        uint32_t width = 40;
        struct error error = {0};
        (void)snprintf(path, sizeof path, "%s/a", test_folder());
        CHECK((i ? pfm_write : hdr_write)(FILE_AT(path), width, H, light_row, &width, &error));
        size_t size;
        char *file = test_read_file(path, &size);
        no_cut_is_a_picture(file, size);
        /* One byte changed: a picture or one line, and memory in proportion to the bytes. */
        struct test_random random = {5};
        for (int k = 0; k < 2000; k++) {
            size_t at = (size_t)test_uniform(&random, 0, (double)size);
            char old = file[at];
            file[at] = (char)test_uniform(&random, 0, 256);
            image_release(parse("t", file, size, &error));
            file[at] = old;
        }
        free(file);
    }
}

TEST(levels_of_a_picture_of_light_are_means) {
    enum { W = 37, ROWS = 11 };
    float texels[W * ROWS * 4], same[W * ROWS * 4];
    struct test_random random = {6};
    double mean = 0;
    for (int i = 0; i < W * ROWS * 4; i++) {
        texels[i] = i % 4 == 3 ? 1 : (float)test_uniform(&random, 0, 100);
        same[i] = i % 4 == 3 ? 1 : 0.1f;
        mean += i % 4 == 0 ? (double)texels[i] / (W * ROWS) : 0;
    }
    struct error error = {0};
    struct image *image = image_create("t", W, ROWS, 32, texels, &error), *plain;
    int last = image->level_count - 1;
    CHECK_NEAR(image_from_units(image_level_texel(image, last, 0, 0)).r, mean, 1e-3);
    image_release(image);
    plain = image_create("t", W, ROWS, 32, same, &error);
    for (int level = 0; level < plain->level_count; level++)
        CHECK_NEAR(image_from_units(image_level_texel(plain, level, 0, 0)).g, (double)0.1f, 1e-16);
    image_release(plain);
}

TEST(reading_light_survives_every_failed_allocation) {
    const char text[] = HEAD "\n-Y 1 +X 64\n\x80\0\0\x81\1\1\1\x3f";
    for (uint64_t k = 1; k < 20; k++) {
        struct error error = {0};
        mem_fail_at(k);
        struct image *image = image_parse("t", (const uint8_t *)text, sizeof text - 1, &error);
        mem_fail_at(0);
        if (image) {
            image_release(image);
            return;
        }
        CHECK_EQ_INT(error.kind, ERROR_MACHINE);
    }
    test_fail(__FILE__, __LINE__, "still fails after 20 allocations");
}

/* --- EXR, if its library is installed --- */

TEST(exr_pictures_are_read_as_they_were_written) {
    test_need_exr();
    static const uint32_t widths[] = {300, 1, 33};
    for (int i = 0; i < 3; i++) {
        char path[512];
        uint32_t width = widths[i], height = i == 2 ? 50 : H; /* several chunks */
        struct error error = {0};
        (void)snprintf(path, sizeof path, "%s/a.exr", test_folder());
        CHECK(exr_write(FILE_AT(path), width, height, light_row, &width, &error));
        struct image *image = image_read(path, &error);
        if (!image) {
            test_fail(__FILE__, __LINE__, "%s", error.text);
            return;
        }
        CHECK_EQ_INT(image_width(image), width);
        CHECK_EQ_INT(image_height(image), height);
        for (uint32_t p = 0; p < width * height; p++) {
            struct rgba c = image_texel(image, p % width, p / width);
            CHECK_NEAR(c.r, (double)light(p % width, p / width, 0), 0);
            CHECK_NEAR(c.g, (double)light(p % width, p / width, 1), 0);
            CHECK_NEAR(c.b, (double)light(p % width, p / width, 2), 0);
        }
        image_release(image);
    }
}

TEST(exr_pictures_cut_or_changed_anywhere_are_one_line) {
    if (!exr_can_write()) {
        struct error error;
        CHECK(parse("t.exr", "\x76\x2f\x31\x01", 4, &error) == NULL);
        CHECK(strstr(error.text, "OpenEXR") != NULL);
        return;
    }
    uint32_t width = 24;
    struct error error = {0};
    const char *path = test_path("a.exr");
    CHECK(exr_write(FILE_AT(path), width, H, light_row, &width, &error));
    size_t size;
    char *file = test_read_file(path, &size);
    no_cut_is_a_picture(file, size);
    struct test_random random = {7};
    for (int k = 0; k < 1500; k++) {
        size_t at = (size_t)test_uniform(&random, 0, (double)size);
        char old = file[at];
        file[at] = (char)test_uniform(&random, 0, 256);
        struct image *image = parse("t", file, size, &error);
        CHECK(image || (error.kind != ERROR_NONE && !strchr(error.text, '\n')));
        image_release(image);
        file[at] = old;
    }
    free(file);
}
