/* Which of Lua's libraries a scene gets. Scenes are written by strangers: nothing here starts programs or loads machine
 * code, and debug shows but does not change. Text is all that load accepts (protect.c), since crafted byte code can
 * crash the interpreter. */
#include "script/context.h"

#include <lauxlib.h>
#include <lualib.h>

/* os.exit ends the script, not the program: pictures that are finished stay, the next script runs. */
static int end_script(lua_State *L) {
    struct context *context = context_of(L);
    context->lua = L;
    bool well = lua_isnoneornil(L, 1) || (lua_isboolean(L, 1) ? lua_toboolean(L, 1) : luaL_checkinteger(L, 1) == 0);
    if (!well) {
        char where[PATH_SIZE + 32];
        context_where(context, where, sizeof where);
        error_set(&context->fatal, ERROR_SCENE, "%sos.exit: the script says that it failed", where);
    }
    context->ended = true;
    context_raise_fatal(L);
}

static void remove_names(lua_State *L, const char *library, const char *const *names) {
    lua_getglobal(L, library);
    for (; *names; names++) {
        lua_pushnil(L);
        lua_setfield(L, -2, *names);
    }
    lua_pop(L, 1);
}

void sandbox_open(lua_State *L) {
    static const luaL_Reg libraries[] = {
        {LUA_GNAME, luaopen_base},        {LUA_LOADLIBNAME, luaopen_package}, {LUA_COLIBNAME, luaopen_coroutine},
        {LUA_TABLIBNAME, luaopen_table},  {LUA_IOLIBNAME, luaopen_io},        {LUA_OSLIBNAME, luaopen_os},
        {LUA_STRLIBNAME, luaopen_string}, {LUA_MATHLIBNAME, luaopen_math},    {LUA_UTF8LIBNAME, luaopen_utf8},
        {LUA_DBLIBNAME, luaopen_debug},
    };
    for (size_t k = 0; k < sizeof libraries / sizeof libraries[0]; k++) {
        luaL_requiref(L, libraries[k].name, libraries[k].func, 1);
        lua_pop(L, 1);
    }
    remove_names(L, "os", (const char *const[]){"execute", NULL});
    remove_names(L, "io", (const char *const[]){"popen", NULL});
    remove_names(L, "package", (const char *const[]){"loadlib", NULL});

    lua_getglobal(L, "os");
    lua_pushcfunction(L, end_script);
    lua_setfield(L, -2, "exit");
    lua_pop(L, 1);

    lua_createtable(L, 0, 2);
    lua_getglobal(L, "debug");
    static const char *const kept[] = {"traceback", "getinfo"};
    for (size_t k = 0; k < sizeof kept / sizeof kept[0]; k++) {
        lua_getfield(L, -1, kept[k]);
        lua_setfield(L, -3, kept[k]);
    }
    lua_pop(L, 1);
    lua_getfield(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE);
    lua_pushvalue(L, -2);
    lua_setfield(L, -2, "debug");
    lua_pop(L, 1);
    lua_setglobal(L, "debug");
}
