/* From the top downwards the surface area heuristic sees one split at a time, and if large and small triangles are
 * mixed (a statue in a stadium), a small one is soon in a box with large ones. Reinsertion takes such a branch out and
 * puts it where the sum of all surfaces becomes smallest: J. Bittner, M. Hapala, V. Havran, "Fast Insertion-Based
 * Optimization of Bounding Volume Hierarchies", CGF 32(1), 2013; the search from the branch upwards, into each sibling
 * on the way, is that of D. Meister, J. Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", CGF
 * 37(2), 2018. Branches are moved one after the other, so that the result is deterministic, and only the most promising
 * ones, which takes a tenth of the build time: those whose parent is large, absolutely and relative to them.
 *
 * Which branches become nodes of eight children, and which blocks, is the cheapest choice of all: H. Ylitie, T. Karras,
 * S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, section 3.1. For every
 * branch and 1 .. 8 lanes, the minimal cost of occupying this many lanes of a node follows from the costs of both
 * children. * Measurements: docs/lab/notebook.md. */
#include "accel/triangle_tree_internal.h"

#include "base/mem.h"
#include "base/sort.h"

#include <string.h>

enum {
    HALVE_DEPTH = 60,       /* below this depth ranges are halved, so there are at most 31 more levels */
    FLOOR_STEP = 3,         /* search for a floor at every third level: where nodes of eight begin */
    REINSERTION_ROUNDS = 2, /* of reinsertion, */
    PASS_SHARE = 7,         /* each over a seventh of all branches */
    KEY_BITS = 12,          /* bits of the estimate used for counting */
    POLL_COUNT = 2000       /* references that are split without asking whether to stop */
};

/* The cost of a node and of a block for a ray that hits it, relative to a node (docs/lab/notebook.md: 30
 * cycles, 60). */
#define NODE_COST 1.0f
#define BLOCK_COST 2.0f

/* A move must save this fraction of the parent's surface: less is rounding, or not worth the time. */
#define MIN_GAIN 1e-3f

static void set_box(struct branch *branch, float4 min, float4 max) {
    float lo[4], hi[4];
    float4_store_any(lo, min);
    float4_store_any(hi, max);
    memcpy(branch->min, lo, sizeof branch->min);
    memcpy(branch->max, hi, sizeof branch->max);
    branch->area = half_area(min, max);
}

bool tree_add(struct tree *tree, const struct range *range, uint32_t parent, uint32_t *out) {
    if (tree->count == tree->capacity) {
        uint32_t larger = tree->capacity + tree->capacity / 2 + 32;
        struct branch *grown = mem_resize_array(tree->branches, larger, sizeof *grown);
        if (!grown)
            return false;
        tree->branches = grown;
        tree->capacity = larger;
    }
    struct branch *branch = &tree->branches[tree->count];
    *branch = (struct branch){.parent = parent, .count = range->count, .first = range->first};
    set_box(branch, range->min, range->max);
    *out = tree->count++;
    return true;
}

void tree_part(struct reference *references, const struct range *range, uint32_t depth, struct range part[2]) {
    bool halve = depth > HALVE_DEPTH;
    if (halve || depth % FLOOR_STEP != 0 || !split_floor(references, range, &part[0], &part[1]))
        split_range(references, range, halve, &part[0], &part[1]);
}

bool tree_build(struct tree *tree, struct reference *references, const struct range *range, uint32_t depth,
                const struct pool *pool, uint32_t *root) {
    struct range part[2];
    uint32_t child[2];
    if (!tree_add(tree, range, NO_BRANCH, root))
        return false;
    if (range->count <= WIDTH)
        return true;
    if (range->count > POLL_COUNT && pool && pool_cancelled(pool))
        return false;
    tree_part(references, range, depth, part);
    for (int i = 0; i < 2; i++) {
        if (!tree_build(tree, references, &part[i], depth + 1, pool, &child[i]))
            return false;
        tree->branches[child[i]].parent = *root;
    }
    struct branch *branch = &tree->branches[*root];
    memcpy(branch->child, child, sizeof child);
    branch->height = branch_height(&tree->branches[child[0]], &tree->branches[child[1]]);
    return true;
}

/* Boxes, counts and heights of a branch whose children are known, and of all above it. */
static void tree_refit(struct tree *tree, uint32_t number) {
    while (number != NO_BRANCH) {
        struct branch *branch = &tree->branches[number];
        const struct branch *a = &tree->branches[branch->child[0]], *b = &tree->branches[branch->child[1]];
        set_box(branch, float4_min(branch_min(a), branch_min(b)), float4_max(branch_max(a), branch_max(b)));
        branch->count = a->count + b->count;
        branch->height = branch_height(a, b);
        number = branch->parent;
    }
}

/* --- reinsertion --- */

static uint32_t sibling_of(const struct branch *branches, uint32_t number) {
    const uint32_t *child = branches[branches[number].parent].child;
    return child[child[0] == number];
}

static void put_child(struct branch *branches, uint32_t parent, uint32_t old, uint32_t new) {
    branches[parent].child[branches[parent].child[1] == old] = new;
    branches[new].parent = parent;
}

static uint32_t depth_of(const struct branch *branches, uint32_t number) {
    uint32_t depth = 0;
    while ((number = branches[number].parent) != NO_BRANCH)
        depth++;
    return depth;
}

/* The best new sibling for branch `number`, or NO_BRANCH to leave it. Its parent moves with it. */
static uint32_t best_position(const struct branch *branches, uint32_t number) {
    struct {
        uint32_t number;
        float gain;
    } stack[MAX_BRANCH_DEPTH + 2];
    const struct branch *moved = &branches[number];
    const float4 lo = branch_min(moved), hi = branch_max(moved);
    const uint32_t parent = moved->parent;
    uint32_t pivot = parent, sibling = sibling_of(branches, number), best = NO_BRANCH;
    float best_gain = branches[parent].area * MIN_GAIN;
    float shrunk = branches[parent].area; /* by which all surfaces up to the pivot become smaller without it */
    float4 rest_lo = branch_min(&branches[sibling]),
           rest_hi = branch_max(&branches[sibling]); /* the pivot's without it */
    for (;;) {
        uint32_t top = 0;
        stack[top].number = sibling;
        stack[top++].gain = shrunk;
        while (top > 0) {
            uint32_t target = stack[--top].number;
            float gain = stack[top].gain;
            if (gain - moved->area <= best_gain)
                continue;
            const struct branch *there = &branches[target];
            gain -= half_area(float4_min(branch_min(there), lo), float4_max(branch_max(there), hi));
            if (gain > best_gain) {
                best_gain = gain;
                best = target;
            }
            for (int i = 0; there->height > 0 && i < 2; i++) {
                stack[top].number = there->child[i];
                stack[top++].gain = gain + there->area;
            }
        }
        if (pivot != parent) {
            rest_lo = float4_min(rest_lo, branch_min(&branches[sibling]));
            rest_hi = float4_max(rest_hi, branch_max(&branches[sibling]));
            shrunk += branches[pivot].area - half_area(rest_lo, rest_hi);
        }
        if (branches[pivot].parent == NO_BRANCH)
            return best;
        sibling = sibling_of(branches, pivot);
        pivot = branches[pivot].parent;
    }
}

static void reinsert(struct tree *tree, uint32_t number) {
    struct branch *branches = tree->branches;
    uint32_t parent = branches[number].parent, sibling = sibling_of(branches, number);
    uint32_t target = best_position(branches, number);
    if (target == NO_BRANCH || target == sibling)
        return;
    uint8_t here = branches[number].height, there = branches[target].height;
    if (depth_of(branches, target) + 1 + (here > there ? here : there) > MAX_BRANCH_DEPTH)
        return;
    uint32_t above = branches[parent].parent;
    put_child(branches, above, parent, sibling);
    tree_refit(tree, above);
    put_child(branches, branches[target].parent, target, parent);
    branches[parent].child[0] = target;
    branches[parent].child[1] = number;
    branches[target].parent = parent;
    tree_refit(tree, parent);
}

/* The possible gain of a branch, as bits that order like the number; 0: it stays. */
static uint32_t promise(const struct tree *tree, uint32_t number) {
    uint32_t parent = tree->branches[number].parent, bits;
    if (parent == NO_BRANCH || tree->branches[parent].parent == NO_BRANCH)
        return 0;
    float size = tree->branches[parent].area, own = tree->branches[number].area;
    float value = size * (size / (own > size * 0x1p-20f ? own : size * 0x1p-20f));
    if (!(value > 0 && value < INFINITY))
        return 0;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* About `wanted` most promising branches, the best first: words whose lower half is a branch. NULL: no memory. */
static uint64_t *best_candidate(const struct tree *tree, uint32_t wanted, uint32_t *count) {
    uint32_t number_of[1 << KEY_BITS] = {0}, min = (1 << KEY_BITS) - 1, found = 0;
    for (uint32_t i = 0; i < tree->count; i++)
        number_of[promise(tree, i) >> (32 - KEY_BITS)]++;
    for (; min > 0 && found + number_of[min] <= wanted; min--)
        found += number_of[min];
    min++; /* the lowest counter that fits completely */
    uint64_t *words = mem_alloc(((size_t)found + 1) * sizeof *words);
    *count = 0;
    for (uint32_t i = 0; words && i < tree->count; i++) {
        uint32_t bits = promise(tree, i);
        if (bits >> (32 - KEY_BITS) >= min)
            words[(*count)++] = (uint64_t)~bits << 32 | i;
    }
    if (words)
        sort_words(words, *count);
    return words;
}

bool tree_improve(struct tree *tree, const struct pool *pool) {
    for (int pass = 0; pass < REINSERTION_ROUNDS; pass++) {
        uint32_t count;
        uint64_t *words = best_candidate(tree, tree->count / PASS_SHARE, &count);
        bool go_on = words != NULL;
        for (uint32_t i = 0; go_on && i < count; i++) {
            uint32_t number = (uint32_t)words[i];
            if (promise(tree, number) > 0) /* others may have moved since */
                reinsert(tree, number);
            go_on = i % 256 != 0 || !pool || !pool_cancelled(pool);
        }
        mem_free(words);
        if (!go_on)
            return false;
    }
    return true;
}

/* --- nodes of eight children --- */

struct lane_costs tree_weigh(struct tree *tree, uint32_t number, uint32_t limit, const struct lane_costs *costs) {
    struct branch *branch = &tree->branches[number];
    struct lane_costs out, a, b;
    float as_block = branch->count <= WIDTH ? branch->area * BLOCK_COST : INFINITY;
    if (branch->height == 0) {
        branch->is_block = true;
        for (int i = 0; i < WIDTH; i++)
            out.of[i] = as_block;
        return out;
    }
    if (costs && branch->count <= limit)
        return costs[branch->first];
    a = tree_weigh(tree, branch->child[0], limit, costs);
    b = tree_weigh(tree, branch->child[1], limit, costs);
    float parted = INFINITY;
    for (int i = 0; i < WIDTH; i++) {
        uint8_t best = 0;
        parted = INFINITY;
        for (int k = 0; k < i; k++) {
            float cost = a.of[k] + b.of[i - 1 - k];
            if (cost < parted) {
                parted = cost;
                best = (uint8_t)(k + 1);
            }
        }
        out.of[i] = parted;
        branch->as_part[i] = best;
    }
    float as_node = branch->area * NODE_COST + parted; /* in all eight lanes */
    branch->as_node = branch->as_part[WIDTH - 1];
    branch->is_block = as_block <= as_node;
    out.of[0] = branch->is_block ? as_block : as_node;
    for (int i = 1; i < WIDTH; i++)
        if (out.of[i - 1] <= out.of[i]) {
            out.of[i] = out.of[i - 1];
            branch->as_part[i] = 0;
        }
    return out;
}

static void add_parts(const struct tree *tree, uint32_t number, uint32_t lanes, uint32_t parts[WIDTH],
                      uint32_t *count) {
    const struct branch *branch = &tree->branches[number];
    while (lanes > 1 && branch->as_part[lanes - 1] == 0)
        lanes--;
    if (lanes == 1) {
        parts[(*count)++] = number;
        return;
    }
    uint32_t left = branch->as_part[lanes - 1];
    add_parts(tree, branch->child[0], left, parts, count);
    add_parts(tree, branch->child[1], lanes - left, parts, count);
}

uint32_t tree_children(const struct tree *tree, uint32_t number, uint32_t children[WIDTH]) {
    const struct branch *branch = &tree->branches[number];
    uint32_t count = 0;
    add_parts(tree, branch->child[0], branch->as_node, children, &count);
    add_parts(tree, branch->child[1], WIDTH - branch->as_node, children, &count);
    return count;
}
