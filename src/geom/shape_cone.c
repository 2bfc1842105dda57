/* The cone. The radius grows evenly with the height s: x^2 + z^2 = (r0 + m s)^2, m = (r1 - r0) / length, whose second
 * nappe the limits of the height leave out (Apollonius' cone in Cartesian form; Haines in Glassner, "An Introduction to
 * Ray Tracing", 1989, ch. 2, intersects it the same way). */
#include "geom/shape_cone.h"

struct conic conic_frustum(struct vec3 from, double from_radius, struct vec3 to, double to_radius, bool open) {
    struct vec3 way = vec3_sub(to, from);
    double length = vec3_length(way), slope = (to_radius - from_radius) / length;
    return (struct conic){.base = from,
                          .axis = vec3_normalize(way),
                          .a = slope * slope,
                          .b = 2 * from_radius * slope,
                          .c = from_radius * from_radius,
                          .lo = 0,
                          .hi = length,
                          .open = open};
}
