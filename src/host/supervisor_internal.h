/* What the files of the supervisor share. supervisor.c has the order of events, supervisor_child.c the life of the
 * render process, supervisor_messages.c the answers to it, supervisor_signals.c the signals, supervisor_export.c
 * the models of the window. */
#ifndef GRAY_HOST_SUPERVISOR_INTERNAL_H
#define GRAY_HOST_SUPERVISOR_INTERNAL_H

#include "base/share.h"
#include "formats/list.h"
#include "host/file_watch.h"
#include "host/supervisor.h"
#include "output/output_session.h"
#include "session/messages.h"
#include "session/standard_streams.h"
#include "viewer/viewer.h"

#include <signal.h>
#include <sys/types.h>

/* The processor time of the script that runs: the child's clock while no picture is being made. */
struct script_clock {
    double used;      /* seconds of earlier stretches of the script */
    double since;     /* the child's clock when this stretch began */
    uint64_t frames;  /* that it has begun: each has the whole time */
    bool runs;        /* a time interval is being measured */
    bool out_of_time; /* the child was killed for that */
};

/* In a farm: whether the child hangs. */
struct stall_check {
    double clock;   /* of the child, when it was seen to move last */
    double seconds; /* since then, in which it might have moved */
    double checked; /* on clock_now */
    bool found;     /* the child was killed for that */
};

/* In a farm: the script that starts again after its render process was killed. */
struct script_retry {
    int count;
    uint32_t pictures_before; /* of output.pictures, when the script began */
    uint32_t kept;            /* number of the picture that is open since an earlier try, or 0 */
    uint8_t *settled;         /* by number of the picture: 1: nothing is left to do for it */
    uint32_t settled_count;
};

/* The process that writes a model for the window. */
struct window_export {
    pid_t process;     /* 0: none */
    struct share text; /* what it prints on standard error */
    struct list edits; /* as Lua, while it starts */
    char name[1024];
    double began; /* on clock_now */
    int shown;    /* the seconds since then that the window shows */
};

/* The process that makes samples in place of the threads of the child, of the picture that is open. */
struct device_process {
    pid_t process;     /* 0: none */
    bool asked;        /* there is a descriptor of the scene */
    int scene;         /* its memory, while the child fills it */
    struct share link; /* device/device_link.h */
};

struct supervisor {
    const struct options *options;
    struct options *own_options; /* the same; the user may change settings in the window */
    const char **given;          /* their script.given, by setting; owned */
    bool options_differ;         /* the child does not know them */
    struct output_session output;
    const struct window_driver *window; /* or NULL */
    struct viewer viewer;               /* the picture in the window */
    struct watch watch;                 /* --watch */
    struct control *control;            /* shared with the child */
    struct channel channel;             /* to the child */
    pid_t child;
    bool had_child; /* a render process was started before */
    int signals;    /* descriptor, or -1 */
    sigset_t signals_before;
    struct standard_streams streams;
    int status;         /* worst so far */
    int next_script;    /* the one that runs, or comes next */
    bool stop;          /* no further script */
    bool broken;        /* the render process violated the protocol of the channel */
    bool finishing;     /* waits for tiles in progress and starts no others */
    double deadline;    /* when the cancelled child is killed; 0: not cancelled */
    bool waits;         /* the child has run all scripts and waits for a change */
    bool restarts;      /* the scripts are cancelled because they will run again */
    bool early_refused; /* no window could be opened before the first picture */
    double quit_at;     /* when the window was closed, or 0 */
    bool ended;         /* by Ctrl-C, or the window was closed */
    bool all_written;   /* in a farm: only other ranks are waited for */
    struct script_clock script;
    struct stall_check stall;
    struct script_retry retry;
    struct window_export model;
    struct device_process device;
};

/* Seconds that a cancelled child has to end by itself before it is killed. It writes no files, so nothing is lost; and
 * freeing the memory of a large scene takes longer than a kill. */
static const double supervisor_patience = 0.03;

void supervisor_note_status(struct supervisor *supervisor, int status); /* the worst stays */
/* In the terminal; errors also in the window. */
void supervisor_report(struct supervisor *supervisor, enum line_kind kind, const char *text);
void supervisor_note_error(struct supervisor *supervisor, const struct error *error);

#endif
