/* The values of the render layers (film/aov.h) at a hit. */
#ifndef GRAY_RENDER_AOV_VALUES_INTERNAL_H
#define GRAY_RENDER_AOV_VALUES_INTERNAL_H

#include "film/aov.h"
#include "render/render_internal.h"
#include "world/world.h"

/* The layers of `mask` that describe the hit of the ray; out[AOV_COUNT]. All zero without a hit. */
void aov_surface(const struct world *world, const struct ray *ray, uint32_t mask, struct world_scratch *scratch,
                 float out[AOV_COUNT][3]);

/* The layers of a pixel whose tile is done. */
void renderer_layer_pixel(struct renderer *renderer, struct worker *worker, int64_t x, int64_t y);
/* A pool_function: the layers of a tile that is done. */
void renderer_layer_item(void *context, uint32_t tile, int worker);

#endif
