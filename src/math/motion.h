/* The pose of an object at a time: a pose that moves at a constant velocity, or from one pose to another between time 0
 * and time 1. */
#ifndef GRAY_MATH_MOTION_H
#define GRAY_MATH_MOTION_H

#include "math/affine.h"
#include "math/box.h"

/* When rays pass the shutter; a ray's own time runs from 0 (open) to 1 (close). */
struct shutter {
    double open, close;
};

static inline double shutter_time(struct shutter shutter, double ray_time) {
    return shutter.open + ray_time * (shutter.close - shutter.open);
}

/* parent_from_node(t) = translation(t) turn(t) stretch(t) spin(t); without `has_end` only translation(t), with `spins`
 * translation(t) rest spin(t). */
struct motion {
    struct vec3 velocity;  /* at all times */
    bool has_end;          /* two poses: from time 0 to time 1, at rest before and after */
    struct transform rest; /* the first of them */
    struct vec3 from, to;  /* their translations */
    struct vec3 axis;      /* in parent space; the turn from the first pose to the second */
    double degrees;        /* 0 .. 180 */
    struct affine first;   /* at time 0, without the translation: turn and stretch */
    struct affine change;  /* the first turn times the difference of the stretches */
    bool spins;            /* a rotation about an axis through the origin of the node's own space */
    struct vec3 spin_axis; /* its length does not matter */
    double spin;           /* degrees per unit of time */
    double spin_start;     /* degrees at time 0 */
};

struct motion motion_of_velocity(struct vec3 velocity);
/* A pose that spins and moves at a constant velocity. */
struct motion motion_of_spin(const struct transform *pose, struct vec3 velocity, struct vec3 axis, double degrees);
/* The linear parts are split into a rotation and a stretch; the rotation follows the shorter arc about one axis,
 * stretch and translation change linearly. False: one pose is a mirror image of the other, and no rotation connects
 * them. */
bool motion_interpolate(const struct transform *from, const struct transform *to, struct vec3 velocity,
                        struct motion *out);
/* The transform at a time. */
struct transform motion_at(const struct motion *motion, double time);
/* A box that contains the region that `box` (in node space) covers from time `open` to `close`. */
struct box motion_bounds(const struct motion *motion, const struct box *box, struct shutter shutter);

#endif
