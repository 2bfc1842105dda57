/* EXR files that the library reads but gray refuses or treats specially: tiles, invalid windows, lossy compression; and
 * failures of each allocation and each call into the library. */
#include "base/fault.h"
#include "image/exr.h"
#include "image/image.h"
#include "tests/unit/model_makers.h"

#include <math.h>

#ifdef HAVE_EXR

enum { WIDTH = 20, HEIGHT = 40 }; /* three chunks */

static void ramp_row(void *context, uint32_t y, float *line) {
    (void)context;
    for (uint32_t x = 0; x < 3 * WIDTH; x++)
        line[x] = (float)(x + y) / 64;
}

static void attribute(struct bytes *b, const char *name, const char *type, size_t size) {
    bytes_add(b, name, strlen(name) + 1);
    bytes_add(b, type, strlen(type) + 1);
    bytes_number(b, size, 4, false);
}

static void window(struct bytes *b, const char *name, const int32_t corners[4]) {
    attribute(b, name, "box2i", 16);
    for (int i = 0; i < 4; i++)
        bytes_number(b, (uint32_t)corners[i], 4, false);
}

/* The attributes of a picture with these windows, one row after the other. */
static void windows(struct bytes *b, const int32_t data[4], const int32_t display[4]) {
    window(b, "dataWindow", data);
    window(b, "displayWindow", display);
    attribute(b, "lineOrder", "lineOrder", 1);
    bytes_add(b, "", 1);
    attribute(b, "pixelAspectRatio", "float", 4);
    bytes_float(b, 1, false);
    attribute(b, "screenWindowCenter", "v2f", 8);
    bytes_number(b, 0, 8, false);
    attribute(b, "screenWindowWidth", "float", 4);
    bytes_float(b, 1, false);
}

/* The header of a file ("Technical Introduction to OpenEXR"): everything that is read before the chunks. */
static void make_header(struct bytes *b, bool tiled, int compression, const int32_t corners[4]) {
    bytes_add(b, "\x76\x2f\x31\x01\x02\0\0\0", 8);
    b->data[b->size - 3] = tiled ? 2 : 0;
    attribute(b, "channels", "chlist", 3 * 18 + 1);
    for (int i = 0; i < 3; i++) {
        bytes_add(b, i == 0 ? "B" : i == 1 ? "G" : "R", 2);
        bytes_number(b, 2, 4, false);
        bytes_number(b, 0, 4, false);
        bytes_number(b, 1, 4, false);
        bytes_number(b, 1, 4, false);
    }
    bytes_add(b, "", 1);
    attribute(b, "compression", "compression", 1);
    bytes_number(b, (uint64_t)compression, 1, false);
    windows(b, corners, (const int32_t[]){0, 0, 9, 9});
    if (tiled) {
        attribute(b, "tiles", "tiledesc", 9);
        bytes_number(b, 16, 4, false);
        bytes_number(b, 16, 4, false);
        bytes_number(b, 0, 1, false);
    }
    bytes_add(b, "", 1);
    for (int i = 0; i < 64; i++) /* a table of chunks with invalid offsets */
        bytes_number(b, 0, 8, false);
}

static void expect_line(const struct bytes *b, const char *words) {
    struct error error = {0};
    uint8_t *copy = malloc(b->size); /* exactly its size, for the sanitizer */
    memcpy(copy, b->data, b->size);
    struct image *image = image_parse("t.exr", copy, b->size, &error);
    if (image || strncmp(error.text, "t.exr: ", 7) != 0 || strchr(error.text, '\n') || !strstr(error.text, words))
        test_fail(__FILE__, __LINE__, "%s, not '%s'", image ? "is read" : error.text, words);
    image_release(image);
    free(copy);
}

TEST(exr_of_other_kinds_is_an_error) {
    static const int32_t ten[] = {0, 0, 9, 9}, wide[] = {0, 0, 4999, 999}, tall[] = {-2000, -2000, -1999, 26000};
    struct bytes b = {0};
    make_header(&b, true, 3, ten);
    expect_line(&b, "");
    bytes_free(&b);
    for (int compression = 0; compression < 10; compression++) { /* 8 and 9: DWAA and DWAB */
        make_header(&b, false, compression, wide);
        /* A file of these compressions may be this small, others may not. */
        expect_line(&b, compression < 8 ? "the file is too short for its pixels" : "");
        bytes_free(&b);
    }
    make_header(&b, false, 3, tall);
    expect_line(&b, "");
    bytes_free(&b);
}

TEST(exr_windows_that_are_none_are_one_line) {
    static const int32_t windows[][4] = {{0, 0, -1, 9},
                                         {0, 0, 9, -1},
                                         {5, 5, 4, 4},
                                         {INT32_MIN, 0, INT32_MAX, 9},
                                         {0, INT32_MIN, 9, INT32_MAX},
                                         {0, 0, 1 << 20, 0},
                                         {0, 0, 0, 1 << 20},
                                         {INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN},
                                         {0, 0, 32768, 0},
                                         {0, 0, 0, 32768}};
    for (size_t i = 0; i < sizeof windows / sizeof windows[0]; i++) {
        struct bytes b = {0};
        make_header(&b, false, 3, windows[i]);
        expect_line(&b, "");
        bytes_free(&b);
    }
}

/* --- files made here, without compression --- */

struct layout {
    int32_t data[4], display[4];
    int tile, mode;          /* side of a tile or 0; 1: with the levels of a mipmap */
    const char *channels[4]; /* by name; NULL: no more */
    int sampling[3];         /* of their columns and rows */
};

/* Of a channel, at x, y of the display window. Y, RY and BY are those of the red, green and blue of this picture. */
static float value_at(const char *channel, int x, int y) {
    double red = 0.5 + x / 16.0, green = red / 2, blue = red / 4;
    double luminance = 0.212639 * red + 0.715169 * green + 0.072192 * blue;
    if (strcmp(channel, "RY") == 0)
        return (float)(red / luminance - 1);
    if (strcmp(channel, "BY") == 0)
        return (float)(blue / luminance - 1);
    (void)y;
    return (float)(channel[0] == 'R' ? red : channel[0] == 'G' ? green + y : channel[0] == 'B' ? blue : luminance);
}

/* The values of a rectangle, row by row and there channel by channel; returns their number. */
static size_t add_values(struct bytes *b, const struct layout *l, const int32_t box[4]) {
    size_t count = 0;
    for (int y = box[1]; y <= box[3]; y++)
        for (int i = 0; l->channels[i]; i++)
            for (int x = box[0]; x <= box[2] && y % l->sampling[i] == 0; x++)
                if (x % l->sampling[i] == 0) {
                    bytes_float(b, (double)value_at(l->channels[i], x, y), false);
                    count++;
                }
    return count;
}

static void add_chunk(struct bytes *b, const struct layout *l, const int32_t box[4], size_t entry) {
    uint64_t at = b->size;
    for (int i = 0; i < 8; i++)
        b->data[entry + (size_t)i] = (uint8_t)(at >> 8 * i);
    if (l->tile) {
        bytes_number(b, (uint64_t)((box[0] - l->data[0]) / l->tile), 4, false);
        bytes_number(b, (uint64_t)((box[1] - l->data[1]) / l->tile), 4, false);
        bytes_number(b, 0, 8, false);
    } else {
        bytes_number(b, (uint32_t)box[1], 4, false);
    }
    struct bytes values = {0};
    bytes_number(b, 4 * add_values(&values, l, box), 4, false);
    bytes_add(b, values.data, values.size);
    bytes_free(&values);
}

static void make_file(struct bytes *b, const struct layout *l) {
    bytes_add(b, "\x76\x2f\x31\x01\x02", 5);
    bytes_number(b, l->tile ? 2 : 0, 3, false);
    size_t list = 1;
    for (int i = 0; l->channels[i]; i++)
        list += strlen(l->channels[i]) + 17;
    attribute(b, "channels", "chlist", list);
    for (int i = 0; l->channels[i]; i++) {
        bytes_add(b, l->channels[i], strlen(l->channels[i]) + 1);
        bytes_number(b, 2, 4, false);
        bytes_number(b, 0, 4, false);
        bytes_number(b, (uint64_t)l->sampling[i], 4, false);
        bytes_number(b, (uint64_t)l->sampling[i], 4, false);
    }
    bytes_add(b, "", 1);
    attribute(b, "compression", "compression", 1);
    bytes_add(b, "", 1);
    windows(b, l->data, l->display);
    if (l->tile) {
        attribute(b, "tiles", "tiledesc", 9);
        bytes_number(b, (uint64_t)l->tile, 4, false);
        bytes_number(b, (uint64_t)l->tile, 4, false);
        bytes_number(b, (uint64_t)l->mode, 1, false);
    }
    bytes_add(b, "", 1);
    /* The table, with empty entries for the smaller levels, then lines or tiles. */
    size_t entry = b->size;
    int step = l->tile ? l->tile : 1, wide = l->tile ? l->tile : 1 << 20;
    for (int i = 0; i < 64; i++)
        bytes_number(b, 0, 8, false);
    for (int32_t y = l->data[1]; y <= l->data[3]; y += step)
        for (int64_t x = l->data[0]; x <= l->data[2]; x += wide, entry += 8) {
            int32_t right = x + wide - 1 < l->data[2] ? (int32_t)x + wide - 1 : l->data[2];
            int32_t bottom = y + step - 1 < l->data[3] ? y + step - 1 : l->data[3];
            add_chunk(b, l, (const int32_t[]){(int32_t)x, y, right, bottom}, entry);
        }
}

static void check_layout(const struct layout *l, bool chroma) {
    struct bytes b = {0};
    struct error error = {0};
    make_file(&b, l);
    for (size_t size = 0; size < b.size; size++) {
        uint8_t *copy = malloc(size ? size : 1);
        memcpy(copy, b.data, size);
        struct image *image = image_parse("t.exr", copy, size, &error);
        if (!image && (strncmp(error.text, "t.exr: ", 7) != 0 || strchr(error.text, '\n')))
            test_fail(__FILE__, __LINE__, "cut at %zu: %s", size, error.text);
        image_release(image);
        free(copy);
    }
    struct image *image = image_parse("t.exr", b.data, b.size, &error);
    bytes_free(&b);
    if (!image) {
        test_fail(__FILE__, __LINE__, "%s", error.text);
        return;
    }
    CHECK_EQ_INT(image_width(image), l->display[2] - l->display[0] + 1);
    CHECK_EQ_INT(image_height(image), l->display[3] - l->display[1] + 1);
    for (int y = l->display[1]; y <= l->display[3]; y++)
        for (int x = l->display[0]; x <= l->display[2]; x++) {
            bool inside = x >= l->data[0] && y >= l->data[1] && x <= l->data[2] && y <= l->data[3];
            struct rgba c = image_texel(image, (uint32_t)(x - l->display[0]), (uint32_t)(y - l->display[1]));
            double green = (double)value_at("G", x, chroma ? 0 : y);
            CHECK_NEAR(c.r, inside ? (double)value_at("R", x, y) : 0, 1e-5);
            CHECK_NEAR(c.g, inside ? green : 0, 1e-5);
            CHECK_NEAR(c.b, inside ? (double)value_at("B", x, y) : 0, 1e-5);
            CHECK_NEAR(c.a, 1, 0);
        }
    image_release(image);
}

TEST(exr_shows_its_display_window_in_lines_in_tiles_and_with_chroma) {
    static const struct layout layouts[] = {
        {{0, 0, 9, 7}, {0, 0, 9, 7}, 4, 0, {"B", "G", "R"}, {1, 1, 1}},
        {{0, 0, 9, 7}, {0, 0, 9, 7}, 4, 1, {"B", "G", "R"}, {1, 1, 1}},
        {{2, 3, 11, 10}, {0, 0, 13, 11}, 0, 0, {"B", "G", "R"}, {1, 1, 1}},
        {{-2, -3, 11, 10}, {0, 0, 5, 4}, 0, 0, {"B", "G", "R"}, {1, 1, 1}},
        {{-2, -3, 11, 10}, {1, 1, 15, 6}, 4, 1, {"B", "G", "R"}, {1, 1, 1}},
        {{20, 20, 25, 25}, {0, 0, 5, 4}, 4, 0, {"B", "G", "R"}, {1, 1, 1}},
        {{0, 0, 7, 5}, {0, 0, 7, 5}, 0, 0, {"BY", "RY", "Y"}, {2, 2, 1}},
        {{4, 2, 11, 9}, {0, 0, 13, 9}, 0, 0, {"BY", "RY", "Y"}, {2, 2, 1}},
        {{4, 2, 11, 9}, {0, 0, 13, 9}, 4, 0, {"BY", "RY", "Y"}, {1, 1, 1}},
    };
    for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++)
        check_layout(&layouts[i], i > 5);
}

static bool write_read(const char *path, struct error *error) {
    static float values[2 * WIDTH * HEIGHT];
    const struct exr_channel channels[] = {{"Y", values, 2}, {"Z", values + 1, 2}};
    char rows[600];
    (void)snprintf(rows, sizeof rows, "%s.exr", path);
    if (!exr_write(FILE_AT(rows), WIDTH, HEIGHT, ramp_row, NULL, error) ||
        !exr_write_channels(FILE_AT(path), WIDTH, HEIGHT, channels, 2, error))
        return false;
    struct image *image = image_read(rows, error);
    bool ok = image && fabs(image_texel(image, 3, 5).g - 15.0 / 64) < 1e-6;
    if (image && !ok)
        test_fail(__FILE__, __LINE__, "another picture");
    image_release(image);
    return ok;
}

TEST(any_allocation_or_call_may_fail_while_exr_is_written_and_read) {
#ifndef GRAY_FAULTS
    test_skip("failures on demand are only in builds with GRAY_FAULTS");
#endif
    int failed[2] = {0};
    for (int kind = 0; kind < 2; kind++)
        for (uint64_t k = 1, over = 0; !over; k++) {
            struct error error = {0};
            uint64_t before = fault_count((enum fault_kind)kind);
            fault_at((enum fault_kind)kind, k);
            bool ok = write_read(test_path("a.exr"), &error);
            fault_at((enum fault_kind)kind, 0);
            over = fault_count((enum fault_kind)kind) - before < k;
            CHECK(ok || (error.text[0] && !strchr(error.text, '\n')));
            failed[kind] += !ok;
        }
    CHECK(failed[0] > 20 && failed[1] > 20);
}

#endif
