/* What is drawn over the picture. */
#ifndef GRAY_VIEWER_VIEWER_OVERLAY_INTERNAL_H
#define GRAY_VIEWER_VIEWER_OVERLAY_INTERNAL_H

#include "viewer/viewer.h"

void viewer_choose_overlay(struct viewer *viewer, enum overlay overlay); /* or none, if it is already shown */
void viewer_invalidate_overlay(struct viewer *viewer);                   /* the view or the scene has changed */
bool viewer_needs_overlay(const struct viewer *viewer);
struct view_overlay_request viewer_overlay_request(const struct viewer *viewer, bool walking);
void viewer_receive_overlay(struct viewer *viewer, const struct view_overlay_request *request,
                            const struct view_overlay *overlay);
void viewer_make_lines(struct viewer *viewer); /* outline and symbols: window.lines */
/* Looks along the axis of a face of the view cube that is there; false: there is none. */
bool viewer_click_cube(struct viewer *viewer, double x, double y);
void viewer_destroy_overlay(struct viewer *viewer);

#endif
