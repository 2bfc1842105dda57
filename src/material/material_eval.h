/* From a hit to its surface: the inputs of the material (material_inputs_at), the side it is seen from, the boundary
 * between two media with Fresnel's shares, and the resulting lobes. */
#ifndef GRAY_MATERIAL_MATERIAL_EVAL_H
#define GRAY_MATERIAL_MATERIAL_EVAL_H

#include "material/bsdf.h"
#include "material/material.h"

/* Settings of the picture for all surfaces, and the observer. All zero: the defaults. */
struct material_context {
    enum specular_kind specular;
    bool ambient_plain;             /* the ambient colour is not multiplied by kd */
    bool total_reflection;          /* at total reflection, refracted light is reflected; else it is lost */
    bool no_black_highlight;        /* matte surfaces do not have a highlight with weight 0 */
    const struct bsdf_joint *joint; /* or NULL: no other surface is there */
    material_observer *observer;    /* called for every link of `authored`, or NULL */
    void *observer_context;
    bool thin;                       /* the surface is a wall without thickness, with the same medium on both sides */
    const struct material *authored; /* if observer is set: the material of the scene that `material` was made from */
};

/* media: those that contain the ray; NULL: none. A surface with opacity 0 has no lobes. */
void material_eval(const struct material *material, const struct hit *hit, const struct medium_stack *media,
                   const struct material_context *context, struct bsdf *out);

#endif
