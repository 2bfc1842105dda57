/* Common parts of the files of a render: tiles (render.c), samples (sample.c), integrators (integrator_internal.h), the
 * time estimate (time_estimate.c), render layers (aov.c). Other modules do not include it. */
#ifndef GRAY_RENDER_RENDER_INTERNAL_H
#define GRAY_RENDER_RENDER_INTERNAL_H

#include "render/camera.h"
#include "render/integrator_state_internal.h"
#include "render/path_wave.h"
#include "render/render.h"
#include "render/time_estimate.h"
#include "render/work_queue_internal.h"
#include "world/packet.h"
#include "world/world.h"

#include <stdatomic.h>

/* Samples that are traced together, in the order in which they are wanted. */
struct batch {
    struct pixel_sample positions[PACKET_RAYS];
    struct colour colours[PACKET_RAYS];
    double seen_through[PACKET_RAYS]; /* of integrator_state */
    struct path_parts *parts;         /* or NULL; PACKET_RAYS of them */
    struct camera_hit *camera_hits;   /* the same */
    uint32_t count;
    struct ray_packet packet;
    struct packet_answer answers[PACKET_RAYS];
};

/* The numbers of samples from `begin` up to, but not including, `end`. */
struct sample_range {
    uint32_t begin, end;
};

/* Of a worker, for the time estimate: what has been added to the cost of the tile in progress. */
struct worker_cost {
    struct tile_cost *tile;
    double share;    /* of the tile, that this worker makes */
    uint32_t part;   /* of its work; as in struct tile_cost */
    uint64_t worked; /* processor time of the thread in nanoseconds */
    double added;    /* when: seconds */
};

struct worker {
    struct world_scratch scratch;
    struct integrator_state state;
    uint64_t camera_rays;
    bool clamped; /* a colour or a layer was not finite or beyond the largest float */
    struct medium_stack ray_medium_stack;
    struct camera_frame camera; /* of the sample's moment, when the camera moves */
    struct batch batch;
    int index;
    double tile_ended;           /* seconds, of the last one */
    _Atomic uint8_t *tile_state; /* of the tile that this worker alone makes, all samples in one go; else NULL */
    double part;                 /* of the work of the tile, that is done after its last samples */
    struct worker_cost cost;
    struct device_work *for_device; /* NULL: the worker traces its own paths */
};

/* What a worker takes for the device of the job. */
struct device_work {
    struct {
        struct work_item item;
        uint8_t before; /* state of the tile */
    } taken[PATH_ORDERS];
    struct film_rectangle parts[PATH_ORDERS];
    struct path_order orders[PATH_ORDERS]; /* of the parts, in their order */
    uint32_t count;
    void *pixels; /* of all orders; owned, grows */
    size_t room;  /* bytes for them */
};

/* How quickly the device of the job makes tiles, and the threads of the processor beside it. */
struct device_pace {
    _Atomic double begun;         /* seconds: when the first could be taken */
    _Atomic uint32_t taken, made; /* by the device */
    _Atomic double seconds;       /* that a thread needed for the last tile; 0: none is made yet */
};

/* Samples that a pass adds to each pixel: from number `begin` on to that before `end`. */
struct sample_pass {
    uint32_t number, begin, end, limit; /* limit: of the end of all passes */
    bool open;                          /* more passes may follow */
};

struct renderer {
    const struct render_job *job;
    struct pool *pool;
    struct camera_frame camera;
    struct medium_stack eye_medium_stack;
    bool timed;               /* while the shutter is open, something moves or a function reads the time */
    bool roams;               /* the film is one pixel that moves over the picture (render_pixels) */
    bool together;            /* camera rays start in one place and at one moment */
    bool medium_stack_by_ray; /* rays start in different places or moments, and solids are near */
    enum sampler_kind sampler;
    struct sample_pass pass;  /* the integrator states all samples as one pass; paths only */
    _Atomic bool unsatisfied; /* a tile of the pass is to have more samples (--noise) */
    double begun;             /* seconds of the clock that never jumps */
    double sample_share; /* footprint of a sample as a fraction of a pixel's width; SAMPLER_STRATA: from the settings */
    uint32_t *closed;    /* the solids that can contain the eye */
    uint32_t closed_count;
    struct integrator *integrator;
    struct worker *workers;
    int worker_count; /* those of the pool, then those that wait for the device of the job */
    struct device_pace pace;
    uint32_t tiles_wanted; /* of this process, those that were there before too */
    uint64_t *cost;        /* of each tile while shards are chosen */
    uint32_t *order;       /* tiles of the queue */
    struct work_queue queue;
    double passes_begun;                /* seconds, as `begun` */
    struct time_estimate time_estimate; /* without tiles if none is requested */
    _Atomic double reported;            /* seconds, of the last report */
    _Atomic uint32_t done;
    _Atomic bool failed;
};

static inline bool renderer_stopped(const struct renderer *renderer, const struct worker *worker) {
    return pool_cancelled(renderer->pool) || worker->scratch.failed;
}

/* Whether the tiles are made pass by pass (render.c), until they have all samples, little enough noise, or the time is
 * over. */
bool renderer_makes_passes(const struct renderer *renderer);

/* No further tile is to be begun. */
bool renderer_is_done(const struct renderer *renderer);

#endif
