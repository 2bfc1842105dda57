/* One error, told in one complete line. Functions that can fail return bool and fill a struct error of the caller.
 * The kind decides the exit status of the program. */
#ifndef GRAY_BASE_ERROR_H
#define GRAY_BASE_ERROR_H

#include <stdbool.h>

enum error_kind {
    ERROR_NONE = 0,
    ERROR_SCENE = 1,       /* a scene or a file was wrong */
    ERROR_USAGE = 2,       /* the command line was wrong */
    ERROR_MACHINE = 3,     /* the machine failed us: disk full, out of memory, no threads */
    ERROR_CANCELLED = 130, /* somebody asked to stop */
};

struct error {
    enum error_kind kind;
    char text[1024];
};

/* Fill and return false, so that `return error_set(...)` reads as a failure. Over-long text is cut with "...". */
bool error_set(struct error *error, enum error_kind kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
bool error_no_memory(struct error *error, const char *what); /* "out of memory for WHAT" */
/* Puts "PREFIX: " before the text that is already there. */
bool error_prefix(struct error *error, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
