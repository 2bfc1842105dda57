/* Lua of the program itself. */
#include "sandbox/embedded.h"

#include "sandbox/sandbox.h"

#include <string.h>

static const char globals = 0; /* its globals are in the registry under this address */

static int raise_text(lua_State *L) {
    char where[PATH_SIZE + 128];
    sandbox_where(sandbox_enter(L), where, sizeof where);
    return luaL_error(L, "%s%s", where, lua_tostring(L, 1));
}

static int words_of_value(lua_State *L) {
    lua_pushstring(L, value_words(L, 1));
    return 1;
}

/* Copies what is no table from the library to the table on top. */
static void copy_library(lua_State *L, const char *library) {
    int to = lua_gettop(L);
    lua_getglobal(L, library);
    for (lua_pushnil(L); lua_next(L, to + 1); lua_pop(L, 1)) {
        if (lua_istable(L, -1))
            continue;
        lua_pushvalue(L, -2);
        lua_pushvalue(L, -2);
        lua_rawset(L, to);
    }
    lua_settop(L, to);
}

void embedded_open(lua_State *L) {
    static const char *const libraries[] = {"debug", "math", "string", "table"};
    static const luaL_Reg helpers[] = {{"raise", raise_text}, {"words", words_of_value}, {NULL, NULL}};
    lua_newtable(L);
    copy_library(L, LUA_GNAME);
    luaL_setfuncs(L, helpers, 0);
    for (size_t i = 0; i < sizeof libraries / sizeof *libraries; i++) {
        lua_newtable(L);
        copy_library(L, libraries[i]);
        lua_setfield(L, -2, libraries[i]);
    }
    lua_pushvalue(L, -1);
    lua_setfield(L, -2, "__index"); /* of the globals of each file */
    lua_rawsetp(L, LUA_REGISTRYINDEX, &globals);
}

static const char *read_line(lua_State *L, void *lines, size_t *size) {
    const char *const **at = lines, *line = **at;
    (void)L;
    *size = line ? strlen(line) : 0;
    *at += line != NULL;
    return line;
}

void embedded_run(lua_State *L, const char *const lines[], const luaL_Reg *helpers) {
    int top = lua_gettop(L);
    size_t size;
    luaL_checkstack(L, 10, NULL);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &globals);
    lua_getfield(L, -1, "string");
    lua_getfield(L, -1, "dump");
    if (lua_load(L, read_line, (void *)&lines, "=gray", "t") != LUA_OK)
        lua_error(L);
    lua_pushboolean(L, 1); /* without lines and names */
    lua_call(L, 2, 1);
    const char *code = lua_tolstring(L, -1, &size);
    if (luaL_loadbufferx(L, code, size, "=gray", "b") != LUA_OK)
        lua_error(L);
    lua_newtable(L);
    luaL_setfuncs(L, helpers, 0);
    lua_pushvalue(L, top + 1);
    lua_setmetatable(L, -2);
    lua_setupvalue(L, -2, 1);
    lua_call(L, 0, 1);
    lua_replace(L, top + 1);
    lua_settop(L, top + 1);
}

int embedded_end(lua_State *L, int level) {
    lua_Debug frame;
    int end = level;
    for (; lua_getstack(L, level, &frame) && lua_getinfo(L, "Sl", &frame) && frame.currentline <= 0; level++)
        end = strcmp(frame.source, "=?") == 0 ? level + 1 : end;
    return end;
}
