/* The whole program under a simulated window with --device emulate: what is shown while the camera moves, what it ends
 * with, and how many device processes there were. */
#define _GNU_SOURCE
#include "host/supervisor.h"
#include "tests/harness.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { WIDTH = 64, HEIGHT = 48, BYTES = 3 * WIDTH * HEIGHT, IMAGES = 400, DELAY = 12, CHILDREN = 16 };

struct walker;
/* What the user does when the window is ready; some have an event. */
typedef void deed_function(struct walker *walker);
struct deed {
    enum window_event_kind kind;
    enum window_action action; /* of WINDOW_ACTION */
    deed_function *does;       /* or NULL; before it */
    bool at_once;              /* it does not wait */
};

struct walker {
    const struct deed *deeds;
    int at, since;
    bool size_sent, is_ready, keeps;
    struct window_state state;
    uint8_t now[BYTES], before[BYTES];
    uint8_t (*kept)[BYTES]; /* pictures that were shown while `keeps` */
    int kept_count;
    pid_t children[CHILDREN]; /* all that there were, in the order of their numbers */
    int child_count;
};

static void note_children(struct walker *walker) {
    char name[64];
    (void)snprintf(name, sizeof name, "/proc/self/task/%d/children", (int)getpid());
    FILE *file = fopen(name, "r");
    int child = 0;
    while (file && fscanf(file, "%d", &child) == 1) {
        bool known = false;
        for (int i = 0; i < walker->child_count; i++)
            known = known || walker->children[i] == child;
        if (!known && walker->child_count < CHILDREN)
            walker->children[walker->child_count++] = child;
    }
    if (file)
        (void)fclose(file);
    CHECK(file != NULL);
}

static bool walker_open(void *context, struct error *error) {
    (void)context, (void)error;
    return true;
}
static void walker_show(void *context, const uint8_t *picture, uint32_t width, uint32_t height) {
    struct walker *walker = context;
    note_children(walker);
    walker->is_ready = walker->since >= DELAY && strcmp(walker->state.state, "ready") == 0;
    if (width != WIDTH || height != HEIGHT)
        return;
    memcpy(walker->now, picture, BYTES);
    if (walker->keeps && walker->kept_count < IMAGES)
        memcpy(walker->kept[walker->kept_count++], picture, BYTES);
}
static bool walker_poll(void *context, struct window_event *event) {
    struct walker *walker = context;
    const struct deed *deed = &walker->deeds[walker->at];
    walker->since++;
    if (!walker->size_sent) {
        walker->size_sent = true;
        *event = (struct window_event){.kind = WINDOW_SIZE, .x = WIDTH, .y = HEIGHT, .density = 1};
        return true;
    }
    if (!deed->at_once && !walker->is_ready)
        return false;
    walker->at++;
    if (deed->does)
        deed->does(walker);
    walker->since = 0;
    walker->is_ready = false;
    *event = (struct window_event){.kind = deed->kind, .action = deed->action, .x = WIDTH / 2, .y = HEIGHT / 2};
    if (deed->kind == WINDOW_ADD)
        (void)strcpy(event->text, "gr.sphere{radius = 0.5}");
    return true;
}
static int walker_descriptor(void *context) {
    (void)context;
    return -1;
}
static void walker_nodes(void *context, const struct node_query *query, const struct node_rows *rows) {
    (void)context, (void)query, (void)rows;
}
static void walker_close(void *context) {
    (void)context;
}

/* A floor, a mirror, a ball of glass, a lamp. */
#define SCENE                                                                                                          \
    "local white = gr.material{kd = {.7, .6, .5}}\n"                                                                   \
    "local all = gr.node{name = 'all', children = {\n"                                                                 \
    "  gr.sphere{name = 'ball', radius = 1, material = gr.material{kd = {0, 0, 0}, ks = {.9, .9, .9}, reflect = "      \
    ".9}},\n"                                                                                                          \
    "  gr.box{material = white, min = {-9, -2, -9}, max = {9, -1, 9}},\n"                                              \
    "  gr.sphere{centre = {2, 3, 2}, radius = .5, material = gr.material{kd = {0, 0, 0}, emission = {9, 9, 8}}}}}\n"   \
    "gr.render{node = all, file = 'out.png', width = 64, height = 48, eye = {0, 1, 6}, target = {0, 0, 0}, fov = "     \
    "40,\n"                                                                                                            \
    "  background = {.2, .3, .4}, integrator = 'path', denoise = false}\n"

static int run_walker(struct walker *walker, const char *samples) {
    const struct window_driver driver = {.context = walker,
                                         .state = &walker->state,
                                         .open = walker_open,
                                         .close = walker_close,
                                         .poll = walker_poll,
                                         .descriptor = walker_descriptor,
                                         .show = walker_show,
                                         .nodes = walker_nodes};
    char *words[] = {"gray",     "-gui",    "-q",    "--progress=none",
                     "--device", "emulate", "--spp", (char *)(uintptr_t)samples,
                     "scene.lua"};
    struct arena arena = {0};
    struct options options;
    struct error error;
    char before[4096], library[4200];
    CHECK(getcwd(before, sizeof before) && chdir(test_folder()) == 0);
    (void)snprintf(library, sizeof library, "%s/lua", before);
    test_write_text("scene.lua", SCENE);
    CHECK(options_parse(&options, 9, words, &arena, &error));
    options.script.library_folder = library;
    int status = supervisor_run(&options, &(struct program_parts){.window = &driver});
    arena_destroy(&arena);
    CHECK(chdir(before) == 0);
    return status;
}

/* Whether the picture that the window has saved is that of threads with the edits that it has saved. */
static bool is_that_of_threads(const char *samples, int number) {
    char arguments[200], saved[40];
    (void)snprintf(arguments, sizeof arguments,
                   "-q --progress=none --spp %s scene.lua --edits out-changes%d.lua -o threads%d.png --force", samples,
                   number, number);
    struct test_result result = test_gray(NULL, arguments);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    (void)snprintf(saved, sizeof saved, "out-view%d.png", number);
    (void)snprintf(arguments, sizeof arguments, "threads%d.png", number);
    return test_same_files(saved, arguments);
}

static void begin_keeping(struct walker *walker) {
    memcpy(walker->before, walker->now, BYTES);
    walker->keeps = true;
}

/* Each pixel of what was shown is that of the picture before or of the picture now. */
static void end_keeping(struct walker *walker) {
    uint32_t strange = 0, others = 0;
    for (int i = 0; i < walker->kept_count; i++)
        for (size_t at = 0; at < BYTES; at += 3) {
            const uint8_t *pixel = &walker->kept[i][at];
            const bool is_new = memcmp(pixel, &walker->now[at], 3) == 0;
            strange += !is_new && memcmp(pixel, &walker->before[at], 3) != 0;
            others += is_new && memcmp(pixel, &walker->before[at], 3) != 0;
        }
    CHECK_EQ_INT(strange, 0);
    CHECK(others > 0);
    walker->keeps = false;
    walker->kept_count = 0;
}

#define DO(name) WINDOW_ACTION, name
#define SAVE                                                                                                           \
    {DO(DO_SAVE_CHANGES), NULL, false}, {                                                                              \
        DO(DO_SAVE_PICTURE), NULL, true                                                                                \
    }

static void begin(struct walker *walker, const struct deed *deeds) {
    *walker = (struct walker){.deeds = deeds, .kept = malloc(IMAGES * sizeof *walker->kept)};
}

/* With one sample, the picture that is shown while the camera moves is that which it ends with. */
TEST(window_with_a_device_shows_one_sample_of_paths_while_the_camera_moves) {
    static struct walker walker;
    static const struct deed deeds[] = {
        {DO(DO_ROLL_LEFT), begin_keeping, false}, {DO(DO_ROLL_LEFT), end_keeping, false},
        {DO(DO_VIEW_TOP), begin_keeping, false},  SAVE,
        {DO(DO_ROLL_LEFT), end_keeping, false},   {DO(DO_QUIT), NULL, false}};
    begin(&walker, deeds);
    CHECK_EQ_INT(run_walker(&walker, "1"), 0);
    CHECK(is_that_of_threads("1", 1));
    CHECK_EQ_INT(walker.child_count, 2); /* the render process and one device process */
    free(walker.kept);
}

TEST(window_with_a_device_adds_samples_to_a_view_and_begins_it_again_after_edits_alone) {
    static struct walker walker;
    static const struct deed deeds[] = {{DO(DO_ROLL_LEFT), NULL, false},
                                        {DO(DO_ROLL_LEFT), NULL, true},
                                        SAVE,
                                        {DO(DO_BRIGHTER), NULL, false},
                                        SAVE,
                                        {WINDOW_ADD, 0, NULL, false},
                                        SAVE,
                                        {DO(DO_VIEW_FRONT), NULL, false},
                                        SAVE,
                                        {DO(DO_QUIT), NULL, false}};
    begin(&walker, deeds);
    CHECK_EQ_INT(run_walker(&walker, "40"), 0);
    for (int i = 1; i <= 4; i++)
        CHECK(is_that_of_threads("40", i));
    CHECK_EQ_INT(walker.child_count, 3);
    free(walker.kept);
}

static void kill_device(struct walker *walker) {
    CHECK_EQ_INT(walker->child_count, 2);
    CHECK(kill(walker->children[1], SIGKILL) == 0);
}

TEST(window_whose_device_process_is_killed_goes_on_with_threads) {
    static struct walker walker;
    static const struct deed deeds[] = {{DO(DO_ROLL_LEFT), NULL, false},
                                        {DO(DO_ROLL_LEFT), kill_device, true},
                                        SAVE,
                                        {DO(DO_ROLL_LEFT), NULL, false},
                                        SAVE,
                                        {DO(DO_QUIT), NULL, false}};
    begin(&walker, deeds);
    CHECK_EQ_INT(run_walker(&walker, "20"), 0);
    CHECK(is_that_of_threads("20", 1) && is_that_of_threads("20", 2));
    CHECK_EQ_INT(walker.child_count, 2);
    free(walker.kept);
}
