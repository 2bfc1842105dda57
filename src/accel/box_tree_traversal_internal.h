/* The traversal of box_tree.h, compiled once per instruction set: a file defines TRAVERSAL(name) and includes this one.
 * The same operations in each, nothing fused, so the same items in the same order. */
#include "accel/box_tree.h"
#include "math/lanes.h"

/* Where the ray enters each child, and which children it meets before t_max (bit i for child i). */
static inline unsigned meet_children(const struct box_tree_traversal *traversal, const struct box_tree_node *node,
                                     double t_max, double enter_out[BOX_TREE_WIDTH], double leave_out[BOX_TREE_WIDTH]) {
    double4 enter = double4_all(traversal->t_min), leave = double4_all(t_max);
    for (int axis = 0; axis < 3; axis++) {
        double4 origin = double4_all(traversal->origin[axis]), inverse = double4_all(traversal->inverse[axis]);
        double4 near = double4_load(node->planes[axis][traversal->near_side[axis]]);
        double4 far = double4_load(node->planes[axis][!traversal->near_side[axis]]);
        /* A NaN does not count. */
        enter = double4_max(double4_mul(double4_sub(near, origin), inverse), enter);
        leave = double4_min(double4_mul(double4_sub(far, origin), inverse), leave);
    }
    double4_store_any(enter_out, enter);
    double4_store_any(leave_out, leave);
    /* The factor that moves the bound outwards. */
    double4 less = double4_all(1 - 0x1p-50), more = double4_all(1 + 0x1p-50);
    double4 early = double4_min(double4_mul(enter, less), double4_mul(enter, more));
    double4 late = double4_max(double4_mul(leave, less), double4_mul(leave, more));
    return double4_bits(double4_less_equal(early, late));
}

bool TRAVERSAL(down)(struct box_tree_traversal *traversal, double t_max, uint32_t *item) {
    while (traversal->top > 0) {
        uint32_t child;
        if (!box_tree_take(traversal, t_max, &child))
            continue;
        if (child & BOX_TREE_ITEM) {
            *item = child & ~BOX_TREE_ITEM;
            return true;
        }
        const struct box_tree_node *node = &traversal->tree->nodes[child];
        double enter[BOX_TREE_WIDTH], leave[BOX_TREE_WIDTH], order[BOX_TREE_WIDTH];
        unsigned met = meet_children(traversal, node, t_max, enter, leave);
        traversal->steps++;
        /* The child that the ray leaves first must be on top: insertion sort of the few that were met. For disjoint
         * boxes this is also the order of entry; of two nested boxes the inner one comes first, and its hit shortens
         * the ray through the outer one (a teapot in a stadium). */
        int base = traversal->top;
        for (; met; met &= met - 1) {
            int i = __builtin_ctz(met), at = traversal->top++;
            for (; at > base && order[at - 1 - base] < leave[i]; at--) {
                order[at - base] = order[at - 1 - base];
                traversal->enter[at] = traversal->enter[at - 1];
                traversal->child[at] = traversal->child[at - 1];
            }
            order[at - base] = leave[i];
            traversal->enter[at] = enter[i];
            traversal->child[at] = node->child[i];
        }
    }
    return false;
}

bool TRAVERSAL(any)(struct box_tree_traversal *traversal, double t_max, uint32_t *item) {
    while (traversal->top > 0) {
        uint32_t child = traversal->child[--traversal->top];
        if (child & BOX_TREE_ITEM) {
            if (child == BOX_TREE_NONE) /* met only by rays that are not finite, through comparisons with NaN */
                continue;
            *item = child & ~BOX_TREE_ITEM;
            return true;
        }
        const struct box_tree_node *node = &traversal->tree->nodes[child];
        double enter[BOX_TREE_WIDTH], leave[BOX_TREE_WIDTH];
        unsigned met = meet_children(traversal, node, t_max, enter, leave);
        traversal->steps++;
        for (; met; met &= met - 1)
            traversal->child[traversal->top++] = node->child[__builtin_ctz(met)];
    }
    return false;
}
