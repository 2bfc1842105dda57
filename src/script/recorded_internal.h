/* Functions of Lua as arguments. */
#ifndef GRAY_SCRIPT_RECORDED_INTERNAL_H
#define GRAY_SCRIPT_RECORDED_INTERNAL_H

#include "script/context_internal.h"
#include "script/record.h"

/* The texture of the Lua function at an absolute index, kept by the scene. Raises every error, with the name of the
 * argument in front. */
const struct script_texture *recorded_texture(struct script_context *context, int index, const char *name);
/* The program of such a function, or of gr.fn of one; NULL of anything else. source: "scene.lua:12". */
const struct expr_program *recorded_program(struct script_context *context, int index, const char *name,
                                            enum record_domain domain, const char **source);

#endif
