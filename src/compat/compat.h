/* What scripts for Lua 5.0 to 5.3 use. */
#ifndef GRAY_COMPAT_COMPAT_H
#define GRAY_COMPAT_COMPAT_H

#include <lua.h>

/* Runs protected and may raise. */
void compat_open(lua_State *L);

#endif
