/* The paraboloid about the y axis. */
#ifndef GRAY_GEOM_SHAPE_PARABOLOID_H
#define GRAY_GEOM_SHAPE_PARABOLOID_H

#include "geom/conic.h"

/* The tip at the origin, radius > 0 at the height > 0, where it ends. */
struct conic conic_paraboloid(double radius, double height, bool open);

#endif
