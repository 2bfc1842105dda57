/* Corner cases of shapes: NaN and infinity in every parameter, solids with any capacity for crossings, nearly equal
 * meshes, quadrics of every axis. */
#include "csg/csg_build.h"
#include "shape/quadric.h"
#include "shape/torus.h"
#include "tests/unit/swept_makers.h"

/* --- NaN and infinity --- */

static double lathe_numbers[] = {0, 0, 1, 0, 1, 1, 0, 2}, prism_numbers[] = {0, 1, 0, 0, 1, 0, 1, 1},
              sweep_numbers[] = {0.1, 0.2, 0, 0, 0, 1, 1, 0}, curve_numbers[] = {0.1, 0.2, 0, 0, 0, 1, 1, 0},
              field_numbers[] = {-1, 0, 1, 0, 1}, blob_numbers[] = {0.5, 0, 0, 0, 1, 0, 0, 1, 1}, patch_numbers[48];

/* The number of a shape's parameters, and the function that builds it from them. */
static bool build_lathe(struct arena *arena, struct error *error) {
    return lathe_build(arena, &(struct lathe_input){.points = (const double(*)[2])lathe_numbers, .count = 4}, error);
}

static bool build_prism(struct arena *arena, struct error *error) {
    return prism_build(arena,
                       &(struct prism_input){.from = prism_numbers[0],
                                             .to = prism_numbers[1],
                                             .points = (const double(*)[2])(prism_numbers + 2),
                                             .curve_starts = (const uint32_t[]){0, 3},
                                             .curve_count = 1},
                       error);
}

static bool build_sweep(struct arena *arena, struct error *error) {
    return sweep_build(
        arena,
        &(struct sweep_input){.radii = sweep_numbers, .points = (const double(*)[3])(sweep_numbers + 2), .count = 2},
        error);
}

static bool build_curve(struct arena *arena, struct error *error) {
    return curve_build(
        arena,
        &(struct curve_input){.widths = curve_numbers, .points = (const double(*)[3])(curve_numbers + 2), .count = 2},
        error);
}

static bool build_field(struct arena *arena, struct error *error) {
    return height_field_build(
        arena,
        &(struct height_field_input){.floor = field_numbers[0], .heights = field_numbers + 1, .columns = 2, .rows = 2},
        error);
}

static bool build_blob(struct arena *arena, struct error *error) {
    const double *n = blob_numbers;
    const struct blob_element element = {{n[1], n[2], n[3]}, {n[4], n[5], n[6]}, n[7], n[8]};
    return blob_build(arena, &(struct blob_input){&element, 1, n[0]}, error);
}

static bool build_patch(struct arena *arena, struct error *error) {
    struct mesh_input out;
    return patch_tessellate(
        arena, &(struct patch_input){.points = (const double(*)[3])patch_numbers, .count = 1, .tolerance = 0.1}, &out,
        error);
}

TEST(shapes_refuse_numbers_that_are_nan_and_positions_too_far_away) {
    static const struct {
        double *numbers;
        int count;
        bool (*build)(struct arena *arena, struct error *error);
    } all[] = {{lathe_numbers, 8, build_lathe}, {prism_numbers, 8, build_prism}, {sweep_numbers, 8, build_sweep},
               {curve_numbers, 8, build_curve}, {field_numbers, 5, build_field}, {blob_numbers, 9, build_blob},
               {patch_numbers, 48, build_patch}};
    static const double bad[] = {NAN, INFINITY, -INFINITY, 1e302, -1e302};
    for (int i = 0; i < 16; i++)
        patch_numbers[3 * i] = i % 4, patch_numbers[3 * i + 1] = i / 4, patch_numbers[3 * i + 2] = i % 3;
    for (size_t s = 0; s < sizeof all / sizeof all[0]; s++) {
        struct arena arena = {0};
        struct error error = {0};
        CHECK(all[s].build(&arena, &error));
        for (int i = 0; i < all[s].count; i++)
            for (size_t b = 0; b < sizeof bad / sizeof bad[0]; b++) {
                double good = all[s].numbers[i];
                /* The strength of a blob's part, and the ends of a prism or of the ground, may be infinite. */
                bool fine = fabs(bad[b]) < INFINITY &&
                            ((all[s].numbers == blob_numbers && (i == 8 || i == 0)) ||
                             (all[s].numbers == prism_numbers && i < 2) || (all[s].numbers == field_numbers && i == 0));
                all[s].numbers[i] = bad[b];
                error = (struct error){0};
                if (!fine && (all[s].build(&arena, &error) || error.kind != ERROR_SCENE))
                    test_fail(__FILE__, __LINE__, "shape %zu takes %g as number %d", s, bad[b], i);
                all[s].numbers[i] = good;
            }
        CHECK(all[s].build(&arena, &error));
        arena_destroy(&arena);
    }
}

TEST(shapes_refuse_counts_that_make_none) {
    struct arena arena = {0};
    struct error error = {0};
    struct mesh_input out;
    static const double heights[] = {0, 1, 0, 1}, line[][2] = {{0, 0}, {1, 0}, {2, 0}},
                        upright[][2] = {{0, 0}, {0, 1}, {0, 2}};
    const uint32_t counts[][2] = {{1, 2}, {2, 1}, {40000, 2}, {2, 40000}};
    for (int i = 0; i < 4; i++)
        CHECK(!height_field_build(&arena,
                                  &(struct height_field_input){
                                      .heights = heights, .columns = counts[i][0], .rows = counts[i][1], .floor = -1},
                                  &error));
    for (int i = 0; i < 2; i++) /* outlines without any area */
        CHECK(!prism_build(
            &arena,
            &(struct prism_input){
                .to = 1, .points = i ? upright : line, .curve_starts = (const uint32_t[]){0, 3}, .curve_count = 1},
            &error));
    CHECK(!patch_tessellate(&arena, &(struct patch_input){.count = 0}, &out, &error));
    static const double point[16][3] = {{0}};
    CHECK(!patch_tessellate(&arena, &(struct patch_input){.points = point, .count = 1}, &out, &error));
    CHECK(!csg_build(&arena, NULL, 70000, NULL, 1, &error) && strstr(error.text, "65535"));
    arena_destroy(&arena);
}

/* A profile whose last point equals its first one is a loop, as with the option. */
TEST(profiles_that_come_back_to_their_first_point_are_loops) {
    struct arena arena = {0};
    static const double ring[][2] = {{1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 0}};
    struct shape closed = make_lathe(&arena, SPLINE_LINEAR, ring, 5, false, false),
                 loop = make_lathe(&arena, SPLINE_LINEAR, ring, 4, true, false);
    struct geom_scratch scratch;
    struct test_random random = {3};
    CHECK(geom_scratch_init(&scratch, 64));
    CHECK(shape_is_closed(&closed) && shape_is_closed(&loop));
    for (int i = 0; i < 2000; i++) {
        struct vec3 p = random_vec3(&random, 2.2);
        double r = hypot(p.x, p.z);
        bool inside = r > 1 && r < 2 && p.y > 0 && p.y < 1;
        CHECK(shape_contains(&closed, p, &scratch) == inside && shape_contains(&loop, p, &scratch) == inside);
    }
    static const double square[][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    struct error error = {0};
    struct shape prism = {.kind = SHAPE_PRISM};
    prism.prism = prism_build(
        &arena,
        &(struct prism_input){.to = 1, .points = square, .curve_starts = (const uint32_t[]){0, 5}, .curve_count = 1},
        &error);
    for (int i = 0; i < 2000; i++) {
        struct vec3 p = random_vec3(&random, 1.5);
        bool inside = p.x > 0 && p.x < 1 && p.y > 0 && p.y < 1 && p.z > 0 && p.z < 1;
        CHECK(shape_contains(&prism, p, &scratch) == inside);
    }
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

/* --- capacity for crossings --- */

/* With any remaining capacity each query gives the full result or reports that there is too little. */
static void check_room(const struct geometry *solid, const struct ray *ray, struct geom_scratch *scratch) {
    struct crossing_list list = list_of_geometry(solid, ray, scratch), other;
    struct crossing nearest = {0}, near;
    scratch->used = 0;
    bool found = geometry_nearest(solid, ray, scratch, &nearest), any = geometry_any(solid, ray, scratch);
    bool inside = geometry_is_closed(solid) && geometry_contains(solid, ray->origin, scratch);
    CHECK(!scratch->overflow);
    for (uint32_t room = 0; room < 14; room++) {
        uint32_t base = scratch->capacity - room;
        for (int question = 0; question < 4; question++) {
            bool right = true;
            scratch->used = base;
            scratch->overflow = false;
            switch (question) {
            case 0:
                right = !geometry_crossings(solid, ray, scratch, &other) || other.count == list.count;
                break;
            case 1:
                right = geometry_nearest(solid, ray, scratch, &near) == found && (!found || near.t == nearest.t);
                break;
            case 2:
                right = geometry_any(solid, ray, scratch) == any;
                break;
            case 3:
                right = !geometry_is_closed(solid) || geometry_contains(solid, ray->origin, scratch) == inside;
                break;
            }
            CHECK(right || scratch->overflow);
        }
    }
    scratch->used = 0;
    scratch->overflow = false;
}

TEST(solids_are_answered_or_say_that_room_is_missing_with_any_room) {
    enum { LEAVES = 6 };
    struct test_random random = {17};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 256));
    for (int turn = 0; turn < 60; turn++) {
        struct arena arena = {0};
        struct error error = {0};
        struct csg_leaf leaves[LEAVES];
        struct csg_token program[4 * LEAVES];
        for (int i = 0; i < LEAVES; i++) {
            struct shape ball = {.kind = SHAPE_SPHERE, .sphere = {random_vec3(&random, 1), 0.8}};
            struct shape box = {.kind = SHAPE_BOX};
            box.box.min = random_vec3(&random, 0.9);
            box.box.max = vec3_add(box.box.min, vec3_make(0.9, 0.7, 1.1));
            leaves[i] = (struct csg_leaf){.shape = i % 3 == 2 ? make((enum maker)(turn % MAKERS), &arena, &random)
                                                   : i % 2    ? ball
                                                              : box,
                                          .csg_from_leaf = transform_identity()};
        }
        uint32_t clip = turn % 3 == 0 ? 2 : 0;
        uint32_t solid = random_program(&random, 0, LEAVES - clip, turn % 2 ? 0.2 : 0, program), length = solid;
        if (clip)
            length += random_program(&random, LEAVES - clip, clip, 0, program + solid);
        const struct csg *csg =
            csg_build_clipped(&arena, &(struct csg_program){leaves, LEAVES, program, length}, solid, &error);
        struct geometry geometry = geometry_of_csg(csg);
        CHECK(csg != NULL);
        for (int i = 0; i < 20 && csg; i++) {
            struct vec3 from = random_vec3(&random, i % 2 ? 1 : 4);
            struct ray ray = ray_from(from, vec3_sub(random_vec3(&random, 0.7), from));
            ray.t_min = 0;
            check_room(&geometry, &ray, &scratch);
        }
        arena_destroy(&arena);
    }
    geom_scratch_destroy(&scratch);
}

/* --- meshes --- */

TEST(meshes_are_the_same_only_where_every_number_is) {
    static const double vertices[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                        other[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 1}};
    static const uint32_t quads[] = {0, 4}, corners[] = {0, 1, 2, 3}, turned[] = {0, 1, 3, 2}, triangles[] = {0, 3, 6},
                          halves[] = {0, 1, 2, 0, 2, 3}, swapped[] = {0, 1, 2, 0, 3, 2}, mixed[] = {0, 4, 7},
                          more[] = {0, 1, 2, 3, 0, 1, 2};
    const struct mesh_input quad = {
        .vertex_count = 4, .face_count = 1, .vertices = vertices, .face_start = quads, .vertex_index = corners};
    struct mesh_input two = {
        .vertex_count = 4, .face_count = 2, .vertices = vertices, .face_start = triangles, .vertex_index = halves};
    struct error error = {0};
    struct mesh *whole = mesh_create(&quad, &error), *split = mesh_create(&two, &error);
    CHECK(whole && split && !mesh_is_closed(whole) && !mesh_is_outward(whole));
    CHECK(mesh_equals_input(whole, &quad) && mesh_equals_input(split, &two));
    CHECK(!mesh_equals_input(whole, &two) && !mesh_equals_input(split, &quad));
    struct mesh_input changed = quad;
    changed.vertices = other;
    CHECK(!mesh_equals_input(whole, &changed));
    changed = quad;
    changed.vertex_index = turned;
    CHECK(!mesh_equals_input(whole, &changed));
    changed = quad;
    changed.vertex_count = 3;
    CHECK(!mesh_equals_input(whole, &changed));
    changed = two;
    changed.vertex_index = swapped;
    CHECK(!mesh_equals_input(split, &changed));
    changed = two;
    changed.face_start = mixed;
    changed.vertex_index = more;
    CHECK(!mesh_equals_input(split, &changed));
    struct mesh *uneven = mesh_create(&changed, &error);
    CHECK(uneven && mesh_equals_input(uneven, &changed) && !mesh_equals_input(uneven, &two));
    struct mesh_input none = {.name = NULL};
    none.face_start = (const uint32_t[]){0};
    struct mesh *empty = mesh_create(&none, &error);
    CHECK(empty && mesh_equals_input(empty, &none) && !mesh_is_open(empty) && !mesh_is_outward(empty));
    /* Hashes include everything that may differ. */
    CHECK(mesh_input_hash(&quad) != mesh_input_hash(&two) && mesh_input_hash(&none) != mesh_input_hash(&quad));
    struct mesh *const all[] = {whole, split, uneven, empty};
    for (int i = 0; i < 4; i++)
        mesh_release(all[i]);
}

/* --- quadrics --- */

/* An infinite round tube along each axis: the image surrounds it once and repeats along it. */
TEST(tubes_along_every_axis_are_hit_on_their_surface_with_their_gradient) {
    struct test_random random = {23};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 16));
    for (int axis = 0; axis < 3; axis++)
        for (int hyperbola = 0; hyperbola < 2; hyperbola++) {
            struct quadric q = {.limits = {vec3_all(-INFINITY), vec3_all(INFINITY)}};
            for (int i = 0; i < 3; i++)
                q.c[i] = i == axis ? (hyperbola ? -1 : 0) : 1;
            q.c[9] = -1;
            struct shape shape = {.kind = SHAPE_QUADRIC, .quadric = &q};
            for (int n = 0; n < 300; n++) {
                struct vec3 from = random_vec3(&random, 4);
                struct ray ray = ray_from(from, vec3_sub(random_vec3(&random, 0.6), from));
                struct crossing_list list = list_of(&shape, &ray, &scratch);
                for (uint32_t k = 0; k < list.count; k++) {
                    struct crossing c = scratch.items[k];
                    struct surface s;
                    if (!isfinite(c.t))
                        continue;
                    shape_describe(&shape, &ray, &c, &s);
                    double p[3] = {s.point.x, s.point.y, s.point.z}, g[3], form = -1;
                    for (int i = 0; i < 3; i++)
                        form += q.c[i] * p[i] * p[i], g[i] = q.c[i] * p[i];
                    CHECK_NEAR(form, 0, 1e-9 * (1 + vec3_dot(s.point, s.point)));
                    struct vec3 n1 = vec3_normalize(s.normal), n2 = vec3_normalize(vec3_make(g[0], g[1], g[2]));
                    CHECK(vec3_length(vec3_cross(n1, n2)) < 1e-6);
                    CHECK(c.enter == (vec3_dot(s.normal, ray.direction) < 0));
                }
            }
        }
    geom_scratch_destroy(&scratch);
}

/* --- tori --- */

/* The distance between the surface and the ball is at most `major`; a line with fewer than two crossings with a ball of
 * radius minor + major may miss both. */
TEST(a_torus_with_hardly_a_ring_is_a_ball) {
    static const double majors[] = {0, 1e-300, 1e-15, 1e-12, 1e-10, 1e-9, 1e-8, 3e-8, 1e-7, 1e-6};
    struct test_random random = {71};
    for (size_t i = 0; i < sizeof majors / sizeof majors[0]; i++) {
        struct torus torus = {.major = 0.7 * majors[i], .minor = 0.7};
        for (int n = 0; n < 3000; n++) {
            struct vec3 from = random_vec3(&random, 3);
            struct ray ray = ray_from(from, vec3_sub(random_vec3(&random, 1), from));
            double along = -vec3_dot(ray.origin, ray.direction) / vec3_dot(ray.direction, ray.direction);
            struct vec3 nearest = vec3_add_scaled(ray.origin, ray.direction, along);
            double half = 0.49 - vec3_dot(nearest, nearest);
            struct crossing found[4];
            int count = torus_crossings(&torus, &ray, found);
            if (fabs(half) < 1e-4) /* it touches the ball */
                continue;
            CHECK(count == (half > 0 ? 2 : 0));
            double extent = half > 0 ? sqrt(half) / vec3_length(ray.direction) : 0;
            for (int k = 0; k < count; k++) {
                CHECK_NEAR(found[k].t, along + (k ? extent : -extent), 200 * torus.major + 1e-12);
                CHECK(found[k].enter == (k == 0));
                struct surface surface;
                torus_describe(&torus, &ray, &found[k], &surface);
                CHECK_NEAR(vec3_length(surface.point), 0.7, torus.major + 1e-12);
            }
        }
    }
}
