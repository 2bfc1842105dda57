/* Angles round an axis, for image coordinates. */
#ifndef GRAY_GEOM_WRAP_H
#define GRAY_GEOM_WRAP_H

#include "math/vec3.h"

/* Unit vectors at right angles to the unit vector `axis` from which angles are counted; x and z for the axis y. */
void wrap_axes(struct vec3 axis, struct vec3 *x, struct vec3 *z);

#endif
