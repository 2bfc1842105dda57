/* Animations: which frame is next, and when it is due. */
#ifndef GRAY_VIEWER_VIEWER_PLAYER_INTERNAL_H
#define GRAY_VIEWER_VIEWER_PLAYER_INTERNAL_H

#include "viewer/viewer.h"

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

#endif
