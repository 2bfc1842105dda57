/* The cone and the frustum, between any two points. */
#ifndef GRAY_GEOM_SHAPE_CONE_H
#define GRAY_GEOM_SHAPE_CONE_H

#include "geom/conic.h"

/* Radii >= 0, at least one > 0; from != to. With `open` without the discs at the ends. */
struct conic conic_frustum(struct vec3 from, double from_radius, struct vec3 to, double to_radius, bool open);

#endif
