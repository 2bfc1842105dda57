/* The general quadric. Along a line its polynomial has degree two for all coefficients: the part of the line
 * where it is negative, cut by the box that limits it, gives the crossings (span_internal.h; Cychosz and Waggenspack,
 * "Intersecting a ray with a quadric surface", Graphics Gems III, 1992). A described point is put back on the surface
 * by two Newton steps along the gradient. An ellipsoid among them is known by its matrix, which is positive definite;
 * its box follows from the inverse. */
#include "shape/quadric.h"

#include "shape/box_shape_internal.h"
#include "shape/planar.h"
#include "shape/span_internal.h"

static double quadric_value(const struct quadric *q, struct vec3 p) {
    const double *c = q->c;
    return (c[0] * p.x + c[3] * p.y + c[4] * p.z + c[6]) * p.x + (c[1] * p.y + c[5] * p.z + c[7]) * p.y +
           (c[2] * p.z + c[8]) * p.z + c[9];
}

static double quadric_magnitude(const struct quadric *q, struct vec3 p) {
    const double *c = q->c;
    double x = fabs(p.x), y = fabs(p.y), z = fabs(p.z);
    return (fabs(c[0]) * x + fabs(c[3]) * y + fabs(c[4]) * z + fabs(c[6])) * x +
           (fabs(c[1]) * y + fabs(c[5]) * z + fabs(c[7])) * y + (fabs(c[2]) * z + fabs(c[8])) * z + fabs(c[9]);
}

static struct vec3 quadric_gradient(const struct quadric *q, struct vec3 p) {
    const double *c = q->c;
    return (struct vec3){2 * c[0] * p.x + c[3] * p.y + c[4] * p.z + c[6],
                         2 * c[1] * p.y + c[3] * p.x + c[5] * p.z + c[7],
                         2 * c[2] * p.z + c[4] * p.x + c[5] * p.y + c[8]};
}

int quadric_crossings(const struct quadric *q, const struct ray *ray, struct crossing out[4]) {
    double unit = direction_unit(ray->direction);
    struct vec3 d = vec3_scale(ray->direction, unit), o = ray->origin;
    if (!(vec3_max_abs(d) > 0))
        return 0;
    const struct box *b = &q->limits;
    struct span limits = {{-INFINITY, 0}, {INFINITY, 0}}, spans[2];
    for (uint32_t axis = 0; axis < 3; axis++) {
        double lo = vec3_get(b->min, (int)axis), hi = vec3_get(b->max, (int)axis);
        uint32_t positive = QUADRIC_FIRST_FACE + 2 * axis, negative = positive + 1;
        if (!cut_by_slab(vec3_get(o, (int)axis), vec3_get(d, (int)axis), (struct slab){lo, hi, negative, positive},
                         &limits))
            return 0;
    }
    struct vec3 middle = {middle_of(b->min.x, b->max.x), middle_of(b->min.y, b->max.y), middle_of(b->min.z, b->max.z)};
    double shift = -vec3_dot(vec3_sub(o, middle), d) / vec3_dot(d, d);
    o = vec3_add_scaled(o, d, shift);
    const double *c = q->c;
    double square = (c[0] * d.x + c[3] * d.y + c[4] * d.z) * d.x + (c[1] * d.y + c[5] * d.z) * d.y + c[2] * d.z * d.z;
    int count = negative_spans(square, vec3_dot(quadric_gradient(q, o), d), quadric_value(q, o), shift, spans);
    count = q->open ? open_crossings(spans, count, &limits, out) : closed_crossings(spans, count, &limits, out);
    return unit == 1 ? count : scale_back(out, count, unit);
}

bool quadric_is_closed(const struct quadric *q) {
    const struct box *b = &q->limits;
    return !q->open || !(isfinite(b->min.x) || isfinite(b->min.y) || isfinite(b->min.z) || isfinite(b->max.x) ||
                         isfinite(b->max.y) || isfinite(b->max.z));
}

bool quadric_contains(const struct quadric *q, struct vec3 point) {
    return box_shape_contains(&q->limits, point) && quadric_value(q, point) < 0;
}

/* The quadratic part as a matrix, its adjugate and determinant, and where the gradient vanishes. */
struct centred {
    double cx, cy, cz, kxy, kxz, kyz; /* the adjugate */
    double det;
    struct vec3 centre;
    bool has_centre, definite; /* one centre; the matrix is positive definite */
};

static struct centred centred(const struct quadric *q) {
    const double *c = q->c;
    double xx = c[0], yy = c[1], zz = c[2], xy = c[3] / 2, xz = c[4] / 2, yz = c[5] / 2;
    double cx = yy * zz - yz * yz, cy = xx * zz - xz * xz, cz = xx * yy - xy * xy;
    double kxy = xz * yz - xy * zz, kxz = xy * yz - xz * yy, kyz = xy * xz - yz * xx;
    double det = xx * cx + xy * kxy + xz * kxz;
    double size = fabs(xx) + fabs(yy) + fabs(zz) + fabs(xy) + fabs(xz) + fabs(yz), min = 0x1p-30 * size * size * size;
    struct vec3 g = {-c[6] / (2 * det), -c[7] / (2 * det), -c[8] / (2 * det)};
    return (struct centred){.cx = cx,
                            .cy = cy,
                            .cz = cz,
                            .kxy = kxy,
                            .kxz = kxz,
                            .kyz = kyz,
                            .det = det,
                            .centre = {cx * g.x + kxy * g.y + kxz * g.z, kxy * g.x + cy * g.y + kyz * g.z,
                                       kxz * g.x + kyz * g.y + cz * g.z},
                            .has_centre = fabs(det) > min,
                            .definite = xx > 0 && cz > 0 && det > min};
}

/* For a positive definite quadric with a solid that is not empty, the extent along g is the square root of g . M g,
 * where M is the inverse matrix times minus the value at the centre. M is multiplied by the determinant, and the value
 * is divided by it. */
struct ellipsoid_form {
    struct centred part;
    double value; /* minus that at the centre over the determinant; <= 0: empty */
};

static bool ellipsoid_form(const struct quadric *q, struct ellipsoid_form *out) {
    out->part = centred(q);
    if (!out->part.definite)
        return false;
    out->value = -quadric_value(q, out->part.centre) / out->part.det;
    return true;
}

/* The inverse loses as many digits as the determinant cancels. */
#define FORM_ROUNDING (1 + 0x1p-18)

struct box quadric_bounds(const struct quadric *q) {
    struct ellipsoid_form e;
    if (!ellipsoid_form(q, &e))
        return q->limits;
    if (!(e.value > 0))
        return box_empty();
    struct vec3 extent = {sqrt(e.part.cx * e.value), sqrt(e.part.cy * e.value), sqrt(e.part.cz * e.value)};
    extent = vec3_scale(extent, FORM_ROUNDING);
    struct box whole = {vec3_sub(e.part.centre, extent), vec3_add(e.part.centre, extent)};
    return box_meet(whole, q->limits);
}

bool quadric_extent(const struct quadric *q, struct vec3 g, double *lo, double *hi) {
    struct ellipsoid_form e;
    struct box own = quadric_bounds(q);
    if (!ellipsoid_form(q, &e) || !(e.value > 0) || box_is_empty(&own))
        return false;
    double form = (e.part.cx * g.x + 2 * e.part.kxy * g.y + 2 * e.part.kxz * g.z) * g.x +
                  (e.part.cy * g.y + 2 * e.part.kyz * g.z) * g.y + e.part.cz * g.z * g.z;
    double middle = vec3_dot(g, e.part.centre), extent = form > 0 ? sqrt(form * e.value) * FORM_ROUNDING : 0;
    /* The box that limits it may be nearer. */
    struct vec3 half = vec3_scale(vec3_sub(own.max, own.min), 0.5), box_centre = vec3_add(own.min, half);
    double box_middle = vec3_dot(g, box_centre);
    double box_extent = fabs(g.x) * half.x + fabs(g.y) * half.y + fabs(g.z) * half.z;
    *lo = math_max(middle - extent, box_middle - box_extent);
    *hi = math_min(middle + extent, box_middle + box_extent);
    return true;
}

/* ---- image coordinates ---- */

static int sign_of(double a, double min) {
    return a > min ? 1 : a < -min ? -1 : 0;
}

/* The axis whose square differs in sign from the other two: that of a cylinder, cone, paraboloid or hyperboloid. When
 * all differ the one without a square; else y. */
static int axis_of(const struct quadric *q) {
    const double *c = q->c, min = 0x1p-30 * (fabs(c[0]) + fabs(c[1]) + fabs(c[2]));
    int x = sign_of(c[0], min), y = sign_of(c[1], min), z = sign_of(c[2], min);
    if (x == z)
        return 1;
    if (y == z)
        return 0;
    if (x == y)
        return 2;
    return x == 0 ? 0 : y == 0 ? 1 : 2;
}

/* The centre; of quadrics without one the middle along each axis by itself: of its parabola, else of the limits. */
static struct vec3 middle_point(const struct quadric *q, const struct centred *part) {
    if (part->has_centre)
        return part->centre;
    double middle[3];
    for (int i = 0; i < 3; i++) {
        double lo = vec3_get(q->limits.min, i), hi = vec3_get(q->limits.max, i);
        middle[i] = q->c[i] != 0 ? -q->c[6 + i] / (2 * q->c[i]) : middle_of(lo, hi);
    }
    return vec3_make(middle[0], middle[1], middle[2]);
}

static bool has_both_ends(const struct box *limits, int axis) {
    return isfinite(vec3_get(limits->min, axis)) && isfinite(vec3_get(limits->max, axis));
}

static void describe_image(const struct quadric *q, struct surface *out) {
    struct centred part = centred(q);
    struct vec3 base = middle_point(q, &part), up = {0, 0, 0};
    if (part.definite) {
        surface_mapping_sphere(base, out);
        return;
    }
    int axis = axis_of(q);
    double lo = vec3_get(q->limits.min, axis), hi = vec3_get(q->limits.max, axis), length = 1;
    double *at = axis == 0 ? &base.x : axis == 1 ? &base.y : &base.z;
    *(axis == 0 ? &up.x : axis == 1 ? &up.y : &up.z) = 1;
    if (has_both_ends(&q->limits, axis)) {
        *at = lo;
        length = hi - lo;
    }
    surface_mapping_label(base, up, length, out);
}

/* A face of the limits shows the picture upright, once; in units of the object where there is no end. */
static void describe_face_image(const struct box *limits, struct surface *out) {
    struct vec3 level, up;
    planar_across(out->normal, &level, &up);
    for (int axis = 0; axis < 3; axis++) {
        bool ends = has_both_ends(limits, axis);
        double lo = ends ? vec3_get(limits->min, axis) : 0, size = ends ? vec3_get(limits->max, axis) - lo : 1;
        double fraction = (vec3_get(out->point, axis) - lo) / size;
        double along_u = vec3_get(level, axis), along_v = vec3_get(up, axis);
        if (along_u != 0) {
            out->u = along_u > 0 ? fraction : 1 - fraction;
            out->dpdu = vec3_scale(level, size);
        }
        if (along_v != 0) {
            out->v = along_v > 0 ? fraction : 1 - fraction;
            out->dpdv = vec3_scale(up, size);
        }
    }
    out->has_uv = true;
}

/* ---- describing ---- */

static void describe_face(const struct quadric *q, uint32_t part, struct surface *out) {
    enum box_face face = (enum box_face)(part - QUADRIC_FIRST_FACE);
    const struct box *b = &q->limits;
    struct vec3 p = out->point, n;
    box_face_point(b, face, &p, &n);
    out->point = p;
    out->normal = n;
    out->error = 0x1p-49 * vec3_max_abs(p);
    describe_face_image(b, out);
}

void quadric_describe(const struct quadric *q, const struct ray *ray, const struct crossing *crossing,
                      struct surface *out) {
    *out = (struct surface){.point = ray_at(ray, crossing->t)};
    if (crossing->part != QUADRIC_SIDE) {
        describe_face(q, crossing->part, out);
    } else {
        struct vec3 p = out->point, gradient = {0};
        double gg = 0;
        for (int step = 0; step < 3; step++) {
            double value = quadric_value(q, p);
            gradient = quadric_gradient(q, p);
            gg = vec3_dot(gradient, gradient);
            /* At the tip of a cone the step would diverge: it must be small relative to the distance to the next
             * root. */
            double bend = fabs(q->c[0]) + fabs(q->c[1]) + fabs(q->c[2]) + fabs(q->c[3]) + fabs(q->c[4]) + fabs(q->c[5]);
            if (step == 2 || !(4 * fabs(value) * bend < gg))
                break;
            p = vec3_add_scaled(p, gradient, -value / gg);
        }
        double slack = quadric_magnitude(q, p) / sqrt(gg), far = vec3_max_abs(p);
        out->point = p;
        out->normal = gg > 0 ? gradient : vec3_negate(ray->direction);
        out->error = 0x1p-49 * (math_min(slack, 0x1p23 * far) + far);
        describe_image(q, out);
    }
    out->shading_normal = out->pattern_normal = out->normal;
    out->pattern_point = out->point;
}
