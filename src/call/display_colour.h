/* Colours as a screen shows them. */
#ifndef GRAY_CALL_DISPLAY_COLOUR_H
#define GRAY_CALL_DISPLAY_COLOUR_H

#include "call/context.h"
#include "record/vector.h"

/* Whether a value is a display colour. Raises an error for a string '#...' that is not a colour. */
bool display_colour_at(lua_State *L, int index, struct colour *out);
/* An argument that is a colour of the screen; where textures are accepted it is one. False: it is something else. */
bool display_colour_read(struct script_context *context, int index, const struct script_parameter *parameter,
                         struct script_value *value);

extern const struct value_functions display_colour_functions; /* gr.srgb, gr.linear */

#endif
