/* What the pieces of a path read and write: the path, and the ray to a light that is on its way. */
#ifndef GRAY_RENDER_PATH_STATE_INTERNAL_H
#define GRAY_RENDER_PATH_STATE_INTERNAL_H

#include "film/path_parts.h"
#include "material/medium.h"
#include "render/observer.h"
#include "render/sampler.h"
#include "world/packet.h"
#include "world/world_lights.h"

/* Media are numbers, and a hit is described where it is needed, so that millions of paths fit into memory. */
struct path {
    struct ray ray;
    struct packet_answer met; /* what the ray hits first; primitive WORLD_NOTHING: nothing */
    struct colour weight, light;
    double radiance_scale; /* the factor of all refractions in the weight so far: a product of eta^2, which roulette
                              ignores */
    double pdf;            /* density of the ray's direction by solid angle; 0: the only possible direction */
    /* With photons, fractions of the weight: for paths whose last scattering was by a lobe that receives photons,
     * and for those that were scattered only by traced lobes since then. */
    struct colour received, thrown;
    struct light_receiver scatter; /* the surface that scattered the current ray */
    struct sampler sampler;
    struct medium_stack media;
    int depth;          /* scattering events so far */
    uint32_t dimension; /* of the sampler: the first dimension of the next vertex */
    /* The largest component of the light without noise, which --clamp leaves: that of photons in sight. */
    float calm;
    bool sight;
    uint8_t kind;   /* enum ray_kind */
    uint16_t holes; /* so far */
};
_Static_assert(sizeof(struct path) <= 528, "a path with its ray and what it hits");
_Static_assert(sizeof(struct path) - sizeof(struct ray) - sizeof(struct packet_answer) <= 384, "the state of a path");

/* The light of one sampled light at a vertex, before it is known whether it arrives. */
struct path_shadow {
    struct light_part part; /* LIGHT_NONE: no light is chosen */
    bool sent;              /* else the light is black */
    struct ray ray;         /* in `media` */
    struct medium_stack media;
    struct world_light_sample sample;
    struct colour weight, scattered;        /* of the path; and by the vertex, of unit radiance */
    int depth;                              /* of the vertex */
    struct colour shares[PATH_SCATTERINGS]; /* with layers: of the light of a vertex of depth 0, as in path_parts */
};

#endif
