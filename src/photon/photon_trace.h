/* Caustics: light that was refracted or reflected by specular surfaces before it hit a diffuse one. Photons are traced
 * before the picture is rendered, and stored in a map. */
#ifndef GRAY_PHOTON_PHOTON_TRACE_H
#define GRAY_PHOTON_PHOTON_TRACE_H

#include "film/render_statistics.h"
#include "photon/photon_map.h"
#include "settings/settings.h"

/* The maximum number of bounces of a photon; in lossless glass almost nothing is left by then. */
enum { PHOTON_BOUNCES = 100 };

struct photon_statistics {
    uint64_t sent, landed, rays;
    double seconds, map_seconds; /* in all; of these: making the map */
};

/* What photons are sent through; borrowed. */
struct photon_scene {
    const struct world *world;
    const struct settings *settings;
};

/* Sends the photons of the settings through the world and builds the map of them; the same for any number of
 * threads. Errors: no memory, cancelled. */
bool photons_make(struct photon_map *map, const struct photon_scene *scene, struct pool *pool,
                  struct photon_statistics *statistics, struct error *error);
/* The same for an integrator before its first tile: counts in the statistics of the render. With settings of no photons
 * the map is empty. */
bool photons_send(struct photon_map *map, const struct photon_scene *scene, struct pool *pool,
                  struct render_statistics *statistics, struct error *error);

#endif
