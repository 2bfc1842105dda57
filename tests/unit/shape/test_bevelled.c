/* Bevelled edges by the forms that they have in the field: rounded ones are what a ball covers that moves over a
 * smaller solid, chamfered ones lie at 45 degrees. */
#include "tests/unit/random_makers.h"
#include "tests/unit/shape_makers.h"

#include "mesh/mesh.h"
#include "shape/bevelled.h"

#include <math.h>
#include <string.h>

/* A box between two corners whose edges are rounded with this radius: the distance of a point, negative inside. */
static double rounded_box(struct vec3 low, struct vec3 high, double radius, struct vec3 p) {
    const struct vec3 middle = vec3_scale(vec3_add(low, high), 0.5), half = vec3_scale(vec3_sub(high, low), 0.5);
    double outside = 0, inside = -INFINITY;
    for (int k = 0; k < 3; k++) {
        double over = fabs(vec3_get(vec3_sub(p, middle), k)) - (vec3_get(half, k) - radius);
        outside += over > 0 ? over * over : 0;
        inside = over > inside ? over : inside;
    }
    return sqrt(outside) + (inside < 0 ? inside : 0) - radius;
}

static const double ell[6][2] = {{0, 0}, {1.6, 0}, {1.6, 0.6}, {0.6, 0.6}, {0.6, 1.6}, {0, 1.6}};
static const uint32_t ell_starts[2] = {0, 6};

/* Inside of the L is inside of one of its two arms, rounded each. */
static double rounded_ell(double radius, struct vec3 p) {
    double one = rounded_box(vec3_make(0, 0, 0), vec3_make(1.6, 0.7, 0.6), radius, p),
           other = rounded_box(vec3_make(0, 0, 0), vec3_make(0.6, 0.7, 1.6), radius, p);
    return one < other ? one : other;
}

TEST(a_rounded_prism_that_turns_inwards_is_its_rounded_arms_at_half_a_million_points) {
    struct arena arena = {0};
    struct geom_scratch scratch;
    struct error error;
    CHECK(geom_scratch_init(&scratch, 256));
    for (int turned = 0; turned < 2; turned++) {
        double points[6][2];
        for (int i = 0; i < 6; i++)
            memcpy(points[i], ell[turned ? 5 - i : i], sizeof *points);
        const struct prism_input in = {SPLINE_LINEAR, (const double(*)[2])points, ell_starts, 1, 0, 0.7};
        const struct shape shape = {.kind = SHAPE_BEVELLED,
                                    .bevelled = bevelled_prism(&arena, &arena, &in, 0.11, &error)};
        CHECK(shape.bevelled != NULL);
        struct test_random random = {21};
        uint32_t wrong = 0;
        for (int i = 0; i < 500000; i++) {
            const struct vec3 p = vec3_make(test_uniform(&random, -0.1, 1.7), test_uniform(&random, -0.1, 0.8),
                                            test_uniform(&random, -0.1, 1.7));
            double distance = rounded_ell(0.11, p);
            wrong += fabs(distance) > 1e-9 && bevelled_contains(shape.bevelled, p) != (distance < 0);
        }
        CHECK(wrong == 0);
        /* Crossings lie on that surface, and no line that meets the solid is without them. */
        for (int i = 0; i < 20000; i++) {
            struct ray ray = {.origin = random_vec3(&random, 3), .t_min = 0, .t_max = INFINITY};
            const struct vec3 through =
                vec3_make(test_uniform(&random, 0, 1.6), test_uniform(&random, 0, 0.7), test_uniform(&random, 0, 1.6));
            ray.direction = vec3_sub(through, ray.origin);
            struct crossing_list list;
            CHECK(shape_crossings(&shape, &ray, &scratch, &list));
            bool inside = false;
            for (uint32_t k = 0; k < list.count; k++) {
                const struct crossing *c = &scratch.items[list.first + k];
                CHECK(fabs(rounded_ell(0.11, ray_at(&ray, c->t))) < 1e-9);
                inside ^= c->t < 1;
            }
            double distance = rounded_ell(0.11, through);
            CHECK(fabs(distance) < 1e-9 || inside == (distance < 0));
            scratch.used = list.first;
        }
    }
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

/* The volume of a closed mesh, positive if its normals point outwards. */
static double volume_of(const struct mesh *mesh) {
    double sum = 0;
    for (uint32_t i = 0; i < mesh_triangle_count(mesh); i++) {
        struct vec3 c[3];
        uint32_t slot;
        mesh_triangle(mesh, i, c, &slot);
        sum += vec3_dot(c[0], vec3_cross(c[1], c[2])) / 6;
    }
    return sum;
}

TEST(a_chamfered_prism_with_holes_is_closed_and_has_the_volume_of_its_sections) {
    const double w = 3, d = 2, hole = 0.4, e = 0.1, height = 0.5;
    for (int turned = 0; turned < 4; turned++) {
        double points[12][2] = {{0, 0}, {w, 0}, {w, d}, {0, d}};
        const uint32_t starts[4] = {0, 4, 8, 12};
        for (int i = 0; i < 8; i++) {
            points[4 + i][0] = (i < 4 ? 0.5 : 1.7) + (i % 4 == 1 || i % 4 == 2 ? hole : 0);
            points[4 + i][1] = (i < 4 ? 0.5 : 0.9) + (i % 4 >= 2 ? hole : 0);
        }
        for (int k = 0; k < 3; k++) /* the direction of a curve means nothing */
            for (int i = 0; i < 2 && (turned >> k & 1); i++) {
                double swap[2];
                memcpy(swap, points[4 * k + i], sizeof swap);
                memcpy(points[4 * k + i], points[4 * k + 3 - i], sizeof swap);
                memcpy(points[4 * k + 3 - i], swap, sizeof swap);
            }
        struct arena arena = {0};
        struct error error;
        struct chamfered_prism faces;
        const struct prism_input in = {SPLINE_LINEAR, (const double(*)[2])points, starts, 3, 0, height};
        CHECK(chamfered_prism(&arena, &in, e, &faces, &error));
        const struct mesh_input input = {.name = "p",
                                         .vertex_count = faces.vertex_count,
                                         .face_count = faces.face_count,
                                         .vertices = (const double(*)[3])faces.vertices,
                                         .face_start = faces.face_start,
                                         .vertex_index = faces.vertex_index};
        struct mesh *mesh = mesh_create(&input, &error);
        CHECK(mesh && mesh_is_closed(mesh) && mesh_is_outward(mesh) && mesh_dropped_faces(mesh) == 0);
        /* Sections at the bottom of a chamfer, in its middle and at its top; Simpson's rule is exact for their squares.
         */
        double sections[3];
        for (int i = 0; i < 3; i++) {
            double s = e * i / 2, cut = e - s, wide = hole + 2 * s;
            sections[i] = (w - 2 * s) * (d - 2 * s) - 2 * cut * cut - 2 * wide * wide;
        }
        double volume = sections[0] * (height - 2 * e) + (sections[0] + 4 * sections[1] + sections[2]) * e / 3;
        CHECK(fabs(volume_of(mesh) - volume) < 1e-12);
        mesh_release(mesh);
        arena_destroy(&arena);
    }
}

TEST(an_edge_that_is_too_large_is_refused_with_its_position) {
    const char *const scenes[][2] = {
        {"gr.box{min = {0, 0, 0}, max = {1, 0.1, 1}, edge = 0.05}",
         "edge (0.05) must be less than half of the shortest side"},
        {"gr.cylinder{radius = 0.2, edge = 0.2}", "edge (0.2) must be less than the radius (0.2)"},
        {"gr.cylinder{open = true, edge = 0.1}", "edge needs a cylinder with caps"},
        {"gr.prism{outline = {{0, 0}, {1, 0}, {1, 0.1}, {0, 1}}, edge = 0.08}",
         "edge (0.08) is too large for the outline near {1, "},
        {"gr.prism{outline = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, holes = {{{0.1, 0.4}, {0.5, 0.4}, {0.5, 0.6}}}, edge = "
         "0.06}",
         "edge (0.06) is too large for the outline near {"},
        {"gr.prism{outline = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, to = 0.1, edge = 0.06}",
         "must be less than half of the height (0.1)"},
        {"gr.prism{outline = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, spline = 'b-spline', edge = 0.06, chamfer = true}",
         "chamfer = true needs an outline of straight lines"},
        {"gr.box{min = {0, 0, 0}, max = {1, 1, 1}, edge = -1}", "edge must be >= 0"}};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        test_write_text(test_path("scene.lua"), scenes[i][0]);
        test_shell_errors("$gray -q scene.lua", 1, scenes[i][1]);
    }
}
