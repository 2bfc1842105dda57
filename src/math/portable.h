/* What C leaves to the library or the processor, with the same bits on every machine.
 * Of +0 and -0 some libraries' fmin and fmax give the second argument, others the one of that sign. Here the second
 * wins among equals, and a number wins over a NaN. A number beyond the range of an integer has no conversion in C:
 * processors give the nearest integer, or the least. */
#ifndef GRAY_MATH_PORTABLE_H
#define GRAY_MATH_PORTABLE_H

#include <stdint.h>

static inline double math_min(double a, double b) {
    return a < b || b != b ? a : b;
}

static inline double math_max(double a, double b) {
    return a > b || b != b ? a : b;
}

/* Towards zero; the nearest integer beyond the range, 0 of NaN. */
static inline int64_t math_integer(double x) {
    return x >= 0x1p63 ? INT64_MAX : x >= -0x1p63 ? (int64_t)x : x < 0 ? INT64_MIN : 0;
}

#endif
