/* Lathe, prism, sphere sweep, height field, blob, curve and patches one by one, against closed forms and brute force;
 * the Bernstein roots below them. */
#include "math/frame.h"
#include "mesh/mesh_internal.h"
#include "tests/unit/swept_makers.h"

/* ---- each shape alone ---- */

TEST(lathe_of_a_rectangle_is_a_cylinder_and_of_half_a_circle_a_sphere) {
    struct arena arena = {0};
    const double rectangle[][2] = {{2, -1}, {2, 3}};
    struct shape can = make_lathe(&arena, SPLINE_LINEAR, rectangle, 2, false, false);
    CHECK(shape_is_closed(&can));
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    struct ray ray = ray_from(vec3_make(-10, 0, 0), vec3_make(1, 0, 0)); /* level, through the axis */
    struct crossing_list list = list_of(&can, &ray, &scratch);
    CHECK_EQ_INT(list.count, 2);
    CHECK_NEAR(scratch.items[0].t, 8, 1e-14);
    CHECK_NEAR(scratch.items[1].t, 12, 1e-14);
    ray = ray_from(vec3_make(0, 10, 0), vec3_make(0, -2, 0)); /* the axis itself */
    list = list_of(&can, &ray, &scratch);
    CHECK_EQ_INT(list.count, 2);
    CHECK_NEAR(scratch.items[0].t, 3.5, 1e-14);
    CHECK_NEAR(scratch.items[1].t, 5.5, 1e-14);
    ray = ray_from(vec3_make(1.5, 10, 0.5), vec3_make(0, -1, 0));
    list = list_of(&can, &ray, &scratch);
    CHECK_EQ_INT(list.count, 2);
    CHECK_NEAR(scratch.items[0].t, 7, 1e-14);

    /* Two quarter circles by the usual cubic, which is a circle to 2.7e-4. */
    const double k = 0.5522847498307936;
    const double circle[][2] = {{0, -1}, {k, -1}, {1, -k}, {1, 0}, {1, k}, {k, 1}, {0, 1}};
    struct shape ball = make_lathe(&arena, SPLINE_BEZIER, circle, 7, false, false);
    CHECK(shape_is_closed(&ball));
    struct test_random random = {31};
    for (int i = 0; i < 20000; i++) {
        struct vec3 o = random_vec3(&random, 5), d = vec3_sub(random_vec3(&random, 0.5), o);
        ray = ray_from(o, d);
        list = list_of(&ball, &ray, &scratch);
        CHECK_EQ_INT(list.count, 2);
        for (uint32_t n = 0; n < list.count; n++)
            CHECK_NEAR(vec3_length(ray_at(&ray, scratch.items[n].t)), 1, 3e-4);
    }
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

/* The crossings of a polyline lathe, independently, by the quadratic of each cone. */
TEST(lathe_of_a_polyline_agrees_with_cones_by_the_quadratic_formula) {
    struct arena arena = {0};
    struct shape shape = make_lathe(&arena, SPLINE_LINEAR, vase, 8, false, false);
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    struct test_random random = {32};
    int wrong = 0, total = 0;
    for (int i = 0; i < 100000; i++) {
        struct vec3 o = random_vec3(&random, 3),
                    d = vec3_sub(vec3_add(random_vec3(&random, 0.7), vec3_make(0, 0.8, 0)), o);
        if (i % 10 == 0)
            d.y *= 1e-8;
        struct ray ray = ray_from(o, d);
        long double found[32];
        int count = 0;
        for (int k = 0; k < 7; k++) {
            long double r0 = vase[k][0], y0 = vase[k][1], dr = vase[k + 1][0] - r0, dy = vase[k + 1][1] - y0;
            if (dy == 0) {
                long double t = (y0 - o.y) / d.y, x = o.x + t * d.x, z = o.z + t * d.z, r = sqrtl(x * x + z * z);
                if (r >= fminl(r0, r0 + dr) && r < fmaxl(r0, r0 + dr))
                    found[count++] = t;
                continue;
            }
            long double m = dr / dy, b = r0 + m * (o.y - y0), s = m * d.y;
            long double qa = (long double)d.x * d.x + (long double)d.z * d.z - s * s;
            long double qb = (long double)o.x * d.x + (long double)o.z * d.z - b * s;
            long double qc = (long double)o.x * o.x + (long double)o.z * o.z - b * b, disc = qb * qb - qa * qc;
            for (int sign = -1; disc > 0 && sign <= 1; sign += 2) {
                long double t = (-qb + sign * sqrtl(disc)) / qa, y = o.y + t * d.y;
                if (y >= fminl(y0, y0 + dy) && y < fmaxl(y0, y0 + dy) && b + s * t >= 0)
                    found[count++] = t;
            }
        }
        struct crossing_list list = list_of(&shape, &ray, &scratch);
        total += count;
        wrong += (uint32_t)count != list.count;
        for (uint32_t k = 0; (uint32_t)count == list.count && k < list.count; k++) {
            long double best = 1;
            for (int j = 0; j < count; j++)
                best = fminl(best, fabsl(found[j] - scratch.items[k].t));
            wrong += best * vec3_length(d) > 1e-7;
        }
    }
    CHECK(total > 50000);
    CHECK_EQ_INT(wrong, 0);
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

TEST(lathe_with_a_thousand_segments_tests_few_of_them) {
    struct arena arena = {0};
    double points[1001][2];
    for (int i = 0; i <= 1000; i++) {
        points[i][0] = i == 0 || i == 1000 ? 0 : 1 + 0.05 * sin(i * 0.4);
        points[i][1] = 0.002 * i;
    }
    struct shape shape = make_lathe(&arena, SPLINE_CATMULL_ROM, (const double(*)[2])points, 1001, false, false);
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 4096));
    struct test_random random = {33};
    struct tally tally = {0};
    for (int i = 0; i < 3000; i++) {
        struct vec3 o = random_vec3(&random, 5), target = vec3_add(random_vec3(&random, 1), vec3_make(0, 1, 0));
        struct ray ray = ray_from(o, vec3_sub(target, o));
        check_ray(&shape, &ray, 3, 50, false, &scratch, &tally);
    }
    check_tally(&tally, "fine lathe");
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

TEST(lathe_without_discs_is_a_sheet_and_a_loop_is_a_ring) {
    struct arena arena = {0};
    const double wall[][2] = {{1, 0}, {1, 1}}, ring[][2] = {{1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 0}};
    struct shape writer = make_lathe(&arena, SPLINE_LINEAR, wall, 2, false, true);
    struct shape torus = make_lathe(&arena, SPLINE_LINEAR, ring, 5, false, false);
    CHECK(!shape_is_closed(&writer) && shape_is_closed(&torus));
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    struct ray ray = ray_from(vec3_make(-5, 0.5, 0), vec3_make(1, 0, 0));
    struct crossing_list list = list_of(&writer, &ray, &scratch);
    CHECK_EQ_INT(list.count, 2);
    CHECK(scratch.items[0].enter && !scratch.items[1].enter);
    ray = ray_from(vec3_make(0, 3, 0), vec3_make(0.1, -1, 0)); /* through the open top, out by the open bottom */
    CHECK_EQ_INT(list_of(&writer, &ray, &scratch).count, 0);
    ray = ray_from(vec3_make(-5, 0.5, 0), vec3_make(1, 0, 0));
    list = list_of(&torus, &ray, &scratch);
    CHECK_EQ_INT(list.count, 4);
    CHECK(!shape_contains(&torus, vec3_make(0, 0.5, 0), &scratch) &&
          shape_contains(&torus, vec3_make(1.5, 0.5, 0), &scratch));
    struct box b = shape_bounds(&torus);
    CHECK_NEAR(b.max.x, 2, 1e-9);
    CHECK_NEAR(b.max.y, 1, 1e-9);
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

TEST(prism_of_a_square_with_a_square_hole_has_four_walls_across) {
    struct arena arena = {0};
    const double points[][2] = {{0, 0}, {3, 0}, {3, 3}, {0, 3}, {1, 1}, {2, 1}, {2, 2}, {1, 2}};
    const uint32_t starts[] = {0, 4, 8};
    struct error error = {0};
    struct prism_input in = {.points = points, .curve_starts = starts, .curve_count = 2, .from = -1, .to = 2};
    struct shape shape = {.kind = SHAPE_PRISM, .prism = prism_build(&arena, &in, &error)};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    struct ray ray = ray_from(vec3_make(-1, 0.5, 1.5), vec3_make(1, 0, 0));
    struct crossing_list list = list_of(&shape, &ray, &scratch);
    const double expected[] = {1, 2, 3, 4};
    CHECK_EQ_INT(list.count, 4);
    for (int i = 0; i < 4 && list.count == 4; i++)
        CHECK_NEAR(scratch.items[i].t, expected[i], 1e-14);
    ray = ray_from(vec3_make(0.5, 5, 0.5), vec3_make(0, -1, 0));
    list = list_of(&shape, &ray, &scratch);
    CHECK_EQ_INT(list.count, 2);
    CHECK(scratch.items[0].t == 3 && scratch.items[0].part == 1 && scratch.items[1].t == 6 &&
          scratch.items[1].part == 0);
    ray = ray_from(vec3_make(1.5, 5, 1.5), vec3_make(0, -1, 0));
    CHECK_EQ_INT(list_of(&shape, &ray, &scratch).count, 0);
    struct box b = shape_bounds(&shape);
    CHECK(b.min.y == -1 && b.max.y == 2);
    CHECK_NEAR(b.max.x, 3, 1e-9);
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

TEST(sweep_of_one_straight_piece_is_a_capsule_or_a_rounded_cone) {
    struct arena arena = {0};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    struct test_random random = {41};
    int wrong = 0, crossed = 0;
    for (int i = 0; i < 40000; i++) {
        arena_reset(&arena);
        double points[2][3], radii[2];
        for (int k = 0; k < 6; k++)
            points[k / 3][k % 3] = test_uniform(&random, -1, 1);
        radii[0] = test_uniform(&random, 0.1, 0.5);
        radii[1] = i % 2 ? radii[0] : test_uniform(&random, 0.1, 0.5);
        struct error error = {0};
        struct sweep_input in = {
            .kind = SPLINE_LINEAR, .points = (const double(*)[3])points, .radii = radii, .count = 2};
        struct shape shape = {.kind = SHAPE_SWEEP, .sweep = sweep_build(&arena, &in, &error)};
        struct vec3 o = random_vec3(&random, 5);
        struct ray ray = ray_from(o, vec3_sub(random_vec3(&random, 0.7), o));
        struct crossing_list list = list_of(&shape, &ray, &scratch);
        wrong += list.count > 2; /* convex */
        for (uint32_t k = 0; k < list.count; k++) {
            /* The deepest ball at the crossing just touches it: the minimum of |p - c(x)| - r(x) by ternary search. */
            struct vec3 p = ray_at(&ray, scratch.items[k].t);
            double lo = 0, hi = 1, min = INFINITY;
            for (int n = 0; n < 120; n++) {
                double x[2] = {lo + (hi - lo) / 3, hi - (hi - lo) / 3}, depth[2];
                for (int j = 0; j < 2; j++) {
                    struct vec3 c = {points[0][0] + x[j] * (points[1][0] - points[0][0]),
                                     points[0][1] + x[j] * (points[1][1] - points[0][1]),
                                     points[0][2] + x[j] * (points[1][2] - points[0][2])};
                    depth[j] = vec3_length(vec3_sub(p, c)) - (radii[0] + x[j] * (radii[1] - radii[0]));
                    min = fmin(min, depth[j]);
                }
                if (depth[0] < depth[1])
                    hi = x[1];
                else
                    lo = x[0];
            }
            crossed++;
            wrong += fabs(min) > 1e-12;
        }
    }
    CHECK(crossed > 20000);
    CHECK_EQ_INT(wrong, 0);
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

/* Where the first ball begins and the last one ends on a line; balls are samples of the path. */
static bool cover_by_samples(const struct sweep_path *sweep, const struct ray *ray, double *enter, double *leave) {
    enum { SAMPLES = 3000 };
    double tube[4][4];
    *enter = INFINITY, *leave = -INFINITY;
    for (uint32_t piece = 0; sweep_piece_tube(sweep, piece, tube); piece++)
        for (int i = 0; i <= SAMPLES; i++) {
            const double x = (double)i / SAMPLES;
            const struct vec3 centre = {cubic_value(tube[0], x), cubic_value(tube[1], x), cubic_value(tube[2], x)};
            const struct vec3 q = vec3_sub(centre, ray->origin);
            const double r = cubic_value(tube[3], x), b = vec3_dot(q, ray->direction);
            const double half = sqrt(r * r - vec3_length_squared(vec3_add_scaled(q, ray->direction, -b)));
            if (half >= 0) { /* or NaN */
                *enter = fmin(*enter, b - half);
                *leave = fmax(*leave, b + half);
            }
        }
    return *enter < *leave;
}

/* Paths in the planes of two axes, and in others; lines at right angles to the plane, and nearly so; lines in the plane
 * through the middle of a path with two equal halves. */
TEST(sweeps_of_planar_paths_are_crossed_where_their_balls_begin_and_end) {
    struct test_random random = {44};
    struct geom_scratch scratch;
    int met = 0;
    CHECK(geom_scratch_init(&scratch, 256));
    for (int round = 0; round < 120; round++) {
        const bool is_even = round % 3 == 0;
        struct arena arena = {0};
        struct error error = {0};
        double points[4][3], radii[4], tilt = round % 5 == 0 ? 0 : pow(10, test_uniform(&random, -14, -2));
        struct vec3 u, v,
            normal = {round % 4 == 0 || round % 4 == 3,
                      round % 4 == 1   ? 1
                      : round % 4 == 3 ? 0.3
                                       : 0,
                      round % 4 >= 2};
        normal = vec3_normalize(normal);
        frame_tangents(normal, &u, &v);
        for (int i = 0; i < 4; i++) {
            const int twin = is_even && i > 1 ? 3 - i : i;
            double x = twin != i ? -1 : (i - 1.5) * test_uniform(&random, 0.3, 0.7),
                   y = test_uniform(&random, -0.7, 0.7);
            const struct vec3 p = vec3_add_scaled(vec3_scale(u, x), v, y);
            points[i][0] = p.x, points[i][1] = p.y, points[i][2] = p.z;
            radii[i] = round % 2 == 0 ? 0.3 : test_uniform(&random, 0.2, 0.4);
            if (twin != i) {
                const struct vec3 other = {points[twin][0], points[twin][1], points[twin][2]};
                const struct vec3 mirrored = vec3_add_scaled(other, u, -2 * vec3_dot(other, u));
                points[i][0] = mirrored.x, points[i][1] = mirrored.y, points[i][2] = mirrored.z;
                radii[i] = radii[twin];
            }
        }
        const struct sweep_input in = {.kind = round % 2 == 1 && !is_even ? SPLINE_LINEAR : SPLINE_CATMULL_ROM,
                                       .points = (const double(*)[3])points,
                                       .radii = radii,
                                       .count = 4};
        const struct sweep_path *sweep = sweep_build(&arena, &in, &error);
        CHECK_TEXT(error.text, "");
        for (int i = 0; i < 30; i++) {
            const bool is_in_plane = is_even && i % 2 == 0;
            const double across = is_in_plane ? 0 : test_uniform(&random, -1, 1), height = test_uniform(&random, -1, 1);
            struct vec3 foot = vec3_add_scaled(vec3_scale(u, across), is_in_plane ? normal : v, 0.3 * height);
            struct vec3 direction = vec3_normalize(vec3_add_scaled(is_in_plane ? v : normal, u, tilt));
            const struct ray ray = ray_from(vec3_add_scaled(foot, direction, -3), direction);
            struct crossing_list list;
            double enter, leave;
            if (!cover_by_samples(sweep, &ray, &enter, &leave))
                continue;
            scratch.used = 0;
            CHECK(sweep_crossings(sweep, &ray, &scratch, &list));
            CHECK(list.count >= 2);
            if (list.count < 2)
                continue;
            met++;
            CHECK_NEAR(scratch.items[list.first].t, enter, 1e-5);
            CHECK_NEAR(scratch.items[list.first + list.count - 1].t, leave, 1e-5);
        }
        arena_destroy(&arena);
    }
    CHECK(met > 1000);
    geom_scratch_destroy(&scratch);
}

TEST(sweep_bounds_are_tight) {
    struct test_random random = {42};
    struct arena arena = {0};
    for (int i = 0; i < 50; i++) {
        arena_reset(&arena);
        struct shape shape = random_sweep(&arena, &random, SPLINE_CATMULL_ROM);
        struct box b = shape_bounds(&shape);
        struct geom_scratch scratch;
        CHECK(geom_scratch_init(&scratch, 64));
        /* Some point of a plane just inside each side is in the shape. */
        double size = size_of(&shape);
        for (int side = 0; side < 6; side++) {
            bool touched = false;
            for (int n = 0; n < 300 && !touched; n++) {
                double lo[3] = {b.min.x, b.min.y, b.min.z}, hi[3] = {b.max.x, b.max.y, b.max.z}, o[3], d[3] = {0};
                int axis = side / 2, other = (axis + 1) % 3, third = (axis + 2) % 3;
                o[axis] = side % 2 ? lo[axis] + 0.01 * size : hi[axis] - 0.01 * size;
                o[other] = lo[other] + (hi[other] - lo[other]) * (n + 0.5) / 300;
                o[third] = 0;
                d[third] = 1;
                struct ray ray = ray_from(vec3_make(o[0], o[1], o[2]), vec3_make(d[0], d[1], d[2]));
                touched = shape_any(&shape, &ray, &scratch);
            }
            CHECK(touched);
        }
        geom_scratch_destroy(&scratch);
    }
    arena_destroy(&arena);
}

TEST(blob_of_one_ball_is_a_sphere_and_of_one_cylinder_a_capsule) {
    struct arena arena = {0};
    struct error error = {0};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    struct blob_element e = {{1, 2, 3}, {1, 2, 3}, 2, 1};
    struct blob_input in = {&e, 1, 0.25}; /* (1 - q)^2 = 1/4 at q = 1/2: radius sqrt(2) */
    struct shape ball = {.kind = SHAPE_BLOB, .blob = blob_build(&arena, &in, &error)};
    struct test_random random = {51};
    for (int i = 0; i < 20000; i++) {
        struct vec3 o = random_vec3(&random, 20), d = vec3_sub(vec3_add(e.a, random_vec3(&random, 0.7)), o);
        struct ray ray = ray_from(o, d);
        struct crossing_list list = list_of(&ball, &ray, &scratch);
        CHECK_EQ_INT(list.count, 2);
        for (uint32_t k = 0; k < list.count; k++)
            CHECK_NEAR(vec3_length(vec3_sub(ray_at(&ray, scratch.items[k].t), e.a)), sqrt(2), 1e-13);
    }
    struct box b = shape_bounds(&ball);
    CHECK(b.max.x >= 1 + sqrt(2) && b.max.x < 1 + sqrt(2) * 1.000001 && b.min.z <= 3 - sqrt(2) &&
          b.min.z > 3 - sqrt(2) * 1.000001);

    e.b = vec3_make(1, 2, 8);
    struct shape rod = {.kind = SHAPE_BLOB, .blob = blob_build(&arena, &in, &error)};
    for (int i = 0; i < 20000; i++) {
        struct vec3 o = random_vec3(&random, 20),
                    d = vec3_sub(vec3_add(vec3_make(1, 2, 5), random_vec3(&random, 1)), o);
        struct ray ray = ray_from(o, d);
        struct crossing_list list = list_of(&rod, &ray, &scratch);
        for (uint32_t k = 0; k < list.count; k++) {
            struct vec3 p = ray_at(&ray, scratch.items[k].t), c = {1, 2, fmin(fmax(p.z, 3), 8)};
            CHECK_NEAR(vec3_length(vec3_sub(p, c)), sqrt(2), 1e-12);
        }
    }
    in.threshold = 2; /* attained nowhere */
    struct shape nothing = {.kind = SHAPE_BLOB, .blob = blob_build(&arena, &in, &error)};
    struct ray ray = ray_from(vec3_make(1, 2, -20), vec3_make(0, 0, 1));
    CHECK_EQ_INT(list_of(&nothing, &ray, &scratch).count, 0);
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

/* A plane inside each side of the box, at 1 % of the size, meets the blob, because one of many lines in it does; and
 * nothing is outside. */
TEST(blobs_have_boxes_within_a_percent_of_the_tightest) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    int outside = 0, loose = 0;
    for (int turn = 0; turn < 12; turn++) {
        struct arena arena = {0};
        struct test_random random = {(uint64_t)(700 + turn)};
        struct shape shape = make(BLOB, &arena, &random);
        struct box box = shape_bounds(&shape);
        struct vec3 size = vec3_sub(box.max, box.min);
        for (int side = 0; side < 6; side++) {
            enum { LINES = 1500 };
            int axis = side / 2, second = (axis + 1) % 3, third = (axis + 2) % 3;
            bool reached = false;
            for (int i = 0; i < LINES; i++) {
                double o[3], d[3] = {0, 0, 0};
                double inside = side % 2 ? 0.01 : 0.99;
                o[axis] = vec3_get(box.min, axis) + inside * vec3_get(size, axis);
                o[second] = vec3_get(box.min, second) + (i + 0.5) / LINES * vec3_get(size, second);
                o[third] = vec3_get(box.min, third) - 1;
                d[third] = 1;
                struct ray ray = ray_from(vec3_make(o[0], o[1], o[2]), vec3_make(d[0], d[1], d[2]));
                struct crossing_list list = list_of(&shape, &ray, &scratch);
                reached = reached || list.count > 0;
                for (uint32_t k = 0; k < list.count; k++) {
                    double at = vec3_get(ray_at(&ray, scratch.items[k].t), third);
                    outside += at < vec3_get(box.min, third) || at > vec3_get(box.max, third);
                }
            }
            loose += !reached;
        }
        arena_destroy(&arena);
    }
    CHECK_EQ_INT(outside, 0);
    CHECK_EQ_INT(loose, 0);
    geom_scratch_destroy(&scratch);
}

TEST(height_field_has_the_box_of_its_points_under_affine_maps) {
    struct arena arena = {0};
    struct test_random random = {62};
    enum { COLUMNS = 13, ROWS = 10 };
    double heights[COLUMNS * ROWS];
    struct error error = {0};
    for (int turn = 0; turn < 100; turn++) {
        for (int i = 0; i < COLUMNS * ROWS; i++)
            heights[i] = test_uniform(&random, 0, 0.6);
        struct height_field_input in = {heights, COLUMNS, ROWS, turn & 1, -0.2, false};
        struct shape shape = {.kind = SHAPE_HEIGHT_FIELD, .height_field = height_field_build(&arena, &in, &error)};
        CHECK(shape.height_field != NULL);
        struct transform map = random_transform(&random);
        struct box found = shape_bounds_under(&shape, &map.forward), points = box_empty();
        for (int i = 0; i < COLUMNS * ROWS; i++) {
            double x = i % COLUMNS / (COLUMNS - 1.0), z = (double)(i / COLUMNS) / (ROWS - 1.0);
            points = box_add_point(points, affine_point(&map.forward, vec3_make(x, heights[i], z)));
            if (!in.open)
                points = box_add_point(points, affine_point(&map.forward, vec3_make(x, in.floor, z)));
        }
        double size = vec3_length(vec3_sub(points.max, points.min));
        CHECK(vec3_length(vec3_sub(found.min, points.min)) <= 1e-9 * size);
        CHECK(vec3_length(vec3_sub(found.max, points.max)) <= 1e-9 * size);
    }
    arena_destroy(&arena);
}

/* Every triangle and wall by brute force. */
TEST(height_field_is_crossed_where_its_triangles_are) {
    struct arena arena = {0};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 256));
    struct test_random random = {61};
    enum { COLUMNS = 9, ROWS = 6 };
    double heights[COLUMNS * ROWS];
    for (int i = 0; i < COLUMNS * ROWS; i++)
        heights[i] = test_uniform(&random, 0, 0.4);
    struct error error = {0};
    int wrong = 0, total = 0;
    for (int open = 0; open < 2; open++) {
        struct height_field_input in = {
            .heights = heights, .columns = COLUMNS, .rows = ROWS, .floor = -0.2, .open = open};
        struct shape shape = {.kind = SHAPE_HEIGHT_FIELD, .height_field = height_field_build(&arena, &in, &error)};
        CHECK(shape_is_closed(&shape) == !open);
        for (int i = 0; i < 20000; i++) {
            struct vec3 o = random_vec3(&random, 2),
                        target = vec3_add(vec3_make(0.5, 0.2, 0.5), random_vec3(&random, 0.5));
            struct ray ray = ray_from(o, vec3_sub(target, o));
            if (i % 5 == 0)
                ray.direction.y = 0;
            struct crossing_list list = list_of(&shape, &ray, &scratch);
            uint32_t count = 0, ground = 0;
            for (int cell = 0; cell < (COLUMNS - 1) * (ROWS - 1) * 2; cell++) {
                int c = cell / 2 % (COLUMNS - 1), r = cell / 2 / (COLUMNS - 1);
                int corners[3][2] = {{c, r}, {c + 1, r + 1}, {cell % 2 ? c : c + 1, cell % 2 ? r + 1 : r}};
                struct vec3 v[3];
                for (int k = 0; k < 3; k++)
                    v[k] = vec3_make(corners[k][0] / (COLUMNS - 1.0), heights[corners[k][1] * COLUMNS + corners[k][0]],
                                     corners[k][1] / (ROWS - 1.0));
                struct vec3 e1 = vec3_sub(v[1], v[0]), e2 = vec3_sub(v[2], v[0]), p = vec3_cross(ray.direction, e2);
                double det = vec3_dot(e1, p), u = vec3_dot(vec3_sub(o, v[0]), p) / det;
                struct vec3 q = vec3_cross(vec3_sub(o, v[0]), e1);
                double w = vec3_dot(ray.direction, q) / det;
                count += u >= 0 && w >= 0 && u + w <= 1;
            }
            for (uint32_t k = 0; k < list.count; k++)
                ground += scratch.items[k].part >= 5;
            total += (int)count;
            wrong += ground != count;
        }
    }
    CHECK(total > 20000);
    CHECK(wrong <= 2);
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

/* Local minima of the distance between line and curve, by dense sampling along the curve. */
TEST(curve_is_met_where_the_line_passes_nearer_than_half_its_width) {
    struct arena arena = {0};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    struct test_random random = {71};
    int wrong = 0, met = 0, misplaced = 0;
    enum { STEPS = 4000 };
    for (int i = 0; i < 1500; i++) {
        arena_reset(&arena);
        double points[4][3], widths[4];
        for (int k = 0; k < 12; k++)
            points[k / 3][k % 3] = test_uniform(&random, -1, 1);
        for (int k = 0; k < 4; k++)
            widths[k] = test_uniform(&random, 0.1, 0.5);
        struct error error = {0};
        struct curve_input in = {
            .kind = SPLINE_BEZIER, .points = (const double(*)[3])points, .widths = widths, .count = 4};
        struct shape shape = {.kind = SHAPE_CURVE, .curve = curve_build(&arena, &in, &error)};
        struct vec3 o = random_vec3(&random, 4), d = vec3_normalize(vec3_sub(random_vec3(&random, 0.5), o));
        struct ray ray = ray_from(o, d);
        struct crossing_list list = list_of(&shape, &ray, &scratch);
        double before = 0, here = 0;
        uint32_t expected = 0, doubtful = 0;
        for (int k = 0; k <= STEPS; k++) {
            double x = (double)k / STEPS, y = 1 - x, c[4] = {y * y * y, 3 * y * y * x, 3 * y * x * x, x * x * x};
            struct vec3 p = {0, 0, 0};
            double width = 0;
            for (int j = 0; j < 4; j++) {
                p = vec3_add_scaled(p, vec3_make(points[j][0], points[j][1], points[j][2]), c[j]);
                width += c[j] * widths[j];
            }
            struct vec3 q = vec3_sub(p, o);
            double distance = vec3_length(vec3_add_scaled(q, d, -vec3_dot(q, d)));
            if (k > 1 && here <= before && here < distance) {
                expected += 2 * here <= width;
                doubtful += fabs(2 * here - width) < 1e-3;
            }
            before = k > 0 ? here : distance;
            here = distance;
        }
        met += list.count > 0;
        wrong += doubtful == 0 && expected != list.count;
        struct box bounds = shape_bounds(&shape);
        for (uint32_t k = 0; k < list.count; k++) {
            struct surface s;
            shape_describe(&shape, &ray, &scratch.items[k], &s);
            misplaced += !(vec3_dot(s.normal, d) < 0) || !(s.v >= 0 && s.v <= 1 && s.u >= 0 && s.u <= 1) ||
                         !(s.behind >= 0.049) || !box_contains(&bounds, s.point);
        }
    }
    CHECK(met > 300);
    CHECK(wrong <= 2);
    CHECK_EQ_INT(misplaced, 0);
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

/* ---- patches ---- */

/* The six sides of a cube, inflated almost to a ball, each with its own rotation and handedness of parameters. */
static void bulged_cube(double (*points)[3]) {
    for (int side = 0; side < 6; side++)
        for (int j = 0; j < 4; j++)
            for (int i = 0; i < 4; i++) {
                int axis = side / 2, a = side % 4 == 1 ? 3 - i : i, b = j;
                if (side % 3 == 1) { /* exchange the parameters */
                    a = b;
                    b = side % 4 == 1 ? 3 - i : i;
                }
                double p[3], sign = side % 2 ? 1 : -1;
                p[axis] = sign;
                p[(axis + 1) % 3] = -1 + 2 * a / 3.0;
                p[(axis + 2) % 3] = -1 + 2 * b / 3.0;
                double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
                for (int k = 0; k < 3; k++)
                    points[16 * side + 4 * j + i][k] = p[k] / length * 2;
            }
}

static struct vec3 bezier_patch(const double (*points)[3], double u, double v) {
    double a[4] = {(1 - u) * (1 - u) * (1 - u), 3 * u * (1 - u) * (1 - u), 3 * u * u * (1 - u), u * u * u};
    double b[4] = {(1 - v) * (1 - v) * (1 - v), 3 * v * (1 - v) * (1 - v), 3 * v * v * (1 - v), v * v * v};
    struct vec3 p = {0, 0, 0};
    for (int k = 0; k < 16; k++)
        p = vec3_add_scaled(p, vec3_make(points[k][0], points[k][1], points[k][2]), a[k % 4] * b[k / 4]);
    return p;
}

TEST(patches_with_common_borders_share_every_vertex_there) {
    double points[96][3];
    bulged_cube(points);
    struct arena arena = {0};
    struct error error = {0};
    struct mesh_input input;
    struct patch_input in = {.name = "bulge", .points = (const double(*)[3])points, .count = 6, .tolerance = 0.002};
    CHECK(patch_tessellate(&arena, &in, &input, &error));
    /* Every edge is shared by two triangles: as a closed surface of V - E + F = 2 with E = 3 F / 2. */
    CHECK_EQ_INT(2 * (long long)input.vertex_count - input.face_count, 4);
    arena_destroy(&arena);
}

TEST(patch_mesh_is_as_near_as_its_tolerance_and_has_normals_and_uv) {
    struct test_random random = {95};
    for (int turn = 0; turn < 10; turn++) {
        double points[16][3];
        for (int k = 0; k < 16; k++) {
            points[k][0] = k % 4 + test_uniform(&random, -0.3, 0.3);
            points[k][1] = test_uniform(&random, -1, 1);
            points[k][2] = k / 4 + test_uniform(&random, -0.3, 0.3);
        }
        struct arena arena = {0};
        struct error error = {0};
        struct mesh_input input;
        struct patch_input in = {.name = "patch", .points = (const double(*)[3])points, .count = 1, .tolerance = 0.003};
        in.flip = turn % 2;
        CHECK(patch_tessellate(&arena, &in, &input, &error));
        double worst = 0;
        int turned = 0;
        for (uint32_t f = 0; f < input.face_count; f++) {
            struct vec3 sum = {0, 0, 0}, v[3];
            double u = 0, w = 0;
            for (int k = 0; k < 3; k++) {
                uint32_t at = input.face_start[f] + (uint32_t)k;
                const double *p = input.vertices[input.vertex_index[at]], *uv = input.uvs[input.uv_index[at]];
                v[k] = vec3_make(p[0], p[1], p[2]);
                sum = vec3_add_scaled(sum, v[k], 1.0 / 3);
                u += uv[0] / 3, w += uv[1] / 3;
                worst = fmax(worst,
                             vec3_length(vec3_sub(bezier_patch((const double(*)[3])points, uv[0], uv[1]), v[k])) * 1e9);
            }
            worst = fmax(worst, vec3_length(vec3_sub(bezier_patch((const double(*)[3])points, u, w), sum)));
            struct vec3 flat = vec3_cross(vec3_sub(v[1], v[0]), vec3_sub(v[2], v[0]));
            const double *n = input.normals[input.normal_index[input.face_start[f]]];
            turned += !(vec3_dot(flat, vec3_make(n[0], n[1], n[2])) > 0);
        }
        CHECK(worst <= 0.003 && worst > 0.0001);
        CHECK_EQ_INT(turned, 0);
        struct mesh *mesh = mesh_create(&input, &error);
        CHECK(mesh && mesh_has_uv(mesh) && mesh->normal_count > 0 && mesh_dropped_faces(mesh) == 0);
        mesh_release(mesh);
        arena_destroy(&arena);
    }
}

TEST(patch_with_a_border_that_is_a_point_has_normals_there) {
    double points[16][3];
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++) {
            double turn = i * 0.5, r = j / 3.0;
            points[4 * j + i][0] = r * cos(turn), points[4 * j + i][1] = 1 - r * r,
                           points[4 * j + i][2] = r * sin(turn);
        }
    struct arena arena = {0};
    struct error error = {0};
    struct mesh_input input;
    struct patch_input in = {.name = "cap", .points = (const double(*)[3])points, .count = 1};
    CHECK(patch_tessellate(&arena, &in, &input, &error));
    for (uint32_t i = 0; i < input.normal_count; i++)
        CHECK_NEAR(vec3_length(vec3_make(input.normals[i][0], input.normals[i][1], input.normals[i][2])), 1, 1e-12);
    struct mesh *mesh = mesh_create(&input, &error);
    CHECK(mesh && mesh_dropped_faces(mesh) == 0);
    mesh_release(mesh);
    in.tolerance = 1e-12;
    CHECK(!patch_tessellate(&arena, &in, &input, &error) && strstr(error.text, "too many"));
    arena_destroy(&arena);
}

/* ---- the roots below ---- */

TEST(bernstein_roots_find_random_roots_and_keep_parity) {
    struct test_random random = {11};
    int lost = 0, found_roots = 0;
    for (int i = 0; i < 100000; i++) {
        int degree = 1 + (int)test_uniform(&random, 0, 9.999), inside = 0;
        double b[BERNSTEIN_MAX_DEGREE + 1] = {1}, next[BERNSTEIN_MAX_DEGREE + 1], roots[BERNSTEIN_MAX_DEGREE],
                                        at[BERNSTEIN_MAX_DEGREE];
        bool apart = true;
        for (int k = 0; k < degree; k++) {
            double root = test_uniform(&random, -0.5, 1.5);
            if (root > 0 && root < 1) {
                for (int j = 0; j < inside; j++)
                    apart &= fabs(at[j] - root) > 0.02;
                at[inside++] = root;
            }
            bernstein_multiply(b, k, (double[]){-root, 1 - root}, 1, next);
            memcpy(b, next, sizeof b);
        }
        int count = bernstein_roots(b, degree, roots);
        CHECK(count <= degree && (count - ((b[0] < 0) != (b[degree] < 0))) % 2 == 0);
        if (apart) {
            lost += count != inside;
            found_roots += inside;
            for (int k = 0; k < count && count == inside; k++) {
                double best = 1;
                for (int j = 0; j < inside; j++)
                    best = fmin(best, fabs(at[j] - roots[k]));
                lost += best > 1e-4;
                CHECK(k == 0 || roots[k] >= roots[k - 1]);
            }
        }
    }
    CHECK(found_roots > 50000);
    CHECK_EQ_INT(lost, 0);
}
