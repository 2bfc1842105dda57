/* The image, and what is shown of it. */
#ifndef GRAY_VIEWER_VIEWER_DRAW_INTERNAL_H
#define GRAY_VIEWER_VIEWER_DRAW_INTERNAL_H

#include "viewer/viewer.h"

void viewer_draw_tiles(struct viewer *viewer); /* from the film to the image */
void viewer_redraw(struct viewer *viewer);     /* the image, with another exposure */
void viewer_show(struct viewer *viewer, double now);
/* Positions the picture in a window of this size. */
void viewer_resize(struct viewer *viewer, int width, int height, double density);
void viewer_choose_overlay(struct viewer *viewer, enum overlay overlay); /* or none, if it is already shown */
void viewer_invalidate_overlay(struct viewer *viewer);                   /* the view or the scene has changed */
bool viewer_needs_overlay(const struct viewer *viewer);
struct view_overlay_request viewer_overlay_request(const struct viewer *viewer, bool walking);
void viewer_receive_overlay(struct viewer *viewer, const struct view_overlay_request *request,
                            const struct view_overlay *overlay);
/* Looks along the axis of a face of the view cube that is there; false: there is none. */
bool viewer_click_cube(struct viewer *viewer, double x, double y);
void viewer_destroy_overlay(struct viewer *viewer);

#endif
