/* Operations of expressions beside Lua, one point beside batches, in every instruction set; graphs and programs. */
#include "base/isa.h"
#include "base/mem.h"
#include "base/random.h"
#include "expr/expr_program.h"
#include "math/exact.h"
#include "tests/harness.h"
#include "tests/unit/expr_by_switch.h"
#include "tests/unit/picture_function.h"

#include <lauxlib.h>
#include <lualib.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* The operation in Lua, or NULL where Lua has none. */
static const char *in_lua(enum expr_operation operation) {
    switch (operation) {
    case EXPR_ADD:
    case EXPR_INTEGER_ADD:
        return "a + b";
    case EXPR_SUBTRACT:
    case EXPR_INTEGER_SUBTRACT:
        return "a - b";
    case EXPR_MULTIPLY:
    case EXPR_INTEGER_MULTIPLY:
        return "a * b";
    case EXPR_DIVIDE:
        return "a / b";
    case EXPR_FLOOR_DIVIDE:
        return "a // b";
    case EXPR_INTEGER_DIVIDE:
        return "b == 0 and 0 or a // b";
    case EXPR_MODULO:
        return "a % b";
    case EXPR_INTEGER_MODULO:
        return "b == 0 and 0 or a % b";
    case EXPR_POWER:
        return "b == 2 and SKIP or a ^ b";
    case EXPR_NEGATE:
    case EXPR_INTEGER_NEGATE:
        return "-a";
    case EXPR_ABS:
        return "math.abs(a)";
    case EXPR_SQRT:
        return "math.sqrt(a)";
    case EXPR_FLOOR:
        return "SAME_NUMBER(math.floor(a))";
    case EXPR_CEIL:
        return "SAME_NUMBER(math.ceil(a))";
    case EXPR_REMAINDER:
        return "math.fmod(a, b)";
    case EXPR_INTEGER_REMAINDER:
        return "b == 0 and 0 or math.fmod(a, b)";
    case EXPR_MIN:
        return "math.min(a, b)";
    case EXPR_MAX:
        return "math.max(a, b)";
    case EXPR_SIN:
        return "math.sin(a)";
    case EXPR_COS:
        return "math.cos(a)";
    case EXPR_TAN:
        return "math.tan(a)";
    case EXPR_ASIN:
        return "math.asin(a)";
    case EXPR_ACOS:
        return "math.acos(a)";
    case EXPR_ATAN:
        return "math.atan(a, b)";
    case EXPR_EXP:
        return "math.exp(a)";
    case EXPR_LOG:
        return "math.log(a)";
    case EXPR_LOG2:
        return "math.log(a, 2)";
    case EXPR_LOG10:
        return "math.log(a, 10)";
    case EXPR_BIT_AND:
        return "a & b";
    case EXPR_BIT_OR:
        return "a | b";
    case EXPR_BIT_XOR:
        return "a ~ b";
    case EXPR_BIT_NOT:
        return "~a";
    case EXPR_SHIFT_LEFT:
        return "a << b";
    case EXPR_SHIFT_RIGHT:
        return "a >> b";
    case EXPR_COPY:
        return "a";
    case EXPR_TO_FLOAT:
        return "a + 0.0";
    case EXPR_TO_INTEGER:
        return "math.tointeger(a) or SKIP";
    case EXPR_LESS:
    case EXPR_INTEGER_LESS:
    case EXPR_MIXED_LESS:
        return "a < b";
    case EXPR_LESS_EQUAL:
    case EXPR_INTEGER_LESS_EQUAL:
    case EXPR_MIXED_LESS_EQUAL:
        return "a <= b";
    case EXPR_EQUAL:
    case EXPR_INTEGER_EQUAL:
    case EXPR_MIXED_EQUAL:
        return "a == b";
    case EXPR_MIXED_GREATER:
        return "a > b";
    case EXPR_MIXED_GREATER_EQUAL:
        return "a >= b";
    case EXPR_WHOLE:
        return "math.tointeger(a) ~= nil";
    case EXPR_SELECT:
    case EXPR_INTEGER_SELECT:
        return "TRUTH(a, b, c)";
    case EXPR_SINH:
    case EXPR_COSH:
    case EXPR_TANH:
    case EXPR_NOISE:
    case EXPR_HASH:
    case EXPR_CELL_NEAREST:
    case EXPR_CELL_SECOND:
    case EXPR_CELL_ID:
    case EXPR_TEXEL:
    case EXPR_TRUTH_SELECT:
    EXPR_LOOP_CASES:
    case EXPR_CONSTANT:
    case EXPR_INPUT:
    case EXPR_OPERATION_COUNT:
    case EXPR_ALL_OPERATIONS:
        break;
    }
    return NULL;
}

static bool same_bits(double a, double b) {
    return to_bits(a) == to_bits(b) || (isnan(a) && isnan(b));
}

/* Every third one is special; of the rest half are of moderate size. */
static double random_float(uint64_t key) {
    static const double special[] = {0.0,
                                     -0.0,
                                     1,
                                     -1,
                                     2,
                                     0.5,
                                     -0.5,
                                     INFINITY,
                                     -INFINITY,
                                     (double)NAN,
                                     0x1p-1074,
                                     -0x1p-1074,
                                     0x1p-1022,
                                     0x1p53,
                                     0x1p63,
                                     -0x1p63,
                                     0x1p62,
                                     1.7976931348623157e308,
                                     3,
                                     10,
                                     255,
                                     256,
                                     1e-3,
                                     -2,
                                     0x1.fffffffffffffp-1,
                                     1.5};
    uint64_t bits = random_mix(key);
    if (bits % 3 == 0)
        return special[(bits >> 8) % (sizeof special / sizeof special[0])];
    if (bits % 3 == 1)
        return (random_unit(random_mix(bits)) - 0.5) * (bits & 256 ? 20 : 2000);
    return from_bits(random_mix(bits));
}

static int64_t random_integer(uint64_t key) {
    static const int64_t special[] = {
        0, 1, -1, 2, -2, 63, 64, -64, 65, INT64_MAX, INT64_MIN, INT64_MIN + 1, 1LL << 53, (1LL << 53) + 1, 7};
    uint64_t bits = random_mix(key);
    if (bits % 3 == 0)
        return special[(bits >> 8) % (sizeof special / sizeof special[0])];
    return (int64_t)random_mix(bits) >> (bits % 3 == 1 ? 0 : 8 + (bits >> 8) % 50);
}

/* A program for one operation. An integer comes in as two halves and goes out as two, a truth as 0 or 1. */
struct example {
    struct arena arena;
    struct expr_graph graph;
    struct expr_program program;
    enum expr_operation operation;
    void *rows;
};

static uint32_t integer_of_halves(struct expr_graph *graph, int operand) {
    uint32_t high = expr_operation(graph, EXPR_TO_INTEGER, expr_input(graph, (enum expr_input)(2 * operand)), 0, 0);
    uint32_t low = expr_operation(graph, EXPR_TO_INTEGER, expr_input(graph, (enum expr_input)(2 * operand + 1)), 0, 0);
    uint32_t up = expr_operation(graph, EXPR_INTEGER_MULTIPLY, high, expr_integer(graph, 1LL << 32), 0);
    return expr_operation(graph, EXPR_INTEGER_ADD, up, low, 0);
}

/* The operand that is a constant, a picture. */
static bool is_picture(enum expr_operation operation, int k) {
    return operation == EXPR_TEXEL && k == 2;
}

static void example_init(struct example *e, enum expr_operation operation) {
    *e = (struct example){.operation = operation};
    struct error error = {0};
    struct expr_graph *graph = &e->graph;
    uint32_t operands[3] = {0, 0, 0}, outputs[2];
    int output_count = 1;
    for (int k = 0; k < expr_operand_count(operation); k++) {
        enum expr_type type = expr_operand_type(operation, k);
        uint32_t input = expr_input(graph, (enum expr_input)(2 * k));
        operands[k] = is_picture(operation, k) ? expr_integer(graph, test_picture_operand(2))
                      : type == EXPR_TYPE_F    ? input
                      : type == EXPR_TYPE_I    ? integer_of_halves(graph, k)
                                               : expr_operation(graph, EXPR_LESS, expr_float(graph, 0), input, 0);
    }
    uint32_t result = expr_operation(graph, operation, operands[0], operands[1], operands[2]);
    switch (expr_result_type(operation)) {
    case EXPR_TYPE_F:
        outputs[0] = result;
        break;
    case EXPR_TYPE_I: {
        uint32_t high = expr_operation(graph, EXPR_SHIFT_RIGHT, result, expr_integer(graph, 32), 0);
        uint32_t low = expr_operation(graph, EXPR_BIT_AND, result, expr_integer(graph, 0xffffffff), 0);
        outputs[0] = expr_operation(graph, EXPR_TO_FLOAT, high, 0, 0);
        outputs[1] = expr_operation(graph, EXPR_TO_FLOAT, low, 0, 0);
        output_count = 2;
        break;
    }
    case EXPR_TYPE_B:
    case EXPR_TYPE_N:
        outputs[0] = expr_operation(graph, EXPR_SELECT, result, expr_float(graph, 1), expr_float(graph, 0));
        break;
    }
    CHECK(expr_compile(graph, outputs, output_count, &e->arena, &e->program, &error));
    e->rows = mem_alloc_aligned(64, expr_batch_size(&e->program));
}

static void example_destroy(struct example *e) {
    mem_free(e->rows);
    expr_graph_destroy(&e->graph);
    arena_destroy(&e->arena);
}

static void put_operand(const struct example *e, int k, uint64_t key, double *inputs, union expr_value *value) {
    if (is_picture(e->operation, k)) {
        value->i = test_picture_operand(2);
        return;
    }
    switch (expr_operand_type(e->operation, k)) {
    case EXPR_TYPE_F:
        inputs[2 * k] = value->f = random_float(key);
        break;
    case EXPR_TYPE_I:
        value->i = random_integer(key);
        inputs[2 * k] = (double)(int32_t)(value->i >> 32);
        inputs[2 * k + 1] = (double)(uint32_t)value->i;
        break;
    case EXPR_TYPE_B:
        inputs[2 * k] = random_mix(key) & 1 ? 1 : -1;
        value->i = inputs[2 * k] > 0 ? -1 : 0;
        break;
    case EXPR_TYPE_N:
        break;
    }
}

static void push_value(lua_State *L, enum expr_type type, union expr_value value) {
    if (type == EXPR_TYPE_F)
        lua_pushnumber(L, value.f);
    else if (type == EXPR_TYPE_I)
        lua_pushinteger(L, value.i);
    else
        lua_pushboolean(L, value.i != 0);
}

/* Whether the function on top of the stack gives that. */
static bool equals_lua(lua_State *L, enum expr_operation operation, const union expr_value *values,
                       union expr_value result) {
    enum expr_type type = expr_result_type(operation);
    lua_pushvalue(L, -1);
    for (int k = 0; k < expr_operand_count(operation); k++)
        push_value(L, expr_operand_type(operation, k), values[k]);
    lua_call(L, expr_operand_count(operation), 1);
    bool fine = lua_isstring(L, -1) && !lua_isnumber(L, -1); /* SKIP */
    if (type == EXPR_TYPE_F)
        fine = fine ||
               (lua_type(L, -1) == LUA_TNUMBER && !lua_isinteger(L, -1) && same_bits(lua_tonumber(L, -1), result.f));
    else if (type == EXPR_TYPE_I)
        fine = fine || (lua_isinteger(L, -1) && lua_tointeger(L, -1) == result.i);
    else
        fine = fine || (lua_isboolean(L, -1) && lua_toboolean(L, -1) == (result.i != 0));
    lua_pop(L, 1);
    return fine;
}

/* What a program for the operation gives for that result. */
static void expected(enum expr_operation operation, union expr_value result, double out[2]) {
    enum expr_type type = expr_result_type(operation);
    out[0] = type == EXPR_TYPE_F   ? result.f
             : type == EXPR_TYPE_I ? (double)((uint64_t)result.i >> 32)
                                   : (result.i != 0 ? 1 : 0);
    out[1] = (double)(uint32_t)result.i;
}

enum { EXAMPLE_INPUTS = 6 };
static void check_batch(struct example *e, lua_State *L, uint64_t key, uint32_t count) {
    static const char *const sets[] = {"base", "avx2", "avx512"};
    double inputs[EXAMPLE_INPUTS][EXPR_BATCH], outputs[2][EXPR_BATCH], wanted[EXPR_BATCH][2];
    const double *in[EXPR_INPUT_COUNT] = {NULL};
    double *out[EXPR_OUTPUTS] = {outputs[0], outputs[1], NULL, NULL};
    for (int k = 0; k < EXAMPLE_INPUTS; k++)
        in[k] = inputs[k];
    for (uint32_t i = 0; i < count; i++) {
        union expr_value values[3] = {{.i = 0}, {.i = 0}, {.i = 0}};
        double point[EXPR_INPUT_COUNT] = {0}, one[EXPR_OUTPUTS];
        for (int k = 0; k < expr_operand_count(e->operation); k++)
            put_operand(e, k, random_combine(key, i * 3 + (uint64_t)k), point, &values[k]);
        for (int k = 0; k < EXAMPLE_INPUTS; k++)
            inputs[k][i] = point[k];
        union expr_value result = expr_apply(e->operation, values[0], values[1], values[2]);
        expected(e->operation, result, wanted[i]);
        expr_evaluate(&e->program, point, one);
        for (int k = 0; k < e->program.output_count; k++)
            if (!same_bits(one[k], wanted[i][k]))
                test_fail(__FILE__, __LINE__, "%s, one point: %a, not %a", expr_operation_name(e->operation), one[k],
                          wanted[i][k]);
        if (in_lua(e->operation) && !equals_lua(L, e->operation, values, result))
            test_fail(__FILE__, __LINE__, "%s of (%a, %lld), (%a, %lld) is not Lua's: %a, %lld",
                      expr_operation_name(e->operation), values[0].f, (long long)values[0].i, values[1].f,
                      (long long)values[1].i, result.f, (long long)result.i);
    }
    for (size_t set = 0; set < sizeof sets / sizeof sets[0]; set++) {
        if (!cpu_select_isa(sets[set]))
            continue;
        expr_evaluate_batch(&e->program, count, in, out, e->rows);
        for (uint32_t i = 0; i < count; i++)
            for (int k = 0; k < e->program.output_count; k++)
                if (!same_bits(outputs[k][i], wanted[i][k]))
                    test_fail(__FILE__, __LINE__, "%s, %s: %a, not %a", expr_operation_name(e->operation), sets[set],
                              outputs[k][i], wanted[i][k]);
    }
}

static void check_operation(lua_State *L, enum expr_operation operation, uint32_t points) {
    struct example e;
    example_init(&e, operation);
    if (in_lua(operation)) {
        char text[256];
        (void)snprintf(text, sizeof text,
                       "local SKIP, TRUTH = 'skip', function(a, b, c) if a then return b end return c end "
                       "local function SAME_NUMBER(x) if x == 0 then return 'skip' end return x + 0.0 end "
                       "return function(a, b, c) return %s end",
                       in_lua(operation));
        if (luaL_dostring(L, text) != LUA_OK)
            test_fail(__FILE__, __LINE__, "%s", lua_tostring(L, -1));
    } else {
        lua_pushnil(L);
    }
    for (uint32_t at = 0; at < points; at += EXPR_BATCH)
        check_batch(&e, L, random_combine((uint64_t)operation, at),
                    points - at < EXPR_BATCH ? points - at : EXPR_BATCH);
    lua_pop(L, 1);
    example_destroy(&e);
}

static void check_operations(uint32_t points) {
    lua_State *L = luaL_newstate();
    luaL_openlibs(L);
    for (int operation = EXPR_INPUT + 1; operation < EXPR_OPERATION_COUNT; operation++)
        check_operation(L, (enum expr_operation)operation, points);
    lua_close(L);
    CHECK(cpu_select_isa("auto"));
}

TEST(every_operation_gives_the_bits_of_lua_at_points_and_in_batches) {
    check_operations(20000);
}

TEST_LONG(every_operation_gives_the_bits_of_lua_on_a_million_values) {
    check_operations(1000000);
}

/* --- programs whose instructions read the result of the one before --- */

enum { LINKED_NODES = 400 };

/* Operations on the newest value, on any other, and on constants; the first three nodes are inputs. */
static void random_linked_graph(struct expr_graph *graph, uint64_t seed, int operations) {
    static const enum expr_operation choices[] = {
        EXPR_ADD,    EXPR_SUBTRACT, EXPR_MULTIPLY, EXPR_DIVIDE,   EXPR_MIN,        EXPR_MAX,
        EXPR_NEGATE, EXPR_ABS,      EXPR_SQRT,     EXPR_FLOOR,    EXPR_SELECT,     EXPR_SELECT,
        EXPR_SELECT, EXPR_CEIL,     EXPR_ADD,      EXPR_MULTIPLY, EXPR_LESS_EQUAL, EXPR_SIN};
    uint32_t last = 0, condition = EXPR_NONE;
    for (int k = 0; k < 3; k++)
        last = expr_input(graph, (enum expr_input)k);
    for (uint64_t i = 0; i < (uint64_t)operations && graph->count < LINKED_NODES - 8; i++) {
        uint64_t bits = random_combine(seed, i);
        enum expr_operation operation = choices[bits % (sizeof choices / sizeof choices[0])];
        uint32_t operands[3];
        for (int k = 0; k < 3; k++) {
            unsigned kind = (unsigned)(bits >> (8 + 4 * k)) % 8;
            uint32_t other = (uint32_t)((bits >> (20 + 8 * k)) % graph->count);
            while (graph->nodes[other].type != EXPR_TYPE_F)
                other--;
            operands[k] = kind < 4 ? last : kind < 6 ? other : expr_float(graph, random_float(bits + (uint64_t)k));
        }
        if (operation == EXPR_LESS_EQUAL || condition == EXPR_NONE) /* for this selection or for one after it */
            condition = expr_operation(graph, bits >> 50 & 1 ? EXPR_LESS : EXPR_LESS_EQUAL, last, operands[0], 0);
        if (operation == EXPR_LESS_EQUAL)
            continue;
        if (operation == EXPR_SELECT)
            operands[0] = condition;
        last = expr_operation(graph, operation, operands[0], operands[1], operands[2]);
    }
}

/* The value of every node at one point. */
static void apply_all(const struct expr_graph *graph, const double *inputs, union expr_value *values) {
    for (uint32_t n = 0; n < graph->count; n++) {
        const struct expr_node *node = &graph->nodes[n];
        union expr_value operands[3] = {{.i = 0}, {.i = 0}, {.i = 0}};
        for (int k = 0; k < expr_operand_count(node->operation); k++)
            operands[k] = values[node->operands[k]];
        values[n] = expr_apply(node->operation, operands[0], operands[1], operands[2]);
        if (node->operation == EXPR_CONSTANT)
            values[n] = node->constant;
        if (node->operation == EXPR_INPUT)
            values[n].f = inputs[node->operands[0]];
    }
}

static void check_linked_program(uint64_t seed) {
    static const char *const sets[] = {"base", "avx2", "avx512"};
    struct expr_graph graph = {.count = 0};
    struct arena arena = {0};
    struct error error = {0};
    struct expr_program program;
    uint32_t outputs[EXPR_OUTPUTS];
    int output_count = 1 + (int)(seed % EXPR_OUTPUTS);
    random_linked_graph(&graph, random_mix(seed), 3 + (int)(seed % 60));
    for (int i = 0; i < output_count; i++) {
        outputs[i] = graph.count - 1 - (uint32_t)(random_combine(seed, (uint64_t)i) % (i ? graph.count : 1));
        while (graph.nodes[outputs[i]].type != EXPR_TYPE_F)
            outputs[i]--;
    }
    CHECK(expr_compile(&graph, outputs, output_count, &arena, &program, &error));
    void *rows = mem_alloc_aligned(64, expr_batch_size(&program));
    uint32_t count = seed % 2 ? EXPR_BATCH : 1 + (uint32_t)(seed * 7 % EXPR_BATCH);
    double room[3][EXPR_BATCH + 1], wanted[EXPR_OUTPUTS][EXPR_BATCH], results[EXPR_OUTPUTS][EXPR_BATCH + 1];
    double *in[3] = {room[0] + (seed / 4 & 1), room[1], room[2] + 1}; /* of any alignment */
    for (uint32_t i = 0; i < count; i++) {
        double point[EXPR_INPUT_COUNT] = {0}, one[EXPR_OUTPUTS], other[EXPR_OUTPUTS];
        union expr_value values[LINKED_NODES];
        for (uint64_t k = 0; k < 3; k++)
            in[k][i] = point[k] = random_float(random_combine(seed, i * 3 + k));
        apply_all(&graph, point, values);
        expr_evaluate(&program, point, one);
        expr_evaluate_by_switch(&program, point, other);
        for (int k = 0; k < output_count; k++) {
            wanted[k][i] = values[outputs[k]].f;
            if (!same_bits(one[k], wanted[k][i]) || !same_bits(other[k], wanted[k][i]))
                test_fail(__FILE__, __LINE__, "program %d: %a, not %a", (int)seed, one[k], wanted[k][i]);
        }
    }
    for (size_t set = 0; set < sizeof sets / sizeof sets[0]; set++) {
        if (!cpu_select_isa(sets[set]))
            continue;
        const double *ins[EXPR_INPUT_COUNT] = {in[0], in[1], in[2]};
        double *outs[EXPR_OUTPUTS] = {results[0], results[1], results[2], results[3]};
        for (int k = 0; k < output_count; k++)
            results[k][count] = 4711;
        expr_evaluate_batch(&program, count, ins, outs, rows);
        for (int k = 0; k < output_count; k++)
            CHECK(results[k][count] == 4711);
        for (int k = 0; k < output_count; k++)
            for (uint32_t i = 0; i < count; i++)
                if (!same_bits(results[k][i], wanted[k][i]))
                    test_fail(__FILE__, __LINE__, "program %d, %s, point %u: %a, not %a", (int)seed, sets[set], i,
                              results[k][i], wanted[k][i]);
    }
    mem_free(rows);
    arena_destroy(&arena);
    expr_graph_destroy(&graph);
}

TEST(programs_of_linked_operations_give_the_bits_of_their_operations_one_by_one) {
    for (uint64_t seed = 0; seed < 3000; seed++)
        check_linked_program(seed);
    CHECK(cpu_select_isa("auto"));
}

/* A sum, difference or product with the input x, the value r, or a constant. */
static uint32_t step(struct expr_graph *graph, unsigned kind, uint32_t from, uint32_t x, uint32_t r) {
    static const enum expr_operation operations[] = {EXPR_ADD, EXPR_SUBTRACT, EXPR_MULTIPLY};
    uint32_t others[] = {x, r, expr_float(graph, 0.7 + kind)};
    return expr_operation(graph, operations[kind % 3], from, others[kind / 3], EXPR_NONE);
}

TEST(two_steps_that_are_one_jump_give_the_bits_of_both) {
    double x[EXPR_BATCH], y[EXPR_BATCH], results[3][EXPR_BATCH];
    for (uint64_t i = 0; i < EXPR_BATCH; i++) {
        x[i] = random_unit(random_combine(1, i)) - 0.3;
        y[i] = 10 * random_unit(random_combine(2, i)) - 5;
    }
    for (unsigned kind = 0; kind < 9 * 9 * 4; kind++) {
        struct expr_graph graph = {.count = 0};
        struct arena arena = {0};
        struct error error = {0};
        struct expr_program program;
        uint32_t of_x = expr_input(&graph, EXPR_POINT_X);
        uint32_t r = expr_operation(&graph, EXPR_ABS, expr_input(&graph, EXPR_POINT_Y), EXPR_NONE, EXPR_NONE);
        uint32_t square = expr_operation(&graph, EXPR_MULTIPLY, of_x, of_x, EXPR_NONE);
        uint32_t first = step(&graph, kind % 9, square, of_x, r);
        uint32_t second = step(&graph, kind / 9 % 9, first, of_x, r);
        uint32_t last = expr_operation(&graph, EXPR_MULTIPLY, second, expr_float(&graph, 3), EXPR_NONE);
        last = kind / 81 & 1 ? expr_operation(&graph, EXPR_MIN, last, first, EXPR_NONE) : last;
        last = kind / 81 & 2 ? expr_operation(&graph, EXPR_MAX, last, second, EXPR_NONE) : last;
        const uint32_t outputs[3] = {last, r, last};
        CHECK(expr_compile(&graph, outputs, 1 + (int)(kind % 3), &arena, &program, &error));
        void *rows = mem_alloc_aligned(64, expr_batch_size(&program));
        const double *ins[EXPR_INPUT_COUNT] = {x, y};
        double *outs[EXPR_OUTPUTS] = {results[0], results[1], results[2], NULL};
        for (uint32_t count = 32; count <= EXPR_BATCH; count += 8) {
            if (!cpu_select_isa(kind % 2 ? "avx2" : "auto"))
                continue;
            memset(results, 0, sizeof results);
            expr_evaluate_batch(&program, count, ins, outs, rows);
            for (uint32_t i = 0; i < count; i++) {
                double point[EXPR_INPUT_COUNT] = {x[i], y[i]};
                union expr_value values[LINKED_NODES];
                apply_all(&graph, point, values);
                for (int k = 0; k < program.output_count; k++)
                    if (!same_bits(results[k][i], values[outputs[k]].f))
                        test_fail(__FILE__, __LINE__, "steps %u, output %d of point %u of %u: %a, not %a", kind, k, i,
                                  count, results[k][i], values[outputs[k]].f);
            }
        }
        mem_free(rows);
        arena_destroy(&arena);
        expr_graph_destroy(&graph);
    }
    CHECK(cpu_select_isa("auto"));
}

TEST(noise_in_batches_has_the_bits_of_noise_at_points) {
    static const char *const sets[] = {"base", "avx2", "avx512"};
    static const double sizes[] = {1, 10, 300, 1e6, 0x1p30, 0x1p30};
    struct expr_graph graph = {.count = 0};
    struct arena arena = {0};
    struct error error = {0};
    struct expr_program program;
    uint32_t p[3];
    for (int k = 0; k < 3; k++)
        p[k] = expr_input(&graph, (enum expr_input)k);
    uint32_t noise = expr_operation(&graph, EXPR_NOISE, p[0], p[1], p[2]);
    CHECK(expr_compile(&graph, &noise, 1, &arena, &program, &error));
    void *rows = mem_alloc_aligned(64, expr_batch_size(&program));
    for (uint64_t seed = 0; seed < 3000; seed++) {
        uint32_t count = 1 + (uint32_t)(seed % EXPR_BATCH);
        double in[3][EXPR_BATCH], results[EXPR_BATCH], size = sizes[seed % 6];
        for (uint32_t i = 0; i < count; i++)
            for (uint64_t k = 0; k < 3; k++) {
                uint64_t bits = random_combine(seed, i * 3 + k);
                double x = (2 * random_unit(bits) - 1) * size;
                in[k][i] = bits >> 8 & 7 ? x : floor(x) + 0.0;
            }
        for (size_t set = 0; set < sizeof sets / sizeof sets[0]; set++) {
            if (!cpu_select_isa(sets[set]))
                continue;
            const double *ins[EXPR_INPUT_COUNT] = {in[0], in[1], in[2]};
            double *outs[EXPR_OUTPUTS] = {results, NULL, NULL, NULL};
            expr_evaluate_batch(&program, count, ins, outs, rows);
            for (uint32_t i = 0; i < count; i++) {
                double wanted = noise_perlin(in[0][i], in[1][i], in[2][i], 0);
                if (!same_bits(results[i], wanted))
                    test_fail(__FILE__, __LINE__, "%s: noise(%a, %a, %a) is %a, not %a", sets[set], in[0][i], in[1][i],
                              in[2][i], results[i], wanted);
            }
        }
    }
    CHECK(cpu_select_isa("auto"));
    mem_free(rows);
    arena_destroy(&arena);
    expr_graph_destroy(&graph);
}

TEST(floor_of_a_float_plus_zero_is_the_float_of_luas_floor) {
    lua_State *L = luaL_newstate();
    luaL_openlibs(L);
    CHECK(luaL_dostring(L, "return function(x) return math.floor(x) + 0.0, math.ceil(x) + 0.0 end") == LUA_OK);
    for (uint64_t i = 0; i < 20000; i++) {
        double x = random_float(random_combine(7, i));
        lua_pushvalue(L, -1);
        lua_pushnumber(L, x);
        lua_call(L, 1, 2);
        CHECK(same_bits(lua_tonumber(L, -2), floor(x) + 0.0));
        CHECK(same_bits(lua_tonumber(L, -1), ceil(x) + 0.0));
        lua_pop(L, 2);
    }
    lua_close(L);
}

TEST(equal_operations_are_one_node_and_constants_are_folded) {
    struct expr_graph graph = {.count = 0};
    uint32_t x = expr_input(&graph, EXPR_POINT_X), half = expr_float(&graph, 0.5);
    uint32_t a = expr_operation(&graph, EXPR_ADD, x, half, 0);
    CHECK_EQ_INT(a, expr_operation(&graph, EXPR_ADD, x, half, 17));
    CHECK(a != expr_operation(&graph, EXPR_ADD, half, x, 0)); /* which NaN comes out may differ */
    CHECK_EQ_INT(expr_operation(&graph, EXPR_ADD, half, half, 0), expr_float(&graph, 1));
    CHECK_EQ_INT(expr_operation(&graph, EXPR_MULTIPLY, expr_float(&graph, 1), x, 0), x);
    CHECK_EQ_INT(expr_operation(&graph, EXPR_SUBTRACT, x, expr_float(&graph, 0), 0), x);
    CHECK(expr_operation(&graph, EXPR_ADD, x, expr_float(&graph, 0), 0) != x); /* of -0 it is 0 */
    uint32_t less = expr_operation(&graph, EXPR_LESS, x, half, 0);
    CHECK_EQ_INT(expr_operation(&graph, EXPR_SELECT, less, a, a), a);
    CHECK_EQ_INT(expr_operation(&graph, EXPR_SELECT, expr_truth(&graph, false), a, x), x);
    CHECK(expr_float(&graph, 0.0) != expr_float(&graph, -0.0));
    CHECK_EQ_INT(expr_float(&graph, from_bits(0x7ff8000000000001)), expr_float(&graph, -from_bits(0x7ff8000000000002)));
    expr_graph_destroy(&graph);
}

TEST(a_graph_ends_at_its_limit_of_operations) {
    struct expr_graph graph = {.count = 0};
    uint32_t x = expr_input(&graph, EXPR_POINT_X), last = x;
    for (uint32_t i = 0; i < EXPR_NODES + 5; i++)
        last = expr_operation(&graph, EXPR_MULTIPLY, last, x, 0);
    CHECK(last == EXPR_NONE && graph.full && graph.count == EXPR_NODES);
    CHECK(expr_operation(&graph, EXPR_ADD, last, x, 0) == EXPR_NONE);
    expr_graph_destroy(&graph);
}

TEST(registers_are_used_again) {
    struct expr_graph graph = {.count = 0};
    struct arena arena = {0};
    struct error error = {0};
    struct expr_program program;
    double in[EXPR_INPUT_COUNT] = {3}, out[EXPR_OUTPUTS];
    uint32_t x = expr_input(&graph, EXPR_POINT_X), sum = x;
    for (int i = 1; i <= 1000; i++)
        sum = expr_operation(&graph, EXPR_ADD, sum,
                             expr_operation(&graph, EXPR_MULTIPLY, x, expr_float(&graph, (double)i), 0), 0);
    CHECK(expr_compile(&graph, &sum, 1, &arena, &program, &error));
    CHECK(program.register_count <= 3);
    CHECK_EQ_INT(program.count, 1999); /* x * 1 is x */
    expr_evaluate(&program, in, out);
    CHECK_NEAR(out[0], 3 + 3 * 500500, 0);
    arena_destroy(&arena);
    expr_graph_destroy(&graph);
}

TEST(a_program_with_too_many_values_is_refused) {
    struct expr_graph graph = {.count = 0};
    struct arena arena = {0};
    struct error error = {0};
    struct expr_program program;
    uint32_t x = expr_input(&graph, EXPR_POINT_X), terms[9000], sum = x;
    for (int i = 0; i < 9000; i++)
        terms[i] = expr_operation(&graph, EXPR_MULTIPLY, x, expr_float(&graph, (double)i + 0.5), 0);
    for (int i = 0; i < 9000; i++)
        sum = expr_operation(&graph, EXPR_ADD, sum, terms[i], 0);
    CHECK(!expr_compile(&graph, &sum, 1, &arena, &program, &error));
    CHECK_TEXT(error.text, "the function needs more than 8192 constants and values at once");
    arena_destroy(&arena);
    expr_graph_destroy(&graph);
}

TEST(an_output_may_be_a_constant_or_an_input) {
    struct expr_graph graph = {.count = 0};
    struct arena arena = {0};
    struct error error = {0};
    struct expr_program program;
    uint32_t outputs[3] = {expr_float(&graph, 0.25), expr_input(&graph, EXPR_TIME), expr_input(&graph, EXPR_TIME)};
    double in[EXPR_INPUT_COUNT] = {0}, out[EXPR_OUTPUTS], batch[2] = {1, 2}, results[3][2];
    const double *ins[EXPR_INPUT_COUNT] = {[EXPR_TIME] = batch};
    double *outs[EXPR_OUTPUTS] = {results[0], results[1], results[2], NULL};
    in[EXPR_TIME] = 7;
    CHECK(expr_compile(&graph, outputs, 3, &arena, &program, &error));
    expr_evaluate(&program, in, out);
    CHECK(out[0] == 0.25 && out[1] == 7 && out[2] == 7);
    void *rows = mem_alloc_aligned(64, expr_batch_size(&program));
    expr_evaluate_batch(&program, 2, ins, outs, rows);
    CHECK(results[0][1] == 0.25 && results[1][0] == 1 && results[2][1] == 2);
    mem_free(rows);
    arena_destroy(&arena);
    expr_graph_destroy(&graph);
}

TEST(distances_of_cells_change_by_no_more_than_the_point_moves) {
    struct test_random random = {5};
    for (int i = 0; i < 3000; i++) {
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = test_uniform(&random, -4, 4);
        struct noise_cells cells = noise_cells(p[0], p[1], p[2]), moved;
        CHECK(cells.nearest <= cells.second && cells.second < 2 && cells.id >= 0 && cells.id < 1);
        /* Distances change by no more than the point moves, also across the borders of cells. */
        double step = test_uniform(&random, 0, 0.3);
        moved = noise_cells(p[0] + step, p[1], p[2]);
        CHECK(fabs(moved.nearest - cells.nearest) <= step + 1e-12);
        CHECK(fabs(moved.second - cells.second) <= step + 1e-12);
    }
    CHECK(noise_cells((double)INFINITY, 0, 0).nearest == 0);
    CHECK(noise_hash(0.0, 1, 2) == noise_hash(-0.0, 1, 2) && noise_hash(0, 1, 2) != noise_hash(1, 0, 2));
    /* The bits of a NaN depend on the compiler and the instruction set. */
    CHECK(noise_hash((double)NAN, 1, 2) == noise_hash(-(double)NAN, 1, 2));
    CHECK(noise_hash(1, copysign(NAN, -1), 2) == noise_hash(1, from_bits(UINT64_C(0x7ff8000000000005)), 2));
}
