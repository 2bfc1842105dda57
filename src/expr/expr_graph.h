/* Expressions during recording: an acyclic graph of operations. Nodes are hash-consed: equal operations on equal
 * operands are one node (A. Ershov, "On programming of arithmetic operations", 1958). They are also folded: an
 * operation on constants becomes its result, and identities that hold for every bit pattern are applied. Operands
 * precede the nodes that read them. */
#ifndef GRAY_EXPR_EXPR_GRAPH_H
#define GRAY_EXPR_EXPR_GRAPH_H

#include "expr/expr_operations.h"

#include <stdbool.h>
#include <stdint.h>

/* The inputs of a function: properties of a hit. Directions are unit vectors in world space. */
#define EXPR_INPUTS(X)                                                                                                 \
    X(EXPR_POINT_X, "p.x")                                                                                             \
    X(EXPR_POINT_Y, "p.y")                                                                                             \
    X(EXPR_POINT_Z, "p.z")                                                                                             \
    X(EXPR_U, "s.u")                                                                                                   \
    X(EXPR_V, "s.v")                                                                                                   \
    X(EXPR_NORMAL_X, "s.normal.x")                                                                                     \
    X(EXPR_NORMAL_Y, "s.normal.y")                                                                                     \
    X(EXPR_NORMAL_Z, "s.normal.z")                                                                                     \
    X(EXPR_VIEW_X, "s.view.x")                                                                                         \
    X(EXPR_VIEW_Y, "s.view.y")                                                                                         \
    X(EXPR_VIEW_Z, "s.view.z")                                                                                         \
    X(EXPR_WORLD_X, "s.world.x")                                                                                       \
    X(EXPR_WORLD_Y, "s.world.y")                                                                                       \
    X(EXPR_WORLD_Z, "s.world.z")                                                                                       \
    X(EXPR_TIME, "s.time")
#define EXPR_INPUT_MEMBER(member, word) member,
enum expr_input { EXPR_INPUTS(EXPR_INPUT_MEMBER) EXPR_INPUT_COUNT };

/* EXPR_STATES: of a loop. EXPR_DEPTH: loops in each other. */
enum { EXPR_NODES = 100000, EXPR_STATES = 64, EXPR_DEPTH = 3 };
#define EXPR_NONE UINT32_MAX

struct expr_node {
    enum expr_operation operation;
    enum expr_type type;
    uint32_t operands[3]; /* EXPR_NONE after the last operand; of an input: first its number */
    uint32_t depth;       /* of the innermost loop whose steps it depends on; 0: none */
    union expr_value constant;
};

/* A loop: states that a body, a part of the graph, computes anew in each step. The body reads symbols of the depth of
 * the loop (expr_symbol): slot 0 is the number of the step, an integer, the others are the states. What the body reads
 * and does not depend on its steps is computed once, before the loop. */
struct expr_graph_loop {
    uint32_t first, last; /* steps */
    uint32_t depth;       /* from 1 to EXPR_DEPTH: one more than the depth of what surrounds it */
    uint32_t state_count;
    const uint32_t *initial, *next; /* the states before the first step, and the results of the body; types agree */
    bool ends;                      /* after a step whose first state is not > 0, and before all steps if one step
                                       has been already (first > 1) */
};

/* A loop of a graph: a copy of the description, and the arguments: initial states, then what the body reads from
 * outside. */
struct expr_kept_loop {
    struct expr_graph_loop loop;
    uint32_t *arguments, argument_count;
    uint32_t node; /* EXPR_LOOP */
};

/* Zero-initialise to create. expr_graph_destroy frees the memory and leaves an empty graph. */
struct expr_graph {
    struct expr_node *nodes;
    uint32_t *slots; /* hash table of indices; its size is a power of two, and it is at most half full */
    uint32_t count, capacity, slot_count;
    struct expr_kept_loop *loops;
    uint32_t loop_count, loop_capacity;
    bool full, out_of_memory; /* why a node is EXPR_NONE */
};

void expr_graph_destroy(struct expr_graph *graph);

/* The node of a leaf or an operation; an equal node is used again. EXPR_NONE if an operand is EXPR_NONE, if there is
 * no memory, or if the graph has EXPR_NODES nodes. The caller makes sure that types match. */
uint32_t expr_float(struct expr_graph *graph, double x);
uint32_t expr_integer(struct expr_graph *graph, int64_t x);
uint32_t expr_truth(struct expr_graph *graph, bool x);
uint32_t expr_input(struct expr_graph *graph, enum expr_input input);
uint32_t expr_operation(struct expr_graph *graph, enum expr_operation operation, uint32_t a, uint32_t b, uint32_t c);
/* What a step of a loop of this depth reads, see struct expr_graph_loop. */
uint32_t expr_symbol(struct expr_graph *graph, uint32_t depth, uint32_t slot, enum expr_type type);
/* Writes the nodes of the states after the loop. Equal loops are one. False as where a node is EXPR_NONE. */
bool expr_loop(struct expr_graph *graph, const struct expr_graph_loop *loop, uint32_t *states);
/* Nodes that the body computes in each step. */
uint32_t expr_body_size(const struct expr_graph *graph, const struct expr_graph_loop *loop);
/* Whether an EXPR_INPUT is a symbol, and its slot. */
bool expr_is_symbol(const struct expr_node *node);
uint32_t expr_symbol_slot(const struct expr_node *node);

/* The value of a constant; NULL for all other nodes and for EXPR_NONE. */
const union expr_value *expr_constant(const struct expr_graph *graph, uint32_t node);

/* Of an operation: the number and types of its operands, the type of its result, and its name. */
int expr_operand_count(enum expr_operation operation);
enum expr_type expr_operand_type(enum expr_operation operation, int operand);
enum expr_type expr_result_type(enum expr_operation operation);
const char *expr_operation_name(enum expr_operation operation);
const char *expr_input_name(enum expr_input input);
/* Evaluates one operation on three values; it ignores operands that the operation does not have. */
union expr_value expr_apply(enum expr_operation operation, union expr_value a, union expr_value b, union expr_value c);

#endif
