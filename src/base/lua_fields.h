/* Fields of the Lua table on top of the stack. May raise without memory. */
#ifndef GRAY_BASE_LUA_FIELDS_H
#define GRAY_BASE_LUA_FIELDS_H

#include <lua.h>
#include <stdbool.h>

static inline void field_number(lua_State *L, const char *field, double number) {
    lua_pushnumber(L, number);
    lua_setfield(L, -2, field);
}
static inline void field_flag(lua_State *L, const char *field, bool flag) {
    lua_pushboolean(L, flag);
    lua_setfield(L, -2, field);
}
static inline void field_text(lua_State *L, const char *field, const char *text) { /* NULL: nil */
    lua_pushstring(L, text);
    lua_setfield(L, -2, field);
}
/* Pushes a list. */
static inline void push_numbers(lua_State *L, const double *numbers, int count) {
    lua_createtable(L, count, 0);
    for (int i = 0; i < count; i++) {
        lua_pushnumber(L, numbers[i]);
        lua_rawseti(L, -2, i + 1);
    }
}
static inline void field_numbers(lua_State *L, const char *field, const double *numbers, int count) {
    push_numbers(L, numbers, count);
    lua_setfield(L, -2, field);
}

#endif
