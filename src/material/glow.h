/* Media that emit light by place, as lights of next-event estimation: a cell is chosen by the power that it may emit,
 * and a point in it. Rays that meet the emission find the same light, so both are weighted by multiple importance
 * sampling; of rays an estimate of their density serves, since weights need only add up to 1. Only media whose density
 * or temperature has cells. */
#ifndef GRAY_MATERIAL_GLOW_H
#define GRAY_MATERIAL_GLOW_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/error.h"
#include "material/medium.h"

struct glow;

/* Of these media, which must outlive it; *out: NULL if it has none of them. Errors: no memory. */
bool glow_build(const struct glow **out, const struct medium *media, uint32_t count, struct arena *arena,
                struct error *error);

struct glow_sample {
    const struct medium *medium;
    struct vec3 point;
    double pdf; /* per volume */
};
/* At a ray's time. False: nothing is there. */
bool glow_sample(const struct glow *glow, double time, struct sample2 u, struct sample2 v, struct glow_sample *out);
/* The density of such samples at a point of one of the media. */
double glow_pdf(const struct glow *glow, const struct medium *medium, struct vec3 point, double time);

/* A ray that was scattered. */
struct glow_met {
    const struct glow *glow;
    struct vec3 from;
    double pdf; /* of its direction */
};
/* The weight of emission that the ray meets at a point; one less this is the weight of next-event estimation. */
double glow_met_weight(const struct glow_met *met, const struct medium *medium, struct vec3 point, double time);

/* Temperatures by place. Errors: no memory. */
struct heat;
struct density;
const struct heat *heat_make(struct arena *arena, const struct density *kelvin, struct error *error);
/* The light of a black body at a point of the density. */
struct colour heat_at(const struct heat *heat, struct vec3 p, double time);
/* density_fits. */
bool heat_fits(const struct heat *heat);
/* Where it is hottest. */
struct colour heat_brightest(const struct heat *heat);
/* Copies what *heat and *glow point to (base/bundle.h). */
void heat_bundle(struct bundle *bundle, const struct heat **heat);
void glow_bundle(struct bundle *bundle, const struct glow **glow);

#endif
