/* The cylinder: x^2 + z^2 = r^2 between two heights, a frustum whose radius does not change (Roth, "Ray casting for
 * modeling solids", 1982, has it among his primitives). */
#include "geom/shape_cylinder.h"

#include "geom/shape_cone.h"

struct conic conic_cylinder(struct vec3 from, struct vec3 to, double radius, bool open) {
    return conic_frustum(from, radius, to, radius, open);
}
