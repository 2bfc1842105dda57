/* A program for as many vectors of points as EACH names: the including file defines EACH(X, ...), which is X(k, ...)
 * for each of them, VECTORS, which is their number, and RUN_LINKED, the name of the function. The result of the
 * instruction before is in x0, x1, ..., which the compiler keeps in processor registers. Undefines all three. */

#define FROM_R(k, operand) LOAD(values + (size_t)in->operand * EXPR_BATCH + (k)*WIDTH)
#define FROM_K(k, operand) ALL(program->constants[in->operand].f)
#define FROM_L(k, operand) x##k
#define KEEP(k, to) STORE(to + (k)*WIDTH, x##k);
#define KEEP_0
#define KEEP_1                                                                                                         \
    double *const to = values + (size_t)in->out * EXPR_BATCH;                                                          \
    EACH(KEEP, to)

#define OPERATE_1(k, operation, oa) x##k = LINKED_##operation(FROM_##oa(k, a));
#define OPERATE_2(k, operation, oa, ob) x##k = LINKED_##operation(FROM_##oa(k, a), FROM_##ob(k, b));
#define OPERATE_3(k, oa, ob, oc) x##k = LINKED_SELECT(FROM_##oa(k, a), FROM_##ob(k, b), FROM_##oc(k, c));
#define CASE_1(operation, oa, stored)                                                                                  \
    case EXPR_LINK_1(operation, oa, stored): {                                                                         \
        EACH(OPERATE_1, operation, oa)                                                                                 \
        KEEP_##stored;                                                                                                 \
        break;                                                                                                         \
    }
#define CASE_2(operation, oa, ob, stored)                                                                              \
    case EXPR_LINK_2(operation, oa, ob, stored): {                                                                     \
        EACH(OPERATE_2, operation, oa, ob)                                                                             \
        KEEP_##stored;                                                                                                 \
        break;                                                                                                         \
    }
#define CASE_3(oa, ob, oc, stored)                                                                                     \
    case EXPR_LINK_3(oa, ob, oc, stored): {                                                                            \
        EACH(OPERATE_3, oa, ob, oc)                                                                                    \
        KEEP_##stored;                                                                                                 \
        break;                                                                                                         \
    }
#define DECLARE(k, zero) vector x##k = zero;
#define FORGET(k, zero) x##k = zero;

static void RUN_LINKED(const struct expr_program *program, double *rows) {
    double *const values = rows - (size_t)program->constant_count * EXPR_BATCH;
    EACH(DECLARE, ALL(0.0))
    for (const struct expr_instruction *in = program->code, *end = in + program->count; in < end; in++) {
        switch (in->link) {
        case EXPR_UNLINKED:
            in = run_rows(program, in, VECTORS * WIDTH, rows);
            EACH(FORGET, ALL(0.0)) /* not saved over the call */
            break;
            EXPR_LINK_CASES(CASE_1, CASE_2, CASE_3)
        default:
            __builtin_unreachable();
        }
    }
}

#undef FROM_R
#undef FROM_K
#undef FROM_L
#undef KEEP
#undef KEEP_0
#undef KEEP_1
#undef OPERATE_1
#undef OPERATE_2
#undef OPERATE_3
#undef CASE_1
#undef CASE_2
#undef CASE_3
#undef DECLARE
#undef FORGET
#undef EACH
#undef VECTORS
#undef RUN_LINKED
