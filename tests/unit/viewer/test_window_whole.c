/* The whole program under a simulated window whose user waits for words of the status and then acts: Stop (rendering or
 * building ends, the picture stays, and work continues on request; the exact moment of a stop is unknown, so several
 * are tried), overlay lines, outlines, edits whose saved calls give the same bytes without a window. */
#define _GNU_SOURCE
#include "host/supervisor.h"
#include "script/addable.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { WIDE = 640, HIGH = 480 };

/* Most deeds need no field. */
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"

/* A user who waits for words of the status and then acts. */
struct deed {
    const char *words; /* NULL: at once */
    struct window_event event;
    int pause;         /* polls for events before it; one every few milliseconds */
    const char *field; /* the name of the field that the event is for; it waits until there is one */
};

#define SETTLED "ready or stopped" /* a stop that came too late counts, too */
enum { DELAY = 12 };               /* polls after which the status shows what a deed has done */

struct person {
    const struct deed *deeds;
    int at, waited, since;
    bool open, size_sent;
    const char *other_scene; /* that scene.lua is from the deed WINDOW_LEAVE on */
    char status[2048];
    struct window_state state;
    uint8_t *large;         /* or NULL: the last picture that had the pixels of the window */
    uint32_t seen_nodes[3]; /* rows of the tree, by depth */
};

static bool person_open(void *context, struct error *error) {
    struct person *person = context;
    (void)error;
    CHECK(person->state.has_scene);
    return person->open = true;
}
static void person_show(void *context, const uint8_t *picture, uint32_t width, uint32_t height) {
    struct person *person = context;
    const struct window_state *state = &person->state;
    CHECK(state->share >= 0 && state->share <= 1 && state->file[0] != '\0');
    CHECK(state->form.count < FORM_FIELDS && state->line_count <= WINDOW_LINES);
    for (uint32_t i = 0; i < state->form.count; i++)
        CHECK(state->form.fields[i].group[0] != '\0' && state->form.fields[i].name[0] != '\0');
    if (person->large && width == WIDE && height == HIGH)
        memcpy(person->large, picture, (size_t)3 * WIDE * HIGH);
    /* The picture may be shown with the words from before the last deed. */
    if (person->since >= DELAY && state->state[0] != '\0')
        (void)snprintf(person->status, sizeof person->status, "%s  %.*s  %s  %s  %s  %s", state->file,
                       (int)strcspn(state->figures, ","), state->figures, state->state, state->frame, state->notice,
                       state->message);
}
static bool says(const char *status, const char *words) {
    if (strcmp(words, SETTLED) == 0)
        return strstr(status, "ready") || strstr(status, "stopped");
    return strstr(status, words) != NULL;
}
static const struct window_field *find_field(const struct window_form *form, const char *name) {
    for (uint32_t i = 0; i < form->count; i++) {
        if (strcmp(form->fields[i].name, name) == 0)
            return &form->fields[i];
    }
    return NULL;
}
static bool person_poll(void *context, struct window_event *event) {
    struct person *person = context;
    const struct deed *deed = &person->deeds[person->at];
    const struct window_field *field = deed->field ? find_field(&person->state.form, deed->field) : NULL;
    person->since++;
    if (!person->size_sent) {
        person->size_sent = true;
        *event = (struct window_event){.kind = WINDOW_SIZE, .x = WIDE, .y = HIGH, .density = 1};
        return true;
    }
    if ((deed->words && !says(person->status, deed->words)) || (deed->field && !field) ||
        person->waited++ < deed->pause)
        return false;
    if (deed->event.kind == WINDOW_LEAVE) {
        test_write_text("new.lua", person->other_scene);
        CHECK(rename("new.lua", "scene.lua") == 0);
    }
    person->at++;
    person->waited = person->since = 0;
    person->status[0] = person->state.state[0] = '\0';
    *event = deed->event;
    event->field = field ? field->number : 0;
    return true;
}
static int person_descriptor(void *context) {
    (void)context;
    return -1;
}
static void person_nodes(void *context, const struct node_query *query, const struct node_rows *rows) {
    struct person *person = context;
    for (uint32_t i = 0; query && i < rows->count; i++)
        person->seen_nodes[query->depth > 2 ? 2 : query->depth] += rows->rows[i].name[0] != '\0';
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

#define ACTION(name)                                                                                                   \
    { .kind = WINDOW_ACTION, .action = name, .x = 320, .y = 240 }
#define KEY(code)                                                                                                      \
    { .kind = WINDOW_KEY, .key = code, .down = true }
#define KEY_UP(code)                                                                                                   \
    { .kind = WINDOW_KEY, .key = code }
#define PRESS                                                                                                          \
    { .kind = WINDOW_PRESS, .button = WINDOW_LEFT, .x = 320, .y = 240 }
#define RELEASE                                                                                                        \
    { .kind = WINDOW_RELEASE, .button = WINDOW_LEFT, .x = 320, .y = 240 }
#define FIELD(...)                                                                                                     \
    {                                                                                                                  \
        .kind = WINDOW_FIELD, .numbers = { __VA_ARGS__ }                                                               \
    }

/* The status of the program with these options. */
struct setting {
    const char *scene, *option; /* NULL: the scene above; --progress=none */
    const char *overlay;        /* NULL: none */
    const char *other_scene;    /* for the deed WINDOW_LEAVE */
    uint8_t *large;             /* as in struct person */
    struct person *person;      /* or NULL: takes it as it is at the end */
    const char *demo;           /* or NULL: this scene, small, as shown%d.png */
};

static int viewer_that(const struct deed *deeds, const struct setting *setting) {
    static struct person person;
    person = (struct person){.deeds = deeds, .large = setting->large, .other_scene = setting->other_scene};
    const struct window_driver driver = {.context = &person,
                                         .state = &person.state,
                                         .open = person_open,
                                         .close = person_close,
                                         .poll = person_poll,
                                         .descriptor = person_descriptor,
                                         .show = person_show,
                                         .nodes = person_nodes};
    struct arena arena = {0};
    struct options options;
    struct error error;
    const char *option = setting->option ? setting->option : "--progress=none";
    const char *overlay = setting->overlay ? setting->overlay : "none";
    char *words[] = {"gray",     "-gui", "-q", (char *)(uintptr_t)option, "--overlay", (char *)(uintptr_t)overlay,
                     "scene.lua"};
    char *demo[] = {"gray",
                    "-gui",
                    "-q",
                    "--progress=none",
                    "--size",
                    "48x32",
                    "--spp",
                    "4",
                    "-o",
                    "shown%d.png",
                    (char *)(uintptr_t)setting->demo};
    char before[4096], library[4200];
    CHECK(getcwd(before, sizeof before) && chdir(test_folder()) == 0);
    (void)snprintf(library, sizeof library, "%s/lua", before);
    test_write_text("scene.lua", setting->scene ? setting->scene : scene);
    CHECK(setting->demo ? options_parse(&options, 11, demo, &arena, &error)
                        : options_parse(&options, 7, words, &arena, &error));
    options.script.library_folder = library;
    int status = supervisor_run(&options, &(struct program_parts){.window = &driver});
    CHECK(!person.open);
    if (setting->person)
        *setting->person = person;
    arena_destroy(&arena);
    CHECK(chdir(before) == 0);
    return status;
}

static int viewer_with(const struct deed *deeds) {
    return viewer_that(deeds, &(struct setting){0});
}

TEST(window_goes_on_after_a_stop_to_the_picture_of_one_that_was_never_stopped) {
    const struct deed plain[] = {{"ready", ACTION(DO_SAVE_PICTURE), 0}, {NULL, ACTION(DO_QUIT), 0}};
    /* During the first build, during a pass, and with Esc. */
    const struct deed stopped[] = {
        {NULL, ACTION(DO_STOP), 0},      {SETTLED, ACTION(DO_RENDER), 0}, {NULL, ACTION(DO_STOP), 2},
        {SETTLED, ACTION(DO_RENDER), 0}, {NULL, ACTION(DO_ESCAPE), 5},    {SETTLED, ACTION(DO_RENDER), 0},
        {NULL, ACTION(DO_STOP), 0},      {"stopped", ACTION(DO_STOP), 0}, {"ready", ACTION(DO_SAVE_PICTURE), 0},
        {NULL, ACTION(DO_QUIT), 0}};
    CHECK_EQ_INT(viewer_with(plain), 0);
    CHECK(rename(test_path("out.png"), test_path("whole.png")) == 0);
    CHECK_EQ_INT(viewer_with(stopped), 0);
    CHECK(test_same_files("out.png", "whole.png") && test_same_files("out-view1.png", "out-view2.png"));
}

TEST(window_stops_building_after_an_edit_and_goes_on_with_it_or_without) {
    const struct window_event press = PRESS, release = RELEASE;
    const struct window_event undo = ACTION(DO_UNDO), again = ACTION(DO_REDO);
    const struct deed begin[] = {{"ready", press, 0}, {NULL, release, 0}, {"ready", ACTION(DO_DELETE), 0}};
    enum { BEGIN = 3, ROUNDS = 3, ROUND = 6 };
    struct deed deeds[BEGIN + ROUNDS * ROUND + 2];
    int count = 0;
    for (; count < BEGIN; count++)
        deeds[count] = begin[count];
    for (int i = 0; i < ROUNDS; i++) {
        const struct deed round[ROUND] = {
            {NULL, ACTION(DO_STOP), 3 * i},       /* the world without the ball */
            {SETTLED, undo, 0},                   /* continues with the ball */
            {NULL, ACTION(DO_ESCAPE), 3 * i + 1}, /* stopped, too */
            {SETTLED, ACTION(DO_STOP), 0},
            {"ready", ACTION(DO_SAVE_PICTURE), 0},
            {"ready", again, 0},
        };
        for (int k = 0; k < ROUND; k++)
            deeds[count++] = round[k];
    }
    deeds[count++] = (struct deed){"ready", ACTION(DO_SAVE_PICTURE), 0};
    deeds[count++] = (struct deed){NULL, ACTION(DO_QUIT), 0};
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
    const struct deed deeds[] = {{"ready", ACTION(DO_BOXES), 0}, {"ready", ACTION(DO_SAVE_PICTURE), 0},
                                 {NULL, ACTION(DO_GRID), 0},     {"ready", ACTION(DO_SAVE_PICTURE), 0},
                                 {NULL, ACTION(DO_GRID), 0},     {"ready", ACTION(DO_SAVE_PICTURE), 0},
                                 {NULL, ACTION(DO_QUIT), 0}};
    const struct deed nothing[] = {{"ready", ACTION(DO_BOXES), 0}, {"ready", ACTION(DO_QUIT), 0}};
    CHECK_EQ_INT(viewer_with(deeds), 0);
    picture_without_window("boxes", "boxes.png");
    picture_without_window("grid", "grid.png");
    CHECK(test_same_files("out-view1.png", "boxes.png") && test_same_files("out-view2.png", "grid.png"));
    CHECK(test_same_files("out-view3.png", "out.png") && !test_same_files("out.png", "boxes.png"));
    /* Requested on the command line, they are part of the script's picture. */
    CHECK_EQ_INT(viewer_that(nothing, &(struct setting){.overlay = "boxes"}), 0);
    CHECK(test_same_files("out.png", "boxes.png"));
}

TEST(window_outlines_what_is_picked_by_its_silhouette) {
    static struct person person;
    const struct deed deeds[] = {
        {"ready", PRESS, 0}, {NULL, RELEASE, 0}, {"ready", ACTION(DO_STOP), 0}, {NULL, ACTION(DO_QUIT), 20}};
    CHECK_EQ_INT(viewer_that(deeds, &(struct setting){.person = &person}), 0);
    /* A ball of radius 1 at distance 6, with a field of view of 40 degrees for 480 pixels; a pixel of the picture is 10
     * wide. */
    double radius = HIGH / 2.0 * tan(asin(1.0 / 6)) / tan(20 * M_PI / 180);
    bool turns[12] = {false};
    for (uint32_t i = 0; i < person.state.line_count; i++) {
        const struct window_line *line = &person.state.lines[i];
        double dx = (double)(line->x0 + line->x1) / 2 - WIDE / 2.0, dy = (double)(line->y0 + line->y1) / 2 - HIGH / 2.0;
        bool straight = line->x0 >= line->x1 && line->x0 <= line->x1; /* an upright side of pixels */
        straight = straight || (line->y0 >= line->y1 && line->y0 <= line->y1);
        double far = hypot(dx, dy);
        if (line->colour != LINE_COLOUR_SELECTED || !straight || far < 20) /* the mark of the click */
            continue;
        CHECK(far > radius - 16 && far < radius + 16);
        turns[(int)((atan2(dy, dx) / M_PI + 1) * 5.999)] = true;
    }
    for (int i = 0; i < 12; i++)
        CHECK(turns[i]);
}

TEST(window_says_when_a_file_is_saved_and_prints_no_progress_in_the_terminal) {
    const struct deed deeds[] = {{"out.png is written", ACTION(DO_SAVE_PICTURE), 0},
                                 {"out-view1.png is written", ACTION(DO_SAVE_VIEW), 0},
                                 {"out-view1.lua is written", ACTION(DO_SAVE_CHANGES), 0},
                                 {"out-changes1.lua is written", KEY(FLY_FORWARD), 0},
                                 {NULL, KEY_UP(FLY_FORWARD), 30},
                                 {"ready", ACTION(DO_STOP), 0},
                                 {NULL, ACTION(DO_QUIT), 30}};
    size_t size;
    CHECK(freopen(test_path("said.txt"), "w", stderr) != NULL);
    CHECK_EQ_INT(viewer_that(deeds, &(struct setting){.option = "--progress=bar"}), 0);
    CHECK(fflush(stderr) == 0);
    char *said = test_read_file(test_path("said.txt"), &size);
    CHECK_TEXT(said, "");
    free(said);
}

TEST(window_exports_the_model_that_the_command_line_writes_and_says_what_is_wrong) {
#define EXPORT(name)                                                                                                   \
    { .kind = WINDOW_ACTION, .action = DO_EXPORT_MODEL, .text = name }
    static const char ball[] =
        "for i = 1, 2 do\n"
        "    gr.render{node = gr.sphere{radius = i}, file = 'ball' .. i .. '.png', width = 64, eye = {0, "
        "0, 9}, view = {0, 0, -1}}\n"
        "end\n";
    const struct deed deeds[] = {{"ready", ACTION(DO_NEXT_PICTURE), 0},
                                 {"ball2.png", ACTION(DO_HIDE), 0},
                                 {"ready", EXPORT("ball.stl"), 0},
                                 {"ball.stl is written", EXPORT("ball.wrl"), 0},
                                 {"ball.wrl: the name of a model ends in", EXPORT("notes.stl"), 0},
                                 {"notes.stl: exists already and is not a model", ACTION(DO_QUIT), 0}};
    test_write_text(test_path("notes.stl"), "my notes\n");
    CHECK_EQ_INT(viewer_that(deeds, &(struct setting){.scene = ball}), 0);
    struct test_result result = test_gray(NULL, "-q scene.lua -o same.stl --picture 2");
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    CHECK(test_same_files("ball.stl", "same.stl"));
    /* A deleted ball is not there. */
    static const char two[] =
        "local all = gr.node{name = 'all', children = {gr.sphere{name = 'near', radius = 1},\n"
        "    gr.sphere{name = 'far', centre = {5, 0, 0}, radius = 1}}}\n"
        "gr.render{node = all, file = 'two.png', width = 64, eye = {0, 0, 9}, view = {0, 0, -1}}\n";
    const struct window_event press = PRESS, release = RELEASE;
    const struct deed edit[] = {{"ready", press, 0},
                                {NULL, release, 0},
                                {"ready", ACTION(DO_DELETE), 0},
                                {"ready", EXPORT("two.stl"), 0},
                                {"two.stl is written", ACTION(DO_QUIT), 0}};
    CHECK_EQ_INT(viewer_that(edit, &(struct setting){.scene = two}), 0);
    result = test_gray(NULL, "-q scene.lua -o same.stl --node far");
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    CHECK(test_same_files("two.stl", "same.stl"));
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
    const struct deed deeds[] = {{"ready  frame 5/5", ACTION(DO_SAVE_PICTURE), 0},
                                 {NULL, ACTION(DO_PREVIOUS_FRAME), 0},
                                 {"ready  frame 4/5", ACTION(DO_PREVIOUS_FRAME), 0},
                                 {"ready  frame 3/5", ACTION(DO_SAVE_PICTURE), 0},
                                 {NULL, ACTION(DO_NEXT_FRAME), 0},
                                 {"ready  frame 4/5", ACTION(DO_PLAY), 0},
                                 {"ready  frame 5/5", ACTION(DO_LOOP), 0},
                                 {NULL, ACTION(DO_PLAY), 0}, /* in a loop */
                                 {"playing", ACTION(DO_PLAY), 150},
                                 {"ready", ACTION(DO_LOOP), 0},
                                 {NULL, ACTION(DO_PLAY), 0},
                                 {"ready  frame 5/5", ACTION(DO_SAVE_PICTURE), 0},
                                 {NULL, ACTION(DO_QUIT), 0}};
    const struct setting setting = {.scene = ANIMATION("0.8", "f")};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
    CHECK(access(test_path("f.0005.png"), F_OK) != 0 && access(test_path("f.####.png"), F_OK) != 0);
    CHECK(saved_frame("f", 5, 1) && saved_frame("f", 3, 1) && saved_frame("f", 5, 2));
}

TEST(window_with_a_changed_script_stays_at_the_frame_that_it_shows) {
    const struct deed deeds[] = {{"ready  frame 5/5", ACTION(DO_PREVIOUS_FRAME), 0},
                                 {"ready  frame 4/5", {.kind = WINDOW_LEAVE}, 0},
                                 {"g.####.png  64x48  ready  frame 4/5", ACTION(DO_SAVE_PICTURE), 0},
                                 {NULL, ACTION(DO_QUIT), 0}};
    const struct setting setting = {
        .scene = ANIMATION("0.8", "f"), .option = "--watch", .other_scene = ANIMATION("0.3", "g")};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
    CHECK(saved_frame("g", 4, 1));
}

TEST(window_goes_on_after_an_animation_and_plays_turntables_and_scripts_of_one_frame) {
    const struct deed turns[] = {{"playing", ACTION(DO_PLAY), 0},
                                 {"ready", ACTION(DO_NEXT_FRAME), 0},
                                 {"ready", ACTION(DO_NEXT_PICTURE), 0},
                                 {"none", ACTION(DO_QUIT), 0}};
    const struct deed frames[] = {{"ready  frame 3/3", ACTION(DO_PREVIOUS_FRAME), 0},
                                  {"ready  frame 2/3", ACTION(DO_QUIT), 0}};
    static const char ball[] =
        "gr.render(gr.sphere(gr.material({1, 1, 1}, {0, 0, 0}, 1)), 'out.png', 64, 48, {0, 0, 6}, "
        "{0, 0, -1}, {0, 1, 0}, 40, {1, 1, 1}, {})\n";
    CHECK_EQ_INT(viewer_that(turns, &(struct setting){.scene = ball, .option = "--turntable=4"}), 0);
    CHECK_EQ_INT(viewer_that(frames, &(struct setting){.scene = ball, .option = "--frames=3"}), 0);
}

/* At the size of the picture the pixels of the window are squares of 10 x 10. */
TEST(window_larger_than_the_picture_shows_it_with_the_pixels_of_the_window) {
    static uint8_t large[3 * WIDE * HIGH];
    const struct deed deeds[] = {{"ready", ACTION(DO_SAVE_PICTURE), 0}, {"ready  ", ACTION(DO_QUIT), 0}};
    const struct setting setting = {
        .scene = "local r = gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.1}, {0.4, 0.4, 0.4}, 20)))\n"
                 "gr.render{node = r, file = 'out.png', width = 64, height = 48, eye = {0, 0, 3}, view = {0, 0, -1}}\n",
        .large = large};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
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
    const struct deed quits[] = {{"scene.lua  640x480  the script runs", ACTION(DO_SAVE_PICTURE), 0},
                                 {"runs", ACTION(DO_QUIT), 0}};
    const struct deed waits[] = {{"the script runs", ACTION(DO_BOXES), 0}, {"64x48  ready", ACTION(DO_QUIT), 0}};
    CHECK_EQ_INT(viewer_that(quits, &(struct setting){.scene = "while true do end\n"}), 130);
    const struct setting slow = {.scene =
                                     "local t = os.clock()\nwhile os.clock() - t < 0.5 do end\n" ANIMATION("0.5", "f")};
    CHECK_EQ_INT(viewer_that(waits, &slow), 0);
}

/* The moment of the end is unknown: several are tried. The tiles of another view are none of the picture. */
TEST(window_that_closes_during_a_picture_leaves_a_partial_one_of_its_own_view) {
    struct setting setting = {
        .scene = "local r = gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.1}, {0.4, 0.4, 0.4}, 20)))\n"
                 "gr.render(r, 'out.png', 640, 480, {0, 0, 3}, {0, 0, -1}, {0, 1, 0}, 60, {.3, .3, .3},\n"
                 "  {gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0})}, {samples = 12, full = true})\n"};
    for (int pause = 20; pause < 1000 && access(test_path("out.partial.png"), F_OK) != 0; pause += 20) {
        const struct deed quits[] = {{NULL, ACTION(DO_QUIT), pause}};
        CHECK_EQ_INT(viewer_that(quits, &setting), 130);
    }
    struct test_picture picture = test_read_picture(test_path("out.partial.png"));
    CHECK_EQ_INT(picture.width, 640);
    free(picture.rgb);
    CHECK(access(test_path("out.png"), F_OK) != 0 && remove(test_path("out.partial.png")) == 0);
    const struct deed flies[] = {
        {"%", KEY(FLY_FORWARD), 5}, {NULL, KEY_UP(FLY_FORWARD), 5}, {NULL, ACTION(DO_QUIT), 200}};
    CHECK_EQ_INT(viewer_that(flies, &setting), 130);
    CHECK(access(test_path("out.partial.png"), F_OK) != 0);
}

TEST(window_that_watches_opens_for_an_error_before_the_first_picture) {
    const struct deed deeds[] = {{"scene.lua:1", {.kind = WINDOW_LEAVE}, 0}, {"64x48  ready", ACTION(DO_QUIT), 0}};
    const struct setting setting = {
        .scene = "gr.no_such_thing()\n", .option = "--watch", .other_scene = ANIMATION("0.5", "f")};
    CHECK(freopen("/dev/null", "w", stderr) != NULL);
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
}

TEST(window_ends_with_the_denoised_picture_of_paths_also_after_a_restart) {
    const struct deed deeds[] = {{"out.png is written", KEY(FLY_FORWARD), 0},
                                 {NULL, KEY_UP(FLY_FORWARD), 10},
                                 {NULL, ACTION(DO_CAMERA), 5},
                                 {NULL, ACTION(DO_RENDER), 5},
                                 {"ready", ACTION(DO_SAVE_PICTURE), 0},
                                 {NULL, ACTION(DO_QUIT), 0}};
    const struct setting setting = {
        .scene = "local r = gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.1}, {0.4, 0.4, 0.4}, 20)))\n"
                 "gr.render{node = r, file = 'out.png', width = 64, height = 48, eye = {0, 0, 3}, view = {0, 0, -1},\n"
                 "  integrator = 'path', background = {0.5, 0.6, 0.7}}\n",
        .option = "--denoise"};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
    struct test_result result = test_gray(NULL, "-q --progress=none scene.lua --denoise -o whole.png");
    CHECK_EQ_INT(result.status, 0);
    CHECK(test_same_files("out.png", "whole.png"));
    CHECK(test_same_files("out-view1.png", "whole.png"));
    test_free_result(&result);
}

TEST(window_with_a_changed_setting_makes_the_picture_of_its_option) {
    const struct deed deeds[] = {{"ready", FIELD(INTEGRATOR_PATH), 0, "integrator"},
                                 {NULL, ACTION(DO_HIDE), 100},
                                 {"ready", ACTION(DO_QUIT), 0}};
    const struct setting setting = {.option = "--watch"};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
    struct test_result result = test_gray(NULL, "-q --progress=none scene.lua --integrator path -o whole.png");
    CHECK_EQ_INT(result.status, 0);
    CHECK(test_same_files("out.png", "whole.png"));
    test_free_result(&result);
}

/* Few samples come first, and the last pass has all of them. */
TEST(window_that_shows_paths_denoised_ends_with_the_picture_of_the_program) {
    const struct deed deeds[] = {{"ready", ACTION(DO_QUIT), 0}};
    const struct setting setting = {
        .scene = "local r = gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.1}, {0.4, 0.4, 0.4}, 20)))\n"
                 "gr.render{node = r, file = 'out.png', width = 64, height = 48, eye = {0, 0, 3}, view = {0, 0, -1},\n"
                 "  integrator = 'path', denoise = true, background = {0.5, 0.6, 0.7}}\n"};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
    struct test_result result = test_gray(NULL, "-q --progress=none scene.lua -o whole.png");
    CHECK_EQ_INT(result.status, 0);
    CHECK(test_same_files("out.png", "whole.png"));
    test_free_result(&result);
}

TEST(window_shows_how_much_light_of_radiosity_is_not_shot_and_ends_with_the_picture_of_the_program) {
    const struct deed deeds[] = {{"of the light is not shot", ACTION(DO_PATCHES), 0},
                                 {"ready", ACTION(DO_SHOW_FACTORS), 20},
                                 {"ready", ACTION(DO_PATCHES), 20},
                                 {"ready", ACTION(DO_SHOW_PICTURE), 20},
                                 {"ready", ACTION(DO_QUIT), 20}};
    const struct setting setting = {
        .scene =
            "local r = gr.node('r')\n"
            "local m = gr.material{kd = {0.7, 0.5, 0.3}, two_sided = true}\n"
            "r:add_child(gr.box{material = m, min = {-2, -2, -2}, max = {2, 2, 4}})\n"
            "r:add_child(gr.box{material = m, min = {-1, -1.9, -1}, max = {0.5, 0.5, 1}})\n"
            "gr.render{node = r, file = 'out.png', width = 64, height = 48, eye = {0, 0, 3.5}, view = {0, 0, -1},\n"
            "  integrator = 'radiosity', radiosity_patches = 4000,\n"
            "  lights = {gr.light{position = {1, 1.5, 2}, colour = {3, 3, 3}}}}\n"};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
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
        {"ready", ACTION(DO_QUIT), 20}};
    static struct person person;
    CHECK_EQ_INT(viewer_that(deeds, &(struct setting){.person = &person}), 0);
    CHECK(person.seen_nodes[0] == NODE_SECTIONS && person.seen_nodes[1] == 2 && person.seen_nodes[2] == 0);
    char *saved = test_read_file(test_path("out-changes1.lua"), NULL);
    CHECK(saved && strstr(saved, "gr.change_delete('many', "));
    free(saved);
}

/* Edits. What the window saves gives the bytes of the picture that it showed, without a window. */

static void check_saved(int number) {
    char line[512];
    (void)snprintf(
        line, sizeof line,
        "{ echo \"require 'out-changes%d'\"; cat scene.lua; } >again.lua && $gray -q --progress=none again.lua "
        "-o again.png && cmp again.png out-view%d.png && ! cmp -s again.png out.png",
        number, number);
    int status = test_run_shell(line, ">out.txt 2>err.txt");
    if (status != 0)
        test_fail(__FILE__, __LINE__, "%s\nstatus %d", line, status);
}

static void check_contains(const char *name, const char *const *words) {
    char *text = test_read_file(test_path(name), NULL);
    for (int i = 0; words[i]; i++) {
        if (!text || !strstr(text, words[i]))
            test_fail(__FILE__, __LINE__, "%s has no %s:\n%s", name, words[i], text ? text : "");
    }
    free(text);
}

#define BALL                                                                                                           \
    "local red = gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20)\nlocal r = gr.node('root')\n"                       \
    "r:add_child(gr.geometry('ball', gr.sphere(red)))\n"
#define RENDER(lights)                                                                                                 \
    "gr.render(r, 'out.png', 64, 48, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2}, {" lights "})\n"
#define LIGHT "gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0})"
#define SAVE                                                                                                           \
    {"ready", ACTION(DO_SAVE_CHANGES), 10}, {                                                                          \
        "ready", ACTION(DO_SAVE_PICTURE), 0                                                                            \
    }
#define UNDO                                                                                                           \
    { "ready", ACTION(DO_UNDO), 0 }
#define QUIT                                                                                                           \
    { NULL, ACTION(DO_QUIT), 20 }

TEST(window_that_turns_sizes_recolours_and_deletes_lights_saves_what_gives_the_same_bytes) {
    const struct setting setting = {
        .scene = BALL RENDER("gr.directional_light{direction={-1, -1, -0.5}, colour={0.4, 0.3, 0.3}}, "
                             "gr.area_light({-1, 3, 0}, {2, 0, 0}, {0, 0, 2}, {0.3, 0.3, 0.4}, {1, 0, 0}), "
                             "gr.spot_light{position={3, 1, 3}, direction={-3, -1, -3}, colour={0.5, 0.5, 0}, inner=5, "
                             "outer=8}, gr.sky_light{sky={0.2, 0.2, 0.3}}")};
    const struct deed deeds[] = {{"ready", ACTION(DO_NEXT_LIGHT), 0},
                                 {NULL, FIELD(20, 30, 0), 5, "rotate by"},
                                 {"ready", ACTION(DO_NEXT_LIGHT), 0},
                                 {NULL, FIELD(1.5), 5, "scale by"},
                                 {"ready", FIELD(-1), 5, "brightness"},
                                 {"ready", ACTION(DO_NEXT_LIGHT), 0},
                                 {NULL, FIELD(2, 1.5, 3), 5, "centre"},
                                 {"ready", FIELD(0.1, 0.2, 0.6), 5, "colour"},
                                 {"ready", ACTION(DO_NEXT_LIGHT), 0},
                                 {NULL, ACTION(DO_DELETE), 5},
                                 SAVE,
                                 UNDO,
                                 UNDO,
                                 UNDO,
                                 UNDO,
                                 UNDO,
                                 UNDO,
                                 {"ready", ACTION(DO_SAVE_PICTURE), 20},
                                 QUIT};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
    check_saved(1);
    CHECK(test_same_files("out-view2.png", "out.png"));
    check_contains("out-changes1.lua", (const char *[]){"gr.change_light(1, {0, 0, 0}, {1, 1, 1}, {",
                                                        "gr.change_light(2, {0, 0, 0}, {0.5,", "gr.change_light(3, {-1",
                                                        "{0.10000000000000001, ", "gr.change_delete_light(4", NULL});
}

TEST(window_that_gives_a_shape_a_material_saves_what_gives_the_same_bytes) {
    const struct setting setting = {.scene = "local r = gr.node('root')\n"
                                             "r:add_child(gr.geometry('ball', gr.sphere('plain')))\n" RENDER(LIGHT)};
    const struct deed deeds[] = {{"ready", PRESS, 0},
                                 {NULL, RELEASE, 0},
                                 {"ready", ACTION(DO_OWN_MATERIAL), 5},
                                 {NULL, FIELD(0.9, 0.2, 0.1), 5, "kd"},
                                 {"ready", FIELD(0, 0, 0.5), 5, "emission"},
                                 SAVE,
                                 UNDO,
                                 UNDO,
                                 UNDO,
                                 {"ready", ACTION(DO_SAVE_PICTURE), 20},
                                 QUIT};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
    check_saved(1);
    CHECK(test_same_files("out-view2.png", "out.png"));
    check_contains("out-changes1.lua", (const char *[]){"change_own", "change_material(2147483647, ",
                                                        "change_look(2147483647, 'emission', ", NULL});
}

/* A ball is subtracted from a larger one: a click with control in the middle selects the hollow. */
TEST(window_that_changes_operands_of_a_solid_saves_what_gives_the_same_bytes) {
    struct window_event press = PRESS, release = RELEASE;
    press.control = release.control = true;
    const struct setting setting = {
        .scene = "local function m(r, g, b) return gr.material({r, g, b}, {0.4, 0.4, 0.4}, 20) end\n"
                 "local r = gr.node('root')\n"
                 "local a, b = gr.geometry('a', gr.sphere(m(0.8, 0.2, 0.1))), gr.geometry('b', gr.sphere(m(0.1, 0.8, "
                 "0.1)))\n"
                 "a:scale(1.5, 1.5, 1.5)\nb:translate(0, 0, 1.2)\nr:add_child(gr.csg_difference('cut', a, "
                 "b))\n" RENDER(LIGHT)};
    const struct deed deeds[] = {{"ready", press, 0},
                                 {NULL, release, 0},
                                 {"ready", FIELD(0.3, 0.2, 1.2), 5, "centre"},
                                 {"ready", FIELD(0.8), 5, "scale by"},
                                 SAVE,
                                 UNDO,
                                 UNDO,
                                 {"ready", ACTION(DO_DELETE), 20},
                                 SAVE,
                                 UNDO,
                                 {"ready", press, 20},
                                 {NULL, release, 0},
                                 {"ready", ACTION(DO_SELECT_PARENT), 20},
                                 {"ready", ACTION(DO_DELETE), 20},
                                 SAVE,
                                 UNDO,
                                 {"ready", ACTION(DO_SAVE_PICTURE), 20},
                                 QUIT};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
    for (int i = 1; i <= 3; i++)
        check_saved(i);
    CHECK(test_same_files("out-view4.png", "out.png"));
    check_contains("out-changes1.lua", (const char *[]){"gr.change_node('b', ", NULL});
    check_contains("out-changes2.lua", (const char *[]){"gr.change_delete('b', ", NULL});
    check_contains("out-changes3.lua", (const char *[]){"gr.change_delete('cut', ", NULL});
}

TEST(window_that_turns_a_sky_turns_what_is_seen_behind_and_saves_what_gives_the_same_bytes) {
    const struct setting setting = {
        .scene = BALL
        "local s = gr.clear_sky{sun={0.6, 0.5, 1}, intensity=0.05}\n"
        "gr.render{node=r, file='out.png', width=64, height=48, eye={0, 1, 6}, view={0, -0.15, -1}, up={0, 1, 0}, "
        "fov=40, ambient={0, 0, 0}, background=s, lights={gr.sky_light{sky=s, samples=1}}}\n"};
    const struct deed deeds[] = {{"ready", ACTION(DO_NEXT_LIGHT), 0},
                                 {NULL, FIELD(0, 70, 0), 5, "rotate by"},
                                 {"ready", FIELD(20, 0, 0), 5, "rotate by"}, /* which has no effect */
                                 SAVE,
                                 QUIT};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
    check_saved(1);
    check_contains("out-changes1.lua", (const char *[]){"gr.change_light(1, {0, 0, 0}, {1, 1, 1}, {0.342", NULL});
}

TEST(window_that_has_more_lights_than_one_message_changes_the_last_one) {
    const struct setting setting = {
        .scene =
            BALL "local lamps = {}\nfor i = 1, 70 do lamps[i] = gr.light({math.sin(i) * 5, 3, math.cos(i) * 5}, "
                 "{0.005, 0.005, 0.005}, {1, 0, 0}) end\nlamps[71] = gr.sun_light{sun={1, 2, 3}, colour={0.4, 0.4, "
                 "0.3}}\n"
                 "gr.render(r, 'out.png', 64, 48, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2}, lamps)\n"};
    const struct deed deeds[] = {{"ready", ACTION(DO_PREVIOUS_LIGHT), 30},
                                 {NULL, FIELD(0, 40, 20), 5, "rotate by"},
                                 SAVE,
                                 UNDO,
                                 {"ready", ACTION(DO_SAVE_PICTURE), 20},
                                 QUIT};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
    check_saved(1);
    CHECK(test_same_files("out-view2.png", "out.png"));
    check_contains("out-changes1.lua", (const char *[]){"gr.change_light(71, ", NULL});
}

/* A camera saved before any movement is the script's in every digit; one that was moved gives the picture of the view.
 */
TEST(window_saves_cameras_that_give_the_same_bytes) {
    const struct deed deeds[] = {{"ready", ACTION(DO_SAVE_VIEW), 0},    {NULL, ACTION(DO_VIEW_TOP), 0},
                                 {"ready", ACTION(DO_BRIGHTER), 20},    {"ready", ACTION(DO_SAVE_CHANGES), 20},
                                 {"ready", ACTION(DO_SAVE_PICTURE), 0}, QUIT};
    CHECK_EQ_INT(viewer_that(deeds, &(struct setting){.scene = BALL RENDER(LIGHT)}), 0);
    CHECK(rename(test_path("out-view1.png"), test_path("view.png")) == 0);
    CHECK_EQ_INT(
        test_run_shell("{ echo \"require 'out-view1'\"; cat scene.lua; } >again.lua && $gray -q again.lua -o "
                       "again.png && cmp again.png out.png && { echo \"require 'out-changes1'\"; cat scene.lua; } "
                       ">again.lua && $gray -q again.lua -o again.png && cmp again.png view.png && ! cmp -s "
                       "view.png out.png",
                       ">out.txt 2>err.txt"),
        0);
}

TEST(window_ends_a_script_that_makes_no_picture_and_runs_the_mended_one) {
    const struct deed deeds[] = {{"the script runs", ACTION(DO_ESCAPE), 0},
                                 {"waiting for a change", {.kind = WINDOW_LEAVE}, 0},
                                 {"64x48  ready", ACTION(DO_QUIT), 0}};
    const struct setting setting = {
        .scene = "while true do end\n", .option = "--watch", .other_scene = BALL RENDER(LIGHT)};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
}

/* A node is found by its name, hidden, shown, and the scene is as before. */
TEST(window_finds_hides_and_shows_a_node) {
    const struct window_event find = {.kind = WINDOW_NODES, .node.search = "BAL"};
    const struct window_event hide = {.kind = WINDOW_HIDE, .node.serial = 2, .text = "ball"};
    const struct deed deeds[] = {{"ready", find, 0},
                                 {"ready", hide, 10},
                                 {"ready", ACTION(DO_SAVE_PICTURE), 20},
                                 {"ready", hide, 10},
                                 {"ready", ACTION(DO_SAVE_PICTURE), 20},
                                 QUIT};
    static struct person person;
    CHECK_EQ_INT(viewer_that(deeds, &(struct setting){.scene = BALL RENDER(LIGHT), .person = &person}), 0);
    CHECK_EQ_INT(person.seen_nodes[0], 1);
    CHECK(!test_same_files("out-view1.png", "out.png") && test_same_files("out-view2.png", "out.png"));
}

/* Its operands are children; the path of what was clicked leads to it. */
TEST(window_lists_operands_and_the_path_of_what_is_clicked) {
    struct window_event press = PRESS, release = RELEASE;
    press.control = release.control = true;
    static struct person person;
    const struct deed deeds[] = {{"ready", {.kind = WINDOW_NODES, .node = {.depth = 2, .path = {0, 1}}}, 0},
                                 {"ready", press, 10},
                                 {NULL, release, 0},
                                 {"ready", ACTION(DO_HIDE), 20},
                                 {"ready", ACTION(DO_QUIT), 20}};
    const struct setting setting = {
        .scene = "local m = gr.material({0.5, 0.5, 0.5}, {0, 0, 0}, 1)\nlocal r = gr.node('root')\n"
                 "local a, b = gr.geometry('a', gr.sphere(m)), gr.geometry('b', gr.sphere(m))\n"
                 "a:scale(1.5, 1.5, 1.5)\nb:translate(0, 0, 1.2)\nr:add_child(gr.node('other'))\n"
                 "r:add_child(gr.csg_difference('cut', a, b))\n" RENDER(LIGHT),
        .person = &person};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
    CHECK_EQ_INT(person.seen_nodes[2], 2);
    const struct node_query *path = &person.state.selected;
    CHECK(path->depth == 3 && path->path[0] == 0 && path->path[1] == 1 && path->path[2] == 1);
}

/* A ball in a group beside another one: alone it is what a script without the other shows. */
TEST(window_shows_a_node_alone_and_everything_again) {
#define TWO(other)                                                                                                     \
    "local m = gr.material({0.5, 0.5, 0.5}, {0, 0, 0}, 1)\nlocal r, g = gr.node('root'), gr.node('group')\n"           \
    "r:add_child(g)\ng:add_child(gr.geometry('a', gr.sphere(m)))\n" other                                              \
    RENDER(LIGHT)
    const struct setting setting = {.scene =
                                        TWO("g:add_child(gr.geometry('b', gr.sphere(m)):translate(1.5, 0, 0))\n"
                                            "r:add_child(gr.geometry('c', gr.sphere(m)):translate(-1.5, 0, 0))\n")};
    const struct deed deeds[] = {{"ready", {.kind = WINDOW_SELECT, .node = {.depth = 3, .path = {0, 0, 0}}}, 0},
                                 {"ready", ACTION(DO_SOLO), 20},
                                 {"ready", ACTION(DO_SAVE_PICTURE), 20},
                                 {"ready", ACTION(DO_SOLO), 0},
                                 {"ready", ACTION(DO_SAVE_PICTURE), 20},
                                 {"ready", ACTION(DO_SAVE_CHANGES), 0},
                                 QUIT};
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
    CHECK(test_same_files("out-view2.png", "out.png") && !test_same_files("out-view1.png", "out.png"));
    test_write_text(test_path("one.lua"), TWO(""));
    CHECK_EQ_INT(test_run_shell("$gray -q --progress=none one.lua -o one.png && cmp one.png out-view1.png", ">out.txt"),
                 0);
}

TEST(window_changes_a_material_of_the_list_and_saves_under_a_chosen_name) {
    const struct window_event save = {.kind = WINDOW_ACTION, .action = DO_SAVE_PICTURE, .text = "mine.png"};
    const struct deed deeds[] = {
        {"ready", {.kind = WINDOW_NODES, .node = {.depth = 1, .path = {SECTION_MATERIALS}}}, 0},
        {"ready", {.kind = WINDOW_SELECT, .node = {.depth = 2, .path = {SECTION_MATERIALS, 0}}}, 0},
        {NULL, FIELD(0.1, 0.2, 0.9), 5, "kd"},
        {"ready", save, 20},
        {"mine.png is written", save, 0},
        {"mine.png: the file exists", ACTION(DO_SAVE_CHANGES), 0},
        {NULL, ACTION(DO_SAVE_PICTURE), 5},
        QUIT};
    static struct person person;
    CHECK_EQ_INT(viewer_that(deeds, &(struct setting){.scene = BALL RENDER(LIGHT), .person = &person}), 0);
    CHECK(person.seen_nodes[1] >= 1 && test_same_files("mine.png", "out-view1.png"));
    check_saved(1);
    check_contains("out-changes1.lua", (const char *[]){"gr.change_material(", NULL});
}

/* Adding. */

#define ADD(lua)                                                                                                       \
    { .kind = WINDOW_ADD, .text = lua }

/* All at once: the file has every call, and no edit was skipped. */
static void add_all(int rows) {
    enum { LIMIT = 128 };
    static struct deed deeds[LIMIT];
    static struct person person;
    const struct setting setting = {.scene = BALL RENDER(LIGHT), .person = &person};
    int count = 0, step = 0;
    while (addable_txt[ADDABLE_COLUMNS * step])
        step++;
    step = step / rows > 0 ? step / rows : 1;
    for (const char *const *row = addable_txt; *row && count < LIMIT - 4; row++) {
        bool call = (row - addable_txt) % ADDABLE_COLUMNS == ADDABLE_CALL;
        if (!call || (row - addable_txt) / ADDABLE_COLUMNS % step != 0)
            continue;
        deeds[count] = (struct deed){"ready", ADD(""), 10};
        (void)snprintf(deeds[count++].event.text, 1024, "%s", *row);
    }
    int added = count;
    deeds[count++] = (struct deed){"ready", ACTION(DO_SAVE_CHANGES), 10};
    deeds[count++] = (struct deed){"ready", ACTION(DO_SAVE_PICTURE), 0};
    deeds[count++] = (struct deed)QUIT;
    CHECK_EQ_INT(viewer_that(deeds, &setting), 0);
    check_saved(1);
    char *saved = test_read_file(test_path("out-changes1.lua"), NULL);
    int calls = 0;
    for (const char *at = saved; at && (at = strstr(at, "gr.change_add")); at++)
        calls++;
    CHECK_EQ_INT(calls, added);
    free(saved);
    CHECK_EQ_INT(test_run_shell("! grep -q skipped err.txt", ">>out.txt"), 0);
}

TEST(window_that_adds_from_its_list_saves_what_gives_the_same_bytes) {
    add_all(5);
}

TEST_LONG(window_that_adds_everything_of_its_list_saves_what_gives_the_same_bytes) {
    add_all(1000);
}

/* The inspector has the arguments of the call; what the function refuses goes back to what was there. */
TEST(window_changes_the_arguments_of_what_it_has_added) {
    const struct deed deeds[] = {{"ready", ADD("gr.torus{major = 2, minor = 0.25}"), 0},
                                 {"ready", FIELD(0.5), 10, "minor"},
                                 {"ready", FIELD(0.1, 0.6, 0.2), 10, "kd"},
                                 {"ready", FIELD(1e9), 10, "major"},
                                 {"ready", ADD("gr.spot_light{position = {0, 0, 0}, colour = {1, 1, 1}}"), 0},
                                 {"ready", FIELD(10), 20, "outer"},
                                 {"ready", FIELD(20), 20, "outer"},
                                 UNDO,
                                 {"ready", ACTION(DO_SAVE_CHANGES), 20},
                                 {"ready", ACTION(DO_SAVE_PICTURE), 0},
                                 QUIT};
    CHECK_EQ_INT(viewer_that(deeds, &(struct setting){.scene = BALL RENDER(LIGHT)}), 0);
    check_saved(1);
    check_contains("out-changes1.lua",
                   (const char *[]){"'gr.torus{major = 2, minor = 0.5}'", "gr.change_material(4294967295, {0.1",
                                    "colour = {1, 1, 1}, outer = 10}'", NULL});
}

/* Pictures and skies that are dropped, on a surface and beside it. */
TEST(window_takes_a_picture_as_the_texture_of_what_it_was_dropped_on_and_a_sky_as_light_and_background) {
    const struct window_event on = {
        .kind = WINDOW_TEXTURE, .down = true, .x = 320, .y = 240, .text = "gr.texture('p.png')"};
    const struct window_event beside = {
        .kind = WINDOW_TEXTURE, .down = true, .x = 2, .y = 2, .text = "gr.texture('a.png')"};
    const struct deed deeds[] = {{"ready", beside, 0},
                                 {"a picture is for a surface", on, 0},
                                 {"ready", ADD("gr.sky_light{sky = gr.sky_map{image = 'p.png'}}"), 20},
                                 {"ready", ACTION(DO_SAVE_CHANGES), 20},
                                 {"ready", ACTION(DO_SAVE_PICTURE), 0},
                                 UNDO,
                                 UNDO,
                                 {"ready", ACTION(DO_SAVE_PICTURE), 20},
                                 QUIT};
    struct test_result made = test_gray_scene(
        "gr.render{node = gr.sphere{}, file = 'p.png', width = 32, height = 16, background = {0.2, 0.9, 0.3}}",
        "-q scene.lua", NULL);
    test_free_result(&made);
    CHECK_EQ_INT(viewer_that(deeds, &(struct setting){.scene = BALL RENDER(LIGHT)}), 0);
    check_saved(1);
    check_contains("out-changes1.lua", (const char *[]){"gr.change_texture(1, 'gr.texture(", "gr.sky_map{image", NULL});
    CHECK(test_same_files("out-view2.png", "out.png"));
    struct test_picture picture = test_read_picture(test_path("out-view1.png")),
                        plain = test_read_picture(test_path("out.png"));
    CHECK(memcmp(picture.rgb, plain.rgb, 3) != 0); /* the background */
    free(picture.rgb);
    free(plain.rgb);
}

/* What is hidden is hidden in the window only; a call that is wrong says so. */
TEST(window_hides_without_deleting_in_what_it_saves) {
    const struct window_event hide = {.kind = WINDOW_HIDE, .node.serial = 2, .text = "ball"};
    const struct deed deeds[] = {{"ready", hide, 0},
                                 {"ready", ADD("gr.no_such_shape{}"), 20},
                                 {"no_such_shape does not exist", ACTION(DO_UNDO), 0},
                                 {"ready", ACTION(DO_UNDO), 0},
                                 {"ready", ACTION(DO_SAVE_PICTURE), 20},
                                 {"ready", ACTION(DO_SAVE_CHANGES), 0},
                                 QUIT};
    static struct person person;
    CHECK_EQ_INT(viewer_that(deeds, &(struct setting){.scene = BALL RENDER(LIGHT), .person = &person}), 0);
    CHECK(!test_same_files("out-view1.png", "out.png") && !person.state.unsaved);
    CHECK_EQ_INT(test_run_shell("! grep '^gr' out-changes1.lua", ">>out.txt"), 0);
}

/* Demos: the first picture of each. The window writes it as the program without it does, and closes. */

static void check_demo(const char *path) {
    static const struct deed deeds[] = {{"is written", ACTION(DO_QUIT), 0}};
    test_write_text(test_path("demo.txt"), path);
    (void)test_run_shell(
        "demo=$(cat demo.txt) && cd \"$(dirname \"$demo\")\" && $gray -q --progress=none --size 48x32 --spp 4 "
        "--allow-write \"$OLDPWD\" \"$demo\" -o \"$OLDPWD\"/plain%d.png",
        ">>out.txt 2>>err.txt");
    if (access(test_path("plain1.png"), F_OK) != 0) /* a module of other scenes */
        return;
    const struct setting setting = {.demo = path};
    (void)viewer_that(deeds, &setting);
    if (!test_same_files("plain1.png", "shown1.png"))
        test_fail(__FILE__, __LINE__, "%s: the picture of the window differs", path);
    CHECK_EQ_INT(test_run_shell("rm -f plain*.png shown*.png", ""), 0);
}

/* One of forty, or all; without animations, which have tests of their own, and those that write models for minutes. */
TEST_TIMES(window_writes_the_bytes_of_the_program_for_the_demos, 40) {
    char path[4096];
    int number = 0;
    CHECK_EQ_INT(
        test_run_shell("cd \"$(dirname \"$(dirname \"$(dirname \"$(realpath $gray)\")\")\")\" && find $PWD/data -name "
                       "'*.lua' ! -path '*/animation/*' ! -path '*/print/*' ! -name 'make_*' | sort",
                       ">demos.txt"),
        0);
    FILE *list = fopen(test_path("demos.txt"), "r");
    while (list && fgets(path, sizeof path, list)) {
        path[strcspn(path, "\n")] = '\0';
        if (number++ % (40 / times) == 0)
            check_demo(path);
    }
    CHECK(number > 50);
    if (list)
        (void)fclose(list);
}
