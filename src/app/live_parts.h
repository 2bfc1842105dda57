/* What the files of a live picture share; nobody else includes this. */
#ifndef GRAY_APP_LIVE_PARTS_H
#define GRAY_APP_LIVE_PARTS_H

#include "app/live.h"

/* live_input.c */
void live_take_event(struct live *live, const struct window_event *event);
void live_change_view(struct live *live); /* the camera was moved */

/* live_draw.c */
void live_draw_tiles(struct live *live); /* film to canvas */
void live_show(struct live *live, double now);
/* Where the picture goes when the window has so many pixels. False: no memory for what is drawn over it. */
bool live_resize(struct live *live, int width, int height, double density);

#endif
