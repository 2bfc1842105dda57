/* Keys below the key of the strata of a pixel: the number of a light, for the order of the strata on
 * that light; the key of a ray, for the strata on a rough surface; UINT64_MAX and the next lower one, for those of lens
 * and shutter; 2, for the jitter on the lens; from UINT64_MAX - 2 down, for the multi-jittered sets of the lights; and
 * 2^62, for the pattern in the pixel. */
#include "render/sampler.h"

static const uint64_t order_of_lens = UINT64_MAX, order_of_times = UINT64_MAX - 1, sets_of_lights = UINT64_MAX - 2;
static const uint64_t jitter_of_times = UINT64_MAX - 1; /* below the key of the sample */
static const uint64_t jitter_of_lens = 2;
static const uint64_t pattern_in_pixel = UINT64_C(1) << 62;

/* The part for this sample: the samples of a pixel visit each part once. */
static uint32_t part_of(const struct sampler *sampler, uint64_t dimension) {
    if (sampler->side <= 1)
        return 0;
    return sample_permute(sampler->cell, sampler->side * sampler->side, random_combine(sampler->pixel_key, dimension));
}

/* Cell (i, j) has its point in column j and row side - 1 - i of its side x side strata (the canonical arrangement of
 * Kensler's memo, math/sampling.c). So edges along rows and columns have side^2 steps instead of side. Edges at other
 * angles have at most the error of the regular grid. The points are symmetric about the centre, so the mean of a linear
 * function is exact. */
struct sample2 sampler_pixel_rotated(const struct sampler *sampler) {
    uint32_t n = sampler->side, i = sampler->cell % n, j = sampler->cell / n;
    uint64_t bits = random_combine(sampler->pixel_key, pattern_in_pixel);
    struct sample2 at = {((double)i + ((double)j + 0.5) / n) / n, ((double)j + ((double)(n - 1 - i) + 0.5) / n) / n};
    if (bits & 1)
        at.x = 1 - at.x;
    return bits & 2 ? (struct sample2){at.y, at.x} : at;
}

struct sample2 sampler_pixel_jittered(const struct sampler *sampler) {
    uint64_t set = random_combine(sampler->pixel_key, pattern_in_pixel);
    return sample_multi(set, random_combine(set, 0), (struct sample_part){0, 0, 1, sampler->cell, sampler->side});
}

struct sample2 sampler_lens(const struct sampler *sampler) {
    if (sampler->kind == SAMPLER_SOBOL)
        return sampler_point(sampler, SAMPLER_LENS);
    uint32_t side = sampler->side, cell = part_of(sampler, order_of_lens);
    return sample_cell(random_combine(sampler->pixel_key, jitter_of_lens), cell % side, cell / side, side);
}

double sampler_time(const struct sampler *sampler) {
    if (sampler->kind == SAMPLER_SOBOL)
        return sampler_point(sampler, SAMPLER_TIME).x;
    uint32_t all = sampler->side * sampler->side, cell = part_of(sampler, order_of_times);
    return ((double)cell + random_unit(random_combine(sampler->key, jitter_of_times))) / (double)all;
}

struct sample_set sampler_facets(const struct sampler *sampler, uint64_t ray_key, uint64_t rough_key, uint32_t side) {
    if (sampler->side <= 1)
        return (struct sample_set){.kind = SAMPLE_SET_JITTERED, .key = rough_key, .side = side};
    return (struct sample_set){.kind = SAMPLE_SET_PARTS,
                               .key = rough_key,
                               .side = side,
                               .part = part_of(sampler, ray_key),
                               .parts = sampler->side};
}

struct sample_set sampler_on_light(const struct sampler *sampler, uint64_t light_key, uint32_t light, uint32_t side,
                                   bool shared) {
    if (!shared)
        return (struct sample_set){.kind = SAMPLE_SET_JITTERED, .key = light_key, .side = side};
    return (struct sample_set){.kind = SAMPLE_SET_MULTI,
                               .key = light_key,
                               .set_key = random_combine(sampler->pixel_key, sets_of_lights - light),
                               .side = side,
                               .part = part_of(sampler, light),
                               .parts = sampler->side};
}
