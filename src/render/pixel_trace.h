/* The trace of a pixel: the computation of its colour, recorded by an observer (render/observer.h) of the integrator.
 * Nothing is computed a second time: a number in a trace is the number that went into the picture. Everything is in
 * the arena of the trace. It has pointers into the world and must not outlive it. */
#ifndef GRAY_RENDER_PIXEL_TRACE_H
#define GRAY_RENDER_PIXEL_TRACE_H

#include "base/arena.h"
#include "render/observer.h"
#include "world/world.h"

#include <stdint.h>

enum { PIXEL_TRACE_RAYS = 100000 }; /* further ones are counted and not printed */

/* One link of a material: the look as it is with it and what is below it. */
struct pixel_trace_link {
    const struct material *material;
    struct surface_inputs inputs;
    struct pixel_trace_link *next;
};

enum pixel_trace_lit {
    PIXEL_TRACE_LIGHT_REACHES,
    PIXEL_TRACE_LIGHT_BLOCKED,   /* no shadow ray arrives */
    PIXEL_TRACE_LIGHT_NOT_OURS,  /* include or exclude leave the surface out */
    PIXEL_TRACE_LIGHT_NO_EFFECT, /* its reflection or its falloff is zero: no shadow rays */
};

/* The contribution of a light at a hit. Of lamps `reflected`, `strength` and `distance` are not set: every shadow ray
 * has its own. */
struct pixel_trace_light {
    uint32_t number; /* in the world, from 0 */
    const struct light *light;
    uint32_t primitive; /* the emissive primitive that the light stands for, or OBSERVER_NO_BLOCKER */
    enum pixel_trace_lit lit;
    bool area_light;
    double distance, strength; /* fading times the cone of a spot */
    struct vec3 to_light;      /* unit */
    struct colour reflected;   /* by the lobes, of unit light */
    uint32_t asked, arrived;   /* shadow rays */
    bool has_blocker;          /* a single shadow ray was stopped */
    uint32_t blocker;          /* by this primitive */
    struct colour colour;      /* of all this in what the surface shows */
    struct pixel_trace_light *next;
};

struct pixel_trace_ray {
    enum ray_kind kind;
    enum ray_cut cut;
    bool begun;      /* it was sent; else only kind and weight are set */
    uint32_t number; /* in the order in which they were begun, from 1 */
    struct vec3 origin, direction;
    double time;
    double share;         /* upper bound of the fraction of its radiance that arrives in the pixel */
    struct colour weight; /* the factor of its radiance in the surface where it started */
    int scatterings;      /* of RAY_BELOW, under the surface */
    uint32_t media_count;
    double media_ior;  /* of where it starts */
    double wavelength; /* of its light where it ends, in micrometres; 0: white light */
    /* What it hit: a surface, else a visible light, else the sky. */
    bool met;
    struct hit hit;
    const struct light *area_light;
    double distance; /* of either, world units; infinite */
    /* The surface. */
    struct pixel_trace_link *links;
    double opacity;
    bool shaded; /* bsdf is set */
    struct bsdf bsdf;
    struct colour ambient_light, ambient, photons, direct; /* direct: ambient, photons and lights together */
    bool has_photons;
    bool is_vertex; /* of a path: `vertex` is set, and takes the place of ambient, photons and direct above */
    struct observed_vertex vertex;
    struct pixel_trace_light *lights, *last_light;
    struct pixel_trace_ray *first, *last; /* those that it sent on */
    double part;                          /* of their weight, where several share one */
    /* Its radiance: brings = left * seen + in_scattered. */
    struct colour seen, left, in_scattered, brings;
    struct pixel_trace_ray *parent, *next;
};

struct pixel_trace_sample {
    double x, y;     /* in the picture, pixels */
    uint64_t number; /* 0: the first one */
    bool counts;     /* it is part of the mean */
    struct colour colour;
    struct pixel_trace_ray *first, *last;
    struct pixel_trace_sample *next;
};

struct pixel_trace {
    struct observer observer; /* of the integrator that makes the pixel */
    struct arena arena;
    uint32_t x, y; /* the pixel of the whole picture */
    /* What render_pixel found out. first[1 + dy][1 + dx]: first samples of the pixel and its neighbours, where
     * known. */
    struct colour first[3][3];
    bool known[3][3];
    bool full;                 /* every pixel is sampled again */
    bool marked;               /* this one was */
    struct observed_mark mark; /* why */
    int samples;               /* N of N x N */
    struct pixel_trace_sample *sample, *last_sample;
    float rgb[3]; /* in the film */
    uint32_t rays, omitted;
    bool failed; /* no memory */
    /* While it is written. */
    bool on; /* a sample of the pixel itself is being traced */
    struct pixel_trace_ray *ray;
    struct pixel_trace_light *light;
    uint32_t mute;        /* number of rays in progress that are not printed */
    enum ray_kind kind;   /* of the next ray */
    struct colour weight; /* of the next ray */
};

/* The trace stays where it is until it is destroyed: its observer points to it. */
void pixel_trace_init(struct pixel_trace *pixel_trace, uint32_t x, uint32_t y);
void pixel_trace_destroy(struct pixel_trace *pixel_trace);

#endif
