/* Notices about options and fields that have no effect on the picture. */
#ifndef GRAY_HOST_EFFECTS_H
#define GRAY_HOST_EFFECTS_H

#include "host/render_process_internal.h"

void effects_note(struct picture_work *work);
/* Counts a finished frame; at the end of a run a notice about an animation of one frame, or of equal ones. */
void effects_count_frame(struct picture_work *work);
void effects_note_frames(struct render_process *process);

#endif
