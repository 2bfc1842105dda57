/* Flat shapes, anywhere in space: what is common to shape_plane.h, shape_rectangle.h, shape_disc.h, shape_triangle.h
 * and shape_polygon.h, which make them. A point is origin + a u + b v; a and b decide whether it belongs to the shape
 * and are its image coordinates, so u points along the rows of an image and v up its columns. The normal's side is the
 * front. */
#ifndef GRAY_GEOM_FLAT_H
#define GRAY_GEOM_FLAT_H

#include "geom/crossing.h"
#include "geom/hit.h"
#include "math/ray.h"

enum flat_kind { FLAT_PLANE, FLAT_PARALLELOGRAM, FLAT_DISC, FLAT_TRIANGLE, FLAT_POLYGON };

struct polygon; /* the outlines in (a, b); lives in an arena */

struct flat {
    enum flat_kind kind;
    struct vec3 origin, u, v;
    struct vec3 normal; /* at right angles to u and v, not 0 */
    double inner;       /* disc: radius of the hole as a share of the disc's */
    const struct polygon *polygon;
};

/* Two unit vectors across the unit vector n, so that an image on the front stands upright: the first is level, the
 * second goes up. x and -z for n = y. */
void flat_across(struct vec3 n, struct vec3 *level, struct vec3 *up);

/* 0 or 1 crossings; of the plane as a half-space, one more at t = -INFINITY or INFINITY where the line is inside. A
 * line in the plane does not cross. */
int flat_crossings(const struct flat *flat, const struct ray *ray, struct crossing out[2]);
bool flat_contains(const struct flat *flat, struct vec3 point); /* of the half-space; else false */
void flat_describe(const struct flat *flat, const struct ray *ray, const struct crossing *crossing,
                   struct surface *out);
void flat_extent(const struct flat *flat, struct vec3 g, double *lo, double *hi);

#endif
