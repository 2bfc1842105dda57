/* Film storage and its way to bytes. */
#include "film/film.h"

#include "base/checked.h"
#include "base/mem.h"
#include "base/random.h"
#include "base/sort.h"
#include "image/png_write.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* For any position of the part on the grid of tiles. */
static size_t max_tiles(uint32_t width, uint32_t height) {
    return ((size_t)width / FILM_TILE + 2) * ((size_t)height / FILM_TILE + 2);
}

bool film_size(uint32_t width, uint32_t height, struct film_record record, size_t *bytes, struct error *error) {
    size_t pixels, size;
    if (width == 0 || height == 0 || !checked_mul(width, height, &pixels) || pixels > (size_t)1 << 31)
        return error_set(error, ERROR_SCENE, "a picture of %u x %u pixels is more than gray can hold (2^31 pixels)",
                         width, height);
    if (!checked_mul(pixels, film_record_size(record), &size) || !checked_add(size, max_tiles(width, height), &size))
        return error_no_memory(error, "the picture");
    *bytes = size;
    return true;
}

void film_layout(struct film *film, void *block, uint32_t width, uint32_t height, struct film_record record) {
    size_t pixels = (size_t)width * height;
    film->width = width;
    film->height = height;
    film->record = record;
    film->pixels = block;
    film->floats = (float *)(void *)(film->pixels + pixels);
    uint8_t *behind = (uint8_t *)(film->floats + record.floats * pixels);
    film->marked = record.marks ? behind : NULL;
    film->tiles = (_Atomic uint8_t *)(behind + record.marks * pixels);
}

bool film_size_layered(uint32_t width, uint32_t height, struct film_record record, uint32_t layers, size_t *bytes,
                       struct error *error) {
    size_t size = 0, more = 0;
    if (!film_size(width, height, record, &size, error))
        return false;
    if (!checked_mul((size_t)width * height, layers * sizeof(float[3]), &more) ||
        !checked_add(size, more + sizeof(float), bytes))
        return error_no_memory(error, "the picture");
    return true;
}

void film_layout_layers(struct film *film, void *block, uint32_t mask) {
    size_t size = 0;
    struct error ignored;
    (void)film_size(film->width, film->height, film->record, &size, &ignored);
    size = (size + sizeof(float) - 1) / sizeof(float) * sizeof(float);
    film->layer_mask = mask;
    film->layers = mask ? (float(*)[3])(void *)((char *)block + size) : NULL;
}

uint32_t film_tiles_across(const struct film *film) {
    return (film->x0 + film->width - 1) / FILM_TILE - film->x0 / FILM_TILE + 1;
}

uint32_t film_tile_count(const struct film *film) {
    return film_tiles_across(film) * ((film->y0 + film->height - 1) / FILM_TILE - film->y0 / FILM_TILE + 1);
}

struct film_rectangle film_rectangle_grown(const struct film_rectangle *r, uint32_t rim, uint32_t width,
                                           uint32_t height) {
    return (struct film_rectangle){r->x0 > rim ? r->x0 - rim : 0, r->y0 > rim ? r->y0 - rim : 0,
                                   rim < width - r->x1 ? r->x1 + rim : width,
                                   rim < height - r->y1 ? r->y1 + rim : height};
}

struct film_rectangle film_tile_rectangle(const struct film *film, uint32_t tile) {
    uint32_t across = film_tiles_across(film);
    uint32_t x = (film->x0 / FILM_TILE + tile % across) * FILM_TILE,
             y = (film->y0 / FILM_TILE + tile / across) * FILM_TILE;
    uint32_t right = film->x0 + film->width, bottom = film->y0 + film->height;
    return (struct film_rectangle){x < film->x0 ? film->x0 : x, y < film->y0 ? film->y0 : y,
                                   x + FILM_TILE > right ? right : x + FILM_TILE,
                                   y + FILM_TILE > bottom ? bottom : y + FILM_TILE};
}

uint32_t film_tiles_in(const struct film *film, enum film_tile state) {
    uint32_t count = 0;
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++)
        count += atomic_load_explicit(&film->tiles[tile], memory_order_acquire) == (uint8_t)state;
    return count;
}

uint32_t film_tiles_begun(const struct film *film) {
    uint32_t count = 0;
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++)
        count += film_tile_is_begun(atomic_load_explicit(&film->tiles[tile], memory_order_acquire));
    return count;
}

static size_t pixel_at(const struct film *film, uint32_t x, uint32_t y) {
    return (size_t)(y - film->y0) * film->width + (x - film->x0);
}

void film_clear_unfinished(struct film *film) {
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++) {
        if (film_tile_shows(atomic_load_explicit(&film->tiles[tile], memory_order_acquire)))
            continue;
        struct film_rectangle r = film_tile_rectangle(film, tile);
        for (uint32_t y = r.y0; y < r.y1; y++) {
            size_t at = pixel_at(film, r.x0, y), width = r.x1 - r.x0;
            memset(&film->pixels[at], 0, width * sizeof *film->pixels);
            memset(&film->floats[at * film->record.floats], 0, width * film->record.floats * sizeof *film->floats);
        }
    }
}

bool film_holds_largest(const struct film *film) {
    for (size_t i = 0; i < (size_t)film->width * film->height; i++)
        for (int c = 0; c < 3; c++)
            if (fabsf(film->pixels[i].rgb[c]) == FLT_MAX)
                return true;
    return false;
}

static uint8_t *put_floats(uint8_t *out, const float *values, uint32_t count) {
    memcpy(out, values, count * sizeof *values);
    return out + count * sizeof *values;
}

static const uint8_t *get_floats(const uint8_t *bytes, float *values, uint32_t count) {
    memcpy(values, bytes, count * sizeof *values);
    return bytes + count * sizeof *values;
}

static size_t mask_size(const struct film *film, struct film_rectangle r) {
    return film->record.marks ? ((size_t)(r.x1 - r.x0) * (r.y1 - r.y0) + 7) / 8 : 0;
}

/* The number of floats that pixels without a mark repeat. */
static uint32_t repeated_floats(struct film_record record) {
    uint32_t colour = record.floats < 3 ? record.floats : 3;
    return record.marks ? colour : 0;
}

size_t film_tile_pack(const struct film *film, uint32_t tile, uint8_t *out) {
    struct film_rectangle r = film_tile_rectangle(film, tile);
    uint32_t bit = 0, floats = film->record.floats;
    uint8_t *mask = out, *end = out + mask_size(film, r);
    memset(mask, 0, mask_size(film, r));
    for (uint32_t y = r.y0; y < r.y1; y++) {
        for (uint32_t x = r.x0; x < r.x1; x++, bit++) {
            size_t at = pixel_at(film, x, y);
            bool marked = film->marked && film->marked[at] != 0;
            if (marked)
                mask[bit / 8] |= (uint8_t)(1 << (bit % 8));
            end = put_floats(end, film->pixels[at].rgb, 3);
            uint32_t from = marked ? 0 : repeated_floats(film->record);
            end = put_floats(end, &film->floats[at * floats + from], floats - from);
        }
    }
    return (size_t)(end - out);
}

bool film_tile_fits(const struct film *film, uint32_t tile, const uint8_t *bytes, size_t size) {
    struct film_rectangle r = film_tile_rectangle(film, tile);
    uint32_t pixels = (r.x1 - r.x0) * (r.y1 - r.y0);
    size_t head = mask_size(film, r), unmarked = pixels;
    if (size < head)
        return false;
    for (uint32_t i = 0; i < pixels && film->record.marks; i++)
        unmarked -= bytes[i / 8] >> (i % 8) & 1;
    size_t floats = (3 + (size_t)film->record.floats) * pixels - repeated_floats(film->record) * unmarked;
    if (size != head + floats * sizeof(float))
        return false;
    for (const uint8_t *at = bytes + head; at < bytes + size;) {
        float value;
        at = get_floats(at, &value, 1);
        if (!isfinite(value))
            return false;
    }
    return true;
}

bool film_tile_unpack(struct film *film, uint32_t tile, const uint8_t *bytes, size_t size) {
    struct film_rectangle r = film_tile_rectangle(film, tile);
    uint32_t bit = 0, floats = film->record.floats;
    if (!film_tile_fits(film, tile, bytes, size))
        return false;
    const uint8_t *next = bytes + mask_size(film, r);
    for (uint32_t y = r.y0; y < r.y1; y++) {
        for (uint32_t x = r.x0; x < r.x1; x++, bit++) {
            size_t at = pixel_at(film, x, y);
            const float *rgb = film->pixels[at].rgb;
            if (film->record.marks)
                film->marked[at] = bytes[bit / 8] >> (bit % 8) & 1;
            next = get_floats(next, film->pixels[at].rgb, 3);
            for (uint32_t i = 0; i < floats; i++)
                film->floats[at * floats + i] = rgb[i % 3];
            uint32_t from = film->marked && film->marked[at] ? 0 : repeated_floats(film->record);
            next = get_floats(next, &film->floats[at * floats + from], floats - from);
        }
    }
    atomic_store_explicit(&film->tiles[tile], FILM_TILE_DONE, memory_order_release);
    return true;
}

/* The floats begin with the first pass where pixels are marked. */
static const float *colour_at(const struct film *film, enum film_view view, size_t at) {
    bool first = view != FILM_FINAL && film->record.marks && film->record.floats >= 3;
    return first ? &film->floats[at * film->record.floats] : film->pixels[at].rgb;
}

static bool is_red(const struct film *film, enum film_view view, size_t at) {
    return view == FILM_TARGETS && film->marked && film->marked[at];
}

void film_row_toned(const struct film *film, enum film_view view, const struct tone *tone, uint32_t y, uint8_t *line) {
    for (uint32_t x = 0; x < film->width; x++) {
        size_t at = (size_t)y * film->width + x;
        const float *rgb = colour_at(film, view, at);
        for (int c = 0; c < 3; c++)
            line[3 * x + (uint32_t)c] = png_write_byte(tone_apply(tone, (double)rgb[c]));
        if (is_red(film, view, at)) {
            line[3 * x] = 255;
            line[3 * x + 1] = line[3 * x + 2] = 0;
        }
    }
}

void film_row_16(const struct film *film, enum film_view view, const struct tone *tone, uint32_t y, uint16_t *line) {
    for (uint32_t x = 0; x < film->width; x++) {
        size_t at = (size_t)y * film->width + x;
        const float *rgb = colour_at(film, view, at);
        bool red = is_red(film, view, at);
        for (int c = 0; c < 3; c++)
            line[3 * x + (uint32_t)c] = tone_word(red ? c == 0 : tone_apply(tone, (double)rgb[c]));
    }
}

void film_row_linear(const struct film *film, enum film_view view, uint32_t y, float *line) {
    for (uint32_t x = 0; x < film->width; x++) {
        size_t at = (size_t)y * film->width + x;
        const float *rgb = colour_at(film, view, at);
        bool red = is_red(film, view, at);
        for (int c = 0; c < 3; c++)
            line[3 * x + (uint32_t)c] = red ? (float)(c == 0) : rgb[c];
    }
}

void film_shrink(const struct film *film, const struct tone *tone, uint32_t width, uint32_t height, uint8_t *rgb) {
    for (uint32_t y = 0; y < height; y++) {
        uint32_t y0 = (uint32_t)((uint64_t)y * film->height / height);
        uint32_t y1 = (uint32_t)((uint64_t)(y + 1) * film->height / height);
        for (uint32_t x = 0; x < width; x++) {
            uint32_t x0 = (uint32_t)((uint64_t)x * film->width / width);
            uint32_t x1 = (uint32_t)((uint64_t)(x + 1) * film->width / width);
            double sum[3] = {0}, count = (double)(x1 - x0) * (y1 - y0);
            for (uint32_t j = y0; j < y1; j++)
                for (uint32_t i = x0; i < x1; i++)
                    for (int c = 0; c < 3; c++)
                        sum[c] += (double)film->pixels[(size_t)j * film->width + i].rgb[c];
            for (int c = 0; c < 3; c++)
                rgb[((size_t)y * width + x) * 3 + (size_t)c] = png_write_byte(tone_apply(tone, sum[c] / count));
        }
    }
}

/* Distributes tiles in alternating forward and backward rounds ("snake draft"): the shard with the most expensive tile
 * of one round gets the cheapest of the next. Equal costs are ordered by the tiles' scrambled number, so that
 * neighbours, which have similar costs, go to different shards. */

struct tile_cost {
    uint64_t cost, scrambled;
    uint32_t tile;
};

static int dearest_first(const void *a, const void *b) {
    const struct tile_cost *x = a, *y = b;
    if (x->cost != y->cost)
        return x->cost < y->cost ? 1 : -1;
    return x->scrambled < y->scrambled ? -1 : x->scrambled > y->scrambled;
}

bool shard_choose(const uint64_t *cost, struct film *film, uint32_t shard, uint32_t shards) {
    uint32_t count = film_tile_count(film);
    struct tile_cost *order = mem_alloc_zero(count, sizeof *order);
    if (!order)
        return false;
    for (uint32_t tile = 0; tile < count; tile++)
        order[tile] = (struct tile_cost){cost[tile], random_mix(tile), tile};
    qsort(order, count, sizeof *order, dearest_first);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t turn = i / shards, position = i % shards;
        uint32_t owner = turn % 2 ? shards - 1 - position : position;
        if (owner != shard - 1 && atomic_load(&film->tiles[order[i].tile]) == FILM_TILE_WANTED)
            atomic_store(&film->tiles[order[i].tile], FILM_TILE_ELSEWHERE);
    }
    mem_free(order);
    return true;
}

/* TILE_ORDER_SPREAD: the sort key of tile i is i times the golden ratio, modulo 1. At any time the finished tiles are
 * evenly distributed over the rows of the picture and within them (Weyl's sequence; no irrational number is further
 * from all fractions), so that their cost represents that of the others. TILE_ORDER_CENTRE: by the distance of their
 * middles from that of the rendered part, in units of its half sides. */

static uint32_t spread_key(uint32_t tile) {
    return tile * UINT32_C(2654435769); /* 2^32 over the golden ratio */
}

static uint32_t centre_key(const struct film *film, uint32_t tile) {
    struct film_rectangle r = film_tile_rectangle(film, tile);
    double dx = ((double)r.x0 + (double)r.x1 - 2.0 * film->x0 - film->width) / film->width;
    double dy = ((double)r.y0 + (double)r.y1 - 2.0 * film->y0 - film->height) / film->height;
    return (uint32_t)((dx * dx + dy * dy) * 0x1p30);
}

bool film_tile_order(const struct film *film, enum tile_order order, uint32_t *out) {
    uint32_t count = film_tile_count(film);
    uint64_t *keys = mem_alloc_zero((size_t)count + 1, sizeof *keys);
    if (!keys)
        return false;
    for (uint32_t i = 0; i < count; i++) {
        uint64_t key = 0;
        switch (order) {
        case TILE_ORDER_ROWS:
            break;
        case TILE_ORDER_SPREAD:
            key = spread_key(i);
            break;
        case TILE_ORDER_CENTRE:
            key = centre_key(film, i);
            break;
        }
        keys[i] = key << 32 | i;
    }
    /* The number of the tile in the low half decides between equal keys, so the order is the same everywhere. */
    sort_words(keys, count);
    for (uint32_t i = 0; i < count; i++)
        out[i] = (uint32_t)keys[i];
    mem_free(keys);
    return true;
}
