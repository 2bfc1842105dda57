/* The lobes of layered materials, which bsdf.h lists: rough diffuse surfaces, fuzz, gloss, metal, glass and thin walls
 * with facets, and light that is scattered by more than one facet. bsdf.c calls them. */
#ifndef GRAY_MATERIAL_ROUGH_LOBES_INTERNAL_H
#define GRAY_MATERIAL_ROUGH_LOBES_INTERNAL_H

#include "material/bsdf.h"

/* f |cos wi| over the weight, as light; transmission by the rules of IMPORTANCE. */
double rough_lobe_eval(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 wi);
/* The weight, with the colour that facets of metal give to this pair of directions. */
struct colour rough_lobe_weight(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 wi);
double rough_lobe_pdf(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 wi);
/* Of a lobe of facets: eval / pdf for its samples. */
double rough_lobe_share(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 wi);
/* False: lost, below the surface or in it. */
bool rough_lobe_sample(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct sample2 u,
                       struct vec3 *direction, bool *transmits);

/* Facets of a roughness between 0 and 1 (not 0) and an anisotropy in [0, 1] (0: none; OpenPBR Surface 1.1) about a
 * frame; `along` has any length and is turned into the surface: 0 for any tangent. One of the four functions below
 * then sets how they reflect and transmit; those of a boundary alone are for opaque surfaces. */
void bsdf_facets_shape(struct bsdf_facets *facets, struct vec3 normal, struct vec3 along, double roughness,
                       double anisotropy);
void bsdf_facets_boundary(struct bsdf_facets *facets, double eta);
void bsdf_facets_glass(struct bsdf_facets *facets, double eta);
void bsdf_facets_pane(struct bsdf_facets *facets, double eta);
/* f0: reflectance head on; tint: the reflectance at the cosine 1/7 over that of Schlick's formula. */
void bsdf_facets_metal(struct bsdf_facets *facets, struct colour f0, struct colour tint);

/* Sets the shares of light from the view: what facets of a boundary reflect, and what neither leaves by the first facet
 * nor passes through it (not for boundaries of opaque surfaces). Before the lobes are evaluated. */
void bsdf_facets_see(struct bsdf_facets *facets, struct vec3 view);

/* The same of a boundary below a film: what facets reflect. *lack: lack_seen of each channel over its mean. */
struct colour bsdf_facets_see_film(struct bsdf_facets *facets, const struct thin_film *film, struct vec3 view,
                                   struct colour *lack);

/* The reflectance of metal at a facet for this cosine to the view, and its mean over a hemisphere, weighted with the
 * cosine. */
struct colour bsdf_metal_fresnel(const struct bsdf_facets *facets, double cosine);
struct colour bsdf_metal_fresnel_average(const struct bsdf_facets *facets);
/* Of both sides of a thin wall together, of one side's reflectance: 2 F / (1 + F). */
static inline double bsdf_pane_reflectance(double fresnel) {
    return 2 * fresnel / (1 + fresnel);
}

/* Rough diffuse surfaces (LOBE_OREN_NAYAR): the colour of the light that is reflected more than once, for the weight of
 * LOBE_OREN_NAYAR_MULTIPLE, of the colour of the surface. */
struct colour bsdf_oren_nayar_multiple(struct colour colour, double roughness);

#endif
