/* The window: walking by quaternions, what is rendered next while people look, and, where there are a display without a
 * screen (Xvfb) and something that presses keys (xdotool), the program itself. */
#define _GNU_SOURCE
#include "app/live.h"
#include "base/mem.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static struct walk some_walk(void) {
    struct walk walk;
    const struct camera camera = {{1, 2, 3}, {1, -0.5, -2}, {0, 1, 0}, 50};
    const struct box bounds = {{-4, -4, -4}, {4, 4, 4}};
    walk_begin(&walk, &camera, &bounds);
    return walk;
}

static double apart(struct vec3 a, struct vec3 b) {
    return vec3_length(vec3_sub(a, b));
}

TEST(walk_begins_with_the_camera_of_the_script) {
    struct walk walk = some_walk();
    struct camera camera = walk_camera(&walk);
    CHECK_NEAR(apart(camera.eye, vec3_make(1, 2, 3)), 0, 0);
    CHECK_NEAR(apart(camera.view, vec3_normalize(vec3_make(1, -0.5, -2))), 0, 1e-15);
    CHECK_NEAR(vec3_dot(camera.view, camera.up), 0, 1e-15);
    CHECK(camera.up.y > 0);
    CHECK_NEAR(camera.fov, 50, 0);
}

TEST(walk_keeps_a_proper_orientation_through_a_million_turns) {
    struct walk walk = some_walk();
    struct test_random random = {3};
    for (int i = 0; i < 1000000; i++)
        walk_look(&walk, test_uniform(&random, -0.2, 0.2), test_uniform(&random, -0.2, 0.2));
    struct camera camera = walk_camera(&walk);
    CHECK_NEAR(vec3_length(camera.view), 1, 1e-12);
    CHECK_NEAR(vec3_length(camera.up), 1, 1e-12);
    CHECK_NEAR(vec3_dot(camera.view, camera.up), 0, 1e-12);
}

TEST(walk_looks_straight_up_and_over_without_trouble) {
    struct walk walk;
    const struct camera camera = {{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 90};
    const struct box bounds = {{-1, -1, -1}, {1, 1, 1}};
    walk_begin(&walk, &camera, &bounds);
    for (int i = 1; i <= 36; i++) { /* ten degrees a step, once round */
        walk_look(&walk, 0, -10.0 / 90);
        double a = i * 10 * M_PI / 180;
        CHECK_NEAR(apart(walk_camera(&walk).view, vec3_make(0, sin(a), -cos(a))), 0, 1e-12);
    }
}

TEST(walk_goes_as_far_in_a_hundred_steps_as_in_one) {
    struct walk fine = some_walk(), coarse = some_walk();
    fine.down[WALK_FORWARD] = fine.down[WALK_RIGHT] = coarse.down[WALK_FORWARD] = coarse.down[WALK_RIGHT] = true;
    for (int i = 0; i < 100; i++)
        CHECK(walk_step(&fine, 0.01));
    CHECK(walk_step(&coarse, 1));
    CHECK_NEAR(apart(fine.pose.place, coarse.pose.place), 0, 1e-12);
    CHECK_NEAR(apart(coarse.pose.place, coarse.home.place), coarse.speed, 1e-12);
    struct walk fast = some_walk();
    fast.down[WALK_FORWARD] = fast.down[WALK_FAST] = true;
    CHECK(walk_step(&fast, 1));
    CHECK_NEAR(apart(fast.pose.place, fast.home.place), 4 * fast.speed, 1e-12);
    walk_home(&fast);
    CHECK_NEAR(apart(fast.pose.place, vec3_make(1, 2, 3)), 0, 0);
}

TEST(walk_round_the_centre_keeps_its_distance_and_its_place_in_the_picture) {
    struct walk walk = some_walk();
    struct camera before = walk_camera(&walk);
    struct vec3 right = vec3_cross(before.view, before.up), to = vec3_sub(walk.centre, before.eye);
    for (int i = 0; i < 50; i++)
        walk_orbit(&walk, 0.07, -0.03);
    struct camera after = walk_camera(&walk);
    struct vec3 right_after = vec3_cross(after.view, after.up), to_after = vec3_sub(walk.centre, after.eye);
    CHECK(apart(before.eye, after.eye) > 0.1);
    CHECK_NEAR(vec3_dot(to, right), vec3_dot(to_after, right_after), 1e-9);
    CHECK_NEAR(vec3_dot(to, before.up), vec3_dot(to_after, after.up), 1e-9);
    CHECK_NEAR(vec3_dot(to, before.view), vec3_dot(to_after, after.view), 1e-9);
}

TEST(walk_levels_the_horizon_and_keeps_where_it_looks) {
    struct walk walk = some_walk();
    walk_roll(&walk, 40);
    struct vec3 view = walk_camera(&walk).view;
    CHECK(fabs(vec3_cross(view, walk_camera(&walk).up).y) > 0.1);
    walk_level(&walk);
    CHECK_NEAR(vec3_cross(walk_camera(&walk).view, walk_camera(&walk).up).y, 0, 1e-12);
    CHECK_NEAR(apart(walk_camera(&walk).view, view), 0, 1e-12);
    walk_save(&walk, 3);
    struct vec3 place = walk.pose.place;
    walk.down[WALK_BACK] = true;
    CHECK(walk_step(&walk, 2));
    CHECK(!walk_recall(&walk, 4) && walk_recall(&walk, 3));
    CHECK_NEAR(apart(walk.pose.place, place), 0, 0);
}

/* A window without a screen: the test says what people do. */
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
static void fake_show(void *context, const struct window_frame *frame) {
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
    struct live live;
    struct picture_request request;
    void *block;
    double now;
};

static void begin(struct table *t) {
    struct error error;
    size_t bytes;
    *t = (struct table){.now = 100,
                        .request = {.full_width = 100,
                                    .full_height = 70,
                                    .width = 100,
                                    .height = 70,
                                    .camera = {{0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 40}}};
    t->driver = (struct window_driver){&t->fake,   fake_open, fake_show,    fake_poll,
                                       fake_title, fake_grab, fake_nothing, fake_nothing};
    CHECK(film_size(100, 70, &bytes, &error));
    t->block = mem_alloc_zero(1, bytes);
    CHECK(live_begin(&t->live, &t->driver, &t->request, t->block, "x.png", t->now, &error));
    t->fake.queue[t->fake.count++] = (struct window_event){.kind = WINDOW_SIZE, .x = 400, .y = 280, .density = 1};
}

static void end(struct table *t) {
    live_end(&t->live);
    CHECK(!t->fake.open);
    mem_free(t->block);
}

/* The child has finished the pass, in so many seconds. */
static void finish_pass(struct table *t, double seconds, bool stopped) {
    const struct picture_report report = {.threads = 2, .bounds = {{-1, -1, -1}, {1, 1, 1}}, .stopped = stopped};
    t->now += seconds;
    for (uint32_t tile = 0; !stopped && tile < film_tile_count(&t->live.film); tile++)
        atomic_store(&t->live.film.tiles[tile], FILM_TILE_DONE);
    live_pass_ended(&t->live, &report, t->now);
}

static enum live_order step(struct table *t) {
    t->now += 0.02;
    return live_step(&t->live, t->now);
}

/* To the script's picture, whole. */
static void go_to_the_end(struct table *t) {
    finish_pass(t, 0.02, false);
    CHECK_EQ_INT(step(t), LIVE_VIEW);
    CHECK(t->live.view.plain && t->live.view.divide == 4 && t->live.view.own);
    CHECK_EQ_INT(step(t), LIVE_NOTHING);
    finish_pass(t, 0.1, false);
    CHECK_EQ_INT(step(t), LIVE_VIEW);
    CHECK(!t->live.view.plain && t->live.view.divide == 1 && t->live.view.own);
    finish_pass(t, 1, false);
    CHECK_EQ_INT(step(t), LIVE_WRITE);
    CHECK_EQ_INT(step(t), LIVE_NOTHING);
}

TEST(window_shows_coarse_passes_first_and_writes_the_picture_of_the_script_once) {
    struct table t;
    begin(&t);
    CHECK_EQ_INT(t.live.film.width, 7);
    CHECK_EQ_INT(t.live.film.height, 5);
    CHECK_EQ_INT(step(&t), LIVE_NOTHING);
    go_to_the_end(&t);
    CHECK(t.fake.shown >= 3);
    key(&t.fake, 'r', true);
    CHECK_EQ_INT(step(&t), LIVE_VIEW);
    CHECK(t.live.view.divide == 16 && t.live.view.own);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), LIVE_VIEW);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), LIVE_VIEW);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), LIVE_NOTHING);
    end(&t);
}

TEST(window_walks_in_coarse_passes_and_refines_when_still) {
    struct table t;
    begin(&t);
    go_to_the_end(&t);
    key(&t.fake, WINDOW_ARROW_UP, true);
    CHECK_EQ_INT(step(&t), LIVE_NOTHING); /* no time has gone by yet */
    for (int i = 0; i < 5; i++) {
        CHECK_EQ_INT(step(&t), LIVE_VIEW);
        CHECK(t.live.view.plain && t.live.view.divide > 1 && !t.live.view.own);
        CHECK(t.live.view.camera.eye.z < 5);
        CHECK_EQ_INT(step(&t), LIVE_NOTHING); /* a coarse pass is worth its end */
        finish_pass(&t, 0.03, false);
    }
    key(&t.fake, WINDOW_ARROW_UP, false);
    while (t.live.view.plain) {
        CHECK_EQ_INT(step(&t), LIVE_VIEW);
        finish_pass(&t, 0.03, false);
    }
    CHECK_EQ_INT(step(&t), LIVE_NOTHING); /* where somebody has walked to is not the script's picture */
    end(&t);
}

TEST(window_stops_a_fine_pass_for_somebody_who_walks_on) {
    struct table t;
    begin(&t);
    finish_pass(&t, 0.02, false);
    CHECK_EQ_INT(step(&t), LIVE_VIEW);
    finish_pass(&t, 0.1, false);
    CHECK_EQ_INT(step(&t), LIVE_VIEW);
    CHECK(!t.live.view.plain);
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_WHEEL, .y = 2};
    CHECK_EQ_INT(step(&t), LIVE_STOP);
    CHECK_EQ_INT(step(&t), LIVE_NOTHING);
    finish_pass(&t, 0.001, true);
    CHECK_EQ_INT(step(&t), LIVE_VIEW);
    CHECK(t.live.view.plain && t.live.view.camera.fov < 40);
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
        CHECK_EQ_INT(step(&t), LIVE_VIEW);
        divide = t.live.view.divide;
        finish_pass(&t, 0.8 / (divide * divide), false); /* a scene that takes 0.8 s at one sample a pixel */
    }
    CHECK_EQ_INT(divide, 5); /* 0.8 / 25 s is below a thirtieth, 0.8 / 16 is not */
    end(&t);
}

TEST(window_keys_mean_walking_only_while_the_mouse_looks) {
    struct table t;
    begin(&t);
    go_to_the_end(&t);
    key(&t.fake, 's', true);
    CHECK_EQ_INT(step(&t), LIVE_SAVE);
    key(&t.fake, 'v', true);
    CHECK_EQ_INT(step(&t), LIVE_RECORD);
    key(&t.fake, WINDOW_SPACE, true);
    key(&t.fake, 's', true);
    (void)step(&t);
    CHECK(t.fake.grabbed);
    CHECK_EQ_INT(step(&t), LIVE_VIEW);
    CHECK(t.live.view.camera.eye.z > 5);
    key(&t.fake, WINDOW_ESCAPE, true);
    CHECK_EQ_INT(step(&t), LIVE_NOTHING);
    CHECK(!t.fake.grabbed && !t.live.walk.down[WALK_BACK]);
    key(&t.fake, 'q', true);
    CHECK_EQ_INT(step(&t), LIVE_QUIT);
    end(&t);
}

/* The program in a real window. */

static int shell(const char *line) {
    char *command = NULL, binary[4096];
    const char *named = getenv("GRAY_TEST_BINARY");
    CHECK(realpath(named ? named : "build/release/gray", binary) != NULL);
    if (asprintf(&command, "cd '%s' && gray='%s' && export gray && { %s; } >out.txt 2>err.txt", test_folder(), binary,
                 line) < 0)
        exit(1);
    int how = system(command);
    free(command);
    return WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
}

static void need_display(void) {
    if (shell("test -x $gray-gui && command -v Xvfb && command -v xdotool && command -v xvfb-run") != 0)
        test_skip("there is no gray-gui beside the program, or no Xvfb, xvfb-run or xdotool");
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/scene.lua", test_folder());
    test_write_text(path,
                    "local r = gr.node('root')\n"
                    "r:add_child(gr.geometry('b', gr.sphere(gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20))))\n"
                    "gr.render(r, 'out.png', 200, 150, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2},\n"
                    "  {gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0})})\n");
    (void)snprintf(path, sizeof path, "%s/wait.sh", test_folder());
    test_write_text(path, "for i in $(seq 300); do eval \"$1\" && exit 0; sleep 0.05; done; exit 1\n");
}

static void gives(const char *line, int status) {
    int got = shell(line);
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/err.txt", test_folder());
    char *said = test_read_file(path, NULL);
    if (got != status)
        test_fail(__FILE__, __LINE__, "%s\nstatus %d, not %d:\n%s", line, got, status, said ? said : "");
    free(said);
}

TEST(window_of_the_program_makes_the_picture_of_the_program_without) {
    need_display();
    gives("$gray scene.lua -o whole.png; "
          "xvfb-run -a sh -c '$gray -gui scene.lua & pid=$!; sh wait.sh \"test -s out.png\" || exit 9; sleep 0.2; "
          "xdotool key v; sh wait.sh \"test -s out-view1.lua\" || exit 8; "
          "xdotool keydown Right sleep 0.3 keyup Right; sleep 0.5; xdotool key s; "
          "sh wait.sh \"test -s out-view1.png\" || exit 7; xdotool key q; wait $pid' && "
          "cmp out.png whole.png && ! cmp -s out-view1.png whole.png",
          0);
    /* The camera that was recorded before anybody walked is the script's, in every digit. */
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

/* What lies over the picture. */

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
    CHECK_EQ_INT(step(&t), LIVE_VIEW);
    CHECK(t.live.view.divide == 16 && t.live.view.own && t.live.turning == 0);
    /* Pressed on a button and let go elsewhere: not used. */
    t.fake.queue[t.fake.count++] = mouse(WINDOW_PRESS, 60, 6);
    CHECK_EQ_INT(step(&t), LIVE_NOTHING);
    t.fake.queue[t.fake.count++] = mouse(WINDOW_MOVE, 200, 200);
    t.fake.queue[t.fake.count++] = mouse(WINDOW_RELEASE, 200, 200);
    CHECK_EQ_INT(step(&t), LIVE_NOTHING);
    CHECK(!t.live.flown);
    click(&t, 60, 6); /* Quit */
    CHECK_EQ_INT(step(&t), LIVE_QUIT);
    end(&t);
}

TEST(window_places_the_picture_in_its_middle_for_any_size_and_density) {
    struct table t;
    begin(&t);
    CHECK_EQ_INT(step(&t), LIVE_NOTHING);
    const struct live_place *place = &t.live.place;
    CHECK(place->left == 0 && place->top == 0 && place->shown_width == 400 && place->shown_height == 280);
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_SIZE, .x = 1600, .y = 700, .density = 2};
    CHECK_EQ_INT(step(&t), LIVE_NOTHING);
    CHECK(place->left == 300 && place->top == 0 && place->shown_width == 1000 && place->shown_height == 700);
    CHECK_EQ_INT(t.live.panel.paper.scale, 2); /* letters as large as before to the eye */
    CHECK(t.live.panel.paper.width == 1600 && t.live.panel.paper.height == 700);
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_SIZE, .x = 50, .y = 90, .density = 1};
    CHECK_EQ_INT(step(&t), LIVE_NOTHING);
    CHECK(place->left == 0 && place->top == 27 && place->shown_width == 50 && place->shown_height == 35);
    t.fake.queue[t.fake.count++] = (struct window_event){.kind = WINDOW_SIZE, .x = 0, .y = 0, .density = 1};
    CHECK_EQ_INT(step(&t), LIVE_NOTHING);
    end(&t);
}

TEST(window_tells_how_far_building_is_and_what_went_wrong) {
    struct table t;
    struct control control = {.build_step = 3, .build_done = 250};
    begin(&t);
    t.live.control = &control;
    t.now += 1;
    CHECK_EQ_INT(step(&t), LIVE_NOTHING);
    CHECK(strstr(t.fake.title, "building, step 3: 25 %") != NULL);
    control.build_step = 0;
    finish_pass(&t, 1, false);
    CHECK_EQ_INT(step(&t), LIVE_VIEW);
    CHECK(strstr(t.fake.title, "triangles") && strstr(t.fake.title, "rays/s") && strstr(t.fake.title, "frames/s"));
    live_tell(&t.live, "scene.lua:3: no such thing\nstack traceback");
    (void)step(&t);
    CHECK_TEXT(t.fake.title, "scene.lua:3: no such thing");
    live_detach(&t.live);
    (void)step(&t);
    key(&t.fake, 'r', true); /* there is nothing to render */
    CHECK_EQ_INT(step(&t), LIVE_NOTHING);
    key(&t.fake, 's', true); /* but what is shown can be kept */
    CHECK_EQ_INT(step(&t), LIVE_SAVE);
    end(&t);
}

TEST(paper_letters_keep_inside_their_cell_and_inside_the_paper) {
    enum { W = 40, H = 30 };
    static uint8_t rgba[4 * W * H];
    const struct paper paper = {rgba, W, H, 1};
    const struct ink ink = {1, 2, 3, 255};
    for (int c = 33; c < 127; c++) {
        const char text[2] = {(char)c, '\0'};
        int dots = 0;
        paper_clear(&paper);
        paper_text(&paper, 10, 10, text, ink);
        for (int i = 0; i < W * H; i++) {
            bool set = rgba[4 * i + 3] != 0;
            dots += set;
            CHECK(!set || (i % W >= 10 && i % W < 15 && i / W >= 10 && i / W < 17));
        }
        CHECK(dots >= 2 && dots < 30);
    }
    CHECK_EQ_INT(paper_text_width(&paper, "a\xc3\xa4?"), 18); /* one cell for each character */
    paper_text(&paper, -3, -3, "ends", ink);
    paper_text(&paper, W - 2, H - 2, "ends", ink);
    paper_line(&paper, -1e9, 5, 1e9, 5, ink);
    paper_line(&paper, -50, -50, 90, 90, ink);
    CHECK_EQ_INT(rgba[4 * (20 * W + 20) + 3], 255);
}

TEST(panel_sliders_follow_the_mouse_that_holds_them_and_stop_at_their_ends) {
    static uint8_t rgba[4 * 100 * 20];
    struct panel panel = {.paper = {rgba, 100, 20, 1}};
    const struct ink ink = {9, 9, 9, 255};
    double value = 0.5;
    panel.mouse_x = 30;
    panel.mouse_y = 5;
    panel_begin(&panel);
    CHECK(!panel_slider(&panel, 10, 2, 80, 0, 1, ink, &value)); /* the mouse is on it, no button is down */
    panel_end(&panel);
    panel.down = panel.pressed = true;
    panel_begin(&panel);
    CHECK(panel_slider(&panel, 10, 2, 80, 0, 1, ink, &value));
    panel_end(&panel);
    CHECK_NEAR(value, 0.25, 1e-12);
    panel.mouse_x = 500;
    panel.mouse_y = 19;
    panel_begin(&panel);
    CHECK(panel_slider(&panel, 10, 2, 80, 0, 1, ink, &value));
    panel_end(&panel);
    CHECK_NEAR(value, 1, 0);
    panel.down = false;
    panel.released = true;
    panel_begin(&panel);
    CHECK(!panel_slider(&panel, 10, 2, 80, 0, 1, ink, &value));
    panel_end(&panel);
    panel.mouse_x = 30;
    panel_begin(&panel);
    CHECK(!panel_slider(&panel, 10, 2, 80, 0, 1, ink, &value));
    panel_end(&panel);
}
