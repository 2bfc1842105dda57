/* How much of the work of a picture is done, and when it will be over: not how many tiles, but what they cost
 * (docs/progress.md). */
#ifndef GRAY_RENDER_TIME_ESTIMATE_H
#define GRAY_RENDER_TIME_ESTIMATE_H

#include "math/portable.h"

#include <math.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/* Shared memory: the other process may read while it is written. Times are seconds of the clock that never jumps. */
struct progress_estimate {
    _Atomic bool wanted;  /* the estimate is needed; set before the render */
    _Atomic double begun; /* when the first tile began; 0: nothing is known yet */
    _Atomic double share; /* of the work, 0..1; it never decreases */
    _Atomic double ends;  /* 0: not known yet */
};
/* Before a render. */
static inline void progress_estimate_reset(struct progress_estimate *estimate, bool wanted) {
    estimate->wanted = wanted;
    estimate->begun = estimate->share = estimate->ends = 0;
}
/* The work done and the work left, in the same unit. */
static inline void progress_estimate_report(struct progress_estimate *estimate, double done, double left, double now) {
    if (!(done > 0))
        return;
    estimate->share = math_max(estimate->share, done / (done + left));
    estimate->ends = now + (now - estimate->begun) * left / done;
}
/* 0..1; negative while nothing is known. */
static inline double progress_estimate_share(const struct progress_estimate *estimate) {
    return estimate->begun > 0 ? math_min(math_max(estimate->share, 0), 1) : -1;
}
/* Seconds left; negative: not known yet. */
static inline double progress_estimate_left(const struct progress_estimate *estimate, double now) {
    return estimate->ends > 0 ? math_min(math_max(estimate->ends - now, 0), 1e9) : -1;
}

/* What the tiles of a picture have cost so far; from it follows what the rest will cost. */
struct tile_cost {
    double pixels;         /* 0: not made in this run */
    _Atomic uint64_t cost; /* processor time in nanoseconds */
    _Atomic uint32_t part; /* of its work, that is done: TILE_COST_WHOLE means all of it */
};
enum { TILE_COST_WHOLE = 1 << 24 };
struct time_estimate {
    uint32_t count, across; /* tiles are numbered row by row */
    struct tile_cost *tiles;
    int waiting; /* workers that may wait for one tile at the end */
};
/* The costs of what is done and of what is left; done is 0 while nothing is known. At any time, from any thread. */
struct time_estimate_work {
    double done, left;
};
struct time_estimate_work time_estimate_work(const struct time_estimate *estimate);

/* In a render (render_internal.h): the estimate, if it is requested, before the first tile; false: no memory. */
struct renderer;
struct worker;
bool renderer_begin_estimate(struct renderer *renderer);
/* The worker begins a tile, or that share of it; so much of its work is done; it ends. */
void renderer_tile_begins(struct renderer *renderer, struct worker *worker, uint32_t tile, double share);
void renderer_tile_goes_on(struct renderer *renderer, struct worker *worker, double part);
void renderer_tile_ends(struct renderer *renderer, struct worker *worker);
/* In place of the three: a device has made this share of the tile, in so many seconds. */
void renderer_tile_was_made(struct renderer *renderer, uint32_t tile, double share, double seconds);

#endif
