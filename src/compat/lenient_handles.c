/* Ghosts. Their metatables, and those of the other handles, have the functions of lenient.lua. */
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

int lenient_handle_type(lua_State *L) {
    const struct handle *handle = handle_at(L, 1);
    if (handle)
        lua_pushstring(L, handle_key(handle->type));
    return handle != NULL;
}

int lenient_ghost_new(lua_State *L) {
    lenient_push_ghost(L, lua_tostring(L, 1), lua_toboolean(L, 2));
    return 1;
}

int lenient_ghost_info(lua_State *L) {
    const struct ghost *ghost = ghost_of(handle_at(L, 1));
    lua_pushstring(L, ghost->name);
    lua_pushboolean(L, ghost->is_method);
    return 2;
}

int lenient_ghost_add(lua_State *L) {
    struct script_context *c = context_of(L);
    const struct handle *holder = handle_at(L, 1), *given = handle_at(L, 2);
    struct ghost *ghost = ghost_of(holder), *other = ghost_of(given);
    struct error ignored = {0};
    c->sandbox.lua = L;
    if (given && ghost != other) {
        struct node *node = other ? other->node : given->type == HANDLE_NODE ? given->pointer : NULL;
        const struct material *material = other                            ? other->material
                                          : given->type == HANDLE_MATERIAL ? given->pointer
                                                                           : NULL;
        if (node)
            (void)node_add_child(&c->scene, lenient_ghost_as(c, holder, HANDLE_NODE, true), node, &ignored);
        if (!ghost->material)
            ghost->material = material;
    }
    lua_pushboolean(L, ghost->node != NULL);
    return 1;
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

void lenient_push_metatables(lua_State *L) {
    lua_newtable(L);
    for (int type = 0; type < HANDLE_TYPES; type++) {
        lua_rawgetp(L, LUA_REGISTRYINDEX, handle_key((enum handle_type)type));
        lua_setfield(L, -2, handle_key((enum handle_type)type));
    }
}
