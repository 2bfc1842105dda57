/* gray. */
#include "host/program.h"

#include <sys/epoll.h>
#include <unistd.h>

/* A program that was started with closed standard streams must not use their numbers for its own sockets and pictures.
 * Each number is occupied by a descriptor that can be neither read nor written. */
static void occupy_standard_descriptors(void) {
    int descriptor;
    do {
        descriptor = epoll_create1(0);
    } while (descriptor >= 0 && descriptor <= STDERR_FILENO);
    if (descriptor >= 0)
        (void)close(descriptor);
}

int main(int argc, char **argv) {
    occupy_standard_descriptors();
    return program_run(argc, argv, &(struct program_parts){0});
}
