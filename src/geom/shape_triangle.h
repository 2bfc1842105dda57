/* The single triangle; many of them are a mesh. */
#ifndef GRAY_GEOM_SHAPE_TRIANGLE_H
#define GRAY_GEOM_SHAPE_TRIANGLE_H

#include "geom/flat.h"

/* The front sees the corners counter-clockwise. */
struct flat flat_triangle(struct vec3 a, struct vec3 b, struct vec3 c);

static inline bool triangle_holds(double a, double b) {
    return a >= 0 && b >= 0 && a + b <= 1;
}

#endif
