/* What scripts for Lua 5.0 to 5.3 use, and values that are literals of Lua. */
#ifndef GRAY_COMPAT_COMPAT_H
#define GRAY_COMPAT_COMPAT_H

#include <lua.h>

/* Runs protected and may raise. */
void compat_open(lua_State *L);
/* Pushes the value that a text is as a literal of Lua (number, quoted string, true, false, nil, a table of literals),
 * or the text. */
void compat_push_literal(lua_State *L, const char *text);

#endif
