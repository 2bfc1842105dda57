/* Standard output and standard error: how the supervisor writes to them, and how it shares standard error with
 * scenes. */
#ifndef GRAY_SESSION_STANDARD_STREAMS_H
#define GRAY_SESSION_STANDARD_STREAMS_H

#include "base/terminal_text.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Standard output and standard error of the supervisor. A reader that stops reading must not prevent signals from being
 * handled: a write waits until the stream accepts data, or until a signal that ends the run is pending. */
struct standard_stream {
    int descriptor;
    bool waits;        /* a pipe, a terminal or the like */
    bool given_up;     /* the run was ended while this stream waited; nothing more is written */
    const bool *ended; /* standard_streams.ended */
};
/* Zero value: not begun. */
struct standard_streams {
    struct standard_stream out, err;
    bool ended; /* set when the signal has been read: from then on writes wait only briefly */
};

/* Where the program writes what a supervisor may print: stdout and stderr, or what is in their place. */
FILE *standard_output(void);
FILE *standard_error(void);
/* Puts streams in the place of stdout and stderr. SIGINT, SIGTERM and SIGHUP must be blocked. The struct must stay
 * until standard_streams_end. Without memory nothing is replaced. */
void standard_streams_begin(struct standard_streams *streams);
/* Writes buffered text, and restores the streams. Also for a process created by fork. */
void standard_streams_end(void);

/* Standard error, which the program and its scenes share. Both write to it directly, one at a time, under a lock. The
 * program ends a line that a scene has left unfinished, and the scene's guard (base/terminal_text.h) begins a new one
 * after a line of the program, so that none is continued by the other. Lies in memory that both processes share; the
 * supervisor trusts nothing in it with more than a newline and a short wait. */
enum error_stream_owner { ERROR_STREAM_FREE, ERROR_STREAM_PROGRAM, ERROR_STREAM_SCENE };

/* Zero value: free, at the beginning of a line. */
struct error_stream {
    _Atomic uint32_t owner; /* an enum error_stream_owner */
    _Atomic uint32_t open;  /* not 0: a scene has left a line unfinished */
    _Atomic uint32_t lines; /* of the program, counted */
    _Atomic uint32_t mute;  /* not 0: another process shows what scenes write */
    /* Lines that the render process has sent to the supervisor, and those that are handled. */
    _Atomic uint32_t sent, handled;
};

/* Waits for the lock. The program waits a tenth of a second at most: a scene that is stopped, or killed, during a write
 * must not block it. Releasing a lock that was not obtained is allowed. */
void error_stream_take(struct error_stream *stream, enum error_stream_owner owner);
void error_stream_give(struct error_stream *stream, enum error_stream_owner owner);
/* The next text is the program's: an unfinished line is ended. NULL is fine. */
void error_stream_begin_line(struct error_stream *stream);
/* The process that wrote for scenes has ended. */
void error_stream_free(struct error_stream *stream);
void error_stream_note_sent(struct error_stream *stream);
void error_stream_note_handled(struct error_stream *stream);

/* The output of scenes in the process that runs them. */
struct scene_writer {
    struct error_stream *stream;
    struct line_guard guard;
    uint32_t lines;  /* the count of the program at the last write here */
    bool unfinished; /* an earlier process has not ended its last line */
};
void scene_writer_init(struct scene_writer *writer, struct error_stream *stream);
/* Waits until the earlier lines are shown. */
void scene_writer_take(struct scene_writer *writer, const char *text, size_t size);
/* Writes the text that was held back (a beginning of "gray:"); to be called before the program prints a message. */
void scene_writer_flush(struct scene_writer *writer);

#endif
