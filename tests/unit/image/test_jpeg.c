#include "base/mem.h"
#include "image/image.h"
#include "image/jpeg_read.h"
#include "tests/harness.h"

#include <math.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#ifndef HAVE_JPEG

TEST(jpeg_without_its_library_says_so) {
    static const uint8_t start[] = {0xff, 0xd8, 0xff, 0xe0};
    struct error error = {0};
    CHECK(image_parse("t.jpg", start, sizeof start, &error) == NULL);
    CHECK(strstr(error.text, "t.jpg: this is a JPEG, which this build cannot read") == error.text);
    CHECK_TEXT(jpeg_library(), "none");
}

#else

#include <jpeglib.h>

enum { WIDTH = 40, HEIGHT = 24 };

/* A smooth picture of 1, 3 or 4 components. */
static void sample(int x, int y, int components, uint8_t *out) {
    for (int k = 0; k < components && k < 4; k++)
        out[k] = (uint8_t)(k == 0 ? 6 * x : k == 1 ? 10 * y : k == 2 ? 240 - 3 * x - 4 * y : 200);
}

static uint8_t *encode(int components, bool progressive, size_t *size) {
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    uint8_t *data = NULL;
    unsigned long length = 0;
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_mem_dest(&jpeg, &data, &length);
    jpeg.image_width = WIDTH;
    jpeg.image_height = HEIGHT;
    jpeg.input_components = components;
    jpeg.in_color_space = components == 1 ? JCS_GRAYSCALE : components == 3 ? JCS_RGB : JCS_CMYK;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, 98, TRUE);
    if (progressive)
        jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    for (int y = 0; y < HEIGHT; y++) {
        uint8_t line[WIDTH * 4];
        JSAMPROW row = line;
        for (int x = 0; x < WIDTH; x++)
            sample(x, y, components, line + x * components);
        (void)jpeg_write_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    *size = length;
    return data;
}

/* A copy of exactly this size, so that the sanitizer detects every read outside it. */
static struct image *parse(const uint8_t *data, size_t size, struct error *error) {
    uint8_t *copy = malloc(size ? size : 1);
    if (size)
        memcpy(copy, data, size);
    *error = (struct error){0};
    struct image *image = image_parse("t.jpg", copy, size, error);
    free(copy);
    return image;
}

TEST(jpeg_of_every_kind_has_its_colours) {
    for (int kind = 0; kind < 6; kind++) {
        static const int components[] = {1, 3, 4};
        int n = components[kind % 3];
        size_t size;
        uint8_t *data = encode(n, kind >= 3, &size);
        struct error error;
        struct image *image = parse(data, size, &error);
        CHECK_TEXT(error.text, "");
        if (image) {
            CHECK_EQ_INT(image_width(image), WIDTH);
            CHECK_EQ_INT(image_height(image), HEIGHT);
            double worst = 0;
            for (int y = 0; y < HEIGHT; y++)
                for (int x = 0; x < WIDTH; x++) {
                    uint8_t c[4];
                    sample(x, y, n, c);
                    struct rgba texel = image_texel(image, (uint32_t)x, (uint32_t)y);
                    double ink = n == 4 ? c[3] / 255.0 : 1;
                    double wanted[3] = {c[0] * ink, c[n > 1 ? 1 : 0] * ink, c[n > 1 ? 2 : 0] * ink};
                    double got[3] = {texel.r * 255, texel.g * 255, texel.b * 255};
                    for (int k = 0; k < 3; k++)
                        worst = fmax(worst, fabs(wanted[k] - got[k]));
                    CHECK_NEAR(texel.a, 1, 0);
                }
            CHECK_NEAR(worst, 0, 16);
        }
        image_release(image);
        free(data);
    }
}

TEST(jpeg_cut_anywhere_is_one_line) {
    for (int progressive = 0; progressive < 2; progressive++) {
        size_t size;
        uint8_t *data = encode(3, progressive, &size);
        for (size_t cut = 0; cut < size; cut++) {
            struct error error;
            struct image *image = parse(data, cut, &error);
            if (image && cut < size - 2)
                test_fail(__FILE__, __LINE__, "%zu of %zu bytes are a picture", cut, size);
            if (!image && (strncmp(error.text, "t.jpg: ", 7) != 0 || strchr(error.text, '\n')))
                test_fail(__FILE__, __LINE__, "cut at %zu: %s", cut, error.text);
            image_release(image);
        }
        struct error error;
        CHECK(parse(data, size / 2, &error) == NULL);
        CHECK(strstr(error.text, "truncated JPEG: the file ends at byte") != NULL);
        free(data);
    }
}

TEST(jpeg_changed_anywhere_is_a_picture_or_one_line) {
    struct test_random random = {5};
    for (int round = 0; round < 3000; round++) {
        size_t size;
        uint8_t *data = encode(3, round % 2, &size);
        for (int k = 0; k <= round % 3; k++)
            data[(size_t)test_uniform(&random, 2, (double)size)] = (uint8_t)test_uniform(&random, 0, 256);
        struct error error;
        struct image *image = parse(data, size, &error);
        if (!image && (strncmp(error.text, "t.jpg: ", 7) != 0 || strchr(error.text, '\n')))
            test_fail(__FILE__, __LINE__, "round %d: %s", round, error.text);
        image_release(image);
        free(data);
    }
}

TEST(jpeg_that_claims_to_be_huge_is_refused_before_memory_is_taken) {
    size_t size;
    uint8_t *data = encode(3, false, &size);
    for (size_t i = 2; i + 9 < size; i++)
        if (data[i] == 0xff && data[i + 1] == 0xc0) {
            struct error error;
            memcpy(data + i + 5, "\x7f\xff\x1f\xff", 4);
            CHECK(parse(data, size, &error) == NULL);
            CHECK(strstr(error.text, "the file is too short for 8191 x 32767 pixels") != NULL);
            memcpy(data + i + 5, "\xff\xff\xff\xff", 4);
            CHECK(parse(data, size, &error) == NULL);
            CHECK(strncmp(error.text, "t.jpg: ", 7) == 0);
            break;
        }
    free(data);
}

TEST(jpeg_survives_every_failed_allocation) {
    size_t size;
    uint8_t *data = encode(3, false, &size);
    struct error error;
    uint64_t before = mem_allocations();
    image_release(parse(data, size, &error));
    uint64_t count = mem_allocations() - before;
    for (uint64_t k = 1; k <= count; k++) {
        mem_fail_at(k);
        struct image *image = parse(data, size, &error);
        mem_fail_at(0);
        CHECK(image == NULL && error.kind == ERROR_MACHINE);
        image_release(image);
    }
    free(data);
}

/* More scans than a picture can use: each coefficient separately, in four passes. */
TEST(jpeg_with_hundreds_of_scans_is_refused) {
    static jpeg_scan_info scans[260];
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    uint8_t *data = NULL, line[WIDTH] = {0};
    unsigned long length = 0;
    int count = 0;
    scans[count++] = (jpeg_scan_info){1, {0}, 0, 0, 0, 0};
    for (int low = 3; low >= 0; low--)
        for (int k = 1; k < 64; k++)
            scans[count++] = (jpeg_scan_info){1, {0}, k, k, low == 3 ? 0 : low + 1, low};
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_mem_dest(&jpeg, &data, &length);
    jpeg.image_width = WIDTH;
    jpeg.image_height = HEIGHT;
    jpeg.input_components = 1;
    jpeg.in_color_space = JCS_GRAYSCALE;
    jpeg_set_defaults(&jpeg);
    jpeg.scan_info = scans;
    jpeg.num_scans = count;
    jpeg_start_compress(&jpeg, TRUE);
    for (int y = 0; y < HEIGHT; y++) {
        JSAMPROW row = line;
        (void)jpeg_write_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    struct error error;
    CHECK(parse(data, length, &error) == NULL);
    CHECK(strstr(error.text, "more than 200 scans") != NULL);
    free(data);
}

/* The size in the header made larger. */
TEST(jpeg_that_claims_a_huge_size_is_refused) {
    static const struct { unsigned width, height; } sizes[] = {{65500, 16}, {16, 65500}, {30000, 30000}, {4000, 4000}};
    size_t size, at = 0;
    uint8_t *data = encode(3, false, &size);
    while (!(data[at] == 0xff && data[at + 1] == 0xc0))
        at++;
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct error error;
        data[at + 5] = (uint8_t)(sizes[i].height >> 8), data[at + 6] = (uint8_t)sizes[i].height;
        data[at + 7] = (uint8_t)(sizes[i].width >> 8), data[at + 8] = (uint8_t)sizes[i].width;
        CHECK(parse(data, size, &error) == NULL);
        CHECK(strstr(error.text, "too many") || strstr(error.text, "too short"));
    }
    free(data);
}

/* Adobe's marker instead of JFIF's, with an unknown transform: read as the usual one. */
TEST(jpeg_with_an_unknown_transform_is_read) {
    size_t size;
    uint8_t *data = encode(3, false, &size);
    struct error error;
    CHECK(data[2] == 0xff && data[3] == 0xe0 && data[5] == 16);
    memcpy(data + 4,
           "\xff\xee\0\x0e"
           "Adobe\0\x64\0\0\0\0\7",
           16); /* two bytes shorter */
    memcpy(data + 2, "\xff\xd8", 2);
    struct image *image = parse(data + 2, size - 2, &error);
    CHECK_TEXT(error.text, "");
    CHECK(image && fabs(image_texel(image, WIDTH - 1, 0).r * 255 - 6 * (WIDTH - 1)) < 16);
    image_release(image);
    free(data);
}

TEST(jpeg_of_no_bytes_is_one_line) {
    struct error error = {0};
    CHECK(image_parse_jpeg("t.jpg", (const uint8_t *)"", 0, &error) == NULL);
    CHECK(strstr(error.text, "t.jpg: broken JPEG: ") == error.text);
}

/* libjpeg allocates the coefficients of a progressive picture before gray allocates its texels. */
TEST(jpeg_that_finds_no_memory_for_its_coefficients_is_an_error) {
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
    test_skip("the sanitizers' own memory is beyond any limit on addresses");
#endif
    size_t size, at = 0;
    uint8_t *data = encode(3, true, &size);
    while (!(data[at] == 0xff && data[at + 1] == 0xc2))
        at++;
    memcpy(data + at + 5, "\x02\x58\x02\x58", 4); /* 600 x 600 */
    (void)fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        struct error error = {0};
        FILE *sizes = fopen("/proc/self/statm", "r");
        unsigned long pages = 0;
        if (!sizes || fscanf(sizes, "%lu", &pages) != 1)
            _exit(2);
        struct rlimit limit = {pages * 4096 + (1 << 18), pages * 4096 + (1 << 18)};
        if (setrlimit(RLIMIT_AS, &limit) != 0)
            _exit(2);
        _exit(!image_parse("t.jpg", data, size, &error) && error.kind == ERROR_MACHINE &&
                      strcmp(error.text, "out of memory for t.jpg") == 0
                  ? 0
                  : 1);
    }
    int how = 0;
    CHECK(waitpid(child, &how, 0) == child && WIFEXITED(how) && WEXITSTATUS(how) == 0);
    free(data);
}

#endif
