/* The files below the scene's folder and the folder above it, for names that are not at the path in a scene. */
#ifndef GRAY_SANDBOX_SEARCH_H
#define GRAY_SANDBOX_SEARCH_H

#include "base/arena.h"
#include "base/path_policy.h"

#include <stdbool.h>
#include <stdint.h>

/* Zero-initialise. Everything is in the arena, which the owner destroys. */
struct file_search {
    struct arena arena;
    bool listed;
    const char **files; /* paths as a message shows them, the nearest first */
    uint32_t count;
};

/* The file whose path has the longest common end with `name`, at least the file name; *found is NULL if there is none.
 * `folder` is the scene's, with a final slash or "". False without memory. */
bool search_find(struct file_search *search, const struct path_policy *path_policy, const char *folder,
                 const char *name, const char **found);
/* False for a name that leads out of the folders of the sandbox, by a link or "..", whether or not a file is there: it
 * is refused and not looked for elsewhere. */
bool search_may(const struct path_policy *path_policy, const char *folder, const char *name);

#endif
