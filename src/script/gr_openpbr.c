/* Layered materials: gr.openpbr_material with the parameters of OpenPBR Surface 1.1, under their names, and
 * gr.metal_material, whose reflectances are measured. Both are one kind of material (material/openpbr.h). */
#include "call/context.h"
#include "material/material_inputs.h"
#include "material/metals.h"
#include "material/openpbr.h"
#include "math/elementary.h"
#include "script/gr_materials_internal.h"
#include "script/gr_textures_internal.h"
#include "script/rows_internal.h"
#include "script/table_internal.h"

enum {
    BASE_WEIGHT,
    BASE_COLOUR,
    BASE_DIFFUSE_ROUGHNESS,
    BASE_METALNESS,
    SPECULAR_WEIGHT,
    SPECULAR_COLOUR,
    SPECULAR_ROUGHNESS,
    SPECULAR_ANISOTROPY,
    SPECULAR_IOR,
    TRANSMISSION_WEIGHT,
    TRANSMISSION_COLOUR,
    TRANSMISSION_DEPTH,
    TRANSMISSION_SCATTER,
    TRANSMISSION_SCATTER_ANISOTROPY,
    TRANSMISSION_DISPERSION_SCALE,
    TRANSMISSION_DISPERSION_ABBE,
    SUBSURFACE_WEIGHT,
    SUBSURFACE_COLOUR,
    SUBSURFACE_RADIUS,
    SUBSURFACE_RADIUS_SCALE,
    SUBSURFACE_SCATTER_ANISOTROPY,
    COAT_WEIGHT,
    COAT_COLOUR,
    COAT_ROUGHNESS,
    COAT_ANISOTROPY,
    COAT_IOR,
    COAT_DARKENING,
    FUZZ_WEIGHT,
    FUZZ_COLOUR,
    FUZZ_ROUGHNESS,
    EMISSION_LUMINANCE,
    EMISSION_COLOUR,
    THIN_FILM_WEIGHT,
    THIN_FILM_THICKNESS,
    THIN_FILM_IOR,
    GEOMETRY_OPACITY,
    GEOMETRY_THIN_WALLED,
    GEOMETRY_NORMAL,
    GEOMETRY_TANGENT,
    GEOMETRY_COAT_NORMAL,
    GEOMETRY_COAT_TANGENT,
    OPENPBR_GLASS,
    OPENPBR_GLOSSY_SAMPLES,
    OPENPBR_CLASSIC,
};

/* A number between 0 and 1, a colour, an index: each may be a texture. */
#define SHARE(name, otherwise, help)                                                                                   \
    { name, KIND_NUMBER, OPTIONAL | OR_TEXTURE, IN_RANGE(0, 1), NULL, otherwise, help }
#define TINT(name, otherwise, help)                                                                                    \
    { name, KIND_COLOUR, OPTIONAL | OR_TEXTURE, ABOVE(0), NULL, otherwise, help }
#define INDEX(name, otherwise, help)                                                                                   \
    { name, KIND_NUMBER, OPTIONAL | OR_TEXTURE | LOW_OPEN, ABOVE(0), NULL, otherwise, help }
#define MEAN_COSINE(name)                                                                                              \
    {                                                                                                                  \
        name, KIND_NUMBER, OPTIONAL | LOW_OPEN | HIGH_OPEN, IN_RANGE(-1, 1), NULL, "0",                                \
            "Mean cosine of that scattering."                                                                          \
    }
#define SAMPLES                                                                                                        \
    {                                                                                                                  \
        "glossy_samples", KIND_WHOLE, OPTIONAL, IN_RANGE(1, 64), NULL, "4",                                            \
            "At most N x N rays from a rough surface under Whitted, as many as its share of reflected light "          \
            "justifies."                                                                                               \
    }
#define CLASSIC                                                                                                        \
    {                                                                                                                  \
        "classic", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",                                                         \
            "Whether Whitted's integrator shades it as a similar gr.material, which is faster."                        \
    }
#define NORMAL_HELP "A normal map or bump map: a result of gr.bump, or the file of a normal map."
#define TANGENT_HELP "Direction along which the facets of an anisotropic surface are smooth, in the world."

static const struct script_parameter openpbr_parameters[] = {
    [BASE_WEIGHT] = SHARE("base_weight", "1", "Factor of base_color."),
    [BASE_COLOUR] =
        TINT("base_color", "{0.8, 0.8, 0.8}", "Diffuse colour; for metals the reflectance at normal incidence."),
    [BASE_DIFFUSE_ROUGHNESS] = SHARE("base_diffuse_roughness", "0", "Roughness of the diffuse base; 0 is Lambert's."),
    [BASE_METALNESS] = SHARE("base_metalness", "0", "Share of the base that is metal."),
    [SPECULAR_WEIGHT] = {"specular_weight", KIND_NUMBER, OPTIONAL | OR_TEXTURE, ABOVE(0), NULL, "1",
                         "Factor of the reflectance at normal incidence; for dielectrics it changes the index."},
    [SPECULAR_COLOUR] =
        TINT("specular_color", "{1, 1, 1}", "Colour of the specular reflection; for metals the tint at 82 degrees."),
    [SPECULAR_ROUGHNESS] = SHARE("specular_roughness", "0.3", "Roughness of reflection and refraction; 0 is polished."),
    [SPECULAR_ANISOTROPY] =
        SHARE("specular_roughness_anisotropy", "0", "How much smoother it is along the tangent than across."),
    [SPECULAR_IOR] = INDEX("specular_ior", "1.5", "Index of refraction of the base."),
    [TRANSMISSION_WEIGHT] = SHARE("transmission_weight", "0", "Share of the dielectric base that transmits light."),
    [TRANSMISSION_COLOUR] =
        TINT("transmission_color", "{1, 1, 1}", "Colour of transmitted light, after the distance transmission_depth."),
    [TRANSMISSION_DEPTH] =
        {"transmission_depth", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "0",
         "Distance inside the solid after which white light has transmission_color; 0: at the surface."},
    [TRANSMISSION_SCATTER] = {"transmission_scatter", KIND_COLOUR, OPTIONAL, ABOVE(0), NULL, "{0, 0, 0}",
                              "Scattering inside the solid along the distance transmission_depth."},
    [TRANSMISSION_SCATTER_ANISOTROPY] = MEAN_COSINE("transmission_scatter_anisotropy"),
    [TRANSMISSION_DISPERSION_SCALE] = {"transmission_dispersion_scale", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL,
                                       "0; 1 with glass", "Factor of the dispersion; 0: none."},
    [TRANSMISSION_DISPERSION_ABBE] = {"transmission_dispersion_abbe_number", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0),
                                      NULL, "20", "Abbe's number of the dispersion by Cauchy's law."},
    [SUBSURFACE_WEIGHT] =
        SHARE("subsurface_weight", "0", "Share of the diffuse base whose light is scattered under the surface."),
    [SUBSURFACE_COLOUR] = TINT("subsurface_color", "{0.8, 0.8, 0.8}", "The colour that a large solid shows by it."),
    [SUBSURFACE_RADIUS] = {"subsurface_radius", KIND_NUMBER, OPTIONAL | OR_TEXTURE, ABOVE(0), NULL, "1",
                           "Mean free path under the surface; 0 is Lambert's diffuse light."},
    [SUBSURFACE_RADIUS_SCALE] = {"subsurface_radius_scale", KIND_COLOUR, OPTIONAL, ABOVE(0), NULL, "{1, 0.5, 0.25}",
                                 "Factors of subsurface_radius by channel."},
    [SUBSURFACE_SCATTER_ANISOTROPY] = MEAN_COSINE("subsurface_scatter_anisotropy"),
    [COAT_WEIGHT] = SHARE("coat_weight", "0", "Share of the surface with a clear coat."),
    [COAT_COLOUR] = TINT("coat_color", "{1, 1, 1}", "Colour of light that passed the coat twice."),
    [COAT_ROUGHNESS] = SHARE("coat_roughness", "0", "Roughness of the coat; 0 is polished."),
    [COAT_ANISOTROPY] = SHARE("coat_roughness_anisotropy", "0", "The same for the coat."),
    [COAT_IOR] = INDEX("coat_ior", "1.6", "Index of refraction of the coat."),
    [COAT_DARKENING] = SHARE("coat_darkening", "1", "How much internal reflections of the coat darken the base."),
    [FUZZ_WEIGHT] = SHARE("fuzz_weight", "0", "Share of the surface with fuzz."),
    [FUZZ_COLOUR] = TINT("fuzz_color", "{1, 1, 1}", "Colour of the fuzz."),
    [FUZZ_ROUGHNESS] =
        SHARE("fuzz_roughness", "0.5", "Roughness of the fuzz; a rough fuzz is visible farther from the rim."),
    [EMISSION_LUMINANCE] = {"emission_luminance", KIND_NUMBER, OPTIONAL | OR_TEXTURE, ABOVE(0), NULL, "0",
                            "Emitted light, below coat and fuzz; 1 means radiance 1."},
    [EMISSION_COLOUR] = TINT("emission_color", "{1, 1, 1}", "Its colour."),
    [THIN_FILM_WEIGHT] =
        SHARE("thin_film_weight", "0", "Share of the base with a film that shows colours of interference."),
    [THIN_FILM_THICKNESS] = {"thin_film_thickness", KIND_NUMBER, OPTIONAL | OR_TEXTURE, ABOVE(0), NULL, "0.5",
                             "Its thickness in micrometres; 0: no film."},
    [THIN_FILM_IOR] = {"thin_film_ior", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "1.4",
                       "Its index of refraction."},
    [GEOMETRY_OPACITY] = SHARE("geometry_opacity", "1", "Opacity of the surface; below 1 it has holes."),
    [GEOMETRY_THIN_WALLED] = {"geometry_thin_walled", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",
                              "Whether the surface is a wall without thickness: nothing is inside."},
    [GEOMETRY_NORMAL] = {"geometry_normal", KIND_IMAGE, OPTIONAL | OR_TEXTURE, ANY, NULL, "none", NORMAL_HELP},
    [GEOMETRY_TANGENT] = {"geometry_tangent", KIND_DIRECTION, OPTIONAL, ANY, NULL, "along u", TANGENT_HELP},
    [GEOMETRY_COAT_NORMAL] = {"geometry_coat_normal", KIND_IMAGE, OPTIONAL | OR_TEXTURE, ANY, NULL, "that of the base",
                              "The same for the coat."},
    [GEOMETRY_COAT_TANGENT] = {"geometry_coat_tangent", KIND_DIRECTION, OPTIONAL, ANY, NULL, "along u",
                               "The same for the coat."},
    [OPENPBR_GLASS] = GLASS_FIELD,
    [OPENPBR_GLOSSY_SAMPLES] = SAMPLES,
    [OPENPBR_CLASSIC] = CLASSIC,
};

static double number_or(const struct script_value *value, double otherwise) {
    return value->given ? value->number : otherwise;
}

static struct colour colour_or(const struct script_value *value, struct colour otherwise) {
    return value->given ? value->colour : otherwise;
}

/* A material whose numbers are those of the specification. */
static struct material *layered(struct script_context *context, struct openpbr **out, struct error *error) {
    struct material *m = scene_material(&context->scene, MATERIAL_OPENPBR, NULL, error);
    *out = m ? arena_alloc(&context->scene.arena, sizeof **out) : NULL;
    if (!m || !*out) {
        if (m)
            error_no_memory(error, "a material");
        return NULL;
    }
    **out = openpbr_defaults();
    m->openpbr = *out;
    m->phong.kd = colour_all(0.8);
    m->phong.ks = colour_all(1);
    m->phong.shininess = 1;
    m->phong.ior = 1;
    m->phong.two_sided = true;
    m->phong.roughness = 0.3;
    return m;
}

/* A texture that multiplies numbers of 1. */
static const struct texture *texture_of(struct script_context *context, const struct script_value *value,
                                        struct error *error) {
    struct script_value own = *value;
    own.colour = colour_all(1);
    return gr_texture_of(context, &own, error);
}

static bool with_texture(struct script_context *context, struct material *m, enum material_input input, bool is_share,
                         const struct script_value *value, struct error *error) {
    struct arena *arena = &context->scene.arena;
    if (!value->texture)
        return true;
    const struct texture_image *cut = gr_cut_of(value, input);
    if (cut && !material_cut_by_alpha(m, cut, arena, error))
        return false;
    if (cut && input == INPUT_OPACITY)
        return true;
    const struct texture *texture = texture_of(context, value, error);
    if (texture && is_share)
        texture = texture_keep(arena, texture_map(texture, FUNCTION_SATURATE, 0), error);
    return texture && material_multiply(m, input, texture, arena, error);
}

/* emission_luminance is a number, and the input a colour: the ratio of a mix is read as a number. */
static bool with_luminance(struct script_context *context, struct material *m, const struct script_value *value,
                           struct error *error) {
    struct arena *arena = &context->scene.arena;
    if (!value->texture)
        return true;
    const struct texture *ratio = texture_of(context, value, error);
    const struct texture *one = texture_keep(arena, texture_constant(colour_all(1)), error);
    const struct texture *none = texture_keep(arena, texture_constant(colour_all(0)), error);
    const struct texture *mix = ratio && one && none ? texture_keep(arena, texture_mix(one, none, ratio), error) : NULL;
    return mix && material_multiply(m, INPUT_EMISSION, mix, arena, error);
}

static bool with_textures(struct script_context *context, struct material *m, const struct script_value *args,
                          struct error *error) {
    static const struct {
        int parameter;
        enum material_input input;
        bool is_share;
    } rows[] = {{BASE_WEIGHT, INPUT_BASE_WEIGHT, true},
                {BASE_COLOUR, INPUT_KD, false},
                {BASE_DIFFUSE_ROUGHNESS, INPUT_DIFFUSE_ROUGHNESS, true},
                {BASE_METALNESS, INPUT_METALNESS, true},
                {SPECULAR_WEIGHT, INPUT_SPECULAR_WEIGHT, false},
                {SPECULAR_COLOUR, INPUT_KS, false},
                {SPECULAR_ROUGHNESS, INPUT_ROUGHNESS, true},
                {SPECULAR_ANISOTROPY, INPUT_SPECULAR_ANISOTROPY, true},
                {SPECULAR_IOR, INPUT_SPECULAR_IOR, false},
                {TRANSMISSION_WEIGHT, INPUT_REFRACT, true},
                {TRANSMISSION_COLOUR, INPUT_TRANSMISSION_COLOUR, false},
                {SUBSURFACE_WEIGHT, INPUT_SUBSURFACE_WEIGHT, true},
                {SUBSURFACE_COLOUR, INPUT_SUBSURFACE_COLOUR, false},
                {SUBSURFACE_RADIUS, INPUT_SUBSURFACE_RADIUS, false},
                {COAT_WEIGHT, INPUT_COAT_WEIGHT, true},
                {COAT_COLOUR, INPUT_COAT_COLOUR, false},
                {COAT_ROUGHNESS, INPUT_COAT_ROUGHNESS, true},
                {COAT_ANISOTROPY, INPUT_COAT_ANISOTROPY, true},
                {COAT_IOR, INPUT_COAT_IOR, false},
                {COAT_DARKENING, INPUT_COAT_DARKENING, true},
                {FUZZ_WEIGHT, INPUT_FUZZ_WEIGHT, true},
                {FUZZ_COLOUR, INPUT_FUZZ_COLOUR, false},
                {FUZZ_ROUGHNESS, INPUT_FUZZ_ROUGHNESS, true},
                {THIN_FILM_WEIGHT, INPUT_FILM_WEIGHT, true},
                {THIN_FILM_THICKNESS, INPUT_FILM_THICKNESS, false},
                {EMISSION_COLOUR, INPUT_EMISSION, false},
                {GEOMETRY_OPACITY, INPUT_OPACITY, true}};
    /* A texture of each input. */
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (!with_texture(context, m, rows[i].input, rows[i].is_share, &args[rows[i].parameter], error))
            return false;
    if (!with_luminance(context, m, &args[EMISSION_LUMINANCE], error))
        return false;
    /* A constant opacity below 1 is a texture, too. */
    const struct script_value *opacity = &args[GEOMETRY_OPACITY];
    if (opacity->texture || !(number_or(opacity, 1) < 1))
        return true;
    const struct texture *cover = texture_keep(&context->scene.arena, texture_number(opacity->number), error);
    return cover && material_multiply(m, INPUT_OPACITY, cover, &context->scene.arena, error);
}

/* A picture alone is a normal map. */
static bool with_normal(struct script_context *context, struct material *m, bool of_coat,
                        const struct script_value *value, struct error *error) {
    if (!value->given)
        return true;
    const struct bump *given = read_bump_values(context, value, error);
    if (!given)
        return false;
    struct bump bump = *given;
    if (!value->texture || !value->texture->is_bump) {
        bump.kind = MATERIAL_NORMAL;
        bump.height = 1;
        bump.relative = false;
    }
    bump.of_coat = of_coat;
    return material_add_bump(m, &bump, &context->scene.arena, error);
}

/* Beer's law: after the depth white light has the colour. Black is all but black. */
static double absorption(double colour, double depth) {
    return colour < 1 ? -el_log(colour > 1e-6 ? colour : 1e-6) / depth : 0;
}

/* The kernels read a tangent of length 0 as none. */
static bool tangent_is_fine(const struct script_parameter *parameter, const struct script_value *value,
                            struct error *error) {
    return !value->given || colour_max_abs(value->colour) > 0 ||
           error_set(error, ERROR_SCENE, "%s has length 0", parameter->name);
}

static void set_numbers(const struct script_value *args, struct openpbr *out, struct phong *phong) {
    /* The layers. */
    out->base_weight = number_or(&args[BASE_WEIGHT], out->base_weight);
    out->base_diffuse_roughness = args[BASE_DIFFUSE_ROUGHNESS].number;
    out->base_metalness = args[BASE_METALNESS].number;
    out->specular_weight = number_or(&args[SPECULAR_WEIGHT], out->specular_weight);
    out->specular_anisotropy = args[SPECULAR_ANISOTROPY].number;
    out->specular_ior = number_or(&args[SPECULAR_IOR], out->specular_ior);
    if (args[OPENPBR_GLASS].given)
        out->specular_ior = glass_ior(gr_glass_of(&args[OPENPBR_GLASS]));
    out->transmission_colour = colour_or(&args[TRANSMISSION_COLOUR], out->transmission_colour);
    out->transmission_anisotropy = args[TRANSMISSION_SCATTER_ANISOTROPY].number;
    out->subsurface_weight = args[SUBSURFACE_WEIGHT].number;
    out->subsurface_colour = colour_or(&args[SUBSURFACE_COLOUR], out->subsurface_colour);
    out->subsurface_radius = number_or(&args[SUBSURFACE_RADIUS], out->subsurface_radius);
    out->subsurface_radius_scale = colour_or(&args[SUBSURFACE_RADIUS_SCALE], out->subsurface_radius_scale);
    out->subsurface_anisotropy = args[SUBSURFACE_SCATTER_ANISOTROPY].number;
    out->coat_weight = args[COAT_WEIGHT].number;
    out->coat_colour = colour_or(&args[COAT_COLOUR], out->coat_colour);
    out->coat_roughness = args[COAT_ROUGHNESS].number;
    out->coat_anisotropy = args[COAT_ANISOTROPY].number;
    out->coat_ior = number_or(&args[COAT_IOR], out->coat_ior);
    out->coat_darkening = number_or(&args[COAT_DARKENING], out->coat_darkening);
    out->fuzz_weight = args[FUZZ_WEIGHT].number;
    out->fuzz_colour = colour_or(&args[FUZZ_COLOUR], out->fuzz_colour);
    out->fuzz_roughness = number_or(&args[FUZZ_ROUGHNESS], out->fuzz_roughness);
    out->film_weight = args[THIN_FILM_WEIGHT].number;
    out->film_thickness = number_or(&args[THIN_FILM_THICKNESS], out->film_thickness);
    out->film_ior = number_or(&args[THIN_FILM_IOR], out->film_ior);
    out->classic = args[OPENPBR_CLASSIC].boolean;
    out->thin_walled = args[GEOMETRY_THIN_WALLED].boolean;
    out->tangent = args[GEOMETRY_TANGENT].vector;
    out->coat_tangent = args[GEOMETRY_COAT_TANGENT].vector;
    /* What they share with classic materials. */
    phong->kd = colour_or(&args[BASE_COLOUR], phong->kd);
    phong->ks = colour_or(&args[SPECULAR_COLOUR], phong->ks);
    phong->roughness = number_or(&args[SPECULAR_ROUGHNESS], phong->roughness);
    phong->refract = args[TRANSMISSION_WEIGHT].number;
    phong->reflect = out->base_metalness;
    phong->emission = colour_scale(colour_or(&args[EMISSION_COLOUR], colour_all(1)), args[EMISSION_LUMINANCE].number);
    phong->glossy_samples = (int)args[OPENPBR_GLOSSY_SAMPLES].number;
    phong->has_ior = phong->refract > 0 && !out->thin_walled;
    phong->ior = phong->has_ior ? openpbr_ior(out->specular_ior, out->specular_weight) : 1;
    const struct script_value *scale = &args[TRANSMISSION_DISPERSION_SCALE];
    phong->dispersion.glass = gr_glass_of(&args[OPENPBR_GLASS]);
    phong->dispersion.amount = phong->dispersion.glass > 0
                                   ? number_or(scale, 1)
                                   : scale->number / number_or(&args[TRANSMISSION_DISPERSION_ABBE], 20);
    /* With a depth, the colour is that of light after this length: its extinction. Where scattering alone is more,
     * gray absorption is added. */
    double depth = args[TRANSMISSION_DEPTH].number;
    struct colour colour = out->transmission_colour;
    if (!(depth > 0) || !phong->has_ior)
        return;
    out->deep = true;
    out->transmission_scattering = colour_scale(args[TRANSMISSION_SCATTER].colour, 1 / depth);
    struct colour extinction =
        colour_make(absorption(colour.r, depth), absorption(colour.g, depth), absorption(colour.b, depth));
    struct colour rest = colour_sub(extinction, out->transmission_scattering);
    phong->absorption = colour_sub(rest, colour_all(math_min(math_min(math_min(rest.r, rest.g), rest.b), 0)));
}

static bool openpbr(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    struct openpbr *numbers;
    if (args[TRANSMISSION_DEPTH].number > 0 && args[TRANSMISSION_COLOUR].texture)
        return error_set(error, ERROR_SCENE, "transmission_color must be a colour where transmission_depth is above 0");
    if (args[OPENPBR_GLASS].given && (args[SPECULAR_IOR].given || args[TRANSMISSION_DISPERSION_ABBE].given))
        return error_set(error, ERROR_SCENE, "glass has an index and a dispersion of its own: %s is not needed",
                         args[SPECULAR_IOR].given ? "specular_ior" : "transmission_dispersion_abbe_number");
    if (!tangent_is_fine(&openpbr_parameters[GEOMETRY_TANGENT], &args[GEOMETRY_TANGENT], error) ||
        !tangent_is_fine(&openpbr_parameters[GEOMETRY_COAT_TANGENT], &args[GEOMETRY_COAT_TANGENT], error))
        return false;
    struct material *m = layered(context, &numbers, error);
    if (!m)
        return false;
    set_numbers(args, numbers, &m->phong);
    result->pointer = m;
    return with_textures(context, m, args, error) && with_normal(context, m, false, &args[GEOMETRY_NORMAL], error) &&
           with_normal(context, m, true, &args[GEOMETRY_COAT_NORMAL], error);
}

#define METAL_WORD(name, ...) " " name
enum {
    METAL_NAME,
    METAL_ROUGHNESS,
    METAL_ANISOTROPY,
    METAL_TANGENT,
    METAL_NORMAL,
    METAL_GLOSSY_SAMPLES,
    METAL_CLASSIC
};
static const struct script_parameter metal_parameters[] = {
    [METAL_NAME] = {"metal", KIND_CHOICE, 0, 0, 0, &(METALS(METAL_WORD))[1], NULL, NULL, "Its name."},
    [METAL_ROUGHNESS] = SHARE("roughness", "0", "Roughness; 0 is polished."),
    [METAL_ANISOTROPY] = SHARE("anisotropy", "0", "How much smoother it is along the tangent than across."),
    [METAL_TANGENT] = {"tangent", KIND_DIRECTION, OPTIONAL, ANY, NULL, "along u", TANGENT_HELP},
    [METAL_NORMAL] = {"normal", KIND_IMAGE, OPTIONAL | OR_TEXTURE, ANY, NULL, "none", NORMAL_HELP},
    [METAL_GLOSSY_SAMPLES] = SAMPLES,
    [METAL_CLASSIC] = CLASSIC,
};

struct metal {
    struct colour f0, tint;
};
#define METAL(name, r, g, b, tint_r, tint_g, tint_b) {{r, g, b}, {tint_r, tint_g, tint_b}},
static const struct metal metals[] = {METALS(METAL)};

static bool metal(struct script_context *context, const struct script_value *args, struct script_result *result,
                  struct error *error) {
    struct openpbr *numbers;
    const struct metal *known = &metals[args[METAL_NAME].choice];
    if (!tangent_is_fine(&metal_parameters[METAL_TANGENT], &args[METAL_TANGENT], error))
        return false;
    struct material *m = layered(context, &numbers, error);
    if (!m)
        return false;
    numbers->base_metalness = 1;
    numbers->specular_anisotropy = args[METAL_ANISOTROPY].number;
    numbers->classic = args[METAL_CLASSIC].boolean;
    numbers->tangent = args[METAL_TANGENT].vector;
    m->phong.kd = known->f0;
    m->phong.ks = known->tint;
    m->phong.reflect = 1;
    m->phong.roughness = args[METAL_ROUGHNESS].number;
    m->phong.glossy_samples = (int)args[METAL_GLOSSY_SAMPLES].number;
    result->pointer = m;
    return with_texture(context, m, INPUT_ROUGHNESS, true, &args[METAL_ROUGHNESS], error) &&
           with_texture(context, m, INPUT_SPECULAR_ANISOTROPY, true, &args[METAL_ANISOTROPY], error) &&
           with_normal(context, m, false, &args[METAL_NORMAL], error);
}

static const struct script_function rows[] = {
    GR("openpbr_material", openpbr_parameters, RESULT_MATERIAL, openpbr,
       "A layered surface of metal, glass, glossy diffuse, clear coat and fuzz: OpenPBR Surface 1.1.", "base_color?"),
    GR("metal_material", metal_parameters, RESULT_MATERIAL, metal, "A metal with its measured reflectance.",
       "metal roughness?"),
};

const struct function_rows layered_functions = {rows, COUNT(rows)};
