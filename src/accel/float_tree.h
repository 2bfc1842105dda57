/* Binary hierarchies over boxes in single precision, for searches on graphics cards: a node is four loads of 16 bytes,
 * and a step needs no double. Made of the hierarchy of box_tree.h, so a scene gives the same bytes for any number of
 * threads. Boxes only propose: what a leaf contains is decided in double precision, so no picture depends on them.
 *
 * No box is left out that contains the point of a hit. Let M be the largest coordinate of the ray's origin and of the
 * box. A hit is computed in doubles, so its point is off by a few 2^-53 M along each axis; planes lie outside of it by
 * 2^-40 of the box's coordinates and are rounded outwards, the origin is an interval with a slack of 2^-40 of its own:
 * together at least 2^-41 M. With planes and origin in floats, a quotient (plane - origin) / direction has four
 * roundings of at most 2^-24 (2^-22 for a direction that is denormal), which the factor 2^-20 of the comparison covers;
 * products that are denormal are off by 2^-150, where the slack 2^-100 of the origin makes 2^-132 for directions of at
 * most 2^32. A component whose reciprocal overflows counts as 0: until t = 2 M 2^32 such a ray moves by less than
 * 2^-90 M along that axis. Infinite boxes have infinite planes. A NaN, as of 0 times infinity, does not exclude a box:
 * minima and maxima take the other number, or become NaN, and the comparison is the negation of "above". Rays whose
 * numbers have other magnitudes, or are not finite, get NaN in the place of reciprocals and meet all boxes. */
#ifndef GRAY_ACCEL_FLOAT_TREE_H
#define GRAY_ACCEL_FLOAT_TREE_H

#include "base/error.h"
#include "base/pool.h"
#include "math/box.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A child, and the root: a node, or a leaf, which is an item of its own, or a run of 1 to 4 items: numbers of entries
 * in `order`, the first in the 28 low bits, how many more above them. */
#define FLOAT_TREE_LEAF UINT32_C(0x80000000)
#define FLOAT_TREE_SINGLE UINT32_C(0x40000000) /* a leaf with the item in the bits below */
#define FLOAT_TREE_NONE UINT32_MAX             /* the root of nothing */
enum {
    FLOAT_TREE_DEPTH = 40, /* of nodes on the way to a leaf: so many entries of a stack suffice */
    FLOAT_TREE_RUN = 4,
    FLOAT_TREE_RUN_SHIFT = 28,
    FLOAT_TREE_MANY = 1 << FLOAT_TREE_RUN_SHIFT, /* items in runs; also a bound of items of their own */
};

struct float_node {
    float box[2][6]; /* of each child: the lower, then the upper sides */
    uint32_t child[2], padding[2];
} __attribute__((aligned(16)));

/* Aligned parts of nodes and of triangles: one load each. */
typedef float float_quad __attribute__((vector_size(16), may_alias));
typedef double double_pair __attribute__((vector_size(16), may_alias));

/* Zero-initialised: no hierarchies. Owner: the holder, float_trees_destroy. */
struct float_trees {
    struct float_node *nodes;
    uint32_t *order; /* the items of all runs, as leaves lie in memory */
    uint32_t node_count, node_room, order_count, order_room;
};

/* Items below `singles` become leaves of their own, the others runs; empty boxes are left out. */
struct float_tree_items {
    const struct box *boxes;
    uint32_t count, singles;
};

/* One more hierarchy. False: no memory or cancelled. */
bool float_trees_add(struct float_trees *trees, const struct float_tree_items *items, struct pool *pool, uint32_t *root,
                     struct error *error);
void float_trees_destroy(struct float_trees *trees);

/* A ray for boxes. */
struct float_ray {
    float low[3], high[3], inverse[3], t_min; /* the origin lies between low and high */
};
void float_ray_set(struct float_ray *out, const struct ray *ray);

/* A float that is not below t. */
static inline float float_ray_end(double t) {
    const float end = (float)t;
    return end + fabsf(end) * 0x1p-22f + 0x1p-120f;
}

/* The sign of a zero does not matter here; of a NaN and a number both may come out. */
static inline float float_lesser(float a, float b) {
#ifdef GRAY_DEVICE
    return __builtin_fminf(a, b);
#else
    return a < b ? a : b;
#endif
}
static inline float float_greater(float a, float b) {
#ifdef GRAY_DEVICE
    return __builtin_fmaxf(a, b);
#else
    return a > b ? a : b;
#endif
}

/* Whether a hit with t_min < t <= end may lie in the box, and about where the ray enters it. */
static inline bool float_ray_meets(const struct float_ray *ray, const float box[6], float end, float *enter) {
    const float ax = (box[0] - ray->high[0]) * ray->inverse[0], bx = (box[3] - ray->low[0]) * ray->inverse[0];
    const float ay = (box[1] - ray->high[1]) * ray->inverse[1], by = (box[4] - ray->low[1]) * ray->inverse[1];
    const float az = (box[2] - ray->high[2]) * ray->inverse[2], bz = (box[5] - ray->low[2]) * ray->inverse[2];
    *enter = float_greater(float_greater(float_lesser(ax, bx), float_lesser(ay, by)),
                           float_greater(float_lesser(az, bz), ray->t_min));
    const float leave = float_lesser(float_lesser(float_greater(ax, bx), float_greater(ay, by)),
                                     float_lesser(float_greater(az, bz), end));
    return !(*enter > leave + fabsf(leave) * 0x1p-20f);
}

#endif
