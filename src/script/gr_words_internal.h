/* Short words for light and materials, which lua/words.lua makes of the other functions of gr. */
#ifndef GRAY_SCRIPT_GR_WORDS_INTERNAL_H
#define GRAY_SCRIPT_GR_WORDS_INTERNAL_H

#include "call/function.h"

#include <lua.h>

/* Calls the function of that name in lua/words.lua with the arguments of the call as one table. Pushes what it returns;
 * may raise. */
int words_answer(lua_State *L, const struct script_function *function);

#endif
