/* The render process: runs the scripts and renders their pictures. It opens no file for writing and owns no terminal;
 * host_services does that for it, over the channel to the supervisor or, with --no-fork, in the same process. */
#ifndef GRAY_HOST_RENDER_PROCESS_H
#define GRAY_HOST_RENDER_PROCESS_H

#include "session/options.h"
#include "session/services.h"

/* Runs the scripts from number `first` on, one after the other; stops early after wrong usage or when cancelled. */
void render_process_run(const struct options *options, const struct host_services *services, int first);

#endif
