/* Any bytes as an expression: four bytes are an operation on nodes that exist, of the types that it takes, or a loop;
 * in the folded graph the steps of a loop follow each other. Its program gives the same bits at one point, in a batch
 * of every instruction set, and where the inputs are constants and the graph folds to one. */
#include "base/isa.h"
#include "base/mem.h"
#include "expr/expr_program.h"
#include "math/exact.h"

#include <stdlib.h>

enum { FUZZ_NODES = 4096 };

/* Nodes by type, the newest last; each list begins with one that is always there. */
struct nodes {
    struct expr_graph graph;
    uint32_t of_type[3][FUZZ_NODES];
    uint32_t count[3];
};

static const double inputs[EXPR_INPUT_COUNT] = {1.5,   -0.0, 1e300, 0.25, 3, -1, 0x1p62, 1e-310,
                                                -7.75, 100,  2,     0,    4, 5,  6};

static void add_node(struct nodes *nodes, uint32_t node) {
    enum expr_type type = nodes->graph.nodes[node].type;
    if (nodes->count[type] < FUZZ_NODES)
        nodes->of_type[type][nodes->count[type]++] = node;
}

/* A picture that repeats. */
static const struct image_function *fuzz_picture(void) {
    static struct image_function function;
    static const uint8_t texels[3][2][4] = {
        {{255, 0, 7, 255}, {1, 2, 3, 4}}, {{0, 0, 0, 0}, {9, 99, 199, 128}}, {{255, 255, 255, 255}, {0, 0, 0, 255}}};
    struct error error = {0};
    if (!function.image)
        function = (struct image_function){.image = image_create("fuzz.png", 2, 3, 8, texels, &error),
                                           .sampling = {IMAGE_BILINEAR, IMAGE_REPEAT, IMAGE_REPEAT},
                                           .scale = {1, 1},
                                           .tint = {1, 1, 1}};
    if (!function.image)
        exit(0);
    return &function;
}

/* A step of a loop of a float and an integer: operations that the bytes name, on the states and on what is outside. */
static void add_step(struct nodes *nodes, const uint8_t bytes[4], uint32_t step, const uint32_t in[2],
                     uint32_t out[2]) {
    static const enum expr_operation of_floats[] = {EXPR_ADD, EXPR_MULTIPLY, EXPR_MODULO, EXPR_SUBTRACT,
                                                    EXPR_MIN, EXPR_POWER,    EXPR_ATAN,   EXPR_DIVIDE};
    static const enum expr_operation of_integers[] = {EXPR_INTEGER_ADD, EXPR_INTEGER_MULTIPLY, EXPR_BIT_XOR,
                                                      EXPR_SHIFT_LEFT};
    struct expr_graph *graph = &nodes->graph;
    uint32_t outside = nodes->of_type[EXPR_TYPE_F][bytes[1] % nodes->count[EXPR_TYPE_F]];
    uint32_t whole = expr_operation(graph, EXPR_TO_FLOAT, in[1], EXPR_NONE, EXPR_NONE);
    uint32_t moved = expr_operation(graph, of_floats[bytes[2] % 8], in[0], outside, EXPR_NONE);
    uint32_t condition = expr_operation(graph, EXPR_LESS, whole, moved, EXPR_NONE);
    out[0] = bytes[2] & 64 ? expr_operation(graph, EXPR_SELECT, condition, moved, whole) : moved;
    out[1] = expr_operation(graph, of_integers[bytes[2] >> 3 & 3], in[1], step, EXPR_NONE);
}

static void add_loop(struct nodes *nodes, const uint8_t bytes[4], bool folded) {
    struct expr_graph *graph = &nodes->graph;
    const uint32_t last = 1 + bytes[3] % 20, zero = expr_float(graph, 0);
    const bool ends = bytes[2] & 128;
    uint32_t state[2] = {nodes->of_type[EXPR_TYPE_F][nodes->count[EXPR_TYPE_F] - 1],
                         nodes->of_type[EXPR_TYPE_I][nodes->count[EXPR_TYPE_I] - 1]},
             next[2];
    for (uint32_t i = 1; folded && i <= last; i++) {
        uint32_t alive = expr_operation(graph, EXPR_LESS, zero, state[0], EXPR_NONE);
        add_step(nodes, bytes, expr_integer(graph, i), state, next);
        bool is_checked = ends && i > 1;
        state[0] = is_checked ? expr_operation(graph, EXPR_SELECT, alive, next[0], state[0]) : next[0];
        state[1] = is_checked ? expr_operation(graph, EXPR_INTEGER_SELECT, alive, next[1], state[1]) : next[1];
    }
    if (!folded) {
        const uint32_t symbols[2] = {expr_symbol(graph, 1, 1, EXPR_TYPE_F), expr_symbol(graph, 1, 2, EXPR_TYPE_I)};
        add_step(nodes, bytes, expr_symbol(graph, 1, 0, EXPR_TYPE_I), symbols, next);
        const struct expr_graph_loop loop = {
            .first = 1, .last = last, .depth = 1, .state_count = 2, .initial = state, .next = next, .ends = ends};
        if (!expr_loop(graph, &loop, state))
            exit(0);
    }
    add_node(nodes, state[0]);
    add_node(nodes, state[1]);
}

static uint32_t build(struct nodes *nodes, const uint8_t *data, size_t size, bool folded) {
    struct expr_graph *graph = &nodes->graph;
    for (int k = 0; k < EXPR_INPUT_COUNT; k++)
        add_node(nodes, folded ? expr_float(graph, inputs[k]) : expr_input(graph, (enum expr_input)k));
    add_node(nodes, expr_integer(graph, INT64_MIN));
    add_node(nodes, expr_integer(graph, 3));
    add_node(nodes, expr_truth(graph, true));
    for (; size >= 4; data += 4, size -= 4) {
        if (data[0] >= 248) {
            add_loop(nodes, data, folded);
            continue;
        }
        enum expr_operation operation =
            (enum expr_operation)(EXPR_INPUT + 1 + data[0] % (EXPR_OPERATION_COUNT - EXPR_INPUT - 1));
        uint32_t operands[3] = {EXPR_NONE, EXPR_NONE, EXPR_NONE};
        for (int k = 0; k < expr_operand_count(operation); k++) {
            if (operation == EXPR_TEXEL && k == 2) {
                operands[k] = expr_integer(graph, expr_texel_operand(fuzz_picture(), data[3] % TEXEL_CHANNELS));
                continue;
            }
            enum expr_type type = expr_operand_type(operation, k);
            operands[k] = nodes->of_type[type][nodes->count[type] - 1 - data[1 + k] % nodes->count[type]];
        }
        add_node(nodes, expr_operation(graph, operation, operands[0], operands[1], operands[2]));
    }
    return nodes->of_type[EXPR_TYPE_F][nodes->count[EXPR_TYPE_F] - 1];
}

static void check_same(double a, double b) {
    if (to_bits(a) != to_bits(b) && (a == a || b == b))
        abort();
}

static void check_program(const struct expr_program *program, double wanted) {
    static const char *const sets[] = {"base", "avx2", "avx512"};
    double one[EXPR_OUTPUTS], columns[EXPR_INPUT_COUNT][EXPR_BATCH], results[EXPR_BATCH];
    const double *in[EXPR_INPUT_COUNT];
    double *out[EXPR_OUTPUTS] = {results, NULL, NULL, NULL};
    expr_evaluate(program, inputs, one);
    check_same(one[0], wanted);
    for (int k = 0; k < EXPR_INPUT_COUNT; k++) {
        for (int i = 0; i < EXPR_BATCH; i++)
            columns[k][i] = inputs[k];
        in[k] = columns[k];
    }
    void *rows = mem_alloc_aligned(64, expr_batch_size(program));
    for (size_t set = 0; rows && set < sizeof sets / sizeof sets[0]; set++) {
        if (!cpu_select_isa(sets[set]))
            continue;
        expr_evaluate_batch(program, EXPR_BATCH - 1, in, out, rows);
        for (int i = 0; i < EXPR_BATCH - 1; i++)
            check_same(results[i], wanted);
    }
    mem_free(rows);
    (void)cpu_select_isa("auto");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The two graphs differ in shape as soon as one folds, so the folded one is built with the choices of the other: both
 * have a node for each operation, in the same order of the same types. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static struct nodes recorded, folded;
    struct arena arena = {0};
    struct error error = {0};
    struct expr_program program;
    recorded = folded = (struct nodes){.count = {0, 0, 0}};
    size = size > 4 * (FUZZ_NODES - 64) ? 4 * (FUZZ_NODES - 64) : size;
    uint32_t result = build(&recorded, data, size, false), constant = build(&folded, data, size, true);
    const union expr_value *wanted = expr_constant(&folded.graph, constant);
    if (!wanted)
        abort();
    if (expr_compile(&recorded.graph, &result, 1, &arena, &program, &error))
        check_program(&program, wanted->f);
    arena_destroy(&arena);
    expr_graph_destroy(&recorded.graph);
    expr_graph_destroy(&folded.graph);
    return 0;
}
