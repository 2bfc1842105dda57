/* The child: runs the scripts and makes their pictures. It opens no file for writing and owns no terminal; what it
 * needs of those it asks for through child_services, which is the channel to the supervisor or, with --no-fork, the
 * desk itself. */
#ifndef GRAY_APP_CHILD_H
#define GRAY_APP_CHILD_H

#include "app/options.h"
#include "app/services.h"

/* Runs the scripts from number `first` on, one after the other; stops early after wrong usage or when cancelled. */
void child_run(const struct options *options, const struct child_services *services, int first);

#endif
