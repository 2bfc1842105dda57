/* Lobes by purpose: what integrators ask of a surface in place of reading its list. */
#ifndef GRAY_MATERIAL_BSDF_SELECT_H
#define GRAY_MATERIAL_BSDF_SELECT_H

#include "material/bsdf.h"

enum bsdf_purpose {
    /* Light that a path scatters. A highlight represents the mirror image of lights: it is left out if traced lobes
     * show that image. */
    BSDF_FOR_PATHS,
    /* Highlights beside smooth traced lobes: they reflect the lights that no ray can hit. */
    BSDF_FOR_UNSEEN_LIGHTS,
    /* Light of photons; none on surfaces that store no photons (photon_trace.c). */
    BSDF_FOR_PHOTONS,
    /* The kinds of scattering of render layers; each lobe is in one of them. */
    BSDF_FOR_DIFFUSE,
    BSDF_FOR_SPECULAR,
    BSDF_FOR_TRANSMISSION,
};
uint32_t bsdf_select_of_many(const struct bsdf *bsdf, enum bsdf_purpose purpose);
/* Most surfaces have one lobe, which paths use unless it is black. */
static inline uint32_t bsdf_select(const struct bsdf *bsdf, enum bsdf_purpose purpose) {
    if (bsdf->count == 1 && purpose <= BSDF_FOR_UNSEEN_LIGHTS)
        return purpose == BSDF_FOR_PATHS && colour_max_abs(bsdf->lobes[0].weight) > 0;
    return bsdf_select_of_many(bsdf, purpose);
}

/* Whether no lobe of the set scatters the light of a sampled light: each has one direction only. */
static inline bool bsdf_is_smooth(const struct bsdf *bsdf, uint32_t lobes) {
    if (lobes == 0)
        return true;
    return (lobe_flags(bsdf->lobes[0].kind) & BSDF_DELTA) && !(lobes & ~bsdf_lobes_with(bsdf, BSDF_DELTA));
}

/* The sum of the weights of a set of lobes, from which it removes black ones. *lambert: all others are Lambert's. */
struct colour bsdf_weight_of(const struct bsdf *bsdf, uint32_t *lobes, bool *lambert);
/* The light of all sides that diffuse lobes reflect; black on dark sides. */
struct colour bsdf_diffuse(const struct bsdf *bsdf);
/* The largest component of the light that Lambert's lobe reflects. */
double bsdf_lambert(const struct bsdf *bsdf);
/* Whether a branch is a rough lobe of a layered material. */
bool bsdf_branch_is_layered(const struct bsdf *bsdf, const struct bsdf_branch *branch);

/* A surface as guides of denoisers show it. */
struct bsdf_guide {
    struct colour albedo;        /* `glow`, and the weights without highlights */
    double reflected, refracted; /* the largest components of these parts of it, summed over lobes */
    bool scatters;               /* in more than single directions */
};
struct bsdf_guide bsdf_guide(const struct bsdf *bsdf, struct colour glow);

/* The same surface with a white Lambert lobe alone, without ambient light. */
struct bsdf bsdf_matt_copy(const struct bsdf *bsdf);
/* Its highlights alone; *colour: the sum of their weights. */
struct bsdf bsdf_shiny_copy(const struct bsdf *bsdf, struct colour *colour);

#endif
