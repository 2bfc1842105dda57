/* How much of the work of a picture is done: not how many tiles, but what they cost. Before the first tile 16 rays go
 * through each; their time says what the tile will take in proportion to the others (docs/progress.md). Shared memory:
 * somebody else may read while it is written. */
#ifndef GRAY_RENDER_OUTLOOK_H
#define GRAY_RENDER_OUTLOOK_H

#include <stdatomic.h>
#include <stdint.h>

struct outlook {
    _Atomic uint64_t all;   /* nanoseconds of the rays for what is to be made; 0: nothing is known yet */
    _Atomic uint64_t done;  /* of that, tiles under way by half */
    _Atomic uint64_t begun; /* when the first tile began, nanoseconds of the clock that never jumps; or: */
};
#define OUTLOOK_WANTED UINT64_MAX /* before the render: somebody will ask */

/* 0..1; negative while nothing is known. */
double outlook_share(const struct outlook *outlook);
/* Seconds left at a time of that clock; negative: not known yet. */
double outlook_left(const struct outlook *outlook, double now);

#endif
