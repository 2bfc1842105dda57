/* Common parts of the files of a render: tiles (render.c), samples (sample.c), integrators (integrator_internal.h), the
 * time estimate (cost_prepass.c), render layers (aov.c). Other modules do not include it. */
#ifndef GRAY_RENDER_RENDER_INTERNAL_H
#define GRAY_RENDER_RENDER_INTERNAL_H

#include "render/camera.h"
#include "render/integrator_state_internal.h"
#include "render/noise_estimate_internal.h"
#include "render/render.h"
#include "render/time_estimate.h"
#include "world/packet.h"
#include "world/world.h"

#include <pthread.h>
#include <stdatomic.h>

/* Samples that are traced together, in the order in which they are wanted. */
struct batch {
    struct pixel_sample positions[PACKET_RAYS];
    struct vec3 colours[PACKET_RAYS];
    struct path_parts *parts;       /* or NULL; PACKET_RAYS of them */
    struct camera_hit *camera_hits; /* the same */
    uint32_t count;
    struct ray_packet packet;
    struct packet_answer answers[PACKET_RAYS];
};

/* The numbers of samples from `begin` up to, but not including, `end`. */
struct sample_range {
    uint32_t begin, end;
};

/* Of a worker, for the time estimate: the layers of some pixels that were measured, and those that are made; costs as
 * of tiles. */
struct layer_sums {
    _Atomic double measured_cost, measured_pixels, cost, pixels;
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
    double tile_ended;                /* seconds, of the last one */
    uint64_t tile_begun, first_ended; /* processor time, while a time estimate is requested */
    struct sample_range level;        /* of the current tile, if tiles get their samples level by level; else zero */
    uint32_t level_tile;              /* the tile of the last level or pass */
    struct sample_range range;        /* samples that it gets now; paths only */
    struct noise_point noise;         /* of the current tile (--noise), after its last samples; zero: not known */
    bool quiet;                       /* its noise is small enough */
    uint32_t samples_expected;        /* of its pixels; 0: not known yet */
    struct layer_sums layers;
};

/* Samples that a pass adds to each pixel: from number `begin` on to that before `end`. */
struct sample_pass {
    uint32_t number, begin, end, limit; /* limit: of the end of all passes */
    bool open;                          /* more passes may follow */
};

/* Tiles that get their samples level by level (--noise): sample_levels.c. */
struct waiting_tile {
    double urgency;
    uint32_t position; /* in the order of the tiles */
};
struct sample_levels {
    bool wanted;
    uint32_t *samples; /* of each tile, that it has */
    pthread_mutex_t mutex;
    struct waiting_tile *waiting; /* for their next level: a heap, the first one is the next */
    uint32_t count;               /* of those that wait */
    uint32_t in_progress;
};

struct renderer {
    const struct render_job *job;
    struct pool *pool;
    struct camera_frame camera;
    struct medium_stack eye_medium_stack;
    bool timed;               /* something moves while the shutter is open */
    bool roams;               /* the film is one pixel that moves over the picture (render_pixels) */
    bool together;            /* camera rays start in one place and at one moment */
    bool medium_stack_by_ray; /* rays start in different places or moments, and solids are near */
    enum sampler_kind sampler;
    struct sample_pass pass; /* the integrator states all samples as one pass; paths only */
    struct sample_levels levels;
    _Atomic bool unsatisfied; /* a tile of the pass is to have more samples (--noise) */
    double begun;             /* seconds of the clock that never jumps */
    double sample_share; /* footprint of a sample as a fraction of a pixel's width; SAMPLER_STRATA: from the settings */
    uint32_t *closed;    /* the solids that can contain the eye */
    uint32_t closed_count;
    struct integrator *integrator;
    struct worker *workers;
    uint32_t tiles_wanted;     /* of this process, those that were there before too */
    uint64_t *cost;            /* of each tile while shards are chosen */
    uint32_t *order;           /* of the tiles; NULL: as they are numbered */
    uint32_t whole_tiles;      /* so many are made as a whole, the others of the order in quarters */
    _Atomic uint8_t *quarters; /* of each of the others, how many are done; and QUARTER_FAILED */
    bool estimated;            /* the cost of the tiles has been estimated */
    struct time_estimate time_estimate;
    struct noise_estimate noise_estimate; /* with levels or passes, instead of it */
    uint64_t worked;                      /* processor time when the first tile began */
    _Atomic uint64_t reported;            /* time of the last progress report in nanoseconds */
    _Atomic uint32_t done;
    _Atomic bool failed;
};

/* A rectangle of pixels of the whole picture: x0 <= x < x1. */
struct rectangle {
    int64_t x0, y0, x1, y1;
};

/* The camera at a ray's time. */
bool renderer_prepare_at(const struct render_job *job, double ray_time, struct camera_frame *out, char warning[256],
                         struct error *error);
/* The camera ray through (x, y) and the centre of the lens, when the shutter opens. False: nothing is visible there. */
bool renderer_middle_ray(const struct renderer *renderer, double x, double y, struct ray *out);
/* The first sample has number 0, at the centre or the corner of the pixel. */
struct pixel_sample renderer_first_sample(const struct renderer *renderer, int64_t x, int64_t y);
struct vec3 renderer_sample(struct renderer *renderer, struct worker *worker, const struct pixel_sample *position);
/* The samples of a batch, equal to those of renderer_sample. The hits of the camera rays are found together. */
void renderer_sample_batch(struct renderer *renderer, struct worker *worker);
static inline bool renderer_stopped(const struct renderer *renderer, const struct worker *worker) {
    return pool_cancelled(renderer->pool) || worker->scratch.failed;
}

/* Before the first tile; false: stopped. Does nothing if no time estimate is requested. */
bool renderer_cost_prepass(struct renderer *renderer);
void renderer_tile_begins(struct renderer *renderer, struct worker *worker, uint32_t tile,
                          double share); /* that share of it */
/* So much of its first pass (0) or its second is done. */
void renderer_tile_goes_on(struct renderer *renderer, struct worker *worker, int pass, double part);
void renderer_tile_ends(struct renderer *renderer, struct worker *worker);
/* The same for a level of a tile, or a pass. renderer_expect_levels: before the first one. */
void renderer_expect_levels(struct renderer *renderer);
void renderer_level_begins(struct renderer *renderer, struct worker *worker, uint32_t tile, uint32_t end);
void renderer_level_ends(struct renderer *renderer, struct worker *worker, uint32_t tile, bool final);
void renderer_report_estimate(struct renderer *renderer);
void renderer_report_end(struct renderer *renderer); /* all tiles are done */

/* Makes the samples of a part of a tile. False: stopped. */
bool renderer_make_samples(struct renderer *renderer, struct worker *worker, struct rectangle part);
/* The tile is done, and is reported; or it is not whole and still wanted. */
void renderer_end_tile(struct renderer *renderer, uint32_t tile, bool whole);

/* Decides whether tiles get their samples level by level; before the first tile. False: no memory. */
bool renderer_order_levels(struct renderer *renderer);
/* Makes all levels; the tiles are in order. False: stopped. */
bool renderer_make_levels(struct renderer *renderer);
/* In a farm: makes one level of a tile, or a few short ones. The tile is in the state FILM_TILE_TAKEN. */
void renderer_make_farm_levels(struct renderer *renderer, struct worker *worker, uint32_t tile);
/* The same as noise_estimate_work, of all ranks; for the first rank. */
struct time_estimate_work renderer_farm_work(const struct renderer *renderer);

/* Makes the tiles pass by pass (render.c), until they have all samples, little enough noise, or the time is over.
 * False: stopped. */
bool renderer_makes_passes(const struct renderer *renderer);
bool renderer_make_passes(struct renderer *renderer);
/* A pool_function of passes: the tile of that place in the order. */
void renderer_pass_item(void *context, uint32_t position, int worker);

/* No further tile is to be begun. */
bool renderer_is_done(const struct renderer *renderer);

/* The layers of a pixel whose tile is done. */
void renderer_layer_pixel(struct renderer *renderer, struct worker *worker, int64_t x, int64_t y);
/* A pool_function: the layers of a tile that is done. */
void renderer_layer_item(void *context, uint32_t tile, int worker);
/* For the time estimate: the moment when layers of pixels begin, and when so many are made. */
uint64_t renderer_layers_begin(const struct renderer *renderer);
void renderer_layers_end(struct renderer *renderer, struct worker *worker, uint64_t begun, double pixels);
/* Makes the layers of a few pixels of a tile that is done, which tell the time of all. */
void renderer_measure_layers(struct renderer *renderer, struct worker *worker, uint32_t tile);

#endif
