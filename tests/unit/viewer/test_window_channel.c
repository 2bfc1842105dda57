/* What goes between the viewer and the process of its window, with a simulated process; the rows of actions and keys.
 */
#include "tests/harness.h"
#include "window/window_channel.h"

#include <poll.h>
#include <string.h>
#include <unistd.h>

/* The next order, or false: there is none. */
static bool next_order(struct channel *channel, struct window_order *order, int *descriptor) {
    static struct message message;
    struct pollfd watched = {.fd = channel->descriptor, .events = POLLIN};
    if (poll(&watched, 1, 0) != 1 || channel_receive(channel, &message) != CHANNEL_MESSAGE)
        return false;
    memcpy(order, message.body.bytes, message.size < sizeof *order ? message.size : sizeof *order);
    *descriptor = message.descriptor;
    return true;
}

TEST(window_channel_changes_the_numbers_of_changed_tiles_only) {
    enum { WIDE = 300, HIGH = 200, TILES = 3 * 2 };
    static uint8_t picture[3 * WIDE * HIGH];
    static struct window_channel window;
    static struct window_order order;
    struct window_picture seen = {0};
    struct channel ends[2];
    struct error error;
    int descriptor = -1;
    CHECK(channel_pair(ends, &error));
    window = (struct window_channel){.channel = ends[0]};
    struct window_driver driver = window_channel_driver(&window);
    driver.show(driver.context, picture, WIDE, HIGH);
    CHECK(next_order(&ends[1], &order, &descriptor) && order.kind == ORDER_PICTURE && descriptor >= 0);
    CHECK(window_picture_attach(&seen, order.width, order.height, descriptor));
    CHECK_EQ_INT(window_picture_tiles(&seen), TILES);
    /* The last pixel is in the last tile. */
    picture[sizeof picture - 1] = 7;
    driver.show(driver.context, picture, WIDE, HIGH);
    CHECK(next_order(&ends[1], &order, &descriptor) && order.kind == ORDER_SHOW);
    for (uint32_t i = 0; i < TILES; i++)
        CHECK_EQ_INT(atomic_load(&window_picture_numbers(&seen)[i]), i == TILES - 1);
    CHECK(memcmp(window_picture_pixels(&seen), picture, sizeof picture) == 0);
    share_destroy(&seen.memory);
    window_channel_destroy(&window);
    channel_close(&ends[1]);
}

TEST(window_channel_shows_what_has_changed_and_nothing_twice) {
    static struct window_channel window;
    static struct window_order order;
    static struct window_state state;
    static const uint8_t picture[3];
    struct share memory = {0};
    struct channel ends[2];
    struct error error;
    int descriptor = -1;
    CHECK(channel_pair(ends, &error));
    window = (struct window_channel){.channel = ends[0]};
    struct window_driver driver = window_channel_driver(&window);
    CHECK(driver.open(driver.context, &error));
    CHECK(next_order(&ends[1], &order, &descriptor) && order.kind == ORDER_STATE);
    CHECK(share_attach(&memory, descriptor, sizeof(struct window_shared), &error));
    driver.show(driver.context, picture, 1, 1);
    while (next_order(&ends[1], &order, &descriptor))
        CHECK(order.kind != ORDER_PICTURE || close(descriptor) == 0);
    atomic_store(&((struct window_shared *)memory.block)->announced, 0);
    for (int i = 1; i < 4; i++) {
        driver.state->share = 0.25 * i;
        driver.state->lines[WINDOW_LINES - 1].x1 = (float)i;
        driver.show(driver.context, picture, 1, 1);
        CHECK(next_order(&ends[1], &order, &descriptor) && order.kind == ORDER_SHOW);
        window_shared_read(memory.block, &state);
        CHECK(memcmp(&state, driver.state, sizeof state) == 0);
        driver.show(driver.context, picture, 1, 1);
        CHECK(!next_order(&ends[1], &order, &descriptor));
        /* Nor what the window has not read yet. */
        driver.state->share = 0;
        driver.show(driver.context, picture, 1, 1);
        CHECK(!next_order(&ends[1], &order, &descriptor));
        atomic_store(&((struct window_shared *)memory.block)->announced, 0);
    }
    share_destroy(&memory);
    channel_close(&ends[1]);
    window_channel_destroy(&window);
}

TEST(window_channel_whose_process_ends_closes_the_window) {
    static struct window_channel window;
    struct window_event event;
    struct channel ends[2];
    struct error error;
    CHECK(channel_pair(ends, &error));
    window = (struct window_channel){.channel = ends[0]};
    struct window_driver driver = window_channel_driver(&window);
    CHECK(!driver.poll(driver.context, &event));
    CHECK(window_send_note(&ends[1], NOTE_OPEN_SCENE, NULL, "next.lua"));
    CHECK(driver.poll(driver.context, &event) && event.kind == WINDOW_CLOSE && !window.closed);
    CHECK_TEXT(window.scene, "next.lua");
    channel_close(&ends[1]);
    CHECK(driver.poll(driver.context, &event) && event.kind == WINDOW_CLOSE && window.closed);
    CHECK(!window_channel_next_scene(&window));
    window_channel_destroy(&window);
}

/* Whether two lists, divided by blanks, have a word in common. */
static bool share_a_key(const char *a, const char *b) {
    for (; *a; a += strspn(a, " ")) {
        size_t length = strcspn(a, " ");
        for (const char *at = b; *at; at += strspn(at, " ")) {
            size_t other = strcspn(at, " ");
            if (length == other && strncmp(a, at, length) == 0)
                return true;
            at += other;
        }
        a += length;
    }
    return false;
}

TEST(window_actions_have_names_and_keys_of_their_own) {
    for (int i = 0; i < WINDOW_ACTION_COUNT; i++) {
        const struct window_action_row *a = &window_action_table[i];
        CHECK(a->name && a->title[0] && a->help[0]);
        for (int j = 0; j < i; j++) {
            const struct window_action_row *b = &window_action_table[j];
            CHECK(strcmp(a->name, b->name) != 0);
            for (int set = 0; set < WINDOW_KEY_SET_COUNT; set++) {
                if (share_a_key(a->keys[set], b->keys[set]))
                    test_fail(__FILE__, __LINE__, "%s and %s have the same key", a->name, b->name);
            }
        }
    }
}
