/* Handles with --lenient, and ghosts: the results of calls of unknown functions. */
#ifndef GRAY_COMPAT_LENIENT_HANDLES_H
#define GRAY_COMPAT_LENIENT_HANDLES_H

#include "call/context.h"

void lenient_push_ghost(lua_State *L, const char *name, bool is_method);
/* Pushes a loader for a module that does not exist, with a warning. */
void lenient_replace_module(lua_State *L, const char *name);
/* The node or material of the ghost, or NULL; if `make` is set, a missing node is created. */
void *lenient_ghost_as(struct script_context *context, const struct handle *ghost, enum handle_type type, bool make);
/* Pushes the metatables by the names of their types. */
void lenient_push_metatables(lua_State *L);

/* What Lua calls (lenient.lua). The name of the type of a handle; nothing for other values. */
int lenient_handle_type(lua_State *L);
int lenient_ghost_new(lua_State *L);  /* (name, is a method) */
int lenient_ghost_info(lua_State *L); /* its name, and whether it is a method */
/* (ghost, value): adds a node as a child, and the first material. Returns whether the ghost has a node. */
int lenient_ghost_add(lua_State *L);

#endif
