/* The lobes, each with its formula (classic ones), density and sampling, and sums over lists of them.
 *
 * A classic lobe is its formula of SPEC 1.2 over pi as f |cos|. A GGX lobe loses no energy: light that a facet sends to
 * the wrong side is turned back, as by one more facet, and its f |cos| is its weight times the density of its
 * directions. A facet that reflects totally where the surface as a whole does not sends its light where the smooth
 * surface would: a share of the samples of a GGX transmission has one direction, and is flagged so. */
#include "material/bsdf.h"

#include "material/classic.h"
#include "material/dielectric.h"
#include "material/microfacet.h"
#include "math/elementary.h"
#include "math/frame.h"

static const double pi = 3.14159265358979323846;

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

struct vec3 bsdf_classic(const struct bsdf *bsdf, uint32_t lobes, struct vec3 wo, struct vec3 wi) {
    double n_l = vec3_dot(bsdf->lit, wi);
    struct vec3 sum = {0, 0, 0};
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
        case LOBE_MIRROR:
        case LOBE_REFRACTION:
        case LOBE_GGX_REFLECTION:
        case LOBE_GGX_TRANSMISSION:
            continue;
        }
        sum = vec3_add_scaled(sum, lobe->weight, factor);
    }
    return sum;
}

/* A unit vector at the angle to the axis with this cosine. */
static struct vec3 around(struct vec3 axis, double cosine, double turn) {
    struct vec3 a, b;
    frame_tangents(axis, &a, &b);
    double sine = sqrt(cosine < 1 ? 1 - cosine * cosine : 0), angle = 2 * pi * turn;
    struct vec3 out = vec3_add_scaled(vec3_scale(axis, cosine), a, sine * el_cos(angle));
    return vec3_add_scaled(out, b, sine * el_sin(angle));
}

/* Directions with a density in proportion to cosine^exponent; without a lower bound there would be none below 0. */
static double power_exponent(double exponent) {
    return exponent > 0 ? exponent : 0;
}
static struct vec3 power_sample(struct vec3 axis, double exponent, struct sample2 u) {
    return around(axis, el_pow(1 - u.x, 1 / (power_exponent(exponent) + 1)), u.y);
}
static double power_pdf(double cosine, double exponent) {
    double e = power_exponent(exponent);
    return cosine > 0 ? (e + 1) / (2 * pi) * lobe_power(cosine, e) : 0;
}

static struct vec3 diffuse_sample(struct vec3 normal, struct sample2 u) {
    struct sample2 disc = sample_disc(u);
    struct vec3 a, b;
    frame_tangents(normal, &a, &b);
    double height = 1 - disc.x * disc.x - disc.y * disc.y;
    struct vec3 out = vec3_scale(normal, height > 0 ? sqrt(height) : 0);
    return vec3_add_scaled(vec3_add_scaled(out, a, disc.x), b, disc.y);
}

static double blinn_pdf(const struct lobe *lobe, struct vec3 normal, struct vec3 wo, struct vec3 wi) {
    struct vec3 half = vec3_normalize(vec3_add(wi, wo));
    double v_h = vec3_dot(wo, half);
    return v_h > 0 ? power_pdf(vec3_dot(normal, half), lobe->exponent) / (4 * v_h) : 0;
}

/* --- smooth boundaries --- */

/* A reflection about an interpolated normal may point into the surface: the geometric normal then takes its place. */
static struct vec3 mirror_direction(const struct bsdf *bsdf, struct vec3 wo) {
    struct vec3 direction = dielectric_mirror(bsdf->side, wo);
    return vec3_dot(direction, bsdf->geometric_side) > 0 ? direction : dielectric_mirror(bsdf->geometric_side, wo);
}

/* About an interpolated normal the ray may not leave its side of the surface: the geometric one takes over. */
bool bsdf_refract(const struct bsdf *bsdf, struct vec3 wo, struct vec3 *out) {
    bool passes = dielectric_refract(bsdf->side, wo, bsdf->eta, out);
    if (passes && vec3_dot(*out, bsdf->geometric_side) >= 0)
        passes = dielectric_refract(bsdf->geometric_side, wo, bsdf->eta, out);
    return passes;
}

/* --- rough boundaries --- */

static struct vec3 fold(struct vec3 direction, struct vec3 to_side) {
    double height = vec3_dot(direction, to_side);
    return height < 0 ? vec3_add_scaled(direction, to_side, -2 * height) : direction;
}

static struct vec3 facet_mirror(const struct bsdf *bsdf, struct vec3 facet, struct vec3 wo) {
    return fold(dielectric_mirror(facet, wo), bsdf->geometric_side);
}

/* True: the facet refracts it; false: it goes the way of the smooth surface. */
static bool facet_refract(const struct bsdf *bsdf, struct vec3 facet, struct vec3 wo, struct vec3 *out) {
    if (!dielectric_refract(facet, wo, bsdf->eta, out)) {
        (void)bsdf_refract(bsdf, wo, out);
        return false;
    }
    *out = fold(*out, vec3_negate(bsdf->geometric_side));
    return bsdf->eta != 1;
}

struct vec3 bsdf_facet(const struct bsdf *bsdf, struct vec3 wo, struct sample2 u) {
    return microfacet_normal(bsdf->side, wo, bsdf->alpha, u);
}

/* Of directions that are not folded yet. The half vectors are those of Walter et al. 2007, sections 5.2 and 5.3. */
static double facet_mirror_pdf(const struct bsdf *bsdf, struct vec3 wo, struct vec3 wi) {
    struct vec3 half = vec3_normalize(vec3_add(wo, wi));
    double v_h = vec3_dot(wo, half);
    return v_h > 0 ? microfacet_pdf(bsdf->side, wo, bsdf->alpha, half) / (4 * v_h) : 0;
}
static double facet_refract_pdf(const struct bsdf *bsdf, struct vec3 wo, struct vec3 wi) {
    struct vec3 half = vec3_normalize(vec3_add_scaled(wi, wo, bsdf->eta));
    if (vec3_dot(wo, half) < 0)
        half = vec3_negate(half);
    double v_h = vec3_dot(wo, half), l_h = vec3_dot(wi, half), sum = bsdf->eta * v_h + l_h;
    if (!(v_h > 0 && l_h < 0 && sum != 0))
        return 0;
    return microfacet_pdf(bsdf->side, wo, bsdf->alpha, half) * -l_h / (sum * sum);
}

/* Each direction on the right side has been reached by itself and by its mirror image on the wrong side. */
static double rough_pdf(const struct bsdf *bsdf, bool transmits, struct vec3 wo, struct vec3 wi) {
    double height = vec3_dot(wi, bsdf->geometric_side);
    struct vec3 turned = vec3_add_scaled(wi, bsdf->geometric_side, -2 * height);
    if (transmits)
        return height < 0 ? facet_refract_pdf(bsdf, wo, wi) + facet_refract_pdf(bsdf, wo, turned) : 0;
    return height > 0 ? facet_mirror_pdf(bsdf, wo, wi) + facet_mirror_pdf(bsdf, wo, turned) : 0;
}

/* --- one lobe --- */

/* A lobe that refracts reflects where the surface reflects totally. */
static bool lobe_transmits(const struct bsdf *bsdf, const struct lobe *lobe) {
    return (lobe_flags(lobe->kind) & BSDF_TRANSMITS) && bsdf->passes;
}

/* Whether it gives light at all. */
static bool lobe_counts(const struct bsdf *bsdf, const struct lobe *lobe) {
    unsigned flags = lobe_flags(lobe->kind);
    if (flags & BSDF_CLASSIC)
        return !bsdf->dark;
    return !(flags & BSDF_TRANSMITS) || bsdf->passes || bsdf->turns_back;
}

static double lobe_pdf(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 wi) {
    double n_l = vec3_dot(bsdf->lit, wi);
    switch (lobe->kind) {
    case LOBE_DIFFUSE:
        return n_l > 0 ? n_l / pi : 0;
    case LOBE_PHONG:
        return n_l > 0 ? power_pdf(vec3_dot(dielectric_mirror(bsdf->lit, wo), wi), lobe->exponent) : 0;
    case LOBE_BLINN:
        return n_l > 0 ? blinn_pdf(lobe, bsdf->lit, wo, wi) : 0;
    case LOBE_MIRROR:
    case LOBE_REFRACTION:
        return 0;
    case LOBE_GGX_REFLECTION:
    case LOBE_GGX_TRANSMISSION:
        return rough_pdf(bsdf, lobe_transmits(bsdf, lobe), wo, wi);
    }
    return 0;
}

/* f |cos| over the weight, as light; transmission by the rules of IMPORTANCE. */
static double lobe_eval(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 wi) {
    double n_l = vec3_dot(bsdf->lit, wi);
    switch (lobe->kind) {
    case LOBE_DIFFUSE:
        return n_l > 0 ? intensity_of(n_l) : 0;
    case LOBE_PHONG:
        return n_l > 0 ? intensity_of(phong_formula(lobe, bsdf->lit, n_l, wo, wi)) : 0;
    case LOBE_BLINN:
        return n_l > 0 ? intensity_of(blinn_formula(lobe, bsdf->lit, wo, wi)) : 0;
    case LOBE_MIRROR:
    case LOBE_REFRACTION:
        return 0;
    case LOBE_GGX_REFLECTION:
    case LOBE_GGX_TRANSMISSION:
        return lobe_pdf(bsdf, lobe, wo, wi);
    }
    return 0;
}

/* A direction, and whether it is the lobe's only one. */
struct lobe_direction {
    struct vec3 direction;
    bool delta;
};

/* Of a traced lobe; facet: of a rough one. */
static void traced_direction(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 facet,
                             struct lobe_direction *out) {
    bool transmits = lobe_transmits(bsdf, lobe);
    out->delta = lobe_flags(lobe->kind) & BSDF_DELTA;
    if (out->delta && transmits)
        (void)bsdf_refract(bsdf, wo, &out->direction);
    else if (out->delta)
        out->direction = mirror_direction(bsdf, wo);
    else if (transmits)
        out->delta = !facet_refract(bsdf, facet, wo, &out->direction);
    else
        out->direction = facet_mirror(bsdf, facet, wo);
}

/* False: lost below the surface. */
static bool lobe_sample(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct sample2 u,
                        struct lobe_direction *out) {
    struct vec3 facet;
    out->delta = false;
    switch (lobe->kind) {
    case LOBE_DIFFUSE:
        out->direction = diffuse_sample(bsdf->lit, u);
        return vec3_dot(bsdf->lit, out->direction) > 0;
    case LOBE_PHONG:
        out->direction = power_sample(dielectric_mirror(bsdf->lit, wo), lobe->exponent, u);
        return vec3_dot(bsdf->lit, out->direction) > 0;
    case LOBE_BLINN:
        facet = power_sample(bsdf->lit, lobe->exponent, u);
        out->direction = dielectric_mirror(facet, wo);
        return vec3_dot(wo, facet) > 0 && vec3_dot(bsdf->lit, out->direction) > 0;
    case LOBE_MIRROR:
    case LOBE_REFRACTION:
        traced_direction(bsdf, lobe, wo, bsdf->side, out);
        return true;
    case LOBE_GGX_REFLECTION:
    case LOBE_GGX_TRANSMISSION:
        traced_direction(bsdf, lobe, wo, bsdf_facet(bsdf, wo, u), out);
        return true;
    }
    return false;
}

/* --- lists of lobes --- */

static double radiance_factor(const struct bsdf *bsdf, enum bsdf_mode mode, bool transmits) {
    return transmits && mode == BSDF_RADIANCE ? bsdf->eta * bsdf->eta : 1;
}

/* In proportion to it a lobe is drawn. */
static double lobe_chance(const struct bsdf *bsdf, uint32_t lobes, int i) {
    const struct lobe *lobe = &bsdf->lobes[i];
    return lobes >> i & 1 && lobe_counts(bsdf, lobe) ? vec3_max_abs(lobe->weight) : 0;
}
static double all_chances(const struct bsdf *bsdf, uint32_t lobes) {
    double sum = 0;
    for (int i = 0; i < bsdf->count; i++)
        sum += lobe_chance(bsdf, lobes, i);
    return sum;
}

struct vec3 bsdf_eval(const struct bsdf *bsdf, uint32_t lobes, enum bsdf_mode mode, struct vec3 wo, struct vec3 wi) {
    struct vec3 sum = {0, 0, 0};
    for (int i = 0; i < bsdf->count; i++) {
        const struct lobe *lobe = &bsdf->lobes[i];
        if (!(lobes >> i & 1) || !lobe_counts(bsdf, lobe))
            continue;
        double factor = radiance_factor(bsdf, mode, lobe_transmits(bsdf, lobe));
        sum = vec3_add_scaled(sum, lobe->weight, factor * lobe_eval(bsdf, lobe, wo, wi));
    }
    return sum;
}

double bsdf_pdf(const struct bsdf *bsdf, uint32_t lobes, struct vec3 wo, struct vec3 wi) {
    double all = all_chances(bsdf, lobes), sum = 0;
    for (int i = 0; i < bsdf->count; i++) {
        double chance = lobe_chance(bsdf, lobes, i);
        if (chance > 0)
            sum += chance / all * lobe_pdf(bsdf, &bsdf->lobes[i], wo, wi);
    }
    return sum;
}

bool bsdf_sample(const struct bsdf *bsdf, uint32_t lobes, enum bsdf_mode mode, struct vec3 wo, struct sample2 u,
                 struct bsdf_sample *out) {
    /* Choose a lobe; what is left of u.x is used again. */
    double all = all_chances(bsdf, lobes), from = 0;
    int chosen = -1;
    for (int i = 0; i < bsdf->count; i++) {
        double share = lobe_chance(bsdf, lobes, i) / all;
        if (!(share > 0))
            continue;
        if (chosen >= 0 && u.x < from)
            break;
        chosen = i;
        out->pdf = share;
        from += share;
    }
    if (chosen < 0)
        return false;
    const struct lobe *lobe = &bsdf->lobes[chosen];
    double within = (u.x - (from - out->pdf)) / out->pdf;
    u.x = within > 0 ? within < 1 ? within : 0x1.fffffffffffffp-1 : 0;

    struct lobe_direction sampled;
    if (!lobe_sample(bsdf, lobe, wo, u, &sampled))
        return false;
    bool transmits = lobe_transmits(bsdf, lobe);
    out->direction = sampled.direction;
    out->flags = transmits ? BSDF_TRANSMITS : BSDF_REFLECTS;
    if (sampled.delta) {
        out->flags |= BSDF_DELTA;
        out->weight = vec3_scale(lobe->weight, radiance_factor(bsdf, mode, transmits) / out->pdf);
        return true;
    }
    out->pdf = bsdf_pdf(bsdf, lobes, wo, out->direction);
    if (!(out->pdf > 0))
        return false;
    out->weight = vec3_scale(bsdf_eval(bsdf, lobes, mode, wo, out->direction), 1 / out->pdf);
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
        bool transmits = lobe_transmits(bsdf, lobe), rough = !(flags & BSDF_DELTA);
        /* Reflected totally, it goes where the mirror goes. */
        if ((flags & BSDF_TRANSMITS) && !transmits && count > 0 && out[count - 1].rough == rough) {
            out[count - 1].weight = vec3_add(out[count - 1].weight, lobe->weight);
            continue;
        }
        out[count].weight = lobe->weight;
        out[count].lobe = i;
        out[count].transmits = transmits;
        out[count++].rough = rough;
    }
    for (int i = 0; i < count; i++) {
        struct vec3 weight = out[i].weight;
        if (weight.x != 0 || weight.y != 0 || weight.z != 0)
            out[kept++] = out[i];
    }
    return kept;
}

void bsdf_branch_sample(const struct bsdf *bsdf, const struct bsdf_branch *branch, struct vec3 wo, struct vec3 facet,
                        struct vec3 *direction, struct vec3 *weight) {
    *weight = branch->weight;
    if (branch->transmits && !branch->rough) {
        *direction = bsdf->through;
        return;
    }
    struct lobe_direction sampled;
    traced_direction(bsdf, &bsdf->lobes[branch->lobe], wo, facet, &sampled);
    *direction = sampled.direction;
}
