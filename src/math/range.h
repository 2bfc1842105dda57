/* The range of numbers from scripts and files, and the conversion of light to single precision. A number beyond the
 * limit is an error where it enters. Products of legal numbers can still exceed single precision: values in a film are
 * clamped. */
#ifndef GRAY_MATH_RANGE_H
#define GRAY_MATH_RANGE_H

#include "math/vec3.h"

#include <float.h>

/* Of the absolute value. Squares and fourth powers of lengths stay within the range of doubles. */
#define NUMBER_LIMIT 1e30
/* The smallest length that may be divided by. */
#define NUMBER_SMALLEST 1e-30

static inline bool number_in_range(double x) {
    return fabs(x) <= NUMBER_LIMIT;
}
/* False for NaN. */
static inline bool vec3_within(struct vec3 a, double limit) {
    return fabs(a.x) <= limit && fabs(a.y) <= limit && fabs(a.z) <= limit;
}
/* NaN becomes 0. */
static inline double number_clamped(double x, double limit) {
    return x > limit ? limit : x < -limit ? -limit : x == x ? x : 0;
}
static inline struct vec3 vec3_clamped(struct vec3 a, double limit) {
    return (struct vec3){number_clamped(a.x, limit), number_clamped(a.y, limit), number_clamped(a.z, limit)};
}

#endif
