/* The triangle by its barycentric coordinates (Moebius, "Der barycentrische Calcul", 1827): none may be negative, the
 * third being 1 - a - b. Two triangles with a common edge are two shapes; what must be watertight is a mesh. */
#include "geom/shape_triangle.h"

struct flat flat_triangle(struct vec3 a, struct vec3 b, struct vec3 c) {
    struct vec3 u = vec3_sub(b, a), v = vec3_sub(c, a);
    return (struct flat){.kind = FLAT_TRIANGLE, .origin = a, .u = u, .v = v, .normal = vec3_cross(u, v)};
}
