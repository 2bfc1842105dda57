/* What depends on the integrator of a picture before it is rendered. */
#ifndef GRAY_RENDER_INTEGRATOR_H
#define GRAY_RENDER_INTEGRATOR_H

#include "render/render.h"

/* What films for pictures of an integrator record at least, and with the layers and the denoiser of the settings. */
struct film_record render_record(const struct settings *settings);
/* Warnings about parts of the scene that the integrator interprets differently; the world is built. */
void integrator_warn(const struct render_job *job, world_warning *warn, void *context);

/* What the integrator keeps for later pictures (job->radiosity), so that render_run finds it. Errors: those of it. */
bool integrator_prepare(const struct render_job *job, struct pool *pool, struct error *error);

#endif
