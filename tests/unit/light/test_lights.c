/* Lights against closed forms. A small patch of a white floor under a lamp of radiance 1 shows the view factor of the
 * lamp; the formulas are those of Howell, "A Catalog of Radiation Heat Transfer Configuration Factors": B-12 (disc),
 * B-3 (rectangle over its corner), B-38 (sphere). */
#include "light/light_bounds.h"
#include "math/elementary.h"
#include "math/sampling.h"
#include "shape/planar.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* A view of one point from far above with a very small field of view. */
static double patch_at(struct stage *s, double x, double z) {
    s->camera = (struct camera){{x + 3, 1000, z}, {-3, -1000, 0}, {0, 0, -1}, 1e-4};
    CHECK(stage_render(s, 1, 1));
    return stage_pixel(s, 0, 0).r;
}

static struct light area_light(enum light_kind kind, struct vec3 position, double radius) {
    return (struct light){.kind = kind,
                          .position = position,
                          .direction = {0, -1, 0},
                          .radius = radius,
                          .colour = {1, 1, 1},
                          .falloff = {1, 0, 0},
                          .emissive = true,
                          .samples = 32};
}

static struct light rectangle(struct vec3 corner, struct vec3 edge1, struct vec3 edge2) {
    struct light light = area_light(LIGHT_PARALLELOGRAM, corner, 0);
    light.corner = corner;
    light.edge1 = edge1;
    light.edge2 = edge2;
    light.position = vec3_add(corner, vec3_scale(vec3_add(edge1, edge2), 0.5));
    return light;
}

TEST(disc_lamp_gives_its_view_factor) {
    struct stage s;
    stage_floor(&s);
    static const double radius[] = {0.25, 1, 4};
    for (int i = 0; i < 3; i++) {
        double r = radius[i], h = 2;
        s.lights[0] = area_light(LIGHT_DISC, vec3_make(0, h, 0), r);
        CHECK_NEAR(patch_at(&s, 0, 0), r * r / (r * r + h * h), 2e-3);
        /* At distance a from the axis: B-13. */
        double a = 1.5, hh = h / a, rr = r / a, z = 1 + hh * hh + rr * rr;
        CHECK_NEAR(patch_at(&s, a, 0), 0.5 * (1 - (z - 2 * rr * rr) / sqrt(z * z - 4 * rr * rr)), 2e-3);
    }
    stage_end(&s);
}

TEST(rectangle_lamp_gives_its_view_factor) {
    struct stage s;
    stage_floor(&s);
    static const double sides[][3] = {{1, 1, 1}, {3, 0.5, 1}, {2, 5, 1.5}, {3, 3, 1}};
    for (int i = 0; i < 4; i++) {
        double h = sides[i][2], a = sides[i][0] / h, b = sides[i][1] / h, p = sqrt(1 + a * a), q = sqrt(1 + b * b);
        double factor = (a / p * atan(b / p) + b / q * atan(a / q)) / (2 * pi);
        s.lights[0] = rectangle(vec3_make(0, h, 0), vec3_make(sides[i][0], 0, 0), vec3_make(0, 0, sides[i][1]));
        CHECK_NEAR(patch_at(&s, 0, 0), factor, 2e-3);
    }
    stage_end(&s);
}

TEST(sphere_lamp_gives_its_view_factor) {
    struct stage s;
    stage_floor(&s);
    for (int i = 0; i < 3; i++) {
        double r = 0.3 + 0.6 * i, h = 2, x = 0.8 * i, distance = sqrt(h * h + x * x);
        s.lights[0] = area_light(LIGHT_SPHERE, vec3_make(x, h, 0), r);
        CHECK_NEAR(patch_at(&s, 0, 0), r * r / (distance * distance) * h / distance, 2e-4);
    }
    /* Half below the horizon: the centre lies in the plane of the patch; B-38 for an angle of 90 degrees. */
    double r = 1, d = 2, root = sqrt(d * d / (r * r) - 1);
    s.lights[0] = area_light(LIGHT_SPHERE, vec3_make(d, 0, 0), r);
    CHECK_NEAR(patch_at(&s, 0, 0), (atan(1 / root) - root * r * r / (d * d)) / pi, 1e-3);
    stage_end(&s);
}

/* A patch inside sees only the lamp. */
TEST(the_inside_of_a_ball_lamp_is_lit) {
    struct stage s;
    stage_floor(&s);
    for (int i = 0; i < 3; i++) {
        s.lights[0] = area_light(LIGHT_SPHERE, vec3_make(0.5 * i, 0.9 * i, 0), 3);
        CHECK_NEAR(patch_at(&s, 0, 0), 1, 0.01);
    }
    stage_end(&s);
}

static void plane_below(struct node *node) {
    struct shape plane = {.kind = SHAPE_PLANAR};
    plane.planar = planar_plane(vec3_make(0, 1, 0), 1);
    node->shape = plane;
}

/* A light that intersects a planar floor, .55 of it above: the floor hides the rest, as the top of a solid does. */
TEST(a_flat_shape_hides_what_is_below_it) {
    for (int kind = 0; kind < 3; kind++) {
        double seen[2];
        for (int planar = 0; planar < 2; planar++) {
            struct stage s;
            stage_floor(&s);
            if (planar)
                plane_below(s.root->first_child->node);
            struct vec3 middle = {2, 0.1, 0};
            if (kind == 0)
                s.lights[0] = rectangle(vec3_make(2, -0.9, -0.5), vec3_make(0, 2, 0), vec3_make(0, 0, 1));
            else
                s.lights[0] = area_light(kind == 1 ? LIGHT_DISC : LIGHT_SPHERE, middle, 1);
            s.lights[0].direction = vec3_make(-1, 0, 0);
            s.lights[0].emissive = false;
            seen[planar] = patch_at(&s, 0, 0) * sqrt(4.01) / 0.1; /* divided by the cosine of the centre */
            stage_end(&s);
        }
        CHECK_NEAR(seen[1], seen[0], 1e-9);
        CHECK_NEAR(seen[1], kind == 0 ? 0.55 : seen[0], 0.02);
        CHECK(seen[1] < 0.7);
    }
}

TEST(a_one_sided_lamp_lights_its_side_only) {
    struct stage s;
    stage_floor(&s);
    for (int flip = 0; flip < 2; flip++) {
        s.lights[0] = area_light(LIGHT_DISC, vec3_make(0, 2, 0), 1);
        s.lights[0].one_sided = true;
        s.lights[0].direction.y = flip ? 1 : -1;
        CHECK_NEAR(patch_at(&s, 0, 0), flip ? 0 : 0.2, 1e-3);
    }
    stage_end(&s);
}

TEST(directional_light_is_the_cosine_without_attenuation) {
    struct stage s;
    stage_floor(&s);
    s.lights[0] = (struct light){.kind = LIGHT_DIRECTIONAL, .direction = {0.6, -0.8, 0}, .colour = {1, 1, 1}};
    CHECK_NEAR(patch_at(&s, 0, 0), 0.8, 1e-7);
    CHECK_NEAR(patch_at(&s, 15, -9), 0.8, 1e-7);
    /* A ball of radius 1 at height 4 over x = -3: its shadow falls on the origin. */
    struct node *ball = stage_sphere(&s, s.root, stage_phong(&s, colour_all(1), colour_all(0), 1));
    stage_move(&s, ball, -3, 4, 0);
    CHECK_NEAR(patch_at(&s, 0, 0), 0, 0);
    CHECK_NEAR(patch_at(&s, 0, 1.01), 0.8, 1e-7);
    CHECK_NEAR(patch_at(&s, 0, 0.99), 0, 0);
    stage_end(&s);
}

TEST(attenuation_by_range_and_by_inverse_square) {
    struct stage s;
    stage_floor(&s);
    s.lights[0] = (struct light){.kind = LIGHT_POINT, .position = {0, 3, 0}, .colour = {1, 1, 1}};
    s.lights[0].attenuation = ATTENUATION_RANGE;
    s.lights[0].range = 4;
    CHECK_NEAR(patch_at(&s, 0, 0), 0.25, 1e-7);
    s.lights[0].range = 2.5;
    CHECK_NEAR(patch_at(&s, 0, 0), 0, 0);
    s.lights[0].attenuation = ATTENUATION_INVERSE_SQUARE;
    s.lights[0].intensity = 4;
    CHECK_NEAR(patch_at(&s, 0, 0), 4.0 / 9, 1e-7);
    CHECK_NEAR(patch_at(&s, 4, 0), 4.0 / 25 * 0.6, 1e-7);
    stage_end(&s);
}

TEST(spot_is_full_inside_smooth_at_its_edge_and_dark_outside) {
    struct stage s;
    stage_floor(&s);
    s.lights[0] = (struct light){.kind = LIGHT_SPOT,
                                 .position = {0, 1, 0},
                                 .direction = {0, -1, 0},
                                 .colour = {1, 1, 1},
                                 .cos_inner = cos(20 * pi / 180),
                                 .cos_outer = cos(40 * pi / 180)};
    CHECK_NEAR(patch_at(&s, tan(19.9 * pi / 180), 0), cos(19.9 * pi / 180), 1e-6);
    CHECK_NEAR(patch_at(&s, tan(40.1 * pi / 180), 0), 0, 0);
    /* At the mean of the two cosines the share is one half. */
    double middle = acos((cos(20 * pi / 180) + cos(40 * pi / 180)) / 2);
    CHECK_NEAR(patch_at(&s, 0, tan(middle)), cos(middle) / 2, 1e-6);
    double before = 2;
    for (int i = 0; i <= 20; i++) {
        double share = patch_at(&s, tan((20 + i) * pi / 180), 0) / cos((20 + i) * pi / 180);
        CHECK(share <= before + 1e-7);
        before = share;
    }
    stage_end(&s);
}

TEST(lists_of_nodes_decide_what_a_light_reaches) {
    /* Two balls, the left one in a group; both seen from the front with the light at the camera. */
    for (int mode = 0; mode < 4; mode++) {
        struct stage s;
        stage_begin(&s, 1);
        struct material *white = stage_phong(&s, colour_all(1), colour_all(0), 1);
        struct node *group = stage_group(&s, s.root), *left = stage_sphere(&s, group, white);
        struct node *right = stage_sphere(&s, s.root, white);
        stage_move(&s, left, -2, 0, 0);
        stage_move(&s, right, 2, 0, 0);
        s.settings.samples = 1;
        stage_point_light(&s, vec3_make(0, 0, 10), colour_all(1));
        const struct node *list[] = {mode < 2 ? group : right};
        if (mode % 2 == 0) {
            s.authored[0].include = list;
            s.authored[0].include_count = 1;
        } else {
            s.authored[0].exclude = list;
            s.authored[0].exclude_count = 1;
        }
        CHECK(stage_render(&s, 101, 101));
        bool left_lit = stage_pixel(&s, 28, 50).r > 0, right_lit = stage_pixel(&s, 72, 50).r > 0;
        CHECK(left_lit == (mode == 0 || mode == 3));
        CHECK(right_lit == (mode == 1 || mode == 2));
        stage_end(&s);
    }
}

TEST(an_empty_list_of_included_nodes_lights_nothing) {
    struct stage s;
    stage_floor(&s);
    const struct node *none[1] = {NULL};
    s.lights[0] = (struct light){.kind = LIGHT_POINT, .position = {0, 3, 0}, .colour = {1, 1, 1}};
    s.authored[0].include = none;
    CHECK_NEAR(patch_at(&s, 0, 0), 0, 0);
    stage_end(&s);
}

TEST(a_visible_lamp_shows_its_radiance_and_its_outline) {
    static const enum light_kind kinds[] = {LIGHT_DISC, LIGHT_SPHERE, LIGHT_PARALLELOGRAM};
    for (int i = 0; i < 3; i++) {
        struct stage s;
        stage_begin(&s, 1);
        s.settings.full = true;
        s.settings.samples = 4;
        s.lights[0] = area_light(kinds[i], vec3_make(0, 0, 0), 2);
        s.lights[0].direction = vec3_make(0, 0, 1);
        if (kinds[i] == LIGHT_PARALLELOGRAM)
            s.lights[0] = rectangle(vec3_make(-1, -1, 0), vec3_make(3, 0, 0), vec3_make(1, 2, 0));
        s.lights[0].visible = true;
        s.lights[0].colour = colour_make(0.5, 0.25, 3);
        s.light_count = 1;
        CHECK(stage_render(&s, 200, 200));
        CHECK_NEAR(stage_pixel(&s, 100, 100).b, 3, 1e-6);
        double sum = 0, pixel = 2 * tan(25 * pi / 180) / 200 * 10;
        for (uint32_t p = 0; p < 200 * 200; p++)
            sum += stage_pixel(&s, p % 200, p / 200).r / 0.5;
        double silhouette = 10 * tan(asin(0.2)), expected[] = {4 * pi, pi * silhouette * silhouette, 6};
        CHECK_NEAR(sum * pixel * pixel, expected[i], 0.02);
        stage_end(&s);
    }
}

/* A square at y = 0 whose shading normal is tilted towards +x by `degrees`. */
static struct node *leaning_square(struct stage *s, double degrees, double half, const struct material *material) {
    const double corners[4][3] = {{-half, 0, -half}, {-half, 0, half}, {half, 0, half}, {half, 0, -half}};
    const double normal[1][3] = {{sin(degrees * pi / 180), cos(degrees * pi / 180), 0}};
    static const uint32_t starts[] = {0, 4}, indices[] = {0, 1, 2, 3}, normals[] = {0, 0, 0, 0};
    struct mesh_input input = {.name = "square",
                               .vertex_count = 4,
                               .vertices = corners,
                               .face_count = 1,
                               .face_start = starts,
                               .vertex_index = indices,
                               .normal_count = 1,
                               .normals = normal,
                               .normal_index = normals};
    struct node *node = scene_node(&s->scene, NODE_GEOMETRY, "square", &s->error);
    node->shape = (struct shape){.kind = SHAPE_MESH, .mesh = assets_mesh(&s->assets, &input, &s->error)};
    node->material = material;
    CHECK(node_add_child(&s->scene, s->root, node, &s->error));
    return node;
}

/* All kinds that have a position, on one side of the square (y = 2 or -2), in the direction of the tilt. */
static struct light light_at(int kind, bool emissive, double y) {
    struct light light = area_light((enum light_kind)kind, vec3_make(6, y, 0), 0.5);
    if (kind == LIGHT_PARALLELOGRAM)
        light = rectangle(vec3_make(6, y - 0.5, -0.5), vec3_make(0, 0, 1), vec3_make(0, 1, 0));
    light.direction = vec3_normalize(vec3_make(-6, -y, 0));
    light.cos_inner = 0.9;
    light.cos_outer = 0.8;
    light.emissive = emissive;
    light.samples = 4;
    return light;
}

TEST(no_light_from_behind_a_surface_is_reflected_however_its_shading_normal_leans) {
    for (int kind = LIGHT_POINT; kind <= LIGHT_SPHERE; kind++)
        for (int emissive = 0; emissive < 2; emissive++)
            for (int side = 0; side < 2; side++) {
                if (emissive && (kind == LIGHT_POINT || kind == LIGHT_DIRECTIONAL || kind == LIGHT_SPOT))
                    continue;
                struct stage s;
                stage_begin(&s, 1);
                struct material *material = stage_phong(&s, colour_all(1), colour_all(0.5), 3);
                material->phong.two_sided = true;
                (void)leaning_square(&s, 75, 4, material);
                s.light_count = 1;
                s.lights[0] = light_at(kind, emissive, side ? 2 : -2);
                double above = patch_at(&s, 0, 0);
                s.camera = (struct camera){{3, -1000, 0}, {-3, 1000, 0}, {0, 0, -1}, 1e-4};
                CHECK(stage_render(&s, 1, 1));
                double below = stage_pixel(&s, 0, 0).r;
                if (side)
                    CHECK(above > 0.001 && below == 0);
                else
                    CHECK(above == 0);
                stage_end(&s);
            }
}

/* A mirror below a visible lamp shows the lamp's radiance; its highlight is the same light again. Below an invisible
 * lamp it shows only the highlight. */
TEST(a_visible_lamp_counts_once_in_a_mirror) {
    for (int visible = 0; visible < 2; visible++)
        for (int rough = 0; rough < 4; rough++) { /* of 2 and 3 the lamp is shaded from its centre */
            struct stage s;
            stage_begin(&s, 1);
            struct material *mirror = stage_glass(&s, 1, 0, 1);
            mirror->phong.roughness = rough & 1 ? 0.1 : 0;
            stage_sphere(&s, s.root, mirror);
            s.lights[0] = area_light(LIGHT_SPHERE, vec3_make(0, 0, 40), 25);
            s.lights[0].visible = visible == 1;
            s.lights[0].emissive = rough < 2;
            s.lights[0].colour = colour_all(1);
            s.light_count = 1;
            s.camera = (struct camera){{0, 0, 3}, {0, 0, -1}, {0, 1, 0}, 1};
            CHECK(stage_render(&s, 1, 1));
            double seen = stage_pixel(&s, 0, 0).r;
            if (visible)
                CHECK_NEAR(seen, 1, 1e-6);
            else
                CHECK(seen > 0.01 && seen <= 1);
            s.settings.integrator = INTEGRATOR_PATH;
            if (visible && rough != 3) { /* a rough mirror scatters the light of a point as such */
                CHECK(stage_render(&s, 1, 1));
                CHECK_NEAR(stage_pixel(&s, 0, 0).r, 1, rough ? 0.05 : 1e-6);
            }
            stage_end(&s);
        }
}

/* Also where the centre of a lamp is before the surface and the point that a shadow ray goes to is behind it. */
TEST(a_closed_solid_is_dark_inside_of_itself_with_every_integrator) {
    const struct revolved_quadric cylinder =
        revolved_quadric_cylinder(vec3_make(0, -1, 0), vec3_make(0, 1, 0), 1, false);
    const struct shape shapes[] = {
        {.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, 1}},
        {.kind = SHAPE_BOX, .box = {{-1, -1, -1}, {1, 1, 1}}},
        {.kind = SHAPE_ELLIPSOID, .ellipsoid = {{0, 0, 0}, {1, 2, 1}}},
        {.kind = SHAPE_REVOLVED_QUADRIC, .revolved_quadric = cylinder},
    };
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        for (int kind = LIGHT_POINT; kind <= LIGHT_SPHERE; kind++)
            for (int integrator = 0; integrator < LIST_COUNT(INTEGRATORS); integrator++) {
                struct stage s;
                stage_begin(&s, 1);
                struct material *material = stage_phong(&s, colour_all(0.8), colour_all(0.3), 5);
                material->phong.two_sided = true;
                stage_sphere(&s, s.root, material)->shape = shapes[i];
                s.light_count = 1;
                s.lights[0] = kind == LIGHT_PARALLELOGRAM
                                  ? rectangle(vec3_make(-1, 3, -1), vec3_make(2, 0, 0), vec3_make(0, 0, 2))
                                  : area_light((enum light_kind)kind, vec3_make(3, 1, 1), 1.9);
                s.lights[0].direction = vec3_make(-1, 0, 0);
                s.lights[0].emissive = false;
                s.lights[0].cos_outer = -1;
                s.lights[0].samples = 2;
                s.settings.integrator = (enum integrator_kind)integrator;
                s.settings.path_samples = 16;
                s.camera = (struct camera){{0.1, 0.05, 0.13}, {0.3, 0.4, -1}, {0, 1, 0}, 110};
                CHECK(stage_render(&s, 16, 16));
                for (size_t k = 0; k < 256; k++)
                    CHECK(s.film.pixels[k].rgb[0] == 0);
                stage_end(&s);
            }
}

TEST(a_light_may_set_its_number_of_shadow_rays) {
    struct stage s;
    stage_floor(&s);
    for (int n = 1; n <= 20; n += 19) {
        s.lights[0] = area_light(LIGHT_SPHERE, vec3_make(0, 2, 0), 1);
        s.lights[0].samples = n;
        s.statistics.shadow_rays = 0;
        (void)patch_at(&s, 0, 0);
        CHECK_EQ_INT(s.statistics.shadow_rays, n * n);
    }
    stage_end(&s);
}

TEST(half_of_a_lamp_behind_a_wall_gives_half_of_the_light) {
    struct stage s;
    stage_floor(&s);
    struct node *wall = stage_cube(&s, s.root, stage_phong(&s, colour_all(1), colour_all(0), 1));
    stage_move(&s, wall, 0, 0, -0.5);
    stage_scale(&s, wall, 10, 1e-3, 10);
    stage_move(&s, wall, 0, 1, 0);
    s.lights[0] = area_light(LIGHT_SPHERE, vec3_make(0, 2, 0), 0.5);
    s.camera = (struct camera){{-1, 0.5, 0}, {1, -0.5, 0}, {0, 1, 0}, 1e-4}; /* below the wall's edge */
    CHECK(stage_render(&s, 1, 1));
    CHECK_NEAR(stage_pixel(&s, 0, 0).r, 0.5 * 0.25 / 4, 3e-4);
    stage_end(&s);
}

/* All kinds together over objects that cast shadows. */
static void lit_scene(struct stage *s, double unit) {
    struct node *top = stage_group(s, s->root);
    struct material *white = stage_phong(s, colour_make(0.8, 0.7, 0.6), colour_all(0.2), 20);
    struct node *node = stage_cube(s, top, white);
    stage_move(s, node, -0.5, -1, -0.5);
    stage_scale(s, node, 20, 1, 20);
    for (int i = 0; i < 5; i++)
        stage_move(s, stage_sphere(s, top, white), 3 * i - 6, 1, i % 2);
    stage_scale(s, top, unit, unit, unit);
    s->lights[0] = area_light(LIGHT_SPHERE, vec3_make(-3 * unit, 4 * unit, unit), unit);
    s->lights[1] = area_light(LIGHT_DISC, vec3_make(3 * unit, 5 * unit, 2 * unit), unit);
    s->lights[2] = rectangle(vec3_make(0, 6 * unit, 0), vec3_make(unit, 0, 0), vec3_make(0, 0.5 * unit, unit));
    s->lights[3] = (struct light){.kind = LIGHT_DIRECTIONAL, .direction = {0, -0.6, -0.8}, .colour = {0.2, 0.1, 0}};
    s->lights[4] = (struct light){.kind = LIGHT_SPOT,
                                  .position = {-5 * unit, 5 * unit, 0},
                                  .direction = {0.6, -0.8, 0},
                                  .colour = {0, 0.5, 0},
                                  .cos_inner = 0.95,
                                  .cos_outer = 0.9,
                                  .attenuation = ATTENUATION_RANGE,
                                  .range = 9 * unit};
    s->lights[5] = area_light(LIGHT_SPHERE, vec3_make(0, 3 * unit, 3 * unit), 0.5 * unit);
    s->lights[5].emissive = false;
    s->lights[5].colour = colour_all(0.3);
    for (int i = 0; i < 6; i++) {
        s->lights[i].samples = 2;
        s->lights[i].visible = i == 0;
    }
    s->light_count = 6;
    s->camera = (struct camera){{0, 4 * unit, 12 * unit}, {0, -0.25, -1}, {0, 1, 0}, 50};
    s->settings.samples = 2;
}

TEST(all_lights_give_the_same_bits_for_any_threads_search_and_power_of_two) {
    struct film_pixel *reference = NULL;
    static const struct {
        int threads;
        enum accel_kind accel;
        double unit;
    } runs[] = {{1, ACCEL_AUTO, 1}, {2, ACCEL_AUTO, 1},       {7, ACCEL_GRID, 1},
                {2, ACCEL_NONE, 1}, {2, ACCEL_AUTO, 0x1p-10}, {2, ACCEL_BVH, 0x1p20}};
    for (int i = 0; i < 6; i++) {
        struct stage s;
        stage_begin(&s, runs[i].threads);
        lit_scene(&s, runs[i].unit);
        s.settings.accel = runs[i].accel;
        CHECK(stage_render(&s, 80, 60));
        size_t size = 2 * (size_t)80 * 60 * sizeof *reference; /* colours and first pass */
        if (!reference)
            reference = memcpy(malloc(size), s.film.pixels, size);
        else
            CHECK(memcmp(reference, s.film.pixels, size) == 0);
        stage_end(&s);
    }
    free(reference);
}

TEST(permutations_are_bijections_and_differ_by_key) {
    for (uint32_t count = 1; count <= 70; count++) {
        uint8_t seen[70] = {0};
        int same = 0;
        for (uint32_t i = 0; i < count; i++) {
            uint32_t p = sample_permute(i, count, 12345), q = sample_permute(i, count, random_mix(99));
            CHECK(p < count);
            seen[p]++;
            same += p == q;
        }
        for (uint32_t i = 0; i < count; i++)
            CHECK_EQ_INT(seen[i], 1);
        CHECK(count < 20 || same < (int)count / 2);
    }
}

/* Four parts of 3 x 3 cells: 36 points, one in each of 6 x 6 parts, of 36 columns and of 36 rows. */
TEST(a_set_of_samples_is_stratified_in_cells_rows_and_columns) {
    for (uint64_t set = 0; set < 50; set++) {
        uint8_t parts[36] = {0}, columns[36] = {0}, rows[36] = {0};
        for (uint32_t k = 0; k < 36; k++) {
            struct sample2 p =
                sample_multi(set, random_mix(set * 100 + k), (struct sample_part){k % 3, k / 3 % 3, 3, k / 9, 2});
            CHECK((uint32_t)(p.x * 3) == k % 3 && (uint32_t)(p.y * 3) == k / 3 % 3);
            parts[(uint32_t)(p.y * 6) * 6 + (uint32_t)(p.x * 6)]++;
            columns[(uint32_t)(p.x * 36)]++;
            rows[(uint32_t)(p.y * 36)]++;
        }
        for (uint32_t k = 0; k < 36; k++)
            CHECK(parts[k] == 1 && columns[k] == 1 && rows[k] == 1);
    }
}

TEST(disc_map_keeps_areas_and_stays_inside) {
    int inside = 0;
    for (int i = 0; i < 200; i++) {
        for (int j = 0; j < 200; j++) {
            struct sample2 p = sample_disc((struct sample2){(i + 0.5) / 200, (j + 0.5) / 200});
            double r = p.x * p.x + p.y * p.y;
            CHECK(r <= 1);
            inside += r < 0.36;
        }
    }
    CHECK_NEAR(inside / 40000.0, 0.36, 2e-3);
}

/* With one shadow ray per sample, the samples of a pixel must have less variance than the same number of independent
 * ones. */
TEST(samples_of_pixel_and_lamp_are_stratified_together) {
    struct stage s;
    stage_floor(&s);
    double h = 1, r = 2, exact = r * r / (r * r + h * h), together = 0, single = 0;
    s.lights[0] = area_light(LIGHT_DISC, vec3_make(0, h, 0), r);
    s.lights[0].samples = 1;
    for (uint64_t seed = 0; seed < 64; seed++) {
        s.settings.seed = seed;
        s.settings.samples = 8;
        double off = patch_at(&s, 0, 0) - exact;
        together += off * off;
        s.settings.samples = 1;
        double mean = 0;
        for (uint64_t i = 0; i < 64; i++) {
            s.settings.seed = 1000 + seed * 64 + i;
            mean += patch_at(&s, 0, 0) / 64;
        }
        single += (mean - exact) * (mean - exact);
    }
    CHECK(together < 0.2 * single);
    stage_end(&s);
}

/* Lines from anywhere, also through the cone behind the tip; along them one part at most is lit. */
TEST(a_spot_shines_on_the_part_of_a_line_that_its_cone_cuts) {
    struct test_random random = {7};
    int lit = 0;
    for (int i = 0; i < 300; i++) {
        struct vec3 origin = {test_uniform(&random, -3, 3), test_uniform(&random, -3, 3), test_uniform(&random, -3, 3)};
        struct vec3 d = vec3_normalize(vec3_make(test_uniform(&random, -1, 1), test_uniform(&random, -1, 1), 0.5));
        const struct light spot = {.kind = LIGHT_SPOT,
                                   .position = {0.2, 0.1, -0.3},
                                   .direction = vec3_normalize(vec3_make(1, test_uniform(&random, -1, 1), 0.3)),
                                   .cos_outer =
                                       i % 5 ? test_uniform(&random, 0.02, 0.99) : test_uniform(&random, -1, 0),
                                   .cos_inner = 1};
        double from = 0, to = 9;
        bool any = light_cut(&spot, origin, d, &from, &to);
        for (double t = 0.01; t < 9; t += 0.09) {
            struct vec3 to_point = vec3_normalize(vec3_sub(vec3_add_scaled(origin, d, t), spot.position));
            bool shines = vec3_dot(to_point, spot.direction) > spot.cos_outer;
            lit += shines;
            if (shines)
                CHECK(any && t > from - 1e-9 && t < to + 1e-9);
            else if (spot.cos_outer > 0)
                CHECK(!any || t < from + 1e-9 || t > to - 1e-9);
        }
    }
    CHECK(lit > 1000);
}
