/* The whole program, for all of its mains. */
#ifndef GRAY_HOST_PROGRAM_H
#define GRAY_HOST_PROGRAM_H

#include "output/farm.h"
#include "viewer/window.h"

/* What only some of the programs have; used under the option that asks for it. */
struct program_parts {
    const struct farm_transport *transport; /* how the processes of a farm reach each other: --mpi */
    const struct window_driver *window;     /* -gui */
};

/* Returns the exit status. */
int program_run(int argc, char **argv, const struct program_parts *parts);

#endif
