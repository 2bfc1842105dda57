/* Reads the arguments of a call: one table of named fields, or the positional form that fits best. */
#ifndef GRAY_CALL_ARGUMENTS_H
#define GRAY_CALL_ARGUMENTS_H

#include "call/context.h"

/* May raise. Reads into args[0 .. parameter_count-1]. False: an argument is a ghost, so the call has no effect. `first`
 * is the stack index of the first argument. */
bool arguments_read(struct script_context *context, const struct script_function *function, int first,
                    struct script_value *args);
/* Whether the arguments first to last are one table of named fields. */
bool arguments_have_names(lua_State *L, const struct script_function *function, int first, int last);

#endif
