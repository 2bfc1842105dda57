/* The window: camera flights by quaternions, the choice of the next pass, and the program itself if a virtual display
 * (Xvfb) and a tool that presses keys (xdotool) are installed. */
#define _GNU_SOURCE
#include "base/mem.h"
#include "render/render.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "viewer/viewer_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

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
    fly_camera_save(&fly_camera, 3);
    struct vec3 layout = fly_camera.pose.position;
    fly_camera.down[FLY_BACK] = true;
    CHECK(fly_camera_step(&fly_camera, 2));
    CHECK(!fly_camera_recall(&fly_camera, 4) && fly_camera_recall(&fly_camera, 3));
    CHECK_NEAR(apart(fly_camera.pose.position, layout), 0, 0);
}

/* A window without a screen: the test supplies the user's input. */
struct fake {
    struct window_event queue[16];
    int count, shown;
    bool open, grabbed;
    char title[1024];
};

static bool fake_open(void *context, uint32_t width, uint32_t height, const char *title, struct error *error) {
    struct fake *fake = context;
    (void)error;
    CHECK(width == 100 && height == 70 && title);
    return fake->open = true;
}
static void fake_show(void *context, const struct window_content *frame) {
    struct fake *fake = context;
    CHECK(frame->picture && frame->width == 100 && frame->height == 70);
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
static void fake_title(void *context, const char *text) {
    struct fake *fake = context;
    CHECK(text[0] != '\0');
    (void)snprintf(fake->title, sizeof fake->title, "%s", text);
}
static void fake_grab(void *context, bool on) {
    struct fake *fake = context;
    fake->grabbed = on;
}
static void fake_nothing(void *context) {
    struct fake *fake = context;
    fake->open = false;
}

static void key(struct fake *fake, int code, bool down) {
    fake->queue[fake->count++] = (struct window_event){.kind = WINDOW_KEY, .key = code, .down = down};
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
    CHECK(t->viewer.pass.view.divide == 16 && t->viewer.pass.view.plain && t->viewer.pass.view.own);
}

static void begin(struct table *t) {
    struct error error;
    size_t bytes;
    *t = (struct table){.now = 100,
                        .request = {.full_width = 100,
                                    .full_height = 70,
                                    .width = 100,
                                    .height = 70,
                                    .camera = {{0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 40}}};
    t->driver = (struct window_driver){.context = &t->fake,
                                       .open = fake_open,
                                       .show = fake_show,
                                       .poll = fake_poll,
                                       .title = fake_title,
                                       .grab = fake_grab,
                                       .full_screen = fake_nothing,
                                       .close = fake_nothing};
    CHECK(film_size(100, 70, stage_record(INTEGRATOR_WHITTED), &bytes, &error));
    t->block = mem_alloc_zero(1, bytes);
    CHECK(
        viewer_begin(&t->viewer, &t->driver, &(struct viewer_picture){&t->request, t->block, "x.png"}, t->now, &error));
    t->fake.queue[t->fake.count++] = (struct window_event){.kind = WINDOW_SIZE, .x = 400, .y = 280, .density = 1};
    build(t);
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
    CHECK(t.viewer.display.fits_window); /* its images are new */
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

/* Up to the script's complete picture. */
static void go_to_the_end(struct table *t) {
    finish_pass(t, 0.02, false);
    CHECK_EQ_INT(step(t), VIEWER_SEND_COMMAND);
    CHECK(t->viewer.pass.view.plain && t->viewer.pass.view.divide == 4 && t->viewer.pass.view.own);
    CHECK_EQ_INT(step(t), VIEWER_NOTHING);
    finish_pass(t, 0.1, false);
    CHECK_EQ_INT(step(t), VIEWER_SEND_COMMAND);
    CHECK(!t->viewer.pass.view.plain && t->viewer.pass.view.divide == 1 && t->viewer.pass.view.own);
    finish_pass(t, 1, false);
    CHECK_EQ_INT(step(t), VIEWER_WRITE_PICTURE);
    CHECK_EQ_INT(step(t), VIEWER_NOTHING);
}

TEST(window_shows_coarse_passes_first_and_writes_the_picture_of_the_script_once) {
    struct table t;
    begin(&t);
    CHECK_EQ_INT(t.viewer.pass.film.width, 7);
    CHECK_EQ_INT(t.viewer.pass.film.height, 5);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    go_to_the_end(&t);
    CHECK(t.fake.shown >= 3);
    key(&t.fake, 'r', true);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.pass.view.divide == 16 && t.viewer.pass.view.own);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    end(&t);
}

TEST(window_renders_coarse_passes_while_the_camera_moves_and_refines_after) {
    struct table t;
    begin(&t);
    go_to_the_end(&t);
    key(&t.fake, WINDOW_ARROW_UP, true);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING); /* no time has passed yet */
    for (int i = 0; i < 5; i++) {
        CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
        CHECK(t.viewer.pass.view.plain && t.viewer.pass.view.divide > 1 && !t.viewer.pass.view.own);
        CHECK(t.viewer.pass.view.camera.eye.z < 5);
        CHECK_EQ_INT(step(&t), VIEWER_NOTHING); /* a coarse pass is worth its end */
        finish_pass(&t, 0.03, false);
    }
    key(&t.fake, WINDOW_ARROW_UP, false);
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
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    finish_pass(&t, 0.1, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(!t.viewer.pass.view.plain);
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_WHEEL, .y = 2};
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
    key(&t.fake, WINDOW_ARROW_LEFT, true);
    (void)step(&t);
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
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(!t.viewer.pass.view.plain);
    /* A tile is shown again after each pass. */
    render_tile(&t, 0, 1, FILM_TILE_PASSED + 1);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    int whole = pixels_with(&t, 255);
    CHECK(whole > 0);
    render_tile(&t, 0, 0.2f, FILM_TILE_PASSED + 2);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(pixels_with(&t, 255) == 0 && pixels_with(&t, 51) == whole);
    /* The view changes: tiles that are finished until the pass has stopped are not shown. */
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_WHEEL, .y = 2};
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

TEST(window_keys_fly_only_while_the_mouse_turns_the_camera) {
    struct table t;
    begin(&t);
    go_to_the_end(&t);
    key(&t.fake, 's', true);
    CHECK_EQ_INT(step(&t), VIEWER_SAVE_IMAGE);
    key(&t.fake, 'v', true);
    CHECK_EQ_INT(step(&t), VIEWER_SAVE_CAMERA);
    key(&t.fake, WINDOW_SPACE, true);
    key(&t.fake, 's', true);
    (void)step(&t);
    CHECK(t.fake.grabbed);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.pass.view.camera.eye.z > 5);
    key(&t.fake, WINDOW_ESCAPE, true);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(!t.fake.grabbed && !t.viewer.fly_camera.down[FLY_BACK]);
    key(&t.fake, 'q', true);
    CHECK_EQ_INT(step(&t), VIEWER_QUIT);
    end(&t);
}

/* The program in a real window. */

static int shell(const char *line) {
    return test_run_shell(line, ">out.txt 2>err.txt");
}

static void need_display(void) {
    test_need_window();
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/scene.lua", test_folder());
    test_write_text(path,
                    "local r = gr.node('root')\n"
                    "r:add_child(gr.geometry('b', gr.sphere(gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20))))\n"
                    "gr.render(r, 'out.png', 200, 150, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2},\n"
                    "  {gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0})})\n");
    (void)snprintf(path, sizeof path, "%s/wait.sh", test_folder());
    test_write_text(path, "for i in $(seq 3000); do eval \"$1\" && exit 0; sleep 0.05; done; exit 1\n");
}

static void gives(const char *line, int status) {
    int got = shell(line);
    char *said = test_read_file(test_path("err.txt"), NULL);
    if (got != status)
        test_fail(__FILE__, __LINE__, "%s\nstatus %d, not %d:\n%s", line, got, status, said ? said : "");
    free(said);
}

TEST(window_of_the_program_makes_the_picture_of_the_program_without) {
    need_display();
    gives("$gray scene.lua -o whole.png; "
          "xvfb-run -a sh -c '$gray -gui scene.lua & pid=$!; sh wait.sh \"test -s out.png\" || exit 9; sleep 0.2; "
          "xdotool key v; sh wait.sh \"test -s out-view1.lua\" || exit 8; "
          "xdotool keydown Right sleep 0.3 keyup Right; sleep 0.5; "
          "sh wait.sh \"xdotool search --name ready\" || exit 6; xdotool key s key v; "
          "sh wait.sh \"test -s out-view1.png -a -s out-view2.lua\" || exit 7; xdotool key q; wait $pid' && "
          "cmp out.png whole.png && ! cmp -s out-view1.png whole.png",
          0);
    /* A file saved at another position: required by the scene, it gives the picture that was saved there. */
    gives("{ echo \"require 'out-view2'\"; cat scene.lua; } >again.lua; $gray again.lua -o again.png && "
          "cmp again.png out-view1.png",
          0);
    /* A camera saved before any movement is the script's, in every digit. */
    gives("sed -e \"s/{0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40/c.eye, c.view, c.up, c.fov/\" -e \"1i local c = "
          "dofile('out-view1.lua')\" scene.lua >again.lua; $gray again.lua -o again.png && cmp again.png whole.png",
          0);
}

TEST(window_that_is_closed_early_leaves_no_picture) {
    need_display();
    gives(
        "xvfb-run -a sh -c '$gray -gui -full -ss 40 scene.lua & pid=$!; "
        "sh wait.sh \"xdotool search --name scene\\|out >/dev/null\" || exit 9; sleep 0.3; xdotool key q; wait $pid'; "
        "status=$?; test -e out.png && exit 1; exit $status",
        130);
}

TEST(window_that_watches_shows_errors_keeps_the_camera_and_recovers) {
    need_display();
    gives("cp scene.lua keep.lua; xvfb-run -a sh -c '$gray -gui --watch scene.lua 2>said.txt & pid=$!; "
          "sh wait.sh \"test -s out.png\" || exit 9; cp out.png first.png; "
          "xdotool keydown Right sleep 0.2 keyup Right; sleep 0.2; xdotool key v; "
          "sh wait.sh \"test -s out-view1.lua\" || exit 8; "
          "echo \"gr.no_such_thing()\" >new.lua; mv new.lua scene.lua; "
          "sh wait.sh \"grep -q no_such_thing said.txt\" || exit 7; "
          "sh wait.sh \"xdotool search --name no_such_thing\" || exit 6; cmp out.png first.png || exit 5; "
          "sed s/0.8,/0.1,/ keep.lua >new.lua; mv new.lua scene.lua; "
          "sh wait.sh \"xdotool search --name out.png.*ready\" || exit 4; xdotool key v; "
          "sh wait.sh \"test -s out-view2.lua\" || exit 3; cmp out-view1.lua out-view2.lua || exit 2; "
          "xdotool key Home; sh wait.sh \"! cmp -s out.png first.png\" || exit 1; xdotool key q; wait $pid'",
          0);
    gives("$gray scene.lua -o whole.png && cmp out.png whole.png", 0);
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

TEST(window_menu_renders_again_and_quits_by_clicks_that_do_not_turn_the_camera) {
    struct table t;
    begin(&t);
    go_to_the_end(&t);
    click(&t, 10, 6); /* Render */
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.pass.view.divide == 16 && t.viewer.pass.view.own && !t.viewer.input.pressed);
    /* Pressed on a button and released elsewhere: no click. */
    t.fake.queue[t.fake.count++] = mouse(WINDOW_PRESS, 60, 6);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    t.fake.queue[t.fake.count++] = mouse(WINDOW_MOVE, 200, 200);
    t.fake.queue[t.fake.count++] = mouse(WINDOW_RELEASE, 200, 200);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(!t.viewer.camera_moved);
    click(&t, 60, 6); /* Quit */
    CHECK_EQ_INT(step(&t), VIEWER_QUIT);
    end(&t);
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
    CHECK_EQ_INT(t.viewer.window.panel.canvas.scale, 2); /* letters of the same visible size as before */
    CHECK(t.viewer.window.panel.canvas.width == 1600 && t.viewer.window.panel.canvas.height == 700);
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
    CHECK(t.viewer.pass.view.plain && strstr(t.fake.title, "(coarse)") && !strstr(t.fake.title, "left"));
    for (int i = 0; i < 9 && t.viewer.pass.view.plain; i++) {
        finish_pass(&t, 1, false);
        CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    }
    control.progress_estimate.begun = t.now - 30;
    progress_estimate_report(&control.progress_estimate, 1, 3, t.now);
    t.now += 10;
    (void)step(&t);
    CHECK(strstr(t.fake.title, "25 %, 1 min 20 s left"));
    end(&t);
}

TEST(window_shows_how_far_building_is_and_errors) {
    struct table t;
    struct control control = {.build_step = 3, .build_done = 250};
    begin(&t);
    t.viewer.window.control = &control;
    t.now += 1;
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(strstr(t.fake.title, "building, step 3: 25 %") != NULL);
    control.build_step = 0;
    finish_pass(&t, 1, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(strstr(t.fake.title, "triangles") && strstr(t.fake.title, "rays/s") && strstr(t.fake.title, "frames/s"));
    viewer_show_message(&t.viewer, "scene.lua:3: no such thing\nstack traceback");
    (void)step(&t);
    CHECK_TEXT(t.fake.title, "scene.lua:3: no such thing");
    viewer_detach(&t.viewer);
    (void)step(&t);
    key(&t.fake, 'r', true); /* there is nothing to render */
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    key(&t.fake, 's', true); /* but the displayed picture can be saved */
    CHECK_EQ_INT(step(&t), VIEWER_SAVE_IMAGE);
    end(&t);
}

TEST(canvas_letters_stay_inside_their_cell_and_the_canvas) {
    enum { W = 40, H = 30 };
    static uint8_t rgba[4 * W * H];
    const struct canvas canvas = {rgba, W, H, 1};
    const struct canvas_colour colour = {1, 2, 3, 255};
    for (int c = 33; c < 127; c++) {
        const char text[2] = {(char)c, '\0'};
        int dots = 0;
        canvas_clear(&canvas);
        canvas_text(&canvas, 10, 10, text, colour);
        for (int i = 0; i < W * H; i++) {
            bool set = rgba[4 * i + 3] != 0;
            dots += set;
            CHECK(!set || (i % W >= 10 && i % W < 15 && i / W >= 10 && i / W < 17));
        }
        CHECK(dots >= 2 && dots < 30);
    }
    CHECK_EQ_INT(canvas_text_width(&canvas, "a\xc3\xa4?"), 18); /* one cell for each character */
    canvas_text(&canvas, -3, -3, "ends", colour);
    canvas_text(&canvas, W - 2, H - 2, "ends", colour);
    canvas_line(&canvas, -1e9, 5, 1e9, 5, colour);
    canvas_line(&canvas, -50, -50, 90, 90, colour);
    CHECK_EQ_INT(rgba[4 * (20 * W + 20) + 3], 255);
}

TEST(panel_sliders_follow_the_mouse_that_holds_them_and_stop_at_their_ends) {
    static uint8_t rgba[4 * 100 * 20];
    struct panel panel = {.canvas = {rgba, 100, 20, 1}};
    const struct panel_slider slider = {10, 2, 80, 0, 1, {9, 9, 9, 255}};
    double value = 0.5;
    panel.mouse_x = 30;
    panel.mouse_y = 5;
    panel_begin(&panel);
    CHECK(!panel_slider(&panel, &slider, &value)); /* the mouse is over it, no button is pressed */
    panel_end(&panel);
    panel.down = panel.pressed = true;
    panel_begin(&panel);
    CHECK(panel_slider(&panel, &slider, &value));
    panel_end(&panel);
    CHECK_NEAR(value, 0.25, 1e-12);
    panel.mouse_x = 500;
    panel.mouse_y = 19;
    panel_begin(&panel);
    CHECK(panel_slider(&panel, &slider, &value));
    panel_end(&panel);
    CHECK_NEAR(value, 1, 0);
    panel.down = false;
    panel.released = true;
    panel_begin(&panel);
    CHECK(!panel_slider(&panel, &slider, &value));
    panel_end(&panel);
    panel.mouse_x = 30;
    panel_begin(&panel);
    CHECK(!panel_slider(&panel, &slider, &value));
    panel_end(&panel);
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

TEST(window_that_gets_a_request_during_a_fine_pass_goes_on_with_it) {
    struct table t;
    begin(&t);
    enlarge(&t);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(!t.viewer.pass.view.plain);
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
    key(&t.fake, 'm', true);
    drag(&t, 40, -20);
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
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_KEY, .key = 'z', .down = true, .control = true};
    take_change(&t);
    CHECK(!t.viewer.command.present && t.viewer.edit.steps.now.count == 0);
    refine(&t);
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_KEY, .key = 'y', .down = true, .control = true};
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
    key(&t.fake, 't', true);
    drag(&t, 560, 0); /* the height of the picture: half a turn */
    take_change(&t);
    const double *m = t.viewer.command.change.numbers;
    const double half_turn[12] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0};
    for (int i = 0; i < 12; i++)
        CHECK_NEAR(m[i], half_turn[i], 1e-9);
    refine(&t);
    key(&t.fake, 'z', true);
    drag(&t, 0, -280);
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
    key(&t.fake, WINDOW_DELETE, true);
    take_change(&t);
    CHECK(t.viewer.command.change.kind == CHANGE_GONE && t.viewer.edit.selection.kind == SELECTED_NOTHING);
    refine(&t);
    click(&t, 101, 20); /* Sphere */
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.command.kind == COMMAND_CHANGE && t.viewer.command.change.kind == CHANGE_ADD &&
          t.viewer.command.more);
    CHECK(t.viewer.command.change.added == ADDED_SPHERE && t.viewer.command.change.serial == 0);
    print_news(&t, &(struct preview_reply){.kind = REPLY_CHANGED});
    take_change(&t); /* and its position */
    CHECK(t.viewer.command.change.kind == CHANGE_TRANSFORM && t.viewer.command.change.serial == UINT32_MAX &&
          !t.viewer.command.more);
    CHECK(t.viewer.edit.tool == TOOL_MOVE && t.viewer.edit.selection.picked.serial == UINT32_MAX);
    refine(&t);
    click(&t, 400, 280 - 560 * 1 / (2 * 5 * tan(20 * M_PI / 180))); /* the light at {0, 1, 0} */
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(t.viewer.edit.selection.kind == SELECTED_LIGHT && t.viewer.edit.selection.light == 1);
    drag(&t, 28, 0);
    take_change(&t);
    CHECK(t.viewer.command.change.kind == CHANGE_LIGHT && t.viewer.command.change.serial == 1);
    CHECK_NEAR(t.viewer.command.change.numbers[0], 28 * 2 * 5 * tan(20 * M_PI / 180) / 560, 1e-9);
    CHECK(t.viewer.command.change.numbers[3] == 1);
    refine(&t);
    key(&t.fake, WINDOW_DELETE, true);
    take_change(&t);
    CHECK(t.viewer.command.change.kind == CHANGE_DARK);
    end(&t);
}

TEST(window_changes_parts_of_a_material_and_copies_them_to_one_of_its_own) {
    struct table t;
    const double half[3] = {0.5, 0, 0};
    double now[3];
    begin(&t);
    enlarge(&t);
    go_to_the_end(&t);
    pick_ball(&t);
    viewer_material_now(&t.viewer, MATERIAL_PART_KD, now);
    CHECK(now[0] == 0.5 && now[2] == 0.5);
    viewer_set_material(&t.viewer, MATERIAL_PART_REFLECT, half);
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
    key(&t.fake, WINDOW_PAGE_DOWN, true); /* there are no lines below */
    key(&t.fake, WINDOW_PAGE_UP, true);
    do
        CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    while (t.viewer.command.kind == COMMAND_OVERLAY);
    CHECK(t.viewer.command.kind == COMMAND_PICK && t.viewer.command.up == 0 && t.viewer.command.x == 50.5);
    reply.picked.up = 0;
    reply.picked.levels = 1;
    reply.picked.below = 1;
    print_news(&t, &reply);
    key(&t.fake, WINDOW_PAGE_DOWN, true);
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
    key(&t.fake, 'i', true);
    key(&t.fake, ',', true);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK(t.viewer.edit.selection.kind == SELECTED_LIGHT && t.viewer.edit.selection.light == 70 &&
          t.viewer.lights.listed);
    key(&t.fake, '.', true);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK_EQ_INT(t.viewer.edit.selection.light, 1);
    key(&t.fake, ',', true);
    key(&t.fake, 't', true);
    drag(&t, 560, 0); /* the height of the picture: half a turn */
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    const struct change *change = &t.viewer.command.change;
    CHECK(change->kind == CHANGE_LIGHT && change->serial == 70 && change->turns && t.viewer.command.first_light == 69);
    CHECK_NEAR(change->numbers[TURN_AT], -1, 1e-9);
    CHECK_NEAR(change->numbers[TURN_AT + 4], 1, 1e-9);
    CHECK_NEAR(viewer_light(&t.viewer, 70)->direction.z, 1, 1e-9);
    viewer_add_node(&t.viewer, ADDED_COPY); /* with its changed numbers */
    CHECK(t.viewer.edit.selection.light == 71 && t.viewer.lights.count == 71 && t.viewer.edit.tool == TOOL_TURN);
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
    t.fake.queue[t.fake.count++] = mouse(WINDOW_MOVE, 8 * 12 + 3, 8 * 60 + 7);
    key(&t.fake, 'p', true);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK_EQ_INT(t.viewer.command.kind, COMMAND_PIXEL_TRACE);
    CHECK(t.viewer.command.x == 12 && t.viewer.command.y == 60 && t.viewer.command.view.own);
    viewer_add_pixel_trace(&t.viewer, "one line\n");
    viewer_add_pixel_trace(&t.viewer, "another\n");
    print_news(&t, &(struct preview_reply){.kind = REPLY_PIXEL_TRACE});
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK_TEXT(t.viewer.trace.text, "one line\nanother\n");
    key(&t.fake, WINDOW_PAGE_DOWN, true); /* past its end: it starts again */
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    CHECK_EQ_INT(t.viewer.trace.line, 0);
    for (int i = 0; i < 5000; i++) /* more than fits */
        viewer_add_pixel_trace(&t.viewer, "a line of some length\n");
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    key(&t.fake, WINDOW_ESCAPE, true);
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
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
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
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    key(&t.fake, '=', true);
    CHECK_EQ_INT(step(&t), VIEWER_STOP_PASS);
    finish_pass(&t, 0.001, true);
    CHECK_EQ_INT(step(&t), VIEWER_SEND_COMMAND);
    CHECK(t.viewer.command.view.exposure == 0.25 && !t.viewer.command.view.plain); /* no coarse pass in between */
    finish_pass(&t, 1, false);
    CHECK_EQ_INT(step(&t), VIEWER_NOTHING);
    key(&t.fake, '-', true);
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
    key(&t.fake, 'm', true);
    drag(&t, 40, 0);
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

static const char editing[] =
    "xvfb-run -a -s '-screen 0 900x700x24' sh -c '$gray -gui --size 320x240 scene.lua & pid=$!; "
    "sh wait.sh \"test -s out.png\" || exit 20; cp out.png first.png; sh wait.sh \"xdotool search --name ready\" || "
    "exit 19; xdotool mousemove 450 350 click 1 sleep 0.3 key m mousemove 450 350 mousedown 1 mousemove 460 340 sleep "
    "0.1 mousemove 480 330 sleep 0.1 mouseup 1 sleep 0.2 key s; sh wait.sh \"test -s out-view1.png\" || exit 18; "
    "cmp -s out-view1.png first.png && exit 17; "
    "xdotool key ctrl+z sleep 0.3; sh wait.sh \"xdotool search --name ready\" || exit 16; "
    "xdotool key s; sh wait.sh \"test -s out-view2.png\" || exit 15; cmp out-view2.png first.png || exit 14; "
    "xdotool key ctrl+y sleep 0.3 key equal sleep 0.1 key Escape keydown Up sleep 0.2 keyup Up sleep 0.3; "
    "sh wait.sh \"xdotool search --name ready\" || exit 13; "
    "xdotool key s key c; sh wait.sh \"test -s out-changes1.lua\" || exit 12; "
    "sh wait.sh \"test -s out-view3.png\" || exit 11; xdotool key q; wait $pid'";

TEST(window_that_moves_a_node_saves_changes_that_give_the_same_bytes) {
    need_display();
    gives(editing, 0);
    gives("{ echo \"require \\\"out-changes1\\\"\"; cat scene.lua; } >again.lua; $gray --size 320x240 again.lua -o "
          "again.png && cmp again.png out-view3.png && ! cmp -s again.png first.png",
          0);
    gives("cat out-changes1.lua >&2; grep change_node out-changes1.lua && grep change_view out-changes1.lua && grep "
          "change_exposure "
          "out-changes1.lua",
          0);
}

TEST(window_that_is_resized_and_looked_about_in_shows_the_same_picture_at_home) {
    need_display();
    gives("xvfb-run -a -s '-screen 0 900x700x24' sh -c '$gray -gui scene.lua & pid=$!; "
          "sh wait.sh \"test -s out.png\" || exit 20; cp out.png first.png; "
          "xdotool search --name out.png windowsize 520 300 sleep 0.2 windowsize 170 400 sleep 0.2 windowsize 700 500; "
          "xdotool sleep 0.2 key Tab key f sleep 0.3 key f sleep 0.2 key ctrl+1 click 4 click 4 sleep 0.2 key "
          "bracketright "
          "sleep 0.1 key l sleep 0.1 key 1 sleep 0.3 click 5 sleep 0.2; "
          "sh wait.sh \"xdotool search --name ready\" || exit 19; xdotool key s; "
          "sh wait.sh \"test -s out-view1.png\" || exit 18; cmp -s out-view1.png first.png && exit 17; "
          "xdotool key Home sleep 0.3; sh wait.sh \"xdotool search --name ready\" || exit 16; xdotool key s; "
          "sh wait.sh \"test -s out-view2.png\" || exit 15; cmp out-view2.png first.png || exit 14; "
          "xdotool key q; wait $pid'",
          0);
}

/* The only unit of X11 is the pixel. */
TEST(window_on_a_screen_of_high_density_has_larger_letters) {
    need_display();
    gives("xvfb-run -a -s '-screen 0 900x700x24' sh -c 'for density in 1 2; do rm -f out.png; "
          "GDK_SCALE=$density $gray -gui --verbose --progress=none scene.lua 2>said.txt & pid=$!; "
          "sh wait.sh \"test -s out.png && grep -q density.$density, said.txt\" || exit 9; "
          "sh wait.sh \"xdotool search --name ready\" || exit 8; xdotool search --name ready windowsize 600 450; "
          "sh wait.sh \"grep -q 600x450.pixels,.density.$density,.letters.of.$density said.txt\" || exit 7; "
          "xdotool key q; wait $pid; done'",
          0);
}

TEST(window_of_the_program_plays_pauses_and_grows) {
    need_display();
    gives("{ sed /gr.render/,\\$d scene.lua; echo \"gr.frames{count = 9, loop = true, pure = true, draw = function(t) "
          "return "
          "{node = r, file = 'f.##.png', width = 200, height = 150, eye = {t, 0, 6}, view = {0, 0, -1}} end}\"; } "
          ">anim.lua; "
          "xvfb-run -a -s '-screen 0 900x700x24' sh -c '$gray -gui --progress=none anim.lua & pid=$!; "
          "sh wait.sh \"xdotool search --name playing\" || exit 20; xdotool key k; "
          "sh wait.sh \"xdotool search --name ready..frame\" || exit 19; xdotool key h; "
          "sh wait.sh \"xdotool search --name ready..frame\" || exit 18; "
          "xdotool search --name ready windowsize 600 450; sh wait.sh \"xdotool search --name enlarging\\\\|ready\" || "
          "exit 17; "
          "xdotool key s; sh wait.sh \"ls f.*-view1.png\" || exit 16; xdotool key q; wait $pid'",
          0);
    gives("name=$(ls f.*-view1.png) && number=${name#f.} && number=${number%-view1.png} && "
          "$gray -q anim.lua --frames $number-$number -o whole.png && cmp whole.png $name && ! ls f.??.png",
          0);
}
