/* Functions of a point as programs, for tests of implicit solids: simple ones with closed forms, and random ones with
 * everything that a script can do. They fit the box from -1 to 1. */
#ifndef GRAY_TESTS_FUNCTION_MAKERS_H
#define GRAY_TESTS_FUNCTION_MAKERS_H

#include "expr/expr_program.h"
#include "math/vec3.h"
#include "tests/harness.h"

/* A graph, and the nodes of the point. */
struct function_maker {
    struct expr_graph graph;
    uint32_t p[3];
};

static inline void function_begin(struct function_maker *maker) {
    *maker = (struct function_maker){.graph = {.count = 0}};
    for (int k = 0; k < 3; k++)
        maker->p[k] = expr_input(&maker->graph, (enum expr_input)(EXPR_POINT_X + k));
}

/* The program of a node; the graph is destroyed. */
static inline const struct expr_program *function_end(struct function_maker *maker, uint32_t node,
                                                      struct arena *arena) {
    struct expr_program *program = arena_alloc(arena, sizeof *program);
    struct error error = {0};
    if (!program || !expr_compile(&maker->graph, &node, 1, arena, program, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    expr_graph_destroy(&maker->graph);
    return program;
}

static inline uint32_t fn_number(struct function_maker *m, double x) {
    return expr_float(&m->graph, x);
}
static inline uint32_t fn_of(struct function_maker *m, enum expr_operation operation, uint32_t a) {
    return expr_operation(&m->graph, operation, a, EXPR_NONE, EXPR_NONE);
}
static inline uint32_t fn_two(struct function_maker *m, enum expr_operation operation, uint32_t a, uint32_t b) {
    return expr_operation(&m->graph, operation, a, b, EXPR_NONE);
}
static inline uint32_t fn_add(struct function_maker *m, uint32_t a, uint32_t b) {
    return fn_two(m, EXPR_ADD, a, b);
}
static inline uint32_t fn_sub(struct function_maker *m, uint32_t a, uint32_t b) {
    return fn_two(m, EXPR_SUBTRACT, a, b);
}
static inline uint32_t fn_mul(struct function_maker *m, uint32_t a, uint32_t b) {
    return fn_two(m, EXPR_MULTIPLY, a, b);
}
static inline uint32_t fn_scaled(struct function_maker *m, double factor, uint32_t a) {
    return fn_mul(m, fn_number(m, factor), a);
}
static inline uint32_t fn_less(struct function_maker *m, uint32_t a, double by) {
    return fn_sub(m, a, fn_number(m, by));
}
static inline uint32_t fn_square(struct function_maker *m, uint32_t a) {
    return fn_mul(m, a, a);
}
static inline uint32_t fn_hypot(struct function_maker *m, uint32_t a, uint32_t b) {
    return fn_of(m, EXPR_SQRT, fn_add(m, fn_square(m, a), fn_square(m, b)));
}

/* Squares, less that of the radius; or distances. */
static inline uint32_t fn_ball(struct function_maker *m, struct vec3 centre, double radius, bool is_distance) {
    uint32_t sum = EXPR_NONE;
    for (int k = 0; k < 3; k++) {
        uint32_t square = fn_square(m, fn_less(m, m->p[k], vec3_get(centre, k)));
        sum = k ? fn_add(m, sum, square) : square;
    }
    return is_distance ? fn_less(m, fn_of(m, EXPR_SQRT, sum), radius) : fn_less(m, sum, radius * radius);
}

static inline uint32_t fn_torus(struct function_maker *m, double major, double minor) {
    return fn_less(m, fn_hypot(m, fn_less(m, fn_hypot(m, m->p[0], m->p[2]), major), m->p[1]), minor);
}

/* |sin kx cos ky + sin ky cos kz + sin kz cos kx| - thickness. */
static inline uint32_t fn_gyroid(struct function_maker *m, double k, double thickness) {
    uint32_t sum = EXPR_NONE;
    for (int i = 0; i < 3; i++) {
        uint32_t a = fn_of(m, EXPR_SIN, fn_scaled(m, k, m->p[i]));
        uint32_t b = fn_of(m, EXPR_COS, fn_scaled(m, k, m->p[(i + 1) % 3]));
        sum = i ? fn_add(m, sum, fn_mul(m, a, b)) : fn_mul(m, a, b);
    }
    return fn_less(m, fn_of(m, EXPR_ABS, sum), thickness);
}

static inline uint32_t fn_box(struct function_maker *m, double half) {
    uint32_t outer = EXPR_NONE, inner = EXPR_NONE, zero = fn_number(m, 0);
    for (int k = 0; k < 3; k++) {
        uint32_t q = fn_less(m, fn_of(m, EXPR_ABS, m->p[k]), half * (1 - 0.2 * k));
        uint32_t square = fn_square(m, fn_two(m, EXPR_MAX, q, zero));
        outer = k ? fn_add(m, outer, square) : square;
        inner = k ? fn_two(m, EXPR_MAX, inner, q) : q;
    }
    return fn_add(m, fn_of(m, EXPR_SQRT, outer), fn_two(m, EXPR_MIN, inner, zero));
}

enum { FUNCTION_KINDS = 16 };

/* One of the kinds with random numbers. */
static inline uint32_t fn_random_leaf(struct function_maker *m, struct test_random *random, int kind) {
    double a = test_uniform(random, 0.2, 0.6), b = test_uniform(random, 1, 3);
    struct vec3 centre = {test_uniform(random, -0.5, 0.5), test_uniform(random, -0.5, 0.5),
                          test_uniform(random, -0.5, 0.5)};
    uint32_t x = m->p[0], y = m->p[1], z = m->p[2], saved[3] = {x, y, z}, out = x;
    switch (kind % FUNCTION_KINDS) {
    case 0:
        return fn_ball(m, centre, a, true);
    case 1:
        return fn_torus(m, 0.3 + a / 2, a / 3);
    case 2:
        return fn_box(m, a);
    case 3:
        return fn_gyroid(m, 3 * b, 0.4 * a);
    case 4: /* noise */
        return fn_less(
            m, expr_operation(&m->graph, EXPR_NOISE, fn_scaled(m, b, x), fn_scaled(m, b, y), fn_scaled(m, b, z)),
            a - 0.4);
    case 5: /* cells */
        return fn_less(
            m, expr_operation(&m->graph, EXPR_CELL_NEAREST, fn_scaled(m, b, x), fn_scaled(m, b, y), fn_scaled(m, b, z)),
            a);
    case 6: /* ripples */
        return fn_sub(m, y,
                      fn_scaled(m, 0.2,
                                fn_mul(m, fn_of(m, EXPR_SIN, fn_scaled(m, 4 * b, x)),
                                       fn_of(m, EXPR_COS, fn_scaled(m, 3 * b, z)))));
    case 7: /* tanglecube */
        out = fn_number(m, a - 0.2);
        for (int k = 0; k < 3; k++) {
            uint32_t square = fn_square(m, fn_scaled(m, 2.4, m->p[k]));
            out = fn_add(m, out, fn_mul(m, square, fn_less(m, square, 5)));
        }
        return fn_add(m, out, fn_number(m, 11.8));
    case 8: /* metaballs */
        out = fn_number(m, a);
        for (int k = 0; k < 3; k++) {
            struct vec3 at = {k == 0 ? 0.5 : -0.2, k == 1 ? 0.4 : -0.1, centre.z};
            out = fn_sub(m, out, fn_of(m, EXPR_EXP, fn_scaled(m, -6 * b, fn_ball(m, at, 0, false))));
        }
        return out;
    case 9: /* steps */
        return fn_add(m, y, fn_scaled(m, 0.3, fn_of(m, EXPR_FLOOR, fn_scaled(m, b, x))));
    case 10: /* NaN at x < centre.x / 2 */
        return fn_add(m, fn_of(m, EXPR_SQRT, fn_less(m, x, centre.x / 2)), fn_less(m, fn_square(m, y), a * a + 0.3));
    case 11: /* a thin shell */
        return fn_less(m, fn_of(m, EXPR_ABS, fn_ball(m, centre, a + 0.2, true)), 1e-4);
    case 12: /* a twisted box */
    {
        uint32_t angle = fn_scaled(m, b, y), c = fn_of(m, EXPR_COS, angle), s = fn_of(m, EXPR_SIN, angle);
        m->p[0] = fn_add(m, fn_mul(m, c, x), fn_mul(m, s, z));
        m->p[2] = fn_sub(m, fn_mul(m, c, z), fn_mul(m, s, x));
        out = fn_box(m, a);
        break;
    }
    case 13: /* copies of a ball */
        for (int k = 0; k < 3; k++)
            m->p[k] = fn_less(m, fn_two(m, EXPR_MODULO, saved[k], fn_number(m, 0.5)), 0.25);
        out = fn_ball(m, vec3_all(0), 0.1 + a / 6, false);
        break;
    case 14: /* quotients and angles */
        return fn_sub(m, fn_hypot(m, x, z),
                      fn_add(m, fn_number(m, 0.5),
                             fn_scaled(m, 0.2, fn_of(m, EXPR_SIN, fn_scaled(m, 5, fn_two(m, EXPR_ATAN, z, x))))));
    default: /* a cone by powers */
        return fn_sub(m, fn_two(m, EXPR_POWER, fn_add(m, fn_square(m, x), fn_square(m, z)), fn_number(m, 0.7)),
                      fn_scaled(m, a, fn_less(m, y, -0.8)));
    }
    for (int k = 0; k < 3; k++)
        m->p[k] = saved[k];
    return out;
}

/* Function `number`: the kinds themselves first, then pairs of them joined. */
static inline uint32_t fn_random(struct function_maker *m, struct test_random *random, int number) {
    uint32_t a = fn_random_leaf(m, random, number);
    if (number < FUNCTION_KINDS)
        return a;
    uint32_t b = fn_random_leaf(m, random, (int)test_uniform(random, 0, FUNCTION_KINDS - 0.01));
    switch (number % 5) {
    case 0:
        return fn_two(m, EXPR_MIN, a, b);
    case 1:
        return fn_two(m, EXPR_MAX, a, b);
    case 2:
        return fn_two(m, EXPR_MAX, a, fn_of(m, EXPR_NEGATE, b));
    case 3: /* a smooth union */
    {
        uint32_t h = fn_sub(m, fn_number(m, 1), fn_scaled(m, 5, fn_of(m, EXPR_ABS, fn_sub(m, a, b))));
        h = fn_square(m, fn_two(m, EXPR_MAX, h, fn_number(m, 0)));
        return fn_sub(m, fn_two(m, EXPR_MIN, a, b), fn_scaled(m, 0.05, h));
    }
    default: /* one where x > 0, the other elsewhere: a jump */
        return expr_operation(&m->graph, EXPR_SELECT, fn_two(m, EXPR_LESS, fn_number(m, 0), m->p[0]), a, b);
    }
}

#endif
