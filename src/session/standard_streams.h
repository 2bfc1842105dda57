/* Standard output and standard error: how the supervisor writes to them, and how it shares standard error with scenes.
 */
#ifndef GRAY_SESSION_STANDARD_STREAMS_H
#define GRAY_SESSION_STANDARD_STREAMS_H

#include "base/terminal_text.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Standard output and standard error of the supervisor. A reader that stopped reading must not keep it from its
 * signals: a write waits until the stream takes something, or until a signal that ends the run is pending. */
struct standard_stream {
    int descriptor;
    bool waits;        /* a pipe, a terminal or the like */
    bool given_up;     /* the run was ended while this stream waited; nothing more is written */
    const bool *ended; /* standard_streams.ended */
};
/* Zero value: not begun. */
struct standard_streams {
    struct standard_stream out, err;
    bool ended;      /* set when the signal has been read: from then on a stream that takes nothing is given up soon */
    FILE *before[2]; /* stdout and stderr as they were */
};

/* From now on stdout and stderr write so. SIGINT, SIGTERM and SIGHUP must be blocked. The struct must stay until
 * standard_streams_end. Without memory nothing changes. */
void standard_streams_begin(struct standard_streams *streams);
/* Writes what is buffered, and puts the streams back. Also for the process that fork has made. */
void standard_streams_end(struct standard_streams *streams);

/* Standard error, which the program and its scenes share. Both write to it directly, one at a time: who writes has
 * taken it. The program ends a line that a scene has left unfinished, and the scene's guard (base/terminal_text.h)
 * begins a new one after a line of the program, so that none is continued by the other. Lies in memory that both
 * processes share; the supervisor trusts nothing in it with more than a newline and a short wait. */
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

/* Waits until it is free. The program waits a tenth of a second at most: a scene that is stopped, or killed, in the
 * middle of a write must not hold it. Fine to give what was not got. */
void error_stream_take(struct error_stream *stream, enum error_stream_owner owner);
void error_stream_give(struct error_stream *stream, enum error_stream_owner owner);
/* What comes next is the program's: an unfinished line is ended. */
void error_stream_begin_line(struct error_stream *stream);
/* The process that wrote for scenes is gone. */
void error_stream_free(struct error_stream *stream);
void error_stream_note_sent(struct error_stream *stream);
void error_stream_note_handled(struct error_stream *stream);

/* A process that runs scenes: their text on its way. */
struct scene_writer {
    struct error_stream *stream;
    struct line_guard guard;
    uint32_t lines;  /* of the program, when something was last written here */
    bool unfinished; /* an earlier process has left a line unfinished */
};
void scene_writer_init(struct scene_writer *writer, struct error_stream *stream);
/* Waits until the lines before it are shown. */
void scene_writer_take(struct scene_writer *writer, const char *text, size_t size);
/* Writes what is held back, a beginning of "gray:"; to be called before the program says something. */
void scene_writer_flush(struct scene_writer *writer);

#endif
