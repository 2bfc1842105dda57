/* Shared by the files of the world; private to this module. */
#ifndef GRAY_WORLD_WORLD_INTERNAL_H
#define GRAY_WORLD_WORLD_INTERNAL_H

#include "world/world.h"

struct flattening;
/* The tables of the frame before with the changes of the scene, in f->world. *reused: false if there are none that fit;
 * then f->arena and f->log are those of new tables, if they may be kept. */
bool kept_tables_reuse(struct flattening *f, const struct world_input *input, bool *reused);

/* The nearest crossing with one primitive, in its own space; scratch grows until it fits. */
bool world_ask_nearest(const struct world *world, uint32_t index, const struct ray *ray_object,
                       struct world_scratch *scratch, struct crossing *out);
/* Whether one primitive occludes. */
bool world_ask_any(const struct world *world, uint32_t index, const struct ray *ray, struct world_scratch *scratch);

/* What is the same for every hit of a triangle of a primitive whose space is the world's. */
struct group_facet world_facet(const struct world *world, uint32_t primitive, uint32_t triangle);

/* Computes the boxes of all primitives in the world, cut by `limits` if there are any (NULL: none). Also counts
 * triangles, scratch memory and convex hulls. Errors: cancelled. */
bool world_primitive_boxes(struct world *world, const struct box *limits, struct pool *pool, struct error *error);
/* The same for a primitive with another pose, in a world without limits. False: its box depends on those of other
 * primitives. */
bool world_update_box(struct world *world, uint32_t primitive);

#endif
