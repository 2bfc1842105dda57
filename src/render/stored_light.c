#include "render/stored_light_internal.h"

#include "material/bsdf_select.h"
#include "render/direct_internal.h"

bool stored_light_prepare(struct radiosity *radiosity, const struct render_job *job, struct pool *pool,
                          struct error *error) {
    const struct settings *settings = &job->settings;
    const struct radiosity_input input = {.world = job->world,
                                          .background = job->background_lights,
                                          .limit = (uint32_t)settings->radiosity_patches,
                                          .error_share = settings->radiosity_error,
                                          .seed = settings->seed,
                                          .pool = pool};
    return radiosity->ready = radiosity_update(radiosity, &input, error);
}

bool stored_light_begin(struct radiosity *own, struct renderer *renderer, int workers, struct error *error) {
    struct radiosity *radiosity = renderer->job->radiosity ? renderer->job->radiosity : own;
    if (!radiosity->ready && !stored_light_prepare(radiosity, renderer->job, renderer->pool, error))
        return false;
    radiosity->ready = false;
    for (int i = 0; i < workers; i++)
        renderer->workers[i].state.radiosity = radiosity;
    return true;
}

struct colour stored_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf,
                           uint64_t key) {
    struct colour light, shiny_weight;
    if (bsdf->dark || !radiosity_light(state->radiosity, hit, &light)) {
        struct bsdf lit = *bsdf;
        lit.ambient = colour_all(0);
        return direct_light(state, hit, &lit, key);
    }
    const struct bsdf shiny = bsdf_shiny_copy(bsdf, &shiny_weight);
    struct colour sum = colour_mul(bsdf_diffuse(bsdf), light);
    if (shiny.count > 0 && !colour_is_black(shiny_weight))
        sum = colour_add(sum, direct_light(state, hit, &shiny, key));
    if (state->caustics)
        sum = colour_add(
            sum, photon_map_light(state->caustics, state->job->world, hit, bsdf, bsdf_lobes_with(bsdf, BSDF_DIFFUSE)));
    state->camera_hit = NULL;
    return sum;
}
