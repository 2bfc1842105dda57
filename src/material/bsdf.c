/* The lobes, each with its formula (classic ones), density and sampling, and sums over lists of them.
 *
 * A classic lobe is its formula of docs/language.md 5.2 over pi as f |cos|. The GGX lobes are those of Walter,
 * Marschner, Li, Torrance, "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, with the masking of
 * both directions together (Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 2014,
 * equation 99). Facets are sampled by their visibility from wo, so the weight of a sample is the masking of the other
 * direction. Fresnel reflectance and total reflection are those of the facet. Light that meets a second facet is
 * lost. */
#include "material/bsdf.h"

#include "material/classic.h"
#include "material/rough_lobes_internal.h"
#include "math/elementary.h"
#include "math/frame.h"

#include <stddef.h>

const char *lobe_name(enum lobe_kind kind) {
#define LOBE_NAME(kind, name, flags) [kind] = (name),
    static const char *const names[] = {LOBES(LOBE_NAME)};
#undef LOBE_NAME
    return names[kind];
}

uint32_t bsdf_lobes_with(const struct bsdf *bsdf, unsigned flags) {
    uint32_t lobes = 0;
    for (int i = 0; i < bsdf->count; i++)
        lobes |= lobe_flags(bsdf->lobes[i].kind) & flags ? UINT32_C(1) << i : 0;
    return lobes;
}

/* --- classic lobes --- */

/* Power with the usual small whole exponents done by multiplication would be faster but rounds differently for
 * neighbouring exponents; el_pow is the same function for all. 0^0 = 1, as old scenes with shininess 0 expect. */
static double lobe_power(double cosine, double exponent) {
    return el_pow(cosine, exponent);
}

static double phong_formula(const struct lobe *lobe, struct vec3 normal, double n_l, struct vec3 wo, struct vec3 wi) {
    double r_v = vec3_dot(vec3_sub(vec3_scale(normal, 2 * n_l), wi), wo);
    return r_v > 0 ? lobe_power(r_v, lobe->exponent) : 0;
}

static double blinn_formula(const struct lobe *lobe, struct vec3 normal, struct vec3 wo, struct vec3 wi) {
    double n_h = vec3_dot(normal, vec3_normalize(vec3_add(wi, wo)));
    return n_h > 0 ? lobe_power(n_h, lobe->exponent) : 0;
}

/* The cosine of wi for classic lobes; 0 for light from behind the surface, for any shading normal. */
static double classic_cosine(const struct bsdf *bsdf, struct vec3 wi) {
    double n_l = vec3_dot(bsdf->lit, wi);
    return n_l > 0 && vec3_dot(bsdf->geometric_side, wi) > 0 ? n_l : 0;
}

struct colour bsdf_classic(const struct bsdf *bsdf, uint32_t lobes, struct vec3 wo, struct vec3 wi) {
    double n_l = classic_cosine(bsdf, wi);
    struct colour sum = {0, 0, 0};
    if (!(n_l > 0))
        return sum;
    for (int i = 0; i < bsdf->count; i++) {
        const struct lobe *lobe = &bsdf->lobes[i];
        double factor = 0;
        if (!(lobes >> i & 1))
            continue;
        switch (lobe->kind) {
        case LOBE_DIFFUSE:
            factor = n_l;
            break;
        case LOBE_PHONG:
            factor = phong_formula(lobe, bsdf->lit, n_l, wo, wi);
            break;
        case LOBE_BLINN:
            factor = blinn_formula(lobe, bsdf->lit, wo, wi);
            break;
            ROUGH_LOBES(LIST_LABEL)
            if (lobe_flags(lobe->kind) & BSDF_CLASSIC)
                sum = colour_add_scaled(sum, rough_lobe_weight(bsdf, lobe, wo, wi),
                                        radiance_of(rough_lobe_eval(bsdf, lobe, wo, wi)));
            continue;
        case LOBE_MIRROR:
        case LOBE_COAT:
        case LOBE_REFRACTION:
        case LOBE_GGX_REFLECTION:
        case LOBE_GGX_TRANSMISSION:
        case LOBE_SUBSURFACE:
            continue;
        }
        sum = colour_add_scaled(sum, lobe->weight, factor);
    }
    return sum;
}

/* A unit vector at the angle to the axis with this cosine. */
static struct vec3 direction_about(struct vec3 axis, double cosine, double turn) {
    struct vec3 a, b;
    frame_tangents(axis, &a, &b);
    double sine = sqrt(cosine < 1 ? 1 - cosine * cosine : 0), angle = 2 * PI * turn;
    struct vec3 out = vec3_add_scaled(vec3_scale(axis, cosine), a, sine * el_cos(angle));
    return vec3_add_scaled(out, b, sine * el_sin(angle));
}

/* Directions with a density in proportion to cosine^exponent; without a lower bound there would be none below 0. */
static double power_exponent(double exponent) {
    return exponent > 0 ? exponent : 0;
}
static struct vec3 power_sample(struct vec3 axis, double exponent, struct sample2 u) {
    return direction_about(axis, el_pow(1 - u.x, 1 / (power_exponent(exponent) + 1)), u.y);
}
static double power_pdf(double cosine, double exponent) {
    double e = power_exponent(exponent);
    return cosine > 0 ? (e + 1) / (2 * PI) * lobe_power(cosine, e) : 0;
}

/* Sine and cosine of -pi/4 to pi/4 by their series, to 2^-52; without branches, for directions only. The terms are
 * added in pairs (Estrin's scheme), because in a single chain each addition would wait for the previous one. */
static void short_sincos(double x, double *sine, double *cosine) {
    double z = x * x, z2 = z * z, z4 = z2 * z2;
    double s = (-1.0 / 6 + z * (1.0 / 120)) + z2 * (-1.0 / 5040 + z * (1.0 / 362880)) +
               z4 * ((-1.0 / 39916800 + z * (1.0 / 6227020800)) + z2 * (-1.0 / 1307674368000));
    double c = (-0.5 + z * (1.0 / 24)) + z2 * (-1.0 / 720 + z * (1.0 / 40320)) +
               z4 * ((-1.0 / 3628800 + z * (1.0 / 479001600)) + z2 * (-1.0 / 87178291200 + z * (1.0 / 20922789888000)));
    *sine = x + x * (z * s);
    *cosine = 1 + z * c;
}

/* Density proportional to the cosine: sample_disc, raised to the hemisphere. In each eighth of the disc the angle to
 * the next axis is at most pi/4. */
static struct vec3 diffuse_sample(struct vec3 normal, struct sample2 u) {
    /* Selected by an index, because the larger one cannot be predicted. */
    const double at[2] = {2 * u.y - 1, 2 * u.x - 1};
    int wide = fabs(at[1]) > fabs(at[0]);
    double radius = at[wide], other = at[!wide], sine, cosine;
    short_sincos(radius != 0 ? PI / 4 * (other / radius) : 0, &sine, &cosine);
    const double along[2] = {radius * sine, radius * cosine};
    double height = 1 - radius * radius;
    struct vec3 a, b;
    frame_tangents(normal, &a, &b);
    struct vec3 out = vec3_scale(normal, height > 0 ? sqrt(height) : 0);
    return vec3_add_scaled(vec3_add_scaled(out, a, along[wide]), b, along[!wide]);
}

static double blinn_pdf(const struct lobe *lobe, struct vec3 normal, struct vec3 wo, struct vec3 wi) {
    struct vec3 half = vec3_normalize(vec3_add(wi, wo));
    double v_h = vec3_dot(wo, half);
    return v_h > 0 ? power_pdf(vec3_dot(normal, half), lobe->exponent) / (4 * v_h) : 0;
}

/* --- smooth boundaries --- */

/* A reflection about an interpolated normal may point into the surface: then the geometric normal is used. */
static struct vec3 mirror_direction(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo) {
    struct vec3 side = lobe->kind == LOBE_COAT ? bsdf->facets[lobe->facets].distribution.normal : bsdf->side;
    struct vec3 direction = dielectric_mirror(side, wo);
    return vec3_dot(direction, bsdf->geometric_side) > 0 ? direction : dielectric_mirror(bsdf->geometric_side, wo);
}

/* With an interpolated normal the ray may not cross the surface: then the geometric one is used. */
bool bsdf_refract(const struct bsdf *bsdf, struct vec3 wo, struct vec3 *out) {
    bool transmits = dielectric_refract(bsdf->side, wo, bsdf->eta, out);
    if (transmits && vec3_dot(*out, bsdf->geometric_side) >= 0)
        transmits = dielectric_refract(bsdf->geometric_side, wo, bsdf->eta, out);
    return transmits;
}

/* --- rough boundaries --- */

/* The fraction of light at a facet that goes into a GGX lobe; `towards` is the cosine of wo to the facet. */
static double facet_share(const struct bsdf *bsdf, bool transmits, double towards) {
    if (!bsdf->fresnel_of_facets)
        return 1;
    double reflected = dielectric_fresnel(towards, bsdf->eta);
    return transmits ? 1 - reflected : reflected;
}

/* The masking of light from a visible facet towards wi; 0 on the wrong side of the shading normal or of the surface. */
static double facet_escape(const struct bsdf *bsdf, bool transmits, struct vec3 wo, struct vec3 wi) {
    double n_l = vec3_dot(bsdf->side, wi), height = vec3_dot(bsdf->geometric_side, wi);
    if (transmits ? !(n_l < 0 && height < 0) : !(n_l > 0 && height > 0))
        return 0;
    return microfacet_escape(vec3_dot(bsdf->side, wo), fabs(n_l), bsdf->alpha);
}

/* A direction of a GGX lobe: its facet, its density without Fresnel and masking, and the product of these. */
struct facet_path {
    double pdf, share;
};

/* Through reflection by a facet. A refracting lobe has such directions where the facet reflects totally. */
static struct facet_path by_mirror(const struct bsdf *bsdf, bool refracts, struct vec3 wo, struct vec3 wi) {
    struct vec3 half = vec3_normalize(vec3_add(wo, wi)), through;
    double v_h = vec3_dot(wo, half);
    if (!(v_h > 0) || (refracts && (!bsdf->turns_back || dielectric_refract(half, wo, bsdf->eta, &through))))
        return (struct facet_path){0, 0};
    return (struct facet_path){microfacet_pdf(bsdf->side, wo, bsdf->alpha, half) / (4 * v_h),
                               facet_share(bsdf, refracts, v_h) * facet_escape(bsdf, false, wo, wi)};
}

/* Through refraction by a facet: Walter et al. 2007, sections 5.2 and 5.3. */
static struct facet_path by_refraction(const struct bsdf *bsdf, struct vec3 wo, struct vec3 wi) {
    struct vec3 half = vec3_normalize(vec3_add_scaled(wi, wo, bsdf->eta));
    if (vec3_dot(wo, half) < 0)
        half = vec3_negate(half);
    double v_h = vec3_dot(wo, half), l_h = vec3_dot(wi, half), sum = bsdf->eta * v_h + l_h;
    if (!(v_h > 0 && l_h < 0 && sum != 0))
        return (struct facet_path){0, 0};
    return (struct facet_path){microfacet_pdf(bsdf->side, wo, bsdf->alpha, half) * -l_h / (sum * sum),
                               facet_share(bsdf, true, v_h) * facet_escape(bsdf, true, wo, wi)};
}

/* Samples with weight 0 are dropped and have no density. */
static struct facet_path rough_path(const struct bsdf *bsdf, bool refracts, struct vec3 wo, struct vec3 wi) {
    struct facet_path path = {0, 0};
    if (vec3_dot(wi, bsdf->geometric_side) > 0)
        path = by_mirror(bsdf, refracts, wo, wi);
    else if (refracts && bsdf->eta != 1)
        path = by_refraction(bsdf, wo, wi);
    return path.share > 0 ? path : (struct facet_path){0, 0};
}

/* --- one lobe --- */

/* A smooth refracting lobe reflects at total reflection; for a rough one each facet decides. */
static bool lobe_transmits(const struct bsdf *bsdf, const struct lobe *lobe) {
    return (lobe_flags(lobe->kind) & BSDF_TRANSMITS) && (bsdf->transmits || !(lobe_flags(lobe->kind) & BSDF_DELTA));
}

/* Whether its contribution is not zero. */
static bool lobe_counts(const struct bsdf *bsdf, const struct lobe *lobe) {
    unsigned flags = lobe_flags(lobe->kind);
    if (flags & BSDF_CLASSIC)
        return !bsdf->dark;
    return !(flags & BSDF_TRANSMITS) || lobe_transmits(bsdf, lobe) || bsdf->turns_back;
}

static double lobe_pdf(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 wi) {
    double n_l = lobe_flags(lobe->kind) & BSDF_CLASSIC ? classic_cosine(bsdf, wi) : 0;
    switch (lobe->kind) {
    case LOBE_DIFFUSE:
        return n_l > 0 ? n_l / PI : 0;
    case LOBE_PHONG:
        return n_l > 0 ? power_pdf(vec3_dot(dielectric_mirror(bsdf->lit, wo), wi), lobe->exponent) : 0;
    case LOBE_BLINN:
        return n_l > 0 ? blinn_pdf(lobe, bsdf->lit, wo, wi) : 0;
    case LOBE_MIRROR:
    case LOBE_COAT:
    case LOBE_REFRACTION:
    case LOBE_SUBSURFACE:
        return 0;
    case LOBE_GGX_REFLECTION:
    case LOBE_GGX_TRANSMISSION:
        return rough_path(bsdf, lobe->kind == LOBE_GGX_TRANSMISSION, wo, wi).pdf;
        ROUGH_LOBES(LIST_LABEL)
        return rough_lobe_pdf(bsdf, lobe, wo, wi);
    }
    return 0;
}

/* f |cos| over the weight, as light; transmission by the rules of IMPORTANCE. */
static double lobe_eval(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 wi) {
    double n_l = lobe_flags(lobe->kind) & BSDF_CLASSIC ? classic_cosine(bsdf, wi) : 0;
    switch (lobe->kind) {
    case LOBE_DIFFUSE:
        return n_l > 0 ? intensity_of(n_l) : 0;
    case LOBE_PHONG:
        return n_l > 0 ? intensity_of(phong_formula(lobe, bsdf->lit, n_l, wo, wi)) : 0;
    case LOBE_BLINN:
        return n_l > 0 ? intensity_of(blinn_formula(lobe, bsdf->lit, wo, wi)) : 0;
    case LOBE_MIRROR:
    case LOBE_COAT:
    case LOBE_REFRACTION:
    case LOBE_SUBSURFACE:
        return 0;
    case LOBE_GGX_REFLECTION:
    case LOBE_GGX_TRANSMISSION: {
        struct facet_path path = rough_path(bsdf, lobe->kind == LOBE_GGX_TRANSMISSION, wo, wi);
        return path.pdf * path.share;
    }
        ROUGH_LOBES(LIST_LABEL)
        return rough_lobe_eval(bsdf, lobe, wo, wi);
    }
    return 0;
}

/* A direction, whether it is the lobe's only one, and f |cos| / pdf over the lobe's weight where it is traced. */
struct lobe_direction {
    struct vec3 direction;
    double share;
    double pdf; /* proportional to the density of a lobe with this f |cos|; 0 for all others */
    bool delta, transmits;
};

struct bsdf_draw bsdf_draw(const struct bsdf *bsdf, struct vec3 wo, struct sample2 u) {
    return (struct bsdf_draw){u, bsdf->alpha > 0 ? microfacet_normal(bsdf->side, wo, bsdf->alpha, u) : bsdf->side};
}

static bool rough_direction(const struct bsdf *bsdf, bool refracts, struct vec3 wo, struct vec3 facet,
                            struct lobe_direction *out) {
    double v_h = vec3_dot(wo, facet);
    out->transmits = refracts && dielectric_refract(facet, wo, bsdf->eta, &out->direction);
    if (out->transmits && bsdf->eta == 1) { /* there is no boundary */
        out->delta = true;
        return true;
    }
    if (!out->transmits) {
        if (refracts && !bsdf->turns_back)
            return false;
        out->direction = dielectric_mirror(facet, wo);
    }
    out->share = facet_share(bsdf, refracts, v_h) * facet_escape(bsdf, out->transmits, wo, out->direction);
    return out->share > 0;
}

/* The direction of a traced lobe; facet: of a rough one. False: invalid, below the surface or in its plane. */
static bool traced_direction(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 facet,
                             struct lobe_direction *out) {
    out->transmits = lobe_transmits(bsdf, lobe);
    out->delta = lobe_flags(lobe->kind) & BSDF_DELTA;
    out->share = 1;
    if (!out->delta)
        return rough_direction(bsdf, out->transmits, wo, facet, out);
    if (out->transmits)
        (void)bsdf_refract(bsdf, wo, &out->direction);
    else
        out->direction = mirror_direction(bsdf, lobe, wo);
    return true;
}

/* False: invalid, below the surface or in its plane. */
static bool lobe_sample(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct sample2 u,
                        struct lobe_direction *out) {
    struct vec3 facet;
    out->delta = out->transmits = false;
    out->share = 1;
    out->pdf = 0;
    switch (lobe->kind) {
    case LOBE_DIFFUSE:
        out->direction = diffuse_sample(bsdf->lit, u);
        out->pdf = classic_cosine(bsdf, out->direction) / PI;
        return out->pdf > 0;
    case LOBE_PHONG:
        out->direction = power_sample(dielectric_mirror(bsdf->lit, wo), lobe->exponent, u);
        return classic_cosine(bsdf, out->direction) > 0;
    case LOBE_BLINN:
        facet = power_sample(bsdf->lit, lobe->exponent, u);
        out->direction = dielectric_mirror(facet, wo);
        return vec3_dot(wo, facet) > 0 && classic_cosine(bsdf, out->direction) > 0;
    case LOBE_MIRROR:
    case LOBE_COAT:
    case LOBE_REFRACTION:
        return traced_direction(bsdf, lobe, wo, bsdf->side, out);
    case LOBE_GGX_REFLECTION:
    case LOBE_GGX_TRANSMISSION:
        return traced_direction(bsdf, lobe, wo, microfacet_normal(bsdf->side, wo, bsdf->alpha, u), out);
    case LOBE_SUBSURFACE:
        out->direction = diffuse_sample(vec3_negate(bsdf->side), u);
        out->delta = true;
        return vec3_dot(out->direction, bsdf->geometric_side) < 0;
        ROUGH_LOBES(LIST_LABEL)
        return rough_lobe_sample(bsdf, lobe, wo, u, &out->direction, &out->transmits);
    }
    return false;
}

/* --- lists of lobes --- */

static double radiance_factor(const struct bsdf *bsdf, enum bsdf_mode mode, bool transmits) {
    return transmits && mode == BSDF_RADIANCE ? bsdf->eta * bsdf->eta : 1;
}

/* The expected fraction of its weight that a lobe contributes, always above 0: facets multiply it by Fresnel's
 * share. */
static double expected_share(const struct bsdf *bsdf, const struct lobe *lobe) {
    unsigned flags = lobe_flags(lobe->kind);
    if (lobe->share > 0)
        return lobe->share;
    if (!bsdf->fresnel_of_facets || !(flags & BSDF_TRACED) || (flags & BSDF_DELTA))
        return 1;
    double reflected = math_min(math_max(bsdf->fresnel, 1.0 / 16), 15.0 / 16);
    return flags & BSDF_TRANSMITS ? 1 - reflected : reflected;
}

/* Lobes are chosen in proportion to it. Without a boundary no facet reflects. */
static double lobe_chance(const struct bsdf *bsdf, const struct lobe *lobe) {
    if (!lobe_counts(bsdf, lobe) || (lobe->kind == LOBE_GGX_REFLECTION && bsdf->fresnel_of_facets && bsdf->eta == 1))
        return 0;
    return colour_max_abs(lobe->weight) * expected_share(bsdf, lobe);
}

/* The only lobe of a set; NULL if there are none or several. */
static const struct lobe *only_lobe(const struct bsdf *bsdf, uint32_t lobes) {
    lobes &= (UINT32_C(1) << bsdf->count) - 1;
    return lobes != 0 && (lobes & (lobes - 1)) == 0 ? &bsdf->lobes[__builtin_ctz(lobes)] : NULL;
}

/* The chances of all lobes, and their sum. */
struct lobe_chances {
    double of[BSDF_LOBES], all;
};
static void lobe_chances_make(const struct bsdf *bsdf, uint32_t lobes, struct lobe_chances *out) {
    out->all = 0;
    for (int i = 0; i < bsdf->count; i++) {
        out->of[i] = lobes >> i & 1 ? lobe_chance(bsdf, &bsdf->lobes[i]) : 0;
        out->all += out->of[i];
    }
}
/* A lobe without others needs no division. */
static double lobe_share(const struct lobe_chances *chances, int i) {
    return chances->of[i] == chances->all ? chances->all > 0 : chances->of[i] / chances->all;
}

static double pdf_of_chances(const struct bsdf *bsdf, const struct lobe_chances *chances, struct vec3 wo,
                             struct vec3 wi) {
    double sum = 0;
    for (int i = 0; i < bsdf->count; i++)
        if (chances->of[i] > 0)
            sum += lobe_share(chances, i) * lobe_pdf(bsdf, &bsdf->lobes[i], wo, wi);
    return sum;
}

/* A single diffuse lobe, as most surfaces have. */
static struct colour diffuse_eval(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wi) {
    double n_l = bsdf->dark ? 0 : classic_cosine(bsdf, wi);
    return n_l > 0 ? colour_scale(lobe->weight, intensity_of(n_l)) : colour_all(0);
}

struct colour bsdf_eval(const struct bsdf *bsdf, uint32_t lobes, enum bsdf_mode mode, struct vec3 wo, struct vec3 wi) {
    const struct lobe *only = only_lobe(bsdf, lobes);
    if (only && only->kind == LOBE_DIFFUSE)
        return diffuse_eval(bsdf, only, wi);
    struct colour sum = {0, 0, 0};
    for (uint32_t left = lobes & ((UINT32_C(1) << bsdf->count) - 1); left; left &= left - 1) {
        const struct lobe *lobe = &bsdf->lobes[__builtin_ctz(left)];
        if (!lobe_counts(bsdf, lobe))
            continue;
        bool transmits = (lobe_flags(lobe->kind) & BSDF_TRANSMITS) && vec3_dot(wi, bsdf->geometric_side) < 0;
        double factor = radiance_factor(bsdf, mode, transmits);
        bool tinted = lobe_flags(lobe->kind) & BSDF_TINTED;
        struct colour weight = tinted ? rough_lobe_weight(bsdf, lobe, wo, wi) : lobe->weight;
        sum = colour_add_scaled(sum, weight, factor * lobe_eval(bsdf, lobe, wo, wi));
    }
    return sum;
}

double bsdf_pdf(const struct bsdf *bsdf, uint32_t lobes, struct vec3 wo, struct vec3 wi) {
    struct lobe_chances chances;
    const struct lobe *only = only_lobe(bsdf, lobes);
    if (only)
        return lobe_chance(bsdf, only) > 0 ? lobe_pdf(bsdf, only, wo, wi) : 0;
    lobe_chances_make(bsdf, lobes, &chances);
    return pdf_of_chances(bsdf, &chances, wo, wi);
}

/* Selects a lobe with u->x, and rescales u->x to be uniform again. NULL: no lobe contributes. */
static const struct lobe *choose_lobe(const struct bsdf *bsdf, const struct lobe_chances *chances, struct sample2 *u,
                                      double *chance) {
    double from = 0;
    int chosen = -1;
    for (int i = 0; i < bsdf->count; i++) {
        double share = lobe_share(chances, i);
        if (!(share > 0))
            continue;
        if (chosen >= 0 && u->x < from)
            break;
        chosen = i;
        *chance = share;
        from += share;
    }
    if (chosen < 0)
        return NULL;
    if (*chance < 1) {
        double within = (u->x - (from - *chance)) / *chance;
        u->x = within > 0 ? within < 1 ? within : 0x1.fffffffffffffp-1 : 0;
    }
    return &bsdf->lobes[chosen];
}

static bool sample_diffuse(const struct bsdf *bsdf, const struct lobe *lobe, struct sample2 u,
                           struct bsdf_sample *out) {
    if (bsdf->dark || !(colour_max_abs(lobe->weight) > 0))
        return false;
    out->direction = diffuse_sample(bsdf->lit, u);
    out->pdf = classic_cosine(bsdf, out->direction) / PI;
    out->weight = lobe->weight;
    out->flags = BSDF_REFLECTS;
    return out->pdf > 0;
}

bool bsdf_sample(const struct bsdf *bsdf, uint32_t lobes, enum bsdf_mode mode, struct vec3 wo, struct sample2 u,
                 struct bsdf_sample *out) {
    const struct lobe *only = only_lobe(bsdf, lobes), *lobe = only;
    if (only && only->kind == LOBE_DIFFUSE)
        return sample_diffuse(bsdf, only, u, out);
    /* Among several lobes one is chosen by its chance. */
    struct lobe_chances chances;
    chances.all = 0;
    out->pdf = 1;
    if (!only) {
        lobe_chances_make(bsdf, lobes, &chances);
        lobe = choose_lobe(bsdf, &chances, &u, &out->pdf);
    } else if (!(lobe_chance(bsdf, only) > 0)) {
        return false;
    }
    struct lobe_direction sampled;
    if (!lobe || !lobe_sample(bsdf, lobe, wo, u, &sampled))
        return false;
    out->direction = sampled.direction;
    out->flags = sampled.transmits ? BSDF_TRANSMITS : BSDF_REFLECTS;
    /* No other lobe reaches the direction of a mirror. */
    if (sampled.delta) {
        out->flags |= BSDF_DELTA | (lobe_flags(lobe->kind) & BSDF_BELOW);
        out->weight = colour_scale(lobe->weight, radiance_factor(bsdf, mode, sampled.transmits) / out->pdf);
        return true;
    }
    /* Where value and density are proportional, their ratio is exact. */
    if (only && sampled.pdf > 0) {
        out->pdf = sampled.pdf;
        out->weight = lobe->weight;
        return true;
    }
    /* Else the direction might have come from each of the lobes. */
    out->pdf = only ? lobe_pdf(bsdf, only, wo, out->direction) : pdf_of_chances(bsdf, &chances, wo, out->direction);
    if (!(out->pdf > 0))
        return false;
    out->weight = colour_scale(bsdf_eval(bsdf, lobes, mode, wo, out->direction), 1 / out->pdf);
    return true;
}

/* --- branches --- */

int bsdf_branches(const struct bsdf *bsdf, struct bsdf_branch out[BSDF_LOBES]) {
    int count = 0, kept = 0;
    for (int i = 0; i < bsdf->count; i++) {
        const struct lobe *lobe = &bsdf->lobes[i];
        unsigned flags = lobe_flags(lobe->kind);
        if (!(flags & BSDF_TRACED) || !lobe_counts(bsdf, lobe))
            continue;
        /* At total reflection it has the mirror direction. */
        if ((flags & BSDF_TRANSMITS) && !lobe_transmits(bsdf, lobe) && count > 0) {
            out[count - 1].weight = colour_add(out[count - 1].weight, lobe->weight);
            continue;
        }
        out[count].weight = lobe->weight;
        out[count].expected = expected_share(bsdf, lobe);
        out[count].lobe = i;
        out[count++].rough = !(flags & BSDF_DELTA);
    }
    for (int i = 0; i < count; i++) {
        struct colour weight = out[i].weight;
        if (weight.r != 0 || weight.g != 0 || weight.b != 0)
            out[kept++] = out[i];
    }
    return kept;
}

bool bsdf_branch_is_known(const struct bsdf *bsdf, const struct bsdf_branch *branch) {
    const struct lobe *lobe = &bsdf->lobes[branch->lobe];
    const struct bsdf_facets *facets = &bsdf->facets[lobe->facets];
    return lobe->kind == LOBE_GLOSS && facets->kind == FACETS_BOUNDARY && facets->eta < 1;
}

/* Of a rough lobe of a layered material. */
static bool rough_branch_sample(const struct bsdf *bsdf, const struct bsdf_branch *branch, struct vec3 wo,
                                struct sample2 u, struct bsdf_branch_direction *out) {
    const struct lobe *lobe = &bsdf->lobes[branch->lobe];
    if (!rough_lobe_sample(bsdf, lobe, wo, u, &out->direction, &out->transmits))
        return false;
    double share = rough_lobe_share(bsdf, lobe, wo, out->direction);
    out->weight = colour_scale(rough_lobe_weight(bsdf, lobe, wo, out->direction), share);
    return share > 0;
}

bool bsdf_branch_sample(const struct bsdf *bsdf, const struct bsdf_branch *branch, struct vec3 wo,
                        const struct bsdf_draw *draw, struct bsdf_branch_direction *out) {
    const struct lobe *lobe = &bsdf->lobes[branch->lobe];
    if (!branch->rough && lobe_transmits(bsdf, lobe)) {
        *out = (struct bsdf_branch_direction){bsdf->through, branch->weight, true};
        return true;
    }
    if (lobe_flags(lobe->kind) & BSDF_ROUGH)
        return rough_branch_sample(bsdf, branch, wo, draw->u, out);
    struct lobe_direction sampled;
    if (!traced_direction(bsdf, lobe, wo, draw->facet, &sampled))
        return false;
    out->direction = sampled.direction;
    out->weight = sampled.share == 1 ? branch->weight : colour_scale(branch->weight, sampled.share);
    out->transmits = sampled.transmits;
    return true;
}
