/* See expr_affine.h. Every value has an interval beside its form, and the interval is never wider than the form. */
#include "expr/expr_affine.h"

#include "expr/expr_interval_internal.h"

#include <float.h>
#include <math.h>

static double spread_of(struct expr_affine a) {
    return fabs(a.slopes[0]) + fabs(a.slopes[1]) + a.rest;
}

/* With the rounding of a few operations. */
static struct expr_affine rounded(struct expr_affine a) {
    a.rest += 8 * DBL_EPSILON * (fabs(a.middle) + spread_of(a));
    return a;
}

struct expr_affine expr_affine_add(struct expr_affine a, struct expr_affine b) {
    return rounded((struct expr_affine){
        a.middle + b.middle, {a.slopes[0] + b.slopes[0], a.slopes[1] + b.slopes[1]}, a.rest + b.rest});
}

struct expr_affine expr_affine_scale(struct expr_affine a, double factor) {
    return rounded(
        (struct expr_affine){a.middle * factor, {a.slopes[0] * factor, a.slopes[1] * factor}, a.rest * fabs(factor)});
}

struct expr_affine expr_affine_multiply(struct expr_affine a, struct expr_affine b) {
    return rounded((struct expr_affine){
        a.middle * b.middle,
        {a.middle * b.slopes[0] + b.middle * a.slopes[0], a.middle * b.slopes[1] + b.middle * a.slopes[1]},
        fabs(a.middle) * b.rest + fabs(b.middle) * a.rest + spread_of(a) * spread_of(b)});
}

/* The square of the spread is not negative. */
static struct expr_affine square(struct expr_affine a) {
    double half = spread_of(a) * spread_of(a) / 2, twice = 2 * a.middle;
    return rounded((struct expr_affine){
        a.middle * a.middle + half, {twice * a.slopes[0], twice * a.slopes[1]}, fabs(twice) * a.rest + half});
}

struct affine_value {
    struct expr_interval bounds;
    struct expr_affine form; /* its rest is infinite: unknown */
};

static struct affine_value value_of(struct expr_interval bounds) {
    double half = (bounds.high - bounds.low) / 2;
    if (!isfinite(half))
        half = INFINITY;
    return (struct affine_value){bounds, {isfinite(half) ? bounds.low + half : 0, {0, 0}, half}};
}

static struct expr_interval ends_of(struct expr_affine a) {
    return (struct expr_interval){a.middle - spread_of(a), a.middle + spread_of(a), false};
}

static struct affine_value constant_of(enum expr_type type, union expr_value constant) {
    if (type == EXPR_TYPE_I)
        return value_of(expr_interval_of_integer(constant.i));
    return value_of(type == EXPR_TYPE_B ? expr_interval_of_truth(constant.i) : expr_interval_of_float(constant.f));
}

/* The form of the result; its rest is not finite where the operation is not one of those that have one. */
static struct expr_affine form_of(const struct expr_instruction *in, struct expr_affine a, struct expr_affine b) {
    if (in->operation == EXPR_NEGATE)
        return expr_affine_scale(a, -1);
    if (in->operation == EXPR_ADD)
        return expr_affine_add(a, b);
    if (in->operation == EXPR_SUBTRACT)
        return expr_affine_add(a, expr_affine_scale(b, -1));
    if (in->operation == EXPR_MULTIPLY)
        return in->a == in->b ? square(a) : expr_affine_multiply(a, b);
    return (struct expr_affine){.rest = INFINITY};
}

static struct affine_value apply(const struct expr_instruction *in, const struct affine_value operands[3]) {
    struct affine_value out = value_of(expr_interval_apply((enum expr_operation)in->operation, operands[0].bounds,
                                                           operands[1].bounds, operands[2].bounds));
    if (in->operation == EXPR_COPY)
        return operands[0];
    struct expr_affine form = form_of(in, operands[0].form, operands[1].form);
    if (!isfinite(form.middle + spread_of(form)))
        return out;
    struct expr_interval ends = ends_of(form);
    out.form = form;
    out.bounds.low = math_max(out.bounds.low, ends.low);
    out.bounds.high = math_min(out.bounds.high, ends.high);
    return out;
}

size_t expr_affine_size(const struct expr_program *program) {
    return ((size_t)program->constant_count + program->row_count) * sizeof(struct affine_value);
}

void expr_evaluate_affine(const struct expr_program *program, const struct expr_affine inputs[EXPR_INPUT_COUNT],
                          struct expr_interval outputs[EXPR_OUTPUTS], void *rows) {
    if (program->loop_count > 0) {
        struct expr_interval ends[EXPR_INPUT_COUNT];
        for (int i = 0; i < EXPR_INPUT_COUNT; i++)
            ends[i] = ends_of(inputs[i]);
        expr_evaluate_interval(program, ends, outputs, NULL, rows);
        return;
    }
    struct affine_value *values = rows;
    for (int i = 0; i < program->input_count; i++) {
        struct expr_affine form = inputs[program->inputs[i].input];
        values[program->inputs[i].value] = (struct affine_value){ends_of(form), form};
    }
    for (const struct expr_instruction *in = program->code, *end = in + program->count; in < end; in++) {
        const enum expr_operation operation = (enum expr_operation)in->operation;
        const uint16_t from[3] = {in->a, in->b, in->c};
        struct affine_value operands[3] = {0};
        for (int k = 0; k < expr_operand_count(operation); k++)
            operands[k] = from[k] < program->constant_count
                              ? constant_of(expr_operand_type(operation, k), program->constants[from[k]])
                              : values[from[k]];
        values[in->out] = apply(in, operands);
    }
    for (int i = 0; i < program->output_count; i++)
        outputs[i] = program->outputs[i] < program->constant_count
                         ? expr_interval_of_float(program->constants[program->outputs[i]].f)
                         : values[program->outputs[i]].bounds;
}
