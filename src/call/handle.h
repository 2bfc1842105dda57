/* Handles: the Lua values for nodes, materials, lights and textures. */
#ifndef GRAY_CALL_HANDLE_H
#define GRAY_CALL_HANDLE_H

#include "base/list.h"

#include <lua.h>
#include <stdint.h>

/* Types, with their names in Lua and in messages. */
#define HANDLE_LIST(X)                                                                                                 \
    X(HANDLE_NODE, "node", "a node")                                                                                   \
    X(HANDLE_MATERIAL, "material", "a material")                                                                       \
    X(HANDLE_LIGHT, "light", "a light")                                                                                \
    X(HANDLE_TEXTURE, "texture", "a texture")                                                                          \
    X(HANDLE_FOG, "fog", "a fog")                                                                                      \
    X(HANDLE_MEDIUM, "medium", "a medium")                                                                             \
    X(HANDLE_SKY, "sky", "a sky")                                                                                      \
    X(HANDLE_GHOST, "ghost", "something this version does not have")
enum handle_type { HANDLE_LIST(LIST_MEMBER) };
enum { HANDLE_TYPES = LIST_COUNT(HANDLE_LIST) };

/* The contents of our userdata; no finalizer. The serial gives tables with handles as keys a fixed order. */
struct handle {
    enum handle_type type;
    uint32_t serial;
    void *pointer;
};

/* The handles of a Lua state. */
struct handles {
    const void *metatables[HANDLE_TYPES];
    uint32_t count;
    /* A handle was made; it is on top of the stack. NULL: nothing happens. */
    void (*made)(lua_State *L, uint32_t serial);
};

void handles_open(lua_State *L);
void handle_push(lua_State *L, enum handle_type type, void *pointer);
/* The handle at a stack index, or NULL for any other value. */
const struct handle *handle_at(lua_State *L, int index);
const char *handle_words(enum handle_type type);
/* Pushes the table of the methods of nodes, by name: upvalue 1 of __index of their metatable. */
void handle_push_methods(lua_State *L);
/* Its name in Lua; the metatable is in the registry under this pointer. */
const char *handle_key(enum handle_type type);

#endif
