/* What every user of the descriptions of functions needs. */
#include "call/function.h"

#include "base/lua_fields.h"

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

static void push_parameter(lua_State *L, const struct script_parameter *p) {
    static const struct {
        unsigned flag;
        const char *name;
    } flags[] = {{OPTIONAL, "optional"}, {LOW_OPEN, "low_open"},          {HIGH_OPEN, "high_open"},
                 {NOT_ZERO, "not_zero"}, {OR_TEXTURE, "or_texture"},      {OR_NUMBER, "or_number"},
                 {OR_CURVE, "or_curve"}, {OR_PROFILE, "or_profile"},      {OR_FUNCTION, "or_function"},
                 {OR_FILE, "or_file"},   {OR_COMPASS, "or_compass"},      {OR_PAIR, "or_pair"},
                 {OR_SKY, "or_sky"},     {GHOST_IS_NONE, "ghost_is_none"}};
    lua_newtable(L);
    field_text(L, "name", p->name);
    field_text(L, "kind", kind_name(p->kind));
    field_text(L, "choices", p->choices);
    field_text(L, "help", p->help);
    field_number(L, "low", p->low);
    field_number(L, "high", p->high);
    lua_pushlightuserdata(L, (void *)(uintptr_t)p);
    lua_setfield(L, -2, "row");
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++)
        field_flag(L, flags[i].name, p->flags & flags[i].flag);
}

void function_push(lua_State *L, const struct script_function *function) {
    static const char *const results[] = {RESULT_KINDS(LIST_WORD)};
    int index;
    const struct script_parameter *rest = function_rest(function, &index);
    lua_createtable(L, function->parameter_count, 8);
    field_text(L, "name", function->name);
    field_text(L, "owner", function->owner == OWNER_NODE ? "node" : "gr");
    field_text(L, "result", results[function->result]);
    field_text(L, "rest", rest ? rest->name : NULL);
    field_flag(L, "renders", function_renders(function));
    lua_pushinteger(L, function->owner == OWNER_NODE ? 2 : 1);
    lua_setfield(L, -2, "first");
    lua_pushlightuserdata(L, (void *)(uintptr_t)function);
    lua_setfield(L, -2, "row");
    for (int k = 0; k < function->parameter_count; k++) {
        push_parameter(L, &function->parameters[k]);
        lua_rawseti(L, -2, k + 1);
    }
}
