/* A kd-tree over the triangles of one mesh: --accel kdtree. The results are those of triangle_brute_*, bit for bit. */
#ifndef GRAY_ACCEL_KD_TRIANGLES_H
#define GRAY_ACCEL_KD_TRIANGLES_H

#include "accel/triangle_index.h"
#include "base/bundle.h"

struct kd_triangles;

/* Owner: the caller, kd_triangles_destroy. False: no memory or cancelled. */
bool kd_triangles_build(struct kd_triangles **out, const struct triangle_set *set, const struct pool *pool,
                        struct error *error);
void kd_triangles_destroy(struct kd_triangles *index); /* NULL is fine */
size_t kd_triangles_memory(const struct kd_triangles *index);

/* As triangle_index_*. */
bool kd_triangles_nearest(const struct kd_triangles *index, const struct triangle_set *set, const struct ray *ray,
                          struct triangle_hit *hit, struct triangle_cost *cost);
bool kd_triangles_any(const struct kd_triangles *index, const struct triangle_set *set, const struct ray *ray,
                      struct triangle_cost *cost);
void kd_triangles_all(const struct kd_triangles *index, const struct triangle_set *set, const struct ray *ray,
                      triangle_visit *visit, void *context, struct triangle_cost *cost);
/* Copies what *triangles points to (base/bundle.h). */
void kd_triangles_bundle(struct bundle *bundle, struct kd_triangles **triangles);

#endif
