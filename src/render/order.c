/* ORDER_SPREAD: tile i comes at the place of i times the golden ratio, modulo 1. However many are done, they lie evenly
 * over the rows of the picture and within them (Weyl's sequence; no irrational number is further from all fractions),
 * so that their cost represents that of the others. ORDER_CENTRE: by the distance of their middles from that of
 * the rendered part, in units of its half sides. */
#include "render/order.h"

#include "base/mem.h"
#include "base/sort.h"

static uint32_t spread_key(uint32_t tile) {
    return tile * UINT32_C(2654435769); /* 2^32 over the golden ratio */
}

static uint32_t centre_key(const struct film *film, uint32_t tile) {
    struct film_rectangle r = film_tile_rectangle(film, tile);
    double dx = ((double)r.x0 + (double)r.x1 - 2.0 * film->x0 - film->width) / film->width;
    double dy = ((double)r.y0 + (double)r.y1 - 2.0 * film->y0 - film->height) / film->height;
    return (uint32_t)((dx * dx + dy * dy) * 0x1p30);
}

bool tile_order(const struct film *film, enum order order, uint32_t *out) {
    uint32_t count = film_tile_count(film);
    uint64_t *keys = mem_alloc_zero((size_t)count + 1, sizeof *keys);
    if (!keys)
        return false;
    for (uint32_t i = 0; i < count; i++) {
        uint64_t key = 0;
        switch (order) {
        case ORDER_ROWS:
            break;
        case ORDER_SPREAD:
            key = spread_key(i);
            break;
        case ORDER_CENTRE:
            key = centre_key(film, i);
            break;
        }
        keys[i] = key << 32 | i;
    }
    sort_words(keys, count);
    for (uint32_t i = 0; i < count; i++)
        out[i] = (uint32_t)keys[i];
    mem_free(keys);
    return true;
}
