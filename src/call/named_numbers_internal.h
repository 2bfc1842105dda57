/* Tables of numbers by name. */
#ifndef GRAY_CALL_NAMED_NUMBERS_INTERNAL_H
#define GRAY_CALL_NAMED_NUMBERS_INTERNAL_H

#include "call/context.h"

/* Pushes {1, 2, 3} of {x = 1, y = 2, z = 3}, or of the letters of a colour or a quaternion; false: there are no such
 * names, and nothing is pushed. */
bool named_numbers_push(lua_State *L, int index, int count);
/* {azimuth = ..., elevation = ...} in degrees, from north (-z) over east (+x) and above the horizon, at that index.
 * Wrong numbers are errors of the argument `name`. False: it has no such names. */
bool compass_read(struct script_context *context, int index, const char *name, struct vec3 *out);

#endif
