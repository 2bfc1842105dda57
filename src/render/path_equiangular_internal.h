/* Distances in media that are sampled for a light: on the first rays of a path, near the point of the ray that is
 * closest to it (equiangular sampling: C. Kulla and M. Fajardo, "Importance Sampling Techniques for Path Tracing in
 * Participating Media", EGSR 2012). The vertices that tracking finds have the same light, so both are weighted by
 * multiple importance sampling: of tracking an estimate of its density serves, since weights need only add up to 1. */
#ifndef GRAY_RENDER_PATH_EQUIANGULAR_INTERNAL_H
#define GRAY_RENDER_PATH_EQUIANGULAR_INTERNAL_H

#include "material/medium_mix.h"
#include "render/path_internal.h"
#include "render/path_state_internal.h"

/* Whether the ray of the path has such samples: of four depths (1, 2, 3, all), in fog with two lamps, these have the
 * least error in equal time. */
enum { AIMED_DEPTHS = 3 };
static inline bool path_is_aimed(const struct path_tracer *tracer, const struct path *path) {
    return tracer->aimed_light_count > 0 && path->depth < tracer->max_depth && path->depth < AIMED_DEPTHS &&
           !path_is_sealed(tracer, &path->media);
}

/* The lamps of which a ray chooses one, by estimates of the light that the media scatter of them: those from `first`
 * on, cyclic. */
enum { AIMED_LIGHTS = 16 };
struct path_aimed {
    uint32_t first, count;
    double shares[AIMED_LIGHTS]; /* probabilities */
};

/* The light of a lamp that media scatter on the ray, for a path of weight 1; `path` has the weight before the ray. */
struct colour path_aimed_light(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                               const struct medium_mix *mix, double distance, struct path_aimed *choice);

/* A vertex that tracking has found on such a ray. */
struct path_tracked {
    const struct ray *ray;
    double end, distance; /* of the ray, and to the vertex */
    double density;       /* estimate of that of tracking; 0: the ray has no other samples */
    struct path_aimed choice;
};
/* The weight of light from a part that the vertex chooses with probability pmf. */
double path_tracked_weight(const struct path_tracer *tracer, const struct path_tracked *tracked, struct light_part part,
                           double pmf);

#endif
