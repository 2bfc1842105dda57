/* The ellipsoid with its axes along x, y and z, in its own space. */
#ifndef GRAY_GEOM_SHAPE_ELLIPSOID_H
#define GRAY_GEOM_SHAPE_ELLIPSOID_H

#include "geom/crossing.h"
#include "geom/hit.h"
#include "math/ray.h"

struct ellipsoid {
    struct vec3 centre, radii; /* > 0 */
};

int ellipsoid_crossings(const struct ellipsoid *e, const struct ray *ray, struct crossing out[2]);
bool ellipsoid_contains(const struct ellipsoid *e, struct vec3 point);
void ellipsoid_describe(const struct ellipsoid *e, const struct ray *ray, const struct crossing *crossing,
                        struct surface *out);
void ellipsoid_extent(const struct ellipsoid *e, struct vec3 g, double *lo, double *hi);

#endif
