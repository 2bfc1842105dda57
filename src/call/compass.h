/* Directions as those of a compass. */
#ifndef GRAY_CALL_COMPASS_H
#define GRAY_CALL_COMPASS_H

#include "call/context.h"

/* {azimuth = ..., elevation = ...} in degrees, from north (-z) over east (+x) and above the horizon, at that index.
 * Wrong numbers are errors of the argument `name`. False: it has no such names. */
bool compass_read(struct script_context *context, int index, const char *name, struct vec3 *out);

#endif
