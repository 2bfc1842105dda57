/* Links between instructions that follow each other. An operation often reads the result of the one before it. The
 * evaluators keep that result in processor registers, and store it only if another instruction reads it too. The link
 * of an instruction is one number for its operation, the origins of its operands, and whether its result is stored, so
 * that evaluators need one jump. An instruction whose link is EXPR_UNLINKED reads and writes registers of the program
 * only. */
#ifndef GRAY_EXPR_EXPR_LINK_INTERNAL_H
#define GRAY_EXPR_EXPR_LINK_INTERNAL_H

#include "expr/expr_program.h"

/* Where an operand comes from: a register of the program (R), a constant (K), or the instruction before (L). */
enum { EXPR_FROM_R, EXPR_FROM_K, EXPR_FROM_L };

/* The operations that have links, with one operand and with two; the third kind is the selection. */
#define EXPR_LINKED_1(X) X(NEGATE) X(ABS) X(SQRT) X(FLOOR)
#define EXPR_LINKED_2(X) X(ADD) X(SUBTRACT) X(MULTIPLY) X(DIVIDE) X(MIN) X(MAX) X(LESS) X(LESS_EQUAL)
#define EXPR_LINKS_1(operation) EXPR_LINK_##operation, EXPR_LINK_END_##operation = EXPR_LINK_##operation + 5,
#define EXPR_LINKS_2(operation) EXPR_LINK_##operation, EXPR_LINK_END_##operation = EXPR_LINK_##operation + 17,
enum { EXPR_UNLINKED, EXPR_LINKED_1(EXPR_LINKS_1) EXPR_LINKED_2(EXPR_LINKS_2) EXPR_LINK_SELECT };
#define EXPR_LINK_1(operation, a, stored) (EXPR_LINK_##operation + 2 * EXPR_FROM_##a + (stored))
#define EXPR_LINK_2(operation, a, b, stored)                                                                           \
    (EXPR_LINK_##operation + 2 * (3 * EXPR_FROM_##a + EXPR_FROM_##b) + (stored))
#define EXPR_LINK_3(a, b, c, stored)                                                                                   \
    (EXPR_LINK_SELECT + 2 * (9 * EXPR_FROM_##a + 3 * EXPR_FROM_##b + EXPR_FROM_##c) + (stored))

/* All links but EXPR_UNLINKED: X1(operation, origin, stored), X2(operation, two origins, stored), X3(three origins,
 * stored) of the selection. */
#define EXPR_CASES_1(X, operation) X(operation, R, 0) X(operation, R, 1) X(operation, L, 0) X(operation, L, 1)
#define EXPR_CASES_2(X, operation, stored)                                                                             \
    X(operation, R, R, stored)                                                                                         \
    X(operation, R, K, stored)                                                                                         \
    X(operation, R, L, stored)                                                                                         \
    X(operation, K, R, stored)                                                                                         \
    X(operation, K, L, stored)                                                                                         \
    X(operation, L, R, stored)                                                                                         \
    X(operation, L, K, stored)                                                                                         \
    X(operation, L, L, stored)
#define EXPR_CASES_3(X, stored)                                                                                        \
    X(R, R, R, stored)                                                                                                 \
    X(R, R, K, stored)                                                                                                 \
    X(R, R, L, stored)                                                                                                 \
    X(R, K, R, stored)                                                                                                 \
    X(R, K, K, stored)                                                                                                 \
    X(R, K, L, stored)                                                                                                 \
    X(R, L, R, stored)                                                                                                 \
    X(R, L, K, stored)                                                                                                 \
    X(L, R, R, stored)                                                                                                 \
    X(L, R, K, stored)                                                                                                 \
    X(L, K, R, stored)                                                                                                 \
    X(L, K, K, stored)
#define EXPR_LINK_CASES(X1, X2, X3)                                                                                    \
    EXPR_CASES_1(X1, NEGATE)                                                                                           \
    EXPR_CASES_1(X1, ABS)                                                                                              \
    EXPR_CASES_1(X1, SQRT)                                                                                             \
    EXPR_CASES_1(X1, FLOOR)                                                                                            \
    EXPR_CASES_BOTH(X2, ADD)                                                                                           \
    EXPR_CASES_BOTH(X2, SUBTRACT)                                                                                      \
    EXPR_CASES_BOTH(X2, MULTIPLY)                                                                                      \
    EXPR_CASES_BOTH(X2, DIVIDE)                                                                                        \
    EXPR_CASES_BOTH(X2, MIN)                                                                                           \
    EXPR_CASES_BOTH(X2, MAX)                                                                                           \
    EXPR_CASES_BOTH(X2, LESS)                                                                                          \
    EXPR_CASES_BOTH(X2, LESS_EQUAL)                                                                                    \
    EXPR_CASES_3(X3, 0)                                                                                                \
    EXPR_CASES_3(X3, 1)
/* The table of jumps of an evaluator: by link, the addresses of the labels that these cases make of the names, such as
 * ADD_L_R_1. */
#define EXPR_LINK_ADDRESSES                                                                                            \
    [EXPR_UNLINKED] = &&UNLINKED, EXPR_LINK_CASES(EXPR_ADDRESS_1, EXPR_ADDRESS_2, EXPR_ADDRESS_3)
#define EXPR_ADDRESS_1(operation, oa, stored) [EXPR_LINK_1(operation, oa, stored)] = &&operation##_##oa##_##stored,
#define EXPR_ADDRESS_2(operation, oa, ob, stored)                                                                      \
    [EXPR_LINK_2(operation, oa, ob, stored)] = &&operation##_##oa##_##ob##_##stored,
#define EXPR_ADDRESS_3(oa, ob, oc, stored) [EXPR_LINK_3(oa, ob, oc, stored)] = &&SELECT_##oa##_##ob##_##oc##_##stored,
#define EXPR_CASES_BOTH(X, operation) EXPR_CASES_2(X, operation, 0) EXPR_CASES_2(X, operation, 1)

struct expr_link_range {
    uint16_t first, operand_count; /* 0 and 0 for operations without links */
};
#define EXPR_RANGE_1(operation) [EXPR_##operation] = {EXPR_LINK_##operation, 1},
#define EXPR_RANGE_2(operation) [EXPR_##operation] = {EXPR_LINK_##operation, 2},
static const struct expr_link_range expr_link_ranges[EXPR_ALL_OPERATIONS] = {
    EXPR_LINKED_1(EXPR_RANGE_1) EXPR_LINKED_2(EXPR_RANGE_2)[EXPR_SELECT] = {EXPR_LINK_SELECT, 3}};

/* The state of a pass that sets links from the last instruction to the first. Zero-initialise but for
 * constant_count. */
struct expr_linker {
    struct expr_instruction *later; /* set last; the origins of its operands are not known yet */
    unsigned ended;                 /* bit k: nothing after `later` reads the value of its operand k */
    uint32_t constant_count;
};

/* Completes the link of `later`: the result of the instruction before it is in register `last`, or in none. */
static inline void expr_link_operands(const struct expr_linker *linker, uint32_t last) {
    struct expr_instruction *in = linker->later;
    if (!in || in->link == EXPR_UNLINKED)
        return;
    const uint16_t operands[3] = {in->a, in->b, in->c};
    uint32_t origins = 0;
    for (int k = 0; k < expr_link_ranges[in->operation].operand_count; k++)
        origins = 3 * origins + (operands[k] < linker->constant_count ? EXPR_FROM_K
                                 : operands[k] == last                ? EXPR_FROM_L
                                                                      : EXPR_FROM_R);
    in->link = (uint16_t)(in->link + 2 * origins);
}

/* Sets the link of the instruction before `later`. ended: bit k: nothing after this instruction reads the value of its
 * operand k. */
static inline void expr_link(struct expr_linker *linker, struct expr_instruction *in, unsigned ended) {
    const struct expr_link_range range = expr_link_ranges[in->operation];
    const struct expr_instruction *later = linker->later;
    const uint32_t constants = linker->constant_count;
    /* Only what the evaluators have: a constant condition and equal choices are left to the unlinked operation. */
    bool has_link = range.operand_count == 2   ? in->a >= constants || in->b >= constants
                    : range.operand_count == 3 ? in->a >= constants && in->b != in->c
                                               : range.operand_count == 1 && in->a >= constants;
    bool is_read = false, is_ended = false;
    if (has_link && later && later->link != EXPR_UNLINKED) {
        const uint16_t operands[3] = {later->a, later->b, later->c};
        for (int k = 0; k < expr_link_ranges[later->operation].operand_count; k++) {
            bool reads = operands[k] == in->out;
            is_read = is_read || reads;
            is_ended = is_ended || (reads && (linker->ended >> k & 1));
        }
    }
    expr_link_operands(linker, is_read ? in->out : UINT32_MAX);
    in->link = has_link ? (uint16_t)(range.first + !is_ended) : (uint16_t)EXPR_UNLINKED;
    linker->later = in;
    linker->ended = ended;
}

/* Sets the links of a program, whose code this is. */
void expr_link_program(const struct expr_program *program, struct expr_instruction *code);

#endif
