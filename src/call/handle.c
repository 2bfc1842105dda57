/* Handles: the Lua values for nodes, materials, lights and textures. A handle is a userdata with a tag and a pointer
 * into the scene's arena, without finalizer: the scene outlives the Lua state. A ghost is the handle of an object that
 * this version does not support; it exists with --lenient only and is accepted everywhere
 * (compat/lenient_handles.h). */
#include "call/handle.h"

#include "call/context.h"

#include <assert.h>
#include <lauxlib.h>

#define HANDLE_NAME(type, name, words) [type] = (name),
#define HANDLE_WORDS(type, name, words) [type] = (words),
static const char *const type_names[] = {HANDLE_LIST(HANDLE_NAME)};

const char *handle_words(enum handle_type type) {
    static const char *const words[] = {HANDLE_LIST(HANDLE_WORDS)};
    return words[type];
}

const char *handle_key(enum handle_type type) {
    return type_names[type];
}

void handle_push(lua_State *L, enum handle_type type, void *pointer) {
    struct script_context *context = context_of(L);
    struct handle *handle = lua_newuserdatauv(L, sizeof *handle, 0);
    *handle = (struct handle){.type = type, .serial = context->handles.count++, .pointer = pointer};
    lua_rawgetp(L, LUA_REGISTRYINDEX, type_names[type]);
    lua_setmetatable(L, -2);
    if (context->handles.made)
        context->handles.made(L, handle->serial);
}

const struct handle *handle_at(lua_State *L, int index) {
    const struct handle *handle = lua_touserdata(L, index);
    if (!handle)
        return NULL;
    /* Scripts get no light userdata, and all other userdata have metatables. */
    bool has_metatable = lua_getmetatable(L, index);
    assert(has_metatable);
    (void)has_metatable;
    const void *metatable = lua_topointer(L, -1);
    lua_pop(L, 1);
    const struct script_context *context = context_of(L);
    for (int type = 0; type < HANDLE_TYPES; type++)
        if (context->handles.metatables[type] == metatable)
            return handle;
    return NULL;
}

/* tostring(handle): without an address, so that a script always prints the same. */
static int handle_text(lua_State *L) {
    const struct handle *handle = handle_at(L, 1);
    assert(handle); /* scripts cannot reach the metatable */
    if (handle->type == HANDLE_NODE)
        lua_pushfstring(L, "node '%s'", ((const struct node *)handle->pointer)->name);
    else
        lua_pushstring(L, type_names[handle->type]);
    return 1;
}

/* handle.NAME = value, and handle.NAME of a handle that is no node. */
static int handle_field(lua_State *L) {
    const struct handle *handle = handle_at(L, 1);
    assert(handle); /* scripts cannot reach the metatable */
    const char *type = type_names[handle->type], *name = luaL_tolstring(L, 2, NULL);
    struct sandbox *sandbox = sandbox_enter(L);
    if (lua_toboolean(L, lua_upvalueindex(1)))
        sandbox_raise(sandbox, "the field %.100s of a %s cannot be read: objects of gr have no fields", name, type);
    sandbox_raise(sandbox,
                  "%.100s of a %s cannot be set: fields are given when it is made, as in gr.sphere{radius = 2}%s", name,
                  type, handle->type == HANDLE_NODE ? ", and methods change a node, as in n:set_material(m)" : "");
}

void handles_open(lua_State *L) {
    struct script_context *context = context_of(L);
    for (int type = 0; type < HANDLE_TYPES; type++) {
        lua_createtable(L, 0, 7);
        lua_pushstring(L, type_names[type]);
        lua_setfield(L, -2, "__name");
        lua_pushstring(L, type_names[type]); /* the result of getmetatable; setmetatable is refused */
        lua_setfield(L, -2, "__metatable");
        lua_pushstring(L, handle_words((enum handle_type)type));
        lua_setfield(L, -2, WORDS_FIELD);
        lua_pushcfunction(L, handle_text);
        lua_setfield(L, -2, "__tostring");
        for (int reads = type == HANDLE_NODE ? 0 : 1; reads >= 0; reads--) { /* nodes have methods */
            lua_pushboolean(L, reads);
            lua_pushcclosure(L, handle_field, 1);
            lua_setfield(L, -2, reads ? "__index" : "__newindex");
        }
        context->handles.metatables[type] = lua_topointer(L, -1);
        lua_rawsetp(L, LUA_REGISTRYINDEX, type_names[type]);
    }
}

void handle_push_methods(lua_State *L) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, handle_key(HANDLE_NODE));
    lua_getfield(L, -1, "__index");
    const char *methods = lua_getupvalue(L, -1, 1);
    assert(methods);
    (void)methods;
    lua_replace(L, -3);
    lua_pop(L, 1);
}
