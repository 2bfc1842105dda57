/* Rough surfaces as many small mirrors. */
#ifndef GRAY_MATERIAL_MICROFACET_INTERNAL_H
#define GRAY_MATERIAL_MICROFACET_INTERNAL_H

#include "math/sampling.h"
#include "math/vec3.h"

#include <stdbool.h>

/* The laws of a smooth boundary between two dielectrics. Directions are unit vectors that point away from the surface,
 * normals lie on the side of `view`; eta = index on view's side / index on the other side. */

struct vec3 dielectric_mirror(struct vec3 normal, struct vec3 view); /* 2 (n.v) n - v */
/* Snell's law. False: total internal reflection. */
bool dielectric_refract(struct vec3 normal, struct vec3 view, double eta, struct vec3 *out);
/* Unpolarised Fresnel reflectance; 1 beyond the critical angle. cos_view > 0. */
double dielectric_fresnel(double cos_view, double eta);
/* The mean of dielectric_fresnel over all directions of a hemisphere, with the cosine. */
double dielectric_fresnel_average(double eta);

/* Normal of a facet visible from `view` (unit, on the normal's side), for a point of the unit square. alpha is the
 * width of the distribution of slopes, in (0, 1]. Unit, on the side of the normal and of the view. */
struct vec3 microfacet_normal(struct vec3 normal, struct vec3 view, double alpha, struct sample2 xi);

/* The density of microfacet_normal per solid angle. */
double microfacet_pdf(struct vec3 normal, struct vec3 view, double alpha, struct vec3 facet);

/* Of light that visible facets send on, the share that leaves the surface at once: the masking of both directions over
 * that of the view. Cosines to the normal, of either side, in (0, 1]. */
double microfacet_escape(double cos_view, double cos_out, double alpha);

/* The same of surfaces whose slopes are wider along one tangent than along the other. */
struct facet_distribution {
    struct vec3 normal, along, across; /* a frame of unit vectors; the normal is on the side of the view */
    double alpha_along, alpha_across;  /* in (0, 1] */
};
struct vec3 facet_distribution_sample(const struct facet_distribution *facets, struct vec3 view, struct sample2 xi);
double facet_distribution_pdf(const struct facet_distribution *facets, struct vec3 view, struct vec3 facet);
/* Of either side of the surface. */
double facet_distribution_escape(const struct facet_distribution *facets, struct vec3 view, struct vec3 out);

#endif
