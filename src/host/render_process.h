/* The child: runs the scripts and makes their pictures. It opens no file for writing and owns no terminal; what it
 * needs of those it asks for through host_services, which is the channel to the supervisor or, with --no-fork, the
 * desk itself. */
#ifndef GRAY_HOST_RENDER_PROCESS_H
#define GRAY_HOST_RENDER_PROCESS_H

#include "session/options.h"
#include "session/services.h"

/* Runs the scripts from number `first` on, one after the other; stops early after wrong usage or when cancelled. */
void render_process_run(const struct options *options, const struct host_services *services, int first);

#endif
