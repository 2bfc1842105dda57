/* All media in which a ray is, and light along it where there are several, or one with a density: tracking that
 * takes each place with the right probability (delta tracking and ratio tracking: Woodcock et al. 1965; Novak et al.,
 * "Monte Carlo Methods for Volumetric Light Transport Simulation", 2018). Steps are those of a constant medium with the
 * bounds of all densities in the cells that the ray crosses. */
#ifndef GRAY_MATERIAL_MEDIUM_MIX_H
#define GRAY_MATERIAL_MEDIUM_MIX_H

#include "material/density.h"
#include "material/glow.h"
#include "material/medium.h"

enum { MEDIUM_MIX_LIMIT = 8 }; /* the outermost beyond that do not count (docs/limits.md) */

struct medium_mix {
    uint32_t count;
    const struct medium *media[MEDIUM_MIX_LIMIT]; /* that affect light; innermost first. A fog is alone */
};
void medium_stack_mix(const struct medium_stack *stack, struct medium_mix *out);
/* Whether one of them scatters. */
bool medium_mix_scatters(const struct medium_mix *mix);

/* A point and a line where the density of the medium is; t remains that of the line. */
struct vec3 medium_placement_point(const struct medium_placement *placement, struct vec3 p, double time);
struct medium_line medium_placement_line(const struct medium_placement *placement, const struct medium_line *line);
/* Whether its density or temperature is to fill the box of a solid. */
bool medium_needs_solid(const struct medium *medium);
/* The factor of the coefficients of a medium at a point. */
double medium_density(const struct medium *medium, struct vec3 p, double time);
/* What it emits there per unit, where its density is this one. */
struct colour medium_emission_at(const struct medium *medium, double density, struct vec3 p, double time);

/* What happens to a path along a line. */
struct medium_track {
    const struct medium *scatterer; /* the one that scatters it after `distance`; NULL: it comes to the end */
    double distance;
    struct colour weight;  /* as that of medium_sample */
    struct colour emitted; /* the light of the media, for a path of weight 1 */
};
/* The random numbers: u, then those of the key. */
struct medium_draw {
    struct sample2 u;
    uint64_t key;
    const struct glow_met *met; /* weights the emission against next-event estimation; or NULL */
};
/* At most along the line; the mix has no fog. */
void medium_mix_track(const struct medium_mix *mix, const struct medium_line *line, struct colour throughput,
                      struct medium_draw draw, struct medium_track *out);
/* An estimate, which depends on nothing else, of the density with which a path is scattered at the end of the line. */
double medium_mix_density(const struct medium_mix *mix, const struct medium_line *line, struct colour throughput);
/* What is left of light along the line: in the mean over the keys. */
struct colour medium_mix_left(const struct medium_mix *mix, const struct medium_line *line, uint64_t key);

/* The mean extinction, without that of functions and grids. */
double medium_mix_haze(const struct medium_mix *mix);

/* The same without random numbers: depths of a density are a quadrature. */
struct colour medium_mix_dimmed(const struct medium_mix *mix, const struct medium_line *line);

/* The same as medium_transmittance for a ray of this kind, but with a random transmittance. */
struct colour medium_ray_left(enum medium_ray kind, const struct ray *ray, double distance, uint64_t key);

#endif
