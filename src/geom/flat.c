/* Flat shapes: the line meets the plane at one t, an oblique coordinate system in the plane says the rest. The
 * coordinates come from the triple products of Cramer's rule divided by normal . normal. Which of them belong to the
 * shape, and how far it reaches, is each shape's own business. */
#include "geom/flat.h"

#include "geom/shape_disc.h"
#include "geom/shape_plane.h"
#include "geom/shape_polygon.h"
#include "geom/shape_rectangle.h"
#include "geom/shape_triangle.h"

void flat_across(struct vec3 n, struct vec3 *level, struct vec3 *up) {
    struct vec3 x = vec3_make(n.z, 0, -n.x); /* y cross n */
    x = vec3_max_abs(x) > 0x1p-26 ? vec3_normalize(x) : vec3_make(1, 0, 0);
    *up = vec3_normalize(vec3_cross(n, x));
    *level = vec3_cross(*up, n);
}

static void coordinates(const struct flat *f, struct vec3 p, double *a, double *b) {
    struct vec3 w = vec3_sub(p, f->origin), n = vec3_cross(f->u, f->v);
    double nn = vec3_dot(n, n);
    *a = vec3_dot(vec3_cross(w, f->v), n) / nn;
    *b = vec3_dot(vec3_cross(f->u, w), n) / nn;
}

static bool holds(const struct flat *f, double a, double b) {
    switch (f->kind) {
    case FLAT_PLANE:
        return true;
    case FLAT_PARALLELOGRAM:
        return parallelogram_holds(a, b);
    case FLAT_DISC:
        return disc_holds(f->inner, a, b);
    case FLAT_TRIANGLE:
        return triangle_holds(a, b);
    case FLAT_POLYGON:
        return polygon_holds(f->polygon, a, b);
    }
    return false;
}

int flat_crossings(const struct flat *f, const struct ray *ray, struct crossing out[2]) {
    double climb = vec3_dot(f->normal, ray->direction), height = vec3_dot(f->normal, vec3_sub(ray->origin, f->origin));
    double t = -height / climb;
    bool enter = climb < 0;
    if (f->kind == FLAT_PLANE)
        return plane_crossings(t, enter, height, ray, out);
    if (!isfinite(t))
        return 0;
    double a, b;
    coordinates(f, ray_at(ray, t), &a, &b);
    if (!holds(f, a, b))
        return 0;
    out[0] = (struct crossing){.t = t, .enter = enter};
    return 1;
}

bool flat_contains(const struct flat *f, struct vec3 point) {
    return f->kind == FLAT_PLANE && vec3_dot(f->normal, vec3_sub(point, f->origin)) < 0;
}

void flat_describe(const struct flat *f, const struct ray *ray, const struct crossing *crossing, struct surface *out) {
    struct vec3 p = ray_at(ray, crossing->t), n = f->normal;
    double off = vec3_dot(n, vec3_sub(p, f->origin)) / vec3_dot(n, n);
    p = vec3_add_scaled(p, n, -off);
    *out = (struct surface){.point = p,
                            .normal = n,
                            .shading_normal = n,
                            .pattern_point = p,
                            .pattern_normal = n,
                            .has_uv = true,
                            .dpdu = f->u,
                            .dpdv = f->v};
    double largest = fmax(vec3_max_abs(f->origin), vec3_max_abs(p));
    if (f->kind == FLAT_POLYGON)
        largest = fmax(largest, polygon_largest(f->polygon));
    out->error = 0x1p-48 * largest;
    coordinates(f, p, &out->u, &out->v);
    if (f->kind == FLAT_DISC)
        disc_image(f, out);
}

void flat_extent(const struct flat *f, struct vec3 g, double *lo, double *hi) {
    double o = vec3_dot(g, f->origin), u = vec3_dot(g, f->u), v = vec3_dot(g, f->v);
    *lo = *hi = o;
    switch (f->kind) {
    case FLAT_PLANE:
        plane_extent(f->normal, g, lo, hi);
        return;
    case FLAT_PARALLELOGRAM:
        *lo += fmin(u, 0) + fmin(v, 0);
        *hi += fmax(u, 0) + fmax(v, 0);
        return;
    case FLAT_DISC: {
        double reach = disc_reach(u, v);
        *lo -= reach;
        *hi += reach;
        return;
    }
    case FLAT_TRIANGLE:
        *lo += fmin(fmin(u, v), 0);
        *hi += fmax(fmax(u, v), 0);
        return;
    case FLAT_POLYGON:
        polygon_extent(f->polygon, g, lo, hi);
        return;
    }
}
