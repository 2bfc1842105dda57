/* What C leaves to the library or the processor, with the same bits on every machine.
 * Of +0 and -0 some libraries' fmin and fmax give the second argument, others the one of that sign. Here the second
 * wins among equals, and a number wins over a NaN. */
#ifndef GRAY_MATH_PORTABLE_H
#define GRAY_MATH_PORTABLE_H

static inline double math_min(double a, double b) {
    return a < b || b != b ? a : b;
}

static inline double math_max(double a, double b) {
    return a > b || b != b ? a : b;
}

#endif
