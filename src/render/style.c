/* See style_internal.h. */
#include "render/style_internal.h"

#include "base/unreachable.h"
#include "material/bsdf_select.h"
#include "render/direct_internal.h"

#include <math.h>

static double largest(struct vec3 c) {
    double max = c.x > c.y ? c.x : c.y;
    return c.z > max ? c.z : max;
}

/* The light of all lights on a white matt surface. */
static struct vec3 matt_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf,
                              uint64_t key) {
    const struct bsdf matt = bsdf_matt_copy(bsdf);
    return direct_light(state, hit, &matt, key);
}

/* Only the highlights; *colour: the sum of their weights. */
static struct vec3 highlight(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf,
                             uint64_t key, struct vec3 *colour) {
    const struct bsdf shiny = bsdf_shiny_copy(bsdf, colour);
    return shiny.count > 0 && largest(*colour) > 0 ? direct_light(state, hit, &shiny, key) : vec3_all(0);
}

static struct vec3 toon_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf,
                              uint64_t key) {
    int steps = state->job->settings.toon_steps;
    struct vec3 light = matt_light(state, hit, bsdf, key), shiny;
    double max = largest(light), step = fmin(floor(max * steps + 0.5) / steps, 1);
    struct vec3 colour = vec3_mul(state->job->ambient, bsdf->ambient);
    if (max > 0)
        colour = vec3_add(colour, vec3_mul(bsdf->albedo, vec3_scale(light, step / max)));
    struct vec3 spot = highlight(state, hit, bsdf, key, &shiny);
    return largest(spot) > 0.5 * largest(shiny) ? vec3_add(colour, shiny) : colour;
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

static struct vec3 gooch_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf,
                               uint64_t key) {
    const struct world *world = state->job->world;
    struct vec3 shiny;
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
    struct vec3 cool = vec3_add_scaled(vec3_make(0, 0, 0.4), bsdf->albedo, 0.2);
    struct vec3 warm = vec3_add_scaled(vec3_make(0.4, 0.4, 0), bsdf->albedo, 0.6);
    struct vec3 colour = vec3_add(vec3_scale(warm, warmth), vec3_scale(cool, 1 - warmth));
    colour = vec3_add(colour, highlight(state, hit, bsdf, key, &shiny));
    state->camera_hit = NULL;
    return colour;
}

struct vec3 style_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf, uint64_t key) {
    switch (state->job->settings.style) {
    case STYLE_NONE:
        return direct_light(state, hit, bsdf, key);
    case STYLE_INK:
        return vec3_all(1);
    case STYLE_TOON:
        return toon_light(state, hit, bsdf, key);
    case STYLE_GOOCH:
        return gooch_light(state, hit, bsdf, key);
    }
    UNREACHABLE("a style of no kind");
}
