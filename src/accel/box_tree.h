/* A four-wide hierarchy over boxes in double precision: every child of a node is an inner node or one item, so an
 * item's own box is tested only in its parent node. Built by binned surface-area splits (Wald, "On fast Construction of
 * SAH-based Bounding Volume Hierarchies", RT 2007) and collapsed to four children (Dammertz, Hanika, Keller, "Shallow
 * Bounding Volume Hierarchies", EGSR 2008). Knows boxes and indices only. Deterministic; scaling all boxes by a power
 * of two gives the same tree. */
#ifndef GRAY_ACCEL_BOX_TREE_H
#define GRAY_ACCEL_BOX_TREE_H

#include "base/bundle.h"
#include "base/error.h"
#include "base/isa.h"
#include "base/pool.h"
#include "math/box.h"
#include "math/ray.h"

#include <stddef.h>
#include <stdint.h>

enum { BOX_TREE_WIDTH = 4, BOX_TREE_STACK = 256 };

/* A child: an item (BOX_TREE_ITEM set), an inner node, or nothing (BOX_TREE_NONE; its box is empty). */
#define BOX_TREE_ITEM UINT32_C(0x80000000)
#define BOX_TREE_NONE UINT32_MAX

struct box_tree_node {
    double planes[3][2][BOX_TREE_WIDTH]; /* [axis][0: low side, 1: high side] of the four children */
    uint32_t child[BOX_TREE_WIDTH];
    uint32_t padding[4];
};

struct box_tree {
    struct box_tree_node *nodes; /* node 0 is the root; aligned to 64 bytes */
    uint32_t node_count, item_count;
    struct box bounds;
};

/* boxes[i] belongs to item i < 2^31; empty boxes are left out, infinite ones are fine. False: no memory or
 * cancelled. */
bool box_tree_build(struct box_tree *tree, const struct box *boxes, uint32_t count, struct pool *pool,
                    struct error *error);
/* Sets new boxes for the items of a tree (a refit). The same items must be empty as before. The structure of the tree
 * stays, and the boxes of its nodes are computed again. */
void box_tree_refit(struct box_tree *tree, const struct box *boxes);
/* Half the sum of the areas of the inner nodes, without infinite ones. The number of nodes that a line visits grows
 * with it (MacDonald and Booth, "Heuristics for Ray Tracing Using Space Subdivision", 1990). */
double box_tree_cost(const struct box_tree *tree);
void box_tree_destroy(struct box_tree *tree);
size_t box_tree_memory(const struct box_tree *tree);

/* Items whose box the ray's interval meets, nearest boxes first:
 *   box_tree_traversal_begin(&traversal, tree, ray); while (box_tree_traversal_next(&traversal, t_max, &item)) ...
 * t_max may shrink between calls. Boxes that begin at t <= t_max are never left out by rounding. */
struct box_tree_traversal {
    const struct box_tree *tree;
    double origin[3], inverse[3];
    int near_side[3];
    double t_min;
    uint32_t steps; /* inner nodes looked at */
    enum cpu_isa isa;
    int top;
    uint32_t child[BOX_TREE_STACK];
    double enter[BOX_TREE_STACK];
};
void box_tree_traversal_begin(struct box_tree_traversal *traversal, const struct box_tree *tree, const struct ray *ray);
/* Takes the top entry of a traversal. False: it begins beyond t_max, or it is an empty child, which only rays that are
 * not finite can reach (comparisons with NaN). */
static inline bool box_tree_take(struct box_tree_traversal *traversal, double t_max, uint32_t *child) {
    *child = traversal->child[--traversal->top];
    double enter = traversal->enter[traversal->top];
    return !(enter * (enter > 0 ? 1 - 0x1p-50 : 1 + 0x1p-50) > t_max) && *child != BOX_TREE_NONE;
}

/* box_tree_traversal_next where a node is on top. Ready items are taken without a call. */
bool box_tree_traversal_down(struct box_tree_traversal *traversal, double t_max, uint32_t *item);

static inline bool box_tree_traversal_next(struct box_tree_traversal *traversal, double t_max, uint32_t *item) {
    while (traversal->top > 0) {
        if (!(traversal->child[traversal->top - 1] & BOX_TREE_ITEM))
            return box_tree_traversal_down(traversal, t_max, item);
        uint32_t child;
        if (box_tree_take(traversal, t_max, &child)) {
            *item = child & ~BOX_TREE_ITEM;
            return true;
        }
    }
    return false;
}

/* The same without order, for any-hit queries. */
bool box_tree_traversal_any(struct box_tree_traversal *traversal, double t_max, uint32_t *item);

/* Items whose box meets a box, in any order. */
struct box_tree_meeting {
    const struct box_tree *tree;
    struct box box;
    int top;
    uint32_t child[BOX_TREE_STACK];
};
void box_tree_meeting_begin(struct box_tree_meeting *meeting, const struct box_tree *tree, const struct box *box);
bool box_tree_meeting_next(struct box_tree_meeting *meeting, uint32_t *item);

/* Both functions for each instruction set. */
bool box_tree_traversal_down_base(struct box_tree_traversal *traversal, double t_max, uint32_t *item);
bool box_tree_traversal_any_base(struct box_tree_traversal *traversal, double t_max, uint32_t *item);
bool box_tree_traversal_down_avx2(struct box_tree_traversal *traversal, double t_max, uint32_t *item);
bool box_tree_traversal_any_avx2(struct box_tree_traversal *traversal, double t_max, uint32_t *item);
/* What it points to (base/bundle.h). */
bundle_fields box_tree_bundle;

#endif
