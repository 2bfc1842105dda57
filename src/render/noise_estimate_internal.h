/* The time of the remaining samples of a picture with --noise, whose tiles get their samples level by level
 * (sample_levels.c): from the noise that each tile has so far. */
#ifndef GRAY_RENDER_NOISE_ESTIMATE_INTERNAL_H
#define GRAY_RENDER_NOISE_ESTIMATE_INTERNAL_H

#include "render/time_estimate.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/* What is known of a tile after some samples: how many samples it would need if its noise fell as 1/sqrt(samples), and
 * how its noise came about (struct path_noise). */
struct noise_point {
    uint32_t samples;
    double needed;
    double rare;    /* natural logarithm of the variance relative to the plain one: large if no mean is known yet */
    double settled; /* the same relative to the variance by samples: negative if stratification helps */
    double concentration;
};
/* Needed by tiles that get all samples whatever their noise is: passes without --noise. */
static const double noise_endless = 1e30;

/* The last point, and the needed samples of those before, oldest first. */
enum { NOISE_PAST = 2 };
struct noise_history {
    struct noise_past {
        uint32_t samples;
        double needed;
    } past[NOISE_PAST];
    struct noise_point last;
    int count; /* of past; there is a last point if its number of samples is not 0 */
};
void noise_history_add(struct noise_history *history, const struct noise_point *point);

/* The number of samples of the level after one with so many, at most `limit`: 2, 4, 8, and the checks of the noise
 * (path_next_check). */
uint32_t noise_next_level(uint32_t samples, uint32_t limit);

/* All tiles get at least `minimum` and at most `limit` samples. */
struct noise_limits {
    uint32_t minimum, limit;
};
/* wanted: the noise of --noise; 0: all tiles get `limit` samples. */
struct noise_limits noise_limits_for(double wanted, uint32_t limit);

/* The further samples of a tile that is not finished: the expected number, without the few cases that need very many;
 * and its standard deviation, with most of them. drift: change of the logarithm of the needed samples for each
 * doubling, beyond what the history says. The history has at least one point with 2 or more samples, or one of a tile
 * that gets all of them. */
struct noise_further {
    double samples, deviation;
};
struct noise_further noise_further_samples(const struct noise_history *history, double drift,
                                           struct noise_limits limits);

/* --- of a picture --- */

struct noise_tile {
    struct noise_history history;
    double pixels, cost; /* cost: of its samples so far, without those that it had before */
    uint32_t before;     /* samples that it had when the estimate began */
    double urgency;      /* see noise_estimate_urgency */
    _Atomic double rest; /* expected cost of its further samples */
};

/* The sums of one worker, as in render/time_estimate.h. */
struct noise_sums {
    _Atomic double done, rest;       /* costs; rest is of tiles that have samples, and may be negative for one worker */
    _Atomic double pixels;           /* of tiles that have samples */
    _Atomic double planned, part;    /* cost of the level in progress, and how much of it is done, 0..1 */
    _Atomic double drift, doublings; /* of levels that are done: needed samples beyond the prediction (logarithm) */
};

struct noise_estimate {
    uint32_t count;
    struct noise_limits limits;
    int workers;
    double pixels; /* of all tiles that get samples here */
    struct noise_tile *tiles;
    struct noise_sums *sums; /* of each worker */
};

/* Memory for tiles and workers. False: no memory; noise_estimate_destroy is fine in any case. */
bool noise_estimate_create(struct noise_estimate *estimate, uint32_t count, struct noise_limits limits, int workers);
void noise_estimate_destroy(struct noise_estimate *estimate);
/* Before the first tile: this tile will get samples, and has so many. */
void noise_estimate_expect(struct noise_estimate *estimate, uint32_t tile, double pixels, uint32_t samples);
/* A level that is done: what is known of the tile after it, its cost, and whether the tile gets no further samples. */
struct noise_level {
    struct noise_point point;
    double cost;
    bool final;
};
/* The worker begins a level of a tile that ends with so many samples; is so far with it; has done it. A tile
 * belongs to one worker at a time. */
void noise_estimate_begin(struct noise_estimate *estimate, int worker, uint32_t tile, uint32_t end);
void noise_estimate_part(struct noise_estimate *estimate, int worker, double part);
void noise_estimate_done(struct noise_estimate *estimate, int worker, uint32_t tile, const struct noise_level *level);
/* The standard deviation of the cost of the further samples of a tile, relative to the cost of its next level. The tile
 * with the largest one comes first. Tiles without samples: HUGE_VAL. Not while a worker has the tile. */
double noise_estimate_urgency(const struct noise_estimate *estimate, uint32_t tile);

/* The costs of samples that are done and left; done is 0 while nothing is known. A tile is not shared: workers wait for
 * the longest one. At any time, from any thread. */
struct time_estimate_work noise_estimate_work(const struct noise_estimate *estimate);

#endif
