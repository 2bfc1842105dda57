#include "device/arithmetic_internal.h"

#include "base/random.h"
#include "math/elementary.h"
#include "math/portable.h"

#include <math.h>
#include <string.h>

/* NaN has other bits on other machines. */
static uint64_t fold(uint64_t digest, double value) {
    uint64_t bits = 1;
    if (!isnan(value))
        memcpy(&bits, &value, sizeof bits);
    return random_combine(digest, bits);
}

/* Numbers near 1; a quarter of them of any size, with those that are not normal. */
static double number_of(uint64_t key) {
    const int exponent = key % 4 == 0 ? (int)(key >> 2 & 2047) - 1075 : (int)(key >> 2 & 15) - 8;
    const double mantissa = 1 + (double)(key >> 12) * 0x1p-52;
    return math_ldexp(key >> 6 & 1 ? -mantissa : mantissa, exponent);
}

static uint64_t digest_of_operations(uint64_t digest, double x, double y) {
    const float a = (float)x, b = (float)y;
    const double doubles[] = {x + y,          x - y,           x * y,
                              x / y,          sqrt(fabs(x)),   floor(x),
                              ceil(y),        math_fmod(x, y), math_nextafter(x, y),
                              math_min(x, y), math_max(x, y)};
    const float floats[] = {a + b, a - b, a * b, a / b, sqrtf(fabsf(a)), math_nextafterf(a, b)};
    for (size_t i = 0; i < sizeof doubles / sizeof *doubles; i++)
        digest = fold(digest, doubles[i]);
    for (size_t i = 0; i < sizeof floats / sizeof *floats; i++)
        digest = fold(digest, (double)floats[i]);
    return digest;
}

static uint64_t digest_of_functions(uint64_t digest, double x, double y) {
    const double unit = x / (1 + fabs(x));
    const double values[] = {el_sin(x),        el_cos(x),         el_tan(x),          el_asin(unit), el_acos(unit),
                             el_atan2(y, x),   el_exp(x),         el_exp2(x),         el_expm1(x),   el_log(fabs(x)),
                             el_log2(fabs(x)), el_log10(fabs(x)), el_pow(fabs(x), y), el_sinh(x),    el_cosh(x),
                             el_tanh(x),       el_cbrt(x)};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++)
        digest = fold(digest, values[i]);
    return digest;
}

uint64_t arithmetic_digest(uint32_t number) {
    const double x = number_of(random_combine(number, 0)), y = number_of(random_combine(number, 1));
    return digest_of_functions(digest_of_operations(number, x, y), x, y);
}
