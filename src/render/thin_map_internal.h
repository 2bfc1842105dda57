/* Where primitives are in the picture that the first samples of pixels may miss: those narrower than a pixel, however
 * long, and small ones. */
#ifndef GRAY_RENDER_THIN_MAP_INTERNAL_H
#define GRAY_RENDER_THIN_MAP_INTERNAL_H

#include "render/render_internal.h"

#include <stdatomic.h>
#include <string.h>

/* LINE: regular patterns of samples meet lines at some angles too often or too seldom. SMALL: a primitive that is not
 * lost between the samples of a regular grid. */
#define THIN_LINE UINT32_C(1)
#define THIN_SMALL UINT32_C(2)
#define THIN_FLAGS UINT32_C(3)

/* Owns `nearness`. A pixel's value depends on nothing but the world, the camera and the filter: a crop has those of the
 * whole picture. */
struct thin_map {
    uint32_t x0, y0, width, height; /* those of the film; of the picture, if the film roams */
    /* By pixel of it: 0: no such primitive; else the bits of a float of at least 1 / t, t that of the nearest one
     * on camera rays through the pixel, with flags in THIN_FLAGS. NULL: there is none in the picture. */
    _Atomic uint32_t *nearness;
};

/* `margin`: how far samples of a pixel can be outside of it, pixels. Primitives that move, cameras that do, and a lens
 * are not for it (struct whitted.full). Errors: no memory, cancelled; nothing is left to destroy then. */
bool thin_map_build(struct thin_map *map, const struct renderer *renderer, double margin, struct error *error);
void thin_map_destroy(struct thin_map *map);

static inline uint32_t thin_map_bits(const struct thin_map *map, int64_t x, int64_t y) {
    size_t at = (size_t)(y - map->y0) * map->width + (size_t)(x - map->x0);
    return map->nearness ? atomic_load_explicit(&map->nearness[at], memory_order_relaxed) : 0;
}
/* 0, or an upper bound of 1 / t of what is thin there. */
static inline float thin_map_at(const struct thin_map *map, int64_t x, int64_t y) {
    uint32_t bits = thin_map_bits(map, x, y);
    float nearness;
    memcpy(&nearness, &bits, sizeof nearness);
    return nearness;
}
static inline uint32_t thin_map_flags(const struct thin_map *map, int64_t x, int64_t y) {
    return thin_map_bits(map, x, y) & THIN_FLAGS;
}

#endif
