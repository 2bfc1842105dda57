/* One child runs all scripts, so that what one script has read serves the next; when it dies, a new child goes on with
 * the script after the one that was running. The supervisor has no thread while it forks (only while it writes a
 * picture) and keeps no state that a signal handler changes: signals are blocked and read from a descriptor beside the
 * channel. Invariant: files are written by this process alone, and only from a film that the child has declared
 * complete. */
#define _GNU_SOURCE
#include "app/supervisor.h"

#include "app/channel.h"
#include "app/child.h"
#include "app/child_link.h"
#include "app/confine.h"
#include "app/desk.h"
#include "app/live.h"
#include "app/souvenir.h"
#include "app/watch.h"
#include "base/fault.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/pool.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Seconds a cancelled child has to give up politely before it is killed. It writes no files: nothing is lost with it,
 * and giving back the memory of a large scene takes longer than a kill. */
static const double patience = 0.03;
/* The same when the window is closed, which is to be over within 50 milliseconds. */
static const double patience_quit = 0.01;
/* Seconds for the scripts to end before they run again; afterwards the process is started anew. */
static const double patience_again = 0.3;
/* Seconds from the end of the channel to the end of the process. */
static const double farewell = 10;

struct supervisor {
    const struct options *options;
    struct desk desk;
    const struct window_driver *window; /* or NULL */
    struct live live;                   /* the picture in the window */
    struct watch watch;                 /* --watch */
    struct control *control;            /* shared with the child */
    struct channel channel;             /* to the child */
    pid_t child;
    int signals; /* descriptor, or -1 */
    sigset_t signals_before;
    int status;      /* worst so far */
    int next_script; /* the one that runs, or comes next */
    bool stop;       /* no further script */
    bool broken;     /* the child did not keep to the rules of the channel */
    bool finishing;  /* tiles under way are awaited, no others are begun */
    double deadline; /* when the cancelled child is killed; 0: not cancelled */
    bool waits;      /* the child has run all scripts and waits for a change */
    bool restarts;   /* the scripts are cancelled because they will run again */
    double quit_at;  /* when the window was closed, or 0 */
    bool ended;      /* somebody has said so: Ctrl-C, or the window was closed */
    /* The script's own processor time: the child's clock while no picture is being made. */
    double script_used;  /* seconds of earlier stretches of the script that runs */
    double script_since; /* the child's clock when this stretch began */
    bool script_runs;
    bool out_of_time; /* the child was killed for that */
};

static void note_status(struct supervisor *supervisor, int status) {
    if (status > supervisor->status)
        supervisor->status = status;
}

/* In the terminal, and what is wrong in the window, too. */
static void tell(struct supervisor *supervisor, enum line_kind kind, const char *text) {
    desk_line(&supervisor->desk, kind, text);
    if (kind == LINE_ERROR)
        live_tell(&supervisor->live, text);
    if (kind == LINE_OUTPUT)
        live_hear(&supervisor->live, text);
}

static void note_error(struct supervisor *supervisor, const struct error *error) {
    tell(supervisor, LINE_ERROR, error->text);
    note_status(supervisor, (int)error->kind);
}

/* SIGINT, SIGTERM and SIGHUP are read from a descriptor, except those that whoever started us wanted ignored. A write
 * to a closed pipe or past a size limit is an error like any other, not the end of the process. */
static bool listen_to_signals(struct supervisor *supervisor, struct error *error) {
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

/* The first Ctrl-C, where somebody wants the tiles: those under way are finished. Else nothing would become of them. */
static bool finish_tiles(struct supervisor *supervisor) {
    const struct options *options = supervisor->options;
    const struct picture *picture = &supervisor->desk.current;
    bool wanted = (options->checkpoint || options->partial) && picture->open && !picture->request.check &&
                  !supervisor->desk.farm && !supervisor->window && !options->watch &&
                  atomic_load(&supervisor->control->tiles) > 0;
    char line[NAME_LIMIT + 160];
    if (!wanted || supervisor->finishing || supervisor->deadline > 0)
        return false;
    supervisor->stop = supervisor->finishing = true;
    note_status(supervisor, ERROR_CANCELLED);
    atomic_store(&supervisor->control->enough, 1);
    (void)snprintf(line, sizeof line,
                   "gray: interrupted, %s is not written; tiles under way are finished (once more: at once)",
                   picture->name);
    desk_line(&supervisor->desk, LINE_ERROR, line);
    return true;
}

static void cancel(struct supervisor *supervisor) {
    if (supervisor->deadline > 0 && !supervisor->restarts) {
        if (supervisor->child > 0)
            (void)kill(supervisor->child, SIGKILL);
        return;
    }
    supervisor->stop = supervisor->ended = true;
    supervisor->restarts = false;
    if (supervisor->waits) /* nothing is interrupted: it is how watching ends */
        return;
    supervisor->deadline = progress_clock() + patience;
    note_status(supervisor, ERROR_CANCELLED);
    atomic_store(&supervisor->control->cancel, 1);
    if (!supervisor->desk.current.open) {
        desk_line(&supervisor->desk, LINE_ERROR, "gray: interrupted");
        return;
    }
    char line[NAME_LIMIT + 64];
    (void)snprintf(line, sizeof line, "gray: interrupted, %s is not written", supervisor->desk.current.name);
    desk_line(&supervisor->desk, LINE_ERROR, line);
}

static void read_signals(struct supervisor *supervisor) {
    struct signalfd_siginfo info;
    while (read(supervisor->signals, &info, sizeof info) == (ssize_t)sizeof info) {
        if (info.ssi_signo == SIGUSR1)
            desk_checkpoint(&supervisor->desk);
        else if (info.ssi_signo != SIGINT || !finish_tiles(supervisor))
            cancel(supervisor);
    }
}

/* The processor time of the child: all of it is the script's while no picture is being made, since then the threads of
 * the pool sleep. */
static double child_clock(const struct supervisor *supervisor) {
    clockid_t clock;
    struct timespec now;
    if (clock_getcpuclockid(supervisor->child, &clock) != 0 || clock_gettime(clock, &now) != 0)
        return 0;
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double script_time(const struct supervisor *supervisor) {
    double running = supervisor->script_runs ? child_clock(supervisor) - supervisor->script_since : 0;
    return supervisor->script_used + (running > 0 ? running : 0);
}

static void script_stops(struct supervisor *supervisor) {
    supervisor->script_used = script_time(supervisor);
    supervisor->script_runs = false;
}

static void script_goes_on(struct supervisor *supervisor) {
    supervisor->script_since = child_clock(supervisor);
    supervisor->script_runs = true;
}

/* Milliseconds until the script could have used up its time and did not notice; the process itself ends it a little
 * earlier, with its line, unless it is inside one of Lua's own functions. -1: no limit. 0: it has. */
static int script_patience(const struct supervisor *supervisor) {
    double limit = script_time_limit(&supervisor->options->script);
    if (limit <= 0 || !supervisor->script_runs)
        return -1;
    double left = limit * 1.03 + 0.005 - script_time(supervisor);
    return left <= 0 ? 0 : left > 1000 ? 1000000 : (int)(left * 1000) + 1;
}

/* In the child, after the fork: never returns. From child_run on this process needs the channel, the memory it gets,
 * and the files that scenes may read: confine_process takes the rest away. */
static _Noreturn void be_child(struct supervisor *supervisor, struct channel channel, pid_t parent) {
    (void)close(supervisor->signals);
    watch_close(&supervisor->watch);
    channel_close(&supervisor->channel);
    display_close(&supervisor->desk.display);
    /* Ctrl-C reaches the whole group; the supervisor passes on what it means. */
    (void)signal(SIGINT, SIG_IGN);
    (void)signal(SIGTERM, SIG_IGN);
    (void)signal(SIGHUP, SIG_IGN);
    (void)signal(SIGUSR1, SIG_IGN);
    (void)sigprocmask(SIG_SETMASK, &supervisor->signals_before, NULL);
    /* Without its supervisor the child is of no use. */
    if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent)
        _exit(ERROR_MACHINE);
    (void)setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    pool_raise_stack();
    struct child_link link = {.channel = channel};
    struct child_services services = child_link_services(&link, supervisor->control);
    const char *output = supervisor->options->output;
    if (output && strcmp(output, "-") == 0) /* standard output is the picture's: what scripts print goes beside it */
        (void)dup2(STDERR_FILENO, STDOUT_FILENO);
    if (!supervisor->options->script.no_sandbox) {
        struct error error;
        char report[4096];
        (void)file_null_input();
        if (!confine_process(supervisor->options, channel.descriptor, report, sizeof report, &error)) {
            services.line(services.context, LINE_ERROR, error.text);
            services.script_ended(services.context, supervisor->next_script, (int)error.kind);
            _exit(0);
        }
        services.line(services.context, LINE_DETAIL, report);
    }
    child_run(supervisor->options, &services, supervisor->next_script);
    child_link_close(&link);
    exit(link.broken ? ERROR_MACHINE : 0);
}

static bool start_child(struct supervisor *supervisor, struct error *error) {
    struct channel ends[2];
    if (!channel_pair(ends, error))
        return false;
    (void)fflush(NULL);
    pid_t parent = getpid();
    supervisor->channel = ends[0];
    supervisor->child = MAY_FAIL(fork());
    if (supervisor->child == 0)
        be_child(supervisor, ends[1], parent);
    int saved = errno;
    supervisor->script_used = 0;
    supervisor->out_of_time = false;
    script_goes_on(supervisor);
    channel_close(&ends[1]);
    if (supervisor->child > 0)
        return true;
    channel_close(&supervisor->channel);
    return error_set(error, ERROR_MACHINE, "gray: the rendering process cannot be started: %s", strerror(saved));
}

static void send_answer(struct supervisor *supervisor, enum frame_kind kind, bool ok, bool already,
                        const struct error *error, int descriptor) {
    struct frame_answer answer = {.ok = ok, .already = already};
    if (!ok)
        answer.error = *error;
    /* Without its answer the child would wait for ever. */
    if (!channel_send(&supervisor->channel, kind, &answer, sizeof answer, descriptor))
        supervisor->broken = true;
}

/* The wish to stop a pass is used up; that to stop everything stays. To be called while the child waits for an answer:
 * a wish that comes later is one to stop what it will do then. */
static void forget_stop(const struct supervisor *supervisor) {
    int stop = CANCEL_PASS;
    (void)atomic_compare_exchange_strong(&supervisor->control->cancel, &stop, CANCEL_NOTHING);
}

static void answer_begin(struct supervisor *supervisor, const struct frame *frame) {
    struct desk *desk = &supervisor->desk;
    struct error error = {0};
    bool already = live_skips(&supervisor->live, desk->pictures + 1);
    bool ok = desk_begin(desk, &frame->body.request, &already, &error);
    bool film = ok && !already && !frame->body.request.check;
    supervisor->live.number = film ? desk->pictures : supervisor->live.number;
    if (film && supervisor->window &&
        !live_begin(&supervisor->live, supervisor->window, &desk->current.request, desk->current.memory.block,
                    desk->current.name, progress_clock(), &error)) {
        desk_abandon(desk);
        film = ok = false;
    }
    forget_stop(supervisor);
    send_answer(supervisor, FRAME_FILM, ok, already, &error, film ? desk->current.memory.descriptor : -1);
}

static void send_order(struct supervisor *supervisor, const struct studio_order *order) {
    supervisor->live.waiting = false;
    forget_stop(supervisor);
    if (!channel_send(&supervisor->channel, FRAME_ORDER, order, sizeof *order, -1))
        supervisor->broken = true;
}

static void end_picture(struct supervisor *supervisor, bool quit) {
    const struct studio_order order = {.kind = ORDER_END, .quit = quit};
    send_order(supervisor, &order);
}

/* No picture is lost by closing the window: it is there already, or people did not wait for it. */
static void quit_window(struct supervisor *supervisor) {
    supervisor->ended = true;
    supervisor->quit_at = progress_clock();
    if (supervisor->deadline > 0 || supervisor->waits)
        return;
    supervisor->stop = true;
    supervisor->deadline = progress_clock() + patience_quit;
    atomic_store(&supervisor->control->cancel, CANCEL_ALL);
    if (!supervisor->live.written)
        note_status(supervisor, ERROR_CANCELLED);
    if (supervisor->live.waiting)
        end_picture(supervisor, true);
}

/* The scripts are ended, to run again: what they read has changed. */
static void restart(struct supervisor *supervisor) {
    if (supervisor->deadline > 0)
        return;
    supervisor->stop = supervisor->restarts = true;
    supervisor->deadline = progress_clock() + patience_again;
    atomic_store(&supervisor->control->cancel, CANCEL_ALL);
    live_keep(&supervisor->live);
    if (supervisor->live.waiting)
        end_picture(supervisor, true);
}

static void take_home(struct supervisor *supervisor, bool (*take)(const struct live *live, const char *picture_name,
                                                                  char *name, struct error *error)) {
    struct error error;
    char name[NAME_LIMIT], line[NAME_LIMIT + 64];
    bool ok = take(&supervisor->live, supervisor->live.name, name, &error);
    (void)snprintf(line, sizeof line, ok ? "gray: notice: %s is written" : "%s", ok ? name : error.text);
    desk_line(&supervisor->desk, ok ? LINE_NOTICE : LINE_ERROR, line);
}

static void step_window(struct supervisor *supervisor) {
    struct live *live = &supervisor->live;
    struct error error;
    int nothing = CANCEL_NOTHING;
    while (live->open && supervisor->deadline <= 0) {
        switch (live_step(live, progress_clock())) {
        case LIVE_NOTHING:
            return;
        case LIVE_STOP:
            (void)atomic_compare_exchange_strong(&supervisor->control->cancel, &nothing, CANCEL_PASS);
            return;
        case LIVE_ORDER:
            send_order(supervisor, &live->order);
            break;
        case LIVE_WRITE:
            if (!desk_write(&supervisor->desk, &error))
                note_error(supervisor, &error);
            break;
        case LIVE_SAVE:
            take_home(supervisor, souvenir_picture);
            break;
        case LIVE_RECORD:
            take_home(supervisor, souvenir_camera);
            break;
        case LIVE_CHANGES:
            take_home(supervisor, souvenir_changes);
            break;
        case LIVE_NOTE:
            desk_line(&supervisor->desk, LINE_DETAIL, live->note);
            live->note[0] = '\0';
            break;
        case LIVE_NEXT:
            end_picture(supervisor, false);
            return;
        case LIVE_QUIT:
            quit_window(supervisor);
            return;
        }
    }
}

static void answer_done(struct supervisor *supervisor, const struct frame *frame) {
    struct error error = {0};
    live_detach(&supervisor->live);
    bool ok = desk_done(&supervisor->desk, &frame->body.report, &error);
    if (supervisor->finishing) { /* the tiles under way were the last ones: the picture is whole, and the end is here */
        supervisor->deadline = progress_clock() + patience;
        atomic_store(&supervisor->control->cancel, CANCEL_ALL);
    }
    send_answer(supervisor, FRAME_ANSWER, ok, false, &error, -1);
}

static void note_script(struct supervisor *supervisor, const struct frame_script *script) {
    static const int known[] = {0, ERROR_SCENE, ERROR_USAGE, ERROR_MACHINE, ERROR_CANCELLED};
    bool sound = script->index == supervisor->next_script && script->index < supervisor->options->script_count;
    bool is_known = false;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        is_known = is_known || script->status == known[i];
    if (!sound || !is_known) {
        supervisor->broken = true;
        return;
    }
    supervisor->next_script++;
    supervisor->script_used = 0;
    script_goes_on(supervisor);
    supervisor->stop = supervisor->stop || script->status == ERROR_USAGE || script->status == ERROR_CANCELLED;
    /* What a wish to stop means was noted when it came. */
    if (supervisor->deadline <= 0)
        note_status(supervisor, script->status);
}

static void note_read(struct supervisor *supervisor, const struct frame_read *read) {
    struct error error;
    if (supervisor->watch.open && !watch_add(&supervisor->watch, read->path, &read->version, progress_clock())) {
        (void)error_no_memory(&error, "the list of files that are watched");
        note_error(supervisor, &error);
    }
}

/* A frame out of turn (a second picture before the first is finished ...) is not answered: it breaks the rules. */
static void take_frame(struct supervisor *supervisor, const struct frame *frame) {
    const struct picture *current = &supervisor->desk.current;
    switch (frame->kind) {
    case FRAME_LINE:
        tell(supervisor, frame->body.line.kind, frame->body.line.text);
        return;
    case FRAME_BEGIN:
        if (current->open)
            break;
        script_stops(supervisor);
        answer_begin(supervisor, frame);
        if (!current->open)
            script_goes_on(supervisor);
        return;
    case FRAME_DONE:
        if (!current->open || current->request.check || supervisor->deadline > 0)
            break;
        script_goes_on(supervisor);
        answer_done(supervisor, frame);
        return;
    case FRAME_NEWS:
        if (!current->open || !supervisor->window || supervisor->live.waiting)
            break;
        live_take_news(&supervisor->live, &frame->body.news, progress_clock());
        if (supervisor->deadline > 0)
            end_picture(supervisor, true);
        return;
    case FRAME_ABANDON:
        if (!current->open)
            break;
        live_detach(&supervisor->live);
        desk_abandon(&supervisor->desk);
        script_goes_on(supervisor);
        return;
    case FRAME_SCRIPT:
        note_script(supervisor, &frame->body.script);
        return;
    case FRAME_READ:
        note_read(supervisor, &frame->body.read);
        return;
    case FRAME_AGAIN:
        if (!supervisor->watch.open || current->open)
            break;
        script_stops(supervisor);
        supervisor->waits = true;
        return;
    case FRAME_FILM:
    case FRAME_ANSWER:
    case FRAME_ORDER:
        break;
    }
    supervisor->broken = true;
}

/* Milliseconds to wait for the next frame at most; -1: until it comes. */
static int poll_time(const struct supervisor *supervisor) {
    if (supervisor->desk.farm)
        return 2;
    if (supervisor->window)
        return 4;
    if (supervisor->deadline > 0)
        return 5;
    return supervisor->desk.current.open || supervisor->watch.open ? 50 : script_patience(supervisor);
}

static bool files_changed(struct supervisor *supervisor) {
    if (!supervisor->watch.open)
        return false;
    watch_read(&supervisor->watch, progress_clock());
    return watch_changed(&supervisor->watch, progress_clock());
}

/* Until the child closes its end, or has nothing more to do until something changes. */
static void talk_to_child(struct supervisor *supervisor) {
    struct frame frame;
    while (!supervisor->broken) {
        struct pollfd watched[2] = {{.fd = supervisor->channel.descriptor, .events = POLLIN},
                                    {.fd = supervisor->signals, .events = POLLIN}};
        if (poll(watched, 2, poll_time(supervisor)) < 0 && errno != EINTR)
            break;
        if (script_patience(supervisor) == 0) {
            supervisor->out_of_time = supervisor->deadline == 0;
            break;
        }
        if (watched[1].revents)
            read_signals(supervisor);
        if (supervisor->deadline > 0 && progress_clock() > supervisor->deadline)
            break;
        desk_show_progress(&supervisor->desk);
        step_window(supervisor);
        if (files_changed(supervisor))
            restart(supervisor);
        if (!watched[0].revents)
            continue;
        enum channel_result result = channel_receive(&supervisor->channel, &frame);
        if (result == CHANNEL_END)
            return;
        if (result == CHANNEL_FRAME)
            take_frame(supervisor, &frame);
        else
            supervisor->broken = true;
        if (supervisor->waits)
            return;
    }
    (void)kill(supervisor->child, SIGKILL);
}

/* The channel is closed before the process is gone: wait, but not for ever. */
static int reap_child(struct supervisor *supervisor) {
    const struct timespec pause = {0, 2000000};
    double limit = progress_clock() + farewell;
    int how = 0;
    for (;;) {
        pid_t got = waitpid(supervisor->child, &how, WNOHANG);
        if (got == supervisor->child || (got < 0 && errno != EINTR))
            return how;
        if (progress_clock() > limit || supervisor->deadline > 0)
            (void)kill(supervisor->child, SIGKILL);
        (void)nanosleep(&pause, NULL);
    }
}

/* The child is gone in the middle of a script. (os.exit in a script ends the script, not the process.) */
static void tell_death(struct supervisor *supervisor, int how) {
    struct error error;
    const struct picture *picture = &supervisor->desk.current;
    const char *script = supervisor->options->scripts[supervisor->next_script];
    char making[NAME_LIMIT + 64] = "";
    if (picture->open)
        (void)snprintf(making, sizeof making, " while it made %.400s, which is not written", picture->name);
    if (supervisor->out_of_time)
        error_set(&error, ERROR_SCENE,
                  "%.400s: the script used up its %g s of processor time (--script-time allows more)", script,
                  script_time_limit(&supervisor->options->script));
    else if (supervisor->broken)
        error_set(&error, ERROR_MACHINE, "%.400s: the rendering process did not keep to its protocol%s", script,
                  making);
    else if (WIFSIGNALED(how) && WTERMSIG(how) == SIGKILL)
        error_set(&error, ERROR_MACHINE, "%.400s: the rendering process was killed%s (out of memory?)", script, making);
    else if (WIFSIGNALED(how))
        error_set(&error, ERROR_MACHINE, "%.400s: the rendering process crashed (signal %d, %s)%s", script,
                  WTERMSIG(how), strsignal(WTERMSIG(how)), making);
    else
        error_set(&error, ERROR_MACHINE, "%.400s: the rendering process ended with status %d%s", script,
                  WEXITSTATUS(how), making);
    note_error(supervisor, &error);
}

/* What the end of the child means for the scripts that are left. */
static void judge_end(struct supervisor *supervisor, int how) {
    bool all_ended = supervisor->next_script >= supervisor->options->script_count;
    if (supervisor->deadline > 0) {
        /* It was told to stop; how it did does not matter. */
    } else if (!all_ended && !supervisor->stop) {
        tell_death(supervisor, how);
        supervisor->next_script++;
    } else if (how != 0) {
        struct error error;
        error_set(&error, ERROR_MACHINE, "gray: the rendering process failed after its work (%s %d)",
                  WIFSIGNALED(how) ? "signal" : "status", WIFSIGNALED(how) ? WTERMSIG(how) : WEXITSTATUS(how));
        note_error(supervisor, &error);
    }
    live_detach(&supervisor->live);
    desk_abandon(&supervisor->desk);
}

/* A child that is there goes on; another one is started where there is none. */
static void run_children(struct supervisor *supervisor) {
    struct error error;
    bool there = supervisor->child > 0;
    while (supervisor->next_script < supervisor->options->script_count && !supervisor->stop) {
        supervisor->broken = false;
        if (!there && !start_child(supervisor, &error)) {
            note_error(supervisor, &error);
            return;
        }
        talk_to_child(supervisor);
        if (supervisor->waits)
            return;
        int how = reap_child(supervisor);
        there = false;
        supervisor->child = 0;
        channel_close(&supervisor->channel);
        judge_end(supervisor, how);
    }
}

/* Between two runs: nothing is rendered, the window shows the last good picture. True when something has changed. */
static bool wait_for_change(struct supervisor *supervisor) {
    supervisor->waits = true;
    watch_settle(&supervisor->watch, supervisor->status != 0, progress_clock());
    if (!supervisor->window && !supervisor->restarts)
        desk_line(&supervisor->desk, LINE_NOTICE, "gray: notice: waiting for changes (Ctrl-C ends)");
    supervisor->stop = false;
    supervisor->deadline = 0;
    while (!supervisor->ended && !supervisor->restarts) {
        struct pollfd watched[2] = {{.fd = supervisor->watch.descriptor, .events = POLLIN},
                                    {.fd = supervisor->signals, .events = POLLIN}};
        /* Not at once: a file that was read while it was written is looked at a second time. */
        (void)poll(watched, 2, supervisor->window ? 4 : supervisor->watch.last > 0 ? 20 : 500);
        if (watched[1].revents)
            read_signals(supervisor);
        step_window(supervisor);
        if (files_changed(supervisor))
            break;
    }
    return !supervisor->ended;
}

/* The child ends, or runs the scripts again: only where no mesh or picture it may have kept has changed. */
static void answer_again(struct supervisor *supervisor, bool again) {
    const struct error none = {0};
    if (supervisor->child <= 0)
        return;
    send_answer(supervisor, FRAME_ANSWER, again, false, &none, -1);
    if (again) {
        script_goes_on(supervisor);
        return;
    }
    (void)reap_child(supervisor);
    supervisor->child = 0;
    channel_close(&supervisor->channel);
}

static bool watch_scripts(struct supervisor *supervisor, struct error *error) {
    if (!watch_open(&supervisor->watch, error))
        return false;
    for (int i = 0; i < supervisor->options->script_count; i++) {
        if (!watch_add(&supervisor->watch, supervisor->options->scripts[i], NULL, progress_clock()))
            return error_no_memory(error, "the list of files that are watched");
    }
    return true;
}

/* Every run is judged by itself; the last one's status is the program's. */
static void run_and_watch(struct supervisor *supervisor) {
    struct error error;
    run_children(supervisor);
    while (supervisor->watch.open && !supervisor->ended) {
        if (!supervisor->restarts && !desk_settle(&supervisor->desk, &error))
            note_error(supervisor, &error);
        if (!wait_for_change(supervisor))
            break;
        supervisor->watch.any = false;
        live_keep(&supervisor->live);
        desk_restart(&supervisor->desk);
        supervisor->restarts = supervisor->waits = supervisor->stop = false;
        supervisor->deadline = 0;
        supervisor->status = supervisor->next_script = 0;
        supervisor->script_used = 0;
        atomic_store(&supervisor->control->cancel, CANCEL_NOTHING);
        answer_again(supervisor, !supervisor->watch.assets_differ);
        run_children(supervisor);
    }
    supervisor->waits = false;
    answer_again(supervisor, false);
}

static void tell_foreign_line(void *context, const char *line) {
    struct supervisor *supervisor = context;
    desk_line(&supervisor->desk, LINE_WARNING, line);
}

static bool start_farm(struct supervisor *supervisor, const struct farm_transport *transport, struct error *error) {
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    uint32_t threads = (uint32_t)(supervisor->options->threads ? supervisor->options->threads : processors);
    if (!transport)
        return true;
    supervisor->desk.farm = farm_create(transport, 2 * threads, supervisor->control);
    return supervisor->desk.farm || error_no_memory(error, "the farm");
}

/* The first rank stays until the others have ended. */
static void end_farm(struct supervisor *supervisor) {
    if (supervisor->desk.farm)
        farm_finish(supervisor->desk.farm, supervisor->status == 0, tell_foreign_line, supervisor);
    farm_destroy(supervisor->desk.farm);
    supervisor->desk.farm = NULL;
}

int supervisor_run(const struct options *options, const struct program_parts *parts) {
    const struct farm_transport *transport = parts->transport;
    struct supervisor supervisor = {
        .options = options, .window = parts->window, .signals = -1, .channel = {.descriptor = -1}};
    struct error error;
    supervisor.control = mem_share(sizeof *supervisor.control);
    supervisor.live.control = supervisor.control;
    supervisor.live.tells = options->verbose;
    desk_init(&supervisor.desk, options, supervisor.control);
    bool ready = supervisor.control
                     ? listen_to_signals(&supervisor, &error) && start_farm(&supervisor, transport, &error) &&
                           (!options->watch || watch_scripts(&supervisor, &error))
                     : error_no_memory(&error, "the rendering process");
    desk_tell_trust(&supervisor.desk);
    if (ready)
        run_and_watch(&supervisor);
    else
        note_error(&supervisor, &error);
    end_farm(&supervisor);
    live_end(&supervisor.live);
    if (supervisor.quit_at > 0) {
        char line[80];
        (void)snprintf(line, sizeof line, "gray: the window closed in %.1f ms",
                       1000 * (progress_clock() - supervisor.quit_at));
        desk_line(&supervisor.desk, LINE_DETAIL, line);
    }
    watch_close(&supervisor.watch);
    if (!desk_finish(&supervisor.desk, supervisor.status == 0, &error))
        note_error(&supervisor, &error);
    if (supervisor.signals >= 0)
        (void)close(supervisor.signals);
    mem_unshare(supervisor.control, sizeof *supervisor.control);
    return supervisor.status;
}
