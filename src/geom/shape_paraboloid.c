/* The paraboloid: x^2 + z^2 = (r^2 / h) y, the square of the radius grows evenly with the height (Archimedes, "On
 * conoids and spheroids"). */
#include "geom/shape_paraboloid.h"

struct conic conic_paraboloid(double radius, double height, bool open) {
    return conic_upright(0, radius * (radius / height), 0, 0, height, open);
}
