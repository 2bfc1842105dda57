/* Elementary functions with the same bits on every processor: the only ones allowed for pixels.
 *
 * libm chooses between variants by processor (with and without FMA), and their last bits differ. These use + - * / and
 * square root in double precision, rounding to nearest, and integer operations, nothing else.
 *
 * Errors are below 1 unit in the last place (el_tan: 1.05; el_exp, el_log and el_pow: 0.52; measured by
 * tests/unit/math/test_elementary.c), results in the subnormal range included. Special cases follow C11 Annex F: NaN,
 * infinities, signed zeros. A domain error gives a positive quiet NaN. errno is never touched; flags are unspecified.
 * Angles are in radians, of any size. */
#ifndef GRAY_MATH_ELEMENTARY_H
#define GRAY_MATH_ELEMENTARY_H

/* The double nearest to pi. */
#define PI 3.14159265358979323846
#define TURN 6.28318530717958647692 /* 2 PI */

double el_sin(double x);
double el_cos(double x);
void el_sincos(double x, double *sine, double *cosine);
double el_tan(double x);
double el_asin(double x);
double el_acos(double x);
double el_atan2(double y, double x);

double el_exp(double x);
double el_exp2(double x);
double el_expm1(double x);
double el_log(double x);
double el_log2(double x);
double el_log10(double x);
double el_pow(double x, double y);

double el_sinh(double x);
double el_cosh(double x);
double el_tanh(double x);

double el_cbrt(double x);
/* x - trunc(x / y) * y, exact. */
double el_fmod(double x, double y);

#endif
