/* See albedo.h. Nodes are even in the square root of the cosine, in the roughness, and in the square root of
 * (n - 1) / (n + 1), where albedos change about evenly. Between them go the cubics of Catmull and Rom; at both ends the
 * parabola through the last three nodes goes on. */
#include "material/albedo.h"

#include "material/albedo_tables.h"

#include <math.h>

/* Weights of four nodes in a row. */
struct taps {
    int first;
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
        return (struct taps){0, {here + 3 * before, next - 3 * before, after + before, 0}};
    if (i == count - 2)
        return (struct taps){i - 2, {0, before + after, here - 3 * after, next + 3 * after}};
    return (struct taps){i - 1, {before, here, next, after}};
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

static double share(double units) {
    double x = units / 65535;
    return x > 0 ? x < 1 ? x : 1 : 0;
}

static struct taps of_cosine(double cosine) {
    return taps_at(sqrt(cosine > 0 ? cosine : 0), ALBEDO_COSINES);
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
    struct taps c = of_cosine(cosine), r = of_roughness(roughness), k = of_index(eta);
    double sum = 0;
    for (int i = 0; i < 4; i++)
        sum += k.weight[i] * plane(values[k.first + i], &r, &c);
    return share(sum);
}

double albedo_reflection(double cosine, double roughness, double eta) {
    return block(reflection_table[eta > 1], cosine, roughness, eta);
}

double albedo_boundary(double cosine, double roughness, double eta) {
    return block(boundary_table[eta > 1], cosine, roughness, eta);
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
