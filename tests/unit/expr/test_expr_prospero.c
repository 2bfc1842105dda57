/* A picture by bounds and shortened programs, against the whole program at every pixel. */
#include "base/isa.h"
#include "bench/prospero.h"
#include "tests/harness.h"

#include <math.h>

enum { SIZE = 256 };

/* The pixels whose sign is not that of the whole program. */
static int wrong_pixels(const struct expr_program *program, struct prospero *p) {
    int wrong = 0;
    for (int y = 0; y < SIZE; y++) {
        for (int x0 = 0; x0 < SIZE; x0 += EXPR_BATCH) {
            double x[EXPR_BATCH], y_all[EXPR_BATCH], value[EXPR_BATCH];
            const double *in[EXPR_INPUT_COUNT] = {x, y_all};
            double *out[EXPR_OUTPUTS] = {value};
            for (int i = 0; i < EXPR_BATCH; i++) {
                x[i] = p->at[x0 + i];
                y_all[i] = -p->at[y];
            }
            expr_evaluate_batch(program, EXPR_BATCH, in, out, p->rows);
            for (int i = 0; i < EXPR_BATCH; i++)
                wrong += p->image[y * SIZE + x0 + i] != (value[i] < 0 ? 255 : 0);
        }
    }
    return wrong;
}

static void check_picture(struct expr_graph *graph, uint32_t root, int *inside) {
    struct arena arena = {0};
    struct error error = {0};
    struct expr_program program;
    struct prospero p;
    CHECK(expr_compile(graph, &root, 1, &arena, &program, &error));
    CHECK(prospero_init(&p, &program, SIZE));
    memset(p.image, 7, SIZE * SIZE);
    prospero_render(&p, &program);
    CHECK_EQ_INT(wrong_pixels(&program, &p), 0);
    CHECK_EQ_INT(p.stack.free, PROSPERO_CODE);
    for (int i = 0; i < SIZE * SIZE; i++)
        *inside += p.image[i] == 255;
    prospero_destroy(&p);
    arena_destroy(&arena);
}

TEST(a_picture_by_bounds_and_shortened_programs_is_that_of_the_whole_program) {
    static const char *const sets[] = {"base", "avx2", "avx512"};
    struct expr_graph graph = {.count = 0};
    uint32_t root;
    bool is_there = prospero_read("../shared/models/prospero.vm", &graph, &root);
    if (!is_there) {
        expr_graph_destroy(&graph);
        test_skip("../shared/models is not there");
    }
    for (size_t set = 0; set < sizeof sets / sizeof sets[0]; set++) {
        int inside = 0;
        if (!cpu_select_isa(sets[set]))
            continue;
        check_picture(&graph, root, &inside);
        CHECK(inside > SIZE * SIZE / 10 && inside < SIZE * SIZE / 6); /* letters */
    }
    CHECK(cpu_select_isa("auto"));
    expr_graph_destroy(&graph);
}

/* Circles, half of them holes, so that the test does not need a file. */
TEST(a_picture_of_circles_by_bounds_is_that_of_the_whole_program) {
    struct expr_graph graph = {.count = 0};
    uint32_t x = expr_input(&graph, EXPR_POINT_X), y = expr_input(&graph, EXPR_POINT_Y);
    uint32_t value = expr_float(&graph, 1);
    int inside = 0;
    for (int i = 0; i < 40; i++) {
        uint32_t dx = expr_operation(&graph, EXPR_SUBTRACT, x, expr_float(&graph, sin(i * 1.7) * 0.9), EXPR_NONE);
        uint32_t dy = expr_operation(&graph, EXPR_SUBTRACT, y, expr_float(&graph, cos(i * 2.3) * 0.9), EXPR_NONE);
        uint32_t square = expr_operation(&graph, EXPR_ADD, expr_operation(&graph, EXPR_MULTIPLY, dx, dx, EXPR_NONE),
                                         expr_operation(&graph, EXPR_MULTIPLY, dy, dy, EXPR_NONE), EXPR_NONE);
        uint32_t circle = expr_operation(&graph, EXPR_SUBTRACT, square, expr_float(&graph, 0.02), EXPR_NONE);
        value = i % 2 ? expr_operation(&graph, EXPR_MAX, value,
                                       expr_operation(&graph, EXPR_NEGATE, circle, EXPR_NONE, EXPR_NONE), EXPR_NONE)
                      : expr_operation(&graph, EXPR_MIN, value, circle, EXPR_NONE);
    }
    check_picture(&graph, value, &inside);
    CHECK(inside > SIZE * SIZE / 10);
    expr_graph_destroy(&graph);
}
