/* What the files of the world's searches share; nobody else includes this. */
#ifndef GRAY_WORLD_WORLD_PARTS_H
#define GRAY_WORLD_WORLD_PARTS_H

#include "world/world.h"

/* The nearest crossing with one placed primitive, in its own space; scratch grows until it fits. */
bool world_ask_nearest(const struct world *world, uint32_t index, const struct ray *ray_object,
                       struct world_scratch *scratch, struct crossing *out);
/* Whether one placed primitive stands in the way. */
bool world_ask_any(const struct world *world, uint32_t index, const struct ray *ray, struct world_scratch *scratch);

#endif
