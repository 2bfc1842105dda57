/* The recursive integrator of Whitted, "An Improved Illumination Model for Shaded Display", CACM 1980, with the rules
 * of docs/language.md 5.2 and 5.3: own light, reflected and refracted rays with independent counters, media stack,
 * Fresnel (whitted_trace.c); and its adaptive anti-aliasing (whitted.c). */
#ifndef GRAY_RENDER_WHITTED_INTERNAL_H
#define GRAY_RENDER_WHITTED_INTERNAL_H

#include "render/contour_internal.h"
#include "render/filter_internal.h"
#include "render/render.h"
#include "render/render_internal.h"
#include "render/style_internal.h"
#include "render/thin_map_internal.h"

/* Of one worker. */
struct whitted_worker {
    uint64_t marked, late; /* pixels; late: after the time limit, with fewer samples */
    /* The first samples of a tile and its rim. */
    struct colour first[(FILM_TILE + 2) * (FILM_TILE + 2)];
    double seen_through[(FILM_TILE + 2) * (FILM_TILE + 2)];
    struct camera_hit hits[(FILM_TILE + 2) * (FILM_TILE + 2)]; /* AA_ROTATED */
    struct camera_hit patch[PACKET_RAYS];
    struct contour contour;
};

/* Of a run. Owns the photon map, the map of thin primitives and the array of workers with their contours. */
struct whitted {
    double cutoff; /* cutoff_weight: rays of less weight are not followed */
    /* -full, or a lens or moving objects: blurred pixels differ from sample to sample, not from their neighbours */
    bool full;
    bool blurred;         /* by a lens or motion */
    bool fine;            /* surfaces, details and thin primitives mark pixels */
    struct thin_map thin; /* AA_ROTATED */
    struct filter filter;
    struct photon_map caustics;
    struct whitted_worker *workers;
    int worker_count;
};

/* See render/integrator_internal.h. `whitted` is zero. */
struct film_record whitted_record(const struct settings *settings);
bool whitted_create(struct whitted *whitted, struct renderer *renderer, int workers,
                    struct render_statistics *statistics, struct error *error);
void whitted_destroy(struct whitted *whitted);
bool whitted_render(struct whitted *whitted, struct renderer *renderer, struct worker *worker,
                    const struct film_rectangle *part);
void whitted_repeat(const struct whitted *whitted, struct renderer *renderer, struct worker *worker, int64_t x,
                    int64_t y);
void whitted_add_statistics(const struct whitted *whitted, const struct renderer *renderer,
                            struct render_statistics *out);

#endif
