/* Lights. Positions are world coordinates; falloff {0,0,0} counts as {1,0,0}.
 *
 * Two ways of shading. Without `emits` a light with an extent is shaded as from its centre, once, times the share of
 * its shadow rays that reach it (SPEC 1.4). With `emits` it is a lamp of uniform radiance `colour`: every shadow ray
 * carries its own direction, distance and cosine at the lamp. The sum is normalised so that a white diffuse surface
 * that sees nothing but the lamp has the lamp's radiance: what arrives is radiance times view factor. */
#ifndef GRAY_LOOK_LIGHT_H
#define GRAY_LOOK_LIGHT_H

#include "math/ray.h"
#include "math/sampling.h"
#include "math/vec3.h"

#include <stdbool.h>
#include <stdint.h>

enum light_kind { LIGHT_POINT, LIGHT_PARALLELOGRAM, LIGHT_DIRECTIONAL, LIGHT_SPOT, LIGHT_DISC, LIGHT_SPHERE };
/* COEFFICIENTS: 1 / (c0 + c1 d + c2 d^2); RANGE: 1 - d / range, 0 beyond; INVERSE_SQUARE: intensity / d^2. */
enum light_fading { FADING_COEFFICIENTS, FADING_RANGE, FADING_INVERSE_SQUARE };

struct node;

struct light {
    enum light_kind kind;
    struct vec3 position; /* of a parallelogram, disc, sphere: its centre */
    struct vec3 corner, edge1, edge2;
    struct vec3 colour; /* of a lamp: its radiance */
    double falloff[3];
    enum light_fading fading;
    double range, intensity;
    struct vec3 direction;          /* unit: where a directional light or a spot shines to, the normal of a disc */
    double cos_inner, cos_outer;    /* spot: full light within the inner angle, none beyond the outer */
    double radius;                  /* disc, sphere */
    bool emits, one_sided, visible; /* one_sided: a lamp shines to the side of edge1 x edge2 or of the disc's normal */
    int samples;                    /* N x N shadow rays; 0: as the settings say */
    /* The nodes (with everything under them) that it lights, or does not; NULL: no such list. Arrays of the script. */
    const struct node *const *include, *const *exclude;
    uint32_t include_count, exclude_count;
    const uint8_t *lit; /* by placed primitive, made by world_build from the lists; NULL: everything */
};

/* Of the distance, as `fading` says. */
double light_attenuation(const struct light *light, double distance);
/* Share of a spot's light in the unit direction from the light: 1 inside the inner cone, 0 outside the outer, between
 * them the cubic 3 s^2 - 2 s^3 of the cosine. 1 for other kinds. */
double light_cone(const struct light *light, struct vec3 from_light);

static inline bool light_has_extent(const struct light *light) {
    return light->kind == LIGHT_PARALLELOGRAM || light->kind == LIGHT_DISC || light->kind == LIGHT_SPHERE;
}

/* A parallelogram that holds every target light_target gives for this point. */
struct light_frame {
    struct vec3 corner, edge1, edge2;
    double weight;               /* of one target for a lamp, its cosines and distance aside */
    struct vec3 axis, right, up; /* sphere: unit vectors, axis from the point to the centre */
    double cos_cone;             /* sphere: half angle under which it is seen */
    double distance;             /* sphere: of its centre */
};
/* False: nothing of the light can reach the point (inside of a sphere, a lamp's back). */
bool light_frame_make(const struct light *light, struct vec3 from, struct light_frame *out);
/* A point of the light for a place in the unit square; equal areas of the square are equal areas of a parallelogram or
 * disc, equal solid angles of a lamp that is a sphere. */
struct vec3 light_target(const struct light *light, const struct light_frame *frame, struct vec3 from,
                         struct sample2 place);
/* View factor weight of one target: the mean over all places of weight * (n.l) is the view factor. */
double light_target_weight(const struct light *light, const struct light_frame *frame, struct vec3 from,
                           struct vec3 target);

/* Where a ray meets a light that shows itself; t in the ray's interval. */
bool light_meets_ray(const struct light *light, const struct ray *ray, double *t);

#endif
