/* Bounds over many boxes, compiled for the instruction set of the file that includes this one: arithmetic and choices
 * on vectors of boxes, everything else box by box with expr_interval_apply. The steps are those of expr_interval.c, and
 * so are the results. */
#include "expr/expr_interval_internal.h"
#include "expr/expr_vector_internal.h"

#include <string.h>

/* A number in all boxes: its ends, where a constant has the same vector for all of them, and whether it may be NaN. */
struct ends {
    const double *low, *high;
    uint32_t mask; /* of the index of a box: 0 of constants */
    uint64_t may_be_nan;
};

/* Lower ends of vectors, upper ends, of a constant. */
struct spare {
    double low[8], high[8];
} __attribute__((aligned(64)));

struct machine {
    const struct expr_program *program;
    double *rows;
    struct expr_flags *flags;
    uint32_t width;
    struct spare spare[3];
};

static inline struct ends number_of(struct machine *m, uint16_t value, int operand) {
    const uint32_t constants = m->program->constant_count;
    if (value >= constants) {
        const double *low = m->rows + (size_t)(value - constants) * 2 * EXPR_BOXES;
        return (struct ends){low, low + EXPR_BOXES, UINT32_MAX, m->flags[value - constants].first};
    }
    struct expr_interval x = expr_interval_of_float(m->program->constants[value].f);
    struct spare *spare = &m->spare[operand];
    for (int i = 0; i < 8; i++) {
        spare->low[i] = x.low;
        spare->high[i] = x.high;
    }
    return (struct ends){spare->low, spare->high, 0, -(uint64_t)x.may_be_nan};
}

static inline struct expr_flags truth_of(const struct machine *m, uint16_t value) {
    const uint32_t constants = m->program->constant_count;
    if (value >= constants)
        return m->flags[value - constants];
    uint64_t all = -(uint64_t)(m->program->constants[value].i != 0);
    return (struct expr_flags){all, all};
}

/* One box of an operand of any type. */
static struct expr_interval single(const struct machine *m, enum expr_type type, uint16_t value, uint32_t box) {
    const uint32_t constants = m->program->constant_count;
    if (type == EXPR_TYPE_N)
        return (struct expr_interval){0, 1, false};
    if (type == EXPR_TYPE_B) {
        struct expr_flags flags = truth_of(m, value);
        return (struct expr_interval){(double)(flags.first >> box & 1), (double)(flags.second >> box & 1), false};
    }
    if (value < constants)
        return type == EXPR_TYPE_F ? expr_interval_of_float(m->program->constants[value].f)
                                   : expr_interval_of_integer(m->program->constants[value].i);
    const double *low = m->rows + (size_t)(value - constants) * 2 * EXPR_BOXES;
    bool may_be_nan = type == EXPR_TYPE_F && m->flags[value - constants].first >> box & 1;
    return (struct expr_interval){low[box], low[box + EXPR_BOXES], may_be_nan};
}

static struct expr_flags run_singly(const struct machine *m, const struct expr_instruction *in, double *low,
                                    struct expr_choice *decided) {
    enum expr_operation operation = (enum expr_operation)in->operation;
    const uint16_t values[3] = {in->a, in->b, in->c};
    struct expr_flags out = {0, 0};
    int count = expr_operand_count(operation);
    for (uint32_t box = 0; box < m->width; box++) {
        struct expr_interval operands[3];
        for (int k = 0; k < 3; k++)
            operands[k] = single(m, k < count ? expr_operand_type(operation, k) : EXPR_TYPE_N, values[k], box);
        struct expr_interval result = expr_interval_apply(operation, operands[0], operands[1], operands[2]);
        struct expr_choice choice = expr_interval_decide(operation, operands[0], operands[1]);
        decided->first |= choice.first << box;
        decided->second |= choice.second << box;
        if (expr_result_type(operation) == EXPR_TYPE_B) {
            out.first |= (uint64_t)(result.low > 0) << box;
            out.second |= (uint64_t)(result.high > 0) << box;
            continue;
        }
        low[box] = result.low;
        low[box + EXPR_BOXES] = result.high;
        out.first |= (uint64_t)result.may_be_nan << box;
    }
    return out;
}

/* Of a loop, box by box. The ends of its arguments are in rows, those of truth values too. low: of the result. */
static struct expr_flags run_loop_operation(const struct machine *m, const struct expr_instruction *in, double *low) {
    const enum expr_operation operation = (enum expr_operation)in->operation;
    const struct expr_loop_access at = expr_loop_access(m->program, in);
    const struct expr_loop *loop = at.loop;
    const uint32_t slot = loop->offset + at.slot, values = loop->body.constant_count;
    double *rows = m->rows + (size_t)slot * 2 * EXPR_BOXES;
    struct expr_flags out = {0, 0};
    if (operation == EXPR_LOOP) {
        struct expr_interval *of_box =
            (struct expr_interval *)(void *)(rows + (size_t)(expr_loop_rows(loop) / 2) * 2 * EXPR_BOXES);
        for (uint32_t box = 0; box < m->width; box++) {
            for (uint32_t k = 0; k < loop->argument_count; k++) {
                const double *from = rows + (size_t)k * 2 * EXPR_BOXES;
                bool may_be_nan = m->flags[slot + k].first >> box & 1;
                of_box[values + k] = (struct expr_interval){from[box], from[box + EXPR_BOXES], may_be_nan};
            }
            expr_interval_loop(loop, loop->first, of_box);
            for (uint32_t k = 0; k < loop->state_count; k++) {
                double *to = rows + (size_t)k * 2 * EXPR_BOXES;
                struct expr_interval state = of_box[values + k];
                to[box] = state.low;
                to[box + EXPR_BOXES] = state.high;
                m->flags[slot + k].first =
                    (m->flags[slot + k].first & ~((uint64_t)1 << box)) | (uint64_t)state.may_be_nan << box;
            }
        }
        return out;
    }
    if (!at.puts) {
        memcpy(low, rows, 2 * EXPR_BOXES * sizeof *low);
        out.first = operation == EXPR_TAKE_TRUTH ? 0 : m->flags[slot].first;
        for (uint32_t box = 0; operation == EXPR_TAKE_TRUTH && box < m->width; box++) {
            out.first |= (uint64_t)(rows[box] > 0) << box;
            out.second |= (uint64_t)(rows[box + EXPR_BOXES] > 0) << box;
        }
        return out;
    }
    m->flags[slot].first = 0;
    for (uint32_t box = 0; box < m->width; box++) {
        struct expr_interval x = single(m, expr_operand_type(operation, 1), in->b, box);
        rows[box] = x.low;
        rows[box + EXPR_BOXES] = x.high;
        m->flags[slot].first |= (uint64_t)x.may_be_nan << box;
    }
    return out;
}

/* Where the flag is set any number is possible, and NaN. */
static void set_unknown(uint64_t unknown, double *low) {
    for (; unknown; unknown &= unknown - 1) {
        int box = __builtin_ctzll(unknown);
        low[box] = -(double)INFINITY;
        low[box + EXPR_BOXES] = (double)INFINITY;
    }
}

/* One loop over vectors of boxes: al, ah, bl, bh are the ends of the operands, lo and hi those of the result. */
#define EACH(body)                                                                                                     \
    for (uint32_t i = 0; i < width; i += WIDTH) {                                                                      \
        const vector al = LOAD(a.low + (i & a.mask)), ah = LOAD(a.high + (i & a.mask));                                \
        const vector bl = LOAD(b.low + (i & b.mask)), bh = LOAD(b.high + (i & b.mask));                                \
        vector lo, hi;                                                                                                 \
        (void)bl, (void)bh;                                                                                            \
        body;                                                                                                          \
        STORE(low + i, lo);                                                                                            \
        STORE(low + EXPR_BOXES + i, hi);                                                                               \
    }
/* A result that is not a number, or both infinities, may be anything. */
#define UNKNOWN(v) unknown |= IS_NAN(v) << i
#define BOXES(bits) ((bits) >> i)
#define LANES_OF(bits) ((bits) << i)

/* Of two registers, or a register and a constant. */
#define TWO                                                                                                            \
    struct ends a = number_of(m, in->a, 0), b = number_of(m, in->b, 1);                                                \
    out.first = a.may_be_nan | b.may_be_nan
#define ONE                                                                                                            \
    struct ends a = number_of(m, in->a, 0), b = a;                                                                     \
    out.first = a.may_be_nan

static inline __attribute__((always_inline)) void run_boxes(struct machine *m, const uint32_t width,
                                                            struct expr_choice *choices) {
    const struct expr_program *program = m->program;
    for (const struct expr_instruction *in = program->code, *end = in + program->count; in < end; in++) {
        const uint32_t number = (uint32_t)in->out - program->constant_count;
        double *low = m->rows + (size_t)number * 2 * EXPR_BOXES;
        struct expr_flags out = {0, 0};
        struct expr_choice decided = {0, 0};
        uint64_t unknown = 0;
        switch ((unsigned)in->operation) { /* no list: every other operation, new ones too, is right box by box */
        case EXPR_ADD: {
            TWO;
            EACH(lo = al + bl; hi = ah + bh; UNKNOWN(lo + hi); lo = below(lo); hi = above(hi))
            break;
        }
        case EXPR_SUBTRACT: {
            TWO;
            EACH(lo = al - bh; hi = ah - bl; UNKNOWN(lo + hi); lo = below(lo); hi = above(hi))
            break;
        }
        case EXPR_MULTIPLY: {
            TWO;
            if (in->a == in->b)
                EACH(const vector near = MAX_OF(MAX_OF(al, -ah), ALL(0)); const vector far = MAX_OF(-al, ah);
                     lo = below(near * near); hi = above(far * far))
            else
                EACH(const vector p = al * bl; const vector q = al * bh; const vector r = ah * bl;
                     const vector s = ah * bh; UNKNOWN(p + q + (r + s)); lo = below(MIN_OF(MIN_OF(p, q), MIN_OF(r, s)));
                     hi = above(MAX_OF(MAX_OF(p, q), MAX_OF(r, s))))
            break;
        }
        case EXPR_NEGATE: {
            ONE;
            EACH(lo = -ah; hi = -al)
            break;
        }
        case EXPR_COPY: {
            ONE;
            EACH(lo = al; hi = ah)
            break;
        }
        case EXPR_ABS: {
            ONE;
            EACH(lo = MAX_OF(MAX_OF(al, -ah), ALL(0)); hi = MAX_OF(-al, ah);
                 decided.first |= LANES_OF(IS_LESS(ALL(0), al)))
            break;
        }
        case EXPR_SQRT: {
            ONE;
            EACH(lo = below(ROOT_OF(MAX_OF(al, ALL(0)))); hi = above(ROOT_OF(ah));
                 unknown |= LANES_OF(IS_LESS(ah, ALL(0))); out.first |= LANES_OF(IS_LESS(al, ALL(0))))
            break;
        }
        case EXPR_MIN: {
            TWO;
            EACH(lo = MIN_OF(al, bl); hi = MIN_OF(ah, bh); decided.first |= LANES_OF(IS_LESS_EQUAL(ah, bl));
                 decided.second |= LANES_OF(IS_LESS(bh, al));
                 if (b.may_be_nan) hi = CHOOSE(BOXES(b.may_be_nan), ah, hi))
            decided.second &= ~out.first;
            out.first = a.may_be_nan;
            break;
        }
        case EXPR_MAX: {
            TWO;
            EACH(lo = MAX_OF(al, bl); hi = MAX_OF(ah, bh); decided.first |= LANES_OF(IS_LESS_EQUAL(bh, al));
                 decided.second |= LANES_OF(IS_LESS(ah, bl));
                 if (b.may_be_nan) lo = CHOOSE(BOXES(b.may_be_nan), al, lo))
            decided.second &= ~out.first;
            out.first = a.may_be_nan;
            break;
        }
        case EXPR_SELECT: {
            const struct expr_flags holds = truth_of(m, in->a);
            struct ends a = number_of(m, in->b, 0), b = number_of(m, in->c, 1);
            decided = (struct expr_choice){holds.first, ~holds.second};
            out.first = (a.may_be_nan & holds.second) | (b.may_be_nan & ~holds.first);
            EACH(lo = CHOOSE(BOXES(holds.first), al, CHOOSE(BOXES(holds.second), MIN_OF(al, bl), bl));
                 hi = CHOOSE(BOXES(holds.first), ah, CHOOSE(BOXES(holds.second), MAX_OF(ah, bh), bh)))
            break;
        }
        EXPR_LOOP_CASES:
            out = run_loop_operation(m, in, low);
            break;
        default:
            out = run_singly(m, in, low, &decided);
        }
        if (unknown) {
            set_unknown(unknown, low);
            out.first |= unknown;
        }
        m->flags[number] = out;
        if (choices)
            choices[in - program->code] = decided;
    }
}

void KERNEL(run_intervals)(const struct expr_program *program, uint32_t width, double *rows, struct expr_flags *flags,
                           struct expr_choice *choices) {
    struct machine m = {.program = program, .rows = rows, .flags = flags, .width = width};
    if (width == EXPR_BOXES)
        run_boxes(&m, EXPR_BOXES, choices);
    else
        run_boxes(&m, width, choices);
}
