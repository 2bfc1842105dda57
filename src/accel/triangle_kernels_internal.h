/* The three searches in each instruction set they are built for; triangle_index.c chooses between them. */
#ifndef GRAY_ACCEL_TRIANGLE_KERNELS_INTERNAL_H
#define GRAY_ACCEL_TRIANGLE_KERNELS_INTERNAL_H

#include "accel/triangle_index.h"

enum triangle_search { TRIANGLE_NEAREST, TRIANGLE_ANY, TRIANGLE_ALL };

#define TRIANGLE_KERNELS(suffix)                                                                                       \
    bool triangle_nearest_##suffix(const struct triangle_index *index, const struct triangle_set *set,                 \
                                   const struct ray *ray, struct triangle_hit *hit, struct triangle_cost *cost);       \
    bool triangle_any_##suffix(const struct triangle_index *index, const struct triangle_set *set,                     \
                               const struct ray *ray, struct triangle_cost *cost);                                     \
    bool triangle_nearest_but_##suffix(const struct triangle_index *index, const struct triangle_set *set,             \
                                       const struct ray *ray, struct triangle_run run, struct triangle_hit *hit,       \
                                       struct triangle_cost *cost);                                                    \
    bool triangle_any_but_##suffix(const struct triangle_index *index, const struct triangle_set *set,                 \
                                   const struct ray *ray, struct triangle_run run, uint32_t *triangle,                 \
                                   struct triangle_cost *cost);                                                        \
    void triangle_all_##suffix(const struct triangle_index *index, const struct triangle_set *set,                     \
                               const struct ray *ray, triangle_visit *visit, void *context,                            \
                               struct triangle_cost *cost);

TRIANGLE_KERNELS(base)
TRIANGLE_KERNELS(avx2)
TRIANGLE_KERNELS(avx512)

#endif
