/* Lathe, prism, sphere sweep, height field and blob together: crossings against point-by-point evaluation, normals
 * against finite differences, boxes, exactness under scaling, special lines, CSG, full scratch, failing allocations. */
#include "csg/csg_build.h"
#include "tests/unit/swept_makers.h"

TEST_TIMES(swept_shapes_cross_random_lines_where_points_say_so_under_random_affine_maps, 20) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    for (int maker = 0; maker < MAKERS; maker++) {
        struct test_random random = {(uint64_t)(100 + maker)};
        struct tally tally = {0};
        for (int turn = 0; turn < 40 * times; turn++) {
            struct arena arena = {0};
            struct shape shape = make((enum maker)maker, &arena, &random);
            double size = size_of(&shape);
            struct box bounds = shape_bounds(&shape);
            for (int i = 0; i < 80; i++) {
                struct transform map = random_transform(&random);
                struct vec3 q = {test_uniform(&random, bounds.min.x, bounds.max.x),
                                 test_uniform(&random, bounds.min.y, bounds.max.y),
                                 test_uniform(&random, bounds.min.z, bounds.max.z)};
                struct vec3 target = affine_point(&map.forward, q), origin = random_vec3(&random, 20);
                struct ray world = ray_from(origin, vec3_sub(target, origin));
                struct ray ray = ray_transform(&map.inverse, &world);
                check_ray(&shape, &ray, size, 60, true, &scratch, &tally);
                struct crossing_list list = list_of(&shape, &world, &scratch); /* any other line */
                CHECK_EQ_INT(list.count % 2, 0);
            }
            arena_destroy(&arena);
        }
        CHECK(tally.crossings > 1000 * (uint64_t)times && tally.slopes > 500 * (uint64_t)times);
        check_tally(&tally, maker_names[maker]);
    }
    geom_scratch_destroy(&scratch);
}

/* Rays that lie in planes of symmetry, along axes, through vertices of the defining points, almost level. */
TEST(swept_shapes_keep_parity_and_position_on_special_lines) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    const double exact[] = {0, 0.5, -0.5, 0.25, 1, -1, 0.3, 1e-300, 1e-17, -1e-9, 1e-5};
    for (int maker = 0; maker < MAKERS; maker++) {
        struct test_random random = {(uint64_t)(200 + maker)};
        struct tally tally = {0};
        for (int turn = 0; turn < 40; turn++) {
            struct arena arena = {0};
            struct shape shape = make((enum maker)maker, &arena, &random);
            double size = size_of(&shape);
            for (int i = 0; i < 400; i++) {
                double v[6];
                for (int k = 0; k < 6; k++)
                    v[k] = exact[(int)test_uniform(&random, 0, 10.999)];
                if (i % 3 == 0)
                    v[i % 6] = test_uniform(&random, -1, 1);
                if (i % 7 == 0)
                    v[3] = v[5] = 0;
                if (maker == FIELD) /* on edges and diagonals of cells, not in the planes of the walls */
                    v[0] = 0.5 + 0.25 * v[0], v[2] = 0.5 + 0.25 * v[2];
                struct ray ray = ray_from(vec3_make(v[0], v[1], v[2]), vec3_make(v[3], v[4], v[5]));
                if (!(vec3_max_abs(ray.direction) > 0))
                    continue;
                struct crossing_list list = list_of(&shape, &ray, &scratch);
                tally.disorder += list.count % 2;
                for (uint32_t k = 0; k < list.count; k++)
                    tally.disorder += scratch.items[k].enter != (k % 2 == 0) || isnan(scratch.items[k].t);
                /* Points of the line are tested where it does not run along a surface. */
                if (i % 3 == 0 && vec3_max_abs(ray.direction) > 1e-3 && i % 7)
                    check_ray(&shape, &ray, size, 40, false, &scratch, &tally);
            }
            arena_destroy(&arena);
        }
        if (tally.disorder || tally.disagree || tally.missed * 1000 > tally.rays)
            test_fail(__FILE__, __LINE__, "%s: disorder %lu, nearest %lu, missed %lu of %lu", maker_names[maker],
                      tally.disorder, tally.disagree, tally.missed, tally.rays);
    }
    geom_scratch_destroy(&scratch);
}

TEST(swept_shapes_have_no_crossings_with_rays_that_are_none) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    for (int maker = 0; maker < MAKERS; maker++) {
        struct arena arena = {0};
        struct test_random random = {7};
        struct shape shape = make((enum maker)maker, &arena, &random);
        const struct ray none[] = {
            ray_from(vec3_all(0.1), vec3_all(0)),        ray_from(vec3_all(NAN), vec3_make(1, 2, 3)),
            ray_from(vec3_all(0), vec3_make(NAN, 1, 0)), ray_from(vec3_all(0), vec3_all(INFINITY)),
            ray_from(vec3_all(INFINITY), vec3_all(1)),   ray_from(vec3_make(50, 0, 0), vec3_make(0, 1, 0))};
        for (size_t i = 0; i < sizeof none / sizeof none[0]; i++)
            CHECK_EQ_INT(list_of(&shape, &none[i], &scratch).count, 0);
        arena_destroy(&arena);
    }
    geom_scratch_destroy(&scratch);
}

/* From a distance of a million sizes the results are those of a ray that begins nearby, within the precision of the
 * origin. */
TEST(swept_shapes_are_crossed_from_far_away_as_from_near) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    for (int maker = 0; maker < MAKERS; maker++) {
        struct test_random random = {(uint64_t)(300 + maker)};
        int differ = 0, rays = 0;
        for (int turn = 0; turn < 10; turn++) {
            struct arena arena = {0};
            struct shape shape = make((enum maker)maker, &arena, &random);
            double size = size_of(&shape);
            for (int i = 0; i < 300; i++) {
                struct vec3 d = vec3_normalize(random_vec3(&random, 1)), p = random_vec3(&random, 0.5);
                struct ray near = ray_from(vec3_add_scaled(p, d, -2), d),
                           far = ray_from(vec3_add_scaled(p, d, -1e6), d);
                struct crossing own[64];
                struct crossing_list list = list_of(&shape, &near, &scratch);
                uint32_t count = list.count;
                memcpy(own, scratch.items, (count < 64 ? count : 64) * sizeof *own);
                list = list_of(&shape, &far, &scratch);
                rays++;
                differ += list.count != count;
                for (uint32_t k = 0; k < count && k < 64 && list.count == count; k++) {
                    struct surface s;
                    shape_describe(&shape, &far, &scratch.items[k], &s);
                    double off = fabs(vec3_dot(vec3_normalize(s.normal),
                                               vec3_sub(ray_at(&far, scratch.items[k].t), ray_at(&near, own[k].t))));
                    differ += off > 1e-8 * size;
                }
            }
            arena_destroy(&arena);
        }
        if (differ * 500 > rays)
            test_fail(__FILE__, __LINE__, "%s: %d of %d differ", maker_names[maker], differ, rays);
    }
    geom_scratch_destroy(&scratch);
}

TEST(swept_shapes_scaled_by_powers_of_two_give_the_same_t) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 256));
    const int exponents[] = {-120, -10, 20, 90};
    for (int kind = 0; kind < 6; kind++)
        for (int e = 0; e < 4; e++) {
            struct arena arena = {0};
            struct shape shapes[2];
            double scale = ldexp(1, exponents[e]);
            for (int which = 0; which < 2; which++) {
                double s = which ? scale : 1, points[8][2], centres[4][3], radii[4];
                struct error error = {0};
                for (int i = 0; i < 8; i++)
                    points[i][0] = vase[i][0] * s, points[i][1] = vase[i][1] * s;
                for (int i = 0; i < 4; i++) {
                    centres[i][0] = s * 0.3 * i, centres[i][1] = s * (i % 2), centres[i][2] = s * 0.1 * i * i;
                    radii[i] = s * (0.1 + 0.05 * i);
                }
                enum spline_kind spline = kind % 2 ? SPLINE_CATMULL_ROM : SPLINE_LINEAR;
                if (kind < 2) {
                    shapes[which] = make_lathe(&arena, spline, (const double(*)[2])points, 8, false, false);
                } else if (kind < 4) {
                    struct sweep_input in = {
                        .kind = spline, .points = (const double(*)[3])centres, .radii = radii, .count = 4};
                    shapes[which] = (struct shape){.kind = SHAPE_SWEEP, .sweep = sweep_build(&arena, &in, &error)};
                } else if (kind == 4) {
                    struct blob_element elements[4];
                    for (int i = 0; i < 4; i++) {
                        elements[i].a = vec3_make(centres[i][0], centres[i][1], centres[i][2]);
                        elements[i].b = i % 2 ? vec3_all(0) : elements[i].a;
                        elements[i].radius = 5 * radii[i];
                        elements[i].strength = 1;
                    }
                    struct blob_input in = {.elements = elements, .count = 4, .threshold = 0.5};
                    shapes[which] = (struct shape){.kind = SHAPE_BLOB, .blob = blob_build(&arena, &in, &error)};
                } else {
                    uint32_t starts[] = {0, 8};
                    struct prism_input in = {.kind = SPLINE_CATMULL_ROM,
                                             .points = (const double(*)[2])points,
                                             .curve_starts = starts,
                                             .curve_count = 1,
                                             .from = 0,
                                             .to = s};
                    shapes[which] = (struct shape){.kind = SHAPE_PRISM, .prism = prism_build(&arena, &in, &error)};
                }
            }
            struct test_random random = {(uint64_t)(kind * 10 + e)};
            int crossed = 0, differ = 0;
            for (int i = 0; i < 2000; i++) {
                struct vec3 o = random_vec3(&random, 3), d = vec3_sub(random_vec3(&random, 0.8), o);
                struct ray ray = ray_from(o, d), scaled = ray_from(vec3_scale(o, scale), vec3_scale(d, scale));
                struct crossing own[64];
                struct crossing_list list = list_of(&shapes[0], &ray, &scratch);
                uint32_t count = list.count;
                memcpy(own, scratch.items, count * sizeof *own);
                crossed += count > 0;
                list = list_of(&shapes[1], &scaled, &scratch);
                differ += list.count != count;
                for (uint32_t k = 0; k < count && list.count == count; k++)
                    differ += own[k].t != scratch.items[k].t || own[k].part != scratch.items[k].part;
            }
            CHECK(crossed > 200);
            if (differ)
                test_fail(__FILE__, __LINE__, "kind %d, 2^%d: %d differ", kind, exponents[e], differ);
            arena_destroy(&arena);
        }
    geom_scratch_destroy(&scratch);
}

/* ---- together ---- */

TEST(swept_shapes_in_csg_equal_point_by_point_evaluation) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 2000));
    struct test_random random = {81};
    uint64_t wrong = 0, inward = 0, insides = 0, disorder = 0;
    for (int tree = 0; tree < 150; tree++) {
        struct arena arena = {0};
        struct csg_leaf leaves[4];
        struct csg_token program[7];
        uint32_t count = 2 + (uint32_t)tree % 3, length = 0;
        for (uint32_t i = 0; i < count; i++) {
            leaves[i] = (struct csg_leaf){.shape = make((enum maker)((tree + (int)i * 4) % MAKERS), &arena, &random)};
            struct transform move = transform_translate(random_vec3(&random, 0.4)),
                             turn = transform_rotate((int)i % 3, test_uniform(&random, 0, 360));
            leaves[i].csg_from_leaf = transform_compose(&move, &turn);
            program[length++] = (struct csg_token){CSG_LEAF, (uint16_t)i};
            if (i > 0) {
                double pick = test_uniform(&random, 0, 3);
                program[length++] = (struct csg_token){pick < 1   ? CSG_UNION
                                                       : pick < 2 ? CSG_INTERSECTION
                                                                  : CSG_DIFFERENCE,
                                                       0};
            }
        }
        struct error error = {0};
        const struct csg *csg = csg_build(&arena, leaves, count, program, length, &error);
        CHECK(csg != NULL);
        for (int i = 0; csg && i < 300; i++) {
            struct vec3 o = random_vec3(&random, 4);
            struct ray ray = ray_from(o, vec3_sub(random_vec3(&random, 0.8), o));
            struct geometry solid = geometry_of_csg(csg);
            struct crossing_list list = list_of_geometry(&solid, &ray, &scratch);
            disorder += list.count % 2;
            struct crossing own[64];
            uint32_t n = list.count < 64 ? list.count : 64;
            memcpy(own, scratch.items, n * sizeof *own);
            for (uint32_t k = 0; k + 1 < n; k++) {
                disorder += own[k].enter != (k % 2 == 0);
                if (own[k + 1].t - own[k].t < 1e-9)
                    continue;
                bool inside = csg_contains(csg, ray_at(&ray, own[k].t / 2 + own[k + 1].t / 2), &scratch);
                wrong += inside != (k % 2 == 0);
                insides += inside;
                struct surface s;
                csg_describe(csg, &ray, &own[k], &s);
                inward += own[k].enter != (vec3_dot(s.normal, ray.direction) < 0);
            }
        }
        arena_destroy(&arena);
    }
    CHECK(insides > 5000);
    CHECK_EQ_INT(disorder, 0);
    CHECK_EQ_INT(wrong, 0);
    CHECK_EQ_INT(inward, 0);
    geom_scratch_destroy(&scratch);
}

TEST(swept_shapes_report_a_full_scratch_and_answer_after_it_has_grown) {
    struct test_random random = {91};
    for (int maker = 0; maker < MAKERS; maker++) {
        struct arena arena = {0};
        struct shape shape = make((enum maker)maker, &arena, &random);
        struct geom_scratch large, small;
        CHECK(geom_scratch_init(&large, 1024) && geom_scratch_init(&small, 16));
        for (int i = 0; i < 200; i++) {
            struct vec3 o = random_vec3(&random, 3);
            struct ray ray = ray_from(o, vec3_sub(random_vec3(&random, 0.5), o));
            struct crossing_list list = list_of(&shape, &ray, &large), other = {0, 0};
            for (uint32_t room = 0; room < 12; room++) {
                uint32_t base = small.capacity > room ? small.capacity - room : 0;
                small.used = base;
                small.overflow = false;
                if (shape_crossings(&shape, &ray, &small, &other)) {
                    CHECK(!small.overflow && other.first == base && small.used == base + other.count);
                    CHECK_EQ_INT(other.count, list.count);
                } else {
                    CHECK(small.overflow && small.used == base);
                }
            }
            small.used = 0;
            small.overflow = false;
            other = list_of(&shape, &ray, &small);
            CHECK_EQ_INT(other.count, list.count);
            for (uint32_t k = 0; k < list.count && k < other.count; k++)
                CHECK(small.items[k].t == large.items[k].t);
        }
        geom_scratch_destroy(&large);
        geom_scratch_destroy(&small);
        arena_destroy(&arena);
    }
}

/* dpdu and dpdv agree with how the point moves when u and v do: p(next) - p = dpdu du + dpdv dv to first order. */
TEST(swept_shapes_have_derivatives_that_follow_their_image_coordinates) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 256));
    const enum maker makers[] = {LATHE_LINEAR, LATHE_SPLINE, PRISM_LINEAR, PRISM_SPLINE, FIELD, BLOB};
    for (int m = 0; m < 6; m++) {
        struct test_random random = {(uint64_t)(400 + m)};
        int checked = 0, wrong = 0, outside = 0;
        for (int turn = 0; turn < 20; turn++) {
            struct arena arena = {0};
            struct shape shape = make(makers[m], &arena, &random);
            for (int i = 0; i < 300; i++) {
                struct vec3 o = random_vec3(&random, 5);
                struct ray ray = ray_from(o, vec3_sub(random_vec3(&random, 0.8), o)), near = ray;
                near.direction = vec3_add(near.direction, random_vec3(&random, 1e-6));
                struct crossing a, b;
                scratch.used = 0;
                if (!shape_nearest(&shape, &ray, &scratch, &a) || !shape_nearest(&shape, &near, &scratch, &b) ||
                    a.part != b.part)
                    continue;
                struct surface s, t;
                shape_describe(&shape, &ray, &a, &s);
                shape_describe(&shape, &near, &b, &t);
                outside += !(s.has_uv && s.u >= 0 && s.u <= 1 && s.v >= 0 && s.v <= 1);
                struct vec3 moved = vec3_sub(t.point, s.point);
                if (fabs(s.u - t.u) > 0.5 || vec3_length(moved) > 1e-4)
                    continue;
                struct vec3 reported = vec3_add(vec3_scale(s.dpdu, t.u - s.u), vec3_scale(s.dpdv, t.v - s.v));
                checked++;
                wrong += !(vec3_length(vec3_sub(moved, reported)) <= 2e-3 * vec3_length(moved) + 1e-12);
            }
            arena_destroy(&arena);
        }
        CHECK_EQ_INT(outside, 0);
        if (checked < 500 || wrong * 500 > checked)
            test_fail(__FILE__, __LINE__, "%s: %d of %d wrong", maker_names[makers[m]], wrong, checked);
    }
    geom_scratch_destroy(&scratch);
}

/* u increases to the right and v upwards as seen from outside, or both are reversed, but not only one. */
TEST(swept_shapes_never_show_pictures_mirrored) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 256));
    for (int maker = 0; maker <= MAKERS; maker++) {
        struct test_random random = {(uint64_t)(900 + maker)};
        int mirrored = 0, checked = 0;
        for (int turn = 0; turn < 30; turn++) {
            struct arena arena = {0};
            struct error error = {0};
            double points[4][3], widths[4];
            struct shape shape;
            if (maker == MAKERS) {
                for (int k = 0; k < 4; k++) {
                    struct vec3 p = random_vec3(&random, 1);
                    points[k][0] = p.x, points[k][1] = p.y, points[k][2] = p.z, widths[k] = 0.3;
                }
                struct curve_input in = {
                    .kind = SPLINE_BEZIER, .points = (const double(*)[3])points, .widths = widths, .count = 4};
                shape = (struct shape){.kind = SHAPE_CURVE, .curve = curve_build(&arena, &in, &error)};
            } else {
                shape = make((enum maker)maker, &arena, &random);
            }
            for (int i = 0; i < 200; i++) {
                struct vec3 o = random_vec3(&random, 4);
                struct ray ray = ray_from(o, vec3_sub(random_vec3(&random, 0.8), o));
                struct crossing_list list = list_of(&shape, &ray, &scratch);
                for (uint32_t k = 0; k < list.count; k++) {
                    struct surface s;
                    shape_describe(&shape, &ray, &scratch.items[k], &s);
                    struct vec3 both = vec3_cross(s.dpdu, s.dpdv);
                    if (!s.has_uv || !(vec3_length(both) > 1e-9))
                        continue;
                    checked++;
                    mirrored += vec3_dot(both, s.normal) < 0;
                }
            }
            arena_destroy(&arena);
        }
        if (mirrored || checked < 1000)
            test_fail(__FILE__, __LINE__, "%s: %d of %d", maker < MAKERS ? maker_names[maker] : "hair", mirrored,
                      checked);
    }
    geom_scratch_destroy(&scratch);
}

/* The box under a map holds the crossings, and another one, one percent smaller, does not. */
TEST_TIMES(swept_shapes_have_tight_boxes_under_affine_maps, 4) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 256));
    for (int maker = 0; maker < MAKERS; maker++) {
        if (maker == FIELD) /* lines miss its peaks: height_field_has_the_box_of_its_points_under_affine_maps */
            continue;
        struct test_random random = {(uint64_t)(500 + maker)};
        int outside = 0, loose = 0;
        for (int turn = 0; turn < 10 * times; turn++) {
            struct arena arena = {0};
            struct shape shape = make((enum maker)maker, &arena, &random);
            struct transform map = random_transform(&random);
            struct box box = shape_bounds_under(&shape, &map.forward);
            struct vec3 size = vec3_sub(box.max, box.min), slack = vec3_scale(size, 1e-9);
            for (int side = 0; side < 6; side++) {
                int axis = side / 2, second = (axis + 1) % 3, third = (axis + 2) % 3;
                double lo[3] = {box.min.x, box.min.y, box.min.z}, span[3] = {size.x, size.y, size.z};
                bool reached = false;
                /* A plane 1 % inside the box must meet the shape: tested by lines in it. */
                for (int n = 0; n < 4000 && !reached; n++) {
                    double o[3], d[3] = {0, 0, 0};
                    o[axis] = lo[axis] + span[axis] * (side % 2 ? 0.99 : 0.01);
                    o[second] = lo[second] + span[second] * (n + 0.5) / 4000;
                    o[third] = lo[third];
                    d[third] = 1;
                    struct ray world = ray_from(vec3_make(o[0], o[1], o[2]), vec3_make(d[0], d[1], d[2]));
                    struct ray ray = ray_transform(&map.inverse, &world);
                    struct crossing_list list = list_of(&shape, &ray, &scratch);
                    for (uint32_t k = 0; k < list.count; k++) {
                        struct vec3 p = ray_at(&world, scratch.items[k].t);
                        struct vec3 below = vec3_sub(vec3_sub(box.min, slack), p),
                                    above = vec3_sub(p, vec3_add(box.max, slack));
                        outside +=
                            fmax(fmax(below.x, fmax(below.y, below.z)), fmax(above.x, fmax(above.y, above.z))) > 0;
                    }
                    reached = list.count > 0;
                }
                loose += !reached;
            }
            arena_destroy(&arena);
        }
        if (outside || loose)
            test_fail(__FILE__, __LINE__, "%s: outside %d, loose %d", maker_names[maker], outside, loose);
    }
    geom_scratch_destroy(&scratch);
}

TEST(swept_shapes_survive_any_allocation_that_fails) {
    uint64_t before = mem_allocations();
    void *probe = mem_alloc(1);
    mem_free(probe);
    if (mem_allocations() == before)
        test_skip("allocations fail on demand only in builds with GRAY_FAULTS");
    struct error error = {0};
    double heights[64 * 64] = {0}, centres[40][3], radii[40];
    struct blob_element elements[200];
    for (int i = 0; i < 40; i++) {
        centres[i][0] = i, centres[i][1] = i % 3, centres[i][2] = i % 5;
        radii[i] = 1;
    }
    for (int i = 0; i < 200; i++)
        elements[i] = (struct blob_element){{i, 0, 0}, {i, 1, 0}, 1, 1};
    for (int kind = 0; kind < 6; kind++)
        for (uint64_t k = 1; k < 50; k++) {
            struct arena arena = {0};
            const void *built = NULL;
            error = (struct error){0};
            mem_fail_at(k);
            if (kind == 0)
                built = lathe_build(
                    &arena, &(struct lathe_input){.kind = SPLINE_CATMULL_ROM, .points = vase, .count = 8}, &error);
            else if (kind == 1)
                built = prism_build(&arena,
                                    &(struct prism_input){.kind = SPLINE_CATMULL_ROM,
                                                          .points = star,
                                                          .curve_starts = (const uint32_t[]){0, 13},
                                                          .curve_count = 1,
                                                          .to = 1},
                                    &error);
            else if (kind == 2)
                built = sweep_build(
                    &arena,
                    &(struct sweep_input){
                        .kind = SPLINE_B_SPLINE, .points = (const double(*)[3])centres, .radii = radii, .count = 40},
                    &error);
            else if (kind == 3)
                built = curve_build(
                    &arena,
                    &(struct curve_input){
                        .kind = SPLINE_B_SPLINE, .points = (const double(*)[3])centres, .widths = radii, .count = 40},
                    &error);
            else if (kind == 4)
                built = blob_build(&arena, &(struct blob_input){elements, 200, 0.5}, &error);
            else
                built = height_field_build(
                    &arena, &(struct height_field_input){.heights = heights, .columns = 64, .rows = 64, .floor = -1},
                    &error);
            mem_fail_at(0);
            CHECK(built ? error.kind == ERROR_NONE : error.kind == ERROR_MACHINE);
            arena_destroy(&arena);
        }
}

TEST(swept_shapes_refuse_what_makes_no_sense) {
    struct arena arena = {0};
    struct error error = {0};
    const double left[][2] = {{0, 0}, {-1, 1}, {0, 2}}, one[][2] = {{1, 1}}, same[][2] = {{1, 1}, {1, 1}};
    const double nan_point[][2] = {{0, 0}, {NAN, 1}};
    CHECK(!lathe_build(&arena, &(struct lathe_input){.points = left, .count = 3}, &error));
    CHECK(strstr(error.text, "negative radius"));
    CHECK(!lathe_build(&arena, &(struct lathe_input){.points = one, .count = 1}, &error));
    CHECK(!lathe_build(&arena, &(struct lathe_input){.points = same, .count = 2, .open = true}, &error));
    CHECK(!lathe_build(&arena, &(struct lathe_input){.points = nan_point, .count = 2}, &error));
    CHECK(!lathe_build(&arena, &(struct lathe_input){.kind = SPLINE_BEZIER, .points = star, .count = 6}, &error));
    CHECK(strstr(error.text, "3 n + 1"));
    const uint32_t starts[] = {0, 2};
    CHECK(!prism_build(&arena, &(struct prism_input){.points = star, .curve_starts = starts, .curve_count = 1, .to = 1},
                       &error));
    const uint32_t all[] = {0, 13};
    CHECK(!prism_build(&arena,
                       &(struct prism_input){.points = star, .curve_starts = all, .curve_count = 1, .from = 1, .to = 1},
                       &error));
    const double centres[][3] = {{0, 0, 0}, {1, 0, 0}}, radii[] = {0, 0}, negative[] = {1, -1};
    CHECK(!sweep_build(&arena, &(struct sweep_input){.points = centres, .radii = radii, .count = 2}, &error));
    CHECK(!sweep_build(&arena, &(struct sweep_input){.points = centres, .radii = negative, .count = 2}, &error));
    CHECK(!sweep_build(&arena, &(struct sweep_input){.points = centres, .radii = negative, .count = 1}, &error));
    CHECK(!curve_build(&arena, &(struct curve_input){.points = centres, .widths = negative, .count = 2}, &error));
    const double heights[] = {0, 0, 0, 0};
    CHECK(
        !height_field_build(&arena, &(struct height_field_input){.heights = heights, .columns = 2, .rows = 1}, &error));
    CHECK(
        !height_field_build(&arena, &(struct height_field_input){.heights = heights, .columns = 2, .rows = 2}, &error));
    CHECK(strstr(error.text, "floor"));
    const struct blob_element element = {{0, 0, 0}, {0, 0, 0}, 0, 1};
    CHECK(!blob_build(&arena, &(struct blob_input){&element, 1, 1}, &error));
    CHECK(!blob_build(&arena, &(struct blob_input){&element, 0, 1}, &error));
    arena_destroy(&arena);
}
