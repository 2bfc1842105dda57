/* An axis-aligned box; empty when min > max on some axis. */
#ifndef GRAY_MATH_BOX_H
#define GRAY_MATH_BOX_H

#include "math/affine.h"
#include "math/lanes.h"
#include "math/ray.h"
#include "math/vec3.h"

#include <stdbool.h>
#include <stddef.h>

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
/* Further out by so much on every side. */
static inline struct box box_grow(struct box b, double by) {
    return (struct box){vec3_sub(b.min, vec3_all(by)), vec3_add(b.max, vec3_all(by))};
}
/* Corner i of 0 to 7: where bit 1, 2 or 4 is set the maximum of x, y or z. */
static inline struct vec3 box_corner(const struct box *b, unsigned i) {
    return vec3_make(i & 1 ? b->max.x : b->min.x, i & 2 ? b->max.y : b->min.y, i & 4 ? b->max.z : b->min.z);
}
static inline bool box_contains(const struct box *b, struct vec3 p) {
    return p.x >= b->min.x && p.x <= b->max.x && p.y >= b->min.y && p.y <= b->max.y && p.z >= b->min.z &&
           p.z <= b->max.z;
}
/* The box of the eight mapped corners; infinite sides stay infinite, empty stays empty. */
struct box box_transform(const struct affine *to_from, const struct box *b);
/* Grows by a few units in the last place of the largest coordinate, so that rounding cannot lose a touching ray. */
struct box box_pad(struct box b);
/* The part of the ray's closed interval inside the box, conservative by rounding; false when there is none. Handles
 * zero direction components and infinite boxes. */
bool box_clip(const struct box *b, const struct ray *ray, double *t_enter, double *t_exit);

/* The same for many boxes and one ray: reciprocals are computed once. */
struct box_probe {
    double origin[3][2];       /* twice, for both planes of a slab */
    double inverse[3][2];      /* of the direction, and its negative; infinite where it is 0 */
    ptrdiff_t near[3], far[3]; /* which of a box's six numbers is the plane of each slab that comes first, and last */
};

static inline struct box_probe box_probe_make(const struct ray *ray) {
    const double origin[3] = {ray->origin.x, ray->origin.y, ray->origin.z};
    const double direction[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    struct box_probe probe;
    for (int i = 0; i < 3; i++) {
        double inverse = 1 / direction[i];
        bool negative = inverse < 0;
        probe.origin[i][0] = probe.origin[i][1] = origin[i];
        probe.inverse[i][0] = inverse, probe.inverse[i][1] = -inverse;
        probe.near[i] = negative ? i + 3 : i;
        probe.far[i] = negative ? i : i + 3;
    }
    return probe;
}

/* Where the line is between the planes of all three axes, widened by the rounding errors of the quotients: the
 * comparison, which rounding cannot change, comes first, so that one widening is enough. Planes that the line lies in
 * or is parallel to inside do not count (their quotients are infinite or NaN). enter > leave: nowhere. */
struct box_span {
    double enter, leave;
};

/* Both planes of a slab at once: the nearest far plane is minus the maximum of the negated values. */
static inline struct box_span box_probe_span(const struct box_probe *probe, const struct box *b) {
    _Static_assert(sizeof(struct box) == 6 * sizeof(double), "a box is its six numbers");
    const double *planes = (const double *)(const void *)b;
    double2 max = double2_all(-(double)INFINITY);
    for (int i = 0; i < 3; i++) {
        double2 plane = {planes[probe->near[i]], planes[probe->far[i]]};
        max = double2_max((plane - double2_load_any(probe->origin[i])) * double2_load_any(probe->inverse[i]), max);
    }
    double2 wide = double2_min(max * (1 - 0x1p-49), max * (1 + 0x1p-49)); /* infinities stay */
    return (struct box_span){wide[0], -wide[1]};
}

/* Whether some t of [t_min, t_max] may lie inside the box; rounding never makes it false by mistake. A direction
 * component of 0 makes the slab's t infinite on the right side, or NaN on its very plane, which every comparison
 * ignores. */
static inline bool box_span_meets(struct box_span span, double t_min, double t_max) {
    double enter = span.enter > t_min ? span.enter : t_min, leave = span.leave < t_max ? span.leave : t_max;
    return enter <= leave;
}
static inline bool box_probe_meets(const struct box_probe *probe, const struct box *b, double t_min, double t_max) {
    return box_span_meets(box_probe_span(probe, b), t_min, t_max);
}

#endif
