/* Roots of polynomials.
 *
 * Quadratics: the discriminant from exact products (Kahan, "On the cost of floating-point computation without extra-
 * precise arithmetic", 2004; products by Dekker 1971), the root without cancellation first, the other by Vieta.
 *
 * Higher degrees: between neighbouring roots of its derivative a polynomial is monotonic, so the signs there determine
 * which pieces contain a root, and each such root is bracketed; the derivative's roots come from the same method, one
 * degree lower, down to the quadratic. In a bracket Newton's steps are taken while they stay inside and shrink, else
 * the bit patterns are halved, which needs at most 64 steps whatever the magnitudes.
 *
 * Reasons for this method: it always converges, and its count has the parity of the signs at the ends, which CSG
 * requires. The remainders of Sturm's chain cancel, so their signs are noise exactly where roots are close; the
 * eigenvalues of a companion matrix need iteration, rounding splits conjugate pairs, and a scaled scene does not give
 * the same bits. The method can miss a pair of roots that rounding of the coefficients may have removed; tests count
 * these by their gap.
 *
 * Invariant: x is measured in a power of two such that every root in range lies in [-1, 1], and the largest coefficient
 * is in [1/2, 1): nothing overflows, and a scene scaled by a power of two takes exactly the same steps. */
#include "math/roots.h"

#include "math/bracket.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "math/exact.h"
#include "math/portable.h"

static int exponent_of(double x) {
    int exponent;
    math_frexp(x, &exponent);
    return exponent;
}

/* Adds two roots in any order to the result; those that overflowed are left out. */
static int two_roots(double r, double s, double out[2]) {
    int count = 0;
    if (isfinite(math_min(r, s)))
        out[count++] = math_min(r, s);
    if (isfinite(math_max(r, s)))
        out[count++] = math_max(r, s);
    return count;
}

/* Coefficients whose squares and products are far from both ends of the range; the outer ones are not zero. */
static inline int quadratic_moderate(double a, double b, double c, double out[2]) {
    struct pair bb = exact_product(b, b), ac = exact_product(4.0 * a, c);
    double discriminant = (bb.hi - ac.hi) + (bb.lo - ac.lo);
    if (discriminant < 0.0)
        return 0;
    if (discriminant == 0.0) {
        out[0] = out[1] = -0.5 * b / a;
        return 2;
    }
    double q = -0.5 * (b + copysign(sqrt(discriminant), b));
    double r = q / a, s = c / q;
    out[0] = r < s ? r : s;
    out[1] = r < s ? s : r;
    return 2;
}

static inline bool is_moderate(double x) {
    return fabs(x) > 0x1.0p-400 && fabs(x) < 0x1.0p400;
}

int roots_quadratic(double a, double b, double c, double out[2]) {
    if (is_moderate(a) && is_moderate(b) && is_moderate(c))
        return quadratic_moderate(a, b, c, out);
    if (!isfinite(a) || !isfinite(b) || !isfinite(c))
        return 0;
    if (a == 0.0) {
        if (b == 0.0)
            return 0;
        out[0] = c == 0.0 ? 0.0 : -c / b;
        return isfinite(out[0]) ? 1 : 0;
    }
    if (c == 0.0)
        return two_roots(0.0, b == 0.0 ? 0.0 : -b / a, out);

    /* x = 2^shift y makes the outer coefficients alike. */
    int ea = exponent_of(a), ec = exponent_of(c);
    int shift = (ec - ea) / 2;
    if (ec - ea < 2 * shift)
        shift--;
    if (b != 0.0 && exponent_of(b) + shift > ec + 60)
        return two_roots(-b / a, -c / b, out); /* the rest is far below */
    double ya = math_ldexp(a, 2 * shift - ec), yb = math_ldexp(b, shift - ec), yc = math_ldexp(c, -ec);

    int count = quadratic_moderate(ya, yb, yc, out);
    for (int i = 0; i < count; i++) {
        out[i] = math_ldexp(out[i], shift);
    }
    return count == 2 ? two_roots(out[0], out[1], out) : count;
}

static double evaluate(const double *c, int degree, double x) {
    double sum = c[degree];
    for (int i = degree - 1; i >= 0; i--)
        sum = sum * x + c[i];
    return sum;
}

/* The double whose bit pattern is half way between those of l < r, which do not have opposite signs. */
static double bit_midpoint(double l, double r) {
    double a = fabs(l), b = fabs(r), middle;
    uint64_t ia, ib;
    memcpy(&ia, &a, sizeof ia);
    memcpy(&ib, &b, sizeof ib);
    ia = (ia + ib) / 2;
    memcpy(&middle, &ia, sizeof middle);
    return l < 0.0 || r < 0.0 ? -middle : middle;
}

/* The root in (l, r), where the polynomial has opposite signs, positive at r if `rising`; zero is not inside. */
static double bracketed_root(const double *c, int degree, double l, double r, bool rising) {
    struct bracket b = {.lo = l, .hi = r, .x = 0.5 * (l + r), .last_step = r - l, .rising = rising};
    for (;;) {
        double value = c[degree], slope = 0.0;
        for (int i = degree - 1; i >= 0; i--) {
            slope = slope * b.x + value;
            value = value * b.x + c[i];
        }
        if (value == 0.0)
            return b.x;
        bool good = bracket_newton(&b, value, slope);
        if (b.next == b.x || (!good && !bracket_halve(&b, bit_midpoint(b.lo, b.hi))))
            return b.x;
        bracket_move(&b);
    }
}

/* Rounding can produce more sign changes than the degree allows; they come in close pairs. Removing pairs keeps the
 * parity. */
static int drop_pairs(double *roots, int count, int limit) {
    while (count > limit) {
        int closest = 0;
        for (int i = 1; i + 1 < count; i++) {
            if (roots[i + 1] - roots[i] < roots[closest + 1] - roots[closest])
                closest = i;
        }
        for (int i = closest; i + 2 < count; i++)
            roots[i] = roots[i + 2];
        count -= 2;
    }
    return count;
}

/* Roots in [lo, hi] given points (ascending, lo and hi among them) between which the polynomial is monotonic, zero one
 * of them if it is in range. out holds as many numbers as there are points. */
static int roots_in_interval(const double *c, int degree, const double *points, int point_count, double *out) {
    int count = 0, sign = 0;
    bool touched = false;
    double touch = 0.0;
    for (int i = 0; i < point_count; i++) {
        double value = evaluate(c, degree, points[i]);
        /* Points with the value 0 next to each other are one root. */
        if (value == 0.0) {
            if (!touched)
                touch = points[i];
            touched = true;
            continue;
        }
        int sign_here = value > 0.0 ? 1 : -1;
        /* A touch without a change of sign counts twice. */
        if (touched) {
            out[count++] = touch;
            if (sign == sign_here)
                out[count++] = touch;
        } else if (sign == -sign_here) {
            out[count++] = bracketed_root(c, degree, points[i - 1], points[i], value > 0.0);
        }
        touched = false;
        sign = sign_here;
    }
    if (touched)
        out[count++] = touch;
    return drop_pairs(out, count, degree);
}

/* Ascending: lo, the inner numbers that lie strictly between, zero, hi; no number twice. */
static int merge_points(const double *inner, int inner_count, double lo, double hi, double *points) {
    int count = 0;
    bool zero_due = lo < 0.0 && hi > 0.0;
    points[count++] = lo;
    for (int i = 0; i < inner_count; i++) {
        if (zero_due && inner[i] >= 0.0) {
            points[count++] = 0.0;
            zero_due = false;
        }
        if (inner[i] > points[count - 1] && inner[i] < hi)
            points[count++] = inner[i];
    }
    if (zero_due)
        points[count++] = 0.0;
    if (hi > points[count - 1])
        points[count++] = hi;
    return count;
}

/* Roots in [lo, hi] within [-1, 1] of a polynomial of degree at least 2, through its derivatives. */
static int roots_scaled(const double *c, int degree, double lo, double hi, double *out) {
    double derivative[ROOTS_MAX_DEGREE + 1][ROOTS_MAX_DEGREE + 1];
    memcpy(derivative[degree], c, (size_t)(degree + 1) * sizeof *c);
    for (int d = degree; d > 2; d--) {
        for (int i = 1; i <= d; i++)
            derivative[d - 1][i - 1] = i * derivative[d][i];
    }
    double found[ROOTS_MAX_DEGREE + 3], points[ROOTS_MAX_DEGREE + 3];
    int count = roots_quadratic(derivative[2][2], derivative[2][1], derivative[2][0], found);
    for (int d = 3; d <= degree; d++) {
        int point_count = merge_points(found, count, lo, hi, points);
        count = roots_in_interval(derivative[d], d, points, point_count, found);
    }
    int kept = 0;
    for (int i = 0; i < count; i++) {
        if (found[i] >= lo && found[i] <= hi)
            out[kept++] = found[i];
    }
    return kept;
}

/* The power of two in which all roots in [lo, hi] are at most 1. The leading coefficient is not zero. */
static int choose_shift(const double *c, int degree, double lo, double hi) {
    /* No root is larger than 2 max |c(n-i) / c(n)|^(1/i) (Fujiwara 1916); and roots beyond the bounds do not matter. */
    int shift = -1074;
    int lead = exponent_of(c[degree]);
    for (int i = 1; i <= degree; i++) {
        if (c[degree - i] == 0.0)
            continue;
        int over = exponent_of(c[degree - i]) - lead + 1;
        int share = over >= 0 ? (over + i - 1) / i : -(-over / i);
        if (share + 1 > shift)
            shift = share + 1;
    }
    double extent = math_max(fabs(lo), fabs(hi));
    if (isfinite(extent) && extent > 0.0 && exponent_of(extent) < shift)
        shift = exponent_of(extent);
    return shift > 1023 ? 1023 : shift;
}

/* Roots x = 2^shift y in [lo, hi], from the polynomial in y. */
static int roots_shifted(const double *scaled, int degree, int shift, double lo, double hi, double *out) {
    if (!(lo <= hi))
        return 0;
    double found[ROOTS_MAX_DEGREE + 3];
    int count, kept = 0;
    if (degree <= 2) {
        count = roots_quadratic(degree == 2 ? scaled[2] : 0.0, scaled[1], scaled[0], found);
    } else {
        count = roots_scaled(scaled, degree, math_max(math_ldexp(lo, -shift), -1.0),
                             math_min(math_ldexp(hi, -shift), 1.0), found);
    }
    for (int i = 0; i < count; i++) {
        double root = math_ldexp(found[i], shift);
        if (root >= lo && root <= hi && isfinite(root))
            out[kept++] = root;
    }
    return kept;
}

static int roots_ranged(const double *c, int degree, double lo, double hi, double *out) {
    int shift = choose_shift(c, degree, lo, hi);
    int largest = INT32_MIN, smallest = INT32_MAX;
    for (int i = 0; i <= degree; i++) {
        if (c[i] == 0.0)
            continue;
        int exponent = exponent_of(c[i]) + i * shift;
        if (exponent > largest)
            largest = exponent;
        if (exponent < smallest)
            smallest = exponent;
    }
    double scaled[ROOTS_MAX_DEGREE + 1];
    for (int i = 0; i <= degree; i++)
        scaled[i] = math_ldexp(c[i], i * shift - largest);
    if (degree <= 2 || largest - smallest < 960 || shift < -1000) {
        return roots_shifted(scaled, degree, shift, lo, hi, out);
    }
    /* A coefficient that may decide small roots underflows: these roots are computed in another unit. For |y| >= 2^-60
     * it is far below the largest term (2^-60 to the power 12). */
    double edge = math_ldexp(1.0, shift - 60), all[3 * ROOTS_MAX_DEGREE];
    int count = roots_shifted(scaled, degree, shift, lo, math_min(hi, math_nextafter(-edge, -INFINITY)), all);
    if (lo <= edge && hi >= -edge)
        count += roots_ranged(c, degree, math_max(lo, -edge), math_min(hi, edge), all + count);
    count += roots_shifted(scaled, degree, shift, math_max(lo, math_nextafter(edge, INFINITY)), hi, all + count);
    count = drop_pairs(all, count, degree);
    memcpy(out, all, (size_t)count * sizeof *out);
    return count;
}

int roots_polynomial(const double *coefficients, int degree, double lo, double hi, double *out) {
    assert(degree >= 0 && degree <= ROOTS_MAX_DEGREE);
    if (!(lo <= hi))
        return 0;
    for (int i = 0; i <= degree; i++) {
        if (!isfinite(coefficients[i]))
            return 0;
    }
    while (degree > 0 && coefficients[degree] == 0.0)
        degree--;
    if (degree == 0)
        return 0;
    return roots_ranged(coefficients, degree, lo, hi, out);
}
