/* A vector of rays: sixteen floats with AVX-512, else the eight of simd_internal.h, under one set of names for the
 * packet kernel. Masks are one bit a lane. */
#ifndef GRAY_ACCEL_SIMD_RAYS_INTERNAL_H
#define GRAY_ACCEL_SIMD_RAYS_INTERNAL_H

#include "accel/simd_internal.h"

#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(GRAY_KERNEL_FMA) && !defined(GRAY_NO_SIMD)

enum { LANES = 16 };
typedef __m512 lanes;

static inline lanes lanes_load(const float *p) {
    return _mm512_load_ps(p);
}
static inline void lanes_store(float *p, lanes a) {
    _mm512_store_ps(p, a);
}
static inline lanes lanes_all(float x) {
    return _mm512_set1_ps(x);
}
static inline lanes lanes_sub(lanes a, lanes b) {
    return _mm512_sub_ps(a, b);
}
static inline lanes lanes_add(lanes a, lanes b) {
    return _mm512_add_ps(a, b);
}
static inline lanes lanes_mul(lanes a, lanes b) {
    return _mm512_mul_ps(a, b);
}
static inline lanes lanes_div(lanes a, lanes b) {
    return _mm512_div_ps(a, b);
}
static inline lanes lanes_min(lanes a, lanes b) {
    return _mm512_min_ps(a, b);
}
static inline lanes lanes_max(lanes a, lanes b) {
    return _mm512_max_ps(a, b);
}
static inline lanes lanes_multiply_add(lanes a, lanes b, lanes c) {
    return _mm512_fmadd_ps(a, b, c);
}
static inline lanes lanes_multiply_sub(lanes a, lanes b, lanes c) {
    return _mm512_fmsub_ps(a, b, c);
}
static inline unsigned lanes_at_max(lanes a, lanes b) {
    return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ);
}
static inline unsigned lanes_not_negative(lanes a) {
    return _mm512_movepi32_mask(_mm512_castps_si512(a)) ^ 0xffffu;
}
static inline lanes lanes_sign(lanes a) {
    return _mm512_and_ps(a, _mm512_set1_ps(-0.0f));
}
static inline lanes lanes_size(lanes a) {
    return _mm512_andnot_ps(_mm512_set1_ps(-0.0f), a);
}
static inline lanes lanes_flip(lanes a, lanes sign) {
    return _mm512_xor_ps(a, sign);
}
static inline float lanes_smallest(lanes a) {
    return _mm512_reduce_min_ps(a);
}
static inline float lanes_largest(lanes a) {
    return _mm512_reduce_max_ps(a);
}

#else

enum { LANES = 8 };
typedef simd8 lanes;

#define lanes_load simd8_load
#define lanes_store simd8_store
#define lanes_all simd8_all
#define lanes_sub simd8_sub
#define lanes_add simd8_add
#define lanes_mul simd8_mul
#define lanes_min simd8_min
#define lanes_max simd8_max
#define lanes_multiply_add simd8_multiply_add
#define lanes_multiply_sub simd8_multiply_sub
#define lanes_at_max simd8_at_max
#define lanes_not_negative simd8_not_negative
#define lanes_sign simd8_sign
#define lanes_size simd8_size
#define lanes_flip simd8_flip
#define lanes_div simd8_div

static inline float lanes_smallest(lanes a) {
    _Alignas(32) float x[8];
    simd8_store(x, a);
    float m = x[0];
    for (int i = 1; i < 8; i++)
        m = x[i] < m ? x[i] : m;
    return m;
}
static inline float lanes_largest(lanes a) {
    _Alignas(32) float x[8];
    simd8_store(x, a);
    float m = x[0];
    for (int i = 1; i < 8; i++)
        m = x[i] > m ? x[i] : m;
    return m;
}

#endif

/* All lanes of a group of rays. */
#define ALL_LANES ((UINT64_C(1) << LANES) - 1)

#endif
