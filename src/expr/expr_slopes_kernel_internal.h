/* Bounds and slopes over eight boxes, compiled for the instruction set of the file that includes this one: arithmetic,
 * roots, choices, sines and exponentials on vectors of boxes, everything else box by box with expr_rooted_apply. The
 * formulas are those of expr_derivative.c and expr_interval.c. Results have the same bits for every width of
 * vectors. */
#include "expr/expr_derivative_internal.h"
#include "expr/expr_outwards_internal.h"
#include "expr/expr_slopes_internal.h"
#include "math/elementary_lanes.h"

/* The part of an array that a vector covers. */
#define EACH_VECTOR for (int i = 0; i < EXPR_LANES; i += DOUBLE_LANES)

/* The types of operands. */
#define TYPES_OF(member, name, R, A, B, C, expression) [member] = {EXPR_TYPE_##A, EXPR_TYPE_##B, EXPR_TYPE_##C},
#define LOOP_TYPES_OF(member, name, R, A, B, C) [member] = {EXPR_TYPE_##A, EXPR_TYPE_##B, EXPR_TYPE_##C},
static const uint8_t operand_types[EXPR_ALL_OPERATIONS][3] = {EXPR_OPERATIONS(TYPES_OF)
                                                                  EXPR_LOOP_OPERATIONS(LOOP_TYPES_OF)};

/* Lower and upper ends. */
struct span {
    double_lanes low, high;
};

enum { ALL_LANES = (1 << EXPR_LANES) - 1 };

struct machine {
    const struct expr_program *program;
    struct expr_lanes *values, constants[3];
    int directions;
    bool are_cases;
    int cases; /* that are divided among the lanes */
};

/* --- spans --- */

static inline struct span outwards(struct span a) {
    return (struct span){below(a.low), above(a.high)};
}

static inline struct span enclosure(struct span a, struct span b) {
    return (struct span){double_lanes_min(a.low, b.low), double_lanes_max(a.high, b.high)};
}

static inline struct span pick(double_lanes_mask mask, struct span a, struct span b) {
    return (struct span){double_lanes_choose(mask, a.low, b.low), double_lanes_choose(mask, a.high, b.high)};
}

static inline struct span anything(void) {
    return (struct span){double_lanes_all(-(double)INFINITY), double_lanes_all((double)INFINITY)};
}

static inline struct span single_number(double x) {
    return (struct span){double_lanes_all(x), double_lanes_all(x)};
}

/* Ends that are not numbers are unbounded. */
static inline struct span repaired(struct span a) {
    double_lanes_mask unknown = double_lanes_unordered(a.low + a.high, a.low + a.high);
    return BITS(unknown) ? pick(unknown, anything(), a) : a;
}

static inline struct span sum_of(struct span a, struct span b) {
    return repaired(outwards((struct span){a.low + b.low, a.high + b.high}));
}

/* Products of the ends; NaN for infinity times 0. */
static inline struct span corners(struct span a, struct span b, double_lanes *check) {
    double_lanes p = a.low * b.low, q = a.low * b.high, r = a.high * b.low, s = a.high * b.high;
    *check = p + q + (r + s);
    return (struct span){double_lanes_min(double_lanes_min(p, q), double_lanes_min(r, s)),
                         double_lanes_max(double_lanes_max(p, q), double_lanes_max(r, s))};
}

static inline double_lanes size_of(struct span a) {
    return double_lanes_max(-a.low, a.high) + double_lanes_all(0);
}

/* A slope times a derivative; a slope of 0 stays 0. */
static inline struct span slope_times(struct span slope, struct span by) {
    double_lanes check;
    struct span out = outwards(corners(slope, by, &check));
    double_lanes_mask unknown = double_lanes_unordered(check, check);
    if (!BITS(unknown))
        return out;
    out = pick(unknown, anything(), out);
    double_lanes_mask is_some = double_lanes_less(double_lanes_all(0), size_of(slope));
    return pick(is_some, out, single_number(0));
}

/* Of a slope that is divided by what is above 0, or may be 0. */
static inline struct span over_positive(struct span slope, struct span by) {
    double_lanes_mask below_0 = double_lanes_less(slope.low, double_lanes_all(0)),
                      above_0 = double_lanes_less(double_lanes_all(0), slope.high);
    return (struct span){double_lanes_choose(below_0, slope.low / by.low, slope.low / by.high),
                         double_lanes_choose(above_0, slope.high / by.low, slope.high / by.high)};
}

/* --- operands --- */

static inline struct span value_of(const struct expr_lanes *a, int i) {
    return (struct span){double_lanes_load(a->low + i), double_lanes_load(a->high + i)};
}

static inline struct span slope_of(const struct expr_lanes *a, int k, int i) {
    return (struct span){double_lanes_load(a->slopes[k].low + i), double_lanes_load(a->slopes[k].high + i)};
}

static inline void put_value(struct expr_lanes *out, int i, struct span a) {
    double_lanes_store(out->low + i, a.low);
    double_lanes_store(out->high + i, a.high);
}

static inline void put_slope(struct expr_lanes *out, int k, int i, struct span a) {
    double_lanes_store(out->slopes[k].low + i, a.low);
    double_lanes_store(out->slopes[k].high + i, a.high);
}

/* Results that are not numbers may be anything, and NaN. */
static inline void put_computed(struct expr_lanes *out, int i, struct span a, double_lanes check) {
    double_lanes_mask unknown = double_lanes_unordered(check, check);
    if (BITS(unknown)) {
        a = pick(unknown, anything(), a);
        out->may_be_nan |= (uint32_t)(BITS(unknown) << i);
    }
    put_value(out, i, a);
}

static inline const struct expr_lanes *operand(struct machine *run, const struct expr_instruction *in, int k,
                                               uint16_t value) {
    const uint32_t constants = run->program->constant_count;
    enum expr_type type = (enum expr_type)operand_types[in->operation][k];
    struct expr_lanes *out = &run->constants[k];
    if (type != EXPR_TYPE_N && value >= constants)
        return &run->values[value - constants];
    out->may_be_nan = 0;
    if (type == EXPR_TYPE_N)
        return out;
    struct expr_interval x = expr_interval_of_constant(type, run->program->constants[value]);
    EACH_VECTOR put_value(out, i, (struct span){double_lanes_all(x.low), double_lanes_all(x.high)});
    out->may_be_nan = x.may_be_nan ? ALL_LANES : 0;
    return out;
}

/* The largest slopes of the root of an operand. */
static inline double_lanes root_of(const struct expr_lanes *a, int k, int i) {
    double_lanes known = a->has_roots ? double_lanes_load(a->roots[k] + i) : double_lanes_all((double)INFINITY);
    double_lanes is_moving = double_lanes_max(size_of(slope_of(a, k, i)), -double_lanes_load(a->low + i));
    return double_lanes_choose(double_lanes_less(double_lanes_all(0), is_moving), known, double_lanes_all(0));
}

/* --- box by box --- */

static struct expr_rooted lane_of(const struct expr_lanes *a, int directions, int lane) {
    struct expr_rooted out;
    out.range.value = (struct expr_interval){a->low[lane], a->high[lane], a->may_be_nan >> lane & 1};
    out.range.is_nan = a->is_nan >> lane & 1;
    for (int k = 0; k < directions; k++) {
        out.range.slopes[k] = (struct expr_interval){a->slopes[k].low[lane], a->slopes[k].high[lane], false};
        out.roots[k] = a->has_roots ? a->roots[k][lane] : (double)INFINITY;
    }
    return out;
}

static void run_singly(const struct machine *run, const struct expr_instruction *in, const struct expr_lanes *from[3],
                       struct expr_lanes *out, struct expr_choice *decided) {
    struct expr_lanes result;
    result.may_be_nan = result.is_nan = 0;
    result.has_roots = false;
    for (int lane = 0; lane < EXPR_LANES; lane++) {
        struct expr_rooted operands[3], of_lane;
        const struct expr_rooted *pointers[3] = {&operands[0], &operands[1], &operands[2]};
        for (int k = 0; k < 3; k++)
            operands[k] = lane_of(from[k], run->directions, lane);
        expr_rooted_apply(in, pointers, run->directions, &of_lane);
        struct expr_choice choice =
            expr_interval_decide((enum expr_operation)in->operation, operands[0].range.value, operands[1].range.value);
        decided->first |= choice.first << lane;
        decided->second |= choice.second << lane;
        result.low[lane] = of_lane.range.value.low;
        result.high[lane] = of_lane.range.value.high;
        result.may_be_nan |= (uint32_t)of_lane.range.value.may_be_nan << lane;
        result.is_nan |= (uint32_t)of_lane.range.is_nan << lane;
        for (int k = 0; k < run->directions; k++) {
            result.slopes[k].low[lane] = of_lane.range.slopes[k].low;
            result.slopes[k].high[lane] = of_lane.range.slopes[k].high;
        }
    }
    *out = result;
}

static void put_lane(const struct expr_rooted *from, int directions, int lane, struct expr_lanes *to) {
    const uint32_t bit = 1U << lane;
    to->low[lane] = from->range.value.low;
    to->high[lane] = from->range.value.high;
    to->may_be_nan = from->range.value.may_be_nan ? to->may_be_nan | bit : to->may_be_nan & ~bit;
    to->is_nan = from->range.is_nan ? to->is_nan | bit : to->is_nan & ~bit;
    for (int k = 0; k < directions; k++) {
        to->slopes[k].low[lane] = from->range.slopes[k].low;
        to->slopes[k].high[lane] = from->range.slopes[k].high;
    }
}

/* from: the value that is put; out: the value that is taken. */
static void run_loop_operation(const struct machine *run, const struct expr_instruction *in,
                               const struct expr_lanes *from, struct expr_lanes *out) {
    const enum expr_operation operation = (enum expr_operation)in->operation;
    const struct expr_loop_access at = expr_loop_access(run->program, in);
    const struct expr_loop *loop = at.loop;
    struct expr_lanes *of_loop = run->values + loop->offset, *slot = of_loop + at.slot;
    if (at.puts)
        *slot = *from;
    else if (operation != EXPR_LOOP)
        *out = *slot;
    if (operation != EXPR_LOOP)
        return;
    const uint32_t constants = loop->body.constant_count, rows = loop->body.row_count;
    struct expr_rooted *values = (struct expr_rooted *)(void *)(of_loop + expr_loop_rows(loop) / 2);
    struct expr_interval *scratch = (struct expr_interval *)(void *)(values + constants + rows);
    for (int lane = 0; lane < EXPR_LANES; lane++) {
        for (uint32_t k = 0; k < loop->argument_count; k++)
            values[constants + k] = lane_of(&of_loop[k], run->directions, lane);
        expr_rooted_loop(loop, run->directions, values, scratch);
        for (uint32_t k = 0; k < loop->state_count; k++)
            put_lane(&values[constants + k], run->directions, lane, &of_loop[k]);
    }
    for (uint32_t k = 0; k < loop->state_count; k++)
        of_loop[k].has_roots = false;
}

/* --- sines and exponentials --- */

/* The functions at all ends of an operand, with the bits of single calls. */
static void sincos_of(const double *from, double *sines, double *cosines) {
    int other = 0;
    for (int i = 0; i < EXPR_LANES; i++)
        other |= !el_angle_fits(from[i]);
    for (int i = 0; i < EXPR_LANES; i++)
        el_sincos_lane(from[i], &sines[i], &cosines[i]);
    for (int i = 0; other && i < EXPR_LANES; i++)
        el_sincos(from[i], &sines[i], &cosines[i]);
}

static void exponentials_of(const double *from, double *out) {
    int other = 0;
    for (int i = 0; i < EXPR_LANES; i++)
        other |= !el_exp_fits(from[i]);
    for (int i = 0; i < EXPR_LANES; i++)
        out[i] = el_exp_lane(from[i]);
    for (int i = 0; other && i < EXPR_LANES; i++)
        out[i] = el_exp(from[i]);
}

/* By three units, as for all elementary functions. */
static inline struct span widened(struct span a) {
    const double_lanes unit = double_lanes_all(2 * DBL_EPSILON), tiny = double_lanes_all(DBL_TRUE_MIN);
    double_lanes low = a.low - double_lanes_size(a.low) * unit, high = a.high + double_lanes_size(a.high) * unit;
    return (struct span){double_lanes_choose(double_lanes_less(low, a.low), low - tiny, a.low),
                         double_lanes_choose(double_lanes_less(a.high, high), high + tiny, a.high)};
}

/* Where an angle start + n * 2 pi is between the ends, or closer to them than rounding errors. */
static inline double_lanes_mask contains_angle(struct span a, double start) {
    const double turn = 2 * PI, slack = 1e-9;
    return double_lanes_less_equal(
        double_lanes_ceil((a.low - double_lanes_all(start) - double_lanes_all(slack)) / double_lanes_all(turn)),
        double_lanes_floor((a.high - double_lanes_all(start) + double_lanes_all(slack)) / double_lanes_all(turn)));
}

/* Sine or cosine between ends that have these values, with its maximum at `top`. */
static inline struct span wave(struct span a, double_lanes at_low, double_lanes at_high, double top) {
    struct span out = {double_lanes_min(at_low, at_high), double_lanes_max(at_low, at_high)};
    out.low = double_lanes_choose(contains_angle(a, top + PI), double_lanes_all(-1), out.low);
    out.high = double_lanes_choose(contains_angle(a, top), double_lanes_all(1), out.high);
    out = widened(out);
    out =
        (struct span){double_lanes_max(out.low, double_lanes_all(-1)), double_lanes_min(out.high, double_lanes_all(1))};
    double_lanes_mask is_known = double_lanes_less(a.high - a.low, double_lanes_all(2 * PI)),
                      is_small = double_lanes_less(size_of(enclosure(a, single_number(0))), double_lanes_all(1e6));
    return pick(is_known, pick(is_small, out, (struct span){double_lanes_all(-1), double_lanes_all(1)}),
                (struct span){double_lanes_all(-1), double_lanes_all(1)});
}

/* The sine, the cosine, or both; of one NULL. */
static void run_wave(struct machine *run, const struct expr_lanes *from, struct expr_lanes *of_sine,
                     struct expr_lanes *of_cosine) {
    double __attribute__((aligned(64))) sines[2][EXPR_LANES], cosines[2][EXPR_LANES];
    /* At both ends of each interval. */
    sincos_of(from->low, sines[0], cosines[0]);
    sincos_of(from->high, sines[1], cosines[1]);
    uint32_t may_be_nan = from->may_be_nan, is_nan = from->is_nan;
    EACH_VECTOR {
        const struct span a = value_of(from, i);
        const struct span sine = wave(a, double_lanes_load(sines[0] + i), double_lanes_load(sines[1] + i), PI / 2);
        const struct span cosine = wave(a, double_lanes_load(cosines[0] + i), double_lanes_load(cosines[1] + i), 0);
        /* The waves of infinity are not numbers. */
        may_be_nan |=
            (uint32_t)(IS_LESS_EQUAL(double_lanes_all((double)INFINITY), double_lanes_max(-a.low, a.high)) << i);
        /* The slope of one is that of its argument times the other. */
        for (int k = 0; k < run->directions; k++) {
            const struct span slope = slope_of(from, k, i);
            if (of_sine)
                put_slope(of_sine, k, i, slope_times(slope, cosine));
            if (of_cosine)
                put_slope(of_cosine, k, i, slope_times(slope, (struct span){-sine.high, -sine.low}));
        }
        if (of_sine)
            put_value(of_sine, i, sine);
        if (of_cosine)
            put_value(of_cosine, i, cosine);
    }
    for (int k = 0; k < 2; k++) {
        struct expr_lanes *out = k == 0 ? of_sine : of_cosine;
        if (!out)
            continue;
        out->may_be_nan = may_be_nan;
        out->is_nan = is_nan;
        out->has_roots = false;
    }
}

static void run_exponential(struct machine *run, const struct expr_lanes *from, struct expr_lanes *out) {
    double __attribute__((aligned(64))) ends[2][EXPR_LANES];
    exponentials_of(from->low, ends[0]);
    exponentials_of(from->high, ends[1]);
    uint32_t may_be_nan = from->may_be_nan, is_nan = from->is_nan; /* out may be from */
    EACH_VECTOR {
        struct span value = widened((struct span){double_lanes_load(ends[0] + i), double_lanes_load(ends[1] + i)});
        value.low = double_lanes_max(value.low, double_lanes_all(0));
        for (int k = 0; k < run->directions; k++)
            put_slope(out, k, i, slope_times(slope_of(from, k, i), value));
        put_value(out, i, value);
    }
    out->may_be_nan = may_be_nan;
    out->is_nan = is_nan;
    out->has_roots = false;
}

/* --- arithmetic --- */

static inline void run_product(struct machine *run, const struct expr_lanes *a, const struct expr_lanes *b,
                               bool is_square, struct expr_lanes *out) {
    const uint32_t is_nan = a->is_nan | b->is_nan;
    const bool a_is_constant = a == &run->constants[0], b_is_constant = b == &run->constants[1];
    out->may_be_nan = a->may_be_nan | b->may_be_nan;
    EACH_VECTOR {
        const struct span x = value_of(a, i), y = value_of(b, i);
        /* The value: of a square from its size, otherwise from the four corners. */
        double_lanes check = double_lanes_all(0);
        struct span value;
        if (is_square) {
            double_lanes near = double_lanes_max(double_lanes_max(x.low, -x.high), double_lanes_all(0)),
                         far = double_lanes_max(-x.low, x.high);
            value = (struct span){near * near, far * far};
        } else {
            value = corners(x, y, &check);
        }
        /* The slopes: a' b + a b'. */
        for (int k = 0; k < run->directions; k++) {
            struct span slope, s = slope_of(a, k, i), t = slope_of(b, k, i);
            if (is_square) {
                slope = slope_times(s, x);
                slope = (struct span){slope.low + slope.low, slope.high + slope.high};
                double_lanes largest = size_of(s);
                double_lanes_store(out->roots[k] + i, largest + largest * double_lanes_all(4 * DBL_EPSILON));
            } else if (b_is_constant || a_is_constant) {
                slope = b_is_constant ? slope_times(s, y) : slope_times(t, x);
            } else {
                slope = sum_of(slope_times(s, y), slope_times(t, x));
            }
            put_slope(out, k, i, slope);
        }
        put_computed(out, i, outwards(value), check);
    }
    out->is_nan = is_nan;
    out->has_roots = is_square;
}

static inline void run_sum(struct machine *run, const struct expr_lanes *a, const struct expr_lanes *b,
                           bool is_difference, struct expr_lanes *out) {
    const bool has_roots = !is_difference && (a->has_roots || b->has_roots), b_is_constant = b == &run->constants[1];
    const uint32_t is_nan = a->is_nan | b->is_nan;
    out->may_be_nan = a->may_be_nan | b->may_be_nan;
    EACH_VECTOR {
        struct span x = value_of(a, i), y = value_of(b, i);
        for (int k = 0; k < run->directions; k++) {
            double_lanes root = has_roots ? root_of(a, k, i) : double_lanes_all(0),
                         other = has_roots ? root_of(b, k, i) : double_lanes_all(0);
            struct span s = slope_of(a, k, i), t = slope_of(b, k, i);
            if (is_difference)
                t = (struct span){-t.high, -t.low};
            put_slope(out, k, i, b_is_constant ? s : sum_of(s, t));
            if (has_roots) {
                double_lanes both = double_lanes_root(root * root + other * other);
                double_lanes_store(out->roots[k] + i, both + both * double_lanes_all(4 * DBL_EPSILON));
            }
        }
        if (is_difference)
            y = (struct span){-y.high, -y.low};
        struct span value = {x.low + y.low, x.high + y.high};
        put_computed(out, i, outwards(value), value.low + value.high);
    }
    out->is_nan = is_nan;
    out->has_roots = has_roots;
}

/* The quotient rule: (a' - value b') / b, with signs so that b is above 0. */
static inline void run_quotient(struct machine *run, const struct expr_lanes *a, const struct expr_lanes *b,
                                struct expr_lanes *out) {
    const bool b_is_constant = b == &run->constants[1];
    const uint32_t is_nan = a->is_nan | b->is_nan;
    uint32_t may_be_nan = a->may_be_nan | b->may_be_nan;
    EACH_VECTOR {
        const struct span x = value_of(a, i), y = value_of(b, i);
        double_lanes_mask is_negative = double_lanes_less(y.high, double_lanes_all(0));
        struct span by = pick(is_negative, (struct span){-y.high, -y.low}, y);
        struct span over = pick(is_negative, (struct span){-x.high, -x.low}, x);
        double_lanes_mask has_zero = double_lanes_less_equal(by.low, double_lanes_all(0));
        struct span value = pick(has_zero, anything(), outwards(over_positive(over, by)));
        /* NaN is 0 / 0 or infinity by infinity. */
        double_lanes nearest = double_lanes_max(double_lanes_max(x.low, -x.high), double_lanes_all(0));
        uint64_t is_some = IS_LESS(double_lanes_all(0), nearest), zeros = BITS(has_zero) & ~is_some;
        uint64_t infinite = IS_LESS_EQUAL(double_lanes_all((double)INFINITY), double_lanes_max(-x.low, x.high)) &
                            IS_LESS_EQUAL(double_lanes_all((double)INFINITY), double_lanes_max(-y.low, y.high));
        may_be_nan |= (uint32_t)((zeros | infinite) << i);
        if (infinite)
            value = (struct span){double_lanes_choose_bits(infinite, double_lanes_all(-(double)INFINITY), value.low),
                                  double_lanes_choose_bits(infinite, double_lanes_all((double)INFINITY), value.high)};
        for (int k = 0; k < run->directions; k++) {
            struct span s = slope_of(a, k, i), t = slope_of(b, k, i), slope = s;
            if (!b_is_constant) {
                struct span other = slope_times(t, value);
                slope = sum_of(slope, (struct span){-other.high, -other.low});
            }
            slope = pick(is_negative, (struct span){-slope.high, -slope.low}, slope);
            slope = repaired(outwards(over_positive(slope, by)));
            double_lanes_mask moves = double_lanes_less(double_lanes_all(0), double_lanes_max(size_of(s), size_of(t)));
            put_slope(out, k, i, pick(has_zero, pick(moves, anything(), single_number(0)), slope));
        }
        put_value(out, i, value);
    }
    out->may_be_nan = may_be_nan;
    out->is_nan = is_nan;
    out->has_roots = false;
}

static inline void run_root(struct machine *run, const struct expr_lanes *a, struct expr_lanes *out) {
    uint32_t is_nan = a->is_nan;
    out->may_be_nan = a->may_be_nan;
    EACH_VECTOR {
        const struct span x = value_of(a, i);
        struct span value = {below(double_lanes_root(double_lanes_max(x.low, double_lanes_all(0)))),
                             above(double_lanes_root(x.high))};
        is_nan |= (uint32_t)(IS_LESS(x.high, double_lanes_all(0)) << i);
        out->may_be_nan |= (uint32_t)(IS_LESS(x.low, double_lanes_all(0)) << i);
        for (int k = 0; k < run->directions; k++) {
            struct span t = slope_of(a, k, i), half = {t.low * double_lanes_all(0.5), t.high * double_lanes_all(0.5)};
            struct span slope = repaired(outwards(over_positive(half, value)));
            double_lanes max = root_of(a, k, i);
            put_slope(
                out, k, i,
                (struct span){
                    double_lanes_max(slope.low, double_lanes_choose(double_lanes_less(t.low, double_lanes_all(0)), -max,
                                                                    double_lanes_all(0))),
                    double_lanes_min(slope.high, double_lanes_choose(double_lanes_less(double_lanes_all(0), t.high),
                                                                     max, double_lanes_all(0)))});
        }
        put_computed(out, i, value, value.high);
    }
    out->is_nan = is_nan;
    out->has_roots = false;
}

/* --- choices --- */

static inline void run_extreme(struct machine *run, const struct expr_lanes *a, const struct expr_lanes *b, bool is_max,
                               struct expr_lanes *out, struct expr_choice *decided) {
    const uint32_t a_nan = a->may_be_nan, b_nan = b->may_be_nan, is_nan = a->is_nan;
    EACH_VECTOR {
        const struct span x = value_of(a, i), y = value_of(b, i);
        /* Lanes that an operand decides. */
        double_lanes_mask first =
            is_max ? double_lanes_less_equal(y.high, x.low) : double_lanes_less_equal(x.high, y.low);
        double_lanes_mask second = is_max ? double_lanes_less(x.high, y.low) : double_lanes_less(y.high, x.low);
        struct span value = is_max ? (struct span){double_lanes_max(x.low, y.low), double_lanes_max(x.high, y.high)}
                                   : (struct span){double_lanes_min(x.low, y.low), double_lanes_min(x.high, y.high)};
        /* The slopes of that operand, or of both. */
        for (int k = 0; k < run->directions; k++) {
            struct span s = slope_of(a, k, i), t = slope_of(b, k, i);
            struct span slope = pick(first, s, pick(second, t, enclosure(s, t)));
            if (b_nan)
                slope =
                    (struct span){double_lanes_choose_bits(b_nan >> i, double_lanes_all(-(double)INFINITY), slope.low),
                                  double_lanes_choose_bits(b_nan >> i, double_lanes_all((double)INFINITY), slope.high)};
            put_slope(out, k, i, slope);
        }
        decided->first |= BITS(first) << i;
        decided->second |= BITS(second) << i;
        /* Where b is not a number, the result is a. */
        if (b_nan && is_max)
            value.low = double_lanes_choose_bits(b_nan >> i, x.low, value.low);
        else if (b_nan)
            value.high = double_lanes_choose_bits(b_nan >> i, x.high, value.high);
        put_value(out, i, value);
    }
    decided->second &= ~(uint64_t)(a_nan | b_nan);
    out->may_be_nan = a_nan;
    out->is_nan = is_nan;
    out->has_roots = false;
}

static inline void run_size(struct machine *run, const struct expr_lanes *a, struct expr_lanes *out,
                            struct expr_choice *decided) {
    uint32_t may_be_nan = a->may_be_nan, is_nan = a->is_nan;
    EACH_VECTOR {
        const struct span x = value_of(a, i);
        double_lanes_mask is_positive = double_lanes_less_equal(double_lanes_all(0), x.low),
                          is_negative = double_lanes_less_equal(x.high, double_lanes_all(0));
        decided->first |= IS_LESS(double_lanes_all(0), x.low) << i;
        for (int k = 0; k < run->directions; k++) {
            struct span s = slope_of(a, k, i), t = {-s.high, -s.low};
            put_slope(out, k, i, pick(is_positive, s, pick(is_negative, t, enclosure(s, t))));
        }
        put_value(out, i,
                  (struct span){double_lanes_max(double_lanes_max(x.low, -x.high), double_lanes_all(0)),
                                double_lanes_max(-x.low, x.high)});
    }
    out->may_be_nan = may_be_nan;
    out->is_nan = is_nan;
    out->has_roots = false;
}

static inline void run_negation(struct machine *run, const struct expr_lanes *a, struct expr_lanes *out) {
    EACH_VECTOR {
        const struct span x = value_of(a, i);
        for (int k = 0; k < run->directions; k++) {
            struct span s = slope_of(a, k, i);
            put_slope(out, k, i, (struct span){-s.high, -s.low});
        }
        put_value(out, i, (struct span){-x.high, -x.low});
    }
    out->may_be_nan = a->may_be_nan;
    out->is_nan = a->is_nan;
    out->has_roots = false;
}

/* --- cases --- */

/* Lanes in which a case has its second side: half of them, others for each case. */
static const uint32_t second_sides[] = {0xaa, 0xcc, 0xf0};

/* Divides a jump of the result among the lanes, if there is one with two sides and room for it. */
static void divide_case(struct machine *run, const struct expr_instruction *in, const struct expr_lanes *from[3],
                        struct expr_lanes *out) {
    bool is_divided = false;
    struct expr_lanes result = *out;
    for (int lane = 0; lane < EXPR_LANES && run->cases < (int)(sizeof second_sides / sizeof second_sides[0]); lane++) {
        /* Each lane gets one of the two sides of a jump. */
        const bool second = second_sides[run->cases] >> lane & 1;
        double low = out->low[lane], high = out->high[lane], slope = 0;
        if ((out->may_be_nan | from[0]->may_be_nan | from[1]->may_be_nan) >> lane & 1)
            continue;
        /* A modulo that wraps once. */
        if (in->operation == EXPR_MODULO) {
            double period = from[1]->low[lane], a = from[0]->low[lane], b = from[0]->high[lane];
            double before = expr_modulo(a, period), after = expr_modulo(b, period);
            if (!(period > 0 && period >= from[1]->high[lane] && b - a < 0.5 * period && before > after))
                continue;
            low = second ? 0 : before - period * DBL_EPSILON;
            high = second ? after + period * DBL_EPSILON : period;
            slope = 1;
        } else if (high == low + 1) {
            low = second ? high : low;
            high = low;
        } else {
            continue;
        }
        is_divided = true;
        result.low[lane] = low;
        result.high[lane] = high;
        for (int k = 0; k < run->directions; k++) {
            result.slopes[k].low[lane] = slope > 0 ? from[0]->slopes[k].low[lane] : 0;
            result.slopes[k].high[lane] = slope > 0 ? from[0]->slopes[k].high[lane] : 0;
        }
    }
    run->cases += is_divided;
    *out = result;
}

static bool may_be_divided(enum expr_operation operation) {
    return operation == EXPR_FLOOR || operation == EXPR_CEIL || operation == EXPR_FLOOR_DIVIDE ||
           operation == EXPR_MODULO || expr_result_type(operation) == EXPR_TYPE_B;
}

/* --- all of them --- */

static inline __attribute__((always_inline)) void run_lanes(struct machine *run, struct expr_choice *choices) {
    const struct expr_program *program = run->program;
    for (const struct expr_instruction *in = program->code, *end = in + program->count; in < end; in++) {
        struct expr_lanes *out = &run->values[(uint32_t)in->out - program->constant_count];
        const struct expr_lanes *from[3] = {operand(run, in, 0, in->a), operand(run, in, 1, in->b),
                                            operand(run, in, 2, in->c)};
        struct expr_choice decided = {0, 0};
        switch (
            (unsigned)in->operation) { /* no list: every operation without vectors, new ones too, is right box by box */
        case EXPR_COPY:
            *out = *from[0];
            break;
        case EXPR_ADD:
        case EXPR_SUBTRACT:
            run_sum(run, from[0], from[1], in->operation == EXPR_SUBTRACT, out);
            break;
        case EXPR_MULTIPLY:
            run_product(run, from[0], from[1], in->a == in->b, out);
            break;
        case EXPR_DIVIDE:
            run_quotient(run, from[0], from[1], out);
            break;
        case EXPR_NEGATE:
            run_negation(run, from[0], out);
            break;
        case EXPR_ABS:
            run_size(run, from[0], out, &decided);
            break;
        case EXPR_SQRT:
            run_root(run, from[0], out);
            break;
        case EXPR_MIN:
        case EXPR_MAX:
            run_extreme(run, from[0], from[1], in->operation == EXPR_MAX, out, &decided);
            break;
        case EXPR_SIN:
        case EXPR_COS: {
            struct expr_lanes *other = NULL;
            const bool is_sine = in->operation == EXPR_SIN;
            if (expr_is_pair(in, end)) {
                if (choices)
                    choices[in - program->code] = decided;
                other = &run->values[(uint32_t)(++in)->out - program->constant_count];
            }
            run_wave(run, from[0], is_sine ? out : other, is_sine ? other : out);
            break;
        }
        case EXPR_EXP:
            run_exponential(run, from[0], out);
            break;
        EXPR_LOOP_CASES:
            run_loop_operation(run, in, from[1], out);
            break;
        default: {
            struct expr_lanes result;
            run_singly(run, in, from, &result, &decided);
            if (run->are_cases && may_be_divided((enum expr_operation)in->operation))
                divide_case(run, in, from, &result);
            *out = result;
        }
        }
        if (choices)
            choices[in - program->code] = decided;
    }
}

void KERNEL(run_slopes)(const struct expr_program *program, int directions, bool are_cases, struct expr_lanes *values,
                        struct expr_choice *choices) {
    struct machine run = {.program = program, .values = values, .are_cases = are_cases, .cases = 0};
    for (int k = 0; k < 3; k++)
        run.constants[k] = (struct expr_lanes){.has_roots = false};
    if (directions == 1) {
        run.directions = 1;
        run_lanes(&run, choices);
    } else {
        run.directions = directions;
        run_lanes(&run, choices);
    }
}
