/* Lights. Everything that depends on the kind of a light happens in this module: what a point gets of it (light_sample,
 * light_pdf, light_arrive), what a ray that meets it sees (light_meets_ray, light_emitted), the photons that it sends
 * (light_photon), and what it has for listings and editors (light_properties). Positions are world coordinates; falloff
 * {0,0,0} counts as {1,0,0}.
 *
 * Two ways of shading. Without `emissive` a light with an extent is shaded as from its centre, once, times the share of
 * its shadow rays that reach it (docs/language.md 7.1): a delta light whose shadow rays differ. With `emissive` it is
 * an area light of uniform radiance `colour`: every shadow ray carries its own direction, distance and cosine at the
 * light. */
#ifndef GRAY_LIGHT_LIGHT_H
#define GRAY_LIGHT_LIGHT_H

#include "base/list.h"
#include "math/box.h"
#include "math/ray.h"
#include "math/sampling.h"
#include "math/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/* Every kind with its name. Those of a mesh and of a sky are lamps always: `emissive` is set. */
#define LIGHT_KINDS(X)                                                                                                 \
    X(LIGHT_POINT, "point light")                                                                                      \
    X(LIGHT_PARALLELOGRAM, "area light")                                                                               \
    X(LIGHT_DIRECTIONAL, "directional light")                                                                          \
    X(LIGHT_SPOT, "spot light")                                                                                        \
    X(LIGHT_DISC, "disc light")                                                                                        \
    X(LIGHT_SPHERE, "spherical light")                                                                                 \
    X(LIGHT_MESH, "mesh light")                                                                                        \
    X(LIGHT_SKY, "sky light")
enum light_kind { LIGHT_KINDS(LIST_MEMBER) };
enum { LIGHT_KIND_COUNT = LIST_COUNT(LIGHT_KINDS) };

#define LIGHT_NONE UINT32_MAX /* in the place of a light's number */

/* COEFFICIENTS: 1 / (c0 + c1 d + c2 d^2); RANGE: 1 - d / range, 0 beyond; INVERSE_SQUARE: intensity / d^2. */
enum light_attenuation { ATTENUATION_COEFFICIENTS, ATTENUATION_RANGE, ATTENUATION_INVERSE_SQUARE };

struct arena;
struct error;
struct light_mesh;
struct pool;
struct sky;
struct sky_table;

struct light {
    enum light_kind kind;
    struct vec3 position; /* of a parallelogram, disc, sphere: its centre */
    struct vec3 corner, edge1, edge2;
    struct vec3 colour; /* of a lamp: its radiance */
    double falloff[3];
    enum light_attenuation attenuation;
    double range, intensity;
    struct vec3 direction;       /* unit: where a directional light or a spot shines to, the normal of a disc */
    double cos_inner, cos_outer; /* spot: full light within the inner angle, none beyond the outer */
    double radius;               /* disc, sphere */
    bool emissive, one_sided,
        visible;       /* one_sided: a lamp shines to the side of edge1 x edge2 or of the disc's normal */
    int samples;       /* N x N shadow rays; 0: as the settings say */
    bool has_emission; /* of a mesh: `emission` takes the place of the materials' */
    struct vec3 emission;
    const struct light_mesh *mesh; /* made by world_build (light_mesh.h) */
    const struct sky *sky;         /* its colour multiplies it */
    const struct sky_table *table; /* made by light_prepare */
    const uint8_t *lit;            /* by primitive, made by world_build; NULL: it lights everything */
};

/* Makes what a light needs before it is asked (the table of a sky), in the arena. Errors: no memory. */
bool light_prepare(struct light *light, struct arena *arena, struct pool *pool, struct error *error);

/* --- what a point gets --- */

/* A surface is shaded for it from one direction, whatever is sampled; that direction has no density. */
static inline bool light_is_delta(const struct light *light) {
    return !light->emissive;
}

/* Where shadow rays end: a point, or the direction of one that is infinitely far. */
struct light_target {
    struct vec3 at;
    bool distant;
};
/* From a point to the target, not unit. */
static inline struct vec3 light_target_from(const struct light_target *target, struct vec3 from) {
    return target->distant ? target->at : vec3_sub(target->at, from);
}
/* The largest t of a shadow ray along light_target_from. */
static inline double light_target_end(const struct light_target *target) {
    return target->distant ? INFINITY : 1;
}
/* The middle of a light that has one place or one direction; false: meshes and skies have none. */
bool light_middle(const struct light *light, struct light_target *out);

/* A delta light as a point sees it. */
struct light_arrival {
    struct light_target middle;
    struct vec3 direction; /* unit, to the light */
    double distance;       /* of its middle; infinite */
    double strength;       /* colour * strength arrives: the fading times the cone of a spot */
};
/* False: the point is the light's own. */
bool light_arrive(const struct light *light, struct vec3 point, struct light_arrival *out);

/* What samples of a light need to know about the point that they are for. */
struct light_context {
    struct vec3 point, from; /* what is shaded; where shadow rays start, next to it */
    bool single;             /* all samples of a delta light have its middle as their target */
    bool shares_cells;       /* the cells of the unit square are divided once more among the samples of a pixel */
    bool bounded;            /* a parallelogram holds every target: */
    struct vec3 corner, edge1, edge2;
    double weight;               /* of one target of a lamp, its cosines and distance aside */
    struct vec3 axis, right, up; /* sphere: unit vectors, axis from the point to the centre */
    double distance;             /* sphere: of its centre */
    bool by_angle;               /* a lamp that is sampled by the solid angle of a rectangle: */
    struct spherical_rectangle seen;
};
/* False: nothing of the light can reach the point (on a ball, behind a lamp that shines to one side). */
bool light_context_make(const struct light *light, struct vec3 point, struct vec3 from, struct light_context *out);

struct light_sample {
    struct vec3 direction;      /* unit, from the point: the surface is shaded for light from there */
    struct light_target target; /* what the shadow ray has to reach */
    struct vec3 radiance;       /* of a lamp, where the target lies; of a delta light what arrives: colour * strength */
    double pdf;                 /* of the target, by solid angle at the point; of a delta light 1 */
    struct vec3 intensity;      /* the classic one: the mean over all samples of intensity * (n.l) is what arrives */
    bool is_delta;
    uint32_t triangle; /* of a mesh */
};
/* The sample for a place in the unit square: equal areas of the square are equal areas of a parallelogram or disc,
 * equal solid angles of a lamp that is a sphere or a rectangle, equal light of a mesh or a sky. A target that the light
 * does not reach has intensity 0 and pdf as it was drawn. Only where light_context_make was true. */
struct light_sample light_sample(const struct light *light, const struct light_context *context, struct sample2 xi);
/* The target of that sample alone, of a light with an extent (not a mesh). */
struct vec3 light_target_at(const struct light *light, const struct light_context *context, struct sample2 xi);

/* Where a ray meets a light. */
struct light_hit {
    double t; /* infinite: a sky */
    struct vec3 point;
    uint32_t triangle; /* of a mesh */
};
/* The density of light_sample by solid angle at the point for the direction (unit) in which the light is met at `hit`;
 * 0 of delta lights, and where the light does not shine to. */
double light_pdf(const struct light *light, const struct light_context *context, struct vec3 direction,
                 const struct light_hit *hit);

/* --- what a ray sees --- */

/* Where a ray meets the surface of a light that has one of its own; t in the ray's interval. Never a mesh, which the
 * scene shows, nor a sky, which is behind everything. */
bool light_meets_ray(const struct light *light, const struct ray *ray, struct light_hit *hit);
/* Whether a ray that leads to it sees its light, as part of the light or of what it is made of: a mirror shows it. */
bool light_is_seen(const struct light *light);
/* The radiance that it sends back along a ray that meets it. */
struct vec3 light_emitted(const struct light *light, const struct ray *ray, const struct light_hit *hit);
/* The box of the surface that light_meets_ray knows of. False: there is none. */
bool light_surface_box(const struct light *light, struct box *out);
/* At least the largest component of what comes from it. */
double light_brightest(const struct light *light);

/* --- what it sends --- */

/* LOCAL: it has a position and emits in many directions. PARALLEL: all of it goes in one direction, from infinitely
 * far. ENVIRONMENT: from infinitely far, from all sides. */
enum light_domain { LIGHT_DOMAIN_LOCAL, LIGHT_DOMAIN_PARALLEL, LIGHT_DOMAIN_ENVIRONMENT };

/* A light, or part of one, that photons leave. */
struct light_emitter {
    const struct light *light;
    enum light_domain domain;
    struct vec3 centre; /* LOCAL: the places where photons start lie in this ball */
    double radius;
    double low[2], side;   /* part of the unit square whose places are meant: low to low + side */
    struct vec3 right, up; /* PARALLEL: across its direction; else of a disc */
    bool even;             /* it sends alike in all directions */
};
/* Into how large parts a light is best divided: its size; 0: it cannot be divided. */
double light_divided_extent(const struct light *light);
/* Part (i, j) of parts x parts. False: it sends nothing. */
bool light_emitter_make(const struct light *light, uint32_t i, uint32_t j, uint32_t parts, struct light_emitter *out);
/* LOCAL: its brightness in the unit direction, of its brightest. */
double light_emitter_shine(const struct light_emitter *emitter, struct vec3 direction);
/* LOCAL: whether it shines within the cone about `axis`, when it does not along its axis and some directions round it.
 */
bool light_emitter_shines_near(const struct light_emitter *emitter, struct vec3 axis, double cos_half);
/* Colour times unit is the power of a photon before shine: an estimate, to share photons by. */
struct vec3 light_emitter_colour(const struct light_emitter *emitter);
double light_emitter_unit(const struct light_emitter *emitter);

struct light_photon {
    struct vec3 origin, direction; /* direction: unit */
    struct vec3 power;
};
/* LOCAL: a photon in the unit direction that is given, from the place on the light; its power is flux by solid angle,
 * the mean over places. Others: the direction follows from the place, the origin is not set, and the power is flux by
 * area across the direction, the mean over places. Fluxes are those of classic intensities (docs/light.md). */
struct light_photon light_photon(const struct light_emitter *emitter, struct vec3 direction, struct sample2 xi);
/* Times this is the power of a photon after a path of `length`. */
double light_photon_attenuation(const struct light *light, double length);

/* --- listings and editors --- */

const char *light_kind_name(enum light_kind kind);
enum light_property {
    LIGHT_HAS_POSITION = 1,  /* that of its own */
    LIGHT_HAS_DIRECTION = 2, /* where it shines to, or the normal of a disc */
    LIGHT_HAS_EDGES = 4,
    LIGHT_HAS_RADIUS = 8,     /* about its direction, where it has one */
    LIGHT_HAS_CONE = 16,      /* about its direction */
    LIGHT_HAS_RANGE = 32,     /* its range grows with it */
    LIGHT_IS_ENVIRONMENT = 64 /* it comes from all sides, mirrors show it, and it is turned about the y axis alone */
};
unsigned light_properties(const struct light *light);
/* The middle of one that stands somewhere, and of a mesh once the world is built. False: there is none. */
bool light_centre(const struct light *light, struct vec3 *out);

#endif
