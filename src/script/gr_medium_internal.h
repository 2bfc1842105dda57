/* Media of solids. */
#ifndef GRAY_SCRIPT_GR_MEDIUM_INTERNAL_H
#define GRAY_SCRIPT_GR_MEDIUM_INTERNAL_H

#include "call/function.h"

/* The material of a surface with the medium behind it, or of one of them alone. False: no memory. */
bool choose_material(struct script_context *context, const struct script_value *material,
                     const struct script_value *medium, const struct material **out, struct error *error);
#endif
