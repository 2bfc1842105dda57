/* Nothing is sent that has not changed. The reader of a tile may see a part of its next state: it copies the tile
 * again, because the number of a tile grows after its pixels were written. */
#include "window/window_channel.h"

#include "base/mem.h"

#include <poll.h>
#include <stdio.h>
#include <string.h>

/* The memory of the picture. */

static uint32_t across(uint32_t pixels) {
    return (pixels + WINDOW_TILE - 1) / WINDOW_TILE;
}

uint32_t window_picture_tiles(const struct window_picture *picture) {
    return across(picture->width) * across(picture->height);
}

_Atomic uint32_t *window_picture_numbers(const struct window_picture *picture) {
    return picture->memory.block;
}

uint8_t *window_picture_pixels(const struct window_picture *picture) {
    return (uint8_t *)picture->memory.block + window_picture_tiles(picture) * sizeof(uint32_t);
}

static size_t memory_size(const struct window_picture *picture) {
    return window_picture_tiles(picture) * sizeof(uint32_t) + (size_t)3 * picture->width * picture->height;
}

bool window_picture_attach(struct window_picture *picture, uint32_t width, uint32_t height, int descriptor) {
    struct error ignored;
    share_destroy(&picture->memory);
    picture->width = width;
    picture->height = height;
    return share_attach(&picture->memory, descriptor, memory_size(picture), &ignored);
}

void window_shared_read(const struct window_shared *shared, struct window_state *out) {
    uint32_t before;
    do {
        before = atomic_load_explicit(&shared->number, memory_order_acquire);
        memcpy(out, &shared->state, sizeof *out);
        atomic_thread_fence(memory_order_acquire);
    } while (before % 2 == 1 || before != atomic_load_explicit(&shared->number, memory_order_relaxed));
}

bool window_send_note(struct channel *channel, enum window_note_kind kind, const struct window_event *event,
                      const char *text) {
    struct window_note note = {.kind = kind};
    if (event)
        note.event = *event;
    (void)snprintf(note.text, sizeof note.text, "%s", text);
    return channel_send(channel, MESSAGE_WINDOW, &note, offsetof(struct window_note, text) + strlen(note.text) + 1, -1);
}

/* The driver. */

static void send(struct window_channel *window, const struct window_order *order, int descriptor) {
    size_t size = order->kind == ORDER_NODES ? sizeof *order : offsetof(struct window_order, query);
    window->closed = window->closed || !channel_send(&window->channel, MESSAGE_WINDOW, order, size, descriptor);
}

/* Publishes the state. True: it has changed. */
static bool update_state(struct window_channel *window) {
    struct window_shared *shared = window->memory.block;
    if (!shared || memcmp(&shared->state, &window->state, sizeof window->state) == 0)
        return false;
    atomic_fetch_add_explicit(&shared->number, 1, memory_order_relaxed);
    atomic_thread_fence(memory_order_release); /* who reads some of the new state sees the odd number */
    memcpy(&shared->state, &window->state, sizeof window->state);
    atomic_fetch_add_explicit(&shared->number, 1, memory_order_release);
    return true;
}

static void show_state(struct window_channel *window, bool changed) {
    struct window_shared *shared = window->memory.block;
    if (changed && shared)
        atomic_fetch_add_explicit(&shared->number, 2, memory_order_release);
    bool shows = update_state(window) || changed;
    if (shows && (!shared || atomic_exchange(&shared->announced, 1) == 0))
        send(window, &(struct window_order){.kind = ORDER_SHOW}, -1);
}

static bool open_window(void *context, struct error *error) {
    struct window_channel *window = context;
    window->empty = !window->state.has_scene;
    if (!window->memory.block) {
        if (!share_create(&window->memory, sizeof(struct window_shared), error))
            return false;
        send(window, &(struct window_order){.kind = ORDER_STATE}, window->memory.descriptor);
    }
    show_state(window, false);
    return !window->closed || error_set(error, ERROR_MACHINE, "-gui: the process of the window has ended");
}

/* Another size has other memory. */
static bool fit_picture(struct window_channel *window, uint32_t width, uint32_t height) {
    struct window_picture *picture = &window->picture;
    struct window_order order = {.kind = ORDER_PICTURE, .width = width, .height = height};
    struct error ignored;
    if (picture->memory.block && picture->width == width && picture->height == height)
        return true;
    share_destroy(&picture->memory);
    picture->width = width;
    picture->height = height;
    if (!share_create(&picture->memory, memory_size(picture), &ignored))
        return false;
    send(window, &order, picture->memory.descriptor);
    return true;
}

/* Copies the tiles that differ. True: there are some. */
static bool update_picture(struct window_picture *picture, const uint8_t *from) {
    uint8_t *to = window_picture_pixels(picture);
    bool any = false;
    for (uint32_t tile = 0; tile < window_picture_tiles(picture); tile++) {
        uint32_t x = tile % across(picture->width) * WINDOW_TILE, y = tile / across(picture->width) * WINDOW_TILE;
        uint32_t width = picture->width - x < WINDOW_TILE ? picture->width - x : WINDOW_TILE;
        bool changed = false;
        for (uint32_t v = y; v < picture->height && v < y + WINDOW_TILE; v++) {
            size_t at = 3 * ((size_t)v * picture->width + x), bytes = (size_t)3 * width;
            if (memcmp(to + at, from + at, bytes) == 0)
                continue;
            memcpy(to + at, from + at, bytes);
            changed = true;
        }
        if (changed)
            atomic_fetch_add_explicit(&window_picture_numbers(picture)[tile], 1, memory_order_release);
        any = any || changed;
    }
    return any;
}

static void show(void *context, const uint8_t *picture, uint32_t width, uint32_t height) {
    struct window_channel *window = context;
    bool changed = fit_picture(window, width, height) && update_picture(&window->picture, picture);
    show_state(window, changed);
}

static void close_window(void *context) {
    struct window_channel *window = context;
    window->state = (struct window_state){.has_scene = false};
    show_state(window, false);
}

static int descriptor_of(void *context) {
    const struct window_channel *window = context;
    return window->channel.descriptor;
}

/* The next note, if one has come. */
static bool receive_note(struct window_channel *window, struct window_note *note, int patience) {
    struct pollfd watched = {.fd = window->channel.descriptor, .events = POLLIN};
    struct message message;
    if (window->closed || poll(&watched, 1, patience) <= 0)
        return false;
    if (channel_receive(&window->channel, &message) != CHANNEL_MESSAGE || message.kind != MESSAGE_WINDOW ||
        message.size > sizeof *note) {
        window->closed = true;
        return false;
    }
    memset(note, 0, sizeof *note);
    memcpy(note, message.body.bytes, message.size);
    note->text[sizeof note->text - 1] = '\0';
    return true;
}

/* A scene that was opened ends this one. */
static void take_note(struct window_channel *window, const struct window_note *note) {
    if (note->kind == NOTE_OPEN_SCENE)
        (void)snprintf(window->scene, sizeof window->scene, "%s", note->text);
    else if (note->kind == NOTE_FAILED)
        (void)snprintf(window->error, sizeof window->error, "%.500s", note->text);
    window->ready = window->ready || note->kind == NOTE_READY;
    window->closed =
        window->closed || note->kind == NOTE_FAILED || (note->kind == NOTE_EVENT && note->event.kind == WINDOW_CLOSE);
}

static bool poll_event(void *context, struct window_event *event) {
    struct window_channel *window = context;
    struct window_note note;
    *event = (struct window_event){.kind = WINDOW_CLOSE};
    if (window->closed)
        return true;
    if (!receive_note(window, &note, 0))
        return window->closed;
    take_note(window, &note);
    if (note.kind == NOTE_EVENT)
        *event = note.event;
    return note.kind == NOTE_EVENT || note.kind == NOTE_OPEN_SCENE;
}

static void send_nodes(void *context, const struct node_query *query, const struct node_rows *rows) {
    struct window_order order = {.kind = ORDER_NODES, .reset = !query};
    if (query) {
        order.query = *query;
        order.rows = *rows;
    }
    send(context, &order, -1);
}

struct window_driver window_channel_driver(struct window_channel *window) {
    return (struct window_driver){.context = window,
                                  .state = &window->state,
                                  .open = open_window,
                                  .close = close_window,
                                  .poll = poll_event,
                                  .descriptor = descriptor_of,
                                  .show = show,
                                  .nodes = send_nodes};
}

bool window_channel_wait(struct window_channel *window, struct error *error) {
    struct window_note note;
    while (!window->closed && !window->ready) {
        if (receive_note(window, &note, -1))
            take_note(window, &note);
    }
    return !window->closed || error_set(error, ERROR_MACHINE, "-gui: no window can be opened: %s",
                                        window->error[0] != '\0' ? window->error : "its process has ended");
}

bool window_channel_next_scene(struct window_channel *window) {
    struct window_note note;
    while (!window->closed && window->scene[0] == '\0') {
        if (receive_note(window, &note, -1))
            take_note(window, &note);
    }
    return !window->closed;
}

void window_channel_destroy(struct window_channel *window) {
    channel_close(&window->channel);
    share_destroy(&window->picture.memory);
    share_destroy(&window->memory);
}
