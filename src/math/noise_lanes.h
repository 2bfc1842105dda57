/* Noise of many points at once: in a loop the compiler makes vectors of it. No branches; noise.c explains the steps. */
#ifndef GRAY_MATH_NOISE_LANES_H
#define GRAY_MATH_NOISE_LANES_H

#include "math/exact.h"
#include "math/lanes.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

/* The published permutation; the first numbers follow the last, so that 8 bytes may be read at each. */
extern const uint8_t noise_permutation_bytes[264];
/* Of each of its numbers the gradient: from the top 12 bits for x, 12 for y and 8 for z, which are the upper bits of
 * the coordinate as a double, of z divided by NOISE_Z_SCALE. The first follows the last. */
extern const uint32_t noise_gradient_words[257];
#define NOISE_Z_SCALE 0x1p15
/* The 16 gradients: 12 bits for each coordinate from the top. */
extern const uint64_t noise_directions[16];

static inline double noise_fade(double t) {
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

static inline double noise_mix(double weight, double a, double b) {
    return a + weight * (b - a);
}

/* Eight bytes of the tables from an entry on, little-endian: one lookup gives both neighbours. */
typedef uint64_t __attribute__((aligned(1), may_alias)) noise_bytes;
typedef uint64_t __attribute__((aligned(4), may_alias)) noise_words;

static inline uint64_t noise_hashes_lane(uint64_t at) {
    return *(const noise_bytes *)(const void *)(noise_permutation_bytes + (at & 255));
}

static inline uint64_t noise_gradients_lane(uint64_t at) {
    return *(const noise_words *)(const void *)(noise_gradient_words + (at & 255));
}

/* The gradient in the upper half of the word; z is multiplied by NOISE_Z_SCALE. All products are exact. */
static inline double noise_ramp_lane(uint64_t word, double x, double y, double z) {
    const uint64_t upper = (uint64_t)0xfff << 52, top = (uint64_t)0xff << 56;
    return from_bits(word & upper) * x + from_bits(word << 12 & upper) * y + from_bits(word << 24 & top) * z;
}

/* Coordinates that noise_perlin_lane may have. */
static inline bool noise_fits(double x, double y, double z) {
    return (fabs(x) < 0x1p30) & (fabs(y) < 0x1p30) & (fabs(z) < 0x1p30);
}

/* The bits of noise_perlin(x, y, z, 0). */
static inline double noise_perlin_lane(double x, double y, double z) {
    const double to_integer = 0x1.8p52; /* the sum has the integer in its lower bits */
    double fx = floor(x) + to_integer, fy = floor(y) + to_integer, fz = floor(z) + to_integer;
    uint64_t i = to_bits(fx), j = to_bits(fy), k = to_bits(fz);
    x -= fx - to_integer;
    y -= fy - to_integer;
    z -= fz - to_integer;
    double u = noise_fade(x), v = noise_fade(y), w = noise_fade(z);
    double near = z * NOISE_Z_SCALE, far = (z - 1) * NOISE_Z_SCALE;
    uint64_t first = noise_hashes_lane(i);
    uint64_t a = noise_hashes_lane((first & 255) + j), b = noise_hashes_lane((first >> 8) + j);
    uint64_t aa = noise_gradients_lane((a & 255) + k), ab = noise_gradients_lane((a >> 8) + k);
    uint64_t ba = noise_gradients_lane((b & 255) + k), bb = noise_gradients_lane((b >> 8) + k);
    double near_low = noise_mix(u, noise_ramp_lane(aa << 32, x, y, near), noise_ramp_lane(ba << 32, x - 1, y, near));
    double near_high =
        noise_mix(u, noise_ramp_lane(ab << 32, x, y - 1, near), noise_ramp_lane(bb << 32, x - 1, y - 1, near));
    double far_low = noise_mix(u, noise_ramp_lane(aa, x, y, far), noise_ramp_lane(ba, x - 1, y, far));
    double far_high = noise_mix(u, noise_ramp_lane(ab, x, y - 1, far), noise_ramp_lane(bb, x - 1, y - 1, far));
    return noise_mix(w, noise_mix(v, near_low, near_high), noise_mix(v, far_low, far_high));
}

#if defined(LANES_AVX512)
/* Lookups in processor registers, for which vector types have no expression: noise has 11 times Lua's speed in
 * bench/expr, and 6 where AVX2 gathers from tables. The permutation as 256 words, each with the next number in its
 * upper byte: one lookup gives both neighbours. */
struct noise_table {
    __m512i words[8];
};

static inline struct noise_table noise_table_make(void) {
    struct noise_table table;
    for (int i = 0; i < 8; i++) {
        const uint8_t *from = noise_permutation_bytes + 32 * i;
        __m512i these = _mm512_cvtepu8_epi16(_mm256_loadu_si256((const __m256i *)(const void *)from));
        __m512i next = _mm512_cvtepu8_epi16(_mm256_loadu_si256((const __m256i *)(const void *)(from + 1)));
        table.words[i] = _mm512_or_si512(these, _mm512_slli_epi16(next, 8));
    }
    return table;
}

/* The words at 32 indices; only the lower 8 bits of an index are used. */
static inline __m512i noise_neighbours(const struct noise_table *table, __m512i at) {
    const __m512i *words = table->words;
    __mmask32 bit_6 = _mm512_test_epi16_mask(at, _mm512_set1_epi16(64));
    __mmask32 bit_7 = _mm512_test_epi16_mask(at, _mm512_set1_epi16(128));
    __m512i low = _mm512_mask_blend_epi16(bit_6, _mm512_permutex2var_epi16(words[0], at, words[1]),
                                          _mm512_permutex2var_epi16(words[2], at, words[3]));
    __m512i high = _mm512_mask_blend_epi16(bit_6, _mm512_permutex2var_epi16(words[4], at, words[5]),
                                           _mm512_permutex2var_epi16(words[6], at, words[7]));
    return _mm512_mask_blend_epi16(bit_7, low, high);
}

/* Eight gradients; only bits 0 to 3 of each index are used. */
static inline double_lanes noise_ramps(__m512i at, double_lanes x, double_lanes y, double_lanes z) {
    const __m512i upper = _mm512_set1_epi64((long long)((uint64_t)0xfff << 52));
    __m512i word =
        _mm512_permutex2var_epi64(_mm512_loadu_si512(noise_directions), at, _mm512_loadu_si512(noise_directions + 8));
    double_lanes gx = (double_lanes)_mm512_and_si512(word, upper);
    double_lanes gy = (double_lanes)_mm512_and_si512(_mm512_slli_epi64(word, 12), upper);
    double_lanes gz = (double_lanes)_mm512_and_si512(_mm512_slli_epi64(word, 24), upper);
    return gx * x + gy * y + gz * z;
}

static inline double_lanes noise_fades(double_lanes t) {
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

static inline double_lanes noise_mixes(double_lanes weight, double_lanes a, double_lanes b) {
    return a + weight * (b - a);
}

/* Of eight points, their offsets in the cell; returns the lower 16 bits of the cell. */
static inline __m128i noise_cell(const double *from, double_lanes *offset) {
    const double to_integer = 0x1.8p52;
    double_lanes x = double_lanes_load_any(from), sum = double_lanes_floor(x) + to_integer;
    *offset = x - (sum - to_integer);
    return _mm512_cvtepi64_epi16((__m512i)sum);
}

/* The bits of noise_perlin_lane at 8 * count points, count from 1 to 4; out may be one of the operands. The hashes of
 * 32 points are looked up at once, in processor registers. */
static inline void noise_perlin_block(const struct noise_table *table, const double *const operands[3], int count,
                                      double *out) {
    const __m512i byte = _mm512_set1_epi16(255);
    _Alignas(64) uint16_t cells[3][32] = {{0}}, corners[4][32];
    double_lanes offsets[3][4];
    for (int k = 0; k < 3; k++)
        for (int g = 0; g < count; g++)
            _mm_store_si128((__m128i *)(void *)(cells[k] + 8 * g), noise_cell(operands[k] + 8 * g, &offsets[k][g]));
    /* Hashes of the eight corners of the cells, two in one number. */
    __m512i j = _mm512_load_si512(cells[1]), k = _mm512_load_si512(cells[2]);
    __m512i first = noise_neighbours(table, _mm512_load_si512(cells[0]));
    __m512i a = noise_neighbours(table, _mm512_add_epi16(_mm512_and_si512(first, byte), j));
    __m512i b = noise_neighbours(table, _mm512_add_epi16(_mm512_srli_epi16(first, 8), j));
    __m512i aa = _mm512_add_epi16(_mm512_and_si512(a, byte), k), ab = _mm512_add_epi16(_mm512_srli_epi16(a, 8), k);
    __m512i ba = _mm512_add_epi16(_mm512_and_si512(b, byte), k), bb = _mm512_add_epi16(_mm512_srli_epi16(b, 8), k);
    _mm512_store_si512(corners[0], noise_neighbours(table, aa));
    _mm512_store_si512(corners[1], noise_neighbours(table, ba));
    _mm512_store_si512(corners[2], noise_neighbours(table, ab));
    _mm512_store_si512(corners[3], noise_neighbours(table, bb));
    for (int g = 0; g < count; g++) {
        double_lanes x = offsets[0][g], y = offsets[1][g], z = offsets[2][g], x1 = x - 1, y1 = y - 1, z1 = z - 1;
        double_lanes u = noise_fades(x), v = noise_fades(y), w = noise_fades(z);
        __m512i low[4], high[4];
        for (int c = 0; c < 4; c++) {
            low[c] = _mm512_cvtepu16_epi64(_mm_load_si128((const __m128i *)(const void *)(corners[c] + 8 * g)));
            high[c] = _mm512_srli_epi64(low[c], 8);
        }
        /* The ramps of the corners, mixed along x, y and z in the order of noise_perlin. */
        double_lanes near_low = noise_mixes(u, noise_ramps(low[0], x, y, z), noise_ramps(low[1], x1, y, z));
        double_lanes near_high = noise_mixes(u, noise_ramps(low[2], x, y1, z), noise_ramps(low[3], x1, y1, z));
        double_lanes far_low = noise_mixes(u, noise_ramps(high[0], x, y, z1), noise_ramps(high[1], x1, y, z1));
        double_lanes far_high = noise_mixes(u, noise_ramps(high[2], x, y1, z1), noise_ramps(high[3], x1, y1, z1));
        double_lanes_store_any(out + 8 * g,
                               noise_mixes(w, noise_mixes(v, near_low, near_high), noise_mixes(v, far_low, far_high)));
    }
}
#endif

#endif
