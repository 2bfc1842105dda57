/* Shared by the files of this module. */
#ifndef GRAY_LIGHT_LIGHT_SHAPES_INTERNAL_H
#define GRAY_LIGHT_LIGHT_SHAPES_INTERNAL_H

#include "light/light.h"
#include "light/light_sampler.h"
#include "material/classic.h"

#include <math.h>

/* Of the magnitudes: negative light is sampled as often as positive light. */
static inline double light_luminance(struct colour c) {
    return 0.2126 * fabs(c.r) + 0.7152 * fabs(c.g) + 0.0722 * fabs(c.b);
}

/* The intensity of radiance 1 from a place on a plane, for the intensity of its area. */
static inline double weight_of_area(double weight, struct vec3 normal, struct vec3 away) {
    double squared = vec3_length_squared(away), cosine = fabs(vec3_dot(normal, away));
    return squared > 0 ? weight * cosine / (squared * sqrt(squared)) : 0;
}

/* The square of twice `half` about `centre` across the context's axis becomes the parallelogram that holds all
 * targets. */
static inline void light_context_square(struct light_context *out, struct vec3 centre, double half) {
    out->edge1 = vec3_scale(out->right, 2 * half);
    out->edge2 = vec3_scale(out->up, 2 * half);
    out->corner = vec3_add_scaled(vec3_add_scaled(centre, out->right, -half), out->up, -half);
}

/* A lamp without a body may lie exactly in a ceiling or wall: both have the same t, but for rounding. So rays meet such
 * a lamp a little before its plane, and shadow rays end there. Relative to the coordinates: size is the largest one of
 * the lamp, distance that of the point from which the lamp is seen. */
static inline double light_gap(double size, double distance) {
    return 0x1p-40 * (size + distance);
}
/* Whether a ray that crosses the plane of a lamp at t meets it in its interval. across: of the unit normal and the
 * ray's direction, not 0. */
static inline bool light_plane_is_met(const struct ray *ray, double t, double across, double size) {
    double before = t - light_gap(size, fabs(t) * vec3_length(ray->direction)) / fabs(across);
    return before > ray->t_min && before < ray->t_max;
}

/* light_shapes.c: parallelograms and discs. */
void light_plane_prepare(struct light *light);
/* The end of a shadow ray to a point of the lamp, on the way to it. */
struct vec3 light_planar_before(const struct light *light, struct vec3 from, struct vec3 at);
/* False: a one-sided light is seen from its dark side. */
bool light_planar_is_behind(const struct light *light, struct vec3 normal, struct vec3 from);
struct vec3 light_disc_target(const struct light *light, const struct light_context *context, struct sample2 xi);
bool light_is_beside_disc(const struct light *light, struct vec3 point);
bool light_parallelogram_meets_ray(const struct light *light, const struct ray *ray, double *t);
bool light_disc_meets_ray(const struct light *light, const struct ray *ray, double *t);
/* Sets the ball that contains the points of a part. */
void light_parallelogram_emitter(struct light_emitter *out);
/* The cosine at a planar light, on the emitting side. */
double light_planar_shine(const struct light *light, struct vec3 normal, struct vec3 direction);
struct box light_parallelogram_box(const struct light *light);
struct box light_disc_box(const struct light *light);

/* Parts of light_bounds_of. The brightness of a colour for light selection; negative light counts by its magnitude. */
static inline double light_magnitude(struct colour c) {
    return (fabs(c.r) + fabs(c.g) + fabs(c.b)) / 3;
}
/* A bound of the colour in every direction. */
static inline double light_strength(const struct light *light) {
    return light_magnitude(light->colour) * (light->profile ? light->profile_largest : 1);
}
static inline struct box light_box_centred(struct vec3 centre, struct vec3 half) {
    return (struct box){vec3_sub(centre, half), vec3_add(centre, half)};
}
/* A light of that classic intensity at distance 1, which falls with the square of the distance. */
static inline void light_bounds_emit(double intensity, struct light_bounds *out) {
    out->attenuation = intensity;
    out->falloff[2] = 1;
}
/* A planar light with area / pi, by the cosine (light_shapes.c). */
void light_bounds_shine(const struct light *light, struct vec3 normal, double area, struct light_bounds *out);
/* The mathematics of LIGHT_SPHERE, for light.c. */

/* False: the point is on the sphere, or so near that the cone is a half-space, or inside a delta light. */
bool light_sphere_context(const struct light *light, struct light_context *out);
/* Equal areas of the unit square are equal solid angles. */
struct vec3 light_sphere_target(const struct light *light, const struct light_context *context, struct sample2 xi);
/* The nearest crossing in the ray's interval. */
bool light_sphere_meets_ray(const struct light *light, const struct ray *ray, double *t);

#endif
