/* The end of a ray, where light is scattered: a point on a surface, whose BSDF answers, or in a medium, whose phase
 * function does. Directions are those of bsdf.h. */
#ifndef GRAY_MATERIAL_INTERACTION_H
#define GRAY_MATERIAL_INTERACTION_H

#include "material/bsdf.h"
#include "material/phase.h"

struct interaction {
    const struct bsdf *bsdf; /* of a surface, or NULL */
    uint32_t lobes;          /* that scatter; 1 in a medium */
    struct vec3 wo;
    const struct phase *phase; /* of a medium: the colour of scattering is in the weight of medium_sample */
};

/* f |cos wi| of some of the lobes that are not delta. */
static inline struct colour interaction_eval(const struct interaction *at, uint32_t lobes, enum bsdf_mode mode,
                                             struct vec3 wi) {
    if (at->bsdf)
        return bsdf_eval(at->bsdf, lobes, mode, at->wo, wi);
    return colour_all(lobes ? phase_eval(at->phase, at->wo, wi) : 0);
}

/* The density of interaction_sample's directions per solid angle, delta lobes aside. */
static inline double interaction_pdf(const struct interaction *at, struct vec3 wi) {
    return at->bsdf ? bsdf_pdf(at->bsdf, at->lobes, at->wo, wi) : phase_eval(at->phase, at->wo, wi);
}

/* A direction for a point of the unit square. False: none, which counts as black. */
static inline bool interaction_sample(const struct interaction *at, enum bsdf_mode mode, struct sample2 u,
                                      struct bsdf_sample *out) {
    if (at->bsdf)
        return bsdf_sample(at->bsdf, at->lobes, mode, at->wo, u, out);
    out->direction = phase_sample(at->phase, at->wo, u);
    out->weight = colour_all(1);
    out->pdf = phase_eval(at->phase, at->wo, out->direction);
    out->flags = 0;
    return true;
}

#endif
