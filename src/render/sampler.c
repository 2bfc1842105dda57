/* See sampler.h. Below the key of a pixel's strata are: the light's number, its order of the parts on that light; the
 * key of a ray, that on a rough surface; UINT64_MAX and the next below, those of lens and shutter; 2, the jitter on the
 * lens; and from UINT64_MAX - 2 down the lights' multi-jittered sets. */
#include "render/sampler.h"

static const uint64_t order_of_lens = UINT64_MAX, order_of_times = UINT64_MAX - 1, sets_of_lights = UINT64_MAX - 2;
static const uint64_t jitter_of_times = UINT64_MAX - 1; /* below the key of the sample */
static const uint64_t jitter_of_lens = 2;

/* Which part is this sample's turn: over the samples of a pixel each is visited once. */
static uint32_t part_of(const struct sampler *sampler, uint64_t dimension) {
    if (sampler->side <= 1)
        return 0;
    return sample_permute(sampler->cell, sampler->side * sampler->side, random_combine(sampler->pixel_key, dimension));
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
