/* The order in which transforms compose (docs/language.md 12.4), and whether all pictures have the table form without a
 * background, decided from the text of a scene before it runs. This needs no Lua state: a lexer skips comments and
 * strings, and a few patterns of words are evidence. */
#ifndef GRAY_COMPAT_ORDER_H
#define GRAY_COMPAT_ORDER_H

#include "base/error.h"
#include "scene/node.h"

#include <stdbool.h>
#include <stddef.h>

struct order_finding {
    enum transform_order order;
    char reason[400];         /* "it uses readobj (line 3)"; "" without evidence */
    bool only_named_pictures; /* at least one gr.render{...} or gr.frames, no other form, no field background or sky */
    bool several_pictures;    /* more than one call of gr.render, or one in a loop */
};

struct path_policy;
/* The scene at `path` and what it requires by literal names; without evidence there, its siblings that are not hidden.
 * Files of library_folder (may be NULL) do not count, nor do those that the scene may not read (reach; NULL:
 * everything) and those that cannot be read. */
bool order_detect(const char *path, const char *library_folder, const struct path_policy *path_policy,
                  struct order_finding *finding, struct error *error);
/* One text alone. */
void order_of_text(const char *text, size_t size, struct order_finding *finding);

#endif
