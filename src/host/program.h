/* The whole program, called by the main functions of gray, gray-gui and gray-mpi. */
#ifndef GRAY_HOST_PROGRAM_H
#define GRAY_HOST_PROGRAM_H

#include "output/farm.h"
#include "window/window.h"

/* Features that only some of the programs have; used with the option that requests them. */
struct program_parts {
    const struct farm_transport *transport; /* the transport between the processes of a farm: --mpi */
    const struct window_driver *window;     /* -gui */
};

/* Returns the exit status. */
int program_run(int argc, char **argv, const struct program_parts *parts);

#endif
