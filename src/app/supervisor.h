/* The supervisor: forks the child that runs the scripts, answers it, listens for signals, and survives it. */
#ifndef GRAY_APP_SUPERVISOR_H
#define GRAY_APP_SUPERVISOR_H

#include "app/farm.h"
#include "app/options.h"

/* Makes every picture of every script; returns the exit status of the program. The process must have no threads but
 * those of the transport, which is NULL when this process works alone. */
int supervisor_run(const struct options *options, const struct farm_transport *transport);
/* The same in this one process, for debuggers (--no-fork): a crash is a crash, Ctrl-C ends it at once. */
int supervisor_run_without_fork(const struct options *options);

#endif
