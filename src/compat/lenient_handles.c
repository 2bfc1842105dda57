/* Handles with --lenient. A ghost is the result of a function that does not exist: it accepts every call, index and
 * operator. Other handles ignore fields and operators that they do not have, with a warning; fields that a script sets
 * are kept in a table of their own. */
#include "compat/lenient_handles.h"

#include "compat/lenient.h"

#include <assert.h>
#include <lauxlib.h>
#include <string.h>

/* It contains the nodes of the call, and is ignored if no value can replace it. */
struct ghost {
    const char *name;
    struct node *node; /* NULL until it has a child or a parent */
    const struct material *material;
    bool is_method; /* a call returns the node before the colon */
};

static struct ghost *ghost_of(const struct handle *handle) {
    return handle && handle->type == HANDLE_GHOST ? handle->pointer : NULL;
}

void lenient_push_ghost(lua_State *L, const char *name, bool is_method) {
    struct script_context *c = context_of(L);
    struct ghost *ghost = arena_alloc(&c->sandbox.keep, sizeof *ghost);
    const char *copy = ghost ? arena_copy_text(&c->sandbox.keep, name, strlen(name)) : NULL;
    if (!copy) {
        struct error error;
        error_no_memory(&error, "the script");
        sandbox_raise_error(&c->sandbox, &error);
    }
    *ghost = (struct ghost){.name = copy, .is_method = is_method};
    handle_push(L, HANDLE_GHOST, ghost);
}

void *lenient_ghost_as(struct script_context *c, const struct handle *handle, enum handle_type type, bool make) {
    struct ghost *ghost = ghost_of(handle);
    struct error error;
    assert(ghost);
    if (type == HANDLE_MATERIAL)
        return (void *)(uintptr_t)ghost->material;
    if (type != HANDLE_NODE)
        return NULL;
    if (!ghost->node && make) {
        ghost->node = scene_node(&c->scene, NODE_GROUP, ghost->name, &error);
        if (!ghost->node)
            sandbox_raise_error(&c->sandbox, &error);
        lenient_note_node(c, ghost->node);
    }
    return ghost->node;
}

/* Adds the value at `index`, if it is a node, to the ghost at `at` as a child. */
static void ghost_take(struct script_context *c, int at, int index) {
    const struct handle *given = handle_at(c->sandbox.lua, index), *holder = handle_at(c->sandbox.lua, at);
    struct ghost *ghost = ghost_of(holder);
    struct error ignored = {0};
    void *node = NULL;
    if (!given || given == holder)
        return;
    if (given->type == HANDLE_NODE)
        node = given->pointer;
    else if (given->type == HANDLE_GHOST)
        node = lenient_ghost_as(c, given, HANDLE_NODE, false);
    if (node)
        (void)node_add_child(&c->scene, lenient_ghost_as(c, holder, HANDLE_NODE, true), node, &ignored);
    if (given->type == HANDLE_MATERIAL && !ghost->material)
        ghost->material = given->pointer;
    if (given->type == HANDLE_GHOST && !ghost->material)
        ghost->material = lenient_ghost_as(c, given, HANDLE_MATERIAL, false);
}

void lenient_ghost_take(struct script_context *c, int at, int first, int last) {
    lua_State *L = c->sandbox.lua;
    for (int i = first; i <= last; i++) {
        ghost_take(c, at, i);
        if (!lua_istable(L, i))
            continue;
        lua_Integer length = (lua_Integer)lua_rawlen(L, i);
        for (lua_Integer k = 1; k <= length && k <= 100000; k++) {
            lua_rawgeti(L, i, k);
            ghost_take(c, at, lua_gettop(L));
            lua_pop(L, 1);
        }
    }
}

/* gr.shiny_material({1, 0, 0}, ...) has a colour: the result is a plain material of that colour. */
static void ghost_take_colour(struct script_context *c, struct ghost *ghost, int first, int last) {
    lua_State *L = c->sandbox.lua;
    if (ghost->material || !(strstr(ghost->name, "aterial") || strstr(ghost->name, "MATERIAL")))
        return;
    for (int i = first; i <= last && !ghost->material; i++) {
        bool is_colour = lua_istable(L, i) && lua_rawlen(L, i) == 3 && lua_rawgeti(L, i, 1) == LUA_TNUMBER;
        if (is_colour) {
            context_push_function(L, "material");
            lua_createtable(L, 0, 1);
            lua_pushvalue(L, i);
            lua_setfield(L, -2, "kd");
            lua_call(L, 1, 1);
            const struct handle *made = handle_at(L, -1);
            ghost->material = made && made->type == HANDLE_MATERIAL ? made->pointer : NULL;
        }
        lua_settop(L, last + 1); /* the ghost that is the result */
    }
}

/* The value of a module that does not exist. Upvalue 1: its name. */
static int ghost_module(lua_State *L) {
    lenient_push_ghost(L, lua_tostring(L, lua_upvalueindex(1)), false);
    return 1;
}

void lenient_replace_module(lua_State *L, const char *name) {
    lenient_warn(context_of(L), "require: module '%.200s' does not exist and is ignored", name);
    lua_pushstring(L, name);
    lua_pushcclosure(L, ghost_module, 1);
}

/* A call of the ghost at index 1. A method returns the object before the colon. */
static int ghost_call(lua_State *L) {
    struct script_context *c = context_of(L);
    const struct handle *handle = handle_at(L, 1);
    const struct ghost *ghost = ghost_of(handle);
    int last = lua_gettop(L);
    (void)sandbox_enter(L);
    assert(ghost);
    if (ghost->is_method && last >= 2 && handle_at(L, 2)) {
        if (ghost_of(handle_at(L, 2)))
            lenient_ghost_take(c, 2, 3, last);
        lua_pushvalue(L, 2);
        return 1;
    }
    luaL_checkstack(L, 20, NULL);
    lenient_push_ghost(L, ghost->name, false);
    lenient_ghost_take(c, last + 1, 2, last);
    ghost_take_colour(c, ghost_of(handle_at(L, last + 1)), 2, last);
    return 1;
}

/* Fields of ghosts and handles that the script has set: the table is in the registry under this address. */
static const char fields = 0;

/* Pushes the field at index 2 of the value at index 1 if the script has set it. */
bool lenient_own_field(lua_State *L) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, &fields);
    lua_pushvalue(L, 1);
    bool has = lua_rawget(L, -2) == LUA_TTABLE;
    if (has) {
        lua_pushvalue(L, 2);
        has = lua_rawget(L, -2) != LUA_TNIL;
    }
    return has;
}

static int ghost_index(lua_State *L) {
    lua_settop(L, 2);
    if (lenient_own_field(L))
        return 1;
    if (lua_type(L, 2) == LUA_TNUMBER) /* a loop over its entries ends immediately */
        return 0;
    lenient_push_ghost(L, lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "ghost", true);
    return 1;
}

/* A field of a material, a light or another handle without methods. */
int lenient_handle_index(lua_State *L) {
    struct script_context *c = context_of(L);
    lua_settop(L, 2);
    if (lenient_own_field(L))
        return 1;
    (void)sandbox_enter(L);
    if (lua_type(L, 2) != LUA_TSTRING)
        return 0;
    const struct handle *handle = handle_at(L, 1);
    lenient_warn(c, "%s has no field '%.100s', which is ignored", handle_words(handle->type), lua_tostring(L, 2));
    lenient_push_ghost(L, lua_tostring(L, 2), true);
    return 1;
}

static int handle_newindex(lua_State *L) {
    struct script_context *c = context_of(L);
    const struct handle *handle = handle_at(L, 1);
    lua_settop(L, 3);
    (void)sandbox_enter(L);
    if (lua_isnil(L, 2))
        return 0;
    if (handle->type != HANDLE_GHOST)
        lenient_warn(c, "%s has no field '%.100s', which is ignored", handle_words(handle->type),
                     lua_isstring(L, 2) ? luaL_tolstring(L, 2, NULL) : "?");
    lua_settop(L, 3);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &fields);
    lua_pushvalue(L, 1);
    if (lua_rawget(L, 4) != LUA_TTABLE) {
        lua_settop(L, 4);
        lua_newtable(L);
        lua_pushvalue(L, 1);
        lua_pushvalue(L, 5);
        lua_rawset(L, 4);
    }
    lua_pushvalue(L, 2);
    lua_pushvalue(L, 3);
    lua_rawset(L, 5);
    return 0;
}

/* The result of arithmetic with a ghost is a ghost; comparisons are false, and its length is 0. */
static int ghost_arithmetic(lua_State *L) {
    lenient_push_ghost(L, "ghost", false);
    return 1;
}

static int ghost_comparison(lua_State *L) {
    lua_pushboolean(L, 0);
    return 1;
}

static int ghost_length(lua_State *L) {
    lua_pushinteger(L, 0);
    return 1;
}

static int ghost_concat(lua_State *L) {
    luaL_tolstring(L, 1, NULL);
    luaL_tolstring(L, 2, NULL);
    lua_concat(L, 2);
    return 1;
}

/* Operators on other handles: the result is the handle, the first one of two. */

static int handle_operand(lua_State *L) {
    int index = handle_at(L, 1) ? 1 : 2;
    lua_settop(L, 2);
    lua_pushvalue(L, index);
    return 1;
}

static int warn_of_operator(lua_State *L, const char *what) {
    struct script_context *c = context_of(L);
    const struct handle *handle = handle_at(L, handle_at(L, 1) ? 1 : 2);
    assert(handle); /* one operand has this metatable */
    (void)sandbox_enter(L);
    lenient_warn(c, "%s has no %s, which is ignored", handle_words(handle->type), what);
    return handle_operand(L);
}

static int handle_arithmetic(lua_State *L) {
    return warn_of_operator(L, "arithmetic");
}

static int handle_call(lua_State *L) {
    return warn_of_operator(L, "call");
}

static int handle_comparison(lua_State *L) {
    (void)warn_of_operator(L, "order");
    return ghost_comparison(L);
}

static int handle_length(lua_State *L) {
    (void)warn_of_operator(L, "length");
    return ghost_length(L);
}

/* No entries: pairs(handle) is an empty loop. */
static int no_entry(lua_State *L) {
    (void)L;
    return 0;
}

static int handle_pairs(lua_State *L) {
    lua_pushcfunction(L, no_entry);
    return 1;
}

void lenient_open(lua_State *L) {
    static const luaL_Reg methods[] = {
        {"__call", ghost_call},
        {"__index", ghost_index},
        {"__newindex", handle_newindex},
        {"__add", ghost_arithmetic},
        {"__sub", ghost_arithmetic},
        {"__mul", ghost_arithmetic},
        {"__div", ghost_arithmetic},
        {"__mod", ghost_arithmetic},
        {"__pow", ghost_arithmetic},
        {"__unm", ghost_arithmetic},
        {"__idiv", ghost_arithmetic},
        {"__lt", ghost_comparison},
        {"__le", ghost_comparison},
        {"__len", ghost_length},
        {"__concat", ghost_concat},
        {"__pairs", handle_pairs},
        {NULL, NULL},
    };
    static const luaL_Reg operators[] = {
        {"__add", handle_arithmetic}, {"__sub", handle_arithmetic},  {"__mul", handle_arithmetic},
        {"__div", handle_arithmetic}, {"__mod", handle_arithmetic},  {"__pow", handle_arithmetic},
        {"__unm", handle_arithmetic}, {"__idiv", handle_arithmetic}, {"__call", handle_call},
        {"__lt", handle_comparison},  {"__le", handle_comparison},   {"__len", handle_length},
        {"__concat", ghost_concat},   {"__pairs", handle_pairs},     {NULL, NULL},
    };
    lua_newtable(L);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &fields);
    for (int type = 0; type < HANDLE_TYPES; type++) {
        lua_rawgetp(L, LUA_REGISTRYINDEX, handle_key((enum handle_type)type));
        lua_pushcfunction(L, handle_newindex);
        lua_setfield(L, -2, "__newindex");
        if (type == HANDLE_GHOST)
            luaL_setfuncs(L, methods, 0);
        else
            luaL_setfuncs(L, operators, 0);
        if (type != HANDLE_GHOST && type != HANDLE_NODE) {
            lua_pushcfunction(L, lenient_handle_index);
            lua_setfield(L, -2, "__index");
        }
        lua_pop(L, 1);
    }
}
