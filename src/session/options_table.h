/* The rows of the options. */
#ifndef GRAY_SESSION_OPTIONS_TABLE_H
#define GRAY_SESSION_OPTIONS_TABLE_H

#include "session/options.h"
#include "settings/setting.h"

struct document;
/* All options in one row: the settings, some of which have no option, and then the others. */
enum { OPTIONS_LIMIT = 256 };
int option_count(void); /* below it */
const struct setting *option_at(int index);
const char *option_group_title(enum option_group group);
/* One option; and all in groups, with their defaults, the exit status and the environment. */
void option_describe(const struct setting *option, struct document *document);
void options_describe(struct document *document);
bool option_is_setting(const struct setting *option);
/* The struct that has the value of the option: the settings, or the options. */
void *option_base(const struct setting *option, struct options *options);
/* Whether the value may be left out, and is `value` then; and the value in words, NULL if it has none. */
bool option_may_lack_value(const struct setting *option);
const char *option_value(const struct setting *option);

#endif
