/* The marks and lists of lights, and the properties of the selection. */
#ifndef GRAY_VIEWER_VIEWER_PANEL_INTERNAL_H
#define GRAY_VIEWER_VIEWER_PANEL_INTERNAL_H

#include "render/camera.h"
#include "viewer/viewer.h"

void viewer_draw_edge(struct viewer *viewer, const struct camera_frame *frame, struct vec3 a, struct vec3 b,
                      struct canvas_colour colour);
void viewer_draw_lights(struct viewer *viewer, const struct camera_frame *frame);
void viewer_draw_light_list(struct viewer *viewer, int top); /* the list, if it is open */
void viewer_draw_selection_panel(struct viewer *viewer, int top);

#endif
