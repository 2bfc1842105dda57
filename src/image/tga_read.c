/* TGA in ("Truevision TGA File Format Specification", version 2.0, 1991): a header of 18 bytes, a text, a palette,
 * pixels of 1 to 4 bytes, plain or in packets. A pixel in packets has at min_size 1/128 of a byte and its colour, so a
 * picture that the file cannot hold is refused before memory is allocated. */
#include "image/tga_read_internal.h"

#include <string.h>
#include <strings.h>

enum { HEADER = 18, FOOTER = 26, PACKET = 128 };
enum { TYPE_PALETTE = 1, TYPE_COLOUR = 2, TYPE_GRAY = 3, TYPE_PACKETS = 8 };

struct reader {
    const uint8_t *data;
    size_t size, at;
    uint32_t type; /* without TYPE_PACKETS */
    bool packets, from_top, from_right;
    uint32_t width, height, bits;
    bool bit_is_alpha; /* of pixels of 16 bits */
    size_t palette, palette_first, palette_count;
    uint32_t palette_bits;
};

static uint32_t half_at(const uint8_t *p) {
    return (uint32_t)(p[0] | p[1] << 8);
}

static bool is_colour(uint32_t bits) {
    return bits == 15 || bits == 16 || bits == 24 || bits == 32;
}

/* False: no picture has such a header. */
static bool read_header(const uint8_t *data, size_t size, struct reader *r) {
    if (size < HEADER || data[1] > 1)
        return false;
    *r = (struct reader){.data = data,
                         .size = size,
                         .type = data[2] & ~(uint32_t)TYPE_PACKETS,
                         .packets = data[2] & TYPE_PACKETS,
                         .from_top = data[17] & 32,
                         .from_right = data[17] & 16,
                         .width = half_at(data + 12),
                         .height = half_at(data + 14),
                         .bits = data[16],
                         .bit_is_alpha = (data[17] & 15) == 1,
                         .palette = HEADER + (size_t)data[0],
                         .palette_first = half_at(data + 3),
                         .palette_count = data[1] ? half_at(data + 5) : 0,
                         .palette_bits = data[7]};
    r->at = r->palette + r->palette_count * ((r->palette_bits + 7) / 8);
    if (r->width == 0 || r->height == 0 || data[17] & 0xc0)
        return false;
    if (r->type == TYPE_PALETTE)
        return r->palette_count > 0 && is_colour(r->palette_bits) && (r->bits == 8 || r->bits == 16);
    return (r->type == TYPE_COLOUR && is_colour(r->bits)) || (r->type == TYPE_GRAY && (r->bits == 8 || r->bits == 16));
}

static void colour(const struct reader *r, const uint8_t *p, uint32_t bits, uint8_t out[4]) {
    if (bits >= 24) {
        out[0] = p[2], out[1] = p[1], out[2] = p[0], out[3] = bits == 32 ? p[3] : 255;
        return;
    }
    uint32_t pixel = half_at(p);
    for (int k = 0; k < 3; k++)
        out[k] = (uint8_t)(((pixel >> (10 - 5 * k) & 31) * 255 + 15) / 31);
    out[3] = bits == 16 && r->bit_is_alpha && pixel >> 15 == 0 ? 0 : 255;
}

/* Colours that the palette does not have are black. */
static void read_pixel(const struct reader *r, const uint8_t *p, uint8_t out[4]) {
    if (r->type == TYPE_COLOUR) {
        colour(r, p, r->bits, out);
    } else if (r->type == TYPE_GRAY) {
        out[0] = out[1] = out[2] = p[0];
        out[3] = r->bits == 16 ? p[1] : 255;
    } else {
        size_t index = (r->bits == 16 ? half_at(p) : p[0]) - r->palette_first;
        memcpy(out, (const uint8_t[4]){0, 0, 0, 255}, 4);
        if (index < r->palette_count)
            colour(r, r->data + r->palette + index * ((r->palette_bits + 7) / 8), r->palette_bits, out);
    }
}

/* Packets may go on in the next row, as some programs write them. */
static bool read_pixels(struct reader *r, struct image *image) {
    size_t bytes = (r->bits + 7) / 8, left = 0;
    bool run = false;
    for (uint32_t y = 0; y < r->height; y++) {
        for (uint32_t x = 0; x < r->width; x++) {
            if (r->packets && left == 0) {
                if (r->at >= r->size)
                    return false;
                run = r->data[r->at] & 128;
                left = (r->data[r->at++] & 127u) + 1;
            }
            if (r->size - r->at < bytes)
                return false;
            size_t column = r->from_right ? r->width - 1 - x : x, row = r->from_top ? y : r->height - 1 - y;
            read_pixel(r, r->data + r->at, (uint8_t *)image->levels[0].texels + (row * r->width + column) * 4);
            left -= r->packets;
            r->at += run && left > 0 ? 0 : bytes;
        }
    }
    return true;
}

bool tga_is(const char *path, const uint8_t *data, size_t size) {
    struct reader r;
    size_t length = strlen(path);
    if (size >= HEADER + FOOTER && memcmp(data + size - 18, "TRUEVISION-XFILE.", 18) == 0)
        return true;
    return length > 4 && strcasecmp(path + length - 4, ".tga") == 0 && read_header(data, size, &r);
}

struct image *image_parse_tga(const char *path, const uint8_t *data, size_t size, struct error *error) {
    struct reader r;
    if (!read_header(data, size, &r)) {
        error_set(error, ERROR_SCENE, "%s: broken TGA: its header is not that of a picture", path);
        return NULL;
    }
    bool too_large = r.width > IMAGE_MAX_SIDE || r.height > IMAGE_MAX_SIDE; /* said by image_allocate */
    uint64_t pixels = (uint64_t)r.width * r.height, bytes = (r.bits + 7) / 8;
    uint64_t min_size = r.packets ? (pixels + PACKET - 1) / PACKET * (1 + bytes) : pixels * bytes;
    struct image *image = NULL;
    bool whole = r.at <= size && min_size <= size - r.at;
    if (whole || too_large)
        image = image_allocate(path, r.width, r.height, 8, error);
    if (!image && (whole || too_large))
        return NULL;
    if (!whole || !read_pixels(&r, image)) {
        image_release(image);
        error_set(error, ERROR_SCENE, "%s: truncated TGA: the file ends at byte %zu, before the picture is complete",
                  path, size);
        return NULL;
    }
    image_fill_empty_alpha(image);
    return image_finish(image, true, error);
}
