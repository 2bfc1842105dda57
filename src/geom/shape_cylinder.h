/* The cylinder, capped or open, between any two points. */
#ifndef GRAY_GEOM_SHAPE_CYLINDER_H
#define GRAY_GEOM_SHAPE_CYLINDER_H

#include "geom/conic.h"

/* radius > 0, from != to. With `open` without the discs at the ends. */
struct conic conic_cylinder(struct vec3 from, struct vec3 to, double radius, bool open);

#endif
