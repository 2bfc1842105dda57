/* Everything in one process, for debuggers (--no-fork): nothing survives a crash, Ctrl-C ends the program at once. */
#ifndef GRAY_HOST_IN_PROCESS_H
#define GRAY_HOST_IN_PROCESS_H

#include "session/options.h"

/* Makes every picture of every script; returns the exit status of the program. */
int in_process_run(const struct options *options);

#endif
