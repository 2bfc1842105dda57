/* Polynomials in Bernstein form: sum of b[i] C(n,i) x^i (1-x)^(n-i) on [0, 1]. The form of splines; the coefficients
 * bound the polynomial (convex hull) and count its roots (variation diminishing), and rounding in them moves it
 * little. */
#ifndef GRAY_GEOMETRY_BERNSTEIN_H
#define GRAY_GEOMETRY_BERNSTEIN_H

enum { BERNSTEIN_MAX_DEGREE = 12 };

/* Roots inside [0, 1], ascending; at most `degree`. A coefficient of zero counts as positive, so the count is odd if
 * and only if exactly one of b[0] and b[degree] is negative, in spite of rounding; two roots closer than the rounding
 * error may be missed together. */
int bernstein_roots(const double *b, int degree, double *out);
double bernstein_value(const double *b, int degree, double x);
/* b restricted to [0, x] and [x, 1]; left[degree] and right[0] are the same number. Outputs may not alias b. */
void bernstein_split(const double *b, int degree, double x, double *left, double *right);
/* out (degree m + n) = a * b; out (degree n - 1) = b'. */
void bernstein_multiply(const double *a, int m, const double *b, int n, double *out);
void bernstein_derivative(const double *b, int degree, double *out);

#endif
