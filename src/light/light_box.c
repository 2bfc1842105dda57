/* See light_box.h. The line from the point enters the box through the face whose plane it crosses last (Kay and Kajiya,
 * "Ray Tracing Complex Scenes", SIGGRAPH 1986). */
#include "light/light_box.h"

/* How far the point is along an edge, in lengths of it: below 0 or above 1 it is on the outer side of a face. */
static double along_edge(const struct light_box *box, int axis, struct vec3 point) {
    const struct vec3 *edge = &box->edges[axis];
    return vec3_dot(vec3_sub(point, box->corner), *edge) / vec3_length_squared(*edge);
}

bool spherical_box_make(const struct light_box *box, struct vec3 from, struct spherical_box *out) {
    out->count = 0;
    out->angle = 0;
    for (int axis = 0; axis < 3; axis++) {
        double along = along_edge(box, axis, from);
        if (!(along < 0) && !(along > 1))
            continue;
        struct vec3 corner = along > 1 ? vec3_add(box->corner, box->edges[axis]) : box->corner;
        struct spherical_rectangle *face = &out->faces[out->count];
        if (!spherical_rectangle_make(corner, box->edges[(axis + 1) % 3], box->edges[(axis + 2) % 3], from, face))
            continue;
        out->angle += face->angle;
        out->axes[out->count++] = axis;
    }
    return out->count > 0;
}

struct vec3 spherical_box_point(const struct spherical_box *seen, struct sample2 place) {
    double angle = place.x * seen->angle;
    uint32_t face = 0;
    while (face + 1 < seen->count && angle >= seen->faces[face].angle)
        angle -= seen->faces[face++].angle;
    double x = angle / seen->faces[face].angle;
    return spherical_rectangle_point(&seen->faces[face], (struct sample2){x < 1 ? x : 1, place.y});
}

double spherical_box_pdf(const struct light_box *box, const struct spherical_box *seen, struct vec3 from,
                         struct vec3 direction) {
    double last = -INFINITY;
    int entered = 0;
    for (int axis = 0; axis < 3; axis++) {
        double along = along_edge(box, axis, from), step = vec3_dot(direction, box->edges[axis]);
        if (!(along < 0) && !(along > 1))
            continue;
        double t = ((along > 1 ? 1 : 0) - along) * vec3_length_squared(box->edges[axis]) / step;
        if (t > last) {
            last = t;
            entered = axis;
        }
    }
    for (uint32_t i = 0; i < seen->count; i++)
        if (seen->axes[i] == entered)
            return 1 / seen->angle;
    return 0;
}
