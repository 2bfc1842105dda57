/* Passes over the picture: every pass adds samples to all pixels, so that something is to be seen soon, and the time
 * can decide how many samples there will be. A pixel's samples are numbered and added in order (path_film_internal.h):
 * the picture has the bytes of one that got them all in one go.
 *
 * The first pass has one sample, and each further one at most as many as all before it. */
#include "base/clock.h"
#include "render/integrator_internal.h"

static const double shown_every = 1; /* seconds; a pass of a picture that is looked at takes about that */

bool renderer_makes_passes(const struct renderer *renderer) {
    const struct settings *settings = &renderer->job->settings;
    return renderer->pass.end > 0 && (settings->passes || settings->time_limit > 0);
}

/* Seconds until the time is over. */
static double time_left(const struct renderer *renderer, double now) {
    double limit = renderer->job->settings.time_limit;
    return limit > 0 ? limit - (now - renderer->begun) : HUGE_VAL;
}

/* How many samples the next pass has: with a limit no more than half of the time left, so that the last passes are
 * short ones and end near it. second: seconds that one sample of all pixels takes. */
static uint32_t next_samples(const struct renderer *renderer, uint32_t limit, double seconds, double now) {
    uint32_t done = renderer->pass.end, left = limit - done;
    double fitting = time_left(renderer, now) / 2 / seconds;
    if (renderer->job->settings.passes)
        fitting = fmin(fitting, shown_every / seconds);
    uint32_t count = done < left ? done : left;
    return fitting < (double)count ? (uint32_t)fmax(fitting, 1) : count;
}

/* Tiles that have little enough noise count as done. */
static void report_progress(struct renderer *renderer, uint32_t limit, double now) {
    struct progress_estimate *estimate = renderer->job->progress_estimate;
    double done = renderer->pass.end, left = (double)limit - done, passed = now - renderer->begun;
    if (!estimate)
        return;
    if (time_left(renderer, now) < left / done * passed) {
        done = passed;
        left = fmax(time_left(renderer, now), 0);
    }
    progress_estimate_report(estimate, done, left, clock_nanoseconds(CLOCK_MONOTONIC));
}

static void begin_progress(const struct renderer *renderer) {
    struct progress_estimate *estimate = renderer->job->progress_estimate;
    if (estimate)
        atomic_store(&estimate->begun, clock_nanoseconds(CLOCK_MONOTONIC));
}

bool renderer_make_passes(struct renderer *renderer) {
    uint32_t limit = renderer->pass.end, count = film_tile_count(renderer->job->film);
    double begun = clock_seconds(CLOCK_MONOTONIC), now = begun;
    begin_progress(renderer);
    renderer->pass = (struct sample_pass){.begin = 0, .end = 1, .open = true};
    for (;;) {
        atomic_store(&renderer->unsatisfied, false);
        if (!pool_run(renderer->pool, count, renderer_pass_item, renderer) || renderer_is_done(renderer))
            return false;
        now = clock_seconds(CLOCK_MONOTONIC);
        uint32_t done = renderer->pass.end;
        double seconds = fmax((now - begun) / done, 1e-9);
        report_progress(renderer, limit, now);
        if (done == limit || !atomic_load(&renderer->unsatisfied) || time_left(renderer, now) < seconds)
            return true;
        renderer->pass.number++;
        renderer->pass.begin = done;
        renderer->pass.end = done + next_samples(renderer, limit, seconds, now);
    }
}
