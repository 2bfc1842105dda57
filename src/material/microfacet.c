/* The distribution of Trowbridge and Reitz ("GGX"; Walter, Marschner, Li, Torrance, "Microfacet Models for Refraction
 * through Rough Surfaces", EGSR 2007), sampled by visible normals (Heitz, "Sampling the GGX Distribution of
 * Visible Normals", JCGT 2018): no sample is wasted on facets that face away. Seen head on, the share of facets steeper
 * than theta is alpha^2 / (alpha^2 + tan^2 theta). */
#include "material/microfacet_internal.h"
#include "math/elementary.h"

#include "math/frame.h"

#include <math.h>

struct vec3 dielectric_mirror(struct vec3 normal, struct vec3 view) {
    return vec3_sub(vec3_scale(normal, 2 * vec3_dot(normal, view)), view);
}

bool dielectric_refract(struct vec3 normal, struct vec3 view, double eta, struct vec3 *out) {
    double cos_view = vec3_dot(normal, view);
    double sin2 = eta * eta * (1 - cos_view * cos_view);
    if (sin2 >= 1)
        return false;
    double cos_other = sqrt(1 - sin2);
    *out = vec3_add(vec3_scale(view, -eta), vec3_scale(normal, eta * cos_view - cos_other));
    return true;
}

double dielectric_fresnel(double cos_view, double eta) {
    double sin2 = eta * eta * (1 - cos_view * cos_view);
    if (sin2 >= 1)
        return 1;
    /* In units of the far side's index: n_view = eta, n_other = 1. */
    double cos_other = sqrt(1 - sin2);
    double s = (eta * cos_view - cos_other) / (eta * cos_view + cos_other);
    double p = (cos_view - eta * cos_other) / (cos_view + eta * cos_other);
    return 0.5 * (s * s + p * p);
}

/* In closed form by J. Walsh, "The Reflection Factor of a Polished Glass Surface for Diffused Light", Department of
 * Scientific and Industrial Research, Illumination Research, Technical Paper 2, 1926. The value for light from inside
 * follows from the reciprocity of transmission. Near 1 the terms cancel, and the result is almost 0. */
double dielectric_fresnel_average(double eta) {
    double n = eta < 1 ? 1 / eta : eta, n2 = n * n, n4 = n2 * n2, sum = n2 + 1, square = n4 - 1;
    if (n < 1 + 1e-4)
        return eta > 1 ? 1 - 1 / n2 : 0;
    double outside = 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
                     n2 * (n2 - 1) * (n2 - 1) / (sum * sum * sum) * el_log((n - 1) / (n + 1)) -
                     2 * n * n2 * (n2 + 2 * n - 1) / (sum * square) +
                     8 * n4 * (n4 + 1) / (sum * square * square) * el_log(n);
    return eta > 1 ? 1 - (1 - outside) / n2 : outside;
}

struct vec3 microfacet_normal(struct vec3 normal, struct vec3 view, double alpha, struct sample2 xi) {
    struct vec3 a, b;
    frame_tangents(normal, &a, &b);
    /* The view in the frame of the surface, stretched to where the facets form a hemisphere. */
    struct vec3 v = {alpha * vec3_dot(view, a), alpha * vec3_dot(view, b), vec3_dot(view, normal)};
    v = vec3_normalize(v);
    double across = v.x * v.x + v.y * v.y;
    struct vec3 t1 = across > 0 ? vec3_scale(vec3_make(-v.y, v.x, 0), 1 / sqrt(across)) : vec3_make(1, 0, 0);
    struct vec3 t2 = vec3_cross(v, t1);
    /* A point of the hemisphere's projection along the view: half a disc and half an ellipse. */
    struct sample2 round = sample_disc(xi);
    double x = round.x, s = 0.5 * (1 + v.z);
    double y = (1 - s) * sqrt(x * x < 1 ? 1 - x * x : 0) + s * round.y;
    double z = 1 - x * x - y * y;
    struct vec3 h = vec3_add_scaled(vec3_scale(t1, x), t2, y);
    h = vec3_add_scaled(h, v, z > 0 ? sqrt(z) : 0);
    /* Back from the stretched frame. */
    struct vec3 local = vec3_normalize(vec3_make(alpha * h.x, alpha * h.y, h.z > 0 ? h.z : 0));
    struct vec3 out = vec3_add_scaled(vec3_add_scaled(vec3_scale(normal, local.z), a, local.x), b, local.y);
    return vec3_normalize(out);
}

/* G1(v) D(h) (v.h) / (n.v), Heitz 2018, equations 1 to 3. */
double microfacet_pdf(struct vec3 normal, struct vec3 view, double alpha, struct vec3 facet) {
    double n_h = vec3_dot(normal, facet), n_v = vec3_dot(normal, view), v_h = vec3_dot(view, facet);
    if (!(n_h > 0 && v_h > 0))
        return 0;
    double a2 = alpha * alpha, c2 = n_h * n_h, slope = c2 * a2 + (c2 < 1 ? 1 - c2 : 0);
    double facets = a2 / (PI * slope * slope);
    double masking = 2 / (n_v + sqrt(n_v * n_v + a2 * (n_v < 1 ? 1 - n_v * n_v : 0))); /* G1 / n.v */
    return masking * facets * v_h;
}

/* Heitz 2014, equation 72: the masking function Lambda of a direction with this cosine to the normal. */
static double lambda(double cosine, double alpha) {
    double c2 = cosine * cosine, slope2 = c2 < 1 ? alpha * alpha * (1 - c2) / c2 : 0;
    return (sqrt(1 + slope2) - 1) / 2;
}

double microfacet_escape(double cos_view, double cos_out, double alpha) {
    double seen = 1 + lambda(cos_view, alpha);
    return seen / (seen + lambda(cos_out, alpha));
}

/* --- two widths --- */

static struct vec3 to_frame(const struct facet_distribution *facets, struct vec3 v) {
    return vec3_make(vec3_dot(v, facets->along), vec3_dot(v, facets->across), vec3_dot(v, facets->normal));
}

/* Heitz 2018, listing 1. */
struct vec3 facet_distribution_sample(const struct facet_distribution *facets, struct vec3 view, struct sample2 xi) {
    struct vec3 local = to_frame(facets, view);
    struct vec3 v = vec3_normalize(
        vec3_make(facets->alpha_along * local.x, facets->alpha_across * local.y, local.z > 0 ? local.z : 0));
    double side = v.x * v.x + v.y * v.y;
    struct vec3 t1 = side > 0 ? vec3_scale(vec3_make(-v.y, v.x, 0), 1 / sqrt(side)) : vec3_make(1, 0, 0);
    struct vec3 t2 = vec3_cross(v, t1);
    struct sample2 round = sample_disc(xi);
    double x = round.x, s = 0.5 * (1 + v.z);
    double y = (1 - s) * sqrt(x * x < 1 ? 1 - x * x : 0) + s * round.y, z = 1 - x * x - y * y;
    struct vec3 h = vec3_add_scaled(vec3_scale(t1, x), t2, y);
    h = vec3_add_scaled(h, v, z > 0 ? sqrt(z) : 0);
    h = vec3_normalize(vec3_make(facets->alpha_along * h.x, facets->alpha_across * h.y, h.z > 0 ? h.z : 0));
    struct vec3 out = vec3_add_scaled(vec3_scale(facets->normal, h.z), facets->along, h.x);
    return vec3_normalize(vec3_add_scaled(out, facets->across, h.y));
}

/* The length of the stretched tangent part of a direction in the frame, over its height. */
static double stretched_slope2(const struct facet_distribution *facets, struct vec3 v) {
    double x = facets->alpha_along * v.x, y = facets->alpha_across * v.y;
    return (x * x + y * y) / (v.z * v.z);
}

double facet_distribution_pdf(const struct facet_distribution *facets, struct vec3 view, struct vec3 facet) {
    struct vec3 v = to_frame(facets, view), h = to_frame(facets, facet);
    double v_h = vec3_dot(view, facet);
    if (!(h.z > 0 && v.z > 0 && v_h > 0))
        return 0;
    double x = h.x / facets->alpha_along, y = h.y / facets->alpha_across, slope = x * x + y * y + h.z * h.z;
    double density = 1 / (PI * facets->alpha_along * facets->alpha_across * slope * slope);
    double masking = 2 / (v.z * (1 + sqrt(1 + stretched_slope2(facets, v)))); /* G1 / n.v */
    return masking * density * v_h;
}

double facet_distribution_escape(const struct facet_distribution *facets, struct vec3 view, struct vec3 out) {
    double seen = (sqrt(1 + stretched_slope2(facets, to_frame(facets, view))) + 1) / 2;
    double masked = (sqrt(1 + stretched_slope2(facets, to_frame(facets, out))) - 1) / 2;
    return seen / (seen + masked);
}
