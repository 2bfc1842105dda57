/* What C leaves to the machine. */
#include "tests/harness.h"

#include "math/exact.h"
#include "math/portable.h"

#include <math.h>
#include <stdio.h>

static const double numbers[] = {-INFINITY, -1e300, -2, -0.0, 0.0, 0x1p-1074, 1, 2, INFINITY, NAN};
enum { NUMBERS = sizeof numbers / sizeof *numbers };

/* Of equal numbers, +0 and -0 too, the second; of a NaN and a number the number. */
TEST(the_lesser_and_the_greater_number_have_the_bits_of_one_rule) {
    for (int i = 0; i < NUMBERS; i++)
        for (int k = 0; k < NUMBERS; k++) {
            volatile double first = numbers[i], second = numbers[k];
            double a = first, b = second, lesser = math_min(a, b), greater = math_max(a, b);
            bool is_first = isnan(b), is_second = isnan(a) || a == b;
            CHECK(to_bits(lesser) == to_bits(is_first || (!is_second && a < b) ? a : b));
            CHECK(to_bits(greater) == to_bits(is_first || (!is_second && a > b) ? a : b));
        }
}

/* Arguments that the format does not name are ignored. */
TEST(a_nan_loses_its_sign_only_where_the_format_is_one_number) {
    static const char *const formats[] = {"%s.lua", "%-6.2f", "%.14g", "%A", "%sa", "a%d"};
    static const char *const texts[] = {"x.lua", "nan   ", "nan", "NAN", "xa", "a7"};
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        const char *volatile format = formats[i];
        char text[32];
        (void)(i == 5 ? snprintf(text, sizeof text, format, 7, -NAN) : snprintf(text, sizeof text, format, "x", -NAN));
        CHECK_TEXT(text, texts[i]);
    }
}

static uint64_t any_bits(struct test_random *random) {
    uint64_t bits = 0;
    for (int i = 0; i < 4; i++)
        bits = bits << 16 | (uint64_t)test_uniform(random, 0, 65536);
    return bits;
}

/* Numbers of all sizes, with few and with all bits. */
static double any_number(struct test_random *random) {
    uint64_t bits = any_bits(random);
    switch (any_bits(random) % 4) {
    case 0:
        return from_bits(bits);
    case 1:
        return from_bits(bits & 0xfff8000000000000U);
    case 2:
        return from_bits(bits & 0x800fffffffffffffU); /* denormal */
    default:
        return numbers[bits % NUMBERS];
    }
}

static bool is_same(double a, double b) {
    return (isnan(a) && isnan(b)) || to_bits(a) == to_bits(b);
}

TEST(functions_of_the_bits_of_numbers_are_those_of_the_library) {
    struct test_random random = {1};
    for (int i = 0; i < 300000; i++) {
        double x = any_number(&random), y = any_number(&random);
        int n = (int)(any_bits(&random) % 5000) - 2500, own = 0, library = 0;
        CHECK(is_same(math_frexp(x, &own), frexp(x, &library)) && (own == library || !isfinite(x)));
        CHECK(is_same(math_ldexp(x, n), ldexp(x, n)));
        CHECK(is_same(math_fmod(x, y), fmod(x, y)));
        CHECK(is_same(math_nextafter(x, y), nextafter(x, y)));
        float a = (float)x, b = (float)y;
        CHECK(is_same((double)math_nextafterf(a, b), (double)nextafterf(a, b)));
    }
    CHECK(math_ldexp(1, 2147483647) > 1e308 && math_ldexp(1, -2147483647 - 1) <= 0);
}

/* Of numbers near a half of the last place, too. */
TEST(numbers_of_128_bits_are_rounded_once) {
    __extension__ typedef unsigned __int128 wide;
    struct test_random random = {2};
    for (int i = 0; i < 300000; i++) {
        uint64_t high = any_bits(&random) >> (any_bits(&random) % 64), low = any_bits(&random);
        low = i % 3 == 0 ? 0 : i % 3 == 1 ? (uint64_t)1 << (low % 64) : low;
        CHECK(to_bits(math_from_wide(high, low)) == to_bits((double)((wide)high << 64 | low)));
    }
}
