/* Events of an integrator at its stages, in order. The stages always call the functions below; without an observer a
 * call is one test of a pointer. An observer has its own state and cannot change the work: a number in an event is the
 * number that goes into the picture. The pixel trace (render/pixel_trace.h) is an observer. */
#ifndef GRAY_RENDER_OBSERVER_H
#define GRAY_RENDER_OBSERVER_H

#include "light/light.h"
#include "material/material_eval.h"
#include "render/sampler.h"

#include <stdint.h>

/* BELOW: from under a surface, from the last scattering there to where it comes out. */
enum ray_kind { RAY_CAMERA, RAY_REFLECTED, RAY_REFRACTED, RAY_HOLE, RAY_BELOW };
/* Why a ray was not followed, or its hit not evaluated. */
enum ray_cut { RAY_FOLLOWED, RAY_OVER_LIMIT, RAY_TOO_WEAK };
#define OBSERVER_NO_BLOCKER UINT32_MAX
/* Why a pixel is marked. The colour of its first sample differs from that of a neighbour; or less, from that of a
 * neighbour on another surface; or from the mean of two opposite neighbours; or the pixel may contain a primitive that
 * is narrower than a pixel. */
enum mark_reason { MARK_COLOUR, MARK_SURFACE, MARK_DETAIL, MARK_THIN };

/* Why a path ends at a vertex. */
enum path_end {
    PATH_GOES_ON,
    PATH_LEAVES_SCENE,
    PATH_SEES_LIGHT,        /* a line of sight ends at a visible light */
    PATH_REACHES_MAX_DEPTH, /* --max-depth */
    PATH_IS_ABSORBED,       /* the BSDF scatters no light in the direction that it samples */
    PATH_LOSES_ROULETTE,
    PATH_IN_TOO_MANY_HOLES
};

enum observation_kind {
    OBSERVED_SAMPLE_BEGIN, /* sample.place */
    OBSERVED_SAMPLE_END,   /* sample.place, sample.colour */
    OBSERVED_SPLIT,     /* part: the rays that the current ray spawns from now on have this fraction of their weight */
    OBSERVED_RAY_SENT,  /* sent: a secondary ray leaves the hit of the current ray, or would without the cut */
    OBSERVED_RAY_BEGIN, /* begin: the ray is current; its hit */
    OBSERVED_MATERIAL,  /* material: one link of the material of the hit is evaluated */
    OBSERVED_SURFACE,   /* surface: all of it is */
    OBSERVED_LIGHT_BEGIN,   /* light.number, light.light */
    OBSERVED_LIGHT_SAMPLE,  /* the light is shaded as if from one position */
    OBSERVED_SHADOW_RAYS,   /* shadow: of the current light */
    OBSERVED_LIGHT_END,     /* light.colour */
    OBSERVED_LIGHT_SKIPPED, /* light.number, light.light: its lists leave the surface out */
    OBSERVED_DIRECT,        /* direct: after the lights of a hit */
    OBSERVED_VERTEX,        /* vertex: of a path, before the next ray is sent */
    OBSERVED_RAY_END,       /* end */
    OBSERVED_PIXEL,         /* pixel: it is final */
    OBSERVED_MARK           /* mark: the pixel is marked */
};

struct observation {
    enum observation_kind kind;
    union {
        struct {
            const struct pixel_sample *position;
            struct colour colour;
        } sample;
        double part;
        struct {
            enum ray_kind kind;
            struct colour weight; /* the factor of its radiance in the surface where it starts */
            enum ray_cut cut;     /* other than RAY_FOLLOWED: it does not begin */
        } sent;
        struct observed_begin {
            const struct ray *ray;
            const struct hit *hit;     /* or NULL */
            const struct light *light; /* that shows itself before the hit, or NULL; neither: the sky */
            double distance;           /* world units; infinite */
            double share;              /* the largest share of its result that can reach the pixel */
            int scatterings;           /* of RAY_BELOW, under the surface */
        } begin;
        struct {
            const struct material *link;
            const struct surface_inputs *inputs; /* as the link leaves it */
        } material;
        const struct bsdf *surface;
        struct {
            uint32_t number; /* in the world; of paths: of world_lights */
            const struct light *light;
            uint32_t primitive;   /* the emissive primitive that the light stands for, or OBSERVER_NO_BLOCKER */
            struct colour colour; /* of the light in what the surface shows */
        } light;
        struct observed_light_sample {
            double distance, strength; /* attenuation times the cone of a spot */
            struct vec3 to_light;      /* unit */
            struct colour reflected;   /* of unit light */
        } position;
        struct observed_shadow {
            uint32_t asked, arrived;
            uint32_t blocker; /* the primitive that stopped a single ray, where known */
        } shadow;
        struct observed_direct {
            struct colour ambient_light, ambient, photons, direct; /* direct: ambient, photons and lights together */
            bool has_photons;
        } direct;
        struct observed_vertex {
            enum path_end end;
            double distance; /* of PATH_SEES_LIGHT and in_medium, world units */
            bool in_medium;  /* scattered by the medium of the ray, before its hit */
            double chance;   /* of that */
            /* Of the emission of the hit or the sky and of lights, weighted by multiple importance sampling; direct:
             * photons and the light of the sampled light together. */
            struct colour emission, photons, direct;
            bool has_photons;
        } vertex;
        struct observed_end {
            bool evaluated;                                 /* its hit was evaluated; else it was too weak */
            struct colour seen, left, in_scattered, brings; /* brings, its radiance: left * seen + in_scattered */
        } end;
        struct observed_mark {
            enum mark_reason reason;
            int x, y; /* the neighbour, or one of the two, relative to the pixel, -1..1; MARK_THIN: 0 */
            double distance, tolerance; /* squared, of colours; MARK_THIN: 0 */
        } mark;
        struct observed_pixel {
            struct colour colour;
            int samples;       /* N of N x N samples that the pixel has got; 0: the first one only */
            bool full;         /* every pixel gets them */
            bool first_counts; /* the first sample is part of the mean */
        } pixel;
    };
};

struct observer {
    void (*notice)(void *context, const struct observation *what);
    void *context;
};

/* Reports an event, as in OBSERVE(observer, OBSERVED_SPLIT, .part = 0.5); without an observer it computes nothing. */
#define OBSERVE(who, ...)                                                                                              \
    do {                                                                                                               \
        if (who)                                                                                                       \
            (who)->notice((who)->context, &(struct observation){__VA_ARGS__});                                         \
    } while (0)

/* For material_observe. */
static inline void observe_material(void *context, const struct material *link, const struct surface_inputs *inputs) {
    const struct observer *observer = context;
    OBSERVE(observer, OBSERVED_MATERIAL, .material = {link, inputs});
}

#endif
