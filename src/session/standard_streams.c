/* Streams with our own write function (fopencookie, glibc and musl) take the place of stdout and stderr for text of the
 * program: not every C library allows an assignment to these.
 *
 * Text of a scene is written at once, without a buffer, as by io.stderr. A write to a pipe whose reader has stopped
 * waits, with the stream locked; the program checks that the pipe accepts text before it locks the stream. */
#define _GNU_SOURCE
#include "session/standard_streams.h"

#include "base/fault.h"

#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static FILE *replaced[2]; /* by standard_streams_begin, or NULL */

FILE *standard_output(void) {
    return replaced[0] ? replaced[0] : stdout;
}

FILE *standard_error(void) {
    return replaced[1] ? replaced[1] : stderr;
}

static bool is_ending(void) {
    sigset_t pending;
    return sigpending(&pending) == 0 && (sigismember(&pending, SIGINT) == 1 || sigismember(&pending, SIGTERM) == 1 ||
                                         sigismember(&pending, SIGHUP) == 1);
}

/* A pipe that poll reports as writable accepts PIPE_BUF bytes at once. False: the stream accepts no more. */
static bool write_piece(struct standard_stream *stream, const char *text, size_t size, size_t *done) {
    struct pollfd watched = {.fd = stream->descriptor, .events = POLLOUT};
    while (!stream->given_up) {
        int ready = stream->waits ? poll(&watched, 1, 50) : 1;
        if (ready > 0 || (ready < 0 && errno != EINTR)) {
            ssize_t got = write(stream->descriptor, text, size < PIPE_BUF ? size : PIPE_BUF);
            *done = got > 0 ? (size_t)got : 0;
            return got >= 0 || errno == EINTR || errno == EAGAIN;
        }
        stream->given_up = *stream->ended || is_ending();
    }
    errno = EIO;
    return false;
}

/* All of it, or an error: fopencookie has no short writes. glibc takes 0 for an error, musl only a negative number. */
static ssize_t write_all(void *cookie, const char *text, size_t size) {
#ifdef __GLIBC__
    const ssize_t failed = 0;
#else
    const ssize_t failed = -1;
#endif
    for (size_t at = 0, done = 0; at < size; at += done) {
        if (!write_piece(cookie, text + at, size - at, &done))
            return failed;
    }
    return (ssize_t)size;
}

static FILE *open_stream(struct standard_stream *stream, int descriptor, const bool *ended) {
    const cookie_io_functions_t functions = {.write = write_all};
    struct stat status;
    bool known = fstat(descriptor, &status) == 0;
    bool waits = known && (S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode) || S_ISCHR(status.st_mode));
    *stream = (struct standard_stream){.descriptor = descriptor, .waits = waits, .ended = ended};
    FILE *made = fopencookie(stream, "w", functions);
    if (made)
        (void)setvbuf(made, NULL, _IOLBF, BUFSIZ);
    return made;
}

void standard_streams_begin(struct standard_streams *streams) {
    FILE *out = open_stream(&streams->out, STDOUT_FILENO, &streams->ended);
    FILE *err = open_stream(&streams->err, STDERR_FILENO, &streams->ended);
    if (!out || !err) {
        if (out)
            (void)fclose(out);
        if (err)
            (void)fclose(err);
        return;
    }
    (void)fflush(NULL);
    replaced[0] = out;
    replaced[1] = err;
}

void standard_streams_end(void) {
    for (int i = 0; i < 2; i++) {
        if (replaced[i])
            (void)fclose(replaced[i]);
        replaced[i] = NULL;
    }
}

/* Standard error, shared with scenes. */

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
    if (!stream)
        return;
    if (atomic_exchange(&stream->open, 0))
        (void)fputc('\n', standard_error());
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

/* A line may be handled before it is counted as sent. */
static void wait_for_lines(const struct error_stream *stream) {
    while ((int32_t)(atomic_load(&stream->handled) - atomic_load(&stream->sent)) < 0)
        rest();
}

/* Text that standard error does not accept is lost, as it is with stdio. */
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
