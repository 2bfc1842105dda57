/* Standard error, which the program and its scenes share. Both write to it directly, one at a time: who writes has
 * taken it. The program ends a line that a scene has left unfinished, and the scene's guard (base/terminal_text.h)
 * begins a new one after a line of the program, so that none is continued by the other. Lies in memory that both
 * processes share; the supervisor trusts nothing in it with more than a newline and a short wait. */
#ifndef GRAY_SESSION_ERROR_STREAM_H
#define GRAY_SESSION_ERROR_STREAM_H

#include "base/terminal_text.h"

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

enum error_stream_owner { ERROR_STREAM_FREE, ERROR_STREAM_PROGRAM, ERROR_STREAM_SCENE };

/* Zero value: free, at the beginning of a line. */
struct error_stream {
    _Atomic uint32_t owner; /* an enum error_stream_owner */
    _Atomic uint32_t open;  /* not 0: a scene has left a line unfinished */
    _Atomic uint32_t lines; /* of the program, counted */
    _Atomic uint32_t mute;  /* not 0: another process shows what scenes write */
    /* Lines that the rendering process has sent to the supervisor, and those that are handled. */
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
