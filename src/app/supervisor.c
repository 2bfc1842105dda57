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
#include "app/standard_streams.h"
#include "app/text.h"
#include "app/watch.h"
#include "base/fault.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/pool.h"
#include "base/process.h"

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
/* How often in a farm a script is begun anew after its renderer was killed. */
enum { TRIES_MAX = 3 };

struct supervisor {
    const struct options *options;
    struct desk desk;
    const struct window_driver *window; /* or NULL */
    struct live live;                   /* the picture in the window */
    struct watch watch;                 /* --watch */
    struct control *control;            /* shared with the child */
    struct channel channel;             /* to the child */
    pid_t child;
    bool had_child; /* a rendering process was started before */
    int signals;    /* descriptor, or -1 */
    sigset_t signals_before;
    struct standard_streams streams;
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
    bool all_written; /* in a farm: only other ranks are waited for */
    /* In a farm: whether the child stands still. */
    double stall_clock;   /* its clock when it was seen to move last */
    double stalled_for;   /* seconds since then in which it might have moved */
    double stall_checked; /* on progress_clock */
    bool stalled;         /* the child was killed for that */
    /* In a farm: the script that is begun anew. */
    int tries;
    uint32_t pictures_before; /* of desk.pictures, when the script began */
    uint32_t kept;            /* number of the picture that is open since an earlier try, or 0 */
    uint8_t *settled;         /* by number of the picture: 1: nothing is left to do for it */
    uint32_t settled_count;
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
    supervisor->stop = supervisor->ended = supervisor->streams.ended = true;
    supervisor->restarts = false;
    if (supervisor->all_written)
        atomic_store(&supervisor->control->cancel, 1);
    if (supervisor->waits || supervisor->all_written) /* nothing is interrupted: it is how watching ends */
        return;
    supervisor->deadline = progress_clock() + patience;
    note_status(supervisor, ERROR_CANCELLED);
    atomic_store(&supervisor->control->cancel, 1);
    const struct desk *desk = &supervisor->desk;
    const struct picture *picture = desk->current.open ? &desk->current : desk->held.open ? &desk->held : NULL;
    if (!picture) {
        desk_line(&supervisor->desk, LINE_ERROR, "gray: interrupted");
        return;
    }
    char line[NAME_LIMIT + 64];
    (void)snprintf(line, sizeof line, "gray: interrupted, %s is not written", picture->name);
    desk_line(&supervisor->desk, LINE_ERROR, line);
}

static void read_signals(struct supervisor *supervisor) {
    struct signalfd_siginfo info;
    while (read(supervisor->signals, &info, sizeof info) == (ssize_t)sizeof info) {
        if (info.ssi_signo == SIGUSR1 && supervisor->all_written)
            continue;
        if (info.ssi_signo == SIGUSR1)
            desk_checkpoint(&supervisor->desk);
        else if (info.ssi_signo != SIGINT || !finish_tiles(supervisor))
            cancel(supervisor);
    }
}

/* While a picture waits for the reader of a pipe. */
static bool is_stopped(void *context) {
    struct supervisor *supervisor = context;
    read_signals(supervisor);
    return supervisor->ended || supervisor->finishing;
}

/* Waits until standard error takes text, for a signal meanwhile: a reader that has stopped must not keep the run from
 * ending. */
static bool wait_for_reader(void *context) {
    struct supervisor *supervisor = context;
    while (!text_error_is_taken()) {
        struct pollfd watched[2] = {{.fd = STDERR_FILENO, .events = POLLOUT},
                                    {.fd = supervisor->signals, .events = POLLIN}};
        if (supervisor->deadline > 0 || supervisor->ended)
            return false;
        if (poll(watched, 2, -1) >= 0 && watched[1].revents)
            read_signals(supervisor);
    }
    return true;
}

/* The processor time of the child: all of it is the script's while no picture is being made, since then the threads of
 * the pool sleep. */
static double child_clock(const struct supervisor *supervisor) {
    return process_time(supervisor->child);
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

/* What is in force is a detail; what is missing is a warning, once in a run, without the list of folders. */
static void report_confinement(const struct supervisor *supervisor, const struct child_services *services,
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
struct child_work {
    const struct options *options;
    const struct child_services *services;
    int first;
};

static void work_in_child(void *context) {
    const struct child_work *work = context;
    child_run(work->options, work->services, work->first);
}

/* No script can run: one line, and all of them have ended. */
static _Noreturn void give_up(const struct child_work *work, const struct error *error) {
    const struct child_services *services = work->services;
    services->line(services->context, LINE_ERROR, error->text);
    for (int i = work->first; i < work->options->script_count; i++)
        services->script_ended(services->context, i, (int)error->kind);
    _exit(0);
}

/* Whether the child of a farm has stood still for too long: it has used no processor time though it was not short of
 * one. While a picture is open there is always something that it does; a script may wait for whoever reads what it
 * prints, but it does not stop. Time in which this process did not look, since it was stopped itself, does not count.
 */
static bool is_stalled(struct supervisor *supervisor) {
    double limit = supervisor->options->farm_stall, now = progress_clock(), pause = limit / 32;
    double passed = now - supervisor->stall_checked;
    if (!supervisor->desk.farm || limit <= 0 || passed < pause)
        return false;
    double used = child_clock(supervisor);
    enum process_state state = process_state(supervisor->child);
    const struct picture *picture = &supervisor->desk.current;
    bool renders = picture->open && !picture->request.check && !supervisor->kept;
    bool might = state == PROCESS_STOPPED || (state == PROCESS_WAITS && renders);
    supervisor->stall_checked = now;
    supervisor->stalled_for += passed < 2 * pause ? passed : pause;
    if (used > supervisor->stall_clock || !might)
        supervisor->stalled_for = 0;
    supervisor->stall_clock = used;
    return supervisor->stalled_for >= limit;
}

/* What happened to ranks. */
static void show_notes(struct supervisor *supervisor) {
    char line[2048];
    while (supervisor->desk.farm && farm_next_note(supervisor->desk.farm, line, sizeof line))
        desk_line(&supervisor->desk, LINE_WARNING, line);
}

/* Another rank ends with the first one. */
static void leave_abandoned(struct supervisor *supervisor) {
    if (!supervisor->desk.farm || supervisor->ended || !farm_is_abandoned(supervisor->desk.farm))
        return;
    text_print_line(stderr, "gray: the first rank of the farm has been silent for too long, this one ends");
    cancel(supervisor);
    note_status(supervisor, ERROR_CANCELLED);
}

/* In the child, after the fork: never returns. From child_run on this process needs the channel, the memory it gets,
 * and the files that scenes may read: confine_process takes the rest away. */
static _Noreturn void be_child(struct supervisor *supervisor, struct channel channel, pid_t parent) {
    standard_streams_end(&supervisor->streams);
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
    struct child_link link = {.channel = channel};
    struct child_services services = child_link_services(&link, supervisor->control);
    struct child_work work = {supervisor->options, &services, supervisor->next_script};
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
    supervisor->had_child = true;
    supervisor->script_used = 0;
    supervisor->out_of_time = supervisor->stalled = false;
    supervisor->stall_checked = progress_clock();
    supervisor->stall_clock = supervisor->stalled_for = 0;
    script_goes_on(supervisor);
    channel_close(&ends[1]);
    if (supervisor->child > 0)
        return true;
    channel_close(&supervisor->channel);
    return error_set(error, ERROR_MACHINE, "gray: the rendering process cannot be started: %s", strerror(saved));
}

/* Without its answer the child would wait for ever, unless it is gone: that is met at the end of the channel. */
static void note_unsent(struct supervisor *supervisor) {
    struct pollfd peer = {.fd = supervisor->channel.descriptor};
    bool gone = poll(&peer, 1, 0) == 1 && (peer.revents & POLLHUP) != 0;
    supervisor->broken = supervisor->broken || !gone;
}

static void send_answer(struct supervisor *supervisor, enum frame_kind kind, bool ok, bool already,
                        const struct error *error, int descriptor) {
    struct frame_answer answer = {.ok = ok, .already = already};
    if (!ok)
        answer.error = *error;
    if (!channel_send(&supervisor->channel, kind, &answer, sizeof answer, descriptor))
        note_unsent(supervisor);
}

/* The wish to stop a pass is used up; that to stop everything stays. To be called while the child waits for an answer:
 * a wish that comes later is one to stop what it will do then. */
static void forget_stop(const struct supervisor *supervisor) {
    int stop = CANCEL_PASS;
    (void)atomic_compare_exchange_strong(&supervisor->control->cancel, &stop, CANCEL_NOTHING);
}

/* For a script that is begun anew: nothing is left to do for this picture. Without memory it is made again. */
static void settle(struct supervisor *supervisor, uint32_t number) {
    uint32_t room = supervisor->settled_count;
    if (!supervisor->desk.farm)
        return;
    if (number >= room) {
        uint32_t larger = 2 * number + 64;
        uint8_t *settled = mem_resize(supervisor->settled, larger);
        if (!settled)
            return;
        memset(settled + room, 0, larger - room);
        supervisor->settled = settled;
        supervisor->settled_count = larger;
    }
    supervisor->settled[number] = 1;
}

static bool is_settled(const struct supervisor *supervisor, uint32_t number) {
    return number < supervisor->settled_count && supervisor->settled[number];
}

static bool same_picture(const struct picture_request *a, const struct picture_request *b) {
    return a->full_width == b->full_width && a->full_height == b->full_height && a->x0 == b->x0 && a->y0 == b->y0 &&
           a->width == b->width && a->height == b->height && a->layers == b->layers && a->check == b->check &&
           digest_equal(a->files, b->files) && strcmp(a->file, b->file) == 0;
}

/* A script that is begun anew comes to its pictures again; the one that is kept goes on with the tiles it has. False:
 * the picture is made like any other. */
static bool answer_retry(struct supervisor *supervisor, const struct picture_request *request) {
    struct desk *desk = &supervisor->desk;
    struct error error = {0};
    uint32_t number = desk->pictures + 1;
    bool settled = is_settled(supervisor, number);
    if (!supervisor->kept)
        return false;
    desk->pictures = number;
    if (number < supervisor->kept) {
        error_set(&error, ERROR_SCENE, "this picture could not be made before, either");
        send_answer(supervisor, FRAME_FILM, settled, settled, &error, -1);
        return true;
    }
    bool same = same_picture(request, &desk->current.request);
    supervisor->kept = 0;
    if (!same) {
        desk_abandon(desk);
        error_set(&error, ERROR_SCENE,
                  "begun anew after its rendering process was killed, the script makes another picture than before");
    } else {
        outlook_reset(&supervisor->control->outlook, progress_wants_outlook(&desk->progress));
    }
    send_answer(supervisor, FRAME_FILM, same, false, &error, same ? desk->current.memory.descriptor : -1);
    return true;
}

static void answer_begin(struct supervisor *supervisor, const struct frame *frame) {
    struct desk *desk = &supervisor->desk;
    if (answer_retry(supervisor, &frame->body.request))
        return;
    struct error error = {0};
    bool already = live_skips(&supervisor->live, desk->pictures + 1) || is_settled(supervisor, desk->pictures + 1);
    bool ok = desk_begin(desk, &frame->body.request, &already, &error);
    bool film = ok && !already && !frame->body.request.check;
    if (ok && already)
        settle(supervisor, desk->pictures);
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
        note_unsent(supervisor);
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

static void take_home(struct supervisor *supervisor,
                      bool (*take)(const struct live *live, const struct file_target *picture, char *name,
                                   struct error *error)) {
    struct error error;
    char name[NAME_LIMIT], line[NAME_LIMIT + 64];
    const struct file_target picture = {.path = supervisor->live.name, .rules = &supervisor->desk.files.saved};
    bool ok = take(&supervisor->live, &picture, name, &error);
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
    if (ok)
        settle(supervisor, supervisor->desk.pictures);
    if (supervisor->finishing) { /* the tiles under way were the last ones: the picture is whole, and the end is here */
        supervisor->deadline = progress_clock() + patience;
        atomic_store(&supervisor->control->cancel, CANCEL_ALL);
    }
    send_answer(supervisor, FRAME_ANSWER, ok, false, &error, -1);
}

/* A script that was begun anew has ended before it came to its picture again. */
static void drop_kept(struct supervisor *supervisor, const struct frame_script *script) {
    struct error error;
    error_set(&error, ERROR_SCENE,
              "%.400s: begun anew after its rendering process was killed, the script did not come to %.400s again, "
              "which is not written",
              supervisor->options->scripts[script->index], supervisor->desk.current.name);
    desk_abandon(&supervisor->desk);
    supervisor->kept = 0;
    note_error(supervisor, &error);
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
    supervisor->tries = 0;
    supervisor->pictures_before = supervisor->desk.pictures;
    if (supervisor->kept)
        drop_kept(supervisor, script);
    script_goes_on(supervisor);
    supervisor->stop = supervisor->stop || script->status == ERROR_USAGE || script->status == ERROR_CANCELLED;
    /* What a wish to stop means was noted when it came. */
    if (supervisor->deadline <= 0)
        note_status(supervisor, script->status);
}

static void note_read(struct supervisor *supervisor, const struct frame_read *read) {
    struct error error;
    picture_files_keep(&supervisor->desk.files, read->version.identity, read->written);
    if (read->written)
        return;
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
        error_stream_note_handled(&supervisor->control->error_stream);
        return;
    case FRAME_BEGIN:
        if (current->open && !supervisor->kept)
            break;
        script_stops(supervisor);
        answer_begin(supervisor, frame);
        if (!current->open || supervisor->kept)
            script_goes_on(supervisor);
        return;
    case FRAME_DONE:
        if (!current->open || supervisor->kept || current->request.check || supervisor->deadline > 0)
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
        if (!current->open || supervisor->kept)
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
        if (is_stalled(supervisor)) {
            supervisor->stalled = supervisor->deadline == 0;
            break;
        }
        if (watched[1].revents)
            read_signals(supervisor);
        leave_abandoned(supervisor);
        if (supervisor->deadline > 0 && progress_clock() > supervisor->deadline)
            break;
        desk_show_progress(&supervisor->desk);
        show_notes(supervisor);
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
            break;
        if (progress_clock() > limit || supervisor->deadline > 0)
            (void)kill(supervisor->child, SIGKILL);
        (void)nanosleep(&pause, NULL);
    }
    error_stream_free(&supervisor->control->error_stream);
    return how;
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
    else if (supervisor->stalled)
        error_set(&error, ERROR_MACHINE, "%.400s: the rendering process stood still for %g s%s", script,
                  supervisor->options->farm_stall, making);
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

/* In a farm a script whose renderer was killed, by this process or by another one, is begun anew: its pictures that are
 * finished are passed over. The first rank keeps the tiles of the picture that was being made, the others give theirs
 * back. */
static bool tries_again(struct supervisor *supervisor, int how) {
    struct desk *desk = &supervisor->desk;
    char text[512];
    bool killed = WIFSIGNALED(how) && WTERMSIG(how) == SIGKILL;
    if (!desk->farm || !killed || supervisor->out_of_time || supervisor->broken || supervisor->tries >= TRIES_MAX)
        return false;
    if (supervisor->stalled)
        (void)snprintf(
            text, sizeof text,
            "has killed its rendering process, which stood still for %g s (--farm-stall); %.200s begins anew",
            supervisor->options->farm_stall, supervisor->options->scripts[supervisor->next_script]);
    else
        (void)snprintf(text, sizeof text, "has lost its rendering process, which was killed; %.200s begins anew",
                       supervisor->options->scripts[supervisor->next_script]);
    farm_note(desk->farm, text);
    supervisor->tries++;
    if (farm_is_first(desk->farm) && desk->current.open && !desk->current.request.check) {
        farm_take_back_own(desk->farm);
        supervisor->kept = supervisor->kept ? supervisor->kept : desk->pictures;
    } else {
        desk_abandon(desk);
    }
    desk->pictures = supervisor->pictures_before;
    return true;
}

/* What the end of the child means for the scripts that are left. */
static void judge_end(struct supervisor *supervisor, int how) {
    bool all_ended = supervisor->next_script >= supervisor->options->script_count;
    if (supervisor->deadline > 0) {
        /* It was told to stop; how it did does not matter. */
    } else if (!all_ended && !supervisor->stop && tries_again(supervisor, how)) {
        return;
    } else if (!all_ended && !supervisor->stop) {
        tell_death(supervisor, how);
        supervisor->next_script++;
        supervisor->tries = 0;
        supervisor->pictures_before = supervisor->desk.pictures;
    } else if (how != 0) {
        struct error error;
        error_set(&error, ERROR_MACHINE, "gray: the rendering process failed after its work (%s %d)",
                  WIFSIGNALED(how) ? "signal" : "status", WIFSIGNALED(how) ? WTERMSIG(how) : WEXITSTATUS(how));
        note_error(supervisor, &error);
    }
    live_detach(&supervisor->live);
    desk_abandon(&supervisor->desk);
    supervisor->kept = 0;
}

/* A child that is there goes on; another one is started where there is none. */
static void run_children(struct supervisor *supervisor) {
    struct error error;
    bool there = supervisor->child > 0;
    while (supervisor->next_script < supervisor->options->script_count && !supervisor->stop) {
        supervisor->broken = false;
        if (!there && !start_child(supervisor, &error)) {
            note_error(supervisor, &error);
            desk_abandon(&supervisor->desk);
            supervisor->kept = 0;
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

/* Where the farm waits for other ranks. */
static void poll_in_farm(void *context) {
    struct supervisor *supervisor = context;
    read_signals(supervisor);
    show_notes(supervisor);
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
    supervisor->desk.farm = farm_create(transport, 2 * threads, supervisor->options->farm_silence, supervisor->control);
    if (!supervisor->desk.farm)
        return error_no_memory(error, "the farm");
    atomic_store(&supervisor->control->error_stream.mute, transport->rank > 0);
    farm_set_poll(supervisor->desk.farm, poll_in_farm, supervisor);
    return true;
}

/* The first rank stays until the others have ended; all is written before. It also says what became of the pictures:
 * what went wrong on another rank alone is a line, not a status. */
static void end_farm(struct supervisor *supervisor) {
    struct farm *farm = supervisor->desk.farm;
    if (!farm)
        return;
    bool interrupted = supervisor->ended && supervisor->status == ERROR_CANCELLED;
    supervisor->all_written = true;
    if (!farm_is_first(farm) && !interrupted)
        supervisor->status = 0;
    farm_finish(farm, supervisor->status == 0, tell_foreign_line, supervisor);
    leave_abandoned(supervisor);
    show_notes(supervisor);
    farm_destroy(farm);
    supervisor->desk.farm = NULL;
    mem_free(supervisor->settled);
    supervisor->settled = NULL;
}

static int run(struct supervisor *supervisor, const struct farm_transport *transport) {
    const struct options *options = supervisor->options;
    struct error error;
    supervisor->control = mem_share(sizeof *supervisor->control);
    supervisor->live.control = supervisor->control;
    supervisor->live.tells = options->verbose;
    desk_init(&supervisor->desk, options, supervisor->control);
    supervisor->desk.takes_text = wait_for_reader;
    supervisor->desk.takes_context = supervisor;
    bool ready = supervisor->control
                     ? listen_to_signals(supervisor, &error) && start_farm(supervisor, transport, &error) &&
                           (!options->watch || watch_scripts(supervisor, &error))
                     : error_no_memory(&error, "the rendering process");
    if (ready)
        standard_streams_begin(&supervisor->streams);
    desk_set_interrupt(&supervisor->desk, &(struct file_interrupt){supervisor->signals, is_stopped, supervisor});
    desk_tell_trust(&supervisor->desk);
    if (ready)
        run_and_watch(supervisor);
    else
        note_error(supervisor, &error);
    live_end(&supervisor->live);
    if (supervisor->quit_at > 0) {
        char line[80];
        (void)snprintf(line, sizeof line, "gray: the window closed in %.1f ms",
                       1000 * (progress_clock() - supervisor->quit_at));
        desk_line(&supervisor->desk, LINE_DETAIL, line);
    }
    watch_close(&supervisor->watch);
    if (!desk_finish(&supervisor->desk, supervisor->status == 0, &error) && error.kind != ERROR_CANCELLED)
        note_error(supervisor, &error);
    if (!desk_finish_output(&supervisor->desk, &error))
        note_error(supervisor, &error);
    end_farm(supervisor);
    standard_streams_end(&supervisor->streams);
    if (supervisor->signals >= 0)
        (void)close(supervisor->signals);
    mem_unshare(supervisor->control, sizeof *supervisor->control);
    return supervisor->status;
}

/* Not on the stack: that may be a small one. */
int supervisor_run(const struct options *options, const struct program_parts *parts) {
    struct supervisor *supervisor = mem_alloc_zero(1, sizeof *supervisor);
    if (!supervisor) {
        (void)fputs("gray: out of memory\n", stderr);
        return ERROR_MACHINE;
    }
    supervisor->options = options;
    supervisor->window = parts->window;
    supervisor->signals = supervisor->channel.descriptor = -1;
    int status = run(supervisor, parts->transport);
    mem_free(supervisor);
    return status;
}
