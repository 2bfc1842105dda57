/* Radiosity: the light that diffuse surfaces exchange, which does not depend on the camera. It is computed once and
 * stored at the vertices of patches, by progressive refinement: what has most light that is not yet shot shoots first
 * (M. Cohen, S. Chen, J. Wallace, D. Greenberg, "A progressive refinement approach to fast radiosity image generation",
 * SIGGRAPH 1988). Sides of vertices receive and shoot (J. Wallace, K. Elmquist, E. Haines, "A ray tracing algorithm for
 * progressive radiosity", SIGGRAPH 1989). Their form factors are shares of rays, so no row of them sums to more than 1,
 * and the largest light never grows. Light is in classic intensities (material/classic.h): a surface shows its diffuse
 * weight times the light. */
#ifndef GRAY_RADIOSITY_RADIOSITY_H
#define GRAY_RADIOSITY_RADIOSITY_H

#include "base/hash.h"
#include "formats/model_format.h"
#include "image/tone.h"
#include "math/colour.h"
#include "radiosity/patches.h"

#define SIDE_NONE UINT32_MAX

/* The front (number 2 v) or the back (2 v + 1) of vertex v. */
struct side_light {
    struct colour reflectance, light, unshot;
    double buried; /* share of its positions that are inside of other solids */
    double area;   /* 0: it reflects nothing, or there is no surface */
    double weight; /* 1 / number of its rays */
};

/* Who keeps solutions for later runs, and shows how far one is. */
struct radiosity_store {
    void *context;
    /* Adds the bytes of the solution with that digest, if there are any. NULL with `save`: none is kept. */
    bool (*load)(void *context, struct digest depends, struct list *bytes, struct error *error);
    void (*save)(void *context, struct digest depends, const struct list *bytes);
    _Atomic float *unshot; /* the share of light that is not yet shot; 0: nothing is computed */
};

struct radiosity;
/* The solution calls `grown` after each step. At the first call, all light comes directly from lights. Zero value: no
 * function is called. */
struct radiosity_watch {
    void (*grown)(void *context, const struct radiosity *radiosity);
    void *context;
};

/* Zero value: empty. Owner: the caller, radiosity_destroy. */
struct radiosity {
    struct patches patches;
    struct side_light *sides;            /* two for each vertex */
    size_t *first;                       /* by side, one more at the end: its receivers; dropped when it is solved */
    uint32_t *receivers;                 /* the sides whose rays meet it, as often as they do */
    double left;                         /* share of light that is not shot */
    struct digest digest;                /* of all that the solution depends on; zero: there is none */
    bool ready;                          /* it is that of the next picture, which resets this */
    struct radiosity_watch watch;        /* while it is solved */
    const struct radiosity_store *store; /* or NULL; borrowed, and stays when the rest is destroyed */
};

struct radiosity_input {
    const struct world *world;
    bool background;    /* the sky of the world lights the scene */
    uint32_t limit;     /* of patches */
    double error_share; /* of light that need not be shot */
    uint32_t rays;      /* of a side: a square, and a multiple of 64; 0: by the number of sides */
    uint64_t seed;
    struct pool *pool;
    struct radiosity_watch watch;
};

/* Patches, direct light and form factors. Errors: no surface is diffuse; an emitter without end (named); too many
 * triangles; no memory; cancelled. */
bool radiosity_prepare(struct radiosity *radiosity, const struct radiosity_input *input, struct error *error);
/* Shoots until this share of light is left. False: cancelled. */
bool radiosity_shoot(struct radiosity *radiosity, double error_share, struct pool *pool);
/* The same until it is solved: light from other surfaces, whose form factors have noise, becomes smooth. Then drops the
 * factors. Errors: no memory, cancelled. */
bool radiosity_finish(struct radiosity *radiosity, double error_share, struct pool *pool, struct error *error);
/* The solution of a world, computed only if it differs from the one that is there and from the one that was kept.
 * Errors: those of radiosity_prepare and of the store. */
bool radiosity_update(struct radiosity *radiosity, const struct radiosity_input *input, struct error *error);
/* The bytes of a solution, and back. False: no memory. Errors: no memory; they are no solution for the world;
 * cancelled. */
bool radiosity_write(const struct radiosity *radiosity, struct list *out);
bool radiosity_read(struct radiosity *out, const struct radiosity_input *input, const struct list *bytes,
                    struct error *error);
/* Names the primitives that reflect light but have no patches. */
void radiosity_warn(const struct world *world, world_warning *warn, void *context);
/* The patches as a PLY or GLB file: colours of vertices are the light that their fronts reflect, or else their backs,
 * for a display. False: no memory. */
bool radiosity_bake(const struct radiosity *radiosity, const struct tone *tone, enum model_format format,
                    struct list *out);
void radiosity_destroy(struct radiosity *radiosity);

/* The light that arrives at a hit, on the side of its view. False: there is no patch. */
bool radiosity_light(const struct radiosity *radiosity, const struct hit *hit, struct colour *light);

#endif
