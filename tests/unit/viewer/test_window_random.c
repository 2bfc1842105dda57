/* Random users: the whole program, supervisor and confined child, under a simulated window that sends random events
 * (actions, keys, mouse, fields, sizes) while the scene's file changes. GRAY_RANDOM_SECONDS is the duration of the long
 * test (default: an hour); GRAY_RANDOM_SEED repeats one. The program must not crash, leak, hang or report a broken
 * protocol. */
#define _GNU_SOURCE
#include "host/supervisor.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

struct crowd {
    struct test_random random;
    int polls, polls_left; /* until the window is closed */
    bool open, mutates;
    int width, height;
    double x, y;
    int frames;
    struct window_state state;
};

static int below(struct crowd *crowd, int limit) {
    return (int)test_uniform(&crowd->random, 0, limit - 1e-9);
}

static const char scene_head[] =
    "local red = gr.material({0.8, 0.2, 0.1}, {0.4, 0.4, 0.4}, 20)\n"
    "local glass = gr.rr_material({0.1, 0.1, 0.1}, {0.9, 0.9, 0.9}, 100, 0.2, 0.7, 1.4)\n"
    "local r = gr.node('root')\nlocal g = gr.node('group')\nr:add_child(g)\n"
    "g:add_child(gr.geometry('ball', gr.sphere(red)))\n"
    "local lens = gr.geometry('lens', gr.sphere(glass))\nlens:translate(1.5, 0, 1)\nr:add_child(lens)\n"
    "local cut = gr.csg_difference('cut', gr.cube(red), gr.sphere(glass))\ncut:translate(-2, -1, 0)\nr:add_child(cut)\n"
    "r:add_child(gr.instances{name = 'many', of = gr.geometry('small', gr.sphere(red)), at = {{-3, 2, -4}, {0, 2, -4}, "
    "{3, 2, -4}}, size = 0.4})\n"
    "r:add_child(gr.mesh('tetra', {{0, 2, 0}, {1, 3, 0}, {-1, 3, 0}, {0, 2.5, 1}}, {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, "
    "{0, 2, 3}}))\n";

/* One of several scenes: valid ones with one and two pictures and an animation, and two kinds of invalid ones. */
static void write_scene(struct crowd *crowd) {
    static const char *const tails[] = {
        ("gr.render(r, 'out.png', 160, 120, {0, 1, 7}, {0, -0.1, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2}, {gr.light({4, 5, "
         "6}, {0.6, 0.6, 0.6}, {1, 0, 0}), gr.area_light({-1, 4, 0}, {2, 0, 0}, {0, 0, 2}, {0.4, 0.4, 0.4}, {1, 0, "
         "0})})\n"),
        ("for i = 1, 2 do gr.render(r, 'out' .. i .. '.png', 120 * i, 90, {0, 1, 7}, {0, 0, -1}, {0, 1, 0}, 50, {0.2, "
         "0.2, 0.2}, {gr.light({4, 5, 6}, {0.6, 0.6, 0.6}, {1, 0, 0})}) end\n"),
        ("gr.frames{count = 7, loop = true, draw = function(t) g:translate(0.1, 0, 0) return {node = r, file = "
         "'out.png', "
         "width = 90, height = 60, eye = {0, 1, 7}} end}\n"),
        "gr.no_such_thing()\n",
        "gr.render(r, \n",
    };
    char text[4096];
    (void)snprintf(text, sizeof text, "%s%s", scene_head, tails[crowd->polls == 0 ? below(crowd, 3) : below(crowd, 5)]);
    test_write_text("new.lua", text);
    CHECK(rename("new.lua", "scene.lua") == 0);
}

static bool crowd_open(void *context, struct error *error) {
    struct crowd *crowd = context;
    (void)error;
    CHECK(!crowd->open);
    crowd->width = crowd->height = 0;
    return crowd->open = true;
}

/* Every byte to be displayed is readable, every line a number. */
static void crowd_show(void *context, const uint8_t *picture, uint32_t width, uint32_t height) {
    struct crowd *crowd = context;
    const struct window_state *state = &crowd->state;
    unsigned sum = 0;
    for (size_t i = 0; i < 3 * (size_t)width * height; i += 97)
        sum += picture[i];
    CHECK(state->line_count <= WINDOW_LINES);
    for (uint32_t i = 0; i < state->line_count; i++)
        CHECK(state->lines[i].x0 + state->lines[i].y0 + state->lines[i].x1 + state->lines[i].y1 < INFINITY);
    crowd->frames += sum > 0;
    CHECK(crowd->open && state->shown_width >= 1 && state->shown_height >= 1);
}

/* Quitting, saving, the next picture and traces are rare. */
static struct window_event random_action(struct crowd *crowd) {
    struct window_event event = {.kind = WINDOW_ACTION, .x = crowd->x, .y = crowd->y};
    bool rare;
    do {
        event.action = (enum window_action)below(crowd, WINDOW_ACTION_COUNT);
        rare = window_action_table[event.action].menu == MENU_FILE || event.action == DO_PIXEL_TRACE;
    } while (event.action == DO_QUIT || (rare && below(crowd, 10) > 0));
    return event;
}

/* A field of the form that is shown, but no setting, which runs the scripts again; or any other. */
static struct window_event random_field(struct crowd *crowd) {
    struct window_event event = {.kind = WINDOW_FIELD, .field = (uint32_t)below(crowd, 60), .joins = below(crowd, 2)};
    uint32_t count = crowd->state.form.count, at = count > 0 ? (uint32_t)below(crowd, (int)count) : 0;
    if (count > 0 && below(crowd, 4) > 0 && crowd->state.form.fields[at].number < 60)
        event.field = crowd->state.form.fields[at].number;
    for (int i = 0; i < 3; i++)
        event.numbers[i] = below(crowd, 4) ? test_uniform(&crowd->random, -1, 2) : (double)below(crowd, 4);
    return event;
}

static struct window_event random_event(struct crowd *crowd) {
    int what = below(crowd, 100);
    struct window_event event = {.kind = WINDOW_MOVE, .x = crowd->x, .y = crowd->y};
    if (what < 20)
        return random_action(crowd);
    if (what < 26)
        return random_field(crowd);
    if (what < 28)
        return (struct window_event){.kind = WINDOW_TYPE, .typed = "xyz0123.-\b\r"[below(crowd, 11)]};
    if (what < 32)
        return (struct window_event){
            .kind = WINDOW_KEY, .key = (enum fly_camera_key)below(crowd, FLY_KEYS), .down = below(crowd, 3) > 0};
    if (what < 34)
        return (struct window_event){
            .kind = below(crowd, 2) ? WINDOW_SELECT : WINDOW_NODES,
            .node = {.depth = (uint32_t)below(crowd, 4), .path = {0, (uint32_t)below(crowd, 5)}}};
    if (what < 65) {
        bool far = below(crowd, 5) == 0;
        event.dx = test_uniform(&crowd->random, -20, 20);
        event.dy = test_uniform(&crowd->random, -20, 20);
        event.x = far ? test_uniform(&crowd->random, -5, crowd->width + 5) : crowd->x + event.dx;
        event.y = far ? test_uniform(&crowd->random, -5, crowd->height + 5) : crowd->y + event.dy;
    } else if (what < 92) {
        event.kind = below(crowd, 2) ? WINDOW_PRESS : WINDOW_RELEASE;
        event.button = below(crowd, 12) == 0 ? WINDOW_RIGHT : below(crowd, 6) == 0 ? WINDOW_MIDDLE : WINDOW_LEFT;
        event.shift = below(crowd, 3) == 0;
        event.control = below(crowd, 3) == 0;
    } else if (what < 96) {
        event = (struct window_event){
            .kind = WINDOW_WHEEL, .y = test_uniform(&crowd->random, -3, 3), .control = below(crowd, 3) == 0};
    } else if (what < 98) {
        event = (struct window_event){.kind = WINDOW_LEAVE};
    } else {
        event = (struct window_event){.kind = WINDOW_SIZE,
                                      .x = 1 + below(crowd, 900),
                                      .y = 1 + below(crowd, 700),
                                      .density = 1 + 0.5 * below(crowd, 3)};
    }
    return event;
}

static bool crowd_poll(void *context, struct window_event *event) {
    struct crowd *crowd = context;
    crowd->polls++;
    if (crowd->width == 0) {
        *event = (struct window_event){.kind = WINDOW_SIZE, .x = 800, .y = 600, .density = 1};
    } else if (--crowd->polls_left <= 0) {
        *event = (struct window_event){.kind = WINDOW_CLOSE};
    } else {
        if (crowd->mutates && below(crowd, 400) == 0)
            write_scene(crowd);
        if (below(crowd, 3) == 0)
            return false;
        *event = random_event(crowd);
    }
    if (event->kind == WINDOW_SIZE) {
        crowd->width = (int)event->x;
        crowd->height = (int)event->y;
    }
    if (event->kind == WINDOW_MOVE) {
        crowd->x = event->x;
        crowd->y = event->y;
    }
    return true;
}

static int crowd_descriptor(void *context) {
    (void)context;
    return -1;
}
static void crowd_nodes(void *context, const struct node_query *query, const struct node_rows *rows) {
    (void)context;
    CHECK(!query || rows->count <= NODE_ROWS);
}
static void crowd_close(void *context) {
    struct crowd *crowd = context;
    CHECK(crowd->open);
    crowd->open = false;
}

/* One session with this many polls for events. Returns the number of displayed frames. */
static int sit(uint64_t seed, int polls) {
    static struct crowd crowd;
    crowd = (struct crowd){.random = {seed}, .polls_left = polls};
    const struct window_driver driver = {.context = &crowd,
                                         .state = &crowd.state,
                                         .open = crowd_open,
                                         .close = crowd_close,
                                         .poll = crowd_poll,
                                         .descriptor = crowd_descriptor,
                                         .show = crowd_show,
                                         .nodes = crowd_nodes};
    struct arena arena = {0};
    struct options options;
    struct error error;
    crowd.mutates = seed % 2 == 1;
    write_scene(&crowd);
    char *words[] = {"gray", "-gui", "-q", "--progress=none", "scene.lua", "--watch"};
    CHECK(options_parse(&options, crowd.mutates ? 6 : 5, words, &arena, &error));
    int status = supervisor_run(&options, &(struct program_parts){.window = &driver});
    if (status != 0 && status != 130 && !(status == 1 && crowd.mutates))
        test_fail(__FILE__, __LINE__, "seed %llu: status %d", (unsigned long long)seed, status);
    CHECK(!crowd.open);
    arena_destroy(&arena);
    CHECK(system("rm -f -- *") == 0);
    return crowd.frames;
}

static uint64_t first_seed(uint64_t otherwise) {
    const char *given = getenv("GRAY_RANDOM_SEED");
    return given ? strtoull(given, NULL, 10) : otherwise;
}

static void enter_folder(void) {
    CHECK(chdir(test_folder()) == 0);
    /* Errors of scenes go to a file, not between the lines of the tests. */
    CHECK(freopen("/dev/null", "w", stderr) != NULL);
}

TEST(window_survives_random_events) {
    enter_folder();
    (void)sit(first_seed(1), 400);
    (void)sit(first_seed(2), 400);
}

TEST_LONG(window_survives_an_hour_of_random_events) {
    const char *given = getenv("GRAY_RANDOM_SECONDS");
    double seconds = given ? atof(given) : 3600;
    FILE *log = fopen("build/window_random.txt", "w"); /* before the folder is another one */
    (void)alarm((unsigned)seconds + 900);
    enter_folder();
    time_t end = time(NULL) + (time_t)seconds;
    long sittings = 0, frames = 0;
    for (uint64_t seed = first_seed(100); time(NULL) < end; seed++) {
        frames += sit(seed, 1500);
        sittings++;
    }
    if (log) /* output of passing runs is not printed */
        (void)fprintf(log, "%.0f s: %ld sittings of up to 1500 questions for events, %ld frames shown\n", seconds,
                      sittings, frames);
    CHECK(!log || fclose(log) == 0);
}
