/* The parameters of OpenPBR Surface 1.1 (Academy Software Foundation, 2024,
 * https://academysoftwarefoundation.github.io/ OpenPBR) beside those that all materials have, and how they become
 * lobes. The inputs of a material hold base_color (kd), specular_color (ks), specular_roughness (roughness),
 * transmission_weight (refract), emission (luminance times colour) and opacity; bumps hold geometry_normal.
 * docs/language.md says what each parameter does. */
#ifndef GRAY_MATERIAL_OPENPBR_H
#define GRAY_MATERIAL_OPENPBR_H

#include "material/bsdf.h"
#include "material/material.h"

/* Numbers; inputs of the material with textures take their place at a hit. Immutable, in the arena of the script. */
struct openpbr {
    double base_weight, base_diffuse_roughness, base_metalness;
    double specular_weight, specular_anisotropy, specular_ior;
    struct colour transmission_colour;
    struct colour transmission_scattering; /* inside of the solid, per unit */
    double transmission_anisotropy;        /* mean cosine of that */
    double subsurface_weight, subsurface_radius, subsurface_anisotropy;
    struct colour subsurface_colour, subsurface_radius_scale;
    double coat_weight, coat_roughness, coat_anisotropy, coat_ior, coat_darkening;
    struct colour coat_colour;
    double fuzz_weight, fuzz_roughness;
    struct colour fuzz_colour;
    double film_weight, film_thickness, film_ior; /* the thickness in micrometres */
    bool deep;                                    /* transmission_depth is above 0: the colour is that of the inside */
    bool thin_walled;
    bool classic;                      /* Whitted's integrator shades it by numbers of gr.material (openpbr_classic) */
    struct vec3 tangent, coat_tangent; /* in the world; 0: along u */
};

/* The values of the specification where scripts state none. */
struct openpbr openpbr_defaults(void);

/* The index that Fresnel's formulas see: specular_weight scales the reflectance head on. */
double openpbr_ior(double ior, double specular_weight);

/* Makes a material, and the textures of its inputs, one of gr.material that looks like its layers, and never reflects
 * more light than arrives, if it wants that. Materials whose share of metal or of transmission is a texture keep their
 * layers; where the colour is one, the share of metal counts as all or nothing. */
struct surface_material;
void openpbr_classic(struct surface_material *material, const struct texture *textures[INPUT_COUNT]);

struct material_context;
struct surface_inputs;
struct surface_tables;
/* Reads the inputs that have a texture into a copy of the material's numbers. */
void openpbr_read(const struct surface_tables *tables, const struct surface_material *material, const struct hit *hit,
                  struct openpbr *values);
/* Fills the lobes, the emission and the boundary of a BSDF whose frame is set, by the material of the hit. media: of
 * the ray. */
void openpbr_eval(const struct surface_tables *tables, const struct hit *hit, const struct medium_stack *media,
                  const struct material_context *context, const struct surface_inputs *inputs, struct bsdf *bsdf);

#endif
