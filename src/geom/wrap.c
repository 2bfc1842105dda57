/* Directions across an axis that do not depend on its length or turn (Duff et al., "Building an Orthonormal Basis,
 * Revisited", JCGT 2017). */
#include "geom/wrap.h"

void wrap_axes(struct vec3 n, struct vec3 *x, struct vec3 *z) {
    double sign = n.y < 0 ? -1 : 1, s = -1 / (sign + n.y), c = n.x * n.z * s;
    *x = vec3_make(1 + sign * n.x * n.x * s, -sign * n.x, sign * c);
    *z = vec3_make(c, -n.z, sign + n.z * n.z * s);
}
