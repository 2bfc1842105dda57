/* Nothing is sent that has not changed. The reader of a tile may see a part of its next state: it copies the tile
 * again, because the number of a tile grows after its pixels were written. */
#include "viewer/window_channel.h"

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

/* Orders and notes. */

bool window_send_order(struct channel *channel, const struct window_order *order, int descriptor) {
    size_t size = offsetof(struct window_order, body);
    switch (order->kind) {
    case ORDER_STATUS:
        size += sizeof order->body.status;
        break;
    case ORDER_FIELD:
        size += sizeof order->body.field;
        break;
    case ORDER_NODES:
        size += sizeof order->body.nodes;
        break;
    case ORDER_OPEN:
    case ORDER_FORM:
    case ORDER_TRACE:
        size += strlen(order->body.text) + 1;
        break;
    case ORDER_LINES:
        size += order->count * sizeof *order->body.lines;
        break;
    case ORDER_CLOSE:
    case ORDER_PICTURE:
    case ORDER_DRAW:
    case ORDER_FULL_SCREEN:
    case ORDER_FLY:
        break;
    }
    return channel_send(channel, MESSAGE_WINDOW, order, size, descriptor);
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
    window->closed = window->closed || !window_send_order(&window->channel, order, descriptor);
}

static void send_kind(struct window_channel *window, enum window_order_kind kind, bool on, const char *text) {
    struct window_order order = {.kind = kind, .on = on};
    (void)snprintf(order.body.text, sizeof order.body.text, "%s", text);
    send(window, &order, -1);
}

static bool open_window(void *context, const char *title, struct error *error) {
    struct window_channel *window = context;
    window->empty = title[0] == '\0';
    window->drawn.kind = ORDER_OPEN;
    send_kind(window, ORDER_OPEN, true, title);
    return !window->closed || error_set(error, ERROR_MACHINE, "-gui: the process of the window has ended");
}

static void close_window(void *context) {
    send_kind(context, ORDER_CLOSE, false, "");
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

/* True: they are others than before. */
static bool update_lines(struct window_channel *window, const struct window_content *content) {
    const uint32_t count = content->line_count;
    if (count == window->drawn.count &&
        (count == 0 || memcmp(window->lines, content->lines, count * sizeof *content->lines) == 0))
        return false;
    memcpy(window->lines, content->lines, count * sizeof *content->lines);
    for (uint32_t first = 0; first < count; first += LINES_PER_ORDER) {
        uint32_t part = count - first < LINES_PER_ORDER ? count - first : LINES_PER_ORDER;
        struct window_order order = {.kind = ORDER_LINES, .index = first, .count = part};
        memcpy(order.body.lines, content->lines + first, part * sizeof *content->lines);
        send(window, &order, -1);
    }
    return true;
}

static void show_content(void *context, const struct window_content *content) {
    struct window_channel *window = context;
    struct window_order order = {.kind = ORDER_DRAW,
                                 .count = content->line_count,
                                 .left = content->left,
                                 .top = content->top,
                                 .shown_width = content->shown_width,
                                 .shown_height = content->shown_height};
    bool changed =
        update_lines(window, content) || memcmp(&order, &window->drawn, offsetof(struct window_order, body)) != 0;
    memcpy(&window->drawn, &order, offsetof(struct window_order, body));
    if (fit_picture(window, content->width, content->height))
        changed = update_picture(&window->picture, content->picture) || changed;
    if (changed)
        send(window, &order, -1);
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

static void let_fly(void *context, bool on) {
    send_kind(context, ORDER_FLY, on, "");
}

static void turn_full_screen(void *context) {
    send_kind(context, ORDER_FULL_SCREEN, true, "");
}

static void send_status(void *context, const struct window_status *status) {
    struct window_channel *window = context;
    struct window_order order = {.kind = ORDER_STATUS, .body.status = *status};
    if (memcmp(&window->status, status, sizeof *status) == 0)
        return;
    window->status = *status;
    send(window, &order, -1);
}

static void send_form(void *context, const struct window_form *form) {
    struct window_channel *window = context;
    bool other = form->subject != window->form.subject || form->count != window->form.count, sent = other;
    for (uint32_t i = 0; i < form->count; i++) {
        struct window_order order = {.kind = ORDER_FIELD, .index = i, .body.field = form->fields[i]};
        if (!other && memcmp(&form->fields[i], &window->form.fields[i], sizeof form->fields[i]) == 0)
            continue;
        send(window, &order, -1);
        sent = true;
    }
    window->form = *form;
    struct window_order order = {.kind = ORDER_FORM, .index = form->count, .subject = form->subject};
    (void)snprintf(order.body.text, sizeof order.body.text, "%s", form->title);
    if (sent)
        send(window, &order, -1);
}

static void send_trace(void *context, const char *text) {
    struct window_channel *window = context;
    if (strlen(text) != window->trace_length)
        send_kind(window, ORDER_TRACE, true, text);
    window->trace_length = strlen(text);
}

static void send_nodes(void *context, const struct node_query *query, const struct node_rows *rows) {
    struct window_channel *window = context;
    struct window_order order = {.kind = ORDER_NODES, .on = !query};
    if (query) {
        order.body.nodes.query = *query;
        order.body.nodes.rows = *rows;
    }
    send(window, &order, -1);
}

struct window_driver window_channel_driver(struct window_channel *window) {
    return (struct window_driver){.context = window,
                                  .open = open_window,
                                  .close = close_window,
                                  .poll = poll_event,
                                  .descriptor = descriptor_of,
                                  .show = show_content,
                                  .status = send_status,
                                  .form = send_form,
                                  .trace = send_trace,
                                  .nodes = send_nodes,
                                  .fly = let_fly,
                                  .full_screen = turn_full_screen};
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
}
