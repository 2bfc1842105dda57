/* How much of the work of a picture is done, and when it will be over: not how many tiles, but what they cost
 * (render/forecast.h, docs/progress.md). Shared memory: the other process may read while it is written. */
#ifndef GRAY_RENDER_OUTLOOK_H
#define GRAY_RENDER_OUTLOOK_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct outlook {
    _Atomic uint64_t share; /* billionths of the work, and 1; 0: nothing is known yet */
    _Atomic uint64_t ends;  /* nanoseconds of the clock that never jumps; 0: not known yet */
    _Atomic uint64_t pace;  /* thousandths of the clock's time that a second of work took, 0: not known yet */
    _Atomic uint64_t begun; /* when the first tile began, by that clock; or: */
};
#define OUTLOOK_WANTED UINT64_MAX /* before the render: somebody will ask */

/* Nothing is known; somebody will ask, or nobody. */
void outlook_reset(struct outlook *outlook, bool wanted);
/* Whether somebody asked before the render that is told of. */
bool outlook_is_asked(const struct outlook *outlook);
/* So much is done, out of the same unit so much is left; the share never falls. */
void outlook_tell(struct outlook *outlook, double done, double left, uint64_t now);
/* Seconds by the clock that a second of work takes where other programs want the processor, too; 1 while unknown. */
double outlook_pace(const struct outlook *outlook);
/* 0..1; negative while nothing is known. */
double outlook_share(const struct outlook *outlook);
/* Seconds left at a time of that clock; negative: not known yet. */
double outlook_left(const struct outlook *outlook, double now);

#endif
