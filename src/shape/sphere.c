/* The sphere. With f = origin - centre and d the direction, the foot of the perpendicular from the centre to the line
 * is at t = -f.d / d.d, and the crossings lie symmetrically about it, at a distance that follows from Pythagoras.
 * Subtracting the foot's distance instead of f.f from radius^2 keeps the discriminant good when the origin is far away
 * (Haines, Guenther, Akenine-Moeller, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019).
 * The roots are foot - half and foot + half: in order by construction, with an absolute error of a few units in the
 * last place of (|f| + radius) / |d|. That is the error the rounded origin carries anyway, so the other form of the
 * roots, c / q, would gain nothing here. A line that grazes within rounding crosses twice or not at all. */
#include "shape/sphere.h"

#include "math/elementary.h"
#include "math/portable.h"

/* Lengths and directions whose squares might leave the range of doubles are scaled by powers of two first: exact, so a
 * sphere gives the same t, bit by bit, whether it comes through here or not. */
static bool solve_scaled(struct vec3 f, struct vec3 d, double radius, double t[2]);

static bool solve(struct vec3 f, struct vec3 d, double radius, double t[2]) {
    double dd = vec3_dot(d, d), ff = vec3_dot(f, f), rr = radius * radius;
    if (!(dd > 0x1p-600 && dd < 0x1p600 && rr > 0x1p-600 && rr < 0x1p600 && ff < 0x1p600))
        return solve_scaled(f, d, radius, t);
    double foot = -vec3_dot(f, d) / dd;
    struct vec3 perpendicular = vec3_add_scaled(f, d, foot);
    double discriminant = rr - vec3_dot(perpendicular, perpendicular);
    if (!(discriminant > 0))
        return false;
    double half = sqrt(discriminant / dd);
    t[0] = foot - half;
    t[1] = foot + half;
    return t[0] < t[1]; /* from very far away both may round to the foot: a touch */
}

static struct vec3 scaled(struct vec3 a, int exponent) {
    return (struct vec3){math_ldexp(a.x, exponent), math_ldexp(a.y, exponent), math_ldexp(a.z, exponent)};
}

static bool solve_scaled(struct vec3 f, struct vec3 d, double radius, double t[2]) {
    double extent = math_max(vec3_max_abs(f), radius), speed = vec3_max_abs(d);
    if (!(speed > 0) || !vec3_finite(d) || !vec3_finite(f) || !isfinite(radius))
        return false;
    int extent_exponent, speed_exponent;
    (void)math_frexp(extent, &extent_exponent);
    (void)math_frexp(speed, &speed_exponent);
    radius = math_ldexp(radius, -extent_exponent);
    if (!(radius > 0x1p-299)) /* from there it is less than a point */
        return false;
    if (!solve(scaled(f, -extent_exponent), scaled(d, -speed_exponent), radius, t))
        return false;
    t[0] = math_ldexp(t[0], extent_exponent - speed_exponent);
    t[1] = math_ldexp(t[1], extent_exponent - speed_exponent);
    return true;
}

bool sphere_crossings(struct vec3 centre, double radius, const struct ray *ray, struct crossing out[2]) {
    double t[2];
    if (!solve(vec3_sub(ray->origin, centre), ray->direction, radius, t))
        return false;
    out[0] = (struct crossing){.t = t[0], .enter = true};
    out[1] = (struct crossing){.t = t[1], .enter = false};
    return true;
}

bool sphere_contains(struct vec3 centre, double radius, struct vec3 point) {
    return vec3_length(vec3_sub(point, centre)) < radius;
}

void sphere_describe(struct vec3 centre, double radius, const struct ray *ray, const struct crossing *crossing,
                     struct surface *out) {
    struct vec3 n = vec3_normalize(vec3_sub(ray_at(ray, crossing->t), centre));
    if (!(vec3_max_abs(n) > 0)) /* the point fell on the centre: a sphere below the resolution of the ray */
        n = vec3_normalize(vec3_negate(ray->direction));

    /* The point is projected onto the sphere, so its error no longer depends on the distance of the ray's origin. */
    struct vec3 point = vec3_add_scaled(centre, n, radius);
    surface_make(out, point, n, 0x1p-49 * (vec3_max_abs(centre) + radius));
}

void sphere_uv(double radius, struct surface *surface) {
    struct vec3 n = surface->normal;
    /* u = 1/2 + atan2(z, x) / 2 pi, v = 1/2 - asin(y) / pi counts from the top. */
    double y = n.y < -1 ? -1 : n.y > 1 ? 1 : n.y;
    surface->has_uv = true;
    surface->u = 0.5 + el_atan2(n.z, n.x) / TURN;
    surface->v = 0.5 - el_asin(y) / (TURN / 2);
    sphere_tangents(radius, n, &surface->dpdu, &surface->dpdv);
}

void sphere_tangents(double radius, struct vec3 n, struct vec3 *dpdu, struct vec3 *dpdv) {
    double ring = sqrt(n.x * n.x + n.z * n.z);
    double cosine = ring > 0 ? n.x / ring : 1, sine = ring > 0 ? n.z / ring : 0;
    *dpdu = vec3_scale(vec3_make(-n.z, 0, n.x), TURN * radius);
    *dpdv = vec3_scale(vec3_make(n.y * cosine, -ring, n.y * sine), TURN / 2 * radius);
}

/* The ellipsoid is the unit sphere under a scale: lines go to the sphere's space, where t is the same, and points come
 * back. Its reach along g is the length of g times the radii (the support function of a ball under a linear map; see
 * Schneider, "Convex Bodies", 1.7). */

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
    double middle = vec3_dot(g, e->centre), extent = vec3_length(vec3_mul(g, e->radii));
    *lo = middle - extent;
    *hi = middle + extent;
}
