/* From a hit to its surface: the inputs of the material (material_inputs_at), the side it is seen from, the boundary
 * between two media with Fresnel's shares, and the resulting lobes. */
#ifndef GRAY_MATERIAL_MATERIAL_EVAL_H
#define GRAY_MATERIAL_MATERIAL_EVAL_H

#include "geometry/hit.h"
#include "material/bsdf.h"
#include "material/surface_material.h"
#include "settings/settings.h"

/* The inputs at a hit; material_eval turns them into a BSDF. */
struct surface_inputs {
    struct colour kd, ks;
    double shininess, reflect, refract, ior;
    bool has_ior, two_sided;
    bool unlit;         /* kd is shown unchanged, without light */
    struct vec3 normal; /* unit, world, on the outward side: the hit's, or changed by bumps */
    double opacity;     /* of a surface with holes; objects behind it have the weight 1 - opacity */
    enum material_highlight highlight;
    struct colour emission;   /* added to reflected light */
    struct colour absorption; /* inside: the logarithm of light decreases by this per unit */
    double roughness;         /* of reflection and refraction; 0: a mirror */
    int glossy_samples;       /* N x N rays where it is rough; 0: the default */
    bool fresnel;             /* material_eval, which has the media, replaces reflect and refract by F and 1 - F */
};

/* Settings of the picture for all surfaces. All zero: the defaults. */
struct material_context {
    enum specular_kind specular;
    bool ambient_plain;             /* the ambient colour is not multiplied by kd */
    bool total_reflection;          /* at total reflection, refracted light is reflected; else it is lost */
    bool no_black_highlight;        /* matte surfaces do not have a highlight with weight 0 */
    bool walks;                     /* light may come out elsewhere than it goes under a surface (LOBE_SUBSURFACE) */
    const struct bsdf_joint *joint; /* or NULL: no other surface is there */
    bool thin;                      /* the surface is a wall without thickness, with the same medium on both sides */
};

void material_inputs_at(const struct surface_tables *tables, const struct surface_material *material,
                        const struct hit *hit, struct surface_inputs *out);
/* By the material of the hit. media: those that contain the ray; NULL: none. A surface with opacity 0 has no lobes. */
void material_eval(const struct surface_tables *tables, const struct hit *hit, const struct medium_stack *media,
                   const struct material_context *context, struct bsdf *out);

/* Where light comes out from under a surface: seen from outside, with the white lobe of Lambert alone. */
void material_eval_matt(const struct surface_tables *tables, struct hit *hit, struct bsdf *out);

/* Is called for every material of a chain, from the base on, with its inputs. */
typedef void material_observer(void *context, const struct material *link, const struct surface_inputs *inputs);
/* For pixel traces: what material_eval of this context reads, and the links below, which it makes tables of. False: no
 * memory. authored: the material of the scene that the one of the hit was made from. */
bool material_observe(const struct surface_tables *tables, const struct hit *hit, const struct material *authored,
                      const struct material_context *context, material_observer *observer, void *observer_context);

#endif
