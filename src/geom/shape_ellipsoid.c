/* The ellipsoid is the unit sphere under a scale: lines go to the sphere's space, where t is the same, and points come
 * back. Its reach along g is the length of g times the radii (the support function of a ball under a linear map; see
 * Schneider, "Convex Bodies", 1.7). */
#include "geom/shape_ellipsoid.h"

#include "geom/shape_sphere.h"

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
