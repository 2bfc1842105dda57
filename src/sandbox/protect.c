/* Replacements of the functions that could catch a fatal error: pcall, xpcall, coroutine.resume and close, load. They
 * do the same and then raise the error again if the sandbox has a fatal error or the script has ended.
 *
 * Two more ways to avoid the limits are prevented here. Lua runs the handler of xpcall without hooks if the error came
 * from the hook: our handler returns a fatal error itself. Lua always runs finalizers (__gc) without hooks:
 * setmetatable removes them, so that no code of a scene runs while garbage is collected or the state is closed. */
#include "sandbox/protect.h"

#include "sandbox/sandbox.h"

#include <lauxlib.h>

static void pass_on_fatal(lua_State *L) {
    if (sandbox_is_over(sandbox_of(L)))
        limits_check(L);
}

/* After the call or after a yield in it; `extra` values are below the results. As in Lua's own lbaselib.c. */
static int finish_call(lua_State *L, int status, lua_KContext extra) {
    pass_on_fatal(L);
    if (status != LUA_OK && status != LUA_YIELD) {
        lua_pushboolean(L, 0);
        lua_pushvalue(L, -2);
        return 2;
    }
    return lua_gettop(L) - (int)extra;
}

static int protected_call(lua_State *L) {
    luaL_checkany(L, 1);
    lua_pushboolean(L, 1);
    lua_insert(L, 1);
    int status = lua_pcallk(L, lua_gettop(L) - 2, LUA_MULTRET, 0, 0, finish_call);
    return finish_call(L, status, 0);
}

/* Upvalue 1: the script's handler. */
static int guarded_handler(lua_State *L) {
    if (sandbox_is_over(sandbox_of(L)))
        return 1;
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, lua_gettop(L) - 1, 1);
    return 1;
}

static int protected_call_with_handler(lua_State *L) {
    int count = lua_gettop(L);
    luaL_checktype(L, 2, LUA_TFUNCTION);
    lua_pushvalue(L, 2);
    lua_pushcclosure(L, guarded_handler, 1);
    lua_replace(L, 2);
    lua_pushboolean(L, 1);
    lua_pushvalue(L, 1);
    lua_rotate(L, 3, 2); /* function, handler, true, function, arguments */
    int status = lua_pcallk(L, count - 2, LUA_MULTRET, 2, 2, finish_call);
    return finish_call(L, status, 2);
}

/* Calls upvalue 1, Lua's own function, which returns errors as values. A coroutine counts its steps from zero, so many
 * short ones would never call the hook: the clock is also read here. */
static int call_and_pass_on(lua_State *L) {
    limits_check(L);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
    pass_on_fatal(L);
    return lua_gettop(L);
}

/* coroutine.resume and coroutine.close. Bad arguments are found here, because Lua's own function, which this one calls,
 * would not know the line of the script. */
static int use_coroutine(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTHREAD);
    return call_and_pass_on(L);
}

/* coroutine.wrap(f): as Lua's own, with our resume. Upvalue of the result: Lua's own result. */
static int wrap_coroutine(lua_State *L) {
    luaL_checktype(L, 1, LUA_TFUNCTION);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, lua_gettop(L) - 1, 1);
    lua_pushcclosure(L, call_and_pass_on, 1);
    return 1;
}

static int set_metatable(lua_State *L) {
    int type = lua_type(L, 2);
    if (type != LUA_TNIL && type != LUA_TTABLE)
        return luaL_typeerror(L, 2, "nil or table");
    luaL_checktype(L, 1, LUA_TTABLE);
    if (luaL_getmetafield(L, 1, "__metatable") != LUA_TNIL)
        return luaL_error(L, "cannot change a protected metatable");
    lua_settop(L, 2);
    bool finalizer = false;
    if (type == LUA_TTABLE) {
        lua_pushliteral(L, "__gc");
        finalizer = lua_rawget(L, 2) != LUA_TNIL; /* its value, at 3 */
    }
    if (finalizer) {
        lua_pushliteral(L, "__gc");
        lua_pushnil(L);
        lua_rawset(L, 2);
    }
    lua_pushvalue(L, 2);
    lua_setmetatable(L, 1);
    if (finalizer) {
        lua_pushliteral(L, "__gc");
        lua_pushvalue(L, 3);
        lua_rawset(L, 2);
    }
    lua_settop(L, 1);
    return 1;
}

/* load(chunk, name, mode, environment), the mode always "t". */
static int load_text(lua_State *L) {
    if (!lua_isstring(L, 1))
        luaL_checktype(L, 1, LUA_TFUNCTION);
    if (lua_gettop(L) < 3)
        lua_settop(L, 3);
    lua_pushliteral(L, "t");
    lua_replace(L, 3);
    return call_and_pass_on(L);
}

void wrap_function(lua_State *L, const char *library, const char *name, lua_CFunction function) {
    lua_getglobal(L, library);
    lua_getfield(L, -1, name);
    lua_pushcclosure(L, function, 1);
    lua_setfield(L, -2, name);
    lua_pop(L, 1);
}

void protect_open(lua_State *L) {
    lua_pushcfunction(L, protected_call);
    lua_setglobal(L, "pcall");
    lua_pushcfunction(L, protected_call_with_handler);
    lua_setglobal(L, "xpcall");
    wrap_function(L, "coroutine", "resume", use_coroutine);
    wrap_function(L, "coroutine", "close", use_coroutine);
    wrap_function(L, "coroutine", "wrap", wrap_coroutine);
    if (sandbox_of(L)->options->no_sandbox) {
        wrap_function(L, LUA_GNAME, "load", call_and_pass_on);
        return;
    }
    wrap_function(L, LUA_GNAME, "load", load_text);
    lua_pushcfunction(L, set_metatable);
    lua_setglobal(L, "setmetatable");
}
