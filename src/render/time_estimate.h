/* The time of the remaining tiles, estimated from the finished ones. Before the first tile a few rays go
 * through each (time_estimate_probe); afterwards each finished tile reports its cost (time_estimate_done), and the
 * time estimate is the combination of the rays' numbers that fits these tiles best. Costs are in any unit, say
 * nanoseconds. */
#ifndef GRAY_RENDER_TIME_ESTIMATE_H
#define GRAY_RENDER_TIME_ESTIMATE_H

#include "film/film.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

enum { TIME_ESTIMATE_TERMS = 6 };

/* Values of one worker: only its thread writes them, all threads read them. */
static inline double sum_load(const _Atomic double *value) {
    return atomic_load_explicit(value, memory_order_relaxed);
}
static inline void sum_store(_Atomic double *value, double to) {
    atomic_store_explicit(value, to, memory_order_relaxed);
}
static inline void sum_add(_Atomic double *value, double more) {
    sum_store(value, sum_load(value) + more);
}

/* The sums of one worker, values as above. */
struct time_estimate_sums {
    _Atomic double products[TIME_ESTIMATE_TERMS][TIME_ESTIMATE_TERMS],
        costs[TIME_ESTIMATE_TERMS]; /* weighted, of tiles done */
    _Atomic double done[TIME_ESTIMATE_TERMS];
    _Atomic double weight, cost, first_cost;
    _Atomic uint32_t tile;  /* in progress, or TIME_ESTIMATE_NO_TILE */
    _Atomic double share;   /* of the tile, that this worker makes */
    _Atomic double part[2]; /* of its first pass and of the second, 0..1 */
};
#define TIME_ESTIMATE_NO_TILE UINT32_MAX

struct time_estimate {
    uint32_t count, across;
    int workers;
    bool proportional;
    float (*terms)[TIME_ESTIMATE_TERMS]; /* of each tile; all 0: not looked at, not to be made */
    double all[TIME_ESTIMATE_TERMS];     /* their sums */
    struct time_estimate_sums *sums;     /* of each worker */
};

/* Tiles are numbered row by row, `across` in a row. False: no memory; time_estimate_destroy is fine in any case. */
bool time_estimate_create(struct time_estimate *time_estimate, uint32_t count, uint32_t across, int workers);
void time_estimate_destroy(struct time_estimate *time_estimate);

/* pixels > 0; cost: of the rays; resampling: the fraction of neighbouring rays with different colours, 0..1, or the
 * number of samples per pixel. Several threads may call it, once for each tile. */
void time_estimate_probe(struct time_estimate *time_estimate, uint32_t tile, double pixels, double cost,
                         double resampling);
/* After the last such call, before the first tile. proportional: resampling is the number of samples, so the expected
 * cost of a tile is this number times the cost of its rays. */
void time_estimate_begin_tiles(struct time_estimate *time_estimate, bool proportional);

/* The worker begins a tile, or that share of it; is so far with its first or second pass; has done it. */
void time_estimate_begin(struct time_estimate *time_estimate, int worker, uint32_t tile, double share);
void time_estimate_part(struct time_estimate *time_estimate, int worker, int pass, double part);
void time_estimate_done(struct time_estimate *time_estimate, int worker, double cost, double first_pass_cost);

/* Work that is done and that is left, in an arbitrary unit: with what was done in a time, the rest takes that time
 * times left / done. film: what others have made counts, too (a farm); else NULL. At any time, from any thread. */
struct time_estimate_work {
    double done, left;
};
struct time_estimate_work time_estimate_work(const struct time_estimate *time_estimate, const struct film *film);

/* How much of the work of a picture is done, and when it will be over: not how many tiles, but what they cost
 * (render/time_estimate.h, docs/progress.md). Shared memory: the other process may read while it is written. */

struct progress_estimate {
    _Atomic uint64_t share; /* billionths of the work, and 1; 0: nothing is known yet */
    _Atomic uint64_t ends;  /* nanoseconds of the clock that never jumps; 0: not known yet */
    _Atomic uint64_t pace;  /* thousandths of the clock's time that a second of work took, 0: not known yet */
    _Atomic uint64_t begun; /* when the first tile began, by that clock; or: */
};
#define PROGRESS_ESTIMATE_WANTED UINT64_MAX /* before the render: the estimate is needed */

/* No measurement yet; `wanted` or not. */
void progress_estimate_reset(struct progress_estimate *progress_estimate, bool wanted);
/* Whether an estimate was requested before the render. */
bool progress_estimate_is_wanted(const struct progress_estimate *progress_estimate);
/* Sets the work done and the work left, in the same unit; the share never decreases. */
void progress_estimate_report(struct progress_estimate *progress_estimate, double done, double left, uint64_t now);
/* Wall-clock seconds for a second of work if other programs also use the processor; 1 if unknown. */
double progress_estimate_pace(const struct progress_estimate *progress_estimate);
/* 0..1; negative while nothing is known. */
double progress_estimate_share(const struct progress_estimate *progress_estimate);
/* Seconds left at a time of that clock; negative: not known yet. */
double progress_estimate_left(const struct progress_estimate *progress_estimate, double now);

#endif
