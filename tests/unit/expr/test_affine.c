/* Bounds by affine forms. */
#include "expr/expr_affine.h"
#include "tests/harness.h"
#include "tests/unit/function_makers.h"

#include <math.h>
#include <stdlib.h>

static struct expr_affine random_form(struct test_random *random, double size) {
    return (struct expr_affine){test_uniform(random, -1, 1),
                                {test_uniform(random, -size, size), test_uniform(random, -size, size)},
                                test_uniform(random, 0, size / 2)};
}

TEST_TIMES(affine_bounds_hold_every_value, 30) {
    struct test_random random = {31};
    for (int i = 0; i < 200 * times; i++) {
        struct arena arena = {0};
        struct function_maker m;
        function_begin(&m);
        const struct expr_program *program = function_end(&m, fn_random(&m, &random, i), &arena);
        void *rows = malloc(expr_affine_size(program));
        struct expr_affine inputs[EXPR_INPUT_COUNT] = {{0}};
        struct expr_interval out[EXPR_OUTPUTS];
        for (int k = 0; k < 3; k++)
            inputs[k] = random_form(&random, pow(10, test_uniform(&random, -5, 0)));
        expr_evaluate_affine(program, inputs, out, rows);
        for (int n = 0; n < 50; n++) {
            double at[EXPR_INPUT_COUNT] = {0}, value[EXPR_OUTPUTS];
            double a = test_uniform(&random, -1, 1), b = test_uniform(&random, -1, 1);
            for (int k = 0; k < 3; k++)
                at[k] = inputs[k].middle + inputs[k].slopes[0] * a + inputs[k].slopes[1] * b +
                        inputs[k].rest * test_uniform(&random, -1, 1);
            expr_evaluate(program, at, value);
            CHECK(isnan(value[0]) || (value[0] >= out[0].low && value[0] <= out[0].high));
        }
        free(rows);
        arena_destroy(&arena);
    }
}

/* On an arc about the direction of a constant vector, the product with it is 1 within the square of the angle; its
 * interval is as wide as the angle. */
TEST(affine_bounds_of_a_direction_times_a_vector_have_a_quadratic_error) {
    struct arena arena = {0};
    struct function_maker m;
    function_begin(&m);
    uint32_t dot = fn_add(&m, fn_scaled(&m, 0.6, m.p[0]), fn_scaled(&m, 0.8, m.p[1]));
    const struct expr_program *program = function_end(&m, dot, &arena);
    void *rows = malloc(expr_affine_size(program));
    for (double angle = 0.1; angle > 1e-5; angle /= 10) {
        struct expr_affine inputs[EXPR_INPUT_COUNT] = {{0.6, {-0.8 * angle, 0}, angle * angle},
                                                       {0.8, {0.6 * angle, 0}, angle * angle}};
        struct expr_interval out[EXPR_OUTPUTS];
        expr_evaluate_affine(program, inputs, out, rows);
        CHECK(out[0].low <= cos(angle) && out[0].high >= 1);
        CHECK(out[0].high - out[0].low < 3 * angle * angle + 1e-14);
    }
    free(rows);
    arena_destroy(&arena);
}
