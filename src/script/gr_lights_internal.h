/* What lights of other files share with those of gr_lights.c. */
#ifndef GRAY_SCRIPT_GR_LIGHTS_INTERNAL_H
#define GRAY_SCRIPT_GR_LIGHTS_INTERNAL_H

#include "script/rows_internal.h"

/* Every light has these first; fields of fading and of lamps only where the kind has them. */
enum {
    LIGHT_COLOUR,
    LIGHT_INCLUDE,
    LIGHT_EXCLUDE,
    LIGHT_FALLOFF,
    LIGHT_RANGE,
    LIGHT_INTENSITY,
    LIGHT_EMISSION,
    LIGHT_SAMPLES,
    LIGHT_VISIBLE,
    LIGHT_OWN /* the first field of the kind itself */
};
enum { DISTANT_DIRECTION = LIGHT_EXCLUDE + 1, DISTANT_COUNT };

/* The first parameters of every light. */
#define LIGHT_LISTS                                                                                                    \
    [LIGHT_INCLUDE] =                                                                                                  \
        ROW("include", KIND_NODES, OPTIONAL, ANY, NULL, "all", "Nodes that it lights, with their children."),          \
    [LIGHT_EXCLUDE] =                                                                                                  \
        ROW("exclude", KIND_NODES, OPTIONAL, ANY, NULL, "none", "Nodes that it does not light, with their children.")
#define LIGHT_FIELDS(colour_flags)                                                                                     \
    [LIGHT_COLOUR] = ROW("colour", KIND_COLOUR, (colour_flags) | OR_DISPLAY, ANY, NULL,                                \
                         (colour_flags)&OPTIONAL ? "{1, 1, 1} with emission" : NULL,                                   \
                         (colour_flags)&OR_PROFILE                                                                     \
                             ? "Colour and strength, or a function of the unit direction in which light leaves."       \
                             : "Colour and strength."),                                                                \
    LIGHT_LISTS

/* A directional light, or the sun; see struct script_function. */
bool gr_directional_light(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error);

#endif
