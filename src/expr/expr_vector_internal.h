/* Vectors of doubles of the instruction set that the including file is compiled for, for the evaluators of bounds. */
#ifndef GRAY_EXPR_EXPR_VECTOR_INTERNAL_H
#define GRAY_EXPR_EXPR_VECTOR_INTERNAL_H

#include <float.h>
#include <math.h>
#include <stdint.h>

#if defined(__AVX512F__)
#include <immintrin.h>
typedef __m512d vector;
enum { WIDTH = 8 };
#define LOAD(p) _mm512_load_pd(p)
#define STORE(p, v) _mm512_store_pd(p, v)
#define LOAD_ANY(p) _mm512_loadu_pd(p) /* with any alignment */
#define STORE_ANY(p, v) _mm512_storeu_pd(p, v)
#define ALL(x) _mm512_set1_pd(x)
#define MIN_OF(a, b) _mm512_min_pd(a, b)
#define MAX_OF(a, b) _mm512_max_pd(a, b)
#define ROOT_OF(a) _mm512_sqrt_pd(a)
#define SIZE_OF(a) _mm512_abs_pd(a)
#define FLOOR_OF(a) _mm512_floor_pd(a)
#define CEIL_OF(a) _mm512_ceil_pd(a)
#define CHOOSE(mask, a, b) _mm512_mask_blend_pd((__mmask8)(mask), b, a)
typedef __mmask8 lanes_mask;
#define LESS(a, b) _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ)
#define LESS_EQUAL(a, b) _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ)
#define NAN_LANES(a) _mm512_cmp_pd_mask(a, a, _CMP_UNORD_Q)
#define BOTH(a, b) (lanes_mask)((a) & (b))
#define PICK(mask, a, b) _mm512_mask_blend_pd(mask, b, a)
#define BITS(mask) (uint64_t)(mask)
#elif defined(__AVX2__)
#include <immintrin.h>
typedef __m256d vector;
enum { WIDTH = 4 };
#define LOAD(p) _mm256_load_pd(p)
#define STORE(p, v) _mm256_store_pd(p, v)
#define LOAD_ANY(p) _mm256_loadu_pd(p) /* with any alignment */
#define STORE_ANY(p, v) _mm256_storeu_pd(p, v)
#define ALL(x) _mm256_set1_pd(x)
#define MIN_OF(a, b) _mm256_min_pd(a, b)
#define MAX_OF(a, b) _mm256_max_pd(a, b)
#define ROOT_OF(a) _mm256_sqrt_pd(a)
#define SIZE_OF(a) _mm256_andnot_pd(_mm256_set1_pd(-0.0), a)
#define FLOOR_OF(a) _mm256_floor_pd(a)
#define CEIL_OF(a) _mm256_ceil_pd(a)
#define CHOOSE(mask, a, b) choose_lanes(mask, a, b)
typedef __m256d lanes_mask;
#define LESS(a, b) _mm256_cmp_pd(a, b, _CMP_LT_OQ)
#define LESS_EQUAL(a, b) _mm256_cmp_pd(a, b, _CMP_LE_OQ)
#define NAN_LANES(a) _mm256_cmp_pd(a, a, _CMP_UNORD_Q)
#define BOTH(a, b) _mm256_and_pd(a, b)
#define PICK(mask, a, b) _mm256_blendv_pd(b, a, mask)
#define BITS(mask) (uint64_t) _mm256_movemask_pd(mask)
static inline vector choose_lanes(uint64_t mask, vector a, vector b) {
    const __m256i bits = _mm256_set_epi64x(8, 4, 2, 1);
    __m256i chosen = _mm256_cmpeq_epi64(_mm256_and_si256(_mm256_set1_epi64x((long long)mask), bits), bits);
    return _mm256_blendv_pd(b, a, _mm256_castsi256_pd(chosen));
}
#else
typedef double vector;
enum { WIDTH = 1 };
#define LOAD(p) (*(p))
#define STORE(p, v) (*(p) = (v))
#define ALL(x) (x)
#define MIN_OF(a, b) ((a) < (b) ? (a) : (b))
#define MAX_OF(a, b) ((a) > (b) ? (a) : (b))
#define ROOT_OF(a) sqrt(a)
#define SIZE_OF(a) fabs(a)
#define FLOOR_OF(a) floor(a)
#define CEIL_OF(a) ceil(a)
#define CHOOSE(mask, a, b) ((mask)&1 ? (a) : (b))
typedef int lanes_mask;
#define LESS(a, b) ((a) < (b))
#define LESS_EQUAL(a, b) ((a) <= (b))
#define NAN_LANES(a) ((a) != (a))
#define BOTH(a, b) ((a) & (b))
#define PICK(mask, a, b) ((mask) ? (a) : (b))
#define BITS(mask) (uint64_t)(mask)
#endif
/* Comparisons as bits, one for each lane. */
#define IS_LESS(a, b) BITS(LESS(a, b))
#define IS_LESS_EQUAL(a, b) BITS(LESS_EQUAL(a, b))
#define IS_NAN(a) BITS(NAN_LANES(a))

/* Outwards; NaN of an infinity less an infinity is refused by the comparison. */
static inline vector below(vector v) {
    return MIN_OF(v - SIZE_OF(v) * ALL(DBL_EPSILON), v);
}

static inline vector above(vector v) {
    return MAX_OF(v + SIZE_OF(v) * ALL(DBL_EPSILON), v);
}

#endif
