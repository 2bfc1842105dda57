/* Files and printing within what the scene was given. */
#ifndef GRAY_SANDBOX_STREAMS_INTERNAL_H
#define GRAY_SANDBOX_STREAMS_INTERNAL_H

#include <lua.h>

struct sandbox;

/* Runs protected and may raise. */
void streams_open(lua_State *L);
void streams_close(struct sandbox *sandbox); /* after the state */

#endif
