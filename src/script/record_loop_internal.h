/* gr.loop. */
#ifndef GRAY_SCRIPT_RECORD_LOOP_INTERNAL_H
#define GRAY_SCRIPT_RECORD_LOOP_INTERNAL_H

#include <lua.h>

int record_loop(lua_State *L);

#endif
