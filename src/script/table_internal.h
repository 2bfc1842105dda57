/* The table of all functions of gr and methods of nodes, in the order of the manual. */
#ifndef GRAY_SCRIPT_TABLE_INTERNAL_H
#define GRAY_SCRIPT_TABLE_INTERNAL_H

#include "call/function.h"
#include "record/vector.h"

/* The rows of the files gr_....c: beside the functions. */
extern const struct function_rows node_functions, mesh_functions, solid_functions, shape_functions, swept_functions,
    displace_functions, texture_functions, material_functions, glyph_functions, layered_functions, light_functions,
    change_functions, environment_functions, medium_functions, render_functions, method_functions,
    render_method_functions, export_functions, frame_functions, word_functions;

int function_count(void);
/* index: 0 to function_count() - 1. */
const struct script_function *function_at(int index);
/* The row of that name, or NULL. */
const struct script_function *function_find(enum function_owner owner, const char *name);
/* The functions on numbers and vectors, which have no rows in the table. NULL after the last one. */
const struct value_function *value_function_at(size_t index);

#endif
