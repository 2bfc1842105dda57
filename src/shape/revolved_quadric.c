/* Quadrics of revolution: the common part of cylinder, cone, paraboloid and hyperboloids. Their
 * crossings are ends of intervals of the line (span_internal.h). A described point is put back on the surface by two
 * Newton steps along the gradient. For the family see any book on analytic geometry. */
#include "shape/revolved_quadric.h"

#include "math/elementary.h"
#include "math/roots.h"
#include "shape/span_internal.h"

int revolved_quadric_crossings(const struct revolved_quadric *c, const struct ray *ray, struct crossing out[4]) {
    double unit = direction_unit(ray->direction);
    struct vec3 d = vec3_scale(ray->direction, unit), f = vec3_sub(ray->origin, c->base);
    if (!(vec3_max_abs(d) > 0))
        return 0;
    double height = vec3_dot(f, c->axis), climb = vec3_dot(d, c->axis);
    struct span limits = {{-INFINITY, 0}, {INFINITY, 0}}, spans[2];
    if (!cut_by_slab(height, climb, (struct slab){c->lo, c->hi, REVOLVED_QUADRIC_LOW_END, REVOLVED_QUADRIC_HIGH_END},
                     &limits))
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

bool revolved_quadric_is_closed(const struct revolved_quadric *c) {
    return !c->open || (!isfinite(c->lo) && !isfinite(c->hi));
}

/* The radius r(s), the root of q = a s^2 + b s + c, is concave where b^2 >= 4 a c. Of a cone (equal) only one side of
 * its tip may be there; of two sheets, neither. */
bool revolved_quadric_is_convex(const struct revolved_quadric *c) {
    if (c->a <= 0)
        return c->b * c->b >= 4 * c->a * c->c;
    double excess = c->b * c->b - 4 * c->a * c->c, size = c->b * c->b + fabs(4 * c->a * c->c);
    double tip = -c->b / (2 * c->a), slack = 0x1p-40 * (c->hi - c->lo);
    return fabs(excess) <= 0x1p-40 * size && (tip <= c->lo + slack || tip >= c->hi - slack);
}

bool revolved_quadric_contains(const struct revolved_quadric *c, struct vec3 point) {
    struct vec3 f = vec3_sub(point, c->base);
    double s = vec3_dot(f, c->axis);
    struct vec3 w = vec3_add_scaled(f, c->axis, -s);
    return s > c->lo && s < c->hi && vec3_dot(w, w) < (c->a * s + c->b) * s + c->c;
}

static void describe_end(const struct revolved_quadric *c, struct vec3 f, bool high, struct surface *out) {
    double s = high ? c->hi : c->lo, radius = sqrt(math_max((c->a * s + c->b) * s + c->c, 0));
    struct vec3 w = vec3_add_scaled(f, c->axis, -vec3_dot(f, c->axis)), x, z;
    double size = vec3_max_abs(c->base) + fabs(s) + radius;
    out->point = vec3_add(vec3_add_scaled(c->base, c->axis, s), w);
    out->normal = high ? c->axis : vec3_negate(c->axis);
    out->error = 0x1p-48 * size;

    /* Like the top and the bottom of the cube, the image covers the square around the end; v counts from below. */
    surface_mapping_axes(c->axis, &x, &z);
    if (high)
        z = vec3_negate(z);
    radius = radius > 0 ? radius : 1;
    out->u = 0.5 + vec3_dot(w, x) / (2 * radius);
    out->v = 0.5 + vec3_dot(w, z) / (2 * radius);
    out->dpdu = vec3_scale(x, 2 * radius);
    out->dpdv = vec3_scale(z, 2 * radius);
}

static void describe_side(const struct revolved_quadric *c, const struct ray *ray, struct vec3 f, struct surface *out) {
    double s = 0, magnitude = 0, gg = 0;
    struct vec3 w = {0}, gradient = {0};
    for (int step = 0; step < 3; step++) {
        s = vec3_dot(f, c->axis);
        w = vec3_add_scaled(f, c->axis, -s);
        double square = vec3_dot(w, w), value = square - ((c->a * s + c->b) * s + c->c);
        magnitude = square + fabs(c->a) * s * s + fabs(c->b * s) + fabs(c->c);
        gradient = vec3_add_scaled(w, c->axis, -(c->a * s + c->b / 2)); /* half of it */
        gg = vec3_dot(gradient, gradient);
        if (step == 2 || !(fabs(value) < gg)) /* at a tip the step would diverge */
            break;
        f = vec3_add_scaled(f, gradient, -value / (2 * gg));
    }
    double size = vec3_max_abs(c->base) + vec3_max_abs(f);
    double slack = gg > 0 ? magnitude / sqrt(gg) : INFINITY, near_tip = sqrt(magnitude) * 0x1p23;
    out->error = 0x1p-49 * (math_min(slack, near_tip) + size);
    out->point = vec3_add(c->base, f);
    out->normal = gg > 0 ? gradient : vec3_negate(ray->direction);

    struct vec3 x, z;
    surface_mapping_axes(c->axis, &x, &z);
    double p = vec3_dot(w, x), q = vec3_dot(w, z), radius = sqrt(p * p + q * q);
    double cosine = radius > 0 ? p / radius : 1, sine = radius > 0 ? q / radius : 0;
    bool limited = isfinite(c->lo) && isfinite(c->hi);
    double length = limited ? c->hi - c->lo : 1;
    out->u = 0.5 - el_atan2(q, p) / TURN; /* to the right, seen from outside */
    out->v = limited ? math_min(math_max((s - c->lo) / length, 0), 1) : s;
    out->dpdu = vec3_scale(vec3_sub(vec3_scale(x, sine), vec3_scale(z, cosine)), TURN * radius);
    double widening = radius > 0 ? (c->a * s + c->b / 2) / radius : 0;
    struct vec3 outward = vec3_add(vec3_scale(x, cosine), vec3_scale(z, sine));
    out->dpdv = vec3_scale(vec3_add_scaled(c->axis, outward, widening), length);
}

void revolved_quadric_describe(const struct revolved_quadric *c, const struct ray *ray, const struct crossing *crossing,
                               struct surface *out) {
    struct vec3 f = vec3_sub(ray_at(ray, crossing->t), c->base);
    surface_make(out, f, f, 0);
    out->has_uv = true;
    if (crossing->part == REVOLVED_QUADRIC_SIDE)
        describe_side(c, ray, f, out);
    else
        describe_end(c, f, crossing->part == REVOLVED_QUADRIC_HIGH_END, out);
    out->shading_normal = out->pattern_normal = out->normal;
    out->pattern_point = out->point;
}

/* The circle at the height s: its reach in the direction whose parts along and across the axis are given. */
static void extend_by_circle(const struct revolved_quadric *c, double s, double along, double across, double *lo,
                             double *hi) {
    double square = (c->a * s + c->b) * s + c->c;
    double rounding = 0x1p-48 * (fabs(c->a) * s * s + fabs(c->b * s) + fabs(c->c));
    if (!(s >= c->lo && s <= c->hi && square >= -rounding))
        return;
    double extent = across * sqrt(math_max(square, 0));
    *lo = math_min(*lo, along * s - extent);
    *hi = math_max(*hi, along * s + extent);
}

void revolved_quadric_extent(const struct revolved_quadric *c, struct vec3 g, double *lo, double *hi) {
    double along = vec3_dot(g, c->axis), across = vec3_length(vec3_add_scaled(g, c->axis, -along));
    double offset = vec3_dot(g, c->base), roots[2];
    *lo = INFINITY;
    *hi = -INFINITY;
    bool limited = isfinite(c->lo) && isfinite(c->hi);
    if (!limited) {
        /* A closed form exists where the conic is an ellipse; else the shape is treated as unbounded in both
         * directions. */
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

/* The cone. The radius grows evenly with the height s: x^2 + z^2 = (r0 + m s)^2, m = (r1 - r0) / length, whose second
 * nappe the limits of the height leave out (Apollonius' cone in Cartesian form; Haines in Glassner, "An Introduction to
 * Ray Tracing", 1989, ch. 2, intersects it the same way). */

struct revolved_quadric revolved_quadric_frustum(struct vec3 from, double from_radius, struct vec3 to, double to_radius,
                                                 bool open) {
    struct vec3 difference = vec3_sub(to, from);
    double length = vec3_length(difference), slope = (to_radius - from_radius) / length;
    return (struct revolved_quadric){.base = from,
                                     .axis = vec3_normalize(difference),
                                     .a = slope * slope,
                                     .b = 2 * from_radius * slope,
                                     .c = from_radius * from_radius,
                                     .lo = 0,
                                     .hi = length,
                                     .open = open};
}

/* The cylinder: x^2 + z^2 = r^2 between two heights, a frustum whose radius does not change (Roth, "Ray casting for
 * modeling solids", 1982, has it among his primitives). */

struct revolved_quadric revolved_quadric_cylinder(struct vec3 from, struct vec3 to, double radius, bool open) {
    return revolved_quadric_frustum(from, radius, to, radius, open);
}

/* The paraboloid: x^2 + z^2 = (r^2 / h) y, the square of the radius grows evenly with the height (Archimedes, "On
 * conoids and spheroids"). */

struct revolved_quadric revolved_quadric_paraboloid(double radius, double height, bool open) {
    return revolved_quadric_upright(0, radius * (radius / height), 0, 0, height, open);
}

/* The hyperboloids: x^2 + z^2 = m y^2 + w^2 of one sheet, x^2 + z^2 = m (y^2 - g^2) of two, with the cone of slope
 * sqrt(m) as their asymptote (Wren, "Generatio corporis cylindroidis hyperbolici", 1669, found the lines on the first).
 * The slope follows from the rim; differences of squares are products, so that nothing cancels. */

struct revolved_quadric revolved_quadric_one_sheet(double waist, double rim, double lo, double hi, bool open) {
    double extent = math_max(fabs(lo), fabs(hi)), slope = (rim - waist) / extent * ((rim + waist) / extent);
    return revolved_quadric_upright(slope, 0, waist * waist, lo, hi, open);
}

struct revolved_quadric revolved_quadric_two_sheets(double gap, double extent, double rim, bool open) {
    double slope = rim / (extent - gap) * (rim / (extent + gap));
    return revolved_quadric_upright(slope, 0, -slope * gap * gap, -extent, extent, open);
}
