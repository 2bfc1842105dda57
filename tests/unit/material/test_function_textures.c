/* Recorded functions at hits: means over footprints and slopes of heights, by closed forms. */
#include "material/bump.h"
#include "material/texture_function_internal.h"
#include "math/frame.h"
#include "tests/harness.h"
#include "tests/unit/function_makers.h"
#include "tests/unit/surface_makers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A hit of the plane y = 0 at (x, 0, z), seen at an angle (radians) from its normal along x. */
static struct hit plane_hit(double x, double z, double angle, double footprint) {
    struct vec3 up = vec3_make(0, 1, 0), point = vec3_make(x, 0, z);
    struct hit hit = {.point = point,
                      .view = vec3_make(sin(angle), cos(angle), 0),
                      .normal_geometric = up,
                      .normal = up,
                      .pattern_point = point,
                      .pattern_normal = up,
                      .raise = up,
                      .footprint = footprint,
                      .pattern_scale = 1,
                      .front = true};
    frame_tangents(up, &hit.along_a, &hit.along_b);
    return hit;
}

static struct texture texture_of(struct function_maker *maker, uint32_t node, struct arena *arena) {
    return texture_function(function_end(maker, node, arena), false, colour_all(0), colour_all(1));
}

/* (1 + sin kx) / 2 */
static struct texture waves(double k, struct arena *arena) {
    struct function_maker maker;
    function_begin(&maker);
    uint32_t wave = fn_of(&maker, EXPR_SIN, fn_scaled(&maker, k, maker.p[0]));
    return texture_of(&maker, fn_scaled(&maker, 0.5, fn_add(&maker, fn_number(&maker, 1), wave)), arena);
}

TEST(the_mean_over_a_footprint_is_that_of_its_area) {
    struct arena arena = {0};
    for (int i = 0; i < 40; i++) {
        double k = 2 + i, x = 0.37 * i, width = 0.1, angle = 1.0;
        double length = k * width / cos(angle);
        struct texture texture = waves(k, &arena);
        struct hit hit = plane_hit(x, 0, angle, width);
        double mean = 0.5 + 0.5 * sin(k * x) * sin(length / 2) / (length / 2);
        CHECK_NEAR(texture_function_colour(&texture.operation, &hit).r, mean, length < 1 ? 0.02 : 0.006);
    }
    arena_destroy(&arena);
}

TEST(a_function_that_hardly_changes_within_a_footprint_has_the_bits_of_its_middle) {
    struct arena arena = {0};
    struct texture texture = waves(3, &arena);
    for (int i = 0; i < 20; i++) {
        struct hit hit = plane_hit(0.1 * i, 1, 0.05 * i, 0.001);
        double inputs[EXPR_INPUT_COUNT] = {hit.point.x, hit.point.y, hit.point.z}, out[EXPR_OUTPUTS];
        expr_evaluate(texture.operation.recorded.program, inputs, out);
        CHECK(texture_function_colour(&texture.operation, &hit).g == out[0]);
    }
    arena_destroy(&arena);
}

TEST(a_function_of_one_point_has_no_filter) {
    struct arena arena = {0};
    struct texture texture = waves(100, &arena);
    texture.operation.recorded.points = 1;
    struct hit hit = plane_hit(0.3, 1, 1, 0.2);
    CHECK_NEAR(texture_function_colour(&texture.operation, &hit).r, 0.5 + 0.5 * sin(30), 1e-14);
    arena_destroy(&arena);
}

/* The material of a bump alone. */
static void turned(const struct texture *texture, const struct hit *hit, double height, struct vec3 *normal) {
    struct bump bump = bump_make(MATERIAL_BUMP, texture);
    bump.height = height;
    const struct material material = {.kind = MATERIAL_PHONG, .bump = &bump};
    struct surface_inputs inputs;
    surface_inputs_of(&material, hit, &inputs);
    *normal = inputs.normal;
}

TEST(heights_turn_normals_by_their_derivatives) {
    struct arena arena = {0};
    struct function_maker maker;
    function_begin(&maker);
    uint32_t wave = fn_of(&maker, EXPR_SIN, fn_scaled(&maker, 3, maker.p[0]));
    struct texture texture = texture_of(&maker, fn_add(&maker, wave, fn_square(&maker, maker.p[2])), &arena);
    for (int i = 0; i < 30; i++) {
        double x = 0.3 * i - 2, z = 1.5 - 0.1 * i, height = 0.2 * (i % 5) - 0.5;
        struct hit hit = plane_hit(x, z, 0.5, i % 2 ? 1e-6 : 0);
        struct vec3 normal = hit.normal, wanted = vec3_make(-height * 3 * cos(3 * x), 1, -height * 2 * z);
        turned(&texture, &hit, height, &normal);
        CHECK_NEAR(vec3_length(vec3_sub(normal, vec3_normalize(wanted))), 0, i % 2 ? 1e-5 : 1e-13);
    }
    arena_destroy(&arena);
}

TEST(heights_that_are_too_fine_for_a_footprint_leave_normals_nearly_as_they_are) {
    struct arena arena = {0};
    struct texture texture = waves(4000, &arena);
    for (int i = 0; i < 20; i++) {
        struct hit hit = plane_hit(0.1 * i, 1, 0.3, 0.05);
        struct vec3 normal = hit.normal;
        turned(&texture, &hit, 0.0005, &normal);
        CHECK(vec3_length(vec3_sub(normal, hit.normal)) < 0.6); /* up to 0.7 at single points */
    }
    arena_destroy(&arena);
}

TEST(a_height_that_jumps_has_a_slope_at_the_jump) {
    struct arena arena = {0};
    struct function_maker maker;
    function_begin(&maker);
    struct texture texture = texture_of(&maker, fn_of(&maker, EXPR_FLOOR, maker.p[0]), &arena);
    struct hit at_edge = plane_hit(1.001, 0.5, 0, 0.01), beside = plane_hit(1.5, 0.5, 0, 0.01);
    struct vec3 a = at_edge.normal, b = beside.normal;
    turned(&texture, &at_edge, 0.01, &a);
    turned(&texture, &beside, 0.01, &b);
    CHECK(a.x < -0.3);
    CHECK(b.y == 1);
    arena_destroy(&arena);
}

TEST(a_fine_checker_in_lua_has_its_mean_at_the_horizon) {
    struct test_result result = test_gray_scene(
        "local function checker(p) return (math.floor(p.x * 4) + math.floor(p.z * 4)) % 2 < 1 and 0.9 or 0.1 end\n"
        "gr.render{node = gr.node('scene'):add_child(gr.plane{material = gr.material{kd = checker},"
        " normal = {0, 1, 0}, distance = -1}), file = 'a.png', width = 160, height = 60, eye = {0, 0, 0},"
        " view = {0.1, -0.05, -1}, up = {0, 1, 0}, fov = 20, ambient = {1, 1, 1}}\n",
        "-q scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    struct test_picture picture = test_read_picture(test_path("a.png"));
    for (uint32_t y = 22; y < 30; y++) { /* below the horizon, which is in row 21 */
        double sum = 0, squares = 0;
        for (uint32_t x = 0; x < picture.width; x++) {
            double level = picture.rgb[3 * ((size_t)y * picture.width + x)];
            sum += level - 127.5;
            squares += (level - 127.5) * (level - 127.5);
        }
        CHECK(fabs(sum / picture.width) < 4);
        CHECK(sqrt(squares / picture.width) < 12); /* of single points: more than 30 */
    }
    free(picture.rgb);
}
