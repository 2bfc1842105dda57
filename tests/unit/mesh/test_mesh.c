/* Meshes: closed or not, watertight, the index against a test of every triangle, and the description of hits. */
#include "mesh/mesh_internal.h"
#include "mesh/mesh_smooth.h"
#include "mesh/mesh_topology.h"
#include "tests/unit/mesh_makers.h"

static struct geom_scratch scratch_make(void) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 4096));
    return scratch;
}

static bool same_bits(double a, double b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

TEST(mesh_of_a_box_is_closed_and_without_one_face_it_names_three_open_edges) {
    struct maker m = {0};
    for (int i = 0; i < 8; i++)
        maker_vertex(&m, i & 1, i >> 1 & 1, i >> 2);
    const uint32_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (int f = 0; f < 5; f++)
        maker_face(&m, faces[f], 4);
    struct mesh *open = maker_mesh(&m);
    char text[600];
    CHECK(!mesh_is_closed(open));
    CHECK(mesh_is_open(open));
    mesh_describe_open_edges(open, text, sizeof text);
    CHECK_TEXT(text, "the first open edges (of one face, or of faces that disagree about the outside) go "
                     "from {0, 0, 1} to {1, 0, 1}, from {0, 0, 1} to {0, 1, 1}, from {1, 0, 1} to {1, 1, 1}; "
                     "weld = 2e-05 in gr.mesh joins vertices closer than that, which closes seams but no holes");
    CHECK_EQ_INT(mesh_triangle_count(open), 10);
    maker_face(&m, faces[5], 4);
    struct mesh *closed = maker_mesh(&m);
    CHECK(mesh_is_closed(closed));
    CHECK(!mesh_is_open(closed));
    CHECK_EQ_INT(mesh_triangle_count(closed), 12);
    struct mesh_input input = maker_input(&m);
    CHECK(mesh_equals_input(closed, &input));
    CHECK(!mesh_equals_input(open, &input));
    uint64_t hash = mesh_input_hash(&input);
    input.name = "another";
    CHECK(hash == mesh_input_hash(&input));
    m.vertices[0][0] = 0.5;
    CHECK(hash != mesh_input_hash(&input));
    CHECK(!mesh_equals_input(closed, &input));
    mesh_release(open);
    mesh_release(closed);
    maker_free(&m);
}

TEST(mesh_with_vertices_given_once_per_triangle_is_closed_by_position) {
    struct maker m = {0};
    maker_sphere(&m, 5);
    struct mesh *mesh = maker_mesh(&m);
    CHECK(mesh_is_closed(mesh));
    mesh_release(mesh);
    m.vertices[7][1] = nextafter(m.vertices[7][1], 2);
    mesh = maker_mesh(&m);
    CHECK(mesh_is_open(mesh) == !mesh_is_closed(mesh));
    mesh_release(mesh);
    maker_free(&m);
}

/* A ball whose corners were written with few digits, each of another triangle with another error. */
TEST(mesh_whose_corners_are_apart_is_closed_by_welding_with_a_distance) {
    struct maker m = {0};
    struct test_random random = {5};
    maker_sphere(&m, 12);
    struct mesh *whole = maker_mesh(&m);
    for (uint32_t v = 0; v < m.vertex_count; v++)
        for (int k = 0; k < 3; k++)
            m.vertices[v][k] += test_uniform(&random, -1e-7, 1e-7);
    for (int scale = 0; scale < 2; scale++) {
        uint32_t counts[2];
        for (int i = 0; i < 2; i++) {
            struct mesh_input input = maker_input(&m);
            struct mesh_tables own = {0};
            struct error error = {0};
            CHECK(mesh_input_weld(&input, &own, ldexp(i ? 1e-6 : 1e-30, 40 * scale), &error));
            counts[i] = input.vertex_count;
            struct mesh *mesh = mesh_create(&input, &error);
            CHECK_EQ_INT(mesh_is_closed(mesh), i);
            CHECK(!i || mesh_triangle_count(mesh) == mesh_triangle_count(whole));
            mesh_release(mesh);
            mesh_tables_destroy(&own);
        }
        CHECK(counts[1] < counts[0]);
        for (uint32_t v = 0; v < m.vertex_count; v++)
            for (int k = 0; k < 3; k++)
                m.vertices[v][k] = ldexp(m.vertices[v][k], 40);
    }
    mesh_release(whole);
    maker_free(&m);
}

TEST(vertices_closer_than_the_distance_become_the_lowest_kept_one_as_in_a_search_of_all) {
    enum { COUNT = 2000 };
    static double vertices[COUNT][3];
    static uint32_t same[COUNT], wanted[COUNT];
    struct test_random random = {9};
    for (int round = 0; round < 12; round++) {
        double distance = ldexp(1, -round);
        for (int v = 0; v < COUNT; v++)
            for (int k = 0; k < 3; k++)
                vertices[v][k] = test_uniform(&random, -1, 1) * (k == 2 ? 1e-3 : 1);
        CHECK(mesh_weld_near((const double(*)[3])vertices, COUNT, distance, same));
        for (uint32_t v = 0; v < COUNT; v++) {
            wanted[v] = v;
            for (uint32_t w = 0; w < v && wanted[v] == v; w++) {
                const double *p = vertices[v], *q = vertices[w];
                double length = vec3_length(vec3_make(q[0] - p[0], q[1] - p[1], q[2] - p[2]));
                if (wanted[w] == w && length < distance)
                    wanted[v] = w;
            }
        }
        CHECK(memcmp(same, wanted, sizeof same) == 0);
    }
}

TEST(mesh_colours_of_faces_are_those_of_their_triangles_also_when_some_are_dropped) {
    struct maker m = {0};
    static const float colours[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 8; i++)
        maker_vertex(&m, i & 1, i >> 1 & 1, i >> 2);
    maker_face(&m, (const uint32_t[]){0, 1, 3, 2}, 4);
    maker_face(&m, (const uint32_t[]){0, 0, 1}, 3);
    maker_face(&m, (const uint32_t[]){4, 5, 7}, 3);
    struct mesh_input input = maker_input(&m);
    struct error error = {0};
    uint64_t plain = mesh_input_hash(&input);
    input.colours = colours;
    input.colours_by_face = true;
    CHECK(mesh_input_hash(&input) != plain);
    struct mesh *mesh = mesh_create(&input, &error);
    CHECK_EQ_INT(mesh_triangle_count(mesh), 3);
    for (uint32_t t = 0; t < 3; t++) {
        struct crossing crossing = {.part = t, .u = 0.25, .v = 0.25};
        struct ray ray = test_ray(vec3_make(0, 0, 9), vec3_make(0, 0, -1));
        struct surface surface;
        mesh_describe(mesh, &ray, &crossing, &surface);
        CHECK(surface.has_colour && surface.colour.r == (t < 2) && surface.colour.b == (t == 2));
    }
    mesh_release(mesh);
    maker_free(&m);
}

TEST(mesh_drops_degenerate_faces_and_counts_them) {
    struct maker m = {0};
    for (int i = 0; i < 5; i++)
        maker_vertex(&m, i, i % 2, 0);
    maker_vertex(&m, 2, 0, 0);
    maker_triangle(&m, 0, 1, 2);
    maker_triangle(&m, 0, 1, 1);
    maker_triangle(&m, 0, 2, 4); /* on a line */
    maker_triangle(&m, 0, 2, 5); /* two corners in one place */
    uint32_t polygon[4] = {0, 1, 2, 5};
    maker_face(&m, polygon, 4);
    struct mesh *mesh = maker_mesh(&m);
    CHECK_EQ_INT(mesh_dropped_faces(mesh), 3);
    CHECK_EQ_INT(mesh_triangle_count(mesh), 2);
    struct mesh_input input = maker_input(&m);
    CHECK(mesh_equals_input(mesh, &input));
    mesh_release(mesh);
    maker_free(&m);
}

TEST(mesh_without_faces_is_legal_and_never_hit) {
    struct maker m = {0};
    maker_vertex(&m, 1, 2, 3);
    struct mesh *mesh = maker_mesh(&m);
    struct geom_scratch scratch = scratch_make();
    struct ray ray = test_ray(vec3_all(0), vec3_make(1, 2, 3));
    struct crossing crossing;
    struct crossing_list list;
    struct box box = mesh_bounds(mesh);
    CHECK(box_is_empty(&box));
    CHECK(!mesh_is_closed(mesh));
    CHECK(!mesh_nearest(mesh, &ray, ACCEL_GRID, &scratch, &crossing));
    CHECK(!mesh_any(mesh, &ray, ACCEL_GRID, &scratch));
    CHECK(mesh_crossings(mesh, &ray, ACCEL_GRID, &scratch, &list) && list.count == 0);
    geom_scratch_destroy(&scratch);
    mesh_release(mesh);
    maker_free(&m);
}

TEST(flat_mesh_is_hit_from_both_sides_and_enter_means_against_the_normal) {
    struct maker m = {0};
    maker_vertex(&m, 0, 0, 0);
    maker_vertex(&m, 1, 0, 0);
    maker_vertex(&m, 0, 1, 0);
    maker_triangle(&m, 0, 1, 2);
    struct mesh *mesh = maker_mesh(&m);
    struct geom_scratch scratch = scratch_make();
    for (int side = -1; side <= 1; side += 2) {
        struct ray ray = test_ray(vec3_make(0.25, 0.25, 2 * side), vec3_make(0, 0, -4 * side));
        struct crossing crossing;
        struct surface surface;
        CHECK(mesh_nearest(mesh, &ray, ACCEL_GRID, &scratch, &crossing));
        CHECK(crossing.t == 0.5 && crossing.u == 0.25 && crossing.v == 0.25 && crossing.part == 0);
        CHECK(crossing.enter == (side > 0));
        mesh_describe(mesh, &ray, &crossing, &surface);
        CHECK(surface.normal.z > 0 && surface.normal.x == 0);
        CHECK(surface.point.x == 0.25 && surface.point.y == 0.25 && surface.point.z == 0);
        ray.t_max = 0.5; /* the interval is open */
        CHECK(!mesh_nearest(mesh, &ray, ACCEL_GRID, &scratch, &crossing));
        CHECK(!mesh_any(mesh, &ray, ACCEL_GRID, &scratch));
        ray.t_min = 0.5;
        ray.t_max = INFINITY;
        CHECK(!mesh_any(mesh, &ray, ACCEL_GRID, &scratch));
    }
    geom_scratch_destroy(&scratch);
    mesh_release(mesh);
    maker_free(&m);
}

TEST(mesh_describe_interpolates_normals_uv_and_their_derivatives) {
    const double vertices[4][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
    const double normals[4][3] = {{0, 0, 5}, {3, 0, 3}, {0, 0, 1}, {0, 0, -1}};
    const double uvs[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const uint32_t start[3] = {0, 4, 7}, corner[7] = {0, 1, 2, 3, 0, 1, 2}, none[7] = {0, 1, 2, 3, UINT32_MAX, 1, 2};
    const uint32_t material[2] = {7, 9};
    struct mesh_input input = {.name = "t",
                               .vertex_count = 4,
                               .face_count = 2,
                               .vertices = vertices,
                               .face_start = start,
                               .vertex_index = corner,
                               .normal_count = 4,
                               .normals = normals,
                               .normal_index = none,
                               .uv_count = 4,
                               .uvs = uvs,
                               .uv_index = none,
                               .face_material = material};
    struct error error;
    struct mesh *mesh = mesh_create(&input, &error);
    CHECK(mesh && mesh_has_uv(mesh) && mesh->normal_count > 0);
    struct ray ray = test_ray(vec3_make(1.5, 0.5, 1), vec3_make(0, 0, -1));
    struct crossing crossing = {.part = 0, .u = 0.5, .v = 0.25};
    struct surface s;
    mesh_describe(mesh, &ray, &crossing, &s);
    CHECK_NEAR(s.point.x, 1.5, 0);
    CHECK_NEAR(s.u, 0.75, 0);
    CHECK_NEAR(s.v, 0.25, 0);
    CHECK(s.has_uv && s.material_slot == 7);
    CHECK_NEAR(s.dpdu.x, 2, 0);
    CHECK_NEAR(s.dpdu.y, 0, 0);
    CHECK_NEAR(s.dpdv.y, 2, 0);
    CHECK_NEAR(s.shading_normal.x, 0.5 * sqrt(0.5),
               1e-15); /* only the direction of corner normals counts, not their length */
    CHECK_NEAR(s.shading_normal.z, 0.5 + 0.5 * sqrt(0.5), 1e-15);
    crossing = (struct crossing){.part = 1, .u = 0.5, .v = 0.5}; /* triangle 0 2 3, where the normals cancel */
    mesh_describe(mesh, &ray, &crossing, &s);
    CHECK(s.shading_normal.x == s.normal.x && s.shading_normal.z == s.normal.z && s.normal.z > 0);
    crossing.part = 2; /* a corner without normal and uv */
    mesh_describe(mesh, &ray, &crossing, &s);
    CHECK(!s.has_uv && s.dpdu.x == 0 && s.material_slot == 9);
    CHECK(s.shading_normal.z == s.normal.z);
    mesh_release(mesh);
}

/* On every line entries and exits must alternate and be equal in number; the same with the index and by brute force. */
static void check_parity(const struct mesh *mesh, const struct ray *ray, struct geom_scratch *scratch, bool expect_hit,
                         const char *what) {
    struct crossing_list list;
    scratch->used = 0;
    if (!mesh_crossings(mesh, ray, ACCEL_GRID, scratch, &list)) {
        test_fail(__FILE__, __LINE__, "%s: overflow", what);
        return;
    }
    if (list.count % 2 != 0 || (expect_hit && list.count == 0))
        test_fail(__FILE__, __LINE__, "%s: %u crossings", what, list.count);
    for (uint32_t i = 0; i < list.count; i++) {
        if (scratch->items[i].enter != (i % 2 == 0))
            test_fail(__FILE__, __LINE__, "%s: crossing %u of %u goes the wrong way", what, i, list.count);
        if (i && scratch->items[i].t < scratch->items[i - 1].t)
            test_fail(__FILE__, __LINE__, "%s: crossing %u out of order", what, i);
    }
}

static struct vec3 vertex_of(const struct maker *m, uint32_t v) {
    return vec3_make(m->vertices[v][0], m->vertices[v][1], m->vertices[v][2]);
}

TEST(closed_meshes_from_a_thousandth_to_a_million_let_no_ray_through_vertices_and_edges) {
    struct geom_scratch scratch = scratch_make();
    struct test_random random = {1};
    const double scales[] = {1e-3, 1, 37.7, 1e6};
    for (int solid = 0; solid < 3; solid++)
        for (int k = 0; k < 4; k++) {
            struct maker m = {0};
            if (solid < 2)
                maker_sphere(&m, solid ? 4 : 20);
            else
                maker_twisted_torus(&m, 60, 24, 3);
            double shift = k % 2 ? 3 * scales[k] : 0;
            maker_scale(&m, scales[k], shift, -shift, shift / 7);
            struct mesh *mesh = maker_mesh(&m);
            CHECK(mesh_is_closed(mesh));
            struct box box = mesh_bounds(mesh);
            double size = vec3_length(vec3_sub(box.max, box.min));
            struct vec3 middle = vec3_scale(vec3_add(box.min, box.max), 0.5);
            for (int i = 0; i < 6000; i++) {
                uint32_t f = (uint32_t)test_uniform(&random, 0, m.face_count);
                uint32_t j = (uint32_t)test_uniform(&random, 0, 3);
                struct vec3 a = vertex_of(&m, m.corners[3 * f + j]), b = vertex_of(&m, m.corners[3 * f + (j + 1) % 3]);
                double share = i % 3 == 0 ? 0 : i % 3 == 1 ? 0.5 : test_uniform(&random, 0, 1);
                struct vec3 target = vec3_add(a, vec3_scale(vec3_sub(b, a), share));
                struct vec3 origin = vec3_add(middle, test_point(&random, 3 * size));
                struct ray ray = test_ray(origin, vec3_sub(target, origin));
                check_parity(mesh, &ray, &scratch, false, "aimed from outside");
                if (solid == 2)
                    continue;
                /* From inside every ray must hit something. */
                ray = test_ray(middle, vec3_sub(target, middle));
                struct crossing crossing;
                if (!mesh_nearest(mesh, &ray, ACCEL_GRID, &scratch, &crossing))
                    test_fail(__FILE__, __LINE__, "a ray from inside escaped, scale %g", scales[k]);
                else
                    CHECK(!crossing.enter);
                CHECK(mesh_any(mesh, &ray, ACCEL_GRID, &scratch));
                check_parity(mesh, &ray, &scratch, true, "from inside");
            }
            /* Along the axes through vertices: the ray lies in edges and faces of the sphere. */
            for (uint32_t v = 0; v < m.vertex_count; v += 1 + m.vertex_count / 500)
                for (int axis = 0; axis < 3; axis++) {
                    struct vec3 d = vec3_make(axis == 0, axis == 1, axis == 2);
                    struct ray ray = test_ray(vec3_add_scaled(vertex_of(&m, v), d, -4 * size), d);
                    check_parity(mesh, &ray, &scratch, false, "along an axis");
                }
            mesh_release(mesh);
            maker_free(&m);
        }
    geom_scratch_destroy(&scratch);
}

static bool same_crossing(const struct crossing *a, const struct crossing *b) {
    return same_bits(a->t, b->t) && a->part == b->part && same_bits(a->u, b->u) && same_bits(a->v, b->v) &&
           a->enter == b->enter;
}

static uint64_t check_against_brute(const struct maker *m, enum accel_kind accel, const char *what, int rays,
                                    struct test_random *random) {
    struct mesh *mesh = maker_mesh(m);
    struct error error;
    CHECK(accel != ACCEL_KDTREE || mesh_build_accel(mesh, ACCEL_KDTREE, NULL, &error));
    struct geom_scratch scratch = scratch_make();
    uint64_t hits = 0;
    for (int i = 0; i < rays; i++) {
        struct ray ray = test_any_ray(m, mesh, random);
        struct crossing fast = {0}, slow = {0};
        bool found = mesh_nearest(mesh, &ray, accel, &scratch, &fast);
        bool expected = mesh_nearest(mesh, &ray, ACCEL_NONE, &scratch, &slow);
        hits += expected;
        if (found != expected || (found && !same_crossing(&fast, &slow)))
            test_fail(__FILE__, __LINE__, "%s, ray %d: %d at %.17g of %u, not %d at %.17g of %u", what, i, found,
                      fast.t, fast.part, expected, slow.t, slow.part);
        if (mesh_any(mesh, &ray, accel, &scratch) != expected)
            test_fail(__FILE__, __LINE__, "%s, ray %d: any is not %d", what, i, expected);
        if (i % 8)
            continue;
        struct crossing_list all, every;
        scratch.used = 0;
        CHECK(mesh_crossings(mesh, &ray, accel, &scratch, &all));
        CHECK(mesh_crossings(mesh, &ray, ACCEL_NONE, &scratch, &every));
        bool same = all.count == every.count;
        for (uint32_t j = 0; same && j < all.count; j++)
            same = same_crossing(&scratch.items[all.first + j], &scratch.items[every.first + j]);
        if (!same)
            test_fail(__FILE__, __LINE__, "%s, ray %d: %u crossings, not %u", what, i, all.count, every.count);
    }
    geom_scratch_destroy(&scratch);
    mesh_release(mesh);
    return hits;
}

static void many_meshes_against_brute(enum accel_kind accel, uint64_t rays, uint64_t seed) {
    struct test_random random = {seed};
    const char *names[SOUP_KINDS] = {"even", "slivers", "flat", "mixed sizes", "tiny in huge", "lattice", "line"};
    const uint32_t counts[] = {1, 3, 9, 40, 170, 600};
    uint64_t done = 0, hits = 0;
    for (int round = 0; done < rays; round++) {
        struct maker m = {0};
        int kind = round % (SOUP_KINDS + 2);
        uint32_t count = counts[(uint32_t)test_uniform(&random, 0, 6)];
        if (kind < SOUP_KINDS)
            maker_soup(&m, (enum soup)kind, count, &random);
        else if (kind == SOUP_KINDS)
            maker_sphere(&m, 6);
        else
            maker_twisted_torus(&m, 12, 8, 1);
        double scale = pow(10, floor(test_uniform(&random, -3, 7)));
        maker_scale(&m, scale, round % 5 == 0 ? 100 * scale : 0, 0, 0);
        int share = count > 100 ? 2500 : 12500;
        hits += check_against_brute(&m, accel, kind < SOUP_KINDS ? names[kind] : "solid", share, &random);
        done += (uint64_t)share;
        maker_free(&m);
    }
    CHECK(hits > done / 10);
}

TEST(mesh_index_gives_the_bits_of_trying_every_triangle) {
    many_meshes_against_brute(ACCEL_GRID, 250000, 2);
}

TEST_LONG(mesh_index_gives_the_bits_of_trying_every_triangle_on_ten_million_rays) {
    many_meshes_against_brute(ACCEL_GRID, 10000000, 3);
}

TEST(kd_tree_of_a_mesh_gives_the_bits_of_trying_every_triangle) {
    many_meshes_against_brute(ACCEL_KDTREE, 250000, 12);
}

TEST_LONG(kd_tree_of_a_mesh_gives_the_bits_of_trying_every_triangle_on_ten_million_rays) {
    many_meshes_against_brute(ACCEL_KDTREE, 10000000, 13);
}

TEST(scaling_a_mesh_by_a_power_of_two_keeps_every_bit) {
    struct test_random random = {4};
    struct geom_scratch scratch = scratch_make();
    const double factors[] = {0x1p-40, 0x1p-10, 0x1p20, 0x1p60};
    for (int kind = 0; kind < SOUP_KINDS; kind++) {
        struct maker m = {0};
        maker_soup(&m, (enum soup)kind, 300, &random);
        struct mesh *mesh = maker_mesh(&m);
        for (int k = 0; k < 4; k++) {
            struct maker scaled = {0};
            for (uint32_t i = 0; i < m.vertex_count; i++)
                maker_vertex(&scaled, m.vertices[i][0] * factors[k], m.vertices[i][1] * factors[k],
                             m.vertices[i][2] * factors[k]);
            for (uint32_t i = 0; i < m.face_count; i++)
                maker_triangle(&scaled, m.corners[3 * i], m.corners[3 * i + 1], m.corners[3 * i + 2]);
            struct mesh *other = maker_mesh(&scaled);
            CHECK_EQ_INT(mesh_memory(mesh), mesh_memory(other));
            for (int i = 0; i < 2000; i++) {
                struct ray ray = test_any_ray(&m, mesh, &random), big = ray;
                big.origin = vec3_scale(ray.origin, factors[k]);
                big.direction = vec3_scale(ray.direction, factors[k]);
                struct crossing a = {0}, b = {0};
                uint64_t tests = scratch.cost.triangle_tests, steps = scratch.cost.hierarchy_steps,
                         voxels = scratch.cost.voxels;
                bool found = mesh_nearest(mesh, &ray, ACCEL_GRID, &scratch, &a);
                tests = scratch.cost.triangle_tests - tests;
                steps = scratch.cost.hierarchy_steps - steps;
                voxels = scratch.cost.voxels - voxels;
                uint64_t tests2 = scratch.cost.triangle_tests, steps2 = scratch.cost.hierarchy_steps,
                         voxels2 = scratch.cost.voxels;
                CHECK(found == mesh_nearest(other, &big, ACCEL_GRID, &scratch, &b));
                CHECK(!found || same_crossing(&a, &b));
                CHECK(scratch.cost.triangle_tests - tests2 == tests && scratch.cost.hierarchy_steps - steps2 == steps &&
                      scratch.cost.voxels - voxels2 == voxels);
            }
            mesh_release(other);
            maker_free(&scaled);
        }
        mesh_release(mesh);
        maker_free(&m);
    }
    geom_scratch_destroy(&scratch);
}

TEST(equal_t_goes_to_the_lowest_triangle) {
    struct maker m = {0};
    for (int copy = 0; copy < 40; copy++) {
        uint32_t v = maker_vertex(&m, 0, 0, 0);
        maker_vertex(&m, 1, 0, 0);
        maker_vertex(&m, 0, 1, 0);
        maker_triangle(&m, v, v + 1, v + 2);
    }
    struct mesh *mesh = maker_mesh(&m);
    struct geom_scratch scratch = scratch_make();
    struct ray ray = test_ray(vec3_make(0.3, 0.3, 1), vec3_make(0, 0, -1));
    struct crossing crossing = {.part = 99};
    struct crossing_list list;
    CHECK(mesh_nearest(mesh, &ray, ACCEL_GRID, &scratch, &crossing) && crossing.part == 0);
    CHECK(mesh_crossings(mesh, &ray, ACCEL_GRID, &scratch, &list) && list.count == 40);
    geom_scratch_destroy(&scratch);
    mesh_release(mesh);
    maker_free(&m);
}

TEST(crossings_report_missing_scratch_and_then_succeed) {
    struct maker m = {0};
    for (int i = 0; i < 100; i++) {
        uint32_t v = maker_vertex(&m, 0, 0, i);
        maker_vertex(&m, 1, 0, i);
        maker_vertex(&m, 0, 1, i);
        maker_triangle(&m, v, v + 1, v + 2);
    }
    struct mesh *mesh = maker_mesh(&m);
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 8));
    struct ray ray = test_ray(vec3_make(0.3, 0.3, -1), vec3_make(0, 0, 1));
    struct crossing_list list;
    int tries = 1;
    while (!mesh_crossings(mesh, &ray, ACCEL_GRID, &scratch, &list) && tries < 20) {
        CHECK(scratch.overflow);
        CHECK(geom_scratch_grow(&scratch));
        tries++;
    }
    CHECK(list.count == 100 && tries > 1 && tries < 20);
    geom_scratch_destroy(&scratch);
    mesh_release(mesh);
    maker_free(&m);
}

TEST(mesh_of_a_million_triangles_needs_less_than_200_bytes_each) {
    struct maker m = {0};
    maker_twisted_torus(&m, 1000, 500, 2);
    struct mesh *mesh = maker_mesh(&m);
    CHECK_EQ_INT(mesh_triangle_count(mesh), 1000000);
    CHECK(mesh_is_closed(mesh));
    CHECK((double)mesh_memory(mesh) < 200e6);
    mesh_release(mesh);
    maker_free(&m);
}
