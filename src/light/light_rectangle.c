/* A rectangle sampled by the solid angle that it fills: Urena, Fajardo, King, "An Area-Preserving Parametrization for
 * Spherical Rectangles", EGSR 2013. The rectangle lies at z = z0 < 0 of a frame whose origin is the point that looks;
 * the four planes through the point and an edge meet at the corners of a spherical polygon, whose area is the excess of
 * its angles. The first number of a sample picks how much of that area lies to the left, the second how far up. */
#include "light/light_box.h"

#include "math/elementary.h"

/* Below this solid angle the excess has lost half of its digits, and samples by area are as good. */
static const double min_angle = 0x1p-12;

static double limited(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

/* The angle between two neighbouring planes through the point, from their normals. */
static double corner_angle(struct vec3 a, struct vec3 b) {
    return el_acos(limited(-vec3_dot(a, b), -1, 1));
}

bool spherical_rectangle_make(struct vec3 corner, struct vec3 edge1, struct vec3 edge2, struct vec3 from,
                              struct spherical_rectangle *out) {
    double length1 = vec3_length(edge1), length2 = vec3_length(edge2);
    if (!(length1 > 0 && length2 > 0) || fabs(vec3_dot(edge1, edge2)) > 0x1p-40 * length1 * length2)
        return false;
    out->from = from;
    out->x = vec3_scale(edge1, 1 / length1);
    out->y = vec3_scale(edge2, 1 / length2);
    out->z = vec3_cross(out->x, out->y);
    struct vec3 d = vec3_sub(corner, from);
    out->z0 = vec3_dot(d, out->z);
    if (out->z0 > 0) {
        out->z = vec3_negate(out->z);
        out->z0 = -out->z0;
    }
    out->x0 = vec3_dot(d, out->x);
    out->y0 = vec3_dot(d, out->y);
    out->x1 = out->x0 + length1;
    out->y1 = out->y0 + length2;
    if (!(out->z0 < 0))
        return false;
    struct vec3 v00 = {out->x0, out->y0, out->z0}, v01 = {out->x0, out->y1, out->z0};
    struct vec3 v10 = {out->x1, out->y0, out->z0}, v11 = {out->x1, out->y1, out->z0};
    struct vec3 n0 = vec3_normalize(vec3_cross(v00, v10)), n1 = vec3_normalize(vec3_cross(v10, v11));
    struct vec3 n2 = vec3_normalize(vec3_cross(v11, v01)), n3 = vec3_normalize(vec3_cross(v01, v00));
    double g0 = corner_angle(n0, n1), g1 = corner_angle(n1, n2), g2 = corner_angle(n2, n3), g3 = corner_angle(n3, n0);
    out->b0 = n0.z;
    out->b1 = n2.z;
    out->k = 2 * PI - g2 - g3;
    out->angle = g0 + g1 - out->k;
    return out->angle > min_angle;
}

struct vec3 spherical_rectangle_point(const struct spherical_rectangle *seen, struct sample2 place) {
    double sine, cosine;
    el_sincos(place.x * seen->angle + seen->k, &sine, &cosine);
    double f = (cosine * seen->b0 - seen->b1) / sine;
    double c = (f > 0 ? 1 : -1) / sqrt(f * f + seen->b0 * seen->b0);
    c = limited(c, -1, 1);
    double x = limited(-(c * seen->z0) / sqrt(1 - c * c), seen->x0, seen->x1);
    double d = sqrt(x * x + seen->z0 * seen->z0);
    double h0 = seen->y0 / sqrt(d * d + seen->y0 * seen->y0), h1 = seen->y1 / sqrt(d * d + seen->y1 * seen->y1);
    double h = h0 + place.y * (h1 - h0);
    double y = h * h < 1 ? limited(h * d / sqrt(1 - h * h), seen->y0, seen->y1) : h > 0 ? seen->y1 : seen->y0;
    struct vec3 point = vec3_add_scaled(seen->from, seen->x, x);
    return vec3_add_scaled(vec3_add_scaled(point, seen->y, y), seen->z, seen->z0);
}
