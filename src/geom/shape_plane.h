/* The infinite plane, and the half-space behind it. */
#ifndef GRAY_GEOM_SHAPE_PLANE_H
#define GRAY_GEOM_SHAPE_PLANE_H

#include "geom/flat.h"

/* { p : normal . p = distance }, normal of any length > 0, distance in units of length. As a solid the plane is the
 * half-space behind it. */
struct flat flat_plane(struct vec3 normal, double distance);

/* The line is at t = -height / climb in the plane (not finite: along it), whose height above the plane at its origin
 * is given, and goes in or out there. Two crossings, one of them without end; 0 of a line along the plane outside. */
static inline int plane_crossings(double t, bool enter, double height, const struct ray *ray, struct crossing out[2]) {
    /* A line along the plane is inside as a whole or not at all. */
    bool crosses = isfinite(t);
    if (!crosses && !(height < 0 && vec3_max_abs(ray->direction) > 0))
        return 0;
    out[0] = (struct crossing){.t = crosses && enter ? t : -INFINITY, .enter = true};
    out[1] = (struct crossing){.t = crosses && !enter ? t : INFINITY, .enter = false};
    return 2;
}
/* Takes the ends off [lo, hi] that the half-space does not have along g. */
void plane_extent(struct vec3 normal, struct vec3 g, double *lo, double *hi);

#endif
