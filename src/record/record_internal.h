/* The recorder: the paths of a function, and what is known on them. */
#ifndef GRAY_RECORD_RECORD_INTERNAL_H
#define GRAY_RECORD_RECORD_INTERNAL_H

#include "expr/expr_interval.h"
#include "math/box.h"
#include "record/record.h"

/* CALLS: of a function and of the steps of its loops. LEVELS: of steps in steps. */
enum {
    RECORD_PATHS = 4096,
    RECORD_CALLS = 1 << 16,
    RECORD_LOOP = 10000,
    RECORD_LEVELS = 8,
    RECORD_ERROR = PATH_SIZE + 512
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

static inline struct recorder *recorder_of(lua_State *L) {
    return sandbox_of(L)->recorder;
}

/* A message handler: errors get their position while the stack still exists. */
int record_add_position(lua_State *L);
/* Keeps the error of a path at an index, if it is the first one. */
void record_keep_error(lua_State *L, int index);
/* Compares a function with its recording at points within its bounds. Raises the error. Expects the function on top. */
void record_compare_in_bounds(lua_State *L, const struct recorded_function *function);

#endif
