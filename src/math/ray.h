/* A ray: origin + t * direction for t in the open interval (t_min, t_max). The direction is NOT normalised, so t is the
 * same number in object and in world space. */
#ifndef GRAY_MATH_RAY_H
#define GRAY_MATH_RAY_H

#include "math/affine.h"
#include "math/vec3.h"

#include <stdbool.h>
#include <stdint.h>

struct medium_stack; /* of the solids the ray is inside of; material/medium.h */

/* A cone around the ray: its diameter at t is width + spread * t * |direction| (world units). */
struct footprint {
    double width, spread;
};

struct ray {
    struct vec3 origin, direction;
    double t_min, t_max;
    double time; /* 0 at shutter open, 1 at shutter close */
    struct footprint footprint;
    const struct medium_stack *media;
    uint32_t skip_primitive; /* 1 + the number of a primitive that the ray is known not to hit; 0: none */
    uint32_t skip_part;      /* 0: it hits no part of that primitive; otherwise 1 + the triangle that it does not hit */
};

/* Whether the ray is known not to hit any part of a primitive. */
static inline bool ray_skips(const struct ray *ray, uint32_t primitive) {
    return primitive + 1 == ray->skip_primitive && ray->skip_part == 0;
}
static inline struct vec3 ray_at(const struct ray *ray, double t) {
    return vec3_add_scaled(ray->origin, ray->direction, t);
}
/* The same ray in another space; t, interval, time and footprint do not change. */
static inline struct ray ray_transform(const struct affine *to_from, const struct ray *ray) {
    struct ray out = *ray;
    out.origin = affine_point(to_from, ray->origin);
    out.direction = affine_vector(to_from, ray->direction);
    return out;
}

#endif
