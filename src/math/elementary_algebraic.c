/* Cube root, hypotenuse and remainder: the elementary functions that need no tables.
 *
 * Both roots end with one correction step whose residual is computed without error, so the answer is within 0.67 (cube
 * root: Halley's iteration, the argument's bit pattern divided by three as first guess, as in fdlibm) and 0.51 last
 * places (hypotenuse). Powers of two keep intermediate squares inside the range. Only + - * / sqrt; see elementary.c.
 */
#include "math/elementary.h"

#include <math.h>
#include <stdint.h>

#include "math/exact.h"

double el_cbrt(double x) {
    double a = fabs(x);
    if (!(a > 0.0 && a < INFINITY))
        return x + x;
    double down = 1.0;
    if (a < 0x1.0p-1022) {
        a *= 0x1.0p54;
        down = 0x1.0p-18;
    }
    /* A third of the exponent and mantissa as one integer is right to 4 %; each Halley step triples the good bits. */
    double t = from_bits(to_bits(a) / 3 + 0x2a9f7893782da1ceu);
    for (int i = 0; i < 2; i++) {
        double quotient = a / (t * t);
        t = t * (t + 2.0 * quotient) / (2.0 * t + quotient);
    }
    /* With 26 bits t^2 is exact, so the last step's residual is good. */
    t = from_bits((to_bits(t) + 0x4000000u) & 0xfffffffff8000000u);
    double quotient = a / (t * t);
    return copysign((t + t * (quotient - t) / (2.0 * t + quotient)) * down, x);
}

double el_hypot(double x, double y) {
    double a = fabs(x), b = fabs(y);
    if (isinf(a) || isinf(b))
        return INFINITY;
    if (isnan(a) || isnan(b))
        return a + b;
    double big = a > b ? a : b, small = a > b ? b : a;
    if (small <= big * 0x1.0p-54)
        return big + small;
    double back = 1.0;
    if (big > 0x1.0p450) {
        back = 0x1.0p600;
        big *= 0x1.0p-600;
        small *= 0x1.0p-600;
    } else if (small < 0x1.0p-400) {
        back = 0x1.0p-600;
        big *= 0x1.0p600;
        small *= 0x1.0p600;
    }
    struct pair bb = exact_product(big, big), ss = exact_product(small, small);
    struct pair sum = exact_fast_sum(bb.hi, ss.hi);
    double h = sqrt(sum.hi);
    struct pair hh = exact_product(h, h);
    double rest = (sum.hi - hh.hi) + ((sum.lo + (bb.lo + ss.lo)) - hh.lo);
    return (h + rest / (2.0 * h)) * back;
}

/* The library's fmod is exact, so every implementation agrees; only its error reporting is kept away. */
double el_fmod(double x, double y) {
    if (isnan(x) || isnan(y))
        return x + y;
    if (isinf(x) || y == 0.0)
        return invalid();
    return fmod(x, y);
}
