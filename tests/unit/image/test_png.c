/* Reading and writing PNG: every kind of file that libpng can write gives its texels; broken files give one line. */
#include "base/mem.h"
#include "image/image.h"
#include "image/levels.h"
#include "image/png_read_internal.h"
#include "image/png_write.h"
#include "tests/harness.h"

#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_WIDTH = 40, MAX_HEIGHT = 40 };

/* A PNG file in memory. */
struct bytes {
    uint8_t *data;
    size_t size, room;
};

static void append(png_structp png, png_bytep data, size_t size) {
    struct bytes *bytes = png_get_io_ptr(png);
    if (bytes->room - bytes->size < size) {
        bytes->room = (bytes->room + size) * 2;
        bytes->data = realloc(bytes->data, bytes->room);
    }
    memcpy(bytes->data + bytes->size, data, size);
    bytes->size += size;
}

static void no_flush(png_structp png) {
    (void)png;
}

/* One kind of file, with random samples and the expected texels. */
struct kind {
    int type, depth, interlace;
    bool transparency; /* a tRNS chunk */
    bool gamma;        /* gAMA, sRGB or iCCP-like chunks that must have no effect */
    uint32_t width, height;
};

static int channels_of(int type) {
    return type == PNG_COLOR_TYPE_RGB          ? 3
           : type == PNG_COLOR_TYPE_RGB_ALPHA  ? 4
           : type == PNG_COLOR_TYPE_GRAY_ALPHA ? 2
                                               : 1;
}

static struct bytes make_png(const struct kind *kind, uint64_t seed, struct rgba *wanted) {
    struct test_random random = {seed};
    int channels = channels_of(kind->type), top = (1 << kind->depth) - 1;
    png_color palette[256];
    png_byte alphas[256];
    int colours = kind->type == PNG_COLOR_TYPE_PALETTE ? top + 1 : 0;
    for (int i = 0; i < colours; i++) {
        palette[i].red = (png_byte)test_uniform(&random, 0, 256);
        palette[i].green = (png_byte)test_uniform(&random, 0, 256);
        palette[i].blue = (png_byte)test_uniform(&random, 0, 256);
        alphas[i] = (png_byte)test_uniform(&random, 0, 256);
    }
    png_color_16 key = {.red = (png_uint_16)(top / 3),
                        .green = (png_uint_16)(top / 2),
                        .blue = (png_uint_16)top,
                        .gray = (png_uint_16)(top / 3)};

    static png_byte rows[MAX_HEIGHT][MAX_WIDTH * 8];
    memset(rows, 0, sizeof rows);
    for (uint32_t y = 0; y < kind->height; y++)
        for (uint32_t x = 0; x < kind->width; x++) {
            int s[4] = {0, 0, 0, 0};
            for (int c = 0; c < channels; c++)
                s[c] = (int)test_uniform(&random, 0, top + 1.0);
            if (x % 3 == 0 && kind->transparency && colours == 0) /* often the colour that is transparent */
                s[0] = channels == 1 ? key.gray : key.red, s[1] = key.green, s[2] = key.blue;
            for (int c = 0; c < channels; c++) {
                size_t bit = ((size_t)x * (size_t)channels + (size_t)c) * (size_t)kind->depth;
                if (kind->depth == 16)
                    rows[y][bit / 8] = (png_byte)(s[c] >> 8), rows[y][bit / 8 + 1] = (png_byte)s[c];
                else
                    rows[y][bit / 8] = (png_byte)(rows[y][bit / 8] | s[c] << (8 - kind->depth - (int)(bit % 8)));
            }
            struct rgba *out = &wanted[y * kind->width + x];
            double t = top;
            if (colours)
                *out = (struct rgba){palette[s[0]].red / 255.0, palette[s[0]].green / 255.0, palette[s[0]].blue / 255.0,
                                     kind->transparency ? alphas[s[0]] / 255.0 : 1};
            else if (channels <= 2)
                *out = (struct rgba){s[0] / t, s[0] / t, s[0] / t, channels == 2 ? s[1] / t : 1};
            else
                *out = (struct rgba){s[0] / t, s[1] / t, s[2] / t, channels == 4 ? s[3] / t : 1};
            if (kind->transparency && colours == 0 &&
                (channels == 1 ? s[0] == key.gray : s[0] == key.red && s[1] == key.green && s[2] == key.blue))
                out->a = 0;
        }

    struct bytes bytes = {0};
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(png, &bytes, append, no_flush);
    png_set_IHDR(png, info, kind->width, kind->height, kind->depth, kind->type, kind->interlace,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (colours)
        png_set_PLTE(png, info, palette, colours);
    if (kind->transparency)
        png_set_tRNS(png, info, alphas, colours, colours ? NULL : &key);
    if (kind->gamma) {
        png_set_gAMA_fixed(png, info, 100000 / 3);
        png_set_text(png, info,
                     &(png_text){.compression = PNG_TEXT_COMPRESSION_zTXt,
                                 .key = (png_charp) "Comment",
                                 .text = (png_charp) "text",
                                 .text_length = 4},
                     1);
    }
    png_bytep pointers[MAX_HEIGHT];
    for (int y = 0; y < MAX_HEIGHT; y++)
        pointers[y] = rows[y];
    png_write_info(png, info);
    png_write_image(png, pointers);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return bytes;
}

static struct image *parse(const struct bytes *bytes, size_t size, struct error *error) {
    uint8_t *copy = malloc(size ? size : 1); /* exact, for the address sanitizer */
    if (size)
        memcpy(copy, bytes->data, size);
    memset(error, 0, sizeof *error);
    struct image *image = image_parse_png("t.png", copy, size, error);
    free(copy);
    return image;
}

static void check_kind(const struct kind *kind, uint64_t seed) {
    static struct rgba wanted[MAX_WIDTH * MAX_HEIGHT];
    struct bytes bytes = make_png(kind, seed, wanted);
    struct error error;
    struct image *image = parse(&bytes, bytes.size, &error);
    free(bytes.data);
    if (!image) {
        test_fail(__FILE__, __LINE__, "type %d depth %d: %s", kind->type, kind->depth, error.text);
        return;
    }
    CHECK_EQ_INT(image_width(image), kind->width);
    CHECK_EQ_INT(image_height(image), kind->height);
    CHECK_EQ_INT(image->bits, kind->depth == 16 ? 16 : 8);
    int wrong = 0;
    for (uint32_t y = 0; y < kind->height; y++)
        for (uint32_t x = 0; x < kind->width; x++) {
            struct rgba a = image_texel(image, x, y), b = wanted[y * kind->width + x];
            wrong += !(a.r == b.r && a.g == b.g && a.b == b.b && a.a == b.a);
        }
    if (wrong)
        test_fail(__FILE__, __LINE__, "type %d depth %d interlace %d tRNS %d gamma %d, %u x %u: %d texels are wrong",
                  kind->type, kind->depth, kind->interlace, kind->transparency, kind->gamma, kind->width, kind->height,
                  wrong);
    image_release(image);
}

TEST(png_of_every_kind_is_read_exactly) {
    static const int types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_PALETTE, PNG_COLOR_TYPE_RGB,
                                PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB_ALPHA};
    static const uint32_t sizes[][2] = {{1, 1}, {3, 7}, {40, 33}};
    int files = 0;
    for (int t = 0; t < 5; t++)
        for (int depth = 1; depth <= 16; depth *= 2)
            for (int variant = 0; variant < 8 * 3; variant++) {
                struct kind kind = {types[t],
                                    depth,
                                    variant % 2 ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                                    variant / 2 % 2,
                                    variant / 4 % 2,
                                    sizes[variant / 8][0],
                                    sizes[variant / 8][1]};
                bool alpha = (types[t] & PNG_COLOR_MASK_ALPHA) != 0;
                if ((depth < 8 && types[t] != PNG_COLOR_TYPE_GRAY && types[t] != PNG_COLOR_TYPE_PALETTE) ||
                    (depth == 16 && types[t] == PNG_COLOR_TYPE_PALETTE) || (alpha && kind.transparency))
                    continue;
                check_kind(&kind, (uint64_t)++files);
            }
    CHECK_EQ_INT(files, 312);
}

static const struct kind broken_kinds[] = {
    {PNG_COLOR_TYPE_RGB_ALPHA, 8, PNG_INTERLACE_NONE, false, true, 9, 5},
    {PNG_COLOR_TYPE_PALETTE, 4, PNG_INTERLACE_ADAM7, true, false, 13, 11},
    {PNG_COLOR_TYPE_GRAY, 16, PNG_INTERLACE_ADAM7, true, true, 5, 9},
};

/* One complete line that names the file. */
static void check_error(const struct error *error, const char *path) {
    CHECK_EQ_INT(error->kind, ERROR_SCENE);
    CHECK(strncmp(error->text, path, strlen(path)) == 0 && !strchr(error->text, '\n'));
}

TEST(png_cut_at_any_byte_is_an_error_of_a_truncated_file) {
    static struct rgba wanted[MAX_WIDTH * MAX_HEIGHT];
    for (int k = 0; k < 3; k++) {
        struct bytes bytes = make_png(&broken_kinds[k], 1, wanted);
        for (size_t size = 0; size < bytes.size; size++) {
            struct error error;
            struct image *image = parse(&bytes, size, &error);
            CHECK(image == NULL);
            check_error(&error, "t.png: ");
            char where[60];
            (void)snprintf(where, sizeof where, "the file ends at byte %zu,", size);
            if (size > 0 && !strstr(error.text, "truncated"))
                test_fail(__FILE__, __LINE__, "cut at %zu: %s", size, error.text);
            CHECK(size == 0 || strstr(error.text, where));
            image_release(image);
        }
        free(bytes.data);
    }
}

TEST(png_with_any_changed_byte_is_an_error) {
    static struct rgba wanted[MAX_WIDTH * MAX_HEIGHT];
    for (int k = 0; k < 3; k++) {
        struct bytes bytes = make_png(&broken_kinds[k], 2, wanted);
        for (size_t at = 0; at < bytes.size; at++)
            for (int bit = 0; bit < 8; bit++) {
                struct error error;
                bytes.data[at] ^= (uint8_t)(1 << bit);
                struct image *image = parse(&bytes, bytes.size, &error);
                bytes.data[at] ^= (uint8_t)(1 << bit);
                if (image)
                    test_fail(__FILE__, __LINE__, "byte %zu bit %d", at, bit);
                check_error(&error, "t.png: ");
                image_release(image);
            }
        free(bytes.data);
    }
}

TEST(png_errors_say_what_is_wrong) {
    static const struct {
        const char *bytes;
        size_t size;
        const char *message;
    } cases[] = {
        {"", 0, "t.png: not a PNG file: the file is empty"},
        {"hello", 5, "t.png: not a PNG file: it starts with other bytes"},
        {"\x89PNG\n\x1a\n....", 11,
         "t.png: not a PNG file: it looks like a PNG that was copied as text, which changed its line ends"},
        {"\x89PN", 3, "t.png: truncated PNG: the file ends at byte 3, before the picture is complete"},
        {"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x80\x01\0\0\0\x01\x08\x02\0\0\0....", 33,
         "t.png: 32769 x 1 pixels are too many (at most 32768 a side and 268435456 in all)"},
        {"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x80\0\0\0\x7f\xff\x08\x02\0\0\0....", 33,
         "t.png: 32768 x 32767 pixels are too many (at most 32768 a side and 268435456 in all)"},
        {"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\0\0\0\0\x01\x08\x02\0\0\0....", 33,
         "t.png: broken PNG: its size is 0 x 1 (at byte 16)"},
        {"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\0\x08\x02\0\0\0....", 33,
         "t.png: broken PNG: its size is 1 x 0 (at byte 16)"},
        {"\x89PNG\r\n\x1a\n\0\0\0\rIDAT\0\0\0\0\0\0\0\x01\x08\x02\0\0\0....", 33,
         "t.png: broken PNG: the first chunk is not IHDR (at byte 8)"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct error error = {0};
        CHECK(image_parse_png("t.png", (const uint8_t *)cases[i].bytes, cases[i].size, &error) == NULL);
        CHECK_TEXT(error.text, cases[i].message);
    }
    struct error error = {0};
    CHECK(image_read("no/such/file.png", &error) == NULL);
    check_error(&error, "no/such/file.png: ");
}

/* A tiny file that claims 16384 x 16384 pixels must not cost a gigabyte. */
TEST(png_that_is_too_short_for_its_size_is_refused) {
    static struct rgba wanted[MAX_WIDTH * MAX_HEIGHT];
    struct bytes bytes = make_png(&broken_kinds[0], 3, wanted);
    bytes.data[18] = 0x40, bytes.data[19] = 0, bytes.data[22] = 0x40, bytes.data[23] = 0;
    uint32_t crc = 0xffffffffu;
    for (size_t i = 12; i < 29; i++) {
        crc ^= bytes.data[i];
        for (int k = 0; k < 8; k++)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    for (size_t i = 0; i < 4; i++)
        bytes.data[29 + i] = (uint8_t)(~crc >> (24 - 8 * i));
    struct error error;
    CHECK(parse(&bytes, bytes.size, &error) == NULL);
    CHECK(strstr(error.text, "too short for 16384 x 16384 pixels"));
    free(bytes.data);
}

TEST(png_reading_survives_every_failed_allocation) {
    static struct rgba wanted[MAX_WIDTH * MAX_HEIGHT];
    struct bytes bytes = make_png(&broken_kinds[1], 4, wanted);
    struct error error;
    uint64_t before = mem_allocations();
    image_release(parse(&bytes, bytes.size, &error));
    uint64_t count = mem_allocations() - before;
    for (uint64_t k = 1; k <= count; k++) {
        mem_fail_at(k);
        struct image *image = parse(&bytes, bytes.size, &error);
        mem_fail_at(0);
        CHECK(image || error.kind == ERROR_MACHINE);
        image_release(image);
    }
    free(bytes.data);
    if (count == 0)
        test_skip("this build cannot make allocations fail");
}

static void noise_rows(void *context, uint32_t y, uint8_t *line) {
    uint32_t width = *(const uint32_t *)context;
    for (uint32_t i = 0; i < 3 * width; i++)
        line[i] = (uint8_t)(i * 7 + y * 13 + (i * y) % 11);
}

/* In this thread alone. */
static bool write_noise(const struct file_target *target, uint32_t width, uint32_t height, struct error *error) {
    struct png_source source = {.width = width, .height = height, .bytes = noise_rows, .context = &width};
    return png_write_from(target, &source, NULL, error);
}

TEST(png_write_and_read_give_the_same_pixels) {
    static const uint32_t sizes[][2] = {{1, 1}, {1, 300}, {301, 1}, {64, 64}, {127, 33}};
    for (int i = 0; i < 5; i++) {
        char path[300];
        struct error error = {0};
        uint32_t width = sizes[i][0];
        (void)snprintf(path, sizeof path, "%s/new/folder/%d.png", test_folder(), i);
        CHECK(write_noise(FILE_AT(path), width, sizes[i][1], &error));
        struct test_picture picture = test_read_picture(path);
        CHECK_EQ_INT(picture.width, width);
        CHECK_EQ_INT(picture.height, sizes[i][1]);
        struct image *image = image_read(path, &error);
        CHECK_TEXT(error.text, "");
        for (uint32_t y = 0; image && y < sizes[i][1]; y++) {
            uint8_t line[3 * 301];
            noise_rows(&width, y, line);
            CHECK(memcmp(line, picture.rgb + (size_t)y * 3 * width, 3 * width) == 0);
            for (uint32_t x = 0; x < width; x++) {
                struct rgba c = image_texel(image, x, y);
                CHECK(png_write_byte(c.r) == line[3 * x] && png_write_byte(c.g) == line[3 * x + 1] &&
                      png_write_byte(c.b) == line[3 * x + 2] && c.a == 1);
            }
        }
        image_release(image);
        free(picture.rgb);
    }
}

TEST(png_bytes_depend_only_on_the_pixels) {
    char path[2][300];
    struct error error = {0};
    for (int i = 0; i < 2; i++) {
        (void)snprintf(path[i], sizeof path[i], "%s/%d.png", test_folder(), i);
        CHECK(write_noise(FILE_AT(path[i]), 100, 80, &error));
    }
    size_t size_a = 0, size_b = 0;
    char *a = test_read_file(path[0], &size_a), *b = test_read_file(path[1], &size_b);
    CHECK(size_a == size_b && memcmp(a, b, size_a) == 0);
    for (size_t at = 8; at + 12 <= size_a;) { /* nothing but IHDR, IDAT, IEND */
        CHECK(memcmp(a + at + 4, "IHDR", 4) == 0 || memcmp(a + at + 4, "IDAT", 4) == 0 ||
              memcmp(a + at + 4, "IEND", 4) == 0);
        const uint8_t *length = (const uint8_t *)a + at;
        at += 12 + ((size_t)length[0] << 24 | (size_t)length[1] << 16 | (size_t)length[2] << 8 | length[3]);
    }
    free(a);
    free(b);
}

static void noise_words(void *context, uint32_t y, uint16_t *line) {
    uint32_t width = *(const uint32_t *)context;
    for (uint32_t i = 0; i < 3 * width; i++)
        line[i] = (uint16_t)(i * 1777 + y * 1313 + (i * y) % 1100);
}

/* A picture of many strips and a narrow one, with 8 and 16 bits, compared with the rows and with each other. */
TEST(png_bytes_are_the_same_by_any_number_of_threads) {
    uint32_t width = 1000;
    struct error error = {0};
    struct png_source kinds[2] = {{.width = width, .height = 200, .bytes = noise_rows, .context = &width},
                                  {.width = width, .height = 200, .words = noise_words, .context = &width}};
    CHECK(png_write_stripes(width, 200, 8) > 8 && png_write_stripes(width, 200, 16) > 16);
    for (int kind = 0; kind < 2; kind++) {
        char *first = NULL, path[300], warning[256];
        size_t first_size = 0, size = 0;
        for (int threads = 0; threads < 4; threads++) {
            struct pool *pool = threads ? pool_create(threads, warning) : NULL;
            (void)snprintf(path, sizeof path, "%s/%d-%d.png", test_folder(), kind, threads);
            CHECK(png_write_from(FILE_AT(path), &kinds[kind], pool, &error));
            pool_destroy(pool);
            char *bytes = test_read_file(path, &size);
            first = first ? first : bytes;
            first_size = threads ? first_size : size;
            CHECK(size == first_size && memcmp(bytes, first, size) == 0);
            if (bytes != first)
                free(bytes);
        }
        free(first);
        struct image *image = image_read(path, &error);
        CHECK(image);
        for (uint32_t y = 0; image && y < 200; y += 50) {
            static uint8_t line[3 * 1000];
            static uint16_t words[3 * 1000];
            noise_rows(&width, y, line);
            noise_words(&width, y, words);
            for (uint32_t x = 0; x < width; x += 7) {
                struct rgba c = image_texel(image, x, y);
                CHECK_NEAR(c.r, kind ? words[3 * x] / 65535.0 : line[3 * x] / 255.0, 1e-6);
                CHECK_NEAR(c.b, kind ? words[3 * x + 2] / 65535.0 : line[3 * x + 2] / 255.0, 1e-6);
            }
        }
        image_release(image);
    }
}

TEST(png_write_reports_a_full_disk) {
    struct error error = {0};
    const struct file_rules is_direct = {.is_direct = true};
    CHECK(!write_noise(&(struct file_target){.path = "/dev/full", .rules = &is_direct}, 2000, 100, &error));
    CHECK_EQ_INT(error.kind, ERROR_MACHINE);
    CHECK(strncmp(error.text, "/dev/full: ", 11) == 0 && !strchr(error.text, '\n'));
}

TEST(png_write_refuses_sizes_a_png_cannot_have) {
    struct error error = {0};
    CHECK(!write_noise(FILE_AT("x.png"), 0, 1, &error));
    CHECK_TEXT(error.text, "x.png: a PNG file cannot have 0 x 1 pixels");
    CHECK(!write_noise(FILE_AT("x.png"), 4000000000u, 1, &error));
    CHECK(!write_noise(FILE_AT("x.png"), 1, 4000000000u, &error));
}

TEST(png_writing_survives_every_failed_allocation) {
    struct error error = {0};
    const char *path = test_path("a.png");
    uint64_t before = mem_allocations();
    CHECK(write_noise(FILE_AT(path), 20, 20, &error));
    uint64_t count = mem_allocations() - before;
    size_t size = 0, size_after = 0;
    char *old = test_read_file(path, &size);
    for (uint64_t k = 1; k <= count; k++) {
        mem_fail_at(k);
        bool ok = write_noise(FILE_AT(path), 20, 10, &error);
        mem_fail_at(0);
        CHECK(ok || error.kind == ERROR_MACHINE);
        char *now = test_read_file(path, &size_after); /* the old picture is unchanged */
        CHECK(ok || (size == size_after && memcmp(old, now, size) == 0));
        free(now);
    }
    free(old);
    if (count == 0)
        test_skip("this build cannot make allocations fail");
}

TEST(png_bytes_are_rounded_and_clamped) {
    static const struct {
        double value;
        int byte;
    } cases[] = {{0, 0},
                 {1, 255},
                 {0.5, 128},
                 {-1, 0},
                 {2, 255},
                 {1 / 255.0, 1},
                 {0.5 / 255, 1},
                 {0.499999 / 255, 0},
                 {254.5 / 255, 255},
                 {254.499999 / 255, 254},
                 {NAN, 0},
                 {INFINITY, 255},
                 {-INFINITY, 0},
                 {1e-300, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        CHECK_EQ_INT(png_write_byte(cases[i].value), cases[i].byte);
    for (int i = 0; i < 256; i++)
        CHECK_EQ_INT(png_write_byte(i / 255.0), i);
}
