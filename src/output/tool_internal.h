/* Programs that the supervisor starts: found on PATH, with arguments that scenes cannot choose, in a new folder. */
#ifndef GRAY_OUTPUT_TOOL_INTERNAL_H
#define GRAY_OUTPUT_TOOL_INTERNAL_H

#include "base/error.h"
#include "base/file_output.h"

#include <stdbool.h>
#include <sys/types.h>

struct tool {
    const char *purpose;                    /* begins its messages */
    char *const *arguments;                 /* the name of the program first; NULL after the last one */
    const char *folder;                     /* its working directory */
    int input;                              /* its standard input; -1: empty */
    const struct file_interrupt *interrupt; /* or NULL */
};

/* Its output is discarded. It inherits no other descriptor, and signals have their default actions. PATH is that of the
 * user; a relative entry refers to the new folder, which contains no program. Errors: it is not on PATH, it cannot be
 * started. */
bool tool_start(const struct tool *tool, pid_t *child, struct error *error);
/* Waits until it ends; after an interrupt it is killed. Errors: it failed, interrupted. */
bool tool_wait(const struct tool *tool, pid_t child, struct error *error);

#endif
