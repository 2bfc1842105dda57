/* The interface to a window: it shows a picture with a drawing over it, and reports input. The driver
 * decides on the library (SDL 2 in main_gui.c); tests have their own driver. All positions are pixels of the
 * screen, from the upper left corner of the window. */
#ifndef GRAY_VIEWER_WINDOW_H
#define GRAY_VIEWER_WINDOW_H

#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

enum window_event_kind {
    WINDOW_CLOSE,
    WINDOW_KEY,     /* key; down or up; repeats are left out */
    WINDOW_MOVE,    /* x, y: position of the mouse; dx, dy: its motion, also while it is grabbed */
    WINDOW_WHEEL,   /* y: steps away from the user */
    WINDOW_PRESS,   /* button at x, y */
    WINDOW_RELEASE, /* the same */
    WINDOW_LEAVE,   /* the window has lost the keyboard: no key is pressed */
    WINDOW_SIZE,    /* x, y: the size of the window in pixels; density: pixels per dot of a letter */
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
    WINDOW_DELETE,
    WINDOW_PAGE_UP,
    WINDOW_PAGE_DOWN,
    WINDOW_TAB,
};
enum { WINDOW_LEFT = 1, WINDOW_MIDDLE = 2, WINDOW_RIGHT = 4 };

struct window_event {
    enum window_event_kind kind;
    int key, button;
    bool down, control, shift; /* control, shift: held */
    double x, y, dx, dy, density;
};

struct window_content {
    const uint8_t *picture; /* 3 bytes per pixel, rows from the top */
    uint32_t width, height;
    bool picture_changed;
    int left, top, shown_width, shown_height; /* where the picture goes */
    const uint8_t *overlay;                   /* over all of the window: red, green, blue, opacity */
    uint32_t window_width, window_height;
    bool overlay_changed;
    /* Not 0: a picture of this size begins, and the window should get its size unless the user has chosen another. */
    uint32_t fit_width, fit_height;
};

struct window_driver {
    void *context;
    /* Opens a window for a picture of this size; its first event is a WINDOW_SIZE. */
    bool (*open)(void *context, uint32_t width, uint32_t height, const char *title, struct error *error);
    void (*show)(void *context, const struct window_content *frame);
    bool (*poll)(void *context, struct window_event *event); /* false: nothing happened */
    void (*title)(void *context, const char *text);
    void (*grab)(void *context, bool on); /* the mouse is hidden and kept inside the window */
    void (*full_screen)(void *context);   /* on, or off again */
    void (*close)(void *context);
};

#endif
