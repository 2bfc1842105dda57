/* See path_equiangular_internal.h. */
#include "render/path_equiangular_internal.h"

#include "math/elementary.h"
#include "render/path_light_internal.h"

/* The line as a lamp sees it: the nearest point is at `middle`, in the distance `apart`. */
struct view_of_line {
    double middle, apart, from, to; /* angles of the ends */
};

/* False: the lamp has no middle. */
static bool find_view(const struct world_lights *lights, struct light_part part, const struct path_tracked *line,
                      struct view_of_line *out) {
    struct light_target target;
    if (!light_middle(&lights->lights[part.light], &target) || target.distant)
        return false;
    struct vec3 direction = vec3_normalize(line->ray->direction), to = vec3_sub(target.at, line->ray->origin);
    out->middle = vec3_dot(to, direction);
    out->apart = vec3_length(vec3_sub(to, vec3_scale(direction, out->middle)));
    /* On the line itself any small distance will do. */
    out->apart = fmax(out->apart, 0x1p-20 * vec3_length(to));
    out->from = el_atan2(-out->middle, out->apart);
    out->to = line->end < INFINITY ? el_atan2(line->end - out->middle, out->apart) : PI / 2;
    return out->apart > 0 && out->from < out->to;
}

static double view_pdf(const struct view_of_line *view, double t) {
    double off = t - view->middle;
    return view->apart / ((view->to - view->from) * (view->apart * view->apart + off * off));
}

static double squared_share(double own, double other) {
    return own * own / (own * own + other * other);
}

double path_tracked_weight(const struct path_tracer *tracer, const struct path_tracked *tracked, struct light_part part,
                           double pmf) {
    struct view_of_line view;
    if (!(tracked->density > 0) || !find_view(&tracer->lights, part, tracked, &view))
        return 1;
    return squared_share(tracked->density * pmf, view_pdf(&view, tracked->distance) / tracer->aimed_light_count);
}

/* What the media at the point scatter of the sample, weighted against rays that meet the light. */
static struct colour scattered(const struct path_tracer *tracer, const struct path *path, const struct medium_mix *mix,
                               const struct path_shadow *shadow, double pmf) {
    struct vec3 wo = vec3_negate(vec3_normalize(path->ray.direction)), wi = shadow->sample.direction;
    struct colour sum = {0, 0, 0};
    for (uint32_t i = 0; i < mix->count; i++) {
        const struct medium *medium = mix->media[i];
        if (!medium->scatters)
            continue;
        double phase = phase_eval(&medium->phase, wo, wi), density = shadow->sample.pdf * pmf;
        double weight = shadow->sample.is_delta ? 1 : path_light_weight(tracer, density, phase);
        sum = colour_add_scaled(sum, medium->scattering,
                                phase * weight * medium_density(medium, path->scatter.point, path->ray.time));
    }
    return sum;
}

/* path->scatter is the point on the ray. */
static struct colour aimed_light(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                                 const struct medium_mix *mix, double distance) {
    const struct world_lights *lights = &tracer->lights;
    const struct sampler *sampler = &path->sampler;
    const struct sample2 u = sampler_point(sampler, path->dimension | SAMPLER_AIMED);
    const struct path_tracked line = {.ray = &path->ray, .end = distance};
    struct view_of_line view;
    struct path_shadow shadow;
    /* A lamp, and a point on the ray. */
    shadow.part = (struct light_part){tracer->aimed_lights[(uint32_t)(u.x * tracer->aimed_light_count)], 0};
    if (!find_view(lights, shadow.part, &line, &view))
        return colour_all(0);
    double angle = view.from + u.y * (view.to - view.from), sine, cosine;
    el_sincos(angle, &sine, &cosine);
    double t = fmin(fmax(view.middle + view.apart * sine / cosine, 0), distance);
    struct vec3 direction = vec3_normalize(path->ray.direction);
    struct vec3 point = vec3_add_scaled(path->ray.origin, direction, t);
    path->scatter = (struct light_receiver){point, point, {0, 0, 0}, WORLD_NOTHING};
    /* The light there. */
    if (!(t < INFINITY) ||
        !world_lights_sample(lights, &path->scatter, shadow.part,
                             sampler_point(sampler, path->dimension | SAMPLER_AIMED | SAMPLER_STRETCH), &shadow.sample))
        return colour_all(0);
    double pmf_there = light_sampler_pmf(&lights->sampler, point, vec3_all(0), shadow.part);
    struct colour light = scattered(tracer, path, mix, &shadow, pmf_there);
    if (colour_is_black(light))
        return light;
    const struct medium_line before = {path->ray.origin, direction, t, path->ray.time};
    double tracked = medium_mix_density(mix, &before, path->weight);
    double own = view_pdf(&view, t) / tracer->aimed_light_count, weight = squared_share(own, tracked * pmf_there);
    light =
        colour_mul(light, medium_mix_left(mix, &before, random_combine(sampler->key, path->dimension | SAMPLER_AIMED)));
    const struct path_vertex vertex = {.ray = &path->ray, .receiver = &path->scatter};
    path_send_shadow_ray(&vertex, &shadow);
    struct colour arriving = path_light_arriving(tracer, state, path, &shadow);
    arriving = path_without_thrown(tracer, shadow.part.light, path->thrown, arriving);
    return colour_scale(colour_mul(light, arriving), weight / (own * shadow.sample.pdf));
}

struct colour path_aimed_light(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                               const struct medium_mix *mix, double distance) {
    const struct light_receiver scatter = path->scatter;
    struct colour light = aimed_light(tracer, state, path, mix, distance);
    path->scatter = scatter;
    return light;
}
