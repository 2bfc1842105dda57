/* The arguments of every gr function as the table of functions describes them. */
#include "call/arguments.h"

#include "base/suggestion.h"
#include "call/argument.h"
#include "sandbox/hints.h"
#include "settings/foreign_words.h"

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

static bool has_field(const void *context, const char *name) {
    const struct script_function *function = context;
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) /* `self` is no field */
        if (strcmp(function->parameters[k].name, name) == 0)
            return true;
    return function->passes && has_field(function->passes->rows, name);
}

static bool form_has(const struct script_function *function, const char *form, int parameter) {
    int index = -1;
    bool optional;
    while (index != parameter && form_next(function, &form, &index, &optional))
        ;
    return index == parameter;
}

/* "; with names: gr.sphere{material = ..., centre = ..., radius = ...}": the fields but the name and rare ones, the
 * first ones of many; "" for methods. */
static const char *table_form_words(const struct script_function *function, char out[256]) {
    enum { SHOWN = 4 };
    char title[96];
    out[0] = '\0';
    if (function->owner == OWNER_NODE)
        return out;
    snprintf(out, 256, "; with names: %s{", function_title(function, title));
    for (int k = 0, shown = 0; k < function->parameter_count && shown <= SHOWN; k++) {
        const char *name = function->parameters[k].name;
        if (strcmp(name, "name") != 0 && !(function->parameters[k].flags & RARE) && ++shown)
            snprintf(out + strlen(out), 256 - strlen(out), "%s%s%s", shown > 1 ? ", " : "",
                     shown > SHOWN ? "..." : name, shown > SHOWN ? "" : " = ...");
    }
    snprintf(out + strlen(out), 256 - strlen(out), "}");
    return out;
}

/* "; the call is node:scale(x, y, z)". */
static const char *call_words(const struct script_function *function, const char *form, char out[256]) {
    char title[96];
    int index;
    bool optional;
    snprintf(out, 256, "; the call is %s(", function_title(function, title));
    for (const char *separator = ""; form_next(function, &form, &index, &optional); separator = ", ")
        snprintf(out + strlen(out), 256 - strlen(out), "%s%s", separator, function->parameters[index].name);
    snprintf(out + strlen(out), 256 - strlen(out), ")");
    return out;
}

/* Whether a table has fields of the function beside entries without names. */
static bool is_mixed(lua_State *L, const struct script_function *function, int table) {
    bool mixed = false;
    for (int k = 0; k < function->parameter_count && !mixed; k++) {
        lua_pushstring(L, function->parameters[k].name);
        mixed = lua_rawget(L, table) != LUA_TNIL;
        lua_pop(L, 1);
    }
    return mixed;
}

/* Calls that have the syntax of another language, and are not calls of any form. */
static void check_syntax(struct script_context *c, const struct script_function *function, int first) {
    lua_State *L = c->sandbox.lua;
    char title[96], fields[256];
    if (!lua_istable(L, first) || function->owner != OWNER_GR)
        return;
    if (context_is_gr(L, first))
        sandbox_raise(&c->sandbox, "functions of gr are called with a dot, as in %s(...), not gr:%s(...)",
                      function_title(function, title), function->name);
    if (lua_gettop(L) == first && is_mixed(L, function, first))
        sandbox_raise(&c->sandbox, "all fields need names when one has%s", table_form_words(function, fields));
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
        /* Forms that begin with the same parameter are named once. */
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
    char fields[256];
    sandbox_raise(&c->sandbox, "%s must be %s, not %s%s", names, words, value_words(c->sandbox.lua, first),
                  table_form_words(function, fields));
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

/* A field that the function does not have: what other programs mean by it, the name of similar spelling, or the nearest
 * ones. */
_Noreturn static void unknown_field(struct script_context *c, const struct script_function *function,
                                    const char *field) {
    bool is_name = false;
    const char *use = foreign_field(field, has_field, function, &is_name);
    if (use && !is_name)
        sandbox_raise(&c->sandbox, "unknown field '%.100s'; use %s", field, use);
    struct suggestion suggestion;
    suggest_begin(&suggestion, field);
    int first = function->owner == OWNER_NODE, count = function->parameter_count - first;
    for (int k = first; k < function->parameter_count; k++)
        suggest_offer(&suggestion, function->parameters[k].name);
    for (int k = 0; function->passes && k < function->passes->rows->parameter_count; k++)
        suggest_offer(&suggestion, function->passes->rows->parameters[k].name);
    if (use || suggestion.best)
        sandbox_raise(&c->sandbox, "unknown field '%.100s'; did you mean '%s'?", field, use ? use : suggestion.best);
    enum { SHORT_LIST = 6 };
    char fields[256] = "";
    bool all = count <= SHORT_LIST;
    for (int k = 0; k < (all ? count : SUGGESTIONS_NEAR) && (all || suggestion.near[k]); k++)
        snprintf(fields + strlen(fields), sizeof fields - strlen(fields), "%s%s", k > 0 ? ", " : "",
                 all ? function->parameters[first + k].name : suggestion.near[k]);
    sandbox_raise(&c->sandbox, "unknown field '%.100s'; the %sfields are %s", field, all ? "" : "nearest ", fields);
}

/* An unknown field is an error: the first one in byte order, so that the message is always the same. */
static void check_fields(struct script_context *c, const struct script_function *function, int table) {
    lua_State *L = c->sandbox.lua;
    const char *unknown = NULL;
    for (lua_pushnil(L); lua_next(L, table); lua_pop(L, 1)) {
        int rest;
        if (lua_isinteger(L, -2) && function_rest(function, &rest))
            continue;
        if (lua_type(L, -2) != LUA_TSTRING)
            sandbox_raise(&c->sandbox, "fields need names, as in %s = ...",
                          function->parameters[function->owner == OWNER_NODE].name);
        const char *field = lua_tostring(L, -2);
        if (!has_field(function, field) && (!unknown || strcmp(field, unknown) < 0))
            unknown = field;
    }
    if (unknown)
        unknown_field(c, function, unknown);
}

/* Fields whose value is a misspelt variable are nil. A material and an entry of a list are errors; other fields may be
 * nil on purpose, as in radius = RADIUS with -D. */
static void check_nil_fields(struct script_context *c, const struct script_function *function, int table) {
    lua_State *L = c->sandbox.lua;
    const char *names[PARAMETER_LIMIT];
    struct nil_field found;
    size_t count = 0;
    if (c->sandbox.locate || !sandbox_is_new_line(&c->sandbox, function)) /* no script, or a loop */
        return;
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
        const struct script_parameter *p = &function->parameters[k];
        lua_pushstring(L, p->name);
        int type = lua_rawget(L, table);
        bool is_list = type == LUA_TTABLE && (p->kind == KIND_NODES || p->kind == KIND_LIGHTS);
        if ((type == LUA_TNIL && (p->flags & OPTIONAL)) || is_list)
            names[count++] = p->name;
        lua_pop(L, 1);
    }
    int index;
    const struct script_parameter *rest = function_rest(function, &index);
    if (!hint_find_nil_field(&c->sandbox, names, count, rest ? rest->name : NULL, &found))
        return;
    if (found.entry > 0)
        sandbox_raise(&c->sandbox, "%s[%d] is nil%s", found.field, found.entry, found.words);
    if (strcmp(found.field, "material") == 0)
        sandbox_raise(&c->sandbox, "%s is missing%s", found.field, found.words);
    sandbox_warn(&c->sandbox, "%s is nil and has its default%s", found.field, found.words);
}

static bool read_named(struct script_context *c, const struct script_function *function, int table,
                       struct script_value *args) {
    lua_State *L = c->sandbox.lua;
    int value = lua_gettop(L) + 1;
    for (int k = 0; k < function->parameter_count; k++) {
        const struct script_parameter *p = &function->parameters[k];
        if (p->kind != KIND_TEXT || function->result == RESULT_TEXTURE)
            continue;
        lua_pushstring(L, p->name);
        if (lua_rawget(L, table) == LUA_TSTRING)
            c->sandbox.running.subject = lua_tostring(L, value);
        lua_pop(L, 1);
    }
    check_fields(c, function, table);
    check_nil_fields(c, function, table);
    bool listed = read_unnamed(c, function, table, args);
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
        const struct script_parameter *p = &function->parameters[k];
        lua_pushstring(L, p->name);
        /* Nodes in a list need no field name; of a method, the arguments of its first form have to be there. */
        bool may_miss = (p->flags & OPTIONAL) || listed ||
                        (function->owner == OWNER_NODE && !form_has(function, function->forms[0], k));
        if (lua_rawget(L, table) == LUA_TNIL && p->kind == KIND_OUTPUT && c->draws)
            sandbox_raise(&c->sandbox,
                          "draw returns the table of fields, as in return {node = ...}; it does not render");
        if (lua_isnil(L, -1) && !may_miss)
            sandbox_raise(&c->sandbox, "%s is missing%s", p->name, hint_of_nil(&c->sandbox));
        if (!argument_read(c, value, p, &args[k]))
            return false;
        lua_pop(L, 1); /* the table keeps it */
    }
    return true;
}

/* Whether it is a table without an entry 1: it holds named fields. */
static bool is_plain_table(lua_State *L, int index) {
    if (!lua_istable(L, index))
        return false;
    bool plain = lua_rawgeti(L, index, 1) == LUA_TNIL;
    lua_pop(L, 1);
    return plain;
}

/* The table of fields after a positional form. */
static bool read_more(struct script_context *c, const struct script_function *function, int table,
                      struct script_value *args) {
    lua_State *L = c->sandbox.lua;
    int value = lua_gettop(L) + 1;
    check_fields(c, function, table);
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
        const struct script_parameter *p = &function->parameters[k];
        lua_pushstring(L, p->name);
        bool is_field = lua_rawget(L, table) != LUA_TNIL;
        if (is_field && args[k].given)
            sandbox_raise(&c->sandbox, "%s is given twice, as an argument and as a field", p->name);
        if (is_field && !argument_read(c, value, p, &args[k]))
            return false;
        lua_pop(L, 1); /* the table keeps it */
    }
    return true;
}

static bool read_positional(struct script_context *c, const struct script_function *function, int first,
                            struct script_value *args) {
    lua_State *L = c->sandbox.lua;
    check_syntax(c, function, first);
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
        if (function->parameters[index].kind == KIND_TEXT && function->result != RESULT_TEXTURE &&
            lua_isstring(L, slot))
            c->sandbox.running.subject = argument_read_text(c, slot, &function->parameters[index]);
    }
    if (best_fit.leading == 0 && function->forms[1])
        no_form_fits(c, function, first);
    slot = first;
    for (const char *form = best; form_next(function, &form, &index, &optional); slot++) {
        const struct script_parameter *p = &function->parameters[index];
        if (!optional && lua_isnoneornil(L, slot)) {
            if (lua_gettop(L) < first && hint_has_colon(&c->sandbox, function->name))
                sandbox_raise(&c->sandbox, "%s is missing: nothing was given, or a function that returned nothing",
                              p->name);
            if (function->owner == OWNER_NODE && lua_gettop(L) < first)
                sandbox_raise(&c->sandbox, "%s is missing; methods are called with a colon, as in n:%s(...)", p->name,
                              function->name);
            char call[256];
            sandbox_raise(&c->sandbox, "%s is missing%s", p->name,
                          lua_isnil(L, slot) ? hint_of_nil(&c->sandbox) : call_words(function, best, call));
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
    if (function_renders(function) && is_plain_table(L, slot) && !read_more(c, function, slot++, args))
        return false;
    char fields[256];
    if (lua_gettop(L) >= slot) {
        const char *name = function->parameters[index].name;
        if (c->sandbox.locate) /* a file of data has no habits of old scripts */
            sandbox_raise(&c->sandbox, "there are arguments after %s", name);
        context_warn_once(c, WARNED_EXTRA, "arguments after %s are ignored%s", name,
                          table_form_words(function, fields));
    }
    /* gr.sphere(2): numbers count as text, so this is a name. */
    if (lua_gettop(L) == first && lua_type(L, first) == LUA_TNUMBER && has_field(function, "material") &&
        has_field(function, "name"))
        context_warn_once(c, WARNED_OTHER, "%s is the name of the node%s", lua_tostring(L, first),
                          table_form_words(function, fields));
    return true;
}

/* One plain table without an entry 1 holds named fields. */
bool arguments_have_names(lua_State *L, const struct script_function *function, int first, int last) {
    int rest;
    bool named = last == first && lua_istable(L, first) && (is_plain_table(L, first) || function_rest(function, &rest));
    return named &&
           (function_takes_names(function) || is_mixed(L, function, first)); /* others may have a tuple there */
}

bool arguments_read(struct script_context *context, const struct script_function *function, int first,
                    struct script_value *args) {
    if (arguments_have_names(context->sandbox.lua, function, first, lua_gettop(context->sandbox.lua)))
        return read_named(context, function, first, args);
    return read_positional(context, function, first, args);
}
