/* See display.h. One packet is sent at a time; the next is made when it has been sent. */
#define _GNU_SOURCE
#include "output/display.h"

#include "base/fault.h"
#include "base/mem.h"
#include "session/options_check.h"

#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* --- packets --- */

static uint8_t *put(uint8_t *at, const void *bytes, size_t size) {
    memcpy(at, bytes, size);
    return at + size;
}

static uint8_t *put_number(uint8_t *at, uint64_t number, int bytes) {
    for (int i = 0; i < bytes; i++)
        *at++ = (uint8_t)(number >> (8 * i));
    return at;
}

static uint8_t *put_name(uint8_t *at, const char *name) {
    size_t length = strnlen(name, 4095);
    at = put(at, name, length);
    *at = 0;
    return at + 1;
}

/* The length comes first and includes itself. */
static size_t finish_packet(uint8_t *out, const uint8_t *end) {
    size_t size = (size_t)(end - out);
    (void)put_number(out, size, 4);
    return size;
}

static const char channels[] = "R\0G\0B"; /* with the final zero byte: three texts */

/* The packets: each returns its size. name is cut at 4096 bytes. */
static size_t display_create_packet(uint8_t *out, const char *name, uint32_t width, uint32_t height) {
    uint8_t *at = out + 4;
    *at++ = 4;
    *at++ = 1; /* it is shown at once */
    at = put_name(at, name);
    at = put_number(at, width, 4);
    at = put_number(at, height, 4);
    at = put_number(at, 3, 4);
    at = put(at, channels, sizeof channels);
    return finish_packet(out, at);
}

static size_t display_update_packet(uint8_t *out, const char *name, const struct film *film, uint32_t tile) {
    struct film_rectangle r = film_tile_rectangle(film, tile);
    uint8_t *at = out + 4;
    *at++ = 6;
    *at++ = 0;
    at = put_name(at, name);
    at = put_number(at, 3, 4);
    at = put(at, channels, sizeof channels);
    at = put_number(at, r.x0 - film->x0, 4);
    at = put_number(at, r.y0 - film->y0, 4);
    at = put_number(at, r.x1 - r.x0, 4);
    at = put_number(at, r.y1 - r.y0, 4);
    for (uint64_t c = 0; c < 3; c++) /* the offset of each channel, in floats */
        at = put_number(at, c, 8);
    for (int c = 0; c < 3; c++) /* and the step to its next value */
        at = put_number(at, 3, 8);
    for (uint32_t y = r.y0; y < r.y1; y++) {
        const struct film_pixel *row = film->pixels + (size_t)(y - film->y0) * film->width - film->x0;
        for (uint32_t x = r.x0; x < r.x1; x++)
            at = put(at, row[x].rgb, sizeof row[x].rgb);
    }
    return finish_packet(out, at);
}

/* --- the connection --- */

/* The longest wait for a host that does not answer. */
enum { CONNECT_WAIT = 3000 };

static bool connect_soon(int made, const struct addrinfo *at) {
    int failure = 0;
    socklen_t size = sizeof failure;
    if (MAY_FAIL(connect(made, at->ai_addr, at->ai_addrlen)) == 0)
        return true;
    struct pollfd writable = {.fd = made, .events = POLLOUT};
    if (errno != EINPROGRESS)
        return false;
    if (poll(&writable, 1, CONNECT_WAIT) <= 0) {
        errno = ETIMEDOUT;
        return false;
    }
    (void)getsockopt(made, SOL_SOCKET, SO_ERROR, &failure, &size);
    errno = failure;
    return failure == 0;
}

static bool connect_tev(struct display *display, struct error *error) {
    struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM}, *list = NULL;
    const struct display_choice *choice = &display->choice;
    /* "localhost" is this machine even if no name service defines it (RFC 6761, 6.3). */
    const char *host = strcmp(choice->host, "localhost") == 0 ? "127.0.0.1" : choice->host;
    int failure = MAY_FAIL(getaddrinfo(host, choice->port, &hints, &list)), yes = 1, saved = 0;
    if (failure != 0)
        return error_set(error, ERROR_MACHINE, "--display tev:%s:%s: %s", choice->host, choice->port,
                         failure == EAI_SYSTEM || failure == -1 ? strerror(errno) : gai_strerror(failure));
    for (const struct addrinfo *at = list; at && display->socket < 0; at = at->ai_next) {
        int made = MAY_FAIL(socket(at->ai_family, at->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, at->ai_protocol));
        if (made >= 0 && connect_soon(made, at))
            display->socket = made;
        saved = errno;
        if (made >= 0 && display->socket < 0)
            (void)close(made);
    }
    freeaddrinfo(list);
    if (display->socket < 0)
        return error_set(error, ERROR_MACHINE, "--display tev:%s:%s: %s", choice->host, choice->port, strerror(saved));
    (void)setsockopt(display->socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    return true;
}

bool display_open(struct display *display, const char *text, struct error *error) {
    *display = (struct display){.socket = -1};
    if (!text || !display_parse(text, &display->choice))
        return true;
    display->on = display->choice.kind == DISPLAY_TERMINAL || connect_tev(display, error);
    if (display->on && display->choice.kind == DISPLAY_TERMINAL)
        terminal_open(&display->terminal, display->choice.graphics);
    return display->on;
}

void display_forget(struct display *display) {
    mem_free(display->sent);
    display->sent = NULL;
    display->name = NULL;
    display->size = display->begun = 0;
}

void display_close(struct display *display) {
    display_forget(display);
    if (display->socket >= 0)
        (void)close(display->socket);
    display->socket = -1;
    display->on = false;
}

void display_begin(struct display *display, const char *name, const struct film *film, const struct tone *tone) {
    if (!display->on)
        return;
    display_forget(display);
    display->sent = mem_alloc_zero(film_tile_count(film), 1);
    if (!display->sent)
        return; /* this one is not shown */
    display->name = name;
    display->film = film;
    display->tone = *tone;
    display->shown = 0;
    terminal_begin(&display->terminal);
    if (display->choice.kind == DISPLAY_TEV)
        display->size = display_create_packet(display->packet, name, film->width, film->height);
}

static bool next_packet(struct display *display) {
    const struct film *film = display->film;
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++) {
        uint8_t state = atomic_load_explicit(&film->tiles[tile], memory_order_acquire);
        if (display->sent[tile] == state || !film_tile_shows(state))
            continue;
        display->sent[tile] = state;
        display->size = display_update_packet(display->packet, display->name, film, tile);
        display->begun = 0;
        return true;
    }
    return false;
}

/* wait: the longest time without progress, in milliseconds. */
static bool send_tiles(struct display *display, int wait, struct error *error) {
    while (display->begun < display->size || next_packet(display)) {
        ssize_t gone = MAY_FAIL(send(display->socket, display->packet + display->begun, display->size - display->begun,
                                     MSG_NOSIGNAL | MSG_DONTWAIT));
        if (gone >= 0) {
            display->begun += (size_t)gone;
            continue;
        }
        struct pollfd writable = {.fd = display->socket, .events = POLLOUT};
        if (errno == EINTR || (errno == EAGAIN && wait > 0 && poll(&writable, 1, wait) > 0))
            continue;
        if (errno == EAGAIN && wait == 0)
            return true;
        error_set(error, ERROR_MACHINE, "--display tev: the viewer is gone (%s)",
                  errno == EAGAIN ? "it accepts no more data" : strerror(errno));
        display_close(display);
        return false;
    }
    return true;
}

static bool shows_something(const struct film *film) {
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++)
        if (film_tile_shows(atomic_load_explicit(&film->tiles[tile], memory_order_acquire)))
            return true;
    return false;
}

bool display_draws(const struct display *display, double now) {
    return display->on && display->name && display->choice.kind == DISPLAY_TERMINAL && display->terminal.moves &&
           now - display->shown >= 1 && shows_something(display->film);
}

bool display_step(struct display *display, double now, struct error *error) {
    if (!display->on || !display->name)
        return true;
    if (display->choice.kind == DISPLAY_TEV)
        return send_tiles(display, 0, error);
    if (display_draws(display, now)) {
        display->shown = now;
        terminal_draw(&display->terminal, display->film, &display->tone);
    }
    return true;
}

bool display_end(struct display *display, struct error *error) {
    bool ok = true;
    if (!display->on || !display->name)
        return true;
    if (display->choice.kind == DISPLAY_TEV)
        ok = send_tiles(display, 2000, error);
    else
        terminal_draw(&display->terminal, display->film, &display->tone);
    display_forget(display);
    return ok;
}
