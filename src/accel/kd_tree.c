/* Building the kd-tree. Three lists of events, one for each axis, are sorted once; every split reads them in order and
 * passes them on in order, so that only the few events of items cut by the plane are sorted again.
 *
 * Invariant: at a node each of its items has, on every axis, either one PLANAR event or an END and a START, at the ends
 * of the box of its part inside the node's cell; each list is ordered by position, then END before PLANAR before START,
 * then item. A plane at p leaves END <= p to the lower side and START >= p to the upper one.
 *
 * Costs: a step from node to node is 1, a test of an item 1.5; a split that cuts off empty space is a fifth cheaper, as
 * in the paper. There is no minimal number of items: a node becomes a leaf if no plane reduces the cost. */
#include "accel/kd_tree.h"

#include "base/mem.h"

#include <string.h>

enum { EVENT_END, EVENT_PLANAR, EVENT_START };
enum { SIDE_BOTH, SIDE_LOWER, SIDE_UPPER };
enum { ENTRIES_PER_ITEM = 16 }; /* beyond so many list entries (and a few) no plane cuts items any more */

#define COST_STEP 1.0
#define COST_TEST 1.5
#define EMPTY_BONUS 0.8
#define LARGEST 0x1p500 /* boxes beyond are treated as infinite: areas must not overflow */

struct event {
    double position;
    uint32_t item, kind;
};

struct event_list {
    struct event *events;
    size_t count;
};

struct builder {
    struct kd_tree *tree;
    kd_clip *clip;
    const void *context;
    const struct box *boxes;
    const struct pool *pool;
    struct error *error;
    uint8_t *side; /* of each item, while a node is split */
    uint32_t node_capacity, entry_capacity;
    int depth_limit;
};

/* The state of a recursion step. It owns the lists. */
struct cell {
    struct box box;
    struct event_list lists[3];
    uint32_t items;
    uint64_t spare; /* list entries that cutting may add below here */
};

static void cell_free(struct cell *cell) {
    for (int axis = 0; axis < 3; axis++) {
        mem_free(cell->lists[axis].events);
        cell->lists[axis] = (struct event_list){0};
    }
}

static bool no_memory(struct builder *b) {
    return error_no_memory(b->error, "a kd-tree");
}

/* --- events --- */

static bool comes_before(const struct event *a, const struct event *b) {
    if (a->position != b->position)
        return a->position < b->position;
    return a->kind != b->kind ? a->kind < b->kind : a->item < b->item;
}

static void merge(const struct event *a, size_t a_count, const struct event *b, size_t b_count, struct event *out) {
    while (a_count > 0 && b_count > 0) {
        if (comes_before(b, a)) {
            *out++ = *b++;
            b_count--;
        } else {
            *out++ = *a++;
            a_count--;
        }
    }
    if (a_count > 0)
        memcpy(out, a, a_count * sizeof *out);
    if (b_count > 0)
        memcpy(out, b, b_count * sizeof *out);
}

/* Bottom up; `spare` has room for as many. */
static void sort_events(struct event *events, struct event *spare, size_t count) {
    struct event *from = events, *to = spare;
    for (size_t run = 1; run < count; run *= 2) {
        for (size_t i = 0; i < count; i += 2 * run) {
            size_t left = count - i < run ? count - i : run, right = count - i - left < run ? count - i - left : run;
            merge(from + i, left, from + i + left, right, to + i);
        }
        struct event *swap = from;
        from = to;
        to = swap;
    }
    if (from != events)
        memcpy(events, from, count * sizeof *events);
}

static void add_events(struct event_list lists[3], uint32_t item, const struct box *box) {
    for (int axis = 0; axis < 3; axis++) {
        struct event_list *list = &lists[axis];
        double lo = vec3_get(box->min, axis), hi = vec3_get(box->max, axis);
        if (lo == hi) {
            list->events[list->count++] = (struct event){lo, item, EVENT_PLANAR};
        } else {
            list->events[list->count++] = (struct event){lo, item, EVENT_START};
            list->events[list->count++] = (struct event){hi, item, EVENT_END};
        }
    }
}

static bool lists_make(struct event_list lists[3], size_t items) {
    bool ok = true;
    for (int axis = 0; axis < 3; axis++) {
        lists[axis] = (struct event_list){mem_resize_array(NULL, 2 * items, sizeof *lists->events), 0};
        ok = ok && lists[axis].events;
    }
    return ok;
}

static bool lists_sort(struct event_list lists[3]) {
    size_t max = 0;
    for (int axis = 0; axis < 3; axis++)
        max = lists[axis].count > max ? lists[axis].count : max;
    struct event *spare = mem_resize_array(NULL, max, sizeof *spare);
    for (int axis = 0; axis < 3 && spare; axis++)
        sort_events(lists[axis].events, spare, lists[axis].count);
    mem_free(spare);
    return spare != NULL;
}

/* --- the best plane --- */

struct plane {
    int axis; /* -1: none is better than a leaf */
    double position, cost;
    bool planar_lower; /* items in the plane itself go to the lower side */
};

static double half_area(struct vec3 size) {
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

static void set3(struct vec3 *v, int axis, double value) {
    double *component = axis == 0 ? &v->x : axis == 1 ? &v->y : &v->z;
    *component = value;
}

static double split_cost(double share_lower, double share_upper, uint32_t lower, uint32_t upper) {
    double cost = COST_STEP + COST_TEST * (share_lower * lower + share_upper * upper);
    return lower == 0 || upper == 0 ? EMPTY_BONUS * cost : cost;
}

static void best_of_axis(const struct cell *cell, int axis, struct plane *best) {
    const struct event_list *list = &cell->lists[axis];
    struct vec3 size = vec3_sub(cell->box.max, cell->box.min);
    double lo = vec3_get(cell->box.min, axis), hi = vec3_get(cell->box.max, axis), whole = half_area(size);
    uint32_t lower = 0, upper = cell->items;
    if (!(whole > 0))
        return;
    for (size_t i = 0; i < list->count;) {
        /* All events at one position belong to one plane. */
        double p = list->events[i].position;
        uint32_t counts[3] = {0, 0, 0};
        for (; i < list->count && list->events[i].position == p; i++)
            counts[list->events[i].kind]++;
        uint32_t planar = counts[EVENT_PLANAR];
        upper -= planar + counts[EVENT_END];
        /* Items in the plane go to the cheaper side. */
        if (p > lo && p < hi) {
            set3(&size, axis, p - lo);
            double share_lower = half_area(size) / whole;
            set3(&size, axis, hi - p);
            double share_upper = half_area(size) / whole;
            double cost_lower = split_cost(share_lower, share_upper, lower + planar, upper);
            double cost_upper = split_cost(share_lower, share_upper, lower, upper + planar);
            double cost = cost_lower < cost_upper ? cost_lower : cost_upper;
            if (cost < best->cost)
                *best = (struct plane){axis, p, cost, cost_lower < cost_upper};
        }
        lower += planar + counts[EVENT_START];
    }
}

static struct plane best_plane(const struct cell *cell) {
    struct plane best = {.axis = -1, .cost = COST_TEST * cell->items};
    for (int axis = 0; axis < 3; axis++)
        best_of_axis(cell, axis, &best);
    return best;
}

/* --- splitting --- */

static void classify(struct builder *b, const struct cell *cell, const struct plane *plane, uint32_t counts[3]) {
    const struct event_list *list = &cell->lists[plane->axis];
    for (size_t i = 0; i < list->count; i++)
        b->side[list->events[i].item] = SIDE_BOTH;
    for (size_t i = 0; i < list->count; i++) {
        const struct event *e = &list->events[i];
        if (e->kind == EVENT_END && e->position <= plane->position)
            b->side[e->item] = SIDE_LOWER;
        else if (e->kind == EVENT_START && e->position >= plane->position)
            b->side[e->item] = SIDE_UPPER;
        else if (e->kind == EVENT_PLANAR)
            b->side[e->item] = e->position < plane->position || (e->position == plane->position && plane->planar_lower)
                                   ? SIDE_LOWER
                                   : SIDE_UPPER;
    }
    for (size_t i = 0; i < list->count; i++)
        if (list->events[i].kind != EVENT_END)
            counts[b->side[list->events[i].item]]++;
}

/* The part of an item that the plane cuts, on one side. */
static bool part_of(const struct builder *b, uint32_t item, const struct box *box, struct box *part) {
    if (b->clip)
        return b->clip(b->context, item, box, part);
    *part = box_meet(b->boxes[item], *box);
    return !box_is_empty(part);
}

/* Items completely on one side keep their events, in order; cut items get new ones, which are sorted and merged. */
static bool fill_side(struct builder *b, const struct cell *cell, int own_side, uint32_t whole, uint32_t cut,
                      struct cell *out) {
    struct event_list fresh[3] = {{0}};
    bool ok = lists_make(out->lists, (size_t)whole + cut) && lists_make(fresh, cut);
    out->items = whole;
    /* Events of the cut items, by their boxes inside of this side. */
    for (size_t i = 0; ok && i < cell->lists[0].count; i++) {
        const struct event *e = &cell->lists[0].events[i];
        struct box part;
        if (e->kind == EVENT_END || b->side[e->item] != SIDE_BOTH || !part_of(b, e->item, &out->box, &part))
            continue;
        add_events(fresh, e->item, &part);
        out->items++;
    }
    ok = ok && lists_sort(fresh);
    /* Those that stay are in order already. */
    struct event_list kept = {ok ? mem_resize_array(NULL, 2 * (size_t)whole, sizeof *kept.events) : NULL, 0};
    ok = ok && kept.events;
    for (int axis = 0; ok && axis < 3; axis++) {
        kept.count = 0;
        for (size_t i = 0; i < cell->lists[axis].count; i++)
            if (b->side[cell->lists[axis].events[i].item] == own_side)
                kept.events[kept.count++] = cell->lists[axis].events[i];
        merge(kept.events, kept.count, fresh[axis].events, fresh[axis].count, out->lists[axis].events);
        out->lists[axis].count = kept.count + fresh[axis].count;
    }
    mem_free(kept.events);
    for (int axis = 0; axis < 3; axis++)
        mem_free(fresh[axis].events);
    return ok || no_memory(b);
}

/* --- nodes --- */

static bool add_node(struct builder *b, struct kd_node node) {
    struct kd_tree *tree = b->tree;
    if (tree->node_count == b->node_capacity) {
        uint32_t capacity = b->node_capacity ? b->node_capacity * 2 : 64;
        struct kd_node *nodes =
            capacity > b->node_capacity ? mem_resize_array(tree->nodes, capacity, sizeof *nodes) : NULL;
        if (!nodes)
            return no_memory(b);
        tree->nodes = nodes;
        b->node_capacity = capacity;
    }
    tree->nodes[tree->node_count++] = node;
    return true;
}

static bool add_leaf(struct builder *b, const struct cell *cell) {
    struct kd_tree *tree = b->tree;
    if (b->entry_capacity - tree->entry_count < cell->items) {
        uint64_t capacity = (uint64_t)b->entry_capacity * 2 + cell->items;
        uint32_t *items = capacity < UINT32_MAX ? mem_resize_array(tree->items, capacity, sizeof *items) : NULL;
        if (!items)
            return no_memory(b);
        tree->items = items;
        b->entry_capacity = (uint32_t)capacity;
    }
    struct kd_node leaf = {.count = cell->items, .axis = KD_LEAF, .offset = tree->entry_count};
    for (size_t i = 0; i < cell->lists[0].count; i++)
        if (cell->lists[0].events[i].kind != EVENT_END)
            tree->items[tree->entry_count++] = cell->lists[0].events[i].item;
    return add_node(b, leaf);
}

/* Consumes the cell. As deep as the tree, which is limited. */
static bool build_node(struct builder *b, struct cell *cell, int depth) {
    struct plane plane = {.axis = -1};
    bool is_long = cell->items > 1000 || (b->tree->node_count & 255) == 0;
    bool ok = !is_long || !b->pool || !pool_cancelled(b->pool);
    if (!ok)
        error_set(b->error, ERROR_CANCELLED, "stopped while a kd-tree was built");
    if (ok && depth < b->depth_limit && cell->items > 0)
        plane = best_plane(cell);
    uint32_t counts[3] = {0, 0, 0};
    if (plane.axis >= 0) {
        classify(b, cell, &plane, counts);
        if (counts[SIDE_BOTH] > cell->spare)
            plane.axis = -1;
    }
    if (plane.axis < 0) {
        ok = ok && add_leaf(b, cell);
        cell_free(cell);
        return ok;
    }
    struct cell lower = {.box = cell->box}, upper = {.box = cell->box};
    set3(&lower.box.max, plane.axis, plane.position);
    set3(&upper.box.min, plane.axis, plane.position);
    ok = fill_side(b, cell, SIDE_LOWER, counts[SIDE_LOWER], counts[SIDE_BOTH], &lower) &&
         fill_side(b, cell, SIDE_UPPER, counts[SIDE_UPPER], counts[SIDE_BOTH], &upper);
    cell_free(cell);
    /* The remaining allowance of entries is divided in proportion to the number of items. */
    uint64_t spare = cell->spare - counts[SIDE_BOTH], all = (uint64_t)lower.items + upper.items;
    lower.spare = all > 0 ? (uint64_t)((double)spare * ((double)lower.items / (double)all)) : 0;
    upper.spare = spare - lower.spare;
    uint32_t own = b->tree->node_count;
    ok = ok && add_node(b, (struct kd_node){.split = plane.position, .axis = (uint32_t)plane.axis});
    if (ok) {
        ok = build_node(b, &lower, depth + 1);
        b->tree->nodes[own].offset = b->tree->node_count;
    } else {
        cell_free(&lower);
    }
    if (ok)
        return build_node(b, &upper, depth + 1);
    cell_free(&upper);
    return false;
}

/* --- the whole --- */

static bool is_bounded(const struct box *b) {
    return vec3_max_abs(b->min) <= LARGEST && vec3_max_abs(b->max) <= LARGEST;
}

/* The number of levels of a balanced tree with this many items, and half as many again for uneven trees. */
static int depth_for(uint32_t items) {
    int levels = 0;
    for (; items > 0; items /= 2)
        levels++;
    int depth = 8 + levels + levels / 2;
    return depth < KD_DEPTH ? depth : KD_DEPTH;
}

static bool make_root(struct builder *b, uint32_t count, struct cell *root) {
    struct kd_tree *tree = b->tree;
    for (uint32_t i = 0; i < count; i++) {
        const struct box *box = &b->boxes[i];
        if (box_is_empty(box))
            continue;
        if (is_bounded(box)) {
            tree->bounds = box_join(tree->bounds, *box);
            root->items++;
        } else {
            tree->unbounded_count++;
        }
    }
    /* Infinite items are tested by every ray. */
    tree->unbounded = mem_resize_array(NULL, tree->unbounded_count, sizeof *tree->unbounded);
    if (!lists_make(root->lists, root->items) || !tree->unbounded)
        return false;
    tree->unbounded_count = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (box_is_empty(&b->boxes[i]))
            continue;
        if (is_bounded(&b->boxes[i]))
            add_events(root->lists, i, &b->boxes[i]);
        else
            tree->unbounded[tree->unbounded_count++] = i;
    }
    root->box = tree->bounds;
    return lists_sort(root->lists);
}

bool kd_tree_build(struct kd_tree *tree, const struct kd_items *items, const struct pool *pool, struct error *error) {
    uint32_t count = items->count;
    *tree = (struct kd_tree){.bounds = box_empty()};
    struct builder b = {.tree = tree,
                        .clip = items->clip,
                        .context = items->context,
                        .boxes = items->boxes,
                        .pool = pool,
                        .error = error,
                        .side = mem_alloc_zero(count, 1),
                        .depth_limit = depth_for(count)};
    struct cell root = {.box = box_empty(), .spare = (uint64_t)count * ENTRIES_PER_ITEM + 4096};
    /* build_node frees the cell. */
    bool ok = b.side && make_root(&b, count, &root);
    if (!ok) {
        no_memory(&b);
        cell_free(&root);
    } else if (root.items > 0) {
        ok = build_node(&b, &root, 0);
    } else {
        cell_free(&root);
    }
    mem_free(b.side);
    if (!ok)
        kd_tree_destroy(tree);
    return ok;
}

void kd_tree_destroy(struct kd_tree *tree) {
    mem_free(tree->nodes);
    mem_free(tree->items);
    mem_free(tree->unbounded);
    *tree = (struct kd_tree){.bounds = box_empty()};
}

size_t kd_tree_memory(const struct kd_tree *tree) {
    return tree->node_count * sizeof *tree->nodes +
           ((size_t)tree->entry_count + tree->unbounded_count) * sizeof *tree->items;
}

/* --- traversal --- */

/* Traversal of the kd-tree with a stack. The plane of a node is crossed at t = (split - origin) / direction, which is
 * wrong by less than 2^-50 of itself; and a point of the ray may be off the item it belongs to by the caller's slack,
 * which is slack / |direction| along the ray. Both sides of a plane therefore get the interval up to t plus, and from t
 * minus, these two: they overlap, nothing is lost between them, and if a ray lies in a plane, both sides are
 * visited. */

static void push(struct kd_traversal *traversal, uint32_t node, double enter, double leave) {
    traversal->stack[traversal->top++] = (struct kd_pending){enter, leave, node};
}

/* The part of the ray's interval in which it may be within slack of the bounds. */
static bool clip_to_bounds(const struct kd_traversal *traversal, double *enter, double *leave) {
    const struct box *bounds = &traversal->tree->bounds;
    for (int axis = 0; axis < 3; axis++) {
        double lo = vec3_get(bounds->min, axis) - traversal->origin[axis];
        double hi = vec3_get(bounds->max, axis) - traversal->origin[axis];
        if (!isfinite(traversal->inverse[axis])) {
            if (traversal->direction[axis] == 0 && (lo > traversal->slack || hi < -traversal->slack))
                return false;
            continue;
        }
        double a = (traversal->direction[axis] > 0 ? lo : hi) * traversal->inverse[axis];
        double b = (traversal->direction[axis] > 0 ? hi : lo) * traversal->inverse[axis];
        a -= fabs(a) * 0x1p-50 + traversal->widen[axis];
        b += fabs(b) * 0x1p-50 + traversal->widen[axis];
        *enter = a > *enter ? a : *enter;
        *leave = b < *leave ? b : *leave;
    }
    return *enter <= *leave;
}

void kd_traversal_begin(struct kd_traversal *traversal, const struct kd_tree *tree, const struct ray *ray,
                        double slack) {
    traversal->tree = tree;
    traversal->slack = slack;
    traversal->steps = traversal->leaves = 0;
    traversal->top = 0;
    traversal->unbounded_next = tree->unbounded_count > 0;
    for (int axis = 0; axis < 3; axis++) {
        traversal->origin[axis] = vec3_get(ray->origin, axis);
        traversal->direction[axis] = vec3_get(ray->direction, axis);
        traversal->inverse[axis] = 1 / traversal->direction[axis];
        traversal->widen[axis] = slack > 0 ? slack * fabs(traversal->inverse[axis]) : 0;
    }
    double enter = ray->t_min, leave = ray->t_max;
    if (tree->node_count > 0 && clip_to_bounds(traversal, &enter, &leave))
        push(traversal, 0, enter, leave);
}

/* Descends from a node to a leaf; farther children wait on the stack. */
static const struct kd_node *descend(struct kd_traversal *traversal, struct kd_pending at) {
    const struct kd_node *nodes = traversal->tree->nodes, *node = &nodes[at.node];
    while (node->axis != KD_LEAF) {
        uint32_t axis = node->axis, lower = at.node + 1, upper = node->offset;
        double from_origin = node->split - traversal->origin[axis];
        traversal->steps++;
        if (!isfinite(traversal->inverse[axis])) { /* along the plane */
            bool below = from_origin > traversal->slack, above = from_origin < -traversal->slack;
            if (traversal->direction[axis] != 0 || (!below && !above)) {
                push(traversal, upper, at.enter, at.leave);
                above = false;
            }
            at.node = above ? upper : lower;
        } else {
            double t = from_origin * traversal->inverse[axis], widen = fabs(t) * 0x1p-50 + traversal->widen[axis];
            bool forward = traversal->direction[axis] > 0;
            uint32_t first = forward ? lower : upper, second = forward ? upper : lower;
            if (t - widen > at.leave) {
                at.node = first;
            } else if (t + widen < at.enter) {
                at.node = second;
            } else {
                push(traversal, second, t - widen > at.enter ? t - widen : at.enter, at.leave);
                at.node = first;
                at.leave = t + widen < at.leave ? t + widen : at.leave;
            }
        }
        node = &nodes[at.node];
    }
    return node;
}

bool kd_traversal_next(struct kd_traversal *traversal, double t_max) {
    if (traversal->unbounded_next) {
        traversal->unbounded_next = false;
        traversal->items = traversal->tree->unbounded;
        traversal->count = traversal->tree->unbounded_count;
        return true;
    }
    while (traversal->top > 0) {
        struct kd_pending at = traversal->stack[--traversal->top];
        if (at.enter > t_max)
            continue;
        const struct kd_node *leaf = descend(traversal, at);
        traversal->leaves++;
        if (leaf->count == 0)
            continue;
        traversal->items = traversal->tree->items + leaf->offset;
        traversal->count = (uint32_t)leaf->count;
        return true;
    }
    return false;
}

void kd_tree_bundle(struct bundle *bundle, void *kd_tree) {
    struct kd_tree *tree = kd_tree;
    BUNDLE(bundle, tree->nodes, tree->node_count, NULL);
    BUNDLE(bundle, tree->items, tree->entry_count, NULL);
    BUNDLE(bundle, tree->unbounded, tree->unbounded_count, NULL);
}
