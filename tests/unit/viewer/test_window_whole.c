/* The whole program under a simulated window whose user waits for words in the title and then acts: Stop (rendering or
 * building ends, the picture stays, and work continues on request; the exact moment of a stop is unknown, so several
 * are tried), overlay lines, outlines. */
#define _GNU_SOURCE
#include "host/supervisor.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { WIDE = 640, HIGH = 480 };

/* A user who waits for words in the title and then acts. */
struct deed {
    const char *title; /* NULL: at once */
    struct window_event event;
    int pause; /* polls for events before it; one every few milliseconds */
};

#define SETTLED "ready or stopped" /* a stop that came too late counts, too */

struct person {
    const struct deed *deeds;
    int at, waited;
    bool open, size_sent;
    const char *other_scene; /* that scene.lua is from the deed WINDOW_LEAVE on */
    char title[1024];
    uint8_t *over;          /* the last overlay, of the whole window */
    uint8_t *large;         /* or NULL: the last picture that had the pixels of the window */
    const char *field;      /* of forms, that events of fields are for; NULL: the window has no widgets */
    uint32_t number;        /* of that field */
    uint32_t seen_nodes[3]; /* rows of the tree, by depth */
};

static bool person_open(void *context, uint32_t width, uint32_t height, const char *title, struct error *error) {
    struct person *person = context;
    (void)error;
    CHECK(width > 0 && height > 0 && title);
    return person->open = true;
}
static void person_show(void *context, const struct window_content *frame) {
    struct person *person = context;
    CHECK(frame->window_width == WIDE && frame->window_height == HIGH);
    if (person->large && frame->width == WIDE && frame->height == HIGH)
        memcpy(person->large, frame->picture, (size_t)3 * WIDE * HIGH);
    if (person->over)
        memcpy(person->over, frame->overlay, (size_t)4 * WIDE * HIGH);
}
static bool says(const char *title, const char *words) {
    if (strcmp(words, SETTLED) == 0)
        return strstr(title, "ready") || strstr(title, "stopped");
    return strstr(title, words) != NULL;
}
static bool person_poll(void *context, struct window_event *event) {
    struct person *person = context;
    const struct deed *deed = &person->deeds[person->at];
    if (!person->size_sent) {
        person->size_sent = true;
        *event = (struct window_event){.kind = WINDOW_SIZE, .x = WIDE, .y = HIGH, .density = 1};
        return true;
    }
    if ((deed->title && !says(person->title, deed->title)) || person->waited++ < deed->pause)
        return false;
    if (deed->event.kind == WINDOW_LEAVE) {
        test_write_text("new.lua", person->other_scene);
        CHECK(rename("new.lua", "scene.lua") == 0);
    }
    person->at++;
    person->waited = 0;
    person->title[0] = '\0';
    *event = deed->event;
    event->field = person->number;
    return true;
}
static void person_title(void *context, const char *text) {
    struct person *person = context;
    (void)snprintf(person->title, sizeof person->title, "%s", text);
}
static void person_grab(void *context, bool on) {
    (void)context, (void)on;
}
static void person_status(void *context, const struct window_status *status) {
    (void)context;
    CHECK(status->share >= 0 && status->share <= 1 && status->file[0] != '\0');
}
static void person_form(void *context, const struct window_form *form) {
    struct person *person = context;
    CHECK(form->count < FORM_FIELDS);
    for (uint32_t i = 0; i < form->count; i++) {
        CHECK(form->fields[i].group[0] != '\0' && form->fields[i].name[0] != '\0');
        if (strcmp(form->fields[i].name, person->field) == 0)
            person->number = form->fields[i].number;
    }
}
static void person_nodes(void *context, const struct node_query *query, const struct node_rows *rows) {
    struct person *person = context;
    for (uint32_t i = 0; query && i < rows->count; i++)
        person->seen_nodes[query->depth > 2 ? 2 : query->depth] += rows->rows[i].name[0] != '\0';
}
static void person_trace(void *context, const char *text) {
    (void)context, (void)text;
}
static void person_nothing(void *context) {
    (void)context;
}
static void person_close(void *context) {
    struct person *person = context;
    person->open = false;
}

/* Many objects, so that building takes a while even on a fast machine. */
static const char scene[] =
    "local red = gr.material({0.8, 0.2, 0.1}, {0.4, 0.4, 0.4}, 20)\n"
    "local r = gr.node('root')\n"
    "r:add_child(gr.geometry('ball', gr.sphere(red)))\n"
    "local at = {}\n"
    "for i = 1, 20000 do at[i] = {i % 50 - 25, (i // 50) % 20 - 10, -3 - i // 1000} end\n"
    "r:add_child(gr.instances{name = 'many', of = gr.geometry('small', gr.sphere(red)), at = at, size = 0.2})\n"
    "gr.render(r, 'out.png', 64, 48, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2},\n"
    "  {gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0})})\n";

#define KEY(code)                                                                                                      \
    { .kind = WINDOW_KEY, .key = code, .down = true }
#define AT_THE_BALL .button = WINDOW_LEFT, .x = 320, .y = 240

/* The status of the program with these options. */
struct setting {
    const char *scene, *option; /* NULL: the scene above; --progress=none */
    const char *overlay;        /* NULL: none */
    const char *other_scene;    /* for the deed WINDOW_LEAVE */
    uint8_t *large;             /* as in struct person */
    const char *field;          /* the same */
    uint32_t *seen_nodes;       /* or NULL: takes the three numbers */
};

static int viewer_that(const struct deed *deeds, const struct setting *setting, uint8_t *over) {
    struct person person = {.deeds = deeds,
                            .over = over,
                            .large = setting->large,
                            .other_scene = setting->other_scene,
                            .field = setting->field};
    struct window_driver driver = {.context = &person,
                                   .open = person_open,
                                   .show = person_show,
                                   .poll = person_poll,
                                   .title = person_title,
                                   .grab = person_grab,
                                   .full_screen = person_nothing,
                                   .close = person_close};
    if (setting->field) {
        driver.status = person_status;
        driver.form = person_form;
        driver.trace = person_trace;
        driver.nodes = person_nodes;
    }
    struct arena arena = {0};
    struct options options;
    struct error error;
    const char *option = setting->option ? setting->option : "--progress=none";
    const char *overlay = setting->overlay ? setting->overlay : "none";
    char *words[] = {"gray",     "-gui", "-q", (char *)(uintptr_t)option, "--overlay", (char *)(uintptr_t)overlay,
                     "scene.lua"};
    char before[4096];
    CHECK(getcwd(before, sizeof before) && chdir(test_folder()) == 0);
    test_write_text("scene.lua", setting->scene ? setting->scene : scene);
    CHECK(options_parse(&options, 7, words, &arena, &error));
    int status = supervisor_run(&options, &(struct program_parts){.window = &driver});
    CHECK(!person.open);
    if (setting->seen_nodes)
        memcpy(setting->seen_nodes, person.seen_nodes, sizeof person.seen_nodes);
    arena_destroy(&arena);
    CHECK(chdir(before) == 0);
    return status;
}

static int viewer_over(const struct deed *deeds, const char *overlay, uint8_t *over) {
    return viewer_that(deeds, &(struct setting){.overlay = overlay}, over);
}

static int viewer_with(const struct deed *deeds) {
    return viewer_over(deeds, "none", NULL);
}

/* Two of them can be used at a time. */

TEST(window_goes_on_after_a_stop_to_the_picture_of_one_that_was_never_stopped) {
    const struct deed plain[] = {{"ready", KEY('s'), 0}, {NULL, KEY('q'), 0}};
    /* During the first build, during a pass, and with Esc. */
    const struct deed stopped[] = {{NULL, KEY('x'), 0},    {SETTLED, KEY('r'), 0},        {NULL, KEY('x'), 2},
                                   {SETTLED, KEY('r'), 0}, {NULL, KEY(WINDOW_ESCAPE), 5}, {SETTLED, KEY('r'), 0},
                                   {NULL, KEY('x'), 0},    {"stopped", KEY('x'), 0},      {"ready", KEY('s'), 0},
                                   {NULL, KEY('q'), 0}};
    CHECK_EQ_INT(viewer_with(plain), 0);
    CHECK(rename(test_path("out.png"), test_path("whole.png")) == 0);
    CHECK_EQ_INT(viewer_with(stopped), 0);
    CHECK(test_same_files("out.png", "whole.png") && test_same_files("out-view1.png", "out-view2.png"));
}

TEST(window_stops_building_after_an_edit_and_goes_on_with_it_or_without) {
    const struct window_event press = {.kind = WINDOW_PRESS, AT_THE_BALL};
    const struct window_event release = {.kind = WINDOW_RELEASE, AT_THE_BALL};
    const struct window_event undo = {.kind = WINDOW_KEY, .key = 'z', .down = true, .control = true};
    const struct deed begin[] = {{"ready", press, 0}, {NULL, release, 0}, {"ready", KEY(WINDOW_DELETE), 0}};
    enum { BEGIN = 3, ROUNDS = 3, ROUND = 6 };
    struct deed deeds[BEGIN + ROUNDS * ROUND + 2];
    int count = 0;
    for (; count < BEGIN; count++)
        deeds[count] = begin[count];
    for (int i = 0; i < ROUNDS; i++) {
        const struct window_event again = {.kind = WINDOW_KEY, .key = 'y', .down = true, .control = true};
        const struct deed round[ROUND] = {
            {NULL, KEY('x'), 3 * i},               /* the world without the ball */
            {SETTLED, undo, 0},                    /* continues with the ball */
            {NULL, KEY(WINDOW_ESCAPE), 3 * i + 1}, /* stopped, too */
            {SETTLED, KEY('x'), 0},
            {"ready", KEY('s'), 0},
            {"ready", again, 0},
        };
        for (int k = 0; k < ROUND; k++)
            deeds[count++] = round[k];
    }
    deeds[count++] = (struct deed){"ready", KEY('s'), 0};
    deeds[count++] = (struct deed){NULL, KEY('q'), 0};
    CHECK_EQ_INT(viewer_with(deeds), 0);
    CHECK(test_same_files("out.png", "out-view1.png") && test_same_files("out.png", "out-view3.png"));
    CHECK(!test_same_files("out.png", "out-view4.png"));
}

static void picture_without_window(const char *overlay, const char *name) {
    char arguments[100];
    (void)snprintf(arguments, sizeof arguments, "-q --progress=none --overlay %s scene.lua -o %s", overlay, name);
    struct test_result result = test_gray(NULL, arguments);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
}

TEST(window_shows_and_saves_the_lines_that_overlay_draws) {
    const struct deed deeds[] = {{"ready", KEY('b'), 0}, {"ready", KEY('s'), 0}, {NULL, KEY('g'), 0},
                                 {"ready", KEY('s'), 0}, {NULL, KEY('g'), 0},    {"ready", KEY('s'), 0},
                                 {NULL, KEY('q'), 0}};
    const struct deed nothing[] = {{"ready", KEY('b'), 0}, {"ready", KEY('q'), 0}};
    CHECK_EQ_INT(viewer_with(deeds), 0);
    picture_without_window("boxes", "boxes.png");
    picture_without_window("grid", "grid.png");
    CHECK(test_same_files("out-view1.png", "boxes.png") && test_same_files("out-view2.png", "grid.png"));
    CHECK(test_same_files("out-view3.png", "out.png") && !test_same_files("out.png", "boxes.png"));
    /* Requested on the command line, they are part of the script's picture. */
    CHECK_EQ_INT(viewer_over(nothing, "boxes", NULL), 0);
    CHECK(test_same_files("out.png", "boxes.png"));
}

TEST(window_outlines_what_is_picked_by_its_silhouette) {
    static uint8_t over[4 * WIDE * HIGH];
    const struct window_event press = {.kind = WINDOW_PRESS, AT_THE_BALL};
    const struct window_event release = {.kind = WINDOW_RELEASE, AT_THE_BALL};
    const struct deed deeds[] = {{"ready", press, 0}, {NULL, release, 0}, {"ready", KEY('x'), 0}, {NULL, KEY('q'), 20}};
    CHECK_EQ_INT(viewer_over(deeds, "none", over), 0);
    /* A ball of radius 1 at distance 6, with a field of view of 40 degrees for 480 pixels; a pixel of the picture is 10
     * wide. */
    double radius = HIGH / 2.0 * tan(asin(1.0 / 6)) / tan(20 * M_PI / 180);
    bool turns[36] = {false};
    const uint8_t colour[4] = {255, 190, 60, 255};
    for (int y = 0; y < HIGH; y++) {
        for (int x = 0; x < WIDE; x++) {
            const uint8_t *p = over + 4 * ((size_t)y * WIDE + (size_t)x);
            double dx = x + 0.5 - WIDE / 2.0, dy = y + 0.5 - HIGH / 2.0, far = hypot(dx, dy);
            if (memcmp(p, colour, 4) != 0 || far < 20) /* the mark of the click */
                continue;
            CHECK(far > radius - 16 && far < radius + 16);
            turns[(int)((atan2(dy, dx) / M_PI + 1) * 17.999)] = true;
        }
    }
    for (int i = 0; i < 36; i++)
        CHECK(turns[i]);
}

TEST(window_says_when_a_file_is_saved_and_prints_no_progress_in_the_terminal) {
    const struct deed deeds[] = {{"out.png is written", KEY('s'), 0},
                                 {"out-view1.png is written", KEY('v'), 0},
                                 {"out-view1.lua is written", KEY('c'), 0},
                                 {"out-changes1.lua is written", KEY(WINDOW_ARROW_UP), 0},
                                 {NULL, {.kind = WINDOW_KEY, .key = WINDOW_ARROW_UP}, 30},
                                 {"ready", KEY('x'), 0},
                                 {NULL, KEY('q'), 30}};
    size_t size;
    CHECK(freopen(test_path("said.txt"), "w", stderr) != NULL);
    CHECK_EQ_INT(viewer_that(deeds, &(struct setting){.option = "--progress=bar"}, NULL), 0);
    CHECK(fflush(stderr) == 0);
    char *said = test_read_file(test_path("said.txt"), &size);
    CHECK_TEXT(said, "");
    free(said);
}

/* Frames that depend on those before. */
#define ANIMATION(colour, file)                                                                                        \
    "local r = gr.node('root')\n"                                                                                      \
    "local ball = gr.geometry('ball', gr.sphere(gr.material({" colour ", 0.2, 0.1}, {0.4, 0.4, 0.4}, 20)))\n"          \
    "r:add_child(ball)\n"                                                                                              \
    "gr.frames{count = 5, draw = function(t, frame)\n"                                                                 \
    "  ball:translate(0.3, 0, 0)\n"                                                                                    \
    "  return {node = r, file = '" file ".####.png', width = 64, height = 48, eye = {0, 0, 6}, view = {0, 0, -1}}\n"   \
    "end}\n"

/* Whether a frame that the window saved has the bytes of the same frame without it. */
static bool saved_frame(const char *file, int number, int view) {
    char saved[40], arguments[100];
    (void)snprintf(arguments, sizeof arguments, "-q --progress=none scene.lua --frames %d-%d -o w%d.png", number,
                   number, number);
    (void)snprintf(saved, sizeof saved, "%s.%04d-view%d.png", file, number, view);
    struct test_result result = test_gray(NULL, arguments);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    (void)snprintf(arguments, sizeof arguments, "w%d.png", number);
    return test_same_files(saved, arguments);
}

TEST(window_plays_an_animation_to_its_end_and_goes_back_to_frames_before) {
    const struct deed deeds[] = {
        {"ready  frame 5/5", KEY('s'), 0}, {NULL, KEY('h'), 0},    {"ready  frame 4/5", KEY('h'), 0},
        {"ready  frame 3/5", KEY('s'), 0}, {NULL, KEY('j'), 0},    {"ready  frame 4/5", KEY('k'), 0},
        {"ready  frame 5/5", KEY('o'), 0}, {NULL, KEY('k'), 0}, /* in a loop */
        {"playing", KEY('k'), 150},        {"ready", KEY('o'), 0}, {NULL, KEY('k'), 0},
        {"ready  frame 5/5", KEY('s'), 0}, {NULL, KEY('q'), 0}};
    const struct setting setting = {.scene = ANIMATION("0.8", "f")};
    CHECK_EQ_INT(viewer_that(deeds, &setting, NULL), 0);
    CHECK(access(test_path("f.0005.png"), F_OK) != 0 && access(test_path("f.####.png"), F_OK) != 0);
    CHECK(saved_frame("f", 5, 1) && saved_frame("f", 3, 1) && saved_frame("f", 5, 2));
}

TEST(window_with_a_changed_script_stays_at_the_frame_that_it_shows) {
    const struct deed deeds[] = {{"ready  frame 5/5", KEY('h'), 0},
                                 {"ready  frame 4/5", {.kind = WINDOW_LEAVE}, 0},
                                 {"g.####.png  64x48  ready  frame 4/5", KEY('s'), 0},
                                 {NULL, KEY('q'), 0}};
    const struct setting setting = {
        .scene = ANIMATION("0.8", "f"), .option = "--watch", .other_scene = ANIMATION("0.3", "g")};
    CHECK_EQ_INT(viewer_that(deeds, &setting, NULL), 0);
    CHECK(saved_frame("g", 4, 1));
}

TEST(window_goes_on_after_an_animation_and_plays_turntables_and_scripts_of_one_frame) {
    const struct deed turns[] = {
        {"playing", KEY('k'), 0}, {"ready", KEY('j'), 0}, {"ready", KEY('n'), 0}, {"none", KEY('q'), 0}};
    const struct deed frames[] = {{"ready  frame 3/3", KEY('h'), 0}, {"ready  frame 2/3", KEY('q'), 0}};
    static const char ball[] =
        "gr.render(gr.sphere(gr.material({1, 1, 1}, {0, 0, 0}, 1)), 'out.png', 64, 48, {0, 0, 6}, "
        "{0, 0, -1}, {0, 1, 0}, 40, {1, 1, 1}, {})\n";
    CHECK_EQ_INT(viewer_that(turns, &(struct setting){.scene = ball, .option = "--turntable=4"}, NULL), 0);
    CHECK_EQ_INT(viewer_that(frames, &(struct setting){.scene = ball, .option = "--frames=3"}, NULL), 0);
}

/* At the size of the picture the pixels of the window are squares of 10 x 10. */
TEST(window_larger_than_the_picture_shows_it_with_the_pixels_of_the_window) {
    static uint8_t large[3 * WIDE * HIGH];
    const struct deed deeds[] = {{"ready", KEY('s'), 0}, {"ready  ", KEY('q'), 0}};
    const struct setting setting = {
        .scene = "local r = gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.1}, {0.4, 0.4, 0.4}, 20)))\n"
                 "gr.render{node = r, file = 'out.png', width = 64, height = 48, eye = {0, 0, 3}, view = {0, 0, -1}}\n",
        .large = large};
    CHECK_EQ_INT(viewer_that(deeds, &setting, NULL), 0);
    CHECK(test_same_files("out.png", "out-view1.png"));
    struct test_result result = test_gray(NULL, "-q --progress=none scene.lua --size 640x480 -o whole.png");
    CHECK_EQ_INT(result.status, 0);
    struct test_picture whole = test_read_picture(test_path("whole.png")),
                        own = test_read_picture(test_path("out.png"));
    CHECK(own.width == 64 && own.height == 48 && whole.width == WIDE && whole.height == HIGH);
    CHECK(memcmp(whole.rgb, large, sizeof large) == 0);
    free(whole.rgb);
    free(own.rgb);
    test_free_result(&result);
}

TEST(window_opens_while_the_script_runs_and_ends_it) {
    const struct deed quits[] = {{"scene.lua  640x480  the script runs", KEY('s'), 0}, {"runs", KEY('q'), 0}};
    const struct deed waits[] = {{"the script runs", KEY('b'), 0}, {"64x48  ready", KEY('q'), 0}};
    CHECK_EQ_INT(viewer_that(quits, &(struct setting){.scene = "while true do end\n"}, NULL), 130);
    const struct setting slow = {.scene =
                                     "local t = os.clock()\nwhile os.clock() - t < 0.5 do end\n" ANIMATION("0.5", "f")};
    CHECK_EQ_INT(viewer_that(waits, &slow, NULL), 0);
}

/* The moment of the end is unknown: several are tried. The tiles of another view are none of the picture. */
TEST(window_that_closes_during_a_picture_leaves_a_partial_one_of_its_own_view) {
    struct setting setting = {
        .scene = "local r = gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.1}, {0.4, 0.4, 0.4}, 20)))\n"
                 "gr.render(r, 'out.png', 640, 480, {0, 0, 3}, {0, 0, -1}, {0, 1, 0}, 60, {.3, .3, .3},\n"
                 "  {gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0})}, {samples = 12, full = true})\n"};
    for (int pause = 20; pause < 1000 && access(test_path("out.partial.png"), F_OK) != 0; pause += 20) {
        const struct deed quits[] = {{NULL, KEY('q'), pause}};
        CHECK_EQ_INT(viewer_that(quits, &setting, NULL), 130);
    }
    struct test_picture picture = test_read_picture(test_path("out.partial.png"));
    CHECK_EQ_INT(picture.width, 640);
    free(picture.rgb);
    CHECK(access(test_path("out.png"), F_OK) != 0 && remove(test_path("out.partial.png")) == 0);
    const struct deed flies[] = {{NULL, KEY(WINDOW_ARROW_UP), 5},
                                 {NULL, {.kind = WINDOW_KEY, .key = WINDOW_ARROW_UP}, 5},
                                 {NULL, KEY('q'), 200}};
    CHECK_EQ_INT(viewer_that(flies, &setting, NULL), 130);
    CHECK(access(test_path("out.partial.png"), F_OK) != 0);
}

TEST(window_that_watches_opens_for_an_error_before_the_first_picture) {
    const struct deed deeds[] = {{"scene.lua:1", {.kind = WINDOW_LEAVE}, 0}, {"64x48  ready", KEY('q'), 0}};
    const struct setting setting = {
        .scene = "gr.no_such_thing()\n", .option = "--watch", .other_scene = ANIMATION("0.5", "f")};
    CHECK(freopen("/dev/null", "w", stderr) != NULL);
    CHECK_EQ_INT(viewer_that(deeds, &setting, NULL), 0);
}

TEST(window_ends_with_the_denoised_picture_of_paths_also_after_a_restart) {
    const struct deed deeds[] = {{"out.png is written", KEY(WINDOW_ARROW_UP), 0},
                                 {NULL, {.kind = WINDOW_KEY, .key = WINDOW_ARROW_UP}, 10},
                                 {NULL, KEY(WINDOW_HOME), 5},
                                 {NULL, KEY('r'), 5},
                                 {"ready", KEY('s'), 0},
                                 {NULL, KEY('q'), 0}};
    const struct setting setting = {
        .scene = "local r = gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.1}, {0.4, 0.4, 0.4}, 20)))\n"
                 "gr.render{node = r, file = 'out.png', width = 64, height = 48, eye = {0, 0, 3}, view = {0, 0, -1},\n"
                 "  integrator = 'path', background = {0.5, 0.6, 0.7}}\n",
        .option = "--denoise"};
    CHECK_EQ_INT(viewer_that(deeds, &setting, NULL), 0);
    struct test_result result = test_gray(NULL, "-q --progress=none scene.lua --denoise -o whole.png");
    CHECK_EQ_INT(result.status, 0);
    CHECK(test_same_files("out.png", "whole.png"));
    CHECK(test_same_files("out-view1.png", "whole.png"));
    test_free_result(&result);
}

TEST(window_with_a_changed_setting_makes_the_picture_of_its_option) {
    const struct deed deeds[] = {{"ready", {.kind = WINDOW_FIELD, .numbers = {INTEGRATOR_PATH}}, 0},
                                 {NULL, KEY(0), 100},
                                 {"ready", KEY('q'), 0}};
    const struct setting setting = {.option = "--watch", .field = "integrator"};
    CHECK_EQ_INT(viewer_that(deeds, &setting, NULL), 0);
    struct test_result result = test_gray(NULL, "-q --progress=none scene.lua --integrator path -o whole.png");
    CHECK_EQ_INT(result.status, 0);
    CHECK(test_same_files("out.png", "whole.png"));
    test_free_result(&result);
}

/* Few samples come first, and the last pass has all of them. */
TEST(window_that_shows_paths_denoised_ends_with_the_picture_of_the_program) {
    const struct deed deeds[] = {{"ready", KEY('q'), 0}};
    const struct setting setting = {
        .scene = "local r = gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.1}, {0.4, 0.4, 0.4}, 20)))\n"
                 "gr.render{node = r, file = 'out.png', width = 64, height = 48, eye = {0, 0, 3}, view = {0, 0, -1},\n"
                 "  integrator = 'path', denoise = true, background = {0.5, 0.6, 0.7}}\n",
        .field = "integrator"};
    CHECK_EQ_INT(viewer_that(deeds, &setting, NULL), 0);
    struct test_result result = test_gray(NULL, "-q --progress=none scene.lua -o whole.png");
    CHECK_EQ_INT(result.status, 0);
    CHECK(test_same_files("out.png", "whole.png"));
    test_free_result(&result);
}

TEST(window_lists_nodes_and_selects_them_in_the_tree) {
    const struct deed deeds[] = {
        {"ready", {.kind = WINDOW_NODES}, 0},
        {NULL, {.kind = WINDOW_NODES, .node = {.depth = 1}}, 5},
        {"ready", {.kind = WINDOW_SELECT, .node = {.depth = 2, .path = {0, 1}}}, 5},
        {"ready", {.kind = WINDOW_ACTION, .action = DO_DELETE}, 50},
        {"ready", {.kind = WINDOW_SELECT, .node = {.depth = 2, .path = {0, 7}}}, 5}, /* there is none */
        {"ready", {.kind = WINDOW_ACTION, .action = DO_SAVE_CHANGES}, 50},
        {"ready", KEY('q'), 20}};
    uint32_t seen[3];
    const struct setting setting = {.field = "exposure", .seen_nodes = seen};
    CHECK_EQ_INT(viewer_that(deeds, &setting, NULL), 0);
    CHECK(seen[0] == 1 && seen[1] == 2 && seen[2] == 0);
    char *saved = test_read_file(test_path("out-changes1.lua"), NULL);
    CHECK(saved && strstr(saved, "gr.change_delete('many', "));
    free(saved);
}
