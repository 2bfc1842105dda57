/* Parallelograms and discs: hits of rays, samples, photons, bounds. */
#include "light/light_shapes_internal.h"
#include "math/elementary.h"
#include "math/frame.h"

/* --- samples --- */

bool light_planar_is_behind(const struct light *light, struct vec3 normal, struct vec3 from) {
    return light->emissive && light->one_sided && !(vec3_dot(normal, vec3_sub(from, light->position)) > 0);
}

struct vec3 light_disc_target(const struct light *light, const struct light_context *context, struct sample2 xi) {
    struct sample2 round = sample_disc(xi);
    struct vec3 target = vec3_add_scaled(light->position, context->right, light->radius * round.x);
    return vec3_add_scaled(target, context->up, light->radius * round.y);
}

bool light_is_beside_disc(const struct light *light, struct vec3 point) {
    return vec3_length_squared(vec3_sub(point, light->position)) > light->radius * light->radius;
}

/* --- rays --- */

void light_plane_prepare(struct light *light) {
    struct light_plane *plane = &light->plane;
    plane->across = vec3_cross(light->edge1, light->edge2);
    plane->area = vec3_length(plane->across);
    plane->normal = light->kind == LIGHT_DISC ? light->direction : vec3_normalize(plane->across);
    plane->size = math_max(vec3_max_abs(light->position) + light->radius,
                           vec3_max_abs(light->corner) + vec3_max_abs(light->edge1) + vec3_max_abs(light->edge2));
    if (light->kind == LIGHT_PARALLELOGRAM) {
        plane->frame = rectangle_frame_make(light->edge1, light->edge2);
        return;
    }
    struct light_context square;
    frame_tangents(light->direction, &plane->right, &plane->up);
    square.right = plane->right;
    square.up = plane->up;
    light_context_square(&square, light->position, light->radius);
    plane->frame = rectangle_frame_make(square.edge1, square.edge2);
}

struct vec3 light_planar_before(const struct light *light, struct vec3 from, struct vec3 at) {
    struct vec3 away = vec3_sub(from, at);
    double gap = light_gap(light->plane.size, vec3_length(away)), height = fabs(vec3_dot(light->plane.normal, away));
    return vec3_add_scaled(at, away, gap < height ? gap / height : 1);
}

/* The plane through a point, from the emitting side; p: relative to that point. */
static bool plane_meets_ray(const struct light *light, struct vec3 on_plane, const struct ray *ray, double *t,
                            struct vec3 *p) {
    struct vec3 normal = light->plane.normal;
    double across = vec3_dot(normal, ray->direction);
    if (across == 0 || (light->one_sided && across > 0))
        return false;
    *t = vec3_dot(normal, vec3_sub(on_plane, ray->origin)) / across;
    if (!light_plane_is_met(ray, *t, across, light->plane.size))
        return false;
    *p = vec3_sub(ray_at(ray, *t), on_plane);
    return true;
}

bool light_parallelogram_meets_ray(const struct light *light, const struct ray *ray, double *t) {
    struct vec3 p;
    if (!plane_meets_ray(light, light->corner, ray, t, &p))
        return false;
    struct vec3 normal = light->plane.across;
    double n2 = vec3_dot(normal, normal);
    double u = vec3_dot(vec3_cross(p, light->edge2), normal) / n2;
    double v = vec3_dot(vec3_cross(light->edge1, p), normal) / n2;
    return u >= 0 && u <= 1 && v >= 0 && v <= 1;
}

bool light_disc_meets_ray(const struct light *light, const struct ray *ray, double *t) {
    struct vec3 p;
    return plane_meets_ray(light, light->position, ray, t, &p) && vec3_dot(p, p) < light->radius * light->radius;
}

/* --- photons --- */

/* The ball that contains the points of a part. */
void light_parallelogram_emitter(struct light_emitter *out) {
    const struct light *light = out->light;
    double u = out->low[0] + out->side / 2, v = out->low[1] + out->side / 2;
    out->centre = vec3_add_scaled(vec3_add_scaled(light->corner, light->edge1, u), light->edge2, v);
    double one = vec3_length(vec3_add(light->edge1, light->edge2)) / 2;
    double other = vec3_length(vec3_sub(light->edge1, light->edge2)) / 2;
    out->radius = (one > other ? one : other) * out->side;
}

/* The cosine at a planar light, on the emitting side. */
double light_planar_shine(const struct light *light, struct vec3 normal, struct vec3 direction) {
    double cosine = vec3_dot(normal, direction);
    return cosine > 0 ? cosine : light->one_sided ? 0 : -cosine;
}

/* --- bounds --- */

struct box light_parallelogram_box(const struct light *light) {
    struct box box = {light->corner, light->corner};
    box = box_add_point(box, vec3_add(light->corner, light->edge1));
    box = box_add_point(box, vec3_add(light->corner, light->edge2));
    return box_add_point(box, vec3_add(vec3_add(light->corner, light->edge1), light->edge2));
}

struct box light_disc_box(const struct light *light) {
    struct vec3 n = light->direction;
    struct vec3 sines = {sqrt(math_max(0, 1 - n.x * n.x)), sqrt(math_max(0, 1 - n.y * n.y)),
                         sqrt(math_max(0, 1 - n.z * n.z))};
    return light_box_centred(light->position, vec3_scale(sines, light->radius));
}

void light_bounds_shine(const struct light *light, struct vec3 normal, double area, struct light_bounds *out) {
    light_bounds_emit(light_strength(light) * area, out);
    out->axis = normal;
    out->cos_theta_o = 1;
    out->cos_theta_e = 0;
    out->two_sided = !light->one_sided;
}

/* A sphere, sampled by solid angle within its cone: Shirley, Wang, Zimmerman, "Monte Carlo Techniques
 * for Direct Lighting Calculations", TOG 1996. */

/* 1 - cos of the cone, without cancellation. */
static double cone_drop(const struct light_context *context) {
    return context->weight / 2;
}

/* From inside every direction hits the sphere: the solid angle is 4 pi. */
static bool inside_context(const struct light *light, double distance, struct light_context *out) {
    out->distance = distance;
    out->bounded = false;
    out->weight = 4;
    return light->emissive && distance < light->radius;
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

/* Uniform over all directions; finds the exit point of the ray. If the exit is closer than the precision of ray offsets
 * (for directions out of the sphere from a point on it), the target is a point farther in the same direction: rays that
 * start on the sphere itself determine their own hits. */
static struct vec3 inside_target(const struct light *light, const struct light_context *context, struct sample2 xi) {
    double y = 1 - 2 * xi.y, level = 2 * sqrt(xi.y * (1 - xi.y)), sine, cosine;
    el_sincos(2 * PI * xi.x, &sine, &cosine);
    struct vec3 direction = {level * cosine, y, level * sine}, off = vec3_sub(context->from, light->position);
    double along = vec3_dot(off, direction), room = light->radius * light->radius - vec3_length_squared(off);
    double exit = sqrt(along * along + (room > 0 ? room : 0)) - along;
    return vec3_add_scaled(context->from, direction, exit > 0x1p-20 * light->radius ? exit : light->radius);
}

/* Uniform in the cone: 1 - cos grows with the square of the place's distance from the middle. */
struct vec3 light_sphere_target(const struct light *light, const struct light_context *context, struct sample2 xi) {
    if (context->distance < light->radius)
        return inside_target(light, context, xi);
    struct sample2 round = sample_disc(xi);
    double squared = round.x * round.x + round.y * round.y;
    double drop = squared * cone_drop(context), cosine = 1 - drop;
    double sine = sqrt(drop * (2 - drop)), radius = sqrt(squared);
    double x = radius > 0 ? sine * round.x / radius : 0, y = radius > 0 ? sine * round.y / radius : 0;
    struct vec3 direction = vec3_add_scaled(vec3_scale(context->axis, cosine), context->right, x);
    direction = vec3_add_scaled(direction, context->up, y);
    /* The near crossing with the sphere. From a point on the sphere it is closer than the offset of rays, and the
     * direction to it from the surface itself would not be exact: the target is farther, as in inside_target. */
    double along = context->distance * cosine, off = context->distance * sine;
    double half = light->radius * light->radius - off * off, near = along - (half > 0 ? sqrt(half) : 0);
    return vec3_add_scaled(context->from, direction, near > 0x1p-32 * light->radius ? near : light->radius);
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
