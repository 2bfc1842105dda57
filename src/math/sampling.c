/* The concentric map of Shirley and Chiu, "A Low Distortion Map Between Disk and Square", JGT 1997, and the keyed
 * permutation of Kensler, "Correlated Multi-Jittered Sampling", Pixar Technical Memo 13-01, 2013: bijective mixing
 * steps within the next power of two, repeated until the result is in range (cycle walking). Multi-jittered sets are
 * those of Chiu, Shirley, Wang, "Multi-Jittered Sampling", Graphics Gems IV, 1994, every column and every row with a
 * permutation of its own. */
#include "math/sampling.h"

#include "math/elementary.h"

#include <math.h>

uint32_t sample_permute(uint32_t index, uint32_t count, uint64_t key) {
    uint32_t mask = count - 1, p = (uint32_t)key, q = (uint32_t)(key >> 32);
    mask |= mask >> 1;
    mask |= mask >> 2;
    mask |= mask >> 4;
    mask |= mask >> 8;
    mask |= mask >> 16;
    do {
        /* Each line is a bijection of the numbers under the mask: xor, odd factor, xor with own upper bits. */
        index ^= p;
        index *= 0xe170893du;
        index ^= q;
        index ^= (index & mask) >> 4;
        index ^= p >> 8;
        index *= 0x0929eb3fu;
        index ^= q >> 23;
        index ^= (index & mask) >> 1;
        index *= 1 | p >> 27;
        index *= 0x6935fa69u;
        index ^= (index & mask) >> 11;
        index *= 0x74dcb303u;
        index ^= (index & mask) >> 2;
        index *= 0x9e501cc3u;
        index ^= (index & mask) >> 2;
        index *= 0xc860a3dfu;
        index &= mask;
        index ^= index >> 5;
    } while (index >= count);
    return (index + (p & 0x7fffffffu) % count) % count;
}

struct sample2 sample_multi(uint64_t set, uint64_t key, uint32_t i, uint32_t j, uint32_t n, uint32_t part,
                            uint32_t side) {
    uint32_t m = n * side, column = i * side + part % side, row = j * side + part / side;
    uint32_t inner_x = sample_permute(row, m, random_combine(set, 2 * (uint64_t)column));
    uint32_t inner_y = sample_permute(column, m, random_combine(set, 2 * (uint64_t)row + 1));
    uint64_t bits = random_combine(key, (uint64_t)row * m + column);
    double x = random_unit(bits), y = random_unit(random_mix(bits + UINT64_C(0x9e3779b97f4a7c15)));
    return (struct sample2){((double)column + ((double)inner_x + x) / (double)m) / (double)m,
                            ((double)row + ((double)inner_y + y) / (double)m) / (double)m};
}

struct sample2 sample_disc(struct sample2 square) {
    double x = 2 * square.x - 1, y = 2 * square.y - 1, radius, angle, sine, cosine;
    const double quarter = PI / 4;
    if (x == 0 && y == 0)
        return (struct sample2){0, 0};
    if (fabs(x) > fabs(y)) {
        radius = x;
        angle = quarter * (y / x);
    } else {
        radius = y;
        angle = 2 * quarter - quarter * (x / y);
    }
    el_sincos(angle, &sine, &cosine);
    return (struct sample2){radius * cosine, radius * sine};
}
