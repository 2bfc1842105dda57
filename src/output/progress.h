/* Reports the progress of a picture on standard error: as a bar that is drawn over itself, as lines, as JSON lines, or
 * not at all. */
#ifndef GRAY_OUTPUT_PROGRESS_H
#define GRAY_OUTPUT_PROGRESS_H

#include "render/time_estimate.h"
#include "session/options.h"
#include "session/standard_streams.h"

#include <stdbool.h>
#include <stdint.h>

struct progress {
    struct error_stream *stream; /* standard error, where scenes write to it, too; not owned */
    enum progress_mode mode;     /* never PROGRESS_AUTO */
    const char *name;            /* of the picture; NULL if there is none */
    uint32_t width, height;
    int threads;
    double begun, shown; /* seconds; when the picture began, when it was last reported */
    bool printed, known; /* something, and the start of tiles, was reported */
    double writing;      /* seconds for denoising and writing the file */
    double share;        /* the reported share; it never decreases */
    int columns;         /* columns of the bar on the screen; 0: no bar */
    double unshot;       /* share of the light of radiosity, set by the caller; 0: none is computed */
    bool elsewhere;      /* a window shows it; standard error has only the beginning and the end as JSON */
    double script_since; /* when the script began to run between pictures; 0: no script runs */
    double script_next;  /* seconds after which its next line is due */
};

enum progress_end { PROGRESS_WRITTEN, PROGRESS_GIVEN_UP };

/* AUTO becomes a bar on a terminal, else lines; nothing when quiet. */
void progress_init(struct progress *progress, enum progress_mode mode, bool quiet, int threads);
/* `name` must be valid until progress_end. denoised: pixels that are denoised for each pixel of the file. */
void progress_begin(struct progress *progress, const char *name, uint32_t width, uint32_t height, double denoised);
/* count 0: the scene is still being built. Reports at most ten times a second. */
void progress_update(struct progress *progress, uint32_t done, uint32_t count,
                     const struct progress_estimate *estimate);
/* Erases the bar, so that a line can be printed; the next update draws it again. */
void progress_hide(struct progress *progress);
void progress_end(struct progress *progress, enum progress_end how);
/* `runs`: the script computes, and no picture is rendered. On a terminal its line is due after 2 seconds, and each time
 * the duration has doubled. It is a line, not a bar, because the script may print at any time. False: not yet. */
bool progress_script_line(struct progress *progress, const char *script, bool runs, char *line, size_t size);

#endif
