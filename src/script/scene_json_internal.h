/* A scene in JSON, in the place of a script (docs/json.md). */
#ifndef GRAY_SCRIPT_SCENE_JSON_INTERNAL_H
#define GRAY_SCRIPT_SCENE_JSON_INTERNAL_H

#include <lua.h>
#include <stdbool.h>

/* Of the files. */
enum { SCENE_JSON_VERSION = 1 };
/* The member for a field `type` of a function. */
#define SCENE_JSON_FIELD_TYPE "field_type"

/* Whether it is the name of one: it ends in .json. */
bool scene_json_is_named(const char *path);
/* Reads the file that takes the place of the script. May raise. */
void scene_json_run(lua_State *L);

#endif
