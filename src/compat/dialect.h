/* --dialect: a file that runs before the scene. */
#ifndef GRAY_COMPAT_DIALECT_H
#define GRAY_COMPAT_DIALECT_H

#include "sandbox/sandbox.h"

/* The file of --dialect: the one it names, or that of the name in the library. False: no dialect, or the path is too
 * long. */
bool dialect_file(const struct script_options *options, char *out, size_t size);
/* Its folder may be read. */
bool dialect_add_folder(const struct script_options *options, struct path_policy *path_policy, struct error *error);
/* Sets files.dialect. */
bool dialect_find(struct sandbox *sandbox, struct error *error);
void dialect_run(lua_State *L);    /* before the scene; may raise */
void dialect_finish(lua_State *L); /* after it */

#endif
