/* See rough_lobes_internal.h.
 *
 * Rough diffuse surfaces: the energy-preserving model of Oren and Nayar by J. Portsmouth, P. Kutz and S. Hill, "EON:
 * A Practical Energy-Preserving Rough Diffuse BRDF", 2024. It has two lobes, because their colours differ: the
 * formula of M. Fujii, and a lobe that returns the light which that formula loses.
 *
 * Fuzz: the distribution of A. Estevez and C. Kulla, "Production Friendly Microfacet Sheen BRDF", SIGGRAPH 2017
 * courses ("Charlie"), with the visibility of D. Neubelt and M. Pettineo, "Crafting a Next-Gen Material Pipeline for
 * The Order: 1886", 2013. Its width is 0.25 + 0.75 roughness; smaller widths would reflect more than arrives at
 * grazing angles.
 *
 * Facets: as in bsdf.c, but with two widths (Heitz 2014). Light that hits more than one facet follows C. Kulla and
 * A. Conty, "Revisiting Physically Based Shading at Imageworks", SIGGRAPH 2017 courses. E(c) is the fraction of
 * light that leaves after one facet; the compensating lobe is (1 - E(cos wo)) (1 - E(cos wi)) / (pi (1 - mean E)).
 * At boundaries the fraction `through` of it goes to the other side: (1 - E(cos wo)) (1 - E'(cos wi)) / (pi (1 -
 * mean E')), with E' for directions on that side. The fraction is (1 - mean Fresnel) min(1 - mean E, 1 - mean E') /
 * (1 - mean E). Both directions then transmit the same, up to the square of the index: (1 - mean Fresnel) n^2 is the
 * same on both sides. */
#include "material/rough_lobes_internal.h"

#include "material/albedo_internal.h"
#include "material/microfacet_internal.h"
#include "math/elementary.h"
#include "math/frame.h"

#include <stddef.h>

/* --- making facets --- */

void bsdf_facets_shape(struct bsdf_facets *facets, struct vec3 normal, struct vec3 along, double roughness,
                       double anisotropy) {
    struct facet_distribution *out = &facets->distribution;
    out->normal = normal;
    struct vec3 tangent = vec3_add_scaled(along, normal, -vec3_dot(normal, along));
    double length = vec3_length(tangent);
    if (length > 0x1p-20 * vec3_max_abs(along)) {
        out->along = vec3_scale(tangent, 1 / length);
        out->across = vec3_cross(normal, out->along);
    } else {
        frame_tangents(normal, &out->along, &out->across);
    }
    double other = 1 - anisotropy, alpha = roughness * roughness * sqrt(2 / (1 + other * other));
    out->alpha_along = alpha < 1 ? alpha : 1;
    out->alpha_across = math_max(alpha * other, 1e-6);
    double square = out->alpha_along * out->alpha_along + out->alpha_across * out->alpha_across;
    facets->roughness = anisotropy > 0 ? sqrt(sqrt(square / 2)) : roughness;
}

/* The lacks of facets of two widths that reflect all are those of facets of one width times a ratio. At boundaries that
 * holds for means over directions only, times a factor. */
static bool is_stretched(const struct bsdf_facets *facets) {
    return facets->distribution.alpha_along != facets->distribution.alpha_across;
}

static double stretch_towards(const struct bsdf_facets *facets, struct vec3 direction) {
    const struct facet_distribution *d = &facets->distribution;
    double x = vec3_dot(direction, d->along), y = vec3_dot(direction, d->across), length = x * x + y * y;
    double cos_double = length > 0 ? (x * x - y * y) / length : 1;
    return albedo_stretch(fabs(vec3_dot(direction, d->normal)), cos_double, d->alpha_along, d->alpha_across);
}

/* The means over directions of the sums of stretched_boundary, over those of one width: a table between whose nodes it
 * is linear. eta: index on the side of the direction / index behind. */
enum { STRETCH_INDICES = 5, STRETCH_WIDTHS = 15, STRETCH_RATIOS = 5 };
static const double stretch_min_index = 1.1, stretch_max_index = 2.5, stretch_min_width = 0.3;
#include "material/boundary_stretch_internal.h"

/* The node below a position from 0 to 1, and how far beyond it. */
static int node_below(double position, int count, double *beyond) {
    double at = math_min(math_max(position, 0), 1) * (count - 1);
    int node = at < count - 1 ? (int)at : count - 2;
    *beyond = at - node;
    return node;
}

static double boundary_stretch(const struct facet_distribution *d, double eta) {
    double index = eta > 1 ? eta : 1 / eta, part[3], sum = 0;
    if (eta == 1)
        return 1;
    int e = node_below(el_log(index / stretch_min_index) / el_log(stretch_max_index / stretch_min_index),
                       STRETCH_INDICES, &part[0]);
    int w = node_below((sqrt(d->alpha_along) - stretch_min_width) / (1 - stretch_min_width), STRETCH_WIDTHS, &part[1]);
    int r = node_below(sqrt(d->alpha_across / d->alpha_along), STRETCH_RATIOS, &part[2]);
    for (int i = 0; i < 8; i++) {
        int x = i & 1, y = i >> 1 & 1, z = i >> 2;
        double weight = (x ? part[0] : 1 - part[0]) * (y ? part[1] : 1 - part[1]) * (z ? part[2] : 1 - part[2]);
        sum += weight * (double)boundary_stretches[eta > 1][e + x][w + y][r + z];
    }
    return sum;
}

static double mean_lack(const struct bsdf_facets *facets, double mean_albedo, double eta) {
    const struct facet_distribution *d = &facets->distribution;
    double lack = 1 - mean_albedo;
    if (!is_stretched(facets))
        return lack;
    return math_min(lack * albedo_stretch_average(d->alpha_along, d->alpha_across) * boundary_stretch(d, eta), 1);
}

void bsdf_facets_boundary(struct bsdf_facets *facets, double eta) {
    facets->kind = FACETS_BOUNDARY;
    facets->eta = eta;
    facets->lack = facets->lack_behind = facets->through = 0;
}

void bsdf_facets_glass(struct bsdf_facets *facets, double eta) {
    bsdf_facets_boundary(facets, eta);
    facets->lack = mean_lack(facets, albedo_boundary_average(facets->roughness, eta), eta);
    facets->lack_behind = mean_lack(facets, albedo_boundary_average(facets->roughness, 1 / eta), 1 / eta);
    double min = facets->lack < facets->lack_behind ? facets->lack : facets->lack_behind;
    facets->through = facets->lack > 0 ? (1 - dielectric_fresnel_average(eta)) * min / facets->lack : 0;
}

void bsdf_facets_pane(struct bsdf_facets *facets, double eta) {
    facets->kind = FACETS_PANE;
    facets->eta = eta;
    facets->lack = facets->lack_behind = mean_lack(facets, albedo_mirror_average(facets->roughness), 1);
    facets->through = 1 - bsdf_pane_reflectance(dielectric_fresnel_average(eta));
}

void bsdf_facets_metal(struct bsdf_facets *facets, struct colour f0, struct colour tint) {
    const double c = 1.0 / 7, rest = 6.0 / 7, fifth = rest * rest * rest * rest * rest;
    facets->kind = FACETS_METAL;
    facets->eta = 1;
    facets->f0 = f0;
    struct colour schlick = colour_add_scaled(f0, colour_sub(colour_all(1), f0), fifth);
    facets->edge = colour_scale(colour_mul(schlick, colour_sub(colour_all(1), tint)), 1 / (c * fifth * rest));
    facets->lack = facets->lack_behind = mean_lack(facets, albedo_mirror_average(facets->roughness), 1);
    facets->through = 0;
}

static struct colour not_negative(struct colour c) {
    return colour_make(c.r > 0 ? c.r : 0, c.g > 0 ? c.g : 0, c.b > 0 ? c.b : 0);
}

struct colour bsdf_metal_fresnel(const struct bsdf_facets *facets, double cosine) {
    double rest = cosine < 1 ? 1 - cosine : 0, fifth = rest * rest * rest * rest * rest;
    struct colour schlick = colour_add_scaled(facets->f0, colour_sub(colour_all(1), facets->f0), fifth);
    return not_negative(colour_add_scaled(schlick, facets->edge, -cosine * fifth * rest));
}

/* The mean of 2 c (1 - c)^5 is 1/21, that of 2 c^2 (1 - c)^6 is 1/126. */
struct colour bsdf_metal_fresnel_average(const struct bsdf_facets *facets) {
    struct colour schlick = colour_add_scaled(facets->f0, colour_sub(colour_all(1), facets->f0), 1.0 / 21);
    return not_negative(colour_add_scaled(schlick, facets->edge, -1.0 / 126));
}

/* --- directions of a hemisphere --- */

/* On the side of the view direction, for both the shading and the geometric normal; otherwise on the other side for
 * both. */
static double cosine_on(const struct bsdf *bsdf, bool behind, struct vec3 wi) {
    double n_l = vec3_dot(bsdf->side, wi), height = vec3_dot(bsdf->geometric_side, wi);
    if (behind)
        return n_l < 0 && height < 0 ? -n_l : 0;
    return n_l > 0 && height > 0 ? n_l : 0;
}

static struct vec3 uniform_sample(struct vec3 normal, struct sample2 u) {
    struct vec3 a, b;
    frame_tangents(normal, &a, &b);
    double height = u.x, across = sqrt(1 - height * height), angle = 2 * PI * u.y;
    struct vec3 out = vec3_scale(normal, height);
    return vec3_add_scaled(vec3_add_scaled(out, a, across * el_cos(angle)), b, across * el_sin(angle));
}

/* --- rough diffuse surfaces --- */

static double clamp_share(double x) {
    return x > 0 ? x < 1 ? x : 1 : 0;
}

static double fujii_a(double roughness) {
    return 1 / (1 + (0.5 - 2 / (3 * PI)) * roughness);
}

/* Portsmouth et al. 2024, equation 5: pi f divided by the colour. */
static double fujii(double roughness, double n_o, double n_i, double o_i) {
    double a = fujii_a(roughness), s = o_i - n_o * n_i, t = s > 0 ? math_max(n_o, n_i) : 1;
    return a * (1 + roughness * s / t);
}

/* Its albedo, equation 18, and the mean of the albedo. */
static double fujii_albedo(double cosine, double roughness) {
    double a = fujii_a(roughness), c = cosine < 1 ? cosine : 1, sine = sqrt(1 - c * c);
    double g = sine * (el_acos(c) - sine * c) + 2.0 / 3 * (sine / c * (1 - sine * sine * sine) - sine);
    return a * (1 + roughness * g / PI);
}
static double fujii_average(double roughness) {
    return fujii_a(roughness) * (1 + (2.0 / 3 - 28 / (15 * PI)) * roughness);
}

struct colour bsdf_oren_nayar_multiple(struct colour colour, double roughness) {
    double once = fujii_average(roughness), lack = 1 - once;
    return colour_make(colour.r * colour.r * once / (1 - colour.r * lack),
                       colour.g * colour.g * once / (1 - colour.g * lack),
                       colour.b * colour.b * once / (1 - colour.b * lack));
}

static double oren_nayar_multiple(double roughness, double n_o, double n_i) {
    double lack = 1 - fujii_average(roughness);
    return lack > 0 ? (1 - fujii_albedo(n_o, roughness)) * (1 - fujii_albedo(n_i, roughness)) / lack : 0;
}

/* --- fuzz --- */

static double fuzz(double roughness, double n_o, double n_i, struct vec3 normal, struct vec3 wo, struct vec3 wi) {
    double exponent = 1 / (0.25 + 0.75 * roughness);
    double n_h = vec3_dot(normal, vec3_normalize(vec3_add(wo, wi))), sine2 = n_h * n_h < 1 ? 1 - n_h * n_h : 0;
    double facets = (2 + exponent) * el_pow(sine2, exponent / 2) / (2 * PI);
    return facets / (4 * (n_i + n_o - n_i * n_o)) * n_i;
}

/* --- facets --- */

/* The direction mirrored to the other side of the surface. */
static struct vec3 across_surface(const struct bsdf *bsdf, struct vec3 w) {
    return vec3_add_scaled(w, bsdf->side, -2 * vec3_dot(bsdf->side, w));
}

/* The fraction of light that facets with this cosine to the view direction reflect; metals have a colour instead. */
static double reflected_share(const struct bsdf_facets *facets, double towards) {
    switch (facets->kind) {
    case FACETS_BOUNDARY:
        return dielectric_fresnel(towards, facets->eta);
    case FACETS_PANE:
        return bsdf_pane_reflectance(dielectric_fresnel(towards, facets->eta));
    case FACETS_METAL:
        break;
    }
    return 1;
}

/* The fraction that goes into the lobe; with a tint it is a part of the colour. */
static double share_of_facet(const struct bsdf_facets *facets, unsigned flags, double towards) {
    if (flags & BSDF_TINTED)
        return 1;
    double reflected = reflected_share(facets, towards);
    return flags & BSDF_TRANSMITS ? 1 - reflected : reflected;
}

/* How one facet reflects or refracts a direction: its normal, the factor of its density, and that from Fresnel and
 * masking. */
struct facet_path {
    struct vec3 half;
    double jacobian, share;
};
static const struct facet_path no_facet = {{0, 0, 0}, 0, 0};

static struct facet_path path_by(const struct bsdf_facets *facets, struct vec3 wo, struct vec3 wi, struct vec3 half,
                                 double jacobian, double share) {
    share *= facet_distribution_escape(&facets->distribution, wo, wi);
    return share > 0 ? (struct facet_path){half, jacobian, share} : no_facet;
}

static struct facet_path mirrored(const struct bsdf_facets *facets, unsigned flags, struct vec3 wo, struct vec3 wi) {
    struct vec3 half = vec3_normalize(vec3_add(wo, wi));
    double v_h = vec3_dot(wo, half);
    if (!(v_h > 0))
        return no_facet;
    return path_by(facets, wo, wi, half, 1 / (4 * v_h), share_of_facet(facets, flags, v_h));
}

/* Light that a thin wall transmits leaves in the mirrored direction on the other side. */
static struct facet_path through_pane(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo,
                                      struct vec3 wi) {
    const struct bsdf_facets *facets = &bsdf->facets[lobe->facets];
    const unsigned flags = lobe_flags(lobe->kind);
    struct vec3 above = across_surface(bsdf, wi), half = vec3_normalize(vec3_add(wo, above));
    double v_h = vec3_dot(wo, half);
    if (!(v_h > 0))
        return no_facet;
    return path_by(facets, wo, above, half, 1 / (4 * v_h), share_of_facet(facets, flags, v_h));
}

/* Walter et al. 2007, sections 5.2 and 5.3. */
static struct facet_path refracted(const struct bsdf_facets *facets, unsigned flags, struct vec3 wo, struct vec3 wi) {
    if (facets->eta == 1)
        return no_facet;
    struct vec3 half = vec3_normalize(vec3_add_scaled(wi, wo, facets->eta));
    if (!(vec3_dot(half, facets->distribution.normal) > 0))
        half = vec3_negate(half);
    double v_h = vec3_dot(wo, half), l_h = vec3_dot(wi, half), sum = facets->eta * v_h + l_h;
    if (!(v_h > 0 && l_h < 0 && sum != 0))
        return no_facet;
    return path_by(facets, wo, wi, half, -l_h / (sum * sum), share_of_facet(facets, flags, v_h));
}

static struct facet_path path_of(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 wi) {
    const struct bsdf_facets *facets = &bsdf->facets[lobe->facets];
    const unsigned flags = lobe_flags(lobe->kind);
    bool behind = flags & BSDF_TRANSMITS;
    if (!(cosine_on(bsdf, behind, wi) > 0))
        return no_facet;
    if (!behind)
        return mirrored(facets, flags, wo, wi);
    return facets->kind == FACETS_PANE ? through_pane(bsdf, lobe, wo, wi) : refracted(facets, flags, wo, wi);
}

static double path_pdf(const struct bsdf_facets *facets, struct vec3 wo, const struct facet_path *path) {
    return path->share > 0 ? facet_distribution_pdf(&facets->distribution, wo, path->half) * path->jacobian : 0;
}

static bool facet_sample(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct sample2 u,
                         struct vec3 *direction, bool *transmits) {
    const struct bsdf_facets *facets = &bsdf->facets[lobe->facets];
    struct vec3 facet = facet_distribution_sample(&facets->distribution, wo, u);
    *transmits = lobe_flags(lobe->kind) & BSDF_TRANSMITS;
    if (*transmits && facets->kind != FACETS_PANE) {
        if (facets->eta == 1 || !dielectric_refract(facet, wo, facets->eta, direction))
            return false;
    } else {
        *direction = dielectric_mirror(facet, wo);
        if (*transmits)
            *direction = across_surface(bsdf, *direction);
    }
    return cosine_on(bsdf, *transmits, *direction) > 0;
}

struct facet_shares {
    struct colour reflected, lack;
};

/* What facets below a film reflect, at equal steps of the cosine on the thinner side of the boundary. */
enum { FILM_STEPS = 16 };

static void film_shares(const struct thin_film *film, double eta, struct colour shares[FILM_STEPS + 1]) {
    for (int i = 0; i <= FILM_STEPS; i++) {
        double cosine = (double)i / FILM_STEPS;
        cosine = eta > 1 ? sqrt(1 - (1 - cosine * cosine) / (eta * eta)) : cosine;
        shares[i] = thin_film_boundary(film, cosine, eta);
    }
}

static struct colour film_share(const struct colour shares[FILM_STEPS + 1], double cosine, double eta) {
    double across = eta * eta * (1 - cosine * cosine);
    if (across >= 1)
        return colour_all(1);
    double at = FILM_STEPS * math_min(eta > 1 ? sqrt(1 - across) : cosine, 1);
    int i = at < FILM_STEPS ? (int)at : FILM_STEPS - 1;
    return colour_add_scaled(shares[i], colour_sub(shares[i + 1], shares[i]), at - i);
}

/* Boundaries of two widths, or below a film (else NULL): sums over facets that the direction sees, at the points of a
 * lattice of Fibonacci's. Steep facets, beside the edges of the square of random numbers, lose most: the points are
 * denser there. */
static __attribute__((noinline)) struct facet_shares
sums_of_boundary(const struct facet_distribution *d, struct vec3 direction, double eta, const struct thin_film *film) {
    /* All quadrants, and both sides, are alike. */
    struct vec3 view = vec3_scale(d->normal, fabs(vec3_dot(direction, d->normal)));
    view = vec3_add_scaled(view, d->along, fabs(vec3_dot(direction, d->along)));
    view = vec3_add_scaled(view, d->across, fabs(vec3_dot(direction, d->across)));
    const bool dense = eta > 1; /* total reflection divides the facets */
    const int points = dense ? 233 : 34, step = dense ? 144 : 21;
    struct colour shares[FILM_STEPS + 1];
    if (film)
        film_shares(film, eta, shares);
    struct colour reflected = {0, 0, 0}, passed = {0, 0, 0};
    double all = 0;
    for (int i = 0; i < points; i++) {
        double s = (i + 0.5) / points, t = (i * step % points + 0.5) / points, weight = s * (1 - s) * t * (1 - t);
        struct sample2 u = {s * s * (3 - 2 * s), t * t * (3 - 2 * t)};
        struct vec3 facet = facet_distribution_sample(d, view, u), out = dielectric_mirror(facet, view);
        double towards = vec3_dot(facet, view);
        struct colour share = film ? film_share(shares, towards, eta) : colour_all(dielectric_fresnel(towards, eta));
        all += weight;
        if (vec3_dot(out, d->normal) > 0)
            reflected = colour_add(reflected,
                                   colour_scale(colour_scale(share, weight), facet_distribution_escape(d, view, out)));
        if (dielectric_refract(facet, view, eta, &out) && vec3_dot(out, d->normal) < 0)
            passed = colour_add(passed, colour_scale(colour_scale(colour_sub(colour_all(1), share), weight),
                                                     facet_distribution_escape(d, view, out)));
    }
    const struct colour sum = colour_add(reflected, passed);
    return (struct facet_shares){{reflected.r / all, reflected.g / all, reflected.b / all},
                                 not_negative(colour_make(1 - sum.r / all, 1 - sum.g / all, 1 - sum.b / all))};
}

/* The share of light from one direction that neither leaves by the first facet nor passes through it; `behind`: from
 * the other side. */
static double lack_towards(const struct bsdf_facets *facets, struct vec3 direction, bool behind) {
    double eta = behind ? 1 / facets->eta : facets->eta, height = vec3_dot(direction, facets->distribution.normal);
    bool stretched = is_stretched(facets);
    if (facets->kind == FACETS_BOUNDARY)
        return stretched ? sums_of_boundary(&facets->distribution, direction, eta, NULL).lack.r
                         : 1 - albedo_boundary(fabs(height), facets->roughness, eta);
    double lack = 1 - albedo_mirror(fabs(height), facets->roughness);
    return stretched ? math_min(lack * stretch_towards(facets, direction), 1) : lack;
}

void bsdf_facets_see(struct bsdf_facets *facets, struct vec3 view) {
    if (facets->kind == FACETS_BOUNDARY) {
        if (is_stretched(facets)) {
            struct facet_shares shares = sums_of_boundary(&facets->distribution, view, facets->eta, NULL);
            facets->reflected = shares.reflected.r;
            facets->lack_seen = shares.lack.r;
            return;
        }
        double cosine = fabs(vec3_dot(view, facets->distribution.normal));
        facets->reflected = albedo_reflection(cosine, facets->roughness, facets->eta);
        if (!(facets->lack > 0)) {
            facets->lack_seen = 0;
            return;
        }
    }
    facets->lack_seen = lack_towards(facets, view, false);
}

struct colour bsdf_facets_see_film(struct bsdf_facets *facets, const struct thin_film *film, struct vec3 view,
                                   struct colour *lack) {
    struct facet_shares shares = sums_of_boundary(&facets->distribution, view, facets->eta, film);
    double mean = colour_dot(shares.lack, colour_all(1.0 / 3));
    facets->lack_seen = mean;
    *lack = colour_share(shares.lack, colour_all(mean));
    return shares.reflected;
}

static double facets_multiple(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wi) {
    const struct bsdf_facets *facets = &bsdf->facets[lobe->facets];
    bool behind = lobe_flags(lobe->kind) & BSDF_TRANSMITS;
    double mean = behind ? facets->lack_behind : facets->lack;
    double share = behind ? facets->through : 1 - facets->through;
    return mean > 0 ? share * facets->lack_seen * lack_towards(facets, wi, behind) / mean : 0;
}

/* --- the four functions of lobes --- */

double rough_lobe_eval(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 wi) {
    double n_i = cosine_on(bsdf, lobe_flags(lobe->kind) & BSDF_TRANSMITS, wi), n_o = vec3_dot(bsdf->side, wo);
    if (!(n_i > 0))
        return 0;
    switch (lobe->kind) {
    case LOBE_OREN_NAYAR:
        return fujii(clamp_share(lobe->exponent), n_o, n_i, vec3_dot(wo, wi)) * n_i / PI;
    case LOBE_OREN_NAYAR_MULTIPLE:
        return oren_nayar_multiple(clamp_share(lobe->exponent), n_o, n_i) * n_i / PI;
    case LOBE_FUZZ:
        return fuzz(clamp_share(lobe->exponent), n_o, n_i, bsdf->side, wo, wi);
    case LOBE_GLOSS:
    case LOBE_METAL:
    case LOBE_GLASS:
    case LOBE_PANE:
    case LOBE_FILM:
    case LOBE_FILM_GLASS:
    case LOBE_FILM_PANE: {
        struct facet_path path = path_of(bsdf, lobe, wo, wi);
        return path_pdf(&bsdf->facets[lobe->facets], wo, &path) * path.share;
    }
    case LOBE_FACETS_MULTIPLE:
    case LOBE_FACETS_THROUGH:
        return facets_multiple(bsdf, lobe, wi) * n_i / PI;
    case LOBE_DIFFUSE_THROUGH:
        return n_i / PI;
        SIMPLE_LOBES(LIST_LABEL)
        break;
    }
    return 0;
}

/* What a facet below the film reflects. */
static struct colour filmed_share(const struct bsdf *bsdf, const struct bsdf_facets *facets, double towards) {
    switch (facets->kind) {
    case FACETS_BOUNDARY:
        return thin_film_boundary(&bsdf->film, towards, facets->eta);
    case FACETS_PANE:
        return thin_film_pane(&bsdf->film, towards, facets->eta);
    case FACETS_METAL:
        break;
    }
    return thin_film_metal(&bsdf->film, towards, bsdf_metal_fresnel(facets, towards));
}

static __attribute__((noinline)) struct colour filmed_weight(const struct bsdf *bsdf, const struct lobe *lobe,
                                                             struct vec3 wo, struct vec3 wi) {
    double towards = vec3_dot(wo, path_of(bsdf, lobe, wo, wi).half);
    struct colour share = filmed_share(bsdf, &bsdf->facets[lobe->facets], towards);
    bool transmits = lobe_flags(lobe->kind) & BSDF_TRANSMITS;
    return colour_mul(lobe->weight, transmits ? colour_sub(colour_all(1), share) : share);
}

struct colour rough_lobe_weight(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 wi) {
    if (!(lobe_flags(lobe->kind) & BSDF_TINTED))
        return lobe->weight;
    if (lobe->kind != LOBE_METAL)
        return filmed_weight(bsdf, lobe, wo, wi);
    double towards = vec3_dot(wo, vec3_normalize(vec3_add(wo, wi)));
    return colour_mul(lobe->weight, bsdf_metal_fresnel(&bsdf->facets[lobe->facets], towards));
}

double rough_lobe_pdf(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 wi) {
    double n_i = cosine_on(bsdf, lobe_flags(lobe->kind) & BSDF_TRANSMITS, wi);
    if (!(n_i > 0))
        return 0;
    switch (lobe->kind) {
    case LOBE_FUZZ:
        return 1 / (2 * PI);
    case LOBE_OREN_NAYAR:
    case LOBE_OREN_NAYAR_MULTIPLE:
    case LOBE_FACETS_MULTIPLE:
    case LOBE_FACETS_THROUGH:
    case LOBE_DIFFUSE_THROUGH:
        return n_i / PI;
    case LOBE_GLOSS:
    case LOBE_METAL:
    case LOBE_GLASS:
    case LOBE_PANE:
    case LOBE_FILM:
    case LOBE_FILM_GLASS:
    case LOBE_FILM_PANE: {
        struct facet_path path = path_of(bsdf, lobe, wo, wi);
        return path_pdf(&bsdf->facets[lobe->facets], wo, &path);
    }
        SIMPLE_LOBES(LIST_LABEL)
        break;
    }
    return 0;
}

double rough_lobe_share(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct vec3 wi) {
    return path_of(bsdf, lobe, wo, wi).share;
}

bool rough_lobe_sample(const struct bsdf *bsdf, const struct lobe *lobe, struct vec3 wo, struct sample2 u,
                       struct vec3 *direction, bool *transmits) {
    *transmits = lobe_flags(lobe->kind) & BSDF_TRANSMITS;
    switch (lobe->kind) {
    case LOBE_FUZZ:
        *direction = uniform_sample(bsdf->side, u);
        break;
    case LOBE_OREN_NAYAR:
    case LOBE_OREN_NAYAR_MULTIPLE:
    case LOBE_FACETS_MULTIPLE:
    case LOBE_FACETS_THROUGH:
    case LOBE_DIFFUSE_THROUGH:
        *direction = sample_cosine(*transmits ? vec3_negate(bsdf->side) : bsdf->side, u);
        break;
    case LOBE_GLOSS:
    case LOBE_METAL:
    case LOBE_GLASS:
    case LOBE_PANE:
    case LOBE_FILM:
    case LOBE_FILM_GLASS:
    case LOBE_FILM_PANE:
        return facet_sample(bsdf, lobe, wo, u, direction, transmits);
        SIMPLE_LOBES(LIST_LABEL)
        return false;
    }
    return cosine_on(bsdf, *transmits, *direction) > 0;
}
