/* Programs for a part of their domain: without the operands that no point of a box takes, and without what only these
 * needed (M. Keeter 2020, see expr_interval.h). At every point of the box a shortened program gives the very bits of
 * the whole one. Its rows and scratch memory are no larger. */
#ifndef GRAY_EXPR_EXPR_SHORTEN_H
#define GRAY_EXPR_EXPR_SHORTEN_H

#include "expr/expr_interval.h"

/* Memory for the code of shortened programs, bounded: a stack that grows downwards. Programs made later are given back
 * earlier: set `free` to what it was. The constants are those of the whole program. */
struct expr_stack {
    struct expr_instruction *code;
    size_t free; /* instructions below this index are not in use; at the beginning all of them */
};

/* Bytes that expr_shorten works in. */
size_t expr_shorten_size(const struct expr_program *program);
/* The part of a program that box `lane` of the choices needs. False: there is no room in the stack, and nothing has
 * changed. scratch: expr_shorten_size bytes, aligned to 64. */
bool expr_shorten(const struct expr_program *program, const struct expr_choice *choices, uint32_t lane,
                  struct expr_stack *stack, void *scratch, struct expr_program *out);

/* A copy whose code is in the arena, so that it outlives the stack. False: no memory. */
bool expr_keep(const struct expr_program *program, struct arena *arena, struct expr_program *out);

#endif
