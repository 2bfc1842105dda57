/* See float_tree.h. The four children of a node become two by the surface area heuristic. Splits by area lop off one
 * item at a time where sizes grow geometrically; where the depth that is left just suffices, the rest is halved by
 * count. */
#include "accel/float_tree.h"

#include "accel/box_tree.h"
#include "base/mem.h"
#include "math/portable.h"

#include <string.h>

enum { WIDTH = BOX_TREE_WIDTH };

/* A child of a wide node. */
struct branch {
    struct box box;
    uint32_t child, count; /* as it is there; of items */
};

struct conversion {
    const struct float_tree_items *items;
    const struct box_tree *wide;
    struct float_trees *trees;
    uint32_t *counts;    /* of items below each wide node */
    uint32_t *collected; /* room for all items */
};

/* --- boxes --- */

/* Infinite sides count as long ones, so that the products are numbers. */
static double half_area(const struct box *box) {
    const double x = math_min(box->max.x - box->min.x, 0x1p400), y = math_min(box->max.y - box->min.y, 0x1p400),
                 z = math_min(box->max.z - box->min.z, 0x1p400);
    return x * y + y * z + z * x;
}

static double outer(double largest, double coordinate) {
    return isfinite(coordinate) && fabs(coordinate) > largest ? fabs(coordinate) : largest;
}

static void set_box(float out[6], const struct box *box) {
    const double low[3] = {box->min.x, box->min.y, box->min.z}, high[3] = {box->max.x, box->max.y, box->max.z};
    double largest = 0;
    for (int i = 0; i < 3; i++)
        largest = outer(outer(largest, low[i]), high[i]);
    for (int i = 0; i < 3; i++) {
        const double below = low[i] - largest * 0x1p-40, above = high[i] + largest * 0x1p-40;
        out[i] = (float)below;
        out[3 + i] = (float)above;
        if ((double)out[i] > below)
            out[i] = math_nextafterf(out[i], -INFINITY);
        if ((double)out[3 + i] < above)
            out[3 + i] = math_nextafterf(out[3 + i], INFINITY);
    }
}

/* --- nodes --- */

/* Ample room for items of `size` bytes, because there may be many small hierarchies. */
static bool make_room(void *memory, uint32_t *room, uint64_t needed, size_t size) {
    void *before, *larger;
    memcpy(&before, memory, sizeof before);
    if (needed <= *room)
        return true;
    const uint64_t wanted = needed + *room / 2;
    larger = mem_resize_array(before, wanted, size);
    if (!larger)
        return false;
    memcpy(memory, &larger, sizeof larger);
    *room = (uint32_t)wanted;
    return true;
}

static uint32_t leaf_of(const struct conversion *c, const uint32_t *items, uint32_t count) {
    struct float_trees *trees = c->trees;
    if (items[0] < c->items->singles)
        return FLOAT_TREE_LEAF | FLOAT_TREE_SINGLE | items[0];
    const uint32_t first = trees->order_count;
    for (uint32_t i = 0; i < count; i++)
        trees->order[trees->order_count++] = items[i];
    return FLOAT_TREE_LEAF | (count - 1) << FLOAT_TREE_RUN_SHIFT | first;
}

static bool can_be_run(const struct conversion *c, const uint32_t *items, uint32_t count) {
    bool can = count <= FLOAT_TREE_RUN;
    for (uint32_t i = 0; can && i < count; i++)
        can = count == 1 || items[i] >= c->items->singles;
    return can;
}

static uint32_t collect(const struct conversion *c, const struct branch *branches, int number, uint32_t *out) {
    uint32_t count = 0;
    for (int i = 0; i < number; i++) {
        if (branches[i].child & BOX_TREE_ITEM) {
            out[count++] = branches[i].child & ~BOX_TREE_ITEM;
            continue;
        }
        const struct box_tree_node *node = &c->wide->nodes[branches[i].child];
        for (int k = 0; k < WIDTH; k++)
            if (node->child[k] != BOX_TREE_NONE)
                count += collect(c, &(struct branch){.child = node->child[k]}, 1, out + count);
    }
    return count;
}

static uint32_t halve(const struct conversion *c, const uint32_t *items, uint32_t count, struct box *box) {
    *box = box_empty();
    if (can_be_run(c, items, count)) {
        for (uint32_t i = 0; i < count; i++)
            *box = box_join(*box, c->items->boxes[items[i]]);
        return leaf_of(c, items, count);
    }
    const uint32_t number = c->trees->node_count++, left = count / 2;
    for (int k = 0; k < 2; k++) {
        struct box side;
        const uint32_t child = halve(c, items + (k ? left : 0), k ? count - left : left, &side);
        c->trees->nodes[number].child[k] = child;
        set_box(c->trees->nodes[number].box[k], &side);
        *box = box_join(*box, side);
    }
    return number;
}

/* All branches whose bit is set in `mask`. */
static struct branch join(const struct branch *branches, int number, unsigned mask) {
    struct branch all = {.box = box_empty()};
    for (int i = 0; i < number; i++) {
        if (mask >> i & 1) {
            all.box = box_join(all.box, branches[i].box);
            all.count += branches[i].count;
        }
    }
    return all;
}

/* The set of branches on one side that costs least; its cost for a ray that meets all, times the area of that. */
static double best_halves(const struct branch *branches, int number, unsigned *best) {
    double best_cost = INFINITY;
    *best = 1;
    for (unsigned mask = 1; mask < 1U << (number - 1); mask++) {
        const struct branch one = join(branches, number, mask), other = join(branches, number, ~mask);
        const double cost = half_area(&one.box) * one.count + half_area(&other.box) * other.count;
        if (cost < best_cost) {
            best_cost = cost;
            *best = mask;
        }
    }
    return best_cost;
}

static int children_of(const struct conversion *c, uint32_t wide_node, struct branch out[WIDTH]) {
    const struct box_tree_node *node = &c->wide->nodes[wide_node];
    int number = 0;
    for (int k = 0; k < WIDTH; k++) {
        const uint32_t child = node->child[k];
        if (child == BOX_TREE_NONE)
            continue;
        out[number++] = (struct branch){{{node->planes[0][0][k], node->planes[1][0][k], node->planes[2][0][k]},
                                         {node->planes[0][1][k], node->planes[1][1][k], node->planes[2][1][k]}},
                                        child,
                                        child & BOX_TREE_ITEM ? 1 : c->counts[child]};
    }
    return number;
}

/* The hierarchy over branches, with at most `depth` nodes on the way to a leaf: no more than 2^depth items. */
static uint32_t convert(const struct conversion *c, const struct branch *branches, int number, int depth) {
    static const double node_cost = 1.2; /* over that of a triangle */
    struct branch own[WIDTH];
    while (number == 1 && !(branches->child & BOX_TREE_ITEM)) {
        number = children_of(c, branches->child, own);
        branches = own;
    }
    const struct branch all = join(branches, number, ~0U);
    unsigned halves = 1;
    const double cost = number > 1 ? best_halves(branches, number, &halves) : INFINITY;
    if (all.count <= FLOAT_TREE_RUN) {
        const double area = half_area(&all.box);
        uint32_t few[FLOAT_TREE_RUN];
        (void)collect(c, branches, number, few);
        if (can_be_run(c, few, all.count) && !(node_cost * area + cost < area * all.count))
            return leaf_of(c, few, all.count);
    }
    if (all.count > UINT32_C(1) << (depth < 32 ? depth - 1 : 31)) {
        struct box box;
        (void)collect(c, branches, number, c->collected);
        return halve(c, c->collected, all.count, &box);
    }
    const uint32_t node = c->trees->node_count++;
    for (int k = 0; k < 2; k++) {
        const unsigned mask = k ? ~halves : halves;
        const struct branch side = join(branches, number, mask);
        struct branch chosen[WIDTH];
        int count = 0;
        for (int i = 0; i < number; i++)
            if (mask >> i & 1)
                chosen[count++] = branches[i];
        const uint32_t child = convert(c, chosen, count, depth - 1);
        c->trees->nodes[node].child[k] = child;
        set_box(c->trees->nodes[node].box[k], &side.box);
    }
    return node;
}

/* The numbers of children are larger than that of their parent. */
static void count_items(const struct box_tree *wide, uint32_t *counts) {
    for (uint32_t n = wide->node_count; n-- > 0;) {
        counts[n] = 0;
        for (int k = 0; k < WIDTH; k++) {
            const uint32_t child = wide->nodes[n].child[k];
            if (child != BOX_TREE_NONE)
                counts[n] += child & BOX_TREE_ITEM ? 1 : counts[child];
        }
    }
}

bool float_trees_add(struct float_trees *trees, const struct float_tree_items *items, struct pool *pool, uint32_t *root,
                     struct error *error) {
    struct box_tree wide;
    *root = FLOAT_TREE_NONE;
    if (!box_tree_build(&wide, items->boxes, items->count, pool, error))
        return false;
    bool ok = make_room(&trees->nodes, &trees->node_room, (uint64_t)trees->node_count + wide.item_count,
                        sizeof *trees->nodes) &&
              make_room(&trees->order, &trees->order_room, (uint64_t)trees->order_count + wide.item_count,
                        sizeof *trees->order);
    uint32_t *memory = mem_alloc(((size_t)wide.node_count + wide.item_count) * sizeof *memory);
    ok = ok && memory;
    if (ok && wide.item_count > 0) {
        const struct conversion c = {items, &wide, trees, memory, memory + wide.node_count};
        count_items(&wide, c.counts);
        *root = convert(&c, &(struct branch){.child = 0, .count = wide.item_count}, 1, FLOAT_TREE_DEPTH);
    }
    mem_free(memory);
    box_tree_destroy(&wide);
    return ok || error_no_memory(error, "the scene for a device");
}

void float_trees_destroy(struct float_trees *trees) {
    mem_free(trees->nodes);
    mem_free(trees->order);
    *trees = (struct float_trees){.nodes = NULL};
}

/* --- rays --- */

void float_ray_set(struct float_ray *out, const struct ray *ray) {
    const double origin[3] = {ray->origin.x, ray->origin.y, ray->origin.z};
    const double direction[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    const double far = vec3_max_abs(ray->origin), longest = vec3_max_abs(ray->direction);
    const bool usual = far <= 0x1p100 && longest >= 0x1p-32 && longest <= 0x1p32;
    const float slack = (float)far * 0x1p-40f + 0x1p-100f, t_min = (float)ray->t_min;
    for (int i = 0; i < 3; i++) {
        const float near = (float)origin[i], wide = fabsf(near) * 0x1p-23f + slack;
        out->low[i] = near - wide;
        out->high[i] = near + wide;
        out->inverse[i] = usual ? 1 / (float)direction[i] : NAN;
    }
    out->t_min = usual ? t_min - fabsf(t_min) * 0x1p-20f - 0x1p-120f : -INFINITY;
}
