/* Values with derivatives: the chain rule, operation by operation. Over a box, the slope of a function of one
 * operand is between the derivatives at the points of the operand's bounds (mean value theorem). Edges and jumps
 * that the box may contain are covered: the slope of a min or max is between those of its operands, the slope of a
 * jump is unbounded. */
#include "expr/expr_derivative.h"

#include "expr/expr_derivative_internal.h"
#include "expr/expr_frames_internal.h"
#include "expr/expr_slopes_internal.h"

#include <float.h>
#include <string.h>

enum { D = EXPR_DIRECTIONS };

const double expr_gradient_seeds[EXPR_INPUT_COUNT][EXPR_DIRECTIONS] = {
    [EXPR_POINT_X] = {1, 0, 0}, [EXPR_POINT_Y] = {0, 1, 0}, [EXPR_POINT_Z] = {0, 0, 1}};

/* --- at points --- */

struct dual {
    union expr_value value;
    double d[D];
};

/* Operations that are constant between jumps. */
#define STEPS(X)                                                                                                       \
    X(EXPR_FLOOR_DIVIDE)                                                                                               \
    X(EXPR_FLOOR)                                                                                                      \
    X(EXPR_CEIL)                                                                                                       \
    X(EXPR_HASH)                                                                                                       \
    X(EXPR_CELL_ID)                                                                                                    \
    X(EXPR_INTEGER_ADD)                                                                                                \
    X(EXPR_INTEGER_SUBTRACT)                                                                                           \
    X(EXPR_INTEGER_MULTIPLY)                                                                                           \
    X(EXPR_INTEGER_DIVIDE)                                                                                             \
    X(EXPR_INTEGER_MODULO)                                                                                             \
    X(EXPR_INTEGER_REMAINDER)                                                                                          \
    X(EXPR_INTEGER_NEGATE)                                                                                             \
    X(EXPR_BIT_AND)                                                                                                    \
    X(EXPR_BIT_OR)                                                                                                     \
    X(EXPR_BIT_XOR)                                                                                                    \
    X(EXPR_BIT_NOT)                                                                                                    \
    X(EXPR_SHIFT_LEFT)                                                                                                 \
    X(EXPR_SHIFT_RIGHT)                                                                                                \
    X(EXPR_TO_INTEGER)                                                                                                 \
    X(EXPR_LESS)                                                                                                       \
    X(EXPR_LESS_EQUAL)                                                                                                 \
    X(EXPR_EQUAL)                                                                                                      \
    X(EXPR_INTEGER_LESS)                                                                                               \
    X(EXPR_INTEGER_LESS_EQUAL)                                                                                         \
    X(EXPR_INTEGER_EQUAL)                                                                                              \
    X(EXPR_MIXED_LESS)                                                                                                 \
    X(EXPR_MIXED_LESS_EQUAL)                                                                                           \
    X(EXPR_MIXED_GREATER)                                                                                              \
    X(EXPR_MIXED_GREATER_EQUAL)                                                                                        \
    X(EXPR_MIXED_EQUAL)                                                                                                \
    X(EXPR_WHOLE)                                                                                                      \
    X(EXPR_INTEGER_SELECT)                                                                                             \
    X(EXPR_TRUTH_SELECT)

/* The derivatives with respect to each operand; 0 for steps. */
static void partials(enum expr_operation operation, double a, double b, double c, double value, double out[3]) {
    double other[3];
    out[0] = out[1] = out[2] = 0;
    switch (operation) {
    case EXPR_COPY:
    case EXPR_ADD:
        out[0] = out[1] = 1;
        break;
    case EXPR_SUBTRACT:
        out[0] = 1;
        out[1] = -1;
        break;
    case EXPR_MULTIPLY:
        out[0] = b;
        out[1] = a;
        break;
    case EXPR_DIVIDE:
        out[0] = 1 / b;
        out[1] = -value / b;
        break;
    case EXPR_MODULO:
        out[0] = 1;
        out[1] = -floor(a / b);
        break;
    case EXPR_REMAINDER:
        out[0] = 1;
        out[1] = -trunc(a / b);
        break;
    case EXPR_POWER:
        out[0] = b != 0 ? b * el_pow(a, b - 1) : 0;
        out[1] = a > 0 ? value * el_log(a) : 0;
        break;
    case EXPR_NEGATE:
        out[0] = -1;
        break;
    case EXPR_ABS:
        out[0] = a < 0 ? -1 : 1;
        break;
    case EXPR_SQRT:
        out[0] = 0.5 / value;
        break;
    case EXPR_MIN:
        out[b < a ? 1 : 0] = 1;
        break;
    case EXPR_MAX:
        out[a < b ? 1 : 0] = 1;
        break;
    case EXPR_SIN:
        out[0] = el_cos(a);
        break;
    case EXPR_COS:
        out[0] = -el_sin(a);
        break;
    case EXPR_TAN:
        out[0] = 1 + value * value;
        break;
    case EXPR_ASIN:
        out[0] = 1 / sqrt((1 - a) * (1 + a));
        break;
    case EXPR_ACOS:
        out[0] = -1 / sqrt((1 - a) * (1 + a));
        break;
    case EXPR_ATAN:
        out[0] = b / (a * a + b * b);
        out[1] = -a / (a * a + b * b);
        break;
    case EXPR_EXP:
        out[0] = value;
        break;
    case EXPR_LOG:
        out[0] = 1 / a;
        break;
    case EXPR_LOG2:
        out[0] = 0x1.71547652b82fep+0 / a; /* 1 / ln 2 */
        break;
    case EXPR_LOG10:
        out[0] = 0x1.bcb7b1526e50ep-2 / a; /* 1 / ln 10 */
        break;
    case EXPR_SINH:
        out[0] = el_cosh(a);
        break;
    case EXPR_COSH:
        out[0] = el_sinh(a);
        break;
    case EXPR_TANH:
        out[0] = 1 - value * value;
        break;
    case EXPR_NOISE:
        noise_perlin_gradient(a, b, c, out);
        break;
    case EXPR_CELL_NEAREST:
        noise_cells_gradients(a, b, c, out, other);
        break;
    case EXPR_CELL_SECOND:
        noise_cells_gradients(a, b, c, other, out);
        break;
        STEPS(LIST_LABEL)
    case EXPR_TEXEL: /* handled by the caller, which has the picture */
    case EXPR_TO_FLOAT:
    case EXPR_SELECT: /* handled by the callers */
    EXPR_LOOP_CASES:
    case EXPR_CONSTANT:
    case EXPR_INPUT:
    case EXPR_OPERATION_COUNT:
    case EXPR_ALL_OPERATIONS:
        break;
    }
}

_Static_assert(EXPR_VALUES * sizeof(struct dual) == EXPR_GRADIENT_LIMIT, "one for each constant and row");
size_t expr_gradient_size(const struct expr_program *program) {
    return ((size_t)program->constant_count + program->row_count) * sizeof(struct dual);
}

/* A derivative of 0 stays 0, whatever factor it gets. */
static void chain(const struct dual *operands[3], const double by[3], double out[D]) {
    for (int k = 0; k < D; k++) {
        double sum = 0;
        for (int j = 0; j < 3; j++)
            sum += operands[j]->d[k] != 0 && by[j] != 0 ? operands[j]->d[k] * by[j] : 0;
        out[k] = sum;
    }
}

static void texel_partials(const struct dual *from[3], double out[3]) {
    int64_t operand = from[2]->value.i;
    image_function_slopes(expr_texel_function(operand), from[0]->value.f, from[1]->value.f, (int)(operand & 3), out);
}

#define READ_F(operand) (operand)->value.f
#define READ_I(operand) 0
#define READ_B(operand) 0
#define READ_N(operand) 0
#define EVALUATE(member, name, R, A, B, C, expression)                                                                 \
    case member: {                                                                                                     \
        EXPR_C_TYPE_##A a = from[0]->value.EXPR_MEMBER_##A;                                                            \
        EXPR_C_TYPE_##B b = from[1]->value.EXPR_MEMBER_##B;                                                            \
        EXPR_C_TYPE_##C c = from[2]->value.EXPR_MEMBER_##C;                                                            \
        (void)a, (void)b, (void)c;                                                                                     \
        result.value.EXPR_MEMBER_##R = (expression);                                                                   \
        if (member == EXPR_SELECT)                                                                                     \
            result = from[0]->value.i ? *from[1] : *from[2];                                                           \
        else if (member == EXPR_TEXEL)                                                                                 \
            texel_partials(from, by);                                                                                  \
        else if (EXPR_TYPE_##R == EXPR_TYPE_F)                                                                         \
            partials(member, READ_##A(from[0]), READ_##B(from[1]), READ_##C(from[2]), result.value.f, by);             \
        break;                                                                                                         \
    }

/* As expr_evaluate does, with derivatives. See EXPR_DEFINE_RUN. */
struct dual_frame {
    const struct expr_program *program;
    const struct expr_loop *loop;
    const struct expr_instruction *in;
    struct dual *values;
    uint32_t step; /* the next one */
};

static const struct expr_instruction *dual_continue(const struct dual_frame *f) {
    const struct expr_program *program = f->program;
    struct dual *values = f->values;
    for (const struct expr_instruction *in = f->in, *end = program->code + program->count; in < end; in++) {
        static const struct dual none = {.d = {0}};
        enum expr_operation operation = (enum expr_operation)in->operation;
        if (operation == EXPR_LOOP)
            return in;
        if (operation > EXPR_OPERATION_COUNT) {
            const struct expr_loop_access at = expr_loop_access(program, in);
            values[at.puts ? at.value : in->out] = values[at.puts ? in->b : at.value];
            continue;
        }
        const struct dual *from[3] = {&values[in->a], &values[in->b], &values[in->c]};
        struct dual result = {.d = {0}};
        double by[3] = {0, 0, 0};
        /* Operands that it does not have are constant. */
        for (int k = expr_operand_count(operation); k < 3; k++)
            from[k] = &none;
        switch (operation) {
            EXPR_OPERATIONS(EVALUATE)
        EXPR_LOOP_CASES:
        case EXPR_CONSTANT:
        case EXPR_INPUT:
        case EXPR_OPERATION_COUNT:
        case EXPR_ALL_OPERATIONS:
            break;
        }
        if (operation != EXPR_SELECT)
            chain(from, by, result.d);
        values[in->out] = result;
    }
    return NULL;
}

static void dual_begin_loop(const struct dual_frame *f, struct dual_frame *inner) {
    const struct expr_loop *loop = expr_loop_access(f->program, f->in).loop;
    struct dual *values = f->values + f->program->constant_count + loop->offset;
    for (uint32_t i = 0; i < loop->body.constant_count; i++)
        values[i] = (struct dual){loop->body.constants[i], {0}};
    *inner = (struct dual_frame){&loop->body, loop, NULL, values, loop->first};
}

static bool dual_begin_step(struct dual_frame *f) {
    const struct expr_loop *loop = f->loop;
    struct dual *registers = f->values + loop->body.constant_count;
    const union expr_value first = registers[0].value;
    if (f->step > loop->last ||
        (loop->ends && f->step > 1 && !(loop->type[0] == EXPR_TYPE_F ? first.f > 0 : first.i > 0)))
        return false;
    registers[loop->argument_count] = (struct dual){{.i = f->step++}, {0}};
    f->in = loop->body.code;
    return true;
}

static void dual_end_step(const struct dual_frame *f) {
    for (uint32_t k = 0; k < f->loop->state_count; k++)
        f->values[f->program->constant_count + k] = f->values[f->loop->next[k]];
}

EXPR_DEFINE_RUN(dual)

void expr_evaluate_gradient(const struct expr_program *program, const double inputs[EXPR_INPUT_COUNT],
                            const double seeds[EXPR_INPUT_COUNT][EXPR_DIRECTIONS], double outputs[EXPR_OUTPUTS],
                            double gradients[EXPR_OUTPUTS][EXPR_DIRECTIONS], void *rows) {
    struct dual *values = rows;
    struct dual_frame frames[EXPR_FRAMES] = {{program, NULL, program->code, values, 0}};
    for (uint32_t i = 0; i < program->constant_count; i++)
        values[i] = (struct dual){program->constants[i], {0}};
    for (int i = 0; i < program->input_count; i++) {
        struct dual *value = &values[program->inputs[i].value];
        value->value.f = inputs[program->inputs[i].input];
        for (int k = 0; k < D; k++)
            value->d[k] = seeds[program->inputs[i].input][k];
    }
    dual_run(frames);
    for (int i = 0; i < program->output_count; i++) {
        outputs[i] = values[program->outputs[i]].value.f;
        for (int k = 0; k < D; k++)
            gradients[i][k] = values[program->outputs[i]].d[k];
    }
}

/* --- over boxes --- */

static const struct expr_interval zero = {0, 0, false}, one = {1, 1, false}, minus_one = {-1, -1, false};
static const struct expr_interval any_slope = {-INFINITY, INFINITY, false};
static const struct expr_interval unused = {0, 1, false};

static struct expr_interval of_one(enum expr_operation operation, struct expr_interval a) {
    return expr_interval_apply(operation, a, unused, unused);
}

static struct expr_interval of_two(enum expr_operation operation, struct expr_interval a, struct expr_interval b) {
    return expr_interval_apply(operation, a, b, unused);
}

/* The two that slopes consist of, in short where all ends are finite; with the same bits. */
static inline struct expr_interval product(struct expr_interval a, struct expr_interval b) {
    double p = a.low * b.low, q = a.low * b.high, r = a.high * b.low, s = a.high * b.high;
    double low = q < p ? q : p, high = q < p ? p : q, low_2 = s < r ? s : r, high_2 = s < r ? r : s;
    low = low_2 < low ? low_2 : low;
    high = high < high_2 ? high_2 : high;
    if (!(fabs(p) + fabs(q) + (fabs(r) + fabs(s)) < DBL_MAX) || a.low > a.high || b.low > b.high)
        return of_two(EXPR_MULTIPLY, a, b);
    return (struct expr_interval){low - fabs(low) * DBL_EPSILON, high + fabs(high) * DBL_EPSILON,
                                  a.may_be_nan || b.may_be_nan};
}

static inline struct expr_interval plus(struct expr_interval a, struct expr_interval b) {
    double low = a.low + b.low, high = a.high + b.high;
    if (!(fabs(low) + fabs(high) < DBL_MAX) || low > high)
        return of_two(EXPR_ADD, a, b);
    return (struct expr_interval){low - fabs(low) * DBL_EPSILON, high + fabs(high) * DBL_EPSILON,
                                  a.may_be_nan || b.may_be_nan};
}

static struct expr_interval quotient(struct expr_interval a, struct expr_interval b) {
    return of_two(EXPR_DIVIDE, a, b);
}

static struct expr_interval scaled(double factor, struct expr_interval a) {
    return product((struct expr_interval){factor, factor, false}, a);
}

static struct expr_interval square(struct expr_interval a) {
    return of_two(EXPR_POWER, a, (struct expr_interval){2, 2, false});
}

static bool is_single(struct expr_interval a) {
    return a.low >= a.high && !a.may_be_nan;
}

static bool is_finite(struct expr_interval a) {
    return a.low > -INFINITY && a.high < INFINITY && !a.may_be_nan;
}

/* Whole exponents stay single, because only these have powers of negative numbers. */
static void power_slopes(struct expr_interval a, struct expr_interval b, struct expr_interval value,
                         struct expr_interval out[3]) {
    const double less = b.low - 1;
    const bool is_whole = is_single(b) && floor(b.low) == b.low && fabs(b.low) < 0x1p52;
    const struct expr_interval exponent =
        is_whole ? (struct expr_interval){less, less, false} : of_two(EXPR_SUBTRACT, b, one);
    out[0] = product(b, of_two(EXPR_POWER, a, exponent));
    out[1] = a.low > 0 ? product(value, of_one(EXPR_LOG, a)) : any_slope;
}

/* For a remainder by a constant: 1 within a period, that is, if the values are in order and less than a period
 * apart. */
static struct expr_interval period_slope(struct expr_interval a, struct expr_interval b, struct expr_interval value) {
    double width = a.high - a.low, rise = value.high - value.low;
    bool is_smooth = is_single(b) && width < 0.999 * fabs(b.low) && rise <= width * (1 + 1e-9) + fabs(b.low) * 1e-9 &&
                     rise < 0.9995 * fabs(b.low);
    return is_smooth && !value.may_be_nan ? one : any_slope;
}

static void noise_slopes(const struct expr_interval box[3], struct expr_interval out[3]) {
    double middle[3], gradient[3], radius[3];
    bool is_small = true, all_finite = true;
    for (int k = 0; k < 3; k++) {
        all_finite = all_finite && is_finite(box[k]);
        middle[k] = box[k].low + (box[k].high - box[k].low) / 2;
        radius[k] = (box[k].high - box[k].low) * 0.500001;
        is_small = is_small && fabs(middle[k]) < 0x1p40 && radius[k] < 1;
        out[k] = (struct expr_interval){-NOISE_FIRST_MAX, NOISE_FIRST_MAX, false};
    }
    if (!all_finite)
        out[0] = out[1] = out[2] = any_slope;
    if (!all_finite || !is_small)
        return;
    (void)noise_perlin_with_gradient(middle[0], middle[1], middle[2], gradient);
    for (int k = 0; k < 3; k++) {
        double change =
            NOISE_SECOND_MAX * radius[k] + NOISE_MIXED_MAX * (radius[(k + 1) % 3] + radius[(k + 2) % 3]) + 1e-9;
        out[k].low = math_max(out[k].low, gradient[k] - change);
        out[k].high = math_min(out[k].high, gradient[k] + change);
    }
}

/* The texels that a lookup in the box may read are within the bounds of its value, whose width is a bound of the
 * difference of two neighbours. */
static void texel_slopes(struct expr_interval operand, struct expr_interval value, struct expr_interval out[3]) {
    const struct image_function *function = expr_texel_function((int64_t)operand.low);
    double width = value.high - value.low, steps[2] = {image_width(function->image), image_height(function->image)};
    bool jumps = value.may_be_nan || (function->sampling.filter == IMAGE_NEAREST && width > 0);
    for (int k = 0; k < 2; k++) {
        double max = width * steps[k] * fabs(function->scale[k]) * (1 + 4 * DBL_EPSILON);
        out[k] = jumps ? any_slope : (struct expr_interval){-max, max, false};
    }
}

/* Bounds of the slopes with respect to each operand; any_slope if the operation may jump. */
static void slopes_of(enum expr_operation operation, struct expr_interval a, struct expr_interval b,
                      struct expr_interval c, struct expr_interval value, struct expr_interval out[3]) {
    out[0] = out[1] = out[2] = zero;
    switch (operation) {
    case EXPR_COPY:
    case EXPR_ADD:
        out[0] = out[1] = one;
        break;
    case EXPR_SUBTRACT:
        out[0] = one;
        out[1] = minus_one;
        break;
    case EXPR_MULTIPLY:
        out[0] = b;
        out[1] = a;
        break;
    case EXPR_DIVIDE:
        out[0] = quotient(one, b);
        out[1] = b.low > 0 || b.high < 0 ? of_one(EXPR_NEGATE, quotient(value, b)) : any_slope;
        if (!(b.low > 0 || b.high < 0))
            out[0] = any_slope;
        break;
    case EXPR_MODULO:
    case EXPR_REMAINDER:
        out[0] = period_slope(a, b, value);
        out[1] = any_slope;
        break;
    case EXPR_POWER:
        power_slopes(a, b, value, out);
        break;
    case EXPR_NEGATE:
        out[0] = minus_one;
        break;
    case EXPR_ABS:
        out[0] = a.low >= 0 ? one : a.high <= 0 ? minus_one : (struct expr_interval){-1, 1, false};
        break;
    case EXPR_SQRT:
        out[0] = value.low > 0 ? quotient((struct expr_interval){0.5, 0.5, false}, value)
                               : (struct expr_interval){0.5 / value.high * (1 - 1e-15), INFINITY, false};
        break;
    case EXPR_MIN: /* handled by slope_along */
    case EXPR_MAX:
    case EXPR_SELECT:
        break;
    case EXPR_SIN:
        out[0] = of_one(EXPR_COS, a);
        break;
    case EXPR_COS:
        out[0] = of_one(EXPR_NEGATE, of_one(EXPR_SIN, a));
        break;
    case EXPR_TAN:
        out[0] = isinf(value.low) || isinf(value.high) ? any_slope : of_two(EXPR_ADD, one, square(value));
        break;
    case EXPR_ASIN:
        out[0] = quotient(one, of_one(EXPR_SQRT, of_two(EXPR_SUBTRACT, one, square(a))));
        break;
    case EXPR_ACOS:
        out[0] = quotient(minus_one, of_one(EXPR_SQRT, of_two(EXPR_SUBTRACT, one, square(a))));
        break;
    case EXPR_ATAN:
        out[0] = out[1] = any_slope;
        if (a.low > 0 || a.high < 0 || b.low > 0) {
            struct expr_interval squares = of_two(EXPR_ADD, square(a), square(b));
            out[0] = quotient(b, squares);
            out[1] = of_one(EXPR_NEGATE, quotient(a, squares));
        }
        break;
    case EXPR_EXP:
        out[0] = value;
        break;
    case EXPR_LOG:
        out[0] = a.low > 0 ? quotient(one, a) : any_slope;
        break;
    case EXPR_LOG2:
        out[0] = a.low > 0 ? scaled(0x1.71547652b82fep+0, quotient(one, a)) : any_slope;
        break;
    case EXPR_LOG10:
        out[0] = a.low > 0 ? scaled(0x1.bcb7b1526e50ep-2, quotient(one, a)) : any_slope;
        break;
    case EXPR_SINH:
        out[0] = of_one(EXPR_COSH, a);
        break;
    case EXPR_COSH:
        out[0] = of_one(EXPR_SINH, a);
        break;
    case EXPR_TANH:
        out[0] = of_two(EXPR_SUBTRACT, one, square(value));
        break;
    case EXPR_NOISE:
        noise_slopes((struct expr_interval[3]){a, b, c}, out);
        break;
    case EXPR_CELL_NEAREST:
    case EXPR_CELL_SECOND:
        for (int k = 0; k < 3; k++)
            out[k] = is_finite(a) && is_finite(b) && is_finite(c) ? (struct expr_interval){-1, 1, false} : any_slope;
        break;
        STEPS(LIST_LABEL)
        out[0] = out[1] = out[2] = is_single(value) ? zero : any_slope;
        break;
    case EXPR_TEXEL:
        texel_slopes(c, value, out);
        break;
    case EXPR_TO_FLOAT:
        out[0] = one; /* for integers: 0, or unbounded */
        break;
    EXPR_LOOP_CASES:
    case EXPR_CONSTANT:
    case EXPR_INPUT:
    case EXPR_OPERATION_COUNT:
    case EXPR_ALL_OPERATIONS:
        break;
    }
}

/* The slopes of a root are bounded for what is a sum of squares: d sqrt(x^2) is at most |dx|, and d sqrt(a + b) at
 * most sqrt((d sqrt a)^2 + (d sqrt b)^2) by Cauchy and Schwarz. So lengths have slopes of at most 1 also where the root
 * may be of 0. */

size_t expr_slopes_size(const struct expr_program *program) {
    return ((size_t)program->constant_count + program->row_count) * sizeof(struct expr_rooted);
}

static bool is_zero(struct expr_interval a) {
    return a.low == 0 && a.high == 0;
}

static struct expr_interval enclosure(struct expr_interval a, struct expr_interval b) {
    return (struct expr_interval){math_min(a.low, b.low), math_max(a.high, b.high), a.may_be_nan || b.may_be_nan};
}

/* The slope of one of two operands, or any slope between them. */
static struct expr_interval chosen_slope(struct expr_choice choice, struct expr_interval a, struct expr_interval b) {
    return choice.first ? a : choice.second ? b : enclosure(a, b);
}

static double largest(struct expr_interval a) {
    return math_max(fabs(a.low), fabs(a.high)) * (1 + 4 * DBL_EPSILON);
}

static double root_of_sum(double a, double b) {
    return sqrt(a * a + b * b) * (1 + 4 * DBL_EPSILON);
}

/* Of an operand; of what is constant along the direction and not below 0 it is 0. */
static double root_slope(const struct expr_rooted *operand, int direction) {
    bool is_constant = is_zero(operand->range.slopes[direction]) && operand->range.value.low >= 0;
    return is_constant ? 0 : operand->roots[direction];
}

/* The slope of a root, by the chain rule and by what the operand is a sum of. */
static struct expr_interval slope_of_root(struct expr_interval by_chain, struct expr_interval operand, double max) {
    if (!(max < INFINITY))
        return by_chain;
    struct expr_interval out = {operand.low >= 0 ? 0 : -max, operand.high <= 0 ? 0 : max, false};
    out.low = by_chain.low > out.low ? by_chain.low : out.low;
    out.high = by_chain.high < out.high ? by_chain.high : out.high;
    return out.low <= out.high ? out : by_chain;
}

/* Whether a power with a NaN or a negative base is NaN everywhere. NaN^0 and 1^NaN are 1. */
static bool is_nan_power(const struct expr_range *base, const struct expr_range *exponent) {
    const struct expr_interval a = base->value, b = exponent->value;
    const bool is_root = b.low == b.high && b.low != floor(b.low);
    return (base->is_nan && (b.low > 0 || b.high < 0)) || (exponent->is_nan && (a.low > 1 || a.high < 1)) ||
           (is_root && a.low > -INFINITY && a.high < 0);
}

/* Of what is not known to be NaN everywhere, false. Of NaN and a number, min and max give the first. */
static bool is_always_nan(enum expr_operation operation, const struct expr_rooted *from[3]) {
    const struct expr_interval a = from[0]->range.value;
    bool first = from[0]->range.is_nan, second = from[1]->range.is_nan;
    switch ((unsigned)operation) { /* of all others nothing is known: false is never wrong */
    case EXPR_SQRT:
    case EXPR_LOG:
    case EXPR_LOG2:
    case EXPR_LOG10:
        return first || a.high < 0;
    case EXPR_ASIN:
    case EXPR_ACOS:
        return first || a.low > 1 || a.high < -1;
    case EXPR_ADD:
    case EXPR_SUBTRACT:
    case EXPR_MULTIPLY:
    case EXPR_DIVIDE:
    case EXPR_FLOOR_DIVIDE:
    case EXPR_MODULO:
    case EXPR_REMAINDER:
    case EXPR_ATAN:
        return first || second;
    case EXPR_POWER:
        return is_nan_power(&from[0]->range, &from[1]->range);
    case EXPR_SELECT:
        return (second || a.high == 0) && (from[2]->range.is_nan || a.low == 1);
    case EXPR_NEGATE:
    case EXPR_ABS:
    case EXPR_FLOOR:
    case EXPR_CEIL:
    case EXPR_MIN:
    case EXPR_MAX:
    case EXPR_SIN:
    case EXPR_COS:
    case EXPR_TAN:
    case EXPR_EXP:
    case EXPR_SINH:
    case EXPR_COSH:
    case EXPR_TANH:
        return first;
    default:
        return false;
    }
}

/* Of min, max and selections. */
static struct expr_interval slope_of_choice(enum expr_operation operation, const struct expr_rooted *from[3],
                                            int direction) {
    const struct expr_range *first = &from[0]->range, *second = &from[1]->range;
    struct expr_interval a = first->slopes[direction], b = second->slopes[direction];
    struct expr_choice choice = expr_interval_decide(operation, first->value, second->value);
    if (operation != EXPR_SELECT)
        return second->value.may_be_nan ? any_slope : chosen_slope(choice, a, b);
    return !is_single(first->value) && !is_zero(a) ? any_slope
                                                   : chosen_slope(choice, b, from[2]->range.slopes[direction]);
}

static struct expr_interval slope_along(const struct expr_rooted *from[3], const struct expr_interval by[3],
                                        int direction) {
    struct expr_interval sum = zero;
    for (int j = 0; j < 3; j++) {
        struct expr_interval term = from[j]->range.slopes[direction];
        if (is_zero(term) || is_zero(by[j]))
            continue;
        if (by[j].may_be_nan || !(by[j].low > -INFINITY || by[j].high < INFINITY))
            return any_slope;
        if (!(by[j].low == 1 && by[j].high == 1))
            term = product(term, by[j]);
        sum = is_zero(sum) ? term : plus(sum, term);
    }
    return sum.may_be_nan ? any_slope : sum;
}

void expr_rooted_apply(const struct expr_instruction *in, const struct expr_rooted *from[3], int directions,
                       struct expr_rooted *out) {
    enum expr_operation operation = (enum expr_operation)in->operation;
    const struct expr_interval a = from[0]->range.value, b = from[1]->range.value, c = from[2]->range.value;
    bool is_square = operation == EXPR_MULTIPLY && in->a == in->b;
    bool is_choice = operation == EXPR_MIN || operation == EXPR_MAX || operation == EXPR_SELECT;
    struct expr_rooted result;
    struct expr_interval by[3];
    result.range.value = is_square ? expr_interval_square(a) : expr_interval_apply(operation, a, b, c);
    if (!is_choice)
        slopes_of(operation, a, b, c, result.range.value, by);
    /* The slope of the value, and that of its root where it is a sum of squares. */
    for (int k = 0; k < directions; k++) {
        struct expr_interval *slope = &result.range.slopes[k];
        *slope = is_choice ? slope_of_choice(operation, from, k) : slope_along(from, by, k);
        result.roots[k] = INFINITY;
        if (is_square)
            result.roots[k] = largest(from[0]->range.slopes[k]);
        else if (operation == EXPR_ADD)
            result.roots[k] = root_of_sum(root_slope(from[0], k), root_slope(from[1], k));
        else if (operation == EXPR_SQRT)
            *slope = slope_of_root(*slope, from[0]->range.slopes[k], root_slope(from[0], k));
    }
    result.range.is_nan = is_always_nan(operation, from);
    *out = result;
}

struct expr_interval expr_interval_of_constant(enum expr_type type, union expr_value value) {
    switch (type) {
    case EXPR_TYPE_F:
        return expr_interval_of_float(value.f);
    case EXPR_TYPE_I:
        return expr_interval_of_integer(value.i);
    case EXPR_TYPE_B:
        return expr_interval_of_truth(value.i);
    case EXPR_TYPE_N:
        break;
    }
    return unused;
}

/* Operands of an instruction; what is constant is written to `constants`. */
static void find_operands(const struct expr_program *program, const struct expr_instruction *in,
                          const struct expr_rooted *values, struct expr_rooted constants[3],
                          const struct expr_rooted *from[3]) {
    const uint16_t operands[3] = {in->a, in->b, in->c};
    for (int k = 0; k < 3; k++) {
        enum expr_type type = expr_operand_type((enum expr_operation)in->operation, k);
        bool is_constant = type != EXPR_TYPE_N && operands[k] < program->constant_count;
        from[k] = type != EXPR_TYPE_N && !is_constant ? &values[operands[k]] : &constants[k];
        if (type == EXPR_TYPE_N)
            constants[k].range.value = unused;
        else if (is_constant)
            constants[k].range.value = expr_interval_of_constant(type, program->constants[operands[k]]);
    }
}

/* A value without slopes. */
static struct expr_rooted constant_of(struct expr_interval value) {
    return (struct expr_rooted){{value, {zero, zero, zero}, false}, {INFINITY, INFINITY, INFINITY}};
}

/* See EXPR_DEFINE_RUN. */
struct rooted_frame {
    const struct expr_program *program;
    const struct expr_loop *loop;
    const struct expr_instruction *in;
    struct expr_rooted *values;
    struct expr_interval *scratch; /* of a loop, for the bounds of all values of its body */
    struct expr_choice *choices;
    int directions;
    uint32_t step; /* the next one */
};

/* The states may jump where some points have ended: bounds of the values, with any slopes. */
static void run_without_slopes(const struct rooted_frame *f) {
    const struct expr_loop *loop = f->loop;
    struct expr_rooted *registers = f->values + loop->body.constant_count;
    struct expr_interval *bounds = f->scratch + loop->body.constant_count;
    for (uint32_t k = 0; k < loop->argument_count; k++)
        bounds[k] = registers[k].range.value;
    expr_interval_loop(loop, f->step, f->scratch);
    for (uint32_t k = 0; k < loop->state_count; k++) {
        registers[k] = constant_of(bounds[k]);
        for (int d = 0; d < D; d++)
            registers[k].range.slopes[d] = any_slope;
    }
}

static struct expr_rooted rooted_value(const struct rooted_frame *f, enum expr_type type, uint16_t value) {
    const struct expr_program *program = f->program;
    return value >= program->constant_count ? f->values[value]
                                            : constant_of(expr_interval_of_constant(type, program->constants[value]));
}

static const struct expr_instruction *rooted_continue(const struct rooted_frame *f) {
    const struct expr_program *program = f->program;
    struct expr_rooted constants[3], *values = f->values;
    struct expr_choice *choices = f->choices;
    for (int k = 0; k < 3; k++)
        constants[k] = constant_of(zero);
    for (const struct expr_instruction *in = f->in, *end = program->code + program->count; in < end; in++) {
        const struct expr_rooted *from[3];
        if (in->operation > EXPR_OPERATION_COUNT) {
            if (choices)
                choices[in - program->code] = (struct expr_choice){0, 0};
            if (in->operation == EXPR_LOOP)
                return in;
            const struct expr_loop_access at = expr_loop_access(program, in);
            const enum expr_type type = expr_operand_type((enum expr_operation)in->operation, 1);
            values[at.puts ? at.value : in->out] = at.puts ? rooted_value(f, type, in->b) : values[at.value];
            continue;
        }
        find_operands(program, in, values, constants, from);
        if (choices)
            choices[in - program->code] =
                expr_interval_decide((enum expr_operation)in->operation, from[0]->range.value, from[1]->range.value);
        expr_rooted_apply(in, from, f->directions, &values[in->out]);
    }
    return NULL;
}

static void rooted_begin_loop(const struct rooted_frame *f, struct rooted_frame *inner) {
    const struct expr_loop *loop = expr_loop_access(f->program, f->in).loop;
    struct expr_rooted *values = f->values + f->program->constant_count + loop->offset;
    struct expr_interval *scratch = (struct expr_interval *)(void *)(values + expr_loop_rows(loop) / 2);
    *inner = (struct rooted_frame){&loop->body, loop, NULL, values, scratch, NULL, f->directions, loop->first};
}

static bool rooted_begin_step(struct rooted_frame *f) {
    const struct expr_loop *loop = f->loop;
    struct expr_rooted *registers = f->values + loop->body.constant_count;
    const struct expr_interval first = registers[0].range.value;
    const bool is_checked = loop->ends && f->step > 1;
    if (f->step > loop->last || (is_checked && !expr_may_go_on(first)))
        return false;
    if ((is_checked && expr_may_end(first)) || f->step - loop->first >= EXPR_EXACT_STEPS) {
        run_without_slopes(f);
        return false;
    }
    registers[loop->argument_count] = constant_of((struct expr_interval){f->step, f->step, false});
    f->in = loop->body.code;
    f->step++;
    return true;
}

static void rooted_end_step(const struct rooted_frame *f) {
    for (uint32_t k = 0; k < f->loop->state_count; k++)
        f->values[f->program->constant_count + k] = rooted_value(f, f->loop->type[k], f->loop->next[k]);
}

EXPR_DEFINE_RUN(rooted)

void expr_rooted_loop(const struct expr_loop *loop, int directions, struct expr_rooted *values,
                      struct expr_interval *scratch) {
    struct rooted_frame frames[EXPR_FRAMES] = {
        {&loop->body, loop, NULL, values, scratch, NULL, directions, loop->first}};
    if (rooted_begin_step(frames))
        rooted_run(frames);
}

void expr_evaluate_slopes(const struct expr_program *program, const struct expr_interval inputs[EXPR_INPUT_COUNT],
                          const struct expr_directions *directions, struct expr_range outputs[EXPR_OUTPUTS],
                          struct expr_choice *choices, void *rows) {
    struct expr_rooted *values = rows;
    struct rooted_frame frames[EXPR_FRAMES] = {
        {program, NULL, program->code, values, NULL, choices, directions->count, 0}};
    for (int i = 0; i < program->input_count; i++) {
        struct expr_rooted *value = &values[program->inputs[i].value];
        value->range.value = inputs[program->inputs[i].input];
        value->range.is_nan = false;
        for (int k = 0; k < directions->count; k++) {
            double seed = directions->seeds[program->inputs[i].input][k];
            value->range.slopes[k] = (struct expr_interval){seed, seed, false};
            value->roots[k] = INFINITY;
        }
    }
    rooted_run(frames);
    for (int i = 0; i < program->output_count; i++) {
        uint16_t value = program->outputs[i];
        bool is_constant = value < program->constant_count;
        outputs[i].is_nan = !is_constant && values[value].range.is_nan;
        outputs[i].value =
            is_constant ? expr_interval_of_float(program->constants[value].f) : values[value].range.value;
        for (int k = 0; k < directions->count; k++)
            /* Where the value may be a NaN, its slopes say nothing. */
            outputs[i].slopes[k] = is_constant                   ? zero
                                   : outputs[i].value.may_be_nan ? any_slope
                                                                 : values[value].range.slopes[k];
    }
}

/* --- over eight boxes --- */

size_t expr_lanes_size(const struct expr_program *program) {
    return (size_t)program->row_count * sizeof(struct expr_lanes);
}

static void read_lanes(const struct expr_program *program, uint16_t output, int directions, struct expr_lanes *values,
                       struct expr_lane_range *out) {
    if (output < program->constant_count) {
        struct expr_interval constant = expr_interval_of_float(program->constants[output].f);
        *out = (struct expr_lane_range){.may_be_nan = constant.may_be_nan ? (1U << EXPR_LANES) - 1 : 0};
        for (int i = 0; i < EXPR_LANES; i++) {
            out->low[i] = constant.low;
            out->high[i] = constant.high;
        }
        return;
    }
    const struct expr_lanes *value = &values[output - program->constant_count];
    out->may_be_nan = value->may_be_nan;
    out->is_nan = value->is_nan;
    memcpy(out->low, value->low, sizeof out->low);
    memcpy(out->high, value->high, sizeof out->high);
    for (int k = 0; k < directions; k++)
        for (int i = 0; i < EXPR_LANES; i++) {
            bool is_any = value->may_be_nan >> i & 1;
            out->slopes[k].low[i] = is_any ? -INFINITY : value->slopes[k].low[i];
            out->slopes[k].high[i] = is_any ? INFINITY : value->slopes[k].high[i];
        }
}

void expr_evaluate_slopes_lanes(const struct expr_program *program, const struct expr_lane_inputs *inputs,
                                const struct expr_directions *directions, struct expr_lane_range outputs[EXPR_OUTPUTS],
                                struct expr_choice *choices, void *rows) {
    struct expr_lanes *values = rows;
    for (int i = 0; i < program->input_count; i++) {
        enum expr_input input = (enum expr_input)program->inputs[i].input;
        struct expr_lanes *value = &values[program->inputs[i].value - program->constant_count];
        memcpy(value->low, inputs->low[input], sizeof value->low);
        memcpy(value->high, inputs->high[input], sizeof value->high);
        value->may_be_nan = value->is_nan = 0;
        value->has_roots = false;
        for (int k = 0; k < directions->count; k++)
            for (int n = 0; n < EXPR_LANES; n++)
                value->slopes[k].low[n] = value->slopes[k].high[n] = directions->seeds[input][k];
    }
    CPU_ISA_CALL(expr_run_slopes, program, directions->count, inputs->are_cases, values, choices)
    for (int i = 0; i < program->output_count; i++)
        read_lanes(program, program->outputs[i], directions->count, values, &outputs[i]);
}
