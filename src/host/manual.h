/* What the program says about itself. All return the exit status. */
#ifndef GRAY_HOST_MANUAL_H
#define GRAY_HOST_MANUAL_H

#include "base/arena.h"
#include "session/options.h"

/* --help, and --man, whose words are topics; none: everything. library: the folder of the Lua library, or NULL. */
int manual_print(const struct options *options, const char *library, struct arena *arena);
/* --roff: the page that the word names, gray or gray-scene. */
int manual_print_page(const struct options *options, struct arena *arena);
int manual_print_annotations(struct arena *arena); /* lua/gr.lua */
int manual_print_schema(struct arena *arena);      /* of scenes in JSON */

#endif
