#include "render/stored_light_internal.h"

#include "base/clock.h"
#include "material/bsdf_select.h"
#include "render/direct_internal.h"
#include "render/headlight.h"

/* In a window, pictures of the light so far take a fifth of the time in which it is computed. */
struct growth {
    const struct render_job *job;
    struct pool *pool;
    double shown, seconds; /* when the last picture was, and how long it took */
    uint32_t count;
};

static void show_growth(void *context, const struct radiosity *radiosity) {
    struct growth *growth = context;
    double begun = clock_now();
    struct render_job job = *growth->job;
    struct radiosity so_far = *radiosity; /* not changed */
    struct render_statistics ignored = {0};
    struct error error;
    if (begun < growth->shown + 4 * growth->seconds)
        return;
    const struct headlight_request request = {.state = (uint8_t)(FILM_TILE_PASSED + growth->count++ % FILM_PASSES)};
    job.radiosity = &so_far;
    (void)render_headlight(&job, &request, growth->pool, &ignored, &error);
    growth->shown = clock_now();
    growth->seconds = growth->shown - begun;
}

/* These tiles are wanted from the integrator, too. */
static void end_growth(const struct film *film) {
    for (uint32_t i = 0; i < film_tile_count(film); i++)
        if (atomic_load(&film->tiles[i]) >= FILM_TILE_PASSED)
            atomic_store(&film->tiles[i], FILM_TILE_WANTED);
}

bool stored_light_prepare(struct radiosity *radiosity, const struct render_job *job, struct pool *pool,
                          struct error *error) {
    const struct settings *settings = &job->settings;
    struct growth growth = {.job = job, .pool = pool};
    struct radiosity_input input = {.world = job->world,
                                    .background = job->background_lights,
                                    .limit = (uint32_t)settings->radiosity_patches,
                                    .error_share = settings->radiosity_error,
                                    .seed = settings->seed,
                                    .pool = pool};
    if (settings->show_refined)
        input.watch = (struct radiosity_watch){show_growth, &growth};
    radiosity->ready = radiosity_update(radiosity, &input, error);
    if (growth.count > 0)
        end_growth(job->film);
    return radiosity->ready;
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
