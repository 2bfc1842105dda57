/* Spheres and boxes: closed forms, crossings on the surface, uv, bounds of the error, exactness under scaling. */
#include "shape/box_shape_internal.h"
#include "shape/shape.h"
#include "shape/sphere.h"
#include "tests/harness.h"
#include "tests/unit/random_makers.h"

#include <math.h>
#include <string.h>

static struct shape sphere_at(struct vec3 centre, double radius) {
    struct shape s = {.kind = SHAPE_SPHERE};
    s.sphere.centre = centre;
    s.sphere.radius = radius;
    return s;
}

static struct shape box_of_corners(struct vec3 min, struct vec3 max) {
    struct shape s = {.kind = SHAPE_BOX};
    s.box = (struct box){min, max};
    return s;
}

static struct transform random_transform(struct test_random *random) {
    struct transform t = transform_identity();
    for (int i = 0; i < 3; i++) {
        struct vec3 factors = {exp(test_uniform(random, -1.5, 1.5)), exp(test_uniform(random, -1.5, 1.5)),
                               exp(test_uniform(random, -1.5, 1.5))};
        if (test_uniform(random, 0, 1) < 0.3)
            factors.y = -factors.y;
        struct transform scale = transform_scale(factors), move = transform_translate(random_vec3(random, 3));
        struct transform turn = transform_rotate(i, test_uniform(random, 0, 360));
        t = transform_compose(&scale, &t);
        t = transform_compose(&turn, &t);
        t = transform_compose(&move, &t);
    }
    return t;
}

/* Distance from the surface, in long double. */
static double sphere_residual(struct vec3 centre, double radius, struct vec3 p) {
    long double x = (long double)p.x - centre.x, y = (long double)p.y - centre.y, z = (long double)p.z - centre.z;
    return (double)fabsl(sqrtl(x * x + y * y + z * z) - radius);
}

static double box_residual(const struct box *b, struct vec3 p) {
    double outside = 0, inside = INFINITY;
    for (int i = 0; i < 3; i++) {
        double below = vec3_get(b->min, i) - vec3_get(p, i), above = vec3_get(p, i) - vec3_get(b->max, i);
        outside = fmax(outside, fmax(below, above));
        inside = fmin(inside, fmin(fabs(below), fabs(above)));
    }
    return outside > 0 ? outside : inside;
}

TEST(sphere_is_crossed_at_the_closed_form) {
    struct shape s = sphere_at(vec3_make(1, 2, 3), 2);
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 16));
    struct ray ray = ray_from(vec3_make(1, 2, 13), vec3_make(0, 0, -4));
    struct crossing_list list;
    CHECK(shape_crossings(&s, &ray, &scratch, &list));
    CHECK_EQ_INT(list.count, 2);
    CHECK(scratch.items[list.first].t == 2 && scratch.items[list.first].enter);
    CHECK(scratch.items[list.first + 1].t == 3 && !scratch.items[list.first + 1].enter);
    scratch.used = list.first;

    ray = ray_from(vec3_make(1, 2 + 1.2, 3), vec3_make(0.5, 0, 0)); /* chord of half length 1.6 */
    CHECK(shape_crossings(&s, &ray, &scratch, &list) && list.count == 2);
    CHECK_NEAR(scratch.items[list.first].t, -3.2, 1e-15);
    CHECK_NEAR(scratch.items[list.first + 1].t, 3.2, 1e-15);
    scratch.used = list.first;

    ray = ray_from(vec3_make(1, 5, 3), vec3_make(1, 0, 0));
    CHECK(shape_crossings(&s, &ray, &scratch, &list));
    CHECK_EQ_INT(list.count, 0);
    geom_scratch_destroy(&scratch);
}

TEST(sphere_is_grazed_twice_or_not_at_all) {
    struct test_random random = {1};
    int crossed = 0, missed = 0;
    for (int i = 0; i < 100000; i++) {
        struct vec3 normal = vec3_normalize(random_vec3(&random, 1));
        struct vec3 along = vec3_normalize(vec3_cross(normal, random_vec3(&random, 1)));
        double nudge = ldexp(test_uniform(&random, -1, 1), -50), back = test_uniform(&random, -10, 10);
        struct ray ray = ray_from(vec3_add_scaled(vec3_scale(normal, 1 + nudge), along, back), along);
        struct crossing pair[2];
        if (!sphere_crossings(vec3_all(0), 1, &ray, pair)) {
            missed++;
            continue;
        }
        crossed++;
        CHECK(pair[0].t < pair[1].t && pair[0].enter && !pair[1].enter);
        CHECK_NEAR(pair[0].t, -back, 1e-6);
        CHECK_NEAR(pair[1].t, -back, 1e-6);
    }
    CHECK(crossed > 10000 && missed > 10000);
}

TEST(sphere_crossings_from_far_away_stay_on_the_sphere) {
    struct test_random random = {2};
    for (int i = 0; i < 200000; i++) {
        double far = exp(test_uniform(&random, -3, 18)), radius = exp(test_uniform(&random, -5, 5));
        struct vec3 centre = random_vec3(&random, 5), origin = random_vec3(&random, far);
        struct vec3 target = vec3_add_scaled(centre, vec3_normalize(random_vec3(&random, 1)), 0.9 * radius);
        double speed = exp(test_uniform(&random, -20, 20));
        struct ray ray = ray_from(origin, vec3_scale(vec3_sub(target, origin), speed));
        struct crossing pair[2];
        CHECK(sphere_crossings(centre, radius, &ray, pair));
        double magnitude = vec3_length(origin) + vec3_length(centre) + radius;
        for (int k = 0; k < 2; k++)
            CHECK_NEAR(sphere_residual(centre, radius, ray_at(&ray, pair[k].t)), 0, 3e-15 * magnitude);
    }
}

TEST(sphere_and_box_scaled_by_powers_of_two_give_the_same_t) {
    struct test_random random = {3};
    const int exponents[] = {-500, -200, -10, 20, 300, 490};
    int crossed = 0;
    for (int i = 0; i < 20000; i++) {
        struct vec3 centre = random_vec3(&random, 1), origin = random_vec3(&random, 4);
        struct vec3 d = vec3_sub(random_vec3(&random, 1), origin);
        double radius = test_uniform(&random, 0.1, 2);
        struct vec3 corner = vec3_add(centre, vec3_make(radius, 0.5 * radius, 0.25 * radius));
        struct box box = {centre, corner};
        struct ray ray = ray_from(origin, d);
        struct crossing pair[2], scaled_pair[2];
        for (int shape = 0; shape < 2; shape++) {
            bool crosses = shape ? box_shape_crossings(&box, &ray, pair) : sphere_crossings(centre, radius, &ray, pair);
            crossed += crosses;
            for (int e = 0; e < 6; e++) {
                double s = ldexp(1, exponents[e]);
                struct ray big = ray_from(vec3_scale(origin, s), vec3_scale(d, s));
                struct box big_box = {vec3_scale(box.min, s), vec3_scale(box.max, s)};
                bool scaled_crosses = shape ? box_shape_crossings(&big_box, &big, scaled_pair)
                                            : sphere_crossings(vec3_scale(centre, s), radius * s, &big, scaled_pair);
                CHECK(scaled_crosses == crosses);
                if (crosses && scaled_crosses)
                    CHECK(pair[0].t == scaled_pair[0].t && pair[1].t == scaled_pair[1].t);
            }
        }
    }
    CHECK(crossed > 10000);
}

TEST(transformed_shapes_are_hit_on_their_surface) {
    struct test_random random = {4};
    int hits = 0;
    for (int i = 0; i < 100000; i++) {
        struct transform world_from_object = random_transform(&random);
        struct shape shape = i % 2 ? sphere_at(vec3_all(0), 1) : box_of_corners(vec3_all(0), vec3_all(1));
        struct geom_scratch scratch = {0};
        struct vec3 target = affine_point(&world_from_object.forward, random_vec3(&random, 0.5));
        struct vec3 origin = random_vec3(&random, 20);
        struct ray world = ray_from(origin, vec3_sub(target, origin));
        struct ray ray = ray_transform(&world_from_object.inverse, &world);
        struct crossing c;
        if (!shape_nearest(&shape, &ray, &scratch, &c))
            continue;
        hits++;
        struct surface surface;
        shape_describe(&shape, &ray, &c, &surface);
        struct vec3 p = affine_point(&world_from_object.inverse, ray_at(&world, c.t));
        double residual = i % 2 ? sphere_residual(vec3_all(0), 1, p) : box_residual(&shape.box, p);
        CHECK_NEAR(residual, 0, 1e-9);
        CHECK_NEAR(vec3_length(vec3_sub(surface.point, p)), 0, 1e-9);
        /* The normal points outwards in world space, too: against a ray that enters. */
        struct vec3 n = transform_normal(&world_from_object, surface.normal);
        CHECK(vec3_dot(n, world.direction) < 0);
    }
    CHECK(hits > 40000);
}

TEST(surface_error_bounds_the_distance_from_the_surface) {
    struct test_random random = {5};
    for (int i = 0; i < 100000; i++) {
        double radius = exp(test_uniform(&random, -10, 10));
        struct vec3 centre = random_vec3(&random, exp(test_uniform(&random, -5, 12)));
        struct shape sphere = sphere_at(centre, radius),
                     box = box_of_corners(centre, vec3_add(centre, vec3_all(radius)));
        struct vec3 origin = vec3_add(centre, random_vec3(&random, exp(test_uniform(&random, 0, 8)) * radius));
        struct ray ray = ray_from(origin, vec3_sub(vec3_add(centre, random_vec3(&random, radius)), origin));
        struct geom_scratch scratch = {0};
        struct crossing c;
        struct surface s;
        if (shape_nearest(&sphere, &ray, &scratch, &c)) {
            shape_describe(&sphere, &ray, &c, &s);
            CHECK(s.error > 0 && s.error < 1e-14 * (vec3_length(centre) + radius));
            CHECK(sphere_residual(centre, radius, s.point) <= s.error);
        }
        if (shape_nearest(&box, &ray, &scratch, &c)) {
            shape_describe(&box, &ray, &c, &s);
            CHECK(s.error > 0);
            CHECK(box_residual(&box.box, s.point) <= s.error);
        }
    }
}

/* The sphere's parameters are computed independently. */
static void describe_with_uv(const struct shape *shape, const struct ray *ray, const struct crossing *crossing,
                             struct surface *out) {
    shape_describe(shape, ray, crossing, out);
    if (shape->kind == SHAPE_SPHERE)
        sphere_uv(shape->sphere.radius, out);
}

/* dpdu and dpdv agree with how the point moves when u and v do: p(next) - p = dpdu du + dpdv dv to first order. */
static void check_derivatives(const struct shape *shape, uint64_t seed) {
    struct test_random random = {seed};
    struct geom_scratch scratch = {0};
    for (int i = 0; i < 2000; i++) {
        struct vec3 origin = vec3_scale(vec3_normalize(random_vec3(&random, 1)), 20);
        struct ray ray = ray_from(origin, vec3_sub(random_vec3(&random, 0.3), origin)), near = ray;
        near.direction = vec3_add(near.direction, random_vec3(&random, 1e-6));
        struct crossing a, b;
        if (!shape_nearest(shape, &ray, &scratch, &a) || !shape_nearest(shape, &near, &scratch, &b) || a.part != b.part)
            continue;
        struct surface s, t;
        describe_with_uv(shape, &ray, &a, &s);
        describe_with_uv(shape, &near, &b, &t);
        CHECK(s.has_uv && s.u >= 0 && s.u <= 1 && s.v >= 0 && s.v <= 1);
        if (fabs(s.u - t.u) > 0.5 || s.v < 0.02 || s.v > 0.98)
            continue;
        struct vec3 moved = vec3_sub(t.point, s.point);
        struct vec3 predicted = vec3_add(vec3_scale(s.dpdu, t.u - s.u), vec3_scale(s.dpdv, t.v - s.v));
        CHECK(vec3_length(vec3_sub(moved, predicted)) <= 1e-4 * vec3_length(moved) + 1e-12);
    }
}

TEST(sphere_image_coordinates_follow_the_specification) {
    const struct {
        struct vec3 p;
        double u, v;
    } table[] = {
        {{1, 0, 0}, 0.5, 0.5},   {{0, 0, 1}, 0.75, 0.5},
        {{0, 0, -1}, 0.25, 0.5}, {{0, 1, 0}, 0.5, 0},
        {{0, -1, 0}, 0.5, 1},    {{M_SQRT1_2, 0, M_SQRT1_2}, 0.625, 0.5},
        {{-1, 0, 0}, 1, 0.5},    {{0.8, 0.6, 0}, 0.5, 0.2951672353008665},
    };
    struct shape s = sphere_at(vec3_make(3, 4, 5), 2);
    struct geom_scratch scratch = {0};
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        struct ray ray = ray_from(vec3_add_scaled(s.sphere.centre, table[i].p, 8), vec3_scale(table[i].p, -1));
        struct crossing c;
        struct surface surface;
        CHECK(shape_nearest(&s, &ray, &scratch, &c));
        describe_with_uv(&s, &ray, &c, &surface);
        CHECK_NEAR(surface.u, table[i].u, 1e-14);
        CHECK_NEAR(surface.v, table[i].v, 1e-14);
    }
    check_derivatives(&s, 6);
    struct shape unit = sphere_at(vec3_all(0), 1);
    check_derivatives(&unit, 7);
}

TEST(box_image_coordinates_follow_the_specification) {
    /* x = 0.2, y = 0.3, z = 0.9 of the way on every face */
    const double x = 0.2, y = 0.3, z = 0.9;
    const struct {
        struct vec3 direction;
        enum box_face face;
        double u, v;
    } table[] = {
        {{0, 0, -1}, BOX_POSITIVE_Z, x, 1 - y},     {{0, 0, 1}, BOX_NEGATIVE_Z, 1 - x, 1 - y},
        {{-1, 0, 0}, BOX_POSITIVE_X, 1 - z, 1 - y}, {{1, 0, 0}, BOX_NEGATIVE_X, z, 1 - y},
        {{0, -1, 0}, BOX_POSITIVE_Y, x, z},         {{0, 1, 0}, BOX_NEGATIVE_Y, x, 1 - z},
    };
    struct shape s = box_of_corners(vec3_make(-1, 2, 5), vec3_make(3, 4, 6));
    struct vec3 point = {-1 + 4 * x, 2 + 2 * y, 5 + 1 * z};
    struct geom_scratch scratch = {0};
    for (size_t i = 0; i < 6; i++) {
        struct ray ray = ray_from(vec3_add_scaled(point, table[i].direction, -10), table[i].direction);
        struct crossing c;
        struct surface surface;
        CHECK(shape_nearest(&s, &ray, &scratch, &c));
        CHECK_EQ_INT(c.part, table[i].face);
        shape_describe(&s, &ray, &c, &surface);
        CHECK_NEAR(surface.u, table[i].u, 1e-14);
        CHECK_NEAR(surface.v, table[i].v, 1e-14);
        CHECK(vec3_dot(surface.normal, table[i].direction) == -1);
    }
    check_derivatives(&s, 8);
}

TEST(box_lines_cross_twice_or_not_at_all) {
    struct box unit = {vec3_all(0), vec3_all(1)};
    struct crossing pair[2];
    /* In a face plane, along an edge, through an edge or a corner from outside: no crossing. */
    const struct ray touching[] = {
        ray_from(vec3_make(-1, 0, 0.5), vec3_make(1, 0, 0)),    ray_from(vec3_make(-1, 1, 0.5), vec3_make(1, -0.0, 0)),
        ray_from(vec3_make(-1, 0, 0), vec3_make(1, 0, -0.0)),   ray_from(vec3_make(-1, 1, 0.5), vec3_make(1, 1, 0)),
        ray_from(vec3_make(-1, 1, 2), vec3_make(1, -1, -1)),    ray_from(vec3_make(0.5, 0.5, 2), vec3_make(1, 0, 0)),
        ray_from(vec3_make(0.5, 0.5, 0.5), vec3_make(0, 0, 0)),
    };
    for (size_t i = 0; i < sizeof touching / sizeof touching[0]; i++)
        CHECK(!box_shape_crossings(&unit, &touching[i], pair));

    /* Parallel to two axes, with either zero. */
    struct ray ray = ray_from(vec3_make(0.5, 0.25, 3), vec3_make(0.0, -0.0, -2));
    CHECK(box_shape_crossings(&unit, &ray, pair));
    CHECK(pair[0].t == 1 && pair[1].t == 1.5);
    CHECK(pair[0].part == BOX_POSITIVE_Z && pair[1].part == BOX_NEGATIVE_Z);

    /* A diagonal through two edges, and one through two corners. */
    ray = ray_from(vec3_make(-1, -1, 0.5), vec3_make(1, 1, 0));
    CHECK(box_shape_crossings(&unit, &ray, pair) && pair[0].t == 1 && pair[1].t == 2);
    ray = ray_from(vec3_make(2, 2, 2), vec3_make(-1, -1, -1));
    CHECK(box_shape_crossings(&unit, &ray, pair) && pair[0].t == 1 && pair[1].t == 2);

    struct test_random random = {9};
    for (int i = 0; i < 200000; i++) {
        struct vec3 origin = random_vec3(&random, 3);
        ray = ray_from(origin, vec3_sub(random_vec3(&random, 1), origin));
        if (!box_shape_crossings(&unit, &ray, pair))
            continue;
        CHECK(pair[0].t < pair[1].t && pair[0].enter && !pair[1].enter && pair[0].part != pair[1].part);
        double middle = pair[0].t / 2 + pair[1].t / 2;
        if (pair[1].t - pair[0].t > 1e-12)
            CHECK(box_shape_contains(&unit, ray_at(&ray, middle)));
    }
}

TEST(nearest_is_the_first_crossing_in_the_open_interval) {
    struct test_random random = {10};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 16));
    for (int i = 0; i < 100000; i++) {
        struct shape s = i % 2 ? sphere_at(random_vec3(&random, 1), test_uniform(&random, 0.1, 2))
                               : box_of_corners(vec3_all(-1), vec3_make(1, 2, 0.5));
        struct ray ray = ray_from(random_vec3(&random, 4), random_vec3(&random, 1));
        struct crossing_list list;
        CHECK(shape_crossings(&s, &ray, &scratch, &list));
        CHECK(list.count == 0 || list.count == 2);
        ray.t_min = test_uniform(&random, -4, 2);
        ray.t_max = test_uniform(&random, ray.t_min, 6);
        if (list.count == 2 && i % 8 == 0)
            ray.t_min = scratch.items[list.first].t; /* open: the end itself is not in the interval */
        if (list.count == 2 && i % 8 == 1)
            ray.t_max = scratch.items[list.first + 1].t;
        const struct crossing *expected = NULL;
        for (uint32_t k = 0; k < list.count && !expected; k++) {
            const struct crossing *c = &scratch.items[list.first + k];
            expected = c->t > ray.t_min && c->t < ray.t_max ? c : NULL;
        }
        struct crossing c;
        bool found = shape_nearest(&s, &ray, &scratch, &c);
        CHECK(found == (expected != NULL));
        CHECK(shape_any(&s, &ray, &scratch) == found);
        if (found && expected)
            CHECK(c.t == expected->t && c.part == expected->part && c.enter == expected->enter);
        scratch.used = list.first;
    }
    geom_scratch_destroy(&scratch);
}

TEST(scratch_overflow_is_reported_and_growing_answers_the_ray) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 16));
    struct shape s = sphere_at(vec3_all(0), 1);
    struct ray ray = ray_from(vec3_make(0, 0, 5), vec3_make(0, 0, -1));
    struct crossing_list list;
    scratch.used = scratch.capacity - 1;
    CHECK(!shape_crossings(&s, &ray, &scratch, &list));
    CHECK(scratch.overflow && scratch.used == scratch.capacity - 1);
    uint32_t capacity = scratch.capacity;
    CHECK(geom_scratch_grow(&scratch));
    CHECK(!scratch.overflow && scratch.used == 0 && scratch.capacity == 2 * capacity);
    CHECK(shape_crossings(&s, &ray, &scratch, &list) && list.count == 2);
    geom_scratch_destroy(&scratch);
}
