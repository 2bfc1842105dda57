/* gray-mpi: the same program, its processes joined by the Message Passing Interface (MPI 3.1). `gray --mpi` becomes it.
 * Only the supervisor of each rank talks; the processes that run scenes are forked from it and know nothing of MPI. */
#define _GNU_SOURCE
#include "app/program.h"
#include "base/error.h"

#include <mpi.h>
#include <stdlib.h>

static void send_message(void *context, int to, int kind, const void *data, size_t size) {
    (void)context;
    (void)MPI_Send(data, (int)size, MPI_BYTE, to, kind, MPI_COMM_WORLD);
}

static bool receive_message(void *context, int *from, int *kind, void *data, size_t *size) {
    int there = 0, count = 0;
    MPI_Status status;
    (void)context;
    if (MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status) != MPI_SUCCESS || !there)
        return false;
    (void)MPI_Get_count(&status, MPI_BYTE, &count);
    if (count < 0 || (size_t)count > FARM_MESSAGE_LIMIT)
        (void)MPI_Abort(MPI_COMM_WORLD, ERROR_MACHINE); /* not one of ours */
    (void)MPI_Recv(data, count, MPI_BYTE, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    *from = status.MPI_SOURCE;
    *kind = status.MPI_TAG;
    *size = (size_t)count;
    return true;
}

int main(int argc, char **argv) {
    struct farm_transport transport = {.send = send_message, .receive = receive_message};
    /* The forked process never touches what Open MPI warns about (registered memory of fast networks). */
    (void)setenv("OMPI_MCA_mpi_warn_on_fork", "0", 0);
    if (MPI_Init(&argc, &argv) != MPI_SUCCESS)
        return ERROR_MACHINE;
    (void)MPI_Comm_rank(MPI_COMM_WORLD, &transport.rank);
    (void)MPI_Comm_size(MPI_COMM_WORLD, &transport.size);
    int status = program_run(argc, argv, &(struct program_parts){.transport = &transport});
    /* Nobody waits for ranks that were interrupted. */
    if (status == ERROR_CANCELLED)
        (void)MPI_Abort(MPI_COMM_WORLD, status);
    (void)MPI_Finalize();
    return status;
}
