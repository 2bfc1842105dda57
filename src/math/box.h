/* An axis-aligned box; empty when min > max on some axis. */
#ifndef GRAY_MATH_BOX_H
#define GRAY_MATH_BOX_H

#include "math/affine.h"
#include "math/ray.h"
#include "math/vec3.h"

#include <stdbool.h>

struct box {
    struct vec3 min, max;
};

static inline struct box box_empty(void) {
    return (struct box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}
static inline bool box_is_empty(const struct box *b) {
    return !(b->min.x <= b->max.x && b->min.y <= b->max.y && b->min.z <= b->max.z);
}
static inline struct box box_join(struct box a, struct box b) {
    return (struct box){vec3_min(a.min, b.min), vec3_max(a.max, b.max)};
}
static inline struct box box_meet(struct box a, struct box b) {
    return (struct box){vec3_max(a.min, b.min), vec3_min(a.max, b.max)};
}
static inline struct box box_add_point(struct box a, struct vec3 p) {
    return (struct box){vec3_min(a.min, p), vec3_max(a.max, p)};
}
static inline bool box_contains(const struct box *b, struct vec3 p) {
    return p.x >= b->min.x && p.x <= b->max.x && p.y >= b->min.y && p.y <= b->max.y && p.z >= b->min.z && p.z <= b->max.z;
}
/* The box of the eight mapped corners; infinite sides stay infinite, empty stays empty. */
struct box box_transform(const struct affine *to_from, const struct box *b);
/* Grows by a few units in the last place of the largest coordinate, so that rounding cannot lose a touching ray. */
struct box box_pad(struct box b);
/* The part of the ray's closed interval inside the box, conservative by rounding; false when there is none. Handles zero
 * direction components and infinite boxes. */
bool box_clip(const struct box *b, const struct ray *ray, double *t_enter, double *t_exit);

#endif
