/* See path_equiangular_internal.h. */
#include "render/path_equiangular_internal.h"

#include "math/elementary.h"
#include "render/path_light_internal.h"

/* The line as a lamp sees it: the nearest point is at `middle`, in the distance `apart`. */
struct view_of_line {
    double middle, apart, from, to; /* angles of the ends */
};

/* False: the lamp has no middle, or does not shine on the line. */
static bool find_view(const struct world_lights *lights, uint32_t light, const struct ray *ray, double end,
                      struct view_of_line *out) {
    struct light_target target;
    if (!light_middle(&lights->lights[light], &target) || target.distant)
        return false;
    struct vec3 direction = vec3_normalize(ray->direction), to = vec3_sub(target.at, ray->origin);
    out->middle = vec3_dot(to, direction);
    out->apart = vec3_length(vec3_sub(to, vec3_scale(direction, out->middle)));
    /* On the line itself any small distance will do. */
    out->apart = math_max(out->apart, 0x1p-20 * vec3_length(to));
    double first = 0, last = end;
    if (!light_cut(&lights->lights[light], ray->origin, direction, &first, &last))
        return false;
    out->from = el_atan2(first - out->middle, out->apart);
    out->to = last < INFINITY ? el_atan2(last - out->middle, out->apart) : PI / 2;
    return out->apart > 0 && out->from < out->to;
}

static double view_pdf(const struct view_of_line *view, double t) {
    double off = t - view->middle;
    return view->apart / ((view->to - view->from) * (view->apart * view->apart + off * off));
}

static double squared_share(double own, double other) {
    return own * own / (own * own + other * other);
}

/* --- the choice of a lamp --- */

/* POINTS: of the line, at each of which the light is estimated. */
enum { POINTS = 4 };
/* The share of the choice that is the same for all lamps: a beam may lie between the points. */
static const double alike = 0.2;

static double point_of_view(const struct view_of_line *view, double u) {
    double sine, cosine;
    el_sincos(view->from + u * (view->to - view->from), &sine, &cosine);
    return view->middle + view->apart * sine / cosine;
}

/* The integral over the line of the light that comes from the lamp and goes on to the origin of the ray. */
static double light_on_line(const struct world_lights *lights, const struct aimed_light *aimed, const struct ray *ray,
                            double end, double haze) {
    const struct vec3 direction = vec3_normalize(ray->direction);
    struct view_of_line view;
    double sum = 0;
    if (!find_view(lights, aimed->light, ray, end, &view))
        return 0;
    for (int i = 0; i < POINTS; i++) {
        double t = math_max(point_of_view(&view, (i + 0.5) / POINTS), 0);
        sum += light_bounds_importance(&aimed->bounds, vec3_add_scaled(ray->origin, direction, t), vec3_all(0)) /
               view_pdf(&view, t);
    }
    /* Dimmed by what is on the way over the point nearest to the lamp. */
    if (haze > 0)
        sum *= el_exp(-haze * (math_min(math_max(view.middle, 0), end) + view.apart));
    return sum;
}

static void weigh_lights(const struct path_tracer *tracer, const struct path *path, const struct medium_mix *mix,
                         double end, struct path_aimed *out) {
    const uint32_t all = tracer->aimed_light_count;
    const double haze = medium_mix_haze(mix);
    double sum = 0;
    out->count = all < AIMED_LIGHTS ? all : AIMED_LIGHTS;
    out->first = 0;
    if (out->count == 1) {
        out->shares[0] = 1;
        return;
    }
    /* Of many lamps any few that follow each other. */
    if (all > AIMED_LIGHTS)
        out->first = (uint32_t)(random_unit(random_combine(path->sampler.key, path->dimension | SAMPLER_LIGHTS)) * all);
    for (uint32_t i = 0; i < out->count; i++) {
        const struct aimed_light *aimed = &tracer->aimed_lights[(out->first + i) % all];
        sum += out->shares[i] = light_on_line(&tracer->lights, aimed, &path->ray, end, haze);
    }
    for (uint32_t i = 0; i < out->count; i++)
        out->shares[i] = (sum > 0 ? (1 - alike) * out->shares[i] / sum + alike / out->count : 1.0 / out->count);
}

double path_tracked_weight(const struct path_tracer *tracer, const struct path_tracked *tracked, struct light_part part,
                           double pmf) {
    const struct path_aimed *choice = &tracked->choice;
    struct view_of_line view;
    uint32_t i = 0;
    if (!(tracked->density > 0))
        return 1;
    while (i < choice->count &&
           tracer->aimed_lights[(choice->first + i) % tracer->aimed_light_count].light != part.light)
        i++;
    if (i == choice->count || !find_view(&tracer->lights, part.light, tracked->ray, tracked->end, &view))
        return 1;
    return squared_share(tracked->density * pmf, view_pdf(&view, tracked->distance) * choice->shares[i]);
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
                                 const struct medium_mix *mix, double distance, struct path_aimed *choice) {
    const struct world_lights *lights = &tracer->lights;
    const struct sampler *sampler = &path->sampler;
    const struct sample2 u = sampler_point(sampler, path->dimension | SAMPLER_AIMED);
    struct view_of_line view;
    struct path_shadow shadow;
    /* A lamp, and a point on the ray. */
    uint32_t chosen = 0;
    double until;
    weigh_lights(tracer, path, mix, distance, choice);
    for (until = choice->shares[0]; chosen + 1 < choice->count && !(u.x < until); until += choice->shares[chosen])
        chosen++;
    const uint32_t number = (choice->first + chosen) % tracer->aimed_light_count;
    shadow.part = (struct light_part){tracer->aimed_lights[number].light, 0};
    if (!find_view(lights, shadow.part.light, &path->ray, distance, &view))
        return colour_all(0);
    double t = math_min(math_max(point_of_view(&view, u.y), 0), distance);
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
    double own = view_pdf(&view, t) * choice->shares[chosen], weight = squared_share(own, tracked * pmf_there);
    light =
        colour_mul(light, medium_mix_left(mix, &before, random_combine(sampler->key, path->dimension | SAMPLER_AIMED)));
    const struct path_vertex vertex = {.ray = &path->ray, .receiver = &path->scatter};
    path_send_shadow_ray(&vertex, &shadow);
    struct colour arriving = path_light_arriving(tracer, state, path, &shadow);
    arriving = path_without_thrown(tracer, shadow.part.light, path->thrown, arriving);
    return colour_scale(colour_mul(light, arriving), weight / (own * shadow.sample.pdf));
}

struct colour path_aimed_light(const struct path_tracer *tracer, struct integrator_state *state, struct path *path,
                               const struct medium_mix *mix, double distance, struct path_aimed *choice) {
    const struct light_receiver scatter = path->scatter;
    struct colour light = aimed_light(tracer, state, path, mix, distance, choice);
    path->scatter = scatter;
    return light;
}
