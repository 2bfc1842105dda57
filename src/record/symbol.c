/* Symbols: numbers that a recording does not know yet. Their operators follow section 3.4 of Lua's reference manual:
 * two integers give an integer, / and ^ give floats, anything else is done in floats; comparisons of an integer with a
 * float are exact. What Lua decides by a value (whether a float has an integer value, which of two numbers math.max
 * returns) becomes a decision of the path, or a selection. */
#include "record/symbol.h"

#include "record/record_interval_internal.h"
#include "sandbox/protect.h"

#include <lauxlib.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char symbol_key = 0; /* the metatable is in the registry under its address */

/* The userdata. */
struct symbol {
    uint32_t serial;
    struct number number;
};

static bool has_metatable(lua_State *L, int index, const void *metatable) {
    if (!lua_getmetatable(L, index))
        return false;
    bool same = lua_topointer(L, -1) == metatable;
    lua_pop(L, 1);
    return same;
}

bool is_symbol(lua_State *L, int index) {
    return lua_type(L, index) == LUA_TUSERDATA && has_metatable(L, index, recorder_of(L)->symbol_metatable);
}

void push_symbol(lua_State *L, struct number number) {
    const struct recorder *recorder = recorder_of(L);
    number.node = record_node(L, number.node);
    const union expr_value *constant = expr_constant(&recorder->graph, number.node);
    if (constant && number.type == NUMBER_FLOAT) {
        lua_pushnumber(L, constant->f);
        return;
    }
    if (constant && number.type == NUMBER_INTEGER) {
        lua_pushinteger(L, constant->i);
        return;
    }
    recorder_of(L)->work++;
    struct symbol *symbol = lua_newuserdatauv(L, sizeof *symbol, 0);
    *symbol = (struct symbol){.serial = recorder->serial, .number = number};
    lua_rawgetp(L, LUA_REGISTRYINDEX, &symbol_key);
    lua_setmetatable(L, -2);
}

void record_give_up(lua_State *L, const char *format, ...) {
    struct recorder *recorder = recorder_of(L);
    va_list arguments;
    sandbox_of(L)->lua = L;
    sandbox_where(sandbox_of(L), recorder->error, PATH_SIZE + 32);
    size_t used = strlen(recorder->error);
    va_start(arguments, format);
    (void)vsnprintf(recorder->error + used, sizeof recorder->error - used, format, arguments);
    va_end(arguments);
    recorder->gave_up = true;
    lua_pushstring(L, recorder->error);
    lua_error(L);
    __builtin_unreachable();
}

uint32_t record_node(lua_State *L, uint32_t node) {
    const struct recorder *recorder = recorder_of(L);
    if (node != EXPR_NONE)
        return node;
    if (recorder->graph.out_of_memory) {
        sandbox_of(L)->lua = L;
        sandbox_raise_no_memory(sandbox_of(L));
    }
    record_give_up(L,
                   "the function has more than %d operations; gr.where, gr.step, gr.min and gr.max need one operation "
                   "where branches need many, and gr.loop(n, state, f) records one step for all",
                   EXPR_NODES);
}

uint32_t record_operation(lua_State *L, enum expr_operation operation, uint32_t a, uint32_t b, uint32_t c) {
    return record_node(L, expr_operation(&recorder_of(L)->graph, operation, a, b, c));
}

struct number number_at(lua_State *L, int index) {
    struct recorder *recorder = recorder_of(L);
    if (lua_type(L, index) == LUA_TNUMBER) {
        if (lua_isinteger(L, index))
            return (struct number){NUMBER_INTEGER,
                                   record_node(L, expr_integer(&recorder->graph, lua_tointeger(L, index))), EXPR_NONE};
        return (struct number){NUMBER_FLOAT, record_node(L, expr_float(&recorder->graph, lua_tonumber(L, index))),
                               EXPR_NONE};
    }
    if (!is_symbol(L, index))
        luaL_error(L, "an operator on a number of the recorded function needs another number, not %s",
                   value_words(L, index));
    const struct symbol *symbol = lua_touserdata(L, index);
    if (!recorder->active || symbol->serial != recorder->serial)
        luaL_error(L, "a number of a recorded function is used outside the function");
    if (recorder->graph.nodes[symbol->number.node].depth > recorder->loop_depth)
        luaL_error(L, "a number of a step of gr.loop is used outside the step");
    return symbol->number;
}

static const struct expr_node *node_of(const struct recorder *recorder, uint32_t node) {
    return &recorder->graph.nodes[node];
}

/* The float of an integer from math.floor or math.ceil is the result of the C function. Lua returns a float where no
 * integer is large enough, and never -0. */
uint32_t number_float(struct recorder *recorder, struct number number) {
    struct expr_graph *graph = &recorder->graph;
    if (number.type != NUMBER_INTEGER || number.node == EXPR_NONE)
        return number.node;
    const struct expr_node *node = node_of(recorder, number.node);
    if (node->operation == EXPR_TO_INTEGER) {
        uint32_t whole = node->operands[0];
        enum expr_operation operation = node_of(recorder, whole)->operation;
        if (operation == EXPR_FLOOR || operation == EXPR_CEIL)
            return expr_operation(graph, EXPR_ADD, whole, expr_float(graph, 0), EXPR_NONE);
    }
    return expr_operation(graph, EXPR_TO_FLOAT, number.node, EXPR_NONE, EXPR_NONE);
}

static uint32_t float_of(lua_State *L, struct number number) {
    return record_node(L, number_float(recorder_of(L), number));
}

static struct number make_float(uint32_t node) {
    return (struct number){NUMBER_FLOAT, node, EXPR_NONE};
}

static struct number make_integer(uint32_t node) {
    return (struct number){NUMBER_INTEGER, node, EXPR_NONE};
}

/* --- decisions --- */

/* On this path, or on a path of the calls around it. */
static int known_answer(const struct recorder *recorder, uint32_t condition) {
    const struct known_answer *known = &recorder->answers[condition];
    const struct record_frame *frame = &recorder->frames[known->level];
    if (known->serial == 0 || known->level > recorder->level || known->index > frame->taken)
        return -1;
    uint32_t serial = known->index > 0 ? frame->decisions[known->index - 1].serial : frame->serial;
    return known->serial == serial ? known->answer : -1;
}

/* On this path, from here on. */
static void know_answer(struct recorder *recorder, uint32_t condition, bool answer) {
    const struct record_frame *frame = &recorder->frames[recorder->level];
    uint32_t serial = frame->taken > 0 ? frame->decisions[frame->taken - 1].serial : frame->serial;
    recorder->answers[condition] = (struct known_answer){serial, frame->taken, (uint8_t)recorder->level, answer};
}

/* What follows from the decisions of the path: a < b excludes b < a and b <= a, and includes a <= b; -1 if nothing. */
static int implied_answer(lua_State *L, uint32_t condition) {
    struct recorder *recorder = recorder_of(L);
    const struct expr_node *node = node_of(recorder, condition);
    uint32_t a = node->operands[0], b = node->operands[1];
    bool is_less = node->operation == EXPR_LESS || node->operation == EXPR_INTEGER_LESS;
    bool is_integer = node->operation == EXPR_INTEGER_LESS || node->operation == EXPR_INTEGER_LESS_EQUAL;
    if (!is_less && node->operation != EXPR_LESS_EQUAL && node->operation != EXPR_INTEGER_LESS_EQUAL)
        return -1;
    enum expr_operation less = is_integer ? EXPR_INTEGER_LESS : EXPR_LESS;
    enum expr_operation less_equal = is_integer ? EXPR_INTEGER_LESS_EQUAL : EXPR_LESS_EQUAL;
    if (known_answer(recorder, record_operation(L, less, b, a, EXPR_NONE)) == 1)
        return 0;
    if (is_less)
        return known_answer(recorder, record_operation(L, less_equal, b, a, EXPR_NONE)) == 1 ? 0 : -1;
    return known_answer(recorder, record_operation(L, less, a, b, EXPR_NONE)) == 1 ? 1 : -1;
}

struct record_frame *record_begin_paths(lua_State *L) {
    struct recorder *recorder = recorder_of(L);
    if (recorder->level + 1 == RECORD_LEVELS)
        record_give_up(L, "loops of gr.loop are %d deep in each other; %d may be", RECORD_LEVELS, RECORD_LEVELS - 1);
    struct record_frame *frame = &recorder->frames[recorder->level + 1];
    if (!frame->decisions)
        frame->decisions = mem_alloc_zero(RECORD_PATHS, sizeof *frame->decisions);
    if (!frame->decisions)
        sandbox_raise_no_memory(sandbox_of(L));
    frame->depth = frame->taken = frame->branches = 0;
    frame->serial = ++recorder->decision_serial;
    recorder->level++;
    return frame;
}

void record_begin_path(lua_State *L) {
    struct recorder *recorder = recorder_of(L);
    struct record_frame *frame = &recorder->frames[recorder->level];
    if (recorder->calls == RECORD_CALLS)
        record_give_up(L, "the function and the steps of its loops have more than %d paths together", RECORD_CALLS);
    frame->taken = 0;
    frame->is_first = frame->depth == 0;
    frame->path = ++recorder->calls;
}

void record_turn_last(struct recorder *recorder) {
    struct record_frame *frame = &recorder->frames[recorder->level];
    struct decision *last = &frame->decisions[frame->depth - 1];
    last->answer = last->is_narrowed = false;
    last->serial = ++recorder->decision_serial;
}

void record_end_paths(struct recorder *recorder) {
    recorder->level--;
}

bool record_decide(lua_State *L, uint32_t condition) {
    struct recorder *recorder = recorder_of(L);
    struct record_frame *frame = &recorder->frames[recorder->level];
    /* A constant, a condition decided before, or one that follows from those. */
    const union expr_value *constant = expr_constant(&recorder->graph, condition);
    if (constant)
        return constant->i != 0;
    int answer = known_answer(recorder, condition);
    bool is_repeated = frame->taken < frame->depth && frame->decisions[frame->taken].condition == condition;
    if (answer < 0 && !is_repeated) {
        answer = implied_answer(L, condition);
        if (answer < 0)
            answer = record_interval_prove(recorder, condition);
        if (answer >= 0)
            know_answer(recorder, condition, answer == 1);
    }
    if (answer >= 0)
        return answer == 1;
    /* The limit of branches. */
    if (frame->taken == RECORD_PATHS)
        record_give_up(L,
                       "a call of the function branches more than %d times on its arguments; for a loop with a "
                       "constant number of steps use gr.loop(n, state, f)",
                       RECORD_PATHS);
    /* A new decision is added; one of an earlier call is repeated. */
    struct decision *decision = &frame->decisions[frame->taken++];
    if (frame->taken > frame->depth) {
        bool preferred = recorder->level > 0 || !recorder->prefers_false;
        *decision =
            (struct decision){.condition = condition, .serial = ++recorder->decision_serial, .answer = preferred};
        frame->depth = frame->taken;
        frame->branches++;
    } else if (decision->condition != condition) {
        record_give_up(L, "the function is not pure: a second call with the same arguments took another branch");
    }
    /* The bounds of what the condition depends on become narrower. */
    know_answer(recorder, condition, decision->answer);
    if (!record_interval_narrow(recorder, decision)) {
        sandbox_of(L)->lua = L;
        sandbox_raise_no_memory(sandbox_of(L));
    }
    return decision->answer;
}

struct number record_select(lua_State *L, uint32_t condition, struct number a, struct number b) {
    if (a.type == NUMBER_INTEGER && b.type == NUMBER_INTEGER)
        return make_integer(record_operation(L, EXPR_INTEGER_SELECT, condition, a.node, b.node));
    return make_float(record_operation(L, EXPR_SELECT, condition, float_of(L, a), float_of(L, b)));
}

struct number record_settled(lua_State *L, struct number number) {
    if (number.type != NUMBER_EITHER)
        return number;
    if (!record_decide(L, number.is_integer))
        return make_float(number.node);
    return make_integer(record_operation(L, EXPR_TO_INTEGER, number.node, EXPR_NONE, EXPR_NONE));
}

/* As an operand of a bitwise operator. */
static uint32_t integer_of(lua_State *L, struct number number) {
    if (number.type == NUMBER_INTEGER)
        return number.node;
    if (!record_decide(L, record_operation(L, EXPR_WHOLE, number.node, EXPR_NONE, EXPR_NONE)))
        luaL_error(L, "number has no integer representation");
    return record_operation(L, EXPR_TO_INTEGER, number.node, EXPR_NONE, EXPR_NONE);
}

/* --- operators --- */

static int give(lua_State *L, struct number number) {
    push_symbol(L, number);
    return 1;
}

/* Both as integers, or both as floats: true. */
static bool are_floats(lua_State *L, struct number *a, struct number *b) {
    bool is_float = a->type == NUMBER_FLOAT || b->type == NUMBER_FLOAT;
    if (!is_float) {
        *a = record_settled(L, *a);
        *b = record_settled(L, *b);
        is_float = a->type == NUMBER_FLOAT || b->type == NUMBER_FLOAT;
    }
    if (is_float) {
        *a = make_float(float_of(L, *a));
        *b = make_float(float_of(L, *b));
    }
    return is_float;
}

static void refuse_zero(lua_State *L, struct number divisor, const char *message) {
    uint32_t zero = record_node(L, expr_integer(&recorder_of(L)->graph, 0));
    if (record_decide(L, record_operation(L, EXPR_INTEGER_EQUAL, divisor.node, zero, EXPR_NONE)))
        luaL_error(L, message);
}

/* A symbol in front of a table for which the script defines this operator: as for a number, the table's is called. */
static bool by_operator_of_table(lua_State *L, const char *event) {
    lua_settop(L, 2);
    if (lua_type(L, 2) != LUA_TTABLE || luaL_getmetafield(L, 2, event) == LUA_TNIL)
        return false;
    if (lua_iscfunction(L, -1)) { /* of a vector */
        lua_pop(L, 1);
        return false;
    }
    lua_insert(L, 1);
    lua_call(L, 2, 1);
    return true;
}

/* A symbol in front of a table, which is a vector unless it has its own operator. */
static int by_table(lua_State *L, int operator) {
    static const char *const events[] = {
        [LUA_OPADD] = "__add", [LUA_OPSUB] = "__sub", [LUA_OPMUL] = "__mul",  [LUA_OPMOD] = "__mod",
        [LUA_OPPOW] = "__pow", [LUA_OPDIV] = "__div", [LUA_OPIDIV] = "__idiv"};
    return by_operator_of_table(L, events[operator]) ? 1 : vector_arithmetic(L, operator);
}

static int arithmetic(lua_State *L, int operator, enum expr_operation of_floats, enum expr_operation of_integers) {
    if (lua_type(L, 2) == LUA_TTABLE)
        return by_table(L, operator);
    struct number a = number_at(L, 1), b = number_at(L, 2);
    if (are_floats(L, &a, &b))
        return give(L, make_float(record_operation(L, of_floats, a.node, b.node, EXPR_NONE)));
    if (of_integers == EXPR_INTEGER_DIVIDE)
        refuse_zero(L, b, "attempt to divide by zero");
    if (of_integers == EXPR_INTEGER_MODULO)
        refuse_zero(L, b, "attempt to perform 'n%%0'");
    return give(L, make_integer(record_operation(L, of_integers, a.node, b.node, EXPR_NONE)));
}

static int symbol_add(lua_State *L) {
    return arithmetic(L, LUA_OPADD, EXPR_ADD, EXPR_INTEGER_ADD);
}

static int symbol_subtract(lua_State *L) {
    return arithmetic(L, LUA_OPSUB, EXPR_SUBTRACT, EXPR_INTEGER_SUBTRACT);
}

static int symbol_multiply(lua_State *L) {
    return arithmetic(L, LUA_OPMUL, EXPR_MULTIPLY, EXPR_INTEGER_MULTIPLY);
}

static int symbol_floor_divide(lua_State *L) {
    return arithmetic(L, LUA_OPIDIV, EXPR_FLOOR_DIVIDE, EXPR_INTEGER_DIVIDE);
}

static int symbol_modulo(lua_State *L) {
    return arithmetic(L, LUA_OPMOD, EXPR_MODULO, EXPR_INTEGER_MODULO);
}

static int of_two_floats(lua_State *L, enum expr_operation operation) {
    uint32_t a = float_of(L, number_at(L, 1)), b = float_of(L, number_at(L, 2));
    return give(L, make_float(record_operation(L, operation, a, b, EXPR_NONE)));
}

static int symbol_divide(lua_State *L) {
    if (lua_type(L, 2) == LUA_TTABLE)
        return by_table(L, LUA_OPDIV);
    return of_two_floats(L, EXPR_DIVIDE);
}

/* Lua computes x ^ 2 as x * x. */
static int symbol_power(lua_State *L) {
    if (lua_type(L, 2) == LUA_TTABLE)
        return by_table(L, LUA_OPPOW);
    uint32_t a = float_of(L, number_at(L, 1)), b = float_of(L, number_at(L, 2));
    uint32_t two = record_node(L, expr_float(&recorder_of(L)->graph, 2));
    uint32_t is_two = record_operation(L, EXPR_EQUAL, b, two, EXPR_NONE);
    return give(L,
                make_float(record_operation(L, EXPR_SELECT, is_two, record_operation(L, EXPR_MULTIPLY, a, a, EXPR_NONE),
                                            record_operation(L, EXPR_POWER, a, b, EXPR_NONE))));
}

static int symbol_negate(lua_State *L) {
    struct number a = record_settled(L, number_at(L, 1));
    if (a.type == NUMBER_INTEGER)
        return give(L, make_integer(record_operation(L, EXPR_INTEGER_NEGATE, a.node, EXPR_NONE, EXPR_NONE)));
    return give(L, make_float(record_operation(L, EXPR_NEGATE, a.node, EXPR_NONE, EXPR_NONE)));
}

static int of_two_integers(lua_State *L, enum expr_operation operation) {
    uint32_t a = integer_of(L, number_at(L, 1)), b = integer_of(L, number_at(L, 2));
    return give(L, make_integer(record_operation(L, operation, a, b, EXPR_NONE)));
}

static int symbol_and(lua_State *L) {
    return of_two_integers(L, EXPR_BIT_AND);
}

static int symbol_or(lua_State *L) {
    return of_two_integers(L, EXPR_BIT_OR);
}

static int symbol_xor(lua_State *L) {
    return of_two_integers(L, EXPR_BIT_XOR);
}

static int symbol_shift_left(lua_State *L) {
    return of_two_integers(L, EXPR_SHIFT_LEFT);
}

static int symbol_shift_right(lua_State *L) {
    return of_two_integers(L, EXPR_SHIFT_RIGHT);
}

static int symbol_not(lua_State *L) {
    uint32_t a = integer_of(L, number_at(L, 1));
    return give(L, make_integer(record_operation(L, EXPR_BIT_NOT, a, EXPR_NONE, EXPR_NONE)));
}

/* --- comparisons --- */

/* Whether an integer is compared as well by its float: small constants, and what is a float anyway. */
static bool has_exact_float(const struct recorder *recorder, struct number number) {
    const union expr_value *constant = expr_constant(&recorder->graph, number.node);
    if (constant)
        return constant->i >= -(INT64_C(1) << 53) && constant->i <= INT64_C(1) << 53;
    const struct expr_node *node = node_of(recorder, number.node);
    return node->operation == EXPR_TO_INTEGER;
}

struct comparison {
    enum expr_operation floats, integers, integer_left, integer_right;
};

/* The condition, as a node. */
static uint32_t compare(lua_State *L, struct number a, struct number b, const struct comparison *by) {
    const struct recorder *recorder = recorder_of(L);
    if (a.type == NUMBER_INTEGER && b.type == NUMBER_INTEGER)
        return record_operation(L, by->integers, a.node, b.node, EXPR_NONE);
    if (a.type == NUMBER_INTEGER && !has_exact_float(recorder, a))
        return record_operation(L, by->integer_left, a.node, b.node, EXPR_NONE);
    if (b.type == NUMBER_INTEGER && !has_exact_float(recorder, b))
        return record_operation(L, by->integer_right, b.node, a.node, EXPR_NONE);
    return record_operation(L, by->floats, float_of(L, a), float_of(L, b), EXPR_NONE);
}

static const struct comparison by_less = {EXPR_LESS, EXPR_INTEGER_LESS, EXPR_MIXED_LESS, EXPR_MIXED_GREATER};
static const struct comparison by_less_equal = {EXPR_LESS_EQUAL, EXPR_INTEGER_LESS_EQUAL, EXPR_MIXED_LESS_EQUAL,
                                                EXPR_MIXED_GREATER_EQUAL};
static const struct comparison by_equal = {EXPR_EQUAL, EXPR_INTEGER_EQUAL, EXPR_MIXED_EQUAL, EXPR_MIXED_EQUAL};

static int decided(lua_State *L, const struct comparison *by, const char *event) {
    if (by_operator_of_table(L, event))
        return 1;
    uint32_t condition = compare(L, number_at(L, 1), number_at(L, 2), by);
    lua_pushboolean(L, record_decide(L, condition));
    return 1;
}

static int symbol_less(lua_State *L) {
    return decided(L, &by_less, "__lt");
}

static int symbol_less_equal(lua_State *L) {
    return decided(L, &by_less_equal, "__le");
}

static int symbol_equal(lua_State *L) {
    if (!is_symbol(L, 1) || !is_symbol(L, 2)) {
        lua_pushboolean(L, 0);
        return 1;
    }
    return decided(L, &by_equal, "__eq");
}

static int symbol_text(lua_State *L) {
    lua_pushliteral(L, "a number of a recorded function");
    return 1;
}

/* --- functions of math --- */

/* The node that is true where the number is an integer. */
static uint32_t is_integer_node(lua_State *L, struct number number) {
    if (number.type == NUMBER_EITHER)
        return number.is_integer;
    return record_node(L, expr_truth(&recorder_of(L)->graph, number.type == NUMBER_INTEGER));
}

void push_extreme(lua_State *L, bool larger) {
    if (!is_symbol(L, -1) && !is_symbol(L, -2)) {
        bool second = larger ? lua_compare(L, -2, -1, LUA_OPLT) : lua_compare(L, -1, -2, LUA_OPLT);
        lua_remove(L, second ? -2 : -1);
        return;
    }
    struct number a = number_at(L, -2), b = number_at(L, -1), out;
    uint32_t second = larger ? compare(L, a, b, &by_less) : compare(L, b, a, &by_less);
    if (a.type == b.type && a.type != NUMBER_EITHER) {
        out = a.type == NUMBER_INTEGER
                  ? make_integer(record_operation(L, EXPR_INTEGER_SELECT, second, b.node, a.node))
                  : make_float(record_operation(L, larger ? EXPR_MAX : EXPR_MIN, a.node, b.node, EXPR_NONE));
    } else {
        out.type = NUMBER_EITHER;
        out.node = record_operation(L, larger ? EXPR_MAX : EXPR_MIN, float_of(L, a), float_of(L, b), EXPR_NONE);
        out.is_integer = record_operation(L, EXPR_TRUTH_SELECT, second, is_integer_node(L, b), is_integer_node(L, a));
    }
    lua_pop(L, 2);
    push_symbol(L, out);
}

static int extreme(lua_State *L, bool larger) {
    int count = lua_gettop(L);
    lua_pushvalue(L, 1);
    for (int k = 2; k <= count; k++) {
        lua_pushvalue(L, k);
        push_extreme(L, larger);
    }
    return 1;
}

static int of_one_float(lua_State *L, enum expr_operation operation) {
    uint32_t a = float_of(L, number_at(L, 1));
    return give(L, make_float(record_operation(L, operation, a, EXPR_NONE, EXPR_NONE)));
}

static int times(lua_State *L, double factor) {
    uint32_t a = float_of(L, number_at(L, 1)), b = record_node(L, expr_float(&recorder_of(L)->graph, factor));
    return give(L, make_float(record_operation(L, EXPR_MULTIPLY, a, b, EXPR_NONE)));
}

static int rounded(lua_State *L, enum expr_operation operation) {
    struct number a = record_settled(L, number_at(L, 1));
    if (a.type == NUMBER_INTEGER)
        return give(L, a);
    uint32_t whole = record_operation(L, operation, a.node, EXPR_NONE, EXPR_NONE);
    return give(L, make_integer(record_operation(L, EXPR_TO_INTEGER, whole, EXPR_NONE, EXPR_NONE)));
}

static int absolute(lua_State *L) {
    struct number a = number_at(L, 1);
    if (a.type != NUMBER_INTEGER) {
        a.node = record_operation(L, EXPR_ABS, a.node, EXPR_NONE, EXPR_NONE);
        return give(L, a); /* what may be an integer still may */
    }
    uint32_t zero = record_node(L, expr_integer(&recorder_of(L)->graph, 0));
    uint32_t negative = record_operation(L, EXPR_INTEGER_LESS, a.node, zero, EXPR_NONE);
    uint32_t negated = record_operation(L, EXPR_INTEGER_NEGATE, a.node, EXPR_NONE, EXPR_NONE);
    return give(L, make_integer(record_operation(L, EXPR_INTEGER_SELECT, negative, negated, a.node)));
}

/* math.log(x, base). */
static int logarithm(lua_State *L) {
    struct expr_graph *graph = &recorder_of(L)->graph;
    if (lua_isnoneornil(L, 2))
        return of_one_float(L, EXPR_LOG);
    uint32_t x = float_of(L, number_at(L, 1)), base = float_of(L, number_at(L, 2));
    uint32_t two = record_node(L, expr_float(graph, 2)), ten = record_node(L, expr_float(graph, 10));
    uint32_t general = record_operation(L, EXPR_DIVIDE, record_operation(L, EXPR_LOG, x, EXPR_NONE, EXPR_NONE),
                                        record_operation(L, EXPR_LOG, base, EXPR_NONE, EXPR_NONE), EXPR_NONE);
    uint32_t of_ten = record_operation(L, EXPR_SELECT, record_operation(L, EXPR_EQUAL, base, ten, EXPR_NONE),
                                       record_operation(L, EXPR_LOG10, x, EXPR_NONE, EXPR_NONE), general);
    return give(L, make_float(record_operation(L, EXPR_SELECT, record_operation(L, EXPR_EQUAL, base, two, EXPR_NONE),
                                               record_operation(L, EXPR_LOG2, x, EXPR_NONE, EXPR_NONE), of_ten)));
}

static int remainder_of(lua_State *L) {
    struct number a = number_at(L, 1), b = number_at(L, 2);
    if (are_floats(L, &a, &b))
        return give(L, make_float(record_operation(L, EXPR_REMAINDER, a.node, b.node, EXPR_NONE)));
    refuse_zero(L, b, "bad argument #2 to 'fmod' (zero)");
    return give(L, make_integer(record_operation(L, EXPR_INTEGER_REMAINDER, a.node, b.node, EXPR_NONE)));
}

/* math.modf: the whole part as a float, and the rest, which of an infinity is 0. */
static int parts(lua_State *L) {
    struct expr_graph *graph = &recorder_of(L)->graph;
    uint32_t x = float_of(L, number_at(L, 1)), zero = record_node(L, expr_float(graph, 0));
    uint32_t negative = record_operation(L, EXPR_LESS, x, zero, EXPR_NONE);
    uint32_t whole = record_operation(L, EXPR_SELECT, negative, record_operation(L, EXPR_CEIL, x, EXPR_NONE, EXPR_NONE),
                                      record_operation(L, EXPR_FLOOR, x, EXPR_NONE, EXPR_NONE));
    uint32_t rest = record_operation(L, EXPR_SELECT, record_operation(L, EXPR_EQUAL, x, whole, EXPR_NONE), zero,
                                     record_operation(L, EXPR_SUBTRACT, x, whole, EXPR_NONE));
    push_symbol(L, make_float(whole));
    push_symbol(L, make_float(rest));
    return 2;
}

static int to_integer(lua_State *L) {
    struct number a = number_at(L, 1);
    if (a.type != NUMBER_INTEGER && !record_decide(L, record_operation(L, EXPR_WHOLE, a.node, EXPR_NONE, EXPR_NONE))) {
        lua_pushnil(L);
        return 1;
    }
    return give(L, make_integer(integer_of(L, a)));
}

static int unsigned_less(lua_State *L) {
    struct expr_graph *graph = &recorder_of(L)->graph;
    uint32_t top = record_node(L, expr_integer(graph, INT64_MIN));
    uint32_t a = integer_of(L, number_at(L, 1)), b = integer_of(L, number_at(L, 2));
    a = record_operation(L, EXPR_BIT_XOR, a, top, EXPR_NONE);
    b = record_operation(L, EXPR_BIT_XOR, b, top, EXPR_NONE);
    lua_pushboolean(L, record_decide(L, record_operation(L, EXPR_INTEGER_LESS, a, b, EXPR_NONE)));
    return 1;
}

static int type_name(lua_State *L) {
    lua_pushstring(L, record_settled(L, number_at(L, 1)).type == NUMBER_INTEGER ? "integer" : "float");
    return 1;
}

static int refused(lua_State *L, const char *name) {
    return luaL_error(L, "math.%s cannot be recorded", name);
}

/* The functions of math, with what they do to symbols. */
#define MATH_FUNCTIONS(X)                                                                                              \
    X(abs, absolute(L))                                                                                                \
    X(ceil, rounded(L, EXPR_CEIL))                                                                                     \
    X(floor, rounded(L, EXPR_FLOOR))                                                                                   \
    X(sqrt, of_one_float(L, EXPR_SQRT))                                                                                \
    X(sin, of_one_float(L, EXPR_SIN))                                                                                  \
    X(cos, of_one_float(L, EXPR_COS))                                                                                  \
    X(tan, of_one_float(L, EXPR_TAN))                                                                                  \
    X(asin, of_one_float(L, EXPR_ASIN))                                                                                \
    X(acos, of_one_float(L, EXPR_ACOS))                                                                                \
    X(atan, (lua_isnoneornil(L, 2) ? (lua_settop(L, 1), lua_pushnumber(L, 1)) : (void)0, of_two_floats(L, EXPR_ATAN))) \
    X(atan2, of_two_floats(L, EXPR_ATAN))                                                                              \
    X(exp, of_one_float(L, EXPR_EXP))                                                                                  \
    X(log, logarithm(L))                                                                                               \
    X(log10, of_one_float(L, EXPR_LOG10))                                                                              \
    X(pow, of_two_floats(L, EXPR_POWER))                                                                               \
    X(sinh, of_one_float(L, EXPR_SINH))                                                                                \
    X(cosh, of_one_float(L, EXPR_COSH))                                                                                \
    X(tanh, of_one_float(L, EXPR_TANH))                                                                                \
    X(deg, times(L, 180.0 / PI))                                                                                       \
    X(rad, times(L, PI / 180.0))                                                                                       \
    X(fmod, remainder_of(L))                                                                                           \
    X(mod, remainder_of(L))                                                                                            \
    X(modf, parts(L))                                                                                                  \
    X(min, extreme(L, false))                                                                                          \
    X(max, extreme(L, true))                                                                                           \
    X(tointeger, to_integer(L))                                                                                        \
    X(ult, unsigned_less(L))                                                                                           \
    X(type, type_name(L))                                                                                              \
    X(frexp, refused(L, "frexp"))                                                                                      \
    X(ldexp, refused(L, "ldexp"))

/* Upvalue 1: the function for numbers, which is called as if it were in this one's place. */
static bool takes_symbols(lua_State *L) {
    for (int k = lua_gettop(L); k > 0; k--)
        if (lua_type(L, k) == LUA_TUSERDATA && is_symbol(L, k))
            return true;
    return false;
}

#define MATH_FUNCTION(name, of_symbols)                                                                                \
    static int recorded_##name(lua_State *L) {                                                                         \
        if (!takes_symbols(L))                                                                                         \
            return lua_tocfunction(L, lua_upvalueindex(1))(L);                                                         \
        return of_symbols;                                                                                             \
    }
MATH_FUNCTIONS(MATH_FUNCTION)

static int type_of(lua_State *L) {
    if (lua_type(L, 1) != LUA_TUSERDATA || !is_symbol(L, 1))
        return lua_tocfunction(L, lua_upvalueindex(1))(L);
    lua_pushliteral(L, "number");
    return 1;
}

static int to_number(lua_State *L) {
    if (lua_type(L, 1) != LUA_TUSERDATA || !is_symbol(L, 1) || lua_gettop(L) > 1)
        return lua_tocfunction(L, lua_upvalueindex(1))(L);
    return 1;
}

static int is_recorded(lua_State *L) {
    luaL_checkany(L, 1);
    lua_pushboolean(L, is_symbol(L, 1));
    return 1;
}

static const struct value_function functions[] = {
    {"is_recorded", "x", "Whether x is a number of a recorded function, whose value is not known yet.", "boolean",
     is_recorded},
};
const struct value_functions symbol_functions = {functions, sizeof functions / sizeof functions[0]};

void symbols_open(lua_State *L) {
    static const luaL_Reg operators[] = {{"__add", symbol_add},
                                         {"__sub", symbol_subtract},
                                         {"__mul", symbol_multiply},
                                         {"__div", symbol_divide},
                                         {"__idiv", symbol_floor_divide},
                                         {"__mod", symbol_modulo},
                                         {"__pow", symbol_power},
                                         {"__unm", symbol_negate},
                                         {"__band", symbol_and},
                                         {"__bor", symbol_or},
                                         {"__bxor", symbol_xor},
                                         {"__bnot", symbol_not},
                                         {"__shl", symbol_shift_left},
                                         {"__shr", symbol_shift_right},
                                         {"__lt", symbol_less},
                                         {"__le", symbol_less_equal},
                                         {"__eq", symbol_equal},
                                         {"__tostring", symbol_text},
                                         {NULL, NULL}};
    /* The metatable of recorded numbers. */
    lua_newtable(L);
    luaL_setfuncs(L, operators, 0);
    lua_pushliteral(L, "recorded number");
    lua_setfield(L, -2, "__name");
    lua_pushboolean(L, 0);
    lua_setfield(L, -2, "__metatable");
    recorder_of(L)->symbol_metatable = lua_topointer(L, -1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &symbol_key);
    /* Functions of Lua that accept recorded numbers, too. */
#define WRAP_FUNCTION(name, of_symbols) wrap_function(L, "math", #name, recorded_##name);
    MATH_FUNCTIONS(WRAP_FUNCTION)
    wrap_function(L, LUA_GNAME, "type", type_of);
    wrap_function(L, LUA_GNAME, "tonumber", to_number);
}
