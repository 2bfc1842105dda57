/* An index over the triangles of one mesh: finds the hits of a ray, with the same bits as a test of every triangle. */
#ifndef GRAY_ACCEL_TRIANGLE_INDEX_H
#define GRAY_ACCEL_TRIANGLE_INDEX_H

#include "accel/triangle.h"
#include "base/bundle.h"
#include "base/error.h"
#include "base/pool.h"
#include "math/box.h"

#include <stddef.h>
#include <stdint.h>

/* Borrowed from the mesh, which must outlive the index. */
struct triangle_set {
    const double (*vertices)[3];
    const uint32_t (*corners)[3];
    uint32_t count;
    struct box bounds; /* of the triangles; empty when there are none */
};

struct triangle_index;

/* The cost of searches, as sums; searches only add to them. */
struct triangle_cost {
    uint64_t triangle_tests, voxels, hierarchy_steps;
};

/* `voxels`: the approximate number of voxels of the frame; 0: chosen by the cost model of accel_cost.h. Owner: the
 * caller, triangle_index_destroy. False: no memory or cancelled. pool may be NULL; the bytes of the index do not depend
 * on it. */
bool triangle_index_build(struct triangle_index **out, const struct triangle_set *set, uint32_t voxels,
                          struct pool *pool, struct error *error);
void triangle_index_destroy(struct triangle_index *index); /* NULL is fine */
size_t triangle_index_memory(const struct triangle_index *index);

/* The smallest t of the ray's open interval; among equal t the lowest triangle. */
bool triangle_index_nearest(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                            struct triangle_hit *hit, struct triangle_cost *cost);
bool triangle_index_any(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                        struct triangle_cost *cost);
/* Triangles from number `first` on. */
struct triangle_run {
    uint32_t first, count;
};
/* The same for a ray that is known to hit no triangle of a run, such as the triangle of its origin: these are not
 * tested in double precision. *triangle: a triangle that the ray hits. */
bool triangle_index_nearest_but(const struct triangle_index *index, const struct triangle_set *set,
                                const struct ray *ray, struct triangle_run run, struct triangle_hit *hit,
                                struct triangle_cost *cost);
bool triangle_index_any_but(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                            struct triangle_run run, uint32_t *triangle, struct triangle_cost *cost);
/* Every triangle the whole line meets, in any order, perhaps one several times with the same bits. */
typedef void triangle_visit(void *context, const struct triangle_hit *hit);
void triangle_index_all(const struct triangle_index *index, const struct triangle_set *set, const struct ray *ray,
                        triangle_visit *visit, void *context, struct triangle_cost *cost);

/* The same results by testing every triangle. */
bool triangle_brute_nearest(const struct triangle_set *set, const struct ray *ray, struct triangle_hit *hit,
                            struct triangle_cost *cost);
bool triangle_brute_any(const struct triangle_set *set, const struct ray *ray, struct triangle_cost *cost);
void triangle_brute_all(const struct triangle_set *set, const struct ray *ray, triangle_visit *visit, void *context,
                        struct triangle_cost *cost);
/* Copies what *index points to (base/bundle.h). */
void triangle_index_bundle(struct bundle *bundle, struct triangle_index **index);
/* What the set points to. */
bundle_fields triangle_set_bundle;

#endif
