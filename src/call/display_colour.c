/* Colours as a screen shows them: '#rgb', '#rrggbb', and the results of gr.srgb, which are tables {r, g, b, encoding =
 * 'srgb'}. Classic colours are these numbers; linear colours decode them (docs/colour.md). */
#include "call/display_colour.h"

#include "image/transfer.h"

#include <lauxlib.h>
#include <string.h>

static const char *const digits = "0123456789abcdefABCDEF";

static double digit(char c) {
    return c >= 'a' ? c - 'a' + 10 : c >= 'A' ? c - 'A' + 10 : c - '0';
}

/* '#rgb' or '#rrggbb'. */
static bool read_hexadecimal(const char *text, struct colour *out) {
    size_t count = strspn(text + 1, digits), each = count / 3;
    double x[3];
    if (text[1 + count] != '\0' || (count != 3 && count != 6))
        return false;
    for (size_t k = 0; k < 3; k++) {
        const char *at = text + 1 + k * each;
        x[k] = each == 1 ? digit(at[0]) / 15 : (16 * digit(at[0]) + digit(at[1])) / 255;
    }
    *out = colour_make(x[0], x[1], x[2]);
    return true;
}

/* A table of three numbers whose encoding is 'srgb'. */
static bool read_marked(lua_State *L, int index, struct colour *out) {
    double x[3];
    bool ok = lua_rawlen(L, index) == 3;
    lua_pushliteral(L, "encoding");
    ok = lua_rawget(L, index) == LUA_TSTRING && strcmp(lua_tostring(L, -1), "srgb") == 0 && ok;
    lua_pop(L, 1);
    for (int k = 0; ok && k < 3; k++) {
        ok = lua_rawgeti(L, index, k + 1) == LUA_TNUMBER;
        x[k] = lua_tonumber(L, -1);
        ok = ok && isfinite(x[k]);
        lua_pop(L, 1);
    }
    if (ok)
        *out = colour_make(x[0], x[1], x[2]);
    return ok;
}

bool display_colour_at(lua_State *L, int index, struct colour *out) {
    index = lua_absindex(L, index);
    if (lua_type(L, index) == LUA_TTABLE)
        return read_marked(L, index, out);
    if (lua_type(L, index) != LUA_TSTRING || lua_tostring(L, index)[0] != '#')
        return false;
    if (!read_hexadecimal(lua_tostring(L, index), out))
        sandbox_raise(sandbox_of(L), "'%.40s' is not a colour; colours are '#rgb' or '#rrggbb' with hexadecimal digits",
                      lua_tostring(L, index));
    return true;
}

bool display_colour_read(struct script_context *c, int index, const struct script_parameter *p,
                         struct script_value *value) {
    struct colour colour;
    struct error error;
    if (!display_colour_at(c->sandbox.lua, index, &colour))
        return false;
    if (!(p->flags & (OR_TEXTURE | OR_DISPLAY)) && p->kind != KIND_BACKGROUND)
        sandbox_raise(&c->sandbox, "%s must be light: gr.linear converts a display colour to light", p->name);
    value->colour = colour;
    value->display = true;
    if (!(p->flags & OR_TEXTURE))
        return true;
    struct arena *arena = &c->scene.arena;
    struct script_texture texture = {.texture = texture_keep(arena, texture_display_colour(colour), &error)};
    value->texture = texture.texture ? context_keep_texture(c, &texture, &error) : NULL;
    if (!value->texture)
        sandbox_raise_no_memory(&c->sandbox);
    value->number = 1;
    value->colour = colour_all(1);
    return true;
}

/* The colour of a call: a string, a table of three numbers, or three numbers. */
static struct colour colour_of_call(lua_State *L) {
    struct colour colour;
    if (lua_gettop(L) == 1 && display_colour_at(L, 1, &colour))
        return colour;
    bool is_table = lua_type(L, 1) == LUA_TTABLE;
    double x[3];
    for (int k = 0; k < 3; k++) {
        if (is_table)
            (void)lua_rawgeti(L, 1, k + 1);
        else if (lua_gettop(L) == 3)
            lua_pushvalue(L, k + 1);
        else
            lua_pushnil(L);
        if (lua_type(L, -1) != LUA_TNUMBER)
            sandbox_raise(sandbox_of(L), "a colour is needed: '#rrggbb', {r, g, b} or r, g, b");
        x[k] = lua_tonumber(L, -1);
        lua_pop(L, 1);
    }
    return colour_make(x[0], x[1], x[2]);
}

static int make_display_colour(lua_State *L) {
    struct colour colour = colour_of_call(L);
    const double x[3] = {colour.r, colour.g, colour.b};
    lua_createtable(L, 3, 1);
    for (int k = 0; k < 3; k++) {
        lua_pushnumber(L, x[k]);
        lua_rawseti(L, -2, k + 1);
    }
    lua_pushliteral(L, "srgb");
    lua_setfield(L, -2, "encoding");
    return 1;
}

static int light_of_display_colour(lua_State *L) {
    struct colour light = transfer_decode_colour((struct transfer_function){TRANSFER_SRGB, 0}, colour_of_call(L));
    lua_pushnumber(L, light.r);
    lua_pushnumber(L, light.g);
    lua_pushnumber(L, light.b);
    push_vector(L);
    return 1;
}

static const struct value_function functions[] = {
    {"srgb", "colour", "A display colour: '#rrggbb', {r, g, b} or r, g, b; gray decodes it for linear colours.",
     "gr.triple", make_display_colour},
    {"linear", "colour", "The light of a display colour as a vector, decoded by the sRGB function.", "gr.vector",
     light_of_display_colour},
};
const struct value_functions display_colour_functions = {functions, sizeof functions / sizeof functions[0]};
