/* High dynamic range images: short files of every variant with every error; EXR with each byte changed, with one
 * channel, and with failures of each allocation and call. */
#include "base/fault.h"
#include "image/exr.h"
#include "image/float_write.h"
#include "image/image.h"
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 24, HEIGHT = 20 };

static void light_row(void *context, uint32_t y, float *line) {
    (void)context;
    for (uint32_t x = 0; x < 3 * WIDTH; x++)
        line[x] = (float)(x * 7 % 5) / 4 + (float)y;
}

static struct image *parse(const char *name, const void *data, size_t size, struct error *error) {
    uint8_t *exact = malloc(size ? size : 1); /* so that a read beyond it is detected */
    if (size)
        memcpy(exact, data, size);
    *error = (struct error){0};
    struct image *image = image_parse(name, exact, size, error);
    free(exact);
    return image;
}

static void expect(const void *data, size_t size, const char *words) {
    struct error error;
    struct image *image = parse("t", data, size, &error);
    if (!image != !!words || (words && !strstr(error.text, words)))
        test_fail(__FILE__, __LINE__, "%.40s: %s, not '%s'", (const char *)data, image ? "read" : error.text,
                  words ? words : "read");
    image_release(image);
}

static void expect_text(const char *text, const char *words) {
    expect(text, strlen(text), words);
}

#define HEAD "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"

TEST(corners_of_radiance_pictures_are_read_or_reported) {
    static const char marks[] = HEAD "\n-Y 1 +X 9\n\x80\x80\x80\x80\1\1\1\0\1\1\1\0\1\1\1\0\1\1\1\0\1\1\1\1";
    static const char nearly[] = HEAD "\n-Y 1 +X 2\n\1\1\2\x80\1\2\1\x80";
    static const char wide[] = HEAD "\n-Y 1 +X 40000\n\x80\x80\x80\x80\1\1\1\xff\1\1\1\x9b\1\1\1\0";
    char *text = malloc(1 << 20), *to;
    expect(nearly, sizeof nearly - 1, NULL);
    expect(marks, sizeof marks - 1, "a run in a Radiance picture is longer than its row");
    expect(wide, sizeof wide - 1, "t: ");
    expect_text(HEAD "EXPOSURE=1e31\n\n-Y 1 +X 1\n", "EXPOSURE of a Radiance picture must be above 0");
    expect_text(HEAD "EXPOSURE=0\n\n-Y 1 +X 1\n", "EXPOSURE of a Radiance picture must be above 0");
    expect_text(HEAD "\n-Y 2 +X\n", "the line with the size of a Radiance picture cannot be read");
    expect_text(HEAD "\n-Y 9999999999 +X 1\n", "the line with the size of a Radiance picture cannot be read");
    expect_text(HEAD "\n-Y 0 +X 1\n", "t: ");
    expect_text(HEAD "\n-Y 1 +X 0\n", "t: ");
    expect_text(HEAD "\n-Y 999999999 +X 1\n", "t: ");
    expect_text(HEAD "\n-Y 1 +X 999999999\n", "t: ");
    to = stpcpy(text, HEAD);
    memset(to, 'x', 5000);
    strcpy(to + 5000, "\n\n-Y 1 +X 1\n");
    expect_text(text, "the header of a Radiance picture has no end");
    to = stpcpy(text, HEAD);
    for (int i = 0; i < 20000; i++)
        to = stpcpy(to, "# no end\n");
    expect_text(text, "the header of a Radiance picture has no end");
    free(text);
}

TEST(corners_of_pfm_pictures_are_read_or_reported) {
    static const char grey[] = "Pf\r1 1\n-1\n\0\0\x80\x3f",
                      plain[] = "PF 1\t1\r1\n\x3f\x80\0\0\x3f\x80\0\0\x3f\x80\0\0";
    expect(grey, sizeof grey - 1, NULL);
    expect(plain, sizeof plain - 1, NULL);
    expect_text("PX\n1 1\n-1\n", "t: ");
    expect_text("PFX1 1\n-1\n", "t: ");
    expect_text("PF\n1234567890 1\n-1\n", "the size of a PFM picture cannot be read");
    expect_text("PF\n1 x\n-1\n", "the size of a PFM picture cannot be read");
    expect_text("PF\n1", "the size of a PFM picture cannot be read");
    expect_text("PF\n11111111111111111111111111111111111111111111111111111111111111111111111 1\n-1\n",
                "the size of a PFM picture cannot be read");
    expect_text("PF\n1 1\n1e31\n", "the scale of a PFM picture cannot be read");
    expect_text("PF\n1 1\n1e-31\n", "the scale of a PFM picture cannot be read");
    expect_text("PF\n1 1\n1x\n", "the scale of a PFM picture cannot be read");
    expect_text("PF\n1 1\n", "the scale of a PFM picture cannot be read");
    expect_text("PF\n999999999 1\n-1\n", "t: ");
    expect_text("PF\n1 999999999\n-1\n", "t: ");
    expect_text("PF\n0 1\n-1\n", "t: ");
    expect_text("PF\n9 9\n-1\nabc", "the file is too short for its pixels");
}

/* An EXR file, from malloc; NULL if this build has no EXR. */
static char *some_exr(size_t *size) {
    struct error error = {0};
    test_need_exr();
    const char *path = test_path("a.exr");
    CHECK(exr_write(FILE_AT(path), WIDTH, HEIGHT, light_row, NULL, &error));
    return test_read_file(path, size);
}

TEST(exr_with_any_byte_changed_is_a_picture_or_one_line) {
    static const uint8_t values[] = {0, 1, 2, 0x7f, 0x80, 0xff};
    size_t size;
    char *file = some_exr(&size);
    for (size_t at = 0; at < size; at += at < 500 ? 1 : 7)
        for (size_t k = 0; k <= sizeof values; k++) {
            struct error error;
            char old = file[at];
            file[at] = (char)(k < sizeof values ? values[k] : (uint8_t)(old ^ 4));
            struct image *image = parse("t", file, size, &error);
            /* a header may claim more than the file has */
            if (!image && error.kind != ERROR_MACHINE &&
                (strncmp(error.text, "t: ", 3) != 0 || strchr(error.text, '\n')))
                test_fail(__FILE__, __LINE__, "byte %zu: %s", at, error.text);
            image_release(image);
            file[at] = old;
        }
    free(file);
}

/* The channels with other names, in their order: A, X and Y are a grey picture; A, G, R are refused. */
TEST(exr_of_other_channels_is_grey_or_an_error) {
    static const struct {
        const char *names, *words;
    } channels[] = {
        {"AXY", NULL}, {"BGR", NULL}, {"AGR", "needs the channels R, G and B, or Y"}, {"BGY", "needs the channels"}};
    size_t size, at = 0;
    char *file = some_exr(&size);
    while (memcmp(file + at, "chlist", 7) != 0)
        at++;
    at += 7 + 4; /* the size of the list; each entry is a name with its zero and 16 bytes */
    for (size_t i = 0; i < sizeof channels / sizeof channels[0]; i++) {
        for (size_t k = 0; k < 3; k++)
            file[at + 18 * k] = channels[i].names[k];
        expect(file, size, channels[i].words);
        file[at + 18 + 10] = 2; /* half as many samples in the second one */
        struct error error;
        image_release(parse("t", file, size, &error));
        file[at + 18 + 10] = 1;
    }
    free(file);
}

TEST(any_allocation_or_call_may_fail_while_light_is_written_and_read) {
#ifndef GRAY_FAULTS
    test_skip("failures on demand are only in builds with GRAY_FAULTS");
#endif
    typedef bool write_light(const struct file_target *target, uint32_t width, uint32_t height, float_rows *rows,
                             void *context, struct error *error);
    static write_light *const writers[] = {pfm_write, hdr_write, exr_write};
    for (int w = 0; w < (exr_can_write() ? 3 : 2); w++)
        for (int kind = 0; kind < 2; kind++)
            for (uint64_t k = 1, over = 0; !over; k++) {
                char path[512];
                struct error error = {0};
                (void)snprintf(path, sizeof path, "%s/a.%d", test_folder(), w);
                uint64_t before = fault_count((enum fault_kind)kind);
                fault_at((enum fault_kind)kind, k);
                bool ok = writers[w](FILE_AT(path), WIDTH, HEIGHT, light_row, NULL, &error);
                struct image *image = ok ? image_read(path, &error) : NULL;
                fault_at((enum fault_kind)kind, 0);
                over = fault_count((enum fault_kind)kind) - before < k;
                CHECK(image || error.text[0]);
                if (!image && kind == FAULT_OF_ALLOCATION && error.kind != ERROR_MACHINE)
                    test_fail(__FILE__, __LINE__, "writer %d, allocation %llu: %s", w, (unsigned long long)k,
                              error.text);
                image_release(image);
            }
}
