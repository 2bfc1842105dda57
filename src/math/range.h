/* The range of numbers from scripts and files, and the conversion of light to single precision. A number beyond the
 * limit is an error where it enters. Products of legal numbers can still exceed single precision: values in a film are
 * clamped. */
#ifndef GRAY_MATH_RANGE_H
#define GRAY_MATH_RANGE_H

#include "math/colour.h"

#include <float.h>

/* Of the absolute value. Squares and fourth powers of lengths stay within the range of doubles. */
#define NUMBER_LIMIT 1e30
/* The smallest length that may be divided by. */
#define NUMBER_SMALLEST 1e-30

static inline bool number_in_range(double x) {
    return fabs(x) <= NUMBER_LIMIT;
}
/* False for NaN. */
static inline bool colour_within(struct colour a, double limit) {
    return fabs(a.r) <= limit && fabs(a.g) <= limit && fabs(a.b) <= limit;
}
/* NaN becomes 0. */
static inline double number_clamped(double x, double limit) {
    return x > limit ? limit : x < -limit ? -limit : x == x ? x : 0;
}
static inline struct colour colour_clamped(struct colour a, double limit) {
    return (struct colour){number_clamped(a.r, limit), number_clamped(a.g, limit), number_clamped(a.b, limit)};
}

#endif
