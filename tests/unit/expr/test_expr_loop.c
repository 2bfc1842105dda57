/* Loops of programs beside the same steps one by one: random bodies of floats, integers and selections, with loops in
 * them. The steps one by one are operations of the graph, which the other tests compare with Lua. */
#include "base/isa.h"
#include "base/mem.h"
#include "base/random.h"
#include "expr/expr_derivative.h"
#include "expr/expr_shorten.h"
#include "math/exact.h"
#include "tests/harness.h"

#include <math.h>
#include <string.h>

enum { STATES = 3, POOL = 16 };

/* Two floats and an integer. */
static const enum expr_type state_types[STATES] = {EXPR_TYPE_F, EXPR_TYPE_F, EXPR_TYPE_I};

struct maker {
    struct expr_graph graph;
    bool unrolls;
};

static uint32_t apply(struct maker *m, enum expr_operation operation, uint32_t a, uint32_t b, uint32_t c) {
    return expr_operation(&m->graph, operation, a, b, c);
}

static void make_loop(struct maker *m, uint64_t seed, uint32_t depth, uint32_t last, const uint32_t initial[STATES],
                      uint32_t out[STATES]);

/* A step. The values stay within about -10 and 10. */
static void make_body(struct maker *m, uint64_t seed, uint32_t depth, uint32_t step, const uint32_t in[STATES],
                      uint32_t out[STATES]) {
    static const enum expr_operation operations[] = {EXPR_ADD,  EXPR_MULTIPLY, EXPR_SIN,   EXPR_COS,    EXPR_MIN,
                                                     EXPR_TANH, EXPR_SUBTRACT, EXPR_FLOOR, EXPR_SELECT, EXPR_MAX,
                                                     EXPR_ABS,  EXPR_NOISE,    EXPR_TANH,  EXPR_SELECT, EXPR_ADD};
    uint32_t pool[POOL] = {in[0], in[1], apply(m, EXPR_TO_FLOAT, step, 0, 0), expr_float(&m->graph, 0.7)}, count = 4;
    uint32_t whole = in[2], condition = apply(m, EXPR_LESS, in[1], expr_input(&m->graph, EXPR_POINT_Y), 0);
    for (int k = 0; k < 3; k++)
        pool[count++] = expr_input(&m->graph, (enum expr_input)(EXPR_POINT_X + k));
    if (depth < EXPR_DEPTH && seed % 3 == 0) {
        const uint32_t initial[STATES] = {pool[2], pool[seed / 7 % count], seed % 2 ? step : in[2]};
        uint32_t final[STATES];
        make_loop(m, random_mix(seed), depth + 1, 1 + (uint32_t)(seed / 11 % 4), initial, final);
        pool[count++] = apply(m, EXPR_TANH, final[1], 0, 0);
        whole = final[2];
    }
    while (count < POOL) {
        uint64_t bits = random_combine(seed, count);
        enum expr_operation operation = operations[bits % (sizeof operations / sizeof operations[0])];
        uint32_t a = pool[(bits >> 8) % count], b = pool[(bits >> 16) % count], c = pool[(bits >> 24) % count];
        if (bits >> 40 & 1)
            condition = apply(m, EXPR_LESS, a, c, 0);
        if (operation == EXPR_MULTIPLY)
            a = apply(m, EXPR_SIN, a, 0, 0);
        pool[count++] = apply(m, operation, operation == EXPR_SELECT ? condition : a, b, c);
    }
    uint32_t first = apply(m, EXPR_ADD, apply(m, EXPR_SIN, pool[POOL - 1], 0, 0), expr_float(&m->graph, 0.8), 0);
    uint32_t one = expr_float(&m->graph, 1), ended = expr_float(&m->graph, -0.0);
    out[0] = seed % 4 == 0 ? apply(m, EXPR_SELECT, condition, one, ended) : first;
    out[1] = seed % 5 == 0 ? in[0] : apply(m, EXPR_TANH, pool[POOL - 2], 0, 0);
    out[2] = apply(m, seed % 2 ? EXPR_INTEGER_ADD : EXPR_INTEGER_MULTIPLY, whole,
                   apply(m, EXPR_INTEGER_SELECT, condition, step, in[2]), 0);
}

static void make_loop(struct maker *m, uint64_t seed, uint32_t depth, uint32_t last, const uint32_t initial[STATES],
                      uint32_t out[STATES]) {
    const bool ends = seed % 8 != 0;
    uint32_t state[STATES], next[STATES], zero = expr_float(&m->graph, 0);
    memcpy(state, initial, sizeof state);
    for (uint32_t i = 1; m->unrolls && i <= last; i++) {
        uint32_t alive = apply(m, EXPR_LESS, zero, state[0], 0);
        make_body(m, seed, depth, expr_integer(&m->graph, i), state, next);
        for (int k = 0; k < STATES; k++) {
            enum expr_operation select = state_types[k] == EXPR_TYPE_I ? EXPR_INTEGER_SELECT : EXPR_SELECT;
            state[k] = i > 1 && ends ? apply(m, select, alive, next[k], state[k]) : next[k];
        }
    }
    memcpy(out, state, sizeof state);
    if (m->unrolls)
        return;
    for (uint32_t k = 0; k < STATES; k++)
        state[k] = expr_symbol(&m->graph, depth, 1 + k, state_types[k]);
    make_body(m, seed, depth, expr_symbol(&m->graph, depth, 0, EXPR_TYPE_I), state, next);
    const struct expr_graph_loop loop = {.first = 1,
                                         .last = last,
                                         .depth = depth,
                                         .state_count = STATES,
                                         .initial = initial,
                                         .next = next,
                                         .ends = ends};
    if (!expr_loop(&m->graph, &loop, out))
        test_fail(__FILE__, __LINE__, "no loop");
}

struct example {
    struct arena arena;
    struct expr_program looped, unrolled;
};

static void compile(uint64_t seed, uint32_t last, bool unrolls, struct arena *arena, struct expr_program *program) {
    struct maker m = {.graph = {.count = 0}, .unrolls = unrolls};
    struct error error = {0};
    uint32_t x = expr_input(&m.graph, EXPR_POINT_X), z = expr_input(&m.graph, EXPR_POINT_Z), out[STATES], outputs[3];
    const uint32_t initial[STATES] = {apply(&m, EXPR_ADD, x, z, 0), seed % 2 ? z : expr_float(&m.graph, 0.5),
                                      expr_integer(&m.graph, 3)};
    make_loop(&m, seed, 1, last, initial, out);
    outputs[0] = apply(&m, EXPR_MIN, out[1], apply(&m, EXPR_MULTIPLY, x, expr_float(&m.graph, 3), 0), 0);
    outputs[1] = out[0];
    outputs[2] = apply(&m, EXPR_TO_FLOAT, out[2], 0, 0);
    if (!expr_compile(&m.graph, outputs, 3, arena, program, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    expr_graph_destroy(&m.graph);
}

static void example_init(struct example *e, uint64_t seed) {
    uint32_t last = 1 + (uint32_t)(seed % 9);
    *e = (struct example){.arena = {0}};
    compile(seed, last, false, &e->arena, &e->looped);
    compile(seed, last, true, &e->arena, &e->unrolled);
}

static bool same(double a, double b) {
    return to_bits(a) == to_bits(b) || (isnan(a) && isnan(b));
}

static double coordinate(uint64_t key, uint64_t i) {
    return floor(random_unit(random_combine(key, i)) * 4096 - 2048) / 1024;
}

/* --- values --- */

static void check_values(const struct example *e, uint64_t seed) {
    static const char *const sets[] = {"base", "avx2", "avx512"};
    static double in[3][EXPR_BATCH], results[EXPR_OUTPUTS][EXPR_BATCH], wanted[EXPR_OUTPUTS][EXPR_BATCH];
    const double *from[EXPR_INPUT_COUNT] = {in[0], in[1], in[2]};
    double *to[EXPR_OUTPUTS] = {results[0], results[1], results[2], results[3]};
    uint32_t count = 1 + (uint32_t)(seed * 7 % EXPR_BATCH);
    void *rows = mem_alloc_aligned(64, expr_batch_size(&e->looped));
    for (uint32_t i = 0; i < count; i++) {
        double point[EXPR_INPUT_COUNT] = {0}, one[EXPR_OUTPUTS], other[EXPR_OUTPUTS];
        for (uint64_t k = 0; k < 3; k++)
            in[k][i] = point[k] = coordinate(seed, i * 3 + k);
        expr_evaluate(&e->looped, point, one);
        expr_evaluate(&e->unrolled, point, other);
        for (int k = 0; k < 3; k++) {
            wanted[k][i] = other[k];
            if (!same(one[k], other[k]))
                test_fail(__FILE__, __LINE__, "loop %d, output %d: %a, not %a", (int)seed, k, one[k], other[k]);
        }
    }
    for (size_t set = 0; set < sizeof sets / sizeof sets[0]; set++) {
        if (!cpu_select_isa(sets[set]))
            continue;
        expr_evaluate_batch(&e->looped, count, from, to, rows);
        for (uint32_t i = 0; i < 3 * count; i++)
            if (!same(results[i % 3][i / 3], wanted[i % 3][i / 3]))
                test_fail(__FILE__, __LINE__, "loop %d in a batch: %a, not %a", (int)seed, results[i % 3][i / 3],
                          wanted[i % 3][i / 3]);
    }
    CHECK(cpu_select_isa("auto"));
    mem_free(rows);
}

TEST(loops_have_the_bits_of_their_steps_one_by_one) {
    for (uint64_t i = 0; i < 400; i++) {
        struct example e;
        example_init(&e, random_combine(61, i));
        CHECK(e.looped.loop_count == 1 && e.unrolled.loop_count == 0);
        check_values(&e, random_combine(61, i));
        arena_destroy(&e.arena);
    }
}

/* Each loop is the sum of what the loop in it gives for its steps, so that n loops of 3 steps add x to 3^n numbers. */
static bool compile_nested(uint32_t depth, struct arena *arena, struct expr_program *program, struct error *error) {
    struct expr_graph graph = {.count = 0};
    uint32_t inner = expr_input(&graph, EXPR_POINT_X), outputs[1];
    for (uint32_t at = depth; at > 0; at--) {
        const uint32_t zero = expr_float(&graph, 0), state = expr_symbol(&graph, at, 1, EXPR_TYPE_F);
        const uint32_t start = at == 1 ? zero : expr_symbol(&graph, at - 1, 1, EXPR_TYPE_F);
        const uint32_t next = at == depth ? expr_operation(&graph, EXPR_ADD, state, inner, EXPR_NONE) : inner;
        const struct expr_graph_loop loop = {
            .first = 1, .last = 3, .depth = at, .state_count = 1, .initial = &start, .next = &next};
        CHECK(expr_loop(&graph, &loop, &inner));
    }
    outputs[0] = inner;
    const bool ok = expr_compile(&graph, outputs, 1, arena, program, error);
    expr_graph_destroy(&graph);
    return ok;
}

TEST(loops_are_evaluated_to_the_greatest_depth_and_refused_beyond_it) {
    struct arena arena = {0};
    struct expr_program program;
    struct error error = {0};
    double wanted = 1;
    for (uint32_t depth = 1; depth <= EXPR_DEPTH; depth++) {
        static double xs[EXPR_BATCH], results[EXPR_BATCH];
        const double *from[EXPR_INPUT_COUNT] = {xs}, point[EXPR_INPUT_COUNT] = {0};
        double *to[EXPR_OUTPUTS] = {results}, out[EXPR_OUTPUTS], gradient[EXPR_OUTPUTS][EXPR_DIRECTIONS];
        struct expr_interval box[EXPR_INPUT_COUNT] = {{1, 2, false}}, bounds[EXPR_OUTPUTS];
        struct expr_directions along = {.count = 1, .seeds = {{1}}};
        struct expr_range range[EXPR_OUTPUTS];
        CHECK(compile_nested(depth, &arena, &program, &error));
        void *rows = mem_alloc_aligned(64, expr_slopes_size(&program) + expr_batch_size(&program));
        wanted *= 3;
        for (uint32_t i = 0; i < EXPR_BATCH; i++)
            xs[i] = i;
        expr_evaluate_batch(&program, EXPR_BATCH, from, to, rows);
        for (uint32_t i = 0; i < EXPR_BATCH; i++)
            CHECK(results[i] == wanted * xs[i]);
        expr_evaluate_gradient(&program, point, expr_gradient_seeds, out, gradient, rows);
        CHECK(out[0] == 0 && gradient[0][0] == wanted);
        expr_evaluate_interval(&program, box, bounds, NULL, rows);
        expr_evaluate_slopes(&program, box, &along, range, NULL, rows);
        CHECK_NEAR(bounds[0].low, wanted, 1e-9);
        CHECK_NEAR(bounds[0].high, 2 * wanted, 1e-9);
        CHECK_NEAR(range[0].slopes[0].low, wanted, 1e-9);
        mem_free(rows);
    }
    CHECK(!compile_nested(EXPR_DEPTH + 1, &arena, &program, &error));
    CHECK(strstr(error.text, "loops that are more than 3 deep in each other"));
    arena_destroy(&arena);
}

TEST(derivatives_of_loops_are_those_of_their_steps_one_by_one) {
    for (uint64_t i = 0; i < 400; i++) {
        struct example e;
        double values[EXPR_OUTPUTS], one[EXPR_OUTPUTS][EXPR_DIRECTIONS], other[EXPR_OUTPUTS][EXPR_DIRECTIONS];
        example_init(&e, random_combine(62, i));
        void *rows = mem_alloc_aligned(64, expr_gradient_size(&e.looped) + expr_gradient_size(&e.unrolled));
        for (uint64_t n = 0; n < 10; n++) {
            double point[EXPR_INPUT_COUNT] = {0};
            for (uint64_t k = 0; k < 3; k++)
                point[k] = coordinate(i, n * 3 + k);
            expr_evaluate_gradient(&e.looped, point, expr_gradient_seeds, values, one, rows);
            expr_evaluate_gradient(&e.unrolled, point, expr_gradient_seeds, values, other, rows);
            for (int k = 0; k < 9; k++)
                if (!(one[k / 3][k % 3] == other[k / 3][k % 3]) && !isnan(other[k / 3][k % 3]))
                    test_fail(__FILE__, __LINE__, "loop %d: derivative %a, not %a", (int)i, one[k / 3][k % 3],
                              other[k / 3][k % 3]);
        }
        mem_free(rows);
        arena_destroy(&e.arena);
    }
}

/* --- bounds --- */

static void random_box(uint64_t key, struct expr_interval box[EXPR_INPUT_COUNT]) {
    double width = key % 3 == 0 ? 1e-6 : key % 3 == 1 ? 0.01 : 0.8;
    for (uint64_t k = 0; k < EXPR_INPUT_COUNT; k++) {
        double low = coordinate(key, k);
        box[k] = (struct expr_interval){low, low + width * random_unit(random_combine(key, 20 + k)), false};
    }
}

static void point_in(const struct expr_interval *box, uint64_t key, double *point) {
    for (uint64_t k = 0; k < EXPR_INPUT_COUNT; k++) {
        double t = random_unit(random_combine(key, k));
        point[k] = fmin(box[k].low + t * (box[k].high - box[k].low), box[k].high);
    }
}

static bool contains(struct expr_interval bounds, double x) {
    return isnan(x) ? bounds.may_be_nan : bounds.low <= x && x <= bounds.high;
}

static void check_box(const struct expr_program *program, uint64_t key, uint64_t points) {
    struct expr_interval box[EXPR_INPUT_COUNT], bounds[EXPR_OUTPUTS];
    struct expr_range ranges[EXPR_OUTPUTS];
    struct expr_directions directions = {.count = 3};
    struct expr_choice choices[128];
    struct expr_instruction code[128];
    struct expr_stack stack = {code, 128};
    struct expr_program shorter, kept;
    struct arena arena = {0};
    CHECK(program->count < 128);
    memcpy(directions.seeds, expr_gradient_seeds, sizeof directions.seeds);
    void *rows = mem_alloc_aligned(64, expr_slopes_size(program)),
         *scratch = mem_alloc(expr_shorten_size(program) + 64);
    random_box(key, box);
    expr_evaluate_slopes(program, box, &directions, ranges, NULL, rows);
    expr_evaluate_interval(program, box, bounds, choices, rows);
    CHECK(expr_shorten(program, choices, 0, &stack, scratch, &shorter));
    CHECK(expr_keep(&shorter, &arena, &kept));
    for (uint64_t i = 0; i < points; i++) {
        double a[EXPR_INPUT_COUNT], b[EXPR_INPUT_COUNT], of_a[EXPR_OUTPUTS], of_b[EXPR_OUTPUTS], part[EXPR_OUTPUTS];
        point_in(box, random_combine(key, 100 + i), a);
        memcpy(b, a, sizeof b);
        b[i % 3] = box[i % 3].high;
        expr_evaluate(program, a, of_a);
        expr_evaluate(program, b, of_b);
        expr_evaluate(&kept, a, part);
        for (int k = 0; k < program->output_count; k++) {
            struct expr_interval slope = ranges[k].slopes[i % 3];
            double quotient = (of_b[k] - of_a[k]) / (b[i % 3] - a[i % 3]);
            double error = 1e-12 * (fabs(of_a[k]) + 1) / (b[i % 3] - a[i % 3]);
            if (!same(of_a[k], part[k]))
                test_fail(__FILE__, __LINE__, "shortened: %a, not %a", part[k], of_a[k]);
            if (!contains(bounds[k], of_a[k]) || !contains(ranges[k].value, of_a[k]))
                test_fail(__FILE__, __LINE__, "%a is not in %a..%a", of_a[k], bounds[k].low, bounds[k].high);
            if (isfinite(quotient) && !(slope.low - error <= quotient && quotient <= slope.high + error))
                test_fail(__FILE__, __LINE__, "slope %g is not in %g..%g", quotient, slope.low, slope.high);
        }
    }
    arena_destroy(&arena);
    mem_free(scratch);
    mem_free(rows);
}

TEST(bounds_and_slopes_of_loops_contain_those_of_their_points) {
    for (uint64_t i = 0; i < 400; i++) {
        struct arena arena = {0};
        struct expr_program program;
        uint64_t seed = random_combine(63, i);
        compile(seed, 1 + (uint32_t)(i % 40), false, &arena, &program);
        for (uint64_t k = 0; k < 6; k++)
            check_box(&program, random_combine(i, k), 20);
        arena_destroy(&arena);
    }
}

/* The later steps are bounded all at once. */
TEST(bounds_of_long_loops_contain_the_values_of_their_points) {
    for (uint64_t i = 0; i < 12; i++) {
        struct arena arena = {0};
        struct expr_program program;
        compile(random_combine(64, i) / 3 * 3 + 1, 3000, false, &arena, &program); /* without a loop inside */
        for (uint64_t k = 0; k < 4; k++)
            check_box(&program, random_combine(i, k), 6);
        arena_destroy(&arena);
    }
}

static bool same_bounds(struct expr_interval a, double low, double high, bool may_be_nan) {
    return a.low == low && a.high == high && a.may_be_nan == may_be_nan;
}

static void check_many_boxes(const struct expr_program *program, uint64_t key, const char *name) {
    static struct expr_bounds bounds[EXPR_OUTPUTS];
    struct expr_interval box[EXPR_BOXES][EXPR_INPUT_COUNT], single[EXPR_OUTPUTS];
    double ends[2][3][EXPR_BOXES];
    struct expr_boxes boxes = {.count = 1 + (uint32_t)(key % EXPR_BOXES)};
    static _Alignas(64) struct expr_interval single_rows[EXPR_VALUES];
    void *rows = mem_alloc_aligned(64, expr_intervals_size(program));
    for (uint32_t i = 0; i < boxes.count; i++) {
        random_box(random_combine(key, i), box[i]);
        for (int k = 0; k < 3; k++) {
            ends[0][k][i] = box[i][k].low;
            ends[1][k][i] = box[i][k].high;
        }
    }
    for (int k = 0; k < 3; k++) {
        boxes.low[k] = ends[0][k];
        boxes.high[k] = ends[1][k];
    }
    expr_evaluate_intervals(program, &boxes, bounds, NULL, rows);
    for (uint32_t i = 0; i < boxes.count; i++) {
        expr_evaluate_interval(program, box[i], single, NULL, single_rows);
        for (int k = 0; k < program->output_count; k++)
            if (!same_bounds(single[k], bounds[k].low[i], bounds[k].high[i], bounds[k].may_be_nan >> i & 1))
                test_fail(__FILE__, __LINE__, "%s: %a..%a, not %a..%a", name, bounds[k].low[i], bounds[k].high[i],
                          single[k].low, single[k].high);
    }
    mem_free(rows);
}

/* The difference of the values at two points of the box, along direction k, is within the slopes. */
static void check_slope(const struct expr_program *program, const struct expr_interval box[EXPR_INPUT_COUNT], int k,
                        const struct expr_interval slopes[EXPR_OUTPUTS], uint64_t key) {
    double in[EXPR_INPUT_COUNT] = {0}, a[EXPR_OUTPUTS], b[EXPR_OUTPUTS];
    for (int n = 0; n < EXPR_INPUT_COUNT; n++)
        in[n] = box[n].low + random_unit(random_combine(key, (uint64_t)n)) * (box[n].high - box[n].low);
    expr_evaluate(program, in, a);
    double from = in[k];
    in[k] = box[k].low + random_unit(random_combine(key, 100)) * (box[k].high - box[k].low);
    expr_evaluate(program, in, b);
    for (int n = 0; n < program->output_count; n++) {
        double step = in[k] - from, rise = b[n] - a[n], error = 1e-9 * (1 + fabs(a[n]) + fabs(b[n]));
        double p = slopes[n].low * step, q = slopes[n].high * step;
        if (!(step == 0 || !isfinite(rise) || (rise >= fmin(p, q) - error && rise <= fmax(p, q) + error)))
            test_fail(__FILE__, __LINE__, "a rise of %a in %a is not within the slopes %a..%a", rise, step,
                      slopes[n].low, slopes[n].high);
    }
}

/* Slopes of eight boxes at a time and of single boxes round in other orders: -1 times a slope, and a slope plus 0, are
 * exact only in one of them. So x - x has the slope 0, or one of 2^-52, and where it decides whether a value may jump,
 * one of the two slopes is unbounded. Both contain the true slopes. Returns whether there was such a difference. */
static bool check_lanes(const struct expr_program *program, uint64_t key, const char *name) {
    bool differs = false;
    struct expr_lane_inputs inputs = {.are_cases = false};
    struct expr_lane_range lanes[EXPR_OUTPUTS];
    struct expr_range single[EXPR_OUTPUTS];
    struct expr_interval box[EXPR_LANES][EXPR_INPUT_COUNT];
    struct expr_directions directions = {.count = 3};
    memcpy(directions.seeds, expr_gradient_seeds, sizeof directions.seeds);
    void *rows = mem_alloc_aligned(64, expr_lanes_size(program) + expr_slopes_size(program));
    for (uint32_t i = 0; i < EXPR_LANES; i++) {
        random_box(random_combine(key, i), box[i]);
        for (int k = 0; k < EXPR_INPUT_COUNT; k++) {
            inputs.low[k][i] = box[i][k].low;
            inputs.high[k][i] = box[i][k].high;
        }
    }
    expr_evaluate_slopes_lanes(program, &inputs, &directions, lanes, NULL, rows);
    for (uint32_t i = 0; i < EXPR_LANES; i++) {
        expr_evaluate_slopes(program, box[i], &directions, single, NULL, rows);
        for (int k = 0; k < program->output_count; k++) {
            double a = lanes[k].low[i], b = single[k].value.low, error = 1e-9 * (1 + fabs(b));
            double c = lanes[k].slopes[i % 3].high[i], d = single[k].slopes[i % 3].high, wide = 1e-6 * (1 + fabs(d));
            bool is_jump = isinf(c) != isinf(d);
            if (!(same(a, b) || fabs(a - b) < error) || !(same(c, d) || fabs(c - d) < wide || is_jump))
                test_fail(__FILE__, __LINE__, "%s: %a and slope %a, not %a and %a", name, a, c, b, d);
            differs = differs || is_jump;
        }
        for (int k = 0; k < 3; k++) {
            struct expr_interval slopes[EXPR_OUTPUTS];
            for (int n = 0; n < program->output_count; n++)
                slopes[n] = (struct expr_interval){lanes[n].slopes[k].low[i], lanes[n].slopes[k].high[i], false};
            check_slope(program, box[i], k, slopes, random_combine(key, 1000 + 3 * i + (uint64_t)k));
            for (int n = 0; n < program->output_count; n++)
                slopes[n] = single[n].slopes[k];
            check_slope(program, box[i], k, slopes, random_combine(key, 2000 + 3 * i + (uint64_t)k));
        }
    }
    mem_free(rows);
    return differs;
}

static void check_loops_in_many_boxes(uint64_t first, uint64_t end) {
    static const char *const sets[] = {"base", "avx2", "avx512"};
    uint64_t differences = 0;
    for (uint64_t i = first; i < end; i++) {
        struct example e;
        bool differs = false;
        example_init(&e, random_combine(65, i));
        for (size_t set = 0; set < sizeof sets / sizeof sets[0]; set++) {
            if (!cpu_select_isa(sets[set]))
                continue;
            check_many_boxes(&e.looped, random_combine(66, i), sets[set]);
            differs = check_lanes(&e.looped, random_combine(67, i), sets[set]) || differs;
        }
        differences += differs;
        arena_destroy(&e.arena);
    }
    if (differences > (end - first) / 500)
        test_fail(__FILE__, __LINE__, "%d programs differ", (int)differences);
    CHECK(cpu_select_isa("auto"));
}

TEST(bounds_of_loops_in_many_boxes_are_those_of_each_box) {
    check_loops_in_many_boxes(0, 60);
}

/* z * z + p until |z| > 2, at most `steps` times: states without bounds, and boxes that end at very different steps. */
static void compile_mandelbrot(uint32_t steps, struct arena *arena, struct expr_program *program) {
    struct maker m = {.graph = {.count = 0}};
    struct error error = {0};
    struct expr_graph *g = &m.graph;
    uint32_t zero = expr_float(g, 0), one = expr_float(g, 1), two = expr_float(g, 2), four = expr_float(g, 4), out[4];
    uint32_t x = expr_symbol(g, 1, 2, EXPR_TYPE_F), y = expr_symbol(g, 1, 3, EXPR_TYPE_F);
    uint32_t k = expr_symbol(g, 1, 4, EXPR_TYPE_I), xx = apply(&m, EXPR_MULTIPLY, x, x, 0);
    uint32_t yy = apply(&m, EXPR_MULTIPLY, y, y, 0),
             xy = apply(&m, EXPR_MULTIPLY, apply(&m, EXPR_MULTIPLY, two, x, 0), y, 0);
    const uint32_t initial[] = {one, zero, zero, expr_integer(g, 0)};
    const uint32_t next[] = {apply(&m, EXPR_SUBTRACT, four, apply(&m, EXPR_ADD, xx, yy, 0), 0),
                             apply(&m, EXPR_ADD, apply(&m, EXPR_SUBTRACT, xx, yy, 0), expr_input(g, EXPR_POINT_X), 0),
                             apply(&m, EXPR_ADD, xy, expr_input(g, EXPR_POINT_Y), 0),
                             apply(&m, EXPR_INTEGER_ADD, k, expr_integer(g, 1), 0)};
    const struct expr_graph_loop loop = {
        .first = 1, .last = steps, .depth = 1, .state_count = 4, .initial = initial, .next = next, .ends = true};
    CHECK(expr_loop(g, &loop, out));
    const uint32_t outputs[] = {apply(&m, EXPR_TO_FLOAT, out[3], 0, 0), out[1], out[2]};
    if (!expr_compile(g, outputs, 3, arena, program, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    expr_graph_destroy(g);
}

TEST(bounds_of_long_loops_in_many_boxes_are_those_of_each_box) {
    static const char *const sets[] = {"base", "avx2", "avx512"};
    struct arena arena = {0};
    struct expr_program programs[6];
    for (uint32_t i = 0; i < 3; i++) {
        compile_mandelbrot(i == 0 ? 20 : i == 1 ? 200 : 3000, &arena, &programs[2 * i]);
        compile(random_combine(68, i), 1500, false, &arena, &programs[2 * i + 1]);
    }
    for (uint64_t i = 0; i < 24; i++)
        for (size_t set = 0; set < sizeof sets / sizeof sets[0]; set++)
            if (cpu_select_isa(sets[set]))
                check_many_boxes(&programs[i % 6], random_combine(69, i), sets[set]);
    CHECK(cpu_select_isa("auto"));
    arena_destroy(&arena);
}

TEST_LONG(bounds_of_twenty_thousand_loops_in_many_boxes_are_those_of_each_box) {
    check_loops_in_many_boxes(60, 20060);
}
