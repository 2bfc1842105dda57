/* A window in a process of its own, which starts before that process has a thread: the driver of the viewer sends what
 * the window shows, and receives what the user does. The picture and the state go through shared memory: the picture in
 * tiles, each with a number that grows when the tile changes; the window copies those that have changed. */
#ifndef GRAY_WINDOW_WINDOW_CHANNEL_H
#define GRAY_WINDOW_WINDOW_CHANNEL_H

#include "base/share.h"
#include "session/messages.h"
#include "window/window.h"

#include <stdatomic.h>

enum { WINDOW_TILE = 128 };

/* The picture in memory that both processes map: the numbers of the tiles, then the pixels, of 3 bytes. */
struct window_picture {
    struct share memory;
    uint32_t width, height;
};
uint32_t window_picture_tiles(const struct window_picture *picture);
_Atomic uint32_t *window_picture_numbers(const struct window_picture *picture);
uint8_t *window_picture_pixels(const struct window_picture *picture);
/* Maps the memory of the other process, whose descriptor it takes over. */
bool window_picture_attach(struct window_picture *picture, uint32_t width, uint32_t height, int descriptor);

/* The state in such memory; its number is odd while it is written, and grows with the picture, too. An order to show
 * them is on its way at most once: the window clears `announced` when it has had the time to draw, and compares the
 * number. */
struct window_shared {
    _Atomic uint32_t number, announced;
    struct window_state state;
};
void window_shared_read(const struct window_shared *shared, struct window_state *out);

/* What the window is to do. */
enum window_order_kind {
    ORDER_STATE,   /* map the memory of the descriptor: a window_shared */
    ORDER_PICTURE, /* map that of a picture: width, height */
    ORDER_SHOW,    /* they may have changed */
    ORDER_NODES,   /* rows of the children of a node; reset: the tree is another one */
};
struct window_order {
    enum window_order_kind kind;
    uint32_t width, height;
    bool reset;
    struct node_query query;
    struct node_rows rows;
};
/* What comes back: an event of the window; or a scene that the user has opened; or why there is no window. */
enum window_note_kind { NOTE_EVENT, NOTE_OPEN_SCENE, NOTE_READY, NOTE_FAILED };
struct window_note {
    enum window_note_kind kind;
    struct window_event event;
    char text[4096];
};
bool window_send_note(struct channel *channel, enum window_note_kind kind, const struct window_event *event,
                      const char *text);

/* The viewer's side. Zero value with a closed channel: no window. */
struct window_channel {
    struct channel channel;
    struct window_picture picture;
    struct share memory;       /* of the shared state */
    struct window_state state; /* to be shown */
    bool ready;                /* its process has a window */
    bool empty;                /* it was opened without a scene */
    bool closed;               /* by the user, or its process has ended */
    char scene[4096];          /* that the user wants to see next; or empty */
    char error[512];           /* why there is no window */
};
struct window_driver window_channel_driver(struct window_channel *window);
/* Waits until the process has a window. */
bool window_channel_wait(struct window_channel *window, struct error *error);
/* No scene is open: waits until the user opens one. False: the window was closed. */
bool window_channel_next_scene(struct window_channel *window);
void window_channel_destroy(struct window_channel *window);

#endif
