/* The libraries of Lua, without what an untrusted script must not have. */
#ifndef GRAY_SANDBOX_LIBRARIES_INTERNAL_H
#define GRAY_SANDBOX_LIBRARIES_INTERNAL_H

#include <lua.h>
#include <stdbool.h>

/* Adds them, and os.exit that ends the script. Runs protected and may raise. */
void libraries_open(lua_State *L);
/* Whether Lua's library has this function but the sandbox does not. */
bool libraries_lack(const char *library, const char *name);
/* Arguments that are NaN become the one NaN that every machine writes alike. */
void libraries_take_nan(lua_State *L);

#endif
