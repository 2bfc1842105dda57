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
