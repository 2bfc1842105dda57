/* The life of the render process: how it is started and confined, how long its script may take, and what its end means.
 * The supervisor has no thread while it forks (only while it writes a picture). */
#define _GNU_SOURCE
#include "host/supervisor_child.h"

#include "base/clock.h"
#include "base/fault.h"
#include "base/pool.h"
#include "base/process.h"
#include "host/channel_services.h"
#include "host/confine.h"
#include "host/render_process.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Seconds from the end of the channel to the end of the process. */
static const double farewell = 10;
/* How often a farm starts a script again after its renderer was killed. */
enum { TRIES_MAX = 3 };

/* The processor time of the child: all of it is the script's while no picture is being made, since then the threads of
 * the pool sleep. */
static double child_clock(const struct supervisor *supervisor) {
    return process_time(supervisor->child);
}

static double script_time(const struct supervisor *supervisor) {
    double running = supervisor->script.runs ? child_clock(supervisor) - supervisor->script.since : 0;
    return supervisor->script.used + (running > 0 ? running : 0);
}

void supervisor_stop_script_clock(struct supervisor *supervisor) {
    supervisor->script.used = script_time(supervisor);
    supervisor->script.runs = false;
}

void supervisor_start_script_clock(struct supervisor *supervisor) {
    supervisor->script.since = child_clock(supervisor);
    supervisor->script.runs = true;
}

/* Milliseconds until the script could have used up its time and did not notice; the process itself ends it a little
 * earlier, with its line, unless it is inside one of Lua's own functions. -1: no limit. 0: it has. */
int supervisor_script_patience(const struct supervisor *supervisor) {
    double limit = script_time_limit(&supervisor->options->script);
    if (limit <= 0 || !supervisor->script.runs)
        return -1;
    double left = limit * 1.03 + 0.005 - script_time(supervisor);
    return left <= 0 ? 0 : left > 1000 ? 1000000 : (int)(left * 1000) + 1;
}

/* What is in force is a detail; what is missing is a warning, once in a run, without the list of folders. */
static void report_confinement(const struct supervisor *supervisor, const struct host_services *services,
                               char *report) {
    static const char warning[] = "gray: warning: ";
    enum line_kind kind = LINE_DETAIL;
    if (strncmp(report, warning, strlen(warning)) == 0 && !supervisor->had_child) {
        kind = LINE_WARNING;
        if (!supervisor->options->verbose)
            report[strcspn(report, ";")] = '\0';
    }
    services->line(services->context, kind, report);
}

/* What runs in the child once it is confined. */
struct process_work {
    const struct options *options;
    const struct host_services *services;
    int first;
};

static void work_in_child(void *context) {
    const struct process_work *work = context;
    render_process_run(work->options, work->services, work->first);
}

/* No script can run: one line, and all of them have ended. */
static _Noreturn void give_up(const struct process_work *work, const struct error *error) {
    const struct host_services *services = work->services;
    services->line(services->context, LINE_ERROR, error->text);
    for (int i = work->first; i < work->options->script_count; i++)
        services->script_ended(services->context, i, (int)error->kind);
    _exit(0);
}

/* Whether the child of a farm has hung for too long: it used no processor time although a processor was available.
 * While a picture is open, the child always has work. A script may wait for the reader of its output, but it must not
 * be stopped. Time in which this process was stopped itself does not count. */
bool supervisor_child_is_stalled(struct supervisor *supervisor) {
    double limit = supervisor->options->farm_stall, now = clock_now(), pause = limit / 32;
    double passed = now - supervisor->stall.checked;
    if (!supervisor->output.farm || limit <= 0 || passed < pause)
        return false;
    double used = child_clock(supervisor);
    enum process_state state = process_state(supervisor->child);
    const struct picture *picture = &supervisor->output.current;
    bool renders = picture->open && !picture->request.check && !supervisor->retry.kept;
    bool might = state == PROCESS_STOPPED || (state == PROCESS_WAITS && renders);
    supervisor->stall.checked = now;
    supervisor->stall.seconds += passed < 2 * pause ? passed : pause;
    if (used > supervisor->stall.clock || !might)
        supervisor->stall.seconds = 0;
    supervisor->stall.clock = used;
    return supervisor->stall.seconds >= limit;
}

void supervisor_leave(struct supervisor *supervisor) {
    standard_streams_end();
    (void)close(supervisor->signals);
    watch_close(&supervisor->watch);
    channel_close(&supervisor->channel);
    display_close(&supervisor->output.display);
    file_lock_forget(&supervisor->output.animation.lock);
    (void)sigprocmask(SIG_SETMASK, &supervisor->signals_before, NULL);
}

void supervisor_begin_child(struct supervisor *supervisor, pid_t parent) {
    /* Ctrl-C reaches the whole group; the supervisor passes on what it means. */
    (void)signal(SIGINT, SIG_IGN);
    (void)signal(SIGTERM, SIG_IGN);
    (void)signal(SIGHUP, SIG_IGN);
    (void)signal(SIGUSR1, SIG_IGN);
    supervisor_leave(supervisor);
    /* Without its supervisor the child is of no use. */
    if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent)
        _exit(ERROR_MACHINE);
}

/* In the child, after the fork: never returns. From render_process_run on this process needs the channel, the memory it
 * gets, and the files that scenes may read: confine_process takes the rest away. */
static _Noreturn void run_as_child(struct supervisor *supervisor, struct channel channel, pid_t parent) {
    supervisor_begin_child(supervisor, parent);
    (void)setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    struct channel_services link = {.channel = channel};
    struct host_services services = channel_services_make(&link, supervisor->control);
    struct process_work work = {supervisor->options, &services, supervisor->next_script};
    struct error error;
    if (options_output_is_stream(supervisor->options)) /* what scripts print goes beside the picture */
        (void)dup2(STDERR_FILENO, STDOUT_FILENO);
    if (!supervisor->options->script.no_sandbox) {
        char report[4096];
        (void)file_null_input();
        if (!confine_process(supervisor->options, channel.descriptor, report, sizeof report, &error))
            give_up(&work, &error);
        report_confinement(supervisor, &services, report);
    }
    if (!pool_call_with_stack(work_in_child, &work, &error))
        give_up(&work, &error);
    channel_services_close(&link);
    exit(link.broken ? ERROR_MACHINE : 0);
}

bool supervisor_start_child(struct supervisor *supervisor, struct error *error) {
    struct channel ends[2];
    if (!channel_pair(ends, error))
        return false;
    (void)fflush(NULL);
    pid_t parent = getpid();
    supervisor->channel = ends[0];
    supervisor->child = MAY_FAIL(fork());
    if (supervisor->child == 0)
        run_as_child(supervisor, ends[1], parent);
    int saved = errno;
    supervisor->had_child = true;
    supervisor->script.used = 0;
    supervisor->script.frames = 0;
    supervisor->script.out_of_time = supervisor->stall.found = false;
    supervisor->stall.checked = clock_now();
    supervisor->stall.clock = supervisor->stall.seconds = 0;
    supervisor_start_script_clock(supervisor);
    channel_close(&ends[1]);
    if (supervisor->child > 0)
        return true;
    channel_close(&supervisor->channel);
    return error_set(error, ERROR_MACHINE, "gray: the render process cannot be started: %s", strerror(saved));
}

/* The channel is closed before the process is gone: wait, but not for ever. */
int supervisor_reap_child(struct supervisor *supervisor) {
    const struct timespec pause = {0, 2000000};
    double limit = clock_now() + farewell;
    int how = 0;
    for (;;) {
        pid_t got = waitpid(supervisor->child, &how, WNOHANG);
        if (got == supervisor->child || (got < 0 && errno != EINTR))
            break;
        if (clock_now() > limit || supervisor->deadline > 0)
            (void)kill(supervisor->child, SIGKILL);
        (void)nanosleep(&pause, NULL);
    }
    error_stream_free(&supervisor->control->error_stream);
    return how;
}

/* The child is gone in the middle of a script. (os.exit in a script ends the script, not the process.) */
static void report_death(struct supervisor *supervisor, int how) {
    struct error error;
    const struct picture *picture = &supervisor->output.current;
    const char *script = supervisor->options->scripts[supervisor->next_script];
    char making[NAME_LIMIT + 64] = "";
    if (picture->open)
        (void)snprintf(making, sizeof making, " while it rendered %.400s, which is not written", picture->name);
    /* The first cause that is known is the reason. */
    if (supervisor->script.out_of_time)
        error_set(&error, ERROR_SCENE,
                  "%.400s: the script used up its %g s of processor time (--script-time allows more)", script,
                  script_time_limit(&supervisor->options->script));
    else if (supervisor->broken)
        error_set(&error, ERROR_MACHINE, "%.400s: the render process violated its protocol%s", script, making);
    else if (supervisor->stall.found)
        error_set(&error, ERROR_MACHINE, "%.400s: the render process hung for %g s%s", script,
                  supervisor->options->farm_stall, making);
    else if (WIFSIGNALED(how) && WTERMSIG(how) == SIGKILL)
        error_set(&error, ERROR_MACHINE, "%.400s: the render process was killed%s (out of memory?)", script, making);
    else if (WIFSIGNALED(how))
        error_set(&error, ERROR_MACHINE, "%.400s: the render process crashed (signal %d, %s)%s", script, WTERMSIG(how),
                  strsignal(WTERMSIG(how)), making);
    else
        error_set(&error, ERROR_MACHINE, "%.400s: the render process ended with status %d%s", script, WEXITSTATUS(how),
                  making);
    supervisor_note_error(supervisor, &error);
}

/* A farm starts a script again whose renderer was killed, by this process or by another one: its pictures that are
 * finished are passed over. The first rank keeps the tiles of the picture that was being made, the others give theirs
 * back. */
static bool tries_again(struct supervisor *supervisor, int how) {
    struct output_session *output = &supervisor->output;
    char text[512];
    bool killed = WIFSIGNALED(how) && WTERMSIG(how) == SIGKILL;
    if (!output->farm || !killed || supervisor->script.out_of_time || supervisor->broken ||
        supervisor->retry.count >= TRIES_MAX)
        return false;
    if (supervisor->stall.found)
        (void)snprintf(text, sizeof text,
                       "has killed its render process, which hung for %g s (--farm-stall); %.200s starts again",
                       supervisor->options->farm_stall, supervisor->options->scripts[supervisor->next_script]);
    else
        (void)snprintf(text, sizeof text, "has lost its render process, which was killed; %.200s starts again",
                       supervisor->options->scripts[supervisor->next_script]);
    farm_note(output->farm, text);
    supervisor->retry.count++;
    /* The first rank keeps the finished tiles of the picture that was being made. */
    if (farm_is_first(output->farm) && output->current.open && !output->current.request.check) {
        farm_take_back_own(output->farm);
        supervisor->retry.kept = supervisor->retry.kept ? supervisor->retry.kept : output->pictures;
    } else {
        output_abandon(output);
    }
    output->pictures = supervisor->retry.pictures_before;
    return true;
}

/* Files are written after the window is closed. */
void supervisor_abandon_picture(struct supervisor *supervisor) {
    struct picture *picture = &supervisor->output.current;
    bool other = supervisor->window && picture->open && !viewer_has_tiles(&supervisor->viewer);
    for (uint32_t tile = 0; other && !picture->request.check && tile < film_tile_count(&picture->film); tile++)
        atomic_store(&picture->film.tiles[tile], FILM_TILE_WANTED);
    viewer_detach(&supervisor->viewer);
    if (supervisor->quit_at > 0)
        viewer_end(&supervisor->viewer);
    output_abandon(&supervisor->output);
}

/* What the end of the child means for the scripts that are left. */
void supervisor_judge_end(struct supervisor *supervisor, int how) {
    bool all_ended = supervisor->next_script >= supervisor->options->script_count;
    if (supervisor->deadline > 0) {
        /* It has received a request to stop; its exit status does not matter. */
    } else if (!all_ended && !supervisor->stop && tries_again(supervisor, how)) {
        return;
    } else if (!all_ended && !supervisor->stop) {
        report_death(supervisor, how);
        supervisor->next_script++;
        supervisor->retry.count = 0;
        supervisor->retry.pictures_before = supervisor->output.pictures;
    } else if (how != 0) {
        struct error error;
        error_set(&error, ERROR_MACHINE, "gray: the render process failed after its work (%s %d)",
                  WIFSIGNALED(how) ? "signal" : "status", WIFSIGNALED(how) ? WTERMSIG(how) : WEXITSTATUS(how));
        supervisor_note_error(supervisor, &error);
    }
    supervisor_abandon_picture(supervisor);
    supervisor->retry.kept = 0;
}
