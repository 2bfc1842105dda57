/* A tree over the boxes of a shape's parts, stored in the order of a visit: a node, the nodes below its first half, the
 * nodes below its second half. Each node has the index of the next node if a line misses its box, so the traversal
 * needs no stack.
 *
 * Each node is split at the median of the boxes' middles along the longest axis of its box, so the depth is the
 * logarithm of the number of parts. A heap sort per level finds the median: it is fast enough for a few thousand parts
 * and has no bad case. */
#include "shape/part_tree_internal.h"

#include "base/mem.h"

#include <assert.h>
#include <math.h>

/* A part, and where its box lies along the axis of the split. */
struct part_middle {
    double middle;
    uint32_t part;
};

struct builder {
    const struct box *boxes;   /* of the parts, by number */
    struct part_middle *order; /* a node has a piece of it */
    struct part_node *nodes;
    uint32_t node_count, leaf_size;
    double pad; /* boxes are larger by it on every side */
};

/* Halves first: the sum of two finite numbers need not be finite. */
static double middle(const struct box *b, int axis) {
    return vec3_get(b->min, axis) / 2 + vec3_get(b->max, axis) / 2;
}

/* By middle, then by number: a total order, so the tree is a function of the boxes. */
static bool comes_before(const void *one, const void *other) {
    const struct part_middle *p = one, *q = other;
    return p->middle != q->middle ? p->middle < q->middle : p->part < q->part;
}

/* Recursion is as deep as the logarithm of the number of parts. */
static void build(struct builder *b, uint32_t first, uint32_t count) {
    struct box box = box_empty();
    for (uint32_t i = 0; i < count; i++)
        box = box_join(box, b->boxes[b->order[first + i].part]);
    struct part_node *node = &b->nodes[b->node_count++];
    struct vec3 size = vec3_sub(box.max, box.min);
    *node = (struct part_node){.box = box_grow(box, b->pad), .first = first};
    if (count <= b->leaf_size) {
        node->count = count;
    } else {
        /* The first half follows its parent, the second begins where the first ends. */
        int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        for (uint32_t i = first; i < first + count; i++)
            b->order[i].middle = middle(&b->boxes[b->order[i].part], axis);
        sort_items(&b->order[first], count, sizeof *b->order, comes_before);
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
    b.order = mem_alloc(count * sizeof *b.order);
    uint32_t *order = arena_alloc_array(arena, count, sizeof *order);
    b.nodes = arena_alloc_array(arena, 2 * (size_t)count, sizeof *b.nodes);
    if (!b.order || !order || !b.nodes) {
        mem_free(b.order);
        return false;
    }
    /* Rounding grows with the largest coordinate, and so do the boxes. */
    for (uint32_t i = 0; i < count; i++) {
        b.order[i] = (struct part_middle){.part = i};
        b.pad = math_max(b.pad, math_max(vec3_max_abs(boxes[i].min), vec3_max_abs(boxes[i].max)));
    }
    b.pad *= 0x1p-40;
    build(&b, 0, count);
    for (uint32_t i = 0; i < count; i++)
        order[i] = b.order[i].part;
    mem_free(b.order);
    *out = (struct part_tree){b.nodes, b.node_count, order};
    return true;
}

bool part_tree_crossings(const struct part_tree *tree, const struct line *line, const void *shape,
                         part_crossings *crossings_of_part, struct geom_scratch *scratch) {
    uint32_t first = scratch->used;
    for (uint32_t n = 0; n < tree->node_count;) {
        const struct part_node *node = &tree->nodes[n];
        if (!line_meets_box(line, &node->box)) {
            n = node->skip;
            continue;
        }
        for (uint32_t i = 0; i < node->count; i++)
            if (!crossings_of_part(shape, tree->order[node->first + i], line, scratch)) {
                scratch->used = first;
                return false;
            }
        n++;
    }
    return true;
}

void part_tree_bundle(struct bundle *bundle, void *part_tree) {
    struct part_tree *tree = part_tree;
    uint32_t parts = 0;
    for (uint32_t i = 0; i < tree->node_count; i++) {
        const uint32_t end = tree->nodes[i].first + tree->nodes[i].count;
        parts = end > parts ? end : parts;
    }
    BUNDLE(bundle, tree->nodes, tree->node_count, NULL);
    BUNDLE(bundle, tree->order, parts, NULL);
}
