/* Reads one argument as its parameter describes it. */
#ifndef GRAY_CALL_ARGUMENT_H
#define GRAY_CALL_ARGUMENT_H

#include "call/context.h"

/* The value at an absolute stack index, unless it is nil. May raise. False: it is a ghost, so the call has no
 * effect. */
bool argument_read(struct script_context *context, int index, const struct script_parameter *parameter,
                   struct script_value *value);
/* Text at that index; it remains in Lua. May raise. */
const char *argument_read_text(struct script_context *context, int index, const struct script_parameter *parameter);
/* The nodes of the table at that index; nil between them is an error. May raise. */
void argument_read_nodes(struct script_context *context, int index, const struct script_parameter *parameter,
                         struct script_value *value);
/* A nil in that table with an entry after it is an error. May raise. */
void argument_check_holes(struct script_context *context, int index, const struct script_parameter *parameter);
/* Whether a value of this Lua type can be an argument of the kind. */
bool argument_resembles(lua_State *L, int index, enum argument_kind kind, unsigned flags);

#endif
