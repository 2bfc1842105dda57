/* Lights. Everything that depends on the kind of a light is in this module: light at a point (light_sample, light_pdf,
 * light_arrive), radiance along a ray that hits it (light_meets_ray, light_emitted), photons (light_photon), and
 * properties for listings and editors (light_properties). Positions are world coordinates; falloff {0,0,0} counts as
 * {1,0,0}.
 *
 * There are two models. Without `emissive` a light with an extent is shaded once, as if from its centre, times the
 * fraction of its shadow rays that reach it (docs/language.md 7.1): a delta light whose shadow rays differ. With
 * `emissive` it is an area light of uniform radiance `colour`: every shadow ray has its own direction, distance and
 * cosine at the light. */
#ifndef GRAY_LIGHT_LIGHT_H
#define GRAY_LIGHT_LIGHT_H

#include "base/bundle.h"
#include "base/list.h"
#include "math/box.h"
#include "math/colour.h"
#include "math/ray.h"
#include "math/sampling.h"
#include "math/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/* Every kind with its name. A switch names a whole list where its lights have one answer. Those of a mesh and of a sky
 * are lamps always: `emissive` is set. Those of points have no extent, those of surfaces a surface of their own. */
#define POINT_LIGHTS(X)                                                                                                \
    X(LIGHT_POINT, "point light")                                                                                      \
    X(LIGHT_DIRECTIONAL, "directional light")                                                                          \
    X(LIGHT_SPOT, "spot light")
#define SURFACE_LIGHTS(X)                                                                                              \
    X(LIGHT_PARALLELOGRAM, "area light")                                                                               \
    X(LIGHT_DISC, "disc light")                                                                                        \
    X(LIGHT_SPHERE, "spherical light")
#define LIGHT_KINDS(X)                                                                                                 \
    POINT_LIGHTS(X)                                                                                                    \
    SURFACE_LIGHTS(X)                                                                                                  \
    X(LIGHT_MESH, "mesh light")                                                                                        \
    X(LIGHT_SKY, "sky light")
enum light_kind { LIGHT_KINDS(LIST_MEMBER) };
enum { LIGHT_KIND_COUNT = LIST_COUNT(LIGHT_KINDS) };

#define LIGHT_NONE UINT32_MAX /* instead of a light's number */

/* COEFFICIENTS: 1 / (c0 + c1 d + c2 d^2); RANGE: 1 - d / range, 0 beyond; INVERSE_SQUARE: intensity / d^2. */
#define ATTENUATIONS(X)                                                                                                \
    X(ATTENUATION_COEFFICIENTS, "coefficients")                                                                        \
    X(ATTENUATION_RANGE, "range")                                                                                      \
    X(ATTENUATION_INVERSE_SQUARE, "square")
enum light_attenuation { ATTENUATIONS(LIST_MEMBER) };

struct arena;
struct error;
struct expr_program;
struct light_mesh;
struct pool;
struct sky;
struct sky_table;

/* What is the same for all points that see a planar lamp. */
struct light_plane {
    struct vec3 across, normal; /* of a parallelogram: the product of its edges, and the unit vector */
    double area;
    double size;                  /* the largest coordinate */
    struct rectangle_frame frame; /* of a parallelogram, or of the square around a disc */
    struct vec3 right, up;        /* of a disc: directions of that square */
};

struct light {
    enum light_kind kind;
    struct vec3 position; /* of a parallelogram, disc, sphere: its centre */
    struct vec3 corner, edge1, edge2;
    struct colour colour; /* of a lamp: its radiance */
    /* A factor of the colour of a light with a position: a function of the unit direction in which light leaves, with
     * one output or three; NULL: 1. profile_largest: a bound of its components. */
    const struct expr_program *profile;
    double profile_largest;
    /* `colour` has this factor, a colour of the screen. light_decode makes it light and clears has_display. */
    struct colour display;
    bool has_display;
    double falloff[3];
    enum light_attenuation attenuation;
    double range, intensity;
    struct vec3 direction;             /* unit: the direction of a directional light or a spot, the normal of a disc */
    double cos_inner, cos_outer;       /* spot: full light within the inner angle, none beyond the outer */
    double radius;                     /* disc, sphere */
    bool emissive, one_sided, visible; /* one_sided: emits only on the side of edge1 x edge2 or of the disc's normal */
    int samples;                       /* N x N shadow rays; 0: as the settings say */
    bool has_emission;                 /* of a mesh: `emission` replaces that of the materials */
    struct colour emission;
    const struct light_mesh *mesh; /* made by world_build (light_mesh.h) */
    const struct sky *sky;         /* its colour multiplies it */
    const struct sky_table *table; /* made by light_prepare */
    struct light_plane plane;      /* the same, of a parallelogram or disc */
    const uint8_t *lit;            /* by primitive, made by world_build; NULL: it lights everything */
    uint32_t lit_count;
};

/* For linear colours. */
void light_decode(struct light *light);
/* Creates data that queries of a light need (the table of a sky), in the arena. Errors: no memory. */
bool light_prepare(struct light *light, struct arena *arena, struct pool *pool, struct error *error);

/* Sets the factor of the colour of a light with a position. Errors: the function reads more than the direction, or no
 * memory. */
bool light_set_profile(struct light *light, const struct expr_program *profile, struct error *error);

/* --- light at a point --- */

/* Shading uses one direction for all samples; that direction has no density. */
static inline bool light_is_delta(const struct light *light) {
    return !light->emissive;
}

/* Whether all of its samples for a point have the same target. */
static inline bool light_is_point(const struct light *light) {
    switch (light->kind) {
        POINT_LIGHTS(LIST_LABEL)
        return true;
    case LIGHT_MESH:
    case LIGHT_SKY:
        SURFACE_LIGHTS(LIST_LABEL)
        break;
    }
    return false;
}

/* The end of shadow rays: a point, or the direction of an infinitely distant one. */
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
/* The centre of a light with one position or one direction; false: meshes and skies have none. */
bool light_middle(const struct light *light, struct light_target *out);

/* A delta light as a point sees it. */
struct light_arrival {
    struct light_target middle;
    struct vec3 direction; /* unit, to the light */
    double distance;       /* of its middle; infinite */
    double strength;       /* colour * strength arrives: the falloff times the cone of a spot */
    struct colour colour;  /* of the light in that direction */
};
/* False: the point is at the light. */
bool light_arrive(const struct light *light, struct vec3 point, struct light_arrival *out);

/* Data of a point for samples of a light. */
struct light_context {
    struct vec3 point, from; /* the shaded point; the start of shadow rays, next to it */
    bool single;             /* all samples of a delta light have its centre as target */
    bool shares_cells;       /* the cells of the unit square are divided once more among the samples of a pixel */
    bool bounded;            /* a parallelogram contains every target: */
    struct vec3 corner, edge1, edge2;
    double weight;               /* of one target of an area light, without cosines and distance */
    struct vec3 axis, right, up; /* sphere: unit vectors, axis from the point to the centre */
    double distance;             /* sphere: of its centre */
    bool by_angle;               /* an area light that is sampled by the solid angle of a rectangle: */
    struct spherical_rectangle seen;
};
/* False: no light can reach the point (on a sphere, behind a one-sided light). */
bool light_context_make(const struct light *light, struct vec3 point, struct vec3 from, struct light_context *out);

struct light_sample {
    struct vec3 direction;      /* unit, from the point: the surface is shaded for light from there */
    struct light_target target; /* the target of the shadow ray */
    struct colour
        radiance; /* of an area light, at the target; of a delta light the arriving light: colour * strength */
    double pdf;   /* of the target, by solid angle at the point; of a delta light 1 */
    struct colour intensity; /* the classic one: the arriving light is the mean over all samples of intensity * (n.l) */
    bool is_delta;
    uint32_t triangle; /* of a mesh */
};
/* The sample for a point of the unit square: equal areas of the square are equal areas of a parallelogram or disc,
 * equal solid angles of a sphere or a rectangle, equal light of a mesh or a sky. A target that sends no light to the
 * point has intensity 0 and its pdf. Call only if light_context_make was true. */
struct light_sample light_sample(const struct light *light, const struct light_context *context, struct sample2 xi);
/* Only the target of that sample, for a light with an extent (not a mesh). */
struct vec3 light_target_at(const struct light *light, const struct light_context *context, struct sample2 xi);

/* Where a ray meets a light. */
struct light_hit {
    double t; /* infinite: a sky */
    struct vec3 point;
    uint32_t triangle; /* of a mesh */
};
/* The density of light_sample by solid angle at the point for the direction (unit) of the light's hit `hit`; 0 for
 * delta lights, and where the light emits nothing. */
double light_pdf(const struct light *light, const struct light_context *context, struct vec3 direction,
                 const struct light_hit *hit);

/* --- what a ray sees --- */

/* The hit of a ray on the surface of an area light; t in the ray's interval. Never a mesh, whose surface is in the
 * scene (if it is not: light_triangle_meets_ray), nor a sky, which is behind everything. */
bool light_meets_ray(const struct light *light, const struct ray *ray, struct light_hit *hit);
/* The radiance that it emits along a ray that hits it. */
struct colour light_emitted(const struct light *light, const struct ray *ray, const struct light_hit *hit);
/* The box of the surface that light_meets_ray tests. False: there is none. */
bool light_surface_box(const struct light *light, struct box *out);
/* A bound of the largest component of its light. */
double light_brightest(const struct light *light);

/* --- photons --- */

/* LOCAL: it has a position and emits in many directions. PARALLEL: all of it goes in one direction, from infinitely
 * far. ENVIRONMENT: from infinitely far, from all sides. */
enum light_domain { LIGHT_DOMAIN_LOCAL, LIGHT_DOMAIN_PARALLEL, LIGHT_DOMAIN_ENVIRONMENT };

/* A light, or part of one, that photons leave. */
struct light_emitter {
    const struct light *light;
    enum light_domain domain;
    struct vec3 centre; /* LOCAL: the places where photons start lie in this ball */
    double radius;
    double low[2], side;   /* the selected part of the unit square: low to low + side */
    struct vec3 right, up; /* PARALLEL: across its direction; else of a disc */
    bool even;             /* it emits uniformly in all directions */
};
/* The size for the division of a light into parts; 0: it cannot be divided. */
double light_divided_extent(const struct light *light);
/* Part (i, j) of parts x parts. False: it emits nothing. */
bool light_emitter_make(const struct light *light, uint32_t i, uint32_t j, uint32_t parts, struct light_emitter *out);
/* LOCAL: its brightness in the unit direction, relative to the maximum. */
double light_emitter_shine(const struct light_emitter *emitter, struct vec3 direction);
/* LOCAL: whether it emits within the cone about `axis`, if it does not along the axis and some directions around it. */
bool light_emitter_shines_near(const struct light_emitter *emitter, struct vec3 axis, double cos_half);
/* Colour times unit is the power of a photon before shine: an estimate, to share photons by. */
struct colour light_emitter_colour(const struct light_emitter *emitter);
double light_emitter_unit(const struct light_emitter *emitter);

struct light_photon {
    struct vec3 origin, direction; /* direction: unit */
    struct colour power;
};
/* LOCAL: a photon in the given unit direction, from the point xi of the light; its power is flux per solid angle, as a
 * mean over xi. Others: the direction follows from xi, the origin is not set, and the power is flux per area
 * perpendicular to the direction, as a mean over xi. Fluxes are those of classic intensities (docs/design/light.md). */
struct light_photon light_photon(const struct light_emitter *emitter, struct vec3 direction, struct sample2 xi);
/* The factor for the power of a photon after a path of `length`. */
double light_photon_attenuation(const struct light *light, double length);

/* --- selection (light_sampler.h) --- */

struct light_bounds; /* light_bounds.h */
/* How many parts of a light are chosen separately: the triangles of a mesh; 1 of others. */
uint32_t light_part_count(const struct light *light);
/* Of a part. NONE: it sends nothing. INFINITE: it has no place; its bounds are not set. */
enum light_extent { LIGHT_EXTENT_NONE, LIGHT_EXTENT_BOUNDED, LIGHT_EXTENT_INFINITE };
enum light_extent light_bounds_of(const struct light *light, uint32_t part, struct light_bounds *out);
/* What it points to (base/bundle.h). */
bundle_fields light_bundle;

#endif
