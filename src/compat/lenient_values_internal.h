/* Values in the form that a parameter wants. */
#ifndef GRAY_COMPAT_LENIENT_VALUES_INTERNAL_H
#define GRAY_COMPAT_LENIENT_VALUES_INTERNAL_H

#include "call/context.h"

/* Pushes the value at `index` in the form of the parameter, or nil. */
void lenient_convert(struct script_context *context, int index, const struct script_function *function,
                     const struct script_parameter *parameter, const struct script_value *args);
/* Pushes a value for an argument that is missing, or nil. */
void lenient_default(struct script_context *context, const struct script_function *function,
                     const struct script_parameter *parameter);
/* How well the value fits, from 0 (not at all) to 3. */
int lenient_fit(lua_State *L, int index, const struct script_parameter *parameter);

#endif
