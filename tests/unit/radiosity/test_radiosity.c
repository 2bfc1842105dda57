/* Patches, form factors and the light of closed rooms, against closed forms. */
#include "tests/harness.h"

#include "radiosity/radiosity.h"
#include "tests/stage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static struct material *matt(struct stage *s, double kd) {
    return stage_phong(s, colour_all(kd), colour_all(0), 1);
}

static struct node *add_planar(struct stage *s, struct planar planar, const struct material *material) {
    struct node *node = stage_cube(s, s->root, material);
    node->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = planar};
    return node;
}

static struct radiosity_input input_of(struct stage *s, uint32_t limit, uint32_t side) {
    return (struct radiosity_input){
        .world = &s->world, .background = true, .limit = limit, .rays = side * side, .pool = s->pool};
}

static bool prepare(struct stage *s, struct radiosity *radiosity, uint32_t limit, uint32_t side) {
    const struct radiosity_input input = input_of(s, limit, side);
    bool ok = stage_build(s, s->root, ACCEL_AUTO) && radiosity_prepare(radiosity, &input, &s->error);
    if (!ok)
        test_fail(__FILE__, __LINE__, "radiosity: %s", s->error.text);
    return ok;
}

static uint32_t primitive_of(const struct radiosity *radiosity, size_t side) {
    return (uint32_t)patch_vertex_at(&radiosity->patches, (uint32_t)(side / 2))->primitive;
}

static double area_of(const struct radiosity *radiosity, uint32_t primitive) {
    double area = 0;
    for (size_t i = 0; i < 2 * radiosity->patches.vertices.count; i++)
        area += primitive_of(radiosity, i) == primitive ? radiosity->sides[i].area : 0;
    return area;
}

/* The share of light of one primitive that arrives at another. */
static double form_factor(const struct radiosity *radiosity, uint32_t from, uint32_t to) {
    double sum = 0;
    for (size_t j = 0; j < 2 * radiosity->patches.vertices.count; j++) {
        for (size_t i = radiosity->first[j]; primitive_of(radiosity, j) == to && i < radiosity->first[j + 1]; i++) {
            const struct side_light *receiver = &radiosity->sides[radiosity->receivers[i]];
            if (primitive_of(radiosity, radiosity->receivers[i]) == from)
                sum += receiver->area * receiver->weight;
        }
    }
    return sum / area_of(radiosity, from);
}

static size_t sides_with_area(const struct radiosity *radiosity) {
    size_t count = 0;
    for (size_t i = 0; i < 2 * radiosity->patches.vertices.count; i++)
        count += radiosity->sides[i].area > 0;
    return count;
}

/* Of two planar shapes that face each other; at least 10^6 rays for both. */
static double factor_of_pair(struct planar a, struct planar b, double *back) {
    struct stage s;
    struct radiosity radiosity = {0};
    double factor = NAN;
    stage_begin(&s, 2);
    (void)add_planar(&s, a, matt(&s, 0.5));
    (void)add_planar(&s, b, matt(&s, 0.5));
    if (prepare(&s, &radiosity, 4000, 64)) {
        CHECK(64 * 64 * sides_with_area(&radiosity) >= 1000000);
        factor = form_factor(&radiosity, 0, 1);
        *back = form_factor(&radiosity, 1, 0) * area_of(&radiosity, 1) / area_of(&radiosity, 0);
    }
    radiosity_destroy(&radiosity);
    stage_end(&s);
    return factor;
}

static void check_factor(struct planar a, struct planar b, double expected) {
    double back = NAN, factor = factor_of_pair(a, b, &back);
    CHECK_NEAR(factor, expected, 0.002 * expected);
    CHECK_NEAR(back, expected, 0.002 * expected);
}

static struct planar rectangle(double x, double y, double z, struct vec3 along, struct vec3 up) {
    return planar_parallelogram(vec3_make(x, y, z), along, up);
}

static const struct vec3 to_x = {1, 0, 0}, to_y = {0, 1, 0}, to_z = {0, 0, 1};

TEST(form_factors_of_faces_of_a_cube_are_their_closed_forms) {
    const struct planar floor = rectangle(0, 0, 0, to_x, to_y); /* normal +z */
    check_factor(floor, rectangle(0, 0, 1, to_y, to_x), 0.199825);
    check_factor(floor, rectangle(0, 0, 0, to_y, to_z), 0.200044);
}

TEST(form_factors_of_equal_discs_at_the_distance_of_their_radius_are_their_closed_form) {
    check_factor(planar_disc(vec3_all(0), to_z, 1, 0), planar_disc(to_z, vec3_negate(to_z), 1, 0), (3 - sqrt(5)) / 2);
}

/* J. Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", C-11. */
TEST(form_factors_of_parallel_rectangles_are_their_closed_form) {
    const double x = 2 / 0.7, y = 1 / 0.7, x1 = sqrt(1 + x * x), y1 = sqrt(1 + y * y);
    double f = log(x1 * y1 / sqrt(1 + x * x + y * y)) + x * y1 * atan(x / y1) + y * x1 * atan(y / x1) - x * atan(x) -
               y * atan(y);
    check_factor(rectangle(0, 0, 0, vec3_make(2, 0, 0), to_y), rectangle(0, 0, 0.7, to_y, vec3_make(2, 0, 0)),
                 2 * f / (pi * x * y));
}

/* Of plates that are long, by Hottel's crossed strings: 1 - sin(angle / 2). */
TEST(form_factors_of_a_wedge_are_their_closed_form) {
    const double angle = pi / 3;
    struct vec3 length = {0, 0, 4000}, up = {cos(angle), sin(angle), 0};
    check_factor(rectangle(0, 0, 0, length, to_x), rectangle(0, 0, 0, up, length), 0.5);
}

/* Scales rows and columns alike until all rows sum to 1, as R. Sinkhorn and P. Knopp do. */
static void symmetrise(double factors[6][6]) {
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < i; k++)
            factors[i][k] = factors[k][i] = (factors[i][k] + factors[k][i]) / 2;
    for (int round = 0; round < 200; round++) {
        double rows[6] = {0};
        for (int i = 0; i < 36; i++)
            rows[i / 6] += factors[i / 6][i % 6];
        for (int i = 0; i < 36; i++)
            factors[i / 6][i % 6] /= sqrt(rows[i / 6] * rows[i % 6]);
    }
}

/* The faces of a cube as seen from inside: no ray is lost. */
TEST(form_factors_of_a_closed_room_sum_to_1_and_are_reciprocal_when_they_are_symmetrised) {
    struct stage s;
    struct radiosity radiosity = {0};
    double factors[6][6] = {{0}};
    stage_begin(&s, 2);
    for (int i = 0; i < 3; i++) {
        const struct vec3 axes[3] = {to_x, to_y, to_z}, u = axes[(i + 1) % 3], v = axes[(i + 2) % 3];
        (void)add_planar(&s, rectangle(0, 0, 0, u, v), matt(&s, 0.5));
        (void)add_planar(&s, rectangle(axes[i].x, axes[i].y, axes[i].z, v, u), matt(&s, 0.5));
    }
    if (prepare(&s, &radiosity, 4000, 64)) {
        for (uint32_t i = 0; i < 36; i++)
            factors[i / 6][i % 6] = form_factor(&radiosity, i / 6, i % 6);
        for (int i = 0; i < 6; i++) {
            double sum = 0;
            for (int k = 0; k < 6; k++)
                sum += factors[i][k];
            CHECK_NEAR(sum, 1, 1e-12);
        }
        symmetrise(factors);
        for (int i = 0; i < 6; i++) {
            double sum = 0;
            for (int k = 0; k < 6; k++) {
                sum += factors[i][k];
                CHECK_NEAR(factors[i][k], factors[k][i], 1e-12);
                CHECK_NEAR(factors[i][k], i == k ? 0 : i / 2 == k / 2 ? 0.199825 : 0.200044, 0.001);
            }
            CHECK_NEAR(sum, 1, 1e-12);
        }
    }
    radiosity_destroy(&radiosity);
    stage_end(&s);
}

/* --- closed rooms --- */

/* The mean light of a primitive on the sides that have any. */
static double mean_light(const struct radiosity *radiosity, uint32_t primitive, int back) {
    double sum = 0, area = 0;
    for (size_t i = (size_t)back; i < 2 * radiosity->patches.vertices.count; i += 2) {
        if (primitive_of(radiosity, i) != primitive)
            continue;
        sum += radiosity->sides[i].area * radiosity->sides[i].light.g;
        area += radiosity->sides[i].area;
    }
    return sum / area;
}

TEST(light_of_concentric_balls_is_its_closed_form) {
    struct stage s;
    struct radiosity radiosity = {0};
    stage_begin(&s, 2);
    struct material *inner = matt(&s, 0.5), *outer = matt(&s, 0.5);
    inner->phong.emission = colour_all(1);
    outer->phong.two_sided = true;
    (void)stage_sphere(&s, s.root, inner);
    stage_scale(&s, stage_sphere(&s, s.root, outer), 2, 2, 2);
    if (prepare(&s, &radiosity, 4000, 0)) {
        CHECK(radiosity_shoot(&radiosity, 1e-6, s.pool));
        CHECK_NEAR(1 + 0.5 * mean_light(&radiosity, 0, 0), 1.111111, 0.005);
        CHECK_NEAR(0.5 * mean_light(&radiosity, 1, 1), 0.222222, 0.005 * 0.222222);
        CHECK_NEAR(mean_light(&radiosity, 1, 0), 0, 0);
    }
    radiosity_destroy(&radiosity);
    stage_end(&s);
}

/* So large that what leaves at the border is less than a thousandth: 1 / (1 - .5 * .8) arrives above. */
TEST(light_between_parallel_planes_is_its_closed_form) {
    struct stage s;
    struct radiosity radiosity = {0};
    const struct vec3 along = {4000, 0, 0}, up = {0, 4000, 0};
    stage_begin(&s, 2);
    struct material *shines = matt(&s, 0.5);
    shines->phong.emission = colour_all(1);
    (void)add_planar(&s, rectangle(0, 0, 0, along, up), shines);
    (void)add_planar(&s, rectangle(0, 0, 1, up, along), matt(&s, 0.8));
    if (prepare(&s, &radiosity, 2000, 0)) {
        CHECK(radiosity_shoot(&radiosity, 1e-6, s.pool));
        CHECK_NEAR(mean_light(&radiosity, 1, 0), 1 / 0.6, 0.005 / 0.6);
        CHECK_NEAR(mean_light(&radiosity, 0, 0), 0.8 / 0.6, 0.005 * 0.8 / 0.6);
    }
    radiosity_destroy(&radiosity);
    stage_end(&s);
}

/* Le / (1 - reflectance) everywhere, whatever the room is. */
TEST(light_of_a_closed_room_that_shines_is_its_emission_over_what_it_absorbs) {
    for (int kind = 0; kind < 2; kind++) {
        struct stage s;
        struct radiosity radiosity = {0};
        stage_begin(&s, 2);
        struct material *wall = matt(&s, 0.6);
        wall->phong.emission = colour_make(1, 2, 0);
        wall->phong.two_sided = true;
        struct node *room = kind ? stage_sphere(&s, s.root, wall) : stage_cube(&s, s.root, wall);
        stage_scale(&s, room, 3, 2, 1);
        if (prepare(&s, &radiosity, 1000, 0)) {
            CHECK(radiosity_shoot(&radiosity, 1e-6, s.pool));
            for (size_t i = 1; i < 2 * radiosity.patches.vertices.count; i += 2) {
                struct colour light = radiosity.sides[i].light;
                CHECK_NEAR(light.r, 1 / 0.4, 0.04);
                CHECK_NEAR(light.g, 2 / 0.4, 0.08);
                CHECK(light.b == 0);
            }
            CHECK_NEAR(mean_light(&radiosity, 0, 1), 2 / 0.4, 0.01);
        }
        radiosity_destroy(&radiosity);
        stage_end(&s);
    }
}

/* --- a room with things in it --- */

static void begin_room(struct stage *s, int threads) {
    stage_begin(s, threads);
    struct material *wall = matt(s, 0.7), *lamp = matt(s, 0);
    wall->phong.two_sided = true;
    lamp->phong.emission = colour_make(5, 4, 3);
    stage_scale(s, stage_cube(s, s->root, wall), 4, 3, 5);
    struct node *box = stage_cube(s, s->root, stage_phong(s, colour_make(0.8, 0.2, 0.1), colour_all(0), 1));
    stage_move(s, box, 1, 0, 1);
    struct node *ball = stage_sphere(s, s->root, lamp);
    stage_scale(s, ball, 0.2, 0.2, 0.2);
    stage_move(s, ball, 2, 2.2, 3);
    stage_point_light(s, vec3_make(0.5, 2.5, 0.5), colour_all(0.5));
}

TEST(the_solution_has_the_same_bytes_for_every_number_of_threads) {
    struct side_light *first = NULL;
    size_t bytes = 0;
    for (int threads = 1; threads <= 3; threads++) {
        struct stage s;
        struct radiosity radiosity = {0};
        begin_room(&s, threads);
        if (prepare(&s, &radiosity, 1500, 0)) {
            CHECK(radiosity_shoot(&radiosity, 0.001, s.pool));
            if (threads == 1) {
                bytes = 2 * radiosity.patches.vertices.count * sizeof *first;
                first = radiosity.sides;
                radiosity.sides = NULL;
            } else {
                CHECK_EQ_INT(2 * radiosity.patches.vertices.count * sizeof *first, bytes);
                CHECK(memcmp(first, radiosity.sides, bytes) == 0);
            }
        }
        radiosity_destroy(&radiosity);
        stage_end(&s);
    }
    mem_free(first);
}

TEST(no_row_of_form_factors_sums_to_more_than_one_so_light_never_grows) {
    struct stage s;
    struct radiosity radiosity = {0};
    begin_room(&s, 2);
    if (prepare(&s, &radiosity, 1500, 0)) {
        size_t sides = 2 * radiosity.patches.vertices.count;
        double *rows = calloc(sides, sizeof *rows), direct = 0;
        for (size_t i = 0; i < radiosity.first[sides]; i++)
            rows[radiosity.receivers[i]] += radiosity.sides[radiosity.receivers[i]].weight;
        for (size_t i = 0; i < sides; i++) {
            CHECK(rows[i] <= 1 + 1e-12);
            direct = fmax(direct, radiosity.sides[i].light.r);
        }
        for (double left = 1; radiosity_shoot(&radiosity, left, s.pool) && left > 1e-4; left /= 2) {
            CHECK(radiosity.left <= left);
        }
        for (size_t i = 0; i < sides; i++)
            CHECK(radiosity.sides[i].light.r <= direct / (1 - 0.8));
        free(rows);
    }
    radiosity_destroy(&radiosity);
    stage_end(&s);
}

/* The floor below the box is no surface that light reaches. */
TEST(what_is_inside_of_a_solid_has_no_area) {
    struct stage s;
    struct radiosity radiosity = {0};
    stage_begin(&s, 2);
    (void)add_planar(&s, rectangle(0, 0, 0, vec3_make(0, 0, 4), vec3_make(4, 0, 0)), matt(&s, 0.5));
    struct node *box = stage_cube(&s, s.root, matt(&s, 0.5));
    stage_move(&s, box, 1.3, -0.5, 0.9);
    s.sky.colour = colour_all(1);
    if (prepare(&s, &radiosity, 4000, 0)) {
        CHECK_NEAR(area_of(&radiosity, 0), 15, 0.05);
        CHECK_NEAR(mean_light(&radiosity, 0, 0), 1, 0.1);
    }
    radiosity_destroy(&radiosity);
    stage_end(&s);
}

/* --- solutions that are kept --- */

static bool update(struct stage *s, struct radiosity *radiosity) {
    const struct side_light *before = radiosity->sides;
    struct radiosity_input input = input_of(s, 300, 0);
    input.error_share = 0.01;
    CHECK(stage_build(s, s->root, ACCEL_AUTO) && radiosity_update(radiosity, &input, &s->error));
    return radiosity->sides != before;
}

TEST(a_solution_is_kept_until_something_that_it_depends_on_changes) {
    struct stage s;
    struct radiosity radiosity = {0};
    begin_room(&s, 1);
    struct material *kd = matt(&s, 0.4), *glow = matt(&s, 0);
    struct node *box = stage_cube(&s, s.root, kd), *lamp = stage_cube(&s, s.root, glow);
    stage_move(&s, box, 3, 0, 3);
    stage_scale(&s, lamp, 0.1, 0.1, 0.1);
    stage_move(&s, lamp, 3, 2, 1);
    CHECK(update(&s, &radiosity) && !update(&s, &radiosity));
    s.camera.eye.x += 1;
    CHECK(!update(&s, &radiosity));
    kd->phong.kd.g = 0.41;
    CHECK(update(&s, &radiosity) && !update(&s, &radiosity));
    stage_move(&s, box, 0.01, 0, 0);
    CHECK(update(&s, &radiosity) && !update(&s, &radiosity));
    s.lights[0].colour.b = 0.51;
    CHECK(update(&s, &radiosity) && !update(&s, &radiosity));
    s.lights[0].position.x += 0.01;
    CHECK(update(&s, &radiosity) && !update(&s, &radiosity));
    glow->phong.emission = colour_all(1);
    CHECK(update(&s, &radiosity) && !update(&s, &radiosity));
    radiosity_destroy(&radiosity);
    stage_end(&s);
}

/* A floor of kd .5 below a white sky, encoded with the sRGB function. */
TEST(baked_light_is_the_colour_of_vertices) {
    struct stage s;
    struct radiosity radiosity = {0};
    struct list ply = {0};
    stage_begin(&s, 1);
    (void)add_planar(&s, rectangle(0, 0, 0, to_x, to_y), matt(&s, 0.5));
    s.sky.colour = colour_all(1);
    if (prepare(&s, &radiosity, 300, 0)) {
        CHECK(radiosity_finish(&radiosity, 0.01, s.pool, &s.error));
        CHECK(radiosity_bake(&radiosity, &(struct tone){.srgb = true}, FORMAT_PLY, &ply));
        uint32_t vertices = 0, faces = 0;
        CHECK(list_add_bytes(&ply, "", 1));
        const char *head = ply.items, *body = strstr(head, "end_header\n");
        CHECK(body && sscanf(strstr(head, "element vertex"), "element vertex %u", &vertices) == 1);
        CHECK(body && sscanf(strstr(head, "element face"), "element face %u", &faces) == 1);
        CHECK_EQ_INT(vertices, radiosity.patches.vertices.count);
        CHECK_EQ_INT(faces, radiosity.patches.all.count);
        body += strlen("end_header\n");
        CHECK_EQ_INT(body - head + 15 * vertices + 13 * faces + 1, ply.count);
        for (uint32_t i = 0; i < vertices; i++)
            CHECK_NEAR((double)(uint8_t)body[15 * i + 13], 188, 2);
    }
    list_destroy(&ply);
    radiosity_destroy(&radiosity);
    stage_end(&s);
}

TEST(bake_writes_a_file_beside_the_picture) {
    static const char scene[] = "local s = gr.node('s')\n"
                                "s:add_child(gr.sphere(gr.material{kd = {.5, .5, .5}}))\n"
                                "gr.render{node = s, file = 'x.png', width = 8, height = 6, eye = {0, 0, 8}, "
                                "background = {1, 1, 1}}\n";
    struct test_result result = test_gray_scene(scene, "-q --integrator radiosity --bake b.ply scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.err, "");
    test_free_result(&result);
    result = test_gray_scene("local b = gr.mesh('b', 'b.ply')\nprint(b ~= nil)\n", "-q scene.lua", NULL);
    CHECK_TEXT(result.out, "true\n");
    test_free_result(&result);
    result = test_gray_scene(scene, "--bake b.stl scene.lua", NULL);
    CHECK_EQ_INT(result.status, 2);
    CHECK(strstr(result.err, "gray: --bake b.stl: the name must end in .ply or .glb"));
    test_free_result(&result);
    test_need_json();
    result = test_gray_scene(scene, "-q --integrator radiosity --bake b.glb scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    /* Colours are the light of the picture, in which a ball of kd .5 below a white sky is .5. */
    test_write_text(test_path("glb.lua"),
                    "local n = gr.mesh('b', 'b.glb')\n"
                    "gr.render{node = n, file = 'g.png', width = 9, height = 9, eye = {0, 0, 8}, colour = 'linear'}\n");
    test_shell_errors("$gray -q glb.lua && $gray -q --integrator radiosity scene.lua --size 9x9 -o s.png", 0, NULL);
    struct test_picture baked = test_read_picture(test_path("g.png")), seen = test_read_picture(test_path("s.png"));
    for (int k = 0; k < 3; k++)
        CHECK_NEAR((double)baked.rgb[3 * 40 + k], (double)seen.rgb[3 * 40 + k], 2);
    free(baked.rgb);
    free(seen.rgb);
}

/* --- patches --- */

static uint64_t edge_number(uint32_t a, uint32_t b) {
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

TEST(divided_patches_of_a_square_have_no_vertex_within_an_edge) {
    struct stage s;
    struct patches patches = {0};
    stage_begin(&s, 1);
    (void)add_planar(&s, rectangle(0, 0, 0, to_x, to_y), matt(&s, 0.5));
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    CHECK(patches_build(&patches, &s.world, 64, s.pool, &s.error));
    uint64_t key = 1;
    for (int round = 0; round < 12; round++) {
        struct key_map edges = {0};
        bool done;
        for (int i = 0; i < 3; i++) {
            key = random_mix(key + 1);
            const struct patch *patch = patch_at(&patches, (uint32_t)(key % patches.all.count));
            CHECK(patches_mark(&edges, patch->vertex[i], patch->vertex[(i + 1) % 3]));
        }
        CHECK(patches_divide(&patches, &edges, 100000, &done, &s.error) && done);
        key_map_destroy(&edges);
    }
    double area = 0;
    for (uint32_t i = 0; i < patches.all.count; i++) {
        struct vec3 c[3];
        patch_corners(&patches, i, c);
        double own = vec3_cross(vec3_sub(c[1], c[0]), vec3_sub(c[2], c[0])).z / 2;
        CHECK(own > 0);
        area += own;
        for (int k = 0; k < 3; k++) {
            const uint32_t *vertex = patch_at(&patches, i)->vertex;
            struct vec3 a = c[k], b = c[(k + 1) % 3];
            int users = 0;
            for (uint32_t other = 0; other < patches.all.count; other++) {
                const uint32_t *at = patch_at(&patches, other)->vertex;
                for (int n = 0; n < 3; n++)
                    users += edge_number(at[n], at[(n + 1) % 3]) == edge_number(vertex[k], vertex[(k + 1) % 3]);
            }
            bool border = (a.x == b.x && (a.x == 0 || a.x == 1)) || (a.y == b.y && (a.y == 0 || a.y == 1));
            CHECK_EQ_INT(users, border ? 1 : 2);
        }
    }
    CHECK_NEAR(area, 1, 1e-12);
    patches_destroy(&patches);
    stage_end(&s);
}

/* --- what cannot be --- */

static const char *refusal_of(struct stage *s, uint32_t limit) {
    struct radiosity radiosity;
    const struct radiosity_input input = input_of(s, limit, 0);
    CHECK(stage_build(s, s->root, ACCEL_AUTO));
    if (radiosity_prepare(&radiosity, &input, &s->error)) {
        radiosity_destroy(&radiosity);
        return "none";
    }
    return s->error.text;
}

TEST(radiosity_refuses_emitters_without_end_scenes_without_diffuse_surfaces_and_too_many_triangles) {
    struct stage s;
    stage_begin(&s, 1);
    struct node *plane = add_planar(&s, planar_plane(to_y, 0), matt(&s, 0));
    struct material *bright = matt(&s, 0.5);
    bright->phong.emission = colour_all(1);
    CHECK(strstr(refusal_of(&s, 100), "needs a diffuse surface with an end and an area, and the scene has none"));
    plane->material = bright;
    scene_note_change(&s.scene);
    CHECK(strstr(refusal_of(&s, 100), "'cube' emits light and has no end"));
    plane->material = matt(&s, 0.5);
    (void)stage_sphere(&s, s.root, matt(&s, 0.5));
    CHECK(strstr(refusal_of(&s, 40), "more than 40 triangles, the limit of --radiosity-patches"));
    stage_end(&s);
}

/* What a material with layers emits is known before it is evaluated: nothing. */
TEST(a_ground_of_a_layered_material_without_end_is_no_emitter_of_radiosity) {
    struct test_result result = test_gray_scene(
        "local r = gr.node('r'); r:add_child(gr.sphere{centre = {0, 1, 0}, material = gr.openpbr_material{}})\n"
        "r:add_child(gr.plane{normal = {0, 1, 0}, material = gr.openpbr_material{}})\n"
        "gr.render{node = r, width = 8, height = 8, eye = {0, 2, 6}, target = {0, 1, 0},\n"
        "  lights = {gr.light{position = {2, 4, 2}, colour = {1, 1, 1}}}}",
        "-q scene.lua --integrator radiosity --radiosity-patches 200 -o out.png", NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
}

/* --- two rooms --- */

static void add_block(struct stage *s, const struct material *material, struct vec3 from, struct vec3 to) {
    struct node *node = stage_cube(s, s->root, material);
    node->shape.box = (struct box){from, to};
}

/* The lamp is in the left room, and a door in the wall. */
static void begin_two_rooms(struct stage *s) {
    stage_begin(s, 2);
    struct material *wall = stage_phong(s, colour_make(0.75, 0.7, 0.6), colour_all(0), 1), *lamp = matt(s, 0);
    lamp->phong.emission = colour_make(10, 9, 8);
    const struct vec3 x = {8, 0, 0}, y = {0, 3, 0}, z = {0, 0, 4};
    (void)add_planar(s, rectangle(0, 0, 0, z, x), wall);
    (void)add_planar(s, rectangle(0, 3, 0, x, z), wall);
    (void)add_planar(s, rectangle(0, 0, 0, x, y), wall);
    (void)add_planar(s, rectangle(0, 0, 4, y, x), wall);
    (void)add_planar(s, rectangle(0, 0, 0, y, z), wall);
    (void)add_planar(s, rectangle(8, 0, 0, z, y), wall);
    add_block(s, wall, vec3_make(4, 0, 0), vec3_make(4.2, 3, 1));
    add_block(s, wall, vec3_make(4, 0, 3), vec3_make(4.2, 3, 4));
    add_block(s, wall, vec3_make(4, 2.4, 1), vec3_make(4.2, 3, 3));
    add_block(s, stage_phong(s, colour_make(0.7, 0.2, 0.1), colour_all(0), 1), vec3_make(1, 0, 2.5),
              vec3_make(2.2, 0.9, 3.2));
    add_block(s, stage_phong(s, colour_make(0.2, 0.4, 0.6), colour_all(0), 1), vec3_make(5.5, 0, 0.6),
              vec3_make(6.3, 1.2, 1.4));
    struct node *ball = stage_sphere(s, s->root, lamp);
    stage_scale(s, ball, 0.25, 0.25, 0.25);
    stage_move(s, ball, 2.2, 2, 1.8);
}

/* At random vertices, a little inside of one of their patches: the picture of a path tracer that looks at the point
 * from nearby, over the reflectance. */
static void compare_with_paths(struct stage *s, const struct radiosity *radiosity, int count, int samples) {
    double squares = 0, all = 0;
    int far = 0, done = 0;
    uint64_t key = 1;
    s->settings.integrator = INTEGRATOR_PATH;
    s->settings.path_samples = samples;
    s->settings.lens.projection = PROJECTION_ORTHOGRAPHIC;
    s->settings.lens.view_height = 1e-3;
    while (done < count) {
        key = random_mix(key + 1);
        uint32_t index = (uint32_t)(key % radiosity->patches.all.count);
        const uint32_t vertex = patch_at(&radiosity->patches, index)->vertex[0];
        const struct side_light *side = &radiosity->sides[2 * vertex];
        struct vec3 c[3];
        patch_corners(&radiosity->patches, index, c);
        struct vec3 middle = vec3_scale(vec3_add(c[0], vec3_add(c[1], c[2])), 1.0 / 3);
        struct vec3 point = vec3_add_scaled(vec3_scale(c[0], 0.9), middle, 0.1);
        struct vec3 normal = vec3_normalize(patch_normal(c));
        bool is_outside = point.x < 0 || point.x > 8 || point.y < 0 || point.y > 3 || point.z < 0 || point.z > 4;
        if (!(side->area > 0) || is_outside)
            continue;
        s->camera = (struct camera){vec3_add_scaled(point, normal, 1e-3), vec3_negate(normal),
                                    fabs(normal.y) > 0.5 ? to_x : to_y, 50};
        CHECK(stage_render(s, 1, 1));
        struct hit hit = {.point = point, .normal_geometric = normal, .front = true};
        hit.primitive = patch_primitive(&radiosity->patches, index);
        struct colour light;
        CHECK(radiosity_light(radiosity, &hit, &light));
        double paths = stage_pixel(s, 0, 0).g / side->reflectance.g, own = light.g;
        if (!(paths > 0)) /* inside of a solid */
            continue;
        squares += (own - paths) * (own - paths);
        all += paths * paths;
        far += fabs(own - paths) > 0.08 * paths;
        done++;
    }
    fprintf(stderr, "rms %.4f, beyond 8 %%: %d of %d\n", sqrt(squares / all), far, count);
    CHECK(sqrt(squares / all) <= 0.03);
    CHECK(far <= 0.05 * count);
}

TEST_TIMES(two_rooms_are_lit_as_by_paths, 4) {
    struct stage s;
    struct radiosity radiosity = {0};
    begin_two_rooms(&s);
    if (prepare(&s, &radiosity, 10000, 0)) {
        CHECK(radiosity_finish(&radiosity, 0.001, s.pool, &s.error));
        compare_with_paths(&s, &radiosity, 50 * times, 4096 * times);
    }
    radiosity_destroy(&radiosity);
    stage_end(&s);
}
