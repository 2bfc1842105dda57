/* What every user of the descriptions of functions needs. */
#include "call/function.h"

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

#define KIND_NAME(kind, name, words, annotation, like) [kind] = (name),
#define KIND_WORDS(kind, name, words, annotation, like) [kind] = (words),

const char *kind_name(enum argument_kind kind) {
    static const char *const names[] = {KIND_LIST(KIND_NAME)};
    return names[kind];
}

const char *kind_words(enum argument_kind kind) {
    static const char *const words[] = {KIND_LIST(KIND_WORDS)};
    return words[kind];
}
