/* BMP in ("Bitmap Storage", Win32 reference, Microsoft; OS/2 bitmaps have a header of 12 bytes, or one of 16 to 64
 * whose first 40 are those of Windows): a header whose first number is its size, perhaps masks, a palette, and rows of
 * whole 32-bit words from the bottom. Every offset is checked against the size of the file before it is used; a picture
 * in runs is refused if its pixels are more than the bytes can sensibly hold. */
#include "image/bmp_read_internal.h"

#include <string.h>

enum { FILE_HEADER = 14, OS2_HEADER = 12, WINDOWS_HEADER = 40, OS2_LARGE_HEADER = 64, PIXELS_PER_BYTE = 1024 };
enum compression { PLAIN = 0, RUNS_8 = 1, RUNS_4 = 2, MASKS = 3, MASKS_ALPHA = 6 };

struct reader {
    const char *path;
    const uint8_t *data;
    size_t size;
    struct error *error;
    uint32_t header, bits, compression, width, height;
    bool from_top;
    uint32_t masks[4]; /* red, green, blue, alpha */
    uint8_t palette[256][4];
    size_t pixels; /* the offset of the first row */
};

static bool fail(const struct reader *r, const char *what) {
    return error_set(r->error, ERROR_SCENE, "%s: broken BMP: %s", r->path, what);
}

static uint32_t word_at(const struct reader *r, size_t at) {
    const uint8_t *p = r->data + at;
    return at + 4 > r->size ? 0 : (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static uint32_t half_at(const struct reader *r, size_t at) {
    return at + 2 > r->size ? 0 : (uint32_t)(r->data[at] | r->data[at + 1] << 8);
}

/* A number of the header of the picture; short headers lack the later ones. */
static uint32_t field(const struct reader *r, uint32_t offset) {
    return offset + 4 <= r->header ? word_at(r, FILE_HEADER + offset) : 0;
}

static bool read_header(struct reader *r) {
    r->header = word_at(r, FILE_HEADER);
    r->pixels = word_at(r, 10);
    if (r->header != OS2_HEADER && (r->header < 16 || r->header > 1024))
        return fail(r, "the size of its header is unknown");
    if (r->size < FILE_HEADER + (size_t)r->header || r->pixels > r->size)
        return fail(r, "the file ends early");
    bool small = r->header == OS2_HEADER;
    uint32_t height = small ? half_at(r, 20) : word_at(r, 22);
    r->width = small ? half_at(r, 18) : word_at(r, 18);
    r->from_top = !small && height >> 31;
    r->height = r->from_top ? ~height + 1 : height;
    r->bits = half_at(r, small ? 24 : 28);
    r->compression = field(r, 16);
    uint32_t b = r->bits, c = r->compression;
    bool known = c == PLAIN    ? b == 1 || b == 2 || b == 4 || b == 8 || b == 16 || b == 24 || b == 32
                 : c == RUNS_8 ? b == 8
                 : c == RUNS_4
                     ? b == 4
                     : (c == MASKS || c == MASKS_ALPHA) && r->header != OS2_LARGE_HEADER && (b == 16 || b == 32);
    return known || error_set(r->error, ERROR_SCENE, "%s: BMP pictures of %u bits with compression %u are not read",
                              r->path, b, c);
}

/* Masks are in the header, or follow one of 40 bytes. */
static void read_masks(struct reader *r) {
    static const uint32_t of_16[3] = {0x7c00, 0x3e0, 0x1f}, of_32[3] = {0xff0000, 0xff00, 0xff};
    bool stated = r->compression == MASKS || r->compression == MASKS_ALPHA;
    for (size_t i = 0; i < 3; i++)
        r->masks[i] = stated ? word_at(r, FILE_HEADER + WINDOWS_HEADER + 4 * i) : r->bits == 16 ? of_16[i] : of_32[i];
    if (stated && (r->header >= 56 || r->compression == MASKS_ALPHA))
        r->masks[3] = word_at(r, FILE_HEADER + WINDOWS_HEADER + 12);
}

/* Colours that the file does not have stay black. */
static void read_palette(struct reader *r) {
    size_t entry = r->header == OS2_HEADER ? 3 : 4, start = FILE_HEADER + (size_t)r->header;
    size_t used = field(r, 32), count = (size_t)1 << r->bits,
           there = r->pixels > start ? (r->pixels - start) / entry : 0;
    count = used > 0 && used < count ? used : count;
    count = count < there ? count : there;
    for (size_t i = 0; i < 256; i++)
        r->palette[i][3] = 255;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < 3; k++)
            r->palette[i][k] = r->data[start + entry * i + 2 - k];
}

/* The bits of the mask, as a fraction of 255; without a mask, `absent`. */
static uint8_t part(uint32_t pixel, uint32_t mask, uint8_t absent) {
    if (mask == 0)
        return absent;
    uint64_t max = mask >> __builtin_ctz(mask), value = (pixel & mask) >> __builtin_ctz(mask);
    return (uint8_t)((value * 255 + max / 2) / max);
}

static uint8_t *texel(const struct reader *r, struct image *image, uint32_t x, uint32_t y) {
    return (uint8_t *)image->levels[0].texels + ((size_t)(r->from_top ? y : r->height - 1 - y) * r->width + x) * 4;
}

static void read_row(const struct reader *r, struct image *image, uint32_t y, size_t at) {
    const uint8_t *row = r->data + at;
    for (uint32_t x = 0; x < r->width; x++) {
        uint8_t *out = texel(r, image, x, y);
        if (r->bits <= 8) {
            uint32_t first = x * r->bits, byte = row[first / 8];
            memcpy(out, r->palette[byte >> (8 - r->bits - first % 8) & ((1u << r->bits) - 1)], 4);
        } else if (r->bits == 24) {
            out[0] = row[3 * x + 2], out[1] = row[3 * x + 1], out[2] = row[3 * x], out[3] = 255;
        } else {
            uint32_t pixel = r->bits == 16 ? half_at(r, at + 2 * (size_t)x) : word_at(r, at + 4 * (size_t)x);
            for (int k = 0; k < 4; k++)
                out[k] = part(pixel, r->masks[k], k == 3 ? 255 : 0);
        }
    }
}

static void read_rows(const struct reader *r, struct image *image) {
    size_t stride = ((size_t)r->width * r->bits + 31) / 32 * 4;
    for (uint32_t y = 0; y < r->height; y++)
        read_row(r, image, y, r->pixels + stride * y);
}

/* Pairs: a count and a colour (two in turn, of 4 bits), or 0 and: the end of a row (0), of the picture (1), a step
 * right and up (2), or that many colours one by one, in whole 16-bit words. Pixels that are passed over have colour 0.
 */
static bool read_runs(const struct reader *r, struct image *image) {
    size_t at = r->pixels;
    uint32_t x = 0, y = 0;
    for (size_t i = 0; i < (size_t)r->width * r->height; i++)
        memcpy((uint8_t *)image->levels[0].texels + 4 * i, r->palette[0], 4);
    while (r->size - at >= 2) {
        uint32_t count = r->data[at], code = r->data[at + 1];
        at += 2;
        if (count == 0 && code == 1)
            return true;
        if (count == 0 && code == 0) {
            x = 0, y++;
            continue;
        }
        bool step = count == 0 && code == 2, single = count == 0 && !step;
        size_t bytes = step ? 2 : single ? (r->bits == 8 ? code : (code + 1) / 2) : 0;
        if (r->size - at < bytes)
            break;
        const uint8_t *from = single ? r->data + at : r->data + at - 1;
        count = single ? code : count;
        if (step)
            x += from[1], y += from[2];
        if (!step && (y >= r->height || x > r->width || count > r->width - x))
            return fail(r, "a run is longer than its row");
        for (uint32_t i = 0; i < count; i++, x++) {
            uint8_t byte = single ? from[r->bits == 8 ? i : i / 2] : *from;
            memcpy(texel(r, image, x, y), r->palette[r->bits == 8 ? byte : i % 2 ? byte & 15 : byte >> 4], 4);
        }
        at += (bytes + 1) / 2 * 2 < r->size - at ? (bytes + 1) / 2 * 2 : r->size - at;
    }
    return fail(r, "the file ends early");
}

/* Whether the file can hold its pixels; the filling after the last row may be absent. */
static bool holds_its_pixels(const struct reader *r) {
    uint64_t row = ((uint64_t)r->width * r->bits + 7) / 8, stride = (row + 3) / 4 * 4;
    if (r->compression == RUNS_8 || r->compression == RUNS_4)
        return (uint64_t)r->width * r->height / PIXELS_PER_BYTE <= r->size;
    return r->height == 0 || stride * (r->height - 1) + row <= r->size - r->pixels;
}

bool bmp_is(const uint8_t *data, size_t size) {
    return size >= 2 && data[0] == 'B' && data[1] == 'M';
}

struct image *image_parse_bmp(const char *path, const uint8_t *data, size_t size, struct error *error) {
    struct reader r = {.path = path, .data = data, .size = size, .error = error};
    if (!read_header(&r))
        return NULL;
    bool too_large = r.width > IMAGE_MAX_SIDE || r.height > IMAGE_MAX_SIDE; /* said by image_allocate */
    if (!too_large && !holds_its_pixels(&r)) {
        fail(&r, "the file ends early");
        return NULL;
    }
    struct image *image = image_allocate(path, r.width, r.height, 8, error);
    if (!image)
        return NULL;
    if (r.bits <= 8)
        read_palette(&r);
    else
        read_masks(&r);
    bool runs = r.compression == RUNS_8 || r.compression == RUNS_4;
    bool ok = !runs || read_runs(&r, image);
    if (!runs)
        read_rows(&r, image);
    image_fill_empty_alpha(image);
    return image_finish(image, ok, error);
}
