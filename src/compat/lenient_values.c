/* Values in the form that a parameter wants: a number for a table and the reverse, tables with fields x, y, z or r, g,
 * b, one handle for a list of them, colours for materials. Numbers are brought into the range of the parameter. What
 * has no sensible form becomes nil, and the parameter gets its default. */
#include "compat/lenient_values_internal.h"

#include "call/argument.h"
#include "compat/lenient.h"
#include "compat/lenient_picture.h"
#include "math/range.h"

#include <lauxlib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The number of tables that are opened to find a number. */
enum { NESTED = 3 };

static bool number_of(lua_State *L, int index, int depth, double *out) {
    int is_number, type = lua_type(L, index);
    *out = lua_tonumberx(L, index, &is_number);
    if (!is_number && type == LUA_TSTRING) {
        char *end;
        const char *text = lua_tostring(L, index);
        *out = strtod(text, &end); /* '3 cm' */
        is_number = end > text;
    } else if (!is_number && type == LUA_TBOOLEAN) {
        *out = lua_toboolean(L, index);
        is_number = true;
    } else if (!is_number && type == LUA_TTABLE && depth < NESTED) {
        lua_rawgeti(L, index, 1);
        is_number = number_of(L, lua_gettop(L), depth + 1, out);
        lua_pop(L, 1);
    }
    return is_number && isfinite(*out);
}

/* Clamps the number into the range. False: no number near it is in the range. */
static bool into_range(const struct script_parameter *p, double *x) {
    *x = fmax(-NUMBER_LIMIT, fmin(NUMBER_LIMIT, *x));
    if (p->kind == KIND_WHOLE)
        *x = floor(*x);
    if (p->flags & NOT_ZERO)
        return *x != 0;
    if (p->low == 0 && p->high == 0)
        return true;
    if (p->flags & LOW_OPEN ? *x <= p->low : *x < p->low) {
        *x = p->low;
        return !(p->flags & LOW_OPEN);
    }
    if (p->flags & HIGH_OPEN ? *x >= p->high : *x > p->high) {
        *x = p->high;
        return !(p->flags & HIGH_OPEN);
    }
    return true;
}

static void push_number(struct script_context *c, int index, const struct script_function *function,
                        const struct script_parameter *p) {
    double x;
    if (!number_of(c->sandbox.lua, index, 0, &x)) {
        lua_pushnil(c->sandbox.lua);
        return;
    }
    if (into_range(p, &x)) {
        lua_pushnumber(c->sandbox.lua, x);
        return;
    }
    /* A ball of radius 0 draws nothing. */
    bool has_extent = (p->flags & NOT_ZERO) || ((p->flags & LOW_OPEN) && x <= p->low);
    if (function->result == RESULT_NODE && has_extent)
        c->lenient->nothing = true;
    lua_pushnil(c->sandbox.lua);
}

static int hex_digit(char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

/* '#c08040'. */
static bool colour_of_text(const char *text, double out[3]) {
    if (text[0] != '#' || strlen(text) != 7)
        return false;
    for (int k = 0; k < 3; k++) {
        int high = hex_digit(text[1 + 2 * k]), low = hex_digit(text[2 + 2 * k]);
        if (high < 0 || low < 0)
            return false;
        out[k] = (16 * high + low) / 255.0;
    }
    return true;
}

/* Pushes component k (from 0) of the table at `index`: by its index, or by its name. */
static void push_component(lua_State *L, int index, int k, int count) {
    static const char *const names[][2] = {{"x", "r"}, {"y", "g"}, {"z", "b"}, {"w", "a"}};
    if (lua_rawgeti(L, index, k + 1) != LUA_TNIL || k > 3)
        return;
    for (int n = 0; n < 2; n++) {
        lua_pop(L, 1);
        lua_pushstring(L, names[count == 4 ? (k + 3) % 4 : k][n]); /* quaternions begin with w */
        if (lua_rawget(L, index) != LUA_TNIL)
            return;
    }
}

/* Pushes a table of `count` numbers, or nil. */
static void push_tuple(struct script_context *c, int index, const struct script_function *function,
                       const struct script_parameter *p, int count) {
    lua_State *L = c->sandbox.lua;
    int top = lua_gettop(L);
    double x, colour[3];
    bool is_colour = lua_type(L, index) == LUA_TSTRING && colour_of_text(lua_tostring(L, index), colour);
    lua_createtable(L, count, 0);
    if (lua_istable(L, index)) {
        if (lua_rawgeti(L, index, 1) == LUA_TTABLE && lua_rawlen(L, -1) >= (lua_Unsigned)count)
            index = top + 2; /* {{x, y, z}} */
    } else if (!is_colour && !number_of(L, index, 0, &x)) {
        lua_settop(L, top);
        lua_pushnil(L);
        return;
    }
    for (int k = 0; k < count; k++) {
        double value = is_colour ? colour[k % 3] : x;
        if (lua_istable(L, index)) {
            push_component(L, index, k, count);
            if (!number_of(L, lua_gettop(L), 0, &value))
                value = 0;
        }
        if (!into_range(p, &value)) {
            c->lenient->nothing = c->lenient->nothing || function->result == RESULT_NODE;
            value = 1;
        }
        lua_settop(L, top + 2);
        lua_pushnumber(L, value);
        lua_rawseti(L, top + 1, k + 1);
    }
    lua_settop(L, top + 1);
}

static bool is_handle(lua_State *L, int index, enum handle_type type) {
    const struct handle *handle = handle_at(L, index);
    return handle && (handle->type == type || handle->type == HANDLE_GHOST);
}

/* Pushes a list of the handles of that type: the value itself, or those in the table, also in tables in it. */
static void push_list(lua_State *L, int index, enum handle_type type) {
    lua_newtable(L);
    int list = lua_gettop(L);
    if (is_handle(L, index, type)) {
        lua_pushvalue(L, index);
        lua_rawseti(L, list, 1);
        return;
    }
    if (!lua_istable(L, index))
        return;
    lua_Integer length = 0;
    for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1)) {
        if (!lua_isinteger(L, -2))
            continue;
        lua_Integer at = lua_tointeger(L, -2);
        length = at > length && at < 1000000 ? at : length;
    }
    for (lua_Integer k = 1; k <= length; k++) {
        int entry = lua_rawgeti(L, index, k);
        lua_Integer end = (lua_Integer)lua_rawlen(L, list);
        if (entry == LUA_TTABLE) {
            for (lua_Integer i = 1, count = (lua_Integer)lua_rawlen(L, list + 1); i <= count; i++) {
                lua_rawgeti(L, list + 1, i);
                if (is_handle(L, -1, type))
                    lua_rawseti(L, list, ++end);
                else
                    lua_pop(L, 1);
            }
        }
        if (is_handle(L, list + 1, type))
            lua_rawseti(L, list, end + 1);
        lua_settop(L, list);
    }
}

/* A group of the nodes of a table, where the parameter is one node. */
static void push_node(struct script_context *c, int index) {
    lua_State *L = c->sandbox.lua;
    if (is_handle(L, index, HANDLE_NODE)) {
        lua_pushvalue(L, index);
        return;
    }
    push_list(L, index, HANDLE_NODE);
    lua_Integer count = (lua_Integer)lua_rawlen(L, -1);
    if (count == 0) {
        lua_pop(L, 1);
        lua_pushnil(L);
        return;
    }
    int list = lua_gettop(L);
    lua_rawgeti(L, list, 1);
    if (count > 1) {
        lua_pop(L, 1);
        context_push_function(L, "node");
        lua_createtable(L, 0, 1);
        lua_pushvalue(L, list);
        lua_setfield(L, -2, "children");
        lua_call(L, 1, 1);
    }
    lua_replace(L, list);
}

/* A colour becomes the kd of a material. */
static void push_material(struct script_context *c, int index) {
    lua_State *L = c->sandbox.lua;
    if (is_handle(L, index, HANDLE_MATERIAL)) {
        lua_pushvalue(L, index);
        return;
    }
    double colour[3];
    bool is_tuple = lua_istable(L, index) && lua_rawgeti(L, index, 3) == LUA_TNUMBER;
    bool is_text = lua_type(L, index) == LUA_TSTRING && colour_of_text(lua_tostring(L, index), colour);
    if (!is_tuple && !is_text && !is_handle(L, index, HANDLE_TEXTURE)) {
        lua_pushnil(L);
        return;
    }
    context_push_function(L, "material");
    lua_createtable(L, 0, 1);
    lua_pushvalue(L, index);
    lua_setfield(L, -2, "kd");
    lua_call(L, 1, 1);
}

static void push_points(struct script_context *c, int index, const struct script_function *function,
                        const struct script_parameter *p, int count) {
    lua_State *L = c->sandbox.lua;
    if (!lua_istable(L, index)) {
        lua_pushnil(L);
        return;
    }
    lua_Integer length = (lua_Integer)lua_rawlen(L, index);
    lua_createtable(L, 0, 0);
    int list = lua_gettop(L);
    for (lua_Integer k = 1; k <= length; k++) { /* none is left out, since indices refer to them */
        lua_rawgeti(L, index, k);
        push_tuple(c, list + 1, function, p, count);
        if (lua_isnil(L, -1)) {
            lua_pop(L, 1);
            lua_createtable(L, count, 0);
            for (int d = 1; d <= count; d++) {
                lua_pushnumber(L, 0);
                lua_rawseti(L, -2, d);
            }
        }
        lua_rawseti(L, list, k);
        lua_settop(L, list);
    }
}

/* Faces with indices of vertices that exist. */
static void push_faces(lua_State *L, int index, uint32_t vertices) {
    if (!lua_istable(L, index)) {
        lua_pushnil(L);
        return;
    }
    lua_Integer length = (lua_Integer)lua_rawlen(L, index), kept = 0;
    lua_newtable(L);
    int list = lua_gettop(L);
    for (lua_Integer k = 1; k <= length; k++, lua_settop(L, list)) {
        if (lua_rawgeti(L, index, k) != LUA_TTABLE)
            continue;
        lua_Integer corners = (lua_Integer)lua_rawlen(L, list + 1), good = 0;
        lua_createtable(L, 4, 0);
        for (lua_Integer i = 1; i <= corners; i++) {
            double x;
            lua_rawgeti(L, list + 1, i);
            if (number_of(L, lua_gettop(L), 0, &x) && x >= 0 && x < vertices) {
                lua_pushinteger(L, (lua_Integer)x);
                lua_rawseti(L, list + 2, ++good);
            }
            lua_settop(L, list + 2);
        }
        if (good >= 3 && good == corners)
            lua_rawseti(L, list, ++kept);
    }
}

static bool same_letters(const char *a, const char *b, size_t b_length) {
    size_t i = 0;
    for (; *a; a++) {
        if (*a == '_')
            continue;
        while (i < b_length && b[i] == '_')
            i++;
        if (i == b_length || (*a | 32) != (b[i++] | 32))
            return false;
    }
    while (i < b_length && b[i] == '_')
        i++;
    return i == b_length;
}

/* Pushes the most similar word of the list, or nil. */
static void push_choice(lua_State *L, int index, const struct script_parameter *p) {
    if (p->kind == KIND_AXIS && lua_istable(L, index)) { /* {0, 1, 0} is y */
        double x, max = 0;
        int axis = 0;
        for (int k = 0; k < 3; k++) {
            push_component(L, index, k, 3);
            if (number_of(L, lua_gettop(L), 0, &x) && fabs(x) > max)
                max = fabs(x), axis = k;
            lua_pop(L, 1);
        }
        lua_pushlstring(L, &"xyz"[axis], 1);
        return;
    }
    if ((p->flags & OR_CURVE) && lua_isfunction(L, index)) {
        lua_pushvalue(L, index);
        return;
    }
    if (lua_type(L, index) == LUA_TNUMBER) {
        lua_Integer which = (lua_Integer)fmax(-1, fmin(100, lua_tonumber(L, index)));
        const char *word = p->choices;
        for (; which > 1 && *word; which--)
            word += strcspn(word, " "), word += *word == ' ';
        lua_pushlstring(L, word, strcspn(word, " "));
        return;
    }
    if (lua_type(L, index) != LUA_TSTRING) {
        lua_pushnil(L);
        return;
    }
    const char *text = lua_tostring(L, index);
    if (p->kind == KIND_AXIS && strpbrk(text, "xyzXYZ")) {
        char axis = (char)(*strpbrk(text, "xyzXYZ") | ' ');
        lua_pushlstring(L, &axis, 1);
        return;
    }
    for (const char *word = p->choices; *word; word += *word == ' ') {
        size_t length = strcspn(word, " ");
        if (same_letters(text, word, length)) {
            lua_pushlstring(L, word, length);
            return;
        }
        word += length;
    }
    lua_pushnil(L);
}

static uint32_t vertex_count(const struct script_function *function, const struct script_parameter *p,
                             const struct script_value *args) {
    const char *of = strcmp(p->name, "face_normals") == 0 ? "normals"
                     : strcmp(p->name, "face_uvs") == 0   ? "uvs"
                                                          : "verts";
    for (int k = 0; k < function->parameter_count; k++)
        if (strcmp(function->parameters[k].name, of) == 0)
            return args[k].count;
    return 0;
}

void lenient_convert(struct script_context *c, int index, const struct script_function *function,
                     const struct script_parameter *p, const struct script_value *args) {
    lua_State *L = c->sandbox.lua;
    const struct handle *handle = handle_at(L, index);
    bool is_texture =
        (p->flags & OR_TEXTURE) && ((handle && handle->type == HANDLE_TEXTURE) || lua_isfunction(L, index));
    luaL_checkstack(L, 20, NULL);
    if (is_texture) {
        lua_pushvalue(L, index);
        return;
    }
    switch (p->kind) {
    case KIND_NUMBER:
    case KIND_WHOLE:
        push_number(c, index, function, p);
        return;
    case KIND_BOOLEAN:
        lua_pushboolean(L, lua_toboolean(L, index) && !(lua_isnumber(L, index) && lua_tonumber(L, index) == 0));
        return;
    case KIND_TEXT:
    case KIND_FILE:
    case KIND_OUTPUT:
        if (lua_isstring(L, index))
            lua_pushvalue(L, index);
        else
            lua_pushnil(L);
        return;
    case KIND_CHOICE:
    case KIND_AXIS:
        push_choice(L, index, p);
        return;
    case KIND_POINT:
    case KIND_DIRECTION:
    case KIND_COLOUR:
    case KIND_TRIPLE:
    case KIND_SIZE:
        push_tuple(c, index, function, p, 3);
        return;
    case KIND_QUATERNION:
        push_tuple(c, index, function, p, 4);
        return;
    case KIND_INTERVAL:
    case KIND_PAIR:
        push_tuple(c, index, function, p, 2);
        return;
    case KIND_NODE:
        push_node(c, index);
        return;
    case KIND_MATERIAL:
        push_material(c, index);
        return;
    case KIND_NODES:
        push_list(L, index, HANDLE_NODE);
        return;
    case KIND_LIGHTS:
        push_list(L, index, HANDLE_LIGHT);
        return;
    case KIND_POINTS:
        push_points(c, index, function, p, 3);
        return;
    case KIND_PAIRS:
        push_points(c, index, function, p, 2);
        return;
    case KIND_STOPS:
        push_points(c, index, function, p, 4);
        return;
    case KIND_FACES:
        push_faces(L, index, vertex_count(function, p, args));
        return;
    case KIND_BACKGROUND:
        if (lua_istable(L, index))
            push_tuple(c, index, function, p, 3);
        else
            lua_pushvalue(L, index);
        return;
    case KIND_MATERIALS:
    case KIND_IMAGE:
    case KIND_FOG:
    case KIND_CAUSTICS:
    case KIND_NUMBERS:
    case KIND_ROWS:
    case KIND_CURVES:
    case KIND_FUNCTION:
    case KIND_CALLBACK:
        lua_pushvalue(L, index);
        return;
    case KIND_COUNT:
        break;
    }
    lua_pushnil(L);
}

static void push_triple(lua_State *L, double x, double y, double z) {
    const double numbers[3] = {x, y, z};
    lua_createtable(L, 3, 0);
    for (int k = 0; k < 3; k++) {
        lua_pushnumber(L, numbers[k]);
        lua_rawseti(L, -2, k + 1);
    }
}

void lenient_default(struct script_context *c, const struct script_function *function,
                     const struct script_parameter *p) {
    lua_State *L = c->sandbox.lua;
    bool is_render = function_renders(function);
    double x = function->owner == OWNER_NODE && !is_render ? strcmp(function->name, "scale") == 0 : 1;
    if (is_render && p->kind == KIND_WHOLE)
        x = 256;
    char name[PATH_SIZE];
    switch (p->kind) {
    case KIND_NUMBER:
    case KIND_WHOLE:
        if (into_range(p, &x))
            lua_pushnumber(L, x);
        else
            lua_pushnumber(L, 0.5 * (p->low + fmin(p->high, p->low + 1)));
        return;
    case KIND_POINT: /* the camera of gr.render fits the scene */
        if (is_render)
            lua_pushnil(L);
        else
            push_triple(L, 0, 0, 0);
        return;
    case KIND_TRIPLE:
        push_triple(L, x * (function->owner == OWNER_NODE), x * (function->owner == OWNER_NODE),
                    x * (function->owner == OWNER_NODE));
        return;
    case KIND_DIRECTION:
        push_triple(L, strcmp(p->name, "v1") == 0, strcmp(p->name, "v1") != 0 && strcmp(p->name, "v2") != 0,
                    strcmp(p->name, "v2") == 0);
        return;
    case KIND_COLOUR:
        x = function->result == RESULT_LIGHT ? 1 : 0.7;
        push_triple(L, x, x, x);
        return;
    case KIND_SIZE:
        push_triple(L, 1, 1, 1);
        return;
    case KIND_OUTPUT:
        context_picture_name(c, "-lenient.png", name, sizeof name);
        lua_pushstring(L, name);
        return;
    case KIND_CHOICE:
    case KIND_AXIS:
        lua_pushlstring(L, p->choices, strcspn(p->choices, " "));
        return;
    case KIND_FILE:
    case KIND_IMAGE:
        lua_pushliteral(L, "missing");
        return;
    case KIND_NODE:
        if (is_render && lenient_root(c))
            handle_push(L, HANDLE_NODE, lenient_root(c));
        else
            lua_pushnil(L);
        return;
    case KIND_MATERIAL:
        context_push_function(L, "material");
        lua_createtable(L, 0, 1);
        push_triple(L, 0.7, 0.7, 0.7);
        lua_setfield(L, -2, "kd");
        lua_call(L, 1, 1);
        return;
    case KIND_NODES:
    case KIND_LIGHTS:
        lua_newtable(L);
        return;
    case KIND_BOOLEAN:
    case KIND_TEXT:
    case KIND_INTERVAL:
    case KIND_QUATERNION:
    case KIND_PAIR:
    case KIND_MATERIALS:
    case KIND_BACKGROUND:
    case KIND_FOG:
    case KIND_CAUSTICS:
    case KIND_POINTS:
    case KIND_PAIRS:
    case KIND_STOPS:
    case KIND_FACES:
    case KIND_NUMBERS:
    case KIND_ROWS:
    case KIND_CURVES:
    case KIND_FUNCTION:
    case KIND_CALLBACK:
    case KIND_COUNT:
        break;
    }
    lua_pushnil(L);
}

/* "cow.obj", "pictures/brick.png". */
static bool has_ending(const char *text) {
    const char *dot = strrchr(text, '.');
    size_t length = dot ? strlen(dot + 1) : 0;
    return dot && dot > text && length >= 2 && length <= 5 && !strpbrk(dot, "/ ");
}

static int fit_of_text(lua_State *L, int index, enum argument_kind kind) {
    bool is_file = kind == KIND_FILE || kind == KIND_OUTPUT || kind == KIND_IMAGE;
    if (lua_type(L, index) == LUA_TNUMBER)
        return 1;
    return has_ending(lua_tostring(L, index)) ? (is_file ? 3 : 1) : 2;
}

int lenient_fit(lua_State *L, int index, const struct script_parameter *p) {
    if (!argument_resembles(L, index, p->kind, p->flags))
        return 0;
    bool is_text = p->kind == KIND_TEXT || p->kind == KIND_FILE || p->kind == KIND_OUTPUT || p->kind == KIND_IMAGE;
    if (is_text && lua_isstring(L, index))
        return fit_of_text(L, index, p->kind);
    if (lua_type(L, index) == LUA_TSTRING && (p->kind == KIND_NUMBER || p->kind == KIND_WHOLE))
        return 1;
    if ((p->kind == KIND_CHOICE || p->kind == KIND_AXIS) && lua_type(L, index) == LUA_TNUMBER)
        return 1;
    if (!lua_istable(L, index))
        return 2;
    int type = lua_rawgeti(L, index, 1);
    lua_pop(L, 1);
    bool of_tables = p->kind == KIND_POINTS || p->kind == KIND_FACES || p->kind == KIND_PAIRS ||
                     p->kind == KIND_STOPS || p->kind == KIND_ROWS || p->kind == KIND_CURVES;
    bool of_handles = p->kind == KIND_NODES || p->kind == KIND_LIGHTS || p->kind == KIND_MATERIALS;
    int wanted = of_tables ? LUA_TTABLE : of_handles ? LUA_TUSERDATA : LUA_TNUMBER;
    return type == wanted ? 3 : type == LUA_TNIL ? 2 : 1;
}
