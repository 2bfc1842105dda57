/* Keys, buttons and the mouse. */
#ifndef GRAY_VIEWER_VIEWER_INPUT_INTERNAL_H
#define GRAY_VIEWER_VIEWER_INPUT_INTERNAL_H

#include "viewer/viewer.h"

void viewer_do(struct viewer *viewer, enum window_action action);
uint32_t viewer_needs_met(const struct viewer *viewer); /* by enum action_need, as bits */
void viewer_handle_event(struct viewer *viewer, const struct window_event *event);
/* Rows for the tree, to the window. */
void viewer_receive_nodes(struct viewer *viewer, const struct node_query *query, struct node_rows *rows);
void viewer_change_view(struct viewer *viewer); /* the camera was moved */
/* Stops rendering and building, and keeps the image; or continues. */
void viewer_halt(struct viewer *viewer, bool on);
/* The form, and the integrator, as they are now. */
void viewer_make_form(const struct viewer *viewer, struct window_state *state);

#endif
