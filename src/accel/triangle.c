/* The rare parts of the watertight test: exact differences of products, and ties. See triangle.h. */
#include "accel/triangle.h"

#include "math/portable.h"

__extension__ typedef unsigned __int128 wide;

void triangle_ray_set(struct triangle_ray *out, const struct ray *ray) {
    const double d[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    triangle_ray_axes(out, d);
    out->shear[0] = d[out->x] / d[out->z];
    out->shear[1] = d[out->y] / d[out->z];
    out->shear[2] = 1 / d[out->z];
    out->origin[0] = ray->origin.x;
    out->origin[1] = ray->origin.y;
    out->origin[2] = ray->origin.z;
}

bool triangle_ray_init(struct triangle_ray *out, const struct ray *ray) {
    if (!vec3_finite(ray->direction) || !vec3_finite(ray->origin) || !(vec3_max_abs(ray->direction) > 0))
        return false;
    triangle_ray_set(out, ray);
    return true;
}

/* |a b| as an integer of at most 106 bits times a power of two. */
static wide product(double a, double b, int *exponent) {
    int ea, eb;
    uint64_t ma = (uint64_t)math_ldexp(math_frexp(fabs(a), &ea), 53);
    uint64_t mb = (uint64_t)math_ldexp(math_frexp(fabs(b), &eb), 53);
    *exponent = ea + eb;
    return (wide)ma * mb;
}

double triangle_edge_exact(double ax, double ay, double bx, double by) {
    if (!(isfinite(ax) && isfinite(ay) && isfinite(bx) && isfinite(by)))
        return NAN;
    /* Products of zeros, as for triangles along the axes, are exact. */
    if ((ax == 0 || by == 0) && (ay == 0 || bx == 0))
        return ax * by - ay * bx;
    int ep, eq;
    wide p = product(ax, by, &ep), q = product(ay, bx, &eq);
    bool p_negative = signbit(ax) != signbit(by), q_negative = signbit(ay) != signbit(bx);
    double p_rounded = ax * by, q_rounded = ay * bx;
    /* Far apart, of different sign, or one of them zero: nothing cancels and the rounded difference is good. */
    if (p == 0 || q == 0 || p_negative != q_negative || ep > eq + 20 || eq > ep + 20)
        return p_rounded - q_rounded;
    /* Both fit 126 bits on the smaller exponent. */
    int exponent = ep < eq ? ep : eq;
    p <<= ep - exponent;
    q <<= eq - exponent;
    bool negative = p_negative != (p < q);
    wide difference = p < q ? q - p : p - q;
    double value = math_ldexp(math_from_wide((uint64_t)(difference >> 64), (uint64_t)difference), exponent - 106);
    return negative ? -value : value;
}

/* Moving the origin by (e, e^2) changes the function by e (ay - by) + e^2 (bx - ax). */
int triangle_edge_tie(double ax, double ay, double bx, double by) {
    if (ay != by)
        return ay > by ? 1 : -1;
    if (ax != bx)
        return bx > ax ? 1 : -1;
    return 0;
}
