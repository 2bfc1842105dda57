/* The plan of a CSG program. The postfix program is rewritten once as a tree of AND and OR nodes with any number of
 * children over leaves, a leaf possibly negated: a - b is a AND NOT b, negations go down to the leaves (De Morgan), and
 * neighbouring nodes of one kind become one. A node only counts its true children, so a change of one leaf costs one
 * step per node whose truth changes with it: a union of 10,000 solids is one node.
 *
 * Every node has a box outside of which its truth is what it is with all leaves false. Of an AND that is the common
 * part of the boxes of those children that start false, since any of them decides; if all start true, the box around
 * all. An OR is the same with true and false exchanged. A negated axis-aligned box or half-space may shorten an AND's
 * box at an end. A leaf matters only inside the boxes of all nodes above it: a ray that misses their intersection does
 * not test it, and subtracted leaves cost nothing away from the solid.
 *
 * A leaf that contains the whole solid is tested first, since a ray that misses it misses the solid, and after it
 * leaves it there are no more crossings.
 *
 * These boxes of the leaves stand in a binary tree (halves at the median of the longest axis), so that a ray tests only
 * the leaves near it. Programs may be as deep as they are long: they are read with explicit stacks. */
#include "csg/csg_build.h"
#include "base/mem.h"
#include "csg/csg_build_internal.h"

#include <assert.h>

/* A few leaves are tested one by one: a box around several of them is usually hit as well. */
enum { LEAVES_PER_BOUND = 4, FEW_LEAVES = 12 };

/* Each of both programs must combine to exactly one value, and both together use every leaf once, the solid's before
 * the clip's. */
static bool program_is_well_formed(const struct csg *csg, bool *used, uint32_t *stack_depth) {
    uint32_t depth = 0, leaves = 0, deepest = 0;
    uint32_t first_clip_leaf = csg->clipped ? csg->program[csg->solid_length].leaf : csg->leaf_count;
    for (uint32_t i = 0; i < csg->program_length; i++) {
        /* The clip begins above the solid, which stays on the stack. */
        uint32_t base = i < csg->solid_length ? 0 : 1;
        switch (csg->program[i].operation) {
        case CSG_LEAF: {
            uint32_t leaf = csg->program[i].leaf;
            if (leaf >= csg->leaf_count || used[leaf] || (base == 0) != (leaf < first_clip_leaf))
                return false;
            used[leaf] = true;
            leaves++;
            depth++;
            break;
        }
        case CSG_UNION:
        case CSG_INTERSECTION:
        case CSG_DIFFERENCE:
            if (depth < base + 2)
                return false;
            depth--;
            break;
        case CSG_INVERSE:
            if (depth < base + 1)
                return false;
            break;
        }
        deepest = depth > deepest ? depth : deepest;
        if (i + 1 == csg->solid_length && depth != 1)
            return false;
    }
    *stack_depth = deepest;
    return depth == (csg->clipped ? 2 : 1) && leaves == csg->leaf_count;
}

static bool is_identity(const struct transform *t) {
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            if (t->forward.m[i][j] != (i == j) || t->inverse.m[i][j] != (i == j))
                return false;
        }
    }
    return true;
}

struct pending {
    uint32_t parent;
    bool negated;
};

/* Reads a program backwards, so that the root comes first and a right operand before the left one. is_all[n]: whether
 * node n is an AND. Returns the root. */
static uint32_t build_nodes(const struct csg *csg, struct csg_plan *plan, uint32_t first, uint32_t end,
                            struct pending *stack, bool *is_all) {
    uint32_t depth = 0, root = plan->node_count;
    stack[depth++] = (struct pending){CSG_NONE, false};
    for (uint32_t i = end; i-- > first;) {
        struct pending p = stack[--depth];
        enum csg_operation operation = csg->program[i].operation;
        if (operation == CSG_INVERSE) {
            stack[depth++] = (struct pending){p.parent, !p.negated};
            continue;
        }
        /* De Morgan: under a negation, unions are intersections. A node of the kind of its parent is merged into it. */
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
    return root;
}

/* The truth of all nodes while the line is outside every leaf, from the bottom up. */
static void start_truth(const struct csg *csg, struct csg_plan *plan, const bool *is_all) {
    for (uint32_t i = 0; i < plan->node_count; i++)
        if (!is_all[i])
            plan->nodes[i].threshold = 1;
    for (uint32_t i = 0; i < csg->leaf_count; i++)
        if (plan->literals[i].parent != CSG_NONE)
            plan->start_counts[plan->literals[i].parent] += plan->literals[i].negated;
    for (uint32_t i = plan->node_count; i-- > 0;) {
        bool truth = plan->start_counts[i] >= plan->nodes[i].threshold;
        if (plan->nodes[i].parent != CSG_NONE)
            plan->start_counts[plan->nodes[i].parent] += truth;
        else if (i == plan->clip_root)
            plan->starts_shown = truth;
        else
            plan->starts_in = truth;
    }
    if (plan->clip_root == CSG_NONE)
        plan->starts_shown = true;
}

/* ---- boxes ---- */

static struct box box_all(void) {
    return (struct box){vec3_all(-INFINITY), vec3_all(INFINITY)};
}

/* Empty boxes in the form that adds nothing to a join. */
static struct box box_tidy(struct box b) {
    return box_is_empty(&b) ? box_empty() : b;
}

/* The box around a - b. */
static struct box box_less(struct box a, struct box b) {
    double lo[3] = {a.min.x, a.min.y, a.min.z}, hi[3] = {a.max.x, a.max.y, a.max.z};
    const double cut_lo[3] = {b.min.x, b.min.y, b.min.z}, cut_hi[3] = {b.max.x, b.max.y, b.max.z};
    int open = 0, axis = 0;
    for (int i = 0; i < 3; i++)
        if (cut_lo[i] > lo[i] || cut_hi[i] < hi[i]) {
            axis = i;
            open++;
        }
    if (open == 0)
        return box_empty();
    if (open > 1 || cut_hi[axis] <= lo[axis] || cut_lo[axis] >= hi[axis])
        return a;
    if (cut_lo[axis] <= lo[axis])
        lo[axis] = cut_hi[axis];
    else if (cut_hi[axis] >= hi[axis])
        hi[axis] = cut_lo[axis];
    return (struct box){{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

/* The box of a node while it is worked out. */
struct open_box {
    struct box decided;  /* the common part of the children whose start truth decides the node's */
    struct box joined;   /* around all children */
    bool decides;        /* there are deciding children */
    uint32_t first_trim; /* leaves that may take something off the end */
};

static void add_child_box(struct open_box *parent, bool decides, struct box box) {
    parent->joined = box_join(parent->joined, box);
    if (decides)
        parent->decided = box_tidy(box_meet(parent->decided, box));
    parent->decides = parent->decides || decides;
}

/* Where the truth of each node may differ from that at the start, bottom up; then what of it the nodes above leave, top
 * down; then the same for the leaves, in plan->boxes, which come in as the leaves' own. */
static void narrow_boxes(struct csg *csg, struct csg_plan *plan, const bool *is_all, struct open_box *open_boxes,
                         uint32_t *trims) {
    for (uint32_t i = 0; i < plan->node_count; i++)
        open_boxes[i] = (struct open_box){.decided = box_all(), .joined = box_empty(), .first_trim = CSG_NONE};
    for (uint32_t i = csg->leaf_count; i-- > 0;) {
        const struct csg_literal *literal = &plan->literals[i];
        if (literal->parent == CSG_NONE)
            continue;
        struct open_box *parent = &open_boxes[literal->parent];
        bool decides = literal->negated != is_all[literal->parent];
        add_child_box(parent, decides, plan->boxes[i]);
        trims[i] = parent->first_trim;
        if (!decides)
            parent->first_trim = i;
    }
    for (uint32_t i = plan->node_count; i-- > 0;) {
        struct open_box *own = &open_boxes[i];
        struct box box = own->decides ? own->decided : own->joined, inner;
        for (uint32_t leaf = own->first_trim; own->decides && leaf != CSG_NONE; leaf = trims[leaf])
            if (shape_inner_box(&csg->leaves[leaf].shape, &csg->leaves[leaf].csg_from_leaf.forward, &inner) &&
                !box_is_empty(&box))
                box = box_less(box, inner);
        own->decided = box = box_tidy(box);
        uint32_t parent = plan->nodes[i].parent;
        bool truth = plan->start_counts[i] >= plan->nodes[i].threshold;
        if (parent != CSG_NONE)
            add_child_box(&open_boxes[parent], truth != is_all[parent], box);
    }
    /* The surface is where both the solid may change and the clip may be true. */
    struct box solid = csg->open ? plan->boxes[csg->program[0].leaf] : open_boxes[0].decided;
    csg->bounds = solid;
    if (csg->clipped && !plan->starts_shown)
        csg->bounds = box_tidy(box_meet(solid, open_boxes[plan->clip_root].decided));
    for (uint32_t i = 0; i < plan->node_count; i++) {
        uint32_t parent = plan->nodes[i].parent;
        open_boxes[i].decided =
            box_meet(open_boxes[i].decided, parent == CSG_NONE ? csg->bounds : open_boxes[parent].decided);
    }
    for (uint32_t i = 0; i < csg->leaf_count; i++) {
        uint32_t parent = plan->literals[i].parent;
        plan->boxes[i] =
            box_tidy(box_meet(plan->boxes[i], parent == CSG_NONE ? csg->bounds : open_boxes[parent].decided));
    }
}

static double box_middle(const struct box *b, int axis) {
    double middle = vec3_get(b->min, axis) / 2 + vec3_get(b->max, axis) / 2;
    return isfinite(middle) ? middle : 0;
}

/* Quickselect (Hoare, "Algorithm 65: Find", 1961): afterwards the k-th leaf by its middle is at k, lesser ones before
 * it, greater ones behind it. Equal middles go by index, so the order is total. */
static void select_middle(const struct csg_plan *plan, uint32_t *order, uint32_t count, uint32_t k, int axis) {
    uint32_t lo = 0, hi = count - 1;
    while (lo < hi) {
        uint32_t pivot = order[lo + (hi - lo) / 2], i = lo, j = hi;
        /* Equal middles are ordered by their numbers, so that the result is the same everywhere. */
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
static void build_bounds(struct csg_plan *plan, uint32_t first, uint32_t count, uint32_t max) {
    struct csg_bound *bound = &plan->bounds[plan->bound_count++];
    *bound = (struct csg_bound){.box = box_empty(), .first = first};
    struct box middles = box_empty();
    for (uint32_t i = first; i < first + count; i++) {
        const struct box *b = &plan->boxes[plan->order[i]];
        bound->box = box_join(bound->box, *b);
        middles = box_add_point(middles, vec3_make(box_middle(b, 0), box_middle(b, 1), box_middle(b, 2)));
    }
    if (count <= max) {
        bound->count = count;
    } else {
        struct vec3 size = vec3_sub(middles.max, middles.min);
        int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        uint32_t half = count / 2;
        select_middle(plan, plan->order + first, count, half, axis);
        build_bounds(plan, first, half, max);
        build_bounds(plan, first + half, count - half, max);
    }
    bound->skip = plan->bound_count;
}

/* Half the surface of a box: the share of lines through a box that meet another one inside it goes with it. */
static double half_surface(const struct box *b) {
    struct vec3 d = vec3_sub(b->max, b->min);
    return box_is_empty(b) ? 0 : d.x * d.y + d.y * d.z + d.z * d.x;
}

/* Not tried: the root, bounds of a single leaf, whose own box is tried, and bounds nearly as large as the ones around
 * them. */
static void choose_probes(struct csg_plan *plan) {
    plan->bounds[0].unprobed = true;
    for (uint32_t b = 0; b < plan->bound_count; b++) {
        const struct csg_bound *bound = &plan->bounds[b];
        for (uint32_t child = b + 1; child < bound->skip; child = plan->bounds[child].skip)
            plan->bounds[child].unprobed = plan->bounds[child].count == 1 ||
                                           half_surface(&plan->bounds[child].box) >= 0.9 * half_surface(&bound->box);
    }
}

/* Leaves that a ray is tested with first: the solid is a part of each of them. Cheap ones before lists, small ones
 * before large ones. */
static bool needed_before(const struct csg *csg, const struct csg_plan *plan, uint32_t a, uint32_t b) {
    bool a_listed = shape_is_listed(&csg->leaves[a].shape), b_listed = shape_is_listed(&csg->leaves[b].shape);
    if (a_listed != b_listed)
        return b_listed;
    return half_surface(&plan->own_boxes[a]) < half_surface(&plan->own_boxes[b]);
}

static void choose_needed(struct csg *csg, struct csg_plan *plan, const bool *is_all) {
    bool *convexity = plan->is_convex;
    csg->convexity = convexity;
    if (csg->open || !is_all[0])
        return;
    for (uint32_t i = 0; i < csg->leaf_count; i++) {
        if (plan->literals[i].parent != 0 || plan->literals[i].negated)
            continue;
        uint32_t at = plan->needed_count++;
        for (; at > 0 && needed_before(csg, plan, i, plan->needed[at - 1]); at--)
            plan->needed[at] = plan->needed[at - 1];
        plan->needed[at] = i;
        plan->is_needed[i] = true;
        convexity[i] = shape_convexity(&csg->leaves[i].shape) == CONVEXITY_BEHIND;
    }
}

/* Everything that needs memory only while building. */
static bool fill_plan(struct csg *csg, struct csg_plan *plan, struct error *error) {
    uint32_t length = csg->program_length, leaf_count = csg->leaf_count;
    bool *flags = mem_alloc_zero(length, sizeof *flags);
    struct open_box *open_boxes = mem_alloc_zero(leaf_count, sizeof *open_boxes);
    uint32_t *trims = mem_alloc_zero(leaf_count, sizeof *trims);
    struct pending *pending = mem_alloc_zero(length + 1, sizeof *pending);
    bool ok = flags && open_boxes && trims && pending;
    if (!ok)
        error_no_memory(error, "CSG");
    else if (!program_is_well_formed(csg, flags, &csg->stack_depth))
        ok = error_set(error, ERROR_SCENE, "CSG: malformed program");
    if (ok) {
        uint64_t crossings = 0;
        for (uint32_t i = 0; i < leaf_count; i++) {
            const struct csg_leaf *leaf = &csg->leaves[i];
            struct box b = box_pad(shape_bounds_under(&leaf->shape, &leaf->csg_from_leaf.forward));
            if (leaf->limit)
                b = box_meet(b, box_pad(*leaf->limit));
            plan->as_it_is[i] = is_identity(&leaf->csg_from_leaf);
            plan->own_boxes[i] = plan->boxes[i] = b = box_tidy(b);
            plan->order[i] = i;
            crossings += shape_scratch_need(&leaf->shape);
            double extent = box_is_empty(&b) ? 0 : math_max(vec3_max_abs(b.min), vec3_max_abs(b.max));
            if (isfinite(extent)) /* solids without end have no size */
                plan->size = math_max(plan->size, extent);
        }
        for (uint32_t i = 0; i < length; i++)
            flags[i] = false;
        const struct csg_leaf *only = csg->solid_length == 1 ? &csg->leaves[csg->program[0].leaf] : NULL;
        csg->open = only && !shape_is_closed(&only->shape);
        if (csg->open)
            plan->literals[csg->program[0].leaf] = (struct csg_literal){CSG_NONE, false};
        else
            (void)build_nodes(csg, plan, 0, csg->solid_length, pending, flags);
        plan->clip_root = csg->clipped ? build_nodes(csg, plan, csg->solid_length, length, pending, flags) : CSG_NONE;
        start_truth(csg, plan, flags);
        csg->inside_out = plan->starts_in;
        narrow_boxes(csg, plan, flags, open_boxes, trims);
        build_bounds(plan, 0, leaf_count, leaf_count <= FEW_LEAVES ? FEW_LEAVES : LEAVES_PER_BOUND);
        choose_probes(plan);
        choose_needed(csg, plan, flags);

        /* The truth of nodes and leaves, or the stack of csg_contains in bits, and all crossings above it. */
        uint64_t words = plan->node_count + (leaf_count + 31) / 32;
        plan->state_items =
            (uint32_t)((words * sizeof(uint32_t) + sizeof(struct crossing) - 1) / sizeof(struct crossing));
        crossings += plan->state_items + 2; /* and where a solid without end begins and ends */
        csg->max_crossings = crossings < UINT32_MAX / 4 ? (uint32_t)crossings : UINT32_MAX / 4;
    }
    mem_free(pending);
    mem_free(trims);
    mem_free(open_boxes);
    mem_free(flags);
    return ok;
}

const struct csg *csg_build(struct arena *arena, const struct csg_leaf *leaves, uint32_t leaf_count,
                            const struct csg_token *program, uint32_t program_length, struct error *error) {
    return csg_build_clipped(arena, &(struct csg_program){leaves, leaf_count, program, program_length}, program_length,
                             error);
}

const struct csg *csg_build_clipped(struct arena *arena, const struct csg_program *program, uint32_t solid_length,
                                    struct error *error) {
    uint32_t leaf_count = program->leaf_count, program_length = program->length;
    if (leaf_count > 65535) {
        error_set(error, ERROR_SCENE, "CSG: %u operands, more than 65535", leaf_count);
        return NULL;
    }
    /* n leaves, n - 1 operations (or n - 2 and a clip), inverses of each of them; this also bounds what is allocated */
    bool clipped = solid_length < program_length;
    uint32_t min = 2 * leaf_count - (clipped ? 2 : 1);
    if (leaf_count == 0 || solid_length == 0 || program_length < min || program_length > 2 * min) {
        error_set(error, ERROR_SCENE, "CSG: malformed program");
        return NULL;
    }
    struct csg *csg = arena_alloc(arena, sizeof *csg);
    struct csg_plan *plan = arena_alloc(arena, sizeof *plan);
    struct csg_leaf *own_leaves = arena_alloc_array(arena, leaf_count, sizeof *own_leaves);
    struct csg_token *own_program = arena_alloc_array(arena, program_length, sizeof *own_program);
    bool ok = csg && plan && own_leaves && own_program;
    if (ok) {
        plan->leaf_count = leaf_count;
        plan->nodes =
            arena_alloc_array(arena, leaf_count, sizeof *plan->nodes); /* at least two children each, or one */
        plan->start_counts = arena_alloc_array(arena, leaf_count, sizeof *plan->start_counts);
        plan->literals = arena_alloc_array(arena, leaf_count, sizeof *plan->literals);
        plan->boxes = arena_alloc_array(arena, leaf_count, sizeof *plan->boxes);
        plan->own_boxes = arena_alloc_array(arena, leaf_count, sizeof *plan->own_boxes);
        plan->order = arena_alloc_array(arena, leaf_count, sizeof *plan->order);
        plan->bounds =
            arena_alloc_array(arena, leaf_count, sizeof *plan->bounds); /* at least two leaves each, or one */
        plan->as_it_is = arena_alloc_array(arena, leaf_count, sizeof *plan->as_it_is);
        plan->needed = arena_alloc_array(arena, leaf_count, sizeof *plan->needed);
        plan->is_needed = arena_alloc_array(arena, leaf_count, sizeof *plan->is_needed);
        plan->is_convex = arena_alloc_array(arena, leaf_count, sizeof *plan->is_convex);
        ok = plan->nodes && plan->start_counts && plan->literals && plan->boxes && plan->own_boxes && plan->order &&
             plan->bounds && plan->as_it_is && plan->needed && plan->is_needed && plan->is_convex;
    }
    if (!ok) {
        error_no_memory(error, "CSG");
        return NULL;
    }
    for (uint32_t i = 0; i < leaf_count; i++) {
        own_leaves[i] = program->leaves[i];
    }
    for (uint32_t i = 0; i < program_length; i++)
        own_program[i] = program->tokens[i];
    csg->leaves = own_leaves;
    csg->leaf_count = leaf_count;
    csg->program = own_program;
    csg->program_length = program_length;
    csg->solid_length = solid_length;
    csg->clipped = clipped;
    csg->plan = plan;
    return fill_plan(csg, plan, error) ? csg : NULL;
}
