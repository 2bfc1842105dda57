/* Coordinate frames from one direction. */
#ifndef GRAY_MATH_FRAME_H
#define GRAY_MATH_FRAME_H

#include "math/vec3.h"

/* Two unit vectors at right angles to the unit vector n and each other (Duff et al., "Building an Orthonormal Basis,
 * Revisited", JCGT 2017). */
static inline void frame_tangents(struct vec3 n, struct vec3 *a, struct vec3 *b) {
    double sign = n.z < 0 ? -1 : 1, s = -1 / (sign + n.z), c = n.x * n.y * s;
    *a = vec3_make(1 + sign * n.x * n.x * s, sign * c, -sign * n.x);
    *b = vec3_make(c, sign + n.y * n.y * s, -n.y);
}

#endif
