/* The desk: the supervisor's half of making a picture. It decides what a picture is called, holds its film, writes the
 * files, and tells people what happens. It sees no scene. */
#ifndef GRAY_OUTPUT_OUTPUT_SESSION_H
#define GRAY_OUTPUT_OUTPUT_SESSION_H

#include "output/checkpoint.h"
#include "output/display.h"
#include "output/farm.h"
#include "output/picture_files.h"
#include "output/picture_write.h"
#include "output/progress.h"
#include "session/control.h"
#include "session/messages.h"
#include "session/options.h"

#include <stdbool.h>

struct desk {
    const struct options *options;
    struct control *control; /* not owned */
    struct farm *farm;       /* or NULL; not owned */
    struct progress progress;
    /* Waits until standard error takes text; false: it does not, and the run is to end. NULL: writing waits. */
    bool (*takes_text)(void *context);
    void *takes_context;
    struct display display;     /* --display */
    struct keeper keeper;       /* the checkpoint */
    struct picture_files files; /* names, and what they may replace */
    unsigned pictures;          /* begun so far, those under --check too */
    struct picture current;     /* being made */
    struct picture held;        /* finished under -o without %d: written when no second picture came */
    bool several_under_one_name;
};

void desk_init(struct desk *desk, const struct options *options, struct control *control);
/* Names the picture and makes its film; false when it cannot be written for a reason that is known before rendering.
 * *already, when it comes in: it is not wanted again. When it goes out: nothing is to be done, it was written before or
 * is another shard's; then no picture is open. */
bool desk_begin(struct desk *desk, const struct picture_request *request, bool *already, struct error *error);
/* Writes the files of the picture that is open; it stays open. */
bool desk_write(struct desk *desk, struct error *error);
/* The film is complete: the files are written. The picture is closed in any case. */
bool desk_done(struct desk *desk, const struct picture_report *report, struct error *error);
void desk_abandon(struct desk *desk); /* fine when no picture is open */
/* Writes the checkpoint now and says so; or says that none was asked for. */
void desk_checkpoint(struct desk *desk);
/* Draws how far the picture is, writes the checkpoint when it is time, and talks with the farm. */
void desk_show_progress(struct desk *desk);
/* One line (or several: an error with its traceback) on standard error, as -q and --verbose allow; LINE_OUTPUT on
 * standard output. */
void desk_line(struct desk *desk, enum line_kind kind, const char *text);
/* The wait for a pipe ends when `stopped` says so; see struct file_interrupt. */
void desk_set_interrupt(struct desk *desk, const struct file_interrupt *interrupt);
/* --watch: the end of one run, and the beginning of the next, whose pictures count from 1 again. */
bool desk_settle(struct desk *desk, struct error *error);
void desk_restart(struct desk *desk);
/* At the end: false when something that went to standard output, of this process or of the scripts, was lost. */
bool desk_finish_output(struct desk *desk, struct error *error);
/* With --no-sandbox: a warning. */
void desk_tell_trust(struct desk *desk);
/* After all scripts: writes the picture that was held. all_well: everything else was written, so that the checkpoint
 * may go. False: error. */
bool desk_finish(struct desk *desk, bool all_well, struct error *error);

#endif
