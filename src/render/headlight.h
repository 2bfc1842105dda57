/* The picture while a camera moves: one ray for each pixel, shaded by a light at the eye and a little ambient light,
 * with the colours and textures of the materials. No other rays: no shadows, reflections, media. */
#ifndef GRAY_RENDER_HEADLIGHT_H
#define GRAY_RENDER_HEADLIGHT_H

#include "render/render.h"

/* What it shows: surfaces under the light; half of the unit normal plus a half; the depth, from white to black over the
 * distances of the box around all finite objects; the work for the ray, by its logarithm from blue over green to red
 * (4096 steps and tests); the form factor from the surface to a patch of radiosity, from blue (2^-16) to red (1). The
 * last four have this value for any exposure. */
enum headlight_shows { HEADLIGHT_SURFACES, HEADLIGHT_NORMALS, HEADLIGHT_DEPTH, HEADLIGHT_COST, HEADLIGHT_FACTORS };

struct headlight_request {
    enum headlight_shows shows;
    bool coarse;    /* functions of colours are evaluated once for a pixel, not over it */
    uint8_t state;  /* that tiles are in then; those that are done stay */
    uint32_t patch; /* of HEADLIGHT_FACTORS: its number, or PATCH_NONE: surfaces */
};
/* Renders every tile of the film that is not done. Surfaces are as bright in the file as without exposure; the sky is
 * that of the picture. With integrator radiosity, diffuse surfaces have the stored light, once job->radiosity is that
 * of the world. False: cancelled, or no memory. */
bool render_headlight(const struct render_job *job, const struct headlight_request *request, struct pool *pool,
                      struct render_statistics *statistics, struct error *error);

#endif
