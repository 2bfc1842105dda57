/* Layers, from the top: fuzz, coat, then metal mixed with a dielectric, which is glossy over diffuse or transmits
 * light. The light that a layer does not reflect for the view direction goes to the layers below it ("albedo
 * scaling"). So the sum is not reciprocal, but no light is lost: white layers reflect or transmit all of it. The
 * albedos are those of albedo_internal.h, for smooth layers those of Fresnel's formula.
 *
 * Where the specification leaves a choice: The colour of the coat multiplies the light from below. Darkening affects
 * metal and diffuse light separately, each with its own albedo. It uses the mean reflectance of the coat from inside
 * for diffuse light, and the one for the view direction for smooth metal, which is exact for both. specular_weight
 * changes the index for reflection and refraction. transmission_color without a depth tints each passage through the
 * surface.
 *
 * From inside of a solid, the layers are behind the surface. What they do not reflect in the direction of the refracted
 * view leaves through them; the rest is turned back, as by a mirror with the facets of the surface. Each passage has
 * the square root of the coat's colour. The opaque part of a base that transmits light has no reflecting surface on
 * this side: light inside is already in it.
 *
 * Light under the surface takes the place of diffuse light (subsurface.h): the layers above take their share where the
 * view goes in, none where it comes out. */
#include "material/openpbr.h"

#include "material/albedo_internal.h"
#include "material/bump.h"
#include "material/material_eval.h"
#include "material/microfacet_internal.h"
#include "material/rough_lobes_internal.h"

#include <stddef.h>

/* Surfaces with a lower roughness are smooth. */
static const double smooth_roughness = 0x1p-10;

/* Beside the angle of total reflection the tables have errors of a few percent: a share that is far too small would
 * make light that is transmitted there rare and bright. */
static const double min_glass_share = 1.0 / 32;

struct openpbr openpbr_defaults(void) {
    return (struct openpbr){.base_weight = 1,
                            .specular_weight = 1,
                            .specular_ior = 1.5,
                            .transmission_colour = {1, 1, 1},
                            .subsurface_colour = {0.8, 0.8, 0.8},
                            .subsurface_radius = 1,
                            .subsurface_radius_scale = {1, 0.5, 0.25},
                            .coat_colour = {1, 1, 1},
                            .coat_ior = 1.6,
                            .coat_darkening = 1,
                            .fuzz_colour = {1, 1, 1},
                            .fuzz_roughness = 0.5,
                            .film_thickness = 0.5,
                            .film_ior = 1.4};
}

double openpbr_ior(double ior, double specular_weight) {
    double root = (ior - 1) / (ior + 1), scaled = sqrt(specular_weight) * root;
    scaled = scaled > 0.99 ? 0.99 : scaled < -0.99 ? -0.99 : scaled;
    return specular_weight == 1 ? ior : (1 + scaled) / (1 - scaled);
}

/* Head on. */
static double reflectance(double ior) {
    return (ior - 1) * (ior - 1) / ((ior + 1) * (ior + 1));
}

/* A highlight stands for the mirror image of a light, spread by the roughness: (e + 8) / 8 is Blinn's normalisation,
 * and a quarter of his exponent looks alike in Phong's formula. ks also filters reflections, whose amount makes up for
 * it.
 */
void openpbr_classic(struct surface_material *material, const struct texture *textures[INPUT_COUNT]) {
    static const struct texture black = {.operation.kind = TEXTURE_CONSTANT, .source = "", .depth = 1, .size = 1};
    const double largest = 0.8, matt = 0.45; /* weight of a highlight; roughness from where no ray is reflected */
    const double smooth = 0.05;              /* below it a mirror looks alike */
    const struct openpbr *v = &material->openpbr;
    struct phong *out = &material->phong, numbers = *out;
    bool textured = textures[INPUT_KD] != NULL;
    double metal = !textured ? v->base_metalness : v->base_metalness > 0.5, through = (1 - metal) * numbers.refract;
    if (!v->classic || textures[INPUT_METALNESS] || textures[INPUT_REFRACT] || textures[INPUT_SUBSURFACE_WEIGHT] ||
        textures[INPUT_SUBSURFACE_COLOUR] || v->film_weight > 0 || textures[INPUT_FILM_WEIGHT])
        return;
    material->has_layers = false;
    double coat = v->coat_weight * reflectance(v->coat_ior);
    double gloss = reflectance(openpbr_ior(v->specular_ior, v->specular_weight)) * colour_max_abs(numbers.ks);
    double roughness = v->coat_weight > 0.5 ? v->coat_roughness : numbers.roughness;
    double width = math_max(roughness * roughness, 0.03), exponent = 2 / (width * width) - 2,
           share = math_min(gloss + coat, 1);
    double weight = math_min(share * (exponent + 8) / 8, largest);
    struct colour colour = colour_scale(numbers.kd, v->base_weight * (1 - v->subsurface_weight));
    colour = colour_min(colour_add_scaled(colour, v->subsurface_colour, v->subsurface_weight), colour_all(1));
    out->shininess = exponent / 4;
    if (through > 0) {
        double reflected = v->thin_walled ? 2 * gloss / (1 + gloss) : gloss;
        material->fresnel = material->fresnel || (through >= 1 && !v->thin_walled);
        out->kd = colour_scale(colour, (1 - through) * (1 - gloss));
        out->ks = v->deep ? colour_all(1) : colour_min(v->transmission_colour, colour_all(1));
        out->reflect = reflected;
        out->refract = through * (1 - reflected);
        return;
    }
    const double cover = 0.35 * v->fuzz_weight; /* of the fuzz, seen from all sides */
    struct colour coated = colour_add(colour_scale(v->coat_colour, v->coat_weight), colour_all(1 - v->coat_weight));
    struct colour below = colour_scale(colour_mul(colour, colour_min(coated, colour_all(1))), 1 - cover);
    struct colour fuzz = colour_scale(colour_min(v->fuzz_colour, colour_all(1)), cover);
    out->kd = colour_scale(colour_add(below, fuzz), (1 - metal) * (1 - share));
    out->ks = colour_add(colour_scale(colour_all(weight), 1 - metal), colour_scale(colour, metal));
    out->reflect = metal + (1 - metal) * (roughness < matt && weight > 0 ? math_min(share / weight, 1) : 0);
    out->roughness = out->reflect > 0 && roughness > smooth ? roughness : 0;
    double rays = out->glossy_samples > 0 ? out->glossy_samples : 4; /* N of N x N; fewer show a small share as well */
    out->glossy_samples =
        (int)math_min(math_max(floor(0.75 * rays * sqrt(metal + (1 - metal) * share) + 0.5), 1), rays);
    if (textured && metal > 0) { /* its colour is that of reflections */
        textures[INPUT_KS] = textures[INPUT_KD];
        textures[INPUT_KD] = &black;
        out->kd = colour;
    }
}

/* --- inputs --- */

void openpbr_read(const struct surface_tables *tables, const struct surface_material *material, const struct hit *hit,
                  struct openpbr *values) {
    static const struct {
        enum material_input input;
        bool is_colour;
        size_t field;
    } rows[] = {
        {INPUT_BASE_WEIGHT, false, offsetof(struct openpbr, base_weight)},
        {INPUT_DIFFUSE_ROUGHNESS, false, offsetof(struct openpbr, base_diffuse_roughness)},
        {INPUT_METALNESS, false, offsetof(struct openpbr, base_metalness)},
        {INPUT_SPECULAR_WEIGHT, false, offsetof(struct openpbr, specular_weight)},
        {INPUT_SPECULAR_ANISOTROPY, false, offsetof(struct openpbr, specular_anisotropy)},
        {INPUT_SPECULAR_IOR, false, offsetof(struct openpbr, specular_ior)},
        {INPUT_TRANSMISSION_COLOUR, true, offsetof(struct openpbr, transmission_colour)},
        {INPUT_SUBSURFACE_WEIGHT, false, offsetof(struct openpbr, subsurface_weight)},
        {INPUT_SUBSURFACE_COLOUR, true, offsetof(struct openpbr, subsurface_colour)},
        {INPUT_SUBSURFACE_RADIUS, false, offsetof(struct openpbr, subsurface_radius)},
        {INPUT_COAT_WEIGHT, false, offsetof(struct openpbr, coat_weight)},
        {INPUT_COAT_COLOUR, true, offsetof(struct openpbr, coat_colour)},
        {INPUT_COAT_ROUGHNESS, false, offsetof(struct openpbr, coat_roughness)},
        {INPUT_COAT_ANISOTROPY, false, offsetof(struct openpbr, coat_anisotropy)},
        {INPUT_COAT_IOR, false, offsetof(struct openpbr, coat_ior)},
        {INPUT_COAT_DARKENING, false, offsetof(struct openpbr, coat_darkening)},
        {INPUT_FUZZ_WEIGHT, false, offsetof(struct openpbr, fuzz_weight)},
        {INPUT_FUZZ_COLOUR, true, offsetof(struct openpbr, fuzz_colour)},
        {INPUT_FUZZ_ROUGHNESS, false, offsetof(struct openpbr, fuzz_roughness)},
        {INPUT_FILM_WEIGHT, false, offsetof(struct openpbr, film_weight)},
        {INPUT_FILM_THICKNESS, false, offsetof(struct openpbr, film_thickness)},
    };
    if (material->plain)
        return;
    /* Each input that has a texture is read at the hit. */
    struct texture_reader reader;
    texture_reader_init(&reader, hit, &tables->textures, NULL);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        uint32_t program = material->inputs[rows[i].input];
        char *field = (char *)values + rows[i].field;
        if (program == TEXTURE_NONE)
            continue;
        if (rows[i].is_colour)
            *(struct colour *)(void *)field = texture_read(program, &reader);
        else
            *(double *)(void *)field = texture_read(program, &reader).r;
    }
}

/* --- layers --- */

/* The light that the layers above transmit. */
struct layering {
    const struct openpbr *values;
    const struct surface_inputs *inputs;
    struct bsdf *bsdf;
    struct colour left;   /* the fraction of light that arrives at the layer; its way back is included */
    struct colour passes; /* the same without the way back, for light that passes the layers to or from the inside */
    struct colour turned; /* from inside: the fraction of light leaving the base that the layers turn back */
    struct colour mirror; /* of all smooth layers together */
    struct vec3 view, dpdu;
    struct vec3 coat_side; /* the normal of the coat */
    bool coat_turns;       /* it is not that of the base */
    double cosine;         /* of the view to the normal */
    double outside;        /* refractive index of the surrounding medium */
    bool inside;           /* of the solid, if it transmits light */
    int facets;            /* used of bsdf->facets */
    /* The effect of the coat on light from below: the fraction of the base under it, its reflectance for the view
     * direction, and its mean reflectance from inside. */
    double coated, coat_sees, coat_inside;
};

static void add(struct layering *l, enum lobe_kind kind, struct colour weight, double share) {
    if (colour_is_black(weight) || !(share > 0))
        return;
    struct lobe *lobe = &l->bsdf->lobes[l->bsdf->count++];
    lobe->kind = kind;
    lobe->facets = l->facets - 1;
    lobe->weight = weight;
    lobe->exponent = 0;
    lobe->share = share;
}

static void add_matt(struct layering *l, enum lobe_kind kind, struct colour weight, double roughness) {
    int count = l->bsdf->count;
    add(l, kind, weight, 1);
    if (l->bsdf->count > count)
        l->bsdf->lobes[count].exponent = roughness;
}

static struct bsdf_facets *add_facets_on(struct layering *l, struct vec3 side, struct vec3 tangent, double roughness,
                                         double anisotropy) {
    struct bsdf_facets *facets = &l->bsdf->facets[l->facets++];
    bsdf_facets_shape(facets, side, vec3_max_abs(tangent) == 0 ? l->dpdu : tangent, roughness, anisotropy);
    return facets;
}

static struct bsdf_facets *add_facets(struct layering *l, struct vec3 tangent, double roughness, double anisotropy) {
    return add_facets_on(l, l->bsdf->side, tangent, roughness, anisotropy);
}

static void add_fuzz(struct layering *l) {
    const struct openpbr *v = l->values;
    if (!(v->fuzz_weight > 0) || l->inside)
        return;
    double albedo = albedo_fuzz(l->cosine, v->fuzz_roughness);
    add_matt(l, LOBE_FUZZ, colour_scale(colour_mul(l->left, v->fuzz_colour), v->fuzz_weight), v->fuzz_roughness);
    l->left = l->passes = colour_scale(l->left, 1 - v->fuzz_weight * albedo);
}

static struct colour root(struct colour c) {
    return colour_make(sqrt(math_max(c.r, 0)), sqrt(math_max(c.g, 0)), sqrt(math_max(c.b, 0)));
}

/* The share of light that passes a coat with this reflectance and colour. */
static struct colour through_coat(const struct openpbr *v, struct colour colour, double reflected) {
    struct colour transmits = colour_scale(colour, 1 - reflected);
    return colour_add(colour_scale(transmits, v->coat_weight), colour_all(1 - v->coat_weight));
}

/* The normal of the coat on the side of the view; that of the base where it has none of its own. */
static void set_coat_side(struct layering *l, const struct surface_tables *tables,
                          const struct surface_material *material, const struct hit *hit) {
    struct vec3 normal = hit->normal;
    l->coat_side = l->bsdf->side;
    l->coat_turns = material->bump_count > 0 && bump_turn_coat(tables, material, hit, &normal);
    if (!l->coat_turns)
        return;
    l->coat_side = hit->front ? normal : vec3_negate(normal);
    if (!(vec3_dot(l->coat_side, l->view) > 0))
        l->coat_side = l->bsdf->geometric_side;
}

static void add_coat(struct layering *l) {
    const struct openpbr *v = l->values;
    double eta = l->outside / v->coat_ior;
    l->coated = 0;
    if (!(v->coat_weight > 0) || l->inside)
        return;
    double cosine = l->coat_turns ? math_min(vec3_dot(l->coat_side, l->view), 1) : l->cosine;
    double reflected = dielectric_fresnel(cosine, eta);
    l->coated = v->coat_weight;
    l->coat_sees = reflected;
    l->coat_inside = dielectric_fresnel_average(1 / eta);
    if (v->coat_roughness < smooth_roughness && l->coat_turns) {
        (void)add_facets_on(l, l->coat_side, v->coat_tangent, smooth_roughness, 0);
        add(l, LOBE_COAT, colour_scale(l->left, v->coat_weight * reflected), 1);
    } else if (v->coat_roughness < smooth_roughness) {
        l->mirror = colour_add_scaled(l->mirror, l->left, v->coat_weight * reflected);
    } else if (eta != 1) {
        struct bsdf_facets *facets =
            add_facets_on(l, l->coat_side, v->coat_tangent, v->coat_roughness, v->coat_anisotropy);
        bsdf_facets_boundary(facets, eta);
        bsdf_facets_see(facets, l->view);
        reflected = facets->reflected;
        add(l, LOBE_GLOSS, colour_scale(l->left, v->coat_weight), reflected);
    }
    if (l->inputs->refract > 0)
        l->passes = colour_mul(l->left, through_coat(v, root(v->coat_colour), reflected));
    l->left = colour_mul(l->left, through_coat(v, v->coat_colour, reflected));
}

/* The coat and the fuzz as light from inside meets them. Facets of the base spread it; those of the roughness 1 over
 * all directions, whose mean cosine is 2/3. */
static void turn_back(struct layering *l, double eta, double roughness) {
    const struct openpbr *v = l->values;
    double across = eta * eta * (1 - l->cosine * l->cosine), cosine = across < 1 ? sqrt(1 - across) : 0;
    double coat_eta = l->outside / (eta * v->coat_ior), reflected = 0, fuzz = 0;
    cosine += roughness * (2.0 / 3 - cosine);
    if (v->coat_weight > 0)
        reflected = v->coat_roughness < smooth_roughness || coat_eta == 1
                        ? dielectric_fresnel(cosine, coat_eta)
                        : albedo_reflection(cosine, v->coat_roughness, coat_eta);
    if (v->fuzz_weight > 0)
        fuzz = v->fuzz_weight * albedo_fuzz(cosine, v->fuzz_roughness);
    struct colour colour = root(v->coat_colour), passes = through_coat(v, colour, reflected);
    struct colour back = colour_mul(passes, through_coat(v, colour, 0));
    l->passes = colour_scale(passes, 1 - fuzz);
    l->turned = colour_scale(v->coat_colour, v->coat_weight * reflected);
    l->turned = colour_add(l->turned, colour_scale(colour_mul(back, v->fuzz_colour), fuzz));
}

/* Light from a layer with this albedo that the coat reflects back to it; the coat covers the fraction k of the
 * layer. */
static double darkened(const struct layering *l, double albedo, double k) {
    double factor = (1 - k) / (1 - (albedo < 1 ? albedo : 1) * k), amount = l->coated * l->values->coat_darkening;
    return 1 + amount * (factor - 1);
}
static struct colour darken(const struct layering *l, struct colour colour, struct colour albedo, double k) {
    if (!(l->coated > 0))
        return colour;
    return colour_mul(colour,
                      colour_make(darkened(l, albedo.r, k), darkened(l, albedo.g, k), darkened(l, albedo.b, k)));
}

/* A rough coat blurs the light from below. */
static double roughness_below(const struct layering *l) {
    double own = l->inputs->roughness, coat = l->values->coat_roughness;
    own = own > 0 ? own < 1 ? own : 1 : 0;
    if (!(l->values->coat_weight > 0) || !(coat > 0))
        return own;
    double both = own * own * own * own + 2 * coat * coat * coat * coat;
    both = both < 1 ? sqrt(sqrt(both)) : 1;
    return own + l->values->coat_weight * (both - own);
}

/* The film of the base: below the coat, or on the other side of the surface for light inside. */
static void set_film(struct layering *l, double wavelength) {
    const struct openpbr *v = l->values;
    bool there = v->film_weight > 0 && v->film_thickness > 0;
    l->bsdf->film.weight = there ? math_min(v->film_weight, 1) : 0;
    if (!there)
        return;
    l->bsdf->film.thickness = v->film_thickness;
    l->bsdf->film.ior = math_max(v->film_ior, 0.01);
    l->bsdf->film.before = l->outside + l->coated * (v->coat_ior - l->outside);
    l->bsdf->film.wavelength = wavelength;
}

static bool has_film(const struct layering *l) {
    return l->bsdf->film.weight > 0;
}

static struct colour metal_reflects(const struct layering *l, const struct bsdf_facets *facets, double cosine) {
    struct colour bare = bsdf_metal_fresnel(facets, cosine);
    return has_film(l) ? thin_film_metal(&l->bsdf->film, cosine, bare) : bare;
}

/* Over the hemisphere, at equal steps of the squared cosine where there is a film. */
static struct colour metal_average(const struct layering *l, const struct bsdf_facets *facets) {
    enum { COSINES = 3 };
    struct colour sum = {0, 0, 0};
    if (!has_film(l))
        return bsdf_metal_fresnel_average(facets);
    for (int i = 0; i < COSINES; i++)
        sum = colour_add_scaled(sum, metal_reflects(l, facets, sqrt((i + 0.5) / COSINES)), 1.0 / COSINES);
    return sum;
}

/* Facets that reflect as metal; light that hits several of them is included. */
static void add_metal_facets(struct layering *l, struct bsdf_facets *facets, struct colour mean, struct colour weight) {
    bsdf_facets_see(facets, l->view);
    double once = 1 - facets->lack_seen, average = 1 - facets->lack;
    add(l, has_film(l) ? LOBE_FILM : LOBE_METAL, weight, colour_max_abs(mean) * once);
    struct colour multiple = {mean.r * mean.r * average / (1 - mean.r * facets->lack),
                              mean.g * mean.g * average / (1 - mean.g * facets->lack),
                              mean.b * mean.b * average / (1 - mean.b * facets->lack)};
    add(l, LOBE_FACETS_MULTIPLE, colour_mul(weight, multiple), 1 - once);
}

static void add_metal(struct layering *l, double roughness) {
    const struct openpbr *v = l->values;
    if (!(v->base_metalness > 0))
        return;
    struct colour weight = colour_scale(l->left, v->base_metalness * (v->specular_weight < 1 ? v->specular_weight : 1));
    struct bsdf_facets *facets =
        add_facets(l, v->tangent, math_max(roughness, smooth_roughness), v->specular_anisotropy);
    bsdf_facets_metal(facets, colour_scale(l->inputs->kd, v->base_weight), l->inputs->ks);
    struct colour mean = metal_average(l, facets);
    weight = darken(l, weight, mean, l->coat_sees + roughness * (l->coat_inside - l->coat_sees));
    if (roughness < smooth_roughness) {
        l->mirror = colour_add(l->mirror, colour_mul(weight, metal_reflects(l, facets, l->cosine)));
        return;
    }
    add_metal_facets(l, facets, mean, weight);
}

static void add_diffuse(struct layering *l, struct colour left) {
    const struct openpbr *v = l->values;
    struct colour colour = colour_scale(l->inputs->kd, v->base_weight);
    left = darken(l, left, colour, l->coat_inside);
    if (!(v->base_diffuse_roughness > 0)) {
        add_matt(l, LOBE_DIFFUSE, colour_mul(left, colour), 0);
        return;
    }
    struct colour multiple = bsdf_oren_nayar_multiple(colour, v->base_diffuse_roughness);
    add_matt(l, LOBE_OREN_NAYAR, colour_mul(left, colour), v->base_diffuse_roughness);
    add_matt(l, LOBE_OREN_NAYAR_MULTIPLE, colour_mul(left, multiple), v->base_diffuse_roughness);
}

/* The mean free path below a radius is too short for points near the hit to differ. */
static const double fewest_offsets = 64;

/* Where the light that goes under the surface comes out: elsewhere, if someone walks there; of a thin wall, on both
 * sides; else here, as of the radius 0. */
static void add_subsurface(struct layering *l, const struct hit *hit, bool walks, struct colour left) {
    const struct openpbr *v = l->values;
    struct colour colour = colour_min(v->subsurface_colour, colour_all(1));
    struct colour radius = colour_scale(v->subsurface_radius_scale, v->subsurface_radius);
    double longest = colour_max_abs(radius);
    struct colour all = darken(l, colour_mul(left, colour), colour, l->coat_inside);
    if (walks && v->thin_walled) {
        add_matt(l, LOBE_DIFFUSE, colour_scale(all, (1 - v->subsurface_anisotropy) / 2), 0);
        add_matt(l, LOBE_DIFFUSE_THROUGH, colour_scale(all, (1 + v->subsurface_anisotropy) / 2), 0);
        return;
    }
    bool goes_in = walks && hit->front && !(hit->behind > 0) && longest > fewest_offsets * hit->offset;
    add_matt(l, goes_in ? LOBE_SUBSURFACE : LOBE_DIFFUSE, all, 0);
    l->bsdf->subsurface =
        (struct subsurface){colour, colour_max(radius, colour_all(longest / 1024)), v->subsurface_anisotropy};
}

/* Diffuse light, and that from under the surface in its place. */
static void add_opaque(struct layering *l, const struct hit *hit, bool walks, struct colour left) {
    double share = math_min(l->values->subsurface_weight, 1);
    if (share > 0) {
        l->bsdf->albedo =
            colour_add_scaled(colour_scale(l->bsdf->albedo, 1 - share), l->values->subsurface_colour, share);
        add_subsurface(l, hit, walks, colour_scale(left, share));
    }
    if (share < 1)
        add_diffuse(l, share > 0 ? colour_scale(left, 1 - share) : left);
}

/* A smooth surface transmits the light that it does not reflect. */
static void add_smooth_passage(struct layering *l, const struct hit *hit, struct colour left) {
    struct bsdf *bsdf = l->bsdf;
    bsdf->transmits = l->values->thin_walled || bsdf_refract(bsdf, hit->view, &bsdf->through);
    if (l->values->thin_walled)
        bsdf->through = vec3_negate(hit->view);
    if (bsdf->transmits)
        add(l, LOBE_REFRACTION, left, 1);
}

/* An infinitely thin wall: both of its sides together. */
static void add_pane(struct layering *l, const struct hit *hit, struct colour left, double eta, double roughness) {
    struct colour tint = colour_mul(left, l->values->transmission_colour);
    struct colour reflects = colour_mul(left, l->inputs->ks);
    struct colour share = has_film(l) ? thin_film_pane(&l->bsdf->film, l->cosine, eta)
                                      : colour_all(bsdf_pane_reflectance(dielectric_fresnel(l->cosine, eta)));
    struct colour rest = colour_sub(colour_all(1), share);
    if (roughness < smooth_roughness || eta == 1) {
        l->mirror = colour_add(l->mirror, colour_mul(reflects, share));
        add_smooth_passage(l, hit, colour_mul(tint, rest));
        return;
    }
    struct bsdf_facets *facets = add_facets(l, l->values->tangent, roughness, l->values->specular_anisotropy);
    bsdf_facets_pane(facets, eta);
    bsdf_facets_see(facets, l->view);
    double lack = facets->lack_seen;
    add(l, has_film(l) ? LOBE_FILM : LOBE_GLOSS, reflects, colour_max_abs(share));
    add(l, has_film(l) ? LOBE_FILM_PANE : LOBE_PANE, tint, colour_max_abs(rest));
    add(l, LOBE_FACETS_MULTIPLE, left, lack * (1 - facets->through));
    add(l, LOBE_FACETS_THROUGH, tint, lack * facets->through);
}

/* The light that the part which transmits receives, for what it transmits. */
static struct colour let_through(const struct layering *l) {
    const struct openpbr *v = l->values;
    struct colour through = colour_scale(colour_scale(l->passes, 1 - v->base_metalness), l->inputs->refract);
    return v->deep ? through : colour_mul(through, v->transmission_colour);
}

/* Rough boundaries transmit light to the other side; `all` is the light for what they reflect. lost: the colour of what
 * single facets lose. */
static void add_rough_passage(struct layering *l, struct bsdf_facets *facets, struct colour all, struct colour lost) {
    struct colour through = let_through(l);
    /* It leaves after several of them, to this side or the other. */
    double lack = facets->lack_seen, single = 1 - facets->reflected - lack;
    add(l, has_film(l) ? LOBE_FILM_GLASS : LOBE_GLASS, through, math_max(single, min_glass_share));
    add(l, LOBE_FACETS_MULTIPLE, colour_mul(all, lost), lack * (1 - facets->through));
    add(l, LOBE_FACETS_THROUGH, colour_mul(through, lost), lack * facets->through);
    if (colour_is_black(l->turned))
        return;
    struct bsdf_facets *turning = &l->bsdf->facets[l->facets++];
    *turning = *facets;
    bsdf_facets_metal(turning, colour_all(1), colour_all(1));
    add_metal_facets(l, turning, colour_all(1),
                     colour_scale(colour_mul(all, l->turned), math_max(single, 0) + lack * facets->through));
}

/* What the facets of a rough boundary reflect, and the colour of what they lose. */
static struct colour rough_reflects(const struct layering *l, struct bsdf_facets *facets, struct colour *lost) {
    if (has_film(l)) {
        struct colour reflected = bsdf_facets_see_film(facets, &l->bsdf->film, l->view, lost);
        facets->reflected = colour_max_abs(reflected);
        return reflected;
    }
    bsdf_facets_see(facets, l->view);
    *lost = colour_all(1);
    return colour_all(facets->reflected);
}

/* The fraction of the surface that transmits light, and the rest, which is diffuse under a glossy layer. */
static void add_dielectric(struct layering *l, const struct hit *hit, bool walks, double eta, double roughness) {
    const struct openpbr *v = l->values;
    struct colour all = colour_scale(l->left, 1 - v->base_metalness);
    double clear = l->inputs->refract;
    if (colour_is_black(all))
        return;
    /* A thin pane lets light through without a change of direction. */
    if (v->thin_walled && clear > 0) {
        add_pane(l, hit, colour_scale(all, clear), eta, roughness);
        all = colour_scale(all, 1 - clear);
        clear = 0;
    }
    /* Light inside is in the opaque part already. */
    double opaque = 1 - clear;
    struct colour reflected, rest, lost;
    struct colour boundary = l->inside ? colour_scale(all, clear) : all;
    if (roughness < smooth_roughness || eta == 1) {
        reflected = has_film(l) ? thin_film_boundary(&l->bsdf->film, l->cosine, eta)
                                : colour_all(dielectric_fresnel(l->cosine, eta));
        rest = colour_sub(colour_all(1), reflected);
        l->mirror = colour_add(l->mirror, colour_mul(colour_mul(boundary, l->inputs->ks), reflected));
        if (clear > 0)
            add_smooth_passage(l, hit, colour_mul(let_through(l), rest));
        if (l->inside)
            l->mirror = colour_add(l->mirror, colour_mul(colour_mul(boundary, l->turned), rest));
    } else {
        struct bsdf_facets *facets = add_facets(l, v->tangent, roughness, v->specular_anisotropy);
        if (clear > 0)
            bsdf_facets_glass(facets, eta);
        else
            bsdf_facets_boundary(facets, eta);
        reflected = rough_reflects(l, facets, &lost);
        rest = colour_sub(colour_all(1), reflected);
        add(l, has_film(l) ? LOBE_FILM : LOBE_GLOSS, colour_mul(boundary, l->inputs->ks), facets->reflected);
        if (clear > 0)
            add_rough_passage(l, facets, colour_scale(all, clear), lost);
    }
    /* Under the reflection is the opaque base. */
    if (opaque > 0)
        add_opaque(l, hit, walks, l->inside ? colour_scale(all, opaque) : colour_mul(all, colour_scale(rest, opaque)));
}

/* Of an opaque base: relative to the surrounding medium or to the coat. A coat that is denser than the base would
 * cause total reflection; as in the specification, the ratio of indices is then inverted. */
static double relative_index(const struct layering *l) {
    double base = l->values->specular_ior, bare = base / l->outside, below = base / l->values->coat_ior;
    below = below < 1 ? 1 / below : below;
    return bare + l->coated * (below - bare);
}

void openpbr_eval(const struct surface_tables *tables, const struct hit *hit, const struct medium_stack *media,
                  const struct material_context *context, const struct surface_inputs *inputs, struct bsdf *bsdf) {
    static const struct medium_stack air = {.count = 0};
    const struct surface_material *material = &tables->materials[hit->material];
    struct openpbr values = material->openpbr;
    openpbr_read(tables, material, hit, &values);
    values.thin_walled = values.thin_walled || context->thin;
    media = media ? media : &air;
    values.specular_ior = values.specular_ior > 0.01 ? values.specular_ior : 0.01; /* textures may be black */
    values.coat_ior = values.coat_ior > 0.01 ? values.coat_ior : 0.01;
    if (media->wavelength > 0)
        values.specular_ior =
            dispersion_ior(material->phong.dispersion, values.specular_ior, (double)media->wavelength);
    bool is_solid = inputs->refract > 0 && !values.thin_walled;
    struct layering l = {.values = &values, .inputs = inputs, .bsdf = bsdf, .view = hit->view, .dpdu = hit->dpdu};
    l.left = l.passes = colour_all(1);
    l.mirror = l.turned = colour_all(0);
    l.cosine = vec3_dot(bsdf->side, hit->view);
    l.cosine = l.cosine < 1 ? l.cosine : 1;
    l.inside = !values.thin_walled && !hit->front && (is_solid || medium_stack_has(media, hit->solid));
    l.outside = medium_stack_ior(media);
    bsdf->lit = bsdf->side;
    bsdf->dark = false;
    bsdf->alpha = 0;
    bsdf->eta = 1;
    bsdf->fresnel = -1;
    bsdf->fresnel_of_facets = false;
    bsdf->transmits = false;
    bsdf->glossy_samples = inputs->glossy_samples;
    double ior = openpbr_ior(values.specular_ior, values.specular_weight);
    bsdf->boundary.solid = hit->solid;
    bsdf->boundary.ior = ior;
    bsdf->boundary.tint = values.deep ? colour_all(1) : values.transmission_colour;
    bsdf->boundary.entering = hit->front;
    bsdf->boundary.thin = !is_solid;
    if (is_solid)
        bsdf->eta = context->joint ? context->joint->eta : medium_stack_eta(media, &bsdf->boundary);
    add_fuzz(&l);
    if (values.coat_weight > 0)
        set_coat_side(&l, tables, material, hit);
    add_coat(&l);
    set_film(&l, (double)media->wavelength);
    bsdf->emission = colour_mul(inputs->emission, l.left);
    double eta = is_solid ? bsdf->eta : 1 / openpbr_ior(relative_index(&l), values.specular_weight);
    double roughness = roughness_below(&l);
    bsdf->passes = inputs->refract > 0 && values.base_metalness < 1;
    bsdf->behind = context->joint ? context->joint->behind : NULL;
    bsdf->roughness = inputs->refract < 1 ? 2 : roughness;
    if (l.inside && is_solid)
        turn_back(&l, eta, roughness);
    add_metal(&l, roughness);
    add_dielectric(&l, hit, context->walks, eta, roughness);
    add(&l, LOBE_MIRROR, l.mirror, 1);
}
