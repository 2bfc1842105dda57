/* The scene of a model on the command line. */
#ifndef GRAY_SCRIPT_MODEL_SCENE_INTERNAL_H
#define GRAY_SCRIPT_MODEL_SCENE_INTERNAL_H

#include <lua.h>

/* Runs model_scene.lua with the file that takes the place of the script. */
void model_scene_run(lua_State *L);

#endif
