/* Elementary functions: errors against correctly rounded values (elementary_reference.h) and against the 80-bit
 * functions of the C library on random arguments, special cases, exact cases, and a fingerprint of the bits.
 *
 * The library's long double functions are only a reference: their error is about 2^-63, that is 0.001 units in the last
 * place of a double. */
#include <errno.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "math/elementary.h"
#include "tests/harness.h"
#include "tests/unit/elementary_reference.h"

#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))

typedef double one_function(double);
typedef double two_function(double, double);
typedef long double one_ruler(long double);
typedef long double two_ruler(long double, long double);

/* The distance between neighbouring doubles just above |x|. */
static double last_digit_unit(double x) {
    int exponent;
    x = fabs(x);
    if (x < DBL_MIN)
        return 0x1.0p-1074;
    frexp(x, &exponent);
    return ldexp(1.0, exponent - 53);
}

static double error_in_digit_units(double got, long double want) {
    double near = (double)want;
    if (isnan(near))
        return isnan(got) ? 0.0 : HUGE_VAL;
    if (isinf(near) || isinf(got))
        return got == near ? 0.0 : HUGE_VAL;
    if (isnan(got))
        return HUGE_VAL;
    return (double)(fabsl((long double)got - want) / (long double)last_digit_unit(near));
}

/* Either uniform in [lo, hi], or a random sign and mantissa with an exponent from lo to hi. */
enum range_kind { UNIFORM, EXPONENTS, EXPONENTS_POSITIVE };
struct range {
    enum range_kind kind;
    double lo, hi;
};

static double draw(struct test_random *random, struct range range) {
    if (range.kind == UNIFORM)
        return test_uniform(random, range.lo, range.hi);
    double size = ldexp(test_uniform(random, 1.0, 2.0), (int)floor(test_uniform(random, range.lo, range.hi + 1.0)));
    double side = test_uniform(random, -1.0, 1.0);
    return range.kind == EXPONENTS && side < 0.0 ? -size : size;
}

/* Whether the function of the C library for long double is exact enough. Some of musl are off by .3 of a last place of
 * double; gray's functions have the same bits everywhere. */
static bool is_reference(const char *name) {
#ifdef __GLIBC__
    return name != NULL;
#else
    return strcmp(name, "expm1") != 0 && strcmp(name, "sinh") != 0 && strcmp(name, "pow") != 0;
#endif
}

static void check_one(const char *name, one_function *function, one_ruler *ruler, double limit, struct range range) {
    struct test_random random = {20140701};
    double worst = 0.0, where = 0.0;
    if (!is_reference(name))
        return;
    for (int i = 0; i < 50000; i++) {
        double x = draw(&random, range);
        double error = error_in_digit_units(function(x), ruler(x));
        if (error > worst) {
            worst = error;
            where = x;
        }
    }
    if (!(worst < limit))
        test_fail(__FILE__, __LINE__, "%s(%a) is off by %g last places", name, where, worst);
}

static void check_two(const char *name, two_function *function, two_ruler *ruler, double limit, struct range first,
                      struct range second) {
    struct test_random random = {20140702};
    double worst = 0.0, at_x = 0.0, at_y = 0.0;
    if (!is_reference(name))
        return;
    for (int i = 0; i < 100000; i++) {
        double x = draw(&random, first), y = draw(&random, second);
        double error = error_in_digit_units(function(x, y), ruler(x, y));
        if (error > worst) {
            worst = error;
            at_x = x;
            at_y = y;
        }
    }
    if (!(worst < limit))
        test_fail(__FILE__, __LINE__, "%s(%a, %a) is off by %g last places", name, at_x, at_y, worst);
}

#define CHECK_ONE(name, limit, kind, lo, hi) check_one(#name, el_##name, name##l, limit, (struct range){kind, lo, hi})
#define CHECK_TWO(name, limit, first_kind, first_lo, first_hi, second_kind, second_lo, second_hi)                      \
    check_two(#name, el_##name, name##l, limit, (struct range){first_kind, first_lo, first_hi},                        \
              (struct range){second_kind, second_lo, second_hi})

/* A result within one last place of the correctly rounded one is within 1.5 of the true value; 1.0 is one neighbour. */
static void reference_one(const char *name, one_function *function, const struct reference1 *points, int count) {
    for (int i = 0; i < count; i++) {
        double got = function(points[i].x);
        if (!(error_in_digit_units(got, points[i].want) <= 1.0))
            test_fail(__FILE__, __LINE__, "%s(%a) = %a, not %a", name, points[i].x, got, points[i].want);
    }
}

static void reference_two(const char *name, two_function *function, const struct reference2 *points, int count) {
    for (int i = 0; i < count; i++) {
        double got = function(points[i].x, points[i].y);
        if (!(error_in_digit_units(got, points[i].want) <= 1.0))
            test_fail(__FILE__, __LINE__, "%s(%a, %a) = %a, not %a", name, points[i].x, points[i].y, got,
                      points[i].want);
    }
}

#define REFERENCE_ONE(name) reference_one(#name, el_##name, reference_##name, COUNT(reference_##name))
#define REFERENCE_TWO(name) reference_two(#name, el_##name, reference_##name, COUNT(reference_##name))

TEST(elementary_angles_agree_with_400_bit_values) {
    REFERENCE_ONE(sin);
    REFERENCE_ONE(cos);
    REFERENCE_ONE(tan);
    REFERENCE_ONE(asin);
    REFERENCE_ONE(acos);
    REFERENCE_TWO(atan2);
}

TEST(elementary_exponentials_and_logarithms_agree_with_400_bit_values) {
    REFERENCE_ONE(exp);
    REFERENCE_ONE(exp2);
    REFERENCE_ONE(expm1);
    REFERENCE_ONE(log);
    REFERENCE_ONE(log2);
    REFERENCE_ONE(log10);
    REFERENCE_TWO(pow);
}

TEST(elementary_hyperbolics_and_roots_agree_with_400_bit_values) {
    REFERENCE_ONE(sinh);
    REFERENCE_ONE(cosh);
    REFERENCE_ONE(tanh);
    REFERENCE_ONE(cbrt);
}

TEST(elementary_angles_err_by_less_than_1_05_last_places) {
    CHECK_ONE(sin, 0.9, UNIFORM, -0.8, 0.8);
    CHECK_ONE(sin, 0.9, UNIFORM, -100.0, 100.0);
    CHECK_ONE(sin, 0.9, UNIFORM, -2e6, 2e6);
    CHECK_ONE(sin, 0.9, EXPONENTS, -40, 62); /* beyond 2^63 the reference functions fail */
    CHECK_ONE(cos, 0.9, UNIFORM, -100.0, 100.0);
    CHECK_ONE(cos, 0.9, EXPONENTS, -40, 62);
    CHECK_ONE(tan, 1.05, UNIFORM, -0.8, 0.8);
    CHECK_ONE(tan, 1.05, UNIFORM, -100.0, 100.0);
    CHECK_ONE(tan, 1.05, EXPONENTS, -40, 62);
    CHECK_ONE(asin, 0.7, UNIFORM, -1.0, 1.0);
    CHECK_ONE(asin, 0.7, EXPONENTS, -40, -1);
    CHECK_ONE(acos, 0.7, UNIFORM, -1.0, 1.0);
    CHECK_ONE(acos, 0.7, EXPONENTS, -40, -1);
    CHECK_TWO(atan2, 0.7, EXPONENTS, -8, 8, EXPONENTS, -8, 8);
    CHECK_TWO(atan2, 0.7, EXPONENTS, -1000, 1022, EXPONENTS, -1000, 1022);
}

TEST(elementary_exponentials_and_logarithms_err_by_less_than_0_6_last_places) {
    CHECK_ONE(exp, 0.52, UNIFORM, -1.0, 1.0);
    CHECK_ONE(exp, 0.52, UNIFORM, -745.0, 709.7);
    CHECK_ONE(exp2, 0.52, UNIFORM, -1074.0, 1023.9);
    CHECK_ONE(expm1, 0.55, UNIFORM, -0.1, 0.1);
    CHECK_ONE(expm1, 0.55, UNIFORM, -5.0, 709.0);
    CHECK_ONE(expm1, 0.55, EXPONENTS, -60, 5);
    CHECK_ONE(log, 0.52, UNIFORM, 0.97, 1.03);
    CHECK_ONE(log, 0.52, EXPONENTS_POSITIVE, -1074, 1023);
    CHECK_ONE(log2, 0.52, UNIFORM, 0.5, 2.0);
    CHECK_ONE(log2, 0.52, EXPONENTS_POSITIVE, -1074, 1023);
    CHECK_ONE(log10, 0.52, UNIFORM, 0.5, 2.0);
    CHECK_ONE(log10, 0.52, EXPONENTS_POSITIVE, -1074, 1023);
    CHECK_TWO(pow, 0.55, UNIFORM, 0.0, 1.0, UNIFORM, 0.0, 60.0);
    CHECK_TWO(pow, 0.55, UNIFORM, 0.0, 10.0, UNIFORM, -20.0, 20.0);
    CHECK_TWO(pow, 0.55, UNIFORM, 0.9, 1.1, UNIFORM, -7000.0, 7000.0);
    CHECK_TWO(pow, 0.55, EXPONENTS_POSITIVE, -1074, 1023, UNIFORM, -1.0, 1.0);
    CHECK_TWO(pow, 0.55, UNIFORM, 1e9, 1e10, UNIFORM, -34.0, 32.0);
}

TEST(elementary_hyperbolics_and_roots_err_by_less_than_0_7_last_places) {
    CHECK_ONE(sinh, 0.6, UNIFORM, -1.0, 1.0);
    CHECK_ONE(sinh, 0.6, UNIFORM, -710.0, 710.0);
    CHECK_ONE(cosh, 0.6, UNIFORM, -2.0, 2.0);
    CHECK_ONE(cosh, 0.6, UNIFORM, -710.0, 710.0);
    CHECK_ONE(tanh, 0.6, UNIFORM, -1.0, 1.0);
    CHECK_ONE(tanh, 0.6, EXPONENTS, -40, 5);
    CHECK_ONE(cbrt, 0.7, EXPONENTS, -1074, 1023);
}

static bool same(double a, double b) {
    return (isnan(a) && isnan(b)) || (a == b && !signbit(a) == !signbit(b));
}

/* Annex F of the C standard fixes these values; the library's long double functions follow it and serve as the table.
 * If both arguments are finite, only exact results are compared. (The double functions of this program may be ours:
 * sandbox.c.) */
TEST(elementary_special_arguments_follow_annex_f) {
    static const double odd[] = {0.0, -0.0, 1.0, -1.0, INFINITY, -INFINITY, NAN, 2.0, -2.0, 3.0, -3.0, 0.5, -0.5};
    for (int i = 0; i < COUNT(odd); i++) {
        for (int j = 0; j < COUNT(odd); j++) {
            double x = odd[i], y = odd[j];
            bool exact = !(isfinite(x) && isfinite(y)) || x == 0.0 || y == 0.0 || fabs(x) == 1.0;
            if (exact || x < 0.0 || floor(y) == y) {
                double want = (double)powl(x, y);
                if (!same(el_pow(x, y), want))
                    test_fail(__FILE__, __LINE__, "pow(%g, %g) is not %g", x, y, want);
            }
            if (isinf(x) || isinf(y) || isnan(x) || isnan(y) || x == 0.0 || y == 0.0) {
                double want = (double)atan2l(x, y);
                if (!same(el_atan2(x, y), want))
                    test_fail(__FILE__, __LINE__, "atan2(%g, %g) is not %g", x, y, want);
            }
            CHECK(same(el_fmod(x, y), fmod(x, y)));
        }
    }
    CHECK(isnan(el_sin(INFINITY)) && isnan(el_cos(-INFINITY)) && isnan(el_tan(INFINITY)) && isnan(el_sin(NAN)));
    CHECK(same(el_sin(-0.0), -0.0) && same(el_tan(-0.0), -0.0) && el_cos(-0.0) == 1.0);
    CHECK(same(el_asin(-0.0), -0.0) && same(el_acos(1.0), 0.0));
    CHECK(isnan(el_asin(1.0000000000000002)) && isnan(el_acos(-INFINITY)) && isnan(el_acos(NAN)));
    CHECK(el_exp(-INFINITY) == 0.0 && el_exp(INFINITY) == INFINITY && isnan(el_exp(NAN)) && el_exp(0.0) == 1.0);
    CHECK(el_exp(1e300) == INFINITY && el_exp(-1e300) == 0.0 && el_exp2(1024.0) == INFINITY && el_exp2(-2e9) == 0.0);
    CHECK(el_exp2(-INFINITY) == 0.0 && isnan(el_exp2(NAN)) && el_exp2(INFINITY) == INFINITY);
    CHECK(el_expm1(-INFINITY) == -1.0 && same(el_expm1(-0.0), -0.0) && el_expm1(INFINITY) == INFINITY);
    CHECK(el_log(0.0) == -INFINITY && el_log2(-0.0) == -INFINITY && isnan(el_log10(-1.0)) && isnan(el_log(-INFINITY)));
    CHECK(same(el_log(1.0), 0.0) && same(el_log2(1.0), 0.0) && same(el_log10(1.0), 0.0) && isnan(el_log(NAN)));
    CHECK(el_log(INFINITY) == INFINITY);
    CHECK(same(el_sinh(-0.0), -0.0) && el_sinh(-INFINITY) == -INFINITY && el_cosh(-INFINITY) == INFINITY);
    CHECK(same(el_tanh(-0.0), -0.0) && el_tanh(-INFINITY) == -1.0 && isnan(el_tanh(NAN)) && el_sinh(800.0) == INFINITY);
    CHECK(same(el_cbrt(-0.0), -0.0) && el_cbrt(-INFINITY) == -INFINITY && isnan(el_cbrt(NAN)));
}

TEST(elementary_functions_are_exact_where_the_answer_is) {
    for (int n = -1074; n <= 1023; n++) {
        double x = ldexp(1.0, n);
        CHECK(el_exp2(n) == x);
        CHECK(el_log2(x) == n);
        CHECK(el_pow(2.0, n) == x);
    }
    double power = 1.0;
    for (int n = 0; n <= 22; n++) {
        CHECK(el_log10(power) == n);
        CHECK(el_pow(10.0, n) == power);
        power *= 10.0;
    }
    for (int n = 1; n <= 2000; n++) {
        double x = n;
        CHECK(el_cbrt(x * x * x) == x);
        CHECK(el_pow(x, 2.0) == x * x);
        CHECK(el_pow(-x, 3.0) == -x * x * x);
        CHECK(el_pow(x * x, 0.5) == x);
    }
}

TEST(elementary_sincos_gives_the_bits_of_sin_and_cos) {
    struct test_random random = {5};
    for (int i = 0; i < 20000; i++) {
        double x = draw(&random, (struct range){EXPONENTS, -60, 1023}), s, c;
        el_sincos(x, &s, &c);
        CHECK(same(s, el_sin(x)) && same(c, el_cos(x)));
    }
    double s, c;
    el_sincos(-0.0, &s, &c);
    CHECK(same(s, -0.0) && c == 1.0);
    el_sincos(INFINITY, &s, &c);
    CHECK(isnan(s) && isnan(c));
}

TEST(elementary_angles_of_any_size_keep_the_identities) {
    struct test_random random = {6};
    for (int i = 0; i < 20000; i++) {
        double x = draw(&random, (struct range){EXPONENTS, 10, 1023});
        double s = el_sin(x), c = el_cos(x);
        CHECK_NEAR(s * s + c * c, 1.0, 4e-16);
        CHECK(el_sin(-x) == -s && el_cos(-x) == c);
        CHECK(fabs(el_tan(x) - s / c) <= 4e-16 * fabs(s / c));
    }
}

TEST(elementary_functions_do_not_change_errno) {
    static const double odd[] = {0.0, -1.0, 1e300, -1e300, INFINITY, NAN, 5e-324, 2.0};
    errno = 0;
    volatile double sum = 0.0;
    for (int i = 0; i < COUNT(odd); i++) {
        double x = odd[i];
        sum = sum + el_sin(x) + el_cos(x) + el_tan(x) + el_asin(x) + el_acos(x) + el_exp(x) + el_exp2(x);
        sum = sum + el_expm1(x) + el_log(x) + el_log2(x) + el_log10(x) + el_sinh(x) + el_cosh(x);
        sum = sum + el_tanh(x) + el_cbrt(x);
        for (int j = 0; j < COUNT(odd); j++)
            sum = sum + el_pow(x, odd[j]) + el_atan2(x, odd[j]) + el_fmod(x, odd[j]);
    }
    CHECK_EQ_INT(errno, 0);
}

static uint64_t stir(uint64_t hash, double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return (hash ^ bits) * 0x100000001b3u;
}

/* This number changes only with the functions; then pictures change as well. */
TEST(elementary_bits_are_the_same_on_every_machine) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (int i = 1; i <= 20000; i++) {
        double x = i * 0.0371, y = (i % 97 - 48) * 0.173, unit = (i % 2001 - 1000) * 0.001;
        hash = stir(hash, el_sin(x));
        hash = stir(hash, el_cos(x * 1e7));
        hash = stir(hash, el_tan(x));
        hash = stir(hash, el_asin(unit));
        hash = stir(hash, el_acos(unit));
        hash = stir(hash, el_atan2(y, unit));
        hash = stir(hash, el_exp(y * 70));
        hash = stir(hash, el_exp2(y));
        hash = stir(hash, el_expm1(unit));
        hash = stir(hash, el_log(x));
        hash = stir(hash, el_log2(x));
        hash = stir(hash, el_log10(x));
        hash = stir(hash, el_pow(x, y));
        hash = stir(hash, el_sinh(y));
        hash = stir(hash, el_cosh(y));
        hash = stir(hash, el_tanh(unit));
        hash = stir(hash, el_cbrt(y));
    }
    if (hash != 0x84cae62922a68d15u)
        test_fail(__FILE__, __LINE__, "the fingerprint is 0x%016llx", (unsigned long long)hash);
}
