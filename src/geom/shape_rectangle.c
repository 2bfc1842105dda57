/* The rectangle and its relatives: oblique coordinates along two edges, both from 0 to 1 (Moeller and Trumbore, "Fast,
 * minimum storage ray/triangle intersection", JGT 1997, without the diagonal). */
#include "geom/shape_rectangle.h"

struct flat flat_parallelogram(struct vec3 corner, struct vec3 along, struct vec3 up) {
    return (struct flat){
        .kind = FLAT_PARALLELOGRAM, .origin = corner, .u = along, .v = up, .normal = vec3_cross(along, up)};
}

struct flat flat_square(void) {
    return flat_parallelogram(vec3_make(-0.5, 0, 0.5), vec3_make(1, 0, 0), vec3_make(0, 0, -1));
}
