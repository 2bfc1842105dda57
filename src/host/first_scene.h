/* --init: a first scene and the settings of editors. */
#ifndef GRAY_HOST_FIRST_SCENE_H
#define GRAY_HOST_FIRST_SCENE_H

#include "session/options.h"

/* The word of the options is the folder; none: this one. library: that of the Lua library, or NULL. Returns the exit
 * status. */
int first_scene_write(const struct options *options, const char *library);

#endif
