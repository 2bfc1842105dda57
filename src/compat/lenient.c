/* Calls with --lenient. The arguments are first read as usual. If that raises an error, or the function fails, the
 * error becomes a warning, and the arguments are matched again: by type to the positional form that takes most of them,
 * or by the letters of their names. Remaining arguments are converted, missing ones get a default, values out of
 * range the nearest one. If the function fails again, it gets only the arguments of its positional forms. If that fails
 * too, the result is a ghost: a group of the nodes of the call.
 *
 * Errors that a script must not catch pass through: limits, memory, errors of the machine. */
#include "compat/lenient.h"

#include "base/hash.h"
#include "base/suggestion.h"
#include "call/argument.h"
#include "call/arguments.h"
#include "compat/lenient_handles.h"
#include "compat/lenient_picture.h"
#include "compat/lenient_values_internal.h"

#include <lauxlib.h>
#include <stdarg.h>
#include <string.h>

/* Warnings. */

/* The text without its numbers: a warning in a loop is printed once. */
static uint64_t kind_of_warning(const char *where, const char *text) {
    uint64_t hash = hash_bytes(where, strlen(where), 0);
    while (*text) {
        size_t length = strcspn(text, "0123456789");
        hash = hash_bytes(text, length, hash);
        text += length;
        text += strspn(text, "0123456789");
    }
    return hash;
}

/* `line` already names the function: "gr.sphere: radius must be > 0". */
static void warn_line(struct script_context *c, const char *line) {
    struct lenient *lenient = c->lenient;
    char where[PATH_SIZE + 32];
    sandbox_where(&c->sandbox, where, sizeof where);
    uint64_t kind = kind_of_warning(where, line);
    for (uint32_t i = 0; i < lenient->warned_count; i++)
        if (lenient->warned[i] == kind)
            return;
    if (lenient->warned_count == LENIENT_WARNINGS)
        return;
    lenient->warned[lenient->warned_count++] = kind;
    sandbox_warn_line(&c->sandbox, line);
}

void lenient_warn(struct script_context *c, const char *format, ...) {
    char text[1024], line[1536];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    sandbox_compose(&c->sandbox, text, line, sizeof line);
    warn_line(c, line);
}

/* Nodes and lights that the script has made. */

bool lenient_begin(struct script_context *c) {
    c->lenient = arena_alloc(&c->sandbox.keep, sizeof *c->lenient);
    c->ghost_as = lenient_ghost_as;
    c->sandbox.replace_module = lenient_replace_module;
    return c->lenient != NULL;
}

void lenient_note_node(struct script_context *c, struct node *node) {
    struct lenient *lenient = c->lenient;
    lenient->last = node;
    if (lenient->node_count == lenient->node_room) {
        uint32_t room = lenient->node_room ? 2 * lenient->node_room : 256;
        struct node **more = arena_alloc_array(&c->sandbox.keep, room, sizeof *more);
        if (!more)
            sandbox_raise_no_memory(&c->sandbox);
        if (lenient->node_count > 0)
            memcpy(more, lenient->nodes, lenient->node_count * sizeof *more);
        lenient->nodes = more;
        lenient->node_room = room;
    }
    lenient->nodes[lenient->node_count++] = node;
}

static void note_result(struct script_context *c, const struct script_function *function,
                        const struct script_value *args, const struct script_result *result) {
    struct lenient *lenient = c->lenient;
    if (function->result == RESULT_NODE)
        lenient_note_node(c, result->pointer);
    if (function->result == RESULT_SELF)
        lenient->last = args[SELF].node;
    if (function->result == RESULT_LIGHT && lenient->light_count < LENIENT_LIGHTS)
        lenient->lights[lenient->light_count++] = *(const struct scene_light *)result->pointer;
}

/* Protected reading of arguments. */

struct protected_reading {
    const struct script_function *function;
    const struct script_parameter *parameter; /* only this one, or NULL for all */
    struct script_value *args;                /* of the function, or the one value */
    bool complete;                            /* false: an argument is a ghost without a value */
};

/* Index 1: the reading; the arguments follow. */
static int read_protected(lua_State *L) {
    struct protected_reading *reading = lua_touserdata(L, 1);
    struct script_context *c = context_of(L);
    c->sandbox.lua = L;
    if (reading->parameter)
        reading->complete = argument_read(c, 2, reading->parameter, reading->args);
    else
        reading->complete = arguments_read(c, reading->function, 2, reading->args);
    return 0;
}

/* Calls the function below `count` arguments at the top, which are popped. False: it raised an error, and
 * context->sandbox.raised has the line. What must not be caught is raised again. */
static bool survives(struct script_context *c, int count) {
    lua_State *L = c->sandbox.lua;
    c->sandbox.raised[0] = '\0';
    int status = lua_pcall(L, count, 0, 0);
    c->sandbox.lua = L;
    if (status == LUA_OK)
        return true;
    if (status == LUA_ERRMEM || sandbox_is_over(&c->sandbox))
        lua_error(L);
    if (c->sandbox.raised[0] == '\0' && lua_isstring(L, -1))
        snprintf(c->sandbox.raised, sizeof c->sandbox.raised, "%s", lua_tostring(L, -1));
    lua_pop(L, 1);
    return false;
}

/* Reads all arguments from `first` on in the usual way. False: it raised an error. */
static bool read_all(struct script_context *c, const struct script_function *function, int first,
                     struct script_value *args, bool *complete) {
    lua_State *L = c->sandbox.lua;
    struct protected_reading reading = {.function = function, .args = args};
    int top = lua_gettop(L);
    luaL_checkstack(L, top + 10, NULL);
    lua_pushcfunction(L, read_protected);
    lua_pushlightuserdata(L, &reading);
    for (int i = first; i <= top; i++)
        lua_pushvalue(L, i);
    bool read = survives(c, top - first + 2);
    *complete = reading.complete;
    return read;
}

/* Matching. */

enum { MATCHED_MAX = 24 };

/* The arguments of a call and the parameters of a form; taken[p] is the argument of parameter p from 1, 0: none. */
struct match {
    const struct script_parameter *parameters[MATCHED_MAX];
    bool is_optional[MATCHED_MAX];
    int arguments[MATCHED_MAX]; /* stack indices */
    int parameter_count, argument_count, score;
    int fit[MATCHED_MAX][MATCHED_MAX], taken[MATCHED_MAX];
    bool used[MATCHED_MAX + 1];
};

/* In order: the longest common subsequence by the sum of its fits. */
static void match_in_order(struct match *m) {
    int best[MATCHED_MAX + 1][MATCHED_MAX + 1] = {{0}};
    for (int p = m->parameter_count - 1; p >= 0; p--) {
        for (int a = m->argument_count - 1; a >= 0; a--) {
            int both = m->fit[p][a] > 0 ? m->fit[p][a] + best[p + 1][a + 1] : 0;
            int skip = best[p + 1][a] > best[p][a + 1] ? best[p + 1][a] : best[p][a + 1];
            best[p][a] = both >= skip ? both : skip;
        }
    }
    m->score = best[0][0];
    for (int p = 0, a = 0; p < m->parameter_count && a < m->argument_count;) {
        if (m->fit[p][a] > 0 && best[p][a] == m->fit[p][a] + best[p + 1][a + 1]) {
            m->taken[p++] = ++a;
            m->used[a] = true;
        } else if (best[p][a] == best[p + 1][a]) {
            p++;
        } else {
            a++;
        }
    }
}

static int fit_taken(const struct match *m, int p, int taken) {
    return taken > 0 ? m->fit[p][taken - 1] : 0;
}

/* Matches the remaining arguments in any order, and exchanges two arguments where both then fit better. */
static void match_rest(struct match *m) {
    for (int p = 0; p < m->parameter_count; p++) {
        for (int a = 1; a <= m->argument_count && !m->taken[p]; a++) {
            if (m->used[a] || m->fit[p][a - 1] == 0)
                continue;
            m->taken[p] = a;
            m->used[a] = true;
            m->score += m->fit[p][a - 1];
        }
    }
    for (int p = 0; p < m->parameter_count; p++) {
        for (int q = p + 1; q < m->parameter_count; q++) {
            int now = fit_taken(m, p, m->taken[p]) + fit_taken(m, q, m->taken[q]);
            int then = fit_taken(m, p, m->taken[q]) + fit_taken(m, q, m->taken[p]);
            bool fits =
                (!m->taken[q] || fit_taken(m, p, m->taken[q])) && (!m->taken[p] || fit_taken(m, q, m->taken[p]));
            if (then <= now || !fits)
                continue;
            int kept = m->taken[p];
            m->taken[p] = m->taken[q];
            m->taken[q] = kept;
            m->score += then - now;
        }
    }
}

static void match_form(struct script_context *c, const struct script_function *function, const char *form,
                       struct match *m) {
    bool optional;
    for (int index; m->parameter_count < MATCHED_MAX && form_next(function, &form, &index, &optional);) {
        m->is_optional[m->parameter_count] = optional;
        m->parameters[m->parameter_count++] = &function->parameters[index];
    }
    for (int p = 0; p < m->parameter_count; p++)
        for (int a = 0; a < m->argument_count; a++)
            m->fit[p][a] = lenient_fit(c->sandbox.lua, m->arguments[a], m->parameters[p]);
    match_in_order(m);
    match_rest(m);
    for (int p = 0; p < m->parameter_count; p++)
        m->score -= !m->taken[p] && !m->is_optional[p];
}

static bool wants_tuple(enum argument_kind kind) {
    return kind == KIND_POINT || kind == KIND_DIRECTION || kind == KIND_COLOUR || kind == KIND_TRIPLE ||
           kind == KIND_SIZE || kind == KIND_QUATERNION;
}

/* Pushes a table of the next unused numbers, at most `count`; nil if there is none. */
static void push_loose_numbers(lua_State *L, struct match *m, int count) {
    int found = 0;
    lua_createtable(L, count, 0);
    for (int a = 1; a <= m->argument_count && found < count; a++) {
        if (m->used[a] || lua_type(L, m->arguments[a - 1]) != LUA_TNUMBER)
            continue;
        m->used[a] = true;
        lua_pushvalue(L, m->arguments[a - 1]);
        lua_rawseti(L, -2, ++found);
    }
    if (found == 1) { /* one for all */
        lua_rawgeti(L, -1, 1);
        lua_replace(L, -2);
    } else if (found == 0) {
        lua_pop(L, 1);
        lua_pushnil(L);
    }
}

/* Without any table, three numbers stand for each: all numbers are taken again, in order. */
static void free_loose_numbers(lua_State *L, struct match *m) {
    int numbers = 0, tuples = 0;
    for (int a = 0; a < m->argument_count; a++) {
        numbers += lua_type(L, m->arguments[a]) == LUA_TNUMBER;
        if (lua_istable(L, m->arguments[a]))
            return;
    }
    for (int p = 0; p < m->parameter_count; p++)
        tuples += wants_tuple(m->parameters[p]->kind);
    if (tuples == 0 || numbers < 3)
        return;
    for (int p = 0; p < m->parameter_count; p++) {
        if (m->taken[p] && lua_type(L, m->arguments[m->taken[p] - 1]) == LUA_TNUMBER) {
            m->used[m->taken[p]] = false;
            m->taken[p] = 0;
        }
    }
}

/* Pushes the first unused argument that can be converted, or nil. */
static void push_convertible(struct script_context *c, const struct script_function *function, struct match *m,
                             const struct script_parameter *p, const struct script_value *args) {
    lua_State *L = c->sandbox.lua;
    bool nothing = c->lenient->nothing;
    for (int a = 1; a <= m->argument_count; a++) {
        if (m->used[a] || lua_isnil(L, m->arguments[a - 1]) || p->kind == KIND_BOOLEAN)
            continue;
        lenient_convert(c, m->arguments[a - 1], function, p, args);
        bool empty = lua_istable(L, -1) && lua_rawlen(L, -1) == 0;
        if (!lua_isnil(L, -1) && !empty) {
            m->used[a] = true;
            return;
        }
        lua_pop(L, 1);
    }
    c->lenient->nothing = nothing;
    lua_pushnil(L);
}

/* Positional arguments become the fields of the table at `named`. wanted: the parameters that need a value. */
static void name_positional(struct script_context *c, const struct script_function *function, int first, int named,
                            bool wanted[PARAMETER_LIMIT]) {
    lua_State *L = c->sandbox.lua;
    struct match empty = {.argument_count = 0}, best = empty;
    const struct script_value none[PARAMETER_LIMIT] = {{0}};
    for (int i = first; i < named && empty.argument_count < MATCHED_MAX; i++)
        if (i > first || !context_is_gr(L, i)) /* gr:sphere() */
            empty.arguments[empty.argument_count++] = i;
    for (int k = 0; k < FORM_LIMIT && function->forms[k]; k++) {
        struct match m = empty;
        match_form(c, function, function->forms[k], &m);
        if (k == 0 || m.score > best.score)
            best = m;
    }
    free_loose_numbers(L, &best);
    for (int p = 0; p < best.parameter_count; p++) {
        const struct script_parameter *parameter = best.parameters[p];
        if (best.taken[p])
            lua_pushvalue(L, best.arguments[best.taken[p] - 1]);
        else if (wants_tuple(parameter->kind))
            push_loose_numbers(L, &best, parameter->kind == KIND_QUATERNION ? 4 : 3);
        else
            push_convertible(c, function, &best, parameter, none);
        if (lua_isnil(L, -1) && wants_tuple(parameter->kind)) {
            lua_pop(L, 1);
            push_convertible(c, function, &best, parameter, none);
        }
        lua_setfield(L, named, parameter->name);
        wanted[parameter - function->parameters] = !best.is_optional[p];
    }
}

/* The parameter of a field: with this name, with the same letters in any case, or with the most similar name. */
static const struct script_parameter *meant_field(const struct script_function *function, const char *field) {
    struct suggestion suggestion;
    suggest_begin(&suggestion, field);
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
        if (strcmp(function->parameters[k].name, field) == 0)
            return &function->parameters[k];
        suggest_offer(&suggestion, function->parameters[k].name);
    }
    for (int k = function->owner == OWNER_NODE; suggestion.best && k < function->parameter_count; k++)
        if (function->parameters[k].name == suggestion.best)
            return &function->parameters[k];
    return NULL;
}

/* The fields of the table at `table`, which is not changed, with the names of parameters. */
static void name_fields(struct script_context *c, const struct script_function *function, int table, int named) {
    lua_State *L = c->sandbox.lua;
    for (int exact = 1; exact >= 0; exact--) {
        for (lua_pushnil(L); lua_next(L, table); lua_pop(L, 1)) {
            if (lua_type(L, -2) != LUA_TSTRING)
                continue;
            const struct script_parameter *p = meant_field(function, lua_tostring(L, -2));
            if (!p || (strcmp(p->name, lua_tostring(L, -2)) == 0) != exact)
                continue;
            bool taken = lua_getfield(L, named, p->name) != LUA_TNIL;
            lua_pop(L, 1);
            if (taken)
                continue;
            lua_pushvalue(L, -1);
            lua_setfield(L, named, p->name);
        }
    }
}

/* Whether the value at the top fits the parameter, independent of the name of its field. */
static bool is_meant_by_type(lua_State *L, const struct script_parameter *p) {
    const struct handle *handle = handle_at(L, -1);
    switch ((int)p->kind) {
    case KIND_NODE:
        return handle && handle->type == HANDLE_NODE;
    case KIND_MATERIAL:
        return handle && handle->type == HANDLE_MATERIAL;
    case KIND_LIGHTS: {
        if (lua_istable(L, -1)) {
            lua_rawgeti(L, -1, 1);
            handle = handle_at(L, -1);
            lua_pop(L, 1);
        }
        return handle && handle->type == HANDLE_LIGHT;
    }
    case KIND_OUTPUT:
        return lua_type(L, -1) == LUA_TSTRING && strchr(lua_tostring(L, -1), '.');
    }
    return false;
}

/* Fields with unknown names, for parameters without a value; of several, the first in byte order. */
static void name_fields_by_type(struct script_context *c, const struct script_function *function, int table,
                                int named) {
    lua_State *L = c->sandbox.lua;
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
        const struct script_parameter *p = &function->parameters[k];
        const char *first = NULL;
        bool taken = lua_getfield(L, named, p->name) != LUA_TNIL;
        lua_pop(L, 1);
        if (taken)
            continue;
        for (lua_pushnil(L); lua_next(L, table); lua_pop(L, 1)) {
            if (lua_type(L, -2) != LUA_TSTRING || !is_meant_by_type(L, p))
                continue;
            const char *name = lua_tostring(L, -2);
            if (!meant_field(function, name) && (!first || strcmp(name, first) < 0))
                first = name;
        }
        if (!first)
            continue;
        lua_getfield(L, table, first);
        lua_setfield(L, named, p->name);
    }
}

/* Nodes after the positional arguments, or unnamed entries, for the parameter that accepts any number of nodes. */
static void name_rest(struct script_context *c, const struct script_function *function, int first, int named) {
    lua_State *L = c->sandbox.lua;
    int index;
    const struct script_parameter *rest = function_rest(function, &index);
    if (!rest)
        return;
    lua_newtable(L);
    for (int i = first; i < named; i++) {
        lua_pushvalue(L, i);
        lua_rawseti(L, -2, i - first + 1);
    }
    lua_setfield(L, named, rest->name);
}

/* Reads the arguments from the table at `named`. */
static void read_named(struct script_context *c, const struct script_function *function, int named,
                       const bool wanted[PARAMETER_LIMIT], struct script_value *args) {
    lua_State *L = c->sandbox.lua;
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
        const struct script_parameter *p = &function->parameters[k];
        lua_settop(L, named);
        if (lua_getfield(L, named, p->name) != LUA_TNIL)
            lenient_convert(c, named + 1, function, p, args);
        if (lua_isnil(L, -1) && wanted[k])
            lenient_default(c, function, p);
        if (lua_isnil(L, -1))
            continue;
        lua_pushvalue(L, -1);
        lua_setfield(L, named, p->name); /* keeps the string alive */
        struct protected_reading reading = {.function = function, .parameter = p, .args = &args[k]};
        lua_pushcfunction(L, read_protected);
        lua_insert(L, -2);
        lua_pushlightuserdata(L, &reading);
        lua_insert(L, -2);
        if (!survives(c, 2))
            args[k] = (struct script_value){0};
    }
}

/* The index of a parameter that the function has. */
static int index_of(const struct script_function *function, const char *name) {
    int index = 0;
    while (strcmp(function->parameters[index].name, name) != 0)
        index++;
    return index;
}

/* A missing factor of node:scale is equal to that of x. */
static void complete_scale(const struct script_function *function, struct script_value *args) {
    const struct script_value *x = &args[index_of(function, "x")];
    if (args[index_of(function, "vector")].given || !x->given)
        return;
    for (int k = index_of(function, "y"); k <= index_of(function, "z"); k++)
        if (!args[k].given)
            args[k] = *x;
}

/* False: an argument without a default is missing. */
static bool forgive(struct script_context *c, const struct script_function *function, int first,
                    struct script_value *args) {
    lua_State *L = c->sandbox.lua;
    bool wanted[PARAMETER_LIMIT] = {false},
         is_scale = function->owner == OWNER_NODE && strcmp(function->name, "scale") == 0;
    int named = lua_gettop(L) + 1;
    luaL_checkstack(L, 60, NULL);
    memset(args + (function->owner == OWNER_NODE), 0,
           (size_t)(function->parameter_count - (function->owner == OWNER_NODE)) * sizeof *args);
    c->lenient->nothing = false;
    lua_newtable(L);
    if (arguments_have_names(L, function, first, named - 1)) {
        name_fields(c, function, first, named);
        name_fields_by_type(c, function, first, named);
        for (int k = 0; k < function->parameter_count; k++)
            wanted[k] = !(function->parameters[k].flags & OPTIONAL);
    } else {
        name_positional(c, function, first, named, wanted);
        if (is_scale)
            wanted[index_of(function, "y")] = wanted[index_of(function, "z")] = false;
        name_rest(c, function, first, named);
    }
    read_named(c, function, named, wanted, args);
    if (is_scale)
        complete_scale(function, args);
    lua_settop(L, named - 1);
    for (int k = 0; k < function->parameter_count; k++) {
        const struct script_parameter *p = &function->parameters[k];
        bool may_miss =
            (p->flags & (OPTIONAL | GHOST_IS_NONE)) || (function_renders(function) && p->kind == KIND_POINT);
        if (wanted[k] && !args[k].given && !may_miss)
            return false;
    }
    return true;
}

/* Keeps only the arguments of the positional forms. */
static void drop_fields(const struct script_function *function, struct script_value *args) {
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
        bool keep = false, optional;
        for (int f = 0; f < FORM_LIMIT && function->forms[f]; f++) {
            const char *form = function->forms[f];
            for (int index; form_next(function, &form, &index, &optional);)
                keep = keep || (index == k && !(function->parameters[k].kind == KIND_POINTS && f > 0));
        }
        if (!keep && (function->parameters[k].flags & OPTIONAL))
            args[k] = (struct script_value){0};
    }
}

/* The call. */

static int push_lost(lua_State *L, const struct script_function *function, int first) {
    struct script_context *c = context_of(L);
    int last = lua_gettop(L);
    switch (function->result) {
    case RESULT_NOTHING:
    case RESULT_FRAMES:
        return 0;
    case RESULT_SELF:
        lua_pushvalue(L, 1);
        return 1;
    case RESULT_FACES:
        lua_newtable(L);
        lua_newtable(L);
        return 2;
    case RESULT_BOUNDS:
        for (int k = 0; k < 2; k++) {
            lua_createtable(L, 3, 0);
            for (int d = 1; d <= 3; d++) {
                lua_pushnumber(L, k);
                lua_rawseti(L, -2, d);
            }
        }
        return 2;
    case RESULT_NODE:
    case RESULT_MATERIAL:
    case RESULT_LIGHT:
    case RESULT_TEXTURE:
    case RESULT_FOG:
    case RESULT_SKY:
    case RESULT_GLYPHS:
        break;
    }
    luaL_checkstack(L, 20, NULL);
    lenient_push_ghost(L, function->name, false);
    if (strstr(function->name, "difference")) /* its first operand remains */
        for (int i = first; i <= last && !lenient_ghost_as(c, handle_at(L, last + 1), HANDLE_NODE, false); i++)
            lenient_ghost_take(c, last + 1, i, i);
    else
        lenient_ghost_take(c, last + 1, first, last);
    return 1;
}

/* Runs the function with these arguments; an error of the scene becomes a warning. */
static bool run(struct script_context *c, const struct script_function *function, const struct script_value *args,
                struct script_result *result) {
    struct error error = {0};
    *result = (struct script_result){0};
    if (function->run(c, args, result, &error))
        return true;
    c->lenient->refused = c->lenient->refused || error.refused;
    if (error.kind != ERROR_SCENE || error.limit || error.elsewhere || error.refused)
        sandbox_raise_error(&c->sandbox, &error);
    lenient_warn(c, "%s", error.text);
    return false;
}

/* gr.sphere('head', skin): a material among the arguments that the form does not accept. */
static void take_material(struct script_context *c, const struct script_function *function, int first,
                          struct node *node) {
    int last = lua_gettop(c->sandbox.lua);
    if (function->result != RESULT_NODE || node->kind != NODE_GEOMETRY || node->material || node->slots)
        return;
    for (int i = first; i <= last && !node->material; i++) {
        const struct handle *handle = handle_at(c->sandbox.lua, i);
        if (handle && handle->type == HANDLE_MATERIAL)
            node->material = handle->pointer;
    }
}

static struct node *self_of(struct script_context *c) {
    const struct handle *handle = handle_at(c->sandbox.lua, 1);
    if (!handle || (handle->type != HANDLE_NODE && handle->type != HANDLE_GHOST))
        return NULL;
    return handle->type == HANDLE_NODE ? handle->pointer : lenient_ghost_as(c, handle, HANDLE_NODE, true);
}

int lenient_call(struct script_context *c, const struct script_function *function, struct script_result *result) {
    lua_State *L = c->sandbox.lua;
    struct script_value args[PARAMETER_LIMIT] = {{0}};
    int first = function->owner == OWNER_NODE ? 2 : 1;
    bool complete = false;
    if (function->owner == OWNER_NODE) {
        struct node *node = self_of(c);
        if (!node) {
            char title[96];
            const char *given = value_words(L, 1);
            function_title(function, title);
            c->sandbox.running = (struct running_function){0};
            lenient_warn(c, "%s must be called with a colon on a node, as in n:%s(...), not on %s", title,
                         function->name, given);
            lua_settop(L, lua_gettop(L) > 0 ? lua_gettop(L) : 1);
            return push_lost(L, function, first);
        }
        args[SELF] = (struct script_value){.given = true, .node = node};
        c->sandbox.running.subject = node->name;
    }
    c->lenient->nothing = false;
    context_note_line(c);
    bool read = read_all(c, function, first, args, &complete);
    if (!read)
        warn_line(c, c->sandbox.raised);
    if (read && !complete && function->result != RESULT_NOTHING) /* an argument is a ghost, which was reported */
        return push_lost(L, function, first);
    bool done = read && complete && run(c, function, args, result);
    if (!done) {
        if (!forgive(c, function, first, args) || c->lenient->nothing)
            return push_lost(L, function, first);
        done = run(c, function, args, result);
    }
    if (!done) {
        drop_fields(function, args);
        done = run(c, function, args, result);
    }
    if (!done && function_renders(function)) {
        lenient_simplify(c);
        done = run(c, function, args, result);
        struct node *root = args[index_of(function, "node")].node;
        if (!done && root)
            c->lenient->root = root;
    }
    if (!done)
        return push_lost(L, function, first);
    take_material(c, function, first, result->pointer);
    note_result(c, function, args, result);
    return -1;
}
