/* Signals are blocked and read from a descriptor beside the channel, so that no handler changes any state. */
#define _GNU_SOURCE
#include "host/supervisor_signals.h"

#include "base/clock.h"
#include "base/fault.h"
#include "session/text.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/signalfd.h>
#include <unistd.h>

/* SIGINT, SIGTERM and SIGHUP are read from a descriptor, except those that the parent process set to be ignored. A
 * write to a closed pipe or past a size limit is an error like any other, not the end of the process. */
bool supervisor_listen(struct supervisor *supervisor, struct error *error) {
    static const int wanted[] = {SIGINT, SIGTERM, SIGHUP, SIGUSR1};
    sigset_t set;
    (void)sigemptyset(&set);
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        struct sigaction action;
        if (sigaction(wanted[i], NULL, &action) == 0 && action.sa_handler != SIG_IGN)
            (void)sigaddset(&set, wanted[i]);
    }
    (void)signal(SIGPIPE, SIG_IGN);
    (void)signal(SIGXFSZ, SIG_IGN);
    (void)sigprocmask(SIG_BLOCK, &set, &supervisor->signals_before);
    supervisor->signals = MAY_FAIL(signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK));
    if (supervisor->signals < 0)
        return error_set(error, ERROR_MACHINE, "gray: signals cannot be received: %s", strerror(errno));
    return true;
}

/* The first Ctrl-C with --checkpoint: tiles in progress are finished. */
static bool finish_tiles(struct supervisor *supervisor) {
    const struct options *options = supervisor->options;
    const struct picture *picture = &supervisor->output.current;
    bool wanted = options->checkpoint && picture->open && !picture->request.check && !supervisor->output.farm &&
                  !supervisor->window && !options->watch && atomic_load(&supervisor->control->tiles) > 0;
    if (!wanted || supervisor->finishing || supervisor->deadline > 0)
        return false;
    supervisor->stop = supervisor->finishing = true;
    supervisor_note_status(supervisor, ERROR_CANCELLED);
    atomic_store(&supervisor->control->drain, 1);
    output_say(&supervisor->output, LINE_ERROR,
               "gray: interrupted, %s is not written; tiles under way are finished (Ctrl-C again: at once)",
               picture->name);
    return true;
}

void supervisor_interrupt(struct supervisor *supervisor) {
    if (supervisor->deadline > 0 && !supervisor->restarts) {
        if (supervisor->child > 0)
            (void)kill(supervisor->child, SIGKILL);
        return;
    }
    supervisor->stop = supervisor->ended = supervisor->streams.ended = true;
    supervisor->restarts = false;
    if (supervisor->all_written)
        atomic_store(&supervisor->control->cancel, 1);
    if (supervisor->waits || supervisor->all_written) /* nothing is interrupted: it is how watching ends */
        return;
    supervisor->deadline = clock_now() + supervisor_patience;
    supervisor_note_status(supervisor, ERROR_CANCELLED);
    supervisor->output.interrupted = true;
    atomic_store(&supervisor->control->cancel, 1);
    const struct output_session *output = &supervisor->output;
    const struct picture *picture = output->current.open ? &output->current : output->held.open ? &output->held : NULL;
    if (!picture || (supervisor->viewer.window.open && supervisor->viewer.written)) {
        output_report(&supervisor->output, LINE_ERROR, "gray: interrupted");
        return;
    }
    output_say(&supervisor->output, LINE_ERROR, "gray: interrupted, %s is not written", picture->name);
}

void supervisor_read_signals(struct supervisor *supervisor) {
    struct signalfd_siginfo info;
    while (read(supervisor->signals, &info, sizeof info) == (ssize_t)sizeof info) {
        if (info.ssi_signo == SIGUSR1 && supervisor->all_written)
            continue;
        if (info.ssi_signo == SIGUSR1)
            output_write_checkpoint(&supervisor->output);
        else if (info.ssi_signo != SIGINT || !finish_tiles(supervisor))
            supervisor_interrupt(supervisor);
    }
}

/* While a picture waits for the reader of a pipe. */
bool supervisor_is_stopped(void *context) {
    struct supervisor *supervisor = context;
    supervisor_read_signals(supervisor);
    return supervisor->ended || supervisor->finishing;
}

/* Waits until standard error takes text, for a signal meanwhile: a reader that has stopped must not keep the run from
 * ending. */
bool supervisor_wait_for_reader(void *context) {
    struct supervisor *supervisor = context;
    while (!text_stderr_is_ready()) {
        struct pollfd watched[2] = {{.fd = STDERR_FILENO, .events = POLLOUT},
                                    {.fd = supervisor->signals, .events = POLLIN}};
        if (supervisor->deadline > 0 || supervisor->ended)
            return false;
        if (poll(watched, 2, -1) >= 0 && watched[1].revents)
            supervisor_read_signals(supervisor);
    }
    return true;
}
