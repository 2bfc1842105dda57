/* Functions of Lua 5.0 and 5.1 that 5.4 no longer has (Lua reference manuals 5.0 to 5.4,
 * "Changes since the previous version"). Not possible: the implicit table `arg` of vararg functions. */
#include "compat/compat.h"

#include "math/elementary.h"
#include "sandbox/sandbox.h"

#include <lauxlib.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

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

static int table_length(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_pushinteger(L, luaL_len(L, 1));
    return 1;
}

/* Since 5.1 the length of a table is found from its entries. */
static int table_set_length(lua_State *L) {
    lua_settop(L, 1);
    return 1;
}

static int table_largest(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_Number largest = 0;
    for (lua_pushnil(L); lua_next(L, 1); lua_pop(L, 1))
        if (lua_type(L, -2) == LUA_TNUMBER && lua_tonumber(L, -2) > largest)
            largest = lua_tonumber(L, -2);
    lua_pushnumber(L, largest);
    return 1;
}

static int table_for_each_index(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    luaL_checktype(L, 2, LUA_TFUNCTION);
    lua_Integer length = luaL_len(L, 1);
    for (lua_Integer k = 1; k <= length; k++) {
        lua_pushvalue(L, 2);
        lua_pushinteger(L, k);
        lua_geti(L, 1, k);
        lua_call(L, 2, 1);
        if (!lua_isnil(L, -1))
            return 1;
        lua_pop(L, 1);
    }
    return 0;
}

static int math_power(lua_State *L) {
    lua_pushnumber(L, el_pow(luaL_checknumber(L, 1), luaL_checknumber(L, 2)));
    return 1;
}

static int math_log10(lua_State *L) {
    lua_pushnumber(L, el_log10(luaL_checknumber(L, 1)));
    return 1;
}

static int math_cosh(lua_State *L) {
    lua_pushnumber(L, el_cosh(luaL_checknumber(L, 1)));
    return 1;
}

static int math_sinh(lua_State *L) {
    lua_pushnumber(L, el_sinh(luaL_checknumber(L, 1)));
    return 1;
}

static int math_tanh(lua_State *L) {
    lua_pushnumber(L, el_tanh(luaL_checknumber(L, 1)));
    return 1;
}

static int math_atan2(lua_State *L) {
    lua_pushnumber(L, el_atan2(luaL_checknumber(L, 1), luaL_checknumber(L, 2)));
    return 1;
}

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

/* math.randomseed without arguments would use the time: here it restarts the sequence. Floats are truncated, as in
 * Lua 5.1. Upvalue 1: Lua's own function. */
static int math_seed(lua_State *L) {
    lua_Integer seed = (lua_Integer)sandbox_of(L)->options->seed, second = 0;
    if (!lua_isnoneornil(L, 1)) {
        lua_Number x = luaL_checknumber(L, 1);
        if (lua_isinteger(L, 1))
            seed = lua_tointeger(L, 1);
        else
            seed = fabs(x) < 0x1p62 ? (lua_Integer)x : 0;
        second = luaL_optinteger(L, 2, 0);
    }
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_pushinteger(L, seed);
    lua_pushinteger(L, second);
    lua_call(L, 2, 0);
    return 0;
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

/* Runs Lua's own function in the place of this one, so that its errors name the line of the script and the function.
 * Upvalue 1: that of Lua's own function, the state of the random numbers. Upvalue 2: Lua's own function. */
static int run_original(lua_State *L) {
    return lua_tocfunction(L, lua_upvalueindex(2))(L);
}

static void wrap_with_upvalue(lua_State *L, const char *library, const char *name, lua_CFunction function) {
    lua_getglobal(L, library);
    lua_getfield(L, -1, name);
    if (!lua_getupvalue(L, -1, 1))
        lua_pushnil(L);
    lua_insert(L, -2);
    lua_pushcclosure(L, function, 2);
    lua_setfield(L, -2, name);
    lua_pop(L, 1);
}

/* math.random(7 / 2) is math.random(3). */
static int math_random(lua_State *L) {
    make_whole(L, 1);
    if (lua_gettop(L) >= 2)
        make_whole(L, 2);
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

/* loadstring(text, name). Upvalue 1: load. */
static int load_string(lua_State *L) {
    luaL_checkstring(L, 1);
    lua_settop(L, 2);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, 2, LUA_MULTRET);
    return lua_gettop(L);
}

/* The index of the upvalue _ENV of the function at `index`; 0 if it uses no globals. */
static int environment_upvalue(lua_State *L, int index) {
    const char *name;
    for (int k = 1; (name = lua_getupvalue(L, index, k)) != NULL; k++) {
        lua_pop(L, 1);
        if (name[0] == '_' && name[1] == 'E' && name[2] == 'N' && name[3] == 'V' && name[4] == '\0')
            return k;
    }
    return 0;
}

/* Gives the function at `function` its own variable _ENV with the table on top of the stack as value; pops the table.
 * Functions that shared the old variable keep it. */
static void set_environment(lua_State *L, int function) {
    int k = environment_upvalue(L, function);
    if (k == 0) {
        lua_pop(L, 1);
        return;
    }
    if (luaL_loadbufferx(L, "return 0", 8, "=environment", "t") != LUA_OK) /* every chunk has an _ENV */
        lua_error(L);
    lua_insert(L, -2);
    lua_setupvalue(L, -2, 1);
    lua_upvaluejoin(L, function, k, -1, 1);
    lua_pop(L, 1);
}

/* Pushes the function that argument 1 of getfenv and setfenv means: a function, or a level of the stack. */
static bool push_function_of_level(lua_State *L) {
    if (lua_isfunction(L, 1)) {
        lua_pushvalue(L, 1);
        return true;
    }
    lua_Integer level = luaL_optinteger(L, 1, 1);
    lua_Debug frame;
    if (level < 1 || level > 200 || !lua_getstack(L, (int)level, &frame))
        return false;
    lua_getinfo(L, "f", &frame);
    return true;
}

static int environment_get(lua_State *L) {
    if (push_function_of_level(L) && !lua_iscfunction(L, -1)) {
        int k = environment_upvalue(L, lua_gettop(L));
        if (k > 0) {
            lua_getupvalue(L, -1, k);
            return 1;
        }
    }
    lua_pushglobaltable(L);
    return 1;
}

static int environment_set(lua_State *L) {
    luaL_checktype(L, 2, LUA_TTABLE);
    if (!push_function_of_level(L) || lua_iscfunction(L, -1))
        return luaL_error(L, "setfenv: there is no such Lua function");
    int function = lua_gettop(L);
    lua_pushvalue(L, 2);
    set_environment(L, function);
    lua_settop(L, function);
    return 1;
}

/* package.seeall: names that are not in the module are looked up in the globals. */
static int see_all(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    if (!lua_getmetatable(L, 1)) {
        lua_createtable(L, 0, 1);
        lua_pushvalue(L, -1);
        lua_setmetatable(L, 1);
    }
    lua_pushglobaltable(L);
    lua_setfield(L, -2, "__index");
    return 0;
}

/* module(name, ...): the table package.loaded[name] (created if necessary, and stored as a global of that dotted name)
 * becomes the environment of the calling chunk; the further arguments are called with it. */
static int module_begin(lua_State *L) {
    const char *name = luaL_checkstring(L, 1);
    int options = lua_gettop(L);
    lua_getfield(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE);
    if (lua_getfield(L, -1, name) != LUA_TTABLE) {
        lua_pop(L, 1);
        lua_pushglobaltable(L);
        for (const char *part = name; *part;) {
            size_t length = 0;
            while (part[length] && part[length] != '.')
                length++;
            lua_pushlstring(L, part, length);
            lua_pushvalue(L, -1);
            if (lua_rawget(L, -3) != LUA_TTABLE) {
                lua_pop(L, 1);
                lua_newtable(L);
                lua_pushvalue(L, -2);
                lua_pushvalue(L, -2);
                lua_rawset(L, -5);
            }
            lua_replace(L, -3); /* continues with the inner table */
            lua_pop(L, 1);
            part += length + (part[length] == '.');
        }
        lua_pushvalue(L, -1);
        lua_setfield(L, -3, name);
    }
    int module = lua_gettop(L);
    lua_pushvalue(L, module);
    lua_setfield(L, module, "_M");
    lua_pushvalue(L, 1);
    lua_setfield(L, module, "_NAME");
    lua_Debug frame;
    if (lua_getstack(L, 1, &frame)) {
        (void)lua_getinfo(L, "f", &frame);
        int k = lua_iscfunction(L, -1) ? 0 : environment_upvalue(L, lua_gettop(L));
        if (k > 0) { /* the chunk and all its functions share this variable */
            lua_pushvalue(L, module);
            (void)lua_setupvalue(L, -2, k);
        }
    }
    for (int k = 2; k <= options; k++) {
        if (!lua_isfunction(L, k))
            continue; /* `module(..., f)`: require gives the chunk the name of its file as well */
        lua_pushvalue(L, k);
        lua_pushvalue(L, module);
        lua_call(L, 1, 0);
    }
    return 0;
}

static void copy_field(lua_State *L, const char *library, const char *from, const char *to) {
    lua_getglobal(L, library);
    lua_getfield(L, -1, from);
    lua_setfield(L, -2, to);
    lua_pop(L, 1);
}

static void set_functions(lua_State *L, const char *library, const luaL_Reg *functions) {
    lua_getglobal(L, library);
    luaL_setfuncs(L, functions, 0);
    lua_pop(L, 1);
}

void compat_open(lua_State *L) {
    static const luaL_Reg tables[] = {{"getn", table_length},
                                      {"setn", table_set_length},
                                      {"maxn", table_largest},
                                      {"foreachi", table_for_each_index},
                                      {NULL, NULL}};
    static const luaL_Reg maths[] = {{"pow", math_power},   {"log10", math_log10}, {"cosh", math_cosh},
                                     {"sinh", math_sinh},   {"tanh", math_tanh},   {"atan2", math_atan2},
                                     {"frexp", math_frexp}, {"ldexp", math_ldexp}, {NULL, NULL}};
    static const luaL_Reg globals[] = {
        {"getfenv", environment_get}, {"setfenv", environment_set}, {"module", module_begin}, {NULL, NULL}};
    static const luaL_Reg packages[] = {{"seeall", see_all}, {NULL, NULL}};
    set_functions(L, "table", tables);
    set_functions(L, "math", maths);
    set_functions(L, LUA_GNAME, globals);
    set_functions(L, "package", packages);
    copy_field(L, "math", "fmod", "mod");
    copy_field(L, "string", "gmatch", "gfind");

    lua_getglobal(L, "table");
    lua_getfield(L, -1, "unpack");
    lua_setglobal(L, "unpack");
    lua_pop(L, 1);

    lua_getglobal(L, "load");
    lua_pushcclosure(L, load_string, 1);
    lua_setglobal(L, "loadstring");

    wrap_with_upvalue(L, "math", "random", math_random);
    wrap_with_upvalue(L, "string", "format", string_format);

    lua_getglobal(L, "math");
    lua_getfield(L, -1, "randomseed");
    lua_pushcclosure(L, math_seed, 1);
    lua_pushvalue(L, -1);
    lua_setfield(L, -3, "randomseed");
    lua_call(L, 0, 0); /* random numbers start from the seed of the command line */
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
