/* The box, by slabs (Kay and Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986). Per axis the line is inside between
 * two t; the line is inside the box where it is inside all three slabs. Each t is one subtraction and one division,
 * both rounded once, so two boxes with a common face plane in one space get exactly the same t there, and the order of
 * t is the order of the planes. */
#include "shape/box_shape_internal.h"

#include <math.h>

bool box_shape_crossings(const struct box *box, const struct ray *ray, struct crossing out[2]) {
    double enter = -INFINITY, leave = INFINITY;
    uint32_t enter_part = 0, leave_part = 0;
    for (int axis = 0; axis < 3; axis++) {
        double o = vec3_get(ray->origin, axis), d = vec3_get(ray->direction, axis);
        double lo = vec3_get(box->min, axis), hi = vec3_get(box->max, axis);
        if (d == 0) { /* -0 as well */
            if (!(o > lo && o < hi))
                return false;
            continue;
        }
        uint32_t positive = 2 * (uint32_t)axis, negative = positive + 1;
        double near = ((d > 0 ? lo : hi) - o) / d, far = ((d > 0 ? hi : lo) - o) / d;
        if (near > enter) {
            enter = near;
            enter_part = d > 0 ? negative : positive;
        }
        if (far < leave) {
            leave = far;
            leave_part = d > 0 ? positive : negative;
        }
    }
    if (!(enter < leave) || !isfinite(enter) || !isfinite(leave)) /* not finite: no direction, or beyond all numbers */
        return false;
    out[0] = (struct crossing){.t = enter, .part = enter_part, .enter = true};
    out[1] = (struct crossing){.t = leave, .part = leave_part, .enter = false};
    return true;
}

bool box_shape_contains(const struct box *box, struct vec3 p) {
    return p.x > box->min.x && p.x < box->max.x && p.y > box->min.y && p.y < box->max.y && p.z > box->min.z &&
           p.z < box->max.z;
}

void box_face_point(const struct box *box, enum box_face face, struct vec3 *point, struct vec3 *normal) {
    *normal = (struct vec3){0, 0, 0};
    switch (face) {
    case BOX_POSITIVE_X:
        point->x = box->max.x, normal->x = 1;
        break;
    case BOX_NEGATIVE_X:
        point->x = box->min.x, normal->x = -1;
        break;
    case BOX_POSITIVE_Y:
        point->y = box->max.y, normal->y = 1;
        break;
    case BOX_NEGATIVE_Y:
        point->y = box->min.y, normal->y = -1;
        break;
    case BOX_POSITIVE_Z:
        point->z = box->max.z, normal->z = 1;
        break;
    case BOX_NEGATIVE_Z:
        point->z = box->min.z, normal->z = -1;
        break;
    }
}

/* The cube image: fraction of columns from the left and of rows from the top on each face, from the point q in the unit
 * cube, and the derivatives of the point by them. Images on the sides are upright; front (+z), top and bottom join at
 * the edges. */
static void face_image(enum box_face face, struct vec3 q, struct vec3 size, struct surface *out) {
    struct vec3 x = {size.x, 0, 0}, y = {0, size.y, 0}, z = {0, 0, size.z};
    switch (face) {
    case BOX_POSITIVE_Z:
        out->u = q.x, out->v = 1 - q.y, out->dpdu = x, out->dpdv = vec3_negate(y);
        break;
    case BOX_NEGATIVE_Z:
        out->u = 1 - q.x, out->v = 1 - q.y, out->dpdu = vec3_negate(x), out->dpdv = vec3_negate(y);
        break;
    case BOX_POSITIVE_X:
        out->u = 1 - q.z, out->v = 1 - q.y, out->dpdu = vec3_negate(z), out->dpdv = vec3_negate(y);
        break;
    case BOX_NEGATIVE_X:
        out->u = q.z, out->v = 1 - q.y, out->dpdu = z, out->dpdv = vec3_negate(y);
        break;
    case BOX_POSITIVE_Y:
        out->u = q.x, out->v = q.z, out->dpdu = x, out->dpdv = z;
        break;
    case BOX_NEGATIVE_Y:
        out->u = q.x, out->v = 1 - q.z, out->dpdu = x, out->dpdv = vec3_negate(z);
        break;
    }
}

void box_shape_describe(const struct box *box, const struct ray *ray, const struct crossing *crossing,
                        struct surface *out) {
    /* The face's own coordinate is exact, the others stay on the face. */
    struct vec3 point = vec3_min(vec3_max(ray_at(ray, crossing->t), box->min), box->max);
    struct vec3 normal;
    enum box_face face = (enum box_face)crossing->part;
    box_face_point(box, face, &point, &normal);
    double low = vec3_max_abs(box->min), high = vec3_max_abs(box->max);
    surface_make(out, point, normal, 0x1p-50 * (low > high ? low : high));
    out->has_uv = true;
    struct vec3 size = vec3_sub(box->max, box->min), from_corner = vec3_sub(point, box->min);
    struct vec3 q = {from_corner.x / size.x, from_corner.y / size.y, from_corner.z / size.z};
    face_image(face, q, size, out);
}
