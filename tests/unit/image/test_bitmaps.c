/* BMP, TGA and WebP: files of every variant, made here, have the texels of the picture that they were made of. */
#include "base/mem.h"
#include "image/bmp_read_internal.h"
#include "image/image.h"
#include "image/levels.h"
#include "image/tga_read_internal.h"
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

enum { WIDTH = 13, HEIGHT = 6, ROOM = 4096 };

struct file {
    uint8_t bytes[ROOM];
    size_t size;
};

static void put(struct file *f, uint32_t value, int bytes) {
    for (int i = 0; i < bytes; i++)
        f->bytes[f->size++] = (uint8_t)(value >> 8 * i);
}

/* Number x, y of a picture of so many colours; runs and single ones. */
static uint32_t index_at(uint32_t x, uint32_t y, uint32_t colours) {
    return (x < 5 ? y : x * 7 + y * 5) % colours;
}

/* Each channel is 0 or 255 where a pixel has 16 bits (`coarse`). */
static void colour_of(uint32_t index, bool coarse, bool alpha, uint8_t out[4]) {
    for (uint32_t k = 0; k < 4; k++)
        out[k] = (uint8_t)(coarse ? 255 * (index >> k & 1) : index * (37 + 50 * k) + 11 * k);
    out[3] = alpha ? out[3] : 255;
}

struct picture {
    uint32_t colours;
    bool coarse, alpha;
};

static struct image *wanted(const struct picture *p) {
    uint8_t rgba[WIDTH * HEIGHT * 4];
    struct error error = {0};
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
        colour_of(index_at(i % WIDTH, i / WIDTH, p->colours), p->coarse, p->alpha, rgba + 4 * i);
    return image_create("wanted", WIDTH, HEIGHT, 8, rgba, &error);
}

/* A copy of exactly this size, so that the sanitizer detects every read outside it. */
static struct image *parse(const char *name, const struct file *f, size_t size, struct error *error) {
    uint8_t *copy = malloc(size ? size : 1);
    memcpy(copy, f->bytes, size);
    *error = (struct error){0};
    struct image *image = image_parse(name, copy, size, error);
    free(copy);
    return image;
}

/* The file is the picture; each of its beginnings is one line, or the same picture. */
static void check_file(const char *name, const struct file *f, const struct picture *p) {
    struct image *want = wanted(p);
    struct error error;
    for (size_t size = 0; size <= f->size; size++) {
        struct image *image = parse(name, f, size, &error);
        bool same = image && image_width(image) == WIDTH && image_height(image) == HEIGHT && image->bits == 8 &&
                    image->block_size == want->block_size && memcmp(image->block, want->block, want->block_size) == 0;
        if (size == f->size && !same)
            test_fail(__FILE__, __LINE__, "%s: another picture (%s)", name, error.text);
        if (!image && (error.kind != ERROR_SCENE || !strstr(error.text, name) || strchr(error.text, '\n')))
            test_fail(__FILE__, __LINE__, "%s, %zu bytes: '%s'", name, size, error.text);
        image_release(image);
    }
    image_release(want);
}

/* --- BMP --- */

struct bmp_kind {
    uint32_t header, bits, compression;
    bool from_top;
    struct picture picture;
};

static uint32_t bmp_pixel(uint32_t bits, const uint8_t c[4]) {
    if (bits == 16)
        return (uint32_t)(c[0] >> 3 << 11 | c[1] >> 2 << 5 | c[2] >> 3);
    return (uint32_t)c[2] | (uint32_t)c[1] << 8 | (uint32_t)c[0] << 16 | (uint32_t)c[3] << 24;
}

/* Runs of one colour where there are any; single pixels of three and more are also written as such. */
static void bmp_runs(struct file *f, const struct bmp_kind *kind, uint32_t y) {
    uint32_t colours = kind->picture.colours;
    for (uint32_t x = 0; x < 5;) {
        put(f, 5, 1);
        put(f, index_at(0, y, colours) * (kind->bits == 4 ? 17 : 1), 1);
        x += 5;
    }
    put(f, 0, 1);
    put(f, WIDTH - 5, 1);
    for (uint32_t x = 5; x < WIDTH; x += kind->bits == 4 ? 2 : 1) {
        uint32_t first = index_at(x, y, colours);
        put(f, kind->bits == 4 ? first << 4 | index_at(x + 1, y, colours) : first, 1);
    }
    put(f, 0, 2); /* the end of the row */
}

static void bmp_row(struct file *f, const struct bmp_kind *kind, uint32_t y) {
    size_t start = f->size;
    uint32_t bits = kind->bits, byte = 0;
    for (uint32_t x = 0; x < WIDTH; x++) {
        uint32_t index = index_at(x, y, kind->picture.colours);
        uint8_t c[4];
        colour_of(index, kind->picture.coarse, kind->picture.alpha, c);
        if (bits > 8) {
            uint32_t five = bits == 16 && kind->compression == 0;
            put(f, five ? (uint32_t)(c[0] >> 3 << 10 | c[1] >> 3 << 5 | c[2] >> 3) : bmp_pixel(bits, c), (int)bits / 8);
            continue;
        }
        byte = byte << bits | index;
        if ((x + 1) * bits % 8 == 0 || x + 1 == WIDTH)
            put(f, x + 1 == WIDTH ? byte << (8 - ((x * bits) % 8 + bits)) : byte, 1);
    }
    while ((f->size - start) % 4)
        put(f, 0, 1);
}

static void bmp_make(struct file *f, const struct bmp_kind *kind) {
    bool small = kind->header == 12, runs = kind->compression == 1 || kind->compression == 2;
    uint32_t height = kind->from_top ? (uint32_t)-HEIGHT : HEIGHT;
    uint32_t masks = kind->compression == 3 && kind->header == 40 ? 12 : kind->compression == 6 ? 16 : 0;
    uint32_t colours = kind->bits <= 8 ? 1u << kind->bits : 0;
    f->size = 0;
    put(f, 0x4d42, 2), put(f, 0, 4), put(f, 0, 4);
    put(f, 14 + kind->header + masks + colours * (small ? 3 : 4), 4);
    put(f, kind->header, 4), put(f, WIDTH, small ? 2 : 4), put(f, height, small ? 2 : 4), put(f, 1, 2);
    put(f, kind->bits, 2);
    size_t end = 14 + kind->header + masks;
    if (kind->header > 16)
        put(f, kind->compression, 4);
    memset(f->bytes + f->size, 0, ROOM - f->size);
    if (kind->compression == 3 || kind->compression == 6) {
        f->size = 54;
        put(f, kind->bits == 16 ? 0xf800 : 0xff0000, 4), put(f, kind->bits == 16 ? 0x7e0 : 0xff00, 4);
        put(f, kind->bits == 16 ? 0x1f : 0xff, 4);
        if (kind->picture.alpha)
            put(f, 0xff000000, 4);
    }
    f->size = end;
    for (uint32_t i = 0; i < colours; i++) {
        uint8_t c[4];
        colour_of(i, kind->picture.coarse, false, c);
        put(f, bmp_pixel(24, c) & 0xffffff, small ? 3 : 4);
    }
    for (uint32_t i = 0; i < HEIGHT; i++)
        (runs ? bmp_runs : bmp_row)(f, kind, kind->from_top ? i : HEIGHT - 1 - i);
    if (runs)
        put(f, 0x100, 2);
}

TEST(bmp_of_every_kind_has_the_texels_of_its_picture) {
    static const struct bmp_kind kinds[] = {
        {40, 1, 0, false, {2, false, false}},    {40, 4, 0, false, {16, false, false}},
        {40, 8, 0, false, {256, false, false}},  {40, 16, 0, false, {256, true, false}},
        {40, 24, 0, false, {256, false, false}}, {40, 32, 0, false, {256, false, false}},
        {40, 8, 0, true, {256, false, false}},   {40, 24, 0, true, {256, false, false}},
        {12, 1, 0, false, {2, false, false}},    {12, 4, 0, false, {16, false, false}},
        {12, 8, 0, false, {256, false, false}},  {12, 24, 0, false, {256, false, false}},
        {16, 8, 0, false, {256, false, false}},  {64, 24, 0, false, {256, false, false}},
        {40, 8, 1, false, {256, false, false}},  {40, 4, 2, false, {16, false, false}},
        {64, 8, 1, false, {256, false, false}},  {40, 16, 3, false, {256, true, false}},
        {40, 32, 3, false, {256, false, false}}, {52, 32, 3, false, {256, false, false}},
        {56, 32, 3, false, {256, false, true}},  {108, 32, 3, false, {256, false, true}},
        {124, 32, 3, true, {256, false, true}},  {124, 16, 3, false, {256, true, false}},
        {108, 8, 0, false, {256, false, false}}, {124, 24, 0, false, {256, false, false}},
        {40, 32, 6, false, {256, false, true}},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        static struct file f;
        char name[64];
        (void)snprintf(name, sizeof name, "header%u_bits%u_kind%u_%d.bmp", kinds[i].header, kinds[i].bits,
                       kinds[i].compression, kinds[i].from_top);
        bmp_make(&f, &kinds[i]);
        check_file(name, &f, &kinds[i].picture);
    }
}

/* 4 x 2: the upper row begins with two pixels of colour 1, the other pixels are passed over. */
TEST(bmp_in_runs_may_step_over_pixels) {
    static struct file f;
    const struct bmp_kind kind = {40, 8, 1, false, {256, false, false}};
    struct error error;
    bmp_make(&f, &kind);
    f.size = 14 + 40 + 1024;
    f.bytes[18] = 4, f.bytes[22] = 2;
    put(&f, 0x01000200, 4), put(&f, 0x0102, 2), put(&f, 0x0100, 2);
    struct image *image = parse("step.bmp", &f, f.size, &error);
    CHECK_TEXT(error.text, "");
    for (uint32_t i = 0; image && i < 8; i++) {
        uint8_t c[4];
        colour_of(i < 2, false, false, c);
        CHECK_NEAR(image_texel(image, i % 4, i / 4).r * 255, c[0], 1e-9);
    }
    image_release(image);
}

TEST(bmp_whose_alpha_is_0_everywhere_is_opaque) {
    static struct file f;
    const struct bmp_kind kind = {124, 32, 3, false, {256, false, true}};
    struct error error;
    bmp_make(&f, &kind);
    for (size_t i = 14 + 124 + 3; i < f.size; i += 4)
        f.bytes[i] = 0;
    struct image *image = parse("clear.bmp", &f, f.size, &error);
    CHECK(image && image_largest(image).a == 1);
    image_release(image);
}

/* --- TGA --- */

struct tga_kind {
    uint32_t type, bits, palette_bits, descriptor;
    struct picture picture;
};

static void tga_colour(struct file *f, uint32_t bits, const uint8_t c[4]) {
    if (bits == 8)
        put(f, c[0], 1);
    else if (bits <= 16)
        put(f, (uint32_t)(c[3] >> 7 << 15 | c[0] >> 3 << 10 | c[1] >> 3 << 5 | c[2] >> 3), 2);
    else
        put(f, bmp_pixel(32, c), (int)bits / 8);
}

static void tga_pixel(struct file *f, const struct tga_kind *kind, uint32_t x, uint32_t y) {
    uint32_t index = index_at(x, y, kind->picture.colours);
    uint8_t c[4];
    colour_of(index, kind->picture.coarse, kind->picture.alpha, c);
    if ((kind->type & 7) == 1)
        put(f, index + 3, 1);
    else
        tga_colour(f, kind->bits, c);
}

static void tga_make(struct file *f, const struct tga_kind *kind) {
    bool palette = (kind->type & 7) == 1;
    f->size = 0;
    put(f, 2, 1), put(f, palette, 1), put(f, kind->type, 1);
    put(f, palette ? 3 : 0, 2), put(f, palette ? kind->picture.colours : 0, 2), put(f, kind->palette_bits, 1);
    put(f, 0, 4), put(f, WIDTH, 2), put(f, HEIGHT, 2), put(f, kind->bits, 1), put(f, kind->descriptor, 1);
    put(f, 'h' | 'i' << 8, 2);
    for (uint32_t i = 0; palette && i < kind->picture.colours; i++) {
        uint8_t c[4];
        colour_of(i, kind->picture.coarse, kind->picture.alpha, c);
        tga_colour(f, kind->palette_bits, c);
    }
    for (uint32_t i = 0; i < HEIGHT; i++) {
        uint32_t y = kind->descriptor & 32 ? i : HEIGHT - 1 - i;
        bool mirrored = kind->descriptor & 16;
        for (uint32_t k = 0; k < WIDTH; k++) {
            uint32_t x = mirrored ? WIDTH - 1 - k : k;
            if (kind->type & 8 && (k == 0 || k == 8)) /* of 8 single pixels, then 5, which are equal if mirrored */
                put(f, k == 0 ? 7 : mirrored ? 0x84 : 4, 1);
            if (!(kind->type & 8 && mirrored && k > 8))
                tga_pixel(f, kind, x, y);
        }
    }
}

TEST(tga_of_every_kind_has_the_texels_of_its_picture) {
    for (uint32_t origin = 0; origin < 4; origin++)
        for (uint32_t packets = 0; packets < 16; packets += 8) {
            const struct tga_kind kinds[] = {
                {1, 8, 24, 0, {200, false, false}}, {1, 8, 32, 8, {200, false, true}},
                {1, 8, 16, 0, {200, true, false}},  {2, 15, 0, 0, {256, true, false}},
                {2, 16, 0, 1, {256, true, true}},   {2, 16, 0, 0, {256, true, false}},
                {2, 24, 0, 0, {256, false, false}}, {2, 32, 0, 8, {256, false, true}},
            };
            for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
                static struct file f;
                struct tga_kind kind = kinds[i];
                char name[64];
                kind.type += packets;
                kind.descriptor += 16 * origin;
                (void)snprintf(name, sizeof name, "type%u_bits%u_%02x.tga", kind.type, kind.bits, kind.descriptor);
                tga_make(&f, &kind);
                check_file(name, &f, &kind.picture);
            }
        }
}

TEST(tga_in_gray_has_its_values) {
    static struct file f;
    struct error error;
    for (uint32_t packets = 0; packets < 16; packets += 8) {
        const struct tga_kind kind = {3 + packets, 8, 0, 32, {256, false, false}};
        tga_make(&f, &kind);
        struct image *image = parse("gray.tga", &f, f.size, &error), *want = wanted(&kind.picture);
        CHECK_TEXT(error.text, "");
        for (uint32_t i = 0; image && i < WIDTH * HEIGHT; i++) {
            struct rgba c = image_texel(image, i % WIDTH, i / WIDTH);
            CHECK(c.r == image_texel(want, i % WIDTH, i / WIDTH).r && c.g == c.r && c.b == c.r && c.a == 1);
        }
        image_release(image);
        image_release(want);
    }
}

/* Without its ending a TGA is known by its footer alone. */
TEST(tga_is_known_by_its_ending_or_its_footer) {
    static struct file f;
    const struct tga_kind kind = {2, 24, 0, 32, {256, false, false}};
    tga_make(&f, &kind);
    CHECK(tga_is("a.TGA", f.bytes, f.size));
    CHECK(!tga_is("a.png", f.bytes, f.size));
    put(&f, 0, 8);
    memcpy(f.bytes + f.size, "TRUEVISION-XFILE.", 18);
    f.size += 18;
    CHECK(tga_is("a.png", f.bytes, f.size));
    CHECK(!tga_is("a.tga", (const uint8_t *)"a text of some length, no picture", 33));
}

/* --- sizes and kinds --- */

TEST(a_bitmap_that_claims_to_be_huge_costs_no_memory) {
    static struct file f;
    struct error error;
    const struct bmp_kind bmps[] = {{40, 24, 0, false, {256, false, false}}, {40, 8, 1, false, {256, false, false}}};
    const struct tga_kind tgas[] = {{2, 24, 0, 0, {256, false, false}}, {10, 24, 0, 0, {256, false, false}}};
    for (int i = 0; i < 4; i++)
        for (int side = 0; side < 2; side++) {
            bool bmp = i < 2;
            if (bmp)
                bmp_make(&f, &bmps[i]);
            else
                tga_make(&f, &tgas[i - 2]);
            uint8_t *width = f.bytes + (bmp ? 18 : 12), *height = f.bytes + (bmp ? 22 : 14);
            width[0] = width[1] = height[0] = height[1] = 0xff;
            width[1] = height[1] = side ? 0x3f : 0xff;
            struct image *image = parse(bmp ? "huge.bmp" : "huge.tga", &f, f.size, &error);
            CHECK(!image && strstr(error.text, side ? "the file ends" : "65535 x 65535 pixels are too many"));
            image_release(image);
        }
    struct rusage usage;
    (void)getrusage(RUSAGE_SELF, &usage);
    CHECK(usage.ru_maxrss < 256 << 10); /* KiB */
}

TEST(pictures_of_a_kind_that_is_not_read_are_named) {
    static const struct {
        const char *kind, *bytes;
        size_t size;
    } cases[] = {{"GIF", "GIF89a", 6},
                 {"TIFF", "II*\0....", 8},
                 {"TIFF", "MM\0*....", 8},
                 {"Photoshop (PSD)", "8BPS\0\1", 6},
                 {"AVIF",
                  "\0\0\0\x1c"
                  "ftypavif",
                  12},
                 {"HEIC",
                  "\0\0\0\x1c"
                  "ftypheic",
                  12},
                 {"KTX2", "\xabKTX 20\xbb", 8},
                 {"DDS", "DDS |...", 8}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct error error = {0};
        char want[160];
        (void)snprintf(want, sizeof want,
                       "t.png: this is a picture of the kind %s, which gray does not read: convert it to PNG",
                       cases[i].kind);
        CHECK(image_parse("t.png", (const uint8_t *)cases[i].bytes, cases[i].size, &error) == NULL);
        CHECK_TEXT(error.text, want);
    }
}

/* --- WebP --- */

#ifndef HAVE_WEBP

TEST(webp_without_its_library_says_so) {
    struct error error = {0};
    CHECK(image_parse("t.webp", (const uint8_t *)"RIFF....WEBPVP8L", 16, &error) == NULL);
    CHECK(strstr(error.text, "t.webp: this is a WebP, which this build cannot read") == error.text);
}

#else

#include <webp/encode.h>
#include <webp/mux.h>

static const struct picture webp_picture = {256, false, true};

static void webp_make(struct file *f, bool animated) {
    uint8_t rgba[WIDTH * HEIGHT * 4];
    WebPConfig config;
    WebPPicture picture;
    WebPMemoryWriter writer;
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
        colour_of(index_at(i % WIDTH, i / WIDTH, 256), false, true, rgba + 4 * i);
    CHECK(WebPConfigInit(&config) && WebPPictureInit(&picture));
    WebPMemoryWriterInit(&writer);
    config.lossless = config.exact = 1;
    picture.use_argb = 1;
    picture.width = WIDTH, picture.height = HEIGHT;
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
    CHECK(WebPPictureImportRGBA(&picture, rgba, 4 * WIDTH) && WebPEncode(&config, &picture));
    WebPData data = {writer.mem, writer.size}, out = {NULL, 0};
    if (animated) {
        WebPMux *mux = WebPMuxNew();
        WebPMuxFrameInfo frame = {
            .bitstream = data, .duration = 100, .id = WEBP_CHUNK_ANMF, .dispose_method = WEBP_MUX_DISPOSE_NONE};
        WebPMuxAnimParams all = {0};
        CHECK(WebPMuxPushFrame(mux, &frame, 1) == WEBP_MUX_OK && WebPMuxPushFrame(mux, &frame, 1) == WEBP_MUX_OK);
        CHECK(WebPMuxSetAnimationParams(mux, &all) == WEBP_MUX_OK);
        CHECK(WebPMuxAssemble(mux, &out) == WEBP_MUX_OK);
        WebPMuxDelete(mux);
        data = out;
    }
    CHECK(data.size <= ROOM);
    memcpy(f->bytes, data.bytes, data.size);
    f->size = data.size;
    WebPDataClear(&out);
    WebPMemoryWriterClear(&writer);
    WebPPictureFree(&picture);
}

TEST(webp_has_the_texels_of_its_picture_or_of_its_first_frame) {
    static struct file f;
    webp_make(&f, false);
    check_file("still.webp", &f, &webp_picture);
    webp_make(&f, true);
    check_file("frames.webp", &f, &webp_picture);
}

/* Its own memory is counted before libwebp allocates it. */
TEST(webp_needs_the_memory_of_its_library_too) {
    static struct file f;
    struct error error;
    webp_make(&f, false);
    struct mem_account account = {.limit = 512 << 10, .words = "the limit"};
    struct mem_account *before = mem_charge(&account);
    struct image *image = image_parse("t.webp", f.bytes, f.size, &error);
    (void)mem_charge(before);
    CHECK(!image && error.limit && strstr(error.text, "t.webp: the limit"));
    image_release(image);
}

#endif
