/* Pictures of radiosity: Whitted's integrator over the light that is stored at patches. */
#ifndef GRAY_RENDER_STORED_LIGHT_INTERNAL_H
#define GRAY_RENDER_STORED_LIGHT_INTERNAL_H

#include "render/integrator_state_internal.h"
#include "render/render_internal.h"

/* The solution of a job. Errors: those of radiosity_update. */
bool stored_light_prepare(struct radiosity *radiosity, const struct render_job *job, struct pool *pool,
                          struct error *error);
/* Before the first tile: the solution, in `own` unless the job keeps it. Errors: those of radiosity_update. */
bool stored_light_begin(struct radiosity *own, struct renderer *renderer, int workers, struct error *error);
/* What a surface reflects towards hit->view: diffuse lobes the stored light, and that of photons; highlights the
 * lights. A surface without patches reflects the lights alone. */
struct colour stored_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf,
                           uint64_t key);

#endif
