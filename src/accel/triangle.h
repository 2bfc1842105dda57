/* The one ray/triangle test, in double precision and watertight: nearest, any and all crossings, brute force and every
 * index end here, so they cannot disagree.
 *
 * Sven Woop, Carsten Benthin, Ingo Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013: the ray becomes the z
 * axis by a shear, which maps each vertex to a point of the plane independently, the same point for every triangle
 * around it. The rest is a test whether the origin of that plane is inside the projected triangle, by the signs of
 * three edge functions x1 y2 - y1 x2. Two things make the answer exact for the (rounded) plane points:
 *   - rounding is monotonic, so a difference of products has the right sign or is zero; if it cancels, the difference
 * is computed with integers;
 *   - a true zero (the ray meets an edge or a vertex) is decided as if the ray had been moved by (e, e^2) for an
 *     infinitely small e (Edelsbrunner and Muecke, "Simulation of Simplicity", 1990), the same for all triangles.
 * So a line crosses a closed surface as often inwards as outwards, through edges and vertices too, and never passes
 * between two triangles that share an edge. A triangle seen exactly edge-on is not hit. */
#ifndef GRAY_ACCEL_TRIANGLE_H
#define GRAY_ACCEL_TRIANGLE_H

#include "math/ray.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

/* The shear that makes the ray the z axis; axes are permuted so that its largest component is the last. */
struct triangle_ray {
    double origin[3];
    double shear[4]; /* of x, of y, the factor that makes t of z, not used */
    int x, y, z;
};

struct triangle_hit {
    double t, u, v; /* u, v: weights of corners 1 and 2 */
    uint32_t triangle;
    bool enter; /* against the normal (b - a) x (c - a) */
};

/* False for a direction that is zero or not finite: such a ray hits nothing. */
bool triangle_ray_init(struct triangle_ray *out, const struct ray *ray);
/* The same for a ray known to be good. */
void triangle_ray_set(struct triangle_ray *out, const struct ray *ray);
/* Only the axes; without branches, since the longest axis is unpredictable. */
static inline void triangle_ray_axes(struct triangle_ray *out, const double d[3]) {
    int z = fabs(d[1]) > fabs(d[0]);
    z = fabs(d[2]) > fabs(d[z]) ? 2 : z;
    static const int after[4] = {1, 2, 0, 1};
    int backwards = d[z] < 0; /* then x and y are exchanged, which keeps the winding as seen along the ray */
    out->z = z;
    out->x = after[z + backwards];
    out->y = after[z + !backwards];
}

/* ax * by - ay * bx, exact up to the last rounding. */
double triangle_edge_exact(double ax, double ay, double bx, double by);
/* The sign that replaces a zero edge function; 0 if both points are equal. */
int triangle_edge_tie(double ax, double ay, double bx, double by);

static inline double triangle_edge(double ax, double ay, double bx, double by) {
    double p = ax * by, q = ay * bx, e = p - q;
    /* Products of zeros, as for triangles along the axes, are exact. One branch, which can be predicted. */
    bool clear = fabs(e) > 0x1p-49 * (fabs(p) + fabs(q)),
         zero = (e == 0) & ((ax == 0) | (by == 0)) & ((ay == 0) | (bx == 0));
    return __builtin_expect(clear | zero, 1) ? e : triangle_edge_exact(ax, ay, bx, by);
}

/* triangle_cross for corners as they are seen from the origin, with the axes of the ray. */
static inline __attribute__((always_inline)) bool triangle_cross_seen(const double shear[3], const double a[3],
                                                                      const double b[3], const double c[3],
                                                                      struct triangle_hit *hit) {
    /* The corners in the sheared space of the ray. */
    double az = a[2], bz = b[2], cz = c[2];
    double ax = a[0] - shear[0] * az, ay = a[1] - shear[1] * az;
    double bx = b[0] - shear[0] * bz, by = b[1] - shear[1] * bz;
    double cx = c[0] - shear[0] * cz, cy = c[1] - shear[1] * cz;
    /* The edge functions; the ray passes if their signs differ. */
    double u = triangle_edge(cx, cy, bx, by);
    double v = triangle_edge(ax, ay, cx, cy);
    double w = triangle_edge(bx, by, ax, ay);
    bool positive = u >= 0 && v >= 0 && w >= 0;
    if (!positive && !(u <= 0 && v <= 0 && w <= 0))
        return false;
    double sum = u + v + w;
    if (!(fabs(sum) > 0))
        return false;
    /* A ray through an edge belongs to one of the two triangles. */
    positive = sum > 0;
    if (u == 0 && (triangle_edge_tie(cx, cy, bx, by) > 0) != positive)
        return false;
    if (v == 0 && (triangle_edge_tie(ax, ay, cx, cy) > 0) != positive)
        return false;
    if (w == 0 && (triangle_edge_tie(bx, by, ax, ay) > 0) != positive)
        return false;
    /* Where it is. */
    hit->t = (u * az + v * bz + w * cz) / sum * shear[2];
    hit->u = v / sum;
    hit->v = w / sum;
    hit->enter = positive;
    return true;
}

/* Whether the whole line meets the triangle, and where. hit->triangle does not change. */
static inline bool triangle_cross(const struct triangle_ray *ray, const double a[3], const double b[3],
                                  const double c[3], struct triangle_hit *hit) {
    const double *origin = ray->origin;
    int x = ray->x, y = ray->y, z = ray->z;
    const double seen_a[3] = {a[x] - origin[x], a[y] - origin[y], a[z] - origin[z]};
    const double seen_b[3] = {b[x] - origin[x], b[y] - origin[y], b[z] - origin[z]};
    const double seen_c[3] = {c[x] - origin[x], c[y] - origin[y], c[z] - origin[z]};
    return triangle_cross_seen(ray->shear, seen_a, seen_b, seen_c, hit);
}

#endif
