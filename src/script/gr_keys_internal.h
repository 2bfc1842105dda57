/* gr.keys. */
#ifndef GRAY_SCRIPT_GR_KEYS_INTERNAL_H
#define GRAY_SCRIPT_GR_KEYS_INTERNAL_H

#include "record/vector.h"

extern const struct value_functions key_functions;

#endif
