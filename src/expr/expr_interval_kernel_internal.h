/* Bounds over many boxes, compiled for the instruction set of the file that includes this one: arithmetic and choices
 * on vectors of boxes, everything else box by box with expr_interval_apply. Loops repeat their bodies over all boxes.
 * The steps are those of expr_interval.c, and so are the results. */
#include "expr/expr_frames_internal.h"
#include "expr/expr_interval_internal.h"
#include "expr/expr_outwards_internal.h"

#include <float.h>
#include <math.h>
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

static inline struct ends ends_of(struct machine *m, uint16_t value, int operand, bool is_float) {
    const uint32_t constants = m->program->constant_count;
    if (value >= constants) {
        const double *low = m->rows + (size_t)(value - constants) * 2 * EXPR_BOXES;
        return (struct ends){low, low + EXPR_BOXES, UINT32_MAX, m->flags[value - constants].first};
    }
    const union expr_value constant = m->program->constants[value];
    struct expr_interval x = is_float ? expr_interval_of_float(constant.f) : expr_interval_of_integer(constant.i);
    struct spare *spare = &m->spare[operand];
    for (int i = 0; i < 8; i++) {
        spare->low[i] = x.low;
        spare->high[i] = x.high;
    }
    return (struct ends){spare->low, spare->high, 0, -(uint64_t)x.may_be_nan};
}

static inline struct ends number_of(struct machine *m, uint16_t value, int operand) {
    return ends_of(m, value, operand, true);
}

static inline struct ends integer_of(struct machine *m, uint16_t value, int operand) {
    return ends_of(m, value, operand, false);
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

/* One of the instructions before and after a loop. The ends of its arguments are in rows, those of truth values too.
 * low: of the result. */
static struct expr_flags run_loop_access(const struct machine *m, const struct expr_instruction *in, double *low) {
    const enum expr_operation operation = (enum expr_operation)in->operation;
    const struct expr_loop_access at = expr_loop_access(m->program, in);
    const uint32_t slot = at.loop->offset + at.slot;
    double *rows = m->rows + (size_t)slot * 2 * EXPR_BOXES;
    struct expr_flags out = {0, 0};
    /* Takes: the row of the state is the result. */
    if (!at.puts) {
        memcpy(low, rows, 2 * EXPR_BOXES * sizeof *low);
        out.first = operation == EXPR_TAKE_TRUTH ? 0 : m->flags[slot].first;
        for (uint32_t box = 0; operation == EXPR_TAKE_TRUTH && box < m->width; box++) {
            out.first |= (uint64_t)(rows[box] > 0) << box;
            out.second |= (uint64_t)(rows[box + EXPR_BOXES] > 0) << box;
        }
        return out;
    }
    /* Puts: the operand becomes the row. */
    m->flags[slot] = (struct expr_flags){0, 0};
    for (uint32_t box = 0; box < m->width; box++) {
        struct expr_interval x = single(m, expr_operand_type(operation, 1), in->b, box);
        rows[box] = x.low;
        rows[box + EXPR_BOXES] = x.high;
        m->flags[slot].first |= (uint64_t)x.may_be_nan << box;
        if (operation == EXPR_PUT_TRUTH)
            m->flags[slot].first |= (uint64_t)(x.low > 0) << box;
        if (operation == EXPR_PUT_TRUTH)
            m->flags[slot].second |= (uint64_t)(x.high > 0) << box;
    }
    return out;
}

/* --- loops --- */

/* See EXPR_DEFINE_RUN. A loop over many boxes: lane i of the first m.width is the box boxes[i]. As in a batch of
 * points, boxes that have ended leave: the others move to the first lanes. */
struct boxes_frame {
    const struct expr_loop *loop;
    const struct expr_instruction *in;
    struct expr_choice *choices;
    struct machine m;                            /* of the body; its first rows are the states */
    uint32_t step;                               /* the next one */
    double *ended;                               /* rows of the final states, by box */
    uint64_t may_be_nan[EXPR_STATES], has_ended; /* of `ended`, by box */
    uint64_t active;                             /* lanes whose boxes have points that go on */
    uint32_t boxes[EXPR_BOXES];
};

static inline double *state_row(const struct boxes_frame *l, uint32_t k) {
    return l->m.rows + (size_t)k * 2 * EXPR_BOXES;
}

/* An argument in a lane. The second flag is that of truth values only, and set where the first one is. */
static inline struct expr_interval argument_of(const struct boxes_frame *l, uint32_t k, uint32_t lane) {
    const double *row = state_row(l, k);
    const struct expr_flags flags = l->m.flags[k];
    return (struct expr_interval){row[lane], row[lane + EXPR_BOXES], (flags.first & ~flags.second) >> lane & 1};
}

/* The final states of a box, with those that points have which end now in this lane. */
static void end_with(struct boxes_frame *l, uint32_t lane, const struct expr_interval *first) {
    const uint32_t box = l->boxes[lane];
    const bool has_ended = l->has_ended >> box & 1;
    for (uint32_t k = 0; k < l->loop->state_count; k++) {
        const struct expr_interval state = first && k == 0 ? *first : argument_of(l, k, lane);
        double *row = l->ended + (size_t)k * 2 * EXPR_BOXES;
        row[box] = has_ended ? math_min(row[box], state.low) : state.low;
        row[box + EXPR_BOXES] = has_ended ? math_max(row[box + EXPR_BOXES], state.high) : state.high;
        l->may_be_nan[k] |= (uint64_t)state.may_be_nan << box;
    }
    l->has_ended |= (uint64_t)1 << box;
}

/* Lanes whose row of these numbers is below (or, for -1, above) a limit. */
static inline uint64_t lanes_beyond(const double *row, double sign, double limit, uint32_t width) {
    uint64_t lanes = 0;
    for (uint32_t i = 0; i < width; i += DOUBLE_LANES)
        lanes |= IS_LESS(double_lanes_load(row + i) * double_lanes_all(sign), double_lanes_all(limit)) << i;
    return lanes;
}

/* Ends the points whose first state is not > 0. */
static void end_some(struct boxes_frame *l) {
    double *low = state_row(l, 0), *high = low + EXPR_BOXES;
    const bool is_integer = l->loop->type[0] == EXPR_TYPE_I;
    const uint64_t may_be_nan = is_integer ? 0 : l->m.flags[0].first;
    uint64_t may_end = (may_be_nan | ~lanes_beyond(low, -1, 0, l->m.width)) & l->active;
    for (; may_end; may_end &= may_end - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctzll(may_end);
        const uint64_t bit = (uint64_t)1 << lane;
        struct expr_interval first = {low[lane], high[lane], (may_be_nan & bit) != 0};
        const bool goes_on = expr_may_go_on(first);
        first.high = math_min(first.high, math_max(first.low, 0));
        end_with(l, lane, &first);
        if (goes_on) {
            low[lane] = math_max(first.low, is_integer);
            l->m.flags[0].first &= ~bit;
        } else
            l->active &= ~bit;
    }
}

/* Lanes with a number of which nothing is known. */
static uint64_t lost_lanes(const struct boxes_frame *l) {
    uint64_t lost = 0;
    for (uint32_t k = 0; k < l->loop->state_count; k++)
        if (l->loop->type[k] == EXPR_TYPE_F)
            lost |= lanes_beyond(state_row(l, k), 1, -DBL_MAX, l->m.width) &
                    lanes_beyond(state_row(l, k) + EXPR_BOXES, -1, -DBL_MAX, l->m.width);
    return lost & l->active;
}

/* All other steps at once in these lanes, one after the other. */
static void run_rest(struct boxes_frame *l, uint64_t lanes, uint32_t step) {
    const struct expr_loop *loop = l->loop;
    struct expr_interval ended[EXPR_STATES];
    struct expr_interval *values =
        (struct expr_interval *)(void *)(l->ended + (size_t)loop->state_count * 2 * EXPR_BOXES);
    l->active &= ~lanes;
    for (; lanes; lanes &= lanes - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctzll(lanes), box = l->boxes[lane];
        for (uint32_t k = 0; k < loop->argument_count; k++)
            values[loop->body.constant_count + k] = argument_of(l, k, lane);
        for (uint32_t k = 0; k < loop->state_count; k++) {
            const double *row = l->ended + (size_t)k * 2 * EXPR_BOXES;
            ended[k] = (struct expr_interval){row[box], row[box + EXPR_BOXES], l->may_be_nan[k] >> box & 1};
        }
        expr_interval_loop_rest(loop, step, l->has_ended >> box & 1, ended, values);
        for (uint32_t k = 0; k < loop->state_count; k++) {
            double *row = l->ended + (size_t)k * 2 * EXPR_BOXES;
            row[box] = ended[k].low;
            row[box + EXPR_BOXES] = ended[k].high;
            l->may_be_nan[k] = (l->may_be_nan[k] & ~((uint64_t)1 << box)) | (uint64_t)ended[k].may_be_nan << box;
        }
    }
}

/* Moves the active lanes to the first ones; those up to a multiple of 8 repeat the first. */
static void pack(struct boxes_frame *l) {
    uint32_t from[EXPR_BOXES], count = 0;
    for (uint64_t lanes = l->active; lanes; lanes &= lanes - 1)
        from[count++] = (uint32_t)__builtin_ctzll(lanes);
    const uint32_t width = (count + 7) & ~7U;
    for (uint32_t i = count; i < width; i++)
        from[i] = from[0];
    for (uint32_t k = 0; k < l->loop->argument_count; k++) {
        double *low = state_row(l, k);
        const struct expr_flags old = l->m.flags[k];
        struct expr_flags packed = {0, 0};
        for (uint32_t i = 0; i < width; i++) { /* from[i] >= i, but for those that repeat the first */
            packed.first |= (old.first >> from[i] & 1) << i;
            packed.second |= (old.second >> from[i] & 1) << i;
            low[i] = low[i < count ? from[i] : 0];
            low[i + EXPR_BOXES] = low[(i < count ? from[i] : 0) + EXPR_BOXES];
        }
        l->m.flags[k] = packed;
    }
    for (uint32_t i = 0; i < count; i++)
        l->boxes[i] = l->boxes[from[i]];
    l->active = count < EXPR_BOXES ? ((uint64_t)1 << count) - 1 : UINT64_MAX;
    l->m.width = width;
}

/* The next value of a state becomes the state. */
static void write_state(struct boxes_frame *l, uint32_t k) {
    const struct expr_program *body = &l->loop->body;
    const uint16_t next = l->loop->next[k];
    const enum expr_type type = l->loop->type[k];
    double *row = state_row(l, k);
    if (next == body->constant_count + k)
        return;
    if (type != EXPR_TYPE_B && next >= body->constant_count) {
        memcpy(row, l->m.rows + (size_t)(next - body->constant_count) * 2 * EXPR_BOXES, 2 * EXPR_BOXES * sizeof *row);
        l->m.flags[k] = l->m.flags[next - body->constant_count];
        return;
    }
    struct expr_flags flags = type == EXPR_TYPE_B ? truth_of(&l->m, next) : (struct expr_flags){0, 0};
    for (uint32_t lane = 0; lane < l->m.width; lane++) {
        struct expr_interval x = single(&l->m, type, next, lane);
        row[lane] = x.low;
        row[lane + EXPR_BOXES] = x.high;
        flags.first |= (uint64_t)x.may_be_nan << lane;
    }
    l->m.flags[k] = flags;
}

/* Ends the boxes that do not begin this step. The steps are those of expr_interval_loop in each box. */
static void end_boxes(struct boxes_frame *l, uint32_t step) {
    const struct expr_loop *loop = l->loop;
    if (step > 1 && loop->ends)
        end_some(l);
    if (step > loop->last) {
        for (; l->active; l->active &= l->active - 1)
            end_with(l, (uint32_t)__builtin_ctzll(l->active), NULL);
    } else if (step - loop->first >= EXPR_EXACT_STEPS) {
        run_rest(l, l->active, step);
    } else if (step - loop->first >= 32) {
        run_rest(l, lost_lanes(l), step);
    }
}

static void boxes_begin_loop(const struct boxes_frame *outer, struct boxes_frame *l) {
    const struct machine *m = &outer->m;
    const struct expr_loop *loop = expr_loop_access(m->program, outer->in).loop;
    l->loop = loop;
    l->choices = NULL;
    l->m.program = &loop->body;
    l->m.rows = m->rows + (size_t)loop->offset * 2 * EXPR_BOXES;
    l->m.flags = m->flags + loop->offset;
    l->m.width = m->width;
    l->step = loop->first;
    l->ended = l->m.rows + (size_t)(expr_loop_rows(loop) / 2) * 2 * EXPR_BOXES;
    memset(l->may_be_nan, 0, loop->state_count * sizeof *l->may_be_nan);
    l->has_ended = 0;
    l->active = m->width < EXPR_BOXES ? ((uint64_t)1 << m->width) - 1 : UINT64_MAX;
    for (uint32_t i = 0; i < m->width; i++)
        l->boxes[i] = i;
}

static bool boxes_begin_step(struct boxes_frame *l) {
    const struct expr_loop *loop = l->loop;
    end_boxes(l, l->step);
    /* All have ended. */
    if (!l->active) {
        memcpy(l->m.rows, l->ended, (size_t)loop->state_count * 2 * EXPR_BOXES * sizeof *l->ended);
        for (uint32_t k = 0; k < loop->state_count; k++)
            l->m.flags[k] = (struct expr_flags){l->may_be_nan[k], 0};
        return false;
    }
    /* The others. */
    if (((uint32_t)__builtin_popcountll(l->active) + 7) / 8 <= l->m.width / 16)
        pack(l);
    double *row = state_row(l, loop->argument_count);
    for (uint32_t lane = 0; lane < l->m.width; lane++)
        row[lane] = row[lane + EXPR_BOXES] = l->step;
    l->m.flags[loop->argument_count] = (struct expr_flags){0, 0};
    l->in = loop->body.code;
    l->step++;
    return true;
}

static void boxes_end_step(struct boxes_frame *l) {
    for (uint32_t k = 0; k < l->loop->state_count; k++)
        write_state(l, k);
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
    for (uint32_t i = 0; i < width; i += DOUBLE_LANES) {                                                               \
        const double_lanes al = double_lanes_load(a.low + (i & a.mask)),                                               \
                           ah = double_lanes_load(a.high + (i & a.mask));                                              \
        const double_lanes bl = double_lanes_load(b.low + (i & b.mask)),                                               \
                           bh = double_lanes_load(b.high + (i & b.mask));                                              \
        double_lanes lo, hi;                                                                                           \
        (void)bl, (void)bh;                                                                                            \
        body;                                                                                                          \
        double_lanes_store(low + i, lo);                                                                               \
        double_lanes_store(low + EXPR_BOXES + i, hi);                                                                  \
    }
#define COMPARE(body)                                                                                                  \
    for (uint32_t i = 0; i < width; i += DOUBLE_LANES) {                                                               \
        const double_lanes al = double_lanes_load(a.low + (i & a.mask)),                                               \
                           ah = double_lanes_load(a.high + (i & a.mask));                                              \
        const double_lanes bl = double_lanes_load(b.low + (i & b.mask)),                                               \
                           bh = double_lanes_load(b.high + (i & b.mask));                                              \
        body;                                                                                                          \
    }
/* Of numbers: true for all of both intervals, and for some; a NaN makes it false. */
#define ORDER(is)                                                                                                      \
    TWO;                                                                                                               \
    const uint64_t may_be_nan = out.first;                                                                             \
    out.first = 0;                                                                                                     \
    COMPARE(out.first |= LANES_OF(is(ah, bl)); out.second |= LANES_OF(is(al, bh)))                                     \
    out.first &= ~may_be_nan;
/* Ends of integers that doubles do not represent exactly mean any integer. */
#define INTEGERS                                                                                                       \
    const double_lanes_mask is_exact = double_lanes_both(double_lanes_less_equal(double_lanes_all(-0x1p53), lo),       \
                                                         double_lanes_less_equal(hi, double_lanes_all(0x1p53)));       \
    lo = double_lanes_choose(is_exact, lo, double_lanes_all(-0x1p63));                                                 \
    hi = double_lanes_choose(is_exact, hi, double_lanes_all(0x1p63))
/* A result that is not a number, or both infinities, may be anything. */
#define UNKNOWN(v) unknown |= IS_NAN(v) << i
#define BOXES(bits) ((bits) >> i)
#define LANES_OF(bits) ((bits) << i)

/* Of two registers, or a register and a constant. */
#define TWO                                                                                                            \
    struct ends a = number_of(m, in->a, 0), b = number_of(m, in->b, 1);                                                \
    out.first = a.may_be_nan | b.may_be_nan
#define TWO_INTEGERS struct ends a = integer_of(m, in->a, 0), b = integer_of(m, in->b, 1)
#define ONE                                                                                                            \
    struct ends a = number_of(m, in->a, 0), b = a;                                                                     \
    out.first = a.may_be_nan

static inline __attribute__((always_inline)) const struct expr_instruction *
run_boxes(struct machine *m, const struct expr_instruction *in, const uint32_t width, struct expr_choice *choices) {
    const struct expr_program *program = m->program;
    for (const struct expr_instruction *end = program->code + program->count; in < end; in++) {
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
                EACH(const double_lanes near = double_lanes_max(double_lanes_max(al, -ah), double_lanes_all(0));
                     const double_lanes far = double_lanes_max(-al, ah); lo = below(near * near); hi = above(far * far))
            else
                EACH(const double_lanes p = al * bl; const double_lanes q = al * bh; const double_lanes r = ah * bl;
                     const double_lanes s = ah * bh; UNKNOWN(p + q + (r + s));
                     lo = below(double_lanes_min(double_lanes_min(p, q), double_lanes_min(r, s)));
                     hi = above(double_lanes_max(double_lanes_max(p, q), double_lanes_max(r, s))))
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
            EACH(lo = double_lanes_max(double_lanes_max(al, -ah), double_lanes_all(0)); hi = double_lanes_max(-al, ah);
                 decided.first |= LANES_OF(IS_LESS(double_lanes_all(0), al)))
            break;
        }
        case EXPR_SQRT: {
            ONE;
            EACH(lo = below(double_lanes_root(double_lanes_max(al, double_lanes_all(0))));
                 hi = above(double_lanes_root(ah)); unknown |= LANES_OF(IS_LESS(ah, double_lanes_all(0)));
                 out.first |= LANES_OF(IS_LESS(al, double_lanes_all(0))))
            break;
        }
        case EXPR_MIN: {
            TWO;
            EACH(lo = double_lanes_min(al, bl); hi = double_lanes_min(ah, bh);
                 decided.first |= LANES_OF(IS_LESS_EQUAL(ah, bl)); decided.second |= LANES_OF(IS_LESS(bh, al));
                 if (b.may_be_nan) hi = double_lanes_choose_bits(BOXES(b.may_be_nan), ah, hi))
            decided.second &= ~out.first;
            out.first = a.may_be_nan;
            break;
        }
        case EXPR_MAX: {
            TWO;
            EACH(lo = double_lanes_max(al, bl); hi = double_lanes_max(ah, bh);
                 decided.first |= LANES_OF(IS_LESS_EQUAL(bh, al)); decided.second |= LANES_OF(IS_LESS(ah, bl));
                 if (b.may_be_nan) lo = double_lanes_choose_bits(BOXES(b.may_be_nan), al, lo))
            decided.second &= ~out.first;
            out.first = a.may_be_nan;
            break;
        }
        case EXPR_FLOOR: {
            ONE;
            EACH(lo = double_lanes_floor(al); hi = double_lanes_floor(ah))
            break;
        }
        case EXPR_INTEGER_ADD: {
            TWO_INTEGERS;
            EACH(lo = al + bl; hi = ah + bh; INTEGERS)
            break;
        }
        case EXPR_INTEGER_SUBTRACT: {
            TWO_INTEGERS;
            EACH(lo = al - bh; hi = ah - bl; INTEGERS)
            break;
        }
        case EXPR_TO_FLOAT: {
            struct ends a = integer_of(m, in->a, 0), b = a;
            EACH(lo = al; hi = ah)
            break;
        }
        case EXPR_LESS: {
            ORDER(IS_LESS)
            break;
        }
        case EXPR_LESS_EQUAL: {
            ORDER(IS_LESS_EQUAL)
            break;
        }
        case EXPR_SELECT:
        case EXPR_INTEGER_SELECT: {
            const bool is_float = in->operation == EXPR_SELECT;
            const struct expr_flags holds = truth_of(m, in->a);
            struct ends a = ends_of(m, in->b, 0, is_float), b = ends_of(m, in->c, 1, is_float);
            decided = (struct expr_choice){holds.first, ~holds.second};
            out.first = (a.may_be_nan & holds.second) | (b.may_be_nan & ~holds.first);
            EACH(lo = double_lanes_choose_bits(
                     BOXES(holds.first), al,
                     double_lanes_choose_bits(BOXES(holds.second), double_lanes_min(al, bl), bl));
                 hi = double_lanes_choose_bits(
                     BOXES(holds.first), ah,
                     double_lanes_choose_bits(BOXES(holds.second), double_lanes_max(ah, bh), bh)))
            break;
        }
        EXPR_LOOP_CASES : {
            if (choices)
                choices[in - program->code] = decided;
            if (in->operation == EXPR_LOOP)
                return in;
            out = run_loop_access(m, in, low);
            break;
        }
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
    return NULL;
}

static const struct expr_instruction *boxes_continue(struct boxes_frame *l) {
    if (l->m.width == EXPR_BOXES)
        return run_boxes(&l->m, l->in, EXPR_BOXES, l->choices);
    return run_boxes(&l->m, l->in, l->m.width, l->choices);
}

EXPR_DEFINE_RUN(boxes)

void KERNEL(run_intervals)(const struct expr_program *program, uint32_t width, double *rows, struct expr_flags *flags,
                           struct expr_choice *choices) {
    struct boxes_frame frames[EXPR_FRAMES];
    frames[0].loop = NULL;
    frames[0].in = program->code;
    frames[0].choices = choices;
    frames[0].m.program = program;
    frames[0].m.rows = rows;
    frames[0].m.flags = flags;
    frames[0].m.width = width;
    boxes_run(frames);
}
