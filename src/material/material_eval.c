/* From a hit to a BSDF. Without textures the inputs are a copy of the material's numbers, field by field: clearing the
 * whole struct would take longer than all the rest. Textures use the point in the object space of the operand that made
 * the surface, so they stick to the object. If an interpolated or bumped normal is tilted so far that the ray would be
 * behind the surface, the geometric one is used. */
#include "material/material_eval.h"

#include "material/bump.h"
#include "material/microfacet_internal.h"
#include "material/rough_lobes_internal.h"

static void copy_numbers(const struct phong *numbers, struct surface_inputs *out) {
    out->kd = numbers->kd;
    out->ks = numbers->ks;
    out->shininess = numbers->shininess;
    out->reflect = numbers->reflect;
    out->refract = numbers->refract;
    out->ior = numbers->ior;
    out->has_ior = numbers->has_ior;
    out->two_sided = numbers->two_sided;
    out->unlit = numbers->unlit;
    out->opacity = 1;
    out->highlight = numbers->highlight;
    out->emission = numbers->emission;
    out->absorption = numbers->absorption;
    out->roughness = numbers->roughness;
    out->glossy_samples = numbers->glossy_samples;
}

static void read_colour(uint32_t program, struct texture_reader *reader, struct colour *out) {
    if (program != TEXTURE_NONE)
        *out = texture_read(program, reader);
}

static void read_number(uint32_t program, struct texture_reader *reader, double *out) {
    if (program != TEXTURE_NONE)
        *out = texture_read(program, reader).r;
}

void material_inputs_at(const struct surface_tables *tables, const struct surface_material *material,
                        const struct hit *hit, struct surface_inputs *out) {
    const uint32_t *inputs = material->inputs;
    struct texture_reader reader;
    copy_numbers(&material->phong, out);
    out->normal = hit->normal;
    out->fresnel = material->fresnel;
    if (material->plain)
        return;
    texture_reader_init(&reader, hit, &tables->textures, &material->phong);
    read_colour(inputs[INPUT_KD], &reader, &out->kd);
    read_colour(inputs[INPUT_KS], &reader, &out->ks);
    read_number(inputs[INPUT_SHININESS], &reader, &out->shininess);
    read_number(inputs[INPUT_REFLECT], &reader, &out->reflect);
    read_number(inputs[INPUT_REFRACT], &reader, &out->refract);
    read_number(inputs[INPUT_ROUGHNESS], &reader, &out->roughness);
    read_colour(inputs[INPUT_EMISSION], &reader, &out->emission);
    read_number(inputs[INPUT_OPACITY], &reader, &out->opacity);
    bump_turn_normal(tables, material, hit, &out->normal);
}

static void add_lobe(struct bsdf *bsdf, enum lobe_kind kind, struct colour weight, double exponent) {
    struct lobe *lobe = &bsdf->lobes[bsdf->count++];
    lobe->kind = kind;
    lobe->weight = weight;
    lobe->exponent = exponent;
    lobe->share = 0;
    lobe->facets = 0;
}

static inline void set_frame(const struct hit *hit, const struct surface_inputs *inputs, struct bsdf *bsdf) {
    bsdf->normal = inputs->normal;
    bsdf->lit = inputs->two_sided && !hit->front ? vec3_negate(inputs->normal) : inputs->normal;
    bsdf->dark = !hit->front && !inputs->two_sided;
    bsdf->geometric_side = hit->front ? hit->normal_geometric : vec3_negate(hit->normal_geometric);
    bsdf->side = hit->front ? inputs->normal : vec3_negate(inputs->normal);
    if (!(vec3_dot(bsdf->side, hit->view) > 0))
        bsdf->side = bsdf->geometric_side;
}

/* A thin wall: both of its sides together. Light that passes keeps its direction, about which facets spread it. */
static void set_pane(const struct hit *hit, double eta, const struct surface_inputs *inputs, struct bsdf *bsdf) {
    bsdf->transmits = true;
    bsdf->through = vec3_negate(hit->view);
    if (!(inputs->roughness > 0))
        return;
    bsdf_facets_shape(&bsdf->facets[0], bsdf->side, vec3_all(0), inputs->roughness, 0);
    bsdf_facets_pane(&bsdf->facets[0], inputs->fresnel ? eta : 1);
}

/* The relative index, whether light is transmitted, and Fresnel's share of both amounts. */
static void set_boundary(const struct hit *hit, const struct medium_stack *media,
                         const struct material_context *context, struct surface_inputs *inputs, struct bsdf *bsdf) {
    static const struct medium_stack air = {.count = 0};
    const struct bsdf_joint *joint = context->joint;
    bsdf->eta = 1;
    bsdf->fresnel = -1;
    bsdf->fresnel_of_facets = inputs->fresnel && inputs->roughness > 0;
    bsdf->transmits = bsdf->passes = false;
    if (!inputs->fresnel && inputs->refract == 0)
        return;
    bsdf->passes = true;
    bsdf->behind = joint ? joint->behind : NULL;
    bsdf->roughness = colour_max_abs(inputs->kd) > 0 ? 2 : inputs->roughness;
    bsdf->boundary.solid = hit->solid;
    bsdf->boundary.ior = inputs->has_ior ? inputs->ior : 1;
    bsdf->boundary.tint = inputs->fresnel ? inputs->ks : colour_scale(inputs->ks, inputs->refract);
    bsdf->boundary.entering = hit->front;
    bsdf->boundary.thin = context->thin;
    double eta;
    media = media ? media : &air;
    if (context->thin) {
        eta = medium_stack_ior(media) / bsdf->boundary.ior;
        set_pane(hit, eta, inputs, bsdf);
    } else {
        bsdf->eta = eta = joint ? joint->eta : medium_stack_eta(media, &bsdf->boundary);
        bsdf->transmits = bsdf_refract(bsdf, hit->view, &bsdf->through);
    }
    if (inputs->fresnel) {
        double reflected = dielectric_fresnel(vec3_dot(bsdf->side, hit->view), eta);
        inputs->reflect = context->thin ? bsdf_pane_reflectance(reflected) : reflected;
        inputs->refract = 1 - inputs->reflect;
        bsdf->fresnel = inputs->reflect;
    }
}

/* Reflection and transmission by rough walls without thickness; the facets are those of set_pane. */
static void add_rough_pane(const struct surface_inputs *inputs, double reflect, double refract, struct bsdf *bsdf) {
    if (reflect != 0)
        add_lobe(bsdf, inputs->fresnel ? LOBE_GLOSS : LOBE_GGX_REFLECTION, colour_scale(inputs->ks, reflect), 0);
    add_lobe(bsdf, LOBE_PANE, colour_scale(inputs->ks, refract), 0);
    if (!inputs->fresnel)
        return;
    bsdf->lobes[bsdf->count - 2].share = math_max(bsdf->fresnel, 1.0 / 16);
    bsdf->lobes[bsdf->count - 1].share = math_max(1 - bsdf->fresnel, 1.0 / 16);
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
        bsdf->emission = colour_add(bsdf->emission, inputs->kd);
        bsdf->ambient = colour_all(0);
    } else {
        bsdf->ambient = context->ambient_plain ? colour_all(1) : inputs->kd;
        add_lobe(bsdf, LOBE_DIFFUSE, inputs->kd, 0);
        add_lobe(bsdf, blinn ? LOBE_BLINN : LOBE_PHONG, colour_scale(inputs->ks, 1 - inputs->refract),
                 inputs->shininess);
    }
    double reflect = bsdf->fresnel_of_facets ? 1 : inputs->reflect,
           refract = bsdf->fresnel_of_facets ? 1 : inputs->refract;
    if (rough && refract != 0 && bsdf->boundary.thin) {
        add_rough_pane(inputs, reflect, refract, bsdf);
        return;
    }
    if (reflect != 0)
        add_lobe(bsdf, rough ? LOBE_GGX_REFLECTION : LOBE_MIRROR, colour_scale(inputs->ks, reflect), 0);
    if (refract != 0)
        add_lobe(bsdf, rough ? LOBE_GGX_TRANSMISSION : LOBE_REFRACTION, colour_scale(inputs->ks, refract), 0);
}

/* Whether the surface has only a diffuse lobe, and every input is a number. */
static bool is_matte(const struct surface_material *material, const struct phong *numbers) {
    return material->plain && !material->has_layers && !material->fresnel && !numbers->unlit && numbers->reflect == 0 &&
           numbers->refract == 0 && colour_max_abs(numbers->ks) == 0;
}

/* The same as material_eval of such a material. */
static void eval_matte(const struct phong *numbers, const struct hit *hit, const struct material_context *context,
                       struct bsdf *out) {
    struct surface_inputs inputs;
    inputs.normal = hit->normal;
    inputs.two_sided = numbers->two_sided;
    set_frame(hit, &inputs, out);
    out->count = 0;
    add_lobe(out, LOBE_DIFFUSE, numbers->kd, 0);
    out->albedo = numbers->kd;
    out->ambient = context->ambient_plain ? colour_all(1) : numbers->kd;
    out->emission = numbers->emission;
    out->opacity = out->eta = 1;
    out->alpha = numbers->roughness * numbers->roughness;
    out->glossy_samples = numbers->glossy_samples;
    out->fresnel = -1;
    out->fresnel_of_facets = out->transmits = out->passes = false;
    out->turns_back = context->total_reflection;
}

void material_eval_matt(const struct surface_tables *tables, struct hit *hit, struct bsdf *out) {
    static const struct phong white = {.kd = {1, 1, 1}, .two_sided = true};
    static const struct material_context context = {.total_reflection = true};
    const struct surface_material *material = &tables->materials[hit->material];
    struct hit own = *hit;
    hit->front = own.front = true;
    hit->view = own.view = hit->normal_geometric;
    bump_turn_normal(tables, material, hit, &own.normal);
    eval_matte(&white, &own, &context, out);
}

/* The other surfaces of a joint tint what passes. */
static void tint_passing(const struct bsdf_joint *joint, struct bsdf *bsdf) {
    for (int i = 0; joint && i < bsdf->count; i++)
        if (lobe_flags(bsdf->lobes[i].kind) & BSDF_TRANSMITS)
            bsdf->lobes[i].weight = colour_mul(bsdf->lobes[i].weight, joint->tint);
}

void material_eval(const struct surface_tables *tables, const struct hit *hit, const struct medium_stack *media,
                   const struct material_context *context, struct bsdf *out) {
    static const struct material_context defaults = {.thin = false};
    const struct surface_material *material = &tables->materials[hit->material];
    struct surface_inputs inputs;
    if (!context)
        context = &defaults;
    if (context->no_black_highlight && is_matte(material, &material->phong)) {
        eval_matte(&material->phong, hit, context, out);
        return;
    }
    material_inputs_at(tables, material, hit, &inputs);
    out->count = 0;
    out->albedo = inputs.kd;
    out->opacity = inputs.opacity;
    out->turns_back = context->total_reflection;
    set_frame(hit, &inputs, out);
    if (!(inputs.opacity > 0))
        return;
    if (material->has_layers) {
        openpbr_eval(tables, hit, media, context, &inputs, out);
        out->ambient = context->ambient_plain ? colour_all(1) : out->albedo;
    } else {
        if (media && media->wavelength > 0)
            inputs.ior = dispersion_ior(material->phong.dispersion, inputs.ior, (double)media->wavelength);
        set_boundary(hit, media, context, &inputs, out);
        set_lobes(&inputs, context, out);
    }
    tint_passing(context->joint, out);
}

/* --- observers --- */

bool material_observe(const struct surface_tables *tables, const struct hit *hit, const struct material *authored,
                      const struct material_context *context, material_observer *observer, void *observer_context) {
    const struct surface_material *material = &tables->materials[hit->material];
    const struct material *chain[MATERIAL_DEPTH];
    struct surface_tables below;
    struct surface_inputs inputs;
    struct arena arena = {.head = NULL};
    uint32_t depth = 0;
    bool replaced = !material->has_layers && authored->openpbr; /* by openpbr_classic */
    if (context->no_black_highlight && is_matte(material, &material->phong))
        return true;
    /* The links below the material are in no table of the world. */
    for (const struct material *link = authored->base; link && !replaced && depth < MATERIAL_DEPTH; link = link->base)
        chain[depth++] = link;
    bool ok = depth == 0 || surface_tables_build(&below, chain, depth, false, &arena, NULL);
    for (uint32_t i = ok ? depth : 0; i-- > 0;) {
        material_inputs_at(&below, &below.materials[i], hit, &inputs);
        observer(observer_context, chain[i], &inputs);
    }
    arena_destroy(&arena);
    material_inputs_at(tables, material, hit, &inputs);
    observer(observer_context, authored, &inputs);
    return ok;
}
