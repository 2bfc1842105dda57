/* Making the materials of a world, and what is known of them without a hit. */
#include "material/surface_material.h"

#include "base/mem.h"
#include "material/microfacet_internal.h"
#include "material/rough_lobes_internal.h"

/* --- making --- */

struct surface_material surface_material_make(const struct material *material, bool classic,
                                              const struct texture *textures[INPUT_COUNT]) {
    const struct texture *own[INPUT_COUNT], **inputs = textures ? textures : own;
    struct surface_material out = {.fresnel = material->fresnel,
                                   .filled = material->medium && material->medium->fills,
                                   .holds_medium = material->medium != NULL,
                                   .has_layers = material->openpbr != NULL,
                                   .phong = material_origin(material)->phong};
    for (int i = 0; i < INPUT_COUNT; i++)
        inputs[i] = material->inputs[i];
    if (out.has_layers)
        out.openpbr = *material->openpbr;
    if (classic && out.has_layers)
        openpbr_classic(&out, inputs);
    out.plain = !material->bump;
    for (int i = 0; i < INPUT_COUNT; i++) {
        out.inputs[i] = inputs[i] ? 0 : TEXTURE_NONE;
        out.plain = out.plain && !inputs[i];
    }
    return out;
}

void surface_material_update(struct surface_material *surface, const struct material *material, bool classic) {
    struct surface_material now = surface_material_make(material, classic, NULL);
    surface->phong = now.phong;
    surface->openpbr = now.openpbr;
}

struct surface_builder {
    struct texture_builder textures;
    struct surface_bump *bumps;
    const struct bump **authored_bumps;
    uint32_t bump_count, bump_capacity;
};

static bool grow_bumps(struct surface_builder *builder, uint32_t more) {
    if (builder->bump_capacity - builder->bump_count >= more)
        return true;
    size_t capacity = 2 * ((size_t)builder->bump_count + more);
    if (capacity >= TEXTURE_NONE)
        return false;
    struct surface_bump *bumps = mem_resize_array(builder->bumps, capacity, sizeof *bumps);
    builder->bumps = bumps ? bumps : builder->bumps;
    const struct bump **authored = mem_resize_array(builder->authored_bumps, capacity, sizeof *authored);
    builder->authored_bumps = authored ? authored : builder->authored_bumps;
    builder->bump_capacity = bumps && authored ? (uint32_t)capacity : builder->bump_capacity;
    return bumps && authored;
}

static bool add_bump(struct surface_builder *builder, const struct bump *bump, uint32_t at) {
    const struct texture *texture = bump->texture;
    struct surface_bump *out = &builder->bumps[at];
    bool is_single = texture_as_image(texture) || texture->operation.kind == TEXTURE_FUNCTION;
    *out = (struct surface_bump){.kind = bump->kind,
                                 .height = bump->height,
                                 .relative = bump->relative,
                                 .from_above = bump->from_above,
                                 .of_coat = bump->of_coat,
                                 .texture = TEXTURE_NONE};
    builder->authored_bumps[at] = bump;
    if (!texture_builder_add(&builder->textures, texture, bump->kind == MATERIAL_BUMP, &out->program))
        return false;
    if (is_single)
        out->texture = texture_builder_index(&builder->textures, texture);
    return true;
}

/* The bumps of a material in a row. Those of the material before, which often has the same, are used again. */
static bool add_bumps(struct surface_builder *builder, const struct bump *top, const struct surface_material *before,
                      struct surface_material *surface) {
    uint32_t end = before ? before->first_bump + before->bump_count : 0, count = 0;
    for (const struct bump *bump = top; bump; bump = bump->below)
        count++;
    surface->bump_count = count;
    surface->first_bump = builder->bump_count;
    if (before && count > 0 && count <= before->bump_count &&
        builder->authored_bumps[before->first_bump + count - 1] == top) {
        surface->first_bump = before->first_bump;
        return true;
    }
    /* One more over those of the material before. */
    if (before && before->bump_count > 0 && count == before->bump_count + 1 && end == builder->bump_count &&
        builder->authored_bumps[end - 1] == top->below) {
        surface->first_bump = before->first_bump;
        count = 1;
    }
    if (!grow_bumps(builder, count))
        return false;
    builder->bump_count += count;
    for (uint32_t at = builder->bump_count; count-- > 0; top = top->below)
        if (!add_bump(builder, top, --at))
            return false;
    return true;
}

/* Anisotropy needs the tangents, too. */
static bool is_turned(const struct surface_material *surface) {
    return surface->has_layers && (surface->openpbr.specular_anisotropy > 0 || surface->openpbr.coat_anisotropy > 0 ||
                                   surface_has_texture(surface, INPUT_SPECULAR_ANISOTROPY) ||
                                   surface_has_texture(surface, INPUT_COAT_ANISOTROPY));
}

static bool add_material(struct surface_builder *builder, const struct material *material, bool classic,
                         const struct surface_material *before, struct surface_material *out) {
#define INPUT_IS_COLOUR(input, word, is_colour) [input] = (is_colour),
    static const bool is_colour[] = {MATERIAL_INPUTS(INPUT_IS_COLOUR)};
#undef INPUT_IS_COLOUR
    const struct texture *textures[INPUT_COUNT];
    *out = surface_material_make(material, classic, textures);
    out->needs_footprint = out->needs_tangents = material->bump || is_turned(out);
    for (int i = 0; i < INPUT_COUNT; i++) {
        if (!textures[i])
            continue;
        out->needs_footprint = out->needs_footprint || textures[i]->has_image;
        out->needs_tangents = out->needs_tangents || textures[i]->has_function;
        if (!texture_builder_add(&builder->textures, textures[i], !is_colour[i], &out->inputs[i]))
            return false;
        if (is_colour[i])
            texture_builder_mark_colours(&builder->textures, textures[i]);
    }
    return add_bumps(builder, material->bump, before, out);
}

static bool finish(const struct surface_builder *builder, struct arena *arena, struct surface_tables *out,
                   const struct texture *const **authored) {
    struct surface_bump *bumps = arena_alloc_array(arena, (size_t)builder->bump_count + 1, sizeof *bumps);
    const struct texture **textures = arena_alloc_array(arena, (size_t)builder->textures.count + 1, sizeof *textures);
    if (!bumps || !textures || !texture_builder_finish(&builder->textures, arena, &out->textures))
        return false;
    for (uint32_t i = 0; i < builder->bump_count; i++)
        bumps[i] = builder->bumps[i];
    for (uint32_t i = 0; i < builder->textures.count; i++)
        textures[i] = builder->textures.textures[i].authored;
    out->bumps = bumps;
    out->bump_count = builder->bump_count;
    if (authored)
        *authored = textures;
    return true;
}

bool surface_tables_build(struct surface_tables *out, const struct material *const *materials, uint32_t count,
                          bool classic, struct arena *arena, const struct texture *const **authored) {
    struct surface_builder builder = {.bump_count = 0};
    out->materials = arena_alloc_array(arena, (size_t)count + 1, sizeof *out->materials);
    bool ok = out->materials != NULL;
    for (uint32_t i = 0; ok && i < count; i++)
        ok = add_material(&builder, materials[i], classic, i > 0 ? &out->materials[i - 1] : NULL, &out->materials[i]);
    ok = ok && finish(&builder, arena, out, authored);
    texture_builder_destroy(&builder.textures);
    mem_free(builder.bumps);
    mem_free(builder.authored_bumps);
    return ok;
}

/* --- without a hit --- */

bool surface_is_transparent(const struct surface_material *surface) {
    const struct phong *numbers = &surface->phong;
    return surface->filled || (numbers->has_ior && (surface->fresnel || numbers->refract > 0));
}

bool surface_passes(const struct surface_material *surface) {
    return surface->filled || surface->fresnel || surface->phong.refract > 0 ||
           surface_has_texture(surface, INPUT_REFRACT);
}

bool surface_walks(const struct surface_material *surface) {
    const struct openpbr *v = &surface->openpbr;
    return surface->has_layers && (v->subsurface_weight > 0 || surface_has_texture(surface, INPUT_SUBSURFACE_WEIGHT)) &&
           (v->subsurface_radius > 0 || surface_has_texture(surface, INPUT_SUBSURFACE_RADIUS));
}

struct medium surface_medium(const struct surface_material *surface) {
    const struct phong *numbers = &surface->phong;
    const struct openpbr *openpbr = surface->has_layers ? &surface->openpbr : NULL;
    double ior = numbers->has_ior ? numbers->ior : 1;
    struct colour tint = surface->fresnel ? numbers->ks : colour_scale(numbers->ks, numbers->refract);
    if (openpbr) {
        ior = openpbr_ior(openpbr->specular_ior, openpbr->specular_weight);
        tint = openpbr->deep ? colour_all(1) : openpbr->transmission_colour;
    }
    struct medium_input inside = {.absorption = numbers->absorption};
    if (openpbr) {
        inside.scattering = openpbr->transmission_scattering;
        inside.phase.g = openpbr->transmission_anisotropy;
    }
    struct medium medium = medium_inside(ior, tint, &inside);
    medium.dispersion = numbers->dispersion;
    return medium;
}

bool surface_disperses(const struct surface_material *surface) {
    bool thin = surface->has_layers && surface->openpbr.thin_walled;
    return surface->phong.dispersion.amount > 0 && !thin && surface_passes(surface);
}

bool surface_divides_media(const struct surface_material *surface) {
    struct medium medium = surface_medium(surface);
    bool thin = surface->has_layers && surface->openpbr.thin_walled;
    bool differs = surface->has_layers || medium.ior != 1 || colour_max_abs(medium.extinction) > 0;
    return surface->filled || (!thin && differs && surface_passes(surface));
}

static struct colour estimate(const struct surface_tables *tables, const struct surface_material *surface,
                              enum material_input input, struct colour number, enum texture_estimate which) {
    return surface_has_texture(surface, input)
               ? texture_program_estimate(&tables->textures, surface->inputs[input], &surface->phong, which)
               : number;
}

struct colour surface_diffuse(const struct surface_tables *tables, const struct surface_material *surface) {
    return estimate(tables, surface, INPUT_KD, surface->phong.kd, TEXTURE_AVERAGE);
}

struct colour surface_emission(const struct surface_tables *tables, const struct surface_material *surface) {
    return estimate(tables, surface, INPUT_EMISSION, surface->phong.emission, TEXTURE_AVERAGE);
}

struct colour surface_emission_bound(const struct surface_tables *tables, const struct surface_material *surface) {
    return estimate(tables, surface, INPUT_EMISSION, surface->phong.emission, TEXTURE_LARGEST);
}

/* The colour of an unlit material is also emission (material_eval); coats and fuzz reduce it, depending on the
 * direction. */
bool surface_emission_varies(const struct surface_material *surface) {
    const struct openpbr *openpbr = surface->has_layers ? &surface->openpbr : NULL;
    return surface_has_texture(surface, INPUT_EMISSION) || surface->phong.unlit ||
           (openpbr && (openpbr->coat_weight > 0 || openpbr->fuzz_weight > 0));
}

/* What gloss and coat of a layered material reflect in the mean over directions. Textures are not known here: they may
 * be 1, and indices are at least those of a common plastic. */
static double layers_specular(const struct surface_material *surface) {
    const struct openpbr *v = &surface->openpbr;
    double ior = openpbr_ior(v->specular_ior, v->specular_weight);
    double base = dielectric_fresnel_average(1 / ior), coat = dielectric_fresnel_average(1 / v->coat_ior);
    if (surface_has_texture(surface, INPUT_METALNESS) || surface_has_texture(surface, INPUT_REFRACT))
        return 1;
    if (surface_has_texture(surface, INPUT_SPECULAR_IOR) || surface_has_texture(surface, INPUT_SPECULAR_WEIGHT) ||
        v->film_weight > 0 || surface_has_texture(surface, INPUT_FILM_WEIGHT))
        base = math_max(base, 0.04);
    if (!surface_has_texture(surface, INPUT_KS))
        base *= colour_max_abs(surface->phong.ks);
    if (surface_has_texture(surface, INPUT_COAT_IOR))
        coat = math_max(coat, 0.04);
    return math_max(base, surface_has_texture(surface, INPUT_COAT_WEIGHT) ? coat : v->coat_weight * coat);
}

/* The highlight's colour from textures is not known here; it may be white. */
double surface_specular(const struct surface_material *surface) {
    const struct phong *numbers = &surface->phong;
    bool filtered = surface_has_texture(surface, INPUT_KS);
    double amount = surface->fresnel ? 1 : numbers->reflect + numbers->refract;
    double specular = amount > 0 ? amount * (filtered ? 1 : colour_max_abs(numbers->ks)) : 0;
    return surface->has_layers ? math_max(specular, layers_specular(surface)) : specular;
}

/* Of metal, F82 with a tint above 1 (blue of brass) is at most Schlick's formula and -edge c (1 - c)^6; Schlick's
 * formula is at least 5 (1 - f0) c (1 - c)^6 below 1. */
static double metal_albedo_bound(struct colour f0, struct colour tint) {
    struct bsdf_facets facets = {.roughness = 1};
    bsdf_facets_metal(&facets, f0, tint);
    double bound = colour_max_abs(f0);
    for (int c = 0; c < 3; c++) {
        if (-colour_get(facets.edge, c) > 5 * (1 - colour_get(f0, c)))
            bound = math_max(bound, colour_get(tint, c));
    }
    return bound;
}

/* The largest component of a layer's colour; 0: the layer is not there. */
static double layer_bound(const struct surface_tables *tables, const struct surface_material *surface,
                          enum material_input weight_input, double weight, enum material_input colour_input,
                          struct colour colour) {
    if (!(weight > 0) && !surface_has_texture(surface, weight_input))
        return 0;
    return colour_max_abs(estimate(tables, surface, colour_input, colour, TEXTURE_LARGEST_TEXEL));
}

/* The coat filters what is below; fuzz and transmission have their own colours. In a deep medium the colour is that of
 * its absorption. */
static double layers_albedo_bound(const struct surface_tables *tables, const struct surface_material *surface,
                                  double base) {
    const struct openpbr *v = &surface->openpbr;
    double transmission = v->deep ? 0
                                  : layer_bound(tables, surface, INPUT_REFRACT, surface->phong.refract,
                                                INPUT_TRANSMISSION_COLOUR, v->transmission_colour);
    double below = layer_bound(tables, surface, INPUT_SUBSURFACE_WEIGHT, v->subsurface_weight, INPUT_SUBSURFACE_COLOUR,
                               v->subsurface_colour);
    double coat = layer_bound(tables, surface, INPUT_COAT_WEIGHT, v->coat_weight, INPUT_COAT_COLOUR, v->coat_colour);
    double fuzz = layer_bound(tables, surface, INPUT_FUZZ_WEIGHT, v->fuzz_weight, INPUT_FUZZ_COLOUR, v->fuzz_colour);
    return math_max(math_max(math_max(base, math_min(below, 1)), transmission) * math_max(coat, 1), fuzz);
}

/* At normal incidence a highlight reflects 2 ks / (e + 1) of uniform light; with a mirror it is left out. */
double surface_albedo_bound(const struct surface_tables *tables, const struct surface_material *surface) {
    const struct phong *numbers = &surface->phong;
    struct colour colour = estimate(tables, surface, INPUT_KD, numbers->kd, TEXTURE_LARGEST_TEXEL);
    double diffuse = colour_max_abs(colour);
    double specular = surface_specular(surface), exponent = numbers->shininess > 0 ? numbers->shininess : 0;
    if (numbers->unlit)
        return 0;
    const struct openpbr *openpbr = surface->has_layers ? &surface->openpbr : NULL;
    if (openpbr && openpbr->base_metalness >= 1 && !surface_has_texture(surface, INPUT_METALNESS))
        return layers_albedo_bound(tables, surface,
                                   metal_albedo_bound(colour_scale(colour, openpbr->base_weight), numbers->ks));
    if (openpbr)
        return layers_albedo_bound(tables, surface, math_max(diffuse, colour_max_abs(numbers->ks)));
    return diffuse + (specular > 0 ? specular : colour_max_abs(numbers->ks) * 2 / (exponent + 1));
}

void surface_tables_bundle(struct bundle *bundle, struct surface_tables *tables, uint32_t material_count) {
    BUNDLE(bundle, tables->materials, material_count, NULL);
    BUNDLE(bundle, tables->bumps, tables->bump_count, NULL);
    texture_tables_bundle(bundle, &tables->textures);
}
