/* gr.loop. */
#ifndef GRAY_RECORD_RECORD_LOOP_INTERNAL_H
#define GRAY_RECORD_RECORD_LOOP_INTERNAL_H

#include <lua.h>

int record_loop(lua_State *L);

#endif
