/* Bounds, derivatives and shortened programs of expressions, against values at points. */
#include "base/isa.h"
#include "base/mem.h"
#include "base/random.h"
#include "expr/expr_derivative.h"
#include "expr/expr_shorten.h"
#include "math/exact.h"
#include "tests/harness.h"
#include "tests/unit/picture_function.h"

#include <string.h>

static double uniform(uint64_t key, double low, double high) {
    double x = low + (high - low) * random_unit(random_mix(key));
    return x < low ? low : x > high ? high : x;
}

/* --- operations --- */

/* A number of any size, special ones among them. */
static double random_number(uint64_t key) {
    static const double special[] = {0.0,    -0.0,      1.0,    -1.0,   0.5,     -0.5,     2.0,
                                     -3.0,   PI,        PI / 2, 0x1p53, 1e300,   INFINITY, -INFINITY,
                                     1e-310, 0x1p-1074, 256.0,  0x1p63, -0x1p63, 10.0};
    uint64_t bits = random_mix(key);
    if (bits % 4 == 0)
        return special[(bits >> 8) % (sizeof special / sizeof special[0])];
    if (bits % 4 == 1) {
        double x = from_bits(random_mix(bits));
        return isnan(x) ? 0 : x;
    }
    return (random_unit(random_mix(bits)) - 0.5) * (bits % 4 == 2 ? 4 : 400);
}

/* A box and a value in it, at its ends now and then. */
static void random_operand(enum expr_type type, uint64_t key, struct expr_interval *box, union expr_value *value) {
    uint64_t bits = random_combine(key, 99);
    double a = random_number(random_combine(key, 1)), b = random_number(random_combine(key, 2));
    if (bits % 4 > 1)
        b = a + (bits % 4 == 2 ? 1e-3 : 0.4) * random_unit(bits);
    if (bits % 16 == 15)
        b = a;
    *box = (struct expr_interval){a < b ? a : b, a < b ? b : a, false};
    if (type == EXPR_TYPE_F) {
        unsigned end = (unsigned)(bits >> 8) % 8;
        value->f = end == 0 ? box->low : end == 1 ? box->high : uniform(bits, box->low, box->high);
        if (isnan(value->f)) /* between infinities */
            value->f = box->low;
        if (bits >> 40 & 1 && value->f == 0)
            value->f = -value->f;
        if ((bits >> 16) % 16 == 0) {
            box->may_be_nan = true;
            value->f = (bits >> 20) % 2 ? (double)NAN : value->f;
        }
        return;
    }
    if (type == EXPR_TYPE_I) {
        double low = fmin(fmax(box->low, -0x1p62), 0x1p62), high = fmin(fmax(box->high, -0x1p62), 0x1p62);
        *box = (struct expr_interval){floor(low), ceil(high), false};
        value->i = (int64_t)fmin(fmax(rint(uniform(bits, box->low, box->high)), box->low), box->high);
        return;
    }
    value->i = bits & 1 ? -1 : 0;
    *box = (struct expr_interval){bits & 1 && !(bits & 2), bits & 1 || bits & 2, false};
}

static bool is_within(enum expr_type type, union expr_value value, struct expr_interval bounds) {
    if (type == EXPR_TYPE_F)
        return isnan(value.f) ? bounds.may_be_nan : bounds.low <= value.f && value.f <= bounds.high;
    double x = type == EXPR_TYPE_I ? (double)value.i : value.i != 0;
    return bounds.low <= x && x <= bounds.high;
}

static void check_containment(uint32_t count) {
    for (int o = EXPR_INPUT + 1; o < EXPR_OPERATION_COUNT; o++) {
        enum expr_operation operation = (enum expr_operation)o;
        uint32_t failures = 0;
        for (uint64_t i = 0; i < count && failures < 3; i++) {
            struct expr_interval boxes[3] = {{0, 1, false}, {0, 1, false}, {0, 1, false}};
            union expr_value values[3] = {{.i = 0}, {.i = 0}, {.i = 0}};
            for (int k = 0; k < expr_operand_count(operation); k++)
                random_operand(expr_operand_type(operation, k), random_combine((uint64_t)o * 3 + (uint64_t)k, i),
                               &boxes[k], &values[k]);
            if (operation == EXPR_TEXEL) {
                values[2].i = test_picture_operand((int)i % 4);
                boxes[2] = (struct expr_interval){(double)values[2].i, (double)values[2].i, false};
            }
            struct expr_interval bounds = expr_interval_apply(operation, boxes[0], boxes[1], boxes[2]);
            union expr_value result = expr_apply(operation, values[0], values[1], values[2]);
            if (bounds.low <= bounds.high && is_within(expr_result_type(operation), result, bounds))
                continue;
            failures++;
            test_fail(__FILE__, __LINE__, "%s(%a, %a, %a) = %a, not in %a..%a; of %a..%a, %a..%a, %a..%a",
                      expr_operation_name(operation), values[0].f, values[1].f, values[2].f, result.f, bounds.low,
                      bounds.high, boxes[0].low, boxes[0].high, boxes[1].low, boxes[1].high, boxes[2].low,
                      boxes[2].high);
        }
    }
}

TEST(bounds_of_every_operation_contain_its_values) {
    check_containment(40000);
}

TEST_LONG(bounds_of_every_operation_contain_ten_million_values) {
    check_containment(10000000);
}

TEST(bounds_of_smooth_operations_are_not_much_wider_than_the_values) {
    static const enum expr_operation operations[] = {EXPR_SIN, EXPR_EXP,  EXPR_TANH,   EXPR_NOISE,
                                                     EXPR_ABS, EXPR_SQRT, EXPR_MODULO, EXPR_CELL_NEAREST};
    for (size_t o = 0; o < sizeof operations / sizeof operations[0]; o++) {
        struct expr_interval x = {2.3, 2.3 + 1e-4, false}, y = {3, 3, false}, z = {0.25, 0.25, false};
        struct expr_interval bounds = expr_interval_apply(operations[o], x, y, z);
        double width = bounds.high - bounds.low;
        CHECK(width < 1.2e-3 && !bounds.may_be_nan); /* e^2.3 is below 10 */
    }
    struct expr_interval wide = {-3, 100, false};
    struct expr_interval sine = expr_interval_apply(EXPR_SIN, wide, wide, wide);
    CHECK(sine.low == -1 && sine.high == 1);
}

/* --- programs --- */

struct random_program {
    struct expr_graph graph;
    struct arena arena;
    struct expr_program program;
};

/* Of numbers between about -10 and 10: sums, products, waves, noise, and choices. `jumps`: with floor and selections.
 */
static void random_program_init(struct random_program *p, uint64_t seed, int operations, bool jumps) {
    static const enum expr_operation smooth[] = {EXPR_ADD,  EXPR_SUBTRACT, EXPR_MULTIPLY, EXPR_SIN,  EXPR_COS,
                                                 EXPR_TANH, EXPR_MIN,      EXPR_MAX,      EXPR_ABS,  EXPR_NOISE,
                                                 EXPR_ADD,  EXPR_MIN,      EXPR_MAX,      EXPR_ATAN, EXPR_NEGATE};
    static const enum expr_operation jumping[] = {EXPR_FLOOR, EXPR_SELECT, EXPR_SELECT, EXPR_MODULO,
                                                  EXPR_SQRT,  EXPR_LOG,    EXPR_DIVIDE, EXPR_CELL_ID,
                                                  EXPR_EXP,   EXPR_CEIL,   EXPR_TEXEL};
    struct error error = {0};
    uint32_t values[64], count = 0;
    *p = (struct random_program){.graph = {.count = 0}};
    for (int k = 0; k < 3; k++)
        values[count++] = expr_input(&p->graph, (enum expr_input)(EXPR_POINT_X + k));
    values[count++] = expr_float(&p->graph, 0.5);
    values[count++] = expr_float(&p->graph, -1.25);
    for (int i = 0; i < operations; i++) {
        uint64_t bits = random_combine(seed, (uint64_t)i);
        bool is_jump = jumps && bits % 4 == 0;
        enum expr_operation operation = is_jump ? jumping[(bits >> 8) % (sizeof jumping / sizeof jumping[0])]
                                                : smooth[(bits >> 8) % (sizeof smooth / sizeof smooth[0])];
        uint32_t operands[3] = {values[(bits >> 16) % count], values[(bits >> 24) % count],
                                values[(bits >> 32) % count]};
        if (operation == EXPR_SELECT)
            operands[0] = expr_operation(&p->graph, bits & 1 << 5 ? EXPR_LESS : EXPR_LESS_EQUAL,
                                         values[(bits >> 40) % count], values[(bits >> 48) % count], EXPR_NONE);
        if (operation == EXPR_TEXEL)
            operands[2] = expr_integer(&p->graph, test_picture_operand((int)(bits >> 56) % 4));
        uint32_t value = expr_operation(&p->graph, operation, operands[0], operands[1], operands[2]);
        if (operation == EXPR_MULTIPLY || operation == EXPR_EXP)
            value = expr_operation(&p->graph, EXPR_TANH, value, EXPR_NONE, EXPR_NONE);
        values[count < 64 ? count++ : 5 + (bits >> 3) % 59] = value;
    }
    const uint32_t outputs[2] = {values[count - 1], values[count - 2]};
    CHECK(expr_compile(&p->graph, outputs, 2, &p->arena, &p->program, &error));
}

static void random_program_destroy(struct random_program *p) {
    arena_destroy(&p->arena);
    expr_graph_destroy(&p->graph);
}

static void random_box(uint64_t key, struct expr_interval box[EXPR_INPUT_COUNT]) {
    for (int k = 0; k < EXPR_INPUT_COUNT; k++) {
        double middle = uniform(random_combine(key, 2 * (uint64_t)k), -3, 3);
        double radius = pow(10, uniform(random_combine(key, 2 * (uint64_t)k + 1), -4, 0));
        box[k] = (struct expr_interval){middle - radius, middle + radius, false};
    }
}

static void point_in(const struct expr_interval box[EXPR_INPUT_COUNT], uint64_t key, double out[EXPR_INPUT_COUNT]) {
    for (int k = 0; k < EXPR_INPUT_COUNT; k++)
        out[k] = uniform(random_combine(key, (uint64_t)k), box[k].low, box[k].high);
}

static bool same(double a, double b) {
    return to_bits(a) == to_bits(b) || (isnan(a) && isnan(b));
}

/* For expr_evaluate_interval of any program. */
static _Alignas(64) struct expr_interval single_rows[EXPR_VALUES];

/* Of one program and box: bounds, choices, the shortened program. */
static void check_box(const struct expr_program *program, uint64_t key, int points, size_t *before, size_t *after) {
    struct expr_interval box[EXPR_INPUT_COUNT], bounds[EXPR_OUTPUTS], again[EXPR_OUTPUTS];
    struct expr_choice *choices = mem_alloc_zero(program->count + 1, sizeof *choices);
    struct expr_instruction code[512];
    struct expr_stack stack = {code, 512};
    struct expr_program shorter, folded;
    void *scratch = mem_alloc_aligned(64, expr_shorten_size(program));
    random_box(key, box);
    expr_evaluate_interval(program, box, bounds, choices, single_rows);
    CHECK(expr_shorten(program, choices, 0, &stack, scratch, &shorter));
    CHECK(shorter.count <= program->count && shorter.register_count <= program->register_count);
    CHECK(expr_fold(&shorter, &stack, scratch, &folded));
    CHECK(folded.count <= shorter.count && folded.register_count <= shorter.register_count);
    expr_evaluate_interval(&shorter, box, again, NULL, single_rows);
    *before += program->count;
    *after += shorter.count;
    for (int i = 0; i < points; i++) {
        double in[EXPR_INPUT_COUNT], whole[EXPR_OUTPUTS], part[EXPR_OUTPUTS], rest[EXPR_OUTPUTS];
        point_in(box, random_combine(key, 1000 + (uint64_t)i), in);
        expr_evaluate(program, in, whole);
        expr_evaluate(&shorter, in, part);
        expr_evaluate(&folded, in, rest);
        for (int k = 0; k < program->output_count; k++) {
            if (!same(whole[k], part[k]) || !same(whole[k], rest[k]))
                test_fail(__FILE__, __LINE__, "shortened: %a, folded: %a, not %a", part[k], rest[k], whole[k]);
            for (int n = 0; n < 2; n++)
                if (!is_within(EXPR_TYPE_F, (union expr_value){.f = whole[k]}, n ? again[k] : bounds[k]))
                    test_fail(__FILE__, __LINE__, "%a is not in %a..%a", whole[k], bounds[k].low, bounds[k].high);
        }
    }
    mem_free(scratch);
    mem_free(choices);
}

static void check_programs(int programs) {
    size_t before = 0, after = 0;
    for (uint64_t i = 0; i < (uint64_t)programs; i++) {
        struct random_program p;
        random_program_init(&p, random_combine(11, i), 60, i % 2);
        for (uint64_t k = 0; k < 8; k++)
            check_box(&p.program, random_combine(i, k), 25, &before, &after);
        random_program_destroy(&p);
    }
    CHECK(after < before * 9 / 10); /* something is dropped */
}

TEST(shortened_programs_and_bounds_of_random_programs_hold_in_their_boxes) {
    check_programs(500);
}

TEST_LONG(shortened_programs_and_bounds_of_many_random_programs_hold_in_their_boxes) {
    check_programs(50000);
}

/* Of up to 64 boxes, in the instruction set that is selected. */
static void check_lanes(const struct expr_program *program, uint64_t key, uint32_t count, const char *name) {
    static struct expr_bounds bounds[EXPR_OUTPUTS];
    double ends[2][3][EXPR_BOXES];
    struct expr_boxes boxes = {.count = count};
    struct expr_interval all[EXPR_BOXES][EXPR_INPUT_COUNT], single[EXPR_OUTPUTS];
    struct expr_choice choices[256], of_one[256];
    void *rows = mem_alloc_aligned(64, expr_intervals_size(program));
    for (uint32_t i = 0; i < count; i++) {
        random_box(random_combine(key, i), all[i]);
        for (int k = 0; k < 3; k++) {
            if (i == 3)
                all[i][k].high = INFINITY;
            ends[0][k][i] = all[i][k].low;
            ends[1][k][i] = all[i][k].high;
        }
    }
    for (int k = 0; k < 3; k++) {
        boxes.low[k] = ends[0][k];
        boxes.high[k] = ends[1][k];
    }
    expr_evaluate_intervals(program, &boxes, bounds, choices, rows);
    for (uint32_t i = 0; i < count; i++) {
        expr_evaluate_interval(program, all[i], single, of_one, single_rows);
        for (int o = 0; o < program->output_count; o++)
            if (single[o].low != bounds[o].low[i] || single[o].high != bounds[o].high[i] ||
                single[o].may_be_nan != (bounds[o].may_be_nan >> i & 1))
                test_fail(__FILE__, __LINE__, "%s: %a..%a, not %a..%a", name, bounds[o].low[i], bounds[o].high[i],
                          single[o].low, single[o].high);
        for (uint32_t n = 0; n < program->count; n++)
            CHECK((choices[n].first >> i & 1) == (of_one[n].first & 1) &&
                  (choices[n].second >> i & 1) == (of_one[n].second & 1));
    }
    mem_free(rows);
}

TEST(bounds_of_many_boxes_are_those_of_each_box) {
    static const char *const sets[] = {"base", "avx2", "avx512"};
    for (uint64_t i = 0; i < 100; i++) {
        struct random_program p;
        random_program_init(&p, random_combine(41, i), 60, i % 2);
        CHECK(p.program.count < 256);
        for (size_t set = 0; set < sizeof sets / sizeof sets[0]; set++)
            if (cpu_select_isa(sets[set]))
                check_lanes(&p.program, i, i % 3 ? EXPR_BOXES : 1 + (uint32_t)(i % 63), sets[set]);
        random_program_destroy(&p);
    }
    CHECK(cpu_select_isa("auto"));
}

TEST(shortening_without_room_changes_nothing) {
    struct random_program p;
    struct expr_interval box[EXPR_INPUT_COUNT], bounds[EXPR_OUTPUTS];
    struct expr_choice choices[256];
    struct expr_instruction code[4];
    struct expr_stack stack = {code, 3};
    struct expr_program shorter = {.count = 77};
    random_program_init(&p, 5, 60, true);
    void *scratch = mem_alloc_aligned(64, expr_shorten_size(&p.program));
    random_box(1, box);
    CHECK(p.program.count < 256);
    expr_evaluate_interval(&p.program, box, bounds, choices, single_rows);
    CHECK(!expr_shorten(&p.program, choices, 0, &stack, scratch, &shorter));
    CHECK(stack.free == 3 && shorter.count == 77);
    mem_free(scratch);
    random_program_destroy(&p);
}

TEST(a_decided_min_of_a_large_program_leaves_one_of_its_sides) {
    struct expr_graph graph = {.count = 0};
    struct arena arena = {0};
    struct error error = {0};
    struct expr_program program, shorter, kept;
    uint32_t x = expr_input(&graph, EXPR_POINT_X), y = expr_input(&graph, EXPR_POINT_Y);
    uint32_t left = expr_operation(&graph, EXPR_ADD, expr_operation(&graph, EXPR_MULTIPLY, x, x, 0), y, 0);
    uint32_t right = expr_operation(&graph, EXPR_SIN, y, 0, 0);
    uint32_t low = expr_operation(&graph, EXPR_MIN, left, right, 0);
    CHECK(expr_compile(&graph, &low, 1, &arena, &program, &error));
    struct expr_interval box[EXPR_INPUT_COUNT] = {{2, 3, false}, {0, 1, false}}, out[EXPR_OUTPUTS];
    struct expr_choice choices[8];
    struct expr_instruction code[8];
    struct expr_stack stack = {code, 8};
    char rows[1024] __attribute__((aligned(64))), scratch[256] __attribute__((aligned(64)));
    expr_evaluate_interval(&program, box, out, choices, rows);
    CHECK(expr_shorten(&program, choices, 0, &stack, scratch, &shorter));
    CHECK_EQ_INT(shorter.count, 1);
    CHECK_EQ_INT(shorter.input_count, 1);
    CHECK_EQ_INT(shorter.register_count, 1);
    CHECK_EQ_INT(stack.free, 7);
    CHECK(expr_keep(&shorter, &arena, &kept));
    double in[EXPR_INPUT_COUNT] = {2.5, 0.25}, value[EXPR_OUTPUTS];
    expr_evaluate(&kept, in, value);
    CHECK(value[0] == el_sin(0.25));
    arena_destroy(&arena);
    expr_graph_destroy(&graph);
}

/* A ball around (centre, 0, 0). */
static uint32_t ball_node(struct expr_graph *graph, double centre) {
    uint32_t x = expr_operation(graph, EXPR_SUBTRACT, expr_input(graph, EXPR_POINT_X), expr_float(graph, centre), 0);
    uint32_t y = expr_input(graph, EXPR_POINT_Y);
    uint32_t square = expr_operation(graph, EXPR_ADD, expr_operation(graph, EXPR_MULTIPLY, x, x, 0),
                                     expr_operation(graph, EXPR_MULTIPLY, y, y, 0), 0);
    return expr_operation(graph, EXPR_SUBTRACT, expr_operation(graph, EXPR_SQRT, square, 0, 0), expr_float(graph, 1),
                          0);
}

/* min(a, b) - width / 4 * h * h with h = max(1 - |a - b| / width, 0), as sdf.smooth_union. */
static uint32_t smooth_min_node(struct expr_graph *graph, uint32_t a, uint32_t b, double width) {
    uint32_t apart = expr_operation(graph, EXPR_ABS, expr_operation(graph, EXPR_SUBTRACT, a, b, 0), 0, 0);
    uint32_t ratio = expr_operation(graph, EXPR_DIVIDE, apart, expr_float(graph, width), 0);
    uint32_t h = expr_operation(graph, EXPR_MAX, expr_operation(graph, EXPR_SUBTRACT, expr_float(graph, 1), ratio, 0),
                                expr_float(graph, 0), 0);
    uint32_t fillet = expr_operation(graph, EXPR_MULTIPLY,
                                     expr_operation(graph, EXPR_MULTIPLY, expr_float(graph, width / 4), h, 0), h, 0);
    return expr_operation(graph, EXPR_SUBTRACT, expr_operation(graph, EXPR_MIN, a, b, 0), fillet, 0);
}

TEST(a_smooth_union_of_twenty_parts_is_as_short_near_one_of_them_as_that_part_alone) {
    struct expr_graph graph = {.count = 0};
    struct arena arena = {0};
    struct error error = {0};
    struct expr_program single, all, shorter;
    uint32_t out = ball_node(&graph, 0);
    CHECK(expr_compile(&graph, &out, 1, &arena, &single, &error));
    for (int k = 1; k < 20; k++)
        out = smooth_min_node(&graph, out, ball_node(&graph, 10.0 * k), 0.25);
    CHECK(expr_compile(&graph, &out, 1, &arena, &all, &error));
    struct expr_interval box[EXPR_INPUT_COUNT] = {{-2, 2, false}, {-2, 2, false}}, bounds[EXPR_OUTPUTS];
    struct expr_choice choices[512];
    struct expr_instruction code[512];
    struct expr_stack stack = {code, 512};
    CHECK(all.count < 512);
    void *scratch = mem_alloc_aligned(64, expr_shorten_size(&all));
    expr_evaluate_interval(&all, box, bounds, choices, single_rows);
    CHECK(expr_shorten(&all, choices, 0, &stack, scratch, &shorter));
    CHECK(expr_fold(&shorter, &stack, scratch, &shorter));
    CHECK_EQ_INT(shorter.count, single.count);
    mem_free(scratch);
    arena_destroy(&arena);
    expr_graph_destroy(&graph);
}

/* --- derivatives --- */

/* The difference quotient with an estimate of its error; where this is large, or the quotients of both sides differ by
 * more than `bend`, the point is near an edge. */
static bool difference(const struct expr_program *program, const double at[EXPR_INPUT_COUNT], int input, int output,
                       double bend, double *quotient) {
    double values[4], steps[4] = {-1e-5, 1e-5, -2e-5, 2e-5}, in[EXPR_INPUT_COUNT], out[EXPR_OUTPUTS];
    for (int i = 0; i < 4; i++) {
        memcpy(in, at, sizeof in);
        in[input] += steps[i];
        expr_evaluate(program, in, out);
        values[i] = out[output];
    }
    double narrow = (values[1] - values[0]) / 2e-5, wide = (values[3] - values[2]) / 4e-5;
    double left = (values[0] - values[2]) / 1e-5, right = (values[3] - values[1]) / 1e-5;
    *quotient = narrow;
    if (fabs(at[input]) > 1e6 || fabs(values[0]) > 1e6) /* the steps or the differences are rounded */
        return false;
    if (!isfinite(at[0] + at[1] + at[2])) /* derivatives may be NaN */
        return false;
    return fabs(narrow - wide) < 1e-5 * (1 + fabs(narrow)) && fabs(left - right) < bend * (1 + fabs(narrow)) &&
           fabs(narrow) < 1e3;
}

static void check_gradient(const struct expr_program *program, const double in[EXPR_INPUT_COUNT], double bend,
                           uint32_t *compared, const char *name) {
    double values[EXPR_OUTPUTS], gradients[EXPR_OUTPUTS][EXPR_DIRECTIONS], wanted[EXPR_OUTPUTS];
    void *rows = mem_alloc_aligned(64, expr_gradient_size(program));
    expr_evaluate_gradient(program, in, expr_gradient_seeds, values, gradients, rows);
    expr_evaluate(program, in, wanted);
    for (int o = 0; o < program->output_count; o++) {
        CHECK(same(values[o], wanted[o]));
        for (int k = 0; k < 3; k++) {
            double quotient;
            if (!difference(program, in, EXPR_POINT_X + k, o, bend, &quotient))
                continue;
            ++*compared;
            if (!(fabs(gradients[o][k] - quotient) < 2e-4 * (1 + fabs(quotient))))
                test_fail(__FILE__, __LINE__, "%s: derivative %d is %g, the quotient %g, at %a %a %a", name, k,
                          gradients[o][k], quotient, in[0], in[1], in[2]);
        }
    }
    mem_free(rows);
}

static double uniform_operand(uint64_t key, enum expr_operation operation) {
    return uniform(key, operation == EXPR_POWER ? 0.1 : -3, 3);
}

/* Numbers of all sizes, and special ones. Of a divisor: those that do not make steps that are too short for a
 * difference. */
static double any_operand(uint64_t key, enum expr_operation operation, int k) {
    static const double special[] = {0,      -0.0,    1,     -1,     0.5,    -0.5, 2,        3,         PI,  PI / 2,
                                     1e-310, -1e-310, 1e308, -1e308, 0x1p53, 1e22, INFINITY, -INFINITY, NAN, -2};
    const double sign = key >> 60 & 1 ? -1 : 1;
    const bool is_divisor = k == 1 && (operation == EXPR_MODULO || operation == EXPR_REMAINDER ||
                                       operation == EXPR_FLOOR_DIVIDE || operation == EXPR_DIVIDE);
    double x = uniform(random_mix(key), -3, 3);
    if (key % 4 == 1)
        x = uniform(random_mix(key), -100, 100);
    if (key % 4 == 2)
        x = sign * pow(10, uniform(random_mix(key), -12, 4));
    if (key % 4 == 3)
        x = special[(key >> 8) % (sizeof special / sizeof special[0])];
    return is_divisor && fabs(x) < 0.05 ? 0.7 * sign : x;
}

static void check_derivatives(uint64_t count, bool are_any) {
    for (int o = EXPR_INPUT + 1; o < EXPR_OPERATION_COUNT; o++) {
        enum expr_operation operation = (enum expr_operation)o;
        struct random_program p = {.graph = {.count = 0}};
        struct error error = {0};
        uint32_t operands[3] = {EXPR_NONE, EXPR_NONE, EXPR_NONE}, compared = 0;
        bool is_float = expr_result_type(operation) == EXPR_TYPE_F && operation != EXPR_SELECT;
        for (int k = 0; k < expr_operand_count(operation); k++) {
            bool is_picture = operation == EXPR_TEXEL && k == 2;
            is_float = is_float && (is_picture || expr_operand_type(operation, k) == EXPR_TYPE_F);
            operands[k] =
                is_picture ? expr_integer(&p.graph, test_picture_operand(1)) : expr_input(&p.graph, (enum expr_input)k);
        }
        if (!is_float) {
            random_program_destroy(&p);
            continue;
        }
        uint32_t value = expr_operation(&p.graph, operation, operands[0], operands[1], operands[2]);
        CHECK(expr_compile(&p.graph, &value, 1, &p.arena, &p.program, &error));
        for (uint64_t i = 0; i < count; i++) {
            double in[EXPR_INPUT_COUNT] = {0};
            for (int k = 0; k < 3; k++) {
                const uint64_t key = random_combine(i, (uint64_t)k);
                in[k] = are_any ? any_operand(key, operation, k) : uniform_operand(key, operation);
            }
            check_gradient(&p.program, in, are_any ? 1e-4 : 1e-2, &compared, expr_operation_name(operation));
        }
        CHECK(compared > (are_any ? count / 5 : 4 * count / 15) || operation == EXPR_HASH);
        random_program_destroy(&p);
    }
}

TEST(derivatives_of_every_operation_equal_differences) {
    check_derivatives(300, false);
    check_derivatives(300, true);
}

TEST_LONG(derivatives_of_every_operation_equal_differences_at_a_million_points) {
    check_derivatives(1000000, true);
}

TEST(derivatives_of_random_programs_equal_differences) {
    uint32_t compared = 0;
    for (uint64_t i = 0; i < 300; i++) {
        struct random_program p;
        random_program_init(&p, random_combine(21, i), 25, i % 2);
        for (uint64_t k = 0; k < 20; k++) {
            double in[EXPR_INPUT_COUNT] = {0};
            for (uint64_t j = 0; j < 3; j++)
                in[j] = uniform(random_combine(random_combine(i, k), j), -3, 3);
            check_gradient(&p.program, in, 1e-2, &compared, "program");
        }
        random_program_destroy(&p);
    }
    CHECK(compared > 10000);
}

static void check_slopes(const struct expr_program *program, uint64_t key, uint32_t *finite) {
    struct expr_interval box[EXPR_INPUT_COUNT], plain[EXPR_OUTPUTS];
    struct expr_range ranges[EXPR_OUTPUTS];
    void *rows = mem_alloc_aligned(64, expr_slopes_size(program));
    random_box(key, box);
    static const struct expr_directions directions = {2, {{0.3, 1}, {-0.8, 0}, {0.5, 0}}};
    expr_evaluate_slopes(program, box, &directions, ranges, NULL, rows);
    expr_evaluate_interval(program, box, plain, NULL, rows);
    for (int o = 0; o < program->output_count; o++) {
        CHECK(plain[o].low == ranges[o].value.low && plain[o].high == ranges[o].value.high);
        for (int d = 0; d < 2; d++)
            *finite += isfinite(ranges[o].slopes[d].low) && isfinite(ranges[o].slopes[d].high);
    }
    for (uint64_t i = 0; i < 40; i++) {
        double a[EXPR_INPUT_COUNT], b[EXPR_INPUT_COUNT], at_a[EXPR_OUTPUTS], at_b[EXPR_OUTPUTS];
        int d = (int)(i & 1);
        point_in(box, random_combine(key, i), a);
        double t = uniform(random_combine(key, 500 + i), 0, 1) * (i % 3 ? 1 : 1e-3);
        bool is_inside = true;
        memcpy(b, a, sizeof b);
        for (int k = 0; k < 3; k++) {
            b[k] += t * directions.seeds[k][d];
            is_inside = is_inside && b[k] >= box[k].low && b[k] <= box[k].high;
        }
        if (!is_inside)
            continue;
        expr_evaluate(program, a, at_a);
        expr_evaluate(program, b, at_b);
        for (int o = 0; o < program->output_count; o++) {
            double change = at_b[o] - at_a[o], error = 1e-11 * (1 + fabs(at_a[o]) + fabs(at_b[o]));
            if (ranges[o].is_nan && !(isnan(at_a[o]) && isnan(at_b[o])))
                test_fail(__FILE__, __LINE__, "%a and %a, not NaN everywhere", at_a[o], at_b[o]);
            if (!isnan(change) &&
                !(change >= ranges[o].slopes[d].low * t - error && change <= ranges[o].slopes[d].high * t + error))
                test_fail(__FILE__, __LINE__, "%a changes by %a over %a, not by %a..%a", at_a[o], change, t,
                          ranges[o].slopes[d].low, ranges[o].slopes[d].high);
        }
    }
    mem_free(rows);
}

static bool is_near(double a, double b) {
    return a == b || fabs(a - b) <= 1e-9 * (1 + fabs(a) + fabs(b));
}

/* Slabs of the box as lanes against each of them alone. */
static void check_slope_lanes(const struct expr_program *program, uint64_t key) {
    static const struct expr_directions directions = {3, {{0.3, 1, 0}, {-0.8, 0, 0}, {0.5, 0, 1}}};
    struct expr_interval box[EXPR_INPUT_COUNT];
    struct expr_lane_inputs inputs = {.are_cases = false};
    struct expr_lane_range lanes[EXPR_OUTPUTS];
    struct expr_choice *of_lanes = mem_alloc_zero(program->count + 1, sizeof *of_lanes);
    struct expr_choice *of_one = mem_alloc_zero(program->count + 1, sizeof *of_one);
    void *rows = mem_alloc_aligned(64, expr_lanes_size(program) + expr_slopes_size(program));
    random_box(key, box);
    for (int i = 0; i < EXPR_LANES; i++)
        for (int k = 0; k < EXPR_INPUT_COUNT; k++) {
            double width = k == EXPR_POINT_X ? (box[k].high - box[k].low) / EXPR_LANES : box[k].high - box[k].low;
            inputs.low[k][i] = box[k].low + (k == EXPR_POINT_X ? i * width : 0);
            inputs.high[k][i] = inputs.low[k][i] + width;
        }
    expr_evaluate_slopes_lanes(program, &inputs, &directions, lanes, of_lanes, rows);
    for (int i = 0; i < EXPR_LANES; i++) {
        struct expr_range one[EXPR_OUTPUTS];
        for (int k = 0; k < EXPR_INPUT_COUNT; k++)
            box[k] = (struct expr_interval){inputs.low[k][i], inputs.high[k][i], false};
        expr_evaluate_slopes(program, box, &directions, one, of_one, rows);
        for (int o = 0; o < program->output_count; o++) {
            bool same = is_near(lanes[o].low[i], one[o].value.low) && is_near(lanes[o].high[i], one[o].value.high) &&
                        (lanes[o].may_be_nan >> i & 1) == one[o].value.may_be_nan &&
                        (lanes[o].is_nan >> i & 1) == one[o].is_nan;
            for (int k = 0; k < 3; k++) { /* of quotients they are closer */
                double low = lanes[o].slopes[k].low[i], high = lanes[o].slopes[k].high[i];
                same = same && (low > one[o].slopes[k].low || is_near(low, one[o].slopes[k].low)) &&
                       (high < one[o].slopes[k].high || is_near(high, one[o].slopes[k].high));
            }
            if (!same)
                test_fail(__FILE__, __LINE__, "%a..%a, slope %a..%a in lane %d, alone %a..%a, slope %a..%a",
                          lanes[o].low[i], lanes[o].high[i], lanes[o].slopes[0].low[i], lanes[o].slopes[0].high[i], i,
                          one[o].value.low, one[o].value.high, one[o].slopes[0].low, one[o].slopes[0].high);
        }
        double a[EXPR_INPUT_COUNT], b[EXPR_INPUT_COUNT], at_a[EXPR_OUTPUTS], at_b[EXPR_OUTPUTS];
        point_in(box, random_combine(key, (uint64_t)i), a);
        memcpy(b, a, sizeof b);
        b[EXPR_POINT_X] = uniform(random_combine(key, 50 + (uint64_t)i), box[0].low, box[0].high);
        expr_evaluate(program, a, at_a);
        expr_evaluate(program, b, at_b);
        for (int o = 0; o < program->output_count; o++) {
            double moved = b[0] - a[0], change = (at_b[o] - at_a[o]) / moved;
            double error = 1e-11 * (1 + fabs(at_a[o]) + fabs(at_b[o])) / fabs(moved);
            if (isfinite(change) &&
                !(change >= lanes[o].slopes[1].low[i] - error && change <= lanes[o].slopes[1].high[i] + error))
                test_fail(__FILE__, __LINE__, "a slope of %a, not of %a..%a", change, lanes[o].slopes[1].low[i],
                          lanes[o].slopes[1].high[i]);
        }
        for (uint32_t n = 0; n < program->count; n++)
            CHECK((of_lanes[n].first >> i & 1) == of_one[n].first && (of_lanes[n].second >> i & 1) == of_one[n].second);
    }
    mem_free(of_lanes);
    mem_free(of_one);
    mem_free(rows);
}

TEST(slopes_of_eight_boxes_are_those_of_each_box) {
    static const char *const sets[] = {"base", "avx2", "avx512"};
    for (uint64_t i = 0; i < 300; i++) {
        struct random_program p;
        random_program_init(&p, random_combine(37, i), 5 + (int)(i % 30), i % 2);
        for (uint64_t k = 0; k < 6; k++) {
            if (cpu_select_isa(sets[k % 3]))
                check_slope_lanes(&p.program, random_combine(i, k));
        }
        random_program_destroy(&p);
    }
    CHECK(cpu_select_isa("auto"));
}

/* Every point of a box is in one of its cases. */
TEST(cases_of_a_box_contain_the_values_of_its_points) {
    static const struct expr_directions directions = {1, {{1}, {1}, {1}}};
    uint64_t narrowed = 0;
    for (uint64_t i = 0; i < 2000; i++) {
        struct random_program p;
        random_program_init(&p, random_combine(41, i), 5 + (int)(i % 12), true);
        void *rows = mem_alloc_aligned(64, expr_lanes_size(&p.program));
        struct expr_interval box[EXPR_INPUT_COUNT], plain[EXPR_OUTPUTS];
        struct expr_lane_inputs inputs = {.are_cases = true};
        struct expr_lane_range lanes[EXPR_OUTPUTS];
        random_box(random_combine(i, 1), box);
        for (int k = 0; k < EXPR_INPUT_COUNT; k++)
            for (int n = 0; n < EXPR_LANES; n++) {
                inputs.low[k][n] = box[k].low;
                inputs.high[k][n] = box[k].high;
            }
        expr_evaluate_slopes_lanes(&p.program, &inputs, &directions, lanes, NULL, rows);
        expr_evaluate_interval(&p.program, box, plain, NULL, rows);
        for (int o = 0; o < p.program.output_count; o++)
            for (int n = 0; n < EXPR_LANES; n++)
                narrowed += lanes[o].high[n] - lanes[o].low[n] < 0.9 * (plain[o].high - plain[o].low);
        for (uint64_t n = 0; n < 50; n++) {
            double at[EXPR_INPUT_COUNT], values[EXPR_OUTPUTS];
            point_in(box, random_combine(i, n), at);
            expr_evaluate(&p.program, at, values);
            for (int o = 0; o < p.program.output_count; o++) {
                bool found = false;
                for (int k = 0; k < EXPR_LANES; k++)
                    found = found || (values[o] >= lanes[o].low[k] && values[o] <= lanes[o].high[k]) ||
                            (values[o] != values[o] && lanes[o].may_be_nan >> k & 1);
                if (!found)
                    test_fail(__FILE__, __LINE__, "%a is in no case of program %d", values[o], (int)i);
            }
        }
        mem_free(rows);
        random_program_destroy(&p);
    }
    CHECK(narrowed > 500);
}

TEST(slopes_of_random_programs_contain_difference_quotients) {
    uint32_t finite = 0;
    for (uint64_t i = 0; i < 400; i++) {
        struct random_program p;
        random_program_init(&p, random_combine(31, i), 8 + (int)(i % 20), i % 2);
        for (uint64_t k = 0; k < 8; k++)
            check_slopes(&p.program, random_combine(i, k), &finite);
        random_program_destroy(&p);
    }
    CHECK(finite > 4000); /* of 12800 */
}

TEST(noise_and_its_derivatives_are_within_their_bounds) {
    double largest = 0, steepest = 0;
    for (uint64_t i = 0; i < 200000; i++) {
        double p[3], gradient[3], moved[3];
        for (uint64_t k = 0; k < 3; k++)
            p[k] = uniform(random_combine(i, k), -40, 40);
        largest = fmax(largest, fabs(noise_perlin(p[0], p[1], p[2], 0)));
        noise_perlin_gradient(p[0], p[1], p[2], gradient);
        for (int k = 0; k < 3; k++)
            steepest = fmax(steepest, fabs(gradient[k]));
        CHECK(noise_perlin_with_gradient(p[0], p[1], p[2], moved) == noise_perlin(p[0], p[1], p[2], 0));
        for (int k = 0; k < 3; k++)
            CHECK_NEAR(moved[k], gradient[k], 1e-13);
        noise_perlin_gradient(p[0] + 1e-4, p[1], p[2], moved);
        CHECK(fabs(moved[0] - gradient[0]) <= NOISE_SECOND_MAX * 1.0001e-4);
        CHECK(fabs(moved[1] - gradient[1]) <= NOISE_MIXED_MAX * 1.0001e-4);
    }
    CHECK(largest > 0.8 && largest <= NOISE_MAX);
    CHECK(steepest > 2 && steepest <= NOISE_FIRST_MAX);
}
