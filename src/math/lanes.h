/* Vectors of numbers in the vector types of gcc and clang: one text for SSE2, AVX2, AVX-512, NEON, and for processors
 * without vectors, for which the compiler takes these types apart. A type that is longer than the processor's vectors
 * is a pair of halves, since compilers keep longer vector types in memory.
 *
 * All types have functions of the same names: NAME_add of lanes, NAME_load from an address with the alignment of the
 * type, NAME_load_any from any other. Comparisons give a NAME_mask, which is false for NaN and of which NAME_bits has
 * one bit a lane. Minimum and maximum give their second operand if one is NaN or both are equal. Every operation has
 * the same bits on every processor except multiply_add and multiply_sub, which may round once or twice: nothing exact
 * may depend on them.
 *
 * Intrinsics stand where no expression of both compilers becomes the instruction: vectors have no `?:` in C, masks make
 * four instructions of a minimum, loops over lanes are vectorised by one compiler or the other, and constants of `&`
 * come through a general register. */
#ifndef GRAY_MATH_LANES_H
#define GRAY_MATH_LANES_H

#include <math.h>
#include <stdint.h>

/* What the file is compiled for. GRAY_NO_SIMD: as for a processor without vectors. */
#if defined(__SSE2__) && !defined(GRAY_NO_SIMD)
#define LANES_X86
#if defined(__AVX2__)
#include <immintrin.h>
#define LANES_AVX2
#else
#include <emmintrin.h> /* the other takes as long to compile as many a file of gray */
#endif
#if defined(__AVX512VL__) && defined(__AVX512DQ__) && defined(__AVX512BW__)
#define LANES_AVX512
#endif
#elif defined(__aarch64__) && !defined(GRAY_NO_SIMD)
#include <arm_neon.h>
#define LANES_NEON
#endif
#if defined(LANES_NEON) || (defined(LANES_X86) && defined(__FMA__))
#define LANES_FUSED
#endif

#define LANES_DEFINE(result, function, parameters, ...)                                                                \
    static inline result function parameters {                                                                         \
        return __VA_ARGS__;                                                                                            \
    }

#define LANES_STORE(function, parameters, ...)                                                                         \
    static inline void function parameters {                                                                           \
        __VA_ARGS__;                                                                                                   \
    }

/* ---- types of the length of the processor's vectors ---- */

/* `x86` and `suffix` are the beginning and the end of the names of intrinsics. */
#define LANES_VECTOR(name, element, integer, bytes, x86, suffix)                                                       \
    typedef element name __attribute__((vector_size(bytes)));                                                          \
    typedef integer name##_integers __attribute__((vector_size(bytes)));                                               \
    typedef name name##_aligned __attribute__((may_alias));                                                            \
    typedef name name##_anywhere __attribute__((may_alias, aligned(sizeof(element))));                                 \
    LANES_DEFINE(name, name##_load, (const element *p), *(const name##_aligned *)(const void *)p)                      \
    LANES_DEFINE(name, name##_load_any, (const element *p), *(const name##_anywhere *)(const void *)p)                 \
    LANES_STORE(name##_store, (element * p, name a), *(name##_aligned *)(void *)p = a)                                 \
    LANES_STORE(name##_store_any, (element * p, name a), *(name##_anywhere *)(void *)p = a)                            \
    /* A difference: the sum of -0 and 0 would be 0. */                                                                \
    LANES_DEFINE(name, name##_all, (element x), x - (name){0})                                                         \
    LANES_DEFINE(name, name##_add, (name a, name b), a + b)                                                            \
    LANES_DEFINE(name, name##_sub, (name a, name b), a - b)                                                            \
    LANES_DEFINE(name, name##_mul, (name a, name b), a *b)                                                             \
    LANES_DEFINE(name, name##_div, (name a, name b), a / b)                                                            \
    LANES_DEFINE(name, name##_sign, (name a),                                                                          \
                 LANES_OR(x86##_and_##suffix(a, name##_all(-0.0f)),                                                    \
                          (name)((name##_integers)a & (name##_integers)name##_all(-0.0f))))                            \
    LANES_DEFINE(name, name##_size, (name a),                                                                          \
                 LANES_OR(x86##_andnot_##suffix(name##_all(-0.0f), a),                                                 \
                          (name)((name##_integers)a & ~(name##_integers)name##_all(-0.0f))))                           \
    LANES_DEFINE(name, name##_flip, (name a, name sign),                                                               \
                 LANES_OR(x86##_xor_##suffix(a, sign), (name)((name##_integers)a ^ (name##_integers)sign)))            \
    LANES_MASKS##x86(name, suffix) LANES_DEFINE(unsigned, name##_negative, (name a), name##_bits(name##_mask_of(a)))   \
        LANES_DEFINE(name, name##_min, (name a, name b),                                                               \
                     LANES_OR(x86##_min_##suffix(a, b), name##_choose(a < b, a, b)))                                   \
            LANES_DEFINE(name, name##_max, (name a, name b),                                                           \
                         LANES_OR(x86##_max_##suffix(a, b), name##_choose(a > b, a, b)))

/* Masks that are vectors of integers: -1 for true, and `of_mask` and `mask_of` change nothing. */
#define LANES_INTEGER_MASKS(name)                                                                                      \
    typedef name##_integers name##_mask;                                                                               \
    LANES_DEFINE(name##_mask, name##_both, (name##_mask a, name##_mask b), a &b)                                       \
    LANES_DEFINE(name##_mask, name##_mask_of, (name truth), (name##_mask)truth)                                        \
    LANES_DEFINE(name, name##_of_mask, (name##_mask m), (name)m)
#define LANES_COMPARE_AND_CHOOSE(name)                                                                                 \
    LANES_DEFINE(name##_mask, name##_less, (name a, name b), a < b)                                                    \
    LANES_DEFINE(name##_mask, name##_less_equal, (name a, name b), a <= b)                                             \
    LANES_DEFINE(name, name##_choose, (name##_mask m, name a, name b),                                                 \
                 (name)((m & (name##_mask)a) | (~m & (name##_mask)b)))

#if defined(LANES_X86)

#define LANES_OR(intrinsic, text) intrinsic
#define LANES_MASKS_mm(name, suffix)                                                                                   \
    LANES_INTEGER_MASKS(name)                                                                                          \
    LANES_COMPARE_AND_CHOOSE(name)                                                                                     \
    LANES_DEFINE(name##_mask, name##_unordered, (name a, name b), (name##_mask)_mm_cmpunord_##suffix(a, b))            \
    LANES_DEFINE(unsigned, name##_bits, (name##_mask m), (unsigned)_mm_movemask_##suffix((name)m))
#define LANES_MASKS_mm256(name, suffix)                                                                                \
    LANES_INTEGER_MASKS(name)                                                                                          \
    /* In `<` of vectors a NaN raises an exception: no trap, but the Mandelbrot set in bench/expr took 5 to 19 %       \
     * longer. */                                                                                                      \
    LANES_DEFINE(name##_mask, name##_less, (name a, name b), (name##_mask)_mm256_cmp_##suffix(a, b, _CMP_LT_OQ))       \
    LANES_DEFINE(name##_mask, name##_less_equal, (name a, name b), (name##_mask)_mm256_cmp_##suffix(a, b, _CMP_LE_OQ)) \
    LANES_DEFINE(name##_mask, name##_unordered, (name a, name b),                                                      \
                 (name##_mask)_mm256_cmp_##suffix(a, b, _CMP_UNORD_Q))                                                 \
    LANES_DEFINE(name, name##_choose, (name##_mask m, name a, name b), _mm256_blendv_##suffix(b, a, (name)m))          \
    LANES_DEFINE(unsigned, name##_bits, (name##_mask m), (unsigned)_mm256_movemask_##suffix((name)m))

#define LANES_BITS_ps(a) _mm512_movepi32_mask((__m512i)(a))
#define LANES_BITS_pd(a) _mm512_movepi64_mask((__m512i)(a))
#define LANES_TRUTH_ps(m) (__m512) _mm512_movm_epi32(m)
#define LANES_TRUTH_pd(m) (__m512d) _mm512_movm_epi64(m)
#define LANES_MASKS_mm512(name, suffix)                                                                                \
    typedef __typeof__(_mm512_cmp_##suffix##_mask((name){0}, (name){0}, 0)) name##_mask;                               \
    LANES_DEFINE(name##_mask, name##_less, (name a, name b), _mm512_cmp_##suffix##_mask(a, b, _CMP_LT_OQ))             \
    LANES_DEFINE(name##_mask, name##_less_equal, (name a, name b), _mm512_cmp_##suffix##_mask(a, b, _CMP_LE_OQ))       \
    LANES_DEFINE(name##_mask, name##_unordered, (name a, name b), _mm512_cmp_##suffix##_mask(a, b, _CMP_UNORD_Q))      \
    LANES_DEFINE(name##_mask, name##_both, (name##_mask a, name##_mask b), (name##_mask)(a & b))                       \
    LANES_DEFINE(name##_mask, name##_mask_of, (name truth), LANES_BITS_##suffix(truth))                                \
    LANES_DEFINE(name, name##_of_mask, (name##_mask m), LANES_TRUTH_##suffix(m))                                       \
    LANES_DEFINE(name, name##_choose, (name##_mask m, name a, name b), _mm512_mask_blend_##suffix(m, b, a))            \
    LANES_DEFINE(unsigned, name##_bits, (name##_mask m), m)

#else

#define LANES_OR(intrinsic, text) text
#define LANES_MASKS_mm(name, suffix)                                                                                   \
    LANES_INTEGER_MASKS(name)                                                                                          \
    LANES_COMPARE_AND_CHOOSE(name)                                                                                     \
    LANES_DEFINE(name##_mask, name##_unordered, (name a, name b), (a != a) | (b != b))                                 \
    static inline unsigned name##_bits(name##_mask m) {                                                                \
        unsigned bits = 0;                                                                                             \
        for (unsigned i = 0; i < sizeof m / sizeof m[0]; i++)                                                          \
            bits |= (unsigned)(m[i] < 0) << i;                                                                         \
        return bits;                                                                                                   \
    }

#endif

LANES_VECTOR(float4, float, int32_t, 16, _mm, ps)
LANES_VECTOR(double2, double, int64_t, 16, _mm, pd)

#if defined(LANES_X86) && defined(LANES_FUSED)
#define LANES_MULTIPLY_ADD(name, x86) x86##_fmadd_ps(a, b, c)
#define LANES_MULTIPLY_SUB(name, x86) x86##_fmsub_ps(a, b, c)
#elif defined(LANES_FUSED)
#define LANES_MULTIPLY_ADD(name, x86) vfmaq_f32(c, a, b)
#define LANES_MULTIPLY_SUB(name, x86) vfmaq_f32(-c, a, b)
#else
#define LANES_MULTIPLY_ADD(name, x86) a *b + c
#define LANES_MULTIPLY_SUB(name, x86) a *b - c
#endif
#define LANES_PRODUCTS(name, x86)                                                                                      \
    LANES_DEFINE(name, name##_multiply_add, (name a, name b, name c), LANES_MULTIPLY_ADD(name, x86))                   \
    LANES_DEFINE(name, name##_multiply_sub, (name a, name b, name c), LANES_MULTIPLY_SUB(name, x86))
LANES_PRODUCTS(float4, _mm)

/* ---- types of twice that length ---- */

#if defined(LANES_NEON)
/* Both halves before the sum over lanes. */
static inline unsigned lanes_float4_bits(float4_mask low, float4_mask high) {
    const int16_t lane[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    uint16x8_t signs = vshrq_n_u16(vuzp2q_u16((uint16x8_t)low, (uint16x8_t)high), 15);
    return vaddvq_u16(vshlq_u16(signs, vld1q_s16(lane)));
}
#else
#define lanes_float4_bits(low, high) float4_bits(low) | float4_bits(high) << 4
#endif
#define lanes_double2_bits(low, high) double2_bits(low) | double2_bits(high) << 2

#define LANES_EACH(name, half, operation)                                                                              \
    LANES_DEFINE(name, name##_##operation, (name a, name b),                                                           \
                 (name){half##_##operation(a.low, b.low), half##_##operation(a.high, b.high)})
#define LANES_EACH_MASK(name, half, operation, of)                                                                     \
    LANES_DEFINE(name##_mask, name##_##operation, (of a, of b),                                                        \
                 (name##_mask){half##_##operation(a.low, b.low), half##_##operation(a.high, b.high)})
#define LANES_PAIR(name, element, half, count)                                                                         \
    typedef struct {                                                                                                   \
        half low, high;                                                                                                \
    } name;                                                                                                            \
    typedef struct {                                                                                                   \
        half##_mask low, high;                                                                                         \
    } name##_mask;                                                                                                     \
    LANES_DEFINE(name, name##_load, (const element *p), (name){half##_load(p), half##_load(p + (count) / 2)})          \
    LANES_DEFINE(name, name##_load_any, (const element *p),                                                            \
                 (name){half##_load_any(p), half##_load_any(p + (count) / 2)})                                         \
    LANES_STORE(name##_store, (element * p, name a), half##_store(p, a.low), half##_store(p + (count) / 2, a.high))    \
    LANES_STORE(name##_store_any, (element * p, name a), half##_store_any(p, a.low),                                   \
                half##_store_any(p + (count) / 2, a.high))                                                             \
    LANES_DEFINE(name, name##_all, (element x), (name){half##_all(x), half##_all(x)})                                  \
    LANES_EACH(name, half, add)                                                                                        \
    LANES_EACH(name, half, sub)                                                                                        \
    LANES_EACH(name, half, mul)                                                                                        \
    LANES_EACH(name, half, div)                                                                                        \
    LANES_EACH(name, half, min)                                                                                        \
    LANES_EACH(name, half, max)                                                                                        \
    LANES_EACH(name, half, flip)                                                                                       \
    LANES_DEFINE(name, name##_sign, (name a), (name){half##_sign(a.low), half##_sign(a.high)})                         \
    LANES_DEFINE(name, name##_size, (name a), (name){half##_size(a.low), half##_size(a.high)})                         \
    LANES_EACH_MASK(name, half, less, name)                                                                            \
    LANES_EACH_MASK(name, half, less_equal, name)                                                                      \
    LANES_EACH_MASK(name, half, both, name##_mask)                                                                     \
    LANES_DEFINE(unsigned, name##_bits, (name##_mask m), lanes_##half##_bits(m.low, m.high))                           \
    LANES_DEFINE(unsigned, name##_negative, (name a),                                                                  \
                 lanes_##half##_bits(half##_mask_of(a.low), half##_mask_of(a.high)))                                   \
    LANES_DEFINE(name, name##_of, (half low, half high), (name){low, high})                                            \
    LANES_DEFINE(half, name##_low, (name a), a.low)                                                                    \
    LANES_DEFINE(half, name##_high, (name a), a.high)
#define LANES_PAIR_PRODUCTS(name, half)                                                                                \
    LANES_DEFINE(name, name##_multiply_add, (name a, name b, name c),                                                  \
                 (name){half##_multiply_add(a.low, b.low, c.low), half##_multiply_add(a.high, b.high, c.high)})        \
    LANES_DEFINE(name, name##_multiply_sub, (name a, name b, name c),                                                  \
                 (name){half##_multiply_sub(a.low, b.low, c.low), half##_multiply_sub(a.high, b.high, c.high)})

#if defined(LANES_AVX2)
#define LANES_HALVES(name, half, suffix)                                                                               \
    LANES_DEFINE(name, name##_of, (half low, half high),                                                               \
                 _mm256_insertf128_##suffix(_mm256_cast##suffix##128_##suffix##256(low), high, 1))                     \
    LANES_DEFINE(half, name##_low, (name a), _mm256_cast##suffix##256_##suffix##128(a))                                \
    LANES_DEFINE(half, name##_high, (name a), _mm256_extractf128_##suffix(a, 1))
LANES_VECTOR(float8, float, int32_t, 32, _mm256, ps)
LANES_PRODUCTS(float8, _mm256)
LANES_HALVES(float8, float4, ps)
LANES_VECTOR(double4, double, int64_t, 32, _mm256, pd)
LANES_HALVES(double4, double2, pd)
#define double4_lane(a, i) (a)[i]
#else
LANES_PAIR(float8, float, float4, 8)
LANES_PAIR_PRODUCTS(float8, float4)
LANES_PAIR(double4, double, double2, 4)
#define double4_lane(a, i) ((i) < 2 ? (a).low[(i)&1] : (a).high[(i)&1])
#endif

static inline double4 double4_make(double x, double y, double z, double w) {
    return double4_of((double2){x, y}, (double2){z, w});
}

/* Lanes of two vectors, by constants from 0 to 7, of which 4 to 7 are those of b. */
#if defined(LANES_AVX2)
#define double4_shuffle(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#else
#define lanes_of_two(a, b, i) ((i) < 4 ? double4_lane(a, i) : double4_lane(b, (i)-4))
#define double4_shuffle(a, b, i, j, k, l)                                                                              \
    double4_make(lanes_of_two(a, b, i), lanes_of_two(a, b, j), lanes_of_two(a, b, k), lanes_of_two(a, b, l))
#endif

/* ---- as many lanes as the processor has ---- */

/* At least eight floats, and at least two doubles. */
#if defined(LANES_AVX512)
enum { FLOAT_LANES = 16, DOUBLE_LANES = 8 };
LANES_VECTOR(float_lanes, float, int32_t, 64, _mm512, ps)
LANES_PRODUCTS(float_lanes, _mm512)
LANES_VECTOR(double_lanes, double, int64_t, 64, _mm512, pd)
#elif defined(LANES_AVX2)
enum { FLOAT_LANES = 8, DOUBLE_LANES = 4 };
LANES_VECTOR(float_lanes, float, int32_t, 32, _mm256, ps)
LANES_PRODUCTS(float_lanes, _mm256)
LANES_VECTOR(double_lanes, double, int64_t, 32, _mm256, pd)
#else
enum { FLOAT_LANES = 8, DOUBLE_LANES = 2 };
LANES_PAIR(float_lanes, float, float4, 8)
LANES_PAIR_PRODUCTS(float_lanes, float4)
LANES_VECTOR(double_lanes, double, int64_t, 16, _mm, pd)
#endif

/* A mask from one bit a lane; further bits do not matter. */
static inline double_lanes_mask double_lanes_mask_of_bits(uint64_t bits) {
#if defined(LANES_AVX512)
    return (double_lanes_mask)bits;
#else
    const double_lanes_integers lane = {
        1,
        2
#if defined(LANES_AVX2)
        ,
        4,
        8
#endif
    };
    return (((int64_t)bits - (double_lanes_integers){0}) & lane) == lane;
#endif
}

#if defined(LANES_AVX512)
#define LANES_WHOLE(x86, neon, function) _mm512_##x86(a)
#elif defined(LANES_AVX2)
#define LANES_WHOLE(x86, neon, function) _mm256_##x86(a)
#elif defined(LANES_NEON)
#define LANES_WHOLE(x86, neon, function) neon(a)
#else
#define LANES_WHOLE(x86, neon, function)                                                                               \
    (double_lanes) {                                                                                                   \
        function(a[0]), function(a[1])                                                                                 \
    }
#endif
LANES_DEFINE(double_lanes, double_lanes_root, (double_lanes a), LANES_WHOLE(sqrt_pd, vsqrtq_f64, sqrt))
LANES_DEFINE(double_lanes, double_lanes_floor, (double_lanes a), LANES_WHOLE(floor_pd, vrndmq_f64, floor))
LANES_DEFINE(double_lanes, double_lanes_ceil, (double_lanes a), LANES_WHOLE(ceil_pd, vrndpq_f64, ceil))

#endif
