/* The torus about the y axis, centred on the origin: points nearer than `minor` to the circle of radius `major` in y =
 * 0. major >= 0, minor > 0, both between 2^-100 and 2^100. With minor > major the surface is the outer one alone, the
 * solid has no hole. */
#ifndef GRAY_SHAPE_TORUS_H
#define GRAY_SHAPE_TORUS_H

#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "math/ray.h"

struct torus {
    double major, minor;
};

/* All crossings of the whole line in order: 0, 2 or 4. */
int torus_crossings(const struct torus *torus, const struct ray *ray, struct crossing out[4]);
bool torus_contains(const struct torus *torus, struct vec3 point);
/* u runs around the axis, to the right seen from outside, v around the tube, upwards on the outer side; from and to the
 * inner equator. */
void torus_describe(const struct torus *torus, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out);
void torus_extent(const struct torus *torus, struct vec3 g, double *lo, double *hi);

#endif
