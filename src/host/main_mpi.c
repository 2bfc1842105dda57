/* gray-mpi: the same program, its processes joined by the Message Passing Interface (MPI 3.1). `gray --mpi` becomes it.
 * Only the supervisor of each rank communicates; the processes that run scenes are forked from it and do not use MPI.
 * Nothing here waits for another rank, which may be stopped or dead: messages are stored until they are sent, incoming
 * messages are received in pieces, and the wait for the end of all ranks is limited. */
#define _GNU_SOURCE
#include "base/clock.h"
#include "base/error.h"
#include "base/mem.h"
#include "host/program.h"

#include <mpi.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

/* A message that is being sent. */
struct transfer {
    struct transfer *next;
    MPI_Request request;
    int from, kind;
    bool broken; /* the sender died during the transfer */
    size_t size;
    unsigned char data[];
};

/* Lists begin with the oldest entry. */
struct queues {
    struct transfer *sent, *coming;
    double patience; /* limit of the wait at the end, in seconds; 0: no limit */
};

static struct transfer *add_transfer(struct transfer **list, size_t size) {
    struct transfer *transfer = mem_alloc(sizeof *transfer + size);
    if (!transfer)
        (void)MPI_Abort(MPI_COMM_WORLD, ERROR_MACHINE);
    while (*list)
        list = &(*list)->next;
    *list = transfer; /* the newest at the end */
    *transfer = (struct transfer){.request = MPI_REQUEST_NULL, .size = size};
    return transfer;
}

static void remove_transfer(struct transfer **link) {
    struct transfer *transfer = *link;
    *link = transfer->next;
    mem_free(transfer);
}

/* True: it was sent or received, or has failed. */
static bool is_through(struct transfer *transfer) {
    int done = 0;
    return MPI_Test(&transfer->request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS || done;
}

static void forget_sent(struct queues *queues) {
    for (struct transfer **link = &queues->sent; *link;) {
        if (is_through(*link))
            remove_transfer(link);
        else
            link = &(*link)->next;
    }
}

static void send_message(void *context, int to, int kind, const void *data, size_t size) {
    struct queues *queues = context;
    forget_sent(queues);
    struct transfer *transfer = add_transfer(&queues->sent, size);
    memcpy(transfer->data, data, size);
    (void)MPI_Isend(transfer->data, (int)size, MPI_BYTE, to, kind, MPI_COMM_WORLD, &transfer->request);
}

/* Begins to receive available messages. */
static void find_messages(struct queues *queues) {
    for (;;) {
        int there = 0, count = 0;
        MPI_Status status;
        MPI_Message message;
        if (MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &message, &status) != MPI_SUCCESS ||
            !there)
            return;
        (void)MPI_Get_count(&status, MPI_BYTE, &count);
        if (count < 0 || (size_t)count > FARM_MESSAGE_LIMIT)
            (void)MPI_Abort(MPI_COMM_WORLD, ERROR_MACHINE); /* not one of ours */
        struct transfer *transfer = add_transfer(&queues->coming, (size_t)count);
        transfer->from = status.MPI_SOURCE;
        transfer->kind = status.MPI_TAG;
        transfer->broken = MPI_Imrecv(transfer->data, count, MPI_BYTE, &message, &transfer->request) != MPI_SUCCESS;
    }
}

/* Whether an older message of the same rank is still being received. */
static bool must_wait(const struct queues *queues, const struct transfer *transfer) {
    for (const struct transfer *older = queues->coming; older != transfer; older = older->next) {
        if (older->from == transfer->from)
            return true;
    }
    return false;
}

static bool receive_message(void *context, int *from, int *kind, void *data, size_t *size) {
    struct queues *queues = context;
    forget_sent(queues);
    find_messages(queues);
    for (struct transfer **link = &queues->coming; *link;) {
        struct transfer *transfer = *link;
        int done = 0;
        if (must_wait(queues, transfer)) {
            link = &transfer->next;
        } else if (transfer->broken || MPI_Test(&transfer->request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS) {
            remove_transfer(link);
        } else if (!done) {
            link = &transfer->next;
        } else {
            *from = transfer->from;
            *kind = transfer->kind;
            *size = transfer->size;
            memcpy(data, transfer->data, transfer->size);
            remove_transfer(link);
            return true;
        }
    }
    return false;
}

static double read_clock(void *context) {
    (void)context;
    return clock_now();
}

static void note_end(void *context, int silent, double patience) {
    struct queues *queues = context;
    queues->patience = silent > 0 ? 0.01 : patience;
}

/* Processes of ranks on this machine: one that is stopped can be woken by the others. */
struct neighbour {
    long pid;
    unsigned long long space; /* of process numbers */
};

/* For the handler of a signal; set before the first one can come. */
static struct {
    int status;
    struct itimerval grace;
    struct neighbour own, *neighbours;
    int count;
} at_end;

static struct neighbour this_process(void) {
    struct stat status;
    return (struct neighbour){getpid(), stat("/proc/self/ns/pid", &status) == 0 ? status.st_ino : 0};
}

static void find_neighbours(void) {
    const struct neighbour own = at_end.own = this_process();
    MPI_Comm machine;
    if (MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine) != MPI_SUCCESS ||
        MPI_Comm_size(machine, &at_end.count) != MPI_SUCCESS)
        at_end.count = 0;
    at_end.neighbours = mem_alloc_zero((size_t)at_end.count, sizeof own);
    if (!at_end.neighbours)
        (void)MPI_Abort(MPI_COMM_WORLD, ERROR_MACHINE);
    if (at_end.count > 0)
        (void)MPI_Allgather(&own, sizeof own, MPI_BYTE, at_end.neighbours, sizeof own, MPI_BYTE, machine);
}

static void leave(int number) {
    (void)number;
    _exit(at_end.status);
}

/* This has no effect on a process that is not stopped. */
static void wake_neighbours(int number) {
    (void)number;
    for (int i = 0; i < at_end.count; i++) {
        if (at_end.neighbours[i].space == at_end.own.space)
            (void)kill((pid_t)at_end.neighbours[i].pid, SIGCONT);
    }
    (void)signal(SIGALRM, leave);
    (void)setitimer(ITIMER_REAL, &at_end.grace, NULL);
}

static struct itimerval timer_of(double seconds) {
    time_t whole = (time_t)seconds;
    return (struct itimerval){.it_value = {whole, (suseconds_t)(1e6 * (seconds - (double)whole))}};
}

/* MPI_Finalize waits for all ranks. All pictures are written by now: a rank that does not arrive is woken, in case it
 * is stopped; if that does not help, the others exit without it. The first rank exits first, since mpirun then kills
 * the others. */
static void finalize(const struct queues *queues, int rank, int status) {
    struct itimerval limit = timer_of(queues->patience);
    at_end.status = status;
    at_end.grace = timer_of(rank == 0 ? 3 : 12);
    (void)fflush(NULL);
    if (queues->patience > 0 && signal(SIGALRM, wake_neighbours) != SIG_ERR)
        (void)setitimer(ITIMER_REAL, &limit, NULL);
    (void)MPI_Finalize();
}

/* Threads of the library begin with signals blocked: signals that end a run are for the supervisor, in the main thread;
 * in any other thread they would end the process at once. */
static bool start_library(int *argc, char ***argv) {
    static const int wanted[] = {SIGINT, SIGTERM, SIGHUP, SIGUSR1};
    sigset_t set, before;
    (void)sigemptyset(&set);
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        (void)sigaddset(&set, wanted[i]);
    (void)sigprocmask(SIG_BLOCK, &set, &before);
    bool ok = MPI_Init(argc, argv) == MPI_SUCCESS;
    (void)sigprocmask(SIG_SETMASK, &before, NULL);
    return ok;
}

int main(int argc, char **argv) {
    struct queues queues = {0};
    struct farm_transport transport = {
        .context = &queues, .send = send_message, .receive = receive_message, .clock = read_clock, .ended = note_end};
    /* The forked process never touches what Open MPI warns about (registered memory of fast networks). */
    (void)setenv("OMPI_MCA_mpi_warn_on_fork", "0", 0);
    if (!start_library(&argc, &argv))
        return ERROR_MACHINE;
    (void)MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    (void)MPI_Comm_rank(MPI_COMM_WORLD, &transport.rank);
    (void)MPI_Comm_size(MPI_COMM_WORLD, &transport.size);
    find_neighbours();
    int status = program_run(argc, argv, &(struct program_parts){.transport = &transport});
    /* Ranks that were interrupted are not waited for. */
    if (status == ERROR_CANCELLED)
        (void)MPI_Abort(MPI_COMM_WORLD, status);
    finalize(&queues, transport.rank, status);
    return status;
}
