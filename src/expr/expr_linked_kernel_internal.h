/* A program for as many vectors of points as EACH names: the including file defines EACH(X, ...), which is X(k, ...)
 * for each of them, VECTORS, which is their number, and RUN_LINKED, the name of the function. The result of the
 * instruction before is in x0, x1, ..., which the compiler keeps in processor registers. Undefines all three. */

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic" /* addresses of labels */

#define FROM_R(k, operand) double_lanes_load(operand + (k)*DOUBLE_LANES)
#define FROM_K(k, operand) double_lanes_all(constants[in->operand].f)
#define FROM_L(k, operand) x##k
#define FROM_I(k, operand) double_lanes_load_any(operand + (k)*DOUBLE_LANES)
#define KEEP(k, to) double_lanes_store(to + (k)*DOUBLE_LANES, x##k);
#define KEEP_0
#define KEEP_1                                                                                                         \
    double *const to = values + (size_t)in->out * EXPR_BATCH;                                                          \
    EACH(KEEP, to)
/* The row of an operand. The compiler shall keep its address in a processor register. */
#define ROW_R(operand)                                                                                                 \
    const double *operand = values + (size_t)in->operand * EXPR_BATCH;                                                 \
    __asm__("" : "+r"(operand));
#define ROW_I(operand)                                                                                                 \
    const double *operand = inputs[in->operand - input_begin] + at;                                                    \
    __asm__("" : "+r"(operand));
#define ROW_K(operand)
#define ROW_L(operand)

#define OPERATE_1(k, operation, oa) x##k = LINKED_##operation(FROM_##oa(k, a));
#define OPERATE_2(k, operation, oa, ob) x##k = LINKED_##operation(FROM_##oa(k, a), FROM_##ob(k, b));
#define OPERATE_3(k, oa, ob, oc) x##k = LINKED_SELECT(FROM_##oa(k, a), FROM_##ob(k, b), FROM_##oc(k, c));
#define TARGET_1(operation, oa, stored)                                                                                \
    operation##_##oa##_##stored : {                                                                                    \
        ROW_##oa(a) EACH(OPERATE_1, operation, oa) KEEP_##stored;                                                      \
        NEXT                                                                                                           \
    }
#define TARGET_2(operation, oa, ob, stored)                                                                            \
    operation##_##oa##_##ob##_##stored : {                                                                             \
        ROW_##oa(a) ROW_##ob(b) EACH(OPERATE_2, operation, oa, ob) KEEP_##stored;                                      \
        NEXT                                                                                                           \
    }
#define TARGET_3(oa, ob, oc, stored)                                                                                   \
    SELECT_##oa##_##ob##_##oc##_##stored : {                                                                           \
        ROW_##oa(a) ROW_##ob(b) ROW_##oc(c) EACH(OPERATE_3, oa, ob, oc) KEEP_##stored;                                 \
        NEXT                                                                                                           \
    }
#define TARGET_PAIR(o, ob, first_stored, p, pb, stored)                                                                \
    PAIR_##o##_##ob##_##first_stored##_##p##_##pb##_##stored : {                                                       \
        {ROW_##ob(b) EACH(OPERATE_2, o, L, ob) KEEP_##first_stored} in++;                                              \
        ROW_##pb(b) EACH(OPERATE_2, p, L, pb) KEEP_##stored;                                                           \
        NEXT                                                                                                           \
    }
#if VECTORS == 8
#define PAIR_ADDRESS EXPR_ADDRESS_PAIR
#define PAIR_TARGETS EXPR_PAIR_CASES(TARGET_PAIR)
#else
#define PAIR_ADDRESS EXPR_ADDRESS_FIRST
#define PAIR_TARGETS
#endif
#define NEXT                                                                                                           \
    if (++in >= end)                                                                                                   \
        goto done;                                                                                                     \
    EXPR_JUMP
#define DECLARE(k, zero) double_lanes x##k = zero;
#define FORGET(k, zero) x##k = zero;
#define PUT(k, to) double_lanes_store_any(to + (k)*DOUBLE_LANES, x##k);

/* Points from number `at` on, up to the next loop, or to the end: NULL. rows: of the first point. */
static const struct expr_instruction *RUN_LINKED(const struct expr_program *program, const struct expr_instruction *in,
                                                 uint32_t at, double *rows, const struct expr_direct *direct) {
    const double *const *const inputs = direct->inputs;
    const uint32_t input_begin = program->constant_count;
    const union expr_value *const constants = program->constants;
    double *const values = rows + at - (size_t)program->constant_count * EXPR_BATCH;
    const struct expr_instruction *const end = program->code + program->count;
    EACH(DECLARE, double_lanes_all(0.0))
    if (in >= end)
        goto done;
    EXPR_JUMPS(EXPR_LINK_ADDRESSES EXPR_PAIR_CASES(PAIR_ADDRESS))
done:
    if (direct->output) {
        EACH(PUT, direct->output + at)
    }
    return NULL;
LOOP:
    return in;
UNLINKED:
    in = run_rows(program, in, VECTORS * DOUBLE_LANES, rows + at);
    EACH(FORGET, double_lanes_all(0.0)) /* not saved over the call */
    NEXT EXPR_LINK_CASES(TARGET_1, TARGET_2, TARGET_3) PAIR_TARGETS
}

#undef FROM_R
#undef FROM_K
#undef FROM_L
#undef FROM_I
#undef KEEP
#undef KEEP_0
#undef KEEP_1
#undef OPERATE_1
#undef OPERATE_2
#undef OPERATE_3
#undef TARGET_1
#undef TARGET_2
#undef TARGET_3
#undef NEXT
#undef TARGET_PAIR
#undef PAIR_ADDRESS
#undef PAIR_TARGETS
#undef DECLARE
#undef FORGET
#undef PUT
#undef EACH
#undef VECTORS
#undef RUN_LINKED
#pragma GCC diagnostic pop
