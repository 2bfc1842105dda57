/* Lines over a finished picture: the boxes of what is placed, or the cells of what rays search. */
#ifndef GRAY_RENDER_OVERLAY_H
#define GRAY_RENDER_OVERLAY_H

#include "base/pool.h"
#include "render/render.h"

/* Draws what job->settings.overlay says into the film of a job that is done, on the calling thread. Lines are seen
 * through the middle of the lens when the shutter opens; what lies behind a surface is drawn faintly. At most
 * OVERLAY_BOXES boxes: of more, every second, third ... False: no memory, or cancelled. */
enum { OVERLAY_BOXES = 200000 };
bool overlay_draw(const struct render_job *job, const struct pool *pool, struct error *error);

#endif
