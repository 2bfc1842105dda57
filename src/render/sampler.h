/* The random numbers of a picture. Each is a function of the seed, the pixel, the number of the sample within the pixel
 * and the position in the tree of rays where it is used (the dimension), never of thread, order or time.
 *
 * Keys form a tree (base/random.h): seed, pixel, sample, ray, and below a ray its lights and its child rays. A key
 * gives jitter. The strata distribute the samples of one pixel together over a light, a lens, the shutter or the facets
 * of a rough surface: if one sample uses n x n cells, each of the N x N samples of a pixel uses another part of these
 * cells. */
#ifndef GRAY_RENDER_SAMPLER_H
#define GRAY_RENDER_SAMPLER_H

#include "math/sampling.h"

#include <stdbool.h>
#include <stdint.h>

/* Points that are evenly distributed in the unit square: the first two dimensions of Sobol's sequence (S. Joe and F.
 * Kuo, "Constructing Sobol Sequences with Better Two-Dimensional Projections", 2008), scrambled after Owen by a hash
 * (B. Burley, "Practical Hash-based Owen Scrambling", JCGT 2020; the hash in the style of S. Laine and T. Karras).
 *
 * Every seed gives another scrambled (0,2)-sequence, in another order: of its first 2^m points each
 * elementary interval of area 2^-m holds one, and a mean over them is unbiased. So a sample takes one pair for each of
 * its decisions, with the seed of that decision ("padding"), and all decisions are independent of one another. */

static inline uint32_t sobol_reversed(uint32_t x) {
    x = (x & UINT32_C(0x55555555)) << 1 | (x >> 1 & UINT32_C(0x55555555));
    x = (x & UINT32_C(0x33333333)) << 2 | (x >> 2 & UINT32_C(0x33333333));
    x = (x & UINT32_C(0x0f0f0f0f)) << 4 | (x >> 4 & UINT32_C(0x0f0f0f0f));
    return __builtin_bswap32(x);
}

/* Both numbers reversed. */
static inline struct sample2 sobol_reversed_pair(uint32_t x, uint32_t y) {
    uint64_t both = (uint64_t)x << 32 | y;
    both = (both & UINT64_C(0x5555555555555555)) << 1 | (both >> 1 & UINT64_C(0x5555555555555555));
    both = (both & UINT64_C(0x3333333333333333)) << 2 | (both >> 2 & UINT64_C(0x3333333333333333));
    both = (both & UINT64_C(0x0f0f0f0f0f0f0f0f)) << 4 | (both >> 4 & UINT64_C(0x0f0f0f0f0f0f0f0f));
    both = __builtin_bswap64(both);
    return (struct sample2){(double)(uint32_t)both * 0x1p-32, (double)(uint32_t)(both >> 32) * 0x1p-32};
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

/* The point of the sequence with that seed and with the index whose bits, reversed, are these. */
static inline struct sample2 sobol_point_reversed(uint32_t reversed, uint64_t seed) {
    uint64_t more = random_mix(seed + UINT64_C(0x9e3779b97f4a7c15));
    uint32_t index = sobol_reversed(sobol_permuted(reversed, (uint32_t)seed));
    return sobol_reversed_pair(sobol_permuted(index, (uint32_t)more),
                               sobol_permuted(sobol_pascal(index), (uint32_t)(more >> 32)));
}

static inline struct sample2 sobol_point(uint32_t index, uint64_t seed) {
    return sobol_point_reversed(sobol_reversed(index), seed);
}

/* A sample of a pixel of the whole picture. */
struct pixel_sample {
    int64_t x, y;
    double dx, dy;   /* within the pixel */
    uint64_t number; /* 0: the first sample, which is alone; 1 + k: cell k of N x N */
    double weight;   /* of the reconstruction filter (render/filter_internal.h): 1 or -1 */
};

/* How the samples of a pixel are distributed. STRATA: in parts of cells, for N x N samples. SOBOL: as points of
 * sequences, for any number of samples; each decision of a sample has a dimension. */
enum sampler_kind { SAMPLER_STRATA, SAMPLER_SOBOL };

/* The numbers of one sample. */
struct sampler {
    enum sampler_kind kind;
    uint64_t key;       /* of the sample: the root of the keys of its rays */
    uint64_t pixel_key; /* of the strata; or of the sequences of the sample's half */
    uint32_t cell;      /* of `side` x `side` samples of the pixel; SOBOL: number of the sample in its half, reversed */
    uint32_t side;      /* 1: the sample is alone */
};

/* Dimensions of SOBOL: those of the camera ray, then SAMPLER_VERTEX_DIMENSIONS for each vertex of a path. A point of
 * the unit square is one dimension. */
enum sampler_dimension { SAMPLER_PIXEL, SAMPLER_LENS, SAMPLER_TIME, SAMPLER_FIRST_VERTEX };
enum { SAMPLER_VERTEX_DIMENSIONS = 3 };
#define SAMPLER_WAVELENGTH (UINT32_C(1) << 29)
#define SAMPLER_MEDIUM (UINT32_C(1) << 31)  /* with the first dimension of a vertex: the way of the ray to it */
#define SAMPLER_AIMED (UINT32_C(1) << 29)   /* likewise: light along that way */
#define SAMPLER_GLOW (UINT32_C(1) << 28)    /* likewise: light of glowing media */
#define SAMPLER_LIGHTS (UINT32_C(1) << 27)  /* likewise: the lamps of which one is chosen for that way */
#define SAMPLER_STRETCH (UINT32_C(1) << 30) /* in the same way: the rays to lights */

/* Sample `number` of a pixel (counted row by row over the whole picture) of side x side. */
static inline struct sampler sampler_make(uint64_t seed, uint64_t pixel, uint64_t number, uint32_t side) {
    uint64_t key = random_combine(random_combine(seed, 0), pixel);
    return (struct sampler){.key = random_combine(key, number),
                            .pixel_key = random_combine(key, 1),
                            .cell = number > 0 ? (uint32_t)number - 1 : 0,
                            .side = number > 0 ? side : 1};
}

/* Sample `number` of a pixel for paths. Even and odd samples are two halves with different sequences: each half is an
 * estimate of the pixel that is independent of the other one. */
static inline struct sampler sampler_make_sobol(uint64_t seed, uint64_t pixel, uint64_t number) {
    uint64_t key = random_combine(random_combine(seed, 2), pixel);
    return (struct sampler){.kind = SAMPLER_SOBOL,
                            .key = random_combine(key, number),
                            .pixel_key = random_combine(key, UINT64_MAX - number % 2),
                            .cell = sobol_reversed((uint32_t)(number / 2)),
                            .side = 1};
}
/* Its point in a dimension. */
static inline struct sample2 sampler_point(const struct sampler *sampler, uint32_t dimension) {
    return sobol_point_reversed(sampler->cell, random_combine(sampler->pixel_key, dimension));
}

/* A point of the pixel for this sample: one of the side x side points of a rotated grid, mirrored and transposed
 * depending on the pixel. Every row and every column of side^2 has one point; for an odd side one point is the centre.
 * With one sample: the centre. */
struct sample2 sampler_pixel_rotated(const struct sampler *sampler);
/* The same for a multi-jittered set: the mean over it is unbiased. */
struct sample2 sampler_pixel_jittered(const struct sampler *sampler);
/* A point of the unit square for the lens, and a time from 0 to 1 for the shutter: one of as many cells as the pixel
 * has samples, in an order that depends on the pixel. */
struct sample2 sampler_lens(const struct sampler *sampler);
double sampler_time(const struct sampler *sampler);
/* The key of the same sample for the right eye of a stereo pair; sampler->key is that of the left one. */
static inline uint64_t sampler_right_eye(const struct sampler *sampler) {
    return random_combine(sampler->key, UINT64_MAX);
}

/* Keys below that of a ray: for its child rays, and for the lights at its hit. The facets of a rough surface have keys
 * below SAMPLER_ROUGH. */
enum sampler_branch { SAMPLER_REFLECTED, SAMPLER_REFRACTED, SAMPLER_ROUGH, SAMPLER_HOLE, SAMPLER_IN_MEDIUM };
static inline uint64_t sampler_branch(uint64_t ray_key, enum sampler_branch branch) {
    return random_combine(ray_key, (uint64_t)UINT32_MAX + (uint64_t)branch);
}
static inline uint64_t sampler_light(uint64_t ray_key, uint32_t light) {
    return random_combine(ray_key, light);
}
static inline uint64_t sampler_facet(uint64_t rough_key, uint32_t facet) {
    return random_combine(rough_key, facet);
}

/* Points of the unit square, one in each of side x side cells. */
enum sample_set_kind {
    SAMPLE_SET_JITTERED, /* anywhere in the cell */
    SAMPLE_SET_PARTS,    /* in the part of the cell that belongs to the sample */
    SAMPLE_SET_MULTI     /* the same, and multi-jittered together with the other samples of the pixel */
};
struct sample_set {
    enum sample_set_kind kind;
    uint64_t key, set_key;
    uint32_t side, part, parts; /* part of parts x parts */
};

/* For the facets of a rough surface; rough_key: sampler_branch(ray_key, SAMPLER_ROUGH). */
struct sample_set sampler_facets(const struct sampler *sampler, uint64_t ray_key, uint64_t rough_key, uint32_t side);
/* For the shadow rays to light number `light`; light_key: sampler_light(ray_key, light). Not `shared`: the samples of a
 * pixel do not share the cells among each other (lights of docs/language.md 7.1). */
struct sample_set sampler_on_light(const struct sampler *sampler, uint64_t light_key, uint32_t light, uint32_t side,
                                   bool shared);
/* The point in cell (cell % side, cell / side). */
static inline struct sample2 sample_set_point(const struct sample_set *set, uint32_t cell) {
    uint32_t i = cell % set->side, j = cell / set->side;
    switch (set->kind) {
    case SAMPLE_SET_MULTI:
        return sample_multi(set->set_key, set->key, (struct sample_part){i, j, set->side, set->part, set->parts});
    case SAMPLE_SET_PARTS:
        return sample_cell_part(set->key, i, j, set->side, set->part, set->parts);
    case SAMPLE_SET_JITTERED:
        break;
    }
    return sample_cell(set->key, i, j, set->side);
}

#endif
