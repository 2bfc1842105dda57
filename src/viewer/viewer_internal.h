/* What the files of a live picture share; nobody else includes this. */
#ifndef GRAY_VIEWER_VIEWER_INTERNAL_H
#define GRAY_VIEWER_VIEWER_INTERNAL_H

#include "render/camera.h"
#include "viewer/viewer.h"

/* viewer.c: the picture is complete, and nobody wants anything. */
bool live_is_idle(const struct live *live);
void live_note_stop(struct live *live, double seconds);

/* viewer_input.c */
void live_take_event(struct live *live, const struct window_event *event);
void live_change_view(struct live *live); /* the camera was moved */
/* Nothing is rendered or built any more, and what is shown stays; or it goes on. */
void live_halt(struct live *live, bool on);
void live_render(struct live *live); /* again, from coarse to fine */

/* viewer_edit.c */
/* A click on the picture, at pixels of the window: a light that shows there is selected, else the child is asked.
 * operand: of a combined solid that one is selected whose surface is there. */
void live_click(struct live *live, double x, double y, bool operand);
void live_ask_story(struct live *live, double x, double y);
void live_take_picked(struct live *live, const struct picked *picked);
void live_select_up(struct live *live, bool down);       /* the node above, or the operand below */
void live_drag(struct live *live, double dx, double dy); /* with the tool, by pixels of the window */
void live_push(struct live *live, double steps);         /* what is selected goes away from the camera, or nearer */
void live_make(struct live *live, const struct change *change, bool present, bool join);
void live_undo(struct live *live, bool again);
void live_delete(struct live *live);
void live_add(struct live *live, enum added_kind kind);
void live_look(struct live *live, enum look_part part, const double numbers[3]); /* of the material that was hit */
void live_own(struct live *live); /* gives what is selected a material of its own */
void live_expose(struct live *live, double stops);
/* The child is told everything anew. */
void live_resend(struct live *live);
/* What holds now. */
void live_look_now(const struct live *live, enum look_part part, double numbers[3]);
/* A place on what is selected, as it was when it was picked: where it is now. */
struct vec3 live_moved_point(const struct live *live, struct vec3 point);
/* The camera of the last pass; false: it cannot be. */
bool live_frame(const struct live *live, struct camera_frame *frame);
/* Where new things go: where somebody clicked last, or before the camera. */
struct vec3 live_new_place(const struct live *live);
/* From a place in the world to pixels of the window; false: it is not to be seen. */
bool live_project(const struct live *live, const struct camera_frame *frame, struct vec3 point, double *x, double *y);

/* viewer_lights.c; lights are numbered from 1 */
void live_take_lights(struct live *live, const struct studio_news *news);
const struct told_light *live_light(const struct live *live, uint32_t number); /* NULL: nothing is known of it */
/* Where it is marked, pixels of the window; *seen: it is there, and not only at the border on the way to it. False:
 * nowhere. */
bool live_light_mark(const struct live *live, const struct camera_frame *frame, uint32_t number, double *x, double *y,
                     bool *seen);
bool live_near_light(const struct live *live, double x, double y, uint32_t *number);
void live_select_light(struct live *live, uint32_t number);
void live_next_light(struct live *live, bool back);
/* Of the one that is selected; what it cannot do changes nothing. */
void live_light_move(struct live *live, struct vec3 way);
void live_light_turn(struct live *live, const struct transform *map, bool sizes); /* turned by the map, or sized */
void live_light_delete(struct live *live);
void live_add_light(struct live *live);
void live_copy_light(struct live *live);
void live_brighten(struct live *live, double stops); /* to so many above the script's */
double live_stops_now(const struct live *live);
struct vec3 live_light_colour_now(const struct live *live); /* before it is brightened */
void live_light_colour(struct live *live, struct vec3 colour);

/* viewer_overlay.c */
void live_choose_overlay(struct live *live, enum overlay overlay); /* or none, where it is shown already */
void live_stale_marks(struct live *live);                          /* the view or the scene is another one */
bool live_wants_marks(const struct live *live);
struct marks_wish live_marks_wish(const struct live *live, bool walking);
void live_take_marks(struct live *live, const struct marks_wish *asked, const struct marks *marks);
/* False: there is none that is true now. */
bool live_draw_outline(struct live *live, struct ink ink);
void live_destroy_marks(struct live *live);

/* viewer_draw.c */
struct figures {
    char state[64], size[48], rays[48], triangles[48], voxels[64], frames[48];
    double share; /* of the work */
};
void live_draw_tiles(struct live *live);               /* film to canvas */
void live_redraw(struct live *live);                   /* the canvas, in another exposure */
void live_draw_again(struct live *live, size_t pixel); /* one pixel of it */
void live_show(struct live *live, double now);
/* Where the picture goes when the window has so many pixels. False: no memory for what is drawn over it. */
bool live_resize(struct live *live, int width, int height, double density);

/* viewer_panel.c */
void live_draw_edge(struct live *live, const struct camera_frame *frame, struct vec3 a, struct vec3 b, struct ink ink);
void live_draw_lights(struct live *live, const struct camera_frame *frame);
void live_tell_lights(struct live *live, int top); /* the list, where it is wanted */
void live_tell_selection(struct live *live, int top);

/* viewer_hud.c: what lies over the picture, and what people do there. */
void live_tell_over(struct live *live, const struct figures *figures);

#endif
