/* The square, the rectangle and the parallelogram. */
#ifndef GRAY_GEOM_SHAPE_RECTANGLE_H
#define GRAY_GEOM_SHAPE_RECTANGLE_H

#include "geom/flat.h"

/* From a corner along two edges that are not parallel; the front is where `along` turns to `up` counter-clockwise, and
 * there an image stands upright. */
struct flat flat_parallelogram(struct vec3 corner, struct vec3 along, struct vec3 up);
/* The square of docs/language.md 3.3: -0.5 .. 0.5 in x and z at y = 0, normal +y. */
struct flat flat_square(void);

static inline bool parallelogram_holds(double a, double b) {
    return a >= 0 && a <= 1 && b >= 0 && b <= 1;
}

#endif
