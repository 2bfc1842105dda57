/* The polygon: convex, concave, with holes. */
#ifndef GRAY_GEOM_SHAPE_POLYGON_H
#define GRAY_GEOM_SHAPE_POLYGON_H

#include "base/arena.h"
#include "geom/flat.h"

/* Outlines of points that lie in one plane, one after the other; ends[i] is one past the last point of outline i. A
 * point is inside when it is so by the even-odd rule over all outlines; the front sees the first outline
 * counter-clockwise. False, with what is wrong in `why`: fewer than three points, no area, not flat, or (why = NULL) no
 * memory. */
bool flat_polygon(struct arena *arena, const struct vec3 *points, const uint32_t *ends, uint32_t outlines,
                  struct flat *out, const char **why);

bool polygon_holds(const struct polygon *polygon, double a, double b);
double polygon_largest(const struct polygon *polygon); /* coordinate of its corners */
void polygon_extent(const struct polygon *polygon, struct vec3 g, double *lo, double *hi);

#endif
