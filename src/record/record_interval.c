/* Decisions by bounds: a condition that holds for all points of a path, or for none, makes no branch. Nodes are bounded
 * by interval arithmetic (expr/expr_interval.h) from inputs of any finite size. Each decision of the path narrows the
 * bounds of the two sides of its comparison. So `if r < 1 ... elseif r < 2` makes no path without points. The bounds
 * depend only on the decisions of the path, so every call on that path computes the same bounds. */
#include "record/record_interval_internal.h"

#include "base/mem.h"
#include "expr/expr_interval.h"

#include <float.h>
#include <math.h>

/* The limit of nodes that are visited for the bounds of one condition; deeper nodes are treated as unknown. */
enum { MAX_VISITS = 200 };

/* Of nodes: bounds on one path of one recording. */
struct path_bounds {
    struct expr_interval bounds;
    uint32_t serial, path; /* serials begin with 1 */
};

void record_interval_end(struct recorder *recorder) {
    mem_free(recorder->narrowed);
    recorder->narrowed = NULL;
}

static uint32_t record_path(const struct recorder *recorder) {
    return recorder->frames[recorder->level].path;
}

static struct expr_interval unknown(enum expr_type type) {
    switch (type) {
    case EXPR_TYPE_F:
        return (struct expr_interval){-(double)INFINITY, (double)INFINITY, true};
    case EXPR_TYPE_I:
        return (struct expr_interval){-0x1p63, 0x1p63, false};
    case EXPR_TYPE_B:
    case EXPR_TYPE_N:
        break;
    }
    return (struct expr_interval){0, 1, false};
}

/* Unit vectors may be a little too long. */
static struct expr_interval of_input(enum expr_input input) {
    bool is_unit = input >= EXPR_NORMAL_X && input <= EXPR_VIEW_Z;
    double size = is_unit ? 1.0001 : DBL_MAX;
    return (struct expr_interval){-size, size, false};
}

static struct expr_interval of_constant(const struct expr_node *node) {
    struct expr_interval any = unknown(node->type);
    double i = (double)node->constant.i;
    switch (node->type) {
    case EXPR_TYPE_F:
        return isnan(node->constant.f) ? any : (struct expr_interval){node->constant.f, node->constant.f, false};
    case EXPR_TYPE_I:
        return fabs(i) <= 0x1p53 ? (struct expr_interval){i, i, false} : any;
    case EXPR_TYPE_B:
        return (struct expr_interval){node->constant.i != 0, node->constant.i != 0, false};
    case EXPR_TYPE_N:
        break;
    }
    return any;
}

static struct expr_interval meet(struct expr_interval a, struct expr_interval b) {
    struct expr_interval out = {math_max(a.low, b.low), math_min(a.high, b.high), a.may_be_nan && b.may_be_nan};
    return out.low <= out.high ? out : a; /* empty intersection: no point takes this path */
}

/* What the decisions of the path leave of the bounds. */
static struct expr_interval within_path(const struct recorder *recorder, uint32_t node, struct expr_interval bounds) {
    if (!recorder->narrowed)
        return bounds;
    const struct path_bounds *narrowed = &recorder->narrowed[node];
    bool is_here = narrowed->path == record_path(recorder) && narrowed->serial == recorder->serial;
    return is_here ? meet(bounds, narrowed->bounds) : bounds;
}

/* visits: the remaining number; constants need none. A texel has an address among its operands, which is exact as a
 * constant. */
static struct expr_interval bounds_of(const struct recorder *recorder, uint32_t at, int *visits) {
    const struct expr_node *node = &recorder->graph.nodes[at];
    struct expr_interval operands[3] = {{0, 1, false}, {0, 1, false}, {0, 1, false}}, out;
    if (node->operation == EXPR_CONSTANT)
        return of_constant(node);
    if (--*visits < 0)
        return within_path(recorder, at, unknown(node->type));
    if (node->operation > EXPR_OPERATION_COUNT) {
        out = unknown(node->type);
    } else if (expr_is_symbol(node)) {
        bool is_step = expr_symbol_slot(node) == 0;
        out = is_step ? (struct expr_interval){1, RECORD_LOOP, false} : unknown(node->type);
    } else if (node->operation == EXPR_INPUT) {
        out = of_input((enum expr_input)node->operands[0]);
    } else {
        int count = expr_operand_count(node->operation);
        for (int k = 0; k < count; k++)
            operands[k] = bounds_of(recorder, node->operands[k], visits);
        bool is_unread = node->operation == EXPR_TEXEL && *visits < 0;
        out = is_unread ? unknown(node->type)
                        : expr_interval_apply(node->operation, operands[0], operands[1], operands[2]);
    }
    return within_path(recorder, at, out);
}

int record_interval_prove(const struct recorder *recorder, uint32_t condition) {
    int visits = MAX_VISITS;
    struct expr_interval truth = bounds_of(recorder, condition, &visits);
    return truth.low > 0 ? 1 : truth.high > 0 ? -1 : 0;
}

/* The next integer above or below a bound of integers that differ: bounds up to 2^53 are exact. */
static double beyond(double bound, double step) {
    return fabs(bound) < 0x1p53 ? bound + step : bound;
}

static void narrow(const struct recorder *recorder, uint32_t node, struct expr_interval bounds, struct narrowing *out) {
    if (recorder->graph.nodes[node].operation != EXPR_CONSTANT)
        *out = (struct narrowing){node, bounds};
}

/* The effect of a comparison of a with b. If it is false, b is less, or one of them is NaN. */
static void find_narrowings(const struct recorder *recorder, struct decision *decision) {
    const struct expr_node node = recorder->graph.nodes[decision->condition];
    bool answer = decision->answer;
    bool is_order = node.operation == EXPR_LESS || node.operation == EXPR_LESS_EQUAL ||
                    node.operation == EXPR_INTEGER_LESS || node.operation == EXPR_INTEGER_LESS_EQUAL;
    bool is_equal = answer && (node.operation == EXPR_EQUAL || node.operation == EXPR_INTEGER_EQUAL);
    if (!is_order && !is_equal)
        return;
    int visits_a = MAX_VISITS, visits_b = MAX_VISITS;
    uint32_t less = node.operands[0], more = node.operands[1];
    struct expr_interval a = bounds_of(recorder, less, &visits_a), b = bounds_of(recorder, more, &visits_b);
    if (!answer && (a.may_be_nan || b.may_be_nan))
        return;
    if (!answer) {
        struct expr_interval swapped = a;
        a = b;
        b = swapped;
        less = node.operands[1];
        more = node.operands[0];
    }
    double step = answer ? node.operation == EXPR_INTEGER_LESS : node.operation == EXPR_INTEGER_LESS_EQUAL;
    const struct expr_interval below = {is_equal ? b.low : -(double)INFINITY, beyond(b.high, -step), false};
    const struct expr_interval above = {beyond(a.low, step), is_equal ? a.high : (double)INFINITY, false};
    narrow(recorder, less, meet(a, below), &decision->narrowings[0]);
    narrow(recorder, more, meet(b, above), &decision->narrowings[1]);
}

bool record_interval_narrow(struct recorder *recorder, struct decision *decision) {
    if (!recorder->narrowed)
        recorder->narrowed = mem_alloc_zero(EXPR_NODES, sizeof *recorder->narrowed);
    if (!recorder->narrowed)
        return false;
    if (!decision->is_narrowed) {
        decision->narrowings[0].node = decision->narrowings[1].node = EXPR_NONE;
        find_narrowings(recorder, decision);
        decision->is_narrowed = true;
    }
    for (int k = 0; k < 2; k++) {
        const struct narrowing *narrowing = &decision->narrowings[k];
        if (narrowing->node != EXPR_NONE)
            recorder->narrowed[narrowing->node] =
                (struct path_bounds){narrowing->bounds, recorder->serial, record_path(recorder)};
    }
    return true;
}
