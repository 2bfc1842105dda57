/* Makers of random lathes, prisms, sweeps, height fields and blobs, and the checks that hold for every closed shape;
 * for the tests of these shapes. */
#ifndef GRAY_TESTS_SWEPT_MAKERS_H
#define GRAY_TESTS_SWEPT_MAKERS_H

#include "base/mem.h"
#include "csg/csg.h"
#include "csg/geometry.h"
#include "geometry/bernstein.h"
#include "mesh/mesh.h"
#include "mesh/patch.h"
#include "shape/blob.h"
#include "shape/curve.h"
#include "shape/height_field.h"
#include "shape/lathe.h"
#include "shape/prism.h"
#include "shape/sweep.h"
#include "tests/harness.h"
#include "tests/unit/csg_crossings.h"
#include "tests/unit/random_makers.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static inline struct transform random_transform(struct test_random *random) {
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

/* ---- makers ---- */

static inline struct shape make_lathe(struct arena *arena, enum spline_kind kind, const double (*points)[2],
                                      uint32_t count, bool loop, bool open) {
    struct error error = {0};
    struct lathe_input in = {.kind = kind, .points = points, .count = count, .loop = loop, .open = open};
    struct shape shape = {.kind = SHAPE_LATHE};
    shape.lathe = lathe_build(arena, &in, &error);
    if (!shape.lathe)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return shape;
}

static const double vase[][2] = {{0, 0},      {0.6, 0},   {0.8, 0.3}, {0.3, 0.9},
                                 {0.25, 1.3}, {0.5, 1.6}, {0.4, 1.6}, {0, 1.2}};
static const double star[][2] = {{1, 0},    {0.3, 0.2},   {0.3, 0.9},    {-0.2, 0.3}, {-0.9, 0.6},
                                 {-0.4, 0}, {-0.8, -0.6}, {-0.1, -0.35}, {0.3, -0.9}, {0.35, -0.25},
                                 {0.2, 0},  {-0.1, 0.15}, {-0.1, -0.15}};

/* Random points along a curve that does not fold up too much. */
static inline struct shape random_lathe(struct arena *arena, struct test_random *random, enum spline_kind kind) {
    double points[40][2];
    uint32_t count = 4 + (uint32_t)test_uniform(random, 0, 8);
    bool axis = test_uniform(random, 0, 1) < 0.5, loop = !axis && test_uniform(random, 0, 1) < 0.3;
    for (uint32_t i = 0; i < count; i++) {
        double turn = loop ? 6.283185307 * i / count : 3.14159265 * i / (count - 1);
        double extent = test_uniform(random, 0.5, 1);
        points[i][0] = loop ? 1.5 + extent * cos(turn) : fmax(0.05, extent * sin(turn));
        points[i][1] = loop ? extent * sin(turn) : -extent * cos(turn);
    }
    if (axis)
        points[0][0] = points[count - 1][0] = 0;
    return make_lathe(arena, kind, (const double(*)[2])points, count, loop, false);
}

static inline struct shape random_prism(struct arena *arena, struct test_random *random, enum spline_kind kind) {
    double points[60][2];
    uint32_t count = 5 + (uint32_t)test_uniform(random, 0, 20), starts[3] = {0, count, count + 6};
    for (uint32_t i = 0; i < count + 6; i++) {
        bool hole = i >= count;
        double turn = hole ? 6.283185307 * (i - count) / 6 : 6.283185307 * i / count;
        double extent = hole ? test_uniform(random, 0.1, 0.25) : test_uniform(random, 0.4, 1.2);
        points[i][0] = extent * cos(turn);
        points[i][1] = extent * sin(turn);
    }
    struct error error = {0};
    struct prism_input in = {
        .kind = kind, .points = (const double(*)[2])points, .curve_starts = starts, .curve_count = 2};
    in.from = test_uniform(random, -1, 0);
    in.to = test_uniform(random, 0.01, 1);
    struct shape shape = {.kind = SHAPE_PRISM};
    shape.prism = prism_build(arena, &in, &error);
    if (!shape.prism)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return shape;
}

static inline struct shape random_sweep(struct arena *arena, struct test_random *random, enum spline_kind kind) {
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

static inline struct shape random_height_field(struct arena *arena, struct test_random *random, uint32_t max) {
    uint32_t columns = 2 + (uint32_t)test_uniform(random, 0, max), rows = 2 + (uint32_t)test_uniform(random, 0, max);
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

static inline struct shape random_blob(struct arena *arena, struct test_random *random) {
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

enum maker {
    LATHE_LINEAR,
    LATHE_SPLINE,
    PRISM_LINEAR,
    PRISM_SPLINE,
    SWEEP_LINEAR,
    SWEEP_SPLINE,
    SWEEP_B,
    FIELD,
    BLOB,
    MAKERS
};
static const char *const maker_names[] = {"linear lathe",   "spline lathe", "linear prism",
                                          "spline prism",   "linear sweep", "spline sweep",
                                          "B-spline sweep", "height field", "blob"};

static inline struct shape make(enum maker maker, struct arena *arena, struct test_random *random) {
    switch (maker) {
    case LATHE_LINEAR:
        return random_lathe(arena, random, SPLINE_LINEAR);
    case LATHE_SPLINE:
        return random_lathe(arena, random, SPLINE_B_SPLINE);
    case PRISM_LINEAR:
        return random_prism(arena, random, SPLINE_LINEAR);
    case PRISM_SPLINE:
        return random_prism(arena, random, SPLINE_CATMULL_ROM);
    case SWEEP_LINEAR:
        return random_sweep(arena, random, SPLINE_LINEAR);
    case SWEEP_SPLINE:
        return random_sweep(arena, random, SPLINE_CATMULL_ROM);
    case SWEEP_B:
        return random_sweep(arena, random, SPLINE_B_SPLINE);
    case FIELD:
        return random_height_field(arena, random, 20);
    case BLOB:
    case MAKERS:
        break;
    }
    return random_blob(arena, random);
}

/* ---- checks that hold for every closed shape ---- */

static inline struct crossing_list list_of_geometry(const struct geometry *geometry, const struct ray *ray,
                                                    struct geom_scratch *scratch) {
    struct crossing_list list = {0, 0};
    scratch->used = 0;
    while (!geometry_crossings(geometry, ray, scratch, &list)) {
        CHECK(scratch->overflow && scratch->used == 0);
        CHECK(geom_scratch_grow(scratch));
    }
    return list;
}

static inline struct crossing_list list_of(const struct shape *shape, const struct ray *ray,
                                           struct geom_scratch *scratch) {
    struct geometry geometry = geometry_of_shape(shape);
    return list_of_geometry(&geometry, ray, scratch);
}

struct tally {
    uint64_t rays, crossings, disorder, bad_residual, bad_position, missed, outside_bounds, bad_slope, slopes, disagree,
        turned;
};

static inline void check_crossing(const struct shape *shape, const struct ray *ray, const struct crossing *c,
                                  double size, struct geom_scratch *scratch, struct tally *tally) {
    struct surface s;
    struct crossing copy = *c;
    shape_describe(shape, ray, &copy, &s);
    struct vec3 p = ray_at(ray, copy.t), n = vec3_normalize(s.normal);
    tally->bad_position += !(vec3_length(vec3_sub(p, s.point)) < 1e-9 * size + 1e-14 * vec3_length(ray->origin));
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

static inline void check_ray(const struct shape *shape, const struct ray *ray, double size, int samples, bool details,
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

    /* The nearest one from a point is the first of the list after that point. */
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

static inline void check_tally(const struct tally *t, const char *name) {
    if (t->disorder || t->bad_residual || t->bad_position || t->missed || t->outside_bounds || t->disagree ||
        t->turned || t->bad_slope * 2000 > t->slopes)
        test_fail(
            __FILE__, __LINE__,
            "%s: %lu rays, %lu crossings: disorder %lu, residual %lu, place %lu, missed %lu, bounds %lu, slope %lu of "
            "%lu, nearest %lu, turned %lu",
            name, t->rays, t->crossings, t->disorder, t->bad_residual, t->bad_position, t->missed, t->outside_bounds,
            t->bad_slope, t->slopes, t->disagree, t->turned);
}

static inline double size_of(const struct shape *shape) {
    struct box b = shape_bounds(shape);
    return vec3_length(vec3_sub(b.max, b.min));
}

#endif
