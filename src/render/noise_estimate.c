/* A tile needs samples * (noise / wanted noise)^2 samples if its noise is inversely proportional to their square root.
 * It seldom is. Stratified samples converge faster; few samples miss caustics and small bright features, so this number
 * grows with the samples, in some tiles fivefold from 16 samples to 256. The growth of a tile persists: the growth
 * during a doubling of the samples is taken as .65 times that during the doubling before, minus .1 (in logarithms), with
 * a deviation of .13 at 16 samples, less at more. Of the constants that were tried, these gave small errors of the time
 * left in the recorded levels of ten pictures (docs/progress.md). So the number of samples at the end is
 * a log-normal random variable, and the expected number of samples is the sum over the levels of their samples times
 * the probability that the noise at the beginning of the level is still too large (by the logistic distribution, which
 * is the normal one within .01).
 *
 * Tiles without samples count as the mean of the others. A finished level only changes sums, so the cost of an estimate
 * does not depend on the number of tiles, but near the end. */
#include "render/noise_estimate_internal.h"

#include "base/mem.h"
#include "math/elementary.h"
#include "render/path_noise_internal.h"

#include <math.h>
#include <stddef.h>

/* Of the growth per doubling of the samples, in natural logarithms. */
static const double growth_usual = -0.1;                      /* of a tile whose number did not grow */
static const double growth_kept = 0.65, growth_fade = 0.6;     /* the next doubling, and each one relative to the last */
static const double growth_lowest = -0.3, growth_highest = 1; /* of those that are believed */
static const double growth_unknown = 0.3;                     /* of the first two samples */
static const double growth_of_halves = 0.8;                   /* their weight beside that of the samples */
/* Of the logarithm, for one doubling after 16 samples; its exponents in the samples and in the doublings. */
static const double deviation = 0.13, deviation_fall = 0.45, deviation_rise = 0.6;

void noise_history_add(struct noise_history *history, struct noise_point point) {
    if (history->count == NOISE_POINTS) {
        history->count--;
        for (int i = 0; i < history->count; i++)
            history->points[i] = history->points[i + 1];
    }
    history->points[history->count++] = point;
}

uint32_t noise_next_level(uint32_t samples, uint32_t limit) {
    uint32_t next = samples < 2 ? 2 : samples < 16 ? 2 * samples : path_next_check(samples);
    return next < limit ? next : limit;
}

/* Pixels whose samples are all equal have no noise. */
static double logarithm(double needed) {
    return el_log(fmax(needed, 1e-3));
}

/* The growth since the last point that has at most about half of the samples. With two or four samples, the halves are
 * one or two samples. */
static double growth_so_far(const struct noise_history *history) {
    const struct noise_point *now = &history->points[history->count - 1];
    int before = history->count - 2;
    if (before < 0)
        return growth_unknown;
    while (before > 0 && history->points[before].samples > now->samples / 1.8)
        before--;
    const struct noise_point *then = &history->points[before];
    double doublings = el_log2((double)now->samples / then->samples);
    double halves = logarithm(now->needed) - logarithm(then->needed);
    double samples = logarithm(now->needed_by_samples) - logarithm(then->needed_by_samples);
    double growth = now->samples <= 4 ? samples / 2 : growth_of_halves * halves + (1 - growth_of_halves) * samples;
    return doublings > 0 ? fmin(fmax(growth / doublings, growth_lowest), growth_highest) : growth_unknown;
}

struct noise_further noise_further_samples(const struct noise_history *history, uint32_t limit) {
    const struct noise_point *now = &history->points[history->count - 1];
    double needed = logarithm(now->needed), growth = growth_kept * growth_so_far(history);
    double deviates = deviation * el_pow(16.0 / now->samples, deviation_fall), probability = 1, sum = 0, squares = 0;
    uint32_t samples = now->samples;
    while (samples < limit && probability > 1e-3) {
        uint32_t next = noise_next_level(samples, limit);
        double from = samples - now->samples, to = next - now->samples;
        sum += probability * (to - from);
        squares += probability * (to * to - from * from);
        samples = next;
        if (samples < 16)
            continue;
        double doublings = el_log2((double)samples / now->samples);
        double then =
            needed + growth_usual * doublings + growth * (1 - el_pow(growth_fade, doublings)) / (1 - growth_fade);
        double distance = (then - el_log(samples)) / (deviates * el_pow(doublings, deviation_rise));
        probability = fmin(probability, 1 / (1 + el_exp(-1.702 * distance)));
    }
    return (struct noise_further){sum, sqrt(fmax(squares - sum * sum, 0))};
}

/* --- of a picture --- */

bool noise_estimate_create(struct noise_estimate *estimate, uint32_t count, uint32_t limit, int workers) {
    *estimate = (struct noise_estimate){.count = count, .limit = limit, .workers = workers};
    estimate->tiles = mem_alloc_zero(count, sizeof *estimate->tiles);
    estimate->sums = mem_alloc_zero((size_t)workers, sizeof *estimate->sums);
    return estimate->tiles && estimate->sums;
}

void noise_estimate_destroy(struct noise_estimate *estimate) {
    mem_free(estimate->tiles);
    mem_free(estimate->sums);
    *estimate = (struct noise_estimate){0};
}

void noise_estimate_expect(struct noise_estimate *estimate, uint32_t tile, double pixels, uint32_t samples) {
    estimate->tiles[tile].pixels = pixels;
    estimate->tiles[tile].before = samples;
    estimate->tiles[tile].urgency = HUGE_VAL;
    estimate->pixels += pixels;
}

static uint32_t samples_of(const struct noise_tile *tile) {
    return tile->history.count > 0 ? tile->history.points[tile->history.count - 1].samples : 0;
}

/* The history has a point. */
static double cost_of_sample(const struct noise_tile *tile) {
    return tile->cost / (samples_of(tile) - tile->before);
}

void noise_estimate_begin(struct noise_estimate *estimate, int worker, uint32_t tile, uint32_t end) {
    const struct noise_tile *of_tile = &estimate->tiles[tile];
    uint32_t samples = samples_of(of_tile);
    double planned = samples > 0 ? cost_of_sample(of_tile) * (end - samples) : 0;
    sum_store(&estimate->sums[worker].part, 0);
    sum_store(&estimate->sums[worker].planned, fmin(planned, sum_load(&of_tile->rest)));
}

void noise_estimate_part(struct noise_estimate *estimate, int worker, double part) {
    sum_store(&estimate->sums[worker].part, part);
}

void noise_estimate_done(struct noise_estimate *estimate, int worker, uint32_t tile, const struct noise_level *level) {
    struct noise_sums *sums = &estimate->sums[worker];
    struct noise_tile *of_tile = &estimate->tiles[tile];
    double rest = 0;
    of_tile->cost += level->cost;
    sum_store(&sums->planned, 0);
    if (level->point.samples < 2 && level->point.needed < noise_endless && !level->final)
        return; /* no noise yet */
    bool first = of_tile->history.count == 0;
    noise_history_add(&of_tile->history, level->point);
    if (!level->final) {
        uint32_t samples = level->point.samples;
        struct noise_further further = noise_further_samples(&of_tile->history, estimate->limit);
        rest = cost_of_sample(of_tile) * further.samples;
        of_tile->urgency = further.deviation / (noise_next_level(samples, estimate->limit) - samples);
    }
    sum_add(&sums->pixels, first ? of_tile->pixels : 0);
    sum_add(&sums->done, first ? of_tile->cost : level->cost);
    sum_add(&sums->rest, rest - sum_load(&of_tile->rest));
    sum_store(&of_tile->rest, rest);
}

double noise_estimate_urgency(const struct noise_estimate *estimate, uint32_t tile) {
    return estimate->tiles[tile].urgency;
}

/* Near the end, workers may wait for the longest tile. */
static const double end_share = 0.1;

static double longest_rest(const struct noise_estimate *estimate) {
    double longest = 0;
    for (uint32_t i = 0; i < estimate->count; i++)
        longest = fmax(longest, sum_load(&estimate->tiles[i].rest));
    return longest;
}

struct time_estimate_work noise_estimate_work(const struct noise_estimate *estimate) {
    double done = 0, rest = 0, begun = 0, pixels = 0;
    for (int w = 0; w < estimate->workers; w++) {
        const struct noise_sums *sums = &estimate->sums[w];
        done += sum_load(&sums->done);
        rest += sum_load(&sums->rest);
        begun += sum_load(&sums->planned) * sum_load(&sums->part);
        pixels += sum_load(&sums->pixels);
    }
    if (!(pixels > 0))
        return (struct time_estimate_work){0, 1};
    double left = (done + rest) / pixels * (estimate->pixels - pixels) + rest - begun;
    if (estimate->workers > 1 && left < end_share * done)
        left = fmax(left, estimate->workers * longest_rest(estimate) - begun);
    return (struct time_estimate_work){done + begun, fmax(left, 0)};
}
