/* Heights from functions. */
#ifndef GRAY_SCRIPT_GR_DISPLACE_INTERNAL_H
#define GRAY_SCRIPT_GR_DISPLACE_INTERNAL_H

#include "call/context.h"

struct height_field_input;

/* The heights of a grid, or 0 if it has none, plus those of a function; in the arena of the call. NULL with an
 * error. */
const double *gr_function_heights(struct script_context *context, const struct height_field_input *grid,
                                  const struct expr_program *program, struct error *error);

#endif
