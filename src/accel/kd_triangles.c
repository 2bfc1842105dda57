/* Triangles in a kd-tree. Exact splits: the extent of a triangle in a cell is the box of the polygon that remains after
 * clipping to the cell (Sutherland and Hodgman, "Reentrant Polygon Clipping", CACM 1974).
 *
 * The point where a ray meets a triangle, as computed, is off the triangle by some 2^-49 of the coordinates involved:
 * the test of triangle.h takes t as a mean of the corners' z with weights of one sign, so it lies among them, and x and
 * y are wrong by the rounding of corner - origin and of the weights. The slack of the traversal is 2^-46 of origin and
 * mesh. Clipping is done against cells larger by 2^-44 of the mesh, so that its own rounding loses nothing. */
#include "accel/kd_triangles.h"

#include "accel/kd_tree.h"
#include "base/mem.h"

#include <string.h>

enum { CORNERS = 9 /* three, and one more for each of six planes */, MAILBOX = 64 };

#define TRAVERSAL_SLACK 0x1p-46
#define CLIP_SLACK 0x1p-44

struct kd_triangles {
    struct kd_tree tree;
    double extent; /* largest coordinate */
};

struct clip_job {
    const struct triangle_set *set;
    double slack;
};

/* Keeps the side of the plane where sign * x[axis] <= sign * at. */
static int clip_side(double from[CORNERS][3], int count, double to[CORNERS][3], int axis, double at, double sign) {
    int kept = 0;
    for (int i = 0; i < count; i++) {
        const double *p = from[i], *q = from[(i + 1) % count];
        double p_out = sign * (p[axis] - at), q_out = sign * (q[axis] - at);
        if (p_out <= 0)
            memcpy(to[kept++], p, sizeof *to);
        if ((p_out < 0 && q_out > 0) || (p_out > 0 && q_out < 0)) {
            double share = p_out / (p_out - q_out);
            for (int k = 0; k < 3; k++)
                to[kept][k] = p[k] + share * (q[k] - p[k]);
            to[kept++][axis] = at;
        }
    }
    return kept;
}

static bool clip_triangle(const void *context, uint32_t item, const struct box *cell, struct box *part) {
    const struct clip_job *job = context;
    const uint32_t *corner = job->set->corners[item];
    double polygons[2][CORNERS][3];
    int count = 3;
    for (int i = 0; i < 3; i++)
        memcpy(polygons[0][i], job->set->vertices[corner[i]], sizeof polygons[0][i]);
    for (int axis = 0; axis < 3 && count > 0; axis++) {
        double lo = vec3_get(cell->min, axis) - job->slack, hi = vec3_get(cell->max, axis) + job->slack;
        count = clip_side(polygons[0], count, polygons[1], axis, lo, -1);
        count = clip_side(polygons[1], count, polygons[0], axis, hi, 1);
    }
    struct box left = box_empty();
    for (int i = 0; i < count; i++)
        left = box_add_point(left, vec3_make(polygons[0][i][0], polygons[0][i][1], polygons[0][i][2]));
    left.min = vec3_sub(left.min, vec3_all(job->slack));
    left.max = vec3_add(left.max, vec3_all(job->slack));
    *part = box_meet(left, *cell);
    return count > 0 && !box_is_empty(part);
}

bool kd_triangles_build(struct kd_triangles **out, const struct triangle_set *set, const struct pool *pool,
                        struct error *error) {
    struct kd_triangles *index = mem_alloc_zero(1, sizeof *index);
    struct box *boxes = mem_alloc_zero(set->count, sizeof *boxes);
    bool ok = index && boxes;
    if (!ok)
        error_no_memory(error, "the kd-tree of a mesh");
    for (uint32_t i = 0; ok && i < set->count; i++) {
        boxes[i] = box_empty();
        for (int k = 0; k < 3; k++) {
            const double *v = set->vertices[set->corners[i][k]];
            boxes[i] = box_add_point(boxes[i], vec3_make(v[0], v[1], v[2]));
        }
    }
    if (ok && set->count > 0) {
        /* The slack of a clipped triangle is relative to the largest coordinate. */
        index->extent = math_max(vec3_max_abs(set->bounds.min), vec3_max_abs(set->bounds.max));
        struct clip_job job = {set, index->extent * CLIP_SLACK};
        ok = kd_tree_build(&index->tree, &(struct kd_items){boxes, set->count, clip_triangle, &job}, pool, error);
    }
    mem_free(boxes);
    if (!ok) {
        mem_free(index);
        return false;
    }
    *out = index;
    return true;
}

void kd_triangles_destroy(struct kd_triangles *index) {
    if (!index)
        return;
    kd_tree_destroy(&index->tree);
    mem_free(index);
}

size_t kd_triangles_memory(const struct kd_triangles *index) {
    return sizeof *index + kd_tree_memory(&index->tree);
}

/* --- searching --- */

struct search {
    struct kd_traversal traversal;
    struct triangle_ray sheared;
    const struct triangle_set *set;
    uint32_t seen[MAILBOX]; /* triangles tested recently: one may be in many leaves */
    uint64_t tests;
};

static bool search_begin(struct search *s, const struct kd_triangles *index, const struct triangle_set *set,
                         const struct ray *ray) {
    if (set->count == 0 || !triangle_ray_init(&s->sheared, ray))
        return false;
    s->set = set;
    s->tests = 0;
    memset(s->seen, 0xff, sizeof s->seen);
    kd_traversal_begin(&s->traversal, &index->tree, ray, TRAVERSAL_SLACK * (index->extent + vec3_max_abs(ray->origin)));
    return true;
}

static void search_end(const struct search *s, struct triangle_cost *cost) {
    cost->triangle_tests += s->tests;
    cost->hierarchy_steps += s->traversal.steps;
    cost->voxels += s->traversal.leaves;
}

static bool try_triangle(struct search *s, uint32_t triangle, struct triangle_hit *hit) {
    uint32_t *slot = &s->seen[triangle % MAILBOX];
    if (*slot == triangle)
        return false;
    *slot = triangle;
    s->tests++;
    const uint32_t *corner = s->set->corners[triangle];
    hit->triangle = triangle;
    return triangle_cross(&s->sheared, s->set->vertices[corner[0]], s->set->vertices[corner[1]],
                          s->set->vertices[corner[2]], hit);
}

bool kd_triangles_nearest(const struct kd_triangles *index, const struct triangle_set *set, const struct ray *ray,
                          struct triangle_hit *hit, struct triangle_cost *cost) {
    struct search s;
    if (!search_begin(&s, index, set, ray))
        return false;
    double best = ray->t_max;
    bool found = false;
    struct triangle_hit candidate;
    while (kd_traversal_next(&s.traversal, best))
        for (uint32_t i = 0; i < s.traversal.count; i++) {
            uint32_t triangle = s.traversal.items[i];
            if (!try_triangle(&s, triangle, &candidate) || !(candidate.t > ray->t_min) || candidate.t > best)
                continue;
            if (candidate.t == best && (!found || triangle > hit->triangle))
                continue;
            best = candidate.t;
            *hit = candidate;
            found = true;
        }
    search_end(&s, cost);
    return found;
}

bool kd_triangles_any(const struct kd_triangles *index, const struct triangle_set *set, const struct ray *ray,
                      struct triangle_cost *cost) {
    struct search s;
    if (!search_begin(&s, index, set, ray))
        return false;
    bool found = false;
    struct triangle_hit candidate;
    while (!found && kd_traversal_next(&s.traversal, ray->t_max))
        for (uint32_t i = 0; i < s.traversal.count && !found; i++)
            found = try_triangle(&s, s.traversal.items[i], &candidate) && candidate.t > ray->t_min &&
                    candidate.t < ray->t_max;
    search_end(&s, cost);
    return found;
}

void kd_triangles_all(const struct kd_triangles *index, const struct triangle_set *set, const struct ray *ray,
                      triangle_visit *visit, void *context, struct triangle_cost *cost) {
    struct search s;
    struct ray line = *ray;
    line.t_min = -INFINITY;
    line.t_max = INFINITY;
    if (!search_begin(&s, index, set, &line))
        return;
    struct triangle_hit hit;
    while (kd_traversal_next(&s.traversal, INFINITY))
        for (uint32_t i = 0; i < s.traversal.count; i++)
            if (try_triangle(&s, s.traversal.items[i], &hit))
                visit(context, &hit);
    search_end(&s, cost);
}

static void bundle_tree(struct bundle *bundle, void *triangles) {
    kd_tree_bundle(bundle, &((struct kd_triangles *)triangles)->tree);
}

void kd_triangles_bundle(struct bundle *bundle, struct kd_triangles **triangles) {
    BUNDLE(bundle, *triangles, 1, bundle_tree);
}
