/* Links between instructions that follow each other. An operation often reads the result of the one before it. The
 * evaluators keep that result in processor registers, and store it only if another instruction reads it too. The link
 * of an instruction is one number for its operation, the origins of its operands, and whether its result is stored, so
 * that evaluators need one jump. An instruction whose link is EXPR_UNLINKED reads and writes registers of the program
 * only. EXPR_LOOP always has the link of one operand from R whose result is stored; evaluators stop there. */
#ifndef GRAY_EXPR_EXPR_LINK_INTERNAL_H
#define GRAY_EXPR_EXPR_LINK_INTERNAL_H

#include "expr/expr_program.h"

/* Where an operand comes from: a register of the program (R), a constant (K), the instruction before (L), or, of sums,
 * differences and products, an input (I), which batches read where the caller has it. */
enum { EXPR_FROM_R, EXPR_FROM_K, EXPR_FROM_L, EXPR_FROM_I };

/* The operations that have links, with one operand and with two; the third kind is the selection. */
#define EXPR_LINKED_1(X) X(NEGATE) X(ABS) X(SQRT) X(FLOOR)
#define EXPR_LINKED_2(X) X(ADD) X(SUBTRACT) X(MULTIPLY) X(DIVIDE) X(MIN) X(MAX) X(LESS) X(LESS_EQUAL)
#define EXPR_LINKS_1(operation) EXPR_LINK_##operation, EXPR_LINK_END_##operation = EXPR_LINK_##operation + 5,
#define EXPR_LINKS_2(operation) EXPR_LINK_##operation, EXPR_LINK_END_##operation = EXPR_LINK_##operation + 31,
enum { EXPR_UNLINKED, EXPR_LINKS_1(LOOP) EXPR_LINKED_1(EXPR_LINKS_1) EXPR_LINKED_2(EXPR_LINKS_2) EXPR_LINK_SELECT };
#define EXPR_LINK_1(operation, a, stored) (EXPR_LINK_##operation + 2 * EXPR_FROM_##a + (stored))
#define EXPR_LINK_2(operation, a, b, stored)                                                                           \
    (EXPR_LINK_##operation + 2 * (4 * EXPR_FROM_##a + EXPR_FROM_##b) + (stored))
#define EXPR_LINK_3(a, b, c, stored)                                                                                   \
    (EXPR_LINK_SELECT + 2 * (9 * EXPR_FROM_##a + 3 * EXPR_FROM_##b + EXPR_FROM_##c) + (stored))

/* All other links: X1(operation, origin, stored), X2(operation, two origins, stored), X3(three origins,
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
#define EXPR_CASES_I(X, operation, stored)                                                                             \
    X(operation, R, I, stored)                                                                                         \
    X(operation, K, I, stored)                                                                                         \
    X(operation, L, I, stored)                                                                                         \
    X(operation, I, R, stored)                                                                                         \
    X(operation, I, K, stored)                                                                                         \
    X(operation, I, L, stored)                                                                                         \
    X(operation, I, I, stored)
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
    EXPR_CASES_OF_INPUTS(X2, ADD)                                                                                      \
    EXPR_CASES_OF_INPUTS(X2, SUBTRACT)                                                                                 \
    EXPR_CASES_OF_INPUTS(X2, MULTIPLY)                                                                                 \
    EXPR_CASES_3(X3, 0)                                                                                                \
    EXPR_CASES_3(X3, 1)
/* Two sums, differences or products at once: each has the result before as its first operand, and the second one an
 * operand from R, K or I. The link of the first instruction names both and whether the second one is stored; the link
 * of the second one remains that of a single one. */
#define EXPR_STEPS_OF(operation) EXPR_STEP_##operation##_R, EXPR_STEP_##operation##_K, EXPR_STEP_##operation##_I
enum { EXPR_STEPS_OF(ADD), EXPR_STEPS_OF(SUBTRACT), EXPR_STEPS_OF(MULTIPLY), EXPR_STEPS };
enum { EXPR_LINK_PAIRS = EXPR_LINK_SELECT + 2 * 27 };
#define EXPR_LINK_PAIR(first, second, first_stored, stored)                                                            \
    (EXPR_LINK_PAIRS + 4 * (EXPR_STEPS * (first) + (second)) + 2 * (first_stored) + (stored))
/* X(first operation, its operand, whether it is stored, second operation, its operand, whether it is stored) */
#define EXPR_PAIR_CASES(X)                                                                                             \
    EXPR_PAIRS_AFTER(X, ADD, R)                                                                                        \
    EXPR_PAIRS_AFTER(X, ADD, K)                                                                                        \
    EXPR_PAIRS_AFTER(X, ADD, I)                                                                                        \
    EXPR_PAIRS_AFTER(X, SUBTRACT, R)                                                                                   \
    EXPR_PAIRS_AFTER(X, SUBTRACT, K)                                                                                   \
    EXPR_PAIRS_AFTER(X, SUBTRACT, I)                                                                                   \
    EXPR_PAIRS_AFTER(X, MULTIPLY, R)                                                                                   \
    EXPR_PAIRS_AFTER(X, MULTIPLY, K)                                                                                   \
    EXPR_PAIRS_AFTER(X, MULTIPLY, I)
#define EXPR_PAIRS_AFTER(X, o, b)                                                                                      \
    EXPR_PAIRS_WITH(X, o, b, ADD)                                                                                      \
    EXPR_PAIRS_WITH(X, o, b, SUBTRACT)                                                                                 \
    EXPR_PAIRS_WITH(X, o, b, MULTIPLY)
#define EXPR_PAIRS_WITH(X, o, b, p)                                                                                    \
    EXPR_PAIRS_OF(X, o, b, p, R) EXPR_PAIRS_OF(X, o, b, p, K) EXPR_PAIRS_OF(X, o, b, p, I)
#define EXPR_PAIRS_OF(X, o, b, p, c)                                                                                   \
    X(o, b, 0, p, c, 0)                                                                                                \
    X(o, b, 0, p, c, 1)                                                                                                \
    X(o, b, 1, p, c, 0)                                                                                                \
    X(o, b, 1, p, c, 1)
#define EXPR_PAIR_LINK(o, b, first_stored, p, c, stored)                                                               \
    EXPR_LINK_PAIR(EXPR_STEP_##o##_##b, EXPR_STEP_##p##_##c, first_stored, stored)
/* For the jumps of an evaluator: pairs at once, or their first instructions. */
#define EXPR_ADDRESS_PAIR(o, b, first_stored, p, c, stored)                                                            \
    EXPR_TARGET(EXPR_PAIR_LINK(o, b, first_stored, p, c, stored),                                                      \
                PAIR_##o##_##b##_##first_stored##_##p##_##c##_##stored)
#define EXPR_ADDRESS_FIRST(o, b, first_stored, p, c, stored)                                                           \
    EXPR_TARGET(EXPR_PAIR_LINK(o, b, first_stored, p, c, stored), o##_L_##b##_##first_stored)
/* The targets of these jumps: by link, the labels that these cases make of the names, such as ADD_L_R_1. */
#define EXPR_LINK_ADDRESSES                                                                                            \
    EXPR_TARGET(EXPR_UNLINKED, UNLINKED)                                                                               \
    EXPR_TARGET(EXPR_LINK_1(LOOP, R, 1), LOOP) EXPR_LINK_CASES(EXPR_ADDRESS_1, EXPR_ADDRESS_2, EXPR_ADDRESS_3)
#define EXPR_ADDRESS_1(operation, oa, stored)                                                                          \
    EXPR_TARGET(EXPR_LINK_1(operation, oa, stored), operation##_##oa##_##stored)
#define EXPR_ADDRESS_2(operation, oa, ob, stored)                                                                      \
    EXPR_TARGET(EXPR_LINK_2(operation, oa, ob, stored), operation##_##oa##_##ob##_##stored)
#define EXPR_ADDRESS_3(oa, ob, oc, stored)                                                                             \
    EXPR_TARGET(EXPR_LINK_3(oa, ob, oc, stored), SELECT_##oa##_##ob##_##oc##_##stored)

/* EXPR_JUMPS goes to the first instruction, EXPR_JUMP to the next: by a table of addresses, so that each instruction
 * jumps to the next one itself, which processors predict better than one jump for all of them. With GRAY_NO_JUMPS by a
 * switch, for compilers and devices that know no addresses of labels. */
#ifdef GRAY_NO_JUMPS
#define EXPR_TARGET(link, label)                                                                                       \
    case link:                                                                                                         \
        goto label;
#define EXPR_JUMPS(...)                                                                                                \
    jump:                                                                                                              \
    switch (in->link) { __VA_ARGS__ }                                                                                  \
    __builtin_unreachable();
#define EXPR_JUMP goto jump;
#else
#define EXPR_TARGET(link, label) [link] = &&label,
#define EXPR_JUMPS(...)                                                                                                \
    static const void *const targets[] = {__VA_ARGS__};                                                                \
    EXPR_JUMP
#define EXPR_JUMP goto *targets[in->link];
#endif
#define EXPR_CASES_BOTH(X, operation) EXPR_CASES_2(X, operation, 0) EXPR_CASES_2(X, operation, 1)
#define EXPR_CASES_OF_INPUTS(X, operation) EXPR_CASES_I(X, operation, 0) EXPR_CASES_I(X, operation, 1)

static inline bool expr_links_inputs(uint16_t operation) {
    return operation == EXPR_ADD || operation == EXPR_SUBTRACT || operation == EXPR_MULTIPLY;
}

struct expr_link_range {
    uint16_t first, operand_count; /* 0 and 0 for operations without links */
};
#define EXPR_RANGE_1(operation) [EXPR_##operation] = {EXPR_LINK_##operation, 1},
#define EXPR_RANGE_2(operation) [EXPR_##operation] = {EXPR_LINK_##operation, 2},
static const struct expr_link_range expr_link_ranges[EXPR_ALL_OPERATIONS] = {
    EXPR_RANGE_1(LOOP) EXPR_LINKED_1(EXPR_RANGE_1) EXPR_LINKED_2(EXPR_RANGE_2)[EXPR_SELECT] = {EXPR_LINK_SELECT, 3}};

/* The state of a pass that sets links from the last instruction to the first. Zero-initialise but for
 * constant_count and input_end. */
struct expr_linker {
    struct expr_instruction *later; /* set last; the origins of its operands are not known yet */
    unsigned ended;                 /* bit k: nothing after `later` reads the value of its operand k */
    uint32_t constant_count;
    uint32_t input_end; /* the inputs follow the constants up to here, and nothing else is stored there; or 0 */
};

/* Completes the link of `later`: the result of the instruction before it is in register `last`, or in none. */
static inline void expr_link_operands(const struct expr_linker *linker, uint32_t last) {
    struct expr_instruction *in = linker->later;
    if (!in || in->link == EXPR_UNLINKED)
        return;
    const uint16_t operands[3] = {in->a, in->b, in->c};
    const uint32_t count = expr_link_ranges[in->operation].operand_count, kinds = count == 2 ? 4 : 3;
    const uint32_t input_end = expr_links_inputs(in->operation) ? linker->input_end : 0;
    uint32_t origins = 0;
    for (uint32_t k = 0; k < count; k++)
        origins = kinds * origins + (operands[k] < linker->constant_count ? EXPR_FROM_K
                                     : operands[k] == last                ? EXPR_FROM_L
                                     : operands[k] < input_end            ? EXPR_FROM_I
                                                                          : EXPR_FROM_R);
    in->link = (uint16_t)(in->link + 2 * origins);
}

/* The step (EXPR_STEP_) of a linked instruction, EXPR_STEPS if it is none. */
static inline unsigned expr_step(const struct expr_instruction *in) {
    static const uint8_t numbers[] = {
        [EXPR_FROM_R] = EXPR_STEP_ADD_R, [EXPR_FROM_K] = EXPR_STEP_ADD_K, [EXPR_FROM_I] = EXPR_STEP_ADD_I};
    if (in->link == EXPR_UNLINKED || !expr_links_inputs(in->operation))
        return EXPR_STEPS;
    const unsigned origins = (unsigned)(in->link - expr_link_ranges[in->operation].first) / 2;
    const unsigned first = in->operation == EXPR_ADD        ? EXPR_STEP_ADD_R
                           : in->operation == EXPR_SUBTRACT ? EXPR_STEP_SUBTRACT_R
                                                            : EXPR_STEP_MULTIPLY_R;
    if (origins / 4 != EXPR_FROM_L || origins % 4 == EXPR_FROM_L)
        return EXPR_STEPS;
    return first + numbers[origins % 4];
}

static inline unsigned expr_is_stored(const struct expr_instruction *in) {
    return (unsigned)(in->link - expr_link_ranges[in->operation].first) % 2;
}

/* Makes pairs of linked instructions. */
static inline void expr_link_pairs(struct expr_instruction *code, uint32_t count) {
    for (uint32_t n = 0; n + 1 < count; n++) {
        const unsigned first = expr_step(&code[n]), second = expr_step(&code[n + 1]);
        if (first == EXPR_STEPS || second == EXPR_STEPS)
            continue;
        code[n].link = (uint16_t)EXPR_LINK_PAIR(first, second, expr_is_stored(&code[n]), expr_is_stored(&code[n + 1]));
        n++;
    }
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

#endif
