/* The view at the resolution of the window. */
#ifndef GRAY_VIEWER_VIEWER_LARGE_INTERNAL_H
#define GRAY_VIEWER_VIEWER_LARGE_INTERNAL_H

#include "viewer/viewer.h"

bool viewer_wants_large(const struct viewer *viewer);       /* the view is complete, and the window is larger */
bool viewer_large_is_outdated(const struct viewer *viewer); /* the pass is for another size of the window */
bool viewer_begin_large(struct viewer *viewer);             /* lays out its film; false: there is no memory */
void viewer_draw_large(struct viewer *viewer);              /* film to image */
void viewer_drop_large(struct viewer *viewer);              /* the image of the display is shown */
void viewer_destroy_large(struct viewer *viewer);

#endif
