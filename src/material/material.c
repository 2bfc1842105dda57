/* Evaluating the inputs of a material. Without textures the result is a copy of the material's numbers, field by field:
 * clearing the whole struct would take longer than all the rest. Textures use the point in the object space of the
 * operand that made the surface, so they stick to the object. */
#include "material/material.h"

#include "material/bump.h"
#include "material/material_eval.h"
#include "material/microfacet_internal.h"
#include "material/openpbr.h"
#include "material/rough_lobes_internal.h"

const struct material *material_origin(const struct material *material) {
    return material->origin ? material->origin : material;
}

static const struct phong *numbers_of(const struct material *material) {
    return &material_origin(material)->phong;
}

struct material material_flatten(const struct material *material, bool classic) {
    struct material out = *material;
    out.phong = *numbers_of(material);
    if (classic && out.openpbr)
        openpbr_classic(&out);
    out.base = out.origin = NULL;
    out.older = NULL;
    out.name = NULL;
    out.serial = 0;
    out.depth = 1;
    out.plain = false;
    return out;
}

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

static void read_colour(union texture_ref input, struct texture_reader *reader, struct vec3 *out) {
    const struct texture *texture = texture_at(reader->textures, input);
    if (texture)
        *out = texture_read_colour(texture, reader);
}

static void read_number(union texture_ref input, struct texture_reader *reader, double *out) {
    const struct texture *texture = texture_at(reader->textures, input);
    if (texture)
        *out = texture_read_scalar(texture, reader);
}

void material_inputs_at(const struct material *material, const struct hit *hit, struct surface_inputs *out) {
    const union texture_ref *inputs = material->inputs;
    struct texture_reader reader;
    copy_numbers(numbers_of(material), out);
    out->normal = hit->normal;
    out->fresnel = material->fresnel;
    if (material->plain)
        return;
    texture_reader_init(&reader, hit, material->textures, numbers_of(material));
    read_colour(inputs[INPUT_KD], &reader, &out->kd);
    read_colour(inputs[INPUT_KS], &reader, &out->ks);
    read_number(inputs[INPUT_SHININESS], &reader, &out->shininess);
    read_number(inputs[INPUT_REFLECT], &reader, &out->reflect);
    read_number(inputs[INPUT_REFRACT], &reader, &out->refract);
    read_number(inputs[INPUT_ROUGHNESS], &reader, &out->roughness);
    read_colour(inputs[INPUT_EMISSION], &reader, &out->emission);
    read_number(inputs[INPUT_OPACITY], &reader, &out->opacity);
    bump_turn_normal(material, hit, &out->normal);
}

/* material_inputs_at; `observer` (or NULL) is called for every material of the chain. */
static void material_inputs_observe(const struct material *material, const struct hit *hit, struct surface_inputs *out,
                                    material_observer *observer, void *context) {
    const struct material *chain[MATERIAL_DEPTH];
    int depth = 0;
    for (const struct material *link = observer ? material : NULL; link && depth < MATERIAL_DEPTH; link = link->base)
        chain[depth++] = link;
    while (depth > 0) {
        material_inputs_at(chain[--depth], hit, out);
        observer(context, chain[depth], out);
    }
    if (!observer)
        material_inputs_at(material, hit, out);
}

/* Anisotropy needs the tangents, too. */
bool material_has_bump(const struct material *material) {
    const struct openpbr *openpbr = material->openpbr;
    bool turned = openpbr && (openpbr->specular_anisotropy > 0 || openpbr->coat_anisotropy > 0 ||
                              material_texture(material, INPUT_SPECULAR_ANISOTROPY) ||
                              material_texture(material, INPUT_COAT_ANISOTROPY));
    return turned || bump_at(material->bumps, material->bump) != NULL;
}

bool material_has_holes(const struct material *material) {
    return material_texture(material, INPUT_OPACITY) != NULL;
}

const char *material_step_name(const struct material *link) {
#define IMAGE_ON(input, word, is_colour) [input] = "image on " word,
    static const char *const kinds[] = {MATERIAL_KINDS(LIST_WORD)}, *const images[] = {MATERIAL_INPUTS(IMAGE_ON)};
#undef IMAGE_ON
    return link->kind == MATERIAL_IMAGE && link->changed != INPUT_KD ? images[link->changed] : kinds[link->kind];
}

bool material_has_image(const struct material *material) {
    for (int i = 0; i < INPUT_COUNT; i++) {
        const struct texture *texture = material_texture(material, (enum material_input)i);
        if (texture && texture->has_image)
            return true;
    }
    return material_has_bump(material);
}

bool material_has_function(const struct material *material) {
    for (int i = 0; i < INPUT_COUNT; i++) {
        const struct texture *texture = material_texture(material, (enum material_input)i);
        if (texture && texture->has_function)
            return true;
    }
    return false;
}

bool material_is_transparent(const struct material *material) {
    const struct phong *numbers = numbers_of(material);
    return numbers->has_ior && (material->fresnel || numbers->refract > 0);
}

bool material_passes(const struct material *material) {
    return material->fresnel || numbers_of(material)->refract > 0 || material_texture(material, INPUT_REFRACT);
}

struct medium material_medium(const struct material *material) {
    const struct phong *numbers = numbers_of(material);
    const struct openpbr *openpbr = material->openpbr;
    double ior = numbers->has_ior ? numbers->ior : 1;
    struct vec3 tint = material->fresnel ? numbers->ks : vec3_scale(numbers->ks, numbers->refract);
    if (openpbr) {
        ior = openpbr_ior(openpbr->specular_ior, openpbr->specular_weight);
        tint = openpbr->deep ? vec3_all(1) : openpbr->transmission_colour;
    }
    return medium_inside(ior, tint, numbers->absorption);
}

bool material_divides_media(const struct material *material) {
    struct medium medium = material_medium(material);
    bool thin = material->openpbr && material->openpbr->thin_walled;
    bool differs = material->openpbr || medium.ior != 1 || vec3_max_abs(medium.extinction) > 0;
    return !thin && differs && material_passes(material);
}

static struct vec3 emission_of(const struct material *material, enum texture_estimate which) {
    const struct texture *texture = material_texture(material, INPUT_EMISSION);
    const struct phong *numbers = numbers_of(material);
    return texture ? texture_estimate(texture, material->textures, numbers, which) : numbers->emission;
}

struct vec3 material_emission(const struct material *material) {
    return emission_of(material, TEXTURE_AVERAGE);
}

struct vec3 material_emission_bound(const struct material *material) {
    return emission_of(material, TEXTURE_LARGEST);
}

/* The colour of an unlit material is also emission (material_eval); coats and fuzz reduce it, depending on the
 * direction. */
bool material_emission_varies(const struct material *material) {
    const struct openpbr *openpbr = material->openpbr;
    return material_texture(material, INPUT_EMISSION) || numbers_of(material)->unlit ||
           (openpbr && (openpbr->coat_weight > 0 || openpbr->fuzz_weight > 0));
}

bool material_has_ior(const struct material *material) {
    return numbers_of(material)->has_ior;
}

/* What gloss and coat of a layered material reflect in the mean over directions. Textures are not known here: they may
 * be 1, and indices are at least those of a common plastic. */
static double layers_specular(const struct material *material) {
    const struct openpbr *v = material->openpbr;
    double ior = openpbr_ior(v->specular_ior, v->specular_weight);
    double base = dielectric_fresnel_average(1 / ior), coat = dielectric_fresnel_average(1 / v->coat_ior);
    if (material_texture(material, INPUT_METALNESS) || material_texture(material, INPUT_REFRACT))
        return 1;
    if (material_texture(material, INPUT_SPECULAR_IOR) || material_texture(material, INPUT_SPECULAR_WEIGHT))
        base = fmax(base, 0.04);
    if (!material_texture(material, INPUT_KS))
        base *= vec3_max_abs(numbers_of(material)->ks);
    if (material_texture(material, INPUT_COAT_IOR))
        coat = fmax(coat, 0.04);
    return fmax(base, material_texture(material, INPUT_COAT_WEIGHT) ? coat : v->coat_weight * coat);
}

/* The highlight's colour from textures is not known here; it may be white. */
double material_specular(const struct material *material) {
    const struct phong *numbers = numbers_of(material);
    bool filtered = material_texture(material, INPUT_KS) != NULL;
    double amount = material->fresnel ? 1 : numbers->reflect + numbers->refract;
    double specular = amount > 0 ? amount * (filtered ? 1 : vec3_max_abs(numbers->ks)) : 0;
    return material->openpbr ? fmax(specular, layers_specular(material)) : specular;
}

/* Of metal, F82 with a tint above 1 (blue of brass) is at most Schlick's formula and -edge c (1 - c)^6; Schlick's
 * formula is at least 5 (1 - f0) c (1 - c)^6 below 1. */
static double metal_albedo_bound(struct vec3 f0, struct vec3 tint) {
    struct bsdf_facets facets = {.roughness = 1};
    bsdf_facets_metal(&facets, f0, tint);
    double bound = vec3_max_abs(f0);
    for (int c = 0; c < 3; c++) {
        if (-vec3_get(facets.edge, c) > 5 * (1 - vec3_get(f0, c)))
            bound = fmax(bound, vec3_get(tint, c));
    }
    return bound;
}

/* The largest component of a layer's colour; 0: the layer is not there. */
static double layer_bound(const struct material *material, enum material_input weight_input, double weight,
                          enum material_input colour_input, struct vec3 colour) {
    const struct texture *texture = material_texture(material, colour_input);
    if (!(weight > 0) && !material_texture(material, weight_input))
        return 0;
    if (texture)
        colour = texture_estimate(texture, material->textures, numbers_of(material), TEXTURE_LARGEST_TEXEL);
    return vec3_max_abs(colour);
}

/* The coat filters what is below; fuzz and transmission have their own colours. In a deep medium the colour is that of
 * its absorption. */
static double layers_albedo_bound(const struct material *material, double base) {
    const struct openpbr *v = material->openpbr;
    double transmission = v->deep ? 0
                                  : layer_bound(material, INPUT_REFRACT, numbers_of(material)->refract,
                                                INPUT_TRANSMISSION_COLOUR, v->transmission_colour);
    double coat = layer_bound(material, INPUT_COAT_WEIGHT, v->coat_weight, INPUT_COAT_COLOUR, v->coat_colour);
    double fuzz = layer_bound(material, INPUT_FUZZ_WEIGHT, v->fuzz_weight, INPUT_FUZZ_COLOUR, v->fuzz_colour);
    return fmax(fmax(base, transmission) * fmax(coat, 1), fuzz);
}

/* At normal incidence a highlight reflects 2 ks / (e + 1) of uniform light; with a mirror it is left out. */
double material_albedo_bound(const struct material *material) {
    const struct phong *numbers = numbers_of(material);
    const struct texture *texture = material_texture(material, INPUT_KD);
    struct vec3 colour =
        texture ? texture_estimate(texture, material->textures, numbers, TEXTURE_LARGEST_TEXEL) : numbers->kd;
    double diffuse = vec3_max_abs(colour);
    double specular = material_specular(material), exponent = numbers->shininess > 0 ? numbers->shininess : 0;
    if (numbers->unlit)
        return 0;
    const struct openpbr *openpbr = material->openpbr;
    if (openpbr && openpbr->base_metalness >= 1 && !material_texture(material, INPUT_METALNESS))
        return layers_albedo_bound(material, metal_albedo_bound(vec3_scale(colour, openpbr->base_weight), numbers->ks));
    if (openpbr)
        return layers_albedo_bound(material, fmax(diffuse, vec3_max_abs(numbers->ks)));
    return diffuse + (specular > 0 ? specular : vec3_max_abs(numbers->ks) * 2 / (exponent + 1));
}

/* See material_eval.h. If an interpolated or bumped normal is tilted so far that the ray would be behind the surface,
 * the geometric one is used. */

static void add_lobe(struct bsdf *bsdf, enum lobe_kind kind, struct vec3 weight, double exponent) {
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
    bsdf->roughness = vec3_max_abs(inputs->kd) > 0 ? 2 : inputs->roughness;
    bsdf->boundary.solid = hit->solid;
    bsdf->boundary.ior = inputs->has_ior ? inputs->ior : 1;
    bsdf->boundary.tint = inputs->fresnel ? inputs->ks : vec3_scale(inputs->ks, inputs->refract);
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
        add_lobe(bsdf, inputs->fresnel ? LOBE_GLOSS : LOBE_GGX_REFLECTION, vec3_scale(inputs->ks, reflect), 0);
    add_lobe(bsdf, LOBE_PANE, vec3_scale(inputs->ks, refract), 0);
    if (!inputs->fresnel)
        return;
    bsdf->lobes[bsdf->count - 2].share = fmax(bsdf->fresnel, 1.0 / 16);
    bsdf->lobes[bsdf->count - 1].share = fmax(1 - bsdf->fresnel, 1.0 / 16);
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
    if (rough && refract != 0 && bsdf->boundary.thin) {
        add_rough_pane(inputs, reflect, refract, bsdf);
        return;
    }
    if (reflect != 0)
        add_lobe(bsdf, rough ? LOBE_GGX_REFLECTION : LOBE_MIRROR, vec3_scale(inputs->ks, reflect), 0);
    if (refract != 0)
        add_lobe(bsdf, rough ? LOBE_GGX_TRANSMISSION : LOBE_REFRACTION, vec3_scale(inputs->ks, refract), 0);
}

/* Whether the surface has only a diffuse lobe, and every input is a number. */
static bool is_matte(const struct material *material, const struct phong *numbers) {
    return material->plain && !material->openpbr && !material->fresnel && !numbers->unlit && numbers->reflect == 0 &&
           numbers->refract == 0 && vec3_max_abs(numbers->ks) == 0;
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
    out->ambient = context->ambient_plain ? vec3_all(1) : numbers->kd;
    out->emission = numbers->emission;
    out->opacity = out->eta = 1;
    out->alpha = numbers->roughness * numbers->roughness;
    out->glossy_samples = numbers->glossy_samples;
    out->fresnel = -1;
    out->fresnel_of_facets = out->transmits = out->passes = false;
    out->turns_back = context->total_reflection;
}

/* The other surfaces of a joint tint what passes. */
static void tint_passing(const struct bsdf_joint *joint, struct bsdf *bsdf) {
    for (int i = 0; joint && i < bsdf->count; i++)
        if (lobe_flags(bsdf->lobes[i].kind) & BSDF_TRANSMITS)
            bsdf->lobes[i].weight = vec3_mul(bsdf->lobes[i].weight, joint->tint);
}

void material_eval(const struct material *material, const struct hit *hit, const struct medium_stack *media,
                   const struct material_context *context, struct bsdf *out) {
    static const struct material_context defaults = {.observer = NULL};
    struct surface_inputs inputs;
    if (!context)
        context = &defaults;
    if (context->no_black_highlight && is_matte(material, numbers_of(material))) {
        eval_matte(numbers_of(material), hit, context, out);
        return;
    }
    bool replaced = context->observer && !material->openpbr && context->authored->openpbr; /* by openpbr_classic */
    if (context->observer && !replaced)
        material_inputs_observe(context->authored, hit, &inputs, context->observer, context->observer_context);
    else
        material_inputs_at(material, hit, &inputs);
    if (replaced)
        context->observer(context->observer_context, context->authored, &inputs);
    out->count = 0;
    out->albedo = inputs.kd;
    out->opacity = inputs.opacity;
    out->turns_back = context->total_reflection;
    set_frame(hit, &inputs, out);
    if (!(inputs.opacity > 0))
        return;
    if (material->openpbr) {
        openpbr_eval(material, hit, media, context, &inputs, out);
        out->ambient = context->ambient_plain ? vec3_all(1) : inputs.kd;
    } else {
        set_boundary(hit, media, context, &inputs, out);
        set_lobes(&inputs, context, out);
    }
    tint_passing(context->joint, out);
}
