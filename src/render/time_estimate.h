/* How much of the work of a picture is done, and when it will be over: not how many tiles, but what they cost
 * (docs/progress.md). */
#ifndef GRAY_RENDER_TIME_ESTIMATE_H
#define GRAY_RENDER_TIME_ESTIMATE_H

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
void progress_estimate_reset(struct progress_estimate *progress_estimate, bool wanted);
/* The work done and the work left, in the same unit. */
void progress_estimate_report(struct progress_estimate *progress_estimate, double done, double left, double now);
/* 0..1; negative while nothing is known. */
double progress_estimate_share(const struct progress_estimate *progress_estimate);
/* Seconds left; negative: not known yet. */
double progress_estimate_left(const struct progress_estimate *progress_estimate, double now);

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

#endif
