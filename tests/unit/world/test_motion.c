/* Motion blur: interpolated poses, boxes that contain the whole motion, pictures against box filters and against means
 * of sharp ones.
 */
#include "math/motion.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/mesh_makers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct vec3 random_vec(struct test_random *random, double size) {
    double x = test_uniform(random, -size, size), y = test_uniform(random, -size, size);
    return vec3_make(x, y, test_uniform(random, -size, size));
}

static struct transform random_pose(struct test_random *random) {
    struct transform turn = transform_rotate_about(random_vec(random, 1), test_uniform(random, -180, 180));
    struct vec3 factors = {test_uniform(random, 0.2, 3), test_uniform(random, 0.2, 3), test_uniform(random, 0.2, 3)};
    struct transform stretch = transform_scale(factors), shear = transform_rotate(1, test_uniform(random, -90, 90));
    struct transform moved = transform_translate(random_vec(random, 5));
    stretch = transform_compose(&stretch, &shear);
    turn = transform_compose(&turn, &stretch);
    return transform_compose(&moved, &turn);
}

static double difference(const struct affine *a, const struct affine *b) {
    double max = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            max = fmax(max, fabs(a->m[i][j] - b->m[i][j]));
    return max;
}

TEST(a_motion_begins_and_ends_at_its_poses_and_its_inverse_is_one) {
    struct test_random random = {1};
    for (int i = 0; i < 300; i++) {
        struct transform from = random_pose(&random), to = random_pose(&random);
        struct motion motion;
        CHECK(motion_interpolate(&from, &to, vec3_all(0), &motion));
        struct transform start = motion_at(&motion, 0), end = motion_at(&motion, 1), early = motion_at(&motion, -2);
        CHECK(difference(&start.forward, &from.forward) < 1e-12);
        CHECK(difference(&end.forward, &to.forward) < 1e-12);
        CHECK(difference(&early.forward, &from.forward) < 1e-12);
        struct transform middle = motion_at(&motion, test_uniform(&random, 0, 1)), identity = transform_identity();
        struct affine back = affine_compose(&middle.inverse, &middle.forward);
        CHECK(difference(&back, &identity.forward) < 1e-11);
    }
}

/* A point of the node's own space turns about the axis before the pose and the velocity act. */
TEST(a_spin_turns_about_the_axis_of_the_node_at_its_rate) {
    struct test_random random = {7};
    for (int i = 0; i < 200; i++) {
        struct transform pose = random_pose(&random);
        struct vec3 velocity = random_vec(&random, 2), axis = random_vec(&random, 1);
        double rate = test_uniform(&random, -2000, 2000), time = test_uniform(&random, -1, 2);
        struct motion motion = motion_of_spin(&pose, velocity, axis, rate);
        struct transform moved = transform_translate(vec3_scale(velocity, time));
        struct transform turn = transform_rotate_about(axis, rate * time), at = motion_at(&motion, time);
        struct transform expected = transform_compose(&moved, &pose);
        expected = transform_compose(&expected, &turn);
        CHECK(difference(&at.forward, &expected.forward) < 1e-9);
        struct transform start = motion_at(&motion, 0);
        CHECK(difference(&start.forward, &pose.forward) < 1e-12);
    }
}

/* A node that spins about its own axis, before its rotation about x. */
TEST(a_spin_goes_on_over_the_frames_of_an_animation) {
    static const char scene[] =
        "local red, light = gr.material{kd = {.8, .3, .2}}, gr.light{position = {5, 5, 9}, colour = {1, 1, 1}}\n"
        "local function picture(name, cube)\n"
        "  return {node = gr.node('r'):add_child(cube), width = 40, height = 30, file = name, eye = {0, 0, 6}, "
        "lights = {light}, shutter = {0, 0}}\n"
        "end\n"
        "local cube = gr.cube{material = red}:rotate('x', 20):spin('y', 40)\n"
        "local whole = picture('a.png', cube)\n"
        "gr.frames{count = 4, fps = 2, draw = function() return whole end}\n"
        "for k = 0, 3 do\n"
        "  gr.render(picture('b' .. k .. '.png', gr.cube{material = red}:rotate('y', 20 * k):rotate('x', 20)))\n"
        "end\n";
    struct test_result result = test_gray_scene(scene, "-q --transform-order new scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    for (int k = 0; k < 4; k++) {
        char frame[32], still[32];
        (void)snprintf(frame, sizeof frame, "a.%04d.png", k + 1);
        (void)snprintf(still, sizeof still, "b%d.png", k);
        CHECK(test_same_files(frame, still));
    }
}

/* Its shutter is open from 0 to 1, unless `shutter` closes it. */
TEST(functions_of_the_time_read_it_in_a_picture_in_which_nothing_moves) {
    static const char scene[] =
        "local glow = gr.material{kd = {0, 0, 0}, emission = gr.fn(function(p, s) return s.time end)}\n"
        "local fog = gr.fog_field({-2, -2, -2}, {4, 4, 2}, function(p, s) return 100 * s.time end, {1, 1, 1})\n"
        "local function picture(name, more)\n"
        "  local all = {node = gr.sphere{material = glow}, file = name, width = 8, height = 8, eye = {0, 0, 2}, "
        "lights = {}, samples = 8, full = true, background = {0, 0, 0}}\n"
        "  for k, v in pairs(more) do all[k] = v end gr.render(all)\n"
        "end\n"
        "picture('whitted.png', {}) picture('closed.png', {shutter = {.5, .5}})\n"
        "picture('path.png', {integrator = 'path', samples = 16})\n"
        "picture('fog.png', {node = gr.sphere{material = glow}:translate(9, 0, 0), fog = fog})\n";
    static const struct {
        const char *name;
        int low, high;
    } pictures[] = {{"whitted.png", 126, 129}, {"closed.png", 0, 0}, {"path.png", 170, 205}, {"fog.png", 230, 255}};
    struct test_result result = test_gray_scene(scene, "-q scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.err, "");
    test_free_result(&result);
    for (size_t i = 0; i < sizeof pictures / sizeof *pictures; i++) {
        struct test_picture picture = test_read_picture(test_path(pictures[i].name));
        int value = picture.rgb[3 * (4 * 8 + 4)];
        if (value < pictures[i].low || value > pictures[i].high)
            test_fail(__FILE__, __LINE__, "%s: %d", pictures[i].name, value);
        free(picture.rgb);
    }
}

TEST(the_box_of_a_spinning_node_contains_it_at_all_times) {
    struct test_random random = {8};
    for (int i = 0; i < 200; i++) {
        struct transform pose = random_pose(&random), end = random_pose(&random);
        struct vec3 a = random_vec(&random, 2), b = random_vec(&random, 2), axis = random_vec(&random, 1);
        struct box box = {vec3_min(a, b), vec3_max(a, b)};
        double rate = test_uniform(&random, -900, 900);
        struct shutter shutter = {test_uniform(&random, -1, 0.5), test_uniform(&random, 0.5, 1.5)};
        struct motion motion = motion_of_spin(&pose, random_vec(&random, 2), axis, rate);
        if (i % 2 == 1) {
            CHECK(motion_interpolate(&pose, &end, random_vec(&random, 2), &motion));
            motion.spins = true;
            motion.spin_axis = axis;
            motion.spin = rate;
        }
        struct box all = motion_bounds(&motion, &box, shutter);
        for (int k = 0; k <= 50; k++) {
            struct transform at = motion_at(&motion, shutter_time(shutter, k / 50.0));
            for (int corner = 0; corner < 8; corner++) {
                struct vec3 p = {corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                                 corner & 4 ? box.max.z : box.min.z};
                p = affine_point(&at.forward, p);
                for (int axis_number = 0; axis_number < 3; axis_number++) {
                    CHECK(vec3_get(p, axis_number) > vec3_get(all.min, axis_number) - 1e-9);
                    CHECK(vec3_get(p, axis_number) < vec3_get(all.max, axis_number) + 1e-9);
                }
            }
        }
    }
}

TEST(half_of_a_quarter_turn_is_an_eighth_whatever_the_stretch) {
    struct transform stretch = transform_scale(vec3_make(1, 2, 5)), turn = transform_rotate(2, 90);
    struct transform end = transform_compose(&turn, &stretch), eighth = transform_rotate(2, 45);
    struct transform expected = transform_compose(&eighth, &stretch);
    struct motion motion;
    CHECK(motion_interpolate(&stretch, &end, vec3_make(3, 0, 0), &motion));
    CHECK_NEAR(motion.degrees, 90, 1e-12);
    struct transform half = motion_at(&motion, 0.5);
    CHECK_NEAR(half.forward.m[0][3], 1.5, 1e-15);
    half.forward.m[0][3] = 0;
    CHECK(difference(&half.forward, &expected.forward) < 1e-12);
    /* A turn by 180 degrees has an axis, too. */
    struct transform identity = transform_identity(), back = transform_rotate(0, 180);
    CHECK(motion_interpolate(&identity, &back, vec3_all(0), &motion));
    CHECK_NEAR(motion.degrees, 180, 1e-9);
    CHECK_NEAR(fabs(motion.axis.x), 1, 1e-12);
}

TEST(mirror_images_are_refused) {
    struct transform identity = transform_identity(), mirror = transform_scale(vec3_make(1, -1, 1));
    struct motion motion;
    CHECK(!motion_interpolate(&identity, &mirror, vec3_all(0), &motion));
    CHECK(motion_interpolate(&mirror, &mirror, vec3_all(0), &motion));
}

TEST(bounds_of_a_motion_hold_every_point_at_every_time) {
    struct test_random random = {2};
    for (int i = 0; i < 300; i++) {
        struct transform from = random_pose(&random), to = random_pose(&random);
        struct motion motion = motion_of_velocity(random_vec(&random, 3));
        if (i % 3)
            CHECK(motion_interpolate(&from, &to, i % 3 == 1 ? vec3_all(0) : random_vec(&random, 3), &motion));
        struct vec3 a = random_vec(&random, 2), b = random_vec(&random, 2);
        struct box box = {vec3_min(a, b), vec3_max(a, b)};
        struct shutter shutter = {test_uniform(&random, -0.5, 0.8), 0};
        shutter.close = shutter.open + test_uniform(&random, 0, 1.2);
        struct box bounds = motion_bounds(&motion, &box, shutter);
        for (int k = 0; k < 300; k++) {
            struct vec3 p = {k & 1 ? box.min.x : box.max.x, k & 2 ? box.min.y : box.max.y,
                             k & 4 ? box.min.z : box.max.z};
            struct transform at = motion_at(&motion, shutter_time(shutter, test_uniform(&random, 0, 1)));
            p = affine_point(&at.forward, p);
            CHECK(box_contains(&bounds, p));
        }
    }
}

/* --- pictures --- */

static struct material *bright(struct stage *s) {
    struct material *material = stage_phong(s, colour_all(1), colour_all(0), 1);
    material->phong.unlit = true;
    return material;
}

/* Seen straight from the front, one pixel a unit, `size` pixels wide and high, the origin in the middle. */
static void frontal_view(struct stage *s, double size) {
    s->camera = (struct camera){{0, 0, 50}, {0, 0, -1}, {0, 1, 0}, 40};
    s->settings.lens.projection = PROJECTION_ORTHOGRAPHIC;
    s->settings.lens.view_height = size;
    s->settings.samples = 8;
}

/* The edge at x = -8 moves 12 to the right while the shutter is open: how long a place x was covered is a ramp, and a
 * pixel is its mean. Of 64 stratified moments, all are certain except the six in which the edge is inside the pixel: at
 * most half of these can be wrong. */
TEST(a_moving_edge_is_its_box_filter) {
    struct stage s;
    stage_begin(&s, 2);
    struct node *block = stage_cube(&s, s.root, bright(&s));
    stage_scale(&s, block, 40, 40, 1);
    stage_move(&s, block, -48, -20, 0);
    block->velocity = vec3_make(24, 0, 0);
    s.settings.shutter = (struct shutter){0, 0.5};
    frontal_view(&s, 8);
    CHECK(stage_render(&s, 32, 8));
    for (uint32_t x = 0; x < 32; x++) {
        double left = (double)x - 16, expected = 0;
        for (int i = 0; i < 1000; i++) {
            double position = left + (i + 0.5) / 1000;
            expected += fmin(fmax((4 - position) / 12, 0), 1) / 1000;
        }
        double mean = 0;
        for (uint32_t y = 0; y < 8; y++) {
            CHECK_NEAR(stage_pixel(&s, x, y).r, expected, 3.0 / 64);
            mean += stage_pixel(&s, x, y).r / 8;
        }
        CHECK_NEAR(mean, expected, 0.015);
    }
    stage_end(&s);
}

/* Everything that can move, moving: a ball, a mesh, a solid with a hole, an instance, nested motions, a mirror and a
 * shadow. */
static void moving_stage(struct stage *s, int threads, double unit) {
    stage_begin(s, threads);
    struct material *white = stage_phong(s, colour_make(0.7, 0.5, 0.3), colour_all(0), 1);
    struct material *mirror = stage_glass(s, 0.8, 0, 1);
    struct node *ball = stage_sphere(s, s->root, white);
    stage_scale(s, ball, unit, 1.2 * unit, unit);
    stage_move(s, ball, -4 * unit, 0, 0);
    ball->velocity = vec3_make(2 * unit, 0.5 * unit, 0);
    struct node *wheel = stage_group(s, s->root);
    struct node *end = scene_node(&s->scene, NODE_GROUP, "end", &s->error);
    stage_move(s, wheel, 2 * unit, 1.5 * unit, 0);
    stage_rotate(s, end, 2, 70);
    stage_scale(s, end, 1.2, 0.9, 1);
    stage_move(s, end, 3 * unit, 1.5 * unit, 0);
    wheel->moves_to = end;
    struct node *spoke = stage_cube(s, wheel, white);
    stage_scale(s, spoke, 2.5 * unit, 0.4 * unit, unit);
    struct maker maker = {0};
    maker_sphere(&maker, 6);
    maker_scale(&maker, unit, 0, 0, 0);
    struct mesh_input input = maker_input(&maker);
    struct node *solid = scene_node(&s->scene, NODE_GEOMETRY, "mesh", &s->error);
    solid->shape = (struct shape){.kind = SHAPE_MESH, .mesh = assets_mesh(&s->assets, &input, &s->error)};
    solid->material = white;
    maker_free(&maker);
    stage_move(s, solid, -2 * unit, -unit, 0.5 * unit);
    solid->velocity = vec3_make(0, 0, unit); /* of an object on a wheel */
    CHECK(node_add_child(&s->scene, wheel, solid, &s->error));
    struct node *nowhere = scene_node(&s->scene, NODE_GROUP, "nowhere", &s->error), *operands[2];
    operands[0] = stage_cube(s, nowhere, white);
    operands[1] = stage_sphere(s, nowhere, mirror);
    for (int i = 0; i < 2; i++)
        stage_scale(s, operands[i], (2 - i) * unit, 2 * unit, 1.5 * unit);
    struct node *cut = scene_combine(&s->scene, "cut", NODE_DIFFERENCE, operands, 2, &s->error);
    stage_move(s, cut, -3 * unit, -4 * unit, 0);
    cut->velocity = vec3_make(0, 0.8 * unit, 0.5 * unit);
    CHECK(node_add_child(&s->scene, s->root, cut, &s->error));
    struct node *again = stage_group(s, s->root); /* the moving ball once more, under a node that does not move */
    stage_move(s, again, 6 * unit, -2.5 * unit, 0);
    CHECK(node_add_child(&s->scene, again, ball, &s->error));
    struct node *floor = stage_cube(s, s->root, mirror);
    stage_scale(s, floor, 20 * unit, unit, 20 * unit);
    stage_move(s, floor, -10 * unit, -5.5 * unit, -10 * unit);
    stage_point_light(s, vec3_make(4 * unit, 12 * unit, 8 * unit), colour_all(1));
    s->ambient = colour_all(0.1);
    s->camera = (struct camera){{0, unit, 14 * unit}, {0, -0.1, -1}, {0, 1, 0}, 50};
    s->settings.samples = 4;
}

/* A blurred picture is the mean of sharp ones. */
static void compare_with_mean(struct stage *s, uint32_t width, uint32_t height, double max_rms) {
    enum { FRAMES = 48 };
    struct colour *mean = calloc((size_t)width * height, sizeof *mean);
    struct shutter shutter = s->settings.shutter;
    s->settings.samples = 6;
    s->settings.full = true;
    for (int i = 0; i < FRAMES; i++) {
        double moment = shutter_time(shutter, (i + 0.5) / FRAMES);
        s->settings.shutter = (struct shutter){moment, moment};
        s->settings.samples = 3;
        CHECK(stage_render(s, width, height));
        for (uint32_t k = 0; k < width * height; k++)
            mean[k] = colour_add_scaled(mean[k], stage_pixel(s, k % width, k / width), 1.0 / FRAMES);
    }
    s->settings.shutter = shutter;
    s->settings.samples = 12;
    CHECK(stage_render(s, width, height));
    double sum = 0, worst = 0;
    for (uint32_t k = 0; k < width * height; k++) {
        struct colour d = colour_sub(stage_pixel(s, k % width, k / width), mean[k]);
        sum += colour_dot(d, d) / 3;
        worst = fmax(worst, colour_max_abs(d));
    }
    CHECK_NEAR(sqrt(sum / (width * height)), 0, max_rms);
    CHECK_NEAR(worst, 0, 0.15);
    free(mean);
}

TEST(a_blurred_picture_is_the_mean_of_sharp_ones) {
    struct stage s;
    moving_stage(&s, 2, 1);
    s.settings.shutter = (struct shutter){0.1, 0.9};
    compare_with_mean(&s, 40, 30, 0.012);
    stage_end(&s);
}

TEST(a_moving_camera_is_the_mean_of_standing_ones) {
    struct stage s;
    moving_stage(&s, 2, 1);
    s.settings.shutter = (struct shutter){0, 1};
    s.settings.motion =
        (struct camera_motion){true, vec3_make(0.6, 1.2, 13.5), vec3_make(0.05, -0.1, -1), vec3_make(0.05, 1, 0)};
    s.settings.lens.aperture = 0.05;
    s.settings.lens.focus = 14;
    compare_with_mean(&s, 32, 24, 0.015);
    stage_end(&s);
}

TEST(moving_the_camera_is_moving_everything_in_the_opposite_direction) {
    struct colour *first = calloc(32 * 8, sizeof *first);
    for (int i = 0; i < 2; i++) {
        struct stage s;
        stage_begin(&s, 2);
        struct node *ball = stage_sphere(&s, s.root, bright(&s));
        stage_scale(&s, ball, 2, 2, 2);
        frontal_view(&s, 8);
        if (i == 0)
            ball->velocity = vec3_make(4, 1, 0);
        else
            s.settings.motion =
                (struct camera_motion){true, vec3_sub(s.camera.eye, vec3_make(4, 1, 0)), s.camera.view, s.camera.up};
        CHECK(stage_render(&s, 32, 8));
        for (uint32_t k = 0; k < 32 * 8; k++) {
            if (i == 0)
                first[k] = stage_pixel(&s, k % 32, k / 32);
            CHECK_NEAR(first[k].r, stage_pixel(&s, k % 32, k / 32).r, 1.01 / 64);
        }
        stage_end(&s);
    }
    free(first);
}

/* Stratifying pixel and time together must have less variance than the same number of independent times. */
TEST(samples_of_pixel_and_time_are_stratified_together) {
    double error[2] = {0, 0};
    for (int single = 0; single < 2; single++) {
        struct stage s;
        stage_begin(&s, 1);
        struct node *block = stage_cube(&s, s.root, bright(&s));
        stage_scale(&s, block, 40, 40, 1);
        stage_move(&s, block, -41, -20, 0);
        block->velocity = vec3_make(2, 0, 0);
        frontal_view(&s, 0.001);
        error[single] = stage_variance_about_half(&s, single);
        stage_end(&s);
    }
    CHECK(error[0] < 0.1 * error[1]);
}

TEST(motion_gives_the_same_bits_for_any_threads_search_crop_and_power_of_two) {
    struct film_pixel *reference = NULL;
    for (int i = 0; i < 7; i++) {
        struct stage s;
        moving_stage(&s, i == 1 ? 7 : 2, i == 5 ? 0x1p12 : 1);
        s.settings.motion = (struct camera_motion){true, vec3_scale(vec3_make(0.5, 1, 14), i == 5 ? 0x1p12 : 1),
                                                   s.camera.view, s.camera.up};
        if (i == 2) {
            s.settings.cropped = true;
            s.settings.crop_height = 40;
            s.settings.crop_width = 70;
        }
        s.settings.accel = i == 3 ? ACCEL_NONE : i == 4 ? ACCEL_GRID : i == 6 ? ACCEL_KDTREE : ACCEL_AUTO;
        CHECK(stage_render(&s, 70, 50));
        if (!reference)
            reference = memcpy(malloc(2 * 70 * 50 * sizeof *reference), s.film.pixels, 2 * 70 * 50 * sizeof *reference);
        int different = 0;
        for (size_t k = 0; k < (size_t)70 * (i == 2 ? 40 : 50); k++)
            different += memcmp(&reference[k], &s.film.pixels[k], sizeof *reference) != 0 ||
                         memcmp(&reference[70 * 50 + k], &s.film.floats[3 * k], sizeof *reference) != 0;
        CHECK_EQ_INT(different, 0);
        stage_end(&s);
    }
    free(reference);
}

/* The camera is outside a moving glass ball at first and inside it at the end: each ray must have the right medium. */
TEST(a_camera_that_glass_moves_over_starts_in_glass_at_the_right_times) {
    struct stage s;
    stage_begin(&s, 2);
    struct material *glass = stage_glass(&s, 0, 1, 1.5);
    struct node *ball = stage_sphere(&s, s.root, glass);
    stage_scale(&s, ball, 3, 3, 3);
    stage_move(&s, ball, 0, 0, 4);
    ball->velocity = vec3_make(0, 0, -4);
    s.sky = (struct sky){.kind = SKY_GRADIENT};
    s.camera = (struct camera){{0, 0, 0}, {0.2, 0.4, -1}, {0, 1, 0}, 30};
    compare_with_mean(&s, 24, 16, 0.01);
    stage_end(&s);
}
