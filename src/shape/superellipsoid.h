/* The superellipsoid: (|x|^(2/e) + |z|^(2/e))^(e/n) + |y|^(2/n) < 1. e is its roundness as seen along the y axis, n
 * that of its profile: 1 and 1 is the sphere, near 0 the cube, 2 an octahedron, beyond it stars. 0.02 <= e, n <= 20. */
#ifndef GRAY_SHAPE_SUPERELLIPSOID_H
#define GRAY_SHAPE_SUPERELLIPSOID_H

#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "math/ray.h"

struct superellipsoid {
    double e, n;
};

enum { SUPERELLIPSOID_MAX = 16 };

/* All crossings of the whole line in order, an even number. Those of a solid with e, n <= 2 are two or none. */
int superellipsoid_crossings(const struct superellipsoid *s, const struct ray *ray,
                             struct crossing out[SUPERELLIPSOID_MAX]);
bool superellipsoid_contains(const struct superellipsoid *s, struct vec3 point);
void superellipsoid_describe(const struct superellipsoid *s, const struct ray *ray, const struct crossing *crossing,
                             struct surface *out);
void superellipsoid_extent(const struct superellipsoid *s, struct vec3 g, double *lo, double *hi);

#endif
