/* See material_eval.h. Interpolated and turned normals follow the geometric one: where they lean so far that the ray
 * would be behind the surface, the geometric one takes their place. */
#include "material/material_eval.h"

#include "material/dielectric_internal.h"

static void add_lobe(struct bsdf *bsdf, enum lobe_kind kind, struct vec3 weight, double exponent) {
    struct lobe *lobe = &bsdf->lobes[bsdf->count++];
    lobe->kind = kind;
    lobe->weight = weight;
    lobe->exponent = exponent;
}

static void set_frame(const struct hit *hit, const struct surface_inputs *inputs, struct bsdf *bsdf) {
    bsdf->normal = inputs->normal;
    bsdf->lit = inputs->two_sided && !hit->front ? vec3_negate(inputs->normal) : inputs->normal;
    bsdf->dark = !hit->front && !inputs->two_sided;
    bsdf->geometric_side = hit->front ? hit->normal_geometric : vec3_negate(hit->normal_geometric);
    bsdf->side = hit->front ? inputs->normal : vec3_negate(inputs->normal);
    if (!(vec3_dot(bsdf->side, hit->view) > 0))
        bsdf->side = bsdf->geometric_side;
}

/* The relative index, whether light passes, and Fresnel's share of both amounts. */
static void set_boundary(const struct hit *hit, const struct medium_stack *media, struct surface_inputs *inputs,
                         struct bsdf *bsdf) {
    static const struct medium_stack air = {.count = 0};
    bsdf->eta = 1;
    bsdf->fresnel = -1;
    bsdf->fresnel_of_facets = inputs->fresnel && inputs->roughness > 0;
    bsdf->passes = false;
    if (!inputs->fresnel && inputs->refract == 0)
        return;
    bsdf->boundary.medium.primitive = hit->primitive;
    bsdf->boundary.medium.ior = inputs->has_ior ? inputs->ior : 1;
    bsdf->boundary.medium.absorption = inputs->absorption;
    bsdf->boundary.entering = hit->front;
    bsdf->eta = medium_stack_eta(media ? media : &air, &bsdf->boundary);
    bsdf->passes = bsdf_refract(bsdf, hit->view, &bsdf->through);
    if (inputs->fresnel) {
        inputs->reflect = dielectric_fresnel(vec3_dot(bsdf->side, hit->view), bsdf->eta);
        inputs->refract = 1 - inputs->reflect;
        bsdf->fresnel = inputs->reflect;
    }
}

static void set_lobes(const struct surface_inputs *inputs, const struct material_context *context, struct bsdf *bsdf) {
    bsdf->emission = inputs->emission;
    /* The square spreads the useful values over 0..1 (Burley, "Physically-Based Shading at Disney", 2012). */
    bsdf->alpha = inputs->roughness * inputs->roughness;
    bsdf->glossy_samples = inputs->glossy_samples;
    bool blinn = inputs->highlight == HIGHLIGHT_AS_SET ? context->specular == SPECULAR_BLINN
                                                       : inputs->highlight == HIGHLIGHT_BLINN;
    bool rough = bsdf->alpha > 0;
    if (inputs->unlit) {
        bsdf->emission = vec3_add(bsdf->emission, inputs->kd);
        bsdf->ambient = vec3_all(0);
    } else {
        bsdf->ambient = context->ambient_plain ? vec3_all(1) : inputs->kd;
        add_lobe(bsdf, LOBE_DIFFUSE, inputs->kd, 0);
        add_lobe(bsdf, blinn ? LOBE_BLINN : LOBE_PHONG, vec3_scale(inputs->ks, 1 - inputs->refract), inputs->shininess);
    }
    double reflect = bsdf->fresnel_of_facets ? 1 : inputs->reflect,
           refract = bsdf->fresnel_of_facets ? 1 : inputs->refract;
    if (reflect != 0)
        add_lobe(bsdf, rough ? LOBE_GGX_REFLECTION : LOBE_MIRROR, vec3_scale(inputs->ks, reflect), 0);
    if (refract != 0)
        add_lobe(bsdf, rough ? LOBE_GGX_TRANSMISSION : LOBE_REFRACTION, vec3_scale(inputs->ks, refract), 0);
}

void material_eval(const struct material *material, const struct hit *hit, const struct medium_stack *media,
                   const struct material_context *context, struct bsdf *out) {
    static const struct material_context defaults = {.observer = NULL};
    struct surface_inputs inputs;
    if (!context)
        context = &defaults;
    if (context->observer)
        material_inputs_observe(context->authored, hit, &inputs, context->observer, context->observer_context);
    else
        material_inputs_at(material, hit, &inputs);
    out->count = 0;
    out->albedo = inputs.kd;
    out->opacity = inputs.opacity;
    out->turns_back = context->total_reflection;
    set_frame(hit, &inputs, out);
    if (!(inputs.opacity > 0))
        return;
    set_boundary(hit, media, &inputs, out);
    set_lobes(&inputs, context, out);
}
