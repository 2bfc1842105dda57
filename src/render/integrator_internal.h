/* The interface of integrators. A render (render.c) prepares camera, workers and tiles and distributes the tiles.
 * The integrator decides what happens within a tile: which samples its pixels get, and what the film records for
 * them. sample.c turns a sample into camera rays and calls the integrator for their radiance. Each function is one
 * switch over the kind.
 *
 * All integrators have these properties: the same bytes for any number of threads and any order of tiles (a tile or
 * a part of one depends on nothing but the job), random numbers only from the sampler, events for observers, and
 * rays counted in the worker's struct integrator_state. */
#ifndef GRAY_RENDER_INTEGRATOR_INTERNAL_H
#define GRAY_RENDER_INTEGRATOR_INTERNAL_H

#include "render/render_internal.h"

/* The data of an integrator for a run and for each of its workers. */
struct integrator;

/* Creates renderer->integrator of the kind in the settings, for this number of workers, which exist already. It does
 * everything that must precede the first tile. Photons count in `statistics`. Errors: no memory, cancelled;
 * renderer->integrator must be destroyed in these cases, too. */
bool integrator_create(struct renderer *renderer, int workers, struct render_statistics *statistics,
                       struct error *error);
void integrator_destroy(struct integrator *integrator); /* NULL is fine */

/* Renders the pixels of a rectangle within a tile and stores them in the film. False: stopped before the end. */
bool integrator_render(struct renderer *renderer, struct worker *worker, const struct film_rectangle *part);
/* The same for all parts of worker->for_device, in a pass without a limit of noise. */
bool integrator_render_by_device(struct renderer *renderer, struct worker *worker);
/* The radiance along a camera ray, clamped to the range of float. worker->state has the sampler of the sample and
 * the media around the eye. key: the random key of the ray. */
struct colour integrator_radiance(struct renderer *renderer, struct worker *worker, const struct ray *ray,
                                  uint64_t key);
/* The same for a ray of a packet. met: its hit, or NULL. */
struct colour integrator_radiance_met(struct renderer *renderer, struct worker *worker, const struct ray *ray,
                                      const struct packet_answer *met, uint64_t key);
/* Traces the samples of a finished pixel once more, one by one, for layers that measure their cost. */
void integrator_repeat(struct renderer *renderer, struct worker *worker, int64_t x, int64_t y);
/* Adds the numbers that only this integrator counts. */
void integrator_add_statistics(const struct renderer *renderer, struct render_statistics *out);

#endif
