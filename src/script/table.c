/* The rows of all files. docs/language.md describes every function. */
#include "script/table_internal.h"

#include "call/display_colour.h"
#include "record/symbol.h"
#include "script/gr_keys_internal.h"
#include "script/rows_internal.h"

#include <string.h>

/* In the order of the manual. */
static const struct function_rows *const parts[] = {
    &node_functions,     &mesh_functions,    &solid_functions,         &shape_functions,       &swept_functions,
    &displace_functions, &texture_functions, &material_functions,      &glyph_functions,       &layered_functions,
    &word_functions,     &light_functions,   &change_functions,        &environment_functions, &medium_functions,
    &render_functions,   &method_functions,  &render_method_functions, &export_functions,      &frame_functions};

static const struct value_functions *const value_parts[] = {&vector_functions, &display_colour_functions,
                                                            &key_functions, &symbol_functions};

int function_count(void) {
    int count = 0;
    for (int part = 0; part < COUNT(parts); part++)
        count += parts[part]->count;
    return count;
}

const struct script_function *function_at(int index) {
    int part = 0;
    for (; index >= parts[part]->count; part++)
        index -= parts[part]->count;
    return &parts[part]->rows[index];
}

const struct script_function *function_find(enum function_owner owner, const char *name) {
    for (int i = 0; i < function_count(); i++) {
        const struct script_function *function = function_at(i);
        if (function->owner == owner && strcmp(function->name, name) == 0)
            return function;
    }
    return NULL;
}

const struct value_function *value_function_at(size_t index) {
    for (int part = 0; part < COUNT(value_parts); part++) {
        size_t count = (size_t)value_parts[part]->count;
        if (index < count)
            return &value_parts[part]->functions[index];
        index -= count;
    }
    return NULL;
}
