/* Splits the triangles of a range by the binned surface area heuristic: Ingo Wald, "On fast Construction of
 * SAH-based Bounding Volume Hierarchies", RT 2007. The cost of a leaf counts blocks of eight triangles, not
 * triangles. */
#include "accel/triangle_split_internal.h"

enum { BINS = 16 };

static float4 reference_min(const struct reference *r) {
    return float4_three(float4_load_any(r->min));
}

static float4 reference_max(const struct reference *r) {
    return float4_three(float4_load_any(r->max));
}

static void range_clear(struct range *range) {
    range->min = range->centre_min = float4_all(INFINITY);
    range->max = range->centre_max = float4_all(-INFINITY);
}

static inline void range_add(struct range *range, float4 lo, float4 hi, float4 centre) {
    range->min = float4_min(range->min, lo);
    range->max = float4_max(range->max, hi);
    range->centre_min = float4_min(range->centre_min, centre);
    range->centre_max = float4_max(range->centre_max, centre);
}

void range_measure(const struct reference *references, struct range *range) {
    range_clear(range);
    for (uint32_t i = range->first; i < range->first + range->count; i++) {
        float4 lo = reference_min(&references[i]), hi = reference_max(&references[i]);
        range_add(range, lo, hi, float4_add(lo, hi));
    }
}

/* Counts half blocks, so that full blocks are favoured and a few more triangles are not free. */
static float leaf_cost(uint32_t triangles) {
    return (float)((triangles + 3) / 4);
}

struct split {
    int axis; /* -1: nothing separates the centres */
    int32_t last_left;
    float low[4], scale[4];
};

static void bins_of(const struct split *split, float4 centre, int32_t bin[4]) {
    float4_store_int(bin, float4_mul(float4_sub(centre, float4_load_any(split->low)), float4_load_any(split->scale)));
}

static void find_split(const struct reference *references, const struct range *range, struct split *split) {
    float extent[4];
    float4_store_any(extent, float4_sub(range->centre_max, range->centre_min));
    float4_store_any(split->low, range->centre_min);
    split->axis = -1;
    bool any = false;
    /* The scale from a centre to its bin; 0 along an axis without extent. */
    int bins = range->count < 64 ? BINS / 2 : BINS;
    for (int k = 0; k < 3; k++) {
        split->scale[k] = extent[k] > 0 ? (float)bins * 0.999f / extent[k] : 0;
        if (!(split->scale[k] < 0x1p100f))
            split->scale[k] = 0;
        any |= split->scale[k] > 0;
    }
    split->low[3] = split->scale[3] = 0;
    if (!any)
        return;
    /* The boxes and counts of the bins. */
    float4 lo[3][BINS], hi[3][BINS];
    uint32_t count[3][BINS] = {{0}};
    for (int k = 0; k < 3; k++)
        for (int b = 0; b < bins; b++) {
            lo[k][b] = float4_all(INFINITY);
            hi[k][b] = float4_all(-INFINITY);
        }
    for (uint32_t i = range->first; i < range->first + range->count; i++) {
        float4 a = reference_min(&references[i]), b = reference_max(&references[i]);
        int32_t bin[4];
        bins_of(split, float4_add(a, b), bin);
        for (int k = 0; k < 3; k++) {
            lo[k][bin[k]] = float4_min(lo[k][bin[k]], a);
            hi[k][bin[k]] = float4_max(hi[k][bin[k]], b);
            count[k][bin[k]]++;
        }
    }
    /* The cheapest plane between two bins: costs of the right sides first, then with the left sides. */
    float best = INFINITY;
    for (int k = 0; k < 3; k++) {
        if (!(split->scale[k] > 0))
            continue;
        float right_cost[BINS];
        float4 a = float4_all(INFINITY), b = float4_all(-INFINITY);
        uint32_t n = 0;
        for (int j = bins - 1; j > 0; j--) {
            a = float4_min(a, lo[k][j]);
            b = float4_max(b, hi[k][j]);
            n += count[k][j];
            right_cost[j] = n ? half_area(a, b) * leaf_cost(n) : -1;
        }
        a = float4_all(INFINITY);
        b = float4_all(-INFINITY);
        n = 0;
        for (int j = 0; j + 1 < bins; j++) {
            a = float4_min(a, lo[k][j]);
            b = float4_max(b, hi[k][j]);
            n += count[k][j];
            if (n == 0 || right_cost[j + 1] < 0)
                continue;
            float cost = half_area(a, b) * leaf_cost(n) + right_cost[j + 1];
            if (cost < best) {
                best = cost;
                split->axis = k;
                split->last_left = j;
            }
        }
    }
}

void split_range(struct reference *references, const struct range *range, bool halve, struct range *left,
                 struct range *right) {
    struct split split = {.axis = -1};
    if (!halve)
        find_split(references, range, &split);
    /* Without a plane: halves, in the order that there is. */
    if (split.axis < 0) {
        left->first = range->first;
        left->count = range->count / 2;
        right->first = range->first + left->count;
        right->count = range->count - left->count;
        range_measure(references, left);
        range_measure(references, right);
        return;
    }
    /* Else as quicksort divides: those of the right side are swapped to the end. */
    range_clear(left);
    range_clear(right);
    uint32_t i = range->first, end = range->first + range->count;
    while (i < end) {
        float4 lo = reference_min(&references[i]), hi = reference_max(&references[i]), centre = float4_add(lo, hi);
        int32_t bin[4];
        bins_of(&split, centre, bin);
        if (bin[split.axis] <= split.last_left) {
            range_add(left, lo, hi, centre);
            i++;
            continue;
        }
        range_add(right, lo, hi, centre);
        end--;
        struct reference swap = references[i];
        references[i] = references[end];
        references[end] = swap;
    }
    left->first = range->first;
    left->count = i - range->first;
    right->first = i;
    right->count = range->count - left->count;
}

bool split_floor(struct reference *references, const struct range *range, struct range *floor, struct range *rest) {
    float min = half_area(range->min, range->max) / 2;
    uint32_t end = range->first;
    for (uint32_t i = range->first; i < range->first + range->count; i++) {
        if (half_area(reference_min(&references[i]), reference_max(&references[i])) < min)
            continue;
        struct reference swap = references[i];
        references[i] = references[end];
        references[end++] = swap;
    }
    *floor = (struct range){.first = range->first, .count = end - range->first};
    *rest = (struct range){.first = end, .count = range->count - floor->count};
    if (floor->count == 0 || rest->count == 0)
        return false;
    range_measure(references, floor);
    float extent[4], thin[4];
    float4_store_any(extent, float4_sub(range->max, range->min));
    float4_store_any(thin, float4_sub(floor->max, floor->min));
    if (!(thin[0] < extent[0] / 16 || thin[1] < extent[1] / 16 || thin[2] < extent[2] / 16))
        return false;
    range_measure(references, rest);
    return true;
}
