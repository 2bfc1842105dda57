/* --display: shows the picture in another program while it is rendered. The supervisor does this: the render process
 * has no sockets and no terminal. Neither process waits: data that cannot be sent at once is sent later, and if the
 * viewer ends, rendering continues without it.
 *
 * tev (https://github.com/Tom94/tev) listens for packets over TCP: a length (of all of it, 4 bytes), a type, and
 * fields, all little-endian, texts with a final zero byte. The packets sent are "create image" (4) and, for each tile,
 * "update image" (6): linear light in three channels of floats. */
#ifndef GRAY_OUTPUT_DISPLAY_H
#define GRAY_OUTPUT_DISPLAY_H

#include "output/terminal.h"
#include "session/options.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { DISPLAY_PACKET = 4096 + 128 + FILM_TILE * FILM_TILE * 12 };
struct display {
    struct display_choice choice;
    int socket; /* or -1 */
    bool on;
    const char *name; /* of the picture; NULL if there is none */
    const struct film *film;
    struct tone tone;
    uint8_t *sent; /* of each tile the state in which it was sent, or 0 */
    uint8_t packet[DISPLAY_PACKET];
    size_t size, begun; /* of the packet, and how much of it is sent */
    struct terminal terminal;
    double shown;
};

/* Connects. False with error: there is no viewer, and nothing will be shown. */
bool display_open(struct display *display, const char *text, struct error *error);
void display_close(struct display *display);
/* `name` and `film` must stay until display_end. */
void display_begin(struct display *display, const char *name, const struct film *film, const struct tone *tone);
/* Whether the next display_step draws on the terminal. */
bool display_draws(const struct display *display, double now);
/* Shows new tiles as far as possible without waiting. False: the viewer has ended (reported once). */
bool display_step(struct display *display, double now, struct error *error);
/* Shows the rest, and waits briefly for it. */
bool display_end(struct display *display, struct error *error);
void display_forget(struct display *display); /* the picture will not be finished */

#endif
