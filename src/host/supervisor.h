/* The supervisor: forks the render process, answers its messages, receives signals, and survives it. */
#ifndef GRAY_HOST_SUPERVISOR_H
#define GRAY_HOST_SUPERVISOR_H

#include "host/program.h"
#include "session/options.h"

/* Makes every picture of every script; returns the exit status of the program. The process must have no threads but
 * those of the transport or the window. */
int supervisor_run(const struct options *options, const struct program_parts *parts);

#endif
