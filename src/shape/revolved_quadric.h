/* Quadrics of revolution, in the shape's own space: cylinders, cones, paraboloids and
 * hyperboloids. Lengths between 2^-200 and 2^200. */
#ifndef GRAY_SHAPE_REVOLVED_QUADRIC_H
#define GRAY_SHAPE_REVOLVED_QUADRIC_H

#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "math/box.h"
#include "math/ray.h"

/* Points at the height s = (p - base) . axis, lo < s < hi, whose distance from the axis squared is below
 * a s^2 + b s + c. lo and hi may be infinite. With `open` only the side is there, without the two ends. */
struct revolved_quadric {
    struct vec3 base, axis; /* axis of unit length */
    double a, b, c;
    double lo, hi; /* lo < hi */
    bool open;
};
enum revolved_quadric_part { REVOLVED_QUADRIC_SIDE, REVOLVED_QUADRIC_LOW_END, REVOLVED_QUADRIC_HIGH_END };

/* About the y axis: the radius squared is a y^2 + b y + c. */
static inline struct revolved_quadric revolved_quadric_upright(double a, double b, double c, double lo, double hi,
                                                               bool open) {
    return (struct revolved_quadric){.axis = {0, 1, 0}, .a = a, .b = b, .c = c, .lo = lo, .hi = hi, .open = open};
}

/* All crossings of the whole line in order; at most 4. If an unbounded solid contains the beginning or the end of the
 * line there is a crossing at t = -INFINITY or INFINITY. The same is true for quadric_crossings. */
int revolved_quadric_crossings(const struct revolved_quadric *revolved_quadric, const struct ray *ray,
                               struct crossing out[4]);
bool revolved_quadric_is_closed(const struct revolved_quadric *revolved_quadric);
bool revolved_quadric_is_convex(
    const struct revolved_quadric *revolved_quadric); /* up to rounding; false where it is not known */
bool revolved_quadric_contains(const struct revolved_quadric *revolved_quadric, struct vec3 point);
/* u runs around the axis, to the right seen from outside with the axis upwards, v along it. */
void revolved_quadric_describe(const struct revolved_quadric *revolved_quadric, const struct ray *ray,
                               const struct crossing *crossing, struct surface *out);
/* The least and the greatest dot(g, p) over the shape; lo > hi when it is empty. */
void revolved_quadric_extent(const struct revolved_quadric *revolved_quadric, struct vec3 g, double *lo, double *hi);

/* --- The cone and the frustum, between any two points --- */

/* Radii >= 0, at least one > 0; from != to. With `open` without the discs at the ends. */
struct revolved_quadric revolved_quadric_frustum(struct vec3 from, double from_radius, struct vec3 to, double to_radius,
                                                 bool open);

/* --- The cylinder, capped or open, between any two points --- */

/* radius > 0, from != to. With `open` without the discs at the ends. */
struct revolved_quadric revolved_quadric_cylinder(struct vec3 from, struct vec3 to, double radius, bool open);

/* --- The paraboloid about the y axis --- */

/* The tip at the origin, radius > 0 at the height > 0, where it ends. */
struct revolved_quadric revolved_quadric_paraboloid(double radius, double height, bool open);

/* --- The hyperboloids of one and of two sheets about the y axis --- */

/* One sheet: radius `waist` at y = 0 and `rim` > waist at y = lo or hi, whichever is farther. lo < hi. */
struct revolved_quadric revolved_quadric_one_sheet(double waist, double rim, double lo, double hi, bool open);
/* Two sheets with their tips at y = -gap and y = gap, radius `rim` at y = -reach and y = reach > gap > 0. */
struct revolved_quadric revolved_quadric_two_sheets(double gap, double extent, double rim, bool open);

#endif
