/* The steps of elementary functions that have no branches, and from them functions of many arguments at once: in a loop
 * the compiler makes vectors of them. Where `..._fits` holds the result has the bits of the function in elementary.h;
 * elsewhere it is any number. The steps are those of elementary.c, which explains them. */
#ifndef GRAY_MATH_ELEMENTARY_LANES_H
#define GRAY_MATH_ELEMENTARY_LANES_H

#include "math/elementary_tables_internal.h"
#include "math/exact.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

static const double shifter = 0x1.8p52; /* adding and subtracting it rounds to an integer */

/* e^(x + xl) as 2^exponent (value.hi + value.lo) with value in [1, 2); needs |x| < 2000 and |xl| < 2^-8 |x| or so. */
struct scaled {
    struct pair value;
    uint64_t steps; /* its lower half: 128 times the exponent, and the table's index */
};

static inline int scaled_exponent(struct scaled s) {
    return (int32_t)(uint32_t)s.steps >> 7;
}

/* 2^exponent, if that is a normal number. */
static inline double scaled_power(struct scaled s) {
    return from_bits(((s.steps >> 7) + 1023) << 52);
}

static inline struct scaled exp_scaled(double x, double xl) {
    double shifted = x * exp_per_step + shifter;
    uint64_t n = to_bits(shifted);
    double steps = shifted - shifter;
    double r = (x - steps * exp_step_hi) - steps * exp_step_lo + xl;
    const struct exp_entry *entry = &exp_table[n & 127];
    double scale = from_bits(entry->bits);
    double r2 = r * r;
    double p = entry->tail + r + r2 * (0.5 + r * (1.0 / 6)) + r2 * r2 * (1.0 / 24 + r * (1.0 / 120));
    return (struct scaled){{scale, scale * p}, n};
}

/* x = 2^exponent m with m in [0.6875, 1.375) and its interval; x positive and finite. */
struct split {
    double mantissa;
    int exponent;
    const struct log_entry *entry;
};

/* Of normal numbers. */
static inline struct split log_split_normal(double x) {
    uint64_t above = to_bits(x) - 0x3fe6000000000000u;
    struct split s;
    s.exponent = (int32_t)(uint32_t)(above >> 32) >> 20;
    s.entry = &log_table[above >> 45 & 127];
    s.mantissa = from_bits(to_bits(x) - (above & 0xfff0000000000000u));
    return s;
}

/* m c - 1 exactly: c has at most 10 bits, the upper part of m 21. */
static inline struct pair log_remainder(struct split s) {
    double upper = from_bits(to_bits(s.mantissa) & 0xffffffff00000000u);
    double rh = upper * s.entry->inverse - 1.0;
    return exact_fast_sum(rh, (s.mantissa - upper) * s.entry->inverse);
}

static inline double log_tail(double r) {
    double r2 = r * r;
    const double *c = log_poly;
    return (c[0] + r * c[1]) + r2 * ((c[2] + r * c[3]) + r2 * ((c[4] + r * c[5]) + r2 * (c[6] + r * c[7])));
}

/* log(2^k m) as a pair with relative error near 2^-67. */
static inline struct pair log_pair(struct split s, double k) {
    struct pair r = log_remainder(s);
    double rh = leading(r.hi);
    struct pair a = exact_fast_sum(k * log_ln2_hi + s.entry->log_hi, r.hi);
    struct pair b = exact_fast_sum(a.hi, -0.5 * rh * rh);
    double small = a.lo + r.lo + (k * log_ln2_lo + s.entry->log_lo);
    small += b.lo - 0.5 * (r.hi - rh) * (r.hi + rh) - r.hi * r.lo;
    small += r.hi * r.hi * r.hi * log_tail(r.hi);
    return exact_fast_sum(b.hi, small);
}

/* The logarithm of 2^k m. */
static inline double log_value(struct split s) {
    double k = s.exponent;
    struct pair r = log_remainder(s);
    struct pair a = exact_fast_sum(k * log_ln2_hi + s.entry->log_hi, r.hi);
    double r2 = r.hi * r.hi;
    double small = a.lo + r.lo + (k * log_ln2_lo + s.entry->log_lo);
    return a.hi + (small + (r2 * r.hi * log_tail(r.hi) - 0.5 * r2));
}

/* x - n pi/2, before the last part of pi/2; for |x| < 10^6. Good to 2^-99. */
struct turned {
    struct pair rest;
    double shifted, n;
};

static inline struct turned turn_back(double x) {
    double shifted = x * two_over_pi + shifter;
    double n = shifted - shifter;
    double t = x - n * half_pi_1;
    return (struct turned){exact_sum(t, -(n * half_pi_2)), shifted, n};
}

/* Enough unless the angle is next to a multiple of pi/2. */
static inline bool is_turned_well(double x, struct turned turned) {
    return (fabs(turned.rest.hi) > 0x1.0p-30) | (fabs(x) < 0.5);
}

static inline struct pair turned_angle(struct turned turned) {
    return exact_fast_sum(turned.rest.hi, turned.rest.lo - turned.n * half_pi_3);
}

/* Sine of hi + lo, less hi. */
static inline double sine_rest(struct pair r) {
    double z = r.hi * r.hi, z2 = z * z;
    const double *c = sin_poly;
    double p = (c[0] + z * c[1]) + z2 * ((c[2] + z * c[3]) + z2 * (c[4] + z * c[5]));
    return z * r.hi * p + (r.lo - 0.5 * z * r.lo);
}

static inline struct pair cosine_pair(struct pair r) {
    double z = r.hi * r.hi, z2 = z * z;
    const double *c = cos_poly;
    double p = (c[0] + z * c[1]) + z2 * ((c[2] + z * c[3]) + z2 * (c[4] + z * c[5]));
    double w = 1.0 - 0.5 * z;
    return (struct pair){w, ((1.0 - w) - 0.5 * z) + (z2 * p - r.hi * r.lo)};
}

static inline double cosine_value(struct pair r) {
    struct pair c = cosine_pair(r);
    return c.hi + c.lo;
}

static inline double sine_value(struct pair r) {
    return r.hi + sine_rest(r);
}

/* --- whole functions --- */

static inline bool el_exp_fits(double x) {
    return fabs(x) < 708.0;
}

static inline double el_exp_lane(double x) {
    struct scaled e = exp_scaled(x, 0.0);
    return (e.value.hi + e.value.lo) * scaled_power(e);
}

/* Positive, finite and not subnormal. */
static inline bool el_log_fits(double x) {
    return (x >= 0x1.0p-1022) & (x < (double)INFINITY);
}

static inline double el_log_lane(double x) {
    return log_value(log_split_normal(x));
}

/* The base as for the logarithm, the result between 2^-1000 and 2^1000. */
static inline bool el_pow_fits(double x, double y) {
    double exponent = (int32_t)(uint32_t)(to_bits(x) >> 52) - 1023;
    return el_log_fits(x) & (fabs(y) > 0x1.0p-66) & (fabs(y) * (fabs(exponent) + 1) < 1000.0);
}

static inline double el_pow_lane(double x, double y) {
    struct split s = log_split_normal(x);
    struct pair l = log_pair(s, s.exponent);
    double lh = leading(l.hi), yh = leading(y);
    struct scaled e = exp_scaled(yh * lh, (y - yh) * lh + y * ((l.hi - lh) + l.lo));
    return (e.value.hi + e.value.lo) * scaled_power(e);
}

/* Of sine, cosine and tangent. */
static inline bool el_angle_fits(double x) {
    return (fabs(x) < 1.0e6) & is_turned_well(x, turn_back(x));
}

static inline double negated_if(double x, bool negate) {
    return from_bits(to_bits(x) ^ (negate ? 0x8000000000000000u : 0));
}

static inline void el_sincos_lane(double x, double *sine, double *cosine) {
    struct turned turned = turn_back(x);
    struct pair r = turned_angle(turned);
    uint64_t quadrant = to_bits(turned.shifted);
    double s = sine_value(r), c = cosine_value(r);
    double value = negated_if(quadrant & 1 ? c : s, quadrant & 2);
    *sine = fabs(x) < 0x1.0p-27 ? x : value;
    *cosine = negated_if(quadrant & 1 ? s : c, (quadrant + 1) & 2);
}

static inline double el_sin_lane(double x) {
    double sine, cosine;
    el_sincos_lane(x, &sine, &cosine);
    return sine;
}

static inline double el_cos_lane(double x) {
    double sine, cosine;
    el_sincos_lane(x, &sine, &cosine);
    return cosine;
}

/* The tangent, from the sine and the cosine as pairs. */
static inline double tangent_of(struct pair r, uint64_t quadrant) {
    uint64_t is_odd = quadrant & 1;
    struct pair s = exact_fast_sum(r.hi, sine_rest(r));
    struct pair c = cosine_pair(r);
    c = exact_fast_sum(c.hi, c.lo - 0.5 * exact_product(r.hi, r.hi).lo);
    double over_hi = is_odd ? -c.hi : s.hi, over_lo = is_odd ? -c.lo : s.lo;
    double under_hi = is_odd ? s.hi : c.hi, under_lo = is_odd ? s.lo : c.lo;
    double t = over_hi / under_hi;
    struct pair back = exact_product(t, under_hi);
    double rest = ((over_hi - back.hi) - back.lo) + over_lo - t * under_lo;
    return t + rest / under_hi;
}

static inline double el_tan_lane(double x) {
    struct turned turned = turn_back(x);
    double value = tangent_of(turned_angle(turned), to_bits(turned.shifted));
    return fabs(x) < 0x1.0p-27 ? x : value;
}

#endif
