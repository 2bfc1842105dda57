/* A binary hierarchy of boxes over the triangles. Invariant: a node's box holds its triangles; a ray is tested against the
 * box grown by more than the rounding of the triangle test can move a triangle, so nothing is lost. */
#include "accel/triangle_index.h"

#include "base/mem.h"

#include <string.h>

struct index_node {
    float min[3], max[3];
    uint32_t first; /* leaf: first entry of order; else the left child, the right one follows it */
    uint32_t count; /* 0: inner node */
};

struct triangle_index {
    struct index_node *nodes;
    uint32_t *order;
    uint32_t node_count, triangle_count;
    double reach; /* largest absolute coordinate */
};

enum { LEAF_TRIANGLES = 4, STACK_DEPTH = 96 };

static void node_box(const struct triangle_set *set, const uint32_t *order, uint32_t count, struct index_node *node) {
    for (int k = 0; k < 3; k++) {
        double lo = INFINITY, hi = -INFINITY;
        for (uint32_t i = 0; i < count; i++)
            for (int j = 0; j < 3; j++) {
                double x = set->vertices[set->corners[order[i]][j]][k];
                lo = fmin(lo, x);
                hi = fmax(hi, x);
            }
        node->min[k] = nextafterf((float)lo, -INFINITY);
        node->max[k] = nextafterf((float)hi, INFINITY);
    }
}

static double centre(const struct triangle_set *set, uint32_t triangle, int axis) {
    const uint32_t *c = set->corners[triangle];
    return set->vertices[c[0]][axis] + set->vertices[c[1]][axis] + set->vertices[c[2]][axis];
}

/* Splits at the middle of the centres' widest extent, in halves when that separates nothing. */
static uint32_t split(const struct triangle_set *set, uint32_t *order, uint32_t count) {
    double lo[3], hi[3];
    int axis = 0;
    for (int k = 0; k < 3; k++) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            double x = centre(set, order[i], k);
            lo[k] = fmin(lo[k], x);
            hi[k] = fmax(hi[k], x);
        }
        if (hi[k] - lo[k] > hi[axis] - lo[axis])
            axis = k;
    }
    double middle = (lo[axis] + hi[axis]) / 2;
    uint32_t left = 0;
    for (uint32_t i = 0; i < count; i++)
        if (centre(set, order[i], axis) < middle) {
            uint32_t other = order[left];
            order[left++] = order[i];
            order[i] = other;
        }
    return left == 0 || left == count ? count / 2 : left;
}

static void build_node(struct triangle_index *index, const struct triangle_set *set, uint32_t node, uint32_t first,
                       uint32_t count, int depth) {
    node_box(set, index->order + first, count, &index->nodes[node]);
    if (count <= LEAF_TRIANGLES) {
        index->nodes[node].first = first;
        index->nodes[node].count = count;
        return;
    }
    uint32_t left = depth > 48 ? count / 2 : split(set, index->order + first, count);
    uint32_t child = index->node_count;
    index->node_count += 2;
    index->nodes[node].first = child;
    index->nodes[node].count = 0;
    build_node(index, set, child, first, left, depth + 1);
    build_node(index, set, child + 1, first + left, count - left, depth + 1);
}

bool triangle_index_build(struct triangle_index **out, const struct triangle_set *set, struct pool *pool,
                          struct error *error) {
    (void)pool;
    struct triangle_index *index = mem_alloc_zero(1, sizeof *index);
    if (!index)
        return error_no_memory(error, "the index of a mesh");
    index->triangle_count = set->count;
    index->nodes = mem_alloc_zero(2 * (size_t)set->count + 1, sizeof *index->nodes);
    index->order = mem_alloc_zero((size_t)set->count + 1, sizeof *index->order);
    if (!index->nodes || !index->order) {
        triangle_index_destroy(index);
        return error_no_memory(error, "the index of a mesh");
    }
    for (uint32_t i = 0; i < set->count; i++)
        index->order[i] = i;
    index->node_count = 1;
    if (set->count)
        build_node(index, set, 0, 0, set->count, 0);
    index->reach = set->count ? fmax(vec3_max_abs(set->bounds.min), vec3_max_abs(set->bounds.max)) : 0;
    *out = index;
    return true;
}

void triangle_index_destroy(struct triangle_index *index) {
    if (!index)
        return;
    mem_free(index->nodes);
    mem_free(index->order);
    mem_free(index);
}

size_t triangle_index_memory(const struct triangle_index *index) {
    return sizeof *index + (2 * (size_t)index->triangle_count + 1) * sizeof *index->nodes +
           (size_t)index->triangle_count * sizeof *index->order;
}

struct search {
    const struct triangle_index *index;
    const struct triangle_set *set;
    struct triangle_ray sheared;
    double origin[3], inverse[3], slack[3];
};

static bool search_begin(struct search *s, const struct triangle_index *index, const struct triangle_set *set,
                         const struct ray *ray) {
    s->index = index;
    s->set = set;
    if (set->count == 0 || !triangle_ray_init(&s->sheared, ray))
        return false;
    double largest = vec3_max_abs(ray->direction);
    double reach = fmax(index->reach, vec3_max_abs(ray->origin)) * 0x1p-47;
    for (int k = 0; k < 3; k++) {
        double d = vec3_get(ray->direction, k);
        if (fabs(d) < largest * 0x1p-400)
            d = copysign(largest * 0x1p-400, d);
        s->origin[k] = vec3_get(ray->origin, k);
        s->inverse[k] = 1 / d;
        s->slack[k] = fabs(s->inverse[k]) * reach;
    }
    return true;
}

static bool meets_box(const struct search *s, const struct index_node *node, double t_min, double t_max) {
    for (int k = 0; k < 3; k++) {
        double a = ((double)node->min[k] - s->origin[k]) * s->inverse[k];
        double b = ((double)node->max[k] - s->origin[k]) * s->inverse[k];
        t_min = fmax(t_min, fmin(a, b) - s->slack[k]);
        t_max = fmin(t_max, fmax(a, b) + s->slack[k]);
    }
    return t_min <= t_max;
}

enum search_kind { SEARCH_NEAREST, SEARCH_ANY, SEARCH_ALL };

static bool search(struct search *s, enum search_kind kind, double t_min, double t_max, struct triangle_hit *hit,
                   triangle_visit *visit, void *context, struct triangle_cost *cost) {
    uint32_t stack[STACK_DEPTH], top = 0;
    bool found = false;
    stack[top++] = 0;
    while (top) {
        const struct index_node *node = &s->index->nodes[stack[--top]];
        cost->hierarchy_steps++;
        if (!meets_box(s, node, t_min, t_max))
            continue;
        if (!node->count) {
            stack[top++] = node->first + 1;
            stack[top++] = node->first;
            continue;
        }
        for (uint32_t i = 0; i < node->count; i++) {
            struct triangle_hit h = {.triangle = s->index->order[node->first + i]};
            const uint32_t *c = s->set->corners[h.triangle];
            cost->triangle_tests++;
            if (!triangle_cross(&s->sheared, s->set->vertices[c[0]], s->set->vertices[c[1]], s->set->vertices[c[2]], &h))
                continue;
            if (kind == SEARCH_ALL) {
                visit(context, &h);
                continue;
            }
            if (!(h.t > t_min && h.t <= t_max) || (h.t == t_max && !(found && h.triangle < hit->triangle)))
                continue;
            if (kind == SEARCH_ANY)
                return true;
            *hit = h;
            t_max = h.t;
            found = true;
        }
    }
    return found;
}

bool triangle_index_nearest(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                            struct triangle_hit *hit, struct triangle_cost *cost) {
    struct search s;
    return search_begin(&s, index, set, ray) &&
           search(&s, SEARCH_NEAREST, ray->t_min, ray->t_max, hit, NULL, NULL, cost);
}

bool triangle_index_any(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                        struct triangle_cost *cost) {
    struct search s;
    struct triangle_hit hit;
    return search_begin(&s, index, set, ray) && search(&s, SEARCH_ANY, ray->t_min, ray->t_max, &hit, NULL, NULL, cost);
}

void triangle_index_all(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                        triangle_visit *visit, void *context, struct triangle_cost *cost) {
    struct search s;
    struct triangle_hit hit;
    if (search_begin(&s, index, set, ray))
        search(&s, SEARCH_ALL, -INFINITY, INFINITY, &hit, visit, context, cost);
}
