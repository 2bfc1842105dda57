/* Shared by the files of the command line. */
#ifndef GRAY_SESSION_OPTIONS_INTERNAL_H
#define GRAY_SESSION_OPTIONS_INTERNAL_H

#include "session/options.h"

struct piece {
    const char *text;
    size_t length;
};

/* Whether a name has more than one number: output_name replaces the first. */
bool output_name_numbered_twice(const char *pattern);
/* The next piece of a text separated by '|'; *rest moves to the end of it. Empty at the end. */
struct piece option_next_piece(const char **rest);

#endif
