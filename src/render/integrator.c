/* See integrator_internal.h. */
#include "render/integrator_internal.h"

#include "base/mem.h"
#include "base/unreachable.h"
#include "render/integrator.h"
#include "render/path_internal.h"
#include "render/path_trace_internal.h"
#include "render/stored_light_internal.h"
#include "render/whitted_internal.h"
#include "render/whitted_trace_internal.h"

struct integrator {
    enum integrator_kind kind;
    struct radiosity radiosity; /* of one picture, if the job keeps none */
    union {
        struct whitted whitted; /* also of radiosity, which replaces its light */
        struct path_tracer path;
    };
};

static const char *const no_kind = "an integrator of no kind";

struct film_record render_record(const struct settings *settings) {
    switch (settings->integrator) {
    case INTEGRATOR_WHITTED:
    case INTEGRATOR_RADIOSITY:
        return whitted_record(settings);
    case INTEGRATOR_PATH:
        return path_tracer_record(settings);
    }
    UNREACHABLE(no_kind);
}

void integrator_warn(const struct render_job *job, world_warning *warn, void *context) {
    switch (job->settings.integrator) {
    case INTEGRATOR_WHITTED:
        break;
    case INTEGRATOR_PATH:
        path_tracer_warn(job, warn, context);
        break;
    case INTEGRATOR_RADIOSITY:
        if (colour_max_abs(job->ambient) > 0)
            warn(context, "--integrator radiosity ignores ambient: it computes indirect light instead");
        radiosity_warn(job->world, warn, context);
        break;
    }
}

bool integrator_prepare(const struct render_job *job, struct pool *pool, struct error *error) {
    switch (job->settings.integrator) {
    case INTEGRATOR_WHITTED:
    case INTEGRATOR_PATH:
        return true;
    case INTEGRATOR_RADIOSITY:
        return !job->radiosity || stored_light_prepare(job->radiosity, job, pool, error);
    }
    UNREACHABLE(no_kind);
}

bool integrator_create(struct renderer *renderer, int workers, struct render_statistics *statistics,
                       struct error *error) {
    struct integrator *integrator = renderer->integrator = mem_alloc_zero(1, sizeof *integrator);
    if (!integrator)
        return error_no_memory(error, "the workers of a render");
    integrator->kind = renderer->job->settings.integrator;
    switch (integrator->kind) {
    case INTEGRATOR_WHITTED:
        return whitted_create(&integrator->whitted, renderer, workers, statistics, error);
    case INTEGRATOR_PATH:
        return path_tracer_create(&integrator->path, renderer, statistics, error);
    case INTEGRATOR_RADIOSITY:
        return stored_light_begin(&integrator->radiosity, renderer, workers, error) &&
               whitted_create(&integrator->whitted, renderer, workers, statistics, error);
    }
    UNREACHABLE(no_kind);
}

void integrator_destroy(struct integrator *integrator) {
    if (!integrator)
        return;
    switch (integrator->kind) {
    case INTEGRATOR_WHITTED:
    case INTEGRATOR_RADIOSITY:
        whitted_destroy(&integrator->whitted);
        radiosity_destroy(&integrator->radiosity);
        break;
    case INTEGRATOR_PATH:
        path_tracer_destroy(&integrator->path);
        break;
    }
    mem_free(integrator);
}

bool integrator_render(struct renderer *renderer, struct worker *worker, const struct film_rectangle *part) {
    switch (renderer->integrator->kind) {
    case INTEGRATOR_WHITTED:
    case INTEGRATOR_RADIOSITY:
        return whitted_render(&renderer->integrator->whitted, renderer, worker, part);
    case INTEGRATOR_PATH:
        return path_tracer_render(&renderer->integrator->path, renderer, worker, part);
    }
    UNREACHABLE(no_kind);
}

bool integrator_render_by_device(struct renderer *renderer, struct worker *worker) {
    return path_tracer_render_by_device(&renderer->integrator->path, renderer, worker);
}

struct colour integrator_radiance(struct renderer *renderer, struct worker *worker, const struct ray *ray,
                                  uint64_t key) {
    switch (renderer->integrator->kind) {
    case INTEGRATOR_WHITTED:
    case INTEGRATOR_RADIOSITY:
        return whitted_trace(&renderer->integrator->whitted, &worker->state, ray, key);
    case INTEGRATOR_PATH:
        return path_trace(&renderer->integrator->path, &worker->state, ray, NULL, true, key);
    }
    UNREACHABLE(no_kind);
}

struct colour integrator_radiance_met(struct renderer *renderer, struct worker *worker, const struct ray *ray,
                                      const struct packet_answer *met, uint64_t key) {
    switch (renderer->integrator->kind) {
    case INTEGRATOR_WHITTED:
    case INTEGRATOR_RADIOSITY:
        return whitted_trace_met(&renderer->integrator->whitted, &worker->state, ray, met, key);
    case INTEGRATOR_PATH:
        return path_trace(&renderer->integrator->path, &worker->state, ray, met, false, key);
    }
    UNREACHABLE(no_kind);
}

void integrator_repeat(struct renderer *renderer, struct worker *worker, int64_t x, int64_t y) {
    switch (renderer->integrator->kind) {
    case INTEGRATOR_WHITTED:
    case INTEGRATOR_RADIOSITY:
        whitted_repeat(&renderer->integrator->whitted, renderer, worker, x, y);
        break;
    case INTEGRATOR_PATH:
        path_tracer_repeat(&renderer->integrator->path, renderer, worker, x, y);
        break;
    }
}

void integrator_add_statistics(const struct renderer *renderer, struct render_statistics *out) {
    switch (renderer->integrator->kind) {
    case INTEGRATOR_WHITTED:
    case INTEGRATOR_RADIOSITY:
        whitted_add_statistics(&renderer->integrator->whitted, renderer, out);
        break;
    case INTEGRATOR_PATH:
        break;
    }
}
