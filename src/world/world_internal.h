/* Shared by the files of the world; private to this module. */
#ifndef GRAY_WORLD_WORLD_INTERNAL_H
#define GRAY_WORLD_WORLD_INTERNAL_H

#include "world/world.h"

/* The nearest crossing with one primitive, in its own space; scratch grows until it fits. */
bool world_ask_nearest(const struct world *world, uint32_t index, const struct ray *ray_object,
                       struct world_scratch *scratch, struct crossing *out);
/* Whether one primitive occludes. */
bool world_ask_any(const struct world *world, uint32_t index, const struct ray *ray, struct world_scratch *scratch);

/* Computes the boxes of all primitives in the world, cut by `limits` if there are any (NULL: none). Also counts
 * triangles, scratch memory and convex hulls. Errors: cancelled. */
bool world_primitive_boxes(struct world *world, const struct box *limits, struct pool *pool, struct error *error);
/* The same for a primitive with another pose, in a world without limits. False: its box depends on those of other
 * primitives. */
bool world_update_box(struct world *world, uint32_t primitive);

#endif
