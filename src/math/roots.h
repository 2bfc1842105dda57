/* Real roots of polynomials with double coefficients.
 *
 * All functions write roots in ascending order and return how many. Common guarantees:
 *  - Parity: a root where the polynomial changes sign is written once; one where it only touches zero is written twice
 *    or not at all. So the count is odd exactly if the signs at the two ends differ. (CSG counts on this.)
 *  - Scale: x replaced by 2^k x, or all coefficients multiplied by 2^k, gives the same bits shifted, while no
 *    coefficient leaves the normal range.
 *  - A leading coefficient of zero, or so small that its root is beyond the doubles, is a lower degree; roots that
 *    overflow are left out.
 *  - The zero polynomial, a NaN or an infinite coefficient, a NaN bound or lo > hi: no roots.
 * Accuracy: roots_quadratic to about two last places whatever cancels in the discriminant. The others as far as
 * rounding in the evaluation of the polynomial allows: a well separated root to some last places times its condition
 * number, a root of multiplicity m to about 2^(-52/m) of its size; two roots closer than that may be missed
 * together. */
#ifndef GRAY_MATH_ROOTS_H
#define GRAY_MATH_ROOTS_H

enum { ROOTS_MAX_DEGREE = 12 };

/* a x^2 + b x + c */
int roots_quadratic(double a, double b, double c, double out[2]);
/* Sum of coefficients[i] x^i, i = 0..degree <= ROOTS_MAX_DEGREE, in the closed interval [lo, hi], which may be
 * infinite. out holds at least `degree` numbers. */
int roots_polynomial(const double *coefficients, int degree, double lo, double hi, double *out);

#endif
