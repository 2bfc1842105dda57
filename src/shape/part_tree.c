/* A tree over the boxes of a shape's parts, stored in the order of a visit: a node, the nodes below its first half, the
 * nodes below its second half. Each node has the index of the next node if a line misses its box, so the traversal
 * needs no stack.
 *
 * Each node is split at the median of the boxes' middles along the longest axis of its box, so the depth is the
 * logarithm of the number of parts. A heap sort per level finds the median: it is fast enough for a few thousand parts
 * and has no bad case. */
#include "shape/part_tree_internal.h"

#include <assert.h>
#include <math.h>

struct builder {
    const struct box *boxes; /* of the parts, by number */
    uint32_t *order;         /* numbers of the parts; a node has a piece of it */
    struct part_node *nodes;
    uint32_t node_count, leaf_size;
    double pad; /* boxes are larger by it on every side */
};

/* Halves first: the sum of two finite numbers need not be finite. */
static double middle(const struct box *b, int axis) {
    return vec3_get(b->min, axis) / 2 + vec3_get(b->max, axis) / 2;
}

/* By middle, then by number: a total order. */
static bool comes_before(const struct builder *b, uint32_t i, uint32_t j, int axis) {
    double p = middle(&b->boxes[i], axis), q = middle(&b->boxes[j], axis);
    return p != q ? p < q : i < j;
}

static void sift_down(const struct builder *b, uint32_t *items, uint32_t root, uint32_t count, int axis) {
    uint32_t moved = items[root];
    for (;;) {
        uint32_t child = 2 * root + 1;
        if (child >= count)
            break;
        if (child + 1 < count && comes_before(b, items[child], items[child + 1], axis))
            child++;
        if (!comes_before(b, moved, items[child], axis))
            break;
        items[root] = items[child];
        root = child;
    }
    items[root] = moved;
}

/* Heap sort: no recursion, no bad case, and the order is a total one, so the tree is a function of the boxes. */
static void sort(const struct builder *b, uint32_t *items, uint32_t count, int axis) {
    for (uint32_t i = count / 2; i-- > 0;)
        sift_down(b, items, i, count, axis);
    for (uint32_t end = count; end-- > 1;) {
        uint32_t last = items[end];
        items[end] = items[0];
        items[0] = last;
        sift_down(b, items, 0, end, axis);
    }
}

/* Recursion is as deep as the logarithm of the number of parts. */
static void build(struct builder *b, uint32_t first, uint32_t count) {
    struct box box = box_empty();
    for (uint32_t i = 0; i < count; i++)
        box = box_join(box, b->boxes[b->order[first + i]]);
    struct part_node *node = &b->nodes[b->node_count++];
    struct vec3 size = vec3_sub(box.max, box.min);
    *node = (struct part_node){.box = {vec3_sub(box.min, vec3_all(b->pad)), vec3_add(box.max, vec3_all(b->pad))},
                               .first = first};
    if (count <= b->leaf_size) {
        node->count = count;
    } else {
        /* The first half follows its parent, the second begins where the first ends. */
        int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        sort(b, &b->order[first], count, axis);
        build(b, first, count / 2);
        build(b, first + count / 2, count - count / 2);
    }
    node->skip = b->node_count;
}

bool part_tree_build(struct arena *arena, const struct box *boxes, uint32_t count, uint32_t leaf_size,
                     struct part_tree *out) {
    assert(leaf_size > 0);
    *out = (struct part_tree){0};
    if (count == 0)
        return true;
    struct builder b = {.boxes = boxes, .leaf_size = leaf_size};
    b.order = arena_alloc_array(arena, count, sizeof *b.order);
    b.nodes = arena_alloc_array(arena, 2 * (size_t)count, sizeof *b.nodes);
    if (!b.order || !b.nodes)
        return false;
    /* Rounding grows with the largest coordinate, and so do the boxes. */
    for (uint32_t i = 0; i < count; i++) {
        b.order[i] = i;
        b.pad = fmax(b.pad, fmax(vec3_max_abs(boxes[i].min), vec3_max_abs(boxes[i].max)));
    }
    b.pad *= 0x1p-40;
    build(&b, 0, count);
    *out = (struct part_tree){b.nodes, b.node_count, b.order};
    return true;
}
