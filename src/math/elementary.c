/* Elementary functions from + - * / sqrt and integer operations alone.
 *
 * The ideas:
 *  - exp: x = n ln2/128 + r; 2^(n/128) from a table, e^r from five terms of the series (Tang 1989, "Table-driven
 *    implementation of the exponential function in IEEE floating-point arithmetic").
 *  - log: x = 2^k m; a table gives c near 1/m with so few bits that m c - 1 is exact in two doubles, then a polynomial
 *    (Tang 1990; Gal and Bachelis 1991 for the short c). Intervals that touch 1 have c = 1, so nothing cancels there.
 *  - pow: e^(y log x), the logarithm carried as an unevaluated sum of two doubles good to about 2^-67.
 *  - sin, cos, tan: x - n pi/2 with pi/2 in three parts (Cody and Waite 1980) while n < 2^20; beyond, or when so much
 *    cancels that the parts do not suffice, 192 bits of 2/pi in integers (Payne and Hanek 1983). The reduced argument
 *    is a pair; then polynomials on [-pi/4, pi/4].
 *  - atan: nearest i/64, atan(a) = atan(c) + atan((a - c) / (1 + a c)), and a few terms of the series.
 *  - asin, acos: a polynomial below 1/2, the half-angle formula with a corrected square root above (as in fdlibm).
 *  - products and sums whose error matters are Dekker's (1971) with Veltkamp's splitting (exact.h); there is
 * no fma.
 *
 * The steps without branches, which functions of many arguments share, are in elementary_lanes.h; the algebraic ones
 * (cube root, remainder) are at the end.
 *
 * Invariant: no operation here depends on the processor, the compiler or the library. The build must keep
 * contraction off; a pair (hi, lo) always means the exact sum hi + lo. The numbers are in
 * elementary_tables_internal.h. */
#include "math/elementary.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "math/elementary_lanes.h"
#include "math/portable.h"

#ifdef __FAST_MATH__
#error "elementary functions need strict floating-point arithmetic"
#endif

__extension__ typedef unsigned __int128 wide;

/* ---- exponentials ------------------------------------------------------------------------------------------------ */

/* 2^exponent (hi + lo), rounded once even where the result is subnormal. */
static double scale_result(struct pair value, int exponent) {
    if (exponent > 1024)
        return INFINITY;
    if (exponent < -1080)
        return 0.0;
    if (exponent > 1000)
        return (value.hi + value.lo) * 0x1.0p1000 * two_to(exponent - 1000);
    if (exponent >= -1021)
        return (value.hi + value.lo) * two_to(exponent);
    /* In units of 2^-1022 a subnormal is below 1: adding 1 puts its last bit where a double's last bit is. */
    double up = two_to(exponent + 1022);
    double hi = value.hi * up, lo = value.lo * up;
    double sum = hi + lo;
    if (sum < 1.0) {
        struct pair one = exact_fast_sum(1.0, hi);
        sum = (one.hi + (one.lo + lo)) - 1.0;
    }
    return sum * 0x1.0p-1022;
}

double el_exp(double x) {
    if (!(fabs(x) < 708.0)) {
        if (isnan(x))
            return x + x;
        if (x > 710.0)
            return INFINITY;
        if (x < -746.0)
            return 0.0;
        struct scaled e = exp_scaled(x, 0.0);
        return scale_result(e.value, scaled_exponent(e));
    }
    struct scaled e = exp_scaled(x, 0.0);
    return (e.value.hi + e.value.lo) * scaled_power(e);
}

double el_exp2(double x) {
    if (isnan(x))
        return x + x;
    if (x >= 1024.0)
        return INFINITY;
    if (x < -1076.0)
        return 0.0;
    double shifted = x + 0x1.8p45; /* rounds to a multiple of 1/128 */
    int32_t n = (int32_t)(uint32_t)to_bits(shifted);
    double r = (x - (shifted - 0x1.8p45)) * ln2_double;
    const struct exp_entry *entry = &exp_table[n & 127];
    double scale = from_bits(entry->bits);
    double r2 = r * r;
    double p = entry->tail + r + r2 * (0.5 + r * (1.0 / 6)) + r2 * r2 * (1.0 / 24 + r * (1.0 / 120));
    struct pair value = {scale, scale * p};
    if (fabs(x) < 1020.0)
        return (value.hi + value.lo) * two_to(n >> 7);
    return scale_result(value, n >> 7);
}

double el_expm1(double x) {
    if (isnan(x))
        return x + x;
    if (x > 710.0)
        return INFINITY;
    if (x < -40.0)
        return -1.0;
    if (fabs(x) < 0x1.0p-54)
        return x;
    double shifted = x * exp_per_step + shifter;
    int32_t n = (int32_t)(uint32_t)to_bits(shifted);
    double steps = shifted - shifter;
    double coarse = x - steps * exp_step_hi, fine = steps * exp_step_lo;
    double r = coarse - fine;
    double rl = (coarse - r) - fine;
    double r2 = r * r;
    double q = r2 * (0.5 + r * (1.0 / 6)) + r2 * r2 * (1.0 / 24 + r * (1.0 / 120) + r2 * (1.0 / 720));
    if (n == 0)
        return r + q;
    const struct exp_entry *entry = &exp_table[n & 127];
    int k = n >> 7;
    if (k > 64) { /* the 1 is far below the last bit, and products of 2^k might overflow */
        double scale = from_bits(entry->bits);
        return scale_result((struct pair){scale, scale * (entry->tail + rl + r + q)}, k);
    }
    double scale = from_bits(entry->bits) * two_to(k);
    /* scale (1 + tail + r + q) - 1; the two largest terms are added without error. */
    struct pair product = exact_product(scale, r);
    struct pair base = exact_sum(scale, -1.0);
    struct pair sum = exact_sum(base.hi, product.hi);
    return sum.hi + (sum.lo + (base.lo + product.lo + scale * (entry->tail * (1.0 + r) + rl + q)));
}

/* ---- logarithms -------------------------------------------------------------------------------------------------- */

static inline struct split log_split(double x) {
    if (x >= 0x1.0p-1022)
        return log_split_normal(x);
    struct split s = log_split_normal(x * 0x1.0p54);
    s.exponent -= 54;
    return s;
}

/* Zero, negative, infinite and NaN arguments of all logarithms. */
static double log_special(double x) {
    if (isnan(x))
        return x + x;
    if (x == 0.0)
        return -INFINITY;
    if (x < 0.0)
        return invalid();
    return x;
}

static inline bool log_is_plain(double x) {
    return x > 0.0 && x < INFINITY;
}

double el_log(double x) {
    return log_is_plain(x) ? log_value(log_split(x)) : log_special(x);
}

double el_log2(double x) {
    if (!log_is_plain(x))
        return log_special(x);
    struct split s = log_split(x);
    struct pair m = log_pair(s, 0.0);
    struct pair p = exact_product(m.hi, log2_e_hi);
    struct pair sum = exact_sum(s.exponent, p.hi);
    return sum.hi + (sum.lo + (p.lo + (m.hi * log2_e_lo + m.lo * log2_e_hi)));
}

double el_log10(double x) {
    if (!log_is_plain(x))
        return log_special(x);
    struct split s = log_split(x);
    struct pair m = log_pair(s, s.exponent);
    struct pair p = exact_product(m.hi, log10_e_hi);
    return p.hi + (p.lo + (m.hi * log10_e_lo + m.lo * log10_e_hi));
}

/* ---- power ------------------------------------------------------------------------------------------------------- */

/* 0: not an integer, 1: odd, 2: even. */
static int integer_kind(double y) {
    double a = fabs(y);
    if (a >= 0x1.0p53)
        return 2;
    double whole = floor(a);
    if (whole != a)
        return 0;
    return (int64_t)whole & 1 ? 1 : 2;
}

/* x zero, infinite or NaN, or y zero, infinite or NaN. */
static double pow_special(double x, double y) {
    if (y == 0.0 || x == 1.0)
        return 1.0;
    if (isnan(x) || isnan(y))
        return x + y;
    if (isinf(y)) {
        if (fabs(x) == 1.0)
            return 1.0;
        return (fabs(x) > 1.0) == (y > 0.0) ? INFINITY : 0.0;
    }
    bool negative = signbit(x) && integer_kind(y) == 1;
    double size = (x == 0.0) == (y > 0.0) ? 0.0 : INFINITY;
    return negative ? -size : size;
}

double el_pow(double x, double y) {
    if (!(fabs(x) > 0.0 && fabs(x) < INFINITY && fabs(y) > 0.0 && fabs(y) < INFINITY))
        return pow_special(x, y);
    double sign = 1.0;
    if (x < 0.0) {
        int kind = integer_kind(y);
        if (kind == 0)
            return invalid();
        if (kind == 1)
            sign = -1.0;
        x = -x;
    }
    /* Beyond these sizes of y the answer is 1, or leaves the range; and below nothing here can overflow or
     * underflow. */
    if (fabs(y) > 0x1.0p66) {
        if (x == 1.0)
            return sign;
        return sign * ((x > 1.0) == (y > 0.0) ? INFINITY : 0.0);
    }
    if (fabs(y) < 0x1.0p-66)
        return sign;
    struct split s = log_split(x);
    struct pair l = log_pair(s, s.exponent);
    double lh = leading(l.hi), yh = leading(y);
    double hi = yh * lh;
    double lo = (y - yh) * lh + y * ((l.hi - lh) + l.lo);
    if (!(fabs(hi) < 708.0)) {
        if (hi > 711.0)
            return sign * INFINITY;
        if (hi < -747.0)
            return sign * 0.0;
        struct scaled e = exp_scaled(hi, lo);
        return sign * scale_result(e.value, scaled_exponent(e));
    }
    struct scaled e = exp_scaled(hi, lo);
    return sign * ((e.value.hi + e.value.lo) * scaled_power(e));
}

/* ---- hyperbolic functions ---------------------------------------------------------------------------------------- */

/* e^x as a pair, |x| < 700. */
static struct pair exp_pair(double x) {
    struct scaled e = exp_scaled(x, 0.0);
    double up = scaled_power(e);
    return (struct pair){e.value.hi * up, e.value.lo * up};
}

/* e^x / 2 for x >= 40, where e^-x is below the last bit. */
static double half_exp(double x) {
    if (x > 711.0)
        return INFINITY;
    struct scaled e = exp_scaled(x, 0.0);
    return scale_result(e.value, scaled_exponent(e) - 1);
}

double el_sinh(double x) {
    double a = fabs(x);
    if (!(a < INFINITY))
        return x + x;
    if (a < 0.35) {
        double z = a * a;
        const double *c = sinh_poly;
        double p = c[0] + z * (c[1] + z * (c[2] + z * (c[3] + z * (c[4] + z * c[5]))));
        return x + x * z * p;
    }
    if (a >= 40.0)
        return copysign(half_exp(a), x);
    struct pair up = exp_pair(a), down = exp_pair(-a);
    struct pair sum = exact_sum(up.hi, -down.hi);
    return copysign(0.5 * (sum.hi + (sum.lo + (up.lo - down.lo))), x);
}

double el_cosh(double x) {
    double a = fabs(x);
    if (!(a < INFINITY))
        return a + a;
    if (a >= 40.0)
        return half_exp(a);
    struct pair up = exp_pair(a), down = exp_pair(-a);
    struct pair sum = exact_fast_sum(up.hi, down.hi);
    return 0.5 * (sum.hi + (sum.lo + (up.lo + down.lo)));
}

double el_tanh(double x) {
    double a = fabs(x);
    if (isnan(x) || a < 0x1.0p-28)
        return x;
    if (a < 0.35) {
        double z = a * a;
        const double *c = tanh_poly;
        double p = c[5] + z * (c[6] + z * (c[7] + z * (c[8] + z * (c[9] + z * c[10]))));
        p = c[0] + z * (c[1] + z * (c[2] + z * (c[3] + z * (c[4] + z * p))));
        return x + x * z * p;
    }
    if (a > 22.0)
        return copysign(1.0, x);
    /* (1 - q) / (1 + q) = 1 - 2q / (1 + q) with q = e^-2a < 1/2. */
    struct pair q = exp_pair(-2.0 * a);
    struct pair over = exact_fast_sum(1.0, -q.hi), under = exact_fast_sum(1.0, q.hi);
    over = exact_fast_sum(over.hi, over.lo - q.lo);
    under = exact_fast_sum(under.hi, under.lo + q.lo);
    double t = over.hi / under.hi;
    struct pair back = exact_product(t, under.hi);
    double rest = ((over.hi - back.hi) - back.lo) + over.lo - t * under.lo;
    return copysign(t + rest / under.hi, x);
}

/* ---- angles ------------------------------------------------------------------------------------------------------ */

/* |x| - quadrant pi/2 for any finite |x| >= 0.5, from integers. */
static int reduce_by_integers(double x, struct pair *reduced) {
    uint64_t mantissa = (to_bits(x) & 0x000fffffffffffffu) | 0x0010000000000000u;
    int exponent = (int)(to_bits(x) >> 52 & 0x7ff) - 1075;
    /* 192 bits of 2/pi times 2^exponent, from the bit worth 2 downwards: higher ones make whole turns. */
    unsigned start = (unsigned)(126 + exponent);
    unsigned word = start / 64, shift = start % 64;
    uint64_t w[3];
    for (unsigned i = 0; i < 3; i++) {
        w[i] = two_over_pi_bits[word + i] << shift;
        if (shift)
            w[i] |= two_over_pi_bits[word + i + 1] >> (64 - shift);
    }
    wide low = (wide)mantissa * w[2];
    wide middle = (wide)mantissa * w[1] + (uint64_t)(low >> 64);
    uint64_t high = mantissa * w[0] + (uint64_t)(middle >> 64);
    /* high:middle:low is a fixed-point number modulo 4 with its point after the second bit. */
    int quadrant = (int)(high >> 62);
    wide fraction = (wide)high << 66 | (wide)(uint64_t)middle << 2 | (uint64_t)low >> 62;
    bool negative = fraction >> 127;
    if (negative) {
        fraction = -fraction;
        quadrant++;
    }
    /* |fraction| is never below 2^-63 (Kahan's search for the worst double), so its upper word has bits to count. */
    uint64_t upper = (uint64_t)(fraction >> 64);
    int zeros = upper ? __builtin_clzll(upper) : 64;
    fraction <<= zeros;
    double unit = two_to(-zeros);
    double hi = (double)(uint64_t)(fraction >> 75) * 0x1.0p-53 * unit;
    double lo = (double)(uint64_t)(fraction >> 22 & 0x1fffffffffffffu) * 0x1.0p-106 * unit;
    struct pair p = exact_product(hi, half_pi_hi);
    *reduced = exact_fast_sum(p.hi, p.lo + (hi * half_pi_lo + lo * half_pi_hi));
    if (negative)
        *reduced = (struct pair){-reduced->hi, -reduced->lo};
    return quadrant & 3;
}

/* x = quadrant pi/2 + reduced modulo 2 pi, |reduced| <= pi/4 or a last bit more; x finite. */
static inline int reduce_angle(double x, struct pair *reduced) {
    double a = fabs(x);
    if (a < 1.0e6) {
        struct turned turned = turn_back(x);
        if (is_turned_well(x, turned)) {
            *reduced = turned_angle(turned);
            return (int)(to_bits(turned.shifted) & 3);
        }
    }
    int quadrant = reduce_by_integers(a, reduced);
    if (x >= 0.0)
        return quadrant;
    *reduced = (struct pair){-reduced->hi, -reduced->lo};
    return -quadrant & 3;
}

double el_sin(double x) {
    if (fabs(x) < 0.785)
        return fabs(x) < 0x1.0p-27 ? x : sine_value((struct pair){x, 0.0});
    if (!(fabs(x) < INFINITY))
        return isnan(x) ? x + x : invalid();
    struct pair r;
    int quadrant = reduce_angle(x, &r);
    double value = quadrant & 1 ? cosine_value(r) : sine_value(r);
    return quadrant & 2 ? -value : value;
}

double el_cos(double x) {
    if (fabs(x) < 0.785)
        return cosine_value((struct pair){x, 0.0});
    if (!(fabs(x) < INFINITY))
        return isnan(x) ? x + x : invalid();
    struct pair r;
    int quadrant = reduce_angle(x, &r);
    double value = quadrant & 1 ? sine_value(r) : cosine_value(r);
    return quadrant == 1 || quadrant == 2 ? -value : value;
}

/* The same bits as el_sin and el_cos. */
void el_sincos(double x, double *sine, double *cosine) {
    if (fabs(x) < 0x1.0p-27 || !(fabs(x) < INFINITY)) {
        *sine = el_sin(x);
        *cosine = el_cos(x);
        return;
    }
    struct pair r = {x, 0.0};
    int quadrant = fabs(x) < 0.785 ? 0 : reduce_angle(x, &r);
    double s = sine_value(r), c = cosine_value(r);
    double sine_size = quadrant & 1 ? c : s, cosine_size = quadrant & 1 ? s : c;
    *sine = quadrant & 2 ? -sine_size : sine_size;
    *cosine = quadrant == 1 || quadrant == 2 ? -cosine_size : cosine_size;
}

double el_tan(double x) {
    if (fabs(x) < 0x1.0p-27)
        return x;
    if (!(fabs(x) < INFINITY))
        return isnan(x) ? x + x : invalid();
    struct pair r = {x, 0.0};
    int quadrant = fabs(x) < 0.785 ? 0 : reduce_angle(x, &r);
    return tangent_of(r, (uint64_t)quadrant);
}

/* asin(x)/x - 1 for z = x^2 <= 1/4. */
static inline double asin_rest(double z) {
    const double *c = asin_poly;
    double z2 = z * z, z4 = z2 * z2;
    double low = (c[0] + z * c[1]) + z2 * (c[2] + z * c[3]);
    double mid = (c[4] + z * c[5]) + z2 * (c[6] + z * c[7]);
    double high = (c[8] + z * c[9]) + z2 * (c[10] + z * c[11]) + z4 * c[12];
    return z * (low + z4 * (mid + z4 * high));
}

/* 2 asin(sqrt((1 - a) / 2)) = acos(a) as a pair, 1/2 <= a <= 1. */
static inline struct pair acos_near_one(double a) {
    double z = 0.5 * (1.0 - a); /* exact */
    double s = sqrt(z);
    if (s == 0.0)
        return (struct pair){0.0, 0.0};
    double sh = leading(s);
    double sl = (z - sh * sh) / (s + sh); /* sqrt(z) = sh + sl */
    return (struct pair){2.0 * sh, 2.0 * (sl + s * asin_rest(z))};
}

double el_asin(double x) {
    double a = fabs(x);
    if (a < 0.5)
        return a < 0x1.0p-27 ? x : x + x * asin_rest(x * x);
    if (!(a <= 1.0))
        return isnan(x) ? x + x : invalid();
    struct pair c = acos_near_one(a);
    struct pair d = exact_fast_sum(half_pi_hi, -c.hi);
    return copysign(d.hi + (d.lo + (half_pi_lo - c.lo)), x);
}

double el_acos(double x) {
    double a = fabs(x);
    if (a < 0.5) {
        struct pair d = exact_fast_sum(half_pi_hi, -x);
        return d.hi + (d.lo + (half_pi_lo - x * asin_rest(x * x)));
    }
    if (!(a <= 1.0))
        return isnan(x) ? x + x : invalid();
    struct pair c = acos_near_one(a);
    if (x > 0.0)
        return c.hi + c.lo;
    struct pair d = exact_fast_sum(whole_pi_hi, -c.hi);
    return d.hi + (d.lo + (whole_pi_lo - c.lo));
}

/* atan(over / under) as a pair for 0 <= over <= under, both of moderate size. */
static inline struct pair atan_ratio(double over, double under) {
    double ratio = over / under;
    if (ratio < 1.0 / 16) {
        /* Here the quotient itself decides the last bit: its remainder counts, and a table does not help. */
        struct pair back = exact_product(ratio, under);
        double rest = ((over - back.hi) - back.lo) / under;
        double z = ratio * ratio;
        double p = 1.0 / 9 + z * (-1.0 / 11 + z * (1.0 / 13));
        return (struct pair){ratio, rest + ratio * z * (-1.0 / 3 + z * (1.0 / 5 + z * (-1.0 / 7 + z * p)))};
    }
    int i = (int)(ratio * 64.0 + 0.5);
    /* over - c under: c has 7 bits, so both products are exact, and the first difference too. */
    double c = i * (1.0 / 64);
    double head = leading(under);
    double numerator = (over - c * head) - c * (under - head);
    double u = numerator / (under + c * over);
    double z = u * u;
    double rest = u + u * z * (-1.0 / 3 + z * (1.0 / 5 + z * (-1.0 / 7)));
    return (struct pair){atan_table[i].hi, atan_table[i].lo + rest};
}

/* y or x zero or infinite, neither NaN. */
static double atan2_special(double y, double x) {
    double angle;
    if (y == 0.0)
        angle = signbit(x) ? whole_pi_hi : 0.0;
    else if (isinf(y))
        angle = !isinf(x) ? half_pi_hi : x > 0.0 ? quarter_pi_hi : three_quarter_pi_hi;
    else if (x == 0.0)
        angle = half_pi_hi;
    else
        angle = x > 0.0 ? 0.0 : whole_pi_hi;
    return copysign(angle, y);
}

double el_atan2(double y, double x) {
    double a = fabs(y), b = fabs(x);
    if (!(a > 0.0 && a < INFINITY && b > 0.0 && b < INFINITY)) {
        if (isnan(x) || isnan(y))
            return x + y;
        return atan2_special(y, x);
    }
    double over = a < b ? a : b, under = a < b ? b : a;
    if (under > 0x1.0p900) {
        over *= 0x1.0p-200;
        under *= 0x1.0p-200;
    } else if (over < 0x1.0p-700) {
        over *= 0x1.0p200;
        under *= 0x1.0p200;
    }
    struct pair t = {0.0, 0.0};
    if (over >= under * 0x1.0p-60) {
        t = atan_ratio(over, under);
    } else if (a < b && x > 0.0) {
        return y / x; /* the angle is the ratio itself, subnormal perhaps */
    }
    if (a > b) {
        /* pi/2 minus or plus the small angle */
        double side = x > 0.0 ? -1.0 : 1.0;
        struct pair d = exact_fast_sum(half_pi_hi, side * t.hi);
        return copysign(d.hi + (d.lo + (half_pi_lo + side * t.lo)), y);
    }
    if (x > 0.0)
        return copysign(t.hi + t.lo, y);
    struct pair d = exact_fast_sum(whole_pi_hi, -t.hi);
    return copysign(d.hi + (d.lo + (whole_pi_lo - t.lo)), y);
}

/* Cube root and remainder: the elementary functions that need no tables.
 *
 * The root ends with one correction step whose residual is computed without error, so the answer is within 0.67 last
 * places (Halley's iteration, the argument's bit pattern divided by three as first guess, as in fdlibm). Only + - * /;
 * see above. */

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

double el_fmod(double x, double y) {
    if (isnan(x) || isnan(y))
        return x + y;
    if (isinf(x) || y == 0.0)
        return invalid();
    return math_fmod(x, y);
}
