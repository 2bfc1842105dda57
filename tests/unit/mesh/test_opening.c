/* How far a mesh is open: closed forms, and Stokes' theorem beside the walks along the boundary. */
#include "formats/model.h"
#include "tests/harness.h"
#include "tests/unit/mesh_makers.h"

#include <math.h>

static double opening_of(const struct maker *maker) {
    struct mesh *mesh = maker_mesh(maker);
    double share = -1, again = -1;
    CHECK(mesh_opening(mesh, &share));
    CHECK(mesh_opening(mesh, &again));
    CHECK_EQ_INT(share == again, 1);
    mesh_release(mesh);
    return share;
}

/* The vector areas of all triangles, added, and their areas. */
static double by_stokes(const struct maker *m) {
    struct vec3 sum = {0, 0, 0};
    double area = 0;
    for (uint32_t f = 0; f < m->face_count; f++) {
        struct vec3 p[3];
        for (int k = 0; k < 3; k++) {
            const double *v = m->vertices[m->corners[3 * f + (uint32_t)k]];
            p[k] = vec3_make(v[0], v[1], v[2]);
        }
        struct vec3 normal = vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0]));
        sum = vec3_add(sum, normal);
        area += vec3_length(normal);
    }
    return vec3_length(sum) / area;
}

/* A sphere without the triangles that are wholly within that angle of its top, or of both poles. */
static void sphere_with_hole(struct maker *m, double degrees, bool both) {
    struct maker whole = {0};
    double lowest = cos(degrees * M_PI / 180);
    maker_sphere(&whole, 24);
    for (uint32_t v = 0; v < whole.vertex_count; v++)
        maker_vertex(m, whole.vertices[v][0], whole.vertices[v][1], whole.vertices[v][2]);
    for (uint32_t f = 0; f < whole.face_count; f++) {
        const uint32_t *c = whole.corners + 3 * f;
        double top = 2, bottom = 2;
        for (int k = 0; k < 3; k++) {
            top = fmin(top, whole.vertices[c[k]][1]);
            bottom = fmin(bottom, -whole.vertices[c[k]][1]);
        }
        if (top < lowest && (!both || bottom < lowest))
            maker_face(m, c, 3);
    }
    maker_free(&whole);
}

TEST(the_opening_of_a_sphere_with_a_hole_is_that_of_the_disc_in_it) {
    for (double degrees = 8; degrees < 90; degrees += 7) {
        struct maker one = {0}, two = {0};
        sphere_with_hole(&one, degrees, false);
        sphere_with_hole(&two, degrees, true);
        double opening = opening_of(&one), half = degrees * M_PI / 180;
        CHECK_NEAR(opening, by_stokes(&one), 1e-12);
        CHECK_NEAR(opening, sin(half) * sin(half) / (2 + 2 * cos(half)), 0.05); /* steps of the rim are coarse */
        CHECK(opening_of(&two) > 1.8 * opening);
        maker_free(&one);
        maker_free(&two);
    }
}

TEST(a_closed_mesh_with_separate_corners_for_each_face_has_no_opening) {
    struct maker m = {0};
    maker_sphere(&m, 5);
    CHECK_EQ_INT(opening_of(&m) == 0, 1);
    maker_free(&m);
}

/* Two rims of n corners, one above the other, without caps. */
static void tube(struct maker *m, int n, double radius, double low, double high, bool turned) {
    uint32_t base = m->vertex_count;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < 2; k++)
            maker_vertex(m, radius * cos(2 * M_PI * i / n), k ? high : low, radius * sin(2 * M_PI * i / n));
    for (int i = 0; i < n; i++) {
        uint32_t a = base + 2 * (uint32_t)i, b = base + 2 * (uint32_t)((i + 1) % n);
        turned ? maker_triangle(m, a, b, a + 1) : maker_triangle(m, a, a + 1, b);
        turned ? maker_triangle(m, a + 1, b, b + 1) : maker_triangle(m, a + 1, b + 1, b);
    }
}

TEST(both_ends_of_a_tube_count_at_any_position_and_size) {
    for (int n = 3; n < 40; n += 9) {
        struct maker m = {0};
        double height = 0.3 * n, side = 2 * sin(M_PI / n);
        tube(&m, n, 1, 0, height, false);
        double ends = n * sin(2 * M_PI / n); /* of both polygons */
        CHECK_NEAR(opening_of(&m), ends / (n * side * height), 1e-12);
        maker_scale(&m, 1e-12, 3e-12, -8e-12, 5e-12);
        CHECK_NEAR(opening_of(&m), ends / (n * side * height), 1e-12);
        maker_scale(&m, 1e30, 0, 0, 0);
        CHECK_NEAR(opening_of(&m), ends / (n * side * height), 1e-12);
        maker_free(&m);
    }
}

/* A bowl and its lid, whose rims do not meet; and two tubes in one another, each open. */
TEST(parts_of_a_mesh_close_the_openings_of_each_other_as_a_lid_does) {
    struct maker pot = {0}, tubes = {0};
    for (int lid = 0; lid < 2; lid++) {
        tube(&pot, 24, lid ? 1.1 : 1, lid ? 1 : 0, lid ? 1.2 : 1, false);
        uint32_t tip = maker_vertex(&pot, 0, lid ? 1.2 : 0, 0), base = tip - 48;
        for (uint32_t i = 0; i < 24; i++) {
            uint32_t a = base + 2 * i + (lid ? 1 : 0), b = base + 2 * ((i + 1) % 24) + (lid ? 1 : 0);
            lid ? maker_triangle(&pot, tip, b, a) : maker_triangle(&pot, tip, a, b);
        }
    }
    tube(&tubes, 24, 1, 0, 1, false);
    tube(&tubes, 24, 0.8, 0, 1, true);
    CHECK_NEAR(opening_of(&pot), by_stokes(&pot), 1e-12);
    CHECK(opening_of(&pot) < 0.05);
    CHECK(opening_of(&tubes) > 0.8);
    maker_free(&pot);
    maker_free(&tubes);
}

/* A flat grid; every other triangle may be turned over, and three such grids may share an edge. */
TEST(a_flat_mesh_is_wholly_open_also_if_its_triangles_disagree_about_the_outside) {
    struct test_random random = {7};
    for (int turns = 0; turns < 2; turns++) {
        struct maker m = {0};
        for (uint32_t i = 0; i < 100; i++)
            maker_vertex(&m, i % 10, 0, i / 10);
        for (uint32_t i = 0; i < 81; i++) {
            uint32_t a = i % 9 + i / 9 * 10;
            bool over = turns && test_uniform(&random, 0, 1) < 0.5;
            over ? maker_triangle(&m, a, a + 1, a + 10) : maker_triangle(&m, a, a + 10, a + 1);
            maker_triangle(&m, a + 1, a + 10, a + 11);
        }
        CHECK_NEAR(opening_of(&m), 1, 1e-12);
        maker_free(&m);
    }
}

TEST(branching_boundaries_have_an_opening_and_a_soup_of_triangles_is_open) {
    struct maker fins = {0}, soup = {0};
    uint32_t low = maker_vertex(&fins, 0, 0, 0), high = maker_vertex(&fins, 0, 1, 0);
    for (int i = 0; i < 3; i++) {
        double x = cos(i * 2.0), z = sin(i * 2.0);
        uint32_t a = maker_vertex(&fins, x, 0, z), b = maker_vertex(&fins, x, 1, z);
        maker_triangle(&fins, low, a, high);
        maker_triangle(&fins, high, a, b);
    }
    struct test_random random = {3};
    maker_soup(&soup, SOUP_LATTICE, 300, &random);
    CHECK(opening_of(&fins) > 0.3);
    CHECK(opening_of(&soup) > 0.05);
    maker_free(&fins);
    maker_free(&soup);
}

TEST(the_bunny_and_the_teapot_are_solids_with_small_holes) {
    static const struct {
        const char *path;
        double opening;
    } models[] = {{"../shared/models/stanford-bunny.obj", 0.0178}, {"../shared/models/teapot.obj", 0.0245}};
    for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
        char *there = test_read_file(models[i].path, NULL);
        struct error error = {0};
        struct model model;
        double share = -1;
        if (!there)
            test_skip("../shared/models is not there");
        free(there);
        CHECK(model_read(&model, models[i].path, &(struct model_options){.single_file = true}, &error));
        CHECK_EQ_INT(model.meshes.count, 1);
        CHECK(mesh_opening(model_meshes(&model)[0].mesh, &share));
        CHECK_NEAR(share, models[i].opening, 0.001);
        model_destroy(&model);
    }
}
