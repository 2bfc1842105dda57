/* gr.keys. */
#ifndef GRAY_SCRIPT_KEYS_INTERNAL_H
#define GRAY_SCRIPT_KEYS_INTERNAL_H

#include "script/vector_internal.h"

extern const struct value_functions key_functions;

#endif
