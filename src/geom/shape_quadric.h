/* Quadrics, each in its own space: conics turned about an axis (cylinder, cone, frustum, paraboloid, both
 * hyperboloids), the ellipsoid, and the general quadric by its ten coefficients inside a box. Lengths between 2^-200
 * and 2^200. */
#ifndef GRAY_GEOM_SHAPE_QUADRIC_H
#define GRAY_GEOM_SHAPE_QUADRIC_H

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

/* Radii > 0 (of the frustum at least one, the other >= 0), from != to, heights > 0. */
struct conic conic_cylinder(struct vec3 from, struct vec3 to, double radius, bool open);
struct conic conic_frustum(struct vec3 from, double from_radius, struct vec3 to, double to_radius, bool open);
/* The tip at the origin, radius r at the height h. */
struct conic conic_paraboloid(double radius, double height, bool open);
/* One sheet: radius `waist` at y = 0 and `rim` > waist at y = lo or hi, whichever is farther. lo < hi. */
struct conic conic_one_sheet(double waist, double rim, double lo, double hi, bool open);
/* Two sheets with their tips at y = -gap and y = gap, radius `rim` at y = -reach and y = reach > gap > 0. */
struct conic conic_two_sheets(double gap, double reach, double rim, bool open);

/* All crossings of the whole line in order; at most 4. Where an unbounded solid holds the beginning or the end of the
 * line there is a crossing at t = -INFINITY or INFINITY. The same holds for quadric_crossings. */
int conic_crossings(const struct conic *conic, const struct ray *ray, struct crossing out[4]);
bool conic_is_closed(const struct conic *conic);
bool conic_contains(const struct conic *conic, struct vec3 point);
/* u runs round the axis, to the right seen from outside with the axis upwards, v along it. */
void conic_describe(const struct conic *conic, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out);
/* The least and the greatest dot(g, p) over the shape; lo > hi when it is empty. */
void conic_extent(const struct conic *conic, struct vec3 g, double *lo, double *hi);

struct ellipsoid {
    struct vec3 centre, radii; /* > 0 */
};

int ellipsoid_crossings(const struct ellipsoid *e, const struct ray *ray, struct crossing out[2]);
bool ellipsoid_contains(const struct ellipsoid *e, struct vec3 point);
void ellipsoid_describe(const struct ellipsoid *e, const struct ray *ray, const struct crossing *crossing,
                        struct surface *out);
void ellipsoid_extent(const struct ellipsoid *e, struct vec3 g, double *lo, double *hi);

/* c[0] x^2 + c[1] y^2 + c[2] z^2 + c[3] xy + c[4] xz + c[5] yz + c[6] x + c[7] y + c[8] z + c[9] < 0, inside the limits
 * (min < max, each side may be infinite). With `open` the faces of the limits are not there. Not all of c[0..8] zero.
 */
struct quadric {
    double c[10];
    struct box limits;
    bool open;
};
enum { QUADRIC_SIDE, QUADRIC_FIRST_FACE }; /* then the faces in the order of enum box_face */

int quadric_crossings(const struct quadric *q, const struct ray *ray, struct crossing out[4]);
bool quadric_is_closed(const struct quadric *q);
bool quadric_contains(const struct quadric *q, struct vec3 point);
void quadric_describe(const struct quadric *q, const struct ray *ray, const struct crossing *crossing,
                      struct surface *out);
/* The limits, and for ellipsoids not more than their box. */
struct box quadric_bounds(const struct quadric *q);
/* The least and the greatest dot(g, p) where the quadric is an ellipsoid; false where it is not. */
bool quadric_extent(const struct quadric *q, struct vec3 g, double *lo, double *hi);

#endif
