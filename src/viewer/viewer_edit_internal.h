/* The selection, and edits of nodes and materials. */
#ifndef GRAY_VIEWER_VIEWER_EDIT_INTERNAL_H
#define GRAY_VIEWER_VIEWER_EDIT_INTERNAL_H

#include "render/camera.h"
#include "viewer/viewer.h"

/* A click on the picture, at pixels of the window: selects a visible light mark there, else sends a request to the
 * render process. operand: selects the operand of a combined solid whose surface is there. */
void viewer_click(struct viewer *viewer, double x, double y, bool operand);
/* Asks what is there, for orbits and dollies. */
void viewer_probe(struct viewer *viewer, double x, double y);
/* The camera moves back or forth until the selection, or the scene, fills the picture. */
void viewer_frame(struct viewer *viewer, bool selection);
void viewer_request_pixel_trace(struct viewer *viewer, double x, double y);
void viewer_receive_picked(struct viewer *viewer, const struct picked *picked);
void viewer_select_up(struct viewer *viewer, bool down);                 /* the node above, or the operand below */
void viewer_drag_selection(struct viewer *viewer, double dx, double dy); /* with the tool, by pixels of the window */
void viewer_move_selection(struct viewer *viewer, struct vec3 to);
/* About its middle: rotated by degrees about the axes of the world, or scaled. */
void viewer_turn_selection(struct viewer *viewer, const double degrees[3], double factor);
struct vec3 viewer_selection_position(const struct viewer *viewer);
void viewer_push_selection(struct viewer *viewer,
                           double steps); /* moves the selection away from the camera, or nearer */
void viewer_make_edit(struct viewer *viewer, const struct change *change, bool present, bool join);
void viewer_undo(struct viewer *viewer, bool again);
void viewer_delete_selection(struct viewer *viewer);
void viewer_add_node(struct viewer *viewer, enum added_kind kind);
void viewer_set_material(struct viewer *viewer, enum material_part part,
                         const double numbers[3]);    /* of the material that was hit */
void viewer_make_own_material(struct viewer *viewer); /* gives the selection its own material */
void viewer_set_exposure(struct viewer *viewer, double stops);
/* Sends all edits again. */
void viewer_resend_edits(struct viewer *viewer);
/* What holds now. */
void viewer_material_now(const struct viewer *viewer, enum material_part part, double numbers[3]);
/* The current position of a point on the selection, given its position at the time of picking. */
struct vec3 viewer_moved_point(const struct viewer *viewer, struct vec3 point);
/* The camera of the last pass; false: it is invalid. */
bool viewer_camera_frame(const struct viewer *viewer, struct camera_frame *frame);
/* The position of new nodes: the last clicked point, or in front of the camera. */
struct vec3 viewer_new_position(const struct viewer *viewer);
/* From a position in the world to pixels of the window; false: it is not visible. */
bool viewer_project(const struct viewer *viewer, const struct camera_frame *frame, struct vec3 point, double *x,
                    double *y);

#endif
