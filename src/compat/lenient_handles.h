/* Handles with --lenient, and ghosts: the results of calls of unknown functions. */
#ifndef GRAY_COMPAT_LENIENT_HANDLES_H
#define GRAY_COMPAT_LENIENT_HANDLES_H

#include "call/context.h"

/* Changes the metatables of handles; after all of them have been made. */
void lenient_open(lua_State *L);
void lenient_push_ghost(lua_State *L, const char *name, bool is_method);
/* Pushes a loader for a module that does not exist, with a warning. */
void lenient_replace_module(lua_State *L, const char *name);
/* The node of the ghost, or NULL; if `make` is set, a missing node is created. */
void *lenient_ghost_as(struct script_context *context, const struct handle *ghost, enum handle_type type, bool make);
/* Pushes the field at index 2 of the value at index 1 if the script has set it. */
bool lenient_own_field(lua_State *L);
/* __index of handles without methods: ignores fields that do not exist, with a warning. */
int lenient_handle_index(lua_State *L);
/* Adds the arguments `first` to `last`, and the entries of tables among them, to the ghost at stack index `at`. */
void lenient_ghost_take(struct script_context *context, int at, int first, int last);

#endif
