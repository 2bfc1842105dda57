/* World boxes under any affine map, for the shapes whose tightest box is known in closed form: the shape is contained,
 * and the box is less than 1 % too large. The others are in test_analytic_shapes.c and test_swept_shapes.c, by
 * sampling. */
#include "mesh/patch.h"
#include "shape/curve.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/mesh_makers.h"
#include "tests/unit/random_makers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct transform random_transform(struct test_random *random) {
    struct transform t = transform_identity();
    for (int i = 0; i < 3; i++) {
        struct vec3 logs = random_vec3(random, 0.8);
        struct transform scale = transform_scale(vec3_make(exp(logs.x), -exp(logs.y), exp(logs.z)));
        struct transform turn = transform_rotate(i, test_uniform(random, 0, 360));
        t = transform_compose(&scale, &t);
        t = transform_compose(&turn, &t);
    }
    struct transform move = transform_translate(random_vec3(random, 5));
    return transform_compose(&move, &t);
}

static struct box corners_box(const struct affine *map, const double (*points)[3], uint32_t count) {
    struct box box = box_empty();
    for (uint32_t i = 0; i < count; i++)
        box = box_add_point(box, affine_point(map, vec3_make(points[i][0], points[i][1], points[i][2])));
    return box;
}

static void check_tight(const char *what, struct box found, struct box wanted) {
    struct vec3 size = vec3_sub(wanted.max, wanted.min);
    double large = vec3_max_abs(size);
    for (int axis = 0; axis < 3; axis++) {
        double below = vec3_get(wanted.min, axis) - vec3_get(found.min, axis);
        double above = vec3_get(found.max, axis) - vec3_get(wanted.max, axis);
        if (!(below >= -1e-9 * large && above >= -1e-9 * large && below < 0.01 * vec3_get(size, axis) &&
              above < 0.01 * vec3_get(size, axis)))
            test_fail(__FILE__, __LINE__, "%s, axis %d: %g below, %g above, of %g", what, axis, below, above,
                      vec3_get(size, axis));
    }
}

TEST(boxes_of_spheres_boxes_and_quadric_ellipsoids_are_the_closed_forms_under_affine_maps) {
    struct test_random random = {31};
    for (int i = 0; i < 300; i++) {
        struct transform map = i ? random_transform(&random) : transform_identity();
        struct vec3 centre = random_vec3(&random, 2), radii = {test_uniform(&random, 0.2, 2), 0.7, 1.3};
        struct shape sphere = {.kind = SHAPE_SPHERE, .sphere = {centre, radii.x}};
        struct shape box = {.kind = SHAPE_BOX, .box = {vec3_sub(centre, radii), vec3_add(centre, radii)}};
        /* (x - a)^2 / r^2 + ... = 1, turned by a shear: x becomes x + s y. */
        double s = test_uniform(&random, -0.8, 0.8);
        double a = 1 / (radii.x * radii.x), b = 1 / (radii.y * radii.y), c = 1 / (radii.z * radii.z);
        struct quadric quadric = {.c = {a, b + a * s * s, c, 2 * a * s, 0, 0, 0, 0, 0, -1},
                                  .limits = {vec3_all(-INFINITY), vec3_all(INFINITY)}};
        struct shape ellipsoid = {.kind = SHAPE_QUADRIC, .quadric = &quadric};
        struct vec3 ball_centre = affine_point(&map.forward, centre), origin = affine_point(&map.forward, vec3_all(0));
        struct vec3 ball, egg;
        double *ball_extent[3] = {&ball.x, &ball.y, &ball.z}, *egg_extent[3] = {&egg.x, &egg.y, &egg.z};
        double corners[8][3];
        for (int k = 0; k < 3; k++) {
            const double *row = map.forward.m[k];
            *ball_extent[k] = radii.x * sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
            /* Points are (r_x p - s r_y q, r_y q, r_z r) for p, q, r on the unit ball. */
            double p = radii.x * row[0], q = radii.y * (row[1] - s * row[0]), r = radii.z * row[2];
            *egg_extent[k] = sqrt(p * p + q * q + r * r);
        }
        for (int k = 0; k < 8; k++) {
            corners[k][0] = k & 1 ? box.box.max.x : box.box.min.x;
            corners[k][1] = k & 2 ? box.box.max.y : box.box.min.y;
            corners[k][2] = k & 4 ? box.box.max.z : box.box.min.z;
        }
        check_tight("sphere", shape_bounds_under(&sphere, &map.forward),
                    (struct box){vec3_sub(ball_centre, ball), vec3_add(ball_centre, ball)});
        check_tight("box", shape_bounds_under(&box, &map.forward),
                    corners_box(&map.forward, (const double(*)[3])corners, 8));
        check_tight("quadric", shape_bounds_under(&ellipsoid, &map.forward),
                    (struct box){vec3_sub(origin, egg), vec3_add(origin, egg)});
    }
}

/* Half an ellipsoid: the box may reach neither beyond its limits nor beyond the surface. */
TEST(boxes_of_cut_quadrics_hold_every_point_and_are_inside_both_boxes) {
    struct test_random random = {32};
    struct quadric whole = {.c = {1, 2, 0.5, 0.4, -0.3, 0.2, 0.1, -0.2, 0.3, -1},
                            .limits = {vec3_all(-INFINITY), vec3_all(INFINITY)}},
                   cut = whole;
    cut.limits = (struct box){{-INFINITY, 0.1, -0.4}, {0.5, INFINITY, INFINITY}};
    struct shape a = {.kind = SHAPE_QUADRIC, .quadric = &whole}, b = {.kind = SHAPE_QUADRIC, .quadric = &cut};
    struct geom_scratch none = {0};
    for (int i = 0; i < 60; i++) {
        struct transform map = random_transform(&random);
        struct box outer = shape_bounds_under(&a, &map.forward), inner = shape_bounds_under(&b, &map.forward);
        struct box mapped = shape_bounds(&b);
        mapped = box_pad(box_transform(&map.forward, &mapped));
        for (int axis = 0; axis < 3; axis++) {
            CHECK(vec3_get(inner.min, axis) >= fmax(vec3_get(outer.min, axis), vec3_get(mapped.min, axis)) - 1e-12);
            CHECK(vec3_get(inner.max, axis) <= fmin(vec3_get(outer.max, axis), vec3_get(mapped.max, axis)) + 1e-12);
        }
        for (int k = 0; k < 500; k++) {
            struct vec3 p = random_vec3(&random, 2);
            if (shape_contains(&b, p, &none))
                CHECK(box_contains(&inner, affine_point(&map.forward, p)));
        }
    }
}

TEST(boxes_of_transformed_meshes_and_patches_are_those_of_their_corners) {
    struct test_random random = {33};
    struct maker m = {0};
    maker_sphere(&m, 4);
    struct mesh_input ball_input = maker_input(&m);
    struct error error = {0};
    struct arena arena = {0};
    double net[16][3];
    for (int i = 0; i < 16; i++) {
        net[i][0] = i % 4, net[i][1] = test_uniform(&random, 0, 2), net[i][2] = i / 4;
    }
    struct patch_input patch = {.name = "patch", .points = (const double(*)[3])net, .count = 1};
    struct mesh_input patch_input;
    CHECK(patch_tessellate(&arena, &patch, &patch_input, &error));
    for (int i = 0; i < 20; i++) {
        struct stage s;
        stage_begin(&s, 1);
        const struct mesh_input *input = i % 2 ? &ball_input : &patch_input;
        struct node *node = stage_sphere(&s, s.root, stage_phong(&s, colour_all(1), colour_all(0), 1));
        node->shape = (struct shape){.kind = SHAPE_MESH, .mesh = assets_mesh(&s.assets, input, &s.error)};
        node->parent_from_node = random_transform(&random);
        CHECK(stage_build(&s, s.root, ACCEL_AUTO));
        check_tight("mesh", s.world.boxes[0],
                    corners_box(&node->parent_from_node.forward, input->vertices, input->vertex_count));
        stage_end(&s);
    }
    maker_free(&m);
    arena_destroy(&arena);
}

/* A hair has its full width across every ray: its box is that of balls along the spline. */
TEST(boxes_of_hair_are_those_of_balls_along_it) {
    struct test_random random = {34};
    for (int i = 0; i < 40; i++) {
        struct arena arena = {0};
        struct error error = {0};
        double points[2][3], widths[2];
        for (int k = 0; k < 2; k++) {
            struct vec3 p = random_vec3(&random, 1);
            points[k][0] = p.x, points[k][1] = p.y, points[k][2] = p.z;
            widths[k] = test_uniform(&random, 0.02, 0.3);
        }
        struct curve_input in = {
            .kind = SPLINE_LINEAR, .points = (const double(*)[3])points, .widths = widths, .count = 2};
        struct shape curve = {.kind = SHAPE_CURVE, .curve = curve_build(&arena, &in, &error)};
        struct transform map = random_transform(&random);
        struct box wanted = box_empty();
        for (int k = 0; k < 2; k++) {
            struct shape ball = {.kind = SHAPE_SPHERE,
                                 .sphere = {{points[k][0], points[k][1], points[k][2]}, widths[k] / 2}};
            wanted = box_join(wanted, shape_bounds_under(&ball, &map.forward));
        }
        check_tight("hair", shape_bounds_under(&curve, &map.forward), wanted);
        arena_destroy(&arena);
    }
}

static struct box_span span_by_single_planes(const struct box_probe *probe, const struct box *b) {
    const double *planes = (const double *)(const void *)b;
    double near_max = -INFINITY, far_min = INFINITY;
    for (int i = 0; i < 3; i++) {
        double near = (planes[probe->near[i]] - probe->origin[i][0]) * probe->inverse[i][0];
        double far = (planes[probe->far[i]] - probe->origin[i][0]) * probe->inverse[i][0];
        near_max = near > near_max ? near : near_max;
        far_min = far < far_min ? far : far_min;
    }
    const double near_less = near_max * (1 - 0x1p-49), near_more = near_max * (1 + 0x1p-49); /* infinities stay */
    const double far_less = far_min * (1 - 0x1p-49), far_more = far_min * (1 + 0x1p-49);
    return (struct box_span){near_less < near_more ? near_less : near_more, far_less > far_more ? far_less : far_more};
}

/* Rays along planes, from planes, along axes; boxes without end or without size: all bits agree. */
TEST(boxes_are_probed_two_planes_at_a_time_with_the_bits_of_one_at_a_time) {
    struct test_random random = {17};
    static const double special[] = {0, -0.0, 1, -1, INFINITY, -INFINITY, 0x1p-1000, 0x1p1000};
    long differ = 0;
    for (int i = 0; i < 200000; i++) {
        double n[12];
        for (int k = 0; k < 12; k++) {
            n[k] = test_uniform(&random, -2, 2);
            bool odd = test_uniform(&random, 0, 1) < 0.3;
            if (odd) /* origins and directions are finite */
                n[k] = special[(int)test_uniform(&random, 0, k < 6 ? 4 : 8)];
        }
        struct ray ray = {.origin = {n[0], n[1], n[2]}, .direction = {n[3], n[4], n[5]}};
        struct box box = {{n[6], n[7], n[8]}, {n[9], n[10], n[11]}};
        struct box_probe probe = box_probe_make(&ray);
        struct box_span plain = span_by_single_planes(&probe, &box), both = box_probe_span(&probe, &box);
        differ += memcmp(&plain, &both, sizeof plain) != 0;
    }
    CHECK_EQ_INT(differ, 0);
}
