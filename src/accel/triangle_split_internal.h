/* Ranges of references to triangles, and how they are partitioned while a hierarchy is built. Private to
 * src/accel/triangle_*. */
#ifndef GRAY_ACCEL_TRIANGLE_SPLIT_INTERNAL_H
#define GRAY_ACCEL_TRIANGLE_SPLIT_INTERNAL_H

#include "accel/triangle_build_internal.h"
#include "accel/triangle_vectors_internal.h"

/* References first .. first + count - 1, their box and the box of their centres (times two). */
struct range {
    float4 min, max, centre_min, centre_max;
    uint32_t first, count;
};

static inline float half_area(float4 lo, float4 hi) {
    float e[4];
    float4_store_any(e, float4_sub(hi, lo));
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

/* The boxes of a range whose first and count are set. */
void range_measure(const struct reference *references, struct range *range);

/* Splits a range into two that are not empty; halve: in the middle of the list, not by surface. */
void split_range(struct reference *references, const struct range *range, bool halve, struct range *left,
                 struct range *right);

/* Separates a floor, whose triangles each have half the surface of the range, from the rest if it is much thinner;
 * false: there is none. The surface area heuristic sees no gain, but rays start on floors, and rays that leave a floor
 * miss a flat box. */
bool split_floor(struct reference *references, const struct range *range, struct range *floor, struct range *rest);

#endif
