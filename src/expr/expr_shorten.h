/* Programs for a part of their domain: without the operands that are selected at no point of a box, and without the
 * instructions that only these operands need (M. Keeter 2020, see expr_interval.h). At every point of the box, a
 * shortened program gives the same bits as the whole one. It does not need more rows or scratch memory. */
#ifndef GRAY_EXPR_EXPR_SHORTEN_H
#define GRAY_EXPR_EXPR_SHORTEN_H

#include "expr/expr_interval.h"

/* Bounded memory for the code of shortened programs: a stack that grows downwards. To release the programs made
 * last, set `free` to its earlier value. The constants are those of the whole program. */
struct expr_stack {
    struct expr_instruction *code;
    size_t free; /* instructions below this index are free; at the start all of them are */
};

/* The size in bytes of the scratch memory of expr_shorten. */
size_t expr_shorten_size(const struct expr_program *program);
/* The part of a program that box `lane` of the choices needs. False: the stack is too small, and nothing has
 * changed. scratch: expr_shorten_size bytes, aligned to 64. */
bool expr_shorten(const struct expr_program *program, const struct expr_choice *choices, uint32_t lane,
                  struct expr_stack *stack, void *scratch, struct expr_program *out);

/* A program with the same bits. If a register is a copy of a constant, as expr_shorten leaves it: without operations on
 * constants whose result is one of its constants, and without those that return an operand. scratch: expr_shorten_size bytes of the program, aligned to 64; otherwise as expr_shorten. */
bool expr_fold(const struct expr_program *program, struct expr_stack *stack, void *scratch, struct expr_program *out);

/* A copy with its code and the constants that it reads in the arena, which outlives the stack. False: no memory. */
bool expr_keep(const struct expr_program *program, struct arena *arena, struct expr_program *out);

#endif
