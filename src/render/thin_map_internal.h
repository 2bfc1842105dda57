/* A map of the pixels in which first samples may miss primitives: those narrower than a pixel, of any length, and small
 * ones. */
#ifndef GRAY_RENDER_THIN_MAP_INTERNAL_H
#define GRAY_RENDER_THIN_MAP_INTERNAL_H

#include "render/render_internal.h"

#include <stdatomic.h>
#include <string.h>

/* LINE: a regular pattern of samples hits lines at some angles too often or too rarely. SMALL: a primitive that a
 * regular grid of samples does not miss. */
#define THIN_LINE UINT32_C(1)
#define THIN_SMALL UINT32_C(2)
#define THIN_FLAGS UINT32_C(3)

/* Owns `nearness`. A pixel's value depends on nothing but the world, the camera and the filter: a crop has those of the
 * whole picture. */
struct thin_map {
    uint32_t x0, y0, width, height; /* those of the film; of the picture, if the film roams */
    /* For each pixel: 0: no such primitive; otherwise the bits of a float of at least 1 / t, with flags in THIN_FLAGS,
     * where t is that of the nearest one on camera rays through the pixel. NULL: the picture contains none. */
    _Atomic uint32_t *nearness;
};

/* `margin`: the maximum distance of samples of a pixel from its border, in pixels. The map does not support primitives
 * and cameras that move, and lenses (struct whitted.full). Errors: no memory, cancelled; then nothing needs to be
 * destroyed. */
bool thin_map_build(struct thin_map *map, const struct renderer *renderer, double margin, struct error *error);
void thin_map_destroy(struct thin_map *map);

static inline uint32_t thin_map_bits(const struct thin_map *map, int64_t x, int64_t y) {
    size_t at = (size_t)(y - map->y0) * map->width + (size_t)(x - map->x0);
    return map->nearness ? atomic_load_explicit(&map->nearness[at], memory_order_relaxed) : 0;
}
/* 0, or an upper bound of 1 / t of the thin primitives there. */
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
