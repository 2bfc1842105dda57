/* Recording Lua functions as expressions. A function is called with symbols in the place of numbers: userdata whose
 * operators, and those of math and gr, add an operation to a graph (expr/expr_graph.h) in the place of computing. A
 * comparison of symbols is answered `true`; then the function is called again with the last answer turned to `false`,
 * until all paths are known, and their results are joined by selections on the comparisons. Private to src/script.
 *
 * The technique: A. Griewank and A. Walther, "Evaluating Derivatives", 2nd edition 2008, section 6.1 (recording by
 * overloading); J. King, "Symbolic Execution and Program Testing", 1976 (paths and their conditions). */
#ifndef GRAY_SCRIPT_RECORD_INTERNAL_H
#define GRAY_SCRIPT_RECORD_INTERNAL_H

#include "expr/expr_interval.h"
#include "expr/expr_program.h"
#include "math/box.h"
#include "script/bindings_internal.h"
#include "script/context_internal.h"

/* CALLS: of a function and of the steps of its loops. LEVELS: of steps in steps. */
enum {
    RECORD_PATHS = 4096,
    RECORD_CALLS = 1 << 16,
    RECORD_LOOP = 10000,
    RECORD_LEVELS = 8,
    RECORD_ERROR = PATH_SIZE + 512
};

/* The kind of a Lua value in a recording. The node of an integer is an integer; the node of the others is a float.
 * EITHER: math.max(x, 0) gives an integer or a float; its node is the float of it, is_integer the node that says which.
 */
enum number_type { NUMBER_FLOAT, NUMBER_INTEGER, NUMBER_EITHER };
struct number {
    enum number_type type;
    uint32_t node, is_integer;
};

/* The result of a path: one number, three numbers, or an error, for which every number is NaN. */
struct path_result {
    int count; /* 1 or 3; 0: an error */
    uint32_t nodes[3];
};

/* Bounds of a node that follow from a decision; EXPR_NONE: none. */
struct narrowing {
    uint32_t node;
    struct expr_interval bounds;
};

/* Calls that repeat a decision take what the first one computed. */
struct decision {
    uint32_t condition;
    uint32_t serial; /* of this answer on this path: equal as long as the path up to here is the same */
    bool answer, is_narrowed;
    struct narrowing narrowings[2];
    struct path_result if_true; /* while the answer is false: the result of the paths with true */
};

/* What is known of a condition: by the decision number `index` of a frame, or by those up to it; 0: without any. It
 * holds while that decision has this serial, and the call has reached it. */
struct known_answer {
    uint32_t serial, index;
    uint8_t level;
    bool answer;
};

/* The calls of a function, or of a step of a loop: the path of the one that runs. */
struct record_frame {
    struct decision *decisions; /* of the path, RECORD_PATHS of them */
    uint32_t depth, taken;      /* decisions of the path, and the number of decisions that the call has reached */
    uint32_t path;              /* number of the call among all calls of the recording, from 1 */
    uint32_t serial;            /* of the frame, as of a decision */
    uint32_t branches;          /* decisions of all calls; there are, or will be, one more paths */
    bool is_first;              /* the call that runs is the first one */
};

/* The first argument of a function: a point, or a unit direction. */
enum record_domain { RECORD_POINTS_OF_SPACE, RECORD_DIRECTIONS };

/* A function that was recorded, for comparisons within the bounds of the objects that use it. */
struct recorded_function {
    const struct expr_program *program;
    int reference; /* the function, in the registry */
    enum record_domain domain;
    struct box bounds; /* where it is used; empty: no place is known */
    bool is_compared;  /* in these bounds */
    struct recorded_function *next;
};

/* The recorder of a script. Owner: the context. recorder_destroy also frees the data of a recording that did not
 * finish. */
struct recorder {
    struct expr_graph graph;
    struct record_frame frames[RECORD_LEVELS]; /* of the function, and of the steps that run in it */
    uint32_t level, calls;                     /* the innermost frame; all calls */
    uint32_t decision_serial;                  /* the last one */
    uint64_t work;                             /* symbols that were made */
    uint32_t loop_depth;                       /* of loops whose body runs with symbols */
    struct path_bounds *narrowed;              /* record_interval.c; of each node, EXPR_NODES of them */
    struct known_answer *answers;              /* of each node, EXPR_NODES of them */
    uint32_t serial;                           /* of the recording: symbols of others are refused */
    bool active;                               /* symbols may be used */
    bool samples;                              /* busy with a tone curve, which is only called */
    bool busy;                                 /* a function is recorded or compared: no other function of gr may run */
    bool prints;                               /* the first path of the function has not ended */
    bool has_loop;                             /* the recording has a loop of the graph */
    bool unrolls;                              /* the steps of loops are recorded one by one */
    bool prefers_false;                        /* new decisions of the function are `false` */
    bool gave_up;                              /* at a limit; `error` names it and the line */
    char error[RECORD_ERROR];
    char path_error[RECORD_ERROR]; /* the first error of a path; empty: none */
    const void *symbol_metatable, *vector_metatable;
    struct recorded_function *functions; /* the newest first */
};

/* symbol.c: symbols, and the functions of math and type that know them. */
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

/* vector.c: gr.vec and the functions of gr on numbers and vectors. */
void vectors_open(lua_State *L);
bool is_vector(lua_State *L, int index);
/* Makes a vector of the three values on top, in their place. */
void push_vector(lua_State *L);
/* An operator (LUA_OPADD ...) on the components of its arguments, which are vectors, tables or numbers. */
int vector_arithmetic(lua_State *L, int operator);

/* record_loop.c */
int record_loop(lua_State *L); /* gr.loop */

/* record.c */
/* Whether the function that runs is called again, for another path or a comparison: it prints nothing. */
bool record_is_silent(const struct recorder *recorder);
/* A message handler: errors get their position while the stack still exists. */
int record_add_position(lua_State *L);
void record_open(lua_State *L);
/* Keeps the error of a path at an index, if it is the first one. */
void record_keep_error(lua_State *L, int index);
void recorder_destroy(struct recorder *recorder);
/* The texture of the Lua function at an absolute index, kept by the scene. Raises every error, with the name of the
 * argument in front. */
const struct script_texture *record_texture(struct script_context *context, int index, const char *name);
/* The program of such a function, or of gr.fn of one; NULL of anything else. source: "scene.lua:12". */
const struct expr_program *record_function(struct script_context *context, int index, const char *name,
                                           enum record_domain domain, const char **source);
/* The values of a tone curve, a function at an absolute index that is called and not recorded. They live as long as the
 * call. Raises every error, likewise. */
const struct tone_table *record_tone_curve(struct script_context *context, int index, const char *name);

/* keys.c */
int make_keys(lua_State *L); /* gr.keys */

/* Compares a function with its recording at points within its bounds. Raises the error. Expects the function on top. */
void record_compare_in_bounds(lua_State *L, const struct recorded_function *function);

/* record_interval.c */
void record_bounds_end(struct recorder *recorder);
/* 1 if the condition holds for all points of the path, 0 if it holds for none, -1 if for some or not known. */
int record_bounds_prove(const struct recorder *recorder, uint32_t condition);
/* On the path, the decision has its answer from now on. False: no memory. */
bool record_bounds_narrow(struct recorder *recorder, struct decision *decision);

/* record_bounds.c */
/* Stores the function at an absolute index. Raises an error: no memory. */
void record_remember(struct script_context *context, int index, const struct expr_program *program,
                     enum record_domain domain);

/* display_colour.c */
/* Whether a value is a display colour. Raises an error for a string '#...' that is not a colour. */
bool display_colour_at(lua_State *L, int index, struct vec3 *out);
/* An argument that is a colour of the screen; where textures are accepted it is one. False: it is something else. */
bool display_colour_read(struct script_context *c, int index, const struct script_parameter *p,
                         struct script_value *value);
int display_colour_make(lua_State *L);     /* gr.srgb */
int display_colour_to_light(lua_State *L); /* gr.linear */

#endif
