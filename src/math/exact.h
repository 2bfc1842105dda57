/* The basis of elementary functions and roots: bit patterns, and arithmetic without error.
 * Sums and products of two doubles without error, as unevaluated pairs: the exact value is hi + lo, hi the nearest
 * double. T. J. Dekker, "A floating-point technique for extending the available precision", 1971; Knuth's sum; no
 * fma. */
#ifndef GRAY_MATH_EXACT_H
#define GRAY_MATH_EXACT_H

#include <stdint.h>
#include <string.h>

struct pair {
    double hi, lo;
};

/* Exact if |a| >= |b| or a is zero. */
static inline struct pair exact_fast_sum(double a, double b) {
    double s = a + b;
    return (struct pair){s, (a - s) + b};
}

static inline struct pair exact_sum(double a, double b) {
    double s = a + b;
    double t = s - a;
    return (struct pair){s, (a - (s - t)) + (b - t)};
}

/* Exact while nothing overflows (factors below 2^995) or underflows. */
static inline struct pair exact_product(double a, double b) {
    double p = a * b;
    double ta = a * 0x1.0p27 + a, tb = b * 0x1.0p27 + b;
    double ah = ta - (ta - a), bh = tb - (tb - b);
    double al = a - ah, bl = b - bh;
    return (struct pair){p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
}

/* A double's bit pattern, and back. */
static inline uint64_t to_bits(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline double from_bits(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* The one NaN that domain errors give. */
static inline double invalid(void) {
    return from_bits(0x7ff8000000000000u);
}

/* 2^n, -1022 <= n <= 1023. */
static inline double two_to(int n) {
    return from_bits((uint64_t)(n + 1023) << 52);
}

/* The leading 26 bits or fewer: the product of two such is exact. */
static inline double leading(double x) {
    return from_bits(to_bits(x) & 0xfffffffff8000000u);
}

#endif
