/* Programs that the supervisor starts: found on PATH, with arguments that no scene chooses, in a folder of their own.
 */
#ifndef GRAY_OUTPUT_TOOL_INTERNAL_H
#define GRAY_OUTPUT_TOOL_INTERNAL_H

#include "base/error.h"

#include <stdbool.h>
#include <sys/types.h>

struct tool {
    const char *purpose;    /* begins its messages */
    char *const *arguments; /* the name of the program first; NULL after the last one */
    const char *folder;     /* its working directory */
    int input;              /* its standard input; -1: empty */
};

/* What it prints is thrown away. It gets no other descriptor, and the signals as they are by default. PATH is that of
 * the user; an entry that is not absolute leads into the folder, where no program is. Errors: it is not on PATH, it
 * cannot be started. */
bool tool_start(const struct tool *tool, pid_t *child, struct error *error);
/* Waits for its end. Errors: it failed. */
bool tool_wait(const struct tool *tool, pid_t child, struct error *error);

#endif
