/* The output session: the supervisor's part of rendering a picture. It names the picture, holds its film, writes the
 * files, and reports to the user. It has no access to the scene. */
#ifndef GRAY_OUTPUT_OUTPUT_SESSION_H
#define GRAY_OUTPUT_OUTPUT_SESSION_H

#include "output/animation.h"
#include "output/checkpoint.h"
#include "output/display.h"
#include "output/farm.h"
#include "output/model_output.h"
#include "output/picture_files.h"
#include "output/picture_write.h"
#include "output/progress.h"
#include "session/control.h"
#include "session/messages.h"
#include "session/options.h"

#include <stdbool.h>

struct output_session {
    const struct options *options;
    struct control *control; /* not owned */
    struct farm *farm;       /* or NULL; not owned */
    struct progress progress;
    /* Waits until standard error takes text; false: it does not, and the run is to end. NULL: writing waits. */
    bool (*wait_for_text)(void *context);
    void *wait_context;
    struct display display;       /* --display */
    struct checkpoint checkpoint; /* the checkpoint */
    struct animation animation;   /* of the pictures */
    struct model_output model;    /* the file of a model that is being written */
    struct picture_files files;   /* names, and what they may replace */
    unsigned pictures;            /* begun so far, those under --check too */
    struct picture current;       /* being made */
    struct picture held;          /* finished under -o without %d: written when no second picture came */
    struct picture previous;      /* the last frame, for writing it again under the name of an equal next one */
    struct picture_report held_report;
    bool several_under_one_name;
    bool plays;       /* the last picture was a frame in a window */
    bool interrupted; /* by a signal: no picture is written any more */
};

/* The number of the picture, from 1. All frames that a window plays of an animation have one: they are not written. */
unsigned output_number_of(const struct output_session *output, const struct picture_request *request);

void output_init(struct output_session *output, const struct options *options, struct control *control);
/* Names the picture and makes its film; false when it cannot be written for a reason that is known before rendering.
 * *already, when it comes in: it is not wanted again. When it goes out: nothing is to be done, it was written before or
 * is another shard's; then no picture is open. */
bool output_begin(struct output_session *output, const struct picture_request *request, bool *already,
                  struct error *error);
/* model_output_begin; before the first picture is open, its name for the file of its solution. */
bool output_begin_model(struct output_session *output, const struct model_request *request, struct error *error);
/* Writes the files of the picture that is open; it stays open. */
bool output_write(struct output_session *output, struct error *error);
/* The film is complete: the files are written. The picture is closed in any case. */
bool output_done(struct output_session *output, const struct picture_report *report, struct error *error);
void output_abandon(struct output_session *output); /* fine when no picture is open */
/* Writes the checkpoint now and prints a line; or prints that no checkpoint was requested. */
void output_write_checkpoint(struct output_session *output);
/* Draws how far the picture is, writes the checkpoint when it is time, and talks with the farm. */
void output_show_progress(struct output_session *output);
/* One line (or several: an error with its traceback) on standard error, as -q and --verbose allow; LINE_OUTPUT on
 * standard output. */
void output_report(struct output_session *output, enum line_kind kind, const char *text);
/* The same with a format, cut after 2 * NAME_LIMIT bytes. */
void output_say(struct output_session *output, enum line_kind kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* The wait for a pipe ends when `stopped` returns true; see struct file_interrupt. */
void output_set_interrupt(struct output_session *output, const struct file_interrupt *interrupt);
/* --watch: the end of one run, and the beginning of the next, whose pictures count from 1 again. */
bool output_write_held(struct output_session *output, struct error *error);
void output_restart(struct output_session *output);
/* At the end: false when something that went to standard output, of this process or of the scripts, was lost. */
bool output_flush_streams(struct output_session *output, struct error *error);
/* With --no-sandbox: a warning. */
void output_warn_no_sandbox(struct output_session *output);
/* The animation of the run, when all its frames are written. */
bool output_assemble(struct output_session *output, struct error *error);
/* After all scripts: writes the picture that was held. all_well: everything else was written, so that the checkpoint
 * may go. False: error. */
bool output_finish(struct output_session *output, bool all_well, struct error *error);

#endif
