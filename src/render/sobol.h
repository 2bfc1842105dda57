/* Points of the unit square that fill it evenly: the first two dimensions of Sobol's sequence (S. Joe and F. Kuo,
 * "Constructing Sobol Sequences with Better Two-Dimensional Projections", 2008), scrambled after Owen by a hash
 * (B. Burley, "Practical Hash-based Owen Scrambling", JCGT 2020; the hash in the style of S. Laine and T. Karras).
 *
 * Every seed makes a scrambled (0,2)-sequence of its own, in an order of its own: of its first 2^m points each
 * elementary interval of area 2^-m holds one, and a mean over them is unbiased. So a sample takes one pair for each of
 * its decisions, with the seed of that decision ("padding"), and all decisions are independent of one another. */
#ifndef GRAY_RENDER_SOBOL_H
#define GRAY_RENDER_SOBOL_H

#include "math/sampling.h"

#include <stdint.h>

static inline uint32_t sobol_reversed(uint32_t x) {
    x = (x & UINT32_C(0x55555555)) << 1 | (x >> 1 & UINT32_C(0x55555555));
    x = (x & UINT32_C(0x33333333)) << 2 | (x >> 2 & UINT32_C(0x33333333));
    x = (x & UINT32_C(0x0f0f0f0f)) << 4 | (x >> 4 & UINT32_C(0x0f0f0f0f));
    return __builtin_bswap32(x);
}

/* Bit k of the result depends on the bits up to k of x only: on reversed bits this is Owen's scrambling. */
static inline uint32_t sobol_permuted(uint32_t x, uint32_t seed) {
    x += seed;
    x ^= x * UINT32_C(0x6c50b47c);
    x ^= x * UINT32_C(0xb82f1e52);
    x ^= x * UINT32_C(0xc7afe638);
    x ^= x * UINT32_C(0x8d22f6e6);
    return x;
}

/* The second dimension with its bits reversed; the first one is the index itself. Its direction numbers are the rows of
 * Pascal's triangle modulo 2 (primitive polynomial x + 1), and C(k, j) is odd where the bits of j are among those of k
 * (Lucas): bit j is the sum of the bits k of the index with that property. */
static inline uint32_t sobol_pascal(uint32_t index) {
    index ^= index >> 1 & UINT32_C(0x55555555);
    index ^= index >> 2 & UINT32_C(0x33333333);
    index ^= index >> 4 & UINT32_C(0x0f0f0f0f);
    index ^= index >> 8 & UINT32_C(0x00ff00ff);
    index ^= index >> 16;
    return index;
}

/* Point `index` of the sequence with that seed. */
static inline struct sample2 sobol_point(uint32_t index, uint64_t seed) {
    uint64_t more = random_mix(seed + UINT64_C(0x9e3779b97f4a7c15));
    index = sobol_reversed(sobol_permuted(sobol_reversed(index), (uint32_t)seed));
    uint32_t x = sobol_reversed(sobol_permuted(index, (uint32_t)more));
    uint32_t y = sobol_reversed(sobol_permuted(sobol_pascal(index), (uint32_t)(more >> 32)));
    return (struct sample2){(double)x * 0x1p-32, (double)y * 0x1p-32};
}

#endif
