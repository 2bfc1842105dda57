/* Quadrics as sets. Along a line a quadric is a polynomial of degree two, which is negative on one interval or outside
 * of one; the limits are an interval as well. The solid's part of the line is what both have in common: at most two
 * intervals, whose ends are the crossings. So they alternate by construction, caps need no test of their own, and an
 * edge cannot leak.
 *
 * The polynomial is formed about the point of the line nearest to the middle of the shape, so its coefficients have
 * errors of a few last places of the shape's size however far away the ray begins; roots_quadratic adds two more. A
 * described point is put back on the surface by two Newton steps along the gradient. For the family see any book on
 * analytic geometry; the ellipsoid is the unit sphere under a scale. */
#include "geom/shape_quadric.h"

#include "geom/shape_box.h"
#include "geom/shape_sphere.h"
#include "math/elementary.h"
#include "math/roots.h"

#define TURN 6.28318530717958647692

/* ---- intervals of a line ---- */

struct end {
    double t;
    uint32_t part;
};

struct span {
    struct end enter, leave;
};

/* Where a t^2 + b t + c is negative, t shifted; at most two spans, whose ends belong to part 0. The touch of two spans
 * is not a gap. */
static int negative_spans(double a, double b, double c, double shift, struct span out[2]) {
    const struct end begin = {-INFINITY, 0}, end = {INFINITY, 0};
    double roots[2];
    int count = roots_quadratic(a, b, c, roots);
    struct end first = {count > 0 ? shift + roots[0] : 0, 0}, second = {count > 1 ? shift + roots[1] : 0, 0};
    if (count == 2 && a > 0) {
        out[0] = (struct span){first, second};
        return first.t < second.t;
    }
    if (count == 2 && first.t < second.t) {
        out[0] = (struct span){begin, first};
        out[1] = (struct span){second, end};
        return 2;
    }
    if (count == 1) {
        bool rising = 2 * a * roots[0] + b > 0;
        out[0] = rising ? (struct span){begin, first} : (struct span){first, end};
        return 1;
    }
    out[0] = (struct span){begin, end};
    return a < 0 || (a == 0 && c < 0);
}

/* The crossings of the solid: spans cut by the limits. */
static int closed_crossings(const struct span *spans, int count, const struct span *limits, struct crossing *out) {
    int found = 0;
    for (int i = 0; i < count; i++) {
        struct end enter = limits->enter.t > spans[i].enter.t ? limits->enter : spans[i].enter;
        struct end leave = limits->leave.t < spans[i].leave.t ? limits->leave : spans[i].leave;
        if (!(enter.t < leave.t))
            continue;
        out[found++] = (struct crossing){.t = enter.t, .part = enter.part, .enter = true};
        out[found++] = (struct crossing){.t = leave.t, .part = leave.part, .enter = false};
    }
    return found;
}

/* Only the ends that the surface itself makes. */
static int open_crossings(const struct span *spans, int count, const struct span *limits, struct crossing *out) {
    int found = 0;
    for (int i = 0; i < count; i++) {
        const double t[2] = {spans[i].enter.t, spans[i].leave.t};
        for (int k = 0; k < 2; k++)
            if (isfinite(t[k]) && t[k] >= limits->enter.t && t[k] <= limits->leave.t)
                out[found++] = (struct crossing){.t = t[k], .enter = k == 0};
    }
    return found;
}

/* Cuts the limits by lo < o + t d < hi; false when nothing remains. */
static bool cut_by_slab(double o, double d, double lo, double hi, uint32_t lo_part, uint32_t hi_part,
                        struct span *limits) {
    if (d == 0)
        return o > lo && o < hi;
    struct end enter = d > 0 ? (struct end){(lo - o) / d, lo_part} : (struct end){(hi - o) / d, hi_part};
    struct end leave = d > 0 ? (struct end){(hi - o) / d, hi_part} : (struct end){(lo - o) / d, lo_part};
    if (enter.t > limits->enter.t)
        limits->enter = enter;
    if (leave.t < limits->leave.t)
        limits->leave = leave;
    return limits->enter.t < limits->leave.t;
}

/* Directions whose squares leave the range of doubles are brought to size by a power of two; t is divided by it. */
static double direction_unit(struct vec3 d) {
    double largest = vec3_max_abs(d);
    if (largest > 0x1p-250 && largest < 0x1p250)
        return 1;
    int exponent;
    (void)frexp(largest, &exponent);
    return largest > 0 && isfinite(largest) ? ldexp(1, exponent > 1000    ? -1000
                                                       : exponent < -1000 ? 1000
                                                                          : -exponent)
                                            : 0;
}

static int scale_back(struct crossing *crossings, int count, double unit) {
    for (int i = 0; i < count; i++)
        crossings[i].t *= unit;
    return count;
}

/* ---- conics turned about an axis ---- */

static double middle_of(double lo, double hi) {
    return isfinite(lo) && isfinite(hi) ? lo / 2 + hi / 2 : 0;
}

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

struct conic conic_cylinder(struct vec3 from, struct vec3 to, double radius, bool open) {
    return conic_frustum(from, radius, to, radius, open);
}

static struct conic upright(double a, double b, double c, double lo, double hi, bool open) {
    return (struct conic){.axis = {0, 1, 0}, .a = a, .b = b, .c = c, .lo = lo, .hi = hi, .open = open};
}

struct conic conic_paraboloid(double radius, double height, bool open) {
    return upright(0, radius * (radius / height), 0, 0, height, open);
}

struct conic conic_one_sheet(double waist, double rim, double lo, double hi, bool open) {
    double reach = fmax(fabs(lo), fabs(hi)), slope = (rim - waist) / reach * ((rim + waist) / reach);
    return upright(slope, 0, waist * waist, lo, hi, open);
}

struct conic conic_two_sheets(double gap, double reach, double rim, bool open) {
    double slope = rim / (reach - gap) * (rim / (reach + gap));
    return upright(slope, 0, -slope * gap * gap, -reach, reach, open);
}

int conic_crossings(const struct conic *c, const struct ray *ray, struct crossing out[4]) {
    double unit = direction_unit(ray->direction);
    struct vec3 d = vec3_scale(ray->direction, unit), f = vec3_sub(ray->origin, c->base);
    if (!(vec3_max_abs(d) > 0))
        return 0;
    double height = vec3_dot(f, c->axis), climb = vec3_dot(d, c->axis);
    struct span limits = {{-INFINITY, 0}, {INFINITY, 0}}, spans[2];
    if (!cut_by_slab(height, climb, c->lo, c->hi, CONIC_LOW_END, CONIC_HIGH_END, &limits))
        return 0;

    /* From the point of the line nearest to the middle. */
    double shift = -vec3_dot(vec3_add_scaled(f, c->axis, -middle_of(c->lo, c->hi)), d) / vec3_dot(d, d);
    f = vec3_add_scaled(f, d, shift);
    double s = vec3_dot(f, c->axis);
    struct vec3 w = vec3_add_scaled(f, c->axis, -s), e = vec3_add_scaled(d, c->axis, -climb);
    double a = vec3_dot(e, e) - c->a * climb * climb;
    double b = 2 * (vec3_dot(w, e) - c->a * s * climb) - c->b * climb;
    int count = negative_spans(a, b, vec3_dot(w, w) - ((c->a * s + c->b) * s + c->c), shift, spans);
    count = c->open ? open_crossings(spans, count, &limits, out) : closed_crossings(spans, count, &limits, out);
    return unit == 1 ? count : scale_back(out, count, unit);
}

bool conic_is_closed(const struct conic *c) {
    return !c->open || (!isfinite(c->lo) && !isfinite(c->hi));
}

bool conic_contains(const struct conic *c, struct vec3 point) {
    struct vec3 f = vec3_sub(point, c->base);
    double s = vec3_dot(f, c->axis);
    struct vec3 w = vec3_add_scaled(f, c->axis, -s);
    return s > c->lo && s < c->hi && vec3_dot(w, w) < (c->a * s + c->b) * s + c->c;
}

/* Unit vectors at right angles to the axis from which angles are counted; x and z for the axis y (after Duff et al.,
 * "Building an Orthonormal Basis, Revisited", JCGT 2017). */
static void around(struct vec3 n, struct vec3 *x, struct vec3 *z) {
    double sign = n.y < 0 ? -1 : 1, s = -1 / (sign + n.y), c = n.x * n.z * s;
    *x = vec3_make(1 + sign * n.x * n.x * s, -sign * n.x, sign * c);
    *z = vec3_make(c, -n.z, sign + n.z * n.z * s);
}

static void describe_end(const struct conic *c, struct vec3 f, bool high, struct surface *out) {
    double s = high ? c->hi : c->lo, radius = sqrt(fmax((c->a * s + c->b) * s + c->c, 0));
    struct vec3 w = vec3_add_scaled(f, c->axis, -vec3_dot(f, c->axis)), x, z;
    double size = vec3_max_abs(c->base) + fabs(s) + radius;
    out->point = vec3_add(vec3_add_scaled(c->base, c->axis, s), w);
    out->normal = high ? c->axis : vec3_negate(c->axis);
    out->error = 0x1p-48 * size;

    /* Like the top and the bottom of the cube, the square round the end being the image; v counts from below. */
    around(c->axis, &x, &z);
    if (high)
        z = vec3_negate(z);
    radius = radius > 0 ? radius : 1;
    out->u = 0.5 + vec3_dot(w, x) / (2 * radius);
    out->v = 0.5 + vec3_dot(w, z) / (2 * radius);
    out->dpdu = vec3_scale(x, 2 * radius);
    out->dpdv = vec3_scale(z, 2 * radius);
}

static void describe_side(const struct conic *c, const struct ray *ray, struct vec3 f, struct surface *out) {
    double s = 0, magnitude = 0, gg = 0;
    struct vec3 w = {0}, gradient = {0};
    for (int step = 0; step < 3; step++) {
        s = vec3_dot(f, c->axis);
        w = vec3_add_scaled(f, c->axis, -s);
        double square = vec3_dot(w, w), value = square - ((c->a * s + c->b) * s + c->c);
        magnitude = square + fabs(c->a) * s * s + fabs(c->b * s) + fabs(c->c);
        gradient = vec3_add_scaled(w, c->axis, -(c->a * s + c->b / 2)); /* half of it */
        gg = vec3_dot(gradient, gradient);
        if (step == 2 || !(fabs(value) < gg)) /* at a tip the step would go astray */
            break;
        f = vec3_add_scaled(f, gradient, -value / (2 * gg));
    }
    double size = vec3_max_abs(c->base) + vec3_max_abs(f);
    double slack = gg > 0 ? magnitude / sqrt(gg) : INFINITY, near_tip = sqrt(magnitude) * 0x1p23;
    out->error = 0x1p-49 * (fmin(slack, near_tip) + size);
    out->point = vec3_add(c->base, f);
    out->normal = gg > 0 ? gradient : vec3_negate(ray->direction);

    struct vec3 x, z;
    around(c->axis, &x, &z);
    double p = vec3_dot(w, x), q = vec3_dot(w, z), radius = sqrt(p * p + q * q);
    double cosine = radius > 0 ? p / radius : 1, sine = radius > 0 ? q / radius : 0;
    bool limited = isfinite(c->lo) && isfinite(c->hi);
    double length = limited ? c->hi - c->lo : 1;
    out->u = 0.5 - el_atan2(q, p) / TURN; /* to the right, seen from outside */
    out->v = limited ? fmin(fmax((s - c->lo) / length, 0), 1) : s;
    out->dpdu = vec3_scale(vec3_sub(vec3_scale(x, sine), vec3_scale(z, cosine)), TURN * radius);
    double widening = radius > 0 ? (c->a * s + c->b / 2) / radius : 0;
    struct vec3 outward = vec3_add(vec3_scale(x, cosine), vec3_scale(z, sine));
    out->dpdv = vec3_scale(vec3_add_scaled(c->axis, outward, widening), length);
}

void conic_describe(const struct conic *c, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out) {
    struct vec3 f = vec3_sub(ray_at(ray, crossing->t), c->base);
    *out = (struct surface){.has_uv = true};
    if (crossing->part == CONIC_SIDE)
        describe_side(c, ray, f, out);
    else
        describe_end(c, f, crossing->part == CONIC_HIGH_END, out);
    out->shading_normal = out->pattern_normal = out->normal;
    out->pattern_point = out->point;
}

/* The circle at the height s: its reach in the direction whose parts along and across the axis are given. */
static void extend_by_circle(const struct conic *c, double s, double along, double across, double *lo, double *hi) {
    double square = (c->a * s + c->b) * s + c->c;
    double rounding = 0x1p-48 * (fabs(c->a) * s * s + fabs(c->b * s) + fabs(c->c));
    if (!(s >= c->lo && s <= c->hi && square >= -rounding))
        return;
    double reach = across * sqrt(fmax(square, 0));
    *lo = fmin(*lo, along * s - reach);
    *hi = fmax(*hi, along * s + reach);
}

void conic_extent(const struct conic *c, struct vec3 g, double *lo, double *hi) {
    double along = vec3_dot(g, c->axis), across = vec3_length(vec3_add_scaled(g, c->axis, -along));
    double offset = vec3_dot(g, c->base), roots[2];
    *lo = INFINITY;
    *hi = -INFINITY;
    bool limited = isfinite(c->lo) && isfinite(c->hi);
    if (!limited) {
        /* A closed form exists where the conic is an ellipse; else the shape is taken as endless both ways. */
        bool only_along = across == 0;
        if (!(c->a < 0)) {
            *lo = only_along && along != 0 ? (along > 0 ? along * c->lo : along * c->hi) + offset : -INFINITY;
            *hi = only_along && along != 0 ? (along > 0 ? along * c->hi : along * c->lo) + offset : INFINITY;
            if (only_along && along == 0)
                *lo = *hi = offset;
            return;
        }
    }
    /* The extremes are at the ends, at the tips, or where the circle's reach is stationary:
     * along + across (a s + b / 2) / radius = 0, squared. */
    extend_by_circle(c, c->lo, along, across, lo, hi);
    extend_by_circle(c, c->hi, along, across, lo, hi);
    int count = roots_quadratic(c->a, c->b, c->c, roots);
    for (int i = 0; i < count; i++)
        extend_by_circle(c, roots[i], along, across, lo, hi);
    double p = along * along, q = across * across;
    count = roots_quadratic(c->a * (p - c->a * q), c->b * (p - c->a * q), p * c->c - q * c->b * c->b / 4, roots);
    for (int i = 0; i < count; i++)
        extend_by_circle(c, roots[i], along, across, lo, hi);
    *lo += offset;
    *hi += offset;
}

/* ---- the ellipsoid ---- */

static struct vec3 divided(struct vec3 a, struct vec3 b) {
    return (struct vec3){a.x / b.x, a.y / b.y, a.z / b.z};
}

static struct ray to_sphere(const struct ellipsoid *e, const struct ray *ray) {
    struct ray out = *ray;
    out.origin = divided(vec3_sub(ray->origin, e->centre), e->radii);
    out.direction = divided(ray->direction, e->radii);
    return out;
}

int ellipsoid_crossings(const struct ellipsoid *e, const struct ray *ray, struct crossing out[2]) {
    struct ray unit = to_sphere(e, ray);
    return sphere_crossings(vec3_all(0), 1, &unit, out) ? 2 : 0;
}

bool ellipsoid_contains(const struct ellipsoid *e, struct vec3 point) {
    return vec3_length(divided(vec3_sub(point, e->centre), e->radii)) < 1;
}

void ellipsoid_describe(const struct ellipsoid *e, const struct ray *ray, const struct crossing *crossing,
                        struct surface *out) {
    struct ray unit = to_sphere(e, ray);
    sphere_describe(vec3_all(0), 1, &unit, crossing, out);
    sphere_uv(1, out);
    out->point = vec3_add(e->centre, vec3_mul(out->point, e->radii));
    out->normal = divided(out->normal, e->radii);
    out->shading_normal = out->pattern_normal = out->normal;
    out->pattern_point = out->point;
    out->dpdu = vec3_negate(vec3_mul(out->dpdu, e->radii));
    /* Images that are mapped by uv run to the right, seen from outside, and count from below. */
    out->u = 1 - out->u;
    out->v = 1 - out->v;
    out->dpdv = vec3_negate(vec3_mul(out->dpdv, e->radii));
    out->error = 0x1p-49 * (vec3_max_abs(e->centre) + vec3_max_abs(e->radii));
}

void ellipsoid_extent(const struct ellipsoid *e, struct vec3 g, double *lo, double *hi) {
    double middle = vec3_dot(g, e->centre), reach = vec3_length(vec3_mul(g, e->radii));
    *lo = middle - reach;
    *hi = middle + reach;
}

/* ---- the general quadric ---- */

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
        if (!cut_by_slab(vec3_get(o, (int)axis), vec3_get(d, (int)axis), lo, hi, negative, positive, &limits))
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

static void describe_face(const struct quadric *q, uint32_t part, struct surface *out) {
    enum box_face face = (enum box_face)(part - QUADRIC_FIRST_FACE);
    const struct box *b = &q->limits;
    struct vec3 p = out->point, n = {0, 0, 0};
    switch (face) {
    case BOX_POSITIVE_X:
        p.x = b->max.x, n.x = 1;
        break;
    case BOX_NEGATIVE_X:
        p.x = b->min.x, n.x = -1;
        break;
    case BOX_POSITIVE_Y:
        p.y = b->max.y, n.y = 1;
        break;
    case BOX_NEGATIVE_Y:
        p.y = b->min.y, n.y = -1;
        break;
    case BOX_POSITIVE_Z:
        p.z = b->max.z, n.z = 1;
        break;
    case BOX_NEGATIVE_Z:
        p.z = b->min.z, n.z = -1;
        break;
    }
    out->point = p;
    out->normal = n;
    out->error = 0x1p-49 * vec3_max_abs(p);
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
            /* At a tip of a cone the step would go astray: it must stay small beside the way to the next root. */
            double bend = fabs(q->c[0]) + fabs(q->c[1]) + fabs(q->c[2]) + fabs(q->c[3]) + fabs(q->c[4]) + fabs(q->c[5]);
            if (step == 2 || !(4 * fabs(value) * bend < gg))
                break;
            p = vec3_add_scaled(p, gradient, -value / gg);
        }
        double slack = quadric_magnitude(q, p) / sqrt(gg), far = vec3_max_abs(p);
        out->point = p;
        out->normal = gg > 0 ? gradient : vec3_negate(ray->direction);
        out->error = 0x1p-49 * (fmin(slack, 0x1p23 * far) + far);
    }
    out->shading_normal = out->pattern_normal = out->normal;
    out->pattern_point = out->point;
}

/* A quadratic part that is positive definite, and a solid that is not empty: the gradient vanishes at the centre, and
 * the reach along g is the square root of g . M g, M the inverse matrix times minus the value there. M is scaled by the
 * determinant, which the value is divided by. */
struct ellipsoid_form {
    struct vec3 centre;
    double cx, cy, cz, kxy, kxz, kyz; /* the adjugate matrix */
    double value;                     /* minus that at the centre over the determinant; <= 0: empty */
};

static bool ellipsoid_form(const struct quadric *q, struct ellipsoid_form *out) {
    const double *c = q->c;
    double xx = c[0], yy = c[1], zz = c[2], xy = c[3] / 2, xz = c[4] / 2, yz = c[5] / 2;
    double cx = yy * zz - yz * yz, cy = xx * zz - xz * xz, cz = xx * yy - xy * xy;
    double kxy = xz * yz - xy * zz, kxz = xy * yz - xz * yy, kyz = xy * xz - yz * xx;
    double det = xx * cx + xy * kxy + xz * kxz;
    double size = fabs(xx) + fabs(yy) + fabs(zz) + fabs(xy) + fabs(xz) + fabs(yz);
    if (!(xx > 0 && cz > 0 && det > 0x1p-30 * size * size * size))
        return false;
    struct vec3 g = {-c[6] / (2 * det), -c[7] / (2 * det), -c[8] / (2 * det)};
    struct vec3 centre = {cx * g.x + kxy * g.y + kxz * g.z, kxy * g.x + cy * g.y + kyz * g.z,
                          kxz * g.x + kyz * g.y + cz * g.z};
    *out = (struct ellipsoid_form){centre, cx, cy, cz, kxy, kxz, kyz, -quadric_value(q, centre) / det};
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
    struct vec3 reach = {sqrt(e.cx * e.value), sqrt(e.cy * e.value), sqrt(e.cz * e.value)};
    reach = vec3_scale(reach, FORM_ROUNDING);
    struct box whole = {vec3_sub(e.centre, reach), vec3_add(e.centre, reach)};
    return box_meet(whole, q->limits);
}

bool quadric_extent(const struct quadric *q, struct vec3 g, double *lo, double *hi) {
    struct ellipsoid_form e;
    struct box own = quadric_bounds(q);
    if (!ellipsoid_form(q, &e) || !(e.value > 0) || box_is_empty(&own))
        return false;
    double form = (e.cx * g.x + 2 * e.kxy * g.y + 2 * e.kxz * g.z) * g.x + (e.cy * g.y + 2 * e.kyz * g.z) * g.y +
                  e.cz * g.z * g.z;
    double middle = vec3_dot(g, e.centre), reach = form > 0 ? sqrt(form * e.value) * FORM_ROUNDING : 0;
    /* The box that limits it may be nearer. */
    struct vec3 half = vec3_scale(vec3_sub(own.max, own.min), 0.5), box_centre = vec3_add(own.min, half);
    double box_middle = vec3_dot(g, box_centre);
    double box_reach = fabs(g.x) * half.x + fabs(g.y) * half.y + fabs(g.z) * half.z;
    *lo = fmax(middle - reach, box_middle - box_reach);
    *hi = fmin(middle + reach, box_middle + box_reach);
    return true;
}
