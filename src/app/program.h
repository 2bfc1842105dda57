/* The whole program, for both of its mains. */
#ifndef GRAY_APP_PROGRAM_H
#define GRAY_APP_PROGRAM_H

#include "app/farm.h"

/* Returns the exit status. transport: how the processes of a farm reach each other, or NULL; used under --mpi only. */
int program_run(int argc, char **argv, const struct farm_transport *transport);

#endif
