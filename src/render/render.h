/* A job: world, camera, settings, film. render_run renders every tile on the pool, each tile self-contained: first-pass
 * samples of its pixels and of the one-pixel rim around them, marks from these, refinement, final. Same bytes for any
 * number of threads and any order of tiles. */
#ifndef GRAY_RENDER_RENDER_H
#define GRAY_RENDER_RENDER_H

#include "base/pool.h"
#include "film/film.h"
#include "film/render_statistics.h"
#include "material/medium.h"
#include "render/time_estimate.h"
#include "settings/settings.h"
#include "world/world.h"

struct path_device;
struct pixel_trace;
struct radiosity;

struct render_job {
    const struct world *world;
    struct camera camera;
    struct settings settings;
    uint32_t width, height; /* of the whole picture */
    struct colour ambient;
    bool background_lights; /* the script chose the sky of the world: paths take its light */
    uint32_t
        kept_samples; /* that all pixels of the film have: passes of a progressive integrator go on with the next */
    struct radiosity *radiosity;      /* or NULL: kept for the next picture (radiosity_update) */
    const struct path_device *device; /* or NULL: makes the samples of paths (path_wave.h) */
    struct film *film;                /* placed for the crop; only tiles in the state FILM_TILE_WANTED are made */
    const _Atomic uint32_t *handout;  /* or NULL; while it is 1 more tiles may become wanted */
    struct pool_event *handed;        /* or NULL; signalled when tiles become wanted, and when no more can */
    uint32_t shard, shards;           /* this one of so many, from 1, makes its own tiles only; 0 of 0: all */
    /* Called from any worker when a tile is final; may be NULL. done counts from 1. */
    void (*tile_done)(void *context, uint32_t tile, uint32_t done, uint32_t count);
    void *context;
    struct progress_estimate *progress_estimate; /* or NULL; zero */
    const _Atomic int
        *drain; /* or NULL; while it is not 0, no further tile is begun, and the render counts as stopped */
};

/* False: cancelled or out of memory, see `error`. The film then contains the finished tiles. */
bool render_run(const struct render_job *job, struct pool *pool, struct render_statistics *statistics,
                struct error *error);
struct pixel_list {
    const uint32_t (*at)[2]; /* x, y */
    uint32_t count;
};
/* Renders single pixels {x, y} of the whole picture as render_run would, and records and reports the trace of each; it
 * ends when `listen` returns. Does not read the film of the job. False: as render_run, or `listen` returned false. */
typedef bool pixel_trace_listener(void *context, struct pixel_trace *pixel_trace, struct error *error);
bool render_pixels(const struct render_job *job, struct pool *pool, struct pixel_list pixels,
                   pixel_trace_listener *listen, void *context, struct error *error);
/* The part of the picture that is rendered: that of the film. */
struct render_area {
    uint32_t x0, y0, width, height;
};
/* Checks picture size, crop, camera; fills the area. First call of a job. Warnings: up parallel to view. */
bool render_prepare(struct render_job *job, struct render_area *area, char warning[256], struct error *error);

#endif
