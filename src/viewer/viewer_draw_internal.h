/* The image, and what is shown of it. */
#ifndef GRAY_VIEWER_VIEWER_DRAW_INTERNAL_H
#define GRAY_VIEWER_VIEWER_DRAW_INTERNAL_H

#include "viewer/viewer.h"

void viewer_draw_tiles(struct viewer *viewer);               /* from the film to the image */
void viewer_redraw(struct viewer *viewer);                   /* the image, with another exposure */
void viewer_draw_again(struct viewer *viewer, size_t pixel); /* one pixel of it */
void viewer_show(struct viewer *viewer, double now);
/* Positions the picture in a window of this size. */
void viewer_resize(struct viewer *viewer, int width, int height, double density);

#endif
