/* The whole program, for all of its mains. */
#ifndef GRAY_APP_PROGRAM_H
#define GRAY_APP_PROGRAM_H

#include "app/farm.h"
#include "app/window.h"

/* What only some of the programs have; used under the option that asks for it. */
struct program_parts {
    const struct farm_transport *transport; /* how the processes of a farm reach each other: --mpi */
    const struct window_driver *window;     /* -gui */
};

/* Returns the exit status. */
int program_run(int argc, char **argv, const struct program_parts *parts);

#endif
