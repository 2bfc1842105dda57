/* The search of waves of paths (device/), for graphics cards: one loop over binary hierarchies with boxes in single
 * precision (accel/float_tree.h). Its top contains the primitives, and in the place of a plain mesh in world space the
 * mesh's triangles. Other plain meshes have a hierarchy over their triangles, which their instances share. Plain: no
 * culled sides and no holes. Triangles are decided by the test of accel/triangle.h, everything else is asked by
 * world_ask_nearest and world_ask_any, so that all answers have the bits of the other searches.
 * It is made for a bundle alone: processors are quicker with their own. */
#ifndef GRAY_WORLD_DEVICE_SEARCH_H
#define GRAY_WORLD_DEVICE_SEARCH_H

#include "accel/float_tree.h"
#include "world/world.h"

/* A triangle of a leaf, by its place there. */
struct device_triangle {
    double corners[9];
    uint32_t part, primitive; /* its number in the mesh; unused in the hierarchy of a mesh */
} __attribute__((aligned(16)));

/* Owner: the caller of device_search_build, device_search_destroy. */
struct device_search {
    struct float_node *nodes;
    struct device_triangle *triangles;
    uint32_t *roots; /* by prototype: of its mesh; FLOAT_TREE_NONE: it has no hierarchy of its own */
    uint32_t node_count, triangle_count, prototype_count;
    uint32_t top; /* the root of the top */
};

/* More primitives than this have no numbers in leaves. */
enum { DEVICE_SEARCH_PRIMITIVES = FLOAT_TREE_MANY };

/* Errors: no memory, cancelled; nothing is left to destroy then. */
bool device_search_build(struct device_search *search, const struct world *world, struct pool *pool,
                         struct error *error);
void device_search_destroy(struct device_search *search);
bundle_fields device_search_bundle; /* what it points to (base/bundle.h) */
/* The world with this search in place of its own. Both are borrowed. */
struct world device_search_world(const struct device_search *search, const struct world *world);

/* world_nearest_crossing and world_any of such a world. */
bool device_search_nearest(const struct world *world, const struct ray *ray, struct world_scratch *scratch,
                           uint32_t *primitive, struct crossing *crossing);
bool device_search_any(const struct world *world, const struct ray *ray, struct world_scratch *scratch);

#endif
