/* Shared by the files of the command line: the rows of the options, and their names. */
#ifndef GRAY_SESSION_OPTIONS_INTERNAL_H
#define GRAY_SESSION_OPTIONS_INTERNAL_H

#include "session/options.h"
#include "settings/setting.h"

bool option_is_setting(const struct setting *option);
/* The struct that has the value of the option: the settings, or the options. */
void *option_base(const struct setting *option, struct options *options);
/* Whether the value may be left out, and is `value` then; and the value in words, NULL if it has none. */
bool option_may_lack_value(const struct setting *option);
const char *option_value(const struct setting *option);

struct piece {
    const char *text;
    size_t length;
};

/* Whether a name has more than one number: output_name replaces the first. */
bool output_name_numbered_twice(const char *pattern);
/* The next piece of a text separated by '|'; *rest moves to the end of it. Empty at the end. */
struct piece option_next_piece(const char **rest);

/* Checks the options together, and sets those that others imply. */
bool options_check(struct options *options, struct error *error);

#endif
