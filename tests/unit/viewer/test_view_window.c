/* gray view in a simulated window: its user waits for words of the status, and then acts. */
#include "host/view_window.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Most deeds need no field. */
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"

struct user {
    const struct window_event *events; /* the last one closes the window */
    int next;
    bool pauses;                      /* what was done is drawn before the next event */
    int full, empty;                  /* descriptors that can be read, and cannot */
    struct window_state state, ready; /* ready: the last one with all pixels */
    uint32_t width, height, pictures; /* of the last picture; so many were shown */
};

static bool user_open(void *context, struct error *error) {
    (void)context, (void)error;
    return true;
}
static void user_close(void *context) {
    (void)context;
}
static void user_show(void *context, const uint8_t *picture, uint32_t width, uint32_t height) {
    struct user *user = context;
    (void)picture;
    user->width = width;
    user->height = height;
    user->pictures++;
    if (strcmp(user->state.state, "ready") == 0)
        user->ready = user->state;
}
/* An action waits for the picture with all pixels. */
static bool is_due(const struct user *user) {
    return user->events[user->next].kind != WINDOW_ACTION || strcmp(user->state.state, "ready") == 0;
}
static bool user_poll(void *context, struct window_event *event) {
    struct user *user = context;
    user->pauses = !user->pauses;
    if (!user->pauses || !is_due(user))
        return false;
    *event = user->events[user->next++];
    user->state.state[0] = '\0';
    return true;
}
static int user_descriptor(void *context) {
    const struct user *user = context;
    return is_due(user) ? user->full : user->empty;
}
static void user_nodes(void *context, const struct node_query *query, const struct node_rows *rows) {
    (void)context, (void)query, (void)rows;
}

/* The exit status of `gray WORDS` with this user. */
static int view_with(struct user *user, const struct window_event *events, char *words[]) {
    const struct window_driver driver = {.context = user,
                                         .state = &user->state,
                                         .open = user_open,
                                         .close = user_close,
                                         .poll = user_poll,
                                         .descriptor = user_descriptor,
                                         .show = user_show,
                                         .nodes = user_nodes};
    struct arena arena = {0};
    struct options options;
    struct error error;
    char before[4096];
    int ends[2][2], count = 0;
    while (words[count])
        count++;
    *user = (struct user){.events = events};
    CHECK(pipe(ends[0]) == 0 && pipe(ends[1]) == 0 && write(ends[0][1], "x", 1) == 1);
    user->full = ends[0][0];
    user->empty = ends[1][0];
    CHECK(getcwd(before, sizeof before) && chdir(test_folder()) == 0);
    CHECK(options_parse(&options, count, words, &arena, &error));
    int status = view_window_run(&options, &driver);
    arena_destroy(&arena);
    for (int i = 0; i < 4; i++)
        (void)close(ends[i / 2][i % 2]);
    CHECK(chdir(before) == 0);
    return status;
}

/* A number of an option in the status. */
static double number_of(const struct user *user, const char *option) {
    const char *at = strstr(user->ready.figures, option);
    CHECK(at != NULL);
    return at ? strtod(at + strlen(option), NULL) : 0;
}

#define SIZE(across, down)                                                                                             \
    { .kind = WINDOW_SIZE, .x = across, .y = down, .density = 1 }
#define BUTTON(what, across, down)                                                                                     \
    { .kind = what, .button = WINDOW_LEFT, .x = across, .y = down }
#define MOVE(across, down)                                                                                             \
    { .kind = WINDOW_MOVE, .x = 320 + (across), .y = 240 + (down), .dx = across, .dy = down }
#define SAVE(name)                                                                                                     \
    { .kind = WINDOW_ACTION, .action = DO_SAVE_PICTURE, .text = name }
#define QUIT                                                                                                           \
    { .kind = WINDOW_ACTION, .action = DO_QUIT }

/* A plane with a pattern, four units before the cameras. */
static void make_field(const char *fields) {
    char text[1024];
    (void)snprintf(
        text, sizeof text,
        "local function f(p) return gr.vec(0.5 + 0.2 * math.sin(7 * p.x) + 0.2 * math.sin(19 * p.x + 5 * p.y), "
        "0.5 + 0.4 * math.sin(9 * p.y), 0.3) end\n"
        "local r = gr.rectangle{corner = {-9, -9, 0}, along = {18, 0, 0}, up = {0, 18, 0},\n"
        "  material = gr.material{emission = f, kd = {0, 0, 0}}}\n"
        "gr.light_field{node = r, eye = {0, 0, 4}, target = {0, 0, 0}, fov = 30, size = {64, 48}, rows = 3,\n"
        "  columns = 5, spacing = 0.1, file = 'x.lf', samples = 1, background = {0, 0, 0}, %s}\n",
        fields);
    test_write_text(test_path("scene.lua"), text);
    test_shell_errors("$gray -q scene.lua", 0, NULL);
}

TEST(a_view_that_is_dragged_is_saved_as_the_picture_of_gray_view) {
    static struct user user;
    make_field("depth = true");
    /* The picture is 640 x 480: half of it is half of the grid. The wheel opens the lens by sixteenths of half of it.
     */
    const struct window_event events[] = {SIZE(640, 500),
                                          BUTTON(WINDOW_PRESS, 320, 240),
                                          MOVE(-160, 0),
                                          MOVE(0, 120),
                                          BUTTON(WINDOW_RELEASE, 160, 360),
                                          {.kind = WINDOW_WHEEL, .y = 4},
                                          SAVE("w.png"),
                                          QUIT};
    CHECK(view_with(&user, events, (char *[]){"gray", "view", "-gui", "x.lf", NULL}) == 0);
    CHECK(user.state.shown_width == 640 && user.state.shown_height == 480 && user.state.top == 10);
    test_shell_errors("$gray view x.lf -o v.png --eye 0.1,0.05,0 --aperture 0.05 && cmp v.png w.png", 0, NULL);
    CHECK(strcmp(user.state.message, "") == 0 && strstr(user.state.notice, "w.png"));
}

TEST(a_click_focuses_a_view_on_what_is_there_with_depths_and_without) {
    static struct user user;
    const struct window_event events[] = {SIZE(640, 480), BUTTON(WINDOW_PRESS, 400, 200),
                                          BUTTON(WINDOW_RELEASE, 402, 200), QUIT};
    for (int depth = 0; depth < 2; depth++) {
        make_field(depth ? "depth = true" : "depth = false");
        CHECK(view_with(&user, events, (char *[]){"gray", "view", "-gui", "x.lf", "--focus", "2.5", NULL}) == 0);
        double focus = number_of(&user, "--focus ");
        CHECK(fabs(focus / 4 - 1) < (depth ? 1e-3 : 0.03));
    }
}

TEST(a_panorama_that_is_dragged_follows_the_mouse) {
    static struct user user;
    test_write_text(
        test_path("scene.lua"),
        "local s = gr.node('s')\n"
        "for i = 1, 40 do s:add_child(gr.sphere{centre = {math.cos(i) * 5, (i % 7) - 3, math.sin(i) * 5}}) end\n"
        "gr.render{node = s, file = 'p.png', width = 128, height = 64, eye = {0, 0, 0}, view = {0, 0, -1},\n"
        "  projection = 'panorama', ambient = {1, 1, 1}, background = {0.2, 0.3, 0.4}}\n");
    test_shell_errors("$gray -q scene.lua", 0, NULL);
    const struct window_event events[] = {SIZE(200, 100), BUTTON(WINDOW_PRESS, 320, 240),
                                          MOVE(-40, 20),  BUTTON(WINDOW_RELEASE, 280, 260),
                                          SAVE("w.png"),  QUIT};
    CHECK(view_with(&user, events, (char *[]){"gray", "view", "-gui", "p.png", "--fov", "60", NULL}) == 0);
    CHECK(strstr(user.ready.figures, "--direction 24,12 --fov 60"));
    test_shell_errors("$gray view p.png -o v.png --direction 24,12 --fov 60 --size 200x100 && cmp v.png w.png", 0,
                      NULL);
}

TEST(a_view_in_a_window_is_refused_with_one_line) {
    test_need_gui();
    make_field("depth = false");
    test_shell_errors("head -c 3000 x.lf >cut.lf; $gray view -gui x.lf -o a.png", 2, "-gui shows a view: no -o");
    static struct user user;
    const struct window_event events[] = {QUIT};
    CHECK(view_with(&user, events, (char *[]){"gray", "view", "-gui", "cut.lf", NULL}) == 1 && user.pictures == 0);
}
