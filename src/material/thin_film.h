/* A film with the thickness of few wavelengths over a surface: light that is reflected by its two sides interferes (L.
 * Belcour and P. Barla, "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence", ACM TOG
 * 36, 2017). */
#ifndef GRAY_MATERIAL_THIN_FILM_H
#define GRAY_MATERIAL_THIN_FILM_H

#include "math/colour.h"

struct thin_film {
    double weight;     /* the share of the surface that has it; 0: no film, and nothing of the following */
    double thickness;  /* in micrometres */
    double ior;        /* in vacuum */
    double before;     /* the index of the medium on the side of the view */
    double wavelength; /* of the light, in micrometres; 0: white light */
};

/* The unpolarised reflectance of a boundary with the film for a cosine to the view in (0, 1]; eta = index on the view's
 * side / index behind both. Every component is in [0, 1]. */
struct colour thin_film_boundary(const struct thin_film *film, double cosine, double eta);
/* The same of both sides of a thin wall together; a wall of the index around it is the film alone. */
struct colour thin_film_pane(const struct thin_film *film, double cosine, double eta);
/* Of a metal that reflects `bare` for this cosine without the film. */
struct colour thin_film_metal(const struct thin_film *film, double cosine, struct colour bare);

#endif
