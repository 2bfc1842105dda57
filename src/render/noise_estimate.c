/* A tile needs samples * (noise / wanted noise)^2 samples if its noise is inversely proportional to their square root.
 * This number changes with the samples, and the change has a wide distribution. If all pixels of a tile have noise, the
 * number is known within a few per cent. If the noise comes from few pixels that a rare bright path met, it falls as
 * long as no other path is met, and is multiplied when one is. So the logarithm of the number at a later level has
 *
 * - a centre: at few samples the noise is too large, because no mean is known (rare); then it falls while
 * stratification helps, as it did before (growth), and with the concentration of the noise on few pixels;
 * - a spread, which is small for many samples, and large for concentrated noise and for numbers that changed.
 *
 * The constants were fitted to the levels of 35 pictures (docs/progress.md). The tile ends at a level with the
 * probability that the number is at most the samples of this level (logistic distribution). Two things follow:
 *
 * - the expected further samples. Cases of less than a fifth do not count: a rare path makes the mean useless, because
 *   it may need a thousand times as many samples. Their tiles come early, and then their number is known.
 * - the deviation, which decides about the order (sample_levels.c). It counts rare cases, too, and a larger spread
 * where the noise is concentrated.
 *
 * What the tiles of a picture have in common is seen in those that are ahead: half of the mean difference between their
 * numbers and the predictions (drift) is added to the change of all.
 *
 * Tiles without samples count as the mean of the others. A finished level only changes sums, so the cost of an estimate
 * does not depend on the number of tiles, but near the end. */
#include "render/noise_estimate_internal.h"

#include "base/mem.h"
#include "math/elementary.h"
#include "render/path_noise_internal.h"

#include <math.h>
#include <stddef.h>

/* Of the logarithm: shift for `rare` at one sample, and change for each doubling of the samples. */
static const double shift_rare = -0.6;
static const double change_usual = -0.02, change_settled = 0.1, change_growth = 0.25, change_concentrated = -0.8;
/* Its spread after one doubling: after 16 samples, inversely proportional to the samples; by concentration and growth.
 */
static const double spread_usual = 0.04, spread_concentrated = 0.2, spread_growth = 0.25;
static const double spread_order = 0.3; /* more by concentration, for the order of tiles */
/* The drift of a picture counts by half, and less while fewer than drift_doublings are known. Single differences are
 * believed within these limits. */
static const double drift_share = 0.5, drift_doublings = 10, drift_lowest = -0.7, drift_highest = 1;
/* Cases that are less probable do not count. */
static const double improbable_expected = 0.2, improbable_order = 0.02;

void noise_history_add(struct noise_history *history, const struct noise_point *point) {
    if (history->count == NOISE_PAST) {
        history->count--;
        for (int i = 0; i < history->count; i++)
            history->past[i] = history->past[i + 1];
    }
    if (history->last.samples > 0)
        history->past[history->count++] = (struct noise_past){history->last.samples, history->last.needed};
    history->last = *point;
}

uint32_t noise_next_level(uint32_t samples, uint32_t limit) {
    uint32_t next = samples < 2 ? 2 : samples < 16 ? 2 * samples : path_next_check(samples);
    return next < limit ? next : limit;
}

struct noise_limits noise_limits_for(double wanted, uint32_t limit) {
    return (struct noise_limits){wanted > 0 ? path_minimum_samples(wanted) : 0, limit};
}

/* Pixels whose samples are all equal have no noise. */
static double logarithm(double needed) {
    return el_log(fmax(needed, 1e-3));
}

static double clamped(double low, double value, double high) {
    return fmin(fmax(value, low), high);
}

/* The change of the logarithm per doubling, since the last point that has at most about half of the samples. 0 while
 * the halves of the samples are one or two samples. */
static double growth_so_far(const struct noise_history *history) {
    const struct noise_point *now = &history->last;
    int before = history->count - 1;
    if (before < 0 || now->samples <= 4)
        return 0;
    while (before > 0 && history->past[before].samples > now->samples / 1.8)
        before--;
    const struct noise_past *then = &history->past[before];
    return (logarithm(now->needed) - logarithm(then->needed)) / el_log2((double)now->samples / then->samples);
}

/* The logarithm of the needed samples after d doublings: centre + change d, with the spread (and spread_to_order for
 * the order) times the square root of d. */
struct prediction {
    uint32_t samples;
    double centre, change, spread, spread_to_order;
};

static struct prediction predict(const struct noise_history *history) {
    const struct noise_point *now = &history->last;
    double growth = clamped(-0.5, growth_so_far(history), 1), concentration = now->concentration;
    double spread =
        spread_usual * 16 / now->samples + spread_concentrated * concentration + spread_growth * fabs(growth);
    double change = change_usual + change_settled * clamped(-0.5, now->settled, 1) + change_growth * fmin(growth, 0.3) +
                    change_concentrated * concentration * concentration;
    return (struct prediction){now->samples, logarithm(now->needed) + shift_rare * now->rare / now->samples, change,
                               spread, spread + spread_order * concentration};
}

/* Sums over the cases that are more probable than `improbable`. */
static struct noise_further sum_levels(const struct prediction *of, double spread, double improbable,
                                       struct noise_limits limits) {
    double probability = 1, sum = 0, squares = 0;
    uint32_t samples = of->samples;
    while (samples < limits.limit && probability > improbable) {
        uint32_t next = noise_next_level(samples, limits.limit);
        double from = samples - of->samples, to = next - of->samples;
        sum += probability * (to - from);
        squares += probability * (to * to - from * from);
        samples = next;
        if (samples < limits.minimum)
            continue;
        double doublings = el_log2((double)samples / of->samples);
        double distance = of->centre + of->change * doublings - el_log(samples);
        probability = fmin(probability, 1 / (1 + el_exp(-distance / (spread * sqrt(doublings)))));
    }
    return (struct noise_further){sum, sqrt(fmax(squares - sum * sum, 0))};
}

struct noise_further noise_further_samples(const struct noise_history *history, double drift,
                                           struct noise_limits limits) {
    struct prediction prediction = predict(history);
    prediction.change += drift;
    struct noise_further expected = sum_levels(&prediction, prediction.spread, improbable_expected, limits);
    struct noise_further with_rare = sum_levels(&prediction, prediction.spread_to_order, improbable_order, limits);
    return (struct noise_further){expected.samples, with_rare.deviation};
}

/* --- of a picture --- */

bool noise_estimate_create(struct noise_estimate *estimate, uint32_t count, struct noise_limits limits, int workers) {
    *estimate = (struct noise_estimate){.count = count, .limits = limits, .workers = workers};
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
    return tile->history.last.samples;
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

/* What a level shows of the drift. With fewer than 8 samples before it, it says little. */
static void add_drift(struct noise_sums *sums, const struct noise_history *before, const struct noise_point *now) {
    if (before->last.samples < 8 || now->samples < 16 || now->needed >= noise_endless)
        return;
    struct prediction prediction = predict(before);
    double doublings = el_log2((double)now->samples / prediction.samples);
    double difference = logarithm(now->needed) - (prediction.centre + prediction.change * doublings);
    sum_add(&sums->drift, clamped(drift_lowest, difference, drift_highest));
    sum_add(&sums->doublings, doublings);
}

static double drift_so_far(const struct noise_estimate *estimate) {
    double drift = 0, doublings = drift_doublings;
    for (int w = 0; w < estimate->workers; w++) {
        drift += sum_load(&estimate->sums[w].drift);
        doublings += sum_load(&estimate->sums[w].doublings);
    }
    return drift_share * drift / doublings;
}

void noise_estimate_done(struct noise_estimate *estimate, int worker, uint32_t tile, const struct noise_level *level) {
    struct noise_sums *sums = &estimate->sums[worker];
    struct noise_tile *of_tile = &estimate->tiles[tile];
    double rest = 0;
    of_tile->cost += level->cost;
    sum_store(&sums->planned, 0);
    if (level->point.samples < 2 && level->point.needed < noise_endless && !level->final)
        return; /* no noise yet */
    bool first = samples_of(of_tile) == 0;
    add_drift(sums, &of_tile->history, &level->point);
    noise_history_add(&of_tile->history, &level->point);
    if (!level->final) {
        uint32_t samples = level->point.samples;
        struct noise_further further =
            noise_further_samples(&of_tile->history, drift_so_far(estimate), estimate->limits);
        rest = cost_of_sample(of_tile) * further.samples;
        of_tile->urgency = further.deviation / (noise_next_level(samples, estimate->limits.limit) - samples);
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
