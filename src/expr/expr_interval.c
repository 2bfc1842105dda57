/* Each operation bounds its computed results. Sums, products, quotients and roots are rounded to nearest, which is
 * monotone. Their ends are then moved outwards by one or two units in the last place, so that they bound the exact
 * results too. The elementary functions have errors of up to 1.05 units, so their ends move further. Zero stays
 * zero, so that the root of a sum of squares is never NaN. If a sum of opposite infinities or a product of infinity
 * and zero is possible, the bounds allow every result. */
#include "expr/expr_interval_internal.h"

#include "expr/expr_frames_internal.h"
#include "math/exact.h"
#include "math/portable.h"

#include <float.h>

static const struct expr_interval anything = {-INFINITY, INFINITY, true};
static const struct expr_interval any_number = {-INFINITY, INFINITY, false};
static const struct expr_interval any_integer = {-0x1p63, 0x1p63, false};
static const struct expr_interval either = {0, 1, false};

/* --- ends --- */

/* The comparison rejects the NaN of infinity minus infinity. */
static inline double below(double x) {
    double lower = x - fabs(x) * DBL_EPSILON;
    return lower < x ? lower : x;
}

static inline double above(double x) {
    double upper = x + fabs(x) * DBL_EPSILON;
    return upper > x ? upper : x;
}

static inline double smaller(double a, double b) {
    return b < a ? b : a;
}

static inline double larger(double a, double b) {
    return a < b ? b : a;
}

/* Moves the ends outwards by three units, for results of elementary functions. */
static struct expr_interval widened(double low, double high, bool may_be_nan) {
    double lower = low - fabs(low) * (2 * DBL_EPSILON), upper = high + fabs(high) * (2 * DBL_EPSILON);
    return (struct expr_interval){lower < low ? lower - DBL_TRUE_MIN : low, upper > high ? upper + DBL_TRUE_MIN : high,
                                  may_be_nan};
}

static struct expr_interval within(struct expr_interval a, double low, double high) {
    return (struct expr_interval){larger(a.low, low), smaller(a.high, high), a.may_be_nan};
}

static inline bool contains(struct expr_interval a, double x) {
    return a.low <= x && x <= a.high;
}

static struct expr_interval enclosure(struct expr_interval a, struct expr_interval b) {
    return (struct expr_interval){smaller(a.low, b.low), larger(a.high, b.high), a.may_be_nan || b.may_be_nan};
}

static inline struct expr_interval truth(bool certainly, bool possibly) {
    return (struct expr_interval){certainly, possibly, false};
}

static inline bool is_point(struct expr_interval a) {
    return a.low >= a.high && !a.may_be_nan;
}

/* --- arithmetic --- */

static inline struct expr_interval sum(double low, double high, bool may_be_nan) {
    if (isnan(low + high)) /* both infinite, or NaN */
        return anything;
    return (struct expr_interval){below(low), above(high), may_be_nan};
}

static inline struct expr_interval multiply(struct expr_interval a, struct expr_interval b) {
    double p = a.low * b.low, q = a.low * b.high, r = a.high * b.low, s = a.high * b.high;
    if (isnan(p + q + (r + s)))
        return anything;
    return (struct expr_interval){below(smaller(smaller(p, q), smaller(r, s))),
                                  above(larger(larger(p, q), larger(r, s))), a.may_be_nan || b.may_be_nan};
}

static struct expr_interval divide(struct expr_interval a, struct expr_interval b) {
    bool may_be_nan = a.may_be_nan || b.may_be_nan;
    if (contains(b, 0)) {
        bool both = contains(a, 0) || ((isinf(a.low) || isinf(a.high)) && (isinf(b.low) || isinf(b.high)));
        return both ? anything : (struct expr_interval){-INFINITY, INFINITY, may_be_nan};
    }
    double p = a.low / b.low, q = a.low / b.high, r = a.high / b.low, s = a.high / b.high;
    if (isnan(p + q + (r + s)))
        return anything;
    return (struct expr_interval){below(smaller(smaller(p, q), smaller(r, s))),
                                  above(larger(larger(p, q), larger(r, s))), may_be_nan};
}

static struct expr_interval absolute(struct expr_interval a) {
    if (a.low > 0)
        return a;
    if (a.high < 0)
        return (struct expr_interval){-a.high, -a.low, a.may_be_nan};
    return (struct expr_interval){0, larger(-a.low, a.high), a.may_be_nan};
}

struct expr_interval expr_interval_square(struct expr_interval a) {
    struct expr_interval size = absolute(a);
    return (struct expr_interval){below(size.low * size.low), above(size.high * size.high), a.may_be_nan};
}

static struct expr_interval rounded(double low, double high, bool may_be_nan) {
    return (struct expr_interval){floor(low), floor(high), may_be_nan};
}

static inline struct expr_interval root(struct expr_interval a) {
    if (!(a.high >= 0))
        return anything;
    return (struct expr_interval){a.low > 0 ? below(sqrt(a.low)) : 0, above(sqrt(a.high)),
                                  a.may_be_nan || !(a.low >= 0)};
}

/* Within one period the remainder grows with a; `whole` bounds all remainders. At the end of a period the result
 * falls: the ends are then in the wrong order, if they are less than a period apart. */
static struct expr_interval one_period(struct expr_interval a, double period, double low, double high,
                                       struct expr_interval whole) {
    if (low < high && a.high - a.low < 0.999 * fabs(period) && !a.may_be_nan)
        return (struct expr_interval){below(low), above(high), false};
    return whole;
}

static struct expr_interval modulo(struct expr_interval a, struct expr_interval b) {
    bool may_be_nan = a.may_be_nan || b.may_be_nan || contains(b, 0) || isinf(a.low) || isinf(a.high);
    struct expr_interval whole = {smaller(b.low, 0), larger(b.high, 0), may_be_nan};
    if (may_be_nan || !is_point(b))
        return whole;
    return one_period(a, b.low, expr_modulo(a.low, b.low), expr_modulo(a.high, b.low), whole);
}

static struct expr_interval remainder_of(struct expr_interval a, struct expr_interval b) {
    bool may_be_nan = a.may_be_nan || b.may_be_nan || contains(b, 0) || isinf(a.low) || isinf(a.high);
    double size = smaller(absolute(a).high, absolute(b).high);
    struct expr_interval whole = {a.low < 0 ? -size : 0, a.high > 0 ? size : 0, may_be_nan};
    if (may_be_nan || !is_point(b))
        return whole;
    return one_period(a, b.low, el_fmod(a.low, b.low), el_fmod(a.high, b.low), whole);
}

/* NaN if a is NaN; if b is NaN, the result is a. */
static inline struct expr_interval minimum(struct expr_interval a, struct expr_interval b) {
    return (struct expr_interval){smaller(a.low, b.low), b.may_be_nan ? a.high : smaller(a.high, b.high), a.may_be_nan};
}

static inline struct expr_interval maximum(struct expr_interval a, struct expr_interval b) {
    return (struct expr_interval){b.may_be_nan ? a.low : larger(a.low, b.low), larger(a.high, b.high), a.may_be_nan};
}

/* --- elementary functions --- */

/* A function that increases from `first` to `last` and is undefined elsewhere. */
#define GROWING(member, function, first, last)                                                                         \
    case member:                                                                                                       \
        if (!(larger(a.low, first) <= smaller(a.high, last)))                                                          \
            return anything;                                                                                           \
        return widened(function(larger(a.low, first)), function(smaller(a.high, last)),                                \
                       a.may_be_nan || a.low < (first) || a.high > (last));
__attribute__((noinline)) static struct expr_interval growing(enum expr_operation operation, struct expr_interval a) {
    switch ((unsigned)operation) {
        GROWING(EXPR_ASIN, el_asin, -1, 1)
        GROWING(EXPR_EXP, el_exp, -INFINITY, INFINITY)
        GROWING(EXPR_LOG, el_log, 0, INFINITY)
        GROWING(EXPR_LOG2, el_log2, 0, INFINITY)
        GROWING(EXPR_LOG10, el_log10, 0, INFINITY)
        GROWING(EXPR_SINH, el_sinh, -INFINITY, INFINITY)
        GROWING(EXPR_TANH, el_tanh, -INFINITY, INFINITY)
    }
    return anything;
}

/* Whether start + n * 2 pi is in the interval, or closer to it than rounding errors. Angles are below 10^6. */
static bool contains_angle(struct expr_interval a, double start) {
    const double turn = 2 * PI, slack = 1e-9;
    return ceil((a.low - start - slack) / turn) <= floor((a.high - start + slack) / turn);
}

/* The sine or the cosine. */
static struct expr_interval wave(struct expr_interval a, bool is_sine) {
    const double top = is_sine ? PI / 2 : 0;
    bool may_be_nan = a.may_be_nan || isinf(a.low) || isinf(a.high);
    if (!(a.high - a.low < 2 * PI) || fabs(a.low) > 1e6 || fabs(a.high) > 1e6)
        return (struct expr_interval){-1, 1, may_be_nan};
    bool to_bottom = contains_angle(a, top + PI), to_top = contains_angle(a, top);
    if (to_bottom && to_top)
        return (struct expr_interval){-1, 1, may_be_nan};
    double p = is_sine ? el_sin(a.low) : el_cos(a.low), q = is_sine ? el_sin(a.high) : el_cos(a.high);
    return within(widened(to_bottom ? -1 : smaller(p, q), to_top ? 1 : larger(p, q), may_be_nan), -1, 1);
}

static struct expr_interval tangent(struct expr_interval a) {
    bool may_be_nan = a.may_be_nan || isinf(a.low) || isinf(a.high);
    if (!(a.high - a.low < PI) || fabs(a.low) > 1e6 || fabs(a.high) > 1e6 || contains_angle(a, PI / 2) ||
        contains_angle(a, -PI / 2))
        return (struct expr_interval){-INFINITY, INFINITY, may_be_nan};
    return widened(el_tan(a.low), el_tan(a.high), may_be_nan);
}

/* The angle of (b, a). If the box excludes the origin and the cut along negative b, the extremes are at its corners. */
static struct expr_interval arc_tangent(struct expr_interval a, struct expr_interval b) {
    bool may_be_nan = a.may_be_nan || b.may_be_nan;
    if (!(a.low > 0 || a.high < 0 || b.low > 0))
        return widened(-PI, PI, may_be_nan);
    double p = el_atan2(a.low, b.low), q = el_atan2(a.low, b.high), r = el_atan2(a.high, b.low);
    double s = el_atan2(a.high, b.high);
    return widened(smaller(smaller(p, q), smaller(r, s)), larger(larger(p, q), larger(r, s)), may_be_nan);
}

static struct expr_interval hyperbolic_cosine(struct expr_interval a) {
    struct expr_interval size = absolute(a);
    return within(widened(el_cosh(size.low), el_cosh(size.high), a.may_be_nan), 1, INFINITY);
}

/* For positive a: log a * b has its extremes at the corners. */
static struct expr_interval power_of_positive(struct expr_interval a, struct expr_interval b) {
    double p = el_pow(a.low, b.low), q = el_pow(a.low, b.high), r = el_pow(a.high, b.low), s = el_pow(a.high, b.high);
    return within(widened(smaller(smaller(p, q), smaller(r, s)), larger(larger(p, q), larger(r, s)), false), 0,
                  INFINITY);
}

static struct expr_interval power(struct expr_interval a, struct expr_interval b) {
    if (a.may_be_nan || b.may_be_nan)
        return anything;
    if (a.low > 0 || (a.low >= 0 && b.low >= 0))
        return power_of_positive(a, b);
    if (!is_point(b) || fabs(b.low) > 0x1p53 || floor(b.low) != b.low)
        return anything;
    double n = b.low;
    if (math_fmod(n, 2) == 0) {
        struct expr_interval size = absolute(a);
        return n >= 0 || size.low > 0 ? power_of_positive(size, b)
                                      : (struct expr_interval){below(below(el_pow(size.high, n))), INFINITY, false};
    }
    if (n > 0)
        return widened(el_pow(a.low, n), el_pow(a.high, n), false);
    return contains(a, 0) ? any_number : widened(el_pow(a.high, n), el_pow(a.low, n), false);
}

/* --- noise --- */

/* The middle of a box of the three operands, and its half widths. False: a coordinate may be infinite, or is so
 * large that the middle is too inexact. */
static bool middle_of(const struct expr_interval box[3], double middle[3], double radius[3]) {
    for (int k = 0; k < 3; k++) {
        if (box[k].may_be_nan || !(box[k].low > -0x1p40 && box[k].high < 0x1p40))
            return false;
        middle[k] = box[k].low + (box[k].high - box[k].low) / 2;
        radius[k] = larger(box[k].high - middle[k], middle[k] - box[k].low) * (1 + 4 * DBL_EPSILON);
    }
    return true;
}

/* Taylor's formula with bounds of the second derivatives. The noise is 0 where a coordinate may be NaN. */
static struct expr_interval noise(const struct expr_interval box[3]) {
    const struct expr_interval all = {-NOISE_MAX, NOISE_MAX, false};
    double m[3], r[3], gradient[3];
    if (!middle_of(box, m, r) || r[0] + r[1] + r[2] > 1)
        return all;
    double value = noise_perlin_with_gradient(m[0], m[1], m[2], gradient), change = 1e-14;
    for (int k = 0; k < 3; k++) {
        double others = r[(k + 1) % 3] + r[(k + 2) % 3];
        change += (fabs(gradient[k]) + (NOISE_SECOND_MAX * r[k] + NOISE_MIXED_MAX * others) / 2) * r[k];
    }
    return within((struct expr_interval){value - change, value + change, false}, all.low, all.high);
}

/* The distances change at most by the movement of the point; they are 0 where a coordinate is not finite. */
static struct expr_interval cells(const struct expr_interval box[3], enum expr_operation operation) {
    bool is_id = operation == EXPR_CELL_ID;
    const struct expr_interval all = {0, is_id ? 1 : 2, false};
    double m[3], r[3];
    if (!middle_of(box, m, r) || r[0] + r[1] + r[2] > 2)
        return all;
    struct noise_cells at = noise_cells(m[0], m[1], m[2]);
    double moved = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
    double change = moved * (1 + 1e-9) + 1e-12 * (1 + fabs(m[0]) + fabs(m[1]) + fabs(m[2]));
    if (is_id)
        return at.nearest + change < at.second - change ? (struct expr_interval){at.id, at.id, false} : all;
    double value = operation == EXPR_CELL_NEAREST ? at.nearest : at.second;
    return within((struct expr_interval){value - change, value + change, false}, 0, 2);
}

static struct expr_interval hashed(const struct expr_interval box[3]) {
    if (!is_point(box[0]) || !is_point(box[1]) || !is_point(box[2]))
        return (struct expr_interval){0, 1, false};
    double value = noise_hash(box[0].low, box[1].low, box[2].low);
    return (struct expr_interval){value, value, false};
}

/* The operand is a constant, exact as a double. */
static struct expr_interval texel(struct expr_interval u, struct expr_interval v, struct expr_interval operand) {
    int64_t constant = (int64_t)operand.low;
    struct image_interval bounds =
        image_function_bounds(expr_texel_function(constant), (struct image_interval){u.low, u.high, u.may_be_nan},
                              (struct image_interval){v.low, v.high, v.may_be_nan}, (int)(constant & 3));
    return (struct expr_interval){bounds.low, bounds.high, bounds.may_be_nan};
}

/* --- integers --- */

/* Ends that doubles cannot represent exactly, or that wrap around, mean any integer. */
static struct expr_interval integers(double low, double high) {
    return low >= -0x1p53 && high <= 0x1p53 ? (struct expr_interval){low, high, false} : any_integer;
}

static bool is_exact(struct expr_interval a) {
    return a.low >= -0x1p53 && a.high <= 0x1p53;
}

static struct expr_interval integer_multiply(struct expr_interval a, struct expr_interval b) {
    double p = a.low * b.low, q = a.low * b.high, r = a.high * b.low, s = a.high * b.high;
    return integers(smaller(smaller(p, q), smaller(r, s)), larger(larger(p, q), larger(r, s)));
}

/* Division, remainders and bits: exact for single numbers; for quotients and remainders by a constant, the simple
 * cases; otherwise any integer. */
static struct expr_interval integer_operation(enum expr_operation operation, struct expr_interval a,
                                              struct expr_interval b) {
    if (!is_exact(a) || !is_exact(b))
        return any_integer;
    union expr_value x = {.i = (int64_t)a.low}, y = {.i = (int64_t)b.low};
    if (is_point(a) && is_point(b)) {
        int64_t value = expr_apply(operation, x, y, (union expr_value){.i = 0}).i;
        return value >= -(1LL << 53) && value <= 1LL << 53 ? (struct expr_interval){(double)value, (double)value, false}
                                                           : any_integer;
    }
    bool by_positive = is_point(b) && b.low > 0;
    if (operation == EXPR_INTEGER_DIVIDE && by_positive)
        return integers((double)expr_integer_divide(x.i, y.i), (double)expr_integer_divide((int64_t)a.high, y.i));
    if (operation == EXPR_INTEGER_MODULO && by_positive) {
        int64_t low = expr_integer_modulo(x.i, y.i), high = expr_integer_modulo((int64_t)a.high, y.i);
        if (low <= high && a.high - a.low < b.low)
            return integers((double)low, (double)high);
        return integers(0, b.low - 1);
    }
    if (operation == EXPR_BIT_AND && (a.low >= 0 || b.low >= 0))
        return integers(0, a.low < 0 ? b.high : b.low < 0 ? a.high : smaller(a.high, b.high));
    return any_integer;
}

static struct expr_interval to_integer(struct expr_interval a) {
    if (a.may_be_nan || !(a.low >= -0x1p63 && a.high < 0x1p63))
        return any_integer;
    return (struct expr_interval){trunc(a.low), trunc(a.high), false};
}

/* --- conditions --- */

/* A comparison with NaN is false. */
static inline struct expr_interval less(struct expr_interval a, struct expr_interval b) {
    bool may_be_nan = a.may_be_nan || b.may_be_nan;
    return truth(a.high < b.low && !may_be_nan, a.low < b.high);
}

static inline struct expr_interval less_equal(struct expr_interval a, struct expr_interval b) {
    bool may_be_nan = a.may_be_nan || b.may_be_nan;
    return truth(a.high <= b.low && !may_be_nan, a.low <= b.high);
}

static struct expr_interval equal(struct expr_interval a, struct expr_interval b) {
    return truth(is_point(a) && is_point(b) && a.low == b.low && is_exact(a), a.low <= b.high && b.low <= a.high);
}

/* Equal ends do not decide comparisons of integers that are too large for doubles. */
static struct expr_interval compare_integers(enum expr_operation operation, struct expr_interval a,
                                             struct expr_interval b) {
    if ((a.high == b.low && !is_exact(a)) || (a.low == b.high && !is_exact(a)))
        return either;
    return operation == EXPR_INTEGER_LESS || operation == EXPR_MIXED_LESS ? less(a, b) : less_equal(a, b);
}

static struct expr_interval is_whole(struct expr_interval a) {
    if (is_point(a))
        return expr_is_integer(a.low) ? truth(true, true) : truth(false, false);
    return truth(false, !(floor(a.low) == floor(a.high) && a.low > floor(a.low)));
}

static inline struct expr_interval selected(struct expr_interval condition, struct expr_interval b,
                                            struct expr_interval c) {
    return condition.low > 0 ? b : condition.high > 0 ? enclosure(b, c) : c;
}

/* --- all of them --- */

static inline __attribute__((always_inline)) struct expr_interval
apply(enum expr_operation operation, struct expr_interval a, struct expr_interval b, struct expr_interval c) {
    bool may_be_nan = a.may_be_nan || b.may_be_nan;
    switch (operation) {
    case EXPR_ADD:
        return sum(a.low + b.low, a.high + b.high, may_be_nan);
    case EXPR_SUBTRACT:
        return sum(a.low - b.high, a.high - b.low, may_be_nan);
    case EXPR_MULTIPLY:
        return multiply(a, b);
    case EXPR_DIVIDE:
        return divide(a, b);
    case EXPR_FLOOR_DIVIDE: {
        struct expr_interval quotient = divide(a, b);
        return rounded(quotient.low, quotient.high, quotient.may_be_nan);
    }
    case EXPR_MODULO:
        return modulo(a, b);
    case EXPR_POWER:
        return power(a, b);
    case EXPR_NEGATE:
        return (struct expr_interval){-a.high, -a.low, a.may_be_nan};
    case EXPR_ABS:
        return absolute(a);
    case EXPR_SQRT:
        return root(a);
    case EXPR_FLOOR:
        return rounded(a.low, a.high, a.may_be_nan);
    case EXPR_CEIL:
        return (struct expr_interval){ceil(a.low), ceil(a.high), a.may_be_nan};
    case EXPR_REMAINDER:
        return remainder_of(a, b);
    case EXPR_MIN:
        return minimum(a, b);
    case EXPR_MAX:
        return maximum(a, b);
    case EXPR_SIN:
        return wave(a, true);
    case EXPR_COS:
        return wave(a, false);
    case EXPR_TAN:
        return tangent(a);
    case EXPR_ACOS: {
        struct expr_interval inside = within(a, -1, 1);
        if (!(inside.low <= inside.high))
            return anything;
        return widened(el_acos(inside.high), el_acos(inside.low), a.may_be_nan || a.low < -1 || a.high > 1);
    }
    case EXPR_ATAN:
        return arc_tangent(a, b);
    case EXPR_EXP:
        return within(growing(operation, a), 0, INFINITY);
    case EXPR_ASIN:
    case EXPR_LOG:
    case EXPR_LOG2:
    case EXPR_LOG10:
    case EXPR_SINH:
        return growing(operation, a);
    case EXPR_COSH:
        return hyperbolic_cosine(a);
    case EXPR_TANH:
        return within(growing(operation, a), -1, 1);
    case EXPR_NOISE:
        return noise((struct expr_interval[3]){a, b, c});
    case EXPR_HASH:
        return hashed((struct expr_interval[3]){a, b, c});
    case EXPR_CELL_NEAREST:
    case EXPR_CELL_SECOND:
    case EXPR_CELL_ID:
        return cells((struct expr_interval[3]){a, b, c}, operation);
    case EXPR_TEXEL:
        return texel(a, b, c);
    case EXPR_INTEGER_ADD:
        return integers(a.low + b.low, a.high + b.high);
    case EXPR_INTEGER_SUBTRACT:
        return integers(a.low - b.high, a.high - b.low);
    case EXPR_INTEGER_MULTIPLY:
        return integer_multiply(a, b);
    case EXPR_INTEGER_NEGATE:
        return integers(-a.high, -a.low);
    case EXPR_INTEGER_DIVIDE:
    case EXPR_INTEGER_MODULO:
    case EXPR_INTEGER_REMAINDER:
    case EXPR_BIT_AND:
    case EXPR_BIT_OR:
    case EXPR_BIT_XOR:
    case EXPR_SHIFT_LEFT:
    case EXPR_SHIFT_RIGHT:
        return integer_operation(operation, a, b);
    case EXPR_BIT_NOT:
        return integers(-a.high - 1, -a.low - 1);
    case EXPR_COPY:
    case EXPR_TO_FLOAT:
        return a;
    case EXPR_TO_INTEGER:
        return to_integer(a);
    case EXPR_LESS:
        return less(a, b);
    case EXPR_LESS_EQUAL:
        return less_equal(a, b);
    case EXPR_EQUAL:
        return equal(a, b);
    case EXPR_INTEGER_EQUAL:
    case EXPR_MIXED_EQUAL:
        return equal(a, b);
    case EXPR_INTEGER_LESS:
    case EXPR_INTEGER_LESS_EQUAL:
    case EXPR_MIXED_LESS:
    case EXPR_MIXED_LESS_EQUAL:
        return compare_integers(operation, a, b);
    case EXPR_MIXED_GREATER:
        return compare_integers(EXPR_MIXED_LESS, b, a);
    case EXPR_MIXED_GREATER_EQUAL:
        return compare_integers(EXPR_MIXED_LESS_EQUAL, b, a);
    case EXPR_WHOLE:
        return is_whole(a);
    case EXPR_SELECT:
    case EXPR_INTEGER_SELECT:
    case EXPR_TRUTH_SELECT:
        return selected(a, b, c);
    EXPR_LOOP_CASES:
    case EXPR_CONSTANT:
    case EXPR_INPUT:
    case EXPR_OPERATION_COUNT:
    case EXPR_ALL_OPERATIONS:
        break;
    }
    return anything;
}

struct expr_interval expr_interval_apply(enum expr_operation operation, struct expr_interval a, struct expr_interval b,
                                         struct expr_interval c) {
    return apply(operation, a, b, c);
}

struct expr_choice expr_interval_decide(enum expr_operation operation, struct expr_interval a, struct expr_interval b) {
    bool may_be_nan = a.may_be_nan || b.may_be_nan;
    if (operation == EXPR_MIN) /* for NaN, the first operand, too */
        return (struct expr_choice){a.high <= b.low, b.high < a.low && !may_be_nan};
    if (operation == EXPR_MAX)
        return (struct expr_choice){b.high <= a.low, a.high < b.low && !may_be_nan};
    if (operation == EXPR_ABS)
        return (struct expr_choice){a.low > 0, false};
    if (operation == EXPR_SELECT || operation == EXPR_INTEGER_SELECT || operation == EXPR_TRUTH_SELECT)
        return (struct expr_choice){a.low > 0, !(a.high > 0)};
    return (struct expr_choice){0, 0};
}

/* --- programs --- */

struct expr_interval expr_interval_of_integer(int64_t i) {
    return integers((double)i, (double)i);
}

#define OPERAND_F(value)                                                                                               \
    ((value) < program->constant_count ? expr_interval_of_float(program->constants[value].f) : values[value])
#define OPERAND_I(value)                                                                                               \
    ((value) < program->constant_count ? expr_interval_of_integer(program->constants[value].i) : values[value])
#define OPERAND_B(value)                                                                                               \
    ((value) < program->constant_count ? expr_interval_of_truth(program->constants[value].i) : values[value])
#define OPERAND_N(value) either
#define EVALUATE(member, name, R, A, B, C, expression)                                                                 \
    case member: {                                                                                                     \
        struct expr_interval a = OPERAND_##A(in->a), b = OPERAND_##B(in->b), c = OPERAND_##C(in->c);                   \
        values[in->out] =                                                                                              \
            member == EXPR_MULTIPLY && in->a == in->b ? expr_interval_square(a) : apply(member, a, b, c);              \
        if (choices)                                                                                                   \
            choices[in - program->code] = expr_interval_decide(member, a, b);                                          \
        break;                                                                                                         \
    }

/* See EXPR_DEFINE_RUN. Of a loop over one box: the states of the points that have not ended, and all that those that
 * have may have. */
struct interval_frame {
    const struct expr_program *program;
    const struct expr_loop *loop;
    const struct expr_instruction *in;
    struct expr_interval *values;
    struct expr_choice *choices;
    uint32_t first, step;    /* the steps are bounded one by one from `first` on; `step` is the next one, */
    bool is_rest, has_ended; /* or the first of all others, bounded at once; whether a point may have ended */
    struct expr_interval next[EXPR_STATES], ended[EXPR_STATES];
};

static inline struct expr_interval value_of(const struct expr_program *program, const struct expr_interval *values,
                                            enum expr_type type, uint16_t value) {
    switch (type) {
    case EXPR_TYPE_F:
        return OPERAND_F(value);
    case EXPR_TYPE_I:
        return OPERAND_I(value);
    case EXPR_TYPE_B:
        return OPERAND_B(value);
    case EXPR_TYPE_N:
        break;
    }
    return OPERAND_N(value);
}

/* One of the instructions before and after a loop. */
static void run_loop_access(const struct expr_program *program, const struct expr_instruction *in,
                            struct expr_interval *values) {
    const struct expr_loop_access at = expr_loop_access(program, in);
    const enum expr_type type = expr_operand_type((enum expr_operation)in->operation, 1);
    values[at.puts ? at.value : in->out] = at.puts ? value_of(program, values, type, in->b) : values[at.value];
}

static const struct expr_instruction *interval_continue(const struct interval_frame *f) {
    const struct expr_program *program = f->program;
    struct expr_interval *values = f->values;
    struct expr_choice *choices = f->choices;
    for (const struct expr_instruction *in = f->in, *end = program->code + program->count; in < end; in++) {
        switch ((enum expr_operation)in->operation) {
            EXPR_OPERATIONS(EVALUATE)
        EXPR_LOOP_CASES:
            if (choices)
                choices[in - program->code] = (struct expr_choice){0, 0};
            if (in->operation == EXPR_LOOP)
                return in;
            run_loop_access(program, in, values);
            end = program->code + program->count; /* it does not stay in a processor register over the call */
            break;
        case EXPR_CONSTANT:
        case EXPR_INPUT:
        case EXPR_OPERATION_COUNT:
        case EXPR_ALL_OPERATIONS:
            break;
        }
    }
    return NULL;
}

/* --- loops --- */

static void end_with(struct interval_frame *f, const struct expr_interval *states) {
    const uint32_t count = f->loop->state_count;
    for (uint32_t k = 0; k < count; k++)
        f->ended[k] = f->has_ended ? enclosure(f->ended[k], states[k]) : states[k];
    f->has_ended = true;
}

/* Ends the points whose first state is not > 0. False: no point goes on. */
static bool end_some(struct interval_frame *f, struct expr_interval *states) {
    struct expr_interval first = states[0];
    if (!f->loop->ends || !expr_may_end(first))
        return true;
    states[0].high = math_min(first.high, math_max(first.low, 0)); /* or NaN */
    end_with(f, states);
    states[0] = (struct expr_interval){math_max(first.low, f->loop->type[0] == EXPR_TYPE_I), first.high, false};
    return expr_may_go_on(first);
}

/* Nothing is known of one of the numbers, so that single steps hardly tell more than all of them. */
static bool is_lost(const struct interval_frame *f) {
    const struct expr_interval *states = f->values + f->program->constant_count;
    for (uint32_t k = 0; k < f->loop->state_count; k++)
        if (f->loop->type[k] == EXPR_TYPE_F && states[k].low == -INFINITY && states[k].high == INFINITY)
            return true;
    return false;
}

/* Extends the bounds of the states to those after another step, at once to 0 or without end, so that few repetitions
 * reach bounds which a step does not leave (P. Cousot and R. Cousot, "Abstract interpretation", POPL 1977: widening).
 * Each repetition extends an end of a state to the next of few values, so there are at most 5 for each state. False:
 * they contain them already. */
static bool widen(struct interval_frame *f) {
    bool has_grown = false;
    for (uint32_t k = 0; k < f->loop->state_count; k++) {
        struct expr_interval *state = &f->values[f->program->constant_count + k], next = f->next[k];
        const double end = f->loop->type[k] == EXPR_TYPE_F   ? (double)INFINITY
                           : f->loop->type[k] == EXPR_TYPE_I ? 0x1p63
                                                             : 1;
        bool grows = next.low < state->low || next.high > state->high || (next.may_be_nan && !state->may_be_nan);
        if (next.low < state->low)
            state->low = next.low >= 0 ? 0 : -end;
        if (next.high > state->high)
            state->high = next.high <= 0 ? 0 : end;
        state->may_be_nan = state->may_be_nan || next.may_be_nan;
        has_grown = has_grown || grows;
    }
    return has_grown;
}

static void begin_loop(struct interval_frame *f, const struct expr_loop *loop, uint32_t step,
                       struct expr_interval *values) {
    f->program = &loop->body;
    f->loop = loop;
    f->values = values;
    f->choices = NULL;
    f->first = f->step = step;
    f->is_rest = f->has_ended = false;
}

static void interval_begin_loop(const struct interval_frame *f, struct interval_frame *inner) {
    const struct expr_loop *loop = expr_loop_access(f->program, f->in).loop;
    begin_loop(inner, loop, loop->first, f->values + f->program->constant_count + loop->offset);
}

/* Begins a step, or all others at once. */
static void begin_body(struct interval_frame *f) {
    const double last = f->is_rest ? f->loop->last : f->step;
    f->values[f->program->constant_count + f->loop->argument_count] = (struct expr_interval){f->step, last, false};
    f->in = f->program->code;
}

/* All other steps at once have bounds that no step leaves. */
static bool interval_begin_step(struct interval_frame *f) {
    struct expr_interval *states = f->values + f->program->constant_count, *reached = f->is_rest ? f->next : states;
    const uint32_t steps = f->step - f->first;
    bool goes_on = f->step == 1 || end_some(f, reached);
    if (goes_on && !(f->is_rest ? widen(f) : f->step <= f->loop->last)) {
        end_with(f, reached);
        goes_on = false;
    }
    if (!goes_on) {
        memcpy(states, f->ended, f->loop->state_count * sizeof *states);
        return false;
    }
    f->is_rest = f->is_rest || steps >= EXPR_EXACT_STEPS || (steps >= 32 && is_lost(f));
    begin_body(f);
    return true;
}

static void interval_end_step(struct interval_frame *f) {
    const struct expr_loop *loop = f->loop;
    struct expr_interval *next = f->is_rest ? f->next : f->values + loop->body.constant_count;
    for (uint32_t k = 0; k < loop->state_count; k++)
        next[k] = value_of(&loop->body, f->values, loop->type[k], loop->next[k]);
    f->step += !f->is_rest;
}

EXPR_DEFINE_RUN(interval)

void expr_interval_loop(const struct expr_loop *loop, uint32_t step, struct expr_interval *values) {
    struct interval_frame frames[EXPR_FRAMES];
    begin_loop(frames, loop, step, values);
    if (interval_begin_step(frames))
        interval_run(frames);
}

void expr_interval_loop_rest(const struct expr_loop *loop, uint32_t step, bool has_ended, struct expr_interval *ended,
                             struct expr_interval *values) {
    struct interval_frame frames[EXPR_FRAMES];
    begin_loop(frames, loop, step, values);
    frames[0].is_rest = true;
    frames[0].has_ended = has_ended;
    if (has_ended)
        memcpy(frames[0].ended, ended, loop->state_count * sizeof *ended);
    begin_body(frames);
    interval_run(frames);
    memcpy(ended, frames[0].ended, loop->state_count * sizeof *ended);
}

/* --- one box --- */

void expr_evaluate_interval(const struct expr_program *program, const struct expr_interval inputs[EXPR_INPUT_COUNT],
                            struct expr_interval outputs[EXPR_OUTPUTS], struct expr_choice *choices, void *rows) {
    struct expr_interval *values = rows;
    struct interval_frame frames[EXPR_FRAMES];
    for (int i = 0; i < program->input_count; i++)
        values[program->inputs[i].value] = inputs[program->inputs[i].input];
    frames[0].program = program;
    frames[0].loop = NULL;
    frames[0].in = program->code;
    frames[0].values = values;
    frames[0].choices = choices;
    interval_run(frames);
    for (int i = 0; i < program->output_count; i++)
        outputs[i] = OPERAND_F(program->outputs[i]);
}

/* --- many boxes --- */

size_t expr_intervals_size(const struct expr_program *program) {
    return (size_t)program->row_count * (2 * EXPR_BOXES * sizeof(double) + sizeof(struct expr_flags));
}

static void put_inputs(const struct expr_program *program, const struct expr_boxes *boxes, uint32_t width, double *rows,
                       struct expr_flags *flags) {
    for (int i = 0; i < program->input_count; i++) {
        uint32_t number = (uint32_t)program->inputs[i].value - program->constant_count;
        double *low = rows + (size_t)number * 2 * EXPR_BOXES, *high = low + EXPR_BOXES;
        for (uint32_t k = 0; k < width; k++) {
            low[k] = k < boxes->count ? boxes->low[program->inputs[i].input][k] : 0;
            high[k] = k < boxes->count ? boxes->high[program->inputs[i].input][k] : 0;
        }
        flags[number] = (struct expr_flags){0, 0};
    }
}

void expr_evaluate_intervals(const struct expr_program *program, const struct expr_boxes *boxes,
                             struct expr_bounds outputs[EXPR_OUTPUTS], struct expr_choice *choices, void *rows) {
    uint32_t width = (boxes->count + 7) & ~7U;
    double *values = rows;
    struct expr_flags *flags = (struct expr_flags *)(void *)(values + (size_t)program->row_count * 2 * EXPR_BOXES);
    put_inputs(program, boxes, width, values, flags);
    CPU_ISA_CALL(expr_run_intervals, program, width, values, flags, choices)
    for (int i = 0; i < program->output_count; i++) {
        uint16_t value = program->outputs[i];
        bool is_constant = value < program->constant_count;
        uint32_t number = (uint32_t)value - program->constant_count;
        struct expr_interval constant = {0, 0, false};
        if (is_constant)
            constant = expr_interval_of_float(program->constants[value].f);
        const double *low = values + (size_t)number * 2 * EXPR_BOXES;
        for (uint32_t k = 0; k < boxes->count; k++) {
            outputs[i].low[k] = is_constant ? constant.low : low[k];
            outputs[i].high[k] = is_constant ? constant.high : low[k + EXPR_BOXES];
        }
        outputs[i].may_be_nan = is_constant ? -(uint64_t)constant.may_be_nan : flags[number].first;
    }
}
