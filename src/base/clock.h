/* Clocks of the system, for statistics, estimates and limits; no pixel depends on them. */
#ifndef GRAY_BASE_CLOCK_H
#define GRAY_BASE_CLOCK_H

#include <stdint.h>
#include <time.h>

static inline uint64_t clock_nanoseconds(clockid_t clock) {
    struct timespec now;
    (void)clock_gettime(clock, &now);
    return (uint64_t)now.tv_sec * UINT64_C(1000000000) + (uint64_t)now.tv_nsec;
}

/* clock: CLOCK_MONOTONIC, or the processor time of the process or the thread. */
static inline double clock_seconds(clockid_t clock) {
    struct timespec now;
    (void)clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Seconds of the clock that never jumps. */
static inline double clock_now(void) {
    return clock_seconds(CLOCK_MONOTONIC);
}

#endif
