/* Lamps that are nearby rectangles, meshes and skies: against view factors, solid angles and integrals. */
#include "base/random.h"
#include "light/light.h"
#include "light/light_edit.h"
#include "light/light_mesh.h"
#include "light/sky_light_internal.h"
#include "math/sampling.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/mesh_makers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* A view of one point from nearby, below all lamps. */
static double patch_at(struct stage *s, double x, double z) {
    s->camera = (struct camera){{x + 0.02, 0.03, z}, {-0.02, -0.03, 0}, {0, 0, -1}, 1e-4};
    CHECK(stage_render(s, 1, 1));
    return stage_pixel(s, 0, 0).r;
}

static struct light rectangle(struct vec3 corner, struct vec3 edge1, struct vec3 edge2) {
    return (struct light){.kind = LIGHT_PARALLELOGRAM,
                          .position = vec3_add(corner, vec3_scale(vec3_add(edge1, edge2), 0.5)),
                          .corner = corner,
                          .edge1 = edge1,
                          .edge2 = edge2,
                          .colour = {1, 1, 1},
                          .emissive = true,
                          .samples = 32};
}

/* B-3 of Howell's catalogue: a rectangle a x b at height h with a corner above the patch. */
static double corner_factor(double a, double b, double h) {
    a /= h, b /= h;
    double p = sqrt(1 + a * a), q = sqrt(1 + b * b);
    return (a / p * atan(b / p) + b / q * atan(a / q)) / (2 * pi);
}

/* The solid angle of a rectangle with a corner above the point. */
static double corner_angle(double a, double b, double h) {
    return atan(a * b / (h * sqrt(a * a + b * b + h * h)));
}

/* --- rectangles by solid angle --- */

static bool rectangle_seen(struct vec3 corner, struct vec3 edge1, struct vec3 edge2, struct vec3 from,
                           struct spherical_rectangle *out) {
    const struct rectangle_frame frame = rectangle_frame_make(edge1, edge2);
    return spherical_rectangle_make(&frame, corner, from, out);
}

TEST(a_rectangle_is_sampled_by_the_solid_angle_of_its_parts) {
    static const double heights[] = {0.01, 0.3, 2};
    for (int i = 0; i < 3; i++) {
        double h = heights[i];
        struct spherical_rectangle seen;
        struct vec3 from = {0.5, 0, 0.25}, corner = {0.5, h, 0.25};
        CHECK(rectangle_seen(corner, vec3_make(2, 0, 0), vec3_make(0, 0, 1), from, &seen));
        CHECK_NEAR(seen.angle, corner_angle(2, 1, h), 1e-10);
        enum { N = 200 };
        int inside = 0;
        for (int k = 0; k < N * N; k++) {
            struct sample2 xi = {(k % N + 0.5) / N, ((k - k % N) / N + 0.5) / N};
            struct vec3 p = vec3_sub(spherical_rectangle_point(&seen, xi), corner);
            CHECK(p.x >= -1e-12 && p.x <= 2 + 1e-12 && p.z >= -1e-12 && p.z <= 1 + 1e-12);
            CHECK_NEAR(p.y, 0, 1e-12);
            inside += p.x < 0.2 && p.z < 0.3;
        }
        CHECK_NEAR((double)inside / (N * N), corner_angle(0.2, 0.3, h) / seen.angle, 0.005);
    }
    struct spherical_rectangle seen;
    struct vec3 from = {0, 0, 0}, corner = {0, 1, 0};
    CHECK(!rectangle_seen(corner, vec3_make(1, 0, 0), vec3_make(1, 0, 1), from, &seen));
    CHECK(!rectangle_seen(corner, vec3_make(1e-3, 0, 0), vec3_make(0, 0, 1e-3), from, &seen));
    CHECK(!rectangle_seen(from, vec3_make(1, 0, 0), vec3_make(0, 0, 1), from, &seen));
}

/* --- triangles by solid angle --- */

/* From the sides of the spherical triangle (L'Huilier). */
static double triangle_angle(const struct vec3 at[3], struct vec3 from) {
    double sides[3], half = 0;
    for (int i = 0; i < 3; i++) {
        struct vec3 p = vec3_sub(at[(i + 1) % 3], from), q = vec3_sub(at[(i + 2) % 3], from);
        sides[i] = atan2(vec3_length(vec3_cross(p, q)), vec3_dot(p, q));
        half += sides[i] / 2;
    }
    double product = tan(half / 2);
    for (int i = 0; i < 3; i++)
        product *= tan(fmax(0, half - sides[i]) / 2);
    return 4 * atan(sqrt(fmax(0, product)));
}

static double triangle_area(struct vec3 a, struct vec3 b, struct vec3 c) {
    return vec3_length(vec3_cross(vec3_sub(b, a), vec3_sub(c, a))) / 2;
}

/* The corners of triangles, and the point that sees them. */
TEST(a_triangle_is_sampled_by_the_solid_angle_of_its_parts) {
    enum { N = 200 };
    static const struct vec3 cases[][4] = {{{0, 1, 0}, {2, 1, 0}, {0, 1, 1}, {0.5, 0, 0.25}},
                                           {{0, 0.01, 0}, {2, 0.01, 0}, {0, 0.01, 1}, {0.5, 0, 0.25}},
                                           {{0, 1, 0}, {2, 1, 0}, {0, 1, 1}, {5, 0, -3}},
                                           {{0, 1, 0}, {2, 1, 0}, {0, 1, 1}, {-0.001, 0.999, 0.5}},
                                           {{0, 1, 0}, {5, 1, 0}, {0, 1, 0.01}, {0.5, 0.5, 0.25}},
                                           {{0, 1, 0}, {2, 1, 0}, {1, 1, 0.002}, {1, 0.9, 0}},
                                           {{0, 1, 0}, {2, 1, 0}, {0, 1, 1}, {-20, 9, 5}},
                                           {{-9, 1, -9}, {9, 1, -9}, {0, 1, 9}, {0, 0.7, 0}},
                                           {{0, 1, 0}, {2, 1, 0}, {0, 1, 1}, {1.001, 1.001, 0.501}},
                                           {{1, 1, 1}, {0, 2, 0}, {1e5, 3, 2}, {0.5, 0, 0.25}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct vec3 *at = cases[i], from = at[3];
        struct vec3 edge1 = vec3_sub(at[1], at[0]), edge2 = vec3_sub(at[2], at[0]);
        struct spherical_triangle seen;
        CHECK(spherical_triangle_make(at[0], edge1, edge2, from, &seen));
        CHECK_NEAR(seen.angle / triangle_angle(at, from), 1, 1e-6);
        /* Parts: at the three corners, between the centres of two sides and the corner, and the rest. */
        const struct vec3 middle[3] = {vec3_scale(vec3_add(at[1], at[2]), 0.5), vec3_scale(vec3_add(at[2], at[0]), 0.5),
                                       vec3_scale(vec3_add(at[0], at[1]), 0.5)};
        int counted[3] = {0, 0, 0};
        double all = triangle_area(at[0], at[1], at[2]);
        for (int k = 0; k < N * N; k++) {
            struct sample2 xi = {(k % N + 0.5) / N, ((k - k % N) / N + 0.5) / N};
            struct vec3 p = spherical_triangle_point(&seen, xi);
            const double share[3] = {triangle_area(p, at[1], at[2]) / all, triangle_area(p, at[2], at[0]) / all,
                                     triangle_area(p, at[0], at[1]) / all};
            CHECK_NEAR(share[0] + share[1] + share[2], 1, 1e-9); /* it is in the triangle */
            for (int c = 0; c < 3; c++)
                counted[c] += share[c] > 0.5;
        }
        for (int c = 0; c < 3; c++) {
            const struct vec3 part[3] = {at[c], middle[(c + 1) % 3], middle[(c + 2) % 3]};
            CHECK_NEAR((double)counted[c] / (N * N), triangle_angle(part, from) / seen.angle, 0.006);
        }
    }
}

/* Edges of the unit square of a sample are edges of the triangle, and nothing is NaN there. */
TEST(triangles_that_have_no_solid_angle_worth_it_are_not_sampled_by_it) {
    static const struct vec3 corner = {0, 1, 0}, x = {1, 0, 0}, z = {0, 0, 1};
    struct spherical_triangle seen;
    CHECK(!spherical_triangle_make(corner, vec3_scale(x, 1e-3), vec3_scale(z, 1e-3), vec3_make(0, 0, 0), &seen));
    CHECK(!spherical_triangle_make(corner, x, z, corner, &seen));                        /* at a corner, */
    CHECK(!spherical_triangle_make(corner, x, z, vec3_make(0.5, 1, 0), &seen));          /* on an edge, */
    CHECK(!spherical_triangle_make(corner, x, z, vec3_make(0.2, 1, 0.2), &seen));        /* inside, */
    CHECK(!spherical_triangle_make(corner, x, z, vec3_make(3, 1, 0.2), &seen));          /* in its plane, */
    CHECK(!spherical_triangle_make(corner, x, z, vec3_make(0.2, 1 - 1e-6, 0.2), &seen)); /* almost inside */
    CHECK(!spherical_triangle_make(corner, x, vec3_make(2, 0, 0), vec3_make(0, 0, 0), &seen));
    CHECK(!spherical_triangle_make(corner, x, z, vec3_make(NAN, 0, 0), &seen));
    CHECK(spherical_triangle_make(corner, x, z, vec3_make(0, 0, 0), &seen));
    for (int i = 0; i < 9; i++) {
        struct vec3 p = spherical_triangle_point(&seen, (struct sample2){i % 3 / 2.0, (i - i % 3) / 6.0});
        CHECK(p.x >= -1e-12 && p.z >= -1e-12 && p.x + p.z <= 1 + 1e-12);
        CHECK_NEAR(p.y, 1, 1e-12);
    }
}

/* Sixteen shadow rays to a lamp close above. One whose edges are a little off the right angle is sampled by area: the
 * light of one of its rays varies by the factor 600. */
/* Whether a direction from the origin meets the box, and its octant. */
static bool direction_meets(const struct light_box *box, struct vec3 from, struct vec3 d) {
    double enter = 0, leave = INFINITY;
    for (int i = 0; i < 3; i++) {
        const struct vec3 *e = &box->edges[i];
        double at = vec3_dot(vec3_sub(from, box->corner), *e), step = vec3_dot(d, *e), all = vec3_dot(*e, *e);
        double a = (0 - at) / step, b = (all - at) / step;
        enter = fmax(enter, fmin(a, b));
        leave = fmin(leave, fmax(a, b));
    }
    return enter < leave;
}

/* For a box, too: the number of samples in each cell of directions is in proportion to its solid angle. */
TEST(a_box_is_sampled_by_its_solid_angle) {
    enum { N = 60000, CELLS = 6 * 12 };
    static const double sizes[][3] = {{1, 1, 1}, {0.1, 4, 0.2}, {3, 0.001, 2}};
    static const struct vec3 points[] = {{2, 3, 4}, {0.5, 2.2, 0.4}, {-1, 0.3, 0.3}, {0.5, 0.5, -0.4}};
    for (int i = 0; i < 12; i++) {
        static int of_box[CELLS], of_samples[CELLS];
        memset(of_box, 0, sizeof of_box);
        memset(of_samples, 0, sizeof of_samples);
        struct transform turn = transform_rotate_about(vec3_make(1, 2, 3), 40.0 * i);
        struct light_box box = {.corner = {0, 0, 0}};
        for (int k = 0; k < 3; k++) {
            double edge[3] = {0, 0, 0};
            edge[k] = sizes[i / 4][k];
            box.edges[k] = affine_vector(&turn.forward, vec3_make(edge[0], edge[1], edge[2]));
        }
        struct spherical_box seen;
        struct vec3 from = affine_point(&turn.forward, points[i % 4]);
        CHECK(spherical_box_make(&box, from, &seen));
        int met = 0;
        for (uint64_t j = 0; j < 2 * N; j++) {
            struct sample2 u = {random_unit(random_combine(1, j)), random_unit(random_combine(2, j))};
            double y = 1 - 2 * u.y, level = sqrt(1 - y * y);
            struct vec3 d = {level * cos(2 * pi * u.x), y, level * sin(2 * pi * u.x)};
            bool meets = direction_meets(&box, from, d);
            met += meets;
            int cell = (int)(u.x * 12) + 12 * (int)(u.y * 6);
            of_box[cell] += meets;
            if (meets && j % 16 == 0)
                CHECK_NEAR(spherical_box_pdf(&box, &seen, from, d) * seen.angle, 1, 1e-12);
            if (j >= N)
                continue;
            d = vec3_normalize(vec3_sub(spherical_box_point(&seen, u), from));
            double round = atan2(d.z, d.x) / (2 * pi);
            cell = (int)((round < 0 ? round + 1 : round) * 12) % 12 + 12 * (int)fmin(5, (1 - d.y) / 2 * 6);
            of_samples[cell]++;
        }
        CHECK_NEAR(met / (2.0 * N), seen.angle / (4 * pi), 5 * sqrt(met + 1.0) / (2.0 * N));
        double chi = 0;
        int used = 0;
        for (int cell = 0; cell < CELLS; cell++) {
            double a = of_box[cell], b = of_samples[cell], ka = sqrt((double)N / met), kb = 1 / ka;
            if (a + b < 20)
                continue;
            chi += (ka * a - kb * b) * (ka * a - kb * b) / (a + b);
            used++;
        }
        CHECK(chi < used + 5 * sqrt(2.0 * used));
        struct vec3 inside = vec3_scale(vec3_add(vec3_add(box.edges[0], box.edges[1]), box.edges[2]), 0.5);
        CHECK(!spherical_box_make(&box, inside, &seen));
    }
}

TEST(a_rectangle_close_to_a_surface_is_not_grainy) {
    double squares[2] = {0, 0};
    for (int by_area = 0; by_area < 2; by_area++) {
        struct stage s;
        stage_floor(&s);
        double off = by_area ? 1e-6 : 0, factor = 4 * corner_factor(0.5, 0.5, 0.1);
        s.lights[0] = rectangle(vec3_make(-0.5, 0.1, -0.5), vec3_make(1, 0, off), vec3_make(off, 0, 1));
        s.lights[0].samples = 4;
        for (uint64_t seed = 0; seed < 100; seed++) {
            s.settings.seed = seed;
            double error = patch_at(&s, 0, 0) / factor - 1;
            squares[by_area] += error * error / 100;
        }
        stage_end(&s);
    }
    CHECK_NEAR(sqrt(squares[0]), 0, 0.06);
    CHECK(squares[0] < 0.05 * squares[1]);
}

/* --- meshes --- */

static struct node *mesh_node(struct stage *s, const struct maker *maker, const struct material *material) {
    struct mesh_input input = maker_input(maker);
    struct node *node = scene_node(&s->scene, NODE_GEOMETRY, "mesh", &s->error);
    node->shape = (struct shape){.kind = SHAPE_MESH, .mesh = assets_mesh(&s->assets, &input, &s->error)};
    node->material = material;
    return node;
}

static const struct material *glowing(struct stage *s, double radiance) {
    struct material *material = stage_phong(s, colour_all(0), colour_all(0), 1);
    material->phong.emission = colour_all(radiance);
    return material;
}

/* As the first light of the stage. */
static void mesh_area_light(struct stage *s, const struct node *node, int samples) {
    s->lights[0] = (struct light){.kind = LIGHT_MESH, .emissive = true, .colour = {1, 1, 1}, .samples = samples};
    s->authored[0].node = node;
}

/* The unit square at y = 0 from two triangles. */
static struct node *square_node(struct stage *s, const struct material *material) {
    struct maker maker = {0};
    for (int i = 0; i < 4; i++)
        maker_vertex(&maker, i == 1 || i == 2, 0, i >= 2);
    maker_triangle(&maker, 0, 1, 2);
    maker_triangle(&maker, 0, 2, 3);
    struct node *node = mesh_node(s, &maker, material);
    maker_free(&maker);
    return node;
}

TEST(a_rectangle_of_two_triangles_gives_its_view_factor) {
    static const double sides[][3] = {{1, 1, 1}, {3, 0.5, 1}, {2, 5, 1.5}, {3, 3, 1}};
    for (int i = 0; i < 8; i++) {
        struct stage s;
        stage_floor(&s);
        bool shown = i < 4; /* or not in the scene, and the light states its emission */
        double a = sides[i % 4][0], b = sides[i % 4][1], h = sides[i % 4][2];
        struct node *holder = stage_group(&s, s.root), *node = square_node(&s, glowing(&s, shown ? 2 : 0));
        stage_scale(&s, node, a, 1, b);
        stage_move(&s, node, 0, h, 0);
        mesh_area_light(&s, shown ? holder : node, 48);
        if (shown)
            CHECK(node_add_child(&s.scene, holder, node, &s.error));
        s.lights[0].has_emission = !shown;
        s.lights[0].emission = colour_all(2);
        s.lights[0].colour = colour_make(0.5, 1, 1);
        CHECK_NEAR(patch_at(&s, 0, 0), corner_factor(a, b, h), 2.5e-3);
        stage_end(&s);
    }
}

/* A mesh that is not part of the scene lights it equally: with the emission of the light, with that of its material, as
 * a group of two halves with separate materials, one of them at a deeper level. */
TEST(a_mesh_that_is_not_shown_lights_as_if_it_were) {
    enum { BY_LIGHT, BY_MATERIAL, BY_SLOTS, BY_GROUP, VARIANTS };
    for (int route = 0; route < VARIANTS; route++) {
        struct stage s;
        stage_floor(&s);
        double a = 2, b = 1.5, h = 1.25;
        struct node *node = square_node(&s, route == BY_MATERIAL ? glowing(&s, 2) : NULL);
        const struct material *const slots[] = {glowing(&s, 2), NULL};
        if (route == BY_SLOTS) {
            node->slots = slots;
            node->slot_count = 2; /* faces without slots have the first one */
        }
        mesh_area_light(&s, node, 48);
        if (route == BY_GROUP) {
            struct node *group = scene_node(&s.scene, NODE_GROUP, "group", &s.error);
            struct node *inner = scene_node(&s.scene, NODE_GROUP, "inner", &s.error);
            struct node *left = square_node(&s, glowing(&s, 2)), *right = square_node(&s, glowing(&s, 2));
            stage_scale(&s, left, 0.25, 1, 1);
            stage_scale(&s, right, 0.75, 1, 1);
            stage_move(&s, inner, 0.25, 0, 0);
            CHECK(node_add_child(&s.scene, group, left, &s.error) && node_add_child(&s.scene, group, inner, &s.error) &&
                  node_add_child(&s.scene, inner, right, &s.error));
            mesh_area_light(&s, node = group, 48);
        }
        stage_scale(&s, node, a, 1, b);
        stage_move(&s, node, 0, h, 0);
        s.lights[0].has_emission = route == BY_LIGHT;
        s.lights[0].emission = colour_all(2);
        s.lights[0].colour = colour_make(0.5, 1, 1);
        CHECK_NEAR(patch_at(&s, 0, 0), corner_factor(a, b, h), 2.5e-3);
        CHECK(s.warnings == 0);
        stage_end(&s);
    }
}

/* No ray hits it, so a mirror does not show it: its light makes a highlight. */
TEST(a_mesh_that_is_not_shown_is_not_seen_in_mirrors) {
    for (int shown = 0; shown < 2; shown++) {
        struct stage s;
        stage_floor(&s);
        struct node *node = square_node(&s, glowing(&s, 2));
        stage_move(&s, node, 0, 2, 0);
        if (shown)
            CHECK(node_add_child(&s.scene, s.root, node, &s.error));
        mesh_area_light(&s, node, 4);
        s.light_count = 1;
        CHECK(stage_build(&s, s.root, ACCEL_AUTO));
        CHECK(light_is_seen(&s.world.lights[0]) == (shown != 0));
        CHECK_NEAR(light_brightest(&s.world.lights[0]), 2, 1e-12);
        stage_end(&s);
    }
}

/* A closed mesh: only the faces towards the patch are sampled, and its far side casts no shadow on them. */
TEST(a_ball_of_triangles_gives_the_view_factor_of_a_ball) {
    for (int i = 0; i < 3; i++) {
        struct stage s;
        stage_floor(&s);
        struct maker maker = {0};
        maker_sphere(&maker, 16);
        struct node *node = mesh_node(&s, &maker, glowing(&s, 1));
        maker_free(&maker);
        double r = 0.3 + 0.4 * i, h = 2, x = 0.8 * i, distance = sqrt(h * h + x * x);
        stage_scale(&s, node, i == 1 ? -r : r, r, r); /* one is mirrored */
        stage_move(&s, node, x, h, 0);
        CHECK(node_add_child(&s.scene, s.root, node, &s.error));
        mesh_area_light(&s, node, 48);
        double factor = r * r / (distance * distance) * h / distance, mean = 0;
        for (s.settings.seed = 0; s.settings.seed < 12; s.settings.seed++)
            mean += patch_at(&s, 0, 0) / factor / 12;
        CHECK_NEAR(mean, 1, 0.015); /* the ball of triangles is 0.3 % smaller */
        CHECK(s.world.lights[0].mesh->one_sided);
        stage_end(&s);
    }
}

TEST(a_surface_below_its_own_lamp_is_not_shaded_by_it) {
    struct stage s;
    stage_begin(&s, 1);
    struct material *white = stage_phong(&s, colour_all(1), colour_all(0), 1);
    white->phong.emission = colour_all(0.5);
    white->phong.two_sided = true;
    struct maker maker = {0}; /* a corner of two squares: each lights the other by the factor (1 - 1 / sqrt 2) / 2 */
    for (int i = 0; i < 6; i++)
        maker_vertex(&maker, i < 2 ? 40 : 0, i > 3 ? 40 : 0, i % 2 ? -40 : 40);
    maker_triangle(&maker, 0, 1, 3), maker_triangle(&maker, 0, 3, 2);
    maker_triangle(&maker, 2, 3, 5), maker_triangle(&maker, 2, 5, 4);
    struct node *node = mesh_node(&s, &maker, white);
    maker_free(&maker);
    CHECK(node_add_child(&s.scene, s.root, node, &s.error));
    mesh_area_light(&s, node, 64);
    s.light_count = 1;
    s.settings.full = true;
    s.settings.samples = 1;
    /* A patch at distance d from the edge of a wall H high and 2 W wide: B-4 of the catalogue, twice. */
    double d = 20, y = d / 40, z = 40.0 / 40, root = 1 / sqrt(z * z + y * y);
    double factor = (atan(1 / y) - y * root * atan(root)) / pi;
    CHECK_NEAR(patch_at(&s, d, 0), 0.5 + 0.5 * factor, 0.004);
    stage_end(&s);
}

TEST(a_mesh_light_needs_a_mesh_and_warns_without_light) {
    for (int shown = 0; shown < 2; shown++) {
        struct stage s;
        stage_floor(&s);
        struct node *group = scene_node(&s.scene, NODE_GROUP, "ceiling", &s.error);
        if (shown)
            CHECK(node_add_child(&s.scene, s.root, group, &s.error));
        mesh_area_light(&s, group, 4);
        s.light_count = 1;
        CHECK(!stage_build(&s, s.root, ACCEL_AUTO));
        CHECK(strstr(s.error.text, "node 'ceiling' is a mesh light, but there is no mesh there or below it") != NULL);
        CHECK(strchr(s.error.text, '\n') == NULL);
        CHECK(node_add_child(&s.scene, group, square_node(&s, NULL), &s.error));
        s.warnings = 0;
        CHECK(stage_build(&s, s.root, ACCEL_AUTO));
        CHECK(s.warnings == 1 + shown); /* a visible mesh has no material, either */
        stage_end(&s);
    }
}

TEST(a_group_that_is_not_shown_and_holds_itself_is_no_mesh_light) {
    struct stage s;
    stage_floor(&s);
    struct node *outer = scene_node(&s.scene, NODE_GROUP, "outer", &s.error);
    struct node *inner = scene_node(&s.scene, NODE_GROUP, "inner", &s.error);
    CHECK(node_add_child(&s.scene, outer, square_node(&s, NULL), &s.error));
    CHECK(node_add_child(&s.scene, outer, inner, &s.error) && node_add_child(&s.scene, inner, outer, &s.error));
    mesh_area_light(&s, outer, 4);
    s.light_count = 1;
    CHECK(!stage_build(&s, s.root, ACCEL_AUTO));
    CHECK(strstr(s.error.text, "cycle: 'outer' > 'inner' > 'outer'") != NULL);
    stage_end(&s);
}

/* --- skies --- */

static struct light sky_area_light(const struct sky *sky, int samples) {
    return (struct light){.kind = LIGHT_SKY, .emissive = true, .colour = {1, 1, 1}, .sky = sky, .samples = samples};
}

/* A surface under a sky of radiance (1 + y) / 2 shows 1/2 + n.y / 3. */
TEST(a_sky_that_grows_with_height_lights_as_its_integral_says) {
    static const double stops[2][4] = {{-1, 0, 0, 0}, {1, 1, 1, 1}};
    struct sky sky = {.kind = SKY_STOPS, .stops = stops, .stop_count = 2};
    static const struct vec3 views[] = {{0, -1, 0}, {0, 1, 0}, {-1, 0, 0}, {-0.6, -0.8, 0}};
    for (int i = 0; i < 4; i++) {
        struct stage s;
        stage_begin(&s, 1);
        stage_sphere(&s, s.root, stage_phong(&s, colour_all(1), colour_all(0), 1));
        s.lights[0] = sky_area_light(&sky, 64);
        s.light_count = 1;
        s.settings.full = true;
        s.settings.samples = 1;
        struct vec3 v = views[i], up = {0, 0, 1};
        s.camera = (struct camera){vec3_scale(v, -100), v, up, 1e-5};
        CHECK(stage_render(&s, 1, 1));
        CHECK_NEAR(stage_pixel(&s, 0, 0).r, 0.5 - v.y / 3, 2e-3);
        stage_end(&s);
    }
}

/* The furnace test: in uniform light a surface that reflects everything is invisible. */
TEST(white_rough_and_polished_objects_vanish_in_uniform_light) {
    struct stage s;
    stage_begin(&s, 2);
    struct sky sky = {.kind = SKY_CONSTANT, .colour = {0.7, 0.7, 0.7}};
    stage_sphere(&s, s.root, stage_phong(&s, colour_all(1), colour_all(0), 1));
    struct node *mirror = stage_sphere(&s, s.root, stage_glass(&s, 1, 0, 1));
    stage_move(&s, mirror, 6, 0, 0);
    struct material *rough = stage_glass(&s, 1, 0, 1);
    rough->phong.roughness = 0.1; /* the facets of a rougher one mask a part of the light */
    stage_move(&s, stage_sphere(&s, s.root, rough), -6, 0, 0);
    struct material *glass = scene_material(&s.scene, MATERIAL_FRESNEL, stage_glass(&s, 0, 0, 1.5), &s.error);
    stage_move(&s, stage_sphere(&s, s.root, glass), 0, 6, 0);
    s.settings.reflect_limit = s.settings.refract_limit = 40;
    s.settings.cutoff = 1e-5;
    s.sky = sky;
    s.lights[0] = sky_area_light(&sky, 16);
    s.light_count = 1;
    s.settings.samples = 1;
    s.settings.full = true;
    s.camera = (struct camera){{0, 2, 30}, {0, 0, -1}, {0, 1, 0}, 40};
    CHECK(stage_render(&s, 48, 36));
    double sum = 0, worst = 0;
    for (uint32_t i = 0; i < 48 * 36; i++) {
        double off = stage_pixel(&s, i % 48, i / 48).r - 0.7;
        sum += off / (48 * 36);
        worst = fmax(worst, fabs(off));
    }
    CHECK_NEAR(sum, 0, 1e-3);
    CHECK_NEAR(worst, 0, 0.08); /* from 256 stratified directions over the whole sphere */
    stage_end(&s);
}

/* The same integral by brute force, for every kind of sky. */
static double irradiance(const struct sky *sky, struct vec3 normal, int steps) {
    double sum = 0;
    for (int j = 0; j < steps; j++) {
        for (int i = 0; i < 2 * steps; i++) {
            double y = 1 - 2 * (j + 0.5) / steps, turn = pi * (i + 0.5) / steps, level = sqrt(1 - y * y);
            struct vec3 d = {level * cos(turn), y, level * sin(turn)};
            double cosine = vec3_dot(d, normal);
            sum += cosine > 0 ? cosine * sky_colour(sky, d, 0).g : 0;
        }
    }
    return sum * 4 / (2.0 * steps * steps);
}

/* Chi-square over cells of equal solid angle, with N random samples; expected shares by the midpoint rule, finer than
 * the table. */
static void check_density(const struct sky *sky, const struct sky_table *table) {
    enum { ROWS = 8, COLUMNS = 16, FINE = 64, N = 40000 };
    double chi = 0, share[ROWS * COLUMNS] = {0}, all = 0;
    int counted[ROWS * COLUMNS] = {0};
    for (int j = 0; j < ROWS * FINE; j++) {
        for (int i = 0; i < COLUMNS * FINE; i++) {
            double y = 1 - 2 * (j + 0.5) / (ROWS * FINE), turn = 2 * pi * (i + 0.5) / (COLUMNS * FINE);
            struct vec3 d = {sqrt(1 - y * y) * cos(turn), y, sqrt(1 - y * y) * sin(turn)};
            share[j / FINE * COLUMNS + i / FINE] += sky_table_pdf(table, d) * 4 * pi / (ROWS * FINE * COLUMNS * FINE);
        }
    }
    for (uint64_t k = 0; k < N; k++) {
        struct sample2 xi = {random_unit(random_combine(8, k)), random_unit(random_combine(9, k))};
        struct sky_sample sample = sky_table_sample(sky, table, xi);
        struct vec3 d = sample.direction;
        double turn = atan2(d.z, d.x) / (2 * pi);
        int row = (int)fmin(ROWS - 1, (1 - d.y) / 2 * ROWS), column = (int)((turn < 0 ? turn + 1 : turn) * COLUMNS);
        counted[row * COLUMNS + column % COLUMNS]++;
        CHECK_NEAR(sky_table_pdf(table, d) / sample.pdf, 1, 1e-9);
    }
    for (int i = 0; i < ROWS * COLUMNS; i++) {
        double expected = share[i] * N;
        all += share[i];
        CHECK(expected > 5); /* some of them go everywhere */
        chi += (counted[i] - expected) * (counted[i] - expected) / expected;
    }
    CHECK_NEAR(all, 1, 1e-9);
    CHECK(chi < ROWS * COLUMNS + 5 * sqrt(2.0 * ROWS * COLUMNS));
}

TEST(samples_of_every_sky_have_the_density_of_its_table_and_the_mean_of_its_integral) {
    enum { W = 64, H = 32, N = 300 };
    static uint8_t texels[W * H * 4];
    struct error error = {0};
    memset(texels, 40, sizeof texels);
    for (int i = 0; i < 3; i++)
        texels[(9 * W + 20) * 4 + i] = texels[(2 * W + 50) * 4 + i] = 255; /* two suns, one near the pole */
    struct image *map = image_create("map", W, H, 8, texels, &error), *six[6];
    for (int i = 0; i < 6; i++) {
        memset(texels, 20 + 30 * i, 16 * 16 * 4);
        six[i] = image_create("face", 16, 16, 8, texels, &error);
    }
    static const double stops[3][4] = {{-1, 0.1, 0.2, 0.1}, {0, 2, 1, 1}, {1, 0, 0, 3}};
    struct sky skies[6] = {{.kind = SKY_GRADIENT}, {.kind = SKY_MAP, .image = map}};
    skies[4] = (struct sky){.kind = SKY_CONSTANT, .colour = {1, 2, 3}};
    skies[5] = (struct sky){.kind = SKY_STOPS, .stops = stops, .stop_count = 3};
    skies[1].adjusted = true;
    skies[1].intensity = 3;
    skies[1].turn_sine = 0.6, skies[1].turn_cosine = 0.8;
    CHECK(sky_from_faces(six, &skies[2], &error));
    sky_make_clear(vec3_normalize(vec3_make(1, 1, -1)), 3, colour_all(0.15), &skies[3]);
    char warning[256];
    struct pool *pool = pool_create(2, warning);
    for (int i = 0; i < 6; i++) {
        struct arena arena = {0};
        const struct sky_table *table = sky_table_build(&skies[i], &arena, pool);
        struct vec3 normal = vec3_normalize(vec3_make(0.3, 1, -0.2));
        double sum = 0, max = 0;
        for (int k = 0; k < N * N; k++) {
            struct sample2 xi = {(k % N + 0.5) / N, ((k - k % N) / N + 0.5) / N};
            struct sky_sample sample = sky_table_sample(&skies[i], table, xi);
            struct vec3 d = sample.direction;
            struct colour light = sample.intensity;
            CHECK_NEAR(vec3_length(d), 1, 1e-12);
            double cosine = vec3_dot(d, normal);
            sum += cosine > 0 ? cosine * light.g : 0;
            max = fmax(max, light.b);
        }
        /* The gradient has only blue. */
        double expected = i == 0 ? 0 : irradiance(&skies[i], normal, 500);
        CHECK_NEAR(sum / (N * N), expected, 0.01 * expected + 1e-12);
        check_density(&skies[i], table);
        if (i == 0)
            CHECK(max < 4);
        arena_destroy(&arena);
    }
    pool_destroy(pool);
    image_release(map);
    for (int i = 0; i < 6; i++)
        image_release(six[i]);
}

/* Most of the light comes from a thousandth of this sky; 64 uniformly distributed rays would mostly miss it. */
TEST(more_samples_go_where_a_sky_is_bright) {
    enum { W = 128, H = 64 };
    static uint16_t texels[W * H * 4];
    struct error error = {0};
    for (int i = 0; i < W * H * 4; i++)
        texels[i] = i % 4 == 3 ? 65535 : 60;
    for (int y = 15; y < 18; y++)
        for (int x = 30; x < 33; x++)
            for (int c = 0; c < 3; c++)
                texels[(y * W + x) * 4 + c] = 65535;
    struct image *map = image_create("map", W, H, 16, texels, &error);
    struct sky sky = {.kind = SKY_MAP, .image = map};
    double expected = irradiance(&sky, vec3_make(0, 1, 0), 700), squares = 0;
    struct stage s;
    stage_floor(&s);
    s.lights[0] = sky_area_light(&sky, 8);
    for (uint64_t seed = 0; seed < 20; seed++) {
        s.settings.seed = seed;
        double off = patch_at(&s, 0, 0) / expected - 1;
        squares += off * off / 20;
    }
    CHECK_NEAR(sqrt(squares), 0, 0.1);
    stage_end(&s);
    image_release(map);
}

TEST(lamps_that_are_meshes_and_skies_give_the_same_bits_everywhere) {
    static const struct {
        int threads;
        enum accel_kind accel;
        double unit;
    } runs[] = {{1, ACCEL_AUTO, 1},   {7, ACCEL_GRID, 1},       {2, ACCEL_NONE, 1},
                {2, ACCEL_KDTREE, 1}, {2, ACCEL_AUTO, 0x1p-10}, {2, ACCEL_BVH, 0x1p20}};
    struct film_pixel *reference = NULL;
    static const double stops[2][4] = {{-1, 0.1, 0, 0}, {1, 0.3, 0.4, 0.5}};
    struct sky sky = {.kind = SKY_STOPS, .stops = stops, .stop_count = 2};
    for (int i = 0; i < 6; i++) {
        struct stage s;
        stage_begin(&s, runs[i].threads);
        struct node *top = stage_group(&s, s.root), *area_light = square_node(&s, glowing(&s, 5));
        struct material *white = stage_phong(&s, colour_make(0.8, 0.7, 0.6), colour_all(0.2), 20);
        struct node *floor = stage_cube(&s, top, white);
        stage_scale(&s, floor, 20, 1, 20);
        stage_move(&s, floor, -10, -2, -10);
        for (int k = 0; k < 3; k++)
            stage_move(&s, stage_sphere(&s, top, white), 3 * k - 3, 0, k % 2);
        stage_rotate(&s, area_light, 0, 30);
        stage_move(&s, area_light, 0, 2.2, 0.5);
        CHECK(node_add_child(&s.scene, top, area_light, &s.error));
        stage_scale(&s, top, runs[i].unit, runs[i].unit, runs[i].unit);
        mesh_area_light(&s, area_light, 2);
        s.lights[1] = sky_area_light(&sky, 2);
        s.light_count = 2;
        s.camera = (struct camera){vec3_scale(vec3_make(0, 4, 12), runs[i].unit), {0, -0.25, -1}, {0, 1, 0}, 50};
        s.settings.samples = 2;
        s.settings.accel = runs[i].accel;
        CHECK(stage_render(&s, 60, 45));
        size_t size = 2 * (size_t)60 * 45 * sizeof *reference; /* colours and first pass */
        if (!reference)
            reference = memcpy(malloc(size), s.film.pixels, size);
        CHECK(memcmp(reference, s.film.pixels, size) == 0);
        stage_end(&s);
    }
    free(reference);
}

TEST(a_mesh_light_that_is_not_in_the_scene_says_that_a_texture_of_emission_is_averaged) {
    static const char *const emissions[] = {"gr.fn(function(p) return gr.step(p.x, .5) end)", "{1, .5, 0}"};
    for (int k = 0; k < 2; k++) {
        char scene[512];
        (void)snprintf(scene, sizeof scene,
                       "local m = gr.material{kd={0,0,0}, emission=%s}\n"
                       "local square = gr.mesh(m, {{0,1,0},{1,1,0},{1,1,1}}, {{0,1,2}})\n"
                       "gr.render{node=gr.sphere{name='ball'}, file='x.png', width=2, height=2, eye={0,0,5}, "
                       "lights={gr.mesh_light(square)}}\n",
                       emissions[k]);
        struct test_result result = test_gray_scene(scene, "scene.lua", NULL);
        CHECK_EQ_INT(result.status, 0);
        CHECK((strstr(result.err, "not in the scene: of the texture of its emission only the average counts") !=
               NULL) == (k == 0));
        test_free_result(&result);
    }
}
