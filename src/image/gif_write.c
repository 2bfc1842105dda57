/* Writes GIF (Graphics Interchange Format version 89a, CompuServe 1990; LZW: Welch, A Technique for High-Performance
 * Data Compression, 1984). A frame after the first one is the rectangle of pixels whose colours differ from the
 * previous frame. */
#include "image/animation.h"

#include "base/mem.h"
#include "image/palette_internal.h"

#include <math.h>
#include <string.h>

enum {
    SIDE_LIMIT = 65535,
    DEPTH = 8, /* bits of a pixel */
    CLEAR = 1 << DEPTH,
    END = CLEAR + 1,
    CODES = 4096,
    SLOTS = 8192, /* of the table of strings */
    BLOCK = 255,
};

/* A string of the table: the string before its last byte, and the byte. */
struct lzw_slot {
    uint32_t key; /* prefix << 8 | byte, and 1 << 31; 0: free */
    uint32_t code;
};

struct gif {
    const struct animation_source *source;
    struct file_output output;
    struct palette_count *count;
    struct palette_search *search;
    struct palette palette;
    uint8_t *rgb, *pixels; /* a frame, and its colour numbers */
    uint8_t (*shown)[3];   /* the colours on the screen */
    struct lzw_slot slots[SLOTS];
    uint8_t block[BLOCK + 1]; /* its length comes first */
    uint32_t bits, bit_count;
};

struct rectangle {
    uint32_t x, y, width, height;
};

static void put_short(uint8_t *out, uint32_t value) {
    out[0] = (uint8_t)value;
    out[1] = (uint8_t)(value >> 8);
}

static bool put_byte(struct gif *gif, uint8_t byte, struct error *error) {
    gif->block[++gif->block[0]] = byte;
    if (gif->block[0] < BLOCK)
        return true;
    bool ok = file_output_write(&gif->output, gif->block, BLOCK + 1, error);
    gif->block[0] = 0;
    return ok;
}

static bool put_code(struct gif *gif, uint32_t code, uint32_t size, struct error *error) {
    gif->bits |= code << gif->bit_count;
    gif->bit_count += size;
    while (gif->bit_count >= 8) {
        if (!put_byte(gif, (uint8_t)gif->bits, error))
            return false;
        gif->bits >>= 8;
        gif->bit_count -= 8;
    }
    return true;
}

static struct lzw_slot *find_string(struct gif *gif, uint32_t prefix, uint8_t byte) {
    uint32_t key = prefix << 8 | byte | 1u << 31, at = (key * 2654435769u) >> 19;
    while (gif->slots[at].key != 0 && gif->slots[at].key != key)
        at = (at + 1) % SLOTS;
    struct lzw_slot *slot = &gif->slots[at];
    if (slot->key == 0) {
        slot->key = key;
        slot->code = 0;
    }
    return slot;
}

/* Writes the pixels of the rectangle as blocks. */
static bool write_pixels(struct gif *gif, const struct rectangle *r, struct error *error) {
    static const uint8_t depth = DEPTH, end = 0;
    uint32_t next = END + 1, size = DEPTH + 1, prefix = UINT32_MAX;
    gif->bits = gif->bit_count = 0;
    gif->block[0] = 0;
    memset(gif->slots, 0, sizeof gif->slots);
    bool ok = file_output_write(&gif->output, &depth, 1, error) && put_code(gif, CLEAR, size, error);
    for (uint32_t y = r->y; ok && y < r->y + r->height; y++) {
        const uint8_t *row = gif->pixels + (size_t)y * gif->source->width;
        for (uint32_t x = r->x; ok && x < r->x + r->width; x++) {
            if (prefix == UINT32_MAX) {
                prefix = row[x];
                continue;
            }
            struct lzw_slot *slot = find_string(gif, prefix, row[x]);
            if (slot->code != 0) {
                prefix = slot->code;
                continue;
            }
            ok = put_code(gif, prefix, size, error);
            prefix = row[x];
            if (next < CODES) {
                size += next == 1u << size; /* the decoder is one string behind */
                slot->code = next++;
            } else {
                ok = ok && put_code(gif, CLEAR, size, error);
                memset(gif->slots, 0, sizeof gif->slots);
                next = END + 1;
                size = DEPTH + 1;
            }
        }
    }
    ok = ok && put_code(gif, prefix, size, error);
    size += next < CODES && next == 1u << size;
    ok = ok && put_code(gif, END, size, error) && (gif->bit_count == 0 || put_byte(gif, (uint8_t)gif->bits, error));
    ok = ok && (gif->block[0] == 0 || file_output_write(&gif->output, gif->block, 1u + gif->block[0], error));
    return ok && file_output_write(&gif->output, &end, 1, error);
}

static bool write_head(struct gif *gif, bool palette_for_each, struct error *error) {
    const struct animation_source *source = gif->source;
    uint8_t head[13] = "GIF89a", loop[19] = "\x21\xff\x0bNETSCAPE2.0\x03\x01";
    put_short(head + 6, source->width);
    put_short(head + 8, source->height);
    head[10] = (uint8_t)((palette_for_each ? 0 : 0x80) | (DEPTH - 1) << 4 | (DEPTH - 1));
    return file_output_write(&gif->output, head, sizeof head, error) &&
           (palette_for_each ||
            file_output_write(&gif->output, gif->palette.colours, sizeof gif->palette.colours, error)) &&
           (!source->loops || file_output_write(&gif->output, loop, sizeof loop, error));
}

uint32_t gif_delay(double rate, uint32_t index) {
    double before = floor(index * 100.0 / rate + 1e-9), after = floor((index + 1.0) * 100 / rate + 1e-9);
    return (uint32_t)(after - before);
}

/* Maps the frame to colours of the palette; the rectangle of the pixels that change. */
static struct rectangle map_frame(struct gif *gif, uint32_t index) {
    uint32_t width = gif->source->width, height = gif->source->height;
    uint32_t left = width, right = 0, top = height, bottom = 0;
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            size_t at = (size_t)y * width + x;
            gif->pixels[at] = palette_find(gif->search, gif->rgb + 3 * at, x, y);
            const uint8_t *colour = gif->palette.colours[gif->pixels[at]];
            if (index > 0 && memcmp(gif->shown[at], colour, 3) == 0)
                continue;
            memcpy(gif->shown[at], colour, 3);
            left = x < left ? x : left;
            right = x + 1 > right ? x + 1 : right;
            top = y < top ? y : top;
            bottom = y + 1;
        }
    }
    if (bottom == 0)
        return (struct rectangle){0, 0, 1, 1};
    return (struct rectangle){left, top, right - left, bottom - top};
}

static bool write_frame(struct gif *gif, uint32_t index, bool own_palette, struct error *error) {
    const struct animation_source *source = gif->source;
    uint32_t delay = gif_delay(source->rate, index);
    uint8_t control[8] = {0x21, 0xf9, 4, 1 << 2 /* leave the frame in place */};
    uint8_t head[10] = {0x2c};
    if (!source->frame(source->context, index, gif->rgb, error))
        return false;
    if (own_palette) {
        palette_count_clear(gif->count);
        palette_count_add(gif->count, gif->rgb, (size_t)source->width * source->height);
        if (!palette_make(gif->count, &gif->palette))
            return error_no_memory(error, "a palette");
        palette_search_begin(gif->search, &gif->palette);
    }
    struct rectangle r = map_frame(gif, index);
    put_short(control + 4, delay > UINT16_MAX ? UINT16_MAX : delay);
    put_short(head + 1, r.x);
    put_short(head + 3, r.y);
    put_short(head + 5, r.width);
    put_short(head + 7, r.height);
    head[9] = own_palette ? 0x80 | (DEPTH - 1) : 0;
    return file_output_write(&gif->output, control, sizeof control, error) &&
           file_output_write(&gif->output, head, sizeof head, error) &&
           (!own_palette ||
            file_output_write(&gif->output, gif->palette.colours, sizeof gif->palette.colours, error)) &&
           write_pixels(gif, &r, error);
}

static bool count_all(struct gif *gif, struct error *error) {
    const struct animation_source *source = gif->source;
    for (uint32_t index = 0; index < source->count; index++) {
        if (!source->frame(source->context, index, gif->rgb, error))
            return false;
        palette_count_add(gif->count, gif->rgb, (size_t)source->width * source->height);
    }
    if (!palette_make(gif->count, &gif->palette))
        return error_no_memory(error, "a palette");
    palette_search_begin(gif->search, &gif->palette);
    return true;
}

static bool write_all(struct gif *gif, bool palette_for_each, struct error *error) {
    static const uint8_t trailer = 0x3b;
    if (!(palette_for_each || count_all(gif, error)) || !write_head(gif, palette_for_each, error))
        return false;
    for (uint32_t index = 0; index < gif->source->count; index++) {
        if (!write_frame(gif, index, palette_for_each, error))
            return false;
    }
    return file_output_write(&gif->output, &trailer, 1, error);
}

bool gif_write(const struct file_target *target, const struct animation_source *source, bool palette_for_each,
               struct error *error) {
    size_t pixels = (size_t)source->width * source->height;
    if (source->width > SIDE_LIMIT || source->height > SIDE_LIMIT)
        return error_set(error, ERROR_SCENE, "%.600s: a GIF file has at most %d pixels on a side", target->path,
                         SIDE_LIMIT);
    struct gif *gif = mem_alloc_zero(1, sizeof *gif);
    if (!gif)
        return error_no_memory(error, target->path);
    /* All memory before the file is opened. */
    gif->source = source;
    gif->count = palette_count_create();
    gif->search = palette_search_create();
    gif->rgb = mem_alloc(3 * pixels);
    gif->pixels = mem_alloc(pixels);
    gif->shown = mem_alloc_zero(pixels, sizeof *gif->shown);
    bool ok =
        (gif->count && gif->search && gif->rgb && gif->pixels && gif->shown) || error_no_memory(error, target->path);
    ok = ok && file_output_open(&gif->output, target, error);
    if (ok) {
        ok = write_all(gif, palette_for_each, error);
        if (ok)
            ok = file_output_commit(&gif->output, error);
        else
            file_output_abandon(&gif->output);
    }
    palette_count_destroy(gif->count);
    palette_search_destroy(gif->search);
    mem_free(gif->rgb);
    mem_free(gif->pixels);
    mem_free(gif->shown);
    mem_free(gif);
    return ok;
}
