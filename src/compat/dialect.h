/* --dialect: a file that runs before the scene. */
#ifndef GRAY_COMPAT_DIALECT_H
#define GRAY_COMPAT_DIALECT_H

#include "sandbox/sandbox.h"

/* The file that --dialect names, or that of the name in the library, whose folder may be NULL. False: no dialect, or
 * the path is too long. */
bool dialect_file(const char *dialect, const char *library_folder, char *out, size_t size);
/* Its folder may be read. */
bool dialect_add_folder(const char *dialect, const char *library_folder, struct path_policy *path_policy,
                        struct error *error);
/* Sets files.dialect; NULL: none. */
bool dialect_find(struct sandbox *sandbox, const char *dialect, struct error *error);
void dialect_run(lua_State *L);    /* before the scene; may raise */
void dialect_finish(lua_State *L); /* after it */

#endif
