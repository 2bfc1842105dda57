/* The interface to a window: it shows a picture with lines over it, has widgets for everything else, and reports input.
 * The driver of window_channel.c has the window in another process; tests have their own. All positions are pixels of
 * the screen, from the upper left corner of the place for the picture. */
#ifndef GRAY_WINDOW_WINDOW_H
#define GRAY_WINDOW_WINDOW_H

#include "base/error.h"
#include "inspect/node_list.h"
#include "render/fly_camera.h"
#include "window/actions.h"

#include <stdbool.h>
#include <stdint.h>

enum window_event_kind {
    WINDOW_CLOSE,
    WINDOW_KEY,     /* the key that flies, `key`, is down or up; repeats are left out */
    WINDOW_MOVE,    /* x, y: position of the mouse; dx, dy: its motion */
    WINDOW_WHEEL,   /* y: steps away from the user */
    WINDOW_PRESS,   /* button at x, y */
    WINDOW_RELEASE, /* the same */
    WINDOW_LEAVE,   /* the picture has lost the keyboard: no key is pressed */
    WINDOW_SIZE,    /* x, y: the size for the picture; density: pixels per dot of the desktop */
    WINDOW_TYPE,    /* the character `typed` for a tool: an axis, a digit; backspace; return */
    WINDOW_ACTION,  /* action, by a key, a menu or a button; x, y: of the mouse */
    WINDOW_NODES,   /* rows of the children of `node` are wanted */
    WINDOW_SELECT,  /* `node` is selected in the tree */
    WINDOW_ADD,     /* the object of the Lua call `text` */
    WINDOW_TEXTURE, /* the texture of the call `text`: for what is at x, y if `down`, else for the selection */
    WINDOW_HIDE,    /* the node with the serial of `node` and the name `text` is hidden, or shown again */
    WINDOW_FIELD,   /* the field with this number of the form: numbers; joins: it is part of the change before */
};
enum { WINDOW_LEFT = 1, WINDOW_MIDDLE = 2, WINDOW_RIGHT = 4 };

struct window_event {
    enum window_event_kind kind;
    enum fly_camera_key key;
    int button;
    bool down, control, shift; /* control, shift: held */
    char typed;
    double x, y, dx, dy, density;
    enum window_action action;
    uint32_t field;
    double numbers[3];
    bool joins;
    struct node_query node;
    char text[1024]; /* a name; a call; of an action that saves: the file, or empty; of a FIELD_ENTRY: its text */
};

/* One input of a form: the window makes a widget from it, and reports a change by its number. */
enum window_field_kind {
    FIELD_TEXT,   /* only shown */
    FIELD_NUMBER, /* one number */
    FIELD_VECTOR, /* three numbers */
    FIELD_COLOUR, /* three numbers that may be above 1 */
    FIELD_CHOICE, /* one of the words in `text`, divided by '|' */
    FIELD_FLAG,
    FIELD_ENTRY, /* the text, which can be edited */
};
enum {
    FORM_FIELDS = 80,
    FORM_TEXT = 512,
    FORM_HELP = 192,
    WINDOW_FIELD_FRAME = 1 /* the number of the slider of an animation */
};
struct window_field {
    enum window_field_kind kind;
    uint32_t number;                       /* what the field is, to the receiver of its events */
    bool resets;                           /* it has a default: the number `initial` */
    bool linear;                           /* a colour is light, and shown as the screen shows it */
    bool acts;                             /* a number is not a state: it does something, and the field is as before */
    char group[32], name[32], unit[16];    /* unit #: whole numbers */
    double numbers[3], initial, low, high; /* low and high may be infinite */
    char text[FORM_TEXT], help[FORM_HELP];
};
struct window_form {
    uint64_t subject; /* another one: the widgets are made anew */
    char title[64];
    uint32_t count;
    struct window_field fields[FORM_FIELDS];
};

/* A line over the picture. */
enum line_colour {
    LINE_COLOUR_SELECTED,
    LINE_COLOUR_LIGHT,
    LINE_COLOUR_FAINT,
    LINE_COLOUR_X,
    LINE_COLOUR_Y,
    LINE_COLOUR_Z
};
struct window_line {
    float x0, y0, x1, y1;
    enum line_colour colour;
};
enum { WINDOW_LINES = 4096, WINDOW_TRACE = 16384, WINDOW_HIDDEN = 256 };

/* Everything that the window shows but the picture and the rows of the tree. */
struct window_state {
    bool has_scene;                             /* else the page without a scene */
    bool lacks_nodes;                           /* a view of a light field or a panorama: no tree */
    bool flies;                                 /* letters move the camera */
    bool full_screen;                           /* the whole screen */
    bool types;                                 /* a tool is chosen: letters and digits are for it */
    bool halted, busy, playing, loops, unsaved; /* unsaved: edits */
    bool waits;   /* no script runs, so nothing is rendered until a file changes or the user wants it */
    bool changed; /* a file has changed, but the picture would be lost: the user decides */
    bool runs;    /* the scripts run, and there is no picture yet */
    char file[256], state[64], figures[288], frame[64], tool[64];
    char message[512], notice[512]; /* an error that stays; a line that goes away by itself */
    double share;                   /* of the work, 0 to 1 */
    uint32_t action_on;             /* by enum action_need, as bits: what there is */
    uint32_t frame_index, frame_count;
    char trace[WINDOW_TRACE];                     /* of a pixel, or empty */
    int left, top, shown_width, shown_height;     /* where the picture goes */
    struct node_query selected;                   /* the node that is selected; depth 0: none */
    uint32_t hidden_count, hidden[WINDOW_HIDDEN]; /* serials of nodes */
    struct window_form form;
    struct window_field integrator; /* number 0: none */
    uint32_t line_count;
    struct window_line lines[WINDOW_LINES];
};

struct window_driver {
    void *context;
    struct window_state *state; /* what the window shows when it has been published by `show`; the viewer writes it */
    /* Opens the window, or takes the open one for another scene; its first event is a WINDOW_SIZE. */
    bool (*open)(void *context, struct error *error);
    void (*close)(void *context);
    bool (*poll)(void *context, struct window_event *event); /* false: nothing happened */
    int (*descriptor)(void *context);                        /* becomes readable with an event; or -1 */
    /* The picture (3 bytes per pixel, rows from the top) and the state. */
    void (*show)(void *context, const uint8_t *picture, uint32_t width, uint32_t height);
    /* Rows that were wanted; query NULL: the tree is another one, and no row is known. */
    void (*nodes)(void *context, const struct node_query *query, const struct node_rows *rows);
};

#endif
