/* A random walk (Wrenninge, Villemin and Hery, "Path Traced Subsurface Scattering using Anisotropic Phase Functions and
 * Non-Exponential Free Flights", 2017, for its idea) with the same choice of channels as in media (medium.h). The
 * distance is chosen first, so that a search need not look further. Scatterings have no limit but the roulette; a walk
 * through white matter without end loses its way after so many that where it comes out makes no difference, with the
 * share of its light that diffusion brings up from there. */
#include "render/subsurface_walk_internal.h"

#include "base/random.h"
#include "material/medium.h"
#include "material/phase.h"
#include "math/elementary.h"

enum { WALK_LIMIT = 1 << 16, WALK_NUMBERS = 5 };

/* The medium, and the shares of the channels in the weight. */
struct walk_medium {
    struct colour extinction, albedo;
    struct phase phase;
    bool is_gray; /* one extinction in all channels */
};

static struct walk_medium medium_under(const struct subsurface *under) {
    struct colour c = under->colour, r = under->radius;
    double g = under->g;
    struct walk_medium medium = {.extinction = colour_make(1 / r.r, 1 / r.g, 1 / r.b), .phase.g = g};
    medium.albedo = colour_make(subsurface_albedo(c.r, g), subsurface_albedo(c.g, g), subsurface_albedo(c.b, g));
    medium.is_gray = r.r == r.g && r.g == r.b;
    return medium;
}

/* The factor of the weight after a distance without scattering, or with an event there that of scattering. */
static struct colour factor_after(const struct walk_medium *medium, double distance, const struct medium_flight *flight,
                                  bool event) {
    struct colour e = medium->extinction;
    if (medium->is_gray)
        return event ? medium->albedo : colour_all(1);
    struct colour left = colour_make(el_exp(-e.r * distance), el_exp(-e.g * distance), el_exp(-e.b * distance));
    double chance = medium_flight_chance(flight, e, left, event);
    left = colour_scale(event ? colour_mul(left, e) : left, chance > 0 ? 1 / chance : 0);
    return event ? colour_mul(left, medium->albedo) : left;
}

/* The nearest place where the ray leaves the primitive; other parts of it may lie inside. */
static bool leaves(struct subsurface_walk *walk, const struct ray *ray) {
    struct ray rest = *ray;
    while (world_nearest_of(walk->world, walk->primitive, &rest, walk->scratch, &walk->crossing)) {
        if (!walk->crossing.enter)
            return true;
        rest.t_min = walk->crossing.t;
        rest.skip_primitive = rest.skip_part = 0;
    }
    return false;
}

/* The roulette: as that of paths, whose weight at the start was `whole`. */
static bool survives(struct colour *weight, double whole, double u) {
    double chance = sqrt(colour_max_abs(*weight) / whole);
    if (chance >= 1)
        return true;
    if (!(u < chance))
        return false;
    *weight = colour_scale(*weight, 1 / chance);
    return true;
}

/* The share of light at a depth below a plane that comes out, by the diffusion equation. */
static double share_from(double depth, double extinction, double albedo, double g) {
    return el_exp(-depth * extinction * sqrt(3 * (1 - albedo) * (1 - albedo * g)));
}

bool subsurface_walk(struct subsurface_walk *walk) {
    const struct walk_medium medium = medium_under(&walk->under);
    const struct colour e = medium.extinction, a = medium.albedo;
    struct ray *ray = &walk->ray;
    const struct vec3 begin = ray->origin;
    double whole = colour_max_abs(walk->weight);
    ray->direction = vec3_normalize(ray->direction);
    ray->footprint.spread = 0;
    walk->comes_out = false;
    for (walk->scatterings = 0; walk->scatterings < WALK_LIMIT && whole > 0; walk->scatterings++) {
        double u[WALK_NUMBERS];
        for (int i = 0; i < WALK_NUMBERS; i++)
            u[i] = random_unit(random_combine(walk->key, (uint64_t)(WALK_NUMBERS * walk->scatterings + i)));
        /* How far it goes, and whether it is out before that. */
        const struct medium_flight flight = medium_fly(e, walk->weight, (struct sample2){u[0], u[1]});
        ray->t_min = 0;
        ray->t_max = flight.distance;
        if (leaves(walk, ray)) {
            walk->weight = colour_mul(walk->weight, factor_after(&medium, walk->crossing.t, &flight, false));
            ray->t_max = INFINITY;
            return walk->comes_out = true;
        }
        /* It is scattered. */
        walk->weight = colour_mul(walk->weight, factor_after(&medium, ray->t_max, &flight, true));
        if (!survives(&walk->weight, whole, u[4]))
            return false;
        ray->origin = vec3_add_scaled(ray->origin, ray->direction, ray->t_max);
        ray->direction = phase_sample(&medium.phase, vec3_negate(ray->direction), (struct sample2){u[2], u[3]});
        ray->skip_primitive = ray->skip_part = 0;
    }
    double depth = math_max(vec3_dot(vec3_sub(begin, ray->origin), walk->normal), 0), g = walk->under.g;
    walk->weight = colour_mul(walk->weight, colour_make(share_from(depth, e.r, a.r, g), share_from(depth, e.g, a.g, g),
                                                        share_from(depth, e.b, a.b, g)));
    return whole > 0;
}
