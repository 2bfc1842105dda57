/* Media and their effect on the light along a ray: they absorb, scatter and emit by length, in proportion to a density;
 * or are one of the classic fogs. A ray is in the medium of the solid with a surface that it entered last, and outside
 * of all in that of the whole scene; the media of solids with an invisible surface that it entered since add to it.
 * Rays have kinds, and each medium states which of them it affects: fog only lines of sight, not the light of lamps;
 * absorption all. */
#ifndef GRAY_MATERIAL_MEDIUM_H
#define GRAY_MATERIAL_MEDIUM_H

#include "base/bundle.h"
#include "material/dispersion.h"
#include "material/fog.h"
#include "material/phase.h"
#include "math/affine.h"
#include "math/colour.h"
#include "math/ray.h"

#include <stdbool.h>
#include <stdint.h>

enum medium_ray {
    MEDIUM_RAY_SIGHT = 1,     /* camera rays and the reflected, refracted and hole rays that follow them */
    MEDIUM_RAY_SCATTERED = 2, /* of a path, that diffuse or rough lobes have scattered */
    MEDIUM_RAY_SHADOW = 4,    /* to a light; those of Whitted's integrator ask for no medium */
    MEDIUM_RAY_PHOTON = 8,    /* of a photon */
};

struct density;
struct heat;

/* The map from the world to the space of what is given by place, when the shutter opens and closes; between these,
 * points move straight. */
struct medium_placement {
    struct affine open, close;
};

struct medium {
    double ior;
    struct dispersion dispersion;  /* of the index */
    struct colour tint;            /* of light that passes the surface of the solid */
    const struct fog *fog;         /* or NULL; then nothing of the following */
    struct colour extinction;      /* absorption and scattering: the logarithm of light decreases by this per unit */
    struct colour scattering;      /* at most the extinction */
    struct colour emission;        /* radiance per unit */
    struct phase phase;            /* of scattering */
    const struct density *density; /* the factor of these three by place (density.h); NULL: 1 */
    const struct heat *heat;       /* the factor of the emission by place (glow.h); only with a density, or NULL */
    const struct medium_placement *placement; /* of these; NULL: the world */
    const struct medium *inner;               /* one more in the same solid, or NULL */
    bool scatters;                            /* scattering is not black */
    bool fills;                               /* inside of solids whose surface is invisible */
    bool mixed;                               /* with a density or others in the same place: medium_mix.h */
    unsigned affects; /* the set of enum medium_ray that do not pass it as if nothing were there */
};

/* Around all solids. fog: or NULL. */
struct medium medium_outside(const struct fog *fog);
/* One that absorbs, scatters and emits. */
struct medium_input {
    struct colour absorption, scattering, emission;
    struct phase phase;
    const struct density *density; /* or NULL */
    const struct heat *heat;       /* or NULL */
};
struct medium medium_scattering(const struct medium_input *in);
/* The same in solids whose surface is invisible. */
struct medium medium_filling(const struct medium_input *in);
/* That of such a solid around all solids. */
struct medium medium_without_solid(const struct medium *filling);
/* Adds what is in the same solid, which must outlive it. */
void medium_put_inside(struct medium *medium, const struct medium *inner);
/* The same inside of a solid with an index. */
struct medium medium_inside(double ior, struct colour tint, const struct medium_input *in);

/* The stack of media that contain a ray. Leaving a solid removes that solid wherever it is in the stack; the current
 * medium is the one entered last; outside of everything the index is 1. By value: a branch of the path copies and
 * changes it. */

enum { MEDIUM_STACK_LIMIT = 32 }; /* deeper nestings forget the outermost (docs/limits.md) */

/* The inside of one solid: number of its primitive, and of its medium. */
struct solid {
    uint32_t primitive, medium;
};

/* All solids that light passes, and their media. */
struct media {
    const struct solid *solids;
    struct medium *all;
    uint32_t outside; /* number of the medium around all solids */
};
#define SOLID_NONE UINT32_MAX

struct medium_stack {
    const struct media *media;
    uint32_t count;
    uint32_t solids[MEDIUM_STACK_LIMIT]; /* numbers */
    float wavelength;                    /* of the light in them, in micrometres; 0: white light */
};

/* A surface between two media, at the hit of a ray. */
struct medium_boundary {
    uint32_t solid;     /* on the inner side of the surface */
    double ior;         /* of its medium there */
    struct colour tint; /* of light that passes it */
    bool entering;      /* the ray comes from the outer side */
    bool thin;          /* a wall with the same medium on both sides: nothing is entered or left */
};

/* The medium of entry i of the stack. */
static inline const struct medium *medium_stack_at(const struct medium_stack *stack, uint32_t i) {
    return &stack->media->all[stack->media->solids[stack->solids[i]].medium];
}
/* That of the solid entered last; it may not be alone. */
static inline const struct medium *medium_stack_current(const struct medium_stack *stack) {
    return stack->count ? medium_stack_at(stack, stack->count - 1) : &stack->media->all[stack->media->outside];
}
/* Its index for a wavelength; 0: of white light. */
static inline double medium_ior(const struct medium *medium, double wavelength) {
    return wavelength > 0 ? dispersion_ior(medium->dispersion, medium->ior, wavelength) : medium->ior;
}
/* Whether nothing shows a surface between the current media of two stacks. */
bool medium_stacks_equal(const struct medium_stack *a, const struct medium_stack *b);
/* How many of the first `count` entries there are up to the last one that has a surface. */
static inline uint32_t medium_stack_below(const struct medium_stack *stack, uint32_t count) {
    while (count > 0 && medium_stack_at(stack, count - 1)->fills)
        count--;
    return count;
}
/* The index of refraction within the first `count` entries. */
static inline double medium_stack_ior_of(const struct medium_stack *stack, uint32_t count) {
    count = medium_stack_below(stack, count);
    return count ? medium_ior(medium_stack_at(stack, count - 1), (double)stack->wavelength) : 1;
}
static inline double medium_stack_ior(const struct medium_stack *stack) {
    return medium_stack_ior_of(stack, stack->count);
}

/* Only the entries in use. */
void medium_stack_copy(struct medium_stack *to, const struct medium_stack *from);
void medium_stack_enter(struct medium_stack *stack, uint32_t solid);
/* Removes the latest entry of the primitive of the solid; does nothing if there is none (an open surface, a camera on
 * it). */
void medium_stack_leave(struct medium_stack *stack, uint32_t solid);

/* Whether the ray is inside of the solid; SOLID_NONE: never. */
bool medium_stack_has(const struct medium_stack *stack, uint32_t solid);

/* Gives white light in these media a wavelength, by a number in [0, 1), and returns its weight (spectrum_sample). */
struct colour medium_stack_choose_wavelength(struct medium_stack *stack, double u);

/* The stack behind the surface. */
void medium_stack_cross(struct medium_stack *stack, const struct medium_boundary *boundary);
/* The index of refraction on the ray's side over the index behind the surface. */
double medium_stack_eta(const struct medium_stack *stack, const struct medium_boundary *boundary);

/* Whether a ray is affected where it starts, and so on its whole way. Rays without a stack are not. */
static inline bool medium_affects(enum medium_ray kind, const struct ray *ray) {
    return ray->media && (medium_stack_current(ray->media)->affects & kind);
}

/* Light that was `x` is transmittance * x + added after it. */
struct medium_effect {
    struct colour transmittance; /* 0..1 */
    struct colour added;         /* the light of the medium itself */
    struct colour source;        /* the same over an infinite distance, where that is finite */
};

/* From the ray's origin over a distance in world units (infinite: no hit), without random numbers: depths of a density
 * are a quadrature. False: the ray is not affected, and transmittance is 1. */
bool medium_transmittance(enum medium_ray kind, const struct ray *ray, double distance, struct medium_effect *out);

/* The largest radiance that it shows over a long distance. */
double medium_brightest(const struct medium *medium);
/* The radiance that a medium without fog adds over a distance, itself attenuated. */
struct colour medium_emission(const struct medium *medium, double distance);

/* The share of scattering in the extinction. */
struct colour medium_albedo(const struct medium *medium);

/* The way to the next event in a medium of this extinction. The channel whose extinction decides is chosen in
 * proportion to the throughput of the path; all channels use the way with one-sample multiple importance sampling
 * (Wilkie et al., "Hero Wavelength Spectral Sampling", 2014): so the sum of the throughput never grows. */
struct medium_flight {
    double distance;      /* may be infinite */
    struct colour shares; /* of the channels in the throughput */
};
struct medium_flight medium_fly(struct colour extinction, struct colour throughput, struct sample2 u);
/* The probability of passing a distance that is `left` of light, or the density of an event there: the mean over the
 * channels that may have been chosen. */
double medium_flight_chance(const struct medium_flight *flight, struct colour extinction, struct colour left,
                            bool event);

/* Where a path is scattered in a medium without fog. */
struct medium_sample {
    bool scatters; /* before the distance */
    double distance;
    struct colour weight; /* transmittance over the probability of coming this far; or with the colour of scattering,
                           over the density of the distance */
};
/* Samples over at most `distance` (may be infinite) in a medium that is alone and has no density. */
struct medium_sample medium_sample(const struct medium *medium, double distance, struct colour throughput,
                                   struct sample2 u);
/* What it points to (base/bundle.h). */
bundle_fields medium_bundle;

#endif
