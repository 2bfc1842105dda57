/* A kd-tree over items with boxes, in double precision: space is halved by planes across the axes, an item is listed in
 * every leaf that a part of it touches. Built along the surface area heuristic with exact splits in O(n log n) (Wald
 * and Havran, "On building fast kd-Trees for Ray Tracing, and on doing that in O(N log N)", RT 2006). Knows boxes,
 * indices and a function that clips an item. For teaching and for verification: --accel kdtree. Deterministic; scaling
 * everything by a power of two gives the same tree. */
#ifndef GRAY_ACCEL_KD_TREE_H
#define GRAY_ACCEL_KD_TREE_H

#include "base/bundle.h"
#include "base/error.h"
#include "base/pool.h"
#include "math/box.h"
#include "math/ray.h"

#include <stddef.h>
#include <stdint.h>

enum { KD_LEAF = 3, KD_DEPTH = 64 };

/* Nodes lie depth first: the lower child of an inner node follows it. */
struct kd_node {
    union {
        double split;   /* of an inner node: where the plane is */
        uint64_t count; /* of a leaf */
    };
    uint32_t axis;   /* KD_LEAF for a leaf */
    uint32_t offset; /* inner: number of the upper child; leaf: its first entry in items[] */
};

struct kd_tree {
    struct kd_node *nodes; /* node 0 is the root */
    uint32_t *items;
    uint32_t *unbounded; /* items that no cell can hold, offered to every ray first */
    uint32_t node_count, entry_count, unbounded_count;
    struct box bounds; /* of the others */
};

/* The box of the part of an item that lies in a cell, itself inside the cell; false when there is none. It may be too
 * large but never too small. */
typedef bool kd_clip(const void *context, uint32_t item, const struct box *cell, struct box *part);

/* boxes[i] belongs to item i; empty ones are left out. */
struct kd_items {
    const struct box *boxes;
    uint32_t count;
    kd_clip *clip; /* NULL: items are their boxes */
    const void *context;
};
/* False: no memory or cancelled; the tree is then empty. pool may be NULL; it is only polled for cancellation. */
bool kd_tree_build(struct kd_tree *tree, const struct kd_items *items, const struct pool *pool, struct error *error);
void kd_tree_destroy(struct kd_tree *tree);
size_t kd_tree_memory(const struct kd_tree *tree);

/* Leaves along a ray, in the order of the ray:
 *   kd_traversal_begin(&traversal, tree, ray, slack); while (kd_traversal_next(&traversal, t_max)) ...
 * traversal.items[0 .. traversal.count - 1] ... t_max may shrink between calls. An item whose part is nearer than
 * `slack` (a length) to a point of the ray at t <= t_max is offered in spite of rounding. An item may be offered
 * several times. */
struct kd_traversal {
    const uint32_t *items;
    uint32_t count;
    uint32_t steps, leaves; /* inner nodes and leaves visited so far */
    const struct kd_tree *tree;
    double origin[3], direction[3], inverse[3], widen[3], slack;
    int top;
    struct kd_pending {
        double enter, leave;
        uint32_t node;
    } stack[KD_DEPTH + 2];
    bool unbounded_next;
};
void kd_traversal_begin(struct kd_traversal *traversal, const struct kd_tree *tree, const struct ray *ray,
                        double slack);
bool kd_traversal_next(struct kd_traversal *traversal, double t_max);
/* What it points to (base/bundle.h). */
bundle_fields kd_tree_bundle;

#endif
