/* How much of the work of a picture is done, and when it will be over: not how many tiles, but what they cost
 * (render/time_estimate.h, docs/progress.md). Shared memory: the other process may read while it is written. */
#ifndef GRAY_RENDER_PROGRESS_ESTIMATE_H
#define GRAY_RENDER_PROGRESS_ESTIMATE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct progress_estimate {
    _Atomic uint64_t share; /* billionths of the work, and 1; 0: nothing is known yet */
    _Atomic uint64_t ends;  /* nanoseconds of the clock that never jumps; 0: not known yet */
    _Atomic uint64_t pace;  /* thousandths of the clock's time that a second of work took, 0: not known yet */
    _Atomic uint64_t begun; /* when the first tile began, by that clock; or: */
};
#define PROGRESS_ESTIMATE_WANTED UINT64_MAX /* before the render: somebody will ask */

/* Nothing is known; somebody will ask, or nobody. */
void progress_estimate_reset(struct progress_estimate *progress_estimate, bool wanted);
/* Whether somebody asked before the render that is told of. */
bool progress_estimate_is_wanted(const struct progress_estimate *progress_estimate);
/* So much is done, out of the same unit so much is left; the share never falls. */
void progress_estimate_report(struct progress_estimate *progress_estimate, double done, double left, uint64_t now);
/* Seconds by the clock that a second of work takes where other programs want the processor, too; 1 while unknown. */
double progress_estimate_pace(const struct progress_estimate *progress_estimate);
/* 0..1; negative while nothing is known. */
double progress_estimate_share(const struct progress_estimate *progress_estimate);
/* Seconds left at a time of that clock; negative: not known yet. */
double progress_estimate_left(const struct progress_estimate *progress_estimate, double now);

#endif
