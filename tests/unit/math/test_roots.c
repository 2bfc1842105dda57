/* Polynomial roots: polynomials made from known roots, multiple roots, wild scales, parity, and the degenerate cases.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "math/roots.h"
#include "tests/harness.h"

/* Of a x^3 + b x^2 + c x + d, and of a x^4 + b x^3 + c x^2 + d x + e. */
static int cubic(double a, double b, double c, double d, double out[3]) {
    return roots_polynomial((double[]){d, c, b, a}, 3, -INFINITY, INFINITY, out);
}

static int quartic(double a, double b, double c, double d, double e, double out[4]) {
    return roots_polynomial((double[]){e, d, c, b, a}, 4, -INFINITY, INFINITY, out);
}

/* Coefficients (lowest first) of factor * product of (x - root), in long double, so that they are rounded only once. */
static void expand(const double *roots, int count, double factor, double *coefficients) {
    long double c[ROOTS_MAX_DEGREE + 1] = {factor};
    for (int i = 0; i < count; i++) {
        for (int j = i + 1; j > 0; j--)
            c[j] = c[j - 1] - roots[i] * c[j];
        c[0] = -roots[i] * c[0];
    }
    for (int i = 0; i <= count; i++)
        coefficients[i] = (double)c[i];
}

static void sort(double *values, int count) {
    for (int i = 1; i < count; i++) {
        double v = values[i];
        int j = i;
        for (; j > 0 && values[j - 1] > v; j--)
            values[j] = values[j - 1];
        values[j] = v;
    }
}

/* Twice the distance by which a change of every coefficient in the last place can move the root. */
static double tolerance_at(const double *c, int degree, double x) {
    double size = 0.0, slope = 0.0, power = 1.0;
    for (int i = 0; i <= degree; i++) {
        size += fabs(c[i] * power);
        if (i < degree)
            slope += (i + 1) * c[i + 1] * power;
        power *= x;
    }
    return 8.0 * DBL_EPSILON * (degree + 1) * size / fabs(slope) + 4.0 * DBL_EPSILON * fabs(x);
}

TEST(roots_quadratic_survives_cancellation_in_the_discriminant) {
    /* (94906265.625 x - 1)^2 + ...: Kahan's example, roots 1 and 1.000000028975958 */
    double out[2];
    CHECK_EQ_INT(roots_quadratic(94906265.625, -2.0 * 94906267.000, 94906268.375, out), 2);
    CHECK(out[0] == 1.0);
    CHECK_NEAR(out[1], 1.000000028975958, 1e-15);
    CHECK_EQ_INT(roots_quadratic(1.0, -1e8, 1.0, out), 2);
    CHECK_NEAR(out[0] * 1e8, 1.0000000000000001, 3e-16);
    CHECK_NEAR(out[1], 99999999.99999999, 2e-8); /* its last place is worth 1.5e-8 */
}

TEST(roots_quadratic_counts_a_double_root_twice_and_none_as_none) {
    double out[2];
    CHECK_EQ_INT(roots_quadratic(1.0, -2.0, 1.0, out), 2);
    CHECK(out[0] == 1.0 && out[1] == 1.0);
    CHECK_EQ_INT(roots_quadratic(1.0, -2.0, 1.0 + DBL_EPSILON, out), 0);
    CHECK_EQ_INT(roots_quadratic(1.0, -2.0, 1.0 - DBL_EPSILON, out), 2);
    CHECK(out[0] < 1.0 && out[1] > 1.0);
    CHECK_EQ_INT(roots_quadratic(3.0, 0.0, 0.0, out), 2);
    CHECK(out[0] == 0.0 && out[1] == 0.0);
}

TEST(roots_quadratic_degenerates_to_lower_degrees) {
    double out[2];
    CHECK_EQ_INT(roots_quadratic(0.0, 2.0, -3.0, out), 1);
    CHECK(out[0] == 1.5);
    CHECK_EQ_INT(roots_quadratic(0.0, 0.0, 1.0, out), 0);
    CHECK_EQ_INT(roots_quadratic(0.0, 0.0, 0.0, out), 0);
    CHECK_EQ_INT(roots_quadratic(NAN, 1.0, 0.0, out), 0);
    CHECK_EQ_INT(roots_quadratic(1.0, INFINITY, 0.0, out), 0);
    CHECK_EQ_INT(roots_quadratic(1e-300, 1e300, 1e300, out), 1); /* the other is -1e600 */
    CHECK(out[0] == -1.0);
}

TEST(roots_quadratic_finds_known_roots_at_any_scale) {
    struct test_random random = {1};
    for (int i = 0; i < 200000; i++) {
        /* short numbers: sum and product are exact */
        double r = floor(test_uniform(&random, -0x1p24, 0x1p24)), s = floor(test_uniform(&random, -0x1p24, 0x1p24)),
               out[2];
        int k = (int)test_uniform(&random, -400, 400), m = (int)test_uniform(&random, -100, 100);
        CHECK_EQ_INT(roots_quadratic(ldexp(1.0, m), ldexp(-(r + s), m + k), ldexp(r * s, m + 2 * k), out), 2);
        CHECK(fabs(out[0] - ldexp(fmin(r, s), k)) <= 2 * DBL_EPSILON * fabs(out[0]));
        CHECK(fabs(out[1] - ldexp(fmax(r, s), k)) <= 2 * DBL_EPSILON * fabs(out[1]));
    }
}

TEST(roots_polynomial_finds_separated_known_roots_of_every_degree) {
    struct test_random random = {2};
    for (int i = 0; i < 6000; i++) {
        int degree = 1 + i % ROOTS_MAX_DEGREE;
        double roots[ROOTS_MAX_DEGREE], c[ROOTS_MAX_DEGREE + 1], out[ROOTS_MAX_DEGREE];
        for (int j = 0; j < degree; j++)
            roots[j] = (j - degree / 2 + test_uniform(&random, 0.0, 0.4)) * 0.75;
        sort(roots, degree);
        expand(roots, degree, test_uniform(&random, 1.0, 5.0) * (i & 1 ? -1.0 : 1.0), c);
        int count = roots_polynomial(c, degree, -INFINITY, INFINITY, out);
        CHECK_EQ_INT(count, degree);
        for (int j = 0; j < count && count == degree; j++)
            CHECK_NEAR(out[j], roots[j], tolerance_at(c, degree, roots[j]));
    }
}

TEST(roots_cubic_and_quartic_find_known_roots_and_pairs_of_complex_ones_hide) {
    struct test_random random = {3};
    for (int i = 0; i < 100000; i++) {
        double r[4], c[5], out[4];
        for (int j = 0; j < 4; j++)
            r[j] = test_uniform(&random, -3.0, 3.0);
        sort(r, 4);
        double gap = fmin(r[1] - r[0], fmin(r[2] - r[1], r[3] - r[2]));
        if (gap < 1e-3)
            continue;
        expand(r, 3, 2.0, c);
        CHECK_EQ_INT(cubic(c[3], c[2], c[1], c[0], out), 3);
        for (int j = 0; j < 3; j++)
            CHECK_NEAR(out[j], r[j], tolerance_at(c, 3, r[j]));
        expand(r, 4, -0.3, c);
        CHECK_EQ_INT(quartic(c[4], c[3], c[2], c[1], c[0], out), 4);
        for (int j = 0; j < 4; j++)
            CHECK_NEAR(out[j], r[j], tolerance_at(c, 4, r[j]));
        /* (x^2 + p x + q) with p^2 < 4 q adds no root */
        double p = test_uniform(&random, -2.0, 2.0), q = p * p / 4 + test_uniform(&random, 0.01, 4.0);
        double s = r[0] + r[1], t = r[0] * r[1];
        CHECK_EQ_INT(quartic(1.0, p - s, q - p * s + t, p * t - q * s, q * t, out), 2);
        CHECK_NEAR(out[0], r[0], 1e-10);
        CHECK_NEAR(out[1], r[1], 1e-10);
        CHECK_EQ_INT(cubic(1.0, p - r[0], q - p * r[0], -q * r[0], out), 1);
        CHECK_NEAR(out[0], r[0], 1e-10);
    }
}

TEST(roots_multiple_ones_keep_parity_and_position) {
    static const struct {
        double roots[6];
        int degree, simple;
        double double_at;
    } cases[] = {
        {{1, 1, 2}, 3, 1, 1},
        {{-2, 1, 1}, 3, 1, 1},
        {{0, 0, 3}, 3, 1, 0},
        {{1, 1, 1}, 3, 1, 1},
        {{1, 1, 2, 2}, 4, 0, 1},
        {{0, 0, 0, 5}, 4, 0, 0},
        {{0.5, 0.5, 0.5, 0.5}, 4, 0, 0.5},
        {{0, 0, 0, 0}, 4, 0, 0},
        {{3, 3, 3, 3, 3}, 5, 1, 3},
        {{-1, -1, 0, 0, 7, 7}, 6, 0, 0},
    };
    for (int i = 0; i < (int)(sizeof cases / sizeof *cases); i++) {
        double c[ROOTS_MAX_DEGREE + 1], out[ROOTS_MAX_DEGREE];
        int degree = cases[i].degree;
        expand(cases[i].roots, degree, 1.0, c);
        int count = roots_polynomial(c, degree, -INFINITY, INFINITY, out);
        CHECK(count <= degree && count % 2 == degree % 2);
        for (int j = 0; j < count; j++) {
            double nearest = INFINITY;
            for (int k = 0; k < degree; k++)
                nearest = fmin(nearest, fabs(out[j] - cases[i].roots[k]));
            CHECK(nearest < 2e-3); /* 2^(-52/5) of 3 */
        }
        /* a root of odd multiplicity may not be lost */
        if (cases[i].simple)
            CHECK(count >= 1);
    }
    double out[4];
    CHECK_EQ_INT(quartic(1, 0, 0, 0, 0, out), 2);
    CHECK(out[0] == 0.0 && out[1] == 0.0);
    CHECK_EQ_INT(cubic(1, 0, 0, 0, out), 1);
    CHECK(out[0] == 0.0);
}

TEST(roots_counts_have_the_parity_of_the_end_signs) {
    struct test_random random = {4};
    for (int i = 0; i < 60000; i++) {
        int degree = 1 + i % ROOTS_MAX_DEGREE;
        double c[ROOTS_MAX_DEGREE + 1], out[ROOTS_MAX_DEGREE], lo = test_uniform(&random, -3.0, 0.0);
        double hi = lo + test_uniform(&random, 0.0, 4.0), at_lo = 0.0, at_hi = 0.0;
        for (int j = 0; j <= degree; j++)
            c[j] = floor(test_uniform(&random, -4.0, 5.0));
        int whole = roots_polynomial(c, degree, -INFINITY, INFINITY, out);
        int real_degree = degree;
        while (real_degree > 0 && c[real_degree] == 0.0)
            real_degree--;
        CHECK(whole <= real_degree && whole % 2 == real_degree % 2);
        int count = roots_polynomial(c, degree, lo, hi, out);
        for (int j = degree; j >= 0; j--) {
            at_lo = at_lo * lo + c[j];
            at_hi = at_hi * hi + c[j];
        }
        if (fabs(at_lo) < 1e-9 || fabs(at_hi) < 1e-9)
            continue;
        CHECK_EQ_INT(count % 2, (at_lo > 0.0) != (at_hi > 0.0));
        for (int j = 0; j < count; j++) {
            CHECK(out[j] >= lo && out[j] <= hi);
            CHECK(j == 0 || out[j] >= out[j - 1]);
        }
    }
}

TEST(roots_scale_by_powers_of_two_bit_by_bit) {
    struct test_random random = {5};
    for (int i = 0; i < 20000; i++) {
        int degree = 2 + i % 11, k = (int)test_uniform(&random, -60, 60), m = (int)test_uniform(&random, -200, 200);
        double c[ROOTS_MAX_DEGREE + 1], d[ROOTS_MAX_DEGREE + 1], out[ROOTS_MAX_DEGREE], scaled[ROOTS_MAX_DEGREE];
        for (int j = 0; j <= degree; j++) {
            c[j] = test_uniform(&random, -1.0, 1.0);
            d[j] = ldexp(c[j], m - j * k);
        }
        bool bounded = i % 3 == 0;
        double lo = bounded ? -1.25 : -INFINITY, hi = bounded ? 0.75 : INFINITY;
        int count = roots_polynomial(c, degree, lo, hi, out);
        CHECK_EQ_INT(roots_polynomial(d, degree, ldexp(lo, k), ldexp(hi, k), scaled), count);
        for (int j = 0; j < count; j++)
            CHECK(scaled[j] == ldexp(out[j], k));
    }
}

TEST(roots_of_wildly_different_size_are_found) {
    double out[6], c[5];
    static const double wild[4] = {-1e40, -1e-20, 1e-60, 1e20};
    expand(wild, 4, 1e-30, c);
    CHECK_EQ_INT(quartic(c[4], c[3], c[2], c[1], c[0], out), 4);
    for (int j = 0; j < 4; j++)
        CHECK_NEAR(out[j] / wild[j], 1.0, 1e-14);
    static const double tiny[3] = {1e-90, 1e-80, 2e-80};
    expand(tiny, 3, 1e60, c);
    CHECK_EQ_INT(cubic(c[3], c[2], c[1], c[0], out), 3);
    for (int j = 0; j < 3; j++)
        CHECK_NEAR(out[j] / tiny[j], 1.0, 1e-14);
    /* a leading coefficient that is almost nothing sends one root far away and leaves the others */
    CHECK_EQ_INT(cubic(1e-200, 1.0, -3.0, 2.0, out), 3);
    CHECK_NEAR(out[0] / -1e200, 1.0, 1e-14);
    CHECK_NEAR(out[1], 1.0, 1e-14);
    CHECK_NEAR(out[2], 2.0, 1e-14);
    CHECK_EQ_INT(roots_polynomial((double[]){2.0, -3.0, 1.0, 1e-200, 0, 0, 1e-305}, 6, 0.5, INFINITY, out), 2);
    CHECK_NEAR(out[0], 1.0, 1e-14);
    CHECK_NEAR(out[1], 2.0, 1e-14);
    /* a root beyond the range of double is omitted */
    CHECK_EQ_INT(quartic(5e-324, 1e300, 0.0, -1e300, 0.0, out), 3);
    CHECK_NEAR(out[0], -1.0, 1e-14);
    CHECK(out[1] == 0.0);
    CHECK_NEAR(out[2], 1.0, 1e-14);
}

TEST(roots_refuse_what_has_none) {
    double out[ROOTS_MAX_DEGREE];
    CHECK_EQ_INT(roots_polynomial((double[]){0, 0, 0}, 2, -1, 1, out), 0);
    CHECK_EQ_INT(roots_polynomial((double[]){5}, 0, -1, 1, out), 0);
    CHECK_EQ_INT(roots_polynomial((double[]){0, 1, NAN, 1}, 3, -1, 1, out), 0);
    CHECK_EQ_INT(roots_polynomial((double[]){0, INFINITY, 2, 1}, 3, -1, 1, out), 0);
    CHECK_EQ_INT(roots_polynomial((double[]){0, 1, 2, 1}, 3, 1, -1, out), 0);
    CHECK_EQ_INT(roots_polynomial((double[]){0, 1, 2, 1}, 3, NAN, 1, out), 0);
    CHECK_EQ_INT(roots_polynomial((double[]){0, 1}, 1, 0, 0, out), 1);
    CHECK_EQ_INT(quartic(1, 0, 2, 0, 1.5, out), 0);
}

TEST(roots_survive_random_bits) {
    struct test_random random = {6};
    for (int i = 0; i < 30000; i++) {
        int degree = i % (ROOTS_MAX_DEGREE + 1);
        double c[ROOTS_MAX_DEGREE + 1], out[ROOTS_MAX_DEGREE];
        for (int j = 0; j <= degree; j++) {
            c[j] = ldexp(test_uniform(&random, -1.0, 1.0), (int)test_uniform(&random, -1074, 1024));
        }
        int count = roots_polynomial(c, degree, -INFINITY, INFINITY, out);
        CHECK(count >= 0 && count <= degree);
        for (int j = 0; j < count; j++)
            CHECK(isfinite(out[j]) && (j == 0 || out[j] >= out[j - 1]));
    }
}

/* The solver may miss only a pair of roots that rounding of the coefficients can remove: counted by the gap between the
 * two. It never misses only one root of a pair. */
TEST(roots_of_close_pairs_are_missed_together_and_only_below_the_rounding_of_the_coefficients) {
    enum { GAPS = 10, POLYNOMIALS = 3000 };
    struct test_random random = {7};
    int missed[GAPS] = {0}, halves = 0, wrong = 0;
    for (int k = 1; k < GAPS; k++)
        for (int i = 0; i < POLYNOMIALS; i++) {
            double gap = pow(10, -k), roots[6], c[7], out[6];
            int degree = 3 + i % 4, count;
            roots[0] = test_uniform(&random, -0.9, 0.9);
            roots[1] = roots[0] + gap;
            for (int j = 2; j < degree; j++) /* the others are far away */
                roots[j] = roots[0] + (j % 2 ? 1 : -1) * test_uniform(&random, 0.5, 2);
            expand(roots, degree, 1, c);
            count = roots_polynomial(c, degree, -INFINITY, INFINITY, out);
            halves += (degree - count) % 2;
            missed[k] += count == degree - 2;
            for (int j = 0; j < count; j++) {
                double nearest = INFINITY;
                for (int n = 0; n < degree; n++)
                    nearest = fmin(nearest, fabs(out[j] - roots[n]));
                wrong += nearest > fmax(1e-7, 1e-12 / gap);
            }
        }
    CHECK_EQ_INT(halves, 0);
    CHECK_EQ_INT(wrong, 0);
    for (int k = 1; k <= 6; k++)
        CHECK_EQ_INT(missed[k], 0);
    CHECK(missed[GAPS - 1] > 0); /* there the exact polynomial has lost the pairs */
}
