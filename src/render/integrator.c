/* See integrator.h. */
#include "render/integrator.h"

#include "base/mem.h"
#include "base/unreachable.h"
#include "render/whitted.h"

struct integrator {
    enum integrator_kind kind;
    union {
        struct whitted whitted;
    };
};

static const char *const no_kind = "an integrator of no kind";

struct film_record integrator_record(enum integrator_kind integrator) {
    switch (integrator) {
    case INTEGRATOR_WHITTED:
        return whitted_record();
    }
    UNREACHABLE(no_kind);
}

bool integrator_create(struct run *run, int workers, struct render_statistics *statistics, struct error *error) {
    struct integrator *integrator = run->integrator = mem_alloc_zero(1, sizeof *integrator);
    if (!integrator)
        return error_no_memory(error, "the workers of a render");
    integrator->kind = run->job->settings.integrator;
    switch (integrator->kind) {
    case INTEGRATOR_WHITTED:
        return whitted_create(&integrator->whitted, run, workers, statistics, error);
    }
    UNREACHABLE(no_kind);
}

void integrator_destroy(struct integrator *integrator) {
    if (!integrator)
        return;
    switch (integrator->kind) {
    case INTEGRATOR_WHITTED:
        whitted_destroy(&integrator->whitted);
        break;
    }
    mem_free(integrator);
}

bool integrator_render(struct run *run, struct worker *worker, const struct rectangle *part) {
    switch (run->integrator->kind) {
    case INTEGRATOR_WHITTED:
        return whitted_render(&run->integrator->whitted, run, worker, part);
    }
    UNREACHABLE(no_kind);
}

struct vec3 integrator_radiance(struct run *run, struct worker *worker, const struct ray *ray, uint64_t key) {
    switch (run->integrator->kind) {
    case INTEGRATOR_WHITTED:
        return whitted_trace(&run->integrator->whitted, &worker->state, ray, key);
    }
    UNREACHABLE(no_kind);
}

struct vec3 integrator_radiance_met(struct run *run, struct worker *worker, const struct ray *ray,
                                    const struct packet_answer *met, uint64_t key) {
    switch (run->integrator->kind) {
    case INTEGRATOR_WHITTED:
        return whitted_trace_met(&run->integrator->whitted, &worker->state, ray, met, key);
    }
    UNREACHABLE(no_kind);
}

bool integrator_refines(const struct run *run, struct vec3 a, struct vec3 b) {
    switch (run->integrator->kind) {
    case INTEGRATOR_WHITTED:
        return whitted_refines(run, a, b);
    }
    UNREACHABLE(no_kind);
}

void integrator_repeat(struct run *run, struct worker *worker, int64_t x, int64_t y) {
    switch (run->integrator->kind) {
    case INTEGRATOR_WHITTED:
        whitted_repeat(&run->integrator->whitted, run, worker, x, y);
        break;
    }
}

void integrator_add_statistics(const struct run *run, struct render_statistics *out) {
    switch (run->integrator->kind) {
    case INTEGRATOR_WHITTED:
        whitted_add_statistics(&run->integrator->whitted, run, out);
        break;
    }
}
