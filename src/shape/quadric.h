/* The general quadric by its ten coefficients, inside a box, in its own space. Lengths between 2^-200 and 2^200. */
#ifndef GRAY_SHAPE_QUADRIC_H
#define GRAY_SHAPE_QUADRIC_H

#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "math/box.h"
#include "math/ray.h"

/* c[0] x^2 + c[1] y^2 + c[2] z^2 + c[3] xy + c[4] xz + c[5] yz + c[6] x + c[7] y + c[8] z + c[9] < 0, inside the limits
 * (min < max, each side may be infinite). With `open` the faces of the limits are not there. Not all of c[0..8]
 * zero. */
struct quadric {
    double c[10];
    struct box limits;
    bool open;
};
enum { QUADRIC_SIDE, QUADRIC_FIRST_FACE }; /* then the faces in the order of enum box_face */

int quadric_crossings(const struct quadric *q, const struct ray *ray, struct crossing out[4]);
bool quadric_is_closed(const struct quadric *q);
bool quadric_contains(const struct quadric *q, struct vec3 point);
/* Image coordinates of an ellipsoid are spherical about its centre, y up; those of other quadrics are cylindrical about
 * the axis whose square differs in sign from the other two (if none does: y), with v along it over the limits, or in
 * units from the middle. A face of the limits shows it upright. */
void quadric_describe(const struct quadric *q, const struct ray *ray, const struct crossing *crossing,
                      struct surface *out);
/* The limits, and for ellipsoids not more than their box. */
struct box quadric_bounds(const struct quadric *q);
/* The least and the greatest dot(g, p) where the quadric is an ellipsoid; false where it is not. */
bool quadric_extent(const struct quadric *q, struct vec3 g, double *lo, double *hi);

#endif
