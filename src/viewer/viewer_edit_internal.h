/* The selection, lights, and edits of nodes, lights and materials. */
#ifndef GRAY_VIEWER_VIEWER_EDIT_INTERNAL_H
#define GRAY_VIEWER_VIEWER_EDIT_INTERNAL_H

#include "render/camera.h"
#include "viewer/viewer.h"

/* The camera of the last pass; false: it is invalid. */
bool viewer_camera_frame(const struct viewer *viewer, struct camera_frame *frame);
/* From a position in the world to pixels of the window; false: it is not visible. */
bool viewer_project(const struct viewer *viewer, const struct camera_frame *frame, struct vec3 point, double *x,
                    double *y);

/* Lights, which are numbered from 1. */
void viewer_receive_lights(struct viewer *viewer, const struct preview_reply *reply);
const struct light_info *viewer_light(const struct viewer *viewer, uint32_t number); /* NULL: it was not reported */
/* The position of its mark, in pixels of the window; *seen: the mark is at the light, and not at the border in its
 * direction. False: no mark. */
bool viewer_light_marker(const struct viewer *viewer, const struct camera_frame *frame, uint32_t number, double *x,
                         double *y, bool *seen);

/* A click on the picture, at pixels of the window: selects a visible light mark there, else sends a request to the
 * render process. operand: selects the operand of a combined solid whose surface is there. */
void viewer_click(struct viewer *viewer, double x, double y, bool operand);
void viewer_probe(struct viewer *viewer, double x, double y); /* asks what is there, for orbits and dollies */
void viewer_request_pixel_trace(struct viewer *viewer, double x, double y);
/* To the patch of radiosity that is under the mouse. */
void viewer_show_factors(struct viewer *viewer);
void viewer_select_node(struct viewer *viewer, const struct node_query *node);
void viewer_select_light(struct viewer *viewer, uint32_t number);
void viewer_next_light(struct viewer *viewer, bool back);
void viewer_select_up(struct viewer *viewer, bool down); /* the node above, or the operand below */
void viewer_receive_picked(struct viewer *viewer, const struct picked *picked);
/* The camera moves back or forth until the selection, or the scene, fills the picture. */
void viewer_frame(struct viewer *viewer, bool selection);
/* The current position of a point on the selection, given its position at the time of picking; and of its middle. */
struct vec3 viewer_moved_point(const struct viewer *viewer, struct vec3 point);
struct vec3 viewer_selection_position(const struct viewer *viewer);

/* Whether the tool has an effect on the selection. What has none does nothing. */
bool viewer_can(const struct viewer *viewer, enum edit_tool tool);
void viewer_move(struct viewer *viewer, struct vec3 by);
void viewer_turn(struct viewer *viewer, struct vec3 axis, double degrees); /* about its middle */
void viewer_scale(struct viewer *viewer, struct vec3 factors);             /* about its middle, along the axes */
/* With the tool, and along its axis, if it has one, by pixels of the window up to where the mouse is. */
void viewer_drag_selection(struct viewer *viewer, double dx, double dy);
void viewer_push_selection(struct viewer *viewer, double steps); /* away from the camera, or nearer */
/* The handle of a tool and an axis, in pixels of the window; false: there is none. */
enum { HANDLE_POINTS = 7 };
bool viewer_handle(const struct viewer *viewer, const struct camera_frame *frame, enum edit_tool tool, int axis,
                   double points[HANDLE_POINTS][2]);
/* True: there is one, and it is the tool until the button is released. */
bool viewer_take_handle(struct viewer *viewer, double x, double y);

/* The current change of one kind (of a material's part) of the selection, or one without effect; and other numbers of
 * it, three from `at` on. */
struct change viewer_change(const struct viewer *viewer, enum change_kind kind, enum material_part part);
void viewer_set_numbers(struct viewer *viewer, enum change_kind kind, enum material_part part, uint32_t at,
                        const double *numbers);
void viewer_undo(struct viewer *viewer, bool again);
void viewer_take_back(struct viewer *viewer, const char *text);
void viewer_resend_edits(struct viewer *viewer);
void viewer_hide(struct viewer *viewer, uint32_t serial, const char *name); /* a node, or shows it again */
void viewer_solo(struct viewer *viewer); /* only the selection is drawn, or everything again */
void viewer_delete_selection(struct viewer *viewer);
void viewer_copy_selection(struct viewer *viewer);
void viewer_add(struct viewer *viewer, const char *call); /* a node or a light, where the user clicked last */
void viewer_drop_texture(struct viewer *viewer, const struct window_event *event);
/* The change that has added the selection by a call; false: there is none. And another call for it. */
bool viewer_added(const struct viewer *viewer, struct change *out);
void viewer_set_call(struct viewer *viewer, const char *call);
void viewer_make_own_material(struct viewer *viewer); /* gives the selection its own material */
void viewer_set_exposure(struct viewer *viewer, double stops);

#endif
