/* All light of a world for integrators that compute indirect light: the lights of the scene, and every primitive with
 * an emissive material as a light that can be sampled. It is built only for integrators that request it; Whitted's
 * direct light does not use it. Indices of lights: those of world->lights first, then the emissive primitives, then
 * the background if it lights the scene.
 *
 * Next-event estimation at a point (struct light_receiver):
 *     part = light_sampler_sample(&lights->sampler, point, normal, u, &pmf);
 *     if (part.light != LIGHT_NONE && world_lights_sample(lights, &receiver, part, xi, &sample))
 * Then a ray from receiver.from to sample.target, which skips sample.skip_primitive, determines how much light arrives.
 * If sample.decided is false, this is sample.radiance times world_lights_visible, with the ray's interval up to the
 * target. Otherwise it is world_lights_seen_by, with an infinite interval: the hit of the ray decides. The weight is
 * bsdf_eval / (pdf * pmf), times that of multiple importance sampling. With is_delta no other ray finds this light, and
 * the latter weight is 1.
 *
 * Scattered rays find light from: a surface (world_lights_radiance with world_lights_pdf_of_hit); lamps in front of it,
 * which do not block rays, so all of them count (world_lights_met_next with world_lights_pdf); and, without a surface,
 * each light of lights->sampler.infinite (light_emitted with world_lights_pdf). Camera rays and rays after smooth
 * surfaces find only the emission of the material, world_lights_seen and the background.
 *
 * Lists: a light with `lit` reaches no other primitives, whether sampled or hit; all functions here respect this. */
#ifndef GRAY_WORLD_WORLD_LIGHTS_H
#define GRAY_WORLD_WORLD_LIGHTS_H

#include "accel/box_tree.h"
#include "base/bundle.h"
#include "light/light_sampler.h"
#include "math/sampling.h"
#include "world/world.h"

/* The relation of a light to primitives. */
struct emitter {
    uint32_t primitive; /* the only primitive, or WORLD_NOTHING: none or several */
    uint32_t owner;     /* the mesh light over this moving primitive; LIGHT_NONE: none */
    bool shown;         /* hits of primitives are its own */
    bool by_triangle;   /* a mesh: the parts of the light are its triangles */
    bool decided; /* a ray decides: the emission varies, there are holes, or the light is only a bound of the emitter */
    bool unmet;   /* scattered rays do not hit it: a delta light */
    bool has_own; /* of gr.mesh_light: the emission that takes the place of the materials' */
    struct colour emission;        /* that one, or a factor */
    const struct light_box *bound; /* sampled in place of the light; NULL: none */
};

struct world_lights {
    const struct world *world;
    const struct light *lights;
    uint32_t count;
    struct light_sampler sampler;
    const struct emitter *emitters; /* by light */
    const uint32_t *of_primitive;   /* its light; LIGHT_NONE: it emits nothing, or only scattered rays find its light */
    struct box_tree surfaces;       /* over the lamps with a surface of their own; `area_lights` by item */
    const struct light_part *area_lights; /* of mesh lights that are not in the scene each triangle */
    uint32_t area_light_count;
    bool holes; /* something in the world has holes */
    bool met;   /* scattered rays may hit lights */
};

/* background: scattered rays hit the sky of the world, which is then one more light unless it is black; if the scene
 * has a sky light, they hit that instead. */
struct world_lights_options {
    bool background;
    enum light_choice choice;
};
/* Errors: no memory, cancelled; nothing is left to destroy then. */
bool world_lights_build(struct world_lights *out, const struct world *world, struct world_lights_options options,
                        struct arena *arena, struct pool *pool, struct error *error);
void world_lights_destroy(struct world_lights *lights);

/* What light is sampled for. */
struct light_receiver {
    struct vec3 point, from; /* from: where shadow rays start, next to it */
    struct vec3 normal;      /* shading; {0,0,0}: none */
    uint32_t primitive;      /* the primitive, or WORLD_NOTHING */
};

struct world_light_sample {
    struct vec3 direction;      /* unit, from the point */
    struct light_target target; /* of the shadow ray, from receiver.from */
    struct colour radiance;     /* where `decided` is false; of a delta light over pdf 1 */
    double pdf;                 /* by solid angle at the point, for this part; of a delta light 1 */
    bool is_delta;              /* no scattered ray finds this light */
    bool decided;
    uint32_t skip_primitive; /* for ray->skip_primitive of the shadow ray */
    uint32_t light, triangle;
};
/* False: nothing arrives from there. */
bool world_lights_sample(const struct world_lights *lights, const struct light_receiver *receiver,
                         struct light_part part, struct sample2 xi, struct world_light_sample *out);
/* The share of light that arrives along a shadow ray: holes let through what their opacity leaves. */
double world_lights_visible(const struct world_lights *lights, const struct ray *ray, struct world_scratch *scratch);
/* The radiance of a `decided` sample that arrives along the ray to it, including holes; *t: where the ray hits the
 * light. */
struct colour world_lights_seen_by(const struct world_lights *lights, const struct light_receiver *receiver,
                                   const struct world_light_sample *sample, const struct ray *ray,
                                   struct world_scratch *scratch, double *t);
/* Whether a hit is what a `decided` sample was of. */
bool world_lights_shows(const struct world_lights *lights, const struct world_light_sample *sample,
                        const struct hit *hit);

/* What a hit surface, whose material emits `emission` there, sends to a receiver on primitive `primitive`
 * (WORLD_NOTHING: none): with gr.mesh_light what that says of it. */
struct colour world_lights_radiance(const struct world_lights *lights, uint32_t primitive, const struct hit *hit,
                                    struct colour emission);
/* The density (by solid angle, times the probability of the light) with which samples for the receiver have this unit
 * direction and end at this hit; 0: only scattered rays find it. */
double world_lights_pdf_of_hit(const struct world_lights *lights, const struct light_receiver *receiver,
                               struct vec3 direction, const struct hit *hit);

/* The lamps with a surface of their own that a ray intersects in its interval, each once, in any order:
 *     world_lights_met_begin(&traversal, lights, &ray);
 *     while (world_lights_met_next(&traversal, &light, &hit)) ...
 * Their radiance is light_emitted. */
struct world_lights_traversal {
    const struct world_lights *lights;
    const struct ray *ray;
    struct box_tree_traversal tree;
};
void world_lights_met_begin(struct world_lights_traversal *traversal, const struct world_lights *lights,
                            const struct ray *ray);
bool world_lights_met_next(struct world_lights_traversal *traversal, uint32_t *light, struct light_hit *hit);
/* The nearest of them that is visible (light->visible); it hides objects behind it. False: none. */
bool world_lights_seen(const struct world_lights *lights, const struct ray *ray, uint32_t *light,
                       struct light_hit *hit);
/* The density of samples for the receiver (times the probability of the light) for a scattered ray of that unit
 * direction that hits that light, a lamp or an infinite one. */
double world_lights_pdf(const struct world_lights *lights, const struct light_receiver *receiver, uint32_t light,
                        struct vec3 direction, const struct light_hit *hit);
/* Whether a light reaches a primitive (WORLD_NOTHING: anything), by its lists. */
static inline bool world_lights_illuminate(const struct world_lights *lights, uint32_t light, uint32_t primitive) {
    const uint8_t *lit = lights->lights[light].lit;
    return !lit || primitive == WORLD_NOTHING || lit[primitive];
}
/* What they point to (base/bundle.h). */
bundle_fields world_lights_bundle;

#endif
