/* What goes between the viewer and the process of its window, with a simulated process; the rows of actions and keys.
 */
#include "tests/harness.h"
#include "viewer/window_channel.h"

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

static int count_orders(struct channel *channel, enum window_order_kind kind) {
    static struct window_order order;
    int count = 0, descriptor;
    while (next_order(channel, &order, &descriptor)) {
        count += order.kind == kind;
        if (descriptor >= 0) {
            struct window_picture none = {0};
            (void)window_picture_attach(&none, 1, 1, descriptor);
            share_destroy(&none.memory);
        }
    }
    return count;
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
    struct window_content frame = {.picture = picture, .width = WIDE, .height = HIGH, .shown_width = WIDE};
    driver.show(driver.context, &frame);
    CHECK(next_order(&ends[1], &order, &descriptor) && order.kind == ORDER_PICTURE && descriptor >= 0);
    CHECK(window_picture_attach(&seen, order.width, order.height, descriptor));
    CHECK_EQ_INT(window_picture_tiles(&seen), TILES);
    CHECK(next_order(&ends[1], &order, &descriptor) && order.kind == ORDER_DRAW && order.shown_width == WIDE);
    /* The last pixel is in the last tile. */
    picture[sizeof picture - 1] = 7;
    driver.show(driver.context, &frame);
    for (uint32_t i = 0; i < TILES; i++)
        CHECK_EQ_INT(atomic_load(&window_picture_numbers(&seen)[i]), i == TILES - 1);
    CHECK(memcmp(window_picture_pixels(&seen), picture, sizeof picture) == 0);
    share_destroy(&seen.memory);
    window_channel_destroy(&window);
    channel_close(&ends[1]);
}

TEST(window_channel_sends_many_lines_in_parts_and_only_when_they_change) {
    enum { COUNT = 2 * LINES_PER_ORDER + 7 };
    static struct window_line lines[COUNT];
    static struct window_channel window;
    static struct window_order order;
    static const uint8_t picture[3];
    struct channel ends[2];
    struct error error;
    int descriptor = -1;
    uint32_t seen = 0;
    CHECK(channel_pair(ends, &error));
    window = (struct window_channel){.channel = ends[0]};
    struct window_driver driver = window_channel_driver(&window);
    for (int i = 0; i < COUNT; i++)
        lines[i].x0 = (float)i;
    const struct window_content content = {
        .picture = picture, .width = 1, .height = 1, .lines = lines, .line_count = COUNT};
    driver.show(driver.context, &content);
    while (next_order(&ends[1], &order, &descriptor) && order.kind != ORDER_DRAW) {
        for (uint32_t i = 0; order.kind == ORDER_LINES && i < order.count; i++)
            CHECK(order.body.lines[i].x0 >= (float)seen && order.body.lines[i].x0 <= (float)seen++);
        if (descriptor >= 0)
            (void)close(descriptor);
    }
    CHECK(seen == COUNT && order.kind == ORDER_DRAW && order.count == COUNT);
    driver.show(driver.context, &content);
    CHECK(!next_order(&ends[1], &order, &descriptor));
    lines[COUNT - 1].y1 = 1;
    driver.show(driver.context, &content);
    CHECK_EQ_INT(count_orders(&ends[1], ORDER_LINES), 3);
    window_channel_destroy(&window);
    channel_close(&ends[1]);
}

TEST(window_channel_sends_what_has_changed_and_nothing_twice) {
    static struct window_channel window;
    static struct window_form form;
    struct window_status status;
    struct channel ends[2];
    struct error error;
    CHECK(channel_pair(ends, &error));
    window = (struct window_channel){.channel = ends[0]};
    struct window_driver driver = window_channel_driver(&window);
    memset(&status, 0, sizeof status);
    status.share = 0.5;
    form.count = 3;
    form.subject = 1;
    for (int i = 0; i < 2; i++)
        driver.status(driver.context, &status);
    CHECK_EQ_INT(count_orders(&ends[1], ORDER_STATUS), 1);
    for (int i = 0; i < 2; i++)
        driver.form(driver.context, &form);
    CHECK_EQ_INT(count_orders(&ends[1], ORDER_FIELD), 3);
    form.fields[1].numbers[0] = 2;
    driver.form(driver.context, &form);
    CHECK_EQ_INT(count_orders(&ends[1], ORDER_FIELD), 1);
    form.subject = 2; /* all of them again */
    driver.form(driver.context, &form);
    CHECK_EQ_INT(count_orders(&ends[1], ORDER_FIELD), 3);
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
