/* Handles: what a script holds of a node, material, light or texture. A userdata with a tag and a pointer into the
 * scene's arena, without finalizer: the scene outlives the Lua state. A ghost replaces what this version does not have;
 * it exists with --lenient only, is accepted everywhere and does nothing. */
#include "script/context.h"

#include <assert.h>
#include <lauxlib.h>

#define HANDLE_NAME(type, name, words) [type] = (name),
#define HANDLE_WORDS(type, name, words) [type] = (words),
static const char *const type_names[] = {HANDLE_LIST(HANDLE_NAME)};

const char *handle_words(enum handle_type type) {
    static const char *const words[] = {HANDLE_LIST(HANDLE_WORDS)};
    return words[type];
}

const void *handle_key(enum handle_type type) {
    return type_names[type];
}

void handle_push(lua_State *L, enum handle_type type, void *pointer) {
    struct script_context *context = context_of(L);
    struct handle *handle = lua_newuserdatauv(L, sizeof *handle, 0);
    *handle = (struct handle){.type = type, .serial = context->handle_count++, .pointer = pointer};
    lua_rawgetp(L, LUA_REGISTRYINDEX, type_names[type]);
    lua_setmetatable(L, -2);
}

const struct handle *handle_at(lua_State *L, int index) {
    const struct handle *handle = lua_touserdata(L, index);
    if (!handle)
        return NULL;
    /* Scripts get no light userdata, and everybody's others have metatables. */
    bool has_metatable = lua_getmetatable(L, index);
    assert(has_metatable);
    (void)has_metatable;
    const void *metatable = lua_topointer(L, -1);
    lua_pop(L, 1);
    const struct script_context *context = context_of(L);
    for (int type = 0; type < HANDLE_TYPES; type++)
        if (context->metatables[type] == metatable)
            return handle;
    return NULL;
}

const char *value_words(lua_State *L, int index) {
    const struct handle *handle = handle_at(L, index);
    if (handle)
        return handle_words(handle->type);
    switch (lua_type(L, index)) {
    case LUA_TNIL:
        return "nil";
    case LUA_TNONE:
        return "nothing";
    case LUA_TBOOLEAN:
        return "a boolean";
    case LUA_TNUMBER:
        return "a number";
    case LUA_TSTRING:
        return "a string";
    case LUA_TTABLE:
        return "a table";
    case LUA_TFUNCTION:
        return "a function";
    case LUA_TTHREAD:
        return "a coroutine";
    default:
        return "a userdata";
    }
}

/* tostring(handle): no addresses, so that what a script prints is the same every time. */
static int handle_text(lua_State *L) {
    const struct handle *handle = handle_at(L, 1);
    assert(handle); /* no script gets at the metatable */
    if (handle->type == HANDLE_NODE)
        lua_pushfstring(L, "node '%s'", ((const struct node *)handle->pointer)->name);
    else
        lua_pushstring(L, type_names[handle->type]);
    return 1;
}

void handles_open(lua_State *L) {
    struct script_context *context = context_of(L);
    for (int type = 0; type < HANDLE_TYPES; type++) {
        lua_createtable(L, 0, 4);
        lua_pushstring(L, type_names[type]);
        lua_setfield(L, -2, "__name");
        lua_pushstring(L, type_names[type]); /* what getmetatable shows; setmetatable is refused */
        lua_setfield(L, -2, "__metatable");
        lua_pushcfunction(L, handle_text);
        lua_setfield(L, -2, "__tostring");
        context->metatables[type] = lua_topointer(L, -1);
        lua_rawsetp(L, LUA_REGISTRYINDEX, type_names[type]);
    }
}
