/* The image, and the drawing over it. */
#ifndef GRAY_VIEWER_VIEWER_DRAW_INTERNAL_H
#define GRAY_VIEWER_VIEWER_DRAW_INTERNAL_H

#include "viewer/viewer.h"

void viewer_draw_tiles(struct viewer *viewer);               /* film to canvas */
void viewer_redraw(struct viewer *viewer);                   /* the canvas, with another exposure */
void viewer_draw_again(struct viewer *viewer, size_t pixel); /* one pixel of it */
void viewer_show(struct viewer *viewer, double now);
/* Positions the picture in a window of this size. False: no memory for the drawing over it. */
bool viewer_resize(struct viewer *viewer, int width, int height, double density);

#endif
