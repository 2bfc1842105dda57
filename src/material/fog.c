/* Beer's law along a straight line, for densities that can be integrated exactly: no steps, no noise. The grid is
 * traversed cell by cell. */
#include "material/fog.h"

#include "material/fog_cells_internal.h"
#include "material/fog_field.h"
#include "math/elementary.h"

#include <math.h>

/* exp(-depth); NaN comes from infinity times 0 in unbounded fog: the transmittance is 0. */
static double faded(double depth) {
    return depth <= 0 ? 1 : depth < 1e4 ? el_exp(-depth) : 0;
}

static double height_depth(const struct fog *fog, double y, double climb, double distance) {
    double here = fog->density * el_exp(-(y - fog->base) / fog->scale), k = climb / fog->scale;
    if (here == 0 && k >= 0)
        return 0;
    return k == 0 ? here * distance : here * (-el_expm1(-k * distance) / k);
}

/* Integral of the profile from its first height up to y; below it the sign is negative. */
static double profile_sum(const struct fog *fog, double y) {
    uint32_t last = fog->count - 1, low = 0, high = last;
    if (y <= fog->heights[0])
        return fog->densities[0] > 0 ? fog->densities[0] * (y - fog->heights[0]) : 0;
    if (y >= fog->heights[last])
        return fog->sums[last] + (fog->densities[last] > 0 ? fog->densities[last] * (y - fog->heights[last]) : 0);
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        *(fog->heights[middle] <= y ? &low : &high) = middle;
    }
    double step = y - fog->heights[low], share = step / (fog->heights[high] - fog->heights[low]);
    return fog->sums[low] + step * (fog->densities[low] + 0.5 * share * (fog->densities[high] - fog->densities[low]));
}

static double profile_at(const struct fog *fog, double y) {
    uint32_t i = 0;
    while (i + 1 < fog->count && fog->heights[i + 1] <= y)
        i++;
    if (y <= fog->heights[0] || i + 1 == fog->count)
        return fog->densities[i];
    double share = (y - fog->heights[i]) / (fog->heights[i + 1] - fog->heights[i]);
    return fog->densities[i] + share * (fog->densities[i + 1] - fog->densities[i]);
}

static double profile_depth(const struct fog *fog, double y, double climb, double distance) {
    double end = y + climb * distance, rise = end - y;
    /* Nearly horizontal: the difference of two sums would be noise; the density in the middle is accurate. */
    if (climb == 0 || (isfinite(end) && fabs(rise) <= 0x1p-26 * (fabs(y) + fabs(end)))) {
        double density = profile_at(fog, climb == 0 ? y : y + 0.5 * rise);
        return density > 0 ? density * distance : 0;
    }
    return (profile_sum(fog, end) - profile_sum(fog, y)) / climb;
}

static double grid_depth(const struct fog *fog, struct vec3 o, struct vec3 d, double distance) {
    const struct fog_cells cells = {fog->corner, fog->size, {fog->cells[0], fog->cells[1], fog->cells[2]}};
    struct fog_traversal traversal;
    uint64_t cell;
    double from, to, sum = 0;
    if (!fog_traversal_begin(&traversal, &cells, o, d, distance))
        return 0;
    while (fog_traversal_next(&traversal, &cell, &from, &to))
        sum += fog->densities[cell] * math_max(to - from, 0);
    return sum;
}

double fog_transmittance(const struct fog *fog, struct vec3 origin, struct vec3 direction, double distance) {
    double optical_depth;
    switch (fog->kind) {
    case FOG_EXPONENTIAL:
        return fog->density > 0 ? faded(fog->density * distance) : 1;
    case FOG_SQUARED:
        optical_depth = fog->density * distance;
        return fog->density > 0 ? faded(optical_depth * optical_depth) : 1;
    case FOG_LINEAR:
        if (distance <= fog->near)
            return 1;
        return distance >= fog->far ? 0 : (fog->far - distance) / (fog->far - fog->near);
    case FOG_HEIGHT:
        return faded(height_depth(fog, origin.y, direction.y, distance));
    case FOG_PROFILE:
        return faded(profile_depth(fog, origin.y, direction.y, distance));
    case FOG_GRID:
        return faded(grid_depth(fog, origin, direction, distance));
    case FOG_FIELD: {
        struct colour source;
        return fog_field_transmittance(fog->field, &(struct medium_line){origin, direction, distance, 0}, &source);
    }
    }
    return 1;
}

void fog_bundle(struct bundle *bundle, void *any) {
    struct fog *fog = any;
    const size_t cells = (size_t)fog->cells[0] * fog->cells[1] * fog->cells[2];
    BUNDLE(bundle, fog->heights, fog->count, NULL);
    BUNDLE(bundle, fog->densities, fog->kind == FOG_GRID ? cells : fog->count, NULL);
    BUNDLE(bundle, fog->sums, fog->count, NULL);
    fog_field_bundle(bundle, &fog->field);
}
