#include "call/named_numbers_internal.h"

#include "math/elementary.h"

#include <math.h>
#include <string.h>

bool named_numbers_push(lua_State *L, int index, int count) {
    static const char *const names[] = {"xyz", "rgb", "wxyz", "xz", "xy", "uv"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        int found = 0;
        if (strlen(names[i]) != (size_t)count)
            continue;
        lua_createtable(L, count, 0);
        for (; found < count; found++) {
            lua_pushlstring(L, &names[i][found], 1);
            if (lua_rawget(L, index) == LUA_TNIL)
                break;
            lua_rawseti(L, -2, found + 1);
        }
        if (found == count)
            return true;
        lua_settop(L, lua_gettop(L) - (found < count ? 2 : 1));
    }
    return false;
}

bool compass_read(struct script_context *context, int index, const char *name, struct vec3 *out) {
    static const char *const names[] = {"azimuth", "elevation"};
    static const double limits[] = {360, 90};
    lua_State *L = context->sandbox.lua;
    double degrees[2] = {0, 0}, sine[2], cosine[2];
    int found = 0;
    for (int k = 0; k < 2 && lua_istable(L, index); k++) {
        lua_pushstring(L, names[k]);
        int type = lua_rawget(L, index);
        degrees[k] = lua_tonumber(L, -1);
        lua_pop(L, 1);
        found += type != LUA_TNIL;
        if (type != LUA_TNIL && (type != LUA_TNUMBER || !(fabs(degrees[k]) <= limits[k])))
            sandbox_raise(&context->sandbox, "%s.%s must be a number between %g and %g", name, names[k], -limits[k],
                          limits[k]);
    }
    if (found == 1)
        sandbox_raise(&context->sandbox, "%s must be a direction {x, y, z} or {azimuth = ..., elevation = ...}", name);
    for (int k = 0; k < found; k++)
        el_sincos(degrees[k] * (PI / 180), &sine[k], &cosine[k]);
    if (found == 2)
        *out = vec3_make(sine[0] * cosine[1], sine[1], -cosine[0] * cosine[1]);
    return found == 2;
}
