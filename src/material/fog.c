/* Beer's law along a straight way with densities that can be integrated exactly: no steps, no noise. The grid is walked
 * cell by cell (Amanatides and Woo, "A Fast Voxel Traversal Algorithm", Eurographics 1987). */
#include "material/fog.h"

#include "math/elementary.h"

/* exp(-depth); what is not a number came from infinite times nothing in fog without bounds: all of it is hidden. */
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
    /* Nearly level: the difference of two sums would be noise, the density in the middle is right. */
    if (climb == 0 || (isfinite(end) && fabs(rise) <= 0x1p-26 * (fabs(y) + fabs(end)))) {
        double density = profile_at(fog, climb == 0 ? y : y + 0.5 * rise);
        return density > 0 ? density * distance : 0;
    }
    return (profile_sum(fog, end) - profile_sum(fog, y)) / climb;
}

/* The part of the way that lies in the box; false: none. */
static bool clip(const struct fog *fog, struct vec3 o, struct vec3 d, double *from, double *to) {
    for (int axis = 0; axis < 3; axis++) {
        double start = vec3_get(o, axis), step = vec3_get(d, axis), low = vec3_get(fog->corner, axis);
        double high = low + vec3_get(fog->size, axis);
        if (step == 0) {
            if (start < low || start >= high)
                return false;
            continue;
        }
        double a = (low - start) / step, b = (high - start) / step;
        *from = fmax(*from, a < b ? a : b);
        *to = fmin(*to, a < b ? b : a);
    }
    return *from < *to;
}

static double grid_depth(const struct fog *fog, struct vec3 o, struct vec3 d, double distance) {
    double from = 0, to = distance, sum = 0, next[3], delta[3];
    int64_t cell[3], step[3];
    if (!clip(fog, o, d, &from, &to))
        return 0;
    for (int axis = 0; axis < 3; axis++) {
        double start = vec3_get(o, axis), speed = vec3_get(d, axis), low = vec3_get(fog->corner, axis);
        double width = vec3_get(fog->size, axis) / fog->cells[axis];
        double at = floor((start + speed * from - low) / width);
        cell[axis] = at < 0 ? 0 : at >= fog->cells[axis] ? (int64_t)fog->cells[axis] - 1 : (int64_t)at;
        step[axis] = speed > 0 ? 1 : -1;
        double border = low + width * (double)(cell[axis] + (speed > 0 ? 1 : 0));
        next[axis] = speed == 0 ? INFINITY : (border - start) / speed;
        delta[axis] = speed == 0 ? INFINITY : width / fabs(speed);
    }
    for (double t = from; t < to;) {
        int axis = next[0] <= next[1] && next[0] <= next[2] ? 0 : next[1] <= next[2] ? 1 : 2;
        double end = fmin(next[axis], to);
        uint64_t index = (uint64_t)cell[0] + fog->cells[0] * ((uint64_t)cell[1] + fog->cells[1] * (uint64_t)cell[2]);
        sum += fog->densities[index] * fmax(end - t, 0);
        t = end;
        next[axis] += delta[axis];
        cell[axis] += step[axis];
        if (cell[axis] < 0 || cell[axis] >= fog->cells[axis])
            break;
    }
    return sum;
}

double fog_transmittance(const struct fog *fog, struct vec3 origin, struct vec3 direction, double distance) {
    double reach;
    switch (fog->kind) {
    case FOG_EXPONENTIAL:
        return fog->density > 0 ? faded(fog->density * distance) : 1;
    case FOG_SQUARED:
        reach = fog->density * distance;
        return fog->density > 0 ? faded(reach * reach) : 1;
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
    }
    return 1;
}
