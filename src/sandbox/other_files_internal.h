/* Files that are given as scripts by mistake: pictures, models, scenes of other programs. */
#ifndef GRAY_SANDBOX_OTHER_FILES_INTERNAL_H
#define GRAY_SANDBOX_OTHER_FILES_INTERNAL_H

#include <stddef.h>

/* What a file is that Lua cannot compile, and what to do with it, judged by its first bytes and its ending: "is a
 * picture; ..."; NULL: it may be a script with an error. */
const char *other_file_words(const char *path, const void *data, size_t size);
/* What to type instead of the name of a scene that is not there, as in `gray help`, or NULL. */
const char *other_command_words(const char *name);

#endif
