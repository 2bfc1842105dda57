/* Lua of the program itself: the file src/MODULE/NAME.lua is the constant NAME_lua, its lines (Makefile). It runs in
 * the state of an untrusted scene, which must not reach into it: its globals are the functions of Lua's libraries as
 * they were before the scene ran. For positions, error levels and getfenv it counts as C: it has no lines and names.
 * Values of a scene are read with rawget, rawlen and next; strings have no methods here. */
#ifndef GRAY_SANDBOX_EMBEDDED_H
#define GRAY_SANDBOX_EMBEDDED_H

#include <lauxlib.h>

/* Keeps the functions of the libraries; before the scene runs. */
void embedded_open(lua_State *L);
/* Runs the lines, which end with NULL, and pushes their result. Their globals are also the helpers, raise(text), which
 * raises an error with the line of the scene, and words(value). May raise without memory. */
void embedded_run(lua_State *L, const char *const lines[], const luaL_Reg *helpers);
/* The level of the stack behind such functions and what they call, for tracebacks; `level` if there are none. */
int embedded_end(lua_State *L, int level);

#endif
