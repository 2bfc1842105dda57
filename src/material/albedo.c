/* Nodes of the tables are even in the square root of the cosine, in the roughness, and in the square root of
 * (n - 1) / (n + 1), where albedos change about evenly. From inside, half of the cosines are beyond the angle of total
 * reflection, whatever the index, and the nodes are dense on both sides of it. Between nodes go the cubics of Catmull
 * and Rom; at both ends the parabola through the last three nodes goes on. */
#include "material/albedo_internal.h"

#include "material/albedo_tables_internal.h"
#include "material/microfacet_internal.h"

#include <math.h>

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
    double rough = eta > 1 ? math_min(math_max(16 * roughness - 1, 0), 1) : 0;
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
