/* A window as the program needs one: it shows a picture and tells what people do. Which library makes it is the
 * driver's business (SDL2 in main_gui.c); tests have a driver of their own. */
#ifndef GRAY_APP_WINDOW_H
#define GRAY_APP_WINDOW_H

#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

enum window_event_kind {
    WINDOW_CLOSE,
    WINDOW_KEY,     /* key; down or up; repeats are left out */
    WINDOW_MOVE,    /* x, y: way of the mouse in shares of the picture's height; buttons */
    WINDOW_WHEEL,   /* y: steps away from the user */
    WINDOW_PRESS,   /* button at x, y in shares of the picture's width and height */
    WINDOW_RELEASE, /* the same */
    WINDOW_LEAVE,   /* the keyboard is somebody else's now: no key is held */
};

/* Letters and digits are their own small ASCII codes. */
enum window_key {
    WINDOW_ESCAPE = 256,
    WINDOW_SPACE,
    WINDOW_SHIFT,
    WINDOW_CONTROL,
    WINDOW_ARROW_UP,
    WINDOW_ARROW_DOWN,
    WINDOW_ARROW_LEFT,
    WINDOW_ARROW_RIGHT,
    WINDOW_HOME,
};
enum { WINDOW_LEFT = 1, WINDOW_MIDDLE = 2, WINDOW_RIGHT = 4 };

struct window_event {
    enum window_event_kind kind;
    int key, button, buttons; /* buttons: all that are down */
    bool down, control;
    double x, y;
};

struct window_driver {
    void *context;
    bool (*open)(void *context, uint32_t width, uint32_t height, const char *title, struct error *error);
    /* 3 bytes a pixel, rows from the top. */
    void (*show)(void *context, const uint8_t *rgb, uint32_t width, uint32_t height);
    bool (*poll)(void *context, struct window_event *event); /* false: nothing happened */
    void (*title)(void *context, const char *text);
    void (*grab)(void *context, bool on); /* the mouse looks around: hidden and kept inside */
    void (*full_screen)(void *context);   /* on, or off again */
    void (*close)(void *context);
};

#endif
