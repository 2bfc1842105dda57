/* Four and eight floats at a time, under one set of names for three targets: AVX (files compiled with -mavx2), SSE2
 * (every x86-64) and plain loops (any processor). Only the operations that the kernels use. Results of single
 * operations are the same on all of them except for simd8_multiply_sub and simd8_multiply_add, which may round once or
 * twice: nothing exact may depend on them. */
#ifndef GRAY_ACCEL_SIMD_INTERNAL_H
#define GRAY_ACCEL_SIMD_INTERNAL_H

#include <math.h>
#include <stdint.h>

#if defined(__SSE2__) && !defined(GRAY_NO_SIMD)
#include <immintrin.h>

typedef __m128 simd4;

static inline simd4 simd4_load(const float *p) {
    return _mm_loadu_ps(p);
}
static inline void simd4_store(float *p, simd4 a) {
    _mm_storeu_ps(p, a);
}
static inline simd4 simd4_all(float x) {
    return _mm_set1_ps(x);
}
static inline simd4 simd4_make(float x, float y, float z, float w) {
    return _mm_setr_ps(x, y, z, w);
}
static inline simd4 simd4_add(simd4 a, simd4 b) {
    return _mm_add_ps(a, b);
}
static inline simd4 simd4_sub(simd4 a, simd4 b) {
    return _mm_sub_ps(a, b);
}
static inline simd4 simd4_mul(simd4 a, simd4 b) {
    return _mm_mul_ps(a, b);
}
static inline simd4 simd4_min(simd4 a, simd4 b) {
    return _mm_min_ps(a, b);
}
static inline simd4 simd4_max(simd4 a, simd4 b) {
    return _mm_max_ps(a, b);
}
static inline simd4 simd4_size(simd4 a) {
    return _mm_andnot_ps(_mm_set1_ps(-0.0f), a);
}
/* One bit per lane whose sign is set. */
static inline unsigned simd4_negative(simd4 a) {
    return (unsigned)_mm_movemask_ps(a);
}
/* Lane 3 becomes 0. */
static inline simd4 simd4_three(simd4 a) {
    return _mm_and_ps(a, _mm_castsi128_ps(_mm_setr_epi32(-1, -1, -1, 0)));
}
/* Truncated to integers. */
static inline void simd4_store_int(int32_t *p, simd4 a) {
    _mm_storeu_si128((__m128i *)(void *)p, _mm_cvttps_epi32(a));
}
/* Truncated to whole numbers. */
static inline simd4 simd4_whole(simd4 a) {
    return _mm_cvtepi32_ps(_mm_cvttps_epi32(a));
}
static inline simd4 simd4_one_unless_negative(simd4 a) {
    return _mm_andnot_ps(_mm_castsi128_ps(_mm_srai_epi32(_mm_castps_si128(a), 31)), _mm_set1_ps(1));
}
/* The smallest of lanes 0, 1, 2 in lanes 0, 1, 2; lane 3 of `a` must not be the smallest. */
static inline simd4 simd4_min_of_three(simd4 a) {
    simd4 b = _mm_min_ps(a, _mm_shuffle_ps(a, a, _MM_SHUFFLE(3, 0, 2, 1)));
    return _mm_min_ps(b, _mm_shuffle_ps(a, a, _MM_SHUFFLE(3, 1, 0, 2)));
}
static inline float simd4_first(simd4 a) {
    return _mm_cvtss_f32(a);
}
static inline simd4 simd4_div(simd4 a, simd4 b) {
    return _mm_div_ps(a, b);
}
static inline int simd4_any_of_three_below(simd4 a, simd4 b) {
    return _mm_movemask_ps(_mm_cmplt_ps(a, b)) & 7;
}
/* Of lanes 0, 1, 2. */
static inline float simd4_largest_of_three(simd4 a) {
    __m128 b = _mm_max_ss(a, _mm_shuffle_ps(a, a, 1));
    return _mm_cvtss_f32(_mm_max_ss(b, _mm_movehl_ps(a, a)));
}
static inline float simd4_smallest_of_three(simd4 a) {
    __m128 b = _mm_min_ss(a, _mm_shuffle_ps(a, a, 1));
    return _mm_cvtss_f32(_mm_min_ss(b, _mm_movehl_ps(a, a)));
}
/* Adds b where a <= limit; *lanes says where. */
static inline simd4 simd4_add_where_reached(simd4 a, simd4 limit, simd4 b, unsigned *lanes) {
    simd4 reached = _mm_cmple_ps(a, limit);
    *lanes = (unsigned)_mm_movemask_ps(reached);
    return _mm_add_ps(a, _mm_and_ps(reached, b));
}

#else

typedef struct {
    float lane[4];
} simd4;

static inline simd4 simd4_load(const float *p) {
    return (simd4){{p[0], p[1], p[2], p[3]}};
}
static inline void simd4_store(float *p, simd4 a) {
    for (int i = 0; i < 4; i++)
        p[i] = a.lane[i];
}
static inline simd4 simd4_make(float x, float y, float z, float w) {
    return (simd4){{x, y, z, w}};
}
static inline simd4 simd4_all(float x) {
    return simd4_make(x, x, x, x);
}
#define SIMD4_EACH(name, expression)                                                                                   \
    static inline simd4 name(simd4 a, simd4 b) {                                                                       \
        simd4 c;                                                                                                       \
        for (int i = 0; i < 4; i++) {                                                                                  \
            float x = a.lane[i], y = b.lane[i];                                                                        \
            c.lane[i] = expression;                                                                                    \
        }                                                                                                              \
        return c;                                                                                                      \
    }
SIMD4_EACH(simd4_add, x + y)
SIMD4_EACH(simd4_sub, x - y)
SIMD4_EACH(simd4_mul, x *y)
SIMD4_EACH(simd4_min, x < y ? x : y)
SIMD4_EACH(simd4_max, x > y ? x : y)
static inline simd4 simd4_size(simd4 a) {
    for (int i = 0; i < 4; i++)
        a.lane[i] = fabsf(a.lane[i]);
    return a;
}
static inline unsigned simd4_negative(simd4 a) {
    unsigned bits = 0;
    for (int i = 0; i < 4; i++)
        bits |= (unsigned)(signbit(a.lane[i]) != 0) << i;
    return bits;
}
static inline simd4 simd4_three(simd4 a) {
    a.lane[3] = 0;
    return a;
}
static inline void simd4_store_int(int32_t *p, simd4 a) {
    for (int i = 0; i < 4; i++)
        p[i] = (int32_t)a.lane[i];
}
static inline simd4 simd4_whole(simd4 a) {
    for (int i = 0; i < 4; i++)
        a.lane[i] = (float)(int32_t)a.lane[i];
    return a;
}
static inline simd4 simd4_one_unless_negative(simd4 a) {
    for (int i = 0; i < 4; i++)
        a.lane[i] = signbit(a.lane[i]) ? 0 : 1;
    return a;
}
static inline simd4 simd4_min_of_three(simd4 a) {
    float m = a.lane[0] < a.lane[1] ? a.lane[0] : a.lane[1];
    m = m < a.lane[2] ? m : a.lane[2];
    return simd4_make(m, m, m, a.lane[3]);
}
static inline float simd4_first(simd4 a) {
    return a.lane[0];
}
SIMD4_EACH(simd4_div, x / y)
static inline int simd4_any_of_three_below(simd4 a, simd4 b) {
    return a.lane[0] < b.lane[0] || a.lane[1] < b.lane[1] || a.lane[2] < b.lane[2];
}
static inline float simd4_largest_of_three(simd4 a) {
    float m = a.lane[0] > a.lane[1] ? a.lane[0] : a.lane[1];
    return m > a.lane[2] ? m : a.lane[2];
}
static inline float simd4_smallest_of_three(simd4 a) {
    float m = a.lane[0] < a.lane[1] ? a.lane[0] : a.lane[1];
    return m < a.lane[2] ? m : a.lane[2];
}
static inline simd4 simd4_add_where_reached(simd4 a, simd4 limit, simd4 b, unsigned *lanes) {
    *lanes = 0;
    for (int i = 0; i < 4; i++)
        if (a.lane[i] <= limit.lane[i]) {
            *lanes |= 1u << i;
            a.lane[i] += b.lane[i];
        }
    return a;
}
#endif

#if defined(__AVX__) && !defined(GRAY_NO_SIMD)

typedef __m256 simd8;

/* One lane of four in all eight. */
#define simd8_lane(a, i) simd8_all_of(_mm_shuffle_ps(a, a, (i)*0x55))
static inline simd8 simd8_all_of(simd4 a) {
#if defined(__AVX2__)
    return _mm256_broadcastss_ps(a);
#else
    return _mm256_insertf128_ps(_mm256_castps128_ps256(a), a, 1);
#endif
}

static inline simd8 simd8_load(const float *p) {
    return _mm256_load_ps(p);
}
static inline float simd8_first(simd8 a) {
    return _mm256_cvtss_f32(a);
}
static inline simd4 simd8_low(simd8 a) {
    return _mm256_castps256_ps128(a);
}
static inline simd4 simd8_high(simd8 a) {
    return _mm256_extractf128_ps(a, 1);
}
/* Of lanes 0 to 2 in lane 0, of lanes 4 to 6 in lane 4. */
static inline simd8 simd8_largest_of_threes(simd8 a) {
    return _mm256_max_ps(_mm256_max_ps(a, _mm256_permute_ps(a, 1)), _mm256_permute_ps(a, 2));
}
static inline simd8 simd8_of(simd4 low, simd4 high) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(low), high, 1);
}
/* Whether from <= a < to in every lane; a NaN is not. */
static inline int simd8_all_within(simd8 a, const float *from, const float *to) {
    __m256 inside = _mm256_and_ps(_mm256_cmp_ps(a, _mm256_loadu_ps(from), _CMP_GE_OQ),
                                  _mm256_cmp_ps(a, _mm256_loadu_ps(to), _CMP_LT_OQ));
    return _mm256_movemask_ps(inside) == 255;
}
static inline void simd8_store(float *p, simd8 a) {
    _mm256_store_ps(p, a);
}
static inline simd8 simd8_all(float x) {
    return _mm256_set1_ps(x);
}
static inline simd8 simd8_add(simd8 a, simd8 b) {
    return _mm256_add_ps(a, b);
}
static inline simd8 simd8_sub(simd8 a, simd8 b) {
    return _mm256_sub_ps(a, b);
}
static inline simd8 simd8_mul(simd8 a, simd8 b) {
    return _mm256_mul_ps(a, b);
}
static inline simd8 simd8_div(simd8 a, simd8 b) {
    return _mm256_div_ps(a, b);
}
static inline simd8 simd8_min(simd8 a, simd8 b) {
    return _mm256_min_ps(a, b);
}
static inline simd8 simd8_max(simd8 a, simd8 b) {
    return _mm256_max_ps(a, b);
}
/* One bit per lane where a <= b. */
static inline unsigned simd8_at_max(simd8 a, simd8 b) {
    return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ));
}
#if defined(__AVX2__)
/* As integers of the same bits, which takes a quarter of the time and is correct for the kernels: a number less than a
 * non-negative one stays less. Lanes must not hold NaN. */
static inline simd8 simd8_min_bits(simd8 a, simd8 b) {
    return _mm256_castsi256_ps(_mm256_min_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b)));
}
static inline simd8 simd8_max_bits(simd8 a, simd8 b) {
    return _mm256_castsi256_ps(_mm256_max_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b)));
}
/* The largest of three, or, if all are negative, the one farthest below 0, which simd8_at_max_bits treats as larger
 * than any negative number nearer to 0. (Without integers: 0.) */
static inline simd8 simd8_latest_bits(simd8 a, simd8 b, simd8 c) {
    return simd8_max_bits(simd8_max_bits(a, b), c);
}
static inline unsigned simd8_at_max_bits(simd8 a, simd8 b) {
#if defined(__AVX512VL__)
    return _mm256_cmple_epi32_mask(_mm256_castps_si256(a), _mm256_castps_si256(b));
#else
    __m256i above = _mm256_cmpgt_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b));
    return (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(above)) ^ 255u;
#endif
}
/* The same except for lanes where both are equal, and from vectors instead of masks. */
static inline unsigned simd8_below_bits(simd8 a, simd8 b) {
    __m256i below = _mm256_cmpgt_epi32(_mm256_castps_si256(b), _mm256_castps_si256(a));
    return (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(below));
}
#endif
/* One bit per lane whose sign is set. */
static inline unsigned simd8_negative(simd8 a) {
    return (unsigned)_mm256_movemask_ps(a);
}
static inline simd8 simd8_sign(simd8 a) {
    return _mm256_and_ps(a, _mm256_set1_ps(-0.0f));
}
static inline simd8 simd8_size(simd8 a) {
    return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a);
}
static inline simd8 simd8_flip(simd8 a, simd8 sign) {
    return _mm256_xor_ps(a, sign);
}
/* The larger of two sizes. */
static inline simd8 simd8_max_size(simd8 a, simd8 b) {
#if defined(__AVX512VL__) && defined(__AVX512DQ__)
    return _mm256_range_ps(a, b, 11);
#else
    return simd8_max(simd8_size(a), simd8_size(b));
#endif
}

#elif defined(__SSE2__) && !defined(GRAY_NO_SIMD)

typedef struct {
    __m128 low, high;
} simd8;

#define simd8_lane(a, i) simd8_all_of(_mm_shuffle_ps(a, a, (i)*0x55))
static inline simd8 simd8_all_of(simd4 a) {
    return (simd8){a, a};
}

static inline simd8 simd8_load(const float *p) {
    return (simd8){_mm_load_ps(p), _mm_load_ps(p + 4)};
}
static inline float simd8_first(simd8 a) {
    return _mm_cvtss_f32(a.low);
}
static inline simd4 simd8_low(simd8 a) {
    return a.low;
}
static inline simd4 simd8_high(simd8 a) {
    return a.high;
}
static inline simd8 simd8_largest_of_threes(simd8 a) {
    return (simd8){_mm_set_ss(simd4_largest_of_three(a.low)), _mm_set_ss(simd4_largest_of_three(a.high))};
}
static inline simd8 simd8_of(simd4 low, simd4 high) {
    return (simd8){low, high};
}
static inline int simd8_all_within(simd8 a, const float *from, const float *to) {
    __m128 low = _mm_and_ps(_mm_cmpge_ps(a.low, _mm_loadu_ps(from)), _mm_cmplt_ps(a.low, _mm_loadu_ps(to)));
    __m128 high = _mm_and_ps(_mm_cmpge_ps(a.high, _mm_loadu_ps(from + 4)), _mm_cmplt_ps(a.high, _mm_loadu_ps(to + 4)));
    return _mm_movemask_ps(_mm_and_ps(low, high)) == 15;
}
static inline void simd8_store(float *p, simd8 a) {
    _mm_store_ps(p, a.low);
    _mm_store_ps(p + 4, a.high);
}
static inline simd8 simd8_all(float x) {
    return (simd8){_mm_set1_ps(x), _mm_set1_ps(x)};
}
static inline simd8 simd8_add(simd8 a, simd8 b) {
    return (simd8){_mm_add_ps(a.low, b.low), _mm_add_ps(a.high, b.high)};
}
static inline simd8 simd8_sub(simd8 a, simd8 b) {
    return (simd8){_mm_sub_ps(a.low, b.low), _mm_sub_ps(a.high, b.high)};
}
static inline simd8 simd8_mul(simd8 a, simd8 b) {
    return (simd8){_mm_mul_ps(a.low, b.low), _mm_mul_ps(a.high, b.high)};
}
static inline simd8 simd8_div(simd8 a, simd8 b) {
    return (simd8){_mm_div_ps(a.low, b.low), _mm_div_ps(a.high, b.high)};
}
static inline simd8 simd8_min(simd8 a, simd8 b) {
    return (simd8){_mm_min_ps(a.low, b.low), _mm_min_ps(a.high, b.high)};
}
static inline simd8 simd8_max(simd8 a, simd8 b) {
    return (simd8){_mm_max_ps(a.low, b.low), _mm_max_ps(a.high, b.high)};
}
static inline unsigned simd8_at_max(simd8 a, simd8 b) {
    return (unsigned)_mm_movemask_ps(_mm_cmple_ps(a.low, b.low)) |
           (unsigned)_mm_movemask_ps(_mm_cmple_ps(a.high, b.high)) << 4;
}
static inline unsigned simd8_negative(simd8 a) {
    return (unsigned)_mm_movemask_ps(a.low) | (unsigned)_mm_movemask_ps(a.high) << 4;
}
static inline simd8 simd8_sign(simd8 a) {
    __m128 sign = _mm_set1_ps(-0.0f);
    return (simd8){_mm_and_ps(a.low, sign), _mm_and_ps(a.high, sign)};
}
static inline simd8 simd8_size(simd8 a) {
    __m128 sign = _mm_set1_ps(-0.0f);
    return (simd8){_mm_andnot_ps(sign, a.low), _mm_andnot_ps(sign, a.high)};
}
static inline simd8 simd8_flip(simd8 a, simd8 sign) {
    return (simd8){_mm_xor_ps(a.low, sign.low), _mm_xor_ps(a.high, sign.high)};
}

#else

typedef struct {
    float lane[8];
} simd8;

#define simd8_lane(a, i) simd8_all((a).lane[i])

static inline simd8 simd8_load(const float *p) {
    simd8 a;
    for (int i = 0; i < 8; i++)
        a.lane[i] = p[i];
    return a;
}
static inline float simd8_first(simd8 a) {
    return a.lane[0];
}
static inline simd4 simd8_low(simd8 a) {
    return simd4_load(a.lane);
}
static inline simd4 simd8_high(simd8 a) {
    return simd4_load(a.lane + 4);
}
static inline simd8 simd8_largest_of_threes(simd8 a) {
    a.lane[0] = simd4_largest_of_three(simd8_low(a));
    a.lane[4] = simd4_largest_of_three(simd8_high(a));
    return a;
}
static inline simd8 simd8_of(simd4 low, simd4 high) {
    simd8 a;
    for (int i = 0; i < 8; i++)
        a.lane[i] = i < 4 ? low.lane[i] : high.lane[i - 4];
    return a;
}
static inline int simd8_all_within(simd8 a, const float *from, const float *to) {
    int inside = 0;
    for (int i = 0; i < 8; i++)
        inside += a.lane[i] >= from[i] && a.lane[i] < to[i];
    return inside == 8;
}
static inline void simd8_store(float *p, simd8 a) {
    for (int i = 0; i < 8; i++)
        p[i] = a.lane[i];
}
static inline simd8 simd8_all(float x) {
    simd8 a;
    for (int i = 0; i < 8; i++)
        a.lane[i] = x;
    return a;
}
#define SIMD8_EACH(name, expression)                                                                                   \
    static inline simd8 name(simd8 a, simd8 b) {                                                                       \
        simd8 c;                                                                                                       \
        for (int i = 0; i < 8; i++) {                                                                                  \
            float x = a.lane[i], y = b.lane[i];                                                                        \
            c.lane[i] = expression;                                                                                    \
        }                                                                                                              \
        return c;                                                                                                      \
    }
SIMD8_EACH(simd8_add, x + y)
SIMD8_EACH(simd8_sub, x - y)
SIMD8_EACH(simd8_mul, x *y)
SIMD8_EACH(simd8_div, x / y)
SIMD8_EACH(simd8_min, x < y ? x : y)
SIMD8_EACH(simd8_max, x > y ? x : y)
SIMD8_EACH(simd8_flip, signbit(y) ? -x : x)
static inline simd8 simd8_sign(simd8 a) {
    for (int i = 0; i < 8; i++)
        a.lane[i] = signbit(a.lane[i]) ? -0.0f : 0.0f;
    return a;
}
static inline simd8 simd8_size(simd8 a) {
    for (int i = 0; i < 8; i++)
        a.lane[i] = fabsf(a.lane[i]);
    return a;
}
static inline unsigned simd8_negative(simd8 a) {
    unsigned bits = 0;
    for (int i = 0; i < 8; i++)
        bits |= (unsigned)(signbit(a.lane[i]) != 0) << i;
    return bits;
}
static inline unsigned simd8_at_max(simd8 a, simd8 b) {
    unsigned bits = 0;
    for (int i = 0; i < 8; i++)
        bits |= (unsigned)(a.lane[i] <= b.lane[i]) << i;
    return bits;
}
#endif

static inline unsigned simd8_not_negative(simd8 a) {
    return simd8_negative(a) ^ 255u;
}

/* One lane, with an index known only at run time. */
static inline float simd8_pick(simd8 a, unsigned lane) {
    _Alignas(32) float all[8];
    simd8_store(all, a);
    return all[lane];
}

#if !defined(__AVX__) || defined(GRAY_NO_SIMD)
static inline simd8 simd8_max_size(simd8 a, simd8 b) {
    return simd8_max(simd8_size(a), simd8_size(b));
}
#endif

#if !defined(__AVX2__) || defined(GRAY_NO_SIMD)
static inline simd8 simd8_min_bits(simd8 a, simd8 b) {
    return simd8_min(a, b);
}
static inline simd8 simd8_max_bits(simd8 a, simd8 b) {
    return simd8_max(a, b);
}
static inline simd8 simd8_latest_bits(simd8 a, simd8 b, simd8 c) {
    return simd8_max(simd8_max(a, b), simd8_max(c, simd8_all(0)));
}
static inline unsigned simd8_at_max_bits(simd8 a, simd8 b) {
    return simd8_at_max(a, b);
}
#endif

/* Four doubles, to transform a ray into local space. */
#if defined(__AVX2__) && !defined(GRAY_NO_SIMD)

typedef __m256d wide4;

static inline wide4 wide4_load(const double *p) {
    return _mm256_loadu_pd(p);
}
static inline wide4 wide4_make(double x, double y, double z, double w) {
    return _mm256_setr_pd(x, y, z, w);
}
static inline wide4 wide4_all(double x) {
    return _mm256_set1_pd(x);
}
static inline wide4 wide4_add(wide4 a, wide4 b) {
    return _mm256_add_pd(a, b);
}
static inline wide4 wide4_sub(wide4 a, wide4 b) {
    return _mm256_sub_pd(a, b);
}
static inline wide4 wide4_mul(wide4 a, wide4 b) {
    return _mm256_mul_pd(a, b);
}
static inline wide4 wide4_div(wide4 a, wide4 b) {
    return _mm256_div_pd(a, b);
}
static inline wide4 wide4_min(wide4 a, wide4 b) {
    return _mm256_min_pd(a, b);
}
static inline wide4 wide4_max(wide4 a, wide4 b) {
    return _mm256_max_pd(a, b);
}
static inline wide4 wide4_size(wide4 a) {
    return _mm256_andnot_pd(_mm256_set1_pd(-0.0), a);
}
/* The size of a with the sign of b. */
static inline wide4 wide4_signed(wide4 a, wide4 b) {
    return _mm256_or_pd(a, _mm256_and_pd(_mm256_set1_pd(-0.0), b));
}
/* Three numbers, and 0 in lane 3. */
static inline wide4 wide4_load_three(const double *p) {
#if defined(__AVX512VL__)
    return _mm256_maskz_loadu_pd(7, p);
#else
    return _mm256_maskload_pd(p, _mm256_setr_epi64x(-1, -1, -1, 0));
#endif
}
/* The same, number by number: the caller has just stored them one by one, and a wider load would wait for the stores.
 * `volatile` keeps the compiler from joining the loads. */
static inline wide4 wide4_load_singly(const double *p) {
    __m128d low = _mm_load_sd(p);
    __asm__("" : "+x"(low));
    return _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadh_pd(low, p + 1)), _mm_load_sd(p + 2), 1);
}
/* Lanes in another order: `halves` is the source of each half of the four. */
static inline wide4 wide4_permuted(wide4 a, const uint32_t halves[8]) {
    __m256i order = _mm256_load_si256((const __m256i *)(const void *)halves);
    return _mm256_castps_pd(_mm256_permutevar8x32_ps(_mm256_castpd_ps(a), order));
}
/* Lane 2 in all. */
static inline wide4 wide4_third(wide4 a) {
    return _mm256_permute4x64_pd(a, _MM_SHUFFLE(2, 2, 2, 2));
}
/* Lanes 0, 1 and 2 of three vectors, each in a separate vector; lane 3 is undefined. For the last one, lanes 3 and 2 of
 * the vectors must be equal. */
static inline wide4 wide4_firsts(wide4 a, wide4 b, wide4 c) {
    return _mm256_insertf128_pd(_mm256_unpacklo_pd(a, b), _mm256_castpd256_pd128(c), 1);
}
static inline wide4 wide4_seconds(wide4 a, wide4 b, wide4 c) {
    __m128d turned = _mm_permute_pd(_mm256_castpd256_pd128(c), 1);
    return _mm256_insertf128_pd(_mm256_unpackhi_pd(a, b), turned, 1);
}
static inline wide4 wide4_thirds(wide4 a, wide4 b, wide4 c) {
    return _mm256_permute2f128_pd(_mm256_unpacklo_pd(a, b), c, 0x31);
}
static inline wide4 wide4_with_last_two(wide4 a, double last) {
    return _mm256_blend_pd(a, _mm256_set1_pd(last), 12);
}
static inline wide4 wide4_with_first_of(wide4 a, wide4 first) {
    return _mm256_blend_pd(a, first, 1);
}
/* (b0 + b1) + b2 in lane 0, followed by a1 and a2, all divided by (a0 + a1) + a2. */
static inline wide4 wide4_weighted(wide4 a, wide4 b) {
    __m128d a_low = _mm256_castpd256_pd128(a), b_low = _mm256_castpd256_pd128(b);
    __m128d a_high = _mm256_extractf128_pd(a, 1), b_high = _mm256_extractf128_pd(b, 1);
    __m128d sums = _mm_add_pd(_mm_add_pd(_mm_unpacklo_pd(a_low, b_low), _mm_unpackhi_pd(a_low, b_low)),
                              _mm_unpacklo_pd(a_high, b_high));
    __m256d over = _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_shuffle_pd(sums, a_low, 3)), a_high, 1);
    return _mm256_div_pd(over, _mm256_broadcastsd_pd(sums));
}
/* Lane 3 replaced. */
static inline wide4 wide4_with_last(wide4 a, double last) {
    return _mm256_blend_pd(a, _mm256_set1_pd(last), 8);
}
/* Bit 0: lane 1 is larger than lane 0; bit 1: lane 2 is larger than both. */
static inline unsigned wide4_larger(wide4 a) {
    __m256d next = _mm256_permute4x64_pd(a, _MM_SHUFFLE(3, 3, 2, 1)),
            before = _mm256_unpacklo_pd(a, _mm256_max_pd(a, next));
    return (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(before, next, _CMP_LT_OQ)) & 3;
}
static inline double wide4_largest(wide4 a) {
    __m128d b = _mm_max_pd(_mm256_castpd256_pd128(a), _mm256_extractf128_pd(a, 1));
    return _mm_cvtsd_f64(_mm_max_sd(b, _mm_unpackhi_pd(b, b)));
}
static inline double wide4_smallest(wide4 a) {
    __m128d b = _mm_min_pd(_mm256_castpd256_pd128(a), _mm256_extractf128_pd(a, 1));
    return _mm_cvtsd_f64(_mm_min_sd(b, _mm_unpackhi_pd(b, b)));
}
/* Whether a < b in every lane; a NaN is not. */
static inline int wide4_all_below(wide4 a, wide4 b) {
    return _mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_LT_OQ)) == 15;
}
static inline simd4 wide4_to_single(wide4 a) {
    return _mm256_cvtpd_ps(a);
}
/* Lanes 0 to 2; a fourth number may be written after them. */
static inline void wide4_store_three(double *p, wide4 a) {
    _mm256_storeu_pd(p, a);
}
/* Lanes 0, 1, 2 rotated; lane 3 stays. */
static inline wide4 wide4_cab(wide4 a) {
    return _mm256_permute4x64_pd(a, _MM_SHUFFLE(3, 1, 0, 2));
}
static inline wide4 wide4_bca(wide4 a) {
    return _mm256_permute4x64_pd(a, _MM_SHUFFLE(3, 0, 2, 1));
}
/* One bit per lane where a < b, or whose sign is set. */
static inline unsigned wide4_below(wide4 a, wide4 b) {
    return (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_LT_OQ));
}
static inline unsigned wide4_negative(wide4 a) {
    return (unsigned)_mm256_movemask_pd(a);
}

#else

typedef struct {
    double lane[4];
} wide4;

static inline wide4 wide4_load(const double *p) {
    return (wide4){{p[0], p[1], p[2], p[3]}};
}
static inline wide4 wide4_make(double x, double y, double z, double w) {
    return (wide4){{x, y, z, w}};
}
static inline wide4 wide4_all(double x) {
    return wide4_make(x, x, x, x);
}
#define WIDE4_EACH(name, expression)                                                                                   \
    static inline wide4 name(wide4 a, wide4 b) {                                                                       \
        wide4 c;                                                                                                       \
        for (int i = 0; i < 4; i++) {                                                                                  \
            double x = a.lane[i], y = b.lane[i];                                                                       \
            c.lane[i] = expression;                                                                                    \
        }                                                                                                              \
        return c;                                                                                                      \
    }
WIDE4_EACH(wide4_add, x + y)
WIDE4_EACH(wide4_sub, x - y)
WIDE4_EACH(wide4_mul, x *y)
WIDE4_EACH(wide4_div, x / y)
WIDE4_EACH(wide4_min, x < y ? x : y)
WIDE4_EACH(wide4_max, x > y ? x : y)
WIDE4_EACH(wide4_signed, copysign(x, y))
static inline wide4 wide4_size(wide4 a) {
    for (int i = 0; i < 4; i++)
        a.lane[i] = fabs(a.lane[i]);
    return a;
}
static inline wide4 wide4_with_last(wide4 a, double last) {
    a.lane[3] = last;
    return a;
}
static inline double wide4_largest(wide4 a) {
    double x = a.lane[0] > a.lane[1] ? a.lane[0] : a.lane[1], y = a.lane[2] > a.lane[3] ? a.lane[2] : a.lane[3];
    return x > y ? x : y;
}
static inline double wide4_smallest(wide4 a) {
    double x = a.lane[0] < a.lane[1] ? a.lane[0] : a.lane[1], y = a.lane[2] < a.lane[3] ? a.lane[2] : a.lane[3];
    return x < y ? x : y;
}
static inline int wide4_all_below(wide4 a, wide4 b) {
    return a.lane[0] < b.lane[0] && a.lane[1] < b.lane[1] && a.lane[2] < b.lane[2] && a.lane[3] < b.lane[3];
}
static inline simd4 wide4_to_single(wide4 a) {
    return simd4_make((float)a.lane[0], (float)a.lane[1], (float)a.lane[2], (float)a.lane[3]);
}
static inline void wide4_store_three(double *p, wide4 a) {
    for (int i = 0; i < 3; i++)
        p[i] = a.lane[i];
}
static inline wide4 wide4_load_three(const double *p) {
    return wide4_make(p[0], p[1], p[2], 0);
}
static inline wide4 wide4_load_singly(const double *p) {
    return wide4_load_three(p);
}
static inline wide4 wide4_permuted(wide4 a, const uint32_t halves[8]) {
    return wide4_make(a.lane[halves[0] / 2], a.lane[halves[2] / 2], a.lane[halves[4] / 2], a.lane[halves[6] / 2]);
}
static inline wide4 wide4_third(wide4 a) {
    return wide4_all(a.lane[2]);
}
static inline wide4 wide4_firsts(wide4 a, wide4 b, wide4 c) {
    return wide4_make(a.lane[0], b.lane[0], c.lane[0], 0);
}
static inline wide4 wide4_seconds(wide4 a, wide4 b, wide4 c) {
    return wide4_make(a.lane[1], b.lane[1], c.lane[1], 0);
}
static inline wide4 wide4_thirds(wide4 a, wide4 b, wide4 c) {
    return wide4_make(a.lane[2], b.lane[2], c.lane[2], 0);
}
static inline wide4 wide4_with_last_two(wide4 a, double last) {
    return wide4_make(a.lane[0], a.lane[1], last, last);
}
static inline wide4 wide4_with_first_of(wide4 a, wide4 first) {
    a.lane[0] = first.lane[0];
    return a;
}
static inline wide4 wide4_weighted(wide4 a, wide4 b) {
    double first = b.lane[0] + b.lane[1] + b.lane[2], sum = a.lane[0] + a.lane[1] + a.lane[2];
    return wide4_make(first / sum, a.lane[1] / sum, a.lane[2] / sum, 0);
}
static inline wide4 wide4_cab(wide4 a) {
    return wide4_make(a.lane[2], a.lane[0], a.lane[1], a.lane[3]);
}
static inline wide4 wide4_bca(wide4 a) {
    return wide4_make(a.lane[1], a.lane[2], a.lane[0], a.lane[3]);
}
static inline unsigned wide4_larger(wide4 a) {
    double largest = a.lane[1] > a.lane[0] ? a.lane[1] : a.lane[0];
    return (unsigned)(a.lane[1] > a.lane[0]) | (unsigned)(a.lane[2] > largest) << 1;
}
static inline unsigned wide4_below(wide4 a, wide4 b) {
    unsigned bits = 0;
    for (int i = 0; i < 4; i++)
        bits |= (unsigned)(a.lane[i] < b.lane[i]) << i;
    return bits;
}
static inline unsigned wide4_negative(wide4 a) {
    unsigned bits = 0;
    for (int i = 0; i < 4; i++)
        bits |= (unsigned)(signbit(a.lane[i]) != 0) << i;
    return bits;
}
#endif

/* a * b - c and a * b + c */
static inline simd8 simd8_multiply_sub(simd8 a, simd8 b, simd8 c) {
#if defined(GRAY_KERNEL_FMA) && !defined(GRAY_NO_SIMD)
    return _mm256_fmsub_ps(a, b, c);
#else
    return simd8_sub(simd8_mul(a, b), c);
#endif
}
static inline simd8 simd8_multiply_add(simd8 a, simd8 b, simd8 c) {
#if defined(GRAY_KERNEL_FMA) && !defined(GRAY_NO_SIMD)
    return _mm256_fmadd_ps(a, b, c);
#else
    return simd8_add(simd8_mul(a, b), c);
#endif
}

#endif
