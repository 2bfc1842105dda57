/* A small immediate-mode toolkit: the caller describes a panel again for every frame, and each part returns immediately
 * whether it was used. The only state between frames is the pressed part. Independent of the window. */
#ifndef GRAY_VIEWER_PANEL_H
#define GRAY_VIEWER_PANEL_H

#include "viewer/canvas.h"

enum { PANEL_GROUNDS = 16 };

struct panel {
    struct canvas canvas;
    double mouse_x, mouse_y;
    bool down;              /* the left button */
    bool pressed, released; /* since the frame before */
    int held;               /* the part that is pressed; 0: none */
    int part;               /* parts are numbered in the order of the calls */
    struct {
        int x, y, width, height;
    } grounds[PANEL_GROUNDS]; /* of this frame */
    int ground_count;
};

/* Begins a frame: clears the canvas. */
void panel_begin(struct panel *panel);
/* Ends it: clears the recorded presses and releases. */
void panel_end(struct panel *panel);

/* Whether a press at that position is for the panel, according to the last frame. */
bool panel_covers(const struct panel *panel, double x, double y);

/* Sizes of parts, pixels. */
int panel_line_height(const struct panel *panel);
int panel_button_width(const struct panel *panel, const char *text);

/* A background of parts: at most PANEL_GROUNDS of them. */
void panel_ground(struct panel *panel, int x, int y, int width, int height);
void panel_text(struct panel *panel, int x, int y, const char *text);
void panel_warning(struct panel *panel, int x, int y, const char *text);
/* A share of 0 to 1. */
void panel_bar(struct panel *panel, int x, int y, int width, double share);
/* True: clicked. `on`: drawn as selected. */
bool panel_button(struct panel *panel, int x, int y, const char *text, bool on);
/* Buttons from left to right, as many as there is room for. on: by bit, which of them are drawn as selected; used:
 * which one was clicked. Returns the end of the row. */
int panel_button_row(struct panel *panel, int y, const char *const *words, int count, unsigned on, bool *used);
struct panel_slider {
    int x, y, width;
    double low, high;
    struct canvas_colour colour;
};
/* True: *value was changed by the mouse. */
bool panel_slider(struct panel *panel, const struct panel_slider *slider, double *value);

#endif
