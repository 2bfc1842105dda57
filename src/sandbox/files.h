/* The files that a scene names, and the Lua files that it loads. */
#ifndef GRAY_SANDBOX_FILES_H
#define GRAY_SANDBOX_FILES_H

#include "base/error.h"
#include "sandbox/search.h"

#include <lua.h>

struct sandbox;

enum { PATH_SIZE = 4096, FILE_LIMIT = 1 << 28 };

/* Every file that Lua has loaded, newest first: Lua shortens long names in messages, these are the full ones. */
struct source_name {
    const char *path;
    struct source_name *next;
};

struct files {
    const char *path;       /* the scene as the user named it */
    char folder[PATH_SIZE]; /* its folder with a final slash, or "" */
    const char *dialect;    /* a file that runs before the scene, or NULL; the user named it, too */
    struct source_name *sources;
    struct file_search search;       /* for files that are not at the path in the script */
    struct source_name *found_names; /* the names of those that were found, with a notice for each */
    bool number_repaired;            /* the notice about ".0" was printed */
};

/* package, require, dofile and loadfile. */
void files_open(lua_State *L);
/* Saves the globals for our own modules; called after all functions have been added. */
void files_save_globals(lua_State *L);
/* Finds a file that the scene names; docs/language.md 12.3. */
bool files_find(struct sandbox *sandbox, const char *name, char out[PATH_SIZE]);
/* The same with the number in its name repaired, and with an error that names the folders that were searched. */
bool files_require(struct sandbox *sandbox, const char *name, char out[PATH_SIZE], struct error *error);
/* Searches for a file that does not exist under the name in a file of the scene in `folder`; prints a notice if it is
 * found. A model_search. */
bool files_search(void *sandbox, const char *folder, const char *name, const char **path, bool *refused,
                  struct error *error);
/* The templates of package.path with `file` instead of the question marks: the first file that can be read. */
bool files_on_path(const struct sandbox *sandbox, const char *templates, const char *file, char path[PATH_SIZE]);
/* Drops the ".0" of whole numbers. The same pointer when there was none; NULL without memory. */
const char *files_repair_number(struct sandbox *sandbox, const char *name);
/* The policy for a Lua file; NULL for the scene and its dialect: the user named them, so they may be links to any
 * file. */
const struct path_policy *files_policy(const struct sandbox *sandbox, const char *path);
/* Loads a Lua file as text: pushes the chunk or a message and answers with the status. Raises what cannot be caught. */
int files_load(lua_State *L, const char *path);
/* File names that Lua has shortened are written in full again at the start of a message. */
const char *files_unshorten(struct sandbox *sandbox, const char *message); /* NULL without memory */
/* After the error of a scene that cannot be read: "; did you mean ...", if it is not there. Else "". */
const char *files_hint_of_missing_scene(struct sandbox *sandbox);

#endif
