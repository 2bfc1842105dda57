/* Building and traversing the hierarchy over boxes. Rounding: with t = (plane - origin) * inverse, each t is wrong by a
 * few units in its last place, so the far ends are moved outwards by 2^-50 of themselves before they are compared (Ize,
 * "Robust BVH Ray Traversal", JCGT 2013). A direction component of zero makes its slab's t infinite on the right side,
 * or NaN when the ray lies in the very plane, which every comparison here ignores. */
#include "accel/box_tree.h"

#include "base/mem.h"

#include <string.h>

/* --- building --- */

enum { BINS = 16 };

struct build_item {
    struct box box;
    uint32_t item;
};

struct builder {
    struct build_item *items;
    struct pool *pool;
};

/* A run of items that will become a child. */
struct run {
    uint32_t first, count;
    struct box box;
};

static double half_area(const struct box *b) {
    struct vec3 d = vec3_sub(b->max, b->min);
    return d.x * d.y + d.y * d.z + d.z * d.x;
}

static struct box run_box(const struct builder *b, uint32_t first, uint32_t count) {
    struct box box = box_empty();
    for (uint32_t i = 0; i < count; i++)
        box = box_join(box, b->items[first + i].box);
    return box;
}

/* The position of an item for splits. Infinite boxes have no centre; a finite value replaces it. */
static double middle(double lo, double hi) {
    if (isfinite(lo) && isfinite(hi))
        return lo + (hi - lo) * 0.5;
    return isfinite(lo) ? lo : isfinite(hi) ? hi : 0;
}

static double centre_of(const struct build_item *item, int axis) {
    return middle(vec3_get(item->box.min, axis), vec3_get(item->box.max, axis));
}

static int bin_of(double centre, double lo, double scale, int bins) {
    int bin = (int)((centre - lo) * scale);
    return bin < 0 ? 0 : bin >= bins ? bins - 1 : bin;
}

/* Most runs are small: they get as many bins as they can use. */
static int bins_for(uint32_t items) {
    return items >= BINS ? BINS : items > 4 ? 8 : 4;
}

struct split {
    int axis, bin, bins; /* axis -1: none found */
    double lo, scale, cost;
    struct box sides[2];
};

/* The contents of the bins of one axis. */
struct bins {
    double lo, scale; /* scale 0: the axis cannot be split */
    int number;
    struct box boxes[BINS];
    uint32_t counts[BINS];
};

static void clear_bins(struct bins *bins, double lo, double hi, int number) {
    bins->lo = lo;
    bins->number = number;
    bins->scale = hi > lo ? number / (hi - lo) : 0;
    if (!isfinite(bins->scale))
        bins->scale = 0;
    for (int i = 0; i < number; i++) {
        bins->boxes[i] = box_empty();
        bins->counts[i] = 0;
    }
}

/* Every item is read twice, for any number of axes: for the box of the centres, and to fill the bins. */
static void fill_bins(const struct builder *b, const struct run *run, struct bins bins[3]) {
    const struct build_item *items = b->items + run->first;
    struct box centres = box_empty();
    for (uint32_t i = 0; i < run->count; i++)
        centres = box_add_point(centres,
                                vec3_make(centre_of(&items[i], 0), centre_of(&items[i], 1), centre_of(&items[i], 2)));
    for (int axis = 0; axis < 3; axis++)
        clear_bins(&bins[axis], vec3_get(centres.min, axis), vec3_get(centres.max, axis), bins_for(run->count));
    for (uint32_t i = 0; i < run->count; i++) {
        for (int axis = 0; axis < 3; axis++) {
            if (bins[axis].scale == 0)
                continue;
            int bin = bin_of(centre_of(&items[i], axis), bins[axis].lo, bins[axis].scale, bins[axis].number);
            bins[axis].boxes[bin] = box_join(bins[axis].boxes[bin], items[i].box);
            bins[axis].counts[bin]++;
        }
    }
}

/* The cost of this many items for a ray that meets their box: nodes of four children, the last perhaps half full. */
static double cost_of(uint32_t items) {
    return (items + 3) / 4;
}

static void best_of_axis(const struct bins *bins, int axis, uint32_t all, struct split *best) {
    struct box behind[BINS];
    double right_cost[BINS];
    struct box side = box_empty();
    uint32_t count = 0;
    for (int i = bins->number - 1; i > 0; i--) {
        side = box_join(side, bins->boxes[i]);
        count += bins->counts[i];
        behind[i] = side;
        right_cost[i] = count ? half_area(&side) * cost_of(count) : 0;
    }
    side = box_empty();
    count = 0;
    for (int i = 0; i < bins->number - 1; i++) {
        side = box_join(side, bins->boxes[i]);
        count += bins->counts[i];
        if (count == 0 || count == all)
            continue;
        double cost = half_area(&side) * cost_of(count) + right_cost[i + 1];
        /* An infinite area compares equal to itself: the first split is then as good as any. */
        if (cost < best->cost || best->axis < 0)
            *best = (struct split){axis, i, bins->number, bins->lo, bins->scale, cost, {side, behind[i + 1]}};
    }
}

static struct split best_split(const struct builder *b, const struct run *run) {
    struct bins bins[3];
    struct split best = {.axis = -1, .cost = INFINITY};
    fill_bins(b, run, bins);
    for (int axis = 0; axis < 3; axis++) {
        if (bins[axis].scale > 0)
            best_of_axis(&bins[axis], axis, run->count, &best);
    }
    return best;
}

/* By exchange, in place: the order depends only on the boxes, not on addresses or time. */
static uint32_t partition(struct builder *b, const struct run *run, const struct split *split) {
    struct build_item *items = b->items + run->first;
    uint32_t left = 0, end = run->count;
    while (left < end) {
        int bin = bin_of(centre_of(&items[left], split->axis), split->lo, split->scale, split->bins);
        if (bin <= split->bin) {
            left++;
            continue;
        }
        struct build_item moved = items[left];
        items[left] = items[--end];
        items[end] = moved;
    }
    return left;
}

static void split_run(struct builder *b, const struct run *run, bool halve, struct run out[2]) {
    struct split split = {.axis = -1};
    if (run->count > 2 && !halve)
        split = best_split(b, run);
    if (split.axis >= 0) {
        uint32_t left = partition(b, run, &split);
        out[0] = (struct run){run->first, left, split.sides[0]};
        out[1] = (struct run){run->first + left, run->count - left, split.sides[1]};
        return;
    }
    uint32_t left = run->count / 2; /* all centres at one point: halves by order */
    out[0] = (struct run){run->first, left, run_box(b, run->first, left)};
    out[1] = (struct run){run->first + left, run->count - left, run_box(b, run->first + left, run->count - left)};
}

/* The run to split next, or -1. A run of up to four items is a node of its own, full or nearly, and cheaper to visit
 * than its halves would be: it is split only where all of its items find room here. */
static int next_to_split(const struct run *runs, int count, bool halve) {
    int best = -1;
    bool best_large = false;
    for (int i = 0; i < count; i++) {
        bool large = runs[i].count > BOX_TREE_WIDTH;
        if (runs[i].count <= 1 || (!large && (int)runs[i].count - 1 > BOX_TREE_WIDTH - count))
            continue;
        bool larger = halve ? best >= 0 && runs[i].count > runs[best].count
                            : best >= 0 && half_area(&runs[i].box) > half_area(&runs[best].box);
        if (best < 0 || (large && !best_large) || (large == best_large && larger)) {
            best = i;
            best_large = large;
        }
    }
    return best;
}

/* Up to four children. */
static int children_of(struct builder *b, const struct run *run, bool halve, struct run out[BOX_TREE_WIDTH]) {
    int count = 1;
    out[0] = *run;
    while (count < BOX_TREE_WIDTH) {
        int widest = next_to_split(out, count, halve);
        if (widest < 0)
            break;
        struct run halves[2];
        split_run(b, &out[widest], halve, halves);
        memmove(out + widest + 2, out + widest + 1, (size_t)(count - widest - 1) * sizeof *out);
        out[widest] = halves[0];
        out[widest + 1] = halves[1];
        count++;
    }
    return count;
}

static void set_child(struct box_tree_node *node, int slot, const struct box *box, uint32_t child) {
    const double lo[3] = {box->min.x, box->min.y, box->min.z}, hi[3] = {box->max.x, box->max.y, box->max.z};
    for (int axis = 0; axis < 3; axis++) {
        node->planes[axis][0][slot] = lo[axis];
        node->planes[axis][1][slot] = hi[axis];
    }
    node->child[slot] = child;
}

/* Sizes that shrink geometrically make splits by area lop off one item at a time. Below this depth runs are halved by
 * count, so a tree of 2^31 items is at most DEEP + 16 deep, and a traversal's stack (3 entries a level) always
 * suffices. */
enum { DEEP = 64 };
_Static_assert((DEEP + 16) * (BOX_TREE_WIDTH - 1) + BOX_TREE_WIDTH <= BOX_TREE_STACK,
               "the traversal stack is too small");

struct task {
    struct run run;
    uint32_t node, depth;
};

/* Nodes of one part of the tree; they grow with it, so that memory while building stays close to that of the tree. Runs
 * of at most `leave` items are left to other jobs: their child index is the number of an entry in `left`, marked by
 * LEFT_OVER. */
struct part {
    struct box_tree_node *nodes;
    struct task *left;
    uint32_t node_count, node_capacity, left_count, left_capacity, leave;
    bool cancelled, failed; /* failed: no memory */
};

#define LEFT_OVER UINT32_C(0x40000000)

static void part_destroy(struct part *part) {
    mem_free(part->nodes);
    mem_free(part->left);
    part->nodes = NULL;
    part->left = NULL;
}

/* The number of a new node; they move when they grow. */
static uint32_t add_node(struct part *part) {
    if (part->node_count == part->node_capacity) {
        uint32_t capacity = part->node_capacity + part->node_capacity / 4 + 16;
        struct box_tree_node *nodes = mem_resize_array(part->nodes, capacity, sizeof *nodes);
        part->failed = part->failed || !nodes;
        if (part->failed)
            return 0;
        part->nodes = nodes;
        part->node_capacity = capacity;
    }
    return part->node_count++;
}

static uint32_t leave_run(struct part *part, const struct run *run, uint32_t depth) {
    if (part->left_count == part->left_capacity) {
        uint32_t capacity = 2 * part->left_capacity + 64;
        struct task *left = mem_resize_array(part->left, capacity, sizeof *left);
        part->failed = part->failed || !left;
        if (part->failed)
            return 0;
        part->left = left;
        part->left_capacity = capacity;
    }
    part->left[part->left_count] = (struct task){*run, 0, depth};
    return part->left_count++;
}

static void build_part(struct builder *b, struct part *part, struct run root, uint32_t root_depth) {
    struct box nothing = box_empty();
    struct task tasks[BOX_TREE_STACK]; /* as deep as a traversal's */
    uint32_t pending = 0;
    tasks[pending++] = (struct task){root, add_node(part), root_depth};
    while (pending > 0 && !part->cancelled && !part->failed) {
        struct task task = tasks[--pending];
        struct run children[BOX_TREE_WIDTH];
        int count = children_of(b, &task.run, task.depth >= DEEP, children);
        for (int i = 0; i < BOX_TREE_WIDTH && !part->failed; i++) {
            uint32_t child = BOX_TREE_NONE;
            if (i < count && children[i].count == 1) {
                child = b->items[children[i].first].item | BOX_TREE_ITEM;
            } else if (i < count && children[i].count <= part->leave) {
                child = LEFT_OVER | leave_run(part, &children[i], task.depth + 1);
            } else if (i < count) {
                child = add_node(part);
                tasks[pending++] = (struct task){children[i], child, task.depth + 1};
            }
            if (!part->failed)
                set_child(&part->nodes[task.node], i, i < count ? &children[i].box : &nothing, child);
        }
        bool is_long = task.run.count > 1000 || (part->node_count & 255) == 0;
        part->cancelled = is_long && pool_cancelled(b->pool);
    }
}

/* --- in parallel: the top of the tree by one thread, the parts below by all --- */

enum { PARTS = 64, PART_ITEMS = 4096 };

struct forest {
    struct builder *builder;
    const struct task *roots;
    struct part *parts;
};

static void build_root(void *context, uint32_t item, int worker) {
    (void)worker;
    struct forest *forest = context;
    build_part(forest->builder, &forest->parts[item], forest->roots[item].run, forest->roots[item].depth);
}

/* Concatenates the top and the parts; the numbers do not depend on which thread built which part. */
static bool join_parts(struct box_tree *tree, const struct part *top, const struct part *parts) {
    uint32_t total = top->node_count;
    for (uint32_t i = 0; i < top->left_count; i++)
        total += parts[i].node_count;
    tree->nodes = mem_alloc_aligned(64, total * sizeof *tree->nodes);
    if (!tree->nodes)
        return false;
    memcpy(tree->nodes, top->nodes, top->node_count * sizeof *tree->nodes);
    tree->node_count = top->node_count;
    for (uint32_t i = 0; i < top->left_count; i++) {
        struct box_tree_node *nodes = tree->nodes + tree->node_count;
        memcpy(nodes, parts[i].nodes, parts[i].node_count * sizeof *nodes);
        /* Their numbers of nodes begin at their place. */
        for (uint32_t n = 0; n < parts[i].node_count; n++) {
            for (int k = 0; k < BOX_TREE_WIDTH; k++) {
                if (!(nodes[n].child[k] & BOX_TREE_ITEM))
                    nodes[n].child[k] += tree->node_count;
            }
        }
        tree->node_count += parts[i].node_count;
    }
    /* In the top, what was left over is the first node of its part. */
    uint32_t first = top->node_count, *starts = mem_alloc_zero(top->left_count, sizeof *starts);
    if (!starts)
        return false;
    for (uint32_t i = 0; i < top->left_count; i++) {
        starts[i] = first;
        first += parts[i].node_count;
    }
    for (uint32_t n = 0; n < top->node_count; n++) {
        for (int k = 0; k < BOX_TREE_WIDTH; k++) {
            uint32_t child = tree->nodes[n].child[k];
            if (!(child & BOX_TREE_ITEM) && (child & LEFT_OVER))
                tree->nodes[n].child[k] = starts[child & ~LEFT_OVER];
        }
    }
    mem_free(starts);
    return true;
}

/* All parts under the top; false: no memory or cancelled, as `error` says. */
static bool build_parts(struct builder *b, const struct part *top, struct part *parts, struct error *error) {
    struct forest forest = {.builder = b, .roots = top->left, .parts = parts};
    bool whole = !top->cancelled && (top->left_count == 0 || pool_run(b->pool, top->left_count, build_root, &forest));
    bool failed = false;
    for (uint32_t i = 0; i < top->left_count && parts; i++) {
        whole = whole && !parts[i].cancelled;
        failed = failed || parts[i].failed;
    }
    if (failed)
        return error_no_memory(error, "the hierarchy of the scene");
    return whole || error_set(error, ERROR_CANCELLED, "stopped while the hierarchy of the scene was built");
}

static bool build_forest(struct builder *b, struct box_tree *tree, uint32_t count, struct error *error) {
    struct part top = {0}, *parts = NULL;
    if (count > PART_ITEMS)
        top.leave = count / PARTS > PART_ITEMS / 4 ? count / PARTS : PART_ITEMS / 4;
    build_part(b, &top, (struct run){0, count, tree->bounds}, 0);
    bool ok = !top.failed || error_no_memory(error, "the hierarchy of the scene");
    if (ok && top.left_count > 0) {
        parts = mem_alloc_zero(top.left_count, sizeof *parts);
        ok = parts || error_no_memory(error, "the hierarchy of the scene");
    }
    ok = ok && build_parts(b, &top, parts, error);
    mem_free(b->items); /* frees what the joined tree does not need */
    b->items = NULL;
    if (ok && !join_parts(tree, &top, parts))
        ok = error_no_memory(error, "the hierarchy of the scene");
    for (uint32_t i = 0; parts && i < top.left_count; i++)
        part_destroy(&parts[i]);
    mem_free(parts);
    part_destroy(&top);
    return ok;
}

bool box_tree_build(struct box_tree *tree, const struct box *boxes, uint32_t count, struct pool *pool,
                    struct error *error) {
    *tree = (struct box_tree){.bounds = box_empty()};
    struct builder builder = {.items = mem_alloc_zero(count, sizeof *builder.items), .pool = pool};
    bool ok = builder.items != NULL;
    if (!ok)
        error_no_memory(error, "the hierarchy of the scene");
    for (uint32_t i = 0; ok && i < count; i++) {
        const struct box *box = &boxes[i];
        if (box_is_empty(box))
            continue;
        builder.items[tree->item_count++] = (struct build_item){*box, i};
        tree->bounds = box_join(tree->bounds, *box);
    }
    if (ok && tree->item_count > 0)
        ok = build_forest(&builder, tree, tree->item_count, error);
    mem_free(builder.items);
    if (!ok)
        box_tree_destroy(tree);
    return ok;
}

static struct box child_box(const struct box_tree_node *node, int slot) {
    return (struct box){{node->planes[0][0][slot], node->planes[1][0][slot], node->planes[2][0][slot]},
                        {node->planes[0][1][slot], node->planes[1][1][slot], node->planes[2][1][slot]}};
}

static struct box node_box(const struct box_tree_node *node) {
    struct box box = box_empty();
    for (int k = 0; k < BOX_TREE_WIDTH; k++) {
        struct box child = child_box(node, k);
        if (node->child[k] != BOX_TREE_NONE)
            box = box_join(box, child);
    }
    return box;
}

/* The numbers of children are larger than that of their parent. */
void box_tree_refit(struct box_tree *tree, const struct box *boxes) {
    for (uint32_t n = tree->node_count; n-- > 0;) {
        struct box_tree_node *node = &tree->nodes[n];
        for (int k = 0; k < BOX_TREE_WIDTH; k++) {
            uint32_t child = node->child[k];
            if (child == BOX_TREE_NONE)
                continue;
            struct box box = child & BOX_TREE_ITEM ? boxes[child & ~BOX_TREE_ITEM] : node_box(&tree->nodes[child]);
            set_child(node, k, &box, child);
        }
    }
    tree->bounds = tree->node_count > 0 ? node_box(&tree->nodes[0]) : box_empty();
}

double box_tree_cost(const struct box_tree *tree) {
    double cost = 0;
    for (uint32_t n = 0; n < tree->node_count; n++) {
        for (int k = 0; k < BOX_TREE_WIDTH; k++) {
            struct box box = child_box(&tree->nodes[n], k);
            double area = tree->nodes[n].child[k] & BOX_TREE_ITEM ? 0 : half_area(&box);
            cost += isfinite(area) ? area : 0;
        }
    }
    return cost;
}

void box_tree_destroy(struct box_tree *tree) {
    mem_free(tree->nodes);
    *tree = (struct box_tree){.bounds = box_empty()};
}

size_t box_tree_memory(const struct box_tree *tree) {
    return tree->node_count * sizeof *tree->nodes;
}

/* --- traversal --- */

void box_tree_traversal_begin(struct box_tree_traversal *traversal, const struct box_tree *tree,
                              const struct ray *ray) {
    traversal->tree = tree;
    traversal->origin[0] = ray->origin.x;
    traversal->origin[1] = ray->origin.y;
    traversal->origin[2] = ray->origin.z;
    traversal->inverse[0] = 1 / ray->direction.x;
    traversal->inverse[1] = 1 / ray->direction.y;
    traversal->inverse[2] = 1 / ray->direction.z;
    for (int i = 0; i < 3; i++)
        traversal->near_side[i] = traversal->inverse[i] < 0;
    traversal->t_min = ray->t_min;
    traversal->isa = cpu_isa();
    traversal->steps = 0;
    traversal->top = 0;
    if (tree->item_count > 0) {
        traversal->child[traversal->top] = 0;
        traversal->enter[traversal->top++] = -INFINITY;
    }
}

bool box_tree_traversal_down(struct box_tree_traversal *traversal, double t_max, uint32_t *item) {
#if CPU_ISA_CHOICE
    if (traversal->isa != CPU_ISA_BASE)
        return box_tree_traversal_down_avx2(traversal, t_max, item);
#endif
    return box_tree_traversal_down_base(traversal, t_max, item);
}

bool box_tree_traversal_any(struct box_tree_traversal *traversal, double t_max, uint32_t *item) {
#if CPU_ISA_CHOICE
    if (traversal->isa != CPU_ISA_BASE)
        return box_tree_traversal_any_avx2(traversal, t_max, item);
#endif
    return box_tree_traversal_any_base(traversal, t_max, item);
}

/* --- boxes that meet a box --- */

void box_tree_meeting_begin(struct box_tree_meeting *meeting, const struct box_tree *tree, const struct box *box) {
    meeting->tree = tree;
    meeting->box = *box;
    meeting->child[0] = 0;
    meeting->top = tree->item_count > 0 ? 1 : 0;
}

bool box_tree_meeting_next(struct box_tree_meeting *meeting, uint32_t *item) {
    const struct box *b = &meeting->box;
    while (meeting->top > 0) {
        uint32_t next = meeting->child[--meeting->top];
        if (next & BOX_TREE_ITEM) {
            *item = next & ~BOX_TREE_ITEM;
            return true;
        }
        const struct box_tree_node *node = &meeting->tree->nodes[next];
        for (int i = 0; i < BOX_TREE_WIDTH; i++) {
            bool apart = node->child[i] == BOX_TREE_NONE;
            for (int axis = 0; axis < 3; axis++)
                apart = apart || node->planes[axis][0][i] > vec3_get(b->max, axis) ||
                        node->planes[axis][1][i] < vec3_get(b->min, axis);
            if (!apart)
                meeting->child[meeting->top++] = node->child[i];
        }
    }
    return false;
}

void box_tree_bundle(struct bundle *bundle, void *box_tree) {
    struct box_tree *tree = box_tree;
    BUNDLE(bundle, tree->nodes, tree->node_count, NULL);
}
