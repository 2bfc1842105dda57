/* What every user of the descriptions of functions needs. */
#include "call/function.h"

#include "base/unreachable.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

const char *owner_words(enum function_owner owner) {
    return owner == OWNER_GR ? "gr." : "node:";
}

const char *function_title(const struct script_function *function, char out[96]) {
    snprintf(out, 96, "%s%s", owner_words(function->owner), function->name);
    return out;
}

const struct script_parameter *function_rest(const struct script_function *function, int *index) {
    for (*index = 0; *index < function->parameter_count; (*index)++)
        if (function->parameters[*index].flags & REST)
            return &function->parameters[*index];
    return NULL;
}

bool function_takes_names(const struct script_function *function) {
    bool all_optional = function->parameter_count > 1;
    if (function->owner == OWNER_GR || function->result == RESULT_NOTHING)
        return true;
    for (int k = 1; k < function->parameter_count; k++)
        all_optional = all_optional && (function->parameters[k].flags & OPTIONAL) != 0;
    return all_optional;
}

bool function_renders(const struct script_function *function) {
    for (int k = 0; k < function->parameter_count; k++)
        if (function->parameters[k].kind == KIND_OUTPUT)
            return true;
    return false;
}

bool form_next(const struct script_function *function, const char **form, int *index, bool *optional) {
    const char *word = *form;
    while (*word == ' ')
        word++;
    if (*word == '\0')
        return false;
    size_t length = strcspn(word, " ?");
    *optional = word[length] == '?';
    *form = word + length + (*optional ? 1 : 0);
    for (*index = 0;; (*index)++) {
        assert(*index <
               function->parameter_count); /* every name in a form is that of a parameter: a test checks this */
        const char *name = function->parameters[*index].name;
        if (strncmp(name, word, length) == 0 && name[length] == '\0')
            return true;
    }
}

const char *kind_words(enum argument_kind kind) {
    static const char *const words[KIND_COUNT] = {
        [KIND_NUMBER] = "a number",
        [KIND_WHOLE] = "a whole number",
        [KIND_BOOLEAN] = "true or false",
        [KIND_TEXT] = "a string",
        [KIND_FILE] = "the name of a file",
        [KIND_OUTPUT] = "the name of a file",
        [KIND_CHOICE] = "a word",
        [KIND_AXIS] = "'x', 'y' or 'z'",
        [KIND_POINT] = "a point {x, y, z}",
        [KIND_DIRECTION] = "a direction {x, y, z}",
        [KIND_COLOUR] = "a colour {r, g, b}",
        [KIND_TRIPLE] = "a table of 3 numbers",
        [KIND_INTERVAL] = "a table of two rising numbers",
        [KIND_SIZE] = "a number or a table of 3 numbers",
        [KIND_QUATERNION] = "a table of 4 numbers {w, x, y, z}",
        [KIND_PAIR] = "a number or a table of 2 numbers",
        [KIND_NODE] = "a node",
        [KIND_MATERIAL] = "a material",
        [KIND_MATERIALS] = "a table of materials",
        [KIND_IMAGE] = "the name of a picture file or a texture",
        [KIND_BACKGROUND] = "a colour {r, g, b}, a sky, a function or 'gradient'",
        [KIND_FOG] = "a fog",
        [KIND_CAUSTICS] = "a number of photons or {photons = ..., radius = ...}",
        [KIND_STOPS] = "a table of stops {height, r, g, b}",
        [KIND_NODES] = "a table of nodes",
        [KIND_LIGHTS] = "a table of lights",
        [KIND_POINTS] = "a table of points {x, y, z}",
        [KIND_PAIRS] = "a table of pairs {u, v}",
        [KIND_FACES] = "a table of tuples of indices",
        [KIND_NUMBERS] = "a number or a table of numbers",
        [KIND_ROWS] = "a table of tables of numbers",
        [KIND_CURVES] = "a table of tables of pairs {x, z}",
        [KIND_FUNCTION] = "a function",
        [KIND_CALLBACK] = "a function",
    };
    assert(words[kind]);
    return words[kind];
}
