/* Caustics: light that was refracted or reflected by specular surfaces before it hit a diffuse one. Photons are traced
 * before the picture is rendered, and stored in a map. */
#ifndef GRAY_RENDER_PHOTON_TRACE_INTERNAL_H
#define GRAY_RENDER_PHOTON_TRACE_INTERNAL_H

#include "render/photon_map_internal.h"
#include "render/render.h"

/* The maximum number of bounces of a photon; in lossless glass almost nothing is left by then. */
enum { PHOTON_BOUNCES = 100 };

struct photon_statistics {
    uint64_t sent, landed, rays;
    double seconds, map_seconds; /* in all; of these: making the map */
};

/* Sends the photons of the job's settings through its world and builds the map of them; the same for any number of
 * threads. Errors: no memory, cancelled. */
bool photons_make(struct photon_map *map, const struct render_job *job, struct pool *pool,
                  struct photon_statistics *statistics, struct error *error);
/* The same for an integrator before its first tile: counts in the statistics of the render. With settings of no photons
 * the map is empty. */
bool photons_send(struct photon_map *map, const struct render_job *job, struct pool *pool,
                  struct render_statistics *statistics, struct error *error);

#endif
