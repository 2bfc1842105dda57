/* pairs in a fixed order. */
#ifndef GRAY_COMPAT_TRAVERSE_H
#define GRAY_COMPAT_TRAVERSE_H

#include <lua.h>

/* Replaces pairs. Runs protected and may raise. */
void traverse_open(lua_State *L);

#endif
