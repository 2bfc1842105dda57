/* Displaced meshes and height fields: closed ones stay closed, edges are short, vertices are where the function says.
 */
#include "mesh/mesh_displace.h"

#include "mesh/mesh_internal.h"
#include "shape/height_field.h"
#include "tests/harness.h"
#include "tests/unit/function_makers.h"
#include "tests/unit/mesh_makers.h"

#include <math.h>
#include <string.h>

/* The displaced mesh; NULL with an error. */
static struct mesh *displaced(const struct mesh *mesh, const struct mesh_displacement *by, struct error *error) {
    struct mesh_input input;
    struct mesh_tables own = {0};
    struct mesh *out = mesh_input_displace(mesh, by, &input, &own, error) ? mesh_create(&input, error) : NULL;
    mesh_tables_destroy(&own);
    return out;
}

static struct mesh *good(const struct mesh *mesh, const struct mesh_displacement *by) {
    struct error error = {0};
    struct mesh *out = displaced(mesh, by, &error);
    if (!out)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return out;
}

static const struct expr_program *noise(struct arena *arena, double strength) {
    struct function_maker m;
    function_begin(&m);
    uint32_t p[3];
    for (int k = 0; k < 3; k++)
        p[k] = fn_scaled(&m, 3, m.p[k]);
    return function_end(&m, fn_scaled(&m, strength, expr_operation(&m.graph, EXPR_NOISE, p[0], p[1], p[2])), arena);
}

static struct mesh *sphere(int size) {
    struct maker maker = {0};
    maker_sphere(&maker, size);
    struct mesh *mesh = maker_mesh(&maker);
    maker_free(&maker);
    return mesh;
}

static double longest_edge(const struct mesh *mesh) {
    double longest = 0;
    for (uint32_t t = 0; t < mesh_triangle_count(mesh); t++) {
        struct vec3 p[3];
        uint32_t slot;
        mesh_triangle(mesh, t, p, &slot);
        for (int k = 0; k < 3; k++)
            longest = fmax(longest, vec3_length(vec3_sub(p[k], p[(k + 1) % 3])));
    }
    return longest;
}

TEST(a_level_divides_every_triangle_into_four) {
    struct arena arena = {0};
    struct mesh *mesh = sphere(1);
    for (int level = 0; level < 5; level++) {
        struct mesh *fine = good(mesh, &(struct mesh_displacement){noise(&arena, 0.1), 0, level});
        CHECK_EQ_INT(mesh_triangle_count(fine), 8 << 2 * level);
        CHECK(mesh_is_closed(fine) && mesh_is_outward(fine));
        mesh_release(fine);
    }
    mesh_release(mesh);
    arena_destroy(&arena);
}

/* Faces of many sizes and shapes, so that neighbours are divided by different templates. */
TEST(closed_meshes_stay_closed_and_their_edges_become_short) {
    struct arena arena = {0};
    struct test_random random = {4};
    for (int i = 0; i < 12; i++) {
        struct maker maker = {0};
        if (i % 2)
            maker_sphere(&maker, 2 + i / 3);
        else
            maker_twisted_torus(&maker, 5 + i, 3 + i / 2, i % 3);
        for (uint32_t v = 0; v < maker.vertex_count; v++)
            maker.vertices[v][0] *= 3; /* slivers */
        struct mesh *mesh = maker_mesh(&maker);
        CHECK(mesh_is_closed(mesh));
        double edge = test_uniform(&random, 0.06, 0.5);
        struct mesh *plain = good(mesh, &(struct mesh_displacement){noise(&arena, 0), edge, 0});
        struct mesh *fine = good(mesh, &(struct mesh_displacement){noise(&arena, 0.2), edge, 0});
        CHECK(longest_edge(plain) <= edge);
        CHECK(mesh_triangle_count(plain) >= mesh_triangle_count(mesh));
        CHECK_EQ_INT(mesh_triangle_count(plain), mesh_triangle_count(fine));
        CHECK(mesh_is_closed(plain) && mesh_is_closed(fine));
        mesh_release(plain);
        mesh_release(fine);
        mesh_release(mesh);
        maker_free(&maker);
    }
    arena_destroy(&arena);
}

/* The offset p / |p| - p. */
TEST(an_offset_makes_a_sphere_of_an_octahedron) {
    struct arena arena = {0};
    struct function_maker m;
    struct error error = {0};
    struct expr_program program;
    uint32_t offset[3], count;
    function_begin(&m);
    uint32_t length = fn_of(
        &m, EXPR_SQRT, fn_add(&m, fn_add(&m, fn_square(&m, m.p[0]), fn_square(&m, m.p[1])), fn_square(&m, m.p[2])));
    for (int k = 0; k < 3; k++)
        offset[k] = fn_sub(&m, fn_two(&m, EXPR_DIVIDE, m.p[k], length), m.p[k]);
    CHECK(expr_compile(&m.graph, offset, 3, &arena, &program, &error));
    struct mesh *mesh = sphere(1), *ball = good(mesh, &(struct mesh_displacement){&program, 0, 5});
    const double(*vertices)[3] = mesh_vertices(ball, &count);
    for (uint32_t t = 0; t < mesh_triangle_count(ball); t++) {
        struct vec3 p[3];
        uint32_t slot;
        mesh_triangle(ball, t, p, &slot);
        CHECK_NEAR(vec3_length(p[0]), 1, 1e-12);
    }
    CHECK(count >= 4098 && vertices != NULL);
    CHECK(mesh_is_closed(ball));
    expr_graph_destroy(&m.graph);
    mesh_release(ball);
    mesh_release(mesh);
    arena_destroy(&arena);
}

/* The square from 0 to 1 in x and z, seen from above, of two triangles; uv is (x, z), material 7. */
static struct mesh *square(bool with_normals) {
    static const double vertices[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}},
                        uvs[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    static const double normals[1][3] = {{1, 1, 0}};
    static const float colours[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};
    static const uint32_t starts[] = {0, 4}, corners[] = {0, 3, 2, 1}, same[] = {0, 0, 0, 0}, material[] = {7};
    struct error error = {0};
    struct mesh_input input = {.vertex_count = 4,
                               .face_count = 1,
                               .vertices = vertices,
                               .face_start = starts,
                               .vertex_index = corners,
                               .uv_count = 4,
                               .uvs = uvs,
                               .uv_index = corners,
                               .face_material = material,
                               .colours = colours};
    if (with_normals) {
        input.normal_count = 1;
        input.normals = normals;
        input.normal_index = same;
    }
    struct mesh *mesh = mesh_create(&input, &error);
    CHECK(mesh != NULL);
    return mesh;
}

TEST(vertices_move_along_the_normal_and_keep_coordinates_colours_and_materials) {
    struct arena arena = {0};
    const struct expr_program *program = noise(&arena, 0.5);
    struct mesh *plane = square(false), *field = good(plane, &(struct mesh_displacement){program, 0.1, 0});
    CHECK(field->triangle_count > 300);
    for (uint32_t t = 0; t < field->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            const double *p = field->vertices[field->corners[t][k]], *uv = field->uvs[field->uv_corners[t][k]];
            const float *colour = field->colours[field->corners[t][k]];
            double inputs[EXPR_INPUT_COUNT] = {p[0], 0, p[2]}, out[EXPR_OUTPUTS];
            expr_evaluate(program, inputs, out);
            CHECK_NEAR(p[1], out[0], 1e-15);
            CHECK(uv[0] == p[0] && uv[1] == p[2]);
            CHECK(colour[0] == (float)p[0] && colour[2] == (float)p[2]);
            CHECK_EQ_INT(field->materials[t], 7);
        }
    mesh_release(field);
    mesh_release(plane);
    arena_destroy(&arena);
}

TEST(given_normals_are_the_directions_of_the_displacement) {
    struct arena arena = {0};
    struct function_maker m;
    function_begin(&m);
    const struct expr_program *program = function_end(&m, fn_number(&m, sqrt(2)), &arena);
    struct mesh *plane = square(true), *moved = good(plane, &(struct mesh_displacement){program, 0, 2});
    CHECK_NEAR(moved->bounds.min.x, 1, 1e-12);
    CHECK_NEAR(moved->bounds.max.x, 2, 1e-12);
    CHECK_NEAR(moved->bounds.min.y, 1, 1e-12);
    CHECK_NEAR(moved->bounds.max.z, 1, 1e-12);
    mesh_release(moved);
    mesh_release(plane);
    arena_destroy(&arena);
}

/* A cylinder around y whose u jumps from 1 to 0, and whose caps have other coordinates. */
TEST(seams_of_texture_coordinates_do_not_open_a_closed_mesh) {
    enum { SIDES = 9 };
    double vertices[2 * SIDES][3], uvs[2 * (SIDES + 1) + 1][2];
    uint32_t starts[SIDES + 3] = {0}, corners[6 * SIDES], coordinates[6 * SIDES], at = 0;
    for (int i = 0; i <= SIDES; i++)
        for (int k = 0; k < 2; k++) {
            double angle = 2 * M_PI * i / SIDES;
            uvs[2 * i + k][0] = (double)i / SIDES;
            uvs[2 * i + k][1] = k;
            if (i < SIDES) {
                vertices[2 * i + k][0] = cos(angle);
                vertices[2 * i + k][1] = k;
                vertices[2 * i + k][2] = sin(angle);
            }
        }
    uvs[2 * (SIDES + 1)][0] = uvs[2 * (SIDES + 1)][1] = 0.5;
    for (uint32_t i = 0; i < SIDES; i++) {
        const uint32_t side[4] = {2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2};
        for (int k = 0; k < 4; k++) {
            coordinates[at] = side[k];
            corners[at++] = side[k] % (2 * SIDES);
        }
        starts[i + 1] = at;
    }
    for (uint32_t k = 0; k < 2; k++) {
        for (uint32_t i = 0; i < SIDES; i++) {
            coordinates[at] = 2 * (SIDES + 1);
            corners[at++] = k ? 2 * (SIDES - 1 - i) + 1 : 2 * i;
        }
        starts[SIDES + 1 + k] = at;
    }
    struct mesh_input input = {.vertex_count = 2 * SIDES,
                               .face_count = SIDES + 2,
                               .vertices = (const double(*)[3])vertices,
                               .face_start = starts,
                               .vertex_index = corners,
                               .uv_count = 2 * (SIDES + 1) + 1,
                               .uvs = (const double(*)[2])uvs,
                               .uv_index = coordinates};
    struct error error = {0};
    struct arena arena = {0};
    struct function_maker m;
    struct mesh *mesh = mesh_create(&input, &error);
    CHECK(mesh && mesh_is_closed(mesh));
    function_begin(&m);
    uint32_t u = expr_input(&m.graph, EXPR_U);
    const struct expr_program *program = function_end(&m, fn_scaled(&m, 0.3, u), &arena);
    struct mesh *moved = good(mesh, &(struct mesh_displacement){program, 0.15, 0});
    CHECK(mesh_is_closed(moved));
    mesh_release(moved);
    mesh_release(mesh);
    arena_destroy(&arena);
}

TEST(displacements_that_are_impossible_are_refused) {
    struct arena arena = {0};
    struct maker torus = {0};
    struct error error = {0};
    struct function_maker m;
    maker_twisted_torus(&torus, 5, 4, 0); /* 40 triangles: the limit comes after little more than a quarter of it */
    struct mesh *mesh = maker_mesh(&torus);
    maker_free(&torus);
    CHECK(!displaced(mesh, &(struct mesh_displacement){noise(&arena, 1), 1e-5, 0}, &error));
    CHECK(strstr(error.text, "edge = 1e-05 needs more than 10000000 triangles; edge = 0.0"));
    error = (struct error){0};
    CHECK(!displaced(mesh, &(struct mesh_displacement){noise(&arena, 1), 0, 12}, &error));
    CHECK_TEXT(error.text, "level = 12 makes more than 10000000 triangles; level = 8 is possible");
    error = (struct error){0};
    function_begin(&m);
    CHECK(!displaced(mesh, &(struct mesh_displacement){function_end(&m, fn_of(&m, EXPR_SQRT, m.p[0]), &arena), 0.5, 0},
                     &error));
    CHECK(strstr(error.text, "at p = {-") && strstr(error.text, "the function is not a number (NaN)"));
    error = (struct error){0};
    function_begin(&m);
    CHECK(!displaced(mesh, &(struct mesh_displacement){function_end(&m, expr_input(&m.graph, EXPR_V), &arena), 0.5, 0},
                     &error));
    CHECK_TEXT(error.text, "the function reads s.v, but the mesh has no texture coordinates");
    error = (struct error){0};
    function_begin(&m);
    CHECK(!displaced(
        mesh, &(struct mesh_displacement){function_end(&m, expr_input(&m.graph, EXPR_TIME), &arena), 0.5, 0}, &error));
    CHECK_TEXT(error.text, "the function reads s.time, but a displacement may depend only on p, s.u, s.v and s.normal");
    mesh_release(mesh);
    arena_destroy(&arena);
}

TEST(a_refined_height_field_is_the_same_surface) {
    enum { COLUMNS = 5, ROWS = 4 };
    struct test_random random = {9};
    struct arena arena = {0};
    struct error error = {0};
    double heights[ROWS * COLUMNS];
    for (int i = 0; i < ROWS * COLUMNS; i++)
        heights[i] = test_uniform(&random, 0, 1);
    struct height_field_input input = {heights, COLUMNS, ROWS, false, -1, false}, refined;
    const struct height_field *field = height_field_build(&arena, &input, &error);
    for (uint32_t n = 1; n < 8; n++) {
        CHECK(height_field_refine(field, n, &arena, &refined, &error));
        CHECK(refined.columns == 4 * n + 1 && refined.rows == 3 * n + 1 && refined.floor == -1);
        const struct height_field *fine = height_field_build(&arena, &refined, &error);
        CHECK(fine != NULL);
        for (int i = 0; i < 500; i++) {
            struct vec3 p =
                vec3_make(test_uniform(&random, 0, 1), test_uniform(&random, -0.5, 1), test_uniform(&random, 0, 1));
            struct vec3 below = vec3_make(p.x, p.y - 1e-9, p.z), above = vec3_make(p.x, p.y + 1e-9, p.z);
            if (height_field_contains(field, below) == height_field_contains(field, above))
                CHECK(height_field_contains(fine, p) == height_field_contains(field, p));
        }
    }
    CHECK(!height_field_refine(field, 10000, &arena, &refined, &error));
    arena_destroy(&arena);
}
