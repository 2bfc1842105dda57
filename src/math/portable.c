#include "math/portable.h"

#include "math/exact.h"

enum { FRACTION_BITS = 52, BIAS = 1023, ALL_ONES = 0x7ff };
static const uint64_t sign_bit = (uint64_t)1 << 63, hidden_bit = (uint64_t)1 << FRACTION_BITS;

double math_frexp(double x, int *exponent) {
    uint64_t bits = to_bits(x);
    int biased = (int)(bits >> FRACTION_BITS & ALL_ONES);
    *exponent = 0;
    if (x == 0 || biased == ALL_ONES)
        return x;
    if (biased == 0) { /* a denormal number */
        double m = math_frexp(x * 0x1p54, exponent);
        *exponent -= 54;
        return m;
    }
    *exponent = biased - (BIAS - 1);
    return from_bits((bits & ~((uint64_t)ALL_ONES << FRACTION_BITS)) | (hidden_bit * (BIAS - 1)));
}

/* A product with a power of two rounds only if the result is denormal. So no step but the last one may be that: the
 * others of small factors leave 53 bits, or the result is 0. */
double math_ldexp(double x, int exponent) {
    const int limit = 4000; /* beyond all numbers */
    exponent = exponent > limit ? limit : exponent < -limit ? -limit : exponent;
    for (; exponent > BIAS; exponent -= BIAS)
        x *= two_to(BIAS);
    for (; exponent < 1 - BIAS; exponent += BIAS - 1 - 53)
        x *= two_to(1 - BIAS + 53);
    return x * two_to(exponent);
}

/* Long division of the mantissas; 11 bits of the quotient in each step, so that remainders fit 64 bits. */
double math_fmod(double x, double y) {
    uint64_t sign = to_bits(x) & sign_bit;
    double a = from_bits(to_bits(x) ^ sign), b = from_bits(to_bits(y) & ~sign_bit);
    int ea, eb;
    if (!(a - a == 0) || !(b > 0))
        return (x * y) / (x * y);
    if (a < b)
        return x;
    uint64_t remainder = (uint64_t)math_ldexp(math_frexp(a, &ea), FRACTION_BITS + 1);
    uint64_t divisor = (uint64_t)math_ldexp(math_frexp(b, &eb), FRACTION_BITS + 1);
    remainder %= divisor;
    for (int left = ea - eb; left > 0; left -= 11)
        remainder = (remainder << (left < 11 ? left : 11)) % divisor;
    double value = math_ldexp((double)remainder, eb - FRACTION_BITS - 1);
    return from_bits(to_bits(value) | sign);
}

/* Of numbers of one sign, the bits are in the order of the sizes. */
double math_nextafter(double x, double to) {
    uint64_t bits = to_bits(x);
    if (x != x || to != to)
        return x + to;
    if (x == to)
        return to;
    if (x == 0)
        return from_bits((to_bits(to) & sign_bit) | 1);
    return from_bits((x < to) == (x > 0) ? bits + 1 : bits - 1);
}

float math_nextafterf(float x, float to) {
    uint32_t bits;
    if (x != x || to != to)
        return x + to;
    if (x == to)
        return to;
    memcpy(&bits, &x, sizeof bits);
    if (x == 0)
        bits = to < 0 ? 0x80000001U : 1;
    else
        bits += (x < to) == (x > 0) ? 1U : -1U;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* The last of 64 bits says whether one after them is set: it is beyond the bits of the result. */
double math_from_wide(uint64_t high, uint64_t low) {
    if (high == 0)
        return (double)low;
    int shift = __builtin_clzll(high);
    uint64_t leading_bits = shift > 0 ? high << shift | low >> (64 - shift) : high;
    uint64_t rest = low << shift;
    return (double)(leading_bits | (rest != 0)) * two_to(64 - shift);
}
