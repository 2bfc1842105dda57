/* The plane, normal . p = distance (Hesse's normal form). A line is inside the half-space behind it on one side of its
 * only crossing, so in CSG there is a second one at infinity. */
#include "geom/shape_plane.h"

struct flat flat_plane(struct vec3 normal, double distance) {
    struct flat f = {.kind = FLAT_PLANE, .normal = vec3_normalize(normal)};
    f.origin = vec3_scale(f.normal, distance);
    flat_across(f.normal, &f.u, &f.v);
    return f;
}

void plane_extent(struct vec3 normal, struct vec3 g, double *lo, double *hi) {
    /* Behind the plane everything is inside: only along the normal is there an end. */
    double along = vec3_dot(g, normal);
    struct vec3 rest = vec3_add_scaled(g, normal, -along);
    bool straight = vec3_max_abs(rest) == 0;
    if (!(straight && along >= 0))
        *hi = INFINITY;
    if (!(straight && along <= 0))
        *lo = -INFINITY;
}
