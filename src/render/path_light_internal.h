/* The light that reaches a vertex of a path. */
#ifndef GRAY_RENDER_PATH_LIGHT_INTERNAL_H
#define GRAY_RENDER_PATH_LIGHT_INTERNAL_H

#include "material/interaction.h"
#include "render/path_internal.h"
#include "render/path_state_internal.h"

struct path_tracked;

struct path_vertex {
    const struct ray *ray; /* that ends here */
    const struct hit *hit; /* of a surface */
    struct interaction at;
    const struct light_receiver *receiver;
    uint32_t substitute;  /* highlights that represent the mirror image of those lights that no mirror shows */
    bool sight;           /* of a line of sight, on which mirrors show only visible lights */
    struct colour thrown; /* the fraction of the path's weight that photons represent, if traced lobes scatter here */
    const struct path_tracked
        *tracked; /* in a medium whose ray has other samples of lights (path_equiangular_internal.h); or NULL */
    bool sealed;  /* no lamp reaches it */
};

/* medium_affects; most scenes have nothing around their solids. */
static inline bool path_is_affected(const struct path_tracer *tracer, enum medium_ray kind, const struct ray *ray) {
    return (ray->media->count > 0 || tracer->in_medium) && medium_affects(kind, ray);
}

/* A ray that was scattered at a receiver. */
struct path_segment {
    const struct path *path;
    double passed; /* after holes: the line began at t = -passed */
};

/* Random numbers for direct light: `choice` selects the light, and the point of `sampler` in this dimension selects a
 * point on the light, if it has an extent. */
struct path_light_draw {
    double choice;
    const struct sampler *sampler;
    uint32_t dimension;
};
/* What a vertex scatters of a light of radiance 1: by its lobes, and in the place of mirror images. */
struct path_choice {
    struct colour lobes, highlight;
};
/* Chooses a light, a point on it and the ray to it. False: nothing is to be sent, but out->part is set. */
bool path_choose_light(const struct path_tracer *tracer, const struct path_vertex *vertex,
                       const struct path_light_draw *draw, struct path_shadow *out, struct path_choice *choice);
/* The light of the sample that arrives, reduced by the media on its way; black if an object blocks it. */
struct colour path_light_arriving(const struct path_tracer *tracer, struct integrator_state *state,
                                  const struct path *path, struct path_shadow *shadow);
/* The light of a glowing medium that the vertex scatters, and where it comes from. dimension: the first one of the
 * vertex. */
struct colour path_glow_light(const struct path_tracer *tracer, struct integrator_state *state, const struct path *path,
                              const struct path_vertex *vertex, uint32_t dimension, struct vec3 *direction);
/* The ray to the sample in `out`. */
void path_send_shadow_ray(const struct path_vertex *vertex, struct path_shadow *out);
/* The weight of a sample of a light with density `pdf` that rays find with density `other`. */
double path_light_weight(const struct path_tracer *tracer, double pdf, double other);
/* The part of a light's radiance that the path adds. If photons come from this light, the fraction `thrown` of the
 * path's weight belongs to the photon map. */
struct colour path_without_thrown(const struct path_tracer *tracer, uint32_t light, struct colour thrown,
                                  struct colour radiance);
/* What path_shares returns, for a light in the direction wi, highlights included. */
void path_direct_shares(const struct path_vertex *vertex, const struct path_choice *choice, struct vec3 wi,
                        struct colour shares[PATH_SCATTERINGS]);
/* For each kind of scattering and each channel: its fraction of the light that these lobes of the vertex scatter
 * from wi. The fractions add up to 1. */
void path_shares(const struct path_vertex *vertex, uint32_t lobes, struct vec3 wi, struct colour out[PATH_SCATTERINGS]);
/* The fractions of a lobe with these flags: all of its light belongs to one kind. */
void path_share_all(unsigned flags, struct colour out[PATH_SCATTERINGS]);
/* Those of a medium. */
void path_share_volume(struct colour out[PATH_SCATTERINGS]);
/* The light along scattered rays, weighted against path_direct: that of an emissive surface (`emission` at the hit);
 * that of the area lights that the ray crosses before t_max; that of skies if it hits nothing. */
struct colour path_emission(const struct path_tracer *tracer, const struct path_segment *segment, const struct hit *hit,
                            struct colour emission);
struct colour path_area_lights(const struct path_tracer *tracer, const struct path_segment *segment, double t_max);
struct colour path_environment(const struct path_tracer *tracer, const struct path_segment *segment);
/* The nearest visible area light on a line of sight before t_max, and its distance. */
bool path_area_light_seen(const struct path_tracer *tracer, const struct ray *ray, double t_max, double *t,
                          struct colour *radiance);

#endif
