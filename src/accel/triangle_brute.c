/* Searches without an index, the measure of all others: every triangle is tried. */
#include "accel/triangle_index.h"

static bool cross(const struct triangle_set *set, uint32_t triangle, const struct triangle_ray *ray,
                  struct triangle_hit *hit) {
    const uint32_t *corner = set->corners[triangle];
    hit->triangle = triangle;
    return triangle_cross(ray, set->vertices[corner[0]], set->vertices[corner[1]], set->vertices[corner[2]], hit);
}

bool triangle_brute_nearest(const struct triangle_set *set, const struct ray *ray, struct triangle_hit *hit,
                            struct triangle_cost *cost) {
    struct triangle_ray sheared;
    if (!triangle_ray_init(&sheared, ray))
        return false;
    double best = ray->t_max;
    bool found = false;
    struct triangle_hit candidate;
    for (uint32_t i = 0; i < set->count; i++)
        if (cross(set, i, &sheared, &candidate) && candidate.t > ray->t_min && candidate.t < best) {
            best = candidate.t;
            *hit = candidate;
            found = true;
        }
    cost->triangle_tests += set->count;
    return found;
}

bool triangle_brute_any(const struct triangle_set *set, const struct ray *ray, struct triangle_cost *cost) {
    struct triangle_ray sheared;
    if (!triangle_ray_init(&sheared, ray))
        return false;
    struct triangle_hit candidate;
    for (uint32_t i = 0; i < set->count; i++)
        if (cross(set, i, &sheared, &candidate) && candidate.t > ray->t_min && candidate.t < ray->t_max) {
            cost->triangle_tests += i + 1;
            return true;
        }
    cost->triangle_tests += set->count;
    return false;
}

void triangle_brute_all(const struct triangle_set *set, const struct ray *ray, triangle_visit *visit, void *context,
                        struct triangle_cost *cost) {
    struct triangle_ray sheared;
    if (!triangle_ray_init(&sheared, ray))
        return;
    struct triangle_hit hit;
    for (uint32_t i = 0; i < set->count; i++)
        if (cross(set, i, &sheared, &hit))
            visit(context, &hit);
    cost->triangle_tests += set->count;
}
