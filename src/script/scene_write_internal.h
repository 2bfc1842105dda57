/* Writing the scene of a picture as text, in the place of rendering it. */
#ifndef GRAY_SCRIPT_SCENE_WRITE_INTERNAL_H
#define GRAY_SCRIPT_SCENE_WRITE_INTERNAL_H

#include "script/script.h"

#include <lua.h>

struct script_context;
struct script_function;
struct script_value;
struct script_result;

/* From here on calls are recorded. */
void scene_write_open(lua_State *L);
/* A function of the table begins, and has made its result. May raise. */
void scene_write_begin(struct script_context *context);
void scene_write_call(struct script_context *context, const struct script_function *function,
                      const struct script_value *args, const struct script_result *result);
/* Hands the scene of the picture to the host. */
bool scene_write_picture(struct script_context *context, const struct render_request *request, struct error *error);

#endif
