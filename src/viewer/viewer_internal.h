/* Shared by the files of the viewer. */
#ifndef GRAY_VIEWER_VIEWER_INTERNAL_H
#define GRAY_VIEWER_VIEWER_INTERNAL_H

#include "render/camera.h"
#include "viewer/viewer.h"

/* viewer.c: the picture is complete, and there is nothing to do. */
bool viewer_is_idle(const struct viewer *viewer);
bool viewer_is_enlarging(const struct viewer *viewer); /* the same, but for the pixels of a larger window */
void viewer_note_stop(struct viewer *viewer, double seconds);

/* viewer_input.c */
void viewer_handle_event(struct viewer *viewer, const struct window_event *event);
void viewer_change_view(struct viewer *viewer); /* the camera was moved */
/* Stops rendering and building, and keeps the image; or continues. */
void viewer_halt(struct viewer *viewer, bool on);
void viewer_render(struct viewer *viewer); /* renders renders again, from coarse to fine */

/* viewer_edit.c */
/* A click on the picture, at pixels of the window: selects a visible light mark there, else sends a request to the
 * render process. operand: selects the operand of a combined solid whose surface is there. */
void viewer_click(struct viewer *viewer, double x, double y, bool operand);
void viewer_request_pixel_trace(struct viewer *viewer, double x, double y);
void viewer_receive_picked(struct viewer *viewer, const struct picked *picked);
void viewer_select_up(struct viewer *viewer, bool down);                 /* the node above, or the operand below */
void viewer_drag_selection(struct viewer *viewer, double dx, double dy); /* with the tool, by pixels of the window */
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

/* viewer_lights.c; lights are numbered from 1 */
void viewer_receive_lights(struct viewer *viewer, const struct preview_reply *reply);
const struct light_info *viewer_light(const struct viewer *viewer, uint32_t number); /* NULL: it was not reported */
/* The position of its mark, in pixels of the window; *seen: the mark is at the light, and not at the border in its
 * direction. False: no mark. */
bool viewer_light_marker(const struct viewer *viewer, const struct camera_frame *frame, uint32_t number, double *x,
                         double *y, bool *seen);
bool viewer_near_light(const struct viewer *viewer, double x, double y, uint32_t *number);
void viewer_select_light(struct viewer *viewer, uint32_t number);
void viewer_next_light(struct viewer *viewer, bool back);
/* Edits of the selected light; those that it does not support have no effect. */
void viewer_light_move(struct viewer *viewer, struct vec3 route);
void viewer_light_turn(struct viewer *viewer, const struct transform *map,
                       bool sizes); /* rotated by the map, or scaled */
void viewer_light_delete(struct viewer *viewer);
void viewer_add_light(struct viewer *viewer);
void viewer_copy_light(struct viewer *viewer);
void viewer_brighten_light(struct viewer *viewer, double stops); /* to this number of lights above the script's */
double viewer_light_stops_now(const struct viewer *viewer);
struct vec3 viewer_light_colour_now(const struct viewer *viewer); /* before it is brightened */
void viewer_light_colour(struct viewer *viewer, struct vec3 colour);

/* viewer_overlay.c */
void viewer_choose_overlay(struct viewer *viewer, enum overlay overlay); /* or none, if it is already shown */
void viewer_invalidate_overlay(struct viewer *viewer);                   /* the view or the scene has changed */
bool viewer_needs_overlay(const struct viewer *viewer);
struct view_overlay_request viewer_overlay_request(const struct viewer *viewer, bool walking);
void viewer_receive_overlay(struct viewer *viewer, const struct view_overlay_request *request,
                            const struct view_overlay *overlay);
/* False if the outline is out of date. */
bool viewer_draw_outline(struct viewer *viewer, struct canvas_colour colour);
void viewer_destroy_overlay(struct viewer *viewer);

/* viewer_player.c */
enum player_decision {
    PLAYER_REFINES, /* passes of this frame, as of any picture */
    PLAYER_WAITS,   /* the frame is finished, and not due yet */
    PLAYER_GOES,    /* to another frame */
};
void viewer_player_begin(struct viewer *viewer, const struct viewer *before);
/* Whether the picture is another frame of the animation in the window. */
bool viewer_player_continues(const struct viewer *before, const struct picture_request *request);
enum player_decision viewer_player_decide(struct viewer *viewer, double now);
void viewer_player_end_pass(struct viewer *viewer, double now); /* chooses pass.divide for the next frame */
bool viewer_plays(const struct viewer *viewer);
/* The next frame is not finished yet: the screen does not change. */
bool viewer_awaits_frame(const struct viewer *viewer, double now);
void viewer_play(struct viewer *viewer, bool on);
void viewer_player_loop(struct viewer *viewer);                  /* on, or off again */
void viewer_step_frames(struct viewer *viewer, int by);          /* pauses */
void viewer_go_to_frame(struct viewer *viewer, uint32_t number); /* pauses */
/* The visible or requested frame: its index among those that can be shown, from 0. */
uint32_t viewer_frame_index(const struct viewer *viewer);
uint32_t viewer_frame_number(const struct viewer *viewer, double index);

/* viewer_large.c */
bool viewer_wants_large(const struct viewer *viewer);       /* the view is complete, and the window is larger */
bool viewer_large_is_outdated(const struct viewer *viewer); /* the pass is for another size of the window */
bool viewer_begin_large(struct viewer *viewer);             /* lays out its film; false: there is no memory */
void viewer_draw_large(struct viewer *viewer);              /* film to image */
void viewer_drop_large(struct viewer *viewer);              /* the image of the display is shown */
void viewer_destroy_large(struct viewer *viewer);

/* viewer_draw.c */
struct figures {
    char state[64], size[48], rays[48], triangles[48], voxels[64], frames[48], frame[64];
    double share; /* of the work */
};
void viewer_draw_tiles(struct viewer *viewer);               /* film to canvas */
void viewer_redraw(struct viewer *viewer);                   /* the canvas, with another exposure */
void viewer_draw_again(struct viewer *viewer, size_t pixel); /* one pixel of it */
void viewer_show(struct viewer *viewer, double now);
/* Positions the picture in a window of this size. False: no memory for the drawing over it. */
bool viewer_resize(struct viewer *viewer, int width, int height, double density);

/* viewer_panel.c */
void viewer_draw_edge(struct viewer *viewer, const struct camera_frame *frame, struct vec3 a, struct vec3 b,
                      struct canvas_colour colour);
void viewer_draw_lights(struct viewer *viewer, const struct camera_frame *frame);
void viewer_draw_light_list(struct viewer *viewer, int top); /* the list, if it is open */
void viewer_draw_selection_panel(struct viewer *viewer, int top);

/* viewer_hud.c: the drawing over the picture, and its buttons. */
void viewer_draw_hud(struct viewer *viewer, const struct figures *figures);

#endif
