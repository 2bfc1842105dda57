/* See material_eval.h. Interpolated and turned normals follow the geometric one: where they lean so far that the ray
 * would be behind the surface, the geometric one takes their place. */
#include "material/material_eval.h"

#include "material/dielectric.h"

static void add_lobe(struct bsdf *bsdf, enum lobe_kind kind, struct vec3 weight, double exponent) {
    struct lobe *lobe = &bsdf->lobes[bsdf->count++];
    lobe->kind = kind;
    lobe->weight = weight;
    lobe->exponent = exponent;
}

static void set_frame(const struct hit *hit, const struct surface_look *look, struct bsdf *bsdf) {
    bsdf->normal = look->normal;
    bsdf->lit = look->two_sided && !hit->front ? vec3_negate(look->normal) : look->normal;
    bsdf->dark = !hit->front && !look->two_sided;
    bsdf->geometric_side = hit->front ? hit->normal_geometric : vec3_negate(hit->normal_geometric);
    bsdf->side = hit->front ? look->normal : vec3_negate(look->normal);
    if (!(vec3_dot(bsdf->side, hit->view) > 0))
        bsdf->side = bsdf->geometric_side;
}

/* The relative index, whether light passes, and Fresnel's share of both amounts. */
static void set_boundary(const struct hit *hit, const struct medium_stack *media, struct surface_look *look,
                         struct bsdf *bsdf) {
    static const struct medium_stack air = {.count = 0};
    bsdf->eta = 1;
    bsdf->fresnel = -1;
    bsdf->fresnel_of_facets = look->fresnel && look->roughness > 0;
    bsdf->passes = false;
    if (!look->fresnel && look->refract == 0)
        return;
    bsdf->boundary.medium.placed = hit->placed;
    bsdf->boundary.medium.ior = look->has_ior ? look->ior : 1;
    bsdf->boundary.medium.absorption = look->absorption;
    bsdf->boundary.entering = hit->front;
    bsdf->eta = medium_stack_eta(media ? media : &air, &bsdf->boundary);
    bsdf->passes = bsdf_refract(bsdf, hit->view, &bsdf->through);
    if (look->fresnel) {
        look->reflect = dielectric_fresnel(vec3_dot(bsdf->side, hit->view), bsdf->eta);
        look->refract = 1 - look->reflect;
        bsdf->fresnel = look->reflect;
    }
}

static void set_lobes(const struct surface_look *look, const struct material_context *context, struct bsdf *bsdf) {
    bsdf->emission = look->emission;
    /* The square spreads the useful values over 0..1 (Burley, "Physically-Based Shading at Disney", 2012). */
    bsdf->alpha = look->roughness * look->roughness;
    bsdf->glossy_samples = look->glossy_samples;
    bool blinn =
        look->highlight == HIGHLIGHT_AS_SET ? context->specular == SPECULAR_BLINN : look->highlight == HIGHLIGHT_BLINN;
    bool rough = bsdf->alpha > 0;
    if (look->unlit) {
        bsdf->emission = vec3_add(bsdf->emission, look->kd);
        bsdf->ambient = vec3_all(0);
    } else {
        bsdf->ambient = context->ambient_plain ? vec3_all(1) : look->kd;
        add_lobe(bsdf, LOBE_DIFFUSE, look->kd, 0);
        add_lobe(bsdf, blinn ? LOBE_BLINN : LOBE_PHONG, vec3_scale(look->ks, 1 - look->refract), look->shininess);
    }
    double reflect = bsdf->fresnel_of_facets ? 1 : look->reflect, refract = bsdf->fresnel_of_facets ? 1 : look->refract;
    if (reflect != 0)
        add_lobe(bsdf, rough ? LOBE_GGX_REFLECTION : LOBE_MIRROR, vec3_scale(look->ks, reflect), 0);
    if (refract != 0)
        add_lobe(bsdf, rough ? LOBE_GGX_TRANSMISSION : LOBE_REFRACTION, vec3_scale(look->ks, refract), 0);
}

void material_eval(const struct material *material, const struct hit *hit, const struct medium_stack *media,
                   const struct material_context *context, struct bsdf *out) {
    static const struct material_context defaults = {.told = NULL};
    struct surface_look look;
    if (!context)
        context = &defaults;
    if (context->told)
        material_look_told(context->authored, hit, &look, context->told, context->told_to);
    else
        material_look(material, hit, &look);
    out->count = 0;
    out->albedo = look.kd;
    out->opacity = look.opacity;
    out->turns_back = context->total_reflection;
    set_frame(hit, &look, out);
    if (!(look.opacity > 0))
        return;
    set_boundary(hit, media, &look, out);
    set_lobes(&look, context, out);
}
