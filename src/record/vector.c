/* Vectors, and the functions of gr that take numbers, vectors and symbols alike: what a pattern is written with. A
 * vector is a table {x, y, z} with a metatable, so it is also a colour or a point wherever gr takes one. A function on
 * symbols does the operations of the same function on numbers in the same order, so that their bits are equal. */
#include "record/vector.h"

#include "image/image_function.h"
#include "math/noise.h"
#include "record/record_internal.h"
#include "record/record_loop_internal.h"
#include "record/symbol.h"

#include <lauxlib.h>
#include <math.h>
#include <string.h>

static const char vector_key = 0; /* the metatable is in the registry under its address */

bool is_vector(lua_State *L, int index) {
    if (lua_type(L, index) != LUA_TTABLE || !lua_getmetatable(L, index))
        return false;
    bool same = lua_topointer(L, -1) == recorder_of(L)->vector_metatable;
    lua_pop(L, 1);
    return same;
}

void push_vector(lua_State *L) {
    lua_createtable(L, 3, 0);
    lua_insert(L, -4);
    for (int k = 3; k > 0; k--)
        lua_rawseti(L, -1 - k, k);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &vector_key);
    lua_setmetatable(L, -2);
}

static bool is_number(lua_State *L, int index) {
    return lua_type(L, index) == LUA_TNUMBER || is_symbol(L, index);
}

/* Pushes component `k` of a vector or table, or the number itself. `index` is absolute. */
static void push_component(lua_State *L, int index, int k) {
    if (lua_type(L, index) == LUA_TTABLE)
        lua_rawgeti(L, index, k);
    else
        lua_pushvalue(L, index);
    if (!is_number(L, -1))
        luaL_argerror(L, index, "a number or a vector is needed");
}

/* Pushes the three coordinates of a point that is given as a table or as numbers from `first` on. */
static int push_point(lua_State *L, int first) {
    bool is_table = lua_type(L, first) == LUA_TTABLE;
    if (!is_table && lua_gettop(L) < first + 2)
        lua_settop(L, first + 2);
    for (int k = 0; k < 3; k++)
        push_component(L, is_table ? first : first + k, k + 1);
    return is_table ? first + 1 : first + 3;
}

/* Whether one of the arguments 1 to `count`, of which there are no more, is a vector or a table. */
static bool has_vector(lua_State *L, int count) {
    bool found = false;
    lua_settop(L, count);
    for (int i = 1; i <= count; i++)
        found = found || lua_type(L, i) == LUA_TTABLE;
    return found;
}

/* The function on each component of the arguments 1 to `count`; of numbers alone, on them. It replaces that many values
 * on top by one. */
static int by_components(lua_State *L, int count, void (*function)(lua_State *L)) {
    bool is_of_vectors = has_vector(L, count);
    for (int k = 1; k <= (is_of_vectors ? 3 : 1); k++) {
        for (int i = 1; i <= count; i++)
            push_component(L, i, k);
        function(L);
    }
    if (is_of_vectors)
        push_vector(L);
    return 1;
}

/* --- operators --- */

int vector_arithmetic(lua_State *L, int operator) {
    int count = operator== LUA_OPUNM ? 1 : 2;
    lua_settop(L, count);
    for (int k = 1; k <= 3; k++) {
        for (int i = 1; i <= count; i++)
            push_component(L, i, k);
        lua_arith(L, operator);
    }
    push_vector(L);
    return 1;
}

#define OPERATOR(name, operator)                                                                                       \
    static int vector_##name(lua_State *L) {                                                                           \
        return vector_arithmetic(L, operator);                                                                         \
    }
OPERATOR(add, LUA_OPADD)
OPERATOR(subtract, LUA_OPSUB)
OPERATOR(multiply, LUA_OPMUL)
OPERATOR(divide, LUA_OPDIV)
OPERATOR(floor_divide, LUA_OPIDIV)
OPERATOR(modulo, LUA_OPMOD)
OPERATOR(power, LUA_OPPOW)
OPERATOR(negate, LUA_OPUNM)

/* v.x and v.r are v[1], and so on; other names are methods (upvalue 1). */
static int vector_index(lua_State *L) {
    static const char names[] = "xyzrgb";
    const char *key = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
    const char *found = key[0] && !key[1] ? strchr(names, key[0]) : NULL;
    if (found) {
        lua_rawgeti(L, 1, (found - names) % 3 + 1);
        return 1;
    }
    lua_pushvalue(L, 2);
    lua_rawget(L, lua_upvalueindex(1));
    return 1;
}

static int vector_set(lua_State *L) {
    return luaL_error(L, "the fields of a vector cannot be set; make another vector with gr.vec(x, y, z)");
}

static int vector_equal(lua_State *L) {
    for (int k = 1; k <= 3; k++) {
        lua_rawgeti(L, 1, k);
        lua_rawgeti(L, 2, k);
        if (!lua_compare(L, -1, -2, LUA_OPEQ)) {
            lua_pushboolean(L, 0);
            return 1;
        }
        lua_pop(L, 2);
    }
    lua_pushboolean(L, 1);
    return 1;
}

static int vector_text(lua_State *L) {
    luaL_Buffer buffer;
    lua_settop(L, 1);
    luaL_buffinit(L, &buffer);
    for (int k = 1; k <= 3; k++) {
        luaL_addstring(&buffer, k == 1 ? "{" : ", ");
        lua_rawgeti(L, 1, k);
        (void)luaL_tolstring(L, -1, NULL);
        lua_remove(L, -2);
        luaL_addvalue(&buffer);
    }
    luaL_addstring(&buffer, "}");
    luaL_pushresult(&buffer);
    return 1;
}

/* --- vectors --- */

static int make_vector(lua_State *L) {
    if (lua_gettop(L) == 1 && is_number(L, 1)) {
        lua_pushvalue(L, 1);
        lua_pushvalue(L, 1);
    }
    if (lua_gettop(L) > 1 && lua_type(L, 1) == LUA_TTABLE)
        return luaL_error(L,
                          "gr.vec takes three numbers or one vector; the first of %d arguments is a vector, as is the "
                          "point that a function of a material gets",
                          lua_gettop(L));
    (void)push_point(L, 1);
    push_vector(L);
    return 1;
}

/* Pushes a[i] * b[j] of the vectors 1 and 2. */
static void push_product(lua_State *L, int i, int j) {
    push_component(L, 1, i);
    push_component(L, 2, j);
    lua_arith(L, LUA_OPMUL);
}

static int dot(lua_State *L) {
    lua_settop(L, 2);
    push_product(L, 1, 1);
    push_product(L, 2, 2);
    lua_arith(L, LUA_OPADD);
    push_product(L, 3, 3);
    lua_arith(L, LUA_OPADD);
    return 1;
}

static int cross(lua_State *L) {
    lua_settop(L, 2);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3 + 1, j = (k + 2) % 3 + 1;
        push_product(L, i, j);
        push_product(L, j, i);
        lua_arith(L, LUA_OPSUB);
    }
    push_vector(L);
    return 1;
}

static int length(lua_State *L) {
    lua_settop(L, 1);
    lua_pushvalue(L, 1);
    (void)dot(L);
    if (is_symbol(L, -1)) {
        uint32_t square = number_float(recorder_of(L), number_at(L, -1));
        push_symbol(
            L, (struct number){NUMBER_FLOAT, record_operation(L, EXPR_SQRT, square, EXPR_NONE, EXPR_NONE), EXPR_NONE});
    } else {
        lua_pushnumber(L, sqrt(lua_tonumber(L, -1)));
    }
    return 1;
}

static int normalize(lua_State *L) {
    (void)length(L);
    lua_replace(L, 2);
    return vector_divide(L);
}

/* --- blends --- */

/* a, b, t: a + (b - a) t */
static void mix_numbers(lua_State *L) {
    lua_insert(L, -2);
    lua_pushvalue(L, -3);
    lua_arith(L, LUA_OPSUB);
    lua_arith(L, LUA_OPMUL);
    lua_arith(L, LUA_OPADD);
}

static void min_numbers(lua_State *L) {
    push_extreme(L, false);
}

static void max_numbers(lua_State *L) {
    push_extreme(L, true);
}

/* x, low, high */
static void clamp_numbers(lua_State *L) {
    lua_insert(L, -3);
    push_extreme(L, true);
    lua_insert(L, -2);
    push_extreme(L, false);
}

/* low, high, x: t^2 (3 - 2 t) of t = (x - low) / (high - low) within 0..1 */
static void smoothstep_numbers(lua_State *L) {
    lua_pushvalue(L, -3);
    lua_arith(L, LUA_OPSUB); /* low, high, x - low */
    lua_insert(L, -3);
    lua_insert(L, -2); /* x - low, high, low */
    lua_arith(L, LUA_OPSUB);
    lua_arith(L, LUA_OPDIV);
    lua_pushnumber(L, 0);
    lua_pushnumber(L, 1);
    clamp_numbers(L);
    lua_pushvalue(L, -1);
    lua_pushvalue(L, -1);
    lua_arith(L, LUA_OPMUL); /* t, t^2 */
    lua_insert(L, -2);
    lua_pushnumber(L, 2);
    lua_arith(L, LUA_OPMUL);
    lua_pushnumber(L, 3);
    lua_insert(L, -2);
    lua_arith(L, LUA_OPSUB);
    lua_arith(L, LUA_OPMUL);
}

static uint32_t pop_float(lua_State *L) {
    uint32_t node = number_float(recorder_of(L), number_at(L, -1));
    lua_pop(L, 1);
    return node;
}

static uint32_t float_node(lua_State *L, double x) {
    lua_pushnumber(L, x);
    return pop_float(L);
}

/* edge, x: 0 where x < edge, else 1 */
static void step_numbers(lua_State *L) {
    if (!is_symbol(L, -1) && !is_symbol(L, -2)) {
        bool below = lua_compare(L, -1, -2, LUA_OPLT);
        lua_pop(L, 2);
        lua_pushnumber(L, below ? 0 : 1);
        return;
    }
    uint32_t x = pop_float(L), edge = pop_float(L);
    uint32_t below = record_operation(L, EXPR_LESS, x, edge, EXPR_NONE);
    uint32_t out = record_operation(L, EXPR_SELECT, below, float_node(L, 0), float_node(L, 1));
    push_symbol(L, (struct number){NUMBER_FLOAT, out, EXPR_NONE});
}

static int mix(lua_State *L) {
    return by_components(L, 3, mix_numbers);
}

static int clamp(lua_State *L) {
    return by_components(L, 3, clamp_numbers);
}

static int smoothstep(lua_State *L) {
    return by_components(L, 3, smoothstep_numbers);
}

static int step(lua_State *L) {
    return by_components(L, 2, step_numbers);
}

static int two_min(lua_State *L) {
    return by_components(L, 2, min_numbers);
}

static int two_max(lua_State *L) {
    return by_components(L, 2, max_numbers);
}

/* --- choices --- */

/* Pushes a where the condition holds, else b: numbers or vectors at absolute indices. */
static void push_select(lua_State *L, uint32_t condition, int a, int b) {
    bool has_vector = lua_type(L, a) == LUA_TTABLE || lua_type(L, b) == LUA_TTABLE;
    for (int k = 1; k <= (has_vector ? 3 : 1); k++) {
        push_component(L, a, k);
        push_component(L, b, k);
        struct number x = number_at(L, -2), y = number_at(L, -1);
        if (x.type != NUMBER_FLOAT && y.type != NUMBER_FLOAT) { /* an integer where both are */
            x = record_settled(L, x);
            y = record_settled(L, y);
        }
        struct number out = record_select(L, condition, x, y);
        lua_pop(L, 2);
        push_symbol(L, out);
    }
    if (has_vector)
        push_vector(L);
}

/* The node of `x > 0` of the symbol on top. */
static uint32_t is_positive(lua_State *L, int index) {
    uint32_t x = number_float(recorder_of(L), number_at(L, index));
    return record_operation(L, EXPR_LESS, float_node(L, 0), x, EXPR_NONE);
}

/* A table of three numbers on top becomes a vector, as it does where a symbol chooses. */
static void make_top_vector(lua_State *L) {
    int top = lua_gettop(L);
    if (lua_type(L, top) != LUA_TTABLE || lua_rawlen(L, top) != 3 || is_vector(L, top))
        return;
    for (int k = 1; k <= 3; k++) {
        lua_rawgeti(L, top, k);
        if (!is_number(L, -1)) {
            lua_settop(L, top);
            return;
        }
    }
    push_vector(L);
    lua_replace(L, top);
}

/* What a function chooses among: numbers and vectors. */
struct options {
    bool are_fine, has_vector, has_symbol;
    bool is_integer[3]; /* each component: the same one of all options is an integer */
};

/* Adds the value on top. */
static void add_option(lua_State *L, struct options *options) {
    int top = lua_gettop(L);
    bool is_table = lua_type(L, top) == LUA_TTABLE;
    options->are_fine = options->are_fine && (is_table ? lua_rawlen(L, top) == 3 : is_number(L, top));
    options->has_vector = options->has_vector || is_table;
    for (int k = 0; options->are_fine && k < 3; k++) {
        if (is_table)
            lua_rawgeti(L, top, k + 1);
        options->are_fine = is_number(L, -1);
        options->has_symbol = options->has_symbol || is_symbol(L, -1);
        options->is_integer[k] = options->is_integer[k] && lua_isinteger(L, -1);
        lua_settop(L, top);
    }
}

/* Replaces the option on top, without symbols, by what is chosen: a vector if one of all options is a vector. */
static void make_top_chosen(lua_State *L, const struct options *options) {
    int top = lua_gettop(L);
    for (int k = 0; k < (options->has_vector ? 3 : 1); k++) {
        push_component(L, top, k + 1);
        if (options->is_integer[k])
            continue;
        lua_pushnumber(L, lua_tonumber(L, -1));
        lua_remove(L, -2);
    }
    if (options->has_vector)
        push_vector(L);
    lua_replace(L, top);
}

/* where(x, a, b): a where x > 0, else b; an integer only where both are. */
static int where(lua_State *L) {
    struct options options = {.are_fine = true, .is_integer = {true, true, true}};
    lua_settop(L, 3);
    for (int k = 2; k <= 3; k++) {
        lua_pushvalue(L, k);
        add_option(L, &options);
        lua_pop(L, 1);
    }
    if (is_symbol(L, 1)) {
        push_select(L, is_positive(L, 1), 2, 3);
        return 1;
    }
    bool positive = luaL_checknumber(L, 1) > 0;
    if (options.are_fine && options.has_symbol) {
        push_select(L, record_node(L, expr_truth(&recorder_of(L)->graph, positive)), 2, 3);
        return 1;
    }
    lua_pushvalue(L, positive ? 2 : 3);
    if (options.are_fine)
        make_top_chosen(L, &options);
    return 1;
}

/* Pushes entry 1 to n of the table 1 that is chosen by the symbol 2, from those between first and last. */
static void push_entry(lua_State *L, uint32_t i, int first, int last) {
    if (first == last) {
        lua_rawgeti(L, 1, first);
        return;
    }
    int middle = first + (last - first) / 2;
    luaL_checkstack(L, 8, "a table");
    uint32_t condition = record_operation(L, EXPR_LESS, i, float_node(L, middle + 1), EXPR_NONE);
    push_entry(L, i, first, middle);
    push_entry(L, i, middle + 1, last);
    int top = lua_gettop(L);
    push_select(L, condition, top - 1, top);
    lua_replace(L, top - 1);
    lua_settop(L, top - 1);
}

/* lookup(t, i): t[i], i rounded down and kept between 1 and #t; an integer only where all entries are. */
static int lookup(lua_State *L) {
    struct options options = {.are_fine = true, .is_integer = {true, true, true}};
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_settop(L, 2);
    lua_Unsigned count = lua_rawlen(L, 1);
    luaL_argcheck(L, count > 0 && count <= RECORD_LOOP, 1, "a table of 1 to 10000 entries is needed");
    for (lua_Unsigned k = 1; k <= count; k++) {
        lua_rawgeti(L, 1, (lua_Integer)k);
        add_option(L, &options);
        luaL_argcheck(L, options.are_fine, 1, "entries must be numbers or vectors");
        lua_pop(L, 1);
    }
    double i = is_symbol(L, 2) ? 0 : luaL_checknumber(L, 2);
    if (is_symbol(L, 2) || options.has_symbol) {
        push_entry(L, number_float(recorder_of(L), number_at(L, 2)), 1, (int)count);
        make_top_vector(L);
        return 1;
    }
    lua_rawgeti(L, 1, !(i < (double)count) ? (lua_Integer)count : i < 2 ? 1 : (lua_Integer)floor(i));
    make_top_chosen(L, &options);
    return 1;
}

/* --- noise --- */

/* Whether one of the three values on top is a symbol; else they are numbers, given out. */
static bool point_is_recorded(lua_State *L, double p[3]) {
    bool recorded = false;
    for (int k = 0; k < 3; k++) {
        recorded = recorded || is_symbol(L, -3 + k);
        p[k] = lua_tonumber(L, -3 + k);
    }
    return recorded;
}

static void point_nodes(lua_State *L, uint32_t nodes[3]) {
    for (int k = 0; k < 3; k++)
        nodes[k] = number_float(recorder_of(L), number_at(L, -3 + k));
}

static int of_point(lua_State *L, const enum expr_operation *operations, int count) {
    double p[3];
    uint32_t nodes[3] = {EXPR_NONE, EXPR_NONE, EXPR_NONE};
    (void)push_point(L, 1);
    bool recorded = point_is_recorded(L, p);
    if (recorded)
        point_nodes(L, nodes);
    for (int k = 0; k < count; k++) {
        if (recorded)
            push_symbol(L,
                        (struct number){NUMBER_FLOAT, record_operation(L, operations[k], nodes[0], nodes[1], nodes[2]),
                                        EXPR_NONE});
        else
            lua_pushnumber(L, expr_apply(operations[k], (union expr_value){.f = p[0]}, (union expr_value){.f = p[1]},
                                         (union expr_value){.f = p[2]})
                                  .f);
    }
    return count;
}

static int noise(lua_State *L) {
    return of_point(L, (const enum expr_operation[]){EXPR_NOISE}, 1);
}

static int hash(lua_State *L) {
    return of_point(L, (const enum expr_operation[]){EXPR_HASH}, 1);
}

static int cells(lua_State *L) {
    return of_point(L, (const enum expr_operation[]){EXPR_CELL_NEAREST, EXPR_CELL_SECOND, EXPR_CELL_ID}, 3);
}

/* turbulence(p, octaves): the sum of |noise(2^k p)| / 2^k for k from 0 on. */
static int turbulence(lua_State *L) {
    /* The arguments. */
    int next = push_point(L, 1) - 1, top = lua_gettop(L);
    bool has_octaves = next + 1 <= top - 3;
    lua_Integer octaves = has_octaves ? luaL_checkinteger(L, next + 1) : 4;
    luaL_argcheck(L, octaves >= 1 && octaves <= 32, next + 1, "a constant number of octaves up to 32 is needed");
    double p[3], sum = 0, scale = 1;
    uint32_t nodes[3], total;
    /* A point of numbers. */
    if (!point_is_recorded(L, p)) {
        for (lua_Integer k = 0; k < octaves; k++, scale *= 2)
            sum = sum + fabs(noise_perlin(scale * p[0], scale * p[1], scale * p[2], 0)) / scale;
        lua_pushnumber(L, sum);
        return 1;
    }
    /* A recorded point: the operations of the same sum. */
    point_nodes(L, nodes);
    total = float_node(L, 0);
    for (lua_Integer k = 0; k < octaves; k++, scale *= 2) {
        uint32_t factor = float_node(L, scale), at[3];
        for (int i = 0; i < 3; i++)
            at[i] = record_operation(L, EXPR_MULTIPLY, factor, nodes[i], EXPR_NONE);
        uint32_t octave = record_operation(L, EXPR_NOISE, at[0], at[1], at[2]);
        octave = record_operation(L, EXPR_ABS, octave, EXPR_NONE, EXPR_NONE);
        octave = record_operation(L, EXPR_DIVIDE, octave, factor, EXPR_NONE);
        total = record_operation(L, EXPR_ADD, total, octave, EXPR_NONE);
    }
    push_symbol(L, (struct number){NUMBER_FLOAT, total, EXPR_NONE});
    return 1;
}

/* --- pictures --- */

int push_image_value(lua_State *L, const struct image_function *function) {
    double values[TEXEL_CHANNELS];
    lua_settop(L, 3);
    for (int k = 2; k <= 3; k++)
        if (!is_number(L, k))
            return luaL_error(L, "img:at needs two numbers u and v, not %s", value_words(L, k));
    if (!is_symbol(L, 2) && !is_symbol(L, 3)) {
        for (int k = 0; k < TEXEL_CHANNELS; k++)
            values[k] = image_function_value(function, lua_tonumber(L, 2), lua_tonumber(L, 3), k);
        for (int k = 0; k < TEXEL_CHANNELS; k++)
            lua_pushnumber(L, values[k]);
    } else {
        struct recorder *recorder = recorder_of(L);
        uint32_t u = number_float(recorder, number_at(L, 2)), v = number_float(recorder, number_at(L, 3));
        for (int k = 0; k < TEXEL_CHANNELS; k++) {
            uint32_t operand = record_node(L, expr_integer(&recorder->graph, expr_texel_operand(function, k)));
            uint32_t texel = record_operation(L, EXPR_TEXEL, u, v, operand);
            push_symbol(L, (struct number){NUMBER_FLOAT, texel, EXPR_NONE});
        }
    }
    lua_insert(L, 4); /* alpha below the colour */
    push_vector(L);
    lua_insert(L, 4);
    return 2;
}

/* Combines any number of arguments, from the left. */
static int all_of(lua_State *L, lua_CFunction of_two) {
    luaL_checkany(L, 1);
    for (int k = 2, count = lua_gettop(L); k <= count; k++) {
        lua_pushcfunction(L, of_two);
        lua_pushvalue(L, 1);
        lua_pushvalue(L, k);
        lua_call(L, 2, 1);
        lua_replace(L, 1);
    }
    lua_settop(L, 1);
    return 1;
}

static int min_of_all(lua_State *L) {
    return all_of(L, two_min);
}

static int max_of_all(lua_State *L) {
    return all_of(L, two_max);
}

static const struct value_function functions[] = {
    {"vec", "x, y, z", "A vector: a table {x, y, z} with operators. One number becomes all three components.",
     "gr.vector", make_vector},
    {"dot", "a, b", "The scalar product of two vectors.", "number", dot},
    {"cross", "a, b", "The vector product of two vectors.", "gr.vector", cross},
    {"length", "v", "The length of a vector.", "number", length},
    {"normalize", "v", "The vector divided by its length.", "gr.vector", normalize},
    {"mix", "a, b, t", "a + (b - a) * t, of numbers or vectors.", "any", mix},
    {"clamp", "x, low, high", "x clamped to low..high; vectors by components.", "any", clamp},
    {"smoothstep", "low, high, x", "0 below low, 1 above high, smooth between them.", "any", smoothstep},
    {"step", "edge, x", "0 where x < edge, else 1.", "any", step},
    {"min", "...", "The minimum of numbers or vectors, by components.", "any", min_of_all},
    {"max", "...", "The maximum of numbers or vectors, by components.", "any", max_of_all},
    {"where", "x, a, b", "a where x > 0, else b: a choice without a branch.", "any", where},
    {"lookup", "t, i", "Entry i of a table of numbers or vectors; i is rounded down and clamped to 1..#t.", "any",
     lookup},
    {"loop", "n, ...", "Replaces the state s1, s2, ... by f(i, s1, s2, ...) for i = 1 to n while s1 > 0; f is last.",
     "any ...", record_loop},
    {"noise", "p", "Perlin noise at a point, or at x, y, z: about -1..1.", "number", noise},
    {"turbulence", "p, octaves", "The sum of |noise(2^k p)| / 2^k for octaves (4) values of k from 0 on.", "number",
     turbulence},
    {"cells", "p",
     "Distances to the nearest and the second nearest of random points, and a number in 0..1 that identifies the "
     "nearest.",
     "number, number, number", cells},
    {"hash", "p", "A random number in 0..1 for each point.", "number", hash},
};
const struct value_functions vector_functions = {functions, sizeof functions / sizeof functions[0]};

void vectors_open(lua_State *L) {
    static const luaL_Reg operators[] = {
        {"__add", vector_add},       {"__sub", vector_subtract},      {"__mul", vector_multiply},
        {"__div", vector_divide},    {"__idiv", vector_floor_divide}, {"__mod", vector_modulo},
        {"__pow", vector_power},     {"__unm", vector_negate},        {"__eq", vector_equal},
        {"__tostring", vector_text}, {"__newindex", vector_set},      {NULL, NULL}};
    static const luaL_Reg methods[] = {{"dot", dot}, {"cross", cross}, {"length", length}, {"normalize", normalize},
                                       {"mix", mix}, {"clamp", clamp}, {NULL, NULL}};
    lua_newtable(L);
    luaL_setfuncs(L, operators, 0);
    lua_newtable(L);
    luaL_setfuncs(L, methods, 0);
    lua_pushcclosure(L, vector_index, 1);
    lua_setfield(L, -2, "__index");
    lua_pushliteral(L, "vector");
    lua_setfield(L, -2, "__name");
    lua_pushboolean(L, 0);
    lua_setfield(L, -2, "__metatable");
    recorder_of(L)->vector_metatable = lua_topointer(L, -1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &vector_key);
}
