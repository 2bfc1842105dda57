/* Nothing is sent that has not changed. The reader of a tile may see a part of its next state: it copies the tile
 * again, because the number of a tile grows after its pixels were written. */
#include "viewer/window_channel.h"

#include "base/mem.h"

#include <poll.h>
#include <stdio.h>
#include <string.h>

/* Memory of a layer. */

static uint32_t across(uint32_t pixels) {
    return (pixels + WINDOW_TILE - 1) / WINDOW_TILE;
}

uint32_t window_layer_tiles(const struct window_layer *layer) {
    return across(layer->width) * across(layer->height);
}

_Atomic uint32_t *window_layer_numbers(const struct window_layer *layer) {
    return layer->memory.block;
}

uint8_t *window_layer_pixels(const struct window_layer *layer) {
    return (uint8_t *)layer->memory.block + window_layer_tiles(layer) * sizeof(uint32_t);
}

static size_t layer_size(const struct window_layer *layer) {
    return window_layer_tiles(layer) * sizeof(uint32_t) + (size_t)layer->width * layer->height * layer->bytes;
}

bool window_layer_attach(struct window_layer *layer, uint32_t width, uint32_t height, int descriptor) {
    struct error ignored;
    share_destroy(&layer->memory);
    layer->width = width;
    layer->height = height;
    return share_attach(&layer->memory, descriptor, layer_size(layer), &ignored);
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
    case ORDER_CLOSE:
    case ORDER_PICTURE:
    case ORDER_OVERLAY:
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

static void send_kind(struct window_channel *window, enum window_order_kind kind, bool on, const char *text) {
    struct window_order order = {.kind = kind, .on = on};
    (void)snprintf(order.body.text, sizeof order.body.text, "%s", text);
    window->closed = window->closed || !window_send_order(&window->channel, &order, -1);
}

static bool open_window(void *context, uint32_t width, uint32_t height, const char *title, struct error *error) {
    struct window_channel *window = context;
    (void)width, (void)height;
    window->empty = title[0] == '\0';
    window->drawn.kind = ORDER_OPEN;
    send_kind(window, ORDER_OPEN, true, title);
    return !window->closed || error_set(error, ERROR_MACHINE, "-gui: the process of the window has ended");
}

static void close_window(void *context) {
    send_kind(context, ORDER_CLOSE, false, "");
}

/* Another size has other memory. */
static bool fit_layer(struct window_channel *window, struct window_layer *layer, const uint32_t size[2],
                      enum window_order_kind kind) {
    struct window_order order = {.kind = kind, .width = size[0], .height = size[1]};
    struct error ignored;
    if (layer->memory.block && layer->width == size[0] && layer->height == size[1])
        return true;
    share_destroy(&layer->memory);
    layer->width = size[0];
    layer->height = size[1];
    if (!share_create(&layer->memory, layer_size(layer), &ignored))
        return false;
    window->closed = window->closed || !window_send_order(&window->channel, &order, layer->memory.descriptor);
    return true;
}

/* Copies the tiles that differ. True: there are some. */
static bool update_layer(struct window_layer *layer, const uint8_t *from) {
    uint8_t *to = window_layer_pixels(layer);
    size_t row = (size_t)layer->width * layer->bytes;
    bool any = false;
    for (uint32_t tile = 0; tile < window_layer_tiles(layer); tile++) {
        uint32_t x = tile % across(layer->width) * WINDOW_TILE, y = tile / across(layer->width) * WINDOW_TILE;
        uint32_t width = layer->width - x < WINDOW_TILE ? layer->width - x : WINDOW_TILE;
        bool changed = false;
        for (uint32_t v = y; v < layer->height && v < y + WINDOW_TILE; v++) {
            size_t at = v * row + (size_t)x * layer->bytes, bytes = (size_t)width * layer->bytes;
            if (memcmp(to + at, from + at, bytes) == 0)
                continue;
            memcpy(to + at, from + at, bytes);
            changed = true;
        }
        if (changed)
            atomic_fetch_add_explicit(&window_layer_numbers(layer)[tile], 1, memory_order_release);
        any = any || changed;
    }
    return any;
}

static void show_frame(void *context, const struct window_content *frame) {
    struct window_channel *window = context;
    const uint32_t size[2] = {frame->width, frame->height}, over[2] = {frame->window_width, frame->window_height};
    struct window_order order = {.kind = ORDER_DRAW,
                                 .left = frame->left,
                                 .top = frame->top,
                                 .shown_width = frame->shown_width,
                                 .shown_height = frame->shown_height};
    window->picture.bytes = 3;
    window->overlay.bytes = 4;
    bool changed = memcmp(&order, &window->drawn, sizeof order - sizeof order.body) != 0;
    memcpy(&window->drawn, &order, sizeof window->drawn - sizeof window->drawn.body);
    if (fit_layer(window, &window->picture, size, ORDER_PICTURE))
        changed = update_layer(&window->picture, frame->picture) || changed;
    if (frame->overlay && frame->overlay_changed && fit_layer(window, &window->overlay, over, ORDER_OVERLAY))
        changed = update_layer(&window->overlay, frame->overlay) || changed;
    if (changed)
        window->closed = window->closed || !window_send_order(&window->channel, &order, -1);
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

static void set_title(void *context, const char *text) {
    (void)context, (void)text; /* the status has it */
}

static void set_grab(void *context, bool on) {
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
    window->closed = window->closed || !window_send_order(&window->channel, &order, -1);
}

static void send_form(void *context, const struct window_form *form) {
    struct window_channel *window = context;
    bool other = form->subject != window->form.subject || form->count != window->form.count, sent = other;
    for (uint32_t i = 0; i < form->count; i++) {
        struct window_order order = {.kind = ORDER_FIELD, .index = i, .body.field = form->fields[i]};
        if (!other && memcmp(&form->fields[i], &window->form.fields[i], sizeof form->fields[i]) == 0)
            continue;
        window->closed = window->closed || !window_send_order(&window->channel, &order, -1);
        sent = true;
    }
    window->form = *form;
    struct window_order order = {.kind = ORDER_FORM, .index = form->count, .subject = form->subject};
    (void)snprintf(order.body.text, sizeof order.body.text, "%s", form->title);
    if (sent)
        window->closed = window->closed || !window_send_order(&window->channel, &order, -1);
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
    window->closed = window->closed || !window_send_order(&window->channel, &order, -1);
}

struct window_driver window_channel_driver(struct window_channel *window) {
    return (struct window_driver){.context = window,
                                  .open = open_window,
                                  .show = show_frame,
                                  .poll = poll_event,
                                  .title = set_title,
                                  .grab = set_grab,
                                  .full_screen = turn_full_screen,
                                  .close = close_window,
                                  .descriptor = descriptor_of,
                                  .status = send_status,
                                  .form = send_form,
                                  .trace = send_trace,
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
    share_destroy(&window->overlay.memory);
}
