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
    switch (kind) {
    case KIND_NUMBER:
        return "a number";
    case KIND_WHOLE:
        return "a whole number";
    case KIND_BOOLEAN:
        return "true or false";
    case KIND_TEXT:
        return "a string";
    case KIND_FILE:
        return "the name of a file";
    case KIND_OUTPUT:
        return "the name of a file";
    case KIND_CHOICE:
        return "a word";
    case KIND_AXIS:
        return "'x', 'y' or 'z'";
    case KIND_POINT:
        return "a point {x, y, z}";
    case KIND_DIRECTION:
        return "a direction {x, y, z}";
    case KIND_COLOUR:
        return "a colour {r, g, b}";
    case KIND_TRIPLE:
        return "a table of 3 numbers";
    case KIND_INTERVAL:
        return "a table of two rising numbers";
    case KIND_SIZE:
        return "a number or a table of 3 numbers";
    case KIND_QUATERNION:
        return "a table of 4 numbers {w, x, y, z}";
    case KIND_PAIR:
        return "a number or a table of 2 numbers";
    case KIND_NODE:
        return "a node";
    case KIND_MATERIAL:
        return "a material";
    case KIND_MATERIALS:
        return "a table of materials";
    case KIND_IMAGE:
        return "the name of a picture file or a texture";
    case KIND_BACKGROUND:
        return "a colour {r, g, b}, a sky, a function or 'gradient'";
    case KIND_FOG:
        return "a fog";
    case KIND_CAUSTICS:
        return "a number of photons or {photons = ..., radius = ...}";
    case KIND_STOPS:
        return "a table of stops {height, r, g, b}";
    case KIND_NODES:
        return "a table of nodes";
    case KIND_LIGHTS:
        return "a table of lights";
    case KIND_POINTS:
        return "a table of points {x, y, z}";
    case KIND_PAIRS:
        return "a table of pairs {u, v}";
    case KIND_FACES:
        return "a table of tuples of indices";
    case KIND_NUMBERS:
        return "a number or a table of numbers";
    case KIND_ROWS:
        return "a table of tables of numbers";
    case KIND_CURVES:
        return "a table of tables of pairs {x, z}";
    case KIND_FUNCTION:
    case KIND_CALLBACK:
        return "a function";
    case KIND_COUNT:
        break;
    }
    UNREACHABLE("a parameter of no kind");
}
