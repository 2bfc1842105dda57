/* Random numbers as functions of indices, never of thread, order or time: value = hash(seed, stream, index, dimension).
 * The mixing function is the finaliser of splitmix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number
 * generators", OOPSLA 2014) applied once per index. */
#ifndef GRAY_BASE_RANDOM_H
#define GRAY_BASE_RANDOM_H

#include <stdint.h>

static inline uint64_t random_mix(uint64_t x) {
    x ^= x >> 30;
    x *= UINT64_C(0xbf58476d1ce4e5b9);
    x ^= x >> 27;
    x *= UINT64_C(0x94d049bb133111eb);
    x ^= x >> 31;
    return x;
}

static inline uint64_t random_combine(uint64_t key, uint64_t index) {
    return random_mix(key + UINT64_C(0x9e3779b97f4a7c15) * (index + 1));
}

/* Uniform in [0, 1), a multiple of 2^-53. */
static inline double random_unit(uint64_t bits) {
    return (double)(bits >> 11) * 0x1p-53;
}

#endif
