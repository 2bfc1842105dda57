/* The table gr and the methods of nodes. */
#ifndef GRAY_SCRIPT_DISPATCH_INTERNAL_H
#define GRAY_SCRIPT_DISPATCH_INTERNAL_H

#include "call/function.h"

#include <lua.h>

void dispatch_open(lua_State *L); /* the global gr */
void dispatch_push(lua_State *L, const struct script_function *function);
/* The one on top, which dispatch_push has pushed. */
const struct script_function *dispatch_function(lua_State *L);

#endif
