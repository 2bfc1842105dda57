/* See style_internal.h. */
#include "render/style_internal.h"

#include "base/unreachable.h"
#include "material/bsdf_select.h"
#include "render/direct_internal.h"

#include <math.h>

static double largest(struct colour c) {
    double max = c.r > c.g ? c.r : c.g;
    return c.b > max ? c.b : max;
}

/* The light of all lights on a white matt surface. */
static struct colour matt_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf,
                                uint64_t key) {
    const struct bsdf matt = bsdf_matt_copy(bsdf);
    return direct_light(state, hit, &matt, key);
}

/* Only the highlights; *colour: the sum of their weights. */
static struct colour highlight(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf,
                               uint64_t key, struct colour *colour) {
    const struct bsdf shiny = bsdf_shiny_copy(bsdf, colour);
    return shiny.count > 0 && largest(*colour) > 0 ? direct_light(state, hit, &shiny, key) : colour_all(0);
}

static struct colour toon_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf,
                                uint64_t key) {
    int steps = state->job->settings.toon_steps;
    struct colour light = matt_light(state, hit, bsdf, key), shiny;
    double max = largest(light), step = math_min(floor(max * steps + 0.5) / steps, 1);
    struct colour colour = colour_mul(state->job->ambient, bsdf->ambient);
    if (max > 0)
        colour = colour_add(colour, colour_mul(bsdf->albedo, colour_scale(light, step / max)));
    struct colour spot = highlight(state, hit, bsdf, key, &shiny);
    return largest(spot) > 0.5 * largest(shiny) ? colour_add(colour, shiny) : colour;
}

/* The direction to a light, and its light at the point as the weight. False: the light has no direction. */
static bool towards_light(const struct light *light, const struct hit *hit, struct vec3 *direction, double *weight) {
    struct light_target middle;
    struct light_arrival arrival;
    if (light_is_delta(light)) {
        if (!light_arrive(light, hit->point, &arrival))
            return false;
        *direction = arrival.direction;
        *weight = largest(arrival.colour) * arrival.strength;
        return true;
    }
    if (!light_middle(light, &middle))
        return false;
    struct vec3 to = light_target_from(&middle, hit->point);
    *direction = vec3_normalize(to);
    *weight = light_brightest(light);
    return vec3_max_abs(to) > 0;
}

static struct colour gooch_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf,
                                 uint64_t key) {
    const struct world *world = state->job->world;
    struct colour shiny;
    double sum = 0, weights = 0;
    for (uint32_t i = 0; i < world->light_count; i++) {
        const struct light *light = &world->lights[i];
        struct vec3 direction;
        double weight;
        if ((light->lit && !light->lit[hit->primitive]) || !towards_light(light, hit, &direction, &weight))
            continue;
        sum += weight * (1 + vec3_dot(bsdf->lit, direction)) / 2;
        weights += weight;
    }
    double warmth = weights > 0 ? sum / weights : (1 + vec3_dot(bsdf->lit, hit->view)) / 2;
    struct colour cool = colour_add_scaled(colour_make(0, 0, 0.4), bsdf->albedo, 0.2);
    struct colour warm = colour_add_scaled(colour_make(0.4, 0.4, 0), bsdf->albedo, 0.6);
    struct colour colour = colour_add(colour_scale(warm, warmth), colour_scale(cool, 1 - warmth));
    colour = colour_add(colour, highlight(state, hit, bsdf, key, &shiny));
    state->camera_hit = NULL;
    return colour;
}

struct colour style_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf,
                          uint64_t key) {
    switch (state->job->settings.style) {
    case STYLE_NONE:
        return direct_light(state, hit, bsdf, key);
    case STYLE_INK:
        return colour_all(1);
    case STYLE_TOON:
        return toon_light(state, hit, bsdf, key);
    case STYLE_GOOCH:
        return gooch_light(state, hit, bsdf, key);
    }
    UNREACHABLE("a style of no kind");
}
