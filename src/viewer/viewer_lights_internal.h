/* Edits of lights, which are numbered from 1. */
#ifndef GRAY_VIEWER_VIEWER_LIGHTS_INTERNAL_H
#define GRAY_VIEWER_VIEWER_LIGHTS_INTERNAL_H

#include "render/camera.h"
#include "viewer/viewer.h"

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
struct colour viewer_light_colour_now(const struct viewer *viewer); /* before it is brightened */
void viewer_light_colour(struct viewer *viewer, struct colour colour);

#endif
