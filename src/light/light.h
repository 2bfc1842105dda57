/* Lights. Positions are world coordinates; falloff {0,0,0} counts as {1,0,0}.
 *
 * Two ways of shading. Without `emits` a light with an extent is shaded as from its centre, once, times the share of
 * its shadow rays that reach it (SPEC 1.4). With `emits` it is a lamp of uniform radiance `colour`: every shadow ray
 * carries its own direction, distance and cosine at the lamp. The sum is normalised so that a white diffuse surface
 * that sees nothing but the lamp has the lamp's radiance: what arrives is radiance times view factor. */
#ifndef GRAY_LIGHT_LIGHT_H
#define GRAY_LIGHT_LIGHT_H

#include "math/ray.h"
#include "math/sampling.h"
#include "math/vec3.h"

#include <stdbool.h>
#include <stdint.h>

enum light_kind {
    LIGHT_POINT,
    LIGHT_PARALLELOGRAM,
    LIGHT_DIRECTIONAL,
    LIGHT_SPOT,
    LIGHT_DISC,
    LIGHT_SPHERE,
    LIGHT_MESH, /* this and the next are lamps always: `emits` is set */
    LIGHT_SKY
};
/* COEFFICIENTS: 1 / (c0 + c1 d + c2 d^2); RANGE: 1 - d / range, 0 beyond; INVERSE_SQUARE: intensity / d^2. */
enum light_fading { FADING_COEFFICIENTS, FADING_RANGE, FADING_INVERSE_SQUARE };

struct node;
struct sky;

/* The triangles of a lamp that is a mesh, in world space; made by world_build. */
struct light_triangle {
    struct vec3 corner, edge1, edge2, normal; /* normal: unit */
    struct vec3 light;                        /* radiance over the density of samples on the surface, over pi */
    double offset;                            /* shadow rays end this far from it */
};
struct light_mesh {
    const struct light_triangle *triangles;
    const double *until; /* until[i]: share of the unit interval up to and with triangle i */
    uint32_t count;
    bool one_sided; /* normals point outwards, and light comes from that side only */
    struct vec3 centre;
    double radius; /* of a ball round all of it */
};

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
    const struct node *node;        /* of a mesh: all meshes there and below; its colour multiplies their emission */
    bool has_emission;              /* of a mesh: `emission` takes the place of the materials' */
    struct vec3 emission;
    const struct light_mesh *mesh;
    const struct sky *sky; /* its colour multiplies it */
    bool sky_turned; /* the sky is to be turned further, by the angle of this sine and cosine (world_build does) */
    double turn_sine, turn_cosine;
    const struct sky_table *table;
    /* The nodes (with everything under them) that it lights, or does not; NULL: no such list. Arrays of the script. */
    const struct node *const *include, *const *exclude;
    uint32_t include_count, exclude_count;
    const uint8_t *lit; /* by placed primitive, made by world_build from the lists; NULL: everything */
};

/* A place on a lamp that is a mesh, for one in the unit square. */
struct light_point {
    const struct light_triangle *triangle;
    struct vec3 place;
};
struct light_point light_mesh_point(const struct light_mesh *mesh, struct sample2 place);

/* Of the distance, as `fading` says. */
double light_attenuation(const struct light *light, double distance);
/* Share of a spot's light in the unit direction from the light: 1 inside the inner cone, 0 outside the outer, between
 * them the cubic 3 s^2 - 2 s^3 of the cosine. 1 for other kinds. */
double light_cone(const struct light *light, struct vec3 from_light);

static inline bool light_has_extent(const struct light *light) {
    return light->kind == LIGHT_PARALLELOGRAM || light->kind == LIGHT_DISC || light->kind == LIGHT_SPHERE;
}

/* A rectangle as a point sees it (light_rectangle.c). */
struct spherical_rectangle {
    struct vec3 from, x, y, z;
    double x0, x1, y0, y1, z0, b0, b1, k, angle; /* angle: the solid angle */
};

/* What samples of a light need to know about the point that they are for. */
struct light_frame {
    bool bounded; /* a parallelogram holds every target: */
    struct vec3 corner, edge1, edge2;
    double weight;               /* of one target for a lamp, its cosines and distance aside */
    struct vec3 axis, right, up; /* sphere: unit vectors, axis from the point to the centre */
    double cos_cone;             /* sphere: half angle under which it is seen */
    double distance;             /* sphere: of its centre */
    bool by_angle;               /* of a lamp that is a rectangle */
    struct spherical_rectangle seen;
};
/* False: nothing of the light can reach the point (inside of a sphere, a lamp's back). */
bool light_frame_make(const struct light *light, struct vec3 from, struct light_frame *out);
/* A point of the light for a place in the unit square; equal areas of the square are equal areas of a parallelogram or
 * disc, equal solid angles of a lamp that is a sphere or a rectangle. */
struct vec3 light_target(const struct light *light, const struct light_frame *frame, struct vec3 from,
                         struct sample2 place);

struct light_sample {
    struct vec3 target; /* where the shadow ray ends; of a sky its direction */
    struct vec3 light;  /* the mean over all places of light * (n.l) is radiance times view factor */
};
/* One sample of a lamp (`emits`). */
struct light_sample light_sample_lamp(const struct light *light, const struct light_frame *frame, struct vec3 from,
                                      struct sample2 place);

/* light_rectangle.c. False: its edges are not at right angles, or it is seen too small for it to matter. */
bool spherical_rectangle_make(struct vec3 corner, struct vec3 edge1, struct vec3 edge2, struct vec3 from,
                              struct spherical_rectangle *out);
struct vec3 spherical_rectangle_point(const struct spherical_rectangle *seen, struct sample2 place);

/* Where a ray meets a light that shows itself; t in the ray's interval. */
bool light_meets_ray(const struct light *light, const struct ray *ray, double *t);

#endif
