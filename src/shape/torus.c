/* The torus. With k = |p|^2 + R^2 - r^2 its equation is k^2 = 4 R^2 (x^2 + z^2), a quartic along a line (Hanrahan in
 * Glassner's "An Introduction to Ray Tracing", 1989, ch. 3). It is formed about the point of the line nearest to the
 * centre, with a unit direction, so that k = t^2 + k0 has no linear term and the numbers have the torus's size; its
 * roots are sought only where the line is in the ball and the slab that hold the torus (roots_polynomial brackets every
 * one, so none is lost but pairs closer than rounding).
 *
 * The quartic is (inner)(outer) with inner = (rho - R)^2 + y^2 - r^2; when r is small beside R it loses digits to R, so
 * each root is polished by Newton's steps on `inner`, which does not. `inner` also decides whether the line is inside
 * between two roots: crossings alternate by construction, and the lemon inside a spindle torus (r > R) disappears.
 *
 * As R goes to 0 the quartic's roots come together in pairs, and below R = 2^-23 r the search may lose both of a pair.
 * The surface then differs from the sphere of radius r + R by at most R, so the roots are that sphere's, polished. */
#include "shape/torus.h"

#include "math/elementary.h"
#include "math/roots.h"

static double ring(struct vec3 p) {
    return sqrt(p.x * p.x + p.z * p.z);
}

static double inner(const struct torus *torus, struct vec3 p) {
    double from_ring = ring(p) - torus->major;
    return from_ring * from_ring + p.y * p.y - torus->minor * torus->minor;
}

/* Newton from a root of the quartic, between its neighbours; mostly it is good already. */
static double polished(const struct torus *torus, struct vec3 o, struct vec3 d, double t, double lo, double hi) {
    double extent = torus->major + torus->minor, tolerance = extent * extent * 0x1p-51, before = INFINITY, last = t;
    for (int step = 0; step < 4; step++) {
        struct vec3 p = vec3_add_scaled(o, d, t);
        double rho = ring(p), from_ring = rho - torus->major;
        double value = from_ring * from_ring + p.y * p.y - torus->minor * torus->minor;
        if (!(fabs(value) < before)) /* no better than the step before */
            return last;
        if (fabs(value) <= tolerance)
            return t;
        double share = rho > 0 ? from_ring / rho : 0;
        double slope = 2 * (share * (p.x * d.x + p.z * d.z) + p.y * d.y), next = t - value / slope;
        if (!(next > lo && next < hi)) /* also when the slope is zero */
            return t;
        before = fabs(value);
        last = t;
        t = next;
    }
    return last;
}

/* The roots of the quartic between lo and hi about o, the point of the line nearest to the centre, in order. */
static int quartic_roots(const struct torus *torus, struct vec3 o, struct vec3 d, double lo, double hi,
                         double roots[4]) {
    /* (t^2 + 2 m t + k)^2 = 4 R^2 (x^2 + z^2); m is zero but for rounding. */
    double oo = vec3_dot(o, o);
    double m = vec3_dot(o, d), k = oo + (torus->major - torus->minor) * (torus->major + torus->minor);
    double r4 = 4 * torus->major * torus->major;
    double xz_dd = d.x * d.x + d.z * d.z, xz_od = o.x * d.x + o.z * d.z, xz_oo = o.x * o.x + o.z * o.z;
    double quartic[5] = {k * k - r4 * xz_oo, 4 * m * k - 2 * r4 * xz_od, 2 * k + 4 * m * m - r4 * xz_dd, 4 * m, 1};
    return roots_polynomial(quartic, 4, lo, hi, roots);
}

int torus_crossings(const struct torus *torus, const struct ray *ray, struct crossing out[4]) {
    double length = vec3_length(ray->direction), extent = torus->major + torus->minor;
    if (!(length > 0) || !isfinite(length))
        return 0;
    struct vec3 d = vec3_normalize(ray->direction);
    double shift = -vec3_dot(ray->origin, d);
    struct vec3 o = vec3_add_scaled(ray->origin, d, shift);
    double room = extent * extent - vec3_dot(o, o);
    if (!(room > 0))
        return 0;
    double hi = sqrt(room), lo = -hi;
    double roots[6] = {0, lo, hi};
    int count = 2;
    if (torus->major > 0x1p-23 * torus->minor) {
        if (d.y != 0) {
            double bottom = (-torus->minor - o.y) / d.y, top = (torus->minor - o.y) / d.y;
            lo = math_max(lo, math_min(bottom, top));
            hi = math_min(hi, math_max(bottom, top));
        } else if (!(fabs(o.y) < torus->minor)) {
            return 0;
        }
        double margin = extent * 0x1p-20;
        if (!(lo <= hi + margin)) /* a line along the top may still touch it */
            return 0;
        lo -= margin;
        hi += margin;
        count = quartic_roots(torus, o, d, lo, hi, roots + 1);
    }
    roots[0] = lo;
    roots[count + 1] = hi;
    for (int i = 1; i <= count; i++)
        roots[i] = polished(torus, o, d, roots[i], roots[i - 1], roots[i + 1]);

    bool inside = false;
    int found = 0;
    for (int i = 1; i <= count; i++) {
        double middle = i < count ? roots[i] / 2 + roots[i + 1] / 2 : INFINITY;
        bool now = i < count && inner(torus, vec3_add_scaled(o, d, middle)) < 0;
        if (now == inside)
            continue;
        inside = now;
        out[found++] = (struct crossing){.t = (shift + roots[i]) / length, .enter = now};
    }
    return found;
}

bool torus_contains(const struct torus *torus, struct vec3 point) {
    return inner(torus, point) < 0;
}

void torus_describe(const struct torus *torus, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out) {
    struct vec3 p = ray_at(ray, crossing->t);
    double rho = ring(p), cosine = rho > 0 ? p.x / rho : 1, sine = rho > 0 ? p.z / rho : 0;
    /* The direction from the nearest point of the circle; the point is put back at the tube's radius. */
    double across = rho - torus->major, size = sqrt(across * across + p.y * p.y);
    double a = size > 0 ? across / size : 1, b = size > 0 ? p.y / size : 0;
    struct vec3 n = {a * cosine, b, a * sine};
    double radius = torus->major + a * torus->minor;
    struct vec3 point = {radius * cosine, b * torus->minor, radius * sine};
    *out = (struct surface){.point = point,
                            .normal = n,
                            .shading_normal = n,
                            .pattern_point = point,
                            .pattern_normal = n,
                            .has_uv = true,
                            .error = 0x1p-48 * (torus->major + torus->minor)};
    out->u = 0.5 - el_atan2(sine, cosine) / TURN;
    out->v = 0.5 + el_atan2(b, a) / TURN;
    out->dpdu = vec3_scale(vec3_make(sine, 0, -cosine), TURN * radius);
    out->dpdv = vec3_scale(vec3_make(-b * cosine, a, -b * sine), TURN * torus->minor);
}

void torus_extent(const struct torus *torus, struct vec3 g, double *lo, double *hi) {
    *hi = torus->major * ring(g) + torus->minor * vec3_length(g);
    *lo = -*hi;
}
