/* Symbols: numbers that a recording does not know yet. */
#ifndef GRAY_RECORD_SYMBOL_H
#define GRAY_RECORD_SYMBOL_H

#include "expr/expr_graph.h"
#include "record/vector.h"

struct recorder;

/* The kind of a Lua value in a recording. The node of an integer is an integer; the node of the others is a float.
 * EITHER: math.max(x, 0) gives an integer or a float; its node is the float of it, is_integer the node that says
 * which. */
enum number_type { NUMBER_FLOAT, NUMBER_INTEGER, NUMBER_EITHER };
struct number {
    enum number_type type;
    uint32_t node, is_integer;
};

/* Adds the metatable of symbols, and replaces the functions of math, type and tonumber that know them. */
void symbols_open(lua_State *L);
bool is_symbol(lua_State *L, int index);
/* Raises an error for a node that could not be made. */
void push_symbol(lua_State *L, struct number number);
/* The number at a stack index as part of the recording. Raises an error where there is none. */
struct number number_at(lua_State *L, int index);
/* Its node as a float. */
uint32_t number_float(struct recorder *recorder, struct number number);
/* The node; raises an error where it is EXPR_NONE: the graph is at its limit. */
uint32_t record_node(lua_State *L, uint32_t node);
uint32_t record_operation(lua_State *L, enum expr_operation operation, uint32_t a, uint32_t b, uint32_t c);
/* a where the condition holds, else b. */
struct number record_select(lua_State *L, uint32_t condition, struct number a, struct number b);
/* A number that is an integer or a float, as one of the two: a decision of the path. */
struct number record_settled(lua_State *L, struct number number);
/* Begins a frame for the paths of a step of a loop; begins the next path of the innermost frame; ends that frame. They
 * raise errors at the limits. */
struct record_frame *record_begin_paths(lua_State *L);
void record_begin_path(lua_State *L);
/* From now on, the last decision of the path is false. */
void record_turn_last(struct recorder *recorder);
void record_end_paths(struct recorder *recorder);
/* The answer of the path to a condition. */
bool record_decide(lua_State *L, uint32_t condition);
/* Replaces the two values on top by the smaller or the larger, as math.min and math.max choose. */
void push_extreme(lua_State *L, bool larger);
_Noreturn void record_give_up(lua_State *L, const char *format, ...) __attribute__((format(printf, 2, 3)));

extern const struct value_functions symbol_functions; /* gr.is_recorded */

#endif
