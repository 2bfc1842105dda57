/* Calls with --lenient. The arguments are first read as usual. If that raises an error, or the function fails, the
 * error becomes a warning, and the arguments are matched again (lenient.lua). If the function fails again, it gets only
 * the arguments of its positional forms. If that fails too, the result is a ghost: a group of the nodes of the call.
 *
 * Errors that a script must not catch pass through: limits, memory, errors of the machine. */
#include "compat/lenient.h"

#include "base/hash.h"
#include "base/suggestion.h"
#include "call/argument.h"
#include "call/arguments.h"
#include "compat/lenient_handles.h"
#include "compat/lenient_picture.h"
#include "sandbox/embedded.h"

#include <stdarg.h>
#include <string.h>

extern const char *const lenient_lua[];

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

/* What Lua calls (lenient.lua). Parameters and functions are their addresses. */

static int read_value(lua_State *L) {
    struct script_value *args = lua_touserdata(L, 1);
    const struct script_function *function = lua_touserdata(L, 2);
    lua_Integer k = lua_tointeger(L, 3) - 1;
    struct protected_reading reading = {.parameter = &function->parameters[k], .args = &args[k]};
    lua_pushcfunction(L, read_protected);
    lua_pushlightuserdata(L, &reading);
    lua_pushvalue(L, 4);
    if (!survives(context_of(L), 2))
        args[k] = (struct script_value){0};
    if (args[k].given)
        lua_pushinteger(L, args[k].count);
    else
        lua_pushnil(L);
    return 1;
}

static int resembles(lua_State *L) {
    const struct script_parameter *p = lua_touserdata(L, 1);
    lua_pushboolean(L, argument_resembles(L, 2, p->kind, p->flags));
    return 1;
}

/* The number of the parameter of a field, or nothing: with this name, with the same letters in any case, or with the
 * most similar name. */
static int meant_field(lua_State *L) {
    const struct script_function *function = lua_touserdata(L, 1);
    const char *field = lua_tostring(L, 2);
    struct suggestion suggestion;
    int first = function->owner == OWNER_NODE, meant = -1;
    suggest_begin(&suggestion, field);
    for (int k = first; k < function->parameter_count; k++)
        suggest_offer(&suggestion, function->parameters[k].name);
    for (int k = function->parameter_count - 1; k >= first; k--)
        if (function->parameters[k].name == suggestion.best || strcmp(function->parameters[k].name, field) == 0)
            meant = k;
    lua_pushinteger(L, meant + 1);
    return meant >= 0;
}

static int is_gr(lua_State *L) {
    lua_pushboolean(L, context_is_gr(L, 1));
    return 1;
}

static int picture_name(lua_State *L) {
    char name[PATH_SIZE];
    context_picture_name(context_of(L), "-lenient.png", name, sizeof name);
    lua_pushstring(L, name);
    return 1;
}

static int push_root(lua_State *L) {
    struct node *root = lenient_root(context_of(L));
    if (root)
        handle_push(L, HANDLE_NODE, root);
    return root != NULL;
}

static int warn(lua_State *L) {
    struct sandbox *sandbox = sandbox_of(L);
    const struct running_function outer = sandbox->running;
    lenient_warn(context_of(sandbox_enter(L)->lua), "%s", lua_tostring(L, 1));
    sandbox->running = outer;
    return 0;
}

/* Pushes the description of a function with its forms, lists of {parameter, optional}. It is kept. */
static void push_description(lua_State *L, const struct script_function *function) {
    bool optional;
    int index;
    if (lua_rawgetp(L, LUA_REGISTRYINDEX, function) == LUA_TTABLE)
        return;
    lua_pop(L, 1);
    function_push(L, function);
    lua_newtable(L);
    for (int k = 0; k < FORM_LIMIT && function->forms[k]; k++) {
        const char *form = function->forms[k];
        lua_newtable(L);
        for (int n = 1; form_next(function, &form, &index, &optional); n++) {
            lua_newtable(L);
            lua_rawgeti(L, -4, index + 1);
            lua_setfield(L, -2, "parameter");
            lua_pushboolean(L, optional);
            lua_setfield(L, -2, "optional");
            lua_rawseti(L, -2, n);
        }
        lua_rawseti(L, -2, k + 1);
    }
    lua_setfield(L, -2, "forms");
    lua_pushvalue(L, -1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, function);
}

/* Pushes a function of lenient.lua. */
static void push_lua(lua_State *L, const char *name) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, lenient_lua);
    lua_getfield(L, -1, name);
    lua_replace(L, -2);
}

void lenient_open(lua_State *L) {
    static const luaL_Reg helpers[] = {{"read", read_value},
                                       {"resembles", resembles},
                                       {"meant_field", meant_field},
                                       {"is_gr", is_gr},
                                       {"picture_name", picture_name},
                                       {"root", push_root},
                                       {"warning", warn},
                                       {"handle", lenient_handle_type},
                                       {"new_ghost", lenient_ghost_new},
                                       {"ghost_info", lenient_ghost_info},
                                       {"add", lenient_ghost_add},
                                       {NULL, NULL}};
    embedded_run(L, lenient_lua, helpers);
    lua_rawsetp(L, LUA_REGISTRYINDEX, lenient_lua);
    push_lua(L, "open");
    lenient_push_metatables(L);
    context_push_functions(L);
    lua_getglobal(L, "gr");
    lua_call(L, 3, 0);
}

bool lenient_own_field(lua_State *L) {
    push_lua(L, "fields");
    lua_pushvalue(L, 1);
    if (lua_rawget(L, -2) != LUA_TTABLE)
        return false;
    lua_pushvalue(L, 2);
    return lua_rawget(L, -2) != LUA_TNIL;
}

/* The call. */

/* The index of a parameter that the function has. */
static int index_of(const struct script_function *function, const char *name) {
    int index = 0;
    while (strcmp(function->parameters[index].name, name) != 0)
        index++;
    return index;
}

/* False: an argument without a default is missing, or a shape has no extent. What keeps texts of the arguments stays on
 * the stack. */
static bool forgive(struct script_context *c, const struct script_function *function, int first,
                    struct script_value *args) {
    lua_State *L = c->sandbox.lua;
    int last = lua_gettop(L), from = function->owner == OWNER_NODE;
    memset(args + from, 0, (size_t)(function->parameter_count - from) * sizeof *args);
    luaL_checkstack(L, last + 60, NULL);
    push_lua(L, "forgive");
    push_description(L, function);
    lua_pushlightuserdata(L, args);
    lua_pushboolean(L, arguments_have_names(L, function, first, last));
    for (int i = first; i <= last; i++)
        lua_pushvalue(L, i);
    lua_call(L, 3 + (last - first + 1), 2);
    c->sandbox.lua = L;
    return lua_toboolean(L, -2);
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

/* Pushes what a call that failed returns; the arguments end at `last`. */
static int push_lost(lua_State *L, const struct script_function *function, int last) {
    lua_settop(L, last);
    luaL_checkstack(L, last + 20, NULL);
    push_lua(L, "lost");
    push_description(L, function);
    for (int i = 1; i <= last; i++)
        lua_pushvalue(L, i);
    lua_call(L, last + 1, LUA_MULTRET);
    return lua_gettop(L) - last;
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
    int first = function->owner == OWNER_NODE ? 2 : 1, last = lua_gettop(L);
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
            return push_lost(L, function, last > 0 ? last : 1);
        }
        args[SELF] = (struct script_value){.given = true, .node = node};
        c->sandbox.running.subject = node->name;
    }
    context_note_line(c);
    bool read = read_all(c, function, first, args, &complete);
    if (!read)
        warn_line(c, c->sandbox.raised);
    if (read && !complete && function->result != RESULT_NOTHING) /* an argument is a ghost, which was reported */
        return push_lost(L, function, last);
    bool done = read && complete && run(c, function, args, result);
    if (!done) {
        if (!forgive(c, function, first, args))
            return push_lost(L, function, last);
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
        return push_lost(L, function, last);
    take_material(c, function, first, result->pointer);
    note_result(c, function, args, result);
    return -1;
}
