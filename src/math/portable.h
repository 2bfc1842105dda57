/* What C leaves to the library or the processor, with the same bits on every machine, also where there is no library.
 * Of +0 and -0 some libraries' fmin and fmax give the second argument, others the one of that sign. Here the second
 * wins among equals, and a number wins over a NaN. */
#ifndef GRAY_MATH_PORTABLE_H
#define GRAY_MATH_PORTABLE_H

#include <stdint.h>

static inline double math_min(double a, double b) {
    return a < b || b != b ? a : b;
}

static inline double math_max(double a, double b) {
    return a > b || b != b ? a : b;
}

/* The number m with x = m 2^exponent and .5 <= |m| < 1; of 0, infinities and NaN x itself, and the exponent 0. */
double math_frexp(double x, int *exponent);
/* x 2^exponent, rounded once. */
double math_ldexp(double x, int exponent);
/* x minus the multiple of y that leaves the sign of x and less than |y|: exact. NaN for an infinite x and for y = 0. */
double math_fmod(double x, double y);
/* The number next to x on the way to `to`; a NaN gives NaN. */
double math_nextafter(double x, double to);
float math_nextafterf(float x, float to);
/* high 2^64 + low, rounded once. */
double math_from_wide(uint64_t high, uint64_t low);

#endif
