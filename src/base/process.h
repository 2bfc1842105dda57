/* The state of another process of the same user, as the kernel shows it. */
#ifndef GRAY_BASE_PROCESS_H
#define GRAY_BASE_PROCESS_H

#include <sys/types.h>

enum process_state {
    PROCESS_UNKNOWN, /* it has ended, or is invisible */
    PROCESS_RUNS,    /* at least one thread runs, or waits for a processor */
    PROCESS_WAITS,   /* every thread is blocked */
    PROCESS_STOPPED, /* every thread is stopped by a signal or a debugger */
};

enum process_state process_state(pid_t pid);
/* Seconds of processor time that all its threads have used; 0 if that is unknown. */
double process_time(pid_t pid);

#endif
