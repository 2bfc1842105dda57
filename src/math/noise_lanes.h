/* Noise of many points at once: in a loop the compiler makes vectors of it. No branches; noise.c explains the steps. */
#ifndef GRAY_MATH_NOISE_LANES_H
#define GRAY_MATH_NOISE_LANES_H

#include "math/exact.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

/* The published permutation; and of each of its numbers the gradient: 12 bits for each coordinate from the top, which
 * are the upper bits of the coordinate as a double. */
extern const uint64_t noise_permutation[256], noise_gradient_words[256];

static inline double noise_fade(double t) {
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

static inline double noise_mix(double weight, double a, double b) {
    return a + weight * (b - a);
}

static inline double noise_ramp_lane(uint64_t at, double x, double y, double z) {
    const uint64_t upper = (uint64_t)0xfff << 52, word = noise_gradient_words[at & 255];
    return from_bits(word & upper) * x + from_bits(word << 12 & upper) * y + from_bits(word << 24 & upper) * z;
}

/* Coordinates that noise_perlin_lane may have. */
static inline bool noise_fits(double x, double y, double z) {
    return (fabs(x) < 0x1p30) & (fabs(y) < 0x1p30) & (fabs(z) < 0x1p30);
}

/* The bits of noise_perlin(x, y, z, 0). */
static inline double noise_perlin_lane(double x, double y, double z) {
    const double to_integer = 0x1.8p52; /* the sum has the integer in its lower bits */
    const uint64_t *hash = noise_permutation;
    double fx = floor(x) + to_integer, fy = floor(y) + to_integer, fz = floor(z) + to_integer;
    uint64_t i = to_bits(fx), j = to_bits(fy), k = to_bits(fz);
    x -= fx - to_integer;
    y -= fy - to_integer;
    z -= fz - to_integer;
    double u = noise_fade(x), v = noise_fade(y), w = noise_fade(z);
    uint64_t a = hash[i & 255] + j, aa = hash[a & 255] + k, ab = hash[(a + 1) & 255] + k;
    uint64_t b = hash[(i + 1) & 255] + j, ba = hash[b & 255] + k, bb = hash[(b + 1) & 255] + k;
    double near_low = noise_mix(u, noise_ramp_lane(aa, x, y, z), noise_ramp_lane(ba, x - 1, y, z));
    double near_high = noise_mix(u, noise_ramp_lane(ab, x, y - 1, z), noise_ramp_lane(bb, x - 1, y - 1, z));
    double far_low = noise_mix(u, noise_ramp_lane(aa + 1, x, y, z - 1), noise_ramp_lane(ba + 1, x - 1, y, z - 1));
    double far_high =
        noise_mix(u, noise_ramp_lane(ab + 1, x, y - 1, z - 1), noise_ramp_lane(bb + 1, x - 1, y - 1, z - 1));
    return noise_mix(w, noise_mix(v, near_low, near_high), noise_mix(v, far_low, far_high));
}

#endif
