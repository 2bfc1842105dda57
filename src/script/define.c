/* -D name=value: globals set before the run. A value that is a Lua literal counts as that (number, quoted string, true,
 * false, nil, a table of literals), anything else is a string. Tables are evaluated without any globals. */
#include "script/context.h"

#include <assert.h>
#include <lauxlib.h>
#include <string.h>

/* Evaluates `return VALUE` in an empty environment. False: it is no literal; the stack is as before. */
static bool evaluate(lua_State *L, const char *value) {
    int top = lua_gettop(L);
    lua_pushfstring(L, "return %s", value);
    const char *text = lua_tostring(L, -1);
    if (luaL_loadbufferx(L, text, strlen(text), "=-D", "t") == LUA_OK) {
        lua_newtable(L);
        const char *environment = lua_setupvalue(L, -2, 1);
        assert(environment); /* every chunk has one */
        (void)environment;
        if (lua_pcall(L, 0, 1, 0) == LUA_OK) {
            lua_replace(L, top + 1);
            lua_settop(L, top + 1);
            return true;
        }
    }
    lua_settop(L, top);
    return false;
}

static void push_value(lua_State *L, const char *value) {
    size_t length = strlen(value);
    if (lua_stringtonumber(L, value) == length + 1)
        return;
    if (strcmp(value, "true") == 0 || strcmp(value, "false") == 0) {
        lua_pushboolean(L, value[0] == 't');
        return;
    }
    if (strcmp(value, "nil") == 0) {
        lua_pushnil(L);
        return;
    }
    char first = value[0], last = length > 0 ? value[length - 1] : '\0';
    bool quoted = length >= 2 && (first == '"' || first == '\'') && last == first;
    bool table = first == '{' && last == '}' && !strstr(value, "function");
    if (quoted && evaluate(L, value)) {
        if (lua_type(L, -1) == LUA_TSTRING)
            return;
        lua_pop(L, 1);
    } else if (table && evaluate(L, value)) {
        return;
    }
    lua_pushstring(L, value);
}

void define_open(lua_State *L) {
    const struct script_options *options = context_of(L)->options;
    for (int k = 0; k < options->define_count; k++) {
        push_value(L, options->defines[k].value);
        lua_setglobal(L, options->defines[k].name);
    }
}
