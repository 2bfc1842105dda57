/* What the files of the viewer share: each declares its own in a header, and they all see each other. */
#ifndef GRAY_VIEWER_VIEWER_INTERNAL_H
#define GRAY_VIEWER_VIEWER_INTERNAL_H

#include "viewer/viewer_draw_internal.h"
#include "viewer/viewer_edit_internal.h"
#include "viewer/viewer_input_internal.h"
#include "viewer/viewer_large_internal.h"
#include "viewer/viewer_player_internal.h"

/* The picture is complete, and there is nothing to do. */
bool viewer_is_idle(const struct viewer *viewer);
bool viewer_is_enlarging(const struct viewer *viewer); /* the same, but for the pixels of a larger window */
/* Samples of paths are shown when they are denoised. */
bool viewer_shows_denoised(const struct viewer *viewer);
void viewer_choose_mode(struct viewer *viewer, struct view_mode mode);
/* After a coarse pass: the resolution of the next one, which is to take that long, or up to the limit where it would
 * have less than a quarter of the pixels in each direction. One slow pass may be the fault of another program, so it
 * changes slowly; a margin prevents that it changes to and fro. */
void viewer_fit_resolution(struct viewer *viewer, double now, double seconds, double limit);
/* The view has changed: it is rendered again. */
void viewer_outdate(struct viewer *viewer);
void viewer_note_stop(struct viewer *viewer, double seconds);

#endif
