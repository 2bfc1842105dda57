/* Stop: what is rendered or built ends, what is shown stays, and it goes on when somebody wants it. The whole program
 * under a window without a screen. When exactly a stop comes is not known, so several moments are tried. */
#define _GNU_SOURCE
#include "app/supervisor.h"
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Somebody who waits for words in the title, and then does something. */
struct deed {
    const char *title; /* NULL: at once */
    struct window_event event;
    int pause; /* questions for events before it; one every few milliseconds */
};

#define SETTLED "ready or stopped" /* a stop that came too late is one, too */

struct person {
    const struct deed *deeds;
    int at, waited;
    bool open, size_told;
    char title[1024];
    uint8_t *seen; /* what was shown last */
    size_t bytes;
    uint32_t width, height;
};

static bool person_open(void *context, uint32_t width, uint32_t height, const char *title, struct error *error) {
    struct person *person = context;
    (void)error, (void)title;
    person->width = width;
    person->height = height;
    person->bytes = 3 * (size_t)width * height;
    person->seen = calloc(1, person->bytes);
    return person->open = person->seen != NULL;
}
static void person_show(void *context, const struct window_frame *frame) {
    struct person *person = context;
    memcpy(person->seen, frame->picture, person->bytes);
}
static bool says(const char *title, const char *words) {
    if (strcmp(words, SETTLED) == 0)
        return strstr(title, "ready") || strstr(title, "stopped");
    return strstr(title, words) != NULL;
}
static bool person_poll(void *context, struct window_event *event) {
    struct person *person = context;
    const struct deed *deed = &person->deeds[person->at];
    if (!person->size_told) {
        person->size_told = true;
        *event = (struct window_event){.kind = WINDOW_SIZE, .x = 640, .y = 480, .density = 1};
        return true;
    }
    if ((deed->title && !says(person->title, deed->title)) || person->waited++ < deed->pause)
        return false;
    person->at++;
    person->waited = 0;
    person->title[0] = '\0';
    *event = deed->event;
    return true;
}
static void person_title(void *context, const char *text) {
    struct person *person = context;
    (void)snprintf(person->title, sizeof person->title, "%s", text);
}
static void person_grab(void *context, bool on) {
    (void)context, (void)on;
}
static void person_nothing(void *context) {
    (void)context;
}
static void person_close(void *context) {
    struct person *person = context;
    free(person->seen);
    person->open = false;
}

/* Many things, so that building takes a while even on a fast machine. */
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

/* The status of the program. */
static int live_with(const struct deed *deeds) {
    struct person person = {.deeds = deeds};
    const struct window_driver driver = {&person,      person_open, person_show,    person_poll,
                                         person_title, person_grab, person_nothing, person_close};
    struct arena arena = {0};
    struct options options;
    struct error error;
    char *words[] = {"gray", "-gui", "-q", "--progress=none", "scene.lua"};
    CHECK(chdir(test_folder()) == 0);
    test_write_text("scene.lua", scene);
    CHECK(options_parse(&options, 5, words, &arena, &error));
    int status = supervisor_run(&options, &(struct program_parts){.window = &driver});
    CHECK(!person.open);
    arena_destroy(&arena);
    return status;
}

static bool same_files(const char *one, const char *other) {
    size_t a, b;
    char *x = test_read_file(one, &a), *y = test_read_file(other, &b);
    bool same = x && y && a == b && memcmp(x, y, a) == 0;
    free(x);
    free(y);
    return same;
}

TEST(window_goes_on_after_a_stop_to_the_picture_of_one_that_was_never_stopped) {
    const struct deed plain[] = {{"ready", KEY('s'), 0}, {NULL, KEY('q'), 0}};
    /* In the first building, in a pass, and by Esc. */
    const struct deed stopped[] = {{NULL, KEY('x'), 0},    {SETTLED, KEY('r'), 0},        {NULL, KEY('x'), 2},
                                   {SETTLED, KEY('r'), 0}, {NULL, KEY(WINDOW_ESCAPE), 5}, {SETTLED, KEY('r'), 0},
                                   {NULL, KEY('x'), 0},    {"stopped", KEY('x'), 0},      {"ready", KEY('s'), 0},
                                   {NULL, KEY('q'), 0}};
    CHECK_EQ_INT(live_with(plain), 0);
    CHECK(rename("out.png", "whole.png") == 0);
    CHECK_EQ_INT(live_with(stopped), 0);
    CHECK(same_files("out.png", "whole.png") && same_files("out-view1.png", "out-view2.png"));
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
            {SETTLED, undo, 0},                    /* goes on, to the one with it */
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
    CHECK_EQ_INT(live_with(deeds), 0);
    CHECK(same_files("out.png", "out-view1.png") && same_files("out.png", "out-view3.png"));
    CHECK(!same_files("out.png", "out-view4.png"));
}
