/* What Lua 5.0 and 5.1 have and 5.4 no longer has (Lua reference manuals 5.0 to 5.4,
 * "Changes since the previous version"). */
#include "compat/compat.h"

#include "math/elementary.h"
#include "sandbox/embedded.h"
#include "sandbox/sandbox.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

extern const char *const compat_lua[];

/* tostring(3.0) is "3", as in Lua 5.1; so are print and string.format('%s'), which use the same metamethod. */
static int number_text(lua_State *L) {
    lua_Number x = lua_tonumber(L, 1);
    char text[64];
    if (lua_isinteger(L, 1))
        snprintf(text, sizeof text, LUA_INTEGER_FMT, lua_tointeger(L, 1));
    else
        snprintf(text, sizeof text, "%.14g", x);
    lua_pushstring(L, text);
    return 1;
}

#define MATH_ONE(name)                                                                                                 \
    static int math_##name(lua_State *L) {                                                                             \
        lua_pushnumber(L, el_##name(luaL_checknumber(L, 1)));                                                          \
        return 1;                                                                                                      \
    }
#define MATH_TWO(name)                                                                                                 \
    static int math_##name(lua_State *L) {                                                                             \
        lua_pushnumber(L, el_##name(luaL_checknumber(L, 1), luaL_checknumber(L, 2)));                                  \
        return 1;                                                                                                      \
    }

MATH_ONE(log10)
MATH_ONE(cosh)
MATH_ONE(sinh)
MATH_ONE(tanh)
MATH_TWO(pow)
MATH_TWO(atan2)

static int math_frexp(lua_State *L) {
    int exponent;
    lua_pushnumber(L, frexp(luaL_checknumber(L, 1), &exponent));
    lua_pushinteger(L, exponent);
    return 2;
}

static int math_ldexp(lua_State *L) {
    lua_Integer exponent = luaL_checkinteger(L, 2);
    int clamped = exponent > 10000 ? 10000 : exponent < -10000 ? -10000 : (int)exponent;
    lua_pushnumber(L, ldexp(luaL_checknumber(L, 1), clamped));
    return 1;
}

/* Truncates the float at `index` to a whole number, toward zero, as a C conversion does. */
static void make_whole(lua_State *L, int index) {
    if (lua_type(L, index) != LUA_TNUMBER || lua_isinteger(L, index))
        return;
    lua_Number x = lua_tonumber(L, index);
    if (fabs(x) >= 0x1p62 || isnan(x) || x == floor(x))
        return;
    lua_pushinteger(L, (lua_Integer)x);
    lua_replace(L, index);
}

/* Which arguments are positions and counts: the first one, the last one or 0 for all that follow, and how many
 * arguments the call needs for that (in table.insert(t, 1.5) the fraction is the value). */
struct whole_arguments {
    const char *library, *name;
    int first, last, minimum;
};

static const struct whole_arguments whole_arguments[] = {
    {"math", "random", 1, 2, 1},  {"string", "byte", 2, 3, 2},    {"string", "char", 1, 0, 1},
    {"string", "find", 3, 3, 3},  {"string", "rep", 2, 2, 2},     {"string", "sub", 2, 3, 2},
    {"table", "concat", 3, 4, 3}, {"table", "insert", 2, 2, 3},   {"table", "remove", 2, 2, 2},
    {"table", "unpack", 2, 3, 2}, {LUA_GNAME, "select", 1, 1, 1},
};

/* Runs Lua's own function in the place of this one, so that its errors name the line of the script and the function.
 * Upvalue 1: that of Lua's own function, the state of the random numbers. Upvalue 2: Lua's own function. */
static int run_original(lua_State *L) {
    return lua_tocfunction(L, lua_upvalueindex(2))(L);
}

static void wrap(lua_State *L, const char *library, const char *name, lua_CFunction function,
                 const struct whole_arguments *row) {
    lua_getglobal(L, library);
    lua_getfield(L, -1, name);
    if (!lua_getupvalue(L, -1, 1))
        lua_pushnil(L);
    lua_insert(L, -2);
    lua_pushlightuserdata(L, (void *)(uintptr_t)row);
    lua_pushcclosure(L, function, 3);
    lua_setfield(L, -2, name);
    lua_pop(L, 1);
}

/* ("abcdef"):sub(1, 7 / 2) is "abc". Upvalue 3: the row. */
static int cut_fractions(lua_State *L) {
    const struct whole_arguments *row = lua_touserdata(L, lua_upvalueindex(3));
    int top = lua_gettop(L), last = row->last > 0 && row->last < top ? row->last : top;
    for (int k = row->first; k <= last && top >= row->minimum; k++)
        make_whole(L, k);
    return run_original(L);
}

/* string.format('%d', 2.7) is "2". */
static int string_format(lua_State *L) {
    const char *format = lua_type(L, 1) == LUA_TSTRING ? lua_tostring(L, 1) : "";
    int top = lua_gettop(L), argument = 1;
    for (const char *c = format; *c; c++) {
        if (*c != '%')
            continue;
        c++;
        if (*c == '%')
            continue;
        c += strspn(c, "-+ #0123456789.");
        if (*c == '\0' || ++argument > top)
            break;
        if (strchr("cdiouxX", *c))
            make_whole(L, argument);
    }
    return run_original(L);
}

/* The global `arg` in a function with `...`: the table of these arguments, with their number as n. It is made anew for
 * each use. Index 1: the globals; index 2: a name that they lack. */
static int further_arguments(lua_State *L) {
    lua_Debug caller;
    const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
    if (strcmp(name, "arg") != 0 || !lua_getstack(L, 1, &caller) || !lua_getinfo(L, "uS", &caller) ||
        !caller.isvararg || strcmp(caller.what, "Lua") != 0)
        return 0;
    int count = 0;
    lua_newtable(L);
    while (lua_getlocal(L, &caller, -(count + 1)))
        lua_rawseti(L, 3, ++count);
    lua_pushinteger(L, count);
    lua_setfield(L, 3, "n");
    return 1;
}

/* What Lua calls (compat.lua). */

static int scene_globals(lua_State *L) {
    lua_pushglobaltable(L);
    return 1;
}

static int first_seed(lua_State *L) {
    lua_pushinteger(L, (lua_Integer)sandbox_of(L)->options->seed);
    return 1;
}

void compat_open(lua_State *L) {
    static const luaL_Reg maths[] = {{"pow", math_pow},     {"log10", math_log10}, {"cosh", math_cosh},
                                     {"sinh", math_sinh},   {"tanh", math_tanh},   {"atan2", math_atan2},
                                     {"frexp", math_frexp}, {"ldexp", math_ldexp}, {NULL, NULL}};
    static const luaL_Reg helpers[] = {{"scene_globals", scene_globals}, {"first_seed", first_seed}, {NULL, NULL}};
    for (size_t k = 0; k < sizeof whole_arguments / sizeof whole_arguments[0]; k++)
        wrap(L, whole_arguments[k].library, whole_arguments[k].name, cut_fractions, &whole_arguments[k]);
    wrap(L, "string", "format", string_format, NULL);
    lua_getglobal(L, "math");
    luaL_setfuncs(L, maths, 0);
    embedded_run(L, compat_lua, helpers);
    lua_rawsetp(L, LUA_REGISTRYINDEX, compat_lua);
    lua_pop(L, 1);

    lua_pushglobaltable(L);
    lua_createtable(L, 0, 1);
    lua_pushcfunction(L, further_arguments);
    lua_setfield(L, -2, "__index");
    lua_setmetatable(L, -2);
    lua_pop(L, 1);

    lua_pushinteger(L, 0);
    lua_createtable(L, 0, 2);
    lua_pushcfunction(L, number_text);
    lua_setfield(L, -2, "__tostring");
    lua_pushboolean(L, 0);
    lua_setfield(L, -2, "__metatable");
    lua_setmetatable(L, -2); /* of every number */
    lua_pop(L, 1);
}

void compat_push_literal(lua_State *L, const char *text) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, compat_lua);
    lua_pushstring(L, text);
    lua_call(L, 1, 1);
}
