/* Building the hierarchies of a triangle index. Private to src/accel/triangle_*. */
#ifndef GRAY_ACCEL_TRIANGLE_BUILD_INTERNAL_H
#define GRAY_ACCEL_TRIANGLE_BUILD_INTERNAL_H

#include "accel/triangle_layout_internal.h"

/* A triangle in one voxel: its local box, cut to the voxel. */
struct reference {
    float min[3];
    uint32_t triangle;
    float max[3];
    uint32_t unused;
};

/* The references of one hierarchy, and the reference to it afterwards. */
struct hierarchy {
    uint32_t first, count;
    uint32_t result;
};

struct hierarchy_list {
    struct hierarchy *items;
    uint32_t count;
};

/* Makes nodes and blocks of `index` (centre and scale are set) for all hierarchies; `references` is reordered.
 * The same bytes for any pool. False: no memory or cancelled; partial results stay in the index. */
bool hierarchies_build(struct triangle_index *index, const struct triangle_set *set, struct reference *references,
                       struct hierarchy_list hierarchies, struct pool *pool, struct error *error);

#endif
