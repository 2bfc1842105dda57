/* What searches of triangles need of vectors beyond math/lanes.h. */
#ifndef GRAY_ACCEL_TRIANGLE_VECTORS_INTERNAL_H
#define GRAY_ACCEL_TRIANGLE_VECTORS_INTERNAL_H

#include "math/lanes.h"

/* ---- four floats: three coordinates ---- */

#define float4_shuffle(a, i, j, k, l) __builtin_shufflevector(a, a, i, j, k, l)

/* Lane 3 becomes 0. */
static inline float4 float4_three(float4 a) {
    return (float4)((float4_integers)a & (float4_integers){-1, -1, -1, 0});
}
/* Truncated. */
static inline void float4_store_int(int32_t *p, float4 a) {
    *(float4_integers *)(void *)p = __builtin_convertvector(a, float4_integers);
}
static inline float4 float4_whole(float4 a) {
    return __builtin_convertvector(__builtin_convertvector(a, float4_integers), float4);
}
static inline float4 float4_one_unless_negative(float4 a) {
    return (float4)(~((float4_integers)a >> 31) & (float4_integers)float4_all(1));
}
/* The smallest of lanes 0, 1, 2 in lanes 0, 1, 2; lane 3 of `a` must not be the smallest. */
static inline float4 float4_min_of_three(float4 a) {
    return float4_min(float4_min(a, float4_shuffle(a, 1, 2, 0, 3)), float4_shuffle(a, 2, 0, 1, 3));
}
/* Of lanes 0, 1, 2. */
static inline float float4_largest_of_three(float4 a) {
    return float4_max(float4_max(a, float4_shuffle(a, 1, 1, 2, 3)), float4_shuffle(a, 2, 3, 2, 3))[0];
}
static inline float float4_smallest_of_three(float4 a) {
    return float4_min(float4_min(a, float4_shuffle(a, 1, 1, 2, 3)), float4_shuffle(a, 2, 3, 2, 3))[0];
}
/* Adds b where a <= limit; *lanes says where. */
static inline float4 float4_add_where_reached(float4 a, float4 limit, float4 b, unsigned *lanes) {
    float4_mask reached = float4_less_equal(a, limit);
    *lanes = float4_bits(reached);
    return a + (float4)(reached & (float4_mask)b);
}

/* ---- eight floats: children of a node, triangles of a block ---- */

/* Whether from <= a < to in every lane. */
static inline bool float8_all_within(float8 a, const float *from, const float *to) {
    return float8_bits(float8_both(float8_less_equal(float8_load_any(from), a), float8_less(a, float8_load_any(to)))) ==
           255;
}
/* One lane, with an index known only at run time. */
static inline float float8_pick(float8 a, unsigned lane) {
    _Alignas(32) float all[8];
    float8_store(all, a);
    return all[lane];
}
/* The larger of two sizes. */
static inline float8 float8_max_size(float8 a, float8 b) {
#if defined(LANES_AVX512)
    return _mm256_range_ps(a, b, 11); /* one instruction instead of three, thrice for each block */
#else
    return float8_max(float8_size(a), float8_size(b));
#endif
}

/* Minimum, maximum and comparison of the bits as integers, which takes a quarter of the time where there are
 * instructions for it and is correct for the kernels: a number less than a non-negative one stays less. Lanes must not
 * hold NaN. The latest of three is the largest, or, if all are negative, the one farthest below 0, which
 * float8_less_equal_bits treats as larger than any negative number nearer to 0. (Without integers: 0.) */
#if defined(LANES_AVX2)
static inline float8 float8_min_bits(float8 a, float8 b) {
    return (float8)_mm256_min_epi32((__m256i)a, (__m256i)b);
}
static inline float8 float8_latest_bits(float8 a, float8 b, float8 c) {
    return (float8)_mm256_max_epi32(_mm256_max_epi32((__m256i)a, (__m256i)b), (__m256i)c);
}
static inline unsigned float8_less_equal_bits(float8 a, float8 b) {
#if defined(LANES_AVX512)
    return _mm256_cmple_epi32_mask((__m256i)a, (__m256i)b);
#else
    return float8_bits((float8_mask)a > (float8_mask)b) ^ 255u;
#endif
}
/* The same except for lanes where both are equal, and from vectors instead of masks. */
static inline unsigned float8_less_bits(float8 a, float8 b) {
    return float8_bits((float8_mask)b > (float8_mask)a);
}
#elif defined(LANES_NEON)
#define NEON_PAIR(f, a, b)                                                                                             \
    (float8) {                                                                                                         \
        (float4) f((int32x4_t)(a).low, (int32x4_t)(b).low), (float4)f((int32x4_t)(a).high, (int32x4_t)(b).high)        \
    }
static inline float8 float8_min_bits(float8 a, float8 b) {
    return NEON_PAIR(vminq_s32, a, b);
}
static inline float8 float8_latest_bits(float8 a, float8 b, float8 c) {
    float8 d = NEON_PAIR(vmaxq_s32, a, b);
    return NEON_PAIR(vmaxq_s32, d, c);
}
static inline unsigned float8_less_equal_bits(float8 a, float8 b) {
    return float8_bits(
        (float8_mask){(float4_mask)a.low <= (float4_mask)b.low, (float4_mask)a.high <= (float4_mask)b.high});
}
#undef NEON_PAIR
#else
#define float8_min_bits float8_min
static inline float8 float8_latest_bits(float8 a, float8 b, float8 c) {
    return float8_max(float8_max(a, b), float8_max(c, float8_all(0)));
}
static inline unsigned float8_less_equal_bits(float8 a, float8 b) {
    return float8_bits(float8_less_equal(a, b));
}
#endif

/* ---- four doubles: a ray or a vertex in its own precision ---- */

/* Three numbers, and 0 in lane 3. */
static inline double4 double4_load_three(const double *p) {
#if defined(LANES_AVX512)
    return _mm256_maskz_loadu_pd(7, p);
#elif defined(LANES_AVX2)
    return _mm256_maskload_pd(p, (__m256i)(double4_integers){-1, -1, -1, 0}); /* no other load stops at three */
#else
    return double4_of(double2_load_any(p), (double2){p[2], 0});
#endif
}
/* The same, number by number: the caller has just stored them one by one, and a wider load would wait for the stores.
 * The empty statement keeps the compiler from joining the loads. */
static inline double4 double4_load_singly(const double *p) {
    double2 low = {p[0], 0};
#if defined(LANES_X86)
    __asm__("" : "+x"(low));
#elif defined(LANES_NEON)
    __asm__("" : "+w"(low));
#endif
    low[1] = p[1];
    return double4_of(low, (double2){p[2], 0});
}
/* Lanes in another order: `halves` is the source of each half of the four. */
static inline double4 double4_permuted(double4 a, const uint32_t halves[8]) {
#if defined(LANES_AVX2)
    return (double4)_mm256_permutevar8x32_ps((float8)a, *(const __m256i *)(const void *)halves);
#else
    _Alignas(32) double all[4];
    double4_store(all, a);
    return double4_make(all[halves[0] / 2], all[halves[2] / 2], all[halves[4] / 2], all[halves[6] / 2]);
#endif
}
/* Lane 2 in all. */
static inline double4 double4_third(double4 a) {
    return double4_shuffle(a, a, 2, 2, 2, 2);
}
/* Lanes 0, 1 and 2 of three vectors, each in a separate vector; lane 3 is undefined. For the last one, lanes 3 and 2 of
 * the vectors must be equal. */
static inline double4 double4_firsts(double4 a, double4 b, double4 c) {
    return double4_of(double4_low(double4_shuffle(a, b, 0, 4, 2, 6)), double4_low(c));
}
static inline double4 double4_seconds(double4 a, double4 b, double4 c) {
    return double4_of(double4_low(double4_shuffle(a, b, 1, 5, 3, 7)), double4_low(double4_shuffle(c, c, 1, 0, 3, 2)));
}
static inline double4 double4_thirds(double4 a, double4 b, double4 c) {
    double4 both = double4_shuffle(a, b, 0, 4, 2, 6);
    return double4_shuffle(both, c, 2, 3, 6, 7);
}
/* Lanes 0, 1, 2 rotated; lane 3 stays. */
static inline double4 double4_cab(double4 a) {
    return double4_shuffle(a, a, 2, 0, 1, 3);
}
static inline double4 double4_bca(double4 a) {
    return double4_shuffle(a, a, 1, 2, 0, 3);
}
/* (b0 + b1) + b2 in lane 0, followed by a1 and a2, all divided by (a0 + a1) + a2. */
static inline double4 double4_weighted(double4 a, double4 b) {
    double2 a_low = double4_low(a), b_low = double4_low(b), a_high = double4_high(a), b_high = double4_high(b);
    double2 sums = __builtin_shufflevector(a_low, b_low, 0, 2) + __builtin_shufflevector(a_low, b_low, 1, 3);
    sums += __builtin_shufflevector(a_high, b_high, 0, 2);
    return double4_div(double4_of(__builtin_shufflevector(sums, a_low, 1, 3), a_high), double4_all(sums[0]));
}
/* Bit 0: lane 1 is larger than lane 0; bit 1: lane 2 is larger than both. */
static inline unsigned double4_larger(double4 a) {
    double4 next = double4_shuffle(a, a, 1, 2, 3, 3), largest = double4_max(a, next);
    return double4_bits(double4_less(double4_shuffle(a, largest, 0, 4, 2, 6), next)) & 3;
}
static inline double double4_largest(double4 a) {
    double2 b = double2_max(double4_low(a), double4_high(a));
    return b[0] > b[1] ? b[0] : b[1];
}
static inline double double4_smallest(double4 a) {
    double2 b = double2_min(double4_low(a), double4_high(a));
    return b[0] < b[1] ? b[0] : b[1];
}
static inline bool double4_all_less(double4 a, double4 b) {
    return double4_bits(double4_less(a, b)) == 15;
}
static inline float4 double4_to_single(double4 a) {
#if defined(LANES_AVX2)
    return __builtin_convertvector(a, float4);
#else
    return (float4){(float)a.low[0], (float)a.low[1], (float)a.high[0], (float)a.high[1]};
#endif
}

#endif
