/* Conics turned about an axis, in the shape's own space: cylinders, cones, paraboloids and
 * hyperboloids. Lengths between 2^-200 and 2^200. */
#ifndef GRAY_GEOM_CONIC_H
#define GRAY_GEOM_CONIC_H

#include "geom/crossing.h"
#include "geom/hit.h"
#include "math/box.h"
#include "math/ray.h"

/* Points at the height s = (p - base) . axis, lo < s < hi, whose distance from the axis squared is below
 * a s^2 + b s + c. lo and hi may be infinite. With `open` only the side is there, without the two ends. */
struct conic {
    struct vec3 base, axis; /* axis of unit length */
    double a, b, c;
    double lo, hi; /* lo < hi */
    bool open;
};
enum conic_part { CONIC_SIDE, CONIC_LOW_END, CONIC_HIGH_END };

/* About the y axis: the radius squared is a y^2 + b y + c. */
static inline struct conic conic_upright(double a, double b, double c, double lo, double hi, bool open) {
    return (struct conic){.axis = {0, 1, 0}, .a = a, .b = b, .c = c, .lo = lo, .hi = hi, .open = open};
}

/* All crossings of the whole line in order; at most 4. Where an unbounded solid holds the beginning or the end of the
 * line there is a crossing at t = -INFINITY or INFINITY. The same holds for quadric_crossings. */
int conic_crossings(const struct conic *conic, const struct ray *ray, struct crossing out[4]);
bool conic_is_closed(const struct conic *conic);
bool conic_is_convex(const struct conic *conic); /* up to rounding; false where it is not known */
bool conic_contains(const struct conic *conic, struct vec3 point);
/* u runs round the axis, to the right seen from outside with the axis upwards, v along it. */
void conic_describe(const struct conic *conic, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out);
/* The least and the greatest dot(g, p) over the shape; lo > hi when it is empty. */
void conic_extent(const struct conic *conic, struct vec3 g, double *lo, double *hi);

/* --- The cone and the frustum, between any two points --- */

/* Radii >= 0, at least one > 0; from != to. With `open` without the discs at the ends. */
struct conic conic_frustum(struct vec3 from, double from_radius, struct vec3 to, double to_radius, bool open);

/* --- The cylinder, capped or open, between any two points --- */

/* radius > 0, from != to. With `open` without the discs at the ends. */
struct conic conic_cylinder(struct vec3 from, struct vec3 to, double radius, bool open);

/* --- The paraboloid about the y axis --- */

/* The tip at the origin, radius > 0 at the height > 0, where it ends. */
struct conic conic_paraboloid(double radius, double height, bool open);

/* --- The hyperboloids of one and of two sheets about the y axis --- */

/* One sheet: radius `waist` at y = 0 and `rim` > waist at y = lo or hi, whichever is farther. lo < hi. */
struct conic conic_one_sheet(double waist, double rim, double lo, double hi, bool open);
/* Two sheets with their tips at y = -gap and y = gap, radius `rim` at y = -reach and y = reach > gap > 0. */
struct conic conic_two_sheets(double gap, double reach, double rim, bool open);

#endif
