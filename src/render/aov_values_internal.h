/* The values of the render layers (film/aov.h) at a hit. */
#ifndef GRAY_RENDER_AOV_VALUES_INTERNAL_H
#define GRAY_RENDER_AOV_VALUES_INTERNAL_H

#include "film/aov.h"
#include "world/world.h"

/* The layers of `mask` that describe the hit of the ray; out[AOV_COUNT]. All zero without a hit. */
void aov_surface(const struct world *world, const struct ray *ray, uint32_t mask, struct world_scratch *scratch,
                 float out[AOV_COUNT][3]);

#endif
