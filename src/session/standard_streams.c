/* Both FILE pointers are exchanged for streams with a write function of our own (fopencookie, glibc), so that all text
 * of the program goes through it. */
#define _GNU_SOURCE
#include "session/standard_streams.h"

#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

static bool is_ending(void) {
    sigset_t pending;
    return sigpending(&pending) == 0 && (sigismember(&pending, SIGINT) == 1 || sigismember(&pending, SIGTERM) == 1 ||
                                         sigismember(&pending, SIGHUP) == 1);
}

/* A pipe that poll reports writable takes PIPE_BUF bytes at once. False: the stream takes no more. */
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

/* All of it, or an error: fopencookie has no short writes. */
static ssize_t write_all(void *cookie, const char *text, size_t size) {
    for (size_t at = 0, done = 0; at < size; at += done) {
        if (!write_piece(cookie, text + at, size - at, &done))
            return 0;
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
    streams->before[0] = stdout;
    streams->before[1] = stderr;
    stdout = out;
    stderr = err;
}

void standard_streams_end(struct standard_streams *streams) {
    if (!streams->before[0])
        return;
    (void)fclose(stdout);
    (void)fclose(stderr);
    stdout = streams->before[0];
    stderr = streams->before[1];
    streams->before[0] = NULL;
}
