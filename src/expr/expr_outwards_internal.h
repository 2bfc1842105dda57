/* Ends of intervals in vectors of math/lanes.h, for the evaluators of bounds: rounding outwards, and comparisons as
 * bits, one for each lane. */
#ifndef GRAY_EXPR_EXPR_OUTWARDS_INTERNAL_H
#define GRAY_EXPR_EXPR_OUTWARDS_INTERNAL_H

#include "math/lanes.h"

#include <float.h>

#define BITS(mask) (uint64_t) double_lanes_bits(mask)
#define IS_LESS(a, b) BITS(double_lanes_less(a, b))
#define IS_LESS_EQUAL(a, b) BITS(double_lanes_less_equal(a, b))
#define IS_NAN(a) BITS(double_lanes_unordered(a, a))

static inline double_lanes double_lanes_choose_bits(uint64_t bits, double_lanes a, double_lanes b) {
    return double_lanes_choose(double_lanes_mask_of_bits(bits), a, b);
}

/* A NaN of an infinity less an infinity is refused by the comparison. */
static inline double_lanes below(double_lanes v) {
    return double_lanes_min(v - double_lanes_size(v) * DBL_EPSILON, v);
}

static inline double_lanes above(double_lanes v) {
    return double_lanes_max(v + double_lanes_size(v) * DBL_EPSILON, v);
}

#endif
