/* A binary tree over the boxes of a shape's parts, so that a line tests only the parts near it. In depth-first order: a
 * first child follows its parent, `skip` is the next node if a box is missed. Owner: the arena it was built in. */
#ifndef GRAY_SHAPE_PART_TREE_INTERNAL_H
#define GRAY_SHAPE_PART_TREE_INTERNAL_H

#include "base/arena.h"
#include "base/bundle.h"
#include "geometry/crossing.h"
#include "math/box.h"

#include <stdint.h>

struct part_node {
    struct box box; /* padded for rounding: by 2^-40 of the largest coordinate in the tree */
    uint32_t skip;
    uint32_t first, count; /* into `order`; count 0: has children instead */
};

struct part_tree {
    const struct part_node *nodes;
    uint32_t node_count;
    const uint32_t *order; /* part numbers */
};

/* At most `leaf_size` parts in a leaf. False: no memory. */
bool part_tree_build(struct arena *arena, const struct box *boxes, uint32_t count, uint32_t leaf_size,
                     struct part_tree *out);

/* Adds the crossings of a line and one part of a shape to the scratch. False: no room there. */
typedef bool part_crossings(const void *shape, uint32_t part, const struct line *line, struct geom_scratch *scratch);

/* Adds the crossings of all parts whose boxes the line intersects. False: no room; then the scratch memory is
 * unchanged. */
bool part_tree_crossings(const struct part_tree *tree, const struct line *line, const void *shape,
                         part_crossings *crossings_of_part, struct geom_scratch *scratch);
/* What it points to (base/bundle.h). */
bundle_fields part_tree_bundle;

#endif
