/* Recording Lua functions as expressions. A function is called with symbols in the place of numbers: userdata whose
 * operators, and those of math and gr, add an operation to a graph (expr/expr_graph.h) in the place of computing. A
 * comparison of symbols is answered `true`; then the function is called again with the last answer turned to `false`,
 * until all paths are known, and their results are joined by selections on the comparisons.
 *
 * The technique: A. Griewank and A. Walther, "Evaluating Derivatives", 2nd edition 2008, section 6.1 (recording by
 * overloading); J. King, "Symbolic Execution and Program Testing", 1976 (paths and their conditions). */
#ifndef GRAY_RECORD_RECORD_H
#define GRAY_RECORD_RECORD_H

#include "expr/expr_program.h"
#include "image/tone.h"
#include "material/texture.h"
#include "sandbox/sandbox.h"

/* The first argument of a function: a point, or a unit direction. */
enum record_domain { RECORD_POINTS_OF_SPACE, RECORD_DIRECTIONS };

/* What was recorded. The program and its source, "scene.lua:12", are in the arena of the call of record_function. */
struct recording {
    const struct expr_program *program;
    const char *source;
    struct texture texture; /* of the program */
};

/* Creates the recorder of a sandbox, with symbols and vectors. May raise. */
void record_open(lua_State *L);
/* After the state was closed; frees the data of a recording that did not finish, too. */
void recorder_destroy(struct recorder *recorder);
/* While a function is recorded or compared no function of gr may run: what is busy, "function that is recorded". NULL:
 * nothing is. */
const char *record_activity(lua_State *L);
/* Records the Lua function at an absolute index. Raises every error, with the name of the argument in front. */
void record_function(struct sandbox *sandbox, int index, const char *name, enum record_domain domain,
                     struct arena *arena, struct recording *out);
/* The texture of a program that was not recorded here. */
struct texture record_texture_of(const struct expr_program *program);
/* The values of a tone curve, a function at an absolute index that is called and not recorded. They live as long as the
 * call. Raises every error, likewise. */
const struct tone_table *record_tone_curve(struct sandbox *sandbox, int index, const char *name);

#endif
