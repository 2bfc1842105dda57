/* The batch evaluator, compiled for the instruction set of the file that includes this one. Each operation is one loop
 * over the points, which the compiler vectorises; the loops come from the list of operations. Where there are vectors
 * of at least four points, linked instructions (expr_link_internal.h) keep results in processor registers. No result
 * depends on the number of points in a vector. */
#include "expr/expr_batch_internal.h"
#include "expr/expr_frames_internal.h"
#include "expr/expr_link_internal.h"
#include "math/elementary_lanes.h"
#include "math/lanes.h"
#include "math/noise_lanes.h"

#include <string.h>

/* Rows of doubles also store integers and truth values. */
typedef int64_t __attribute__((may_alias)) row_integer;

#define TYPE_F double
#define TYPE_I row_integer
#define TYPE_B row_integer
#define TYPE_N row_integer
/* The result may be stored over an operand. Each point only reads its own operands, so the loop has no dependency
 * between points. */
#if defined(__clang__)
#define INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define INDEPENDENT _Pragma("GCC ivdep")
#endif

/* Operands that are constant are a number in place of a row: bit k of `constant` of operand k, known when compiling. */
#define LOOP(bound, constant, A, B, C, expression)                                                                     \
    {                                                                                                                  \
        const TYPE_##A a0 = *as;                                                                                       \
        const TYPE_##B b0 = *bs;                                                                                       \
        const TYPE_##C c0 = *cs;                                                                                       \
        INDEPENDENT                                                                                                    \
        for (uint32_t i = 0; i < (bound); i++) {                                                                       \
            TYPE_##A a = (constant)&1 ? a0 : as[i];                                                                    \
            TYPE_##B b = (constant)&2 ? b0 : bs[i];                                                                    \
            TYPE_##C c = (constant)&4 ? c0 : cs[i];                                                                    \
            (void)a, (void)b, (void)c;                                                                                 \
            out[i] = (expression);                                                                                     \
        }                                                                                                              \
        (void)a0, (void)b0, (void)c0;                                                                                  \
    }
/* Without links, the common operations have loops of constant length, for each operand that may be constant; the others
 * have one loop, and their constants are copied into rows. */
static inline bool is_common(enum expr_operation operation) {
#if defined(LANES_AVX2)
    (void)operation;
    return false; /* they have links */
#else
    return operation == EXPR_ADD || operation == EXPR_SUBTRACT || operation == EXPR_MULTIPLY ||
           operation == EXPR_DIVIDE || operation == EXPR_NEGATE || operation == EXPR_ABS || operation == EXPR_SQRT ||
           operation == EXPR_MIN || operation == EXPR_MAX || operation == EXPR_LESS || operation == EXPR_LESS_EQUAL ||
           operation == EXPR_SELECT;
#endif
}

#define IS_CONSTANT(T, value) (EXPR_HAS_##T && (value) < constants)
#define RUN(member, name, R, A, B, C, expression)                                                                      \
    case member: {                                                                                                     \
        const uint32_t constant = (uint32_t)IS_CONSTANT(A, in->a) | (uint32_t)IS_CONSTANT(B, in->b) << 1 |             \
                                  (uint32_t)IS_CONSTANT(C, in->c) << 2;                                                \
        const double *from[3] = {operand(program, in->a, rows), operand(program, in->b, rows),                         \
                                 operand(program, in->c, rows)};                                                       \
        TYPE_##R *out = (TYPE_##R *)(void *)to;                                                                        \
        const TYPE_##A *as = (const TYPE_##A *)(const void *)from[0];                                                  \
        const TYPE_##B *bs = (const TYPE_##B *)(const void *)from[1];                                                  \
        const TYPE_##C *cs = (const TYPE_##C *)(const void *)from[2];                                                  \
        const bool is_whole = is_common(member) && width == EXPR_BATCH;                                                \
        if ((member == EXPR_SIN || member == EXPR_COS) && expr_is_pair(in, end)) {                                     \
            double *other = rows + (size_t)((++in)->out - constants) * EXPR_BATCH;                                     \
            run_sincos(from[0], width, member == EXPR_SIN ? to : other, member == EXPR_SIN ? other : to);              \
            break;                                                                                                     \
        }                                                                                                              \
        if (is_whole && constant == 0)                                                                                 \
            LOOP(EXPR_BATCH, 0, A, B, C, expression)                                                                   \
        else if (is_whole && !EXPR_HAS_##C && constant == 1)                                                           \
            LOOP(EXPR_BATCH, 1, A, B, C, expression)                                                                   \
        else if (is_whole && EXPR_HAS_##B && constant == 2)                                                            \
            LOOP(EXPR_BATCH, 2, A, B, C, expression)                                                                   \
        else if (is_whole && EXPR_HAS_##C && constant == 4)                                                            \
            LOOP(EXPR_BATCH, 4, A, B, C, expression)                                                                   \
        else {                                                                                                         \
            const double *ra = row_of(from[0], constant & 1, width, spare);                                            \
            const double *rb = row_of(from[1], constant & 2, width, spare + EXPR_BATCH);                               \
            const double *rc = row_of(from[2], constant & 4, width, spare + 2 * EXPR_BATCH);                           \
            as = (const TYPE_##A *)(const void *)ra;                                                                   \
            bs = (const TYPE_##B *)(const void *)rb;                                                                   \
            cs = (const TYPE_##C *)(const void *)rc;                                                                   \
            if (!run_lanes(member, ra, rb, rc, width, to))                                                             \
                LOOP(width, 0, A, B, C, expression)                                                                    \
        }                                                                                                              \
        break;                                                                                                         \
    }

/* The operand as a row. A constant is copied into all of `spare`. */
static inline const double *row_of(const double *from, uint32_t is_constant, uint32_t width, double *spare) {
    if (!is_constant)
        return from;
    row_integer *out = (row_integer *)(void *)spare, x = *(const row_integer *)(const void *)from;
    for (uint32_t i = 0; i < width; i++)
        out[i] = x;
    return spare;
}

/* Elementary functions and noise, with gathered tables: only where there are instructions for that. Points at which
 * the loop without branches does not apply are computed again one by one, from copies of the operands: the result may
 * have replaced them. */
#if defined(LANES_AVX2)
#define LANES(name, fits, of_lane, of_one)                                                                             \
    static void name(const double *as, const double *bs, const double *cs, uint32_t width, double *out) {              \
        double copies[3][EXPR_BATCH];                                                                                  \
        int64_t is_other = 0;                                                                                          \
        INDEPENDENT                                                                                                    \
        for (uint32_t i = 0; i < width; i++) {                                                                         \
            double a = as[i], b = bs[i], c = cs[i];                                                                    \
            (void)b, (void)c;                                                                                          \
            is_other |= (fits) ? 0 : -1;                                                                               \
        }                                                                                                              \
        for (int k = 0; k < 3 && is_other; k++)                                                                        \
            memcpy(copies[k], k == 0 ? as : k == 1 ? bs : cs, width * sizeof *as);                                     \
        INDEPENDENT                                                                                                    \
        for (uint32_t i = 0; i < width; i++) {                                                                         \
            double a = as[i], b = bs[i], c = cs[i];                                                                    \
            (void)b, (void)c;                                                                                          \
            out[i] = (of_lane);                                                                                        \
        }                                                                                                              \
        for (uint32_t i = 0; i < width && is_other; i++) {                                                             \
            double a = copies[0][i], b = copies[1][i], c = copies[2][i];                                               \
            (void)b, (void)c;                                                                                          \
            if (!(fits))                                                                                               \
                out[i] = (of_one);                                                                                     \
        }                                                                                                              \
    }
LANES(run_sin, el_angle_fits(a), el_sin_lane(a), el_sin(a))
LANES(run_cos, el_angle_fits(a), el_cos_lane(a), el_cos(a))
LANES(run_tan, el_angle_fits(a), el_tan_lane(a), el_tan(a))
LANES(run_exp, el_exp_fits(a), el_exp_lane(a), el_exp(a))
LANES(run_log, el_log_fits(a), el_log_lane(a), el_log(a))
LANES(run_power, el_pow_fits(a, b), el_pow_lane(a, b), el_pow(a, b))
LANES(run_noise_lanes, noise_fits(a, b, c), noise_perlin_lane(a, b, c), noise_perlin(a, b, c, 0))

static void run_noise(const double *as, const double *bs, const double *cs, uint32_t width, double *out) {
#if defined(LANES_AVX512)
    int64_t is_other = 0;
    INDEPENDENT
    for (uint32_t i = 0; i < width; i++)
        is_other |= noise_fits(as[i], bs[i], cs[i]) ? 0 : -1;
    const struct noise_table table = noise_table_make();
    for (uint32_t at = 0; at < width && !is_other; at += 32) {
        const double *const operands[3] = {as + at, bs + at, cs + at};
        noise_perlin_block(&table, operands, width - at < 32 ? (int)(width - at) / 8 : 4, out + at);
    }
    if (!is_other)
        return;
#endif
    run_noise_lanes(as, bs, cs, width, out);
}

#define CASE(member, name)                                                                                             \
    case member:                                                                                                       \
        name(as, bs, cs, width, out);                                                                                  \
        return true;
/* False: it is none of these. */
static inline bool run_lanes(enum expr_operation operation, const double *as, const double *bs, const double *cs,
                             uint32_t width, double *out) {
    switch ((unsigned)operation) {
        CASE(EXPR_SIN, run_sin)
        CASE(EXPR_COS, run_cos)
        CASE(EXPR_TAN, run_tan)
        CASE(EXPR_EXP, run_exp)
        CASE(EXPR_LOG, run_log)
        CASE(EXPR_POWER, run_power)
        CASE(EXPR_NOISE, run_noise)
    }
    return false;
}
#else
#define run_lanes(...) false
#endif

/* The sine and the cosine of one number. */
static void run_sincos(const double *from, uint32_t width, double *sines, double *cosines) {
    double copies[EXPR_BATCH]; /* a result may replace the operand */
    int64_t is_other = -1;
    memcpy(copies, from, width * sizeof *from);
#if defined(LANES_AVX2)
    is_other = 0;
    INDEPENDENT
    for (uint32_t i = 0; i < width; i++)
        is_other |= el_angle_fits(copies[i]) ? 0 : -1;
    INDEPENDENT
    for (uint32_t i = 0; i < width; i++)
        el_sincos_lane(copies[i], &sines[i], &cosines[i]);
#endif
    for (uint32_t i = 0; i < width && is_other; i++)
        el_sincos(copies[i], &sines[i], &cosines[i]);
}

/* An operand: the beginning of its row, or the constant. */
static inline const double *operand(const struct expr_program *program, uint16_t value, double *rows) {
    if (value >= program->constant_count)
        return rows + (size_t)(value - program->constant_count) * EXPR_BATCH;
    return &program->constants[value].f;
}

/* --- loops --- */

/* See EXPR_DEFINE_RUN. Of a loop, the points: `kept` has a row for each state, in the order at the start. Of the first
 * `width` lanes, points[i] is the point of lane i; alive[i] has all bits set if it has not ended. */
struct batch_frame {
    const struct expr_program *program;
    const struct expr_loop *loop;
    const struct expr_instruction *in;
    const struct expr_direct *direct;
    double *rows, *kept;
    uint32_t width, at;   /* `at`: the first lane of the vectors that are computed */
    uint32_t step, whole; /* the next one; the width at the start */
    uint32_t points[EXPR_BATCH];
    int64_t alive[EXPR_BATCH];
};

/* The states of points that have ended stay: `alive` has all bits set for the others. */
static void write_state(const struct expr_loop *loop, uint32_t k, uint32_t width, double *rows, const int64_t *alive) {
    const struct expr_program *body = &loop->body;
    row_integer *state = (row_integer *)(void *)(rows + (size_t)k * EXPR_BATCH);
    const row_integer *next = (const row_integer *)(const void *)operand(body, loop->next[k], rows);
    if (loop->next[k] == body->constant_count + k)
        return;
    if (loop->next[k] < body->constant_count) {
        const row_integer x = *next;
        for (uint32_t i = 0; i < width; i++)
            state[i] = (x & alive[i]) | (state[i] & ~alive[i]);
        return;
    }
    INDEPENDENT
    for (uint32_t i = 0; i < width; i++)
        state[i] = (next[i] & alive[i]) | (state[i] & ~alive[i]);
}

/* Keeps those whose first state is > 0; returns their number. */
static uint32_t keep_alive(const struct expr_loop *loop, uint32_t width, const double *rows, int64_t *alive) {
    const row_integer *integers = (const row_integer *)(const void *)rows;
    int64_t count = 0;
    if (loop->type[0] == EXPR_TYPE_F)
        for (uint32_t i = 0; i < width; i++)
            count -= alive[i] &= -(int64_t)(rows[i] > 0);
    else
        for (uint32_t i = 0; i < width; i++)
            count -= alive[i] &= -(int64_t)(integers[i] > 0);
    return (uint32_t)count;
}

static void keep_states(const struct batch_frame *f) {
    for (uint32_t k = 0; k < f->loop->state_count; k++)
        for (uint32_t i = 0; i < f->width; i++)
            f->kept[k * EXPR_BATCH + f->points[i]] = f->rows[k * EXPR_BATCH + i];
}

/* Moves the `count` points that have not ended to the first lanes; lanes up to a multiple of 16 repeat the first. */
static void pack(struct batch_frame *f, uint32_t count) {
    uint32_t from[EXPR_BATCH], filled = 0, width = (count + 15) & ~15U;
    keep_states(f);
    for (uint32_t i = 0; i < f->width; i++)
        if (f->alive[i])
            from[filled++] = i;
    for (; filled < width; filled++)
        from[filled] = from[0];
    for (uint32_t k = 0; k < f->loop->argument_count; k++) {
        double row[EXPR_BATCH], *values = f->rows + (size_t)k * EXPR_BATCH;
        for (uint32_t i = 0; i < width; i++)
            row[i] = values[from[i]];
        memcpy(values, row, width * sizeof *row);
    }
    for (uint32_t i = 0, first = f->points[from[0]]; i < width; i++) {
        f->points[i] = i < count ? f->points[from[i]] : first;
        f->alive[i] = -1;
    }
    f->width = width;
}

/* One of the instructions before and after a loop. */
static void run_loop_access(const struct expr_program *program, const struct expr_instruction *in, uint32_t width,
                            double *rows) {
    const struct expr_loop_access at = expr_loop_access(program, in);
    double *slot = rows + (size_t)(at.loop->offset + at.slot) * EXPR_BATCH;
    double *out = rows + (size_t)(in->out - program->constant_count) * EXPR_BATCH;
    if (!at.puts)
        memcpy(out, slot, width * sizeof *slot);
    else if (in->b >= program->constant_count)
        memcpy(slot, operand(program, in->b, rows), width * sizeof *slot);
    else
        (void)row_of(operand(program, in->b, rows), 1, width, slot);
}

/* Runs an instruction, or the two of a sine and a cosine; returns the last one. */
static inline const struct expr_instruction *
run_instruction(const struct expr_program *program, const struct expr_instruction *in, uint32_t width, double *rows) {
    double *spare = rows + (size_t)program->row_count * EXPR_BATCH;
    const uint32_t constants = program->constant_count;
    const struct expr_instruction *end = program->code + program->count;
    double *to = rows + (size_t)(in->out - constants) * EXPR_BATCH;
    switch ((enum expr_operation)in->operation) {
        EXPR_OPERATIONS(RUN)
    EXPR_LOOP_CASES:
        run_loop_access(program, in, width, rows);
        break;
    case EXPR_ALL_OPERATIONS:
    case EXPR_CONSTANT:
    case EXPR_INPUT:
    case EXPR_OPERATION_COUNT:
        break;
    }
    return in;
}

#if defined(LANES_AVX2)

__attribute__((noinline)) static const struct expr_instruction *
run_rows(const struct expr_program *program, const struct expr_instruction *in, uint32_t width, double *rows) {
    return run_instruction(program, in, width, rows);
}

/* In terms of vectors what EXPR_OPERATIONS says of numbers. */
#define LINKED_NEGATE(a) -(a)
#define LINKED_ABS(a) double_lanes_size(a)
#define LINKED_SQRT(a) double_lanes_root(a)
#define LINKED_FLOOR(a) double_lanes_floor(a)
#define LINKED_ADD(a, b) (a) + (b)
#define LINKED_SUBTRACT(a, b) (a) - (b)
#define LINKED_MULTIPLY(a, b) (a) * (b)
#define LINKED_DIVIDE(a, b) (a) / (b)
#define LINKED_MIN(a, b) double_lanes_min(b, a)
#define LINKED_MAX(a, b) double_lanes_max(b, a)
#define LINKED_LESS(a, b) double_lanes_of_mask(double_lanes_less(a, b))
#define LINKED_LESS_EQUAL(a, b) double_lanes_of_mask(double_lanes_less_equal(a, b))
#define LINKED_SELECT(a, b, c) double_lanes_choose(double_lanes_mask_of(a), b, c)

/* One vector, for a few points; sixteen points; and eight vectors, which AVX2 has registers for. */
#define VECTORS 1
#define EACH(X, ...) X(0, __VA_ARGS__)
#define RUN_LINKED run_one
#include "expr/expr_linked_kernel_internal.h"
#if defined(LANES_AVX512)
#define VECTORS 2
#define EACH(X, ...) X(0, __VA_ARGS__) X(1, __VA_ARGS__)
#else
#define VECTORS 4
#define EACH(X, ...) X(0, __VA_ARGS__) X(1, __VA_ARGS__) X(2, __VA_ARGS__) X(3, __VA_ARGS__)
#endif
#define RUN_LINKED run_few
#include "expr/expr_linked_kernel_internal.h"
#define VECTORS 8
#define EACH(X, ...)                                                                                                   \
    X(0, __VA_ARGS__)                                                                                                  \
    X(1, __VA_ARGS__)                                                                                                  \
    X(2, __VA_ARGS__)                                                                                                  \
    X(3, __VA_ARGS__) X(4, __VA_ARGS__) X(5, __VA_ARGS__) X(6, __VA_ARGS__) X(7, __VA_ARGS__)
#define RUN_LINKED run_many
#include "expr/expr_linked_kernel_internal.h"

/* How many of the points that are left are computed together. */
static inline uint32_t part_of(uint32_t left) {
    return left >= 8 * DOUBLE_LANES ? 8 * DOUBLE_LANES : left >= 16 ? 16 : DOUBLE_LANES;
}

/* Runs the part of the points from number `at` on: up to the next loop, or to the end: NULL. */
static inline const struct expr_instruction *run_part(const struct expr_program *program,
                                                      const struct expr_instruction *in, uint32_t at, uint32_t part,
                                                      double *rows, const struct expr_direct *direct) {
    return part == 8 * DOUBLE_LANES ? run_many(program, in, at, rows, direct)
           : part == 16             ? run_few(program, in, at, rows, direct)
                                    : run_one(program, in, at, rows, direct);
}

#else

static inline uint32_t part_of(uint32_t left) {
    return left;
}

static const struct expr_instruction *run_part(const struct expr_program *program, const struct expr_instruction *in,
                                               uint32_t at, uint32_t part, double *rows,
                                               const struct expr_direct *direct) {
    (void)at, (void)direct; /* for links only */
    for (const struct expr_instruction *end = program->code + program->count; in < end; in++) {
        if (in->operation == EXPR_LOOP)
            return in;
        in = run_instruction(program, in, part, rows);
    }
    return NULL;
}

#endif

/* --- programs --- */

static const struct expr_instruction *batch_continue(struct batch_frame *f) {
    const struct expr_instruction *in = f->in;
    while (f->at < f->width) {
        const uint32_t part = part_of(f->width - f->at);
        in = run_part(f->program, in, f->at, part, f->rows, f->direct);
        if (in)
            return in;
        in = f->program->code;
        f->at += part;
    }
    return NULL;
}

/* All points begin. */
static void batch_begin_loop(const struct batch_frame *f, struct batch_frame *inner) {
    static const struct expr_direct none = {.output = NULL};
    const struct expr_loop *loop = expr_loop_access(f->program, f->in).loop;
    inner->program = &loop->body;
    inner->loop = loop;
    inner->direct = &none;
    inner->rows = f->rows + f->at + (size_t)loop->offset * EXPR_BATCH;
    inner->width = part_of(f->width - f->at);
    inner->kept = inner->rows + (size_t)(expr_loop_rows(loop) / 2) * EXPR_BATCH;
    inner->step = loop->first;
    inner->whole = inner->width;
    for (uint32_t i = 0; i < inner->width; i++) {
        inner->points[i] = i;
        inner->alive[i] = -1;
    }
}

/* A step of the points that have not ended, in fewer vectors if half have. At the end the states return to their
 * points. */
static bool batch_begin_step(struct batch_frame *f) {
    const struct expr_loop *loop = f->loop;
    row_integer *steps = (row_integer *)(void *)(f->rows + (size_t)loop->argument_count * EXPR_BATCH);
    const bool is_checked = loop->ends && f->step > 1;
    const uint32_t count = f->step > loop->last ? 0
                           : is_checked         ? keep_alive(loop, f->width, f->rows, f->alive)
                                                : f->width;
    if (count == 0) {
        if (f->width < f->whole)
            keep_states(f);
        for (uint32_t k = 0; k < loop->state_count && f->width < f->whole; k++)
            memcpy(f->rows + (size_t)k * EXPR_BATCH, f->kept + (size_t)k * EXPR_BATCH, f->whole * sizeof *f->rows);
        return false;
    }
    if (((count + 15) & ~15U) <= f->width / 2)
        pack(f, count);
    const uint32_t step = f->step++, width = f->width;
    for (uint32_t i = 0; i < width; i++)
        steps[i] = step;
    f->at = 0;
    f->in = loop->body.code;
    return true;
}

static void batch_end_step(const struct batch_frame *f) {
    const struct expr_loop *loop = f->loop;
    const uint32_t width = f->width & ~(DOUBLE_LANES - 1U); /* which the compiler knows to be whole vectors */
    double *rows = f->rows;
    for (uint32_t k = 0; k < loop->state_count; k++)
        write_state(loop, k, width, rows, f->alive);
}

EXPR_DEFINE_RUN(batch)

__attribute__((noinline)) static void run_loops(const struct expr_program *program, uint32_t width, double *rows,
                                                const struct expr_direct *direct) {
    struct batch_frame frames[EXPR_FRAMES];
    frames[0].program = program;
    frames[0].loop = NULL;
    frames[0].in = program->code;
    frames[0].direct = direct;
    frames[0].rows = rows;
    frames[0].width = width;
    frames[0].at = 0;
    batch_run(frames);
}

void KERNEL(run)(const struct expr_program *program, uint32_t width, double *rows, const struct expr_direct *direct) {
    if (program->loop_count > 0) {
        run_loops(program, width, rows, direct);
        return;
    }
    for (uint32_t at = 0, part; at < width; at += part) {
        part = part_of(width - at);
        (void)run_part(program, program->code, at, part, rows, direct);
    }
}
