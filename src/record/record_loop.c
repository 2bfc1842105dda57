/* gr.loop. Outside of recordings it calls the function for each step. In a recording, the function is called with
 * symbols for the number of the step and for the states, and what it returns is the body of one loop of the graph
 * (expr/expr_graph.h), whatever the number of steps. A step may decide by its arguments: it has paths of its own, which
 * are joined by selections before the next step.
 *
 * Steps are recorded one by one in place of a loop while the states are plain numbers, where there are few, and where
 * the body cannot have a symbol as the number of its step (an index of a table, a bound of a `for`). */
#include "record/record_loop_internal.h"

#include "record/record_internal.h"
#include "record/symbol.h"

#include <lauxlib.h>
#include <math.h>
#include <string.h>

/* UNROLLED: operations of all steps that are recorded one by one. FEWEST_STEPS: of a loop. */
enum { UNROLLED = 1000, FEWEST_STEPS = 4 };

/* The states: numbers or vectors, and their components. */
struct states {
    int count, number_count;
    bool is_vector[EXPR_STATES];
    struct number numbers[EXPR_STATES];
};

static bool is_state(lua_State *L, int index) {
    return lua_type(L, index) == LUA_TNUMBER || is_symbol(L, index) ||
           (lua_type(L, index) == LUA_TTABLE && lua_rawlen(L, index) == 3);
}

static void check_results(lua_State *L, int first, int count) {
    for (int k = 0; k < count; k++)
        if (!is_state(L, first + k))
            luaL_error(L, "gr.loop: the function must return %d numbers or vectors", count);
}

/* --- numbers --- */

/* The arguments are at 1: n, the states, the function. Leaves the final states on top. */
static int loop_of_numbers(lua_State *L, lua_Integer steps, int states) {
    for (lua_Integer i = 1; i <= steps; i++) {
        lua_pushvalue(L, states + 2);
        lua_pushinteger(L, i);
        for (int k = 0; k < states; k++)
            lua_pushvalue(L, 2 + k);
        lua_call(L, states + 1, states);
        check_results(L, states + 3, states);
        bool ends = lua_type(L, states + 3) == LUA_TNUMBER && !(lua_tonumber(L, states + 3) > 0);
        for (int k = states; k-- > 0;)
            lua_replace(L, 2 + k);
        if (ends)
            break;
    }
    lua_settop(L, states + 1);
    return states;
}

/* --- states --- */

/* Reads `count` values from the index on. */
static void read_states(lua_State *L, int first, int count, struct states *out) {
    *out = (struct states){.count = count};
    luaL_checkstack(L, 8, "a state");
    for (int k = 0; k < count; k++) {
        out->is_vector[k] = lua_type(L, first + k) == LUA_TTABLE;
        for (int c = 1; c <= (out->is_vector[k] ? 3 : 1); c++) {
            if (out->is_vector[k])
                lua_rawgeti(L, first + k, c);
            else
                lua_pushvalue(L, first + k);
            out->numbers[out->number_count++] = number_at(L, -1);
            lua_pop(L, 1);
        }
    }
}

static void push_states(lua_State *L, const struct states *states) {
    luaL_checkstack(L, states->count + 8, "the states of a loop");
    for (int k = 0, at = 0; k < states->count; k++) {
        for (int c = 0; c < (states->is_vector[k] ? 3 : 1); c++)
            push_symbol(L, states->numbers[at++]);
        if (states->is_vector[k])
            push_vector(L);
    }
}

static bool same_shape(const struct states *a, const struct states *b) {
    return a->count == b->count && memcmp(a->is_vector, b->is_vector, sizeof a->is_vector) == 0;
}

static bool is_plain(const struct recorder *recorder, const struct states *states) {
    for (int k = 0; k < states->number_count; k++)
        if (states->numbers[k].type == NUMBER_EITHER || !expr_constant(&recorder->graph, states->numbers[k].node))
            return false;
    return true;
}

static uint32_t float_of(lua_State *L, struct number number) {
    return record_node(L, number_float(recorder_of(L), number));
}

static uint32_t is_integer_node(lua_State *L, struct number number) {
    if (number.type == NUMBER_EITHER)
        return number.is_integer;
    return record_node(L, expr_truth(&recorder_of(L)->graph, number.type == NUMBER_INTEGER));
}

static struct number as_either(lua_State *L, struct number number) {
    return (struct number){NUMBER_EITHER, float_of(L, number), is_integer_node(L, number)};
}

static struct number select_number(lua_State *L, uint32_t condition, struct number a, struct number b) {
    if (a.type == b.type && a.type != NUMBER_EITHER)
        return record_select(L, condition, a, b);
    a = as_either(L, a);
    b = as_either(L, b);
    uint32_t node = record_operation(L, EXPR_SELECT, condition, a.node, b.node);
    uint32_t is_integer = record_operation(L, EXPR_TRUTH_SELECT, condition, a.is_integer, b.is_integer);
    return (struct number){NUMBER_EITHER, node, is_integer};
}

/* a if the condition holds, otherwise b. A path with an error has no states: its values are NaN, or 0 for integers. */
static void join_states(lua_State *L, uint32_t condition, const struct states *a, struct states *b) {
    struct expr_graph *graph = &recorder_of(L)->graph;
    if (a->count > 0 && b->count > 0 && !same_shape(a, b))
        luaL_error(L, "gr.loop: a state is a number on one path of the function and a vector on another");
    struct states out = a->count > 0 ? *a : *b;
    for (int k = 0; k < out.number_count; k++) {
        struct number missing = out.numbers[k].type == NUMBER_INTEGER
                                    ? (struct number){NUMBER_INTEGER, expr_integer(graph, 0), EXPR_NONE}
                                    : (struct number){NUMBER_FLOAT, expr_float(graph, (double)NAN), EXPR_NONE};
        (void)record_node(L, missing.node);
        out.numbers[k] =
            select_number(L, condition, a->count > 0 ? a->numbers[k] : missing, b->count > 0 ? b->numbers[k] : missing);
    }
    *b = out;
}

/* --- a step --- */

/* One call on one path. After an error there are no states; the first error is kept at the index `error`. */
static void call_step(lua_State *L, int function, struct number step, const struct states *in, int error,
                      struct states *out) {
    struct sandbox *sandbox = sandbox_of(L);
    int top = lua_gettop(L);
    lua_pushcfunction(L, record_add_position);
    lua_pushvalue(L, function);
    push_symbol(L, step);
    push_states(L, in);
    int status = lua_pcall(L, in->count + 1, in->count, top + 1);
    sandbox->lua = L;
    if (sandbox_is_over(sandbox))
        limits_check(L);
    if (recorder_of(L)->gave_up) { /* even if the function caught the error */
        lua_pushstring(L, recorder_of(L)->error);
        lua_error(L);
    }
    *out = (struct states){.count = 0};
    if (status == LUA_OK) {
        check_results(L, top + 2, in->count);
        read_states(L, top + 2, in->count, out);
    } else {
        record_keep_error(L, -1);
        if (lua_isnil(L, error))
            lua_copy(L, -1, error);
    }
    lua_settop(L, top);
}

/* All paths of a step, joined. Raises the error if every path has one. */
static void record_step(lua_State *L, int function, struct number step, const struct states *in, struct states *out) {
    struct recorder *recorder = recorder_of(L);
    struct record_frame *frame = record_begin_paths(L);
    struct states *if_true = NULL;
    uint32_t capacity = 0;
    luaL_checkstack(L, 8, "a step of a loop");
    lua_pushnil(L);
    lua_pushnil(L); /* the memory of if_true */
    int error = lua_gettop(L) - 1;
    for (;;) {
        record_begin_path(L);
        call_step(L, function, step, in, error, out);
        while (frame->depth > 0 && !frame->decisions[frame->depth - 1].answer) {
            frame->depth--;
            join_states(L, frame->decisions[frame->depth].condition, &if_true[frame->depth], out);
        }
        if (frame->depth == 0)
            break;
        if (frame->depth > capacity) {
            uint32_t larger = 2 * frame->depth;
            struct states *moved = lua_newuserdatauv(L, larger * sizeof *moved, 0);
            if (capacity > 0)
                memcpy(moved, if_true, capacity * sizeof *moved);
            if_true = moved;
            capacity = larger;
            lua_replace(L, error + 1);
        }
        if (frame->branches >= RECORD_PATHS)
            record_give_up(L, "a step of gr.loop has more than %d paths; gr.where(x, a, b) chooses without a path",
                           RECORD_PATHS);
        if_true[frame->depth - 1] = *out;
        record_turn_last(recorder);
    }
    record_end_paths(recorder);
    if (out->count == 0) {
        lua_pushvalue(L, error);
        lua_error(L);
    }
    lua_settop(L, error - 1);
}

/* --- one step after the other --- */

static struct number integer_number(lua_State *L, uint32_t i) {
    return (struct number){NUMBER_INTEGER, record_node(L, expr_integer(&recorder_of(L)->graph, i)), EXPR_NONE};
}

/* The node of `the first state is > 0`. */
static uint32_t goes_on(lua_State *L, const struct states *states) {
    uint32_t zero = record_node(L, expr_float(&recorder_of(L)->graph, 0));
    return record_operation(L, EXPR_LESS, zero, float_of(L, states->numbers[0]), EXPR_NONE);
}

/* A step for the points that have not ended; the others keep their states. False: all have ended. */
static bool unroll_step(lua_State *L, int function, uint32_t step, struct states *states) {
    struct states next;
    const struct expr_graph *graph = &recorder_of(L)->graph;
    uint32_t alive = step > 1 && !states->is_vector[0] ? goes_on(L, states) : EXPR_NONE;
    const union expr_value *known = expr_constant(graph, alive);
    if (known && !known->i)
        return false;
    record_step(L, function, integer_number(L, step), states, &next);
    if (alive != EXPR_NONE && !known)
        join_states(L, alive, &next, states);
    else
        *states = next;
    return true;
}

/* --- a loop --- */

/* The symbols of states like these. Returns the number of slots, or 0 where there are too many. */
static uint32_t make_symbols(lua_State *L, const struct states *like, struct states *out) {
    struct recorder *recorder = recorder_of(L);
    uint32_t slot = 0;
    *out = *like;
    for (int k = 0; k < like->number_count; k++) {
        struct number *number = &out->numbers[k];
        if (slot + 2 > EXPR_STATES)
            return 0;
        enum expr_type type = number->type == NUMBER_INTEGER ? EXPR_TYPE_I : EXPR_TYPE_F;
        number->node = record_node(L, expr_symbol(&recorder->graph, recorder->loop_depth, ++slot, type));
        if (number->type == NUMBER_EITHER)
            number->is_integer =
                record_node(L, expr_symbol(&recorder->graph, recorder->loop_depth, ++slot, EXPR_TYPE_B));
    }
    return slot;
}

/* The nodes of the slots of states, with the types of `like`. */
static void list_slots(lua_State *L, const struct states *states, const struct states *like, uint32_t *out) {
    for (int k = 0; k < like->number_count; k++) {
        struct number number = states->numbers[k];
        if (like->numbers[k].type == NUMBER_EITHER)
            number = as_either(L, number);
        *out++ = number.node;
        if (number.type == NUMBER_EITHER)
            *out++ = number.is_integer;
    }
}

/* Records the body until its results have the types of its symbols. False: they have another form, or there are too
 * many. */
static bool record_body(lua_State *L, int function, struct states *symbols, struct states *next, uint32_t *slots) {
    struct recorder *recorder = recorder_of(L);
    for (bool is_settled = false; !is_settled;) {
        *slots = make_symbols(L, symbols, symbols);
        if (*slots == 0)
            return false;
        uint32_t step = record_node(L, expr_symbol(&recorder->graph, recorder->loop_depth, 0, EXPR_TYPE_I));
        record_step(L, function, (struct number){NUMBER_INTEGER, step, EXPR_NONE}, symbols, next);
        if (!same_shape(symbols, next))
            return false;
        is_settled = true;
        for (int k = 0; k < symbols->number_count; k++) {
            enum number_type *type = &symbols->numbers[k].type;
            is_settled = is_settled && (*type == next->numbers[k].type || *type == NUMBER_EITHER);
            *type = *type == next->numbers[k].type ? *type : NUMBER_EITHER;
        }
    }
    return true;
}

/* Whether the body, recorded once, gives states of these types. Otherwise a single step may change the types. */
static bool keeps_types(const struct states *states, const struct states *symbols) {
    for (int k = 0; k < states->number_count; k++)
        if (states->numbers[k].type != symbols->numbers[k].type)
            return false;
    return true;
}

/* The arguments of record_steps, and its result. */
struct looping {
    struct states states;
    uint32_t step, last; /* the next one */
    bool is_done, is_refused;
};

/* Records the remaining steps as a loop; is_refused if it is better to record them one by one. Argument 1: the
 * function, 2: the struct looping. */
static int record_others(lua_State *L) {
    struct recorder *recorder = recorder_of(L);
    struct looping *l = lua_touserdata(L, 2);
    struct states symbols = l->states, next;
    uint32_t slots, initial[EXPR_STATES], results[EXPR_STATES], final[EXPR_STATES];
    l->is_refused = true;
    recorder->loop_depth++;
    if (!record_body(L, 1, &symbols, &next, &slots))
        return 0;
    if (!keeps_types(&l->states, &symbols) && l->step < 3) { /* after another step the types may agree */
        l->is_refused = false;
        return 0;
    }
    list_slots(L, &l->states, &symbols, initial);
    list_slots(L, &next, &symbols, results);
    const struct expr_graph_loop loop = {.first = l->step,
                                         .last = l->last,
                                         .depth = recorder->loop_depth,
                                         .state_count = slots,
                                         .initial = initial,
                                         .next = results,
                                         .ends = !l->states.is_vector[0]};
    uint64_t steps = l->last - l->step + 1;
    if (steps * expr_body_size(&recorder->graph, &loop) <= UNROLLED)
        return 0;
    recorder->has_loop = true;
    bool fits = expr_loop(&recorder->graph, &loop, final);
    for (uint32_t k = 0; !fits && k < slots; k++)
        (void)record_node(L, EXPR_NONE);
    for (int k = 0, at = 0; k < symbols.number_count; k++) {
        struct number *number = &l->states.numbers[k];
        *number = (struct number){symbols.numbers[k].type, final[at++], EXPR_NONE};
        if (number->type == NUMBER_EITHER)
            number->is_integer = final[at++];
    }
    l->is_refused = false;
    l->is_done = true;
    return 0;
}

/* Calls it; an error means a refusal, except at limits. */
static void try_loop(lua_State *L, int function, struct looping *l) {
    struct sandbox *sandbox = sandbox_of(L);
    struct recorder *recorder = sandbox->recorder;
    const uint32_t depth = recorder->loop_depth, level = recorder->level;
    lua_pushcfunction(L, record_others);
    lua_pushvalue(L, function);
    lua_pushlightuserdata(L, l);
    int status = lua_pcall(L, 2, 0, 0);
    sandbox->lua = L;
    recorder->loop_depth = depth;
    recorder->level = level;
    if (status == LUA_OK)
        return;
    if (sandbox_is_over(sandbox))
        limits_check(L);
    if (recorder->gave_up)
        lua_error(L);
    lua_pop(L, 1);
    l->is_refused = true;
}

/* Argument 1: the function, 2: the struct looping. */
static int record_steps(lua_State *L) {
    struct recorder *recorder = recorder_of(L);
    struct looping *l = lua_touserdata(L, 2);
    bool may_loop = !recorder->unrolls && recorder->loop_depth < EXPR_DEPTH;
    while (l->step <= l->last) {
        bool is_long = l->last - l->step + 1 >= FEWEST_STEPS;
        if (may_loop && is_long && !is_plain(recorder, &l->states)) {
            try_loop(L, 1, l);
            may_loop = !l->is_refused;
            if (l->is_done)
                break;
        }
        if (!unroll_step(L, 1, l->step++, &l->states))
            break;
    }
    return 0;
}

/* loop(n, s1, s2, ..., f): f(i, s1, s2, ...) for i = 1 to n returns the next state, until s1 <= 0 (for that point). */
int record_loop(lua_State *L) {
    struct recorder *recorder = recorder_of(L);
    int states = lua_gettop(L) - 2;
    /* The arguments; a call outside of recording runs as it is. */
    lua_Integer count = luaL_checkinteger(L, 1);
    luaL_argcheck(L, count >= 0 && count <= RECORD_LOOP, 1, "a constant number of steps up to 10000 is needed");
    luaL_argcheck(L, states > 0, 2, "a state is needed");
    luaL_checktype(L, states + 2, LUA_TFUNCTION);
    if (!recorder->active)
        return loop_of_numbers(L, count, states);
    for (int k = 0; k < states; k++)
        luaL_argcheck(L, is_state(L, 2 + k), 2 + k, "a state must be a number or a vector");
    luaL_argcheck(L, 3 * states <= EXPR_STATES, 2, "there may be 21 states");
    /* The steps are recorded; an error leaves the loop as it was entered. */
    struct looping l = {.step = 1, .last = (uint32_t)count};
    read_states(L, 2, states, &l.states);
    const uint32_t depth = recorder->loop_depth, level = recorder->level;
    lua_pushcfunction(L, record_steps);
    lua_pushvalue(L, states + 2);
    lua_pushlightuserdata(L, &l);
    int status = lua_pcall(L, 2, 0, 0);
    sandbox_of(L)->lua = L;
    recorder->loop_depth = depth;
    recorder->level = level;
    if (status != LUA_OK)
        return lua_error(L);
    push_states(L, &l.states);
    return states;
}
