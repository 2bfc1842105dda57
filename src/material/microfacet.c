/* The distribution of Trowbridge and Reitz ("GGX"; Walter, Marschner, Li, Torrance, "Microfacet Models for Refraction
 * through Rough Surfaces", EGSR 2007), sampled by visible normals (Heitz, "Sampling the GGX Distribution of
 * Visible Normals", JCGT 2018): no sample is wasted on facets that face away. Seen head on, the share of facets steeper
 * than theta is alpha^2 / (alpha^2 + tan^2 theta). */
#include "material/microfacet_internal.h"
#include "math/elementary.h"

#include "material/albedo_internal.h"
#include "material/albedo_tables_internal.h"
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

/* See albedo_internal.h. Nodes are even in the square root of the cosine, in the roughness, and in the square root of
 * (n - 1) / (n + 1), where albedos change about evenly. From inside, half of the cosines are beyond the angle of total
 * reflection, whatever the index, and the nodes are dense on both sides of it. Between nodes go the cubics of Catmull
 * and Rom; at both ends the parabola through the last three nodes goes on. */

/* Weights of four nodes in a row; the position is between nodes `low` and low + 1 of them. */
struct taps {
    int first, low;
    double weight[4];
};

/* x: 0 at the first node, 1 at the last one. */
static struct taps taps_at(double x, int count) {
    double position = (x > 0 ? x < 1 ? x : 1 : 0) * (count - 1);
    int i = position < count - 1 ? (int)position : count - 2;
    double t = position - i;
    double before = t * (-1 + t * (2 - t)) / 2, here = 1 + t * t * (3 * t - 5) / 2,
           next = t * (1 + t * (4 - 3 * t)) / 2, after = t * t * (t - 1) / 2;
    if (i == 0)
        return (struct taps){0, 0, {here + 3 * before, next - 3 * before, after + before, 0}};
    if (i == count - 2)
        return (struct taps){i - 2, 2, {0, before + after, here - 3 * after, next + 3 * after}};
    return (struct taps){i - 1, 1, {before, here, next, after}};
}

static double row(const uint16_t *values, const struct taps *taps) {
    const uint16_t *v = values + taps->first;
    return v[0] * taps->weight[0] + v[1] * taps->weight[1] + v[2] * taps->weight[2] + v[3] * taps->weight[3];
}

static double plane(const uint16_t (*values)[ALBEDO_COSINES], const struct taps *roughness, const struct taps *cosine) {
    double sum = 0;
    for (int i = 0; i < 4; i++)
        sum += roughness->weight[i] * row(values[roughness->first + i], cosine);
    return sum;
}

/* A row that jumps: beside the angle of total reflection a cubic would leave the values of the nodes around it. */
static double row_limited(const uint16_t *values, const struct taps *taps) {
    const uint16_t *v = values + taps->first + taps->low;
    double x = row(values, taps), low = v[0] < v[1] ? v[0] : v[1], high = v[0] < v[1] ? v[1] : v[0];
    return x < low ? low : x > high ? high : x;
}

static double share(double units) {
    double x = units / 65535;
    return x > 0 ? x < 1 ? x : 1 : 0;
}

static struct taps of_cosine(double cosine) {
    return taps_at(sqrt(cosine > 0 ? cosine : 0), ALBEDO_COSINES);
}

/* From inside: eta > 1. */
static struct taps of_cosine_inside(double cosine, double eta) {
    double critical = sqrt(1 - 1 / (eta * eta));
    if (cosine >= critical)
        return taps_at(0.5 + 0.5 * sqrt((cosine - critical) / (1 - critical)), ALBEDO_COSINES);
    double x = cosine > 0 ? cosine / critical : 0;
    return taps_at(x < 0.5 ? 0.5 * sqrt(0.5 * x) : 0.5 - 0.5 * sqrt(0.5 * (1 - x)), ALBEDO_COSINES);
}

static struct taps of_roughness(double roughness) {
    return taps_at(roughness, ALBEDO_ROUGHNESSES);
}

/* eta: either way. */
static struct taps of_index(double eta) {
    return taps_at(sqrt(2 * fabs(1 - eta) / (1 + eta)), ALBEDO_INDICES);
}

double albedo_mirror(double cosine, double roughness) {
    struct taps c = of_cosine(cosine), r = of_roughness(roughness);
    return share(plane(mirror_table, &r, &c));
}

double albedo_mirror_average(double roughness) {
    struct taps r = of_roughness(roughness);
    return share(row(mirror_average_table, &r));
}

static double block(const uint16_t (*values)[ALBEDO_ROUGHNESSES][ALBEDO_COSINES], double cosine, double roughness,
                    double eta) {
    struct taps c = eta > 1 ? of_cosine_inside(cosine, eta) : of_cosine(cosine);
    struct taps r = of_roughness(roughness), k = of_index(eta);
    double sum = 0;
    for (int i = 0; i < 4 && eta <= 1; i++)
        sum += k.weight[i] * plane(values[k.first + i], &r, &c);
    for (int i = 0; i < 16 && eta > 1; i++)
        sum += k.weight[i / 4] * r.weight[i % 4] * row_limited(values[k.first + i / 4][r.first + i % 4], &c);
    return sum;
}

/* From outside, the table has the difference to a smooth boundary, which varies less with the index. From inside, that
 * difference has a cusp at the angle of total reflection; facets of little roughness reflect as a smooth boundary. */
double albedo_reflection(double cosine, double roughness, double eta) {
    double units = block(reflection_table[eta > 1], cosine, roughness, eta);
    double rough = eta > 1 ? fmin(fmax(16 * roughness - 1, 0), 1) : 0;
    if (rough == 1)
        return share(units);
    double smooth = 65535 * dielectric_fresnel(cosine, eta);
    return share(eta > 1 ? smooth + rough * (units - smooth) : 2 * units - 65535 + smooth);
}

double albedo_boundary(double cosine, double roughness, double eta) {
    return share(block(boundary_table[eta > 1], cosine, roughness, eta));
}

double albedo_boundary_average(double roughness, double eta) {
    struct taps r = of_roughness(roughness), k = of_index(eta);
    double sum = 0;
    for (int i = 0; i < 4; i++)
        sum += k.weight[i] * row(boundary_average_table[eta > 1][k.first + i], &r);
    return share(sum);
}

double albedo_fuzz(double cosine, double roughness) {
    struct taps c = of_cosine(cosine), r = of_roughness(roughness);
    return share(plane(fuzz_table, &r, &c));
}

/* --- two widths: ratios of lacks --- */

static double stretch_row(const int16_t *values, const struct taps *taps) {
    const int16_t *v = values + taps->first;
    return v[0] * taps->weight[0] + v[1] * taps->weight[1] + v[2] * taps->weight[2] + v[3] * taps->weight[3];
}

double albedo_stretch(double cosine, double cos_double, double alpha_along, double alpha_across) {
    struct taps width = taps_at(sqrt(alpha_along), STRETCH_WIDTHS),
                stretch = taps_at(alpha_across / alpha_along, STRETCHES);
    struct taps c = taps_at(sqrt(cosine > 0 ? cosine : 0), STRETCH_COSINES);
    double waves[STRETCH_WAVES] = {1, cos_double}, sum = 0; /* Chebyshev: cosines of multiples of an angle */
    for (int w = 2; w < STRETCH_WAVES; w++)
        waves[w] = 2 * cos_double * waves[w - 1] - waves[w - 2];
    for (int i = 0; i < 16; i++)
        for (int w = 0; w < STRETCH_WAVES; w++)
            sum += width.weight[i / 4] * stretch.weight[i % 4] * waves[w] *
                   stretch_row(stretch_table[width.first + i / 4][stretch.first + i % 4][w], &c);
    return sum > 0 ? sum / 8192 : 0;
}

double albedo_stretch_average(double alpha_along, double alpha_across) {
    struct taps width = taps_at(sqrt(alpha_along), STRETCH_WIDTHS),
                stretch = taps_at(alpha_across / alpha_along, STRETCHES);
    double sum = 0;
    for (int i = 0; i < 4; i++)
        sum += width.weight[i] * stretch_row(stretch_average_table[width.first + i], &stretch);
    return sum / 8192;
}
