/* The binary hierarchies of an index while it is built: built from the top downwards, improved by reinsertion, and
 * collapsed into nodes of eight children. Private to src/accel/triangle_*. */
#ifndef GRAY_ACCEL_TRIANGLE_TREE_INTERNAL_H
#define GRAY_ACCEL_TRIANGLE_TREE_INTERNAL_H

#include "accel/triangle_split_internal.h"

#include "base/pool.h"

#define NO_BRANCH UINT32_MAX

/* A branch of the forest; height 0: a leaf, of at most WIDTH references. */
struct branch {
    float min[3];
    uint32_t parent; /* NO_BRANCH: a root */
    float max[3];
    uint32_t count; /* references below */
    uint32_t child[2];
    uint32_t first; /* of a leaf: its references */
    float area;     /* half of the surface */
    uint8_t height;
    /* Set by tree_weigh: whether it is one block; how many of its eight lanes child 0 gets if it is a node; and, if it
     * gets i + 1 lanes of its parent, how many of them child 0 gets (0: i lanes are as good). */
    bool is_block;
    uint8_t as_node, as_part[WIDTH];
};

struct tree {
    struct branch *branches;
    uint32_t count, capacity;
};

static inline float4 branch_min(const struct branch *branch) {
    return float4_three(float4_load_any(branch->min));
}
static inline float4 branch_max(const struct branch *branch) {
    return float4_three(float4_load_any(branch->max));
}

/* Of a branch with these children. */
static inline uint8_t branch_height(const struct branch *a, const struct branch *b) {
    return (uint8_t)(1 + (a->height > b->height ? a->height : b->height));
}

/* A branch without children over a range; its number is *out. False: no memory. */
bool tree_add(struct tree *tree, const struct range *range, uint32_t parent, uint32_t *out);
/* Splits a range that is `depth` branches below its root. */
void tree_part(struct reference *references, const struct range *range, uint32_t depth, struct range part[2]);
/* A whole hierarchy over a range, whose root would lie `depth` branches below another. False: no memory, or
 * cancelled. */
bool tree_build(struct tree *tree, struct reference *references, const struct range *range, uint32_t depth,
                const struct pool *pool, uint32_t *root);

/* Moves branches to where they cost less. False: no memory, or cancelled. */
bool tree_improve(struct tree *tree, const struct pool *pool);

/* The cost of branch `number` as 1 .. WIDTH lanes of a node. costs: known costs of branches with at most `limit`
 * references, by their `first`, except leaves; the recursion stops at them. NULL: there are none. */
struct lane_costs {
    float of[WIDTH];
};
struct lane_costs tree_weigh(struct tree *tree, uint32_t number, uint32_t limit, const struct lane_costs *costs);
/* The children of branch `number` as a node; how many. */
uint32_t tree_children(const struct tree *tree, uint32_t number, uint32_t children[WIDTH]);

#endif
