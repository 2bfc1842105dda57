/* Functions that could catch what a script must not catch. */
#ifndef GRAY_SANDBOX_PROTECT_H
#define GRAY_SANDBOX_PROTECT_H

#include <lua.h>

/* Replaces them. Runs protected and may raise. */
void protect_open(lua_State *L);
/* Replaces library.name by `function`; the old function becomes its upvalue. */
void wrap_function(lua_State *L, const char *library, const char *name, lua_CFunction function);

#endif
