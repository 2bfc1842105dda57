/* A lamp that is a sphere, sampled by solid angle within its cone: Shirley, Wang, Zimmerman, "Monte Carlo Techniques
 * for Direct Lighting Calculations", TOG 1996. */
#include "light/light_sphere.h"

#include "light/light_internal.h"
#include "math/elementary.h"
#include "math/frame.h"

/* 1 - cos of the cone, without cancellation. */
static double cone_drop(const struct light_context *context) {
    return context->weight / 2;
}

/* From inside every direction meets the lamp: the solid angle 4 pi. */
static bool inside_context(const struct light *light, double distance, struct light_context *out) {
    out->distance = distance;
    out->bounded = false;
    out->weight = 4;
    return light->emits && distance < light->radius;
}

bool light_sphere_context(const struct light *light, struct light_context *out) {
    struct vec3 to_centre = vec3_sub(light->position, out->from);
    double distance = vec3_length(to_centre);
    if (!(distance > light->radius))
        return inside_context(light, distance, out);
    double sine = light->radius / distance;
    out->distance = distance;
    out->axis = vec3_scale(to_centre, 1 / distance);
    frame_tangents(out->axis, &out->right, &out->up);
    double cos_cone = sqrt((1 - sine) * (1 + sine));
    if (!(cos_cone > 0))
        return false;
    /* The intensity of its solid angle 2 pi (1 - cos), without cancellation. */
    out->weight = 2 * sine * sine / (1 + cos_cone);
    /* The cone's section through the centre, a little larger than the sphere; targets lie before it. */
    light_context_square(out, light->position, light->radius / cos_cone);
    return true;
}

/* Uniform over all directions; where the ray comes out. */
static struct vec3 inside_target(const struct light *light, const struct light_context *context, struct sample2 place) {
    double y = 1 - 2 * place.y, level = 2 * sqrt(place.y * (1 - place.y)), sine, cosine;
    el_sincos(2 * PI * place.x, &sine, &cosine);
    struct vec3 direction = {level * cosine, y, level * sine}, off = vec3_sub(context->from, light->position);
    double along = vec3_dot(off, direction), room = light->radius * light->radius - vec3_length_squared(off);
    return vec3_add_scaled(context->from, direction, sqrt(along * along + (room > 0 ? room : 0)) - along);
}

/* Uniform in the cone: 1 - cos grows with the square of the place's distance from the middle. */
struct vec3 light_sphere_target(const struct light *light, const struct light_context *context, struct sample2 place) {
    if (context->distance < light->radius)
        return inside_target(light, context, place);
    struct sample2 round = sample_disc(place);
    double squared = round.x * round.x + round.y * round.y;
    double drop = squared * cone_drop(context), cosine = 1 - drop;
    double sine = sqrt(drop * (2 - drop)), radius = sqrt(squared);
    double x = radius > 0 ? sine * round.x / radius : 0, y = radius > 0 ? sine * round.y / radius : 0;
    struct vec3 direction = vec3_add_scaled(vec3_scale(context->axis, cosine), context->right, x);
    direction = vec3_add_scaled(direction, context->up, y);
    /* The near crossing with the sphere. */
    double along = context->distance * cosine, off = context->distance * sine;
    double half = light->radius * light->radius - off * off;
    return vec3_add_scaled(context->from, direction, along - (half > 0 ? sqrt(half) : 0));
}

bool light_sphere_meets_ray(const struct light *light, const struct ray *ray, double *t) {
    struct vec3 d = ray->direction, o = vec3_sub(ray->origin, light->position);
    double a = vec3_dot(d, d), b = vec3_dot(o, d);
    /* The squared distance of the line from the centre, without cancellation. */
    struct vec3 nearest = vec3_add_scaled(o, d, -b / a);
    double half = light->radius * light->radius - vec3_dot(nearest, nearest);
    if (!(half > 0))
        return false;
    double root = sqrt(half / a);
    *t = -b / a - root;
    if (*t > ray->t_min && *t < ray->t_max)
        return true;
    *t = -b / a + root;
    return *t > ray->t_min && *t < ray->t_max;
}
