/* Airy's formula for each polarisation, with the amplitudes r of both sides of the film and the phase d between them:
 *     R = (r1^2 + r2^2 + 2 r1 r2 cos d) / (1 + r1^2 r2^2 + 2 r1 r2 cos d)
 * White light is the mean over the wavelengths of the observer of spectrum.h, at nodes of equal phase steps. In thick
 * films neighbouring wavelengths have all phases: of the harmonics of d, R keeps those that the observer sees.
 *
 * The second amplitude follows from the one of the surface without the film: a film without thickness changes nothing,
 * whatever the surface is. Metals are known by their reflectance alone; they turn the phase by half a period. */
#include "material/thin_film.h"

#include "material/microfacet_internal.h"
#include "material/rough_lobes_internal.h"
#include "math/elementary.h"
#include "math/sampling.h"
#include "math/spectrum.h"

#include <stdbool.h>

/* The longest difference of paths, in micrometres, at which white light interferes: what the observer sees of its
 * waves is below 1e-3 there, and the nodes still have several phases per period. Harmonics of more are left out. */
static const double longest_path = 9;
/* The phase of a single wavelength is unknown there. */
static const double many_waves = 1e6;

/* The amplitudes of the sides of the film for one polarisation. */
struct amplitudes {
    double outer, inner;
};

/* Both sides together reflect `bare` without a way between them: bare = (outer + inner) / (1 + outer inner). */
static struct amplitudes amplitudes_of(double outer, double bare) {
    double divisor = 1 - outer * bare;
    return (struct amplitudes){outer, divisor > 0 ? (bare - outer) / divisor : 0};
}

static double airy(struct amplitudes a, double cosine) {
    double product = a.outer * a.inner, both = 2 * product * cosine;
    return (a.outer * a.outer + a.inner * a.inner + both) / (1 + product * product + both);
}

/* The same up to a harmonic: 1 / (1 + p^2 + 2 p cos d) = (1 + 2 sum (-p)^k cos(k d)) / (1 - p^2). */
static double airy_of_harmonics(struct amplitudes a, double cosine, int harmonics) {
    double product = a.outer * a.inner, divisor = 1 - product * product;
    double before = 1, now = cosine, power = -product, sum = 0;
    for (int k = 1; k <= harmonics; k++) {
        double next = 2 * cosine * now - before;
        sum += power * now;
        power *= -product;
        before = now;
        now = next;
    }
    double passes = (1 - a.outer * a.outer) * (1 - a.inner * a.inner);
    return divisor > 0 ? 1 - passes * (1 + 2 * sum) / divisor : 1;
}

/* The film as one ray meets it: amplitudes of its outer side across and along the plane of incidence, and the
 * difference of the paths. */
struct passage {
    double across, along, path;
};

/* False: light cannot enter the film. */
static bool enter(const struct thin_film *film, double cosine, struct passage *out) {
    double eta = film->before / film->ior, inside = 1 - eta * eta * (1 - cosine * cosine);
    if (!(inside > 0))
        return false;
    double within = sqrt(inside);
    out->across = (eta * cosine - within) / (eta * cosine + within);
    out->along = (eta * within - cosine) / (eta * within + cosine);
    out->path = 2 * film->ior * film->thickness * within;
    return true;
}

static double unit(double x) {
    return x > 0 ? x < 1 ? x : 1 : 0;
}

/* The reflectance that the observer sees. */
static struct colour seen(const struct thin_film *film, double path, struct amplitudes s, struct amplitudes p) {
    if (!(path < many_waves) || (path > longest_path && !(film->wavelength > 0)))
        return colour_all(unit(0.5 * (airy_of_harmonics(s, 0, 0) + airy_of_harmonics(p, 0, 0))));
    if (film->wavelength > 0) {
        double cosine = el_cos(2 * PI * path / film->wavelength);
        return colour_all(unit(0.5 * (airy(s, cosine) + airy(p, cosine))));
    }
    int harmonics = path > 1 ? (int)(longest_path / path) : 0; /* 0: all */
    /* cos((i + 1) x) = 2 cos x cos(i x) - cos((i - 1) x) */
    const double first = 2 * PI * path * spectrum_node(0), step = 2 * PI * path * (spectrum_node(1) - spectrum_node(0));
    double now = el_cos(first), before = el_cos(first - step), turn = 2 * el_cos(step);
    struct colour sum = {0, 0, 0};
    for (int i = 0; i < SPECTRUM_NODES; i++) {
        double next = turn * now - before;
        double both = harmonics == 0 ? airy(s, now) + airy(p, now)
                                     : airy_of_harmonics(s, now, harmonics) + airy_of_harmonics(p, now, harmonics);
        sum = colour_add_scaled(sum, spectrum_node_weight(i), 0.5 * both);
        before = now;
        now = next;
    }
    return colour_make(unit(sum.r), unit(sum.g), unit(sum.b));
}

/* The part of the surface without the film reflects `bare`. */
static struct colour covered(const struct thin_film *film, struct colour bare, struct colour filmed) {
    return colour_add_scaled(bare, colour_sub(filmed, bare), film->weight);
}

struct colour thin_film_boundary(const struct thin_film *film, double cosine, double eta) {
    double behind = 1 - eta * eta * (1 - cosine * cosine);
    struct colour bare = colour_all(dielectric_fresnel(cosine, eta));
    struct passage in;
    if (!(behind > 0) || !enter(film, cosine, &in))
        return bare;
    double through = sqrt(behind);
    double across = (eta * cosine - through) / (eta * cosine + through);
    double along = (eta * through - cosine) / (eta * through + cosine);
    return covered(film, bare, seen(film, in.path, amplitudes_of(in.across, across), amplitudes_of(in.along, along)));
}

struct colour thin_film_pane(const struct thin_film *film, double cosine, double eta) {
    struct colour side = thin_film_boundary(film, cosine, eta);
    return eta == 1 ? side
                    : colour_make(bsdf_pane_reflectance(side.r), bsdf_pane_reflectance(side.g),
                                  bsdf_pane_reflectance(side.b));
}

struct colour thin_film_metal(const struct thin_film *film, double cosine, struct colour bare) {
    struct passage in;
    double filmed[3];
    if (!enter(film, cosine, &in))
        return bare;
    for (int c = 0; c < 3; c++) {
        double amplitude = -sqrt(unit(colour_get(bare, c)));
        filmed[c] =
            colour_get(seen(film, in.path, amplitudes_of(in.across, amplitude), amplitudes_of(in.along, amplitude)), c);
    }
    return covered(film, bare, colour_make(filmed[0], filmed[1], filmed[2]));
}
