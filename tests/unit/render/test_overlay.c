/* Overlay lines on a picture. */
#include "render/camera.h"
#include "render/overlay.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How far a pixel's middle is from the nearest edge of the box in the picture; *front: that edge has z = max. */
static double distance_to_edges(const struct camera_frame *frame, const struct box *box, double px, double py,
                                bool *front) {
    double best = INFINITY;
    for (int i = 0; i < 8; i++) {
        for (int axis = 1; axis <= 4; axis *= 2) {
            if (i & axis)
                continue;
            for (int k = 0; k <= 100; k++) {
                int j = i | axis;
                struct vec3 a = {i & 1 ? box->max.x : box->min.x, i & 2 ? box->max.y : box->min.y,
                                 i & 4 ? box->max.z : box->min.z};
                struct vec3 b = {j & 1 ? box->max.x : box->min.x, j & 2 ? box->max.y : box->min.y,
                                 j & 4 ? box->max.z : box->min.z};
                double x, y;
                CHECK(camera_project(frame, vec3_add_scaled(a, vec3_sub(b, a), k / 100.0), &x, &y));
                double distance = hypot(x - px, y - py);
                if (distance < best) {
                    best = distance;
                    *front = (i & 4) && axis != 4;
                }
            }
        }
    }
    return best;
}

TEST(the_box_of_a_ball_is_drawn_where_its_edges_are_and_faintly_behind_it) {
    enum { SIZE = 50 };
    static struct film_pixel before[SIZE * SIZE];
    struct stage s;
    stage_begin(&s, 2);
    struct material *material = stage_phong(&s, colour_all(0.5), colour_all(0), 1);
    material->phong.unlit = true;
    struct node *ball = stage_sphere(&s, s.root, material);
    (void)ball;
    s.camera = (struct camera){{0.4, 0.7, 5}, {0, 0, -1}, {0, 1, 0}, 40};
    CHECK(stage_render(&s, SIZE, SIZE));
    memcpy(before, s.film.pixels, sizeof before);
    struct render_job job = {
        .world = &s.world, .camera = s.camera, .settings = s.settings, .width = SIZE, .height = SIZE, .film = &s.film};
    job.settings.overlay = OVERLAY_OF_BOXES;
    CHECK(overlay_draw(&job, s.pool, &s.error));
    struct camera_frame frame;
    char warning[256];
    CHECK(camera_prepare(&s.camera, &s.settings, (struct picture_size){SIZE, SIZE}, &frame, warning, &s.error));
    const struct box box = {{-1, -1, -1}, {1, 1, 1}};
    int drawn = 0, faint = 0;
    for (uint32_t y = 0; y < SIZE; y++) {
        for (uint32_t x = 0; x < SIZE; x++) {
            bool front = false;
            double distance = distance_to_edges(&frame, &box, x + 0.5, y + 0.5, &front);
            const struct film_pixel *now = &s.film.pixels[y * SIZE + x], *was = &before[y * SIZE + x];
            double change = fabs((double)now->rgb[0] - (double)was->rgb[0]) +
                            fabs((double)now->rgb[1] - (double)was->rgb[1]) +
                            fabs((double)now->rgb[2] - (double)was->rgb[2]);
            if (distance > 1)
                CHECK(change == 0);
            if (distance < 0.2)
                CHECK(change > 0);
            if (front && distance < 0.2)
                CHECK(change > 0.3);
            drawn += change > 0;
            faint += change > 0 && change < 0.2;
        }
    }
    CHECK(drawn > 90);
    CHECK(faint > 2); /* the far edges behind the ball */
    stage_end(&s);
}

/* For each eye of a stereo pair, the edges of a box in the picture coincide with its overlay lines. */
TEST(a_pair_of_pictures_has_the_lines_of_each_eye_in_its_half) {
    enum { WIDTH = 120, HEIGHT = 60 };
    struct stage s;
    stage_begin(&s, 1);
    struct material *material = stage_phong(&s, colour_make(0.5, 0, 0), colour_all(0), 1);
    material->phong.unlit = true;
    struct node *cube = stage_cube(&s, s.root, material);
    stage_move(&s, cube, -0.5, -0.5, -0.5);
    s.camera = (struct camera){{0, 0, 4}, {0, 0, -1}, {0, 1, 0}, 30};
    s.settings.lens.stereo = STEREO_SIDE;
    s.settings.lens.eye_distance = 0.6;
    s.settings.lens.screen = 8;
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    /* Extent of the cube in each half, then of the lines. */
    double low[2][2] = {{1e9, 1e9}, {1e9, 1e9}}, high[2][2] = {{0, 0}, {0, 0}};
    struct render_job job = stage_job(&s, WIDTH, HEIGHT);
    job.settings.overlay = OVERLAY_OF_BOXES;
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
            double x = i % WIDTH;
            int half = x >= WIDTH / 2;
            const float *rgb = s.film.pixels[i].rgb;
            if (pass == 0 ? rgb[0] > 0.4f : rgb[1] > 0.1f) {
                low[pass][half] = fmin(low[pass][half], x);
                high[pass][half] = fmax(high[pass][half], x);
            }
        }
        if (pass == 0)
            CHECK(overlay_draw(&job, s.pool, &s.error));
    }
    for (int half = 0; half < 2; half++) {
        CHECK_NEAR(low[0][half], low[1][half], 1.01);
        CHECK_NEAR(high[0][half], high[1][half], 1.01);
    }
    CHECK(low[1][1] - WIDTH / 2.0 < low[1][0] - 2); /* the right eye sees it further left */
    stage_end(&s);
}

static const char scene[] =
    "local r = gr.node('root')\n"
    "for i = -3, 3 do local s = gr.sphere(gr.material({0.8, 0.3, 0.2}, {0, 0, 0}, 20)) s:scale(0.3, 0.3, 0.3)\n"
    "  s:translate(i, i % 2, 0) r:add_child(s) end\n"
    "local function picture(name, projection)\n"
    "  gr.render{node = r, file = name, width = 64, height = 48, eye = {0, 0, 6}, view = {0, 0, -1}, fov = 60,\n"
    "    projection = projection, ambient = {0.5, 0.5, 0.5}, lights = {}} end\n"
    "for _, p in ipairs{'perspective', 'orthographic', 'fisheye', 'panorama'} do picture(p .. '.png', p) end\n";

/* Pixels of a picture that differ from the one without lines. */
static int differing(const char *name, const struct test_picture *plain) {
    struct test_picture p = test_read_picture(test_path(name));
    int count = 0;
    for (uint32_t i = 0; p.rgb && i < 64 * 48; i++)
        count += memcmp(p.rgb + 3 * i, plain->rgb + 3 * i, 3) != 0;
    free(p.rgb);
    return count;
}

TEST(lines_are_drawn_in_every_projection_and_for_every_accelerator) {
    static const char *const names[] = {"perspective.png", "orthographic.png", "fisheye.png", "panorama.png"};
    static const char *const options[] = {"--overlay boxes scene.lua", "--overlay grid scene.lua",
                                          "--overlay grid --accel grid scene.lua",
                                          "--overlay grid --accel kdtree scene.lua"};
    struct test_picture plain[4];
    struct test_result result = test_gray_scene(scene, "-q scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    for (int i = 0; i < 4; i++)
        plain[i] = test_read_picture(test_path(names[i]));
    for (int k = 0; k < 4; k++) {
        result = test_gray_scene(NULL, options[k], NULL);
        CHECK_EQ_INT(result.status, 0);
        test_free_result(&result);
        for (int i = 0; i < 4; i++)
            CHECK(differing(names[i], &plain[i]) > 20);
    }
    result = test_gray_scene(NULL, "--overlay grid --accel none scene.lua", NULL);
    for (int i = 0; i < 4; i++) {
        CHECK_EQ_INT(differing(names[i], &plain[i]), 0);
        free(plain[i].rgb);
    }
    test_free_result(&result);
    result = test_gray_scene(NULL, "--overlay boxes --checkpoint auto scene.lua", NULL);
    CHECK_EQ_INT(result.status, 2);
    test_free_result(&result);
}

TEST(lines_over_a_picture_are_the_same_for_any_number_of_threads) {
    enum { WIDTH = 90, HEIGHT = 61 };
    static float lines[3][WIDTH * HEIGHT][4];
    for (int threads = 1; threads <= 3; threads++) {
        struct stage s;
        stage_begin(&s, threads);
        struct material *material = stage_phong(&s, colour_all(0.5), colour_all(0), 1);
        for (int i = 0; i < 40; i++)
            stage_move(&s, stage_sphere(&s, s.root, material), i % 7 - 3, i % 5 - 2, -i % 11);
        s.camera = (struct camera){{0.4, 0.7, 5}, {0, 0, -1}, {0, 1, 0}, 60};
        s.settings.lens.projection = PROJECTION_PERSPECTIVE;
        CHECK(stage_render(&s, WIDTH, HEIGHT));
        struct render_job job = stage_job(&s, WIDTH, HEIGHT);
        const struct overlay_request request = {OVERLAY_OF_BOXES, 1000, 3};
        CHECK(overlay_lines(&job, s.pool, &request, lines[threads - 1], &s.error));
        stage_end(&s);
    }
    CHECK(memcmp(lines[0], lines[1], sizeof lines[0]) == 0);
    CHECK(memcmp(lines[0], lines[2], sizeof lines[0]) == 0);
    int drawn = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        drawn += lines[0][i][3] < 1;
    CHECK(drawn > 500);
}
