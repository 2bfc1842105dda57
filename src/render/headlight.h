/* The picture while a camera moves: one ray for each pixel, shaded by a light at the eye and a little ambient light,
 * with the colours and textures of the materials. No other rays: no shadows, reflections, media. */
#ifndef GRAY_RENDER_HEADLIGHT_H
#define GRAY_RENDER_HEADLIGHT_H

#include "render/render.h"

/* Renders every wanted tile of the film. Surfaces are as bright in the file as without exposure; the sky is that of the
 * picture. False: cancelled, or no memory. */
bool render_headlight(const struct render_job *job, struct pool *pool, struct render_statistics *statistics,
                      struct error *error);

#endif
