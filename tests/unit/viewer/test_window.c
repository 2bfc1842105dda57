/* The viewer with a window that the test plays: camera flights by quaternions, the choice of the next pass, edits. */
#include "base/mem.h"
#include "render/integrator.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "viewer/viewer_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct fly_camera some_traversal(void) {
    struct fly_camera fly_camera;
    const struct camera camera = {{1, 2, 3}, {1, -0.5, -2}, {0, 1, 0}, 50};
    const struct box bounds = {{-4, -4, -4}, {4, 4, 4}};
    fly_camera_begin(&fly_camera, &camera, &bounds);
    return fly_camera;
}

static double apart(struct vec3 a, struct vec3 b) {
    return vec3_length(vec3_sub(a, b));
}

TEST(fly_camera_begins_with_the_camera_of_the_script) {
    struct fly_camera fly_camera = some_traversal();
    struct camera camera = fly_camera_current(&fly_camera);
    CHECK_NEAR(apart(camera.eye, vec3_make(1, 2, 3)), 0, 0);
    CHECK_NEAR(apart(camera.view, vec3_normalize(vec3_make(1, -0.5, -2))), 0, 1e-15);
    CHECK_NEAR(vec3_dot(camera.view, camera.up), 0, 1e-15);
    CHECK(camera.up.y > 0);
    CHECK_NEAR(camera.fov, 50, 0);
}

TEST(fly_camera_keeps_a_proper_orientation_through_a_million_turns) {
    struct fly_camera fly_camera = some_traversal();
    struct test_random random = {3};
    for (int i = 0; i < 1000000; i++)
        fly_camera_turn(&fly_camera, test_uniform(&random, -0.2, 0.2), test_uniform(&random, -0.2, 0.2));
    struct camera camera = fly_camera_current(&fly_camera);
    CHECK_NEAR(vec3_length(camera.view), 1, 1e-12);
    CHECK_NEAR(vec3_length(camera.up), 1, 1e-12);
    CHECK_NEAR(vec3_dot(camera.view, camera.up), 0, 1e-12);
}

TEST(fly_camera_turns_straight_up_and_over_without_trouble) {
    struct fly_camera fly_camera;
    const struct camera camera = {{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 90};
    const struct box bounds = {{-1, -1, -1}, {1, 1, 1}};
    fly_camera_begin(&fly_camera, &camera, &bounds);
    for (int i = 1; i <= 36; i++) { /* ten degrees per step, one full turn */
        fly_camera_turn(&fly_camera, 0, -10.0 / 90);
        double a = i * 10 * M_PI / 180;
        CHECK_NEAR(apart(fly_camera_current(&fly_camera).view, vec3_make(0, sin(a), -cos(a))), 0, 1e-12);
    }
}

TEST(fly_camera_goes_as_far_in_a_hundred_steps_as_in_one) {
    struct fly_camera fine = some_traversal(), coarse = some_traversal();
    fine.down[FLY_FORWARD] = fine.down[FLY_RIGHT] = coarse.down[FLY_FORWARD] = coarse.down[FLY_RIGHT] = true;
    for (int i = 0; i < 100; i++)
        CHECK(fly_camera_step(&fine, 0.01));
    CHECK(fly_camera_step(&coarse, 1));
    CHECK_NEAR(apart(fine.pose.position, coarse.pose.position), 0, 1e-12);
    CHECK_NEAR(apart(coarse.pose.position, coarse.home.position), coarse.speed, 1e-12);
    struct fly_camera fast = some_traversal();
    fast.down[FLY_FORWARD] = fast.down[FLY_FAST] = true;
    CHECK(fly_camera_step(&fast, 1));
    CHECK_NEAR(apart(fast.pose.position, fast.home.position), 4 * fast.speed, 1e-12);
    fly_camera_home(&fast);
    CHECK_NEAR(apart(fast.pose.position, vec3_make(1, 2, 3)), 0, 0);
}

TEST(fly_camera_is_slower_near_what_is_in_front) {
    struct fly_camera fly_camera = some_traversal();
    double usual = fly_camera.speed;
    fly_camera_near(&fly_camera, 1e-9);
    CHECK_NEAR(fly_camera.speed, 0.01 * usual, 1e-12);
    fly_camera_near(&fly_camera, usual);
    CHECK_NEAR(fly_camera.speed, 0.7 * usual, 1e-12);
    fly_camera_near(&fly_camera, HUGE_VAL);
    CHECK_NEAR(fly_camera.speed, usual, 1e-12);
}

TEST(fly_camera_orbits_keep_the_distance_of_the_centre_and_its_position_in_the_picture) {
    struct fly_camera fly_camera = some_traversal();
    struct camera before = fly_camera_current(&fly_camera);
    struct vec3 right = vec3_cross(before.view, before.up), to = vec3_sub(fly_camera.centre, before.eye);
    for (int i = 0; i < 50; i++)
        fly_camera_orbit(&fly_camera, 0.07, -0.03);
    struct camera after = fly_camera_current(&fly_camera);
    struct vec3 right_after = vec3_cross(after.view, after.up), to_after = vec3_sub(fly_camera.centre, after.eye);
    CHECK(apart(before.eye, after.eye) > 0.1);
    CHECK_NEAR(vec3_dot(to, right), vec3_dot(to_after, right_after), 1e-9);
    CHECK_NEAR(vec3_dot(to, before.up), vec3_dot(to_after, after.up), 1e-9);
    CHECK_NEAR(vec3_dot(to, before.view), vec3_dot(to_after, after.view), 1e-9);
}

TEST(fly_camera_levels_the_horizon_and_keeps_its_direction) {
    struct fly_camera fly_camera = some_traversal();
    fly_camera_roll(&fly_camera, 40);
    struct vec3 view = fly_camera_current(&fly_camera).view;
    CHECK(fabs(vec3_cross(view, fly_camera_current(&fly_camera).up).y) > 0.1);
    fly_camera_level(&fly_camera);
    CHECK_NEAR(vec3_cross(fly_camera_current(&fly_camera).view, fly_camera_current(&fly_camera).up).y, 0, 1e-12);
    CHECK_NEAR(apart(fly_camera_current(&fly_camera).view, view), 0, 1e-12);
}

/* A movement is one view, however many steps it has. */
TEST(fly_camera_goes_back_over_its_views_and_forth) {
    struct fly_camera fly_camera = some_traversal();
    struct vec3 positions[4] = {fly_camera.pose.position};
    for (int view = 1; view < 4; view++) {
        for (int step = 0; step < 5; step++) {
            fly_camera.pose.position.x += 1;
            fly_camera_note(&fly_camera, 10 * view + 0.1 * step);
        }
        positions[view] = fly_camera.pose.position;
    }
    CHECK(!fly_camera_recall(&fly_camera, true));
    for (int view = 2; view >= 0; view--)
        CHECK(fly_camera_recall(&fly_camera, false) && apart(fly_camera.pose.position, positions[view]) == 0);
    CHECK(!fly_camera_recall(&fly_camera, false));
    CHECK(fly_camera_recall(&fly_camera, true) && apart(fly_camera.pose.position, positions[1]) == 0);
    /* A movement from there forgets what came after it; of many views the last ones stay. */
    fly_camera.pose.position.y = 7;
    fly_camera_note(&fly_camera, 60);
    CHECK(!fly_camera_recall(&fly_camera, true) && fly_camera_recall(&fly_camera, false));
    CHECK_NEAR(apart(fly_camera.pose.position, positions[1]), 0, 0);
    for (int view = 0; view < 3 * FLY_VIEWS; view++) {
        fly_camera.pose.position.z = view;
        fly_camera_note(&fly_camera, 100 + view);
    }
    for (int view = 3 * FLY_VIEWS - 2; view > 2 * FLY_VIEWS; view--)
        CHECK(fly_camera_recall(&fly_camera, false) && fly_camera.pose.position.z == view);
}

/* A window without a screen: the test supplies the user's input. */
struct fake {
    struct window_event queue[16];
    int count, shown;
    bool open, flies;
    struct window_state state;
};

static bool fake_open(void *context, struct error *error) {
    struct fake *fake = context;
    (void)error;
    CHECK(fake->state.has_scene);
    return fake->open = true;
}
static void fake_show(void *context, const uint8_t *picture, uint32_t width, uint32_t height) {
    struct fake *fake = context;
    CHECK(picture && width == 100 && height == 70 && fake->state.form.count < FORM_FIELDS);
    fake->shown++;
}
static bool fake_poll(void *context, struct window_event *event) {
    struct fake *fake = context;
    if (fake->count == 0)
        return false;
    *event = fake->queue[0];
    memmove(fake->queue, fake->queue + 1, (size_t)--fake->count * sizeof *event);
    return true;
}
static int fake_descriptor(void *context) {
    (void)context;
    return -1;
}
static void fake_nodes(void *context, const struct node_query *query, const struct node_rows *rows) {
    (void)context, (void)query, (void)rows;
}
static void fake_close(void *context) {
    struct fake *fake = context;
    fake->open = false;
}

static void key(struct fake *fake, enum fly_camera_key code, bool down) {
    fake->queue[fake->count++] = (struct window_event){.kind = WINDOW_KEY, .key = code, .down = down};
}

static void do_action(struct fake *fake, enum window_action action) {
    fake->queue[fake->count++] = (struct window_event){.kind = WINDOW_ACTION, .action = action};
}

struct table {
    struct fake fake;
    struct window_driver driver;
    struct viewer viewer;
    struct picture_request request;
    void *block;
    double now;
};

static enum viewer_action step(struct table *t) {
    t->now += 0.02;
    return viewer_step(&t->viewer, t->now);
}

static void print_news(struct table *t, const struct preview_reply *reply) {
    viewer_receive_reply(&t->viewer, reply, t->now);
}

/* The child has built the world: the first request is the coarsest pass. */
static void build(struct table *t) {
    struct preview_reply reply = {.kind = REPLY_BUILT, .light_count = 1, .world_from_root = affine_identity()};
    reply.report.bounds = (struct box){{-1, -1, -1}, {1, 1, 1}};
    reply.lights[0] = (struct light_info){
        .kind = LIGHT_POINT, .has_position = true, .position = {0, 1, 0}, .colour = {1, 1, 1}, .moves = true};
    memcpy(reply.root_name, "root", 5);
    print_news(t, &reply);
    CHECK_EQ_INT(step(t), VIEWER_SEND_COMMAND);
    CHECK_EQ_INT(t->viewer.command.kind, COMMAND_PASS);
    CHECK(t->viewer.pass.view.divide > 4 && t->viewer.pass.view.plain && t->viewer.pass.view.own);
}

static void begin_with(struct table *t, struct film_record record, int samples) {
    struct error error;
    size_t bytes;
    *t = (struct table){.now = 100,
                        .request = {.record = record,
                                    .settings.path_samples = samples,
                                    .full_width = 100,
                                    .full_height = 70,
                                    .width = 100,
                                    .height = 70,
                                    .camera = {{0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 40}}};
    t->driver = (struct window_driver){.context = &t->fake,
                                       .state = &t->fake.state,
                                       .open = fake_open,
                                       .close = fake_close,
                                       .poll = fake_poll,
                                       .descriptor = fake_descriptor,
                                       .show = fake_show,
                                       .nodes = fake_nodes};
    CHECK(film_size(100, 70, record, &bytes, &error));
    t->block = mem_alloc_zero(1, bytes);
    CHECK(
        viewer_begin(&t->viewer, &t->driver, &(struct viewer_picture){&t->request, t->block, "x.png"}, t->now, &error));
    t->fake.queue[t->fake.count++] = (struct window_event){.kind = WINDOW_SIZE, .x = 400, .y = 280, .density = 1};
    build(t);
}

static void begin(struct table *t) {
    begin_with(t, stage_record(INTEGRATOR_WHITTED), 0);
}

/* The window of a script that has not rendered yet, and then a picture of its size. */
TEST(window_that_waits_for_a_picture_of_its_size_has_room_for_all_tiles_of_it) {
    struct error error;
    struct table t;
    begin(&t);
    const struct picture_request request = t.request;
    viewer_end(&t.viewer);
    CHECK(viewer_open(&t.viewer, &t.driver, "slow.lua", request.width, request.height, &error));
    CHECK(viewer_begin(&t.viewer, &t.driver, &(struct viewer_picture){&request, t.block, "x.png"}, t.now, &error));
    CHECK_EQ_INT(t.viewer.display.tiles, 4 * 3);
    viewer_end(&t.viewer);
    mem_free(t.block);
}

static void end(struct table *t) {
    viewer_end(&t->viewer);
    CHECK(!t->fake.open);
    mem_free(t->block);
}

/* The child has finished the pass in this many seconds. */
static void finish_pass(struct table *t, double seconds, bool stopped) {
    const struct picture_report report = {.threads = 2, .bounds = {{-1, -1, -1}, {1, 1, 1}}, .stopped = stopped};
    t->now += seconds;
    for (uint32_t tile = 0; !stopped && tile < film_tile_count(&t->viewer.pass.film); tile++)
        atomic_store(&t->viewer.pass.film.tiles[tile], FILM_TILE_DONE);
    print_news(t, &(struct preview_reply){.kind = REPLY_PASS, .report = report});
}

/* Coarse passes, each finer than the one before, up to the first fine one. */
static void go_to_the_fine_pass(struct table *t) {
    while (t->viewer.pass.view.plain) {
        uint32_t divide = t->viewer.pass.view.divide;
        finish_pass(t, 0.02, false);
        CHECK_EQ_INT(step(t), VIEWER_SEND_COMMAND);
        CHECK(!t->viewer.pass.view.plain || t->viewer.pass.view.divide < divide);
    }
    CHECK(t->viewer.pass.view.divide == 1);
}

/* Up to the script's complete picture. */
static void go_to_the_end(struct table *t) {
    go_to_the_fine_pass(t);
    CHECK(t->viewer.pass.view.own);
    CHECK_EQ_INT(step(t), VIEWER_NOTHING);
    finish_pass(t, 1, false);
    CHECK_EQ_INT(step(t), VIEWER_WRITE_PICTURE);
    CHECK_EQ_INT(step(t), VIEWER_NOTHING);
}

TEST(window_shows_coarse_passes_first_and_writes_the_picture_of_the_script_once) {
    struct table t;
    begin(&t);
    CHECK(t.viewer.pass.film.width < 20 && t.viewer.pass.film.height < 14);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    go_to_the_end(&t);
    CHECK(t.fake.shown >= 3);
    do_action(&t.fake, DO_RENDER);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.pass.view.plain && t.viewer.pass.view.own);
    go_to_the_fine_pass(&t);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    end(&t);
}

/* Presses the key: the viewer asks what is in front, and nothing is. */
static void begin_flight(struct table *t, enum fly_camera_key code) {
    key(&t->fake, code, true);
    CHECK_EQ_INT(step(t), VIEWER_SEND_COMMAND);
    CHECK(t->viewer.command.kind == COMMAND_PICK && t->viewer.command.x == 50.5);
    print_news(t, &(struct preview_reply){.kind = REPLY_PICKED});
}

TEST(window_renders_coarse_passes_while_the_camera_moves_and_refines_after) {
    struct table t;
    begin(&t);
    go_to_the_end(&t);
    begin_flight(&t, FLY_FORWARD);
    for (int i = 0; i < 5; i++) {
        CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
        CHECK(t.viewer.pass.view.plain && t.viewer.pass.view.divide > 1 && !t.viewer.pass.view.own);
        CHECK(t.viewer.pass.view.camera.eye.z < 5);
        CHECK_EQ_INT(step(&t), VIEWER_NOTHING); /* a coarse pass is worth its end */
        finish_pass(&t, 0.03, false);
    }
    key(&t.fake, FLY_FORWARD, false);
    while (t.viewer.pass.view.plain) {
        CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
        finish_pass(&t, 0.03, false);
    }
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING); /* a view that the user has moved is not the script's picture */
    end(&t);
}

TEST(window_stops_a_fine_pass_when_the_camera_moves) {
    struct table t;
    begin(&t);
    go_to_the_fine_pass(&t);
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_WHEEL, .y = 2, .control = true};
    CHECK_EQ_INT(step(&t), VIEWER_STOP_PASS);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    finish_pass(&t, 0.001, true);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.pass.view.plain && t.viewer.pass.view.camera.fov < 40);
    end(&t);
}

TEST(window_makes_passes_as_coarse_as_thirty_a_second_need) {
    struct table t;
    begin(&t);
    go_to_the_end(&t);
    begin_flight(&t, FLY_LEFT);
    uint32_t divide = 0;
    for (int i = 0; i < 12; i++) {
        CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
        divide = t.viewer.pass.view.divide;
        finish_pass(&t, 0.8 / (divide * divide), false); /* a scene that takes 0.8 s at one sample a pixel */
    }
    CHECK_EQ_INT(divide, 5); /* 0.8 / 25 s is below a thirtieth, 0.8 / 16 is not */
    end(&t);
}

/* The render process has finished a pass over this tile with this light, or all of it. */
static void render_tile(struct table *t, uint32_t tile, float light, uint8_t state) {
    const struct film *film = &t->viewer.pass.film;
    struct film_rectangle r = film_tile_rectangle(film, tile);
    for (uint32_t y = r.y0; y < r.y1; y++)
        for (uint32_t x = r.x0; x < r.x1; x++)
            for (int c = 0; c < 3; c++)
                film->pixels[(size_t)y * film->width + x].rgb[c] = light;
    atomic_store(&film->tiles[tile], state);
}

static int pixels_with(const struct table *t, uint8_t level) {
    int count = 0;
    for (int i = 0; i < 100 * 70; i++)
        count += t->viewer.window.image[3 * i] == level;
    return count;
}

TEST(window_shows_passes_over_a_view_and_nothing_of_it_once_another_one_begins) {
    struct table t;
    begin(&t);
    go_to_the_fine_pass(&t);
    /* A tile is shown again after each pass. */
    render_tile(&t, 0, 1, FILM_TILE_PASSED + 1);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    int whole = pixels_with(&t, 255);
    CHECK(whole > 0);
    render_tile(&t, 0, 0.2f, FILM_TILE_PASSED + 2);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(pixels_with(&t, 255) == 0 && pixels_with(&t, 51) == whole);
    /* The view changes: tiles that are finished until the pass has stopped are not shown. */
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_WHEEL, .y = 2, .control = true};
    CHECK_EQ_INT(step(&t), VIEWER_STOP_PASS);
    render_tile(&t, 0, 1, FILM_TILE_PASSED + 3);
    render_tile(&t, 1, 1, FILM_TILE_PASSED + 3);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    finish_pass(&t, 0.001, true);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(pixels_with(&t, 255) == 0);
    /* When the first pass of the new view is finished, all pixels are of it. */
    for (uint32_t tile = 0; tile < film_tile_count(&t.viewer.pass.film); tile++)
        render_tile(&t, tile, 0.6f, FILM_TILE_DONE);
    finish_pass(&t, 0.01, false);
    CHECK_EQ_INT(pixels_with(&t, 153), 100 * 70);
    end(&t);
}

static const uint8_t *middle_of(const struct table *t) {
    return t->viewer.window.image + (size_t)3 * (35 * 100 + 50);
}

/* A scene without `denoise`: its film has features, and passes whose tiles are not denoised are not shown. */
TEST(window_shows_samples_of_paths_only_denoised_and_doubles_them) {
    static const struct {
        uint32_t divide, samples, kept;
    } want[] = {{3, 2, 0}, {3, 4, 0}, {2, 8, 0}, {1, 16, 0}, {1, 32, 16}, {1, 0, 32}};
    struct table t;
    const struct settings settings = {.integrator = INTEGRATOR_PATH, .denoise = DENOISER_GRAY};
    begin_with(&t, render_record(&settings), 64);
    while (t.viewer.pass.view.plain) {
        finish_pass(&t, 0.02, false);
        CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    }
    for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
        const struct pass_view *view = &t.viewer.command.view;
        CHECK_EQ_INT(view->divide, want[i].divide);
        CHECK_EQ_INT(view->samples, want[i].samples);
        CHECK_EQ_INT(view->kept, want[i].kept);
        /* In progress: nothing of it is shown. */
        for (uint32_t tile = 0; tile < film_tile_count(&t.viewer.pass.film); tile++)
            render_tile(&t, tile, 1, FILM_TILE_PASSED + 1);
        uint8_t before = middle_of(&t)[0];
        CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
        CHECK_EQ_INT(middle_of(&t)[0], before);
        /* Denoised: all of it. */
        for (uint32_t tile = 0; tile < film_tile_count(&t.viewer.pass.film); tile++)
            render_tile(&t, tile, 0.2f * (float)(i % 2 + 1), FILM_TILE_DONE);
        finish_pass(&t, 0.02, false);
        CHECK_EQ_INT(middle_of(&t)[0], i % 2 ? 102 : 51);
        CHECK_EQ_INT(step(&t), want[i].samples ? VIEWER_SEND_COMMAND : VIEWER_WRITE_PICTURE);
    }
    end(&t);
}

/* A device is there: the first picture of a movement has all pixels, and the samples that follow are added to it. */
TEST(window_with_a_quick_device_walks_with_one_sample_and_adds_to_it_afterwards) {
    static const struct { uint32_t samples, kept; } want[] = {{8, 1}, {16, 8}, {32, 16}, {0, 32}};
    struct table t;
    const struct settings settings = {.integrator = INTEGRATOR_PATH, .denoise = DENOISER_GRAY};
    begin_with(&t, render_record(&settings), 64);
    const struct picture_report report = {.threads = 2, .bounds = {{-1, -1, -1}, {1, 1, 1}}};
    const struct preview_reply ready = {.kind = REPLY_PASS, .report = report, .walks = true};
    while (t.viewer.pass.view.plain) {
        finish_pass(&t, 0.02, false);
        CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    }
    print_news(&t, &ready);
    for (int i = 0; i < 5; i++) {
        do_action(&t.fake, DO_ROLL_LEFT);
        CHECK_EQ_INT(step(&t), i == 0 ? VIEWER_SEND_COMMAND : VIEWER_NOTHING);
        if (i > 0) { /* it is not stopped */
            CHECK_EQ_INT(t.viewer.pass.state, PASS_RUNNING);
            print_news(&t, &ready);
            CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
        }
        const struct pass_view *view = &t.viewer.command.view;
        CHECK(view->walks && view->plain && !view->headlight && !view->own);
        CHECK(view->divide == 1 && view->samples == 1 && view->kept == 0);
    }
    print_news(&t, &ready);
    for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
        const struct pass_view *view = &t.viewer.command.view;
        CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
        CHECK(!view->walks && !view->plain && view->divide == 1);
        CHECK_EQ_INT(view->samples, want[i].samples);
        CHECK_EQ_INT(view->kept, want[i].kept);
        print_news(&t, &ready);
    }
    /* It is gone; or the user wants to see normals. */
    print_news(&t, &(struct preview_reply){.kind = REPLY_PASS, .report = report});
    do_action(&t.fake, DO_ROLL_LEFT);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(!t.viewer.command.view.walks && t.viewer.command.view.headlight);
    print_news(&t, &ready);
    do_action(&t.fake, DO_SHOW_NORMALS);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(!t.viewer.command.view.walks && t.viewer.command.view.headlight);
    end(&t);
}

TEST(window_that_shows_normals_ends_with_their_preview_and_writes_no_picture) {
    struct table t;
    begin(&t);
    go_to_the_end(&t);
    do_action(&t.fake, DO_SHOW_NORMALS);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    t.viewer.written = false;
    while (t.viewer.pass.view.divide > 1) {
        CHECK(t.viewer.pass.view.headlight && t.viewer.pass.view.shows == HEADLIGHT_NORMALS);
        finish_pass(&t, 0.02, false);
        CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    }
    CHECK(t.viewer.pass.view.headlight);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(viewer_is_idle(&t.viewer));
    do_action(&t.fake, DO_SHOW_PICTURE);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    go_to_the_end(&t);
    end(&t);
}

/* A window that plays 60 frames at 30 frames per second, with a simulated script that takes 8 ms for each one, and
 * passes that would take 0.8 s with a sample for each pixel. */
TEST(window_plays_frames_when_they_are_due_by_passes_as_coarse_as_necessary) {
    struct table t;
    struct error error;
    double shown = 0;
    uint32_t number = 1, divide = 0;
    begin(&t);
    t.request.frame = (struct frame){1, 60, 30, true, 0};
    for (int frame = 0; frame < 150; frame++) {
        t.request.frame.number = number;
        CHECK(
            viewer_begin(&t.viewer, &t.driver, &(struct viewer_picture){&t.request, t.block, "x.png"}, t.now, &error));
        t.now += 0.008;
        print_news(&t, &(struct preview_reply){.kind = REPLY_BUILT, .world_from_root = affine_identity()});
        CHECK_EQ_INT(viewer_step(&t.viewer, t.now), VIEWER_SEND_COMMAND);
        CHECK(t.viewer.command.kind == COMMAND_PASS && t.viewer.pass.view.plain);
        divide = t.viewer.pass.view.divide;
        finish_pass(&t, 0.8 / (divide * divide), false);
        enum viewer_action action;
        while ((action = viewer_step(&t.viewer, t.now)) == VIEWER_NOTHING)
            t.now += 0.001;
        CHECK_EQ_INT(action, VIEWER_NEXT_FRAME);
        CHECK_EQ_INT(viewer_next_frame(&t.viewer), number % 60 + 1);
        CHECK(frame < 20 || fabs(t.now - shown - 1 / 30.0) < 0.0021);
        shown = t.now;
        number = viewer_next_frame(&t.viewer);
        viewer_detach(&t.viewer);
        CHECK(viewer_step(&t.viewer, t.now) == VIEWER_NOTHING && viewer_plays(&t.viewer));
    }
    CHECK_EQ_INT(divide, 7); /* 0.8 s / 49 fit into the rest of 33 ms */
    CHECK(t.viewer.player.left_out == 0 && fabs(t.viewer.player.rate - 30) < 0.5);
    /* A window that is too slow for its script leaves frames out. */
    for (int frame = 0; frame < 30; frame++) {
        t.request.frame.number = number;
        CHECK(
            viewer_begin(&t.viewer, &t.driver, &(struct viewer_picture){&t.request, t.block, "x.png"}, t.now, &error));
        t.now += 0.1;
        print_news(&t, &(struct preview_reply){.kind = REPLY_BUILT, .world_from_root = affine_identity()});
        CHECK_EQ_INT(viewer_step(&t.viewer, t.now), VIEWER_SEND_COMMAND);
        finish_pass(&t, 0.001, false);
        while (viewer_step(&t.viewer, t.now) == VIEWER_NOTHING)
            t.now += 0.001;
        number = viewer_next_frame(&t.viewer);
        viewer_detach(&t.viewer);
    }
    CHECK(t.viewer.player.left_out > 50 && t.viewer.player.left_out < 80);
    end(&t);
}

TEST(window_keys_fly_and_escape_ends_it) {
    struct table t;
    begin(&t);
    go_to_the_end(&t);
    do_action(&t.fake, DO_SAVE_PICTURE);
    CHECK_EQ_INT(step(&t), VIEWER_SAVE_IMAGE);
    do_action(&t.fake, DO_SAVE_VIEW);
    CHECK_EQ_INT(step(&t), VIEWER_SAVE_CAMERA);
    do_action(&t.fake, DO_FLY);
    begin_flight(&t, FLY_BACK);
    CHECK(t.fake.state.flies);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.pass.view.camera.eye.z > 5);
    do_action(&t.fake, DO_ESCAPE);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(!t.fake.state.flies && !t.viewer.fly_camera.down[FLY_BACK]);
    do_action(&t.fake, DO_QUIT);
    CHECK_EQ_INT(step(&t), VIEWER_QUIT);
    end(&t);
}

/* The camera of the script, and its picture, are there again to the bit. */
TEST(window_returns_to_views_before) {
    struct table t;
    begin(&t);
    go_to_the_end(&t);
    do_action(&t.fake, DO_VIEW_TOP);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.camera_moved && t.viewer.pass.view.camera.eye.y > 4);
    finish_pass(&t, 0.02, false);
    do_action(&t.fake, DO_VIEW_BACK);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(!t.viewer.camera_moved && t.viewer.pass.view.own);
    finish_pass(&t, 0.02, false);
    do_action(&t.fake, DO_VIEW_FORWARD);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.camera_moved && t.viewer.pass.view.camera.eye.y > 4);
    end(&t);
}

/* Overlays on the picture. */

static struct window_event mouse(enum window_event_kind kind, double x, double y) {
    return (struct window_event){.kind = kind, .button = WINDOW_LEFT, .x = x, .y = y};
}

static void click(struct table *t, double x, double y) {
    t->fake.queue[t->fake.count++] = mouse(WINDOW_MOVE, x, y);
    t->fake.queue[t->fake.count++] = mouse(WINDOW_PRESS, x, y);
    t->fake.queue[t->fake.count++] = mouse(WINDOW_RELEASE, x, y);
}

TEST(window_centres_the_picture_for_any_size_and_density) {
    struct table t;
    begin(&t);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    const struct window_layout *layout = &t.viewer.window.layout;
    CHECK(layout->left == 0 && layout->top == 0 && layout->shown_width == 400 && layout->shown_height == 280);
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_SIZE, .x = 1600, .y = 700, .density = 2};
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(layout->left == 300 && layout->top == 0 && layout->shown_width == 1000 && layout->shown_height == 700);
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_SIZE, .x = 50, .y = 90, .density = 1};
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(layout->left == 0 && layout->top == 27 && layout->shown_width == 50 && layout->shown_height == 35);
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_SIZE, .x = 0, .y = 0, .density = 1};
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    end(&t);
}

TEST(window_shows_how_long_the_picture_will_take) {
    struct table t;
    struct control control = {.build_step = 0};
    begin(&t);
    t.viewer.window.control = &control;
    progress_estimate_reset(&control.progress_estimate, true);
    control.progress_estimate.begun = t.now - 30;
    progress_estimate_report(&control.progress_estimate, 1, 3, t.now);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    t.now += 1;
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(t.viewer.pass.view.plain && strstr(t.fake.state.state, "(coarse)") && !strstr(t.fake.state.state, "left"));
    go_to_the_fine_pass(&t);
    control.progress_estimate.begun = t.now - 30;
    progress_estimate_report(&control.progress_estimate, 1, 3, t.now);
    t.now += 10;
    (void)step(&t);
    CHECK(strstr(t.fake.state.state, "25 %, 1 min 20 s left"));
    end(&t);
}

TEST(window_shows_how_far_building_is_and_errors) {
    struct table t;
    struct control control = {.build_step = 3, .build_done = 250};
    begin(&t);
    t.viewer.window.control = &control;
    t.now += 1;
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(strstr(t.fake.state.state, "building, step 3: 25 %") != NULL);
    control.build_step = 0;
    finish_pass(&t, 1, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    const char *figures = t.fake.state.figures;
    CHECK(strstr(figures, "triangles") && strstr(figures, "rays/s") && strstr(figures, "frames/s"));
    viewer_show_message(&t.viewer, "scene.lua:3: no such thing\nstack traceback");
    (void)step(&t);
    CHECK_TEXT(t.fake.state.message, "scene.lua:3: no such thing");
    viewer_detach(&t.viewer);
    (void)step(&t);
    do_action(&t.fake, DO_RENDER); /* there is nothing to render */
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    do_action(&t.fake, DO_SAVE_PICTURE); /* but the displayed picture can be saved */
    CHECK_EQ_INT(step(&t), VIEWER_SAVE_IMAGE);
    end(&t);
}

/* Editing. */

static const struct picked a_ball = {
    .hit = true,
    .node_path = "root#0 / ball#2",
    .name = "ball",
    .shape = "sphere",
    .material = "phong",
    .serial = 2,
    .levels = 1,
    .material_serial = 1,
    .can_own = true,
    .inputs = {[MATERIAL_PART_KD] = {0.5, 0.5, 0.5}},
    .distance = 4,
    .position = {0, 0, 1},
    .has_box = true,
    .corners = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, 1}},
    .world_from_parent = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}};

/* So large that the text about a selection leaves the middle free. */
static void enlarge(struct table *t) {
    t->fake.queue[t->fake.count++] = (struct window_event){.kind = WINDOW_SIZE, .x = 800, .y = 560, .density = 1};
}

/* Clicks in the middle of the picture and processes the child's answer. */
static void pick_ball(struct table *t) {
    click(t, 400, 280);
    CHECK_EQ_INT(step(t), VIEWER_SEND_COMMAND);
    CHECK_EQ_INT(t->viewer.command.kind, COMMAND_PICK);
    CHECK(t->viewer.command.x == 50.5 && t->viewer.command.y == 35.5 && t->viewer.command.up == 0);
    print_news(t, &(struct preview_reply){.kind = REPLY_PICKED, .picked = a_ball});
    CHECK_EQ_INT(step(t), VIEWER_NOTHING); /* the finished picture stays */
    CHECK(t->viewer.edit.selection.kind == SELECTED_NODE && t->viewer.pass.result == RESULT_COMPLETE);
}

/* From the middle of the picture with the left button, or with a tool without one; then a click ends the tool. */
static void drag(struct table *t, double dx, double dy) {
    t->fake.queue[t->fake.count++] = mouse(WINDOW_PRESS, 400, 280);
    for (int i = 1; i <= 2; i++) {
        struct window_event event = mouse(WINDOW_MOVE, 400 + dx * i / 2, 280 + dy * i / 2);
        event.dx = dx / 2;
        event.dy = dy / 2;
        t->fake.queue[t->fake.count++] = event;
    }
    t->fake.queue[t->fake.count++] = mouse(WINDOW_RELEASE, 400 + dx, 280 + dy);
}

static void use_tool(struct table *t, enum window_action tool, double dx, double dy) {
    do_action(&t->fake, tool);
    for (int i = 1; i <= 2; i++) {
        struct window_event event = mouse(WINDOW_MOVE, 400 + dx * i / 2, 280 + dy * i / 2);
        event.dx = dx / 2;
        event.dy = dy / 2;
        t->fake.queue[t->fake.count++] = event;
    }
    t->fake.queue[t->fake.count++] = mouse(WINDOW_PRESS, 400 + dx, 280 + dy);
    t->fake.queue[t->fake.count++] = mouse(WINDOW_RELEASE, 400 + dx, 280 + dy);
}

static void take_change(struct table *t) {
    CHECK_EQ_INT(step(t), VIEWER_SEND_COMMAND);
    CHECK_EQ_INT(t->viewer.command.kind, COMMAND_CHANGE);
    struct preview_reply reply = {.kind = REPLY_CHANGED, .light_count = 1};
    reply.lights[0] = (struct light_info){
        .kind = LIGHT_POINT, .has_position = true, .position = {0, 1, 0}, .colour = {1, 1, 1}, .moves = true};
    print_news(t, &reply);
}

/* The passes after a change, to the finest. */
static void refine(struct table *t) {
    do {
        CHECK_EQ_INT(step(t), VIEWER_SEND_COMMAND);
        CHECK_EQ_INT(t->viewer.command.kind, COMMAND_PASS);
        finish_pass(t, 0.02, false);
    } while (t->viewer.pass.view.plain);
    CHECK_EQ_INT(step(t), VIEWER_NOTHING);
}

TEST(window_clicks_select_and_orbits_turn_about_the_selection) {
    struct table t;
    begin(&t);
    enlarge(&t);
    go_to_the_end(&t);
    pick_ball(&t);
    CHECK(apart(t.viewer.fly_camera.centre, vec3_make(0, 0, 1)) == 0);
    struct vec3 before = t.viewer.fly_camera.pose.position;
    drag(&t, 40, 10);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.camera_moved && apart(t.viewer.fly_camera.pose.position, before) > 0.1);
    CHECK_NEAR(apart(t.viewer.fly_camera.pose.position, vec3_make(0, 0, 1)), apart(before, vec3_make(0, 0, 1)), 1e-9);
    end(&t);
}

/* A step of the wheel asks what is under the mouse before the answer to the click is there. */
TEST(window_selects_what_was_clicked_although_the_wheel_turns) {
    struct table t;
    begin(&t);
    enlarge(&t);
    go_to_the_end(&t);
    click(&t, 400, 280);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.command.kind == COMMAND_PICK && !t.viewer.command.probes);
    double x = t.viewer.command.x;
    t.fake.queue[t.fake.count++] = mouse(WINDOW_MOVE, 300, 250);
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_WHEEL, .y = 1};
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    print_news(&t, &(struct preview_reply){.kind = REPLY_PICKED, .picked = a_ball});
    CHECK(t.viewer.edit.selection.kind == SELECTED_NODE && t.viewer.edit.selection.x == x);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.command.kind == COMMAND_PICK && t.viewer.command.probes);
    print_news(&t, &(struct preview_reply){.kind = REPLY_PICKED});
    CHECK_EQ_INT(t.viewer.edit.selection.kind, SELECTED_NODE);
    end(&t);
}

TEST(window_that_gets_a_request_during_a_fine_pass_goes_on_with_it) {
    struct table t;
    begin(&t);
    enlarge(&t);
    go_to_the_fine_pass(&t);
    atomic_store(&t.viewer.pass.film.tiles[1], FILM_TILE_DONE);
    atomic_store(&t.viewer.pass.film.tiles[2], FILM_TILE_TAKEN);
    click(&t, 400, 280);
    CHECK_EQ_INT(step(&t), VIEWER_STOP_PASS);
    finish_pass(&t, 0.001, true);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK_EQ_INT(t.viewer.command.kind, COMMAND_PICK);
    print_news(&t, &(struct preview_reply){.kind = REPLY_PICKED, .picked = a_ball});
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.command.kind == COMMAND_PASS && !t.viewer.command.view.plain);
    CHECK_EQ_INT(atomic_load(&t.viewer.pass.film.tiles[1]), FILM_TILE_DONE);
    CHECK_EQ_INT(atomic_load(&t.viewer.pass.film.tiles[2]), FILM_TILE_WANTED);
    end(&t);
}

TEST(window_moves_what_is_picked_with_the_mouse_and_undoes_it) {
    struct table t;
    begin(&t);
    enlarge(&t);
    go_to_the_end(&t);
    pick_ball(&t);
    use_tool(&t, DO_MOVE, 40, -20);
    take_change(&t);
    const struct change *change = &t.viewer.command.change;
    CHECK(change->kind == CHANGE_TRANSFORM && change->serial == 2 && t.viewer.command.present);
    CHECK_TEXT(change->name, "ball");
    /* The middle of the box is 5 from the eye; 560 pixels show 2 x 5 x tan 20 degrees there. */
    double pixel = 2 * 5 * tan(20 * M_PI / 180) / 560;
    CHECK_NEAR(change->numbers[3], 40 * pixel, 1e-9);
    CHECK_NEAR(change->numbers[7], 20 * pixel, 1e-9);
    CHECK_NEAR(change->numbers[11], 0, 1e-9);
    CHECK(change->numbers[0] == 1 && t.viewer.edit.steps.count == 1);
    refine(&t);
    CHECK(t.viewer.pass.edited && !t.viewer.camera_moved);
    do_action(&t.fake, DO_UNDO);
    take_change(&t);
    CHECK(!t.viewer.command.present && t.viewer.edit.steps.now.count == 0);
    refine(&t);
    do_action(&t.fake, DO_REDO);
    take_change(&t);
    CHECK(t.viewer.command.present && t.viewer.command.change.numbers[3] > 0);
    end(&t);
}

TEST(window_turns_and_sizes_about_the_middle_of_what_is_picked) {
    struct table t;
    begin(&t);
    enlarge(&t);
    go_to_the_end(&t);
    pick_ball(&t);
    use_tool(&t, DO_TURN, 560, 0); /* the height of the picture: half a turn */
    take_change(&t);
    const double *m = t.viewer.command.change.numbers;
    const double half_turn[12] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0};
    for (int i = 0; i < 12; i++)
        CHECK_NEAR(m[i], half_turn[i], 1e-9);
    refine(&t);
    use_tool(&t, DO_SIZE, 0, -280);
    take_change(&t);
    CHECK_NEAR(t.viewer.command.change.numbers[0], -exp(1), 1e-9);
    CHECK_NEAR(t.viewer.command.change.numbers[5], exp(1), 1e-9);
    CHECK_EQ_INT(t.viewer.edit.steps.count, 2);
    end(&t);
}

TEST(window_deletes_and_adds_nodes_and_lights) {
    struct table t;
    begin(&t);
    enlarge(&t);
    go_to_the_end(&t);
    pick_ball(&t);
    do_action(&t.fake, DO_DELETE);
    take_change(&t);
    CHECK(t.viewer.command.change.kind == CHANGE_GONE && t.viewer.edit.selection.kind == SELECTED_NOTHING);
    refine(&t);
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_ADD, .text = "gr.sphere{}"};
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.command.kind == COMMAND_CHANGE && t.viewer.command.change.kind == CHANGE_ADD &&
          t.viewer.command.more);
    CHECK(strcmp(t.viewer.command.change.call, "gr.sphere{}") == 0 && t.viewer.command.change.serial == 0);
    print_news(&t, &(struct preview_reply){.kind = REPLY_CHANGED});
    take_change(&t); /* and its position */
    CHECK(t.viewer.command.change.kind == CHANGE_TRANSFORM && t.viewer.command.change.serial == UINT32_MAX &&
          !t.viewer.command.more);
    CHECK(t.viewer.edit.selection.kind == SELECTED_NOTHING);
    /* It is selected when the render process has it. */
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.command.kind == COMMAND_PICK && t.viewer.command.node.serial == UINT32_MAX);
    print_news(&t, &(struct preview_reply){.kind = REPLY_PICKED, .picked = a_ball});
    CHECK(t.viewer.edit.selection.kind == SELECTED_NODE);
    refine(&t);
    click(&t, 400, 280 - 560 * 1 / (2 * 5 * tan(20 * M_PI / 180))); /* the light at {0, 1, 0} */
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(t.viewer.edit.selection.kind == SELECTED_LIGHT && t.viewer.edit.selection.light == 1);
    use_tool(&t, DO_MOVE, 28, 0);
    take_change(&t);
    CHECK(t.viewer.command.change.kind == CHANGE_LIGHT && t.viewer.command.change.serial == 1);
    CHECK_NEAR(t.viewer.command.change.numbers[0], 28 * 2 * 5 * tan(20 * M_PI / 180) / 560, 1e-9);
    CHECK(t.viewer.command.change.numbers[3] == 1);
    refine(&t);
    do_action(&t.fake, DO_DELETE);
    take_change(&t);
    CHECK(t.viewer.command.change.kind == CHANGE_DARK);
    end(&t);
}

TEST(window_changes_parts_of_a_material_and_copies_them_to_one_of_its_own) {
    struct table t;
    const double half[3] = {0.5, 0, 0};
    begin(&t);
    enlarge(&t);
    go_to_the_end(&t);
    pick_ball(&t);
    struct change now = viewer_change(&t.viewer, CHANGE_MATERIAL, MATERIAL_PART_KD);
    CHECK(now.numbers[0] == 0.5 && now.numbers[2] == 0.5);
    viewer_set_numbers(&t.viewer, CHANGE_MATERIAL, MATERIAL_PART_REFLECT, 0, half);
    take_change(&t);
    const struct change *change = &t.viewer.command.change;
    CHECK(change->kind == CHANGE_MATERIAL && change->serial == 1 && change->part == MATERIAL_PART_REFLECT);
    refine(&t);
    viewer_make_own_material(&t.viewer);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(change->kind == CHANGE_OWN && change->serial == 2 && change->source == 1 && t.viewer.command.more);
    print_news(&t, &(struct preview_reply){.kind = REPLY_CHANGED});
    take_change(&t);
    CHECK(change->kind == CHANGE_MATERIAL && change->serial == OWN_SERIAL && change->numbers[0] == 0.5);
    CHECK(t.viewer.edit.selection.picked.material_serial == OWN_SERIAL && !t.viewer.edit.selection.picked.can_own);
    refine(&t);
    viewer_undo(&t.viewer, false);
    viewer_undo(&t.viewer, false);
    CHECK(t.viewer.edit.selection.kind == SELECTED_NOTHING && t.viewer.edit.steps.now.count == 1);
    end(&t);
}

TEST(window_goes_up_to_the_node_above_and_down_to_the_operand_below) {
    struct table t;
    struct preview_reply reply = {.kind = REPLY_PICKED, .picked = a_ball};
    begin(&t);
    enlarge(&t);
    go_to_the_end(&t);
    t.fake.queue[t.fake.count++] = mouse(WINDOW_PRESS, 400, 280);
    t.fake.queue[t.fake.count++] = mouse(WINDOW_RELEASE, 400, 280);
    t.fake.queue[1].control = true; /* scrolled to the end */
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.command.kind == COMMAND_PICK && t.viewer.command.up < -1000);
    reply.picked.up = -1;
    reply.picked.levels = 2;
    print_news(&t, &reply);
    do_action(&t.fake, DO_SELECT_OPERAND); /* there are no lines below */
    do_action(&t.fake, DO_SELECT_PARENT);
    do
        CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    while (t.viewer.command.kind == COMMAND_OVERLAY);
    CHECK(t.viewer.command.kind == COMMAND_PICK && t.viewer.command.up == 0 && t.viewer.command.x == 50.5);
    reply.picked.up = 0;
    reply.picked.levels = 1;
    reply.picked.below = 1;
    print_news(&t, &reply);
    do_action(&t.fake, DO_SELECT_OPERAND);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.command.kind == COMMAND_PICK && t.viewer.command.up == -1);
    end(&t);
}

TEST(window_requests_lights_until_it_has_them_all_and_selects_them_by_keys) {
    struct table t;
    begin(&t);
    enlarge(&t);
    struct preview_reply reply = {.kind = REPLY_BUILT, .light_count = 70, .world_from_root = affine_identity()};
    for (int i = 0; i < LIGHTS_PER_MESSAGE; i++)
        reply.lights[i] = (struct light_info){.kind = LIGHT_DIRECTIONAL, .turns = true, .direction = {0, 0, -1}};
    print_news(&t, &reply);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    for (uint32_t first = LIGHTS_PER_MESSAGE; first < 70; first += LIGHTS_PER_MESSAGE) {
        finish_pass(&t, 0.02, false);
        CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
        CHECK(t.viewer.command.kind == COMMAND_LIGHTS && t.viewer.command.first_light == first);
        reply.kind = REPLY_LIGHTS;
        reply.first_light = first;
        print_news(&t, &reply);
        CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    }
    while (t.viewer.command.kind == COMMAND_PASS && t.viewer.pass.view.plain) {
        finish_pass(&t, 0.02, false);
        CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    }
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_WRITE_PICTURE);
    CHECK_EQ_INT(t.viewer.lights.known, 70);
    do_action(&t.fake, DO_PREVIOUS_LIGHT);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(t.viewer.edit.selection.kind == SELECTED_LIGHT && t.viewer.edit.selection.light == 70);
    do_action(&t.fake, DO_NEXT_LIGHT);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK_EQ_INT(t.viewer.edit.selection.light, 1);
    do_action(&t.fake, DO_PREVIOUS_LIGHT);
    use_tool(&t, DO_TURN, 560, 0); /* the height of the picture: half a turn */
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    const struct change *change = &t.viewer.command.change;
    CHECK(change->kind == CHANGE_LIGHT && change->serial == 70 && change->turns && t.viewer.command.first_light == 69);
    CHECK_NEAR(change->numbers[TURN_AT], -1, 1e-9);
    CHECK_NEAR(change->numbers[TURN_AT + 4], 1, 1e-9);
    viewer_copy_selection(&t.viewer); /* with its changed numbers */
    CHECK(t.viewer.edit.selection.kind == SELECTED_LIGHT && t.viewer.edit.selection.light == 71);
    const struct change *copy = &t.viewer.edit.steps.steps[t.viewer.edit.steps.count - 2].after;
    CHECK(copy->kind == CHANGE_ADD_LIGHT && copy->source == 70);
    CHECK(copy[0].number == 0 && t.viewer.edit.steps.steps[t.viewer.edit.steps.count - 1].after.serial == 71);
    end(&t);
}

TEST(window_shows_the_trace_of_the_pixel_under_the_mouse) {
    struct table t;
    begin(&t);
    enlarge(&t);
    go_to_the_end(&t);
    t.fake.queue[t.fake.count++] =
        (struct window_event){.kind = WINDOW_ACTION, .action = DO_PIXEL_TRACE, .x = 8 * 12 + 3, .y = 8 * 60 + 7};
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK_EQ_INT(t.viewer.command.kind, COMMAND_PIXEL_TRACE);
    CHECK(t.viewer.command.x == 12 && t.viewer.command.y == 60 && t.viewer.command.view.own);
    viewer_add_pixel_trace(&t.viewer, "one line\n");
    viewer_add_pixel_trace(&t.viewer, "another\n");
    print_news(&t, &(struct preview_reply){.kind = REPLY_PIXEL_TRACE});
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK_TEXT(t.viewer.trace.text, "one line\nanother\n");
    for (int i = 0; i < 5000; i++) /* more than fits */
        viewer_add_pixel_trace(&t.viewer, "a line of some length\n");
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    do_action(&t.fake, DO_ESCAPE);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK_TEXT(t.viewer.trace.text, "");
    end(&t);
}

TEST(window_shows_light_through_the_tone_function_of_the_script) {
    struct table t;
    begin(&t);
    struct picture_request *request = &t.viewer.request;
    request->settings.tone.curve = TONE_FUNCTION;
    for (int i = 0; i < TONE_ENTRIES; i++)
        request->tone_table.values[i] = (float)fmin(1, tone_table_light(i) / 2);
    go_to_the_fine_pass(&t);
    CHECK(pixels_with(&t, 51) == 0);
    render_tile(&t, 0, 0.4f, FILM_TILE_PASSED + 1);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(pixels_with(&t, 51) > 0);
    end(&t);
}

TEST(window_makes_the_picture_anew_in_another_exposure_and_does_not_write_it_as_the_scripts) {
    struct table t;
    begin(&t);
    enlarge(&t);
    go_to_the_fine_pass(&t);
    do_action(&t.fake, DO_BRIGHTER);
    CHECK_EQ_INT(step(&t), VIEWER_STOP_PASS);
    finish_pass(&t, 0.001, true);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.command.view.exposure == 0.25 && !t.viewer.command.view.plain); /* no coarse pass in between */
    finish_pass(&t, 1, false);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    do_action(&t.fake, DO_DARKER);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    finish_pass(&t, 1, false);
    CHECK_EQ_INT(step(&t), VIEWER_WRITE_PICTURE);
    end(&t);
}

TEST(window_sends_all_edits_again_when_the_scripts_run_again) {
    struct table t;
    struct error error;
    begin(&t);
    enlarge(&t);
    go_to_the_end(&t);
    pick_ball(&t);
    use_tool(&t, DO_MOVE, 40, 0);
    take_change(&t);
    viewer_keep(&t.viewer);
    viewer_detach(&t.viewer);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(viewer_begin(&t.viewer, &t.driver, &(struct viewer_picture){&t.request, t.block, "x.png"}, t.now, &error));
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    struct preview_reply reply = {.kind = REPLY_BUILT};
    print_news(&t, &reply);
    take_change(&t);
    CHECK(t.viewer.command.change.kind == CHANGE_TRANSFORM && t.viewer.command.present);
    refine(&t);
    CHECK(t.viewer.pass.edited);
    end(&t);
}

static void type(struct fake *fake, const char *text) {
    for (; *text; text++)
        fake->queue[fake->count++] = (struct window_event){.kind = WINDOW_TYPE, .typed = *text};
}

/* The change that the render process gets, once it has answered. */
static const double *changed(struct table *t) {
    take_change(t);
    return t->viewer.command.change.numbers;
}

TEST(window_tools_take_typed_numbers_along_an_axis) {
    struct table t;
    begin(&t);
    enlarge(&t);
    go_to_the_end(&t);
    pick_ball(&t);
    do_action(&t.fake, DO_MOVE);
    type(&t.fake, "x2.5\r"); /* g x 2.5 Return */
    const double *m = changed(&t);
    CHECK(m[3] == 2.5 && m[7] == 0 && m[11] == 0 && m[0] == 1 && t.viewer.edit.tool == TOOL_NONE);
    refine(&t);
    do_action(&t.fake, DO_SIZE);
    type(&t.fake, "3\b2y"); /* 2 along y: the axis may come later */
    m = changed(&t);
    CHECK(m[0] == 1 && m[5] == 2 && m[10] == 1);
    CHECK(strstr(t.fake.state.tool, "Size along y 2") && t.fake.state.types);
    refine(&t);
    do_action(&t.fake, DO_ESCAPE); /* takes it back, and keeps the selection */
    m = changed(&t);
    CHECK(m[5] == 1 && m[3] == 2.5 && t.viewer.edit.selection.kind == SELECTED_NODE);
    refine(&t);
    do_action(&t.fake, DO_TURN);
    type(&t.fake, "z-90\r");
    m = changed(&t);
    CHECK_NEAR(m[1], 1, 1e-12);
    CHECK_NEAR(m[4], -1, 1e-12);
    CHECK_EQ_INT(t.viewer.edit.steps.at, 2);
    end(&t);
}

/* The picture shows 2 x 5 x tan 20 degrees in 560 pixels at the middle of the ball; a handle is 90 pixels long. */
TEST(window_handles_move_turn_and_scale_along_their_axis_only) {
    struct table t;
    const double pixel = 2 * 5 * tan(20 * M_PI / 180) / 560;
    begin(&t);
    enlarge(&t);
    go_to_the_end(&t);
    pick_ball(&t);
    uint32_t colours = 0;
    for (uint32_t i = 0; i < t.fake.state.line_count; i++)
        colours |= 1u << t.fake.state.lines[i].colour;
    CHECK((colours >> LINE_COLOUR_X & 7) == 7);
    struct window_event events[] = {mouse(WINDOW_PRESS, 400 + 60, 280), mouse(WINDOW_MOVE, 400 + 100, 280 + 30),
                                    mouse(WINDOW_RELEASE, 400 + 100, 280 + 30)};
    events[1].dx = 40;
    events[1].dy = 30; /* which has no effect */
    memcpy(t.fake.queue, events, sizeof events);
    t.fake.count = 3;
    const double *m = changed(&t);
    CHECK_NEAR(m[3], 40 * pixel, 1e-9);
    CHECK(m[7] == 0 && m[11] == 0 && t.viewer.edit.tool == TOOL_NONE && !t.viewer.camera_moved);
    refine(&t);
    do_action(&t.fake, DO_UNDO);
    (void)changed(&t);
    refine(&t);
    /* Beyond the arrow upwards: scales along y. */
    struct window_event size[] = {mouse(WINDOW_PRESS, 400, 280 - 105), mouse(WINDOW_MOVE, 400, 280 - 155),
                                  mouse(WINDOW_RELEASE, 400, 280 - 155)};
    size[1].dy = -50;
    memcpy(t.fake.queue, size, sizeof size);
    t.fake.count = 3;
    m = changed(&t);
    CHECK_NEAR(m[5], exp(1), 1e-6);
    CHECK(m[0] == 1 && m[10] == 1);
    refine(&t);
    do_action(&t.fake, DO_UNDO);
    (void)changed(&t);
    refine(&t);
    /* A quarter about z lies between x and y: an eighth of a turn along it. */
    double r = 0.6 * 90, s = r * sqrt(0.5);
    struct window_event turn[] = {mouse(WINDOW_PRESS, 400 + s, 280 - s), mouse(WINDOW_MOVE, 400, 280 - r),
                                  mouse(WINDOW_RELEASE, 400, 280 - r)};
    turn[1].dx = -s;
    turn[1].dy = s - r;
    memcpy(t.fake.queue, turn, sizeof turn);
    t.fake.count = 3;
    m = changed(&t);
    CHECK_NEAR(m[0], cos(M_PI / 4), 1e-9);
    CHECK_NEAR(m[4], sin(M_PI / 4), 1e-9);
    end(&t);
}

/* The cube is in the upper right corner; the middle of a face looks along its axis. */
TEST(window_turns_to_the_face_of_the_view_cube_that_is_clicked) {
    struct table t;
    begin(&t);
    enlarge(&t);
    go_to_the_end(&t);
    viewer_turn(&t.viewer, vec3_make(0, 1, 0), 90); /* nothing is selected: it does nothing */
    CHECK_EQ_INT(t.viewer.edit.steps.count, 0);
    fly_camera_orbit(&t.viewer.fly_camera, 0.2, 0.1);
    viewer_change_view(&t.viewer);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    finish_pass(&t, 0.02, false);
    struct camera_frame frame;
    CHECK(viewer_camera_frame(&t.viewer, &frame));
    for (int axis = 0; axis < 3; axis++) {
        struct vec3 a = {axis == 0, axis == 1, axis == 2}, toward = vec3_negate(frame.forward);
        double sign = vec3_dot(a, toward) > 0 ? 1 : -1;
        double x = 800 - 46 + 22 * sign * vec3_dot(a, frame.unit_right),
               y = 46 + 22 * sign * vec3_dot(a, frame.unit_down);
        CHECK(viewer_click_cube(&t.viewer, x, y));
        struct camera camera = fly_camera_current(&t.viewer.fly_camera);
        CHECK_NEAR(apart(camera.view, vec3_scale(a, -sign)), 0, 1e-9);
    }
    CHECK(!viewer_click_cube(&t.viewer, 800 - 46, 120) && !viewer_click_cube(&t.viewer, 400, 280));
    end(&t);
}

TEST(window_offers_a_changed_file_when_the_picture_has_taken_long) {
    struct table t;
    begin(&t);
    go_to_the_end(&t);
    CHECK(!viewer_delays_change(&t.viewer, t.now) && !viewer_delays_change(&t.viewer, t.now + 1000));
    viewer_end(&t.viewer);
    mem_free(t.block);
    begin(&t);
    go_to_the_fine_pass(&t);
    finish_pass(&t, 60, false);
    CHECK_EQ_INT(step(&t), VIEWER_WRITE_PICTURE);
    CHECK(viewer_delays_change(&t.viewer, t.now + 1));
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    t.now += 0.3;
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(t.fake.state.changed);
    do_action(&t.fake, DO_RENDER);
    CHECK_EQ_INT(step(&t), VIEWER_RUN_AGAIN);
    CHECK(!t.viewer.window.changed);
    end(&t);
}
