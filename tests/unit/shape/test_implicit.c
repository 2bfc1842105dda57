/* Implicit solids against the analytic shapes, and against their own functions along the line. */
#include "tests/harness.h"

#include "csg/geometry.h"
#include "math/elementary.h"
#include "shape/implicit_internal.h"
#include "shape/shape.h"
#include "tests/unit/function_makers.h"
#include "tests/unit/swept_makers.h"

#include <math.h>
#include <stdlib.h>

static struct shape implicit_shape(struct arena *arena, const struct implicit_input *in) {
    struct error error = {0};
    struct shape shape = {.kind = SHAPE_IMPLICIT, .implicit = implicit_build(arena, in, &error)};
    if (!shape.implicit)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return shape;
}

static const struct box unit = {{-1, -1, -1}, {1, 1, 1}};

static struct ray random_ray(struct test_random *random) {
    struct vec3 origin = random_vec3(random, test_uniform(random, 0, 1) < 0.3 ? 0.7 : 5);
    return ray_from(origin, vec3_scale(vec3_sub(random_vec3(random, 0.9), origin), test_uniform(random, 0.2, 4)));
}

/* --- beside the analytic shapes --- */

enum { LIST = 64 };
/* Units of length: the size is 2. Pairs closer than that may be missing. */
static const double pair = 2e-7, near = 2e-9;

struct list {
    struct crossing items[LIST];
    uint32_t count;
};

/* The crossings, without pairs that may be missing. */
static void read_list(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch,
                      struct list *out) {
    struct crossing_list all;
    double length = vec3_length(ray->direction);
    CHECK(shape_crossings(shape, ray, scratch, &all) && all.count < LIST);
    out->count = 0;
    for (uint32_t k = 0; k < all.count; k++) {
        const struct crossing *next = &scratch->items[all.first + k];
        if (out->count > 0 && (next->t - out->items[out->count - 1].t) * length < pair)
            out->count--;
        else
            out->items[out->count++] = *next;
    }
    scratch->used = all.first;
}

/* How many rays see other crossings of both. */
static long differences(const struct shape *a, const struct shape *b, long rays, uint64_t seed) {
    struct test_random random = {seed};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 1000));
    long wrong = 0, found = 0;
    for (long i = 0; i < rays; i++) {
        struct ray ray = random_ray(&random);
        struct list of_a, of_b;
        read_list(a, &ray, &scratch, &of_a);
        read_list(b, &ray, &scratch, &of_b);
        bool same = of_a.count == of_b.count;
        for (uint32_t k = 0; same && k < of_a.count; k++) {
            struct surface surface, other;
            shape_describe(b, &ray, &of_b.items[k], &surface);
            shape_describe(a, &ray, &of_a.items[k], &other);
            double along = (of_a.items[k].t - of_b.items[k].t) * vec3_length(ray.direction);
            double cosine = fabs(vec3_dot(vec3_normalize(surface.normal), vec3_normalize(ray.direction)));
            same = of_a.items[k].enter == of_b.items[k].enter && fabs(along) * cosine + along * along * 5 < near;
            bool is_edge = vec3_length(vec3_sub(surface.point, other.point)) > 1e-7; /* another face of it */
            same = same && (is_edge || cosine < 1e-3 ||
                            vec3_dot(vec3_normalize(surface.normal), vec3_normalize(other.normal)) > 1 - 1e-7);
            found++;
        }
        wrong += !same;
    }
    geom_scratch_destroy(&scratch);
    CHECK(found > rays / 20);
    return wrong;
}

static void compare_with_shapes(long rays) {
    struct test_random random = {3};
    struct arena arena = {0};
    for (int i = 0; i < 8; i++) {
        struct vec3 centre = random_vec3(&random, 0.4);
        double radius = test_uniform(&random, 0.2, 0.55), minor = test_uniform(&random, 0.05, 0.3);
        struct function_maker m;
        function_begin(&m);
        struct implicit_input in = {.program = function_end(&m, fn_ball(&m, centre, radius, i % 2), &arena),
                                    .bounds = unit};
        struct shape a = implicit_shape(&arena, &in);
        struct shape b = {.kind = SHAPE_SPHERE, .sphere = {centre, radius}};
        CHECK_EQ_INT(differences(&a, &b, rays / 32, 10 + (uint64_t)i), 0);

        function_begin(&m);
        in.program = function_end(&m, fn_torus(&m, 0.6, minor), &arena);
        a = implicit_shape(&arena, &in);
        b = (struct shape){.kind = SHAPE_TORUS, .torus = {0.6, minor}};
        CHECK_EQ_INT(differences(&a, &b, rays / 32, 20 + (uint64_t)i), 0);

        /* The caps of a cylinder are those of the bounds. */
        function_begin(&m);
        uint32_t squares = fn_add(&m, fn_square(&m, m.p[0]), fn_square(&m, m.p[2]));
        in.program = function_end(&m, fn_less(&m, squares, radius * radius), &arena);
        in.bounds = (struct box){{-1, -minor, -1}, {1, radius, 1}};
        in.open = i % 2;
        a = implicit_shape(&arena, &in);
        b = (struct shape){.kind = SHAPE_REVOLVED_QUADRIC,
                           .revolved_quadric = revolved_quadric_cylinder((struct vec3){0, -minor, 0},
                                                                         (struct vec3){0, radius, 0}, radius, in.open)};
        CHECK_EQ_INT(differences(&a, &b, rays / 32, 30 + (uint64_t)i), 0);

        /* A function that is below 0 everywhere is its bounds. */
        function_begin(&m);
        in.program = function_end(&m, fn_less(&m, fn_of(&m, EXPR_SIN, m.p[1]), 2), &arena);
        in = (struct implicit_input){.program = in.program, .is_ball = true, .centre = centre, .radius = radius};
        if (i % 2)
            in = (struct implicit_input){.program = in.program, .bounds = {{-0.5, -1, -0.2}, {0.5, 0.3, 0.7}}};
        a = implicit_shape(&arena, &in);
        b = (struct shape){.kind = SHAPE_SPHERE, .sphere = {centre, radius}};
        if (i % 2)
            b = (struct shape){.kind = SHAPE_BOX, .box = in.bounds};
        CHECK_EQ_INT(differences(&a, &b, rays / 32, 40 + (uint64_t)i), 0);
    }
    arena_destroy(&arena);
}

TEST(implicit_balls_rings_cylinders_and_bounds_are_crossed_as_the_analytic_shapes) {
    compare_with_shapes(10000);
}

TEST_LONG(implicit_shapes_are_the_analytic_ones_on_a_million_rays) {
    compare_with_shapes(1000000);
}

TEST(an_implicit_half_space_in_a_box_is_crossed_at_the_plane_and_at_the_sides) {
    struct test_random random = {7};
    struct arena arena = {0};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 100));
    for (int i = 0; i < 20; i++) {
        struct vec3 normal = vec3_normalize(random_vec3(&random, 1));
        double distance = test_uniform(&random, -0.3, 0.3);
        struct function_maker m;
        function_begin(&m);
        uint32_t sum = fn_add(&m, fn_scaled(&m, normal.x, m.p[0]), fn_scaled(&m, normal.y, m.p[1]));
        sum = fn_less(&m, fn_add(&m, sum, fn_scaled(&m, normal.z, m.p[2])), distance);
        struct implicit_input in = {.program = function_end(&m, sum, &arena), .bounds = unit};
        struct shape solid = implicit_shape(&arena, &in);
        for (int k = 0; k < 500; k++) {
            struct ray ray = random_ray(&random);
            double enter, leave, slope = vec3_dot(normal, ray.direction);
            struct ray line = ray;
            line.t_min = -INFINITY;
            line.t_max = INFINITY;
            struct list list;
            read_list(&solid, &ray, &scratch, &list);
            bool meets = box_clip(&unit, &line, &enter, &leave);
            double at = (distance - vec3_dot(normal, ray.origin)) / slope;
            if (meets && slope > 0)
                leave = fmin(leave, at);
            else if (meets)
                enter = fmax(enter, at);
            double length = vec3_length(ray.direction);
            if (fabs(enter - leave) * length < 1e-6)
                continue;
            meets = meets && enter < leave;
            CHECK_EQ_INT(list.count, meets ? 2 : 0);
            if (!meets || list.count != 2)
                continue;
            CHECK_NEAR(list.items[0].t * length, enter * length, 1e-9);
            CHECK_NEAR(list.items[1].t * length, leave * length, 1e-9);
        }
    }
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

/* --- beside their functions --- */

/* The function in the middles of `count` equal parts of a line, a batch at a time; from the part `first` on. */
static uint32_t values_at(const struct expr_program *program, const struct ray *ray, const double ends[2], int first,
                          int count, double *out) {
    _Alignas(64) unsigned char rows[1 << 19];
    double p[3][EXPR_BATCH];
    const double *in[EXPR_INPUT_COUNT] = {p[0], p[1], p[2]};
    double *outs[EXPR_OUTPUTS] = {out, NULL, NULL, NULL};
    uint32_t points = count - first < EXPR_BATCH ? (uint32_t)(count - first) : EXPR_BATCH;
    CHECK(expr_batch_size(program) <= sizeof rows);
    for (uint32_t i = 0; i < points; i++) {
        struct vec3 at = ray_at(ray, ends[0] + (ends[1] - ends[0]) * (first + (int)i + 0.5) / count);
        for (int k = 0; k < 3; k++)
            p[k][i] = vec3_get(at, k);
    }
    expr_evaluate_batch(program, points, in, outs, rows);
    return points;
}

struct holes {
    long crossings, sides, nearest, lengths;
};

/* Whether the line is inside where its function is below 0, at places all along it. */
static void check_line(const struct shape *shape, const struct expr_program *program, const struct ray *ray,
                       int samples, struct geom_scratch *scratch, struct holes *holes) {
    struct crossing_list list;
    struct ray line = *ray;
    double length = vec3_length(ray->direction), enter, leave;
    CHECK(shape_crossings(shape, ray, scratch, &list));
    const struct crossing *items = &scratch->items[list.first];
    holes->crossings += list.count;
    holes->lengths += list.count % 2 != 0;
    line.t_min = -INFINITY;
    line.t_max = INFINITY;
    if (!box_clip(&unit, &line, &enter, &leave)) {
        holes->lengths += list.count > 0;
        return;
    }
    uint32_t before = 0, points = 0;
    double values[EXPR_BATCH];
    for (int i = 0, first = 0; i < samples; i++) {
        if (i == first + (int)points || i == 0) {
            first = i;
            points = values_at(program, ray, (const double[2]){enter, leave}, first, samples, values);
        }
        double t = enter + (leave - enter) * (i + 0.5) / samples;
        while (before < list.count && items[before].t < t)
            before++;
        double back = before > 0 ? t - items[before - 1].t : INFINITY;
        double to_next = before < list.count ? items[before].t - t : INFINITY;
        if (back * length < 1e-7 || to_next * length < 1e-7)
            continue;
        double value = values[i - first];
        holes->sides += (value < 0) != (before % 2 == 1) && !(fabs(value) < 1e-13);
    }
    /* The nearest from any place is that of the list. */
    line.t_min = enter + (leave - enter) * 0.37;
    line.t_max = enter + (leave - enter) * 0.9;
    struct crossing nearest = {.t = NAN};
    uint32_t first = 0;
    while (first < list.count && !(items[first].t > line.t_min))
        first++;
    bool expected = first < list.count && items[first].t < line.t_max;
    bool found = shape_nearest(shape, &line, scratch, &nearest);
    holes->nearest +=
        found != expected || (found && (nearest.t != items[first].t || nearest.part != items[first].part));
    scratch->used = list.first;
}

static void find_holes(int first, int functions, long rays, int samples) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 100000));
    for (int number = first; number < first + functions; number++) {
        struct test_random random = {(uint64_t)(500 + number)};
        struct arena arena = {0};
        struct function_maker m;
        function_begin(&m);
        const struct expr_program *program = function_end(&m, fn_random(&m, &random, number), &arena);
        struct implicit_input in = {.program = program, .bounds = unit};
        struct shape shape = implicit_shape(&arena, &in);
        struct holes holes = {0};
        for (long i = 0; i < rays; i++) {
            struct ray ray = random_ray(&random);
            check_line(&shape, program, &ray, samples, &scratch, &holes);
        }
        if (holes.sides || holes.nearest || holes.lengths)
            test_fail(__FILE__, __LINE__, "function %d, %ld crossings: %ld sides, %ld nearest, %ld lengths are wrong",
                      number, holes.crossings, holes.sides, holes.nearest, holes.lengths);
        arena_destroy(&arena);
    }
    geom_scratch_destroy(&scratch);
}

TEST(lines_are_inside_of_implicit_solids_where_their_functions_are_below_zero) {
    find_holes(0, FUNCTION_KINDS + 5, 20, 100); /* each kind, and each way to join two of them */
}

/* One test for each function, so that they share the processors and each can be repeated. */
#define HOLE_TEST(number)                                                                                              \
    TEST_LONG(no_ray_of_a_million_through_function_##number##_finds_a_hole) {                                          \
        find_holes(number, 1, 1000000, 32);                                                                            \
    }
#define TEN_HOLE_TESTS(tens)                                                                                           \
    HOLE_TEST(tens##0)                                                                                                 \
    HOLE_TEST(tens##1)                                                                                                 \
    HOLE_TEST(tens##2)                                                                                                 \
    HOLE_TEST(tens##3)                                                                                                 \
    HOLE_TEST(tens##4)                                                                                                 \
    HOLE_TEST(tens##5)                                                                                                 \
    HOLE_TEST(tens##6)                                                                                                 \
    HOLE_TEST(tens##7)                                                                                                 \
    HOLE_TEST(tens##8)                                                                                                 \
    HOLE_TEST(tens##9)
TEN_HOLE_TESTS()
TEN_HOLE_TESTS(1)
TEN_HOLE_TESTS(2)
TEN_HOLE_TESTS(3)
TEN_HOLE_TESTS(4)

TEST(a_selection_whose_other_side_is_nan_leaves_few_regions) {
    struct arena arena = {0};
    struct geom_scratch scratch;
    struct test_random random = {8};
    CHECK(geom_scratch_init(&scratch, 1000));
    struct function_maker m;
    function_begin(&m);
    uint32_t ball = fn_ball(&m, (struct vec3){0.4, 0, 0}, 0.3, true);
    uint32_t nan = fn_of(&m, EXPR_SQRT, fn_less(&m, m.p[0], 0.2));
    uint32_t choice = expr_operation(&m.graph, EXPR_SELECT, fn_two(&m, EXPR_LESS, fn_number(&m, 0), m.p[0]), ball, nan);
    struct implicit_input in = {.program = function_end(&m, choice, &arena), .bounds = unit};
    struct shape shape = implicit_shape(&arena, &in);
    CHECK(arena.total < (size_t)2 << 20); /* 2^18 regions need more than 10 MiB */
    struct holes holes = {0};
    for (int k = 0; k < 300; k++) {
        struct ray ray = random_ray(&random);
        check_line(&shape, in.program, &ray, 100, &scratch, &holes);
    }
    CHECK_EQ_INT(holes.sides + holes.nearest + holes.lengths, 0);
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

/* A function of the point that is NaN in a part of the unit box. */
static uint32_t half_nan(struct function_maker *m, int kind) {
    uint32_t x = fn_add(m, m->p[0], fn_scaled(m, 0.3, m->p[1]));
    switch (kind) {
    case 0:
        return fn_add(m, fn_of(m, EXPR_LOG, x), m->p[2]);
    case 1:
        return fn_sub(m, fn_of(m, EXPR_ACOS, fn_scaled(m, 1.5, x)), fn_add(m, fn_number(m, 1), m->p[1]));
    case 2:
        return fn_add(m, fn_of(m, EXPR_EXP, fn_two(m, EXPR_POWER, x, fn_number(m, 1.5))), fn_less(m, m->p[2], 1.5));
    default:
        return fn_less(m, fn_two(m, EXPR_MODULO, fn_of(m, EXPR_LOG2, x), fn_number(m, 3)), 1);
    }
}

TEST_TIMES(solids_whose_function_is_nan_in_a_part_of_the_bounds_are_found_with_little_work, 10) {
    struct test_random random = {9};
    struct geom_scratch scratch;
    struct error error = {0};
    CHECK(geom_scratch_init(&scratch, 1000));
    for (int kind = 0; kind < 4; kind++) {
        struct arena arena = {0};
        struct function_maker m;
        struct implicit_findings findings;
        function_begin(&m);
        struct implicit_input in = {.program = function_end(&m, half_nan(&m, kind), &arena), .bounds = unit};
        struct shape shape = implicit_shape(&arena, &in);
        struct holes holes = {0};
        for (int k = 0; k < 30 * times; k++) {
            struct ray ray = random_ray(&random);
            check_line(&shape, in.program, &ray, 100, &scratch, &holes);
        }
        CHECK(implicit_examine(shape.implicit, &findings, &error));
        if (holes.sides + holes.nearest + holes.lengths > 0 || findings.line_work > 20000)
            test_fail(__FILE__, __LINE__, "kind %d: %ld sides, %ld nearest, %ld lengths are wrong, %.0f operations",
                      kind, holes.sides, holes.nearest, holes.lengths, findings.line_work);
        arena_destroy(&arena);
    }
    geom_scratch_destroy(&scratch);
}

/* |x|^n + |y|^n + |z|^n - 0.5, for even n by powers or by products, for odd ones without the absolute values. */
static double work_of_powers(int n, bool by_products) {
    struct arena arena = {0};
    struct error error = {0};
    struct implicit_findings findings;
    struct function_maker m;
    function_begin(&m);
    uint32_t sum = fn_number(&m, -0.5);
    for (int k = 0; k < 3; k++) {
        uint32_t power = by_products ? m.p[k] : fn_two(&m, EXPR_POWER, m.p[k], fn_number(&m, n));
        for (int i = 1; by_products && i < n; i++)
            power = fn_mul(&m, power, m.p[k]);
        sum = fn_add(&m, sum, power);
    }
    struct implicit_input in = {.program = function_end(&m, sum, &arena), .bounds = unit};
    struct shape shape = implicit_shape(&arena, &in);
    CHECK(implicit_examine(shape.implicit, &findings, &error));
    arena_destroy(&arena);
    return findings.line_work;
}

TEST(whole_powers_of_negative_coordinates_take_no_more_work_than_products) {
    for (int n = 3; n < 9; n++) {
        double powers = work_of_powers(n, false), products = work_of_powers(n, true);
        if (!(powers < 2 * products))
            test_fail(__FILE__, __LINE__, "power %d: %.0f operations for a line, by products %.0f", n, powers,
                      products);
    }
}

/* A ball as a step of 1 at its surface, and stairs, whose walls are jumps between slopes along y. */
TEST(surfaces_where_a_function_jumps_have_the_normals_of_those_surfaces) {
    struct test_random random = {10};
    struct geom_scratch scratch;
    long walls = 0, rough = 0;
    CHECK(geom_scratch_init(&scratch, 1000));
    for (int kind = 0; kind < 2; kind++) {
        struct arena arena = {0};
        struct function_maker m;
        function_begin(&m);
        uint32_t step = expr_operation(&m.graph, EXPR_SELECT,
                                       fn_two(&m, EXPR_LESS, fn_ball(&m, vec3_all(0), 0.6, true), fn_number(&m, 0)),
                                       fn_number(&m, -0.5), fn_number(&m, 0.5));
        uint32_t stairs = fn_sub(&m, m.p[1], fn_scaled(&m, 0.2, fn_of(&m, EXPR_FLOOR, fn_scaled(&m, 5, m.p[0]))));
        struct implicit_input in = {.program = function_end(&m, kind ? stairs : step, &arena), .bounds = unit};
        struct shape shape = implicit_shape(&arena, &in);
        for (int k = 0; k < 2000; k++) {
            struct ray ray = random_ray(&random);
            struct crossing_list list;
            CHECK(shape_crossings(&shape, &ray, &scratch, &list));
            for (uint32_t i = 0; i < list.count; i++) {
                const struct crossing *crossing = &scratch.items[list.first + i];
                struct surface surface;
                if (crossing->part >= IMPLICIT_PART_BOX)
                    continue;
                shape_describe(&shape, &ray, crossing, &surface);
                const struct vec3 p = surface.point, normal = vec3_normalize(surface.normal);
                double to_wall = fabs(5 * p.x - round(5 * p.x)), to_tread = fabs(5 * p.y - round(5 * p.y));
                if (kind == 1 && to_wall < 1e-5 && to_tread < 1e-5)
                    continue; /* an edge */
                struct vec3 expected = kind == 0        ? vec3_normalize(p)
                                       : to_wall < 1e-9 ? (struct vec3){-1, 0, 0}
                                                        : (struct vec3){0, 1, 0};
                walls += kind == 1 && to_wall < 1e-9;
                rough += vec3_dot(normal, expected) < 1 - 1e-6;
            }
            scratch.used = list.first;
        }
        arena_destroy(&arena);
    }
    CHECK(walls > 500);
    CHECK_EQ_INT(rough, 0);
    geom_scratch_destroy(&scratch);
}

TEST(regions_of_a_union_of_hundreds_of_balls_have_the_programs_of_a_few) {
    struct arena arena = {0};
    struct function_maker m;
    function_begin(&m);
    uint32_t all = fn_ball(&m, (struct vec3){0, 0, 0}, 0.09, true);
    for (int k = 0; k < 512; k++) {
        struct vec3 centre = {0.25 * (k % 8) - 0.87, 0.25 * (k / 8 % 8) - 0.87, 0.25 * (k / 64) - 0.87};
        all = fn_two(&m, EXPR_MIN, all, fn_ball(&m, centre, 0.09, true));
    }
    struct implicit_input in = {.program = function_end(&m, all, &arena), .bounds = unit};
    struct shape shape = implicit_shape(&arena, &in);
    uint64_t instructions = 0;
    CHECK(shape.implicit->region_count > 1000);
    for (uint32_t k = 0; k < shape.implicit->region_count; k++)
        instructions += shape.implicit->programs[shape.implicit->regions[k].program].count;
    CHECK(instructions < 30 * (uint64_t)shape.implicit->region_count); /* a ball has 9 */
    arena_destroy(&arena);
}

TEST(gyroids_are_crossed_where_a_dense_march_changes_sign) {
    struct arena arena = {0};
    struct test_random random = {12};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 1000));
    for (int i = 0; i < 3; i++) {
        struct function_maker m;
        function_begin(&m);
        const struct expr_program *program = function_end(&m, fn_gyroid(&m, 3 + 4 * i, 0.3 - 0.14 * i), &arena);
        struct shape shape = implicit_shape(&arena, &(struct implicit_input){.program = program, .bounds = unit});
        struct holes holes = {0};
        for (int k = 0; k < 30; k++) {
            struct ray ray = random_ray(&random);
            check_line(&shape, program, &ray, 4000, &scratch, &holes);
        }
        CHECK(holes.crossings > 40);
        CHECK_EQ_INT(holes.sides + holes.nearest + holes.lengths, 0);
    }
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

TEST(shells_of_a_millionth_of_the_size_are_crossed_four_times) {
    struct arena arena = {0};
    struct test_random random = {4};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 100));
    struct function_maker m;
    function_begin(&m);
    uint32_t shell = fn_less(&m, fn_of(&m, EXPR_ABS, fn_ball(&m, vec3_all(0), 0.7, true)), 1e-6);
    struct implicit_input in = {.program = function_end(&m, shell, &arena), .bounds = unit};
    struct shape shape = implicit_shape(&arena, &in);
    for (int i = 0; i < 2000; i++) {
        struct vec3 origin = random_vec3(&random, 3), target = vec3_scale(vec3_normalize(random_vec3(&random, 1)), 0.6);
        if (vec3_length(origin) < 1)
            continue;
        struct ray ray = ray_from(origin, vec3_sub(vec3_scale(target, test_uniform(&random, 0, 1)), origin));
        struct crossing_list list;
        CHECK(shape_crossings(&shape, &ray, &scratch, &list));
        CHECK_EQ_INT(list.count, 4);
        scratch.used = list.first;
    }
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

TEST(tangents_of_an_implicit_ball_cross_twice_or_not_at_all) {
    struct arena arena = {0};
    struct test_random random = {6};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 100));
    struct function_maker m;
    function_begin(&m);
    struct implicit_input in = {.program = function_end(&m, fn_ball(&m, vec3_all(0), 0.7, true), &arena),
                                .bounds = unit};
    struct shape shape = implicit_shape(&arena, &in);
    for (int i = 0; i < 2000; i++) {
        struct vec3 touch = vec3_normalize(random_vec3(&random, 1)), side = random_vec3(&random, 1);
        struct vec3 along = vec3_normalize(vec3_cross(touch, side));
        double depth = exp(test_uniform(&random, -40, -2)) * (i % 2 ? 1 : -1);
        struct ray ray = ray_from(vec3_add_scaled(vec3_scale(touch, 0.7 - depth), along, -3), along);
        struct crossing_list list;
        CHECK(shape_crossings(&shape, &ray, &scratch, &list));
        CHECK(list.count == 0 || list.count == 2);
        if (depth > 1e-12) /* a chord of more than 2e-6 */
            CHECK_EQ_INT(list.count, 2);
        if (depth < -1e-15)
            CHECK_EQ_INT(list.count, 0);
        scratch.used = list.first;
    }
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

TEST(rays_from_far_away_meet_an_implicit_solid_where_near_ones_do) {
    struct arena arena = {0};
    struct test_random random = {8};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 100));
    struct function_maker m;
    function_begin(&m);
    struct implicit_input in = {.program = function_end(&m, fn_torus(&m, 0.6, 0.2), &arena), .bounds = unit};
    struct shape shape = implicit_shape(&arena, &in);
    for (int i = 0; i < 1000; i++) {
        struct vec3 direction = vec3_normalize(random_vec3(&random, 1)), target = random_vec3(&random, 0.5);
        struct list near_list, far_list;
        struct ray ray = ray_from(vec3_add_scaled(target, direction, -3), direction);
        struct ray far_ray = ray_from(vec3_add_scaled(target, direction, -3e7), direction);
        read_list(&shape, &ray, &scratch, &near_list);
        read_list(&shape, &far_ray, &scratch, &far_list);
        if (near_list.count != far_list.count)
            continue; /* a tangent, moved by rounding; counted below */
        for (uint32_t k = 0; k < near_list.count; k++) {
            struct surface a, b;
            shape_describe(&shape, &ray, &near_list.items[k], &a);
            shape_describe(&shape, &far_ray, &far_list.items[k], &b);
            double cosine = fabs(vec3_dot(vec3_normalize(a.normal), direction));
            CHECK(vec3_length(vec3_sub(a.point, b.point)) * cosine < 1e-7);
        }
    }
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

TEST(an_implicit_solid_of_a_heavy_function_is_built_with_bounded_work_and_memory) {
    struct arena arena = {0};
    struct function_maker m;
    function_begin(&m);
    uint32_t sum = fn_number(&m, 0);
    for (int k = 0; k < 400; k++) {
        uint32_t x = fn_scaled(&m, 37 + k, m.p[k % 3]), y = fn_scaled(&m, 91 - k, m.p[(k + 1) % 3]);
        sum = fn_add(&m, sum, fn_mul(&m, fn_of(&m, EXPR_SIN, x), fn_of(&m, EXPR_COS, y)));
    }
    struct implicit_input in = {.program = function_end(&m, sum, &arena), .bounds = unit};
    struct shape shape = implicit_shape(&arena, &in);
    CHECK(arena.total < (size_t)64 << 20);
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 100000));
    struct test_random random = {2};
    struct ray ray = random_ray(&random);
    struct holes holes = {0};
    check_line(&shape, in.program, &ray, 1000, &scratch, &holes);
    CHECK_EQ_INT(holes.lengths, 0);
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

TEST(bounds_of_functions_with_many_values_at_once_need_no_stack) {
    enum { WAVES = 500 };
    struct arena arena = {0};
    struct geom_scratch scratch;
    struct test_random random = {21};
    struct function_maker m;
    function_begin(&m);
    uint32_t waves[WAVES], sum = fn_number(&m, 0), all = fn_less(&m, fn_of(&m, EXPR_ABS, m.p[1]), 0.6);
    for (int k = 0; k < WAVES; k++) {
        waves[k] = fn_of(&m, EXPR_SIN, fn_add(&m, fn_scaled(&m, 1 + 0.01 * k, m.p[0]), m.p[2]));
        sum = fn_add(&m, sum, waves[k]);
    }
    for (int k = 0; k < WAVES; k++) /* reads every wave again after the sum */
        all = fn_add(&m, all, fn_scaled(&m, 1e-6, fn_mul(&m, waves[k], sum)));
    struct implicit_input in = {.program = function_end(&m, all, &arena), .bounds = unit};
    struct shape shape = implicit_shape(&arena, &in);
    CHECK(expr_lanes_size(in.program) > IMPLICIT_STACK);
    CHECK(geom_scratch_init(&scratch, 4));
    struct holes holes = {0};
    for (int i = 0; i < 20; i++) {
        struct ray ray = random_ray(&random);
        struct crossing_list list;
        while (!shape_crossings(&shape, &ray, &scratch, &list))
            CHECK(scratch.overflow && geom_scratch_grow(&scratch));
        scratch.used = list.first;
        check_line(&shape, in.program, &ray, 20, &scratch, &holes);
    }
    CHECK(scratch.capacity <= 4 * shape_scratch_need(&shape));
    CHECK_EQ_INT(holes.sides + holes.nearest + holes.lengths, 0);
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

TEST(functions_that_are_no_solids_are_refused) {
    struct arena arena = {0};
    struct error error = {0};
    struct function_maker m;
    function_begin(&m);
    uint32_t u = expr_input(&m.graph, EXPR_U);
    struct implicit_input in = {.program = function_end(&m, fn_add(&m, m.p[0], u), &arena), .bounds = unit};
    CHECK(!implicit_build(&arena, &in, &error));
    CHECK_TEXT(error.text, "the function reads s.u, but a solid may depend only on p");
    function_begin(&m);
    in.program = function_end(&m, m.p[0], &arena);
    in.bounds.max.y = -1;
    CHECK(!implicit_build(&arena, &in, &error));
    in.bounds.max.y = INFINITY;
    CHECK(!implicit_build(&arena, &in, &error));
    arena_destroy(&arena);
}
