/* Pictures a second while the camera moves, from its change to the tone-mapped picture in the memory of the supervisor:
 * the whole program with -gui and a window without a display, whose user flies to and fro.
 *
 *   moving SECONDS [OPTION ...] SCENE.lua        prints the notes of the window */
#include "base/clock.h"
#include "host/supervisor.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double turn_seconds = 0.4, start_seconds = 120;

struct user {
    struct window_state state;
    double seconds, began, opened, turned; /* began: to fly; turned: last */
    enum fly_camera_key key;
    bool size_sent, flies, is_over;
    uint32_t width, height;
};

static bool open_nothing(void *context, struct error *error) {
    struct user *user = context;
    (void)error;
    user->opened = clock_now();
    return true;
}
static void show_nothing(void *context, const uint8_t *picture, uint32_t width, uint32_t height) {
    (void)context, (void)picture, (void)width, (void)height;
}
static int no_descriptor(void *context) {
    (void)context;
    return -1;
}
static void list_nothing(void *context, const struct node_query *query, const struct node_rows *rows) {
    (void)context, (void)query, (void)rows;
}
static void close_nothing(void *context) {
    (void)context;
}

static bool press(struct user *user, bool down, struct window_event *event) {
    *event = (struct window_event){.kind = WINDOW_KEY, .key = user->key, .down = down};
    user->flies = down;
    if (!down)
        user->key = user->key == FLY_LEFT ? FLY_RIGHT : FLY_LEFT;
    else
        user->turned = clock_now();
    return true;
}

/* Flies when the picture is ready; ends with it, or when it does not come. */
static bool fly(void *context, struct window_event *event) {
    struct user *user = context;
    const double now = clock_now();
    const bool is_ready = strcmp(user->state.state, "ready") == 0;
    if (!user->size_sent) {
        user->size_sent = true;
        *event = (struct window_event){.kind = WINDOW_SIZE, .x = user->width, .y = user->height, .density = 1};
        return true;
    }
    if (user->began <= 0 && is_ready)
        user->began = now;
    if (user->flies)
        return now - user->turned > turn_seconds && press(user, false, event);
    if (user->began > 0 && now - user->began < user->seconds)
        return press(user, true, event);
    if (user->began > 0 ? now < user->began + user->seconds + 1 || !is_ready : now < user->opened + start_seconds)
        return false;
    *event = (struct window_event){.kind = WINDOW_CLOSE};
    return true;
}

int main(int argc, char **argv) {
    struct user *user = calloc(1, sizeof *user);
    struct arena arena = {0};
    struct options options;
    struct error error;
    char *words[64] = {"gray", "-gui", "--verbose", "--progress=none"};
    if (!user || argc < 3 || argc > 60)
        return 2;
    user->seconds = strtod(argv[1], NULL);
    user->key = FLY_LEFT;
    for (int i = 2; i < argc; i++)
        words[i + 2] = argv[i];
    if (!options_parse(&options, argc + 2, words, &arena, &error)) {
        (void)fprintf(stderr, "%s\n", error.text);
        return 2;
    }
    user->width = (uint32_t)options.width;
    user->height = (uint32_t)options.height;
    const struct window_driver driver = {.context = user,
                                         .state = &user->state,
                                         .open = open_nothing,
                                         .close = close_nothing,
                                         .poll = fly,
                                         .descriptor = no_descriptor,
                                         .show = show_nothing,
                                         .nodes = list_nothing};
    int status = supervisor_run(&options, &(struct program_parts){.window = &driver});
    arena_destroy(&arena);
    free(user);
    return status;
}
