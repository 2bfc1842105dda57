/* The solids of a world. */
#ifndef GRAY_WORLD_FLATTEN_CSG_INTERNAL_H
#define GRAY_WORLD_FLATTEN_CSG_INTERNAL_H

#include "world/flatten_internal.h"

/* The CSG primitives of a NODE_CSG, or of geometry that is clipped, in its own space: none if it is empty, several if
 * it is a union of disjoint solids. around: may be NULL. */
bool flatten_csg(struct flattening *f, const struct node *node, const struct pose *pose,
                 const struct graphics_state *state, const struct csg ***parts, uint32_t *count);
/* Shrinks a box by a bounding solid. */
bool flatten_limit(struct flattening *f, const struct node *solid, const struct transform *world_from_parent,
                   struct box *limit);

#endif
