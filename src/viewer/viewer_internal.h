/* Shared by the files of the viewer. */
#ifndef GRAY_VIEWER_VIEWER_INTERNAL_H
#define GRAY_VIEWER_VIEWER_INTERNAL_H

#include "render/camera.h"
#include "viewer/viewer.h"

/* The picture is complete, and there is nothing to do. */
bool viewer_is_idle(const struct viewer *viewer);
bool viewer_is_enlarging(const struct viewer *viewer); /* the same, but for the pixels of a larger window */
void viewer_note_stop(struct viewer *viewer, double seconds);

#endif
