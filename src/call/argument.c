/* Reads arguments. It may raise a Lua error, so it owns no memory: arrays are in the arena of the call. Tables are read
 * without metamethods, so that a million vertices take a fraction of a second. NaN, infinities and numbers beyond
 * NUMBER_LIMIT are errors here. */
#include "call/argument.h"

#include "base/suggestion.h"
#include "base/unreachable.h"
#include "call/display_colour.h"
#include "call/named_numbers_internal.h"
#include "math/range.h"
#include "record/record.h"
#include "sandbox/hints.h"
#include "settings/settings.h"

#include <assert.h>
#include <lauxlib.h>
#include <math.h>
#include <string.h>

extern const char *const makers_txt[];

/* The position of a value, for messages: name, name[i], name[i][j]. */
struct argument_path {
    const struct script_parameter *parameter;
    lua_Integer i, j; /* 0 = none */
};

static const char *argument_path_text(const struct argument_path *argument_path, char out[128]) {
    const char *name = argument_path->parameter->name;
    if (argument_path->j)
        snprintf(out, 128, "%s[%lld][%lld]", name, (long long)argument_path->i, (long long)argument_path->j);
    else if (argument_path->i)
        snprintf(out, 128, "%s[%lld]", name, (long long)argument_path->i);
    else
        snprintf(out, 128, "%s", name);
    return out;
}

/* The type of Lua or of the handle; of a list of nodes "nodes". */
static const char *given_type(lua_State *L, int index) {
    const struct handle *handle = handle_at(L, index);
    if (handle)
        return handle_key(handle->type);
    if (!lua_istable(L, index))
        return luaL_typename(L, index);
    lua_rawgeti(L, index, 1);
    handle = handle_at(L, -1);
    lua_pop(L, 1);
    return handle && handle->type == HANDLE_NODE ? "nodes" : "table";
}

_Noreturn static void wrong_type(struct script_context *c, const struct argument_path *argument_path,
                                 const char *wanted, int index) {
    char words[128], hint[256] = "";
    lua_State *L = c->sandbox.lua;
    const struct script_parameter *p = argument_path->parameter;
    index = lua_absindex(L, index);
    const char *given = value_words(L, index), *type = given_type(L, index);
    bool is_whole = argument_path->i == 0 || p->kind == KIND_NODES || p->kind == KIND_LIGHTS;
    if (is_whole && (p->flags & OR_TEXTURE) && lua_type(L, index) == LUA_TSTRING && strchr(lua_tostring(L, index), '.'))
        snprintf(hint, sizeof hint, "; gr.texture('%.100s') makes a texture of a file", lua_tostring(L, index));
    for (const char *const *row = makers_txt; is_whole && *row && !hint[0]; row += 3)
        if (strcmp(row[0], kind_name(p->kind)) == 0 && (strcmp(row[1], "any") == 0 || strcmp(row[1], type) == 0))
            snprintf(hint, sizeof hint, "; %s", row[2]);
    sandbox_raise(&c->sandbox, "%s must be %s, not %s%s", argument_path_text(argument_path, words), wanted, given,
                  hint);
}

/* "a > 0 and b < 180" in words. */
static void range_words(const struct script_parameter *p, char out[128]) {
    const char *above = p->flags & LOW_OPEN ? ">" : ">=", *below = p->flags & HIGH_OPEN ? "<" : "<=";
    assert(isfinite(p->low)); /* every range has a lower limit; a test checks all of them */
    if (!isfinite(p->high))
        snprintf(out, 128, "%s %.15g", above, p->low);
    else if (p->flags & (LOW_OPEN | HIGH_OPEN))
        snprintf(out, 128, "%s %.15g and %s %.15g", above, p->low, below, p->high);
    else
        snprintf(out, 128, "between %.15g and %.15g", p->low, p->high);
}

_Noreturn static void out_of_range(struct script_context *c, const struct argument_path *argument_path) {
    char words[128], range[128];
    range_words(argument_path->parameter, range);
    sandbox_raise(&c->sandbox, "%s must be %s", argument_path_text(argument_path, words), range);
}

static double read_number(struct script_context *c, int index, const struct argument_path *argument_path) {
    int is_number;
    double x = lua_tonumberx(c->sandbox.lua, index, &is_number);
    const struct script_parameter *p = argument_path->parameter;
    if (!is_number)
        wrong_type(c, argument_path, argument_path->i ? "a number" : kind_words(p->kind), index);
    char words[128];
    if (isnan(x))
        sandbox_raise(&c->sandbox, "%s must not be NaN (not a number)", argument_path_text(argument_path, words));
    if (isinf(x))
        sandbox_raise(&c->sandbox, "%s must be finite", argument_path_text(argument_path, words));
    bool bounded = p->low != 0 || p->high != 0;
    if (bounded && (p->flags & LOW_OPEN ? x <= p->low : x < p->low))
        out_of_range(c, argument_path);
    if (bounded && (p->flags & HIGH_OPEN ? x >= p->high : x > p->high))
        out_of_range(c, argument_path);
    if (!number_in_range(x))
        sandbox_raise(&c->sandbox, "%s must be between %g and %g", argument_path_text(argument_path, words),
                      -NUMBER_LIMIT, NUMBER_LIMIT);
    if ((p->flags & NOT_ZERO) && x == 0)
        sandbox_raise(&c->sandbox, "%s must not be 0", argument_path_text(argument_path, words));
    return x;
}

static double read_whole(struct script_context *c, int index, const struct argument_path *argument_path) {
    const struct script_parameter *p = argument_path->parameter;
    double x = read_number(c, index, argument_path);
    char words[128];
    if (x == floor(x))
        return x;
    /* A size of a picture in a scene of another program. */
    bool is_dropped = c->sandbox.is_positional && p->unit && strcmp(p->unit, "pixels") == 0;
    if (!is_dropped)
        sandbox_raise(&c->sandbox, "%s must be a whole number", argument_path_text(argument_path, words));
    context_warn_once(c, WARNED_FRACTION, "%s is %.15g: fractions of pixels are dropped", p->name, x);
    return floor(x);
}

/* The `count` numbers of the table at `index` (absolute). argument_path->i is set for a table inside a list. */
static void read_tuple(struct script_context *c, int index, struct argument_path argument_path, int count,
                       double *out) {
    lua_State *L = c->sandbox.lua;
    char words[128];
    lua_Unsigned length = lua_rawlen(L, index);
    if (length == 0 && named_numbers_push(L, index, count)) {
        read_tuple(c, lua_gettop(L), argument_path, count, out);
        lua_pop(L, 1);
        return;
    }
    if (length != (lua_Unsigned)count)
        sandbox_raise(&c->sandbox, "%s must have %d numbers, not %llu", argument_path_text(&argument_path, words),
                      count, (unsigned long long)length);
    for (int k = 0; k < count; k++) {
        if (lua_rawgeti(L, index, k + 1) == LUA_TNUMBER && argument_path.parameter->low == 0 &&
            argument_path.parameter->high == 0 && number_in_range(out[k] = lua_tonumber(L, -1)) &&
            !(argument_path.parameter->flags & NOT_ZERO)) {
            lua_pop(L, 1); /* the common case, without the cost of the argument path */
            continue;
        }
        struct argument_path inner = argument_path;
        *(argument_path.i ? &inner.j : &inner.i) = k + 1;
        out[k] = read_number(c, -1, &inner);
        lua_pop(L, 1);
    }
}

/* An argument that is a table of `count` numbers. */
static void read_row(struct script_context *c, int index, const struct argument_path *argument_path, int count,
                     double *out) {
    if (!lua_istable(c->sandbox.lua, index))
        wrong_type(c, argument_path, kind_words(argument_path->parameter->kind), index);
    read_tuple(c, index, *argument_path, count, out);
}

static struct vec3 read_vector(struct script_context *c, int index, const struct argument_path *argument_path) {
    double x[3];
    read_row(c, index, argument_path, 3, x);
    return (struct vec3){x[0], x[1], x[2]};
}

static struct vec3 read_pair(struct script_context *c, int index, const struct argument_path *argument_path) {
    double x[2];
    read_row(c, index, argument_path, 2, x);
    return (struct vec3){x[0], x[1], 0};
}

static struct vec3 read_interval(struct script_context *c, int index, const struct argument_path *argument_path) {
    struct vec3 pair = read_pair(c, index, argument_path);
    char words[128];
    if (pair.x > pair.y)
        sandbox_raise(&c->sandbox, "%s must not end before it begins", argument_path_text(argument_path, words));
    return pair;
}

/* Strings are not copied: they remain on the stack or in the table of the call. Numbers count as text, as everywhere in
 * Lua. */
static const char *read_text(struct script_context *c, int index, const struct argument_path *argument_path) {
    lua_State *L = c->sandbox.lua;
    char words[128];
    if (lua_type(L, index) == LUA_TNUMBER) {
        const char *text = lua_isinteger(L, index)
                               ? arena_format(&c->sandbox.call, "%lld", (long long)lua_tointeger(L, index))
                               : arena_format(&c->sandbox.call, "%.14g", lua_tonumber(L, index));
        if (!text)
            sandbox_raise_no_memory(&c->sandbox);
        return text;
    }
    if (lua_type(L, index) != LUA_TSTRING)
        wrong_type(c, argument_path, kind_words(argument_path->parameter->kind), index);
    size_t length;
    const char *text = lua_tolstring(L, index, &length);
    if (strlen(text) != length)
        sandbox_raise(&c->sandbox, "%s must not hold a zero byte", argument_path_text(argument_path, words));
    return text;
}

static const char *read_file_name(struct script_context *c, int index, const struct argument_path *argument_path) {
    const char *text = read_text(c, index, argument_path);
    char words[128];
    if (text[0] == '\0')
        sandbox_raise(&c->sandbox, "%s must not be empty", argument_path_text(argument_path, words));
    return text;
}

/* Index of the word among the choices; upper and lower case differ, except for axes. */
enum { LONG_LIST = 8 };
static int read_choice(struct script_context *c, int index, const struct argument_path *argument_path) {
    const struct script_parameter *p = argument_path->parameter;
    const char *text = read_text(c, index, argument_path), *word = p->choices;
    char lowered[2] = {(char)(text[0] | ' '), '\0'}, words[128];
    if (p->kind == KIND_AXIS && text[0] != '\0' && text[1] == '\0')
        text = lowered;
    for (int k = 0; *word; k++) {
        size_t length = strcspn(word, " ");
        if (strncmp(word, text, length) == 0 && text[length] == '\0')
            return k;
        word += length + (word[length] == ' ');
    }
    char list[512], candidates[32][41];
    size_t used = 0;
    int count = 0;
    struct suggestion suggestion;
    suggest_begin(&suggestion, text);
    for (word = p->choices; *word;) {
        int length = (int)strcspn(word, " ");
        const char *next = word + length + (word[length] == ' ');
        if (count < 32) {
            (void)snprintf(candidates[count], sizeof candidates[count], "%.*s", length, word);
            suggest_offer(&suggestion, candidates[count++]);
        }
        const char *separator = used == 0 ? "" : *next ? ", " : " or ";
        used += (size_t)snprintf(list + used, sizeof list - used, "%s'%.*s'", separator, length, word);
        word = next;
    }
    /* Where the list is short, the word that is meant is seen at once. */
    if (count > LONG_LIST && suggestion.best)
        sandbox_raise(&c->sandbox, "%s must be %s, not '%.100s'; did you mean '%s'?",
                      argument_path_text(argument_path, words), list, text, suggestion.best);
    sandbox_raise(&c->sandbox, "%s must be %s, not '%.100s'", argument_path_text(argument_path, words), list, text);
}

/* The handle of that type, or NULL for a ghost (a feature that this version does not have, see context.c). */
static void *read_handle(struct script_context *c, int index, const struct argument_path *argument_path,
                         enum handle_type type) {
    const struct handle *handle = handle_at(c->sandbox.lua, index);
    if (handle && handle->type == HANDLE_GHOST)
        return c->ghost_as(c, handle, type, !(argument_path->parameter->flags & (GHOST_IS_NONE | REST)));
    if (!handle || handle->type != type)
        wrong_type(c, argument_path, argument_path->i ? handle_words(type) : kind_words(argument_path->parameter->kind),
                   index);
    return handle->pointer;
}

static uint32_t list_length(struct script_context *c, int index, const struct argument_path *argument_path) {
    if (!lua_istable(c->sandbox.lua, index))
        wrong_type(c, argument_path, kind_words(argument_path->parameter->kind), index);
    lua_Unsigned length = lua_rawlen(c->sandbox.lua, index);
    char words[128];
    if (length > UINT32_MAX / 4)
        sandbox_raise(&c->sandbox, "%s has too many entries", argument_path_text(argument_path, words));
    return (uint32_t)length;
}

/* `{a, nil, b}` may count as one entry or as three: an entry after a nil is found, and the message names the nil. */
static void check_holes(struct script_context *c, int index, const struct argument_path *argument_path,
                        uint32_t length) {
    lua_State *L = c->sandbox.lua;
    for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1)) {
        if (lua_isinteger(L, -2) && lua_tointeger(L, -2) > (lua_Integer)length)
            sandbox_raise(&c->sandbox, "%s[%u] is nil%s", argument_path->parameter->name, (unsigned)length + 1,
                          hint_of_nil(&c->sandbox));
    }
}

static void read_list_of_handles(struct script_context *c, int index, struct argument_path argument_path,
                                 struct script_value *value) {
    lua_State *L = c->sandbox.lua;
    uint32_t length = list_length(c, index, &argument_path);
    check_holes(c, index, &argument_path, length);
    bool is_lights = argument_path.parameter->kind == KIND_LIGHTS;
    struct scene_light *lights = is_lights ? context_array(c, length, sizeof *lights) : NULL;
    value->nodes = is_lights ? NULL : context_array(c, length, sizeof(struct node *));
    value->lights = lights;
    for (uint32_t k = 0; k < length; k++) {
        argument_path.i = (lua_Integer)k + 1;
        if (lua_rawgeti(L, index, argument_path.i) == LUA_TNIL)
            sandbox_raise(&c->sandbox, "%s[%u] is nil%s", argument_path.parameter->name, (unsigned)k + 1,
                          hint_of_nil(&c->sandbox));
        void *pointer = read_handle(c, -1, &argument_path, is_lights ? HANDLE_LIGHT : HANDLE_NODE);
        lua_pop(L, 1);
        if (!pointer && !(argument_path.parameter->flags & REST)) /* a ghost; NULL in lists whose indices matter */
            continue;
        if (is_lights)
            lights[value->count++] = *(const struct scene_light *)pointer;
        else
            value->nodes[value->count++] = pointer;
    }
}

static void read_tuples(struct script_context *c, int index, struct argument_path argument_path, int width, double *out,
                        uint32_t length) {
    lua_State *L = c->sandbox.lua;
    int top = lua_gettop(L) + 1;
    for (uint32_t k = 0; k < length; k++) {
        argument_path.i = (lua_Integer)k + 1;
        if (lua_rawgeti(L, index, argument_path.i) != LUA_TTABLE)
            wrong_type(c, &argument_path,
                       width == 2   ? "a table of 2 numbers"
                       : width == 3 ? "a table of 3 numbers"
                                    : "a table of 4 numbers",
                       -1);
        read_tuple(c, top, argument_path, width, out + (size_t)k * (size_t)width);
        lua_pop(L, 1);
    }
}

/* The pairs of one curve in a list of curves; messages name the curve and the pair. */
static void read_curve(struct script_context *c, int index, struct argument_path argument_path, double *out,
                       uint32_t length) {
    lua_State *L = c->sandbox.lua;
    for (uint32_t k = 0; k < length; k++) {
        argument_path.j = (lua_Integer)k + 1;
        if (lua_rawgeti(L, index, argument_path.j) != LUA_TTABLE || lua_rawlen(L, -1) != 2)
            wrong_type(c, &argument_path, "a pair of numbers", -1);
        for (int d = 0; d < 2; d++) {
            lua_rawgeti(L, -1, d + 1);
            out[2 * (size_t)k + (size_t)d] = read_number(c, -1, &argument_path);
            lua_pop(L, 1);
        }
        lua_pop(L, 1);
    }
}

enum { MATERIAL_NAMES = 1000 };

/* Materials by name, or a list of them. Names are read in byte order, so that the first wrong one is reported. */
static void read_materials(struct script_context *c, int index, struct argument_path argument_path,
                           struct script_value *value) {
    lua_State *L = c->sandbox.lua;
    uint32_t length = list_length(c, index, &argument_path), count = 0;
    /* A list, or a table with names. */
    if (length == 0)
        for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1), count++)
            if (lua_type(L, -2) != LUA_TSTRING)
                sandbox_raise(&c->sandbox, "%s must be a list or have names", argument_path.parameter->name);
    value->materials = context_array(c, length + (size_t)count, sizeof *value->materials);
    for (uint32_t k = 0; k < length; k++) {
        argument_path.i = (lua_Integer)k + 1;
        lua_rawgeti(L, index, argument_path.i);
        value->materials[value->count++] = read_handle(c, -1, &argument_path, HANDLE_MATERIAL);
        lua_pop(L, 1);
    }
    if (length > 0)
        return;
    if (count > MATERIAL_NAMES)
        sandbox_raise(&c->sandbox, "%s has more than %d entries", argument_path.parameter->name, MATERIAL_NAMES);
    /* Lua has no order of names: they are sorted, so that the result is always the same. */
    const char **names = value->names = context_array(c, count, sizeof *names);
    count = 0;
    for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1), count++) {
        const char *name = lua_tostring(L, -2);
        uint32_t at = count;
        for (; at > 0 && strcmp(names[at - 1], name) > 0; at--)
            names[at] = names[at - 1];
        names[at] = name;
    }
    for (uint32_t k = 0; k < count; k++) {
        lua_pushstring(L, names[k]);
        lua_rawget(L, index);
        const struct handle *handle = handle_at(L, -1);
        bool ghost = handle && handle->type == HANDLE_GHOST;
        if (!ghost && (!handle || handle->type != HANDLE_MATERIAL))
            sandbox_raise(&c->sandbox, "%s['%.100s'] must be a material, not %s", argument_path.parameter->name,
                          names[k], value_words(L, -1));
        value->materials[k] = ghost ? NULL : handle->pointer;
        lua_pop(L, 1);
    }
    value->count = count;
}

/* Two passes: count the corners, then fill arrays of the right size. */
static void read_faces(struct script_context *c, int index, struct argument_path argument_path,
                       struct script_value *value) {
    lua_State *L = c->sandbox.lua;
    uint32_t length = list_length(c, index, &argument_path),
             *starts = context_array(c, (size_t)length + 1, sizeof *starts);
    uint64_t corners = 0;
    for (uint32_t k = 0; k < length; k++) {
        argument_path.i = (lua_Integer)k + 1;
        if (lua_rawgeti(L, index, argument_path.i) != LUA_TTABLE)
            wrong_type(c, &argument_path, "a table of indices", -1);
        starts[k] = (uint32_t)corners;
        /* First the sizes: the arrays of the call are allocated once. */
        corners += lua_rawlen(L, -1);
        lua_pop(L, 1);
        if (corners >= UINT32_MAX)
            sandbox_raise(&c->sandbox, "%s have too many corners", argument_path.parameter->name);
    }
    starts[length] = (uint32_t)corners;
    uint32_t *indices = context_array(c, (size_t)corners, sizeof *indices);
    for (uint32_t k = 0; k < length; k++) {
        lua_rawgeti(L, index, (lua_Integer)k + 1);
        for (uint32_t corner = starts[k]; corner < starts[k + 1]; corner++) {
            argument_path.i = (lua_Integer)k + 1;
            argument_path.j = (lua_Integer)(corner - starts[k]) + 1;
            lua_rawgeti(L, -1, argument_path.j);
            double x = read_number(c, -1, &argument_path);
            char words[128];
            /* The first ray tracers of this language dropped fractions without a word. */
            if (x != floor(x)) {
                context_warn_once(c, WARNED_FRACTION, "%s is %.15g: fractions of indices are dropped",
                                  argument_path_text(&argument_path, words), x);
                x = trunc(x);
            }
            if (x < 0 || x >= UINT32_MAX)
                sandbox_raise(&c->sandbox, "%s is %.15g: indices count from 0",
                              argument_path_text(&argument_path, words), x);
            indices[corner] = (uint32_t)x;
            lua_pop(L, 1);
        }
        lua_pop(L, 1);
    }
    value->count = length;
    value->starts = starts;
    value->indices = indices;
}

/* Numbers of any count from the list at `index` (absolute). */
static void read_numbers(struct script_context *c, int index, struct argument_path argument_path, double *out,
                         uint32_t length) {
    for (uint32_t k = 0; k < length; k++) {
        struct argument_path inner = argument_path;
        *(argument_path.i ? &inner.j : &inner.i) = (lua_Integer)k + 1;
        lua_rawgeti(c->sandbox.lua, index, (lua_Integer)k + 1);
        out[k] = read_number(c, -1, &inner);
        lua_pop(c->sandbox.lua, 1);
    }
}

/* Several lists of numbers or pairs, stored one after the other: they are counted first, then filled. */
static void read_rows(struct script_context *c, int index, struct argument_path argument_path, bool pairs,
                      struct script_value *value) {
    lua_State *L = c->sandbox.lua;
    uint32_t length = list_length(c, index, &argument_path),
             *starts = context_array(c, (size_t)length + 1, sizeof *starts);
    uint64_t total = 0;
    for (uint32_t k = 0; k < length; k++) {
        argument_path.i = (lua_Integer)k + 1;
        if (lua_rawgeti(L, index, argument_path.i) != LUA_TTABLE)
            wrong_type(c, &argument_path, pairs ? "a table of pairs" : "a table of numbers", -1);
        starts[k] = (uint32_t)total;
        /* First the sizes, for one array of all numbers. */
        total += lua_rawlen(L, -1);
        lua_pop(L, 1);
        if (total >= UINT32_MAX / 4)
            sandbox_raise(&c->sandbox, "%s has too many entries", argument_path.parameter->name);
    }
    starts[length] = (uint32_t)total;
    double *numbers = context_array(c, (size_t)total, (pairs ? 2 : 1) * sizeof *numbers);
    int top = lua_gettop(L) + 1;
    for (uint32_t k = 0; k < length; k++) {
        argument_path.i = (lua_Integer)k + 1;
        lua_rawgeti(L, index, argument_path.i);
        if (pairs)
            read_curve(c, top, argument_path, numbers + 2 * (size_t)starts[k], starts[k + 1] - starts[k]);
        else
            read_numbers(c, top, argument_path, numbers + starts[k], starts[k + 1] - starts[k]);
        lua_pop(L, 1);
    }
    value->count = length;
    value->starts = starts;
    value->numbers = pairs ? NULL : numbers;
    value->pairs = pairs ? (const double(*)[2])(void *)numbers : NULL;
}

/* The photons of caustics: their number, or a table of settings. */
static void read_caustics(struct script_context *c, int index, const struct argument_path *argument_path,
                          struct script_value *value) {
    static const struct script_parameter photons = {
        .name = "caustics.photons", .kind = KIND_WHOLE, .low = 0, .high = PHOTONS_MAX};
    static const struct script_parameter radius = {
        .name = "caustics.radius", .kind = KIND_NUMBER, .flags = LOW_OPEN, .low = 0, .high = (double)INFINITY};
    lua_State *L = c->sandbox.lua;
    value->number = PHOTONS_USUAL;
    if (lua_isnumber(L, index)) {
        value->number = read_whole(c, index, &(struct argument_path){.parameter = &photons});
        return;
    }
    if (!lua_istable(L, index))
        wrong_type(c, argument_path, kind_words(argument_path->parameter->kind), index);
    /* The first unknown field by name, so that the message does not depend on the order in the table. */
    const char *unknown = NULL;
    for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1)) {
        if (lua_type(L, -2) != LUA_TSTRING)
            sandbox_raise(&c->sandbox, "fields of caustics need names, as in photons = ...");
        const char *field = lua_tostring(L, -2);
        bool known = strcmp(field, "photons") == 0 || strcmp(field, "radius") == 0;
        if (!known && (!unknown || strcmp(field, unknown) < 0))
            unknown = field;
    }
    if (unknown)
        sandbox_raise(&c->sandbox, "caustics has the fields photons and radius, not '%.100s'", unknown);
    lua_pushstring(L, "photons");
    if (lua_rawget(L, index) != LUA_TNIL)
        value->number = read_whole(c, lua_gettop(L), &(struct argument_path){.parameter = &photons});
    lua_pushstring(L, "radius");
    if (lua_rawget(L, index) != LUA_TNIL)
        value->vector.x = read_number(c, lua_gettop(L), &(struct argument_path){.parameter = &radius});
    lua_pop(L, 2);
}

/* The image of a texture that consists of one image only, or NULL. */
static struct image *image_of(const struct script_texture *texture) {
    const struct texture_image *image = texture_as_image(texture->texture);
    return image ? image->image : NULL;
}

/* --- functions: they are recorded, and the scene keeps the result --- */

/* Raises every error. */
static struct recording record(struct script_context *context, int index, const char *name, enum record_domain domain) {
    struct recording out;
    record_function(&context->sandbox, index, name, domain, &context->scene.arena, &out);
    context->scene.escaped = true; /* the list of recorded functions is older than the program */
    return out;
}

/* The program of a function at an absolute index, or of gr.fn of one; NULL of anything else. source: "scene.lua:12".
 * Raises every error, with the name of the argument in front. */
static const struct expr_program *recorded_program(struct script_context *context, int index, const char *name,
                                                   enum record_domain domain, const char **source) {
    lua_State *L = context->sandbox.lua;
    const struct handle *handle = handle_at(L, index);
    const struct script_texture *texture = handle && handle->type == HANDLE_TEXTURE ? handle->pointer : NULL;
    if (texture && texture->texture->operation.kind == TEXTURE_FUNCTION) {
        *source = texture->texture->source;
        return texture->texture->operation.recorded.program;
    }
    if (lua_type(L, index) != LUA_TFUNCTION)
        return NULL;
    const struct recording recording = record(context, index, name, domain);
    *source = recording.source;
    return recording.program;
}

/* The texture of a function, kept by the scene. Likewise. */
static const struct script_texture *recorded_texture(struct script_context *context, int index, const char *name) {
    const struct recording recording = record(context, index, name, RECORD_POINTS_OF_SPACE);
    struct error error = {0};
    struct script_texture out = {.texture = texture_keep(&context->scene.arena, recording.texture, &error)};
    const struct script_texture *kept = out.texture ? context_keep_texture(context, &out, &error) : NULL;
    if (!kept)
        sandbox_raise_error(&context->sandbox, &error);
    return kept;
}

static enum record_domain domain_of(const struct script_parameter *p) {
    return p->flags & OR_PROFILE || p->kind == KIND_BACKGROUND ? RECORD_DIRECTIONS : RECORD_POINTS_OF_SPACE;
}

/* A function instead of a colour. */
static bool read_function(struct script_context *c, int index, const struct script_parameter *p,
                          struct script_value *value) {
    value->program = recorded_program(c, index, p->name, domain_of(p), &value->source);
    value->colour = colour_all(1);
    return value->program != NULL;
}

/* One argument at an absolute stack index. False: it is a ghost. */
static bool read_value(struct script_context *c, int index, const struct script_parameter *p,
                       struct script_value *value) {
    struct argument_path argument_path = {.parameter = p};
    lua_State *L = c->sandbox.lua;
    char words[128];
    value->given = true;
    /* A texture stands for a value of any kind that accepts one. */
    const struct handle *handle = p->flags & OR_TEXTURE ? handle_at(L, index) : NULL;
    bool is_function = (p->flags & OR_TEXTURE) && lua_type(L, index) == LUA_TFUNCTION;
    if (is_function || (handle && handle->type == HANDLE_TEXTURE)) {
        value->texture = is_function ? recorded_texture(c, index, p->name) : handle->pointer;
        value->image = image_of(value->texture);
        value->number = 1;
        value->colour = colour_all(1);
        return true;
    }
    switch (p->kind) {
    case KIND_NUMBER:
        if (p->choices && p->choices[0] && lua_type(L, index) == LUA_TSTRING && !lua_isnumber(L, index)) {
            value->number = p->high + 1 + read_choice(c, index, &argument_path);
            return true;
        }
        value->number = read_number(c, index, &argument_path);
        if (p->unit && strcmp(p->unit, "degrees") == 0)
            context_warn_of_radians(c, p->name, value->number);
        return true;
    case KIND_WHOLE:
        value->number = read_whole(c, index, &argument_path);
        return true;
    case KIND_BOOLEAN:
        if ((p->flags & OR_NUMBER) && lua_type(L, index) == LUA_TNUMBER)
            value->number = read_number(c, index, &argument_path);
        else if (!lua_isboolean(L, index))
            wrong_type(c, &argument_path, kind_words(p->kind), index);
        value->boolean = lua_toboolean(L, index);
        return true;
    case KIND_TEXT:
        if ((p->flags & OR_PAIR) && lua_istable(L, index))
            value->vector = read_pair(c, index, &argument_path);
        else
            value->text = read_text(c, index, &argument_path);
        return true;
    case KIND_FILE:
        value->text = read_file_name(c, index, &argument_path);
        return true;
    case KIND_OUTPUT:
        value->text = files_repair_number(&c->sandbox, read_file_name(c, index, &argument_path));
        if (!value->text)
            sandbox_raise_no_memory(&c->sandbox);
        return true;
    case KIND_CHOICE:
    case KIND_AXIS:
        if ((p->flags & OR_CURVE) && lua_type(L, index) != LUA_TSTRING && !lua_isfunction(L, index))
            wrong_type(c, &argument_path, "a word or a function", index);
        if ((p->flags & OR_NUMBER) && lua_type(L, index) == LUA_TNUMBER)
            value->number = read_number(c, index, &argument_path);
        else if ((p->flags & OR_CURVE) && lua_isfunction(L, index))
            value->curve = record_tone_curve(&c->sandbox, index, p->name);
        else
            value->choice = read_choice(c, index, &argument_path);
        return true;
    case KIND_COLOUR:
        if ((p->flags & (OR_PROFILE | OR_FUNCTION)) && read_function(c, index, p, value))
            return true;
        if (!display_colour_read(c, index, p, value))
            value->vector = read_vector(c, index, &argument_path);
        return true;
    case KIND_POINT:
    case KIND_DIRECTION:
    case KIND_TRIPLE:
        if ((p->flags & OR_COMPASS) && compass_read(c, index, p->name, &value->vector))
            return true;
        value->vector = read_vector(c, index, &argument_path);
        return true;
    case KIND_SIZE:
        if ((p->flags & OR_TEXTURE) && display_colour_read(c, index, p, value))
            return true;
        value->vector = lua_istable(L, index) ? read_vector(c, index, &argument_path)
                                              : vec3_all(read_number(c, index, &argument_path));
        return true;
    case KIND_INTERVAL:
        value->vector = read_interval(c, index, &argument_path);
        return true;
    case KIND_QUATERNION: {
        double q[4];
        read_row(c, index, &argument_path, 4, q);
        value->number = q[0];
        value->vector = vec3_make(q[1], q[2], q[3]);
        return true;
    }
    case KIND_PAIR:
        if (lua_istable(L, index))
            value->vector = read_pair(c, index, &argument_path);
        else
            value->vector.x = value->vector.y = read_number(c, index, &argument_path);
        return true;
    case KIND_NODE:
        value->node = read_handle(c, index, &argument_path, HANDLE_NODE);
        return value->node != NULL;
    case KIND_MATERIAL:
        value->material = read_handle(c, index, &argument_path, HANDLE_MATERIAL);
        return value->material != NULL;
    case KIND_MATERIALS:
        read_materials(c, index, argument_path, value);
        return true;
    case KIND_IMAGE:
        handle = handle_at(L, index);
        if ((p->flags & OR_SKY) && handle && handle->type == HANDLE_SKY)
            value->sky = handle->pointer;
        else if (lua_isstring(L, index))
            value->text = read_file_name(c, index, &argument_path);
        if (value->sky || value->text)
            return true;
        value->texture = read_handle(c, index, &argument_path, HANDLE_TEXTURE);
        value->image = value->texture ? image_of(value->texture) : NULL;
        if (value->texture && !value->image)
            sandbox_raise(&c->sandbox, "%s must be an image, not another texture",
                          argument_path_text(&argument_path, words));
        return value->texture != NULL;
    case KIND_BACKGROUND:
        if (read_function(c, index, p, value))
            return true;
        if (handle_at(L, index)) {
            value->sky = read_handle(c, index, &argument_path, HANDLE_SKY);
            return value->sky != NULL;
        }
        if (display_colour_read(c, index, p, value))
            return true;
        if (lua_type(L, index) != LUA_TSTRING)
            value->vector = read_vector(c, index, &argument_path);
        else if (strcmp(value->text = lua_tostring(L, index), "gradient") != 0 &&
                 strcmp(value->text, "transparent") != 0)
            sandbox_raise(&c->sandbox, "%s must be %s, not '%.100s'; %s", argument_path_text(&argument_path, words),
                          kind_words(p->kind), value->text,
                          strchr(value->text, '.') ? "gr.sky_map{image = ...} makes a sky of a picture"
                                                   : "red is {1, 0, 0} or '#ff0000'");
        return true;
    case KIND_FOG:
        value->fog = read_handle(c, index, &argument_path, HANDLE_FOG);
        return value->fog != NULL;
    case KIND_MEDIUM:
        value->material = read_handle(c, index, &argument_path, HANDLE_MEDIUM);
        return value->material != NULL;
    case KIND_CAUSTICS:
        read_caustics(c, index, &argument_path, value);
        return true;
    case KIND_NODES:
    case KIND_LIGHTS:
        read_list_of_handles(c, index, argument_path, value);
        return true;
    case KIND_POINTS: {
        uint32_t length = list_length(c, index, &argument_path);
        double(*points)[3] = context_array(c, length, sizeof *points);
        read_tuples(c, index, argument_path, 3, points[0], length);
        value->points = (const double(*)[3])points;
        value->count = length;
        return true;
    }
    case KIND_PAIRS: {
        uint32_t length = list_length(c, index, &argument_path);
        double(*pairs)[2] = context_array(c, length, sizeof *pairs);
        read_tuples(c, index, argument_path, 2, pairs[0], length);
        value->pairs = (const double(*)[2])pairs;
        value->count = length;
        return true;
    }
    case KIND_STOPS: {
        uint32_t length = list_length(c, index, &argument_path);
        double(*stops)[4] = context_array(c, length, sizeof *stops);
        read_tuples(c, index, argument_path, 4, stops[0], length);
        value->stops = (const double(*)[4])stops;
        value->count = length;
        return true;
    }
    case KIND_FACES:
        read_faces(c, index, argument_path, value);
        return true;
    case KIND_NUMBERS: {
        if ((p->flags & OR_FUNCTION) && read_function(c, index, p, value))
            return true;
        if ((p->flags & OR_FILE) && lua_type(L, index) == LUA_TSTRING) {
            value->text = read_file_name(c, index, &argument_path);
            return true;
        }
        value->single = !lua_istable(L, index);
        value->count = value->single ? 1 : list_length(c, index, &argument_path);
        double *numbers = context_array(c, value->count, sizeof *numbers);
        if (value->single)
            numbers[0] = read_number(c, index, &argument_path);
        else
            read_numbers(c, index, argument_path, numbers, value->count);
        value->numbers = numbers;
        return true;
    }
    case KIND_ROWS:
    case KIND_CURVES:
        read_rows(c, index, argument_path, p->kind == KIND_CURVES, value);
        return true;
    case KIND_FUNCTION:
        handle = handle_at(L, index);
        value->program = recorded_program(c, index, p->name, domain_of(p), &value->source);
        if (!value->program && !(handle && handle->type == HANDLE_GHOST))
            wrong_type(c, &argument_path, kind_words(p->kind), index);
        return value->program != NULL;
    case KIND_CALLBACK:
        if (!lua_isfunction(L, index))
            wrong_type(c, &argument_path, kind_words(p->kind), index);
        return true;
    case KIND_COUNT:
        break;
    }
    UNREACHABLE("a parameter of no kind");
}

/* Reads one parameter unless it is nil. False: the whole call has no effect. */
bool argument_read(struct script_context *c, int index, const struct script_parameter *p, struct script_value *value) {
    if (lua_isnoneornil(c->sandbox.lua, index))
        return true;
    if (read_value(c, index, p, value)) {
        if (c->noted)
            c->noted(c, index, p, value);
        return true;
    }
    *value = (struct script_value){0};
    return (p->flags & GHOST_IS_NONE) != 0;
}

const char *argument_read_text(struct script_context *c, int index, const struct script_parameter *p) {
    return read_text(c, index, &(struct argument_path){.parameter = p});
}

void argument_check_holes(struct script_context *c, int index, const struct script_parameter *p) {
    check_holes(c, index, &(struct argument_path){.parameter = p}, (uint32_t)lua_rawlen(c->sandbox.lua, index));
}

void argument_read_nodes(struct script_context *c, int index, const struct script_parameter *p,
                         struct script_value *value) {
    read_list_of_handles(c, index, (struct argument_path){.parameter = p}, value);
}

/* The argument types that a value can have, judged by its Lua type alone: bits. Strings that are numbers are both, a
 * ghost is any handle. */
enum {
    LIKE_NUMBER = 1 << HANDLE_TYPES,
    LIKE_BOOLEAN = LIKE_NUMBER << 1,
    LIKE_TEXT = LIKE_NUMBER << 2,
    LIKE_TABLE = LIKE_NUMBER << 3,
    LIKE_FUNCTION = LIKE_NUMBER << 4,
    LIKE_HANDLE = LIKE_NUMBER - 1, /* bit `type` for each type of handle */
};

static int kinds_of(lua_State *L, int index) {
    const struct handle *handle = handle_at(L, index);
    if (handle)
        return handle->type == HANDLE_GHOST ? LIKE_HANDLE : 1 << handle->type;
    return (lua_isnumber(L, index) ? LIKE_NUMBER : 0) | (lua_isboolean(L, index) ? LIKE_BOOLEAN : 0) |
           (lua_isstring(L, index) ? LIKE_TEXT : 0) | (lua_istable(L, index) ? LIKE_TABLE : 0) |
           (lua_isfunction(L, index) ? LIKE_FUNCTION : 0);
}

#define KIND_LIKE(kind, name, words, annotation, like) [kind] = (like),

bool argument_resembles(lua_State *L, int index, enum argument_kind kind, unsigned flags) {
    static const int wanted[] = {KIND_LIST(KIND_LIKE)};
    int accepted = wanted[kind] |
                   (flags & (OR_TEXTURE | OR_PROFILE | OR_FUNCTION) ? 1 << HANDLE_TEXTURE | LIKE_FUNCTION : 0) |
                   (flags & OR_FILE ? LIKE_TEXT : 0) | (flags & OR_CURVE ? LIKE_FUNCTION : 0) |
                   (flags & OR_PAIR ? LIKE_TABLE : 0) | (flags & OR_SKY ? 1 << HANDLE_SKY : 0);
    return (kinds_of(L, index) & accepted) != 0;
}
