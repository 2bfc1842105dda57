/* Text of a scene is written without a buffer, at once, as io.stderr always was. A write to a pipe whose reader has
 * stopped waits, with the stream taken; the program looks whether the pipe takes text before it takes the stream. */
#include "session/error_stream.h"

#include "base/fault.h"

#include <errno.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

static void rest(void) {
    const struct timespec pause = {0, 100000};
    (void)nanosleep(&pause, NULL);
}

void error_stream_take(struct error_stream *stream, enum error_stream_owner owner) {
    enum { PROGRAM_RESTS = 1000 };
    for (int rests = 0;; rests++) {
        uint32_t expected = ERROR_STREAM_FREE;
        if (atomic_compare_exchange_strong(&stream->owner, &expected, owner) ||
            (owner == ERROR_STREAM_PROGRAM && rests == PROGRAM_RESTS))
            return;
        rest();
    }
}

void error_stream_give(struct error_stream *stream, enum error_stream_owner owner) {
    uint32_t expected = owner;
    (void)atomic_compare_exchange_strong(&stream->owner, &expected, ERROR_STREAM_FREE);
}

void error_stream_begin_line(struct error_stream *stream) {
    if (atomic_exchange(&stream->open, 0))
        (void)fputc('\n', stderr);
    atomic_fetch_add(&stream->lines, 1);
}

void error_stream_free(struct error_stream *stream) {
    atomic_store(&stream->owner, ERROR_STREAM_FREE);
    atomic_store(&stream->handled, atomic_load(&stream->sent));
}

void error_stream_note_sent(struct error_stream *stream) {
    atomic_fetch_add(&stream->sent, 1);
}

void error_stream_note_handled(struct error_stream *stream) {
    atomic_fetch_add(&stream->handled, 1);
}

/* A line may be handled before it is noted as sent. */
static void wait_for_lines(const struct error_stream *stream) {
    while ((int32_t)(atomic_load(&stream->handled) - atomic_load(&stream->sent)) < 0)
        rest();
}

/* What standard error does not take is lost, as what stdio writes to it is. */
static void put(void *context, const char *text, size_t size) {
    (void)context;
    while (size > 0) {
        ssize_t written = MAY_FAIL(write(STDERR_FILENO, text, size));
        if (written < 0 && errno != EINTR)
            return;
        if (written > 0) {
            text += written;
            size -= (size_t)written;
        }
    }
}

void scene_writer_init(struct scene_writer *writer, struct error_stream *stream) {
    *writer = (struct scene_writer){.stream = stream,
                                    .guard = {.put = put},
                                    .lines = atomic_load(&stream->lines),
                                    .unfinished = atomic_load(&stream->open) != 0};
}

static void begin(struct scene_writer *writer) {
    wait_for_lines(writer->stream);
    error_stream_take(writer->stream, ERROR_STREAM_SCENE);
    uint32_t lines = atomic_load(&writer->stream->lines);
    if (lines != writer->lines)
        line_guard_new_line(&writer->guard);
    else if (writer->unfinished)
        put(NULL, "\n", 1);
    writer->lines = lines;
    writer->unfinished = false;
}

static void end(struct scene_writer *writer) {
    atomic_store(&writer->stream->open, writer->guard.open);
    error_stream_give(writer->stream, ERROR_STREAM_SCENE);
}

void scene_writer_take(struct scene_writer *writer, const char *text, size_t size) {
    if (atomic_load(&writer->stream->mute))
        return;
    begin(writer);
    line_guard_take(&writer->guard, text, size);
    end(writer);
}

void scene_writer_flush(struct scene_writer *writer) {
    if (writer->guard.held_size + writer->guard.partial_size == 0)
        return;
    begin(writer);
    line_guard_flush(&writer->guard);
    end(writer);
}
