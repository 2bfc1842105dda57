/* Lines over a finished picture: the boxes of primitives, the cells of the accelerator, or the patches of radiosity. */
#ifndef GRAY_RENDER_OVERLAY_H
#define GRAY_RENDER_OVERLAY_H

#include "base/pool.h"
#include "render/render.h"

enum { OVERLAY_BOXES = 200000 };

struct overlay_request {
    enum overlay kind;
    uint32_t limit; /* at most so many boxes, from 1: of more, every second, third ... */
    uint32_t cell;  /* visibility is tested once for this many pixels across and down, from 1 */
};

/* Computes the lines of a request for the film of a job; does not read its pixels. The view is through the centre of
 * the lens when the shutter opens; lines behind a surface are faint. lines: by pixel, for overlay_blend. The same for
 * any number of threads. False: no memory, or cancelled. */
bool overlay_lines(const struct render_job *job, struct pool *pool, const struct overlay_request *request,
                   float (*lines)[4], struct error *error);

/* One pixel under its lines: its remaining weight, and the light of the lines. */
static inline void overlay_blend(const float lines[4], float rgb[3]) {
    for (int c = 0; c < 3; c++)
        rgb[c] = lines[3] * rgb[c] + lines[c];
}
void overlay_lay(struct film *film, float (*lines)[4]);

/* Draws job->settings.overlay into the film of a finished job. False: as overlay_lines. */
bool overlay_draw(const struct render_job *job, struct pool *pool, struct error *error);

#endif
