/* gr.keys is Lua (gr_keys.lua); what it needs of gray. */
#include "script/gr_keys_internal.h"

#include "call/display_colour.h"
#include "record/symbol.h"
#include "sandbox/embedded.h"
#include "script/script_internal.h"

extern const char *const gr_keys_lua[];

/* The numbers of a display colour; nothing for another value. */
static int colour(lua_State *L) {
    struct colour colour;
    int type = lua_type(L, 1);
    (void)sandbox_enter(L); /* for messages about colours */
    bool may_be = type == LUA_TSTRING || (type == LUA_TTABLE && !is_vector(L, 1));
    if (!may_be || !display_colour_at(L, 1, &colour))
        return 0;
    lua_pushnumber(L, colour.r);
    lua_pushnumber(L, colour.g);
    lua_pushnumber(L, colour.b);
    return 3;
}

static int vector(lua_State *L) {
    push_vector(L);
    return 1;
}

static int now(lua_State *L) {
    lua_pushnumber(L, frame_time(&script_of(context_of(L))->animation.frame));
    return 1;
}

static int is_recorded(lua_State *L) {
    lua_pushboolean(L, is_symbol(L, 1));
    return 1;
}

/* It is read when a script calls it first. */
static int keys(lua_State *L) {
    static const luaL_Reg helpers[] = {
        {"colour", colour}, {"vector", vector}, {"now", now}, {"is_recorded", is_recorded}, {NULL, NULL}};
    if (lua_rawgetp(L, LUA_REGISTRYINDEX, gr_keys_lua) == LUA_TNIL) {
        embedded_run(L, gr_keys_lua, helpers);
        lua_pushvalue(L, -1);
        lua_rawsetp(L, LUA_REGISTRYINDEX, gr_keys_lua);
        lua_replace(L, -2);
    }
    lua_insert(L, 1);
    lua_call(L, lua_gettop(L) - 1, 1);
    return 1;
}

static const struct value_function functions[] = {
    {"keys", "keys",
     "A function of seconds (gr.time) that interpolates keys {seconds, value}; fields: curve = 'linear', 'catmull' or "
     "'bezier', and ease.",
     "fun(seconds?: number): any", keys},
};
const struct value_functions key_functions = {functions, sizeof functions / sizeof functions[0]};
