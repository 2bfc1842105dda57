/* The arguments of every gr function as the table of functions describes them. */
#include "call/arguments.h"

#include "base/suggestion.h"
#include "call/argument.h"
#include "sandbox/hints.h"

#include <string.h>

/* How well the arguments match a form: how many of the first ones match, then the difference of their number from the
 * form's. */
struct fit {
    int leading, difference;
};

static struct fit form_fit(lua_State *L, const struct script_function *function, const char *form, int first) {
    struct fit fit = {0, 0};
    int count = 0, given = lua_gettop(L) - first + 1, index;
    bool optional;
    for (; form_next(function, &form, &index, &optional); count++) {
        if (fit.leading == count &&
            argument_resembles(L, first + count, function->parameters[index].kind, function->parameters[index].flags))
            fit.leading++;
    }
    fit.difference = given < count ? count - given : given - count;
    return fit;
}

static bool fits_better(struct fit a, struct fit b) {
    return a.leading != b.leading ? a.leading > b.leading : a.difference < b.difference;
}

/* The first argument matches no form: the message lists what the forms accept. */
_Noreturn static void no_form_fits(struct script_context *c, const struct script_function *function, int first) {
    char names[256] = "", words[512] = "";
    for (int k = 0; k < FORM_LIMIT && function->forms[k]; k++) {
        const char *form = function->forms[k];
        int index = 0;
        bool optional, known = false;
        form_next(function, &form, &index, &optional);
        const struct script_parameter *p = &function->parameters[index];
        for (int earlier = 0; earlier < k; earlier++) {
            const char *other = function->forms[earlier];
            int other_index = 0;
            form_next(function, &other, &other_index, &optional);
            known = known || other_index == index;
        }
        if (known)
            continue;
        const char *separator = k == 0 ? "" : " or ";
        snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", separator, p->name);
        snprintf(words + strlen(words), sizeof words - strlen(words), "%s%s", separator, kind_words(p->kind));
    }
    if (lua_isnoneornil(c->sandbox.lua, first))
        sandbox_raise(&c->sandbox, "%s is missing%s", names,
                      lua_isnil(c->sandbox.lua, first) ? hint_of_nil(&c->sandbox) : "");
    sandbox_raise(&c->sandbox, "%s must be %s, not %s", names, words, value_words(c->sandbox.lua, first));
}

/* Nodes after a positional form. Returns the index of the first argument that is not a node. */
static int read_rest(struct script_context *c, const struct script_parameter *p, int first,
                     struct script_value *value) {
    lua_State *L = c->sandbox.lua;
    int end = first;
    while (end <= lua_gettop(L) && (lua_isnil(L, end) || argument_resembles(L, end, KIND_NODE, 0)))
        end++;
    if (end == first)
        return end;
    value->given = value->single = true;
    value->nodes = context_array(c, (size_t)(end - first), sizeof(struct node *));
    for (; first < end; first++) {
        const struct handle *handle = handle_at(L, first);
        if (!handle)
            sandbox_raise(&c->sandbox, "%s[%u] is nil%s", p->name, (unsigned)value->count + 1,
                          hint_of_nil(&c->sandbox));
        value->nodes[value->count++] =
            handle->type == HANDLE_GHOST ? c->ghost_as(c, handle, HANDLE_NODE, false) : handle->pointer;
    }
    return end;
}

static bool read_positional(struct script_context *c, const struct script_function *function, int first,
                            struct script_value *args) {
    lua_State *L = c->sandbox.lua;
    const char *best = function->forms[0];
    struct fit best_fit = form_fit(L, function, best, first);
    for (int k = 1; k < FORM_LIMIT && function->forms[k]; k++) {
        struct fit fit = form_fit(L, function, function->forms[k], first);
        if (fits_better(fit, best_fit)) {
            best_fit = fit;
            best = function->forms[k];
        }
    }
    int index = 0, slot = first;
    bool optional;
    for (const char *form = best; form_next(function, &form, &index, &optional); slot++) {
        /* Messages about the arguments after it contain the name; no method has one, which a test checks. */
        if (function->parameters[index].kind == KIND_TEXT && lua_isstring(L, slot))
            c->sandbox.running.subject = argument_read_text(c, slot, &function->parameters[index]);
    }
    if (best_fit.leading == 0 && function->forms[1])
        no_form_fits(c, function, first);
    slot = first;
    for (const char *form = best; form_next(function, &form, &index, &optional); slot++) {
        const struct script_parameter *p = &function->parameters[index];
        if (!optional && lua_isnoneornil(L, slot)) {
            if (function->owner == OWNER_NODE && lua_gettop(L) < first)
                sandbox_raise(&c->sandbox, "%s is missing; methods are called with a colon, as in n:%s(...)", p->name,
                              function->name);
            sandbox_raise(&c->sandbox, "%s is missing%s", p->name, lua_isnil(L, slot) ? hint_of_nil(&c->sandbox) : "");
        }
        /* gr.render: the name of a variable is misspelt. */
        if (optional && function->result == RESULT_NOTHING && (p->kind == KIND_LIGHTS || p->kind == KIND_COLOUR) &&
            lua_isnil(L, slot))
            sandbox_raise(&c->sandbox, "%s is nil%s", p->name, hint_of_nil(&c->sandbox));
        if (!argument_read(c, slot, p, &args[index]))
            return false;
    }
    int rest_index;
    const struct script_parameter *rest = function_rest(function, &rest_index);
    if (rest)
        slot = read_rest(c, rest, slot, &args[rest_index]);
    if (lua_gettop(L) >= slot)
        context_warn_once(c, WARNED_EXTRA, "arguments after %s are ignored", function->parameters[index].name);
    return true;
}

/* Entries without names, if any. */
static bool read_unnamed(struct script_context *c, const struct script_function *function, int table,
                         struct script_value *args) {
    int index;
    const struct script_parameter *rest = function_rest(function, &index);
    if (!rest)
        return false;
    lua_pushstring(c->sandbox.lua, rest->name);
    bool listed = lua_rawget(c->sandbox.lua, table) != LUA_TNIL;
    lua_pop(c->sandbox.lua, 1);
    argument_check_holes(c, table, rest);
    if (lua_rawlen(c->sandbox.lua, table) == 0)
        return listed;
    if (listed)
        sandbox_raise(&c->sandbox, "%s are given twice, with and without a name", rest->name);
    args[index].given = true;
    argument_read_nodes(c, table, rest, &args[index]);
    return true;
}

/* An unknown field is an error: the first one in byte order, so that the message is always the same. */
static void check_fields(struct script_context *c, const struct script_function *function, int table) {
    lua_State *L = c->sandbox.lua;
    const char *unknown = NULL;
    int skip = function->owner == OWNER_NODE; /* `self` is no field */
    for (lua_pushnil(L); lua_next(L, table); lua_pop(L, 1)) {
        int rest;
        if (lua_isinteger(L, -2) && function_rest(function, &rest))
            continue;
        if (lua_type(L, -2) != LUA_TSTRING)
            sandbox_raise(&c->sandbox, "fields need names, as in %s = ...", function->parameters[skip].name);
        const char *field = lua_tostring(L, -2);
        bool known = false;
        for (int k = skip; k < function->parameter_count && !known; k++)
            known = strcmp(function->parameters[k].name, field) == 0;
        if (!known && (!unknown || strcmp(field, unknown) < 0))
            unknown = field;
    }
    if (!unknown)
        return;
    struct suggestion suggestion;
    suggest_begin(&suggestion, unknown);
    for (int k = skip; k < function->parameter_count; k++)
        suggest_offer(&suggestion, function->parameters[k].name);
    if (suggestion.best)
        sandbox_raise(&c->sandbox, "unknown field '%.100s'; did you mean '%s'?", unknown, suggestion.best);
    char fields[700] = "";
    for (int k = skip; k < function->parameter_count && strlen(fields) < sizeof fields - 60; k++)
        snprintf(fields + strlen(fields), sizeof fields - strlen(fields), "%s%s", k > skip ? ", " : "",
                 function->parameters[k].name);
    sandbox_raise(&c->sandbox, "unknown field '%.100s'; the fields are %s", unknown, fields);
}

static bool read_named(struct script_context *c, const struct script_function *function, int table,
                       struct script_value *args) {
    lua_State *L = c->sandbox.lua;
    int value = lua_gettop(L) + 1;
    for (int k = 0; k < function->parameter_count; k++) {
        const struct script_parameter *p = &function->parameters[k];
        if (p->kind != KIND_TEXT)
            continue;
        lua_pushstring(L, p->name);
        if (lua_rawget(L, table) == LUA_TSTRING)
            c->sandbox.running.subject = lua_tostring(L, value);
        lua_pop(L, 1);
    }
    check_fields(c, function, table);
    bool listed = read_unnamed(c, function, table, args);
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
        const struct script_parameter *p = &function->parameters[k];
        lua_pushstring(L, p->name);
        bool may_miss = (p->flags & OPTIONAL) || listed; /* nodes in a list: none needs a field name */
        if (lua_rawget(L, table) == LUA_TNIL && !may_miss)
            sandbox_raise(&c->sandbox, "%s is missing%s", p->name, hint_of_nil(&c->sandbox));
        if (p->kind == KIND_MATERIAL && lua_isnil(L, value))
            hint_check_field(&c->sandbox, p->name);
        if (!argument_read(c, value, p, &args[k]))
            return false;
        lua_pop(L, 1); /* the table keeps it */
    }
    return true;
}

/* One plain table without an entry 1 holds named fields. */
bool arguments_have_names(lua_State *L, const struct script_function *function, int first, int last) {
    if (last != first || !lua_istable(L, first))
        return false;
    if (!function_takes_names(function))
        return false;
    int rest;
    bool named = lua_rawgeti(L, first, 1) == LUA_TNIL || function_rest(function, &rest);
    lua_pop(L, 1);
    return named;
}

bool arguments_read(struct script_context *context, const struct script_function *function, int first,
                    struct script_value *args) {
    if (arguments_have_names(context->sandbox.lua, function, first, lua_gettop(context->sandbox.lua)))
        return read_named(context, function, first, args);
    return read_positional(context, function, first, args);
}
