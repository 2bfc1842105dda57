/* Scripts use names of Lua's libraries for their own things (`table = gr.node('table')`). The modules that come with
 * the program must not stumble over that: their files see the globals as they were before the script began. What such a
 * file adds (`readobj`) becomes a global of the script, and names it does not find are looked for there. Their
 * `require` finds our modules, whatever files of the same names are beside the scene. */
#include "script/context.h"

#include "base/file.h"

#include <assert.h>
#include <lauxlib.h>
#include <lualib.h>
#include <stdio.h>
#include <string.h>

static const char key = 0;    /* the table is in the registry under its address */
static const char hidden = 0; /* likewise: our modules whose names the script's own files have taken, by name */

/* The file of one of our modules, when `require` of the script would find another one first. */
static bool is_hidden(lua_State *L, const char *name, char file[PATH_SIZE]) {
    const struct script_context *context = context_of(L);
    const char *folder = context->options->library_folder;
    char found[PATH_SIZE], other[PATH_SIZE], own[PATH_SIZE];
    assert(folder); /* no other code has this `require` */
    if (strpbrk(name, "./\\"))
        return false;
    int length = snprintf(file, PATH_SIZE, "%s/%s.lua", folder, name);
    if ((size_t)length >= PATH_SIZE || !file_is_regular(file))
        return false;
    lua_getfield(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE);
    bool has_path = lua_getfield(L, -1, LUA_LOADLIBNAME) == LUA_TTABLE && lua_getfield(L, -1, "path") == LUA_TSTRING;
    bool taken = has_path && files_on_path(context, lua_tostring(L, -1), name, found) &&
                 file_canonical(found, other, sizeof other) && file_canonical(file, own, sizeof own) &&
                 strcmp(other, own) != 0;
    lua_settop(L, 1);
    return taken;
}

/* `require` as our modules see it. Upvalue 1: the script's. */
static int library_require(lua_State *L) {
    char file[PATH_SIZE];
    const char *name = luaL_checkstring(L, 1);
    lua_settop(L, 1);
    if (!is_hidden(L, name, file)) {
        lua_pushvalue(L, lua_upvalueindex(1));
        lua_insert(L, 1);
        lua_call(L, 1, LUA_MULTRET);
        return lua_gettop(L);
    }
    lua_rawgetp(L, LUA_REGISTRYINDEX, &hidden);
    if (lua_getfield(L, 2, name) != LUA_TNIL)
        return 1;
    if (files_load(L, file) != LUA_OK)
        return lua_error(L);
    lua_pushvalue(L, 1);
    lua_pushstring(L, file);
    lua_call(L, 2, 1);
    lua_pushvalue(L, -1);
    lua_setfield(L, 2, name);
    return 1;
}

void library_open(lua_State *L) {
    lua_newtable(L);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &hidden);
    lua_newtable(L);
    lua_pushglobaltable(L);
    for (lua_pushnil(L); lua_next(L, -2);) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2); /* the table, _G, key, key, value */
        lua_rawset(L, -5);
    }
    lua_getfield(L, -2, "require");
    lua_pushcclosure(L, library_require, 1);
    lua_setfield(L, -3, "require");
    lua_createtable(L, 0, 2);
    lua_pushvalue(L, -2);
    lua_setfield(L, -2, "__index");
    lua_insert(L, -2);
    lua_setfield(L, -2, "__newindex");
    lua_setmetatable(L, -2);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &key);
}

void library_adopt(lua_State *L, const char *path) {
    const char *folder = context_of(L)->options->library_folder;
    char library[PATH_SIZE], file[PATH_SIZE];
    if (!folder || !folder[0] || !file_canonical(folder, library, sizeof library) ||
        !file_canonical(path, file, sizeof file))
        return;
    size_t length = strlen(library);
    if (strncmp(file, library, length) != 0 || file[length] != '/')
        return;
    lua_rawgetp(L, LUA_REGISTRYINDEX, &key);
    if (!lua_setupvalue(L, -2, 1))
        lua_pop(L, 1); /* byte code, without the sandbox, may use no globals */
}
