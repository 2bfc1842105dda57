/* Rough surfaces as many small mirrors. */
#ifndef GRAY_MATERIAL_MICROFACET_INTERNAL_H
#define GRAY_MATERIAL_MICROFACET_INTERNAL_H

#include "math/sampling.h"
#include "math/vec3.h"

/* Normal of a facet visible from `view` (unit, on the normal's side), for a point of the unit square. alpha is the
 * width of the distribution of slopes, in (0, 1]. Unit, on the side of the normal and of the view. */
struct vec3 microfacet_normal(struct vec3 normal, struct vec3 view, double alpha, struct sample2 place);

/* The density of microfacet_normal per solid angle. */
double microfacet_pdf(struct vec3 normal, struct vec3 view, double alpha, struct vec3 facet);

/* Of light that visible facets send on, the share that leaves the surface at once: the masking of both directions over
 * that of the view. Cosines to the normal, of either side, in (0, 1]. */
double microfacet_escape(double cos_view, double cos_out, double alpha);

#endif
