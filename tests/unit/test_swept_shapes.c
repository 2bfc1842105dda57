/* Lathe, prism, sphere sweep, height field, blob and curve: crossings against point-by-point evaluation, normals against
 * finite differences, bounds, exactness under scaling, degenerate rays, CSG, full scratch; the Bernstein roots below them. */
#include "base/mem.h"
#include "geom/bernstein.h"
#include "geom/csg.h"
#include "geom/mesh.h"
#include "geom/patch.h"
#include "geom/shape.h"
#include "geom/shape_blob.h"
#include "geom/shape_curve.h"
#include "geom/shape_height_field.h"
#include "geom/shape_lathe.h"
#include "geom/shape_prism.h"
#include "geom/shape_sweep.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct vec3 random_vec3(struct test_random *random, double size) {
    double x = test_uniform(random, -size, size), y = test_uniform(random, -size, size);
    double z = test_uniform(random, -size, size);
    return vec3_make(x, y, z);
}

static struct transform random_transform(struct test_random *random) {
    struct transform t = transform_identity();
    for (int i = 0; i < 3; i++) {
        double sx = exp(test_uniform(random, -1, 1)), sy = exp(test_uniform(random, -1, 1));
        double sz = exp(test_uniform(random, -1, 1)), angle = test_uniform(random, 0, 360);
        if (test_uniform(random, 0, 1) < 0.3)
            sy = -sy;
        struct transform scale = transform_scale(vec3_make(sx, sy, sz)), turn = transform_rotate(i, angle);
        struct transform move = transform_translate(random_vec3(random, 3));
        t = transform_compose(&scale, &t);
        t = transform_compose(&turn, &t);
        t = transform_compose(&move, &t);
    }
    return t;
}

static struct ray ray_from(struct vec3 origin, struct vec3 direction) {
    return (struct ray){.origin = origin, .direction = direction, .t_min = -INFINITY, .t_max = INFINITY};
}

/* ---- makers ---- */

static struct shape make_lathe(struct arena *arena, enum spline_kind kind, const double (*points)[2], uint32_t count,
                               bool loop, bool open) {
    struct error error = {0};
    struct lathe_input in = {.kind = kind, .points = points, .count = count, .loop = loop, .open = open};
    struct shape shape = {.kind = SHAPE_LATHE};
    shape.lathe = lathe_build(arena, &in, &error);
    if (!shape.lathe)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return shape;
}

static const double vase[][2] = {{0, 0}, {0.6, 0}, {0.8, 0.3}, {0.3, 0.9}, {0.25, 1.3}, {0.5, 1.6}, {0.4, 1.6}, {0, 1.2}};
static const double star[][2] = {{1, 0}, {0.3, 0.2}, {0.3, 0.9}, {-0.2, 0.3}, {-0.9, 0.6}, {-0.4, 0}, {-0.8, -0.6}, {-0.1, -0.35}, {0.3, -0.9}, {0.35, -0.25},
                                 {0.2, 0}, {-0.1, 0.15}, {-0.1, -0.15}};

/* Random points along a curve that does not fold up too much. */
static struct shape random_lathe(struct arena *arena, struct test_random *random, enum spline_kind kind) {
    double points[40][2];
    uint32_t count = 4 + (uint32_t)test_uniform(random, 0, 8);
    bool axis = test_uniform(random, 0, 1) < 0.5, loop = !axis && test_uniform(random, 0, 1) < 0.3;
    for (uint32_t i = 0; i < count; i++) {
        double turn = loop ? 6.283185307 * i / count : 3.14159265 * i / (count - 1);
        double reach = test_uniform(random, 0.5, 1);
        points[i][0] = loop ? 1.5 + reach * cos(turn) : fmax(0.05, reach * sin(turn));
        points[i][1] = loop ? reach * sin(turn) : -reach * cos(turn);
    }
    if (axis)
        points[0][0] = points[count - 1][0] = 0;
    return make_lathe(arena, kind, (const double(*)[2])points, count, loop, false);
}

static struct shape random_prism(struct arena *arena, struct test_random *random, enum spline_kind kind) {
    double points[60][2];
    uint32_t count = 5 + (uint32_t)test_uniform(random, 0, 20), starts[3] = {0, count, count + 6};
    for (uint32_t i = 0; i < count + 6; i++) {
        bool hole = i >= count;
        double turn = hole ? 6.283185307 * (i - count) / 6 : 6.283185307 * i / count;
        double reach = hole ? test_uniform(random, 0.1, 0.25) : test_uniform(random, 0.4, 1.2);
        points[i][0] = reach * cos(turn);
        points[i][1] = reach * sin(turn);
    }
    struct error error = {0};
    struct prism_input in = {.kind = kind, .points = (const double(*)[2])points, .curve_starts = starts, .curve_count = 2};
    in.from = test_uniform(random, -1, 0);
    in.to = test_uniform(random, 0.01, 1);
    struct shape shape = {.kind = SHAPE_PRISM};
    shape.prism = prism_build(arena, &in, &error);
    if (!shape.prism)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return shape;
}

static struct shape random_sweep(struct arena *arena, struct test_random *random, enum spline_kind kind) {
    double points[40][3], radii[40];
    uint32_t count = 2 + (uint32_t)test_uniform(random, 0, 8);
    for (uint32_t i = 0; i < count; i++) {
        struct vec3 p = random_vec3(random, 1);
        points[i][0] = p.x, points[i][1] = p.y, points[i][2] = p.z;
        radii[i] = test_uniform(random, 0.03, 0.3);
    }
    struct error error = {0};
    struct sweep_input in = {.kind = kind, .points = (const double(*)[3])points, .radii = radii, .count = count};
    in.loop = count > 3 && test_uniform(random, 0, 1) < 0.3;
    struct shape shape = {.kind = SHAPE_SWEEP};
    shape.sweep = sweep_build(arena, &in, &error);
    if (!shape.sweep)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return shape;
}

static struct shape random_height_field(struct arena *arena, struct test_random *random, uint32_t most) {
    uint32_t columns = 2 + (uint32_t)test_uniform(random, 0, most), rows = 2 + (uint32_t)test_uniform(random, 0, most);
    double *heights = arena_alloc_array(arena, (size_t)columns * rows, sizeof *heights);
    for (uint32_t i = 0; i < columns * rows; i++)
        heights[i] = test_uniform(random, 0, 0.3) + 0.2 * sin(7.0 * (i % columns) / columns) + 0.2;
    struct error error = {0};
    struct height_field_input in = {.heights = heights, .columns = columns, .rows = rows, .floor = -0.1};
    struct shape shape = {.kind = SHAPE_HEIGHT_FIELD};
    shape.height_field = height_field_build(arena, &in, &error);
    if (!shape.height_field)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return shape;
}

static struct shape random_blob(struct arena *arena, struct test_random *random) {
    struct blob_element elements[24];
    uint32_t count = 1 + (uint32_t)test_uniform(random, 0, 12);
    for (uint32_t i = 0; i < count; i++) {
        struct blob_element *e = &elements[i];
        e->a = e->b = random_vec3(random, 0.8);
        if (i % 3 == 1)
            e->b = random_vec3(random, 0.8);
        e->radius = test_uniform(random, 0.3, 0.9);
        e->strength = i % 5 == 4 ? -0.7 : test_uniform(random, 0.8, 2);
    }
    elements[0].strength = 1.5;
    struct error error = {0};
    struct blob_input in = {.elements = elements, .count = count, .threshold = 0.6};
    struct shape shape = {.kind = SHAPE_BLOB};
    shape.blob = blob_build(arena, &in, &error);
    if (!shape.blob)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return shape;
}

enum maker { LATHE_LINEAR, LATHE_SPLINE, PRISM_LINEAR, PRISM_SPLINE, SWEEP_LINEAR, SWEEP_SPLINE, SWEEP_B, FIELD, BLOB, MAKERS };
static const char *const maker_names[] = {"linear lathe", "spline lathe", "linear prism", "spline prism", "linear sweep", "spline sweep",
                                          "B-spline sweep", "height field", "blob"};

static struct shape make(enum maker maker, struct arena *arena, struct test_random *random) {
    switch (maker) {
    case LATHE_LINEAR: return random_lathe(arena, random, SPLINE_LINEAR);
    case LATHE_SPLINE: return random_lathe(arena, random, SPLINE_B_SPLINE);
    case PRISM_LINEAR: return random_prism(arena, random, SPLINE_LINEAR);
    case PRISM_SPLINE: return random_prism(arena, random, SPLINE_CATMULL_ROM);
    case SWEEP_LINEAR: return random_sweep(arena, random, SPLINE_LINEAR);
    case SWEEP_SPLINE: return random_sweep(arena, random, SPLINE_CATMULL_ROM);
    case SWEEP_B: return random_sweep(arena, random, SPLINE_B_SPLINE);
    case FIELD: return random_height_field(arena, random, 20);
    case BLOB:
    case MAKERS: break;
    }
    return random_blob(arena, random);
}

/* ---- checks that hold for every closed shape ---- */

static struct crossing_list list_of(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch) {
    struct crossing_list list = {0, 0};
    scratch->used = 0;
    while (!shape_crossings(shape, ray, scratch, &list)) {
        CHECK(scratch->overflow && scratch->used == 0);
        CHECK(geom_scratch_grow(scratch));
    }
    return list;
}

struct tally {
    uint64_t rays, crossings, disorder, bad_residual, bad_place, missed, outside_bounds, bad_slope, slopes, disagree, turned;
};

static void check_crossing(const struct shape *shape, const struct ray *ray, const struct crossing *c, double size,
                           struct geom_scratch *scratch, struct tally *tally) {
    struct surface s;
    struct crossing copy = *c;
    shape_describe(shape, ray, &copy, &s);
    struct vec3 p = ray_at(ray, copy.t), n = vec3_normalize(s.normal);
    tally->bad_place += !(vec3_length(vec3_sub(p, s.point)) < 1e-9 * size + 1e-14 * vec3_length(ray->origin));
    /* On the surface to 1e-9 of its size, and the normal points out. */
    struct vec3 out = vec3_add_scaled(p, n, 1e-9 * size), in = vec3_add_scaled(p, n, -1e-9 * size);
    tally->bad_residual += shape_contains(shape, out, scratch) || !shape_contains(shape, in, scratch);
    tally->turned += copy.enter != (vec3_dot(s.normal, ray->direction) < 0);
    struct box bounds = shape_bounds(shape);
    tally->outside_bounds += !box_contains(&bounds, s.point);

    /* A neighbouring ray's crossing lies in the tangent plane. */
    struct ray near = *ray;
    double t = copy.t;
    struct vec3 side = vec3_normalize(vec3_cross(n, vec3_make(0.3, 0.5, 0.8)));
    struct vec3 there = vec3_add_scaled(p, side, 1e-6 * size);
    near.direction = vec3_sub(there, near.origin);
    near.t_min = 1 - 1e-4 * fabs(t);
    struct crossing_list list = list_of(shape, &near, scratch);
    for (uint32_t i = 0; i < list.count; i++) {
        const struct crossing *d = &scratch->items[i];
        struct vec3 moved = vec3_sub(ray_at(&near, d->t), p);
        if (d->part != copy.part || vec3_length(moved) > 3e-6 * size)
            continue;
        tally->slopes++;
        tally->bad_slope += fabs(vec3_dot(moved, n)) > 2e-3 * vec3_length(moved);
    }
}

static void check_ray(const struct shape *shape, const struct ray *ray, double size, int samples, bool details,
                      struct geom_scratch *scratch, struct tally *tally) {
    struct crossing_list list = list_of(shape, ray, scratch);
    struct crossing own[600];
    uint32_t count = list.count < 600 ? list.count : 600;
    memcpy(own, &scratch->items[list.first], count * sizeof *own);
    tally->rays++;
    tally->crossings += list.count;
    tally->disorder += list.count % 2;
    for (uint32_t i = 0; i < count; i++)
        tally->disorder += own[i].enter != (i % 2 == 0) || (i > 0 && !(own[i].t > own[i - 1].t));

    /* The nearest one from somewhere is the first of the list there. */
    struct ray part = *ray;
    part.t_min = count ? own[count / 3].t : 0;
    scratch->used = 0;
    struct crossing nearest;
    bool found = shape_nearest(shape, &part, scratch, &nearest), any = shape_any(shape, &part, scratch);
    bool expected = count > 0 && count / 3 + 1 < count;
    tally->disagree += found != expected || any != expected;
    if (found && expected)
        tally->disagree += nearest.t != own[count / 3 + 1].t || nearest.part != own[count / 3 + 1].part;

    struct box bounds = shape_bounds(shape);
    double enter, leave;
    if (!box_clip(&bounds, ray, &enter, &leave))
        return;
    double speed = vec3_length(ray->direction);
    for (int k = 0; k < samples; k++) {
        double t = enter + (leave - enter) * (k + 0.5) / samples;
        bool inside = false, close = false;
        for (uint32_t i = 0; i < count; i++) {
            inside ^= own[i].t < t;
            close |= fabs(own[i].t - t) * speed < 1e-9 * size;
        }
        tally->missed += !close && shape_contains(shape, ray_at(ray, t), scratch) != inside;
    }
    for (uint32_t i = 0; details && i < count; i++)
        check_crossing(shape, ray, &own[i], size, scratch, tally);
}

static void check_tally(const struct tally *t, const char *name) {
    if (t->disorder || t->bad_residual || t->bad_place || t->missed || t->outside_bounds || t->disagree || t->turned ||
        t->bad_slope * 2000 > t->slopes)
        test_fail(__FILE__, __LINE__,
                  "%s: %lu rays, %lu crossings: disorder %lu, residual %lu, place %lu, missed %lu, bounds %lu, slope %lu of "
                  "%lu, nearest %lu, turned %lu",
                  name, t->rays, t->crossings, t->disorder, t->bad_residual, t->bad_place, t->missed, t->outside_bounds,
                  t->bad_slope, t->slopes, t->disagree, t->turned);
}

static double size_of(const struct shape *shape) {
    struct box b = shape_bounds(shape);
    return vec3_length(vec3_sub(b.max, b.min));
}

TEST(swept_shapes_cross_random_lines_where_points_say_so_under_random_affine_maps) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    for (int maker = 0; maker < MAKERS; maker++) {
        struct test_random random = {(uint64_t)(100 + maker)};
        struct tally tally = {0};
        for (int turn = 0; turn < 120; turn++) {
            struct arena arena = {0};
            struct shape shape = make((enum maker)maker, &arena, &random);
            double size = size_of(&shape);
            struct box bounds = shape_bounds(&shape);
            for (int i = 0; i < 150; i++) {
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
        CHECK(tally.crossings > 5000 && tally.slopes > 2000);
        check_tally(&tally, maker_names[maker]);
    }
    geom_scratch_destroy(&scratch);
}

/* Rays that lie in planes of symmetry, along axes, through vertices of the defining points, almost level. */
TEST(swept_shapes_keep_parity_and_place_on_special_lines) {
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
                /* Points of the line are told apart where it does not run along a surface. */
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
        const struct ray none[] = {ray_from(vec3_all(0.1), vec3_all(0)), ray_from(vec3_all(NAN), vec3_make(1, 2, 3)),
                                   ray_from(vec3_all(0), vec3_make(NAN, 1, 0)), ray_from(vec3_all(0), vec3_all(INFINITY)),
                                   ray_from(vec3_all(INFINITY), vec3_all(1)), ray_from(vec3_make(50, 0, 0), vec3_make(0, 1, 0))};
        for (size_t i = 0; i < sizeof none / sizeof none[0]; i++)
            CHECK_EQ_INT(list_of(&shape, &none[i], &scratch).count, 0);
        arena_destroy(&arena);
    }
    geom_scratch_destroy(&scratch);
}

/* From a million sizes away the answers are those of a ray that begins nearby, as far as the origin's digits reach. */
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
                struct ray near = ray_from(vec3_add_scaled(p, d, -2), d), far = ray_from(vec3_add_scaled(p, d, -1e6), d);
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
                    struct sweep_input in = {.kind = spline, .points = (const double(*)[3])centres, .radii = radii, .count = 4};
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
                    struct prism_input in = {.kind = SPLINE_CATMULL_ROM, .points = (const double(*)[2])points,
                                             .curve_starts = starts, .curve_count = 1, .from = 0, .to = s};
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

/* ---- each shape by itself ---- */

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

/* The crossings of a polyline lathe by the quadratic of each cone, independently. */
TEST(lathe_of_a_polyline_agrees_with_cones_by_the_quadratic_formula) {
    struct arena arena = {0};
    struct shape shape = make_lathe(&arena, SPLINE_LINEAR, vase, 8, false, false);
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    struct test_random random = {32};
    int wrong = 0, total = 0;
    for (int i = 0; i < 100000; i++) {
        struct vec3 o = random_vec3(&random, 3), d = vec3_sub(vec3_add(random_vec3(&random, 0.7), vec3_make(0, 0.8, 0)), o);
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
    struct shape sheet = make_lathe(&arena, SPLINE_LINEAR, wall, 2, false, true);
    struct shape torus = make_lathe(&arena, SPLINE_LINEAR, ring, 5, false, false);
    CHECK(!shape_is_closed(&sheet) && shape_is_closed(&torus));
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    struct ray ray = ray_from(vec3_make(-5, 0.5, 0), vec3_make(1, 0, 0));
    struct crossing_list list = list_of(&sheet, &ray, &scratch);
    CHECK_EQ_INT(list.count, 2);
    CHECK(scratch.items[0].enter && !scratch.items[1].enter);
    ray = ray_from(vec3_make(0, 3, 0), vec3_make(0.1, -1, 0)); /* through the open top, out by the open bottom */
    CHECK_EQ_INT(list_of(&sheet, &ray, &scratch).count, 0);
    ray = ray_from(vec3_make(-5, 0.5, 0), vec3_make(1, 0, 0));
    list = list_of(&torus, &ray, &scratch);
    CHECK_EQ_INT(list.count, 4);
    CHECK(!shape_contains(&torus, vec3_make(0, 0.5, 0), &scratch) && shape_contains(&torus, vec3_make(1.5, 0.5, 0), &scratch));
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
    CHECK(scratch.items[0].t == 3 && scratch.items[0].part == 1 && scratch.items[1].t == 6 && scratch.items[1].part == 0);
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
        struct sweep_input in = {.kind = SPLINE_LINEAR, .points = (const double(*)[3])points, .radii = radii, .count = 2};
        struct shape shape = {.kind = SHAPE_SWEEP, .sweep = sweep_build(&arena, &in, &error)};
        struct vec3 o = random_vec3(&random, 5);
        struct ray ray = ray_from(o, vec3_sub(random_vec3(&random, 0.7), o));
        struct crossing_list list = list_of(&shape, &ray, &scratch);
        wrong += list.count > 2; /* convex */
        for (uint32_t k = 0; k < list.count; k++) {
            /* The deepest ball at the crossing just touches it: least of |p - c(x)| - r(x) by ternary search. */
            struct vec3 p = ray_at(&ray, scratch.items[k].t);
            double lo = 0, hi = 1, least = INFINITY;
            for (int n = 0; n < 120; n++) {
                double x[2] = {lo + (hi - lo) / 3, hi - (hi - lo) / 3}, depth[2];
                for (int j = 0; j < 2; j++) {
                    struct vec3 c = {points[0][0] + x[j] * (points[1][0] - points[0][0]),
                                     points[0][1] + x[j] * (points[1][1] - points[0][1]),
                                     points[0][2] + x[j] * (points[1][2] - points[0][2])};
                    depth[j] = vec3_length(vec3_sub(p, c)) - (radii[0] + x[j] * (radii[1] - radii[0]));
                    least = fmin(least, depth[j]);
                }
                if (depth[0] < depth[1])
                    hi = x[1];
                else
                    lo = x[0];
            }
            crossed++;
            wrong += fabs(least) > 1e-12;
        }
    }
    CHECK(crossed > 20000);
    CHECK_EQ_INT(wrong, 0);
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
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
    CHECK(b.max.x >= 1 + sqrt(2) && b.max.x < 1 + sqrt(2) * 1.03 && b.min.z <= 3 - sqrt(2) && b.min.z > 3 - sqrt(2) * 1.03);

    e.b = vec3_make(1, 2, 8);
    struct shape rod = {.kind = SHAPE_BLOB, .blob = blob_build(&arena, &in, &error)};
    for (int i = 0; i < 20000; i++) {
        struct vec3 o = random_vec3(&random, 20), d = vec3_sub(vec3_add(vec3_make(1, 2, 5), random_vec3(&random, 1)), o);
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
        struct height_field_input in = {.heights = heights, .columns = COLUMNS, .rows = ROWS, .floor = -0.2, .open = open};
        struct shape shape = {.kind = SHAPE_HEIGHT_FIELD, .height_field = height_field_build(&arena, &in, &error)};
        CHECK(shape_is_closed(&shape) == !open);
        for (int i = 0; i < 20000; i++) {
            struct vec3 o = random_vec3(&random, 2), target = vec3_add(vec3_make(0.5, 0.2, 0.5), random_vec3(&random, 0.5));
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
        struct curve_input in = {.kind = SPLINE_BEZIER, .points = (const double(*)[3])points, .widths = widths, .count = 4};
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
            misplaced += !(vec3_dot(s.normal, d) < 0) || !(s.v >= 0 && s.v <= 1 && s.u >= 0 && s.u <= 1) || s.error < 0.09 ||
                         !box_contains(&bounds, s.point);
        }
    }
    CHECK(met > 300);
    CHECK(wrong <= 2);
    CHECK_EQ_INT(misplaced, 0);
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
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
            struct transform move = transform_translate(random_vec3(&random, 0.4)), turn = transform_rotate((int)i % 3, test_uniform(&random, 0, 360));
            leaves[i].csg_from_leaf = transform_compose(&move, &turn);
            program[length++] = (struct csg_token){CSG_LEAF, (uint16_t)i};
            if (i > 0) {
                double pick = test_uniform(&random, 0, 3);
                program[length++] = (struct csg_token){pick < 1 ? CSG_UNION : pick < 2 ? CSG_INTERSECTION : CSG_DIFFERENCE, 0};
            }
        }
        struct error error = {0};
        const struct csg *csg = csg_build(&arena, leaves, count, program, length, &error);
        CHECK(csg != NULL);
        for (int i = 0; csg && i < 300; i++) {
            struct vec3 o = random_vec3(&random, 4);
            struct ray ray = ray_from(o, vec3_sub(random_vec3(&random, 0.8), o));
            struct shape shape = {.kind = SHAPE_CSG, .csg = csg};
            struct crossing_list list = list_of(&shape, &ray, &scratch);
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
    const enum maker makers[] = {LATHE_LINEAR, LATHE_SPLINE, PRISM_LINEAR, PRISM_SPLINE, FIELD};
    for (int m = 0; m < 5; m++) {
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
                struct vec3 told = vec3_add(vec3_scale(s.dpdu, t.u - s.u), vec3_scale(s.dpdv, t.v - s.v));
                checked++;
                wrong += !(vec3_length(vec3_sub(moved, told)) <= 2e-3 * vec3_length(moved) + 1e-12);
            }
            arena_destroy(&arena);
        }
        CHECK_EQ_INT(outside, 0);
        if (checked < 500 || wrong * 500 > checked)
            test_fail(__FILE__, __LINE__, "%s: %d of %d wrong", maker_names[makers[m]], wrong, checked);
    }
    geom_scratch_destroy(&scratch);
}

/* The box under a map holds the crossings, and another one, one percent smaller, does not. */
TEST(swept_shapes_have_tight_boxes_under_affine_maps) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 256));
    for (int maker = 0; maker < FIELD; maker++) {
        struct test_random random = {(uint64_t)(500 + maker)};
        int outside = 0, loose = 0;
        for (int turn = 0; turn < 40; turn++) {
            struct arena arena = {0};
            struct shape shape = make((enum maker)maker, &arena, &random);
            struct transform map = random_transform(&random);
            struct box box = shape_bounds_under(&shape, &map.forward);
            struct vec3 size = vec3_sub(box.max, box.min), slack = vec3_scale(size, 1e-9);
            for (int side = 0; side < 6; side++) {
                int axis = side / 2, second = (axis + 1) % 3, third = (axis + 2) % 3;
                double lo[3] = {box.min.x, box.min.y, box.min.z}, span[3] = {size.x, size.y, size.z};
                bool reached = false;
                /* A plane one percent inside must meet the shape: lines in it. */
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
                        struct vec3 below = vec3_sub(vec3_sub(box.min, slack), p), above = vec3_sub(p, vec3_add(box.max, slack));
                        outside += fmax(fmax(below.x, fmax(below.y, below.z)), fmax(above.x, fmax(above.y, above.z))) > 0;
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
                built = lathe_build(&arena, &(struct lathe_input){.kind = SPLINE_CATMULL_ROM, .points = vase, .count = 8}, &error);
            else if (kind == 1)
                built = prism_build(&arena, &(struct prism_input){.kind = SPLINE_CATMULL_ROM, .points = star, .curve_starts = (const uint32_t[]){0, 13}, .curve_count = 1, .to = 1}, &error);
            else if (kind == 2)
                built = sweep_build(&arena, &(struct sweep_input){.kind = SPLINE_B_SPLINE, .points = (const double(*)[3])centres, .radii = radii, .count = 40}, &error);
            else if (kind == 3)
                built = curve_build(&arena, &(struct curve_input){.kind = SPLINE_B_SPLINE, .points = (const double(*)[3])centres, .widths = radii, .count = 40}, &error);
            else if (kind == 4)
                built = blob_build(&arena, &(struct blob_input){elements, 200, 0.5}, &error);
            else
                built = height_field_build(&arena, &(struct height_field_input){.heights = heights, .columns = 64, .rows = 64, .floor = -1}, &error);
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
    CHECK(!prism_build(&arena, &(struct prism_input){.points = star, .curve_starts = starts, .curve_count = 1, .to = 1}, &error));
    const uint32_t all[] = {0, 13};
    CHECK(!prism_build(&arena, &(struct prism_input){.points = star, .curve_starts = all, .curve_count = 1, .from = 1, .to = 1}, &error));
    const double centres[][3] = {{0, 0, 0}, {1, 0, 0}}, radii[] = {0, 0}, negative[] = {1, -1};
    CHECK(!sweep_build(&arena, &(struct sweep_input){.points = centres, .radii = radii, .count = 2}, &error));
    CHECK(!sweep_build(&arena, &(struct sweep_input){.points = centres, .radii = negative, .count = 2}, &error));
    CHECK(!sweep_build(&arena, &(struct sweep_input){.points = centres, .radii = negative, .count = 1}, &error));
    CHECK(!curve_build(&arena, &(struct curve_input){.points = centres, .widths = negative, .count = 2}, &error));
    const double heights[] = {0, 0, 0, 0};
    CHECK(!height_field_build(&arena, &(struct height_field_input){.heights = heights, .columns = 2, .rows = 1}, &error));
    CHECK(!height_field_build(&arena, &(struct height_field_input){.heights = heights, .columns = 2, .rows = 2}, &error));
    CHECK(strstr(error.text, "floor"));
    const struct blob_element element = {{0, 0, 0}, {0, 0, 0}, 0, 1};
    CHECK(!blob_build(&arena, &(struct blob_input){&element, 1, 1}, &error));
    CHECK(!blob_build(&arena, &(struct blob_input){&element, 0, 1}, &error));
    arena_destroy(&arena);
}

/* ---- patches ---- */

/* The six sides of a cube bulged into a ball-like thing, each side with its own turn and handedness of parameters. */
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
                worst = fmax(worst, vec3_length(vec3_sub(bezier_patch((const double(*)[3])points, uv[0], uv[1]), v[k])) * 1e9);
            }
            worst = fmax(worst, vec3_length(vec3_sub(bezier_patch((const double(*)[3])points, u, w), sum)));
            struct vec3 flat = vec3_cross(vec3_sub(v[1], v[0]), vec3_sub(v[2], v[0]));
            const double *n = input.normals[input.normal_index[input.face_start[f]]];
            turned += !(vec3_dot(flat, vec3_make(n[0], n[1], n[2])) > 0);
        }
        CHECK(worst <= 0.003 && worst > 0.0001);
        CHECK_EQ_INT(turned, 0);
        struct mesh *mesh = mesh_create(&input, &error);
        CHECK(mesh && mesh_has_uv(mesh) && mesh_has_normals(mesh) && mesh_dropped_faces(mesh) == 0);
        mesh_release(mesh);
        arena_destroy(&arena);
    }
}

TEST(patch_with_a_border_that_is_a_point_has_normals_there) {
    double points[16][3];
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++) {
            double turn = i * 0.5, r = j / 3.0;
            points[4 * j + i][0] = r * cos(turn), points[4 * j + i][1] = 1 - r * r, points[4 * j + i][2] = r * sin(turn);
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
        double b[BERNSTEIN_MAX_DEGREE + 1] = {1}, next[BERNSTEIN_MAX_DEGREE + 1], roots[BERNSTEIN_MAX_DEGREE], at[BERNSTEIN_MAX_DEGREE];
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
