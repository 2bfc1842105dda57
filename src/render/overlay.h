/* Lines over a finished picture: the boxes of what is placed, or the cells of what rays search. */
#ifndef GRAY_RENDER_OVERLAY_H
#define GRAY_RENDER_OVERLAY_H

#include "base/pool.h"
#include "render/render.h"

enum { OVERLAY_BOXES = 200000 };

struct overlay_request {
    enum overlay kind;
    uint32_t limit; /* at most so many boxes, from 1: of more, every second, third ... */
    uint32_t cell;  /* what is behind a surface is asked once for so many pixels across and down, from 1 */
};

/* Finds the lines of a wish for the film of a job, whose pixels are not looked at. Lines are seen through the middle of
 * the lens when the shutter opens; what lies behind a surface is drawn faintly. lines: by pixel what overlay_blend does
 * to it. The same for any number of threads. False: no memory, or cancelled. */
bool overlay_lines(const struct render_job *job, struct pool *pool, const struct overlay_request *request,
                   float (*lines)[4], struct error *error);

/* One pixel under its lines: the share of it that is still seen, and the light of the lines. */
static inline void overlay_blend(const float lines[4], float rgb[3]) {
    for (int c = 0; c < 3; c++)
        rgb[c] = lines[3] * rgb[c] + lines[c];
}
void overlay_lay(struct film *film, float (*lines)[4]);

/* Draws what job->settings.overlay says into the film of a job that is done. False: as overlay_lines. */
bool overlay_draw(const struct render_job *job, struct pool *pool, struct error *error);

#endif
