/* The plan of a CSG program. The postfix program is rewritten once as a tree of AND and OR nodes with any number of
 * children over leaves, a leaf possibly negated: a - b is a AND NOT b, negations go down to the leaves (De Morgan), and
 * neighbouring nodes of one kind become one. A node only counts its true children, so a change of one leaf costs one
 * step per node whose truth changes with it: a union of 10,000 solids is one node.
 *
 * The leaves' boxes stand in a binary tree (halves at the median of the longest axis), so that a ray asks only the
 * leaves near it. Programs may be as deep as they are long: they are read with explicit stacks. */
#include "geom/csg_plan.h"
#include "base/mem.h"

#include <assert.h>

enum { LEAVES_PER_BOUND = 4 };

/* The program must combine to exactly one value and use every leaf once. */
static bool program_is_well_formed(const struct csg *csg, bool *used, uint32_t *stack_depth) {
    uint32_t depth = 0, leaves = 0, deepest = 0;
    for (uint32_t i = 0; i < csg->program_length; i++) {
        if (csg->program[i].operation == CSG_LEAF) {
            uint32_t leaf = csg->program[i].leaf;
            if (leaf >= csg->leaf_count || used[leaf])
                return false;
            used[leaf] = true;
            leaves++;
            depth++;
        } else {
            if (depth < 2)
                return false;
            depth--;
        }
        deepest = depth > deepest ? depth : deepest;
    }
    *stack_depth = deepest;
    return depth == 1 && leaves == csg->leaf_count;
}

/* What the program does to boxes. */
static struct box program_bounds(const struct csg *csg, const struct box *leaf_boxes, struct box *stack) {
    uint32_t depth = 0;
    for (uint32_t i = 0; i < csg->program_length; i++) {
        enum csg_operation operation = csg->program[i].operation;
        if (operation != CSG_LEAF)
            depth--;
        switch (operation) {
        case CSG_LEAF:
            stack[depth++] = leaf_boxes[csg->program[i].leaf];
            break;
        case CSG_UNION:
            stack[depth - 1] = box_join(stack[depth - 1], stack[depth]);
            break;
        case CSG_INTERSECTION:
            stack[depth - 1] = box_meet(stack[depth - 1], stack[depth]);
            break;
        case CSG_DIFFERENCE:
            break;
        }
        if (box_is_empty(&stack[depth - 1])) /* in the form that adds nothing to a join */
            stack[depth - 1] = box_empty();
    }
    return stack[0];
}

struct pending {
    uint32_t parent;
    bool negated;
};

/* Reads the program backwards, which meets the root first and a right operand before the left one. is_all[n] tells
 * whether node n is an AND. */
static void build_nodes(const struct csg *csg, struct csg_plan *plan, struct pending *stack, bool *is_all) {
    uint32_t depth = 0;
    stack[depth++] = (struct pending){CSG_NONE, false};
    for (uint32_t i = csg->program_length; i-- > 0;) {
        struct pending p = stack[--depth];
        enum csg_operation operation = csg->program[i].operation;
        bool leaf = operation == CSG_LEAF, all = !leaf && (operation == CSG_UNION) == p.negated;
        uint32_t node = p.parent;
        if (node == CSG_NONE || (!leaf && is_all[node] != all)) {
            node = plan->node_count++;
            plan->nodes[node] = (struct csg_node){p.parent, 0};
            is_all[node] = all;
            if (p.parent != CSG_NONE)
                plan->nodes[p.parent].threshold++;
        }
        if (leaf) {
            plan->literals[csg->program[i].leaf] = (struct csg_literal){node, p.negated};
            plan->nodes[node].threshold++;
        } else {
            stack[depth++] = (struct pending){node, p.negated};
            stack[depth++] = (struct pending){node, p.negated != (operation == CSG_DIFFERENCE)};
        }
    }
    assert(depth == 0);
    for (uint32_t i = 0; i < plan->node_count; i++)
        if (!is_all[i])
            plan->nodes[i].threshold = 1;

    /* True children while the line is outside every leaf, from the bottom up. */
    for (uint32_t i = 0; i < csg->leaf_count; i++)
        plan->start_counts[plan->literals[i].parent] += plan->literals[i].negated;
    for (uint32_t i = plan->node_count; i-- > 1;)
        plan->start_counts[plan->nodes[i].parent] += plan->start_counts[i] >= plan->nodes[i].threshold;
    assert(plan->start_counts[0] < plan->nodes[0].threshold);
}

static double box_middle(const struct box *b, int axis) {
    double middle = vec3_get(b->min, axis) / 2 + vec3_get(b->max, axis) / 2;
    return isfinite(middle) ? middle : 0;
}

/* Quickselect (Hoare, "Algorithm 65: Find", 1961): afterwards the k-th leaf by its middle stands at k, lesser ones
 * before it, greater ones behind it. Equal middles go by index, so the order is total. */
static void select_middle(const struct csg_plan *plan, uint32_t *order, uint32_t count, uint32_t k, int axis) {
    uint32_t lo = 0, hi = count - 1;
    while (lo < hi) {
        uint32_t pivot = order[lo + (hi - lo) / 2], i = lo, j = hi;
        double value = box_middle(&plan->boxes[pivot], axis);
        for (;;) {
            for (;; i++) {
                double m = box_middle(&plan->boxes[order[i]], axis);
                if (!(m < value || (m == value && order[i] < pivot)))
                    break;
            }
            for (;; j--) {
                double m = box_middle(&plan->boxes[order[j]], axis);
                if (!(m > value || (m == value && order[j] > pivot)))
                    break;
            }
            if (i >= j)
                break;
            uint32_t swapped = order[i];
            order[i] = order[j];
            order[j] = swapped;
        }
        assert(order[i] == pivot);
        if (i == k)
            return;
        if (i > k)
            hi = i - 1;
        else
            lo = i + 1;
    }
}

/* Halving 65535 leaves goes 14 calls deep. */
static void build_bounds(struct csg_plan *plan, uint32_t first, uint32_t count) {
    struct csg_bound *bound = &plan->bounds[plan->bound_count++];
    *bound = (struct csg_bound){.box = box_empty(), .first = first};
    struct box middles = box_empty();
    for (uint32_t i = first; i < first + count; i++) {
        const struct box *b = &plan->boxes[plan->order[i]];
        bound->box = box_join(bound->box, *b);
        middles = box_add_point(middles, vec3_make(box_middle(b, 0), box_middle(b, 1), box_middle(b, 2)));
    }
    if (count <= LEAVES_PER_BOUND) {
        bound->count = count;
    } else {
        struct vec3 size = vec3_sub(middles.max, middles.min);
        int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        uint32_t half = count / 2;
        select_middle(plan, plan->order + first, count, half, axis);
        build_bounds(plan, first, half);
        build_bounds(plan, first + half, count - half);
    }
    bound->skip = plan->bound_count;
}

/* Everything that needs memory only while building. */
static bool fill_plan(struct csg *csg, struct csg_plan *plan, struct error *error) {
    uint32_t length = csg->program_length, leaf_count = csg->leaf_count;
    bool *flags = mem_alloc_zero(length, sizeof *flags);
    struct box *boxes = mem_alloc_zero(length, sizeof *boxes);
    struct pending *pending = mem_alloc_zero(length + 1, sizeof *pending);
    bool ok = flags && boxes && pending;
    if (!ok)
        error_no_memory(error, "CSG");
    else if (!program_is_well_formed(csg, flags, &csg->stack_depth))
        ok = error_set(error, ERROR_SCENE, "CSG: malformed program");
    if (ok) {
        uint64_t crossings = 0;
        for (uint32_t i = 0; i < leaf_count; i++) {
            const struct csg_leaf *leaf = &csg->leaves[i];
            struct box b = box_pad(shape_bounds_under(&leaf->shape, &leaf->csg_from_leaf.forward));
            plan->boxes[i] = b;
            plan->order[i] = i;
            crossings += shape_scratch_need(&leaf->shape);
            double reach = box_is_empty(&b) ? 0 : fmax(vec3_max_abs(b.min), vec3_max_abs(b.max));
            if (isfinite(reach)) /* solids without end have no size */
                plan->size = fmax(plan->size, reach);
        }
        csg->bounds = program_bounds(csg, plan->boxes, boxes);
        for (uint32_t i = 0; i < length; i++)
            flags[i] = false;
        build_nodes(csg, plan, pending, flags);
        build_bounds(plan, 0, leaf_count);

        /* The truth of nodes and leaves, or the stack of csg_contains in bits, and all crossings above it. */
        uint64_t words = plan->node_count + (leaf_count + 31) / 32;
        plan->state_items =
            (uint32_t)((words * sizeof(uint32_t) + sizeof(struct crossing) - 1) / sizeof(struct crossing));
        crossings += plan->state_items;
        csg->max_crossings = crossings < UINT32_MAX / 4 ? (uint32_t)crossings : UINT32_MAX / 4;
    }
    mem_free(pending);
    mem_free(boxes);
    mem_free(flags);
    return ok;
}

const struct csg *csg_build(struct arena *arena, const struct csg_leaf *leaves, uint32_t leaf_count,
                            const struct csg_token *program, uint32_t program_length, struct error *error) {
    if (leaf_count > 65535) {
        error_set(error, ERROR_SCENE, "CSG: %u operands, more than 65535", leaf_count);
        return NULL;
    }
    /* n leaves and n - 1 operations; this also bounds what is allocated below */
    if (leaf_count == 0 || program_length != 2 * leaf_count - 1) {
        error_set(error, ERROR_SCENE, "CSG: malformed program");
        return NULL;
    }
    struct csg *csg = arena_alloc(arena, sizeof *csg);
    struct csg_plan *plan = arena_alloc(arena, sizeof *plan);
    struct csg_leaf *own_leaves = arena_alloc_array(arena, leaf_count, sizeof *own_leaves);
    struct csg_token *own_program = arena_alloc_array(arena, program_length, sizeof *own_program);
    bool ok = csg && plan && own_leaves && own_program;
    if (ok) {
        plan->nodes =
            arena_alloc_array(arena, leaf_count, sizeof *plan->nodes); /* at least two children each, or one */
        plan->start_counts = arena_alloc_array(arena, leaf_count, sizeof *plan->start_counts);
        plan->literals = arena_alloc_array(arena, leaf_count, sizeof *plan->literals);
        plan->boxes = arena_alloc_array(arena, leaf_count, sizeof *plan->boxes);
        plan->order = arena_alloc_array(arena, leaf_count, sizeof *plan->order);
        plan->bounds =
            arena_alloc_array(arena, leaf_count, sizeof *plan->bounds); /* at least two leaves each, or one */
        ok = plan->nodes && plan->start_counts && plan->literals && plan->boxes && plan->order && plan->bounds;
    }
    if (!ok) {
        error_no_memory(error, "CSG");
        return NULL;
    }
    for (uint32_t i = 0; i < leaf_count; i++) {
        assert(leaves[i].shape.kind != SHAPE_CSG);
        own_leaves[i] = leaves[i];
    }
    for (uint32_t i = 0; i < program_length; i++)
        own_program[i] = program[i];
    csg->leaves = own_leaves;
    csg->leaf_count = leaf_count;
    csg->program = own_program;
    csg->program_length = program_length;
    csg->plan = plan;
    return fill_plan(csg, plan, error) ? csg : NULL;
}
