/* Bounds of lights, for light_sampler.c: their union and their importance. The formulas for cones are
 * those of Pharr, Jakob and Humphreys, sections 3.8.4 and 12.6.3. All bounds are conservative: the importance is 0 only
 * if no light arrives. */
#include "light/light_bounds.h"
#include "light/light_shapes_internal.h"
#include "math/elementary.h"
#include "math/range.h"

/* Sums over many lights and products with distances stay finite. */
static const double max = 1e200;

static const double min_cosine = 1.0 / 32;

static double larger(double a, double b) {
    return a > b ? a : b;
}

static double sine_of(double cosine) {
    double squared = 1 - cosine * cosine;
    return squared > 0 ? sqrt(squared) : 0;
}

/* What importance needs at every node. */
static void work_out(struct light_bounds *b) {
    b->centre = vec3_scale(vec3_add(b->box.min, b->box.max), 0.5);
    b->radius = vec3_length(vec3_sub(b->box.max, b->centre));
    b->sin_theta_o = sine_of(b->cos_theta_o);
}

bool light_bounds_finish(struct light_bounds *b) {
    b->steady = math_min(b->steady, max);
    b->attenuation = math_min(b->attenuation, max);
    work_out(b);
    return b->steady + b->attenuation > 0 && vec3_finite(b->box.min) && vec3_finite(b->box.max);
}

/* --- unions --- */

static double angle_of(double cosine) {
    return el_acos(math_max(-1, math_min(1, cosine)));
}

/* v turned by the angle towards `to`, a unit vector at right angles to it. */
static struct vec3 turned(struct vec3 v, struct vec3 to, double angle) {
    double sine, cosine;
    el_sincos(angle, &sine, &cosine);
    return vec3_normalize(vec3_add_scaled(vec3_scale(v, cosine), to, sine));
}

/* The axis of the smallest cone that contains both, and the cosine of its half angle. */
static struct vec3 join_cones(struct vec3 axis_a, double cos_a, struct vec3 axis_b, double cos_b, double *cos_half) {
    double cosine = vec3_dot(axis_a, axis_b);
    *cos_half = cos_a;
    if (cos_a <= -1 || (cos_b >= 1 && cosine >= cos_a)) /* without a call of the arc cosine */
        return axis_a;
    double a = angle_of(cos_a), b = angle_of(cos_b), apart = angle_of(cosine);
    if (math_min(apart + b, PI) <= a)
        return axis_a;
    *cos_half = cos_b;
    if (math_min(apart + a, PI) <= b)
        return axis_b;
    double half = (a + apart + b) / 2;
    struct vec3 across = vec3_sub(axis_b, vec3_scale(axis_a, cosine));
    *cos_half = -1;
    if (half >= PI || !(vec3_length(across) > 0))
        return axis_a;
    *cos_half = math_max(-1, el_cos(half) - 0x1p-40);
    return turned(axis_a, vec3_normalize(across), half - a);
}

struct light_bounds light_bounds_join(const struct light_bounds *a, const struct light_bounds *b) {
    struct light_bounds out = {.box = box_join(a->box, b->box),
                               .cos_theta_e = math_min(a->cos_theta_e, b->cos_theta_e),
                               .two_sided = a->two_sided || b->two_sided,
                               .steady = math_min(a->steady + b->steady, max),
                               .attenuation = math_min(a->attenuation + b->attenuation, max),
                               .range = math_max(a->range, b->range)};
    struct vec3 axis_b = b->axis;
    if (a->two_sided && b->two_sided && vec3_dot(a->axis, b->axis) < 0)
        axis_b = vec3_negate(axis_b);
    out.axis = join_cones(a->axis, a->cos_theta_o, axis_b, b->cos_theta_o, &out.cos_theta_o);
    double both = a->attenuation + b->attenuation;
    for (int i = 0; i < 3 && both > 0; i++)
        out.falloff[i] = a->falloff[i] * (a->attenuation / both) + b->falloff[i] * (b->attenuation / both);
    work_out(&out);
    return out;
}

/* --- importance --- */

/* The cosine of max(0, a - b). */
static double cos_less(double sin_a, double cos_a, double sin_b, double cos_b) {
    return cos_a > cos_b ? 1 : cos_a * cos_b + sin_a * sin_b;
}

static double min_distance(const struct box *box, struct vec3 point) {
    struct vec3 inside = vec3_min(vec3_max(point, box->min), box->max);
    return vec3_length(vec3_sub(point, inside));
}

/* The light at a distance, without the dependence on direction. */
static double strength_at(const struct light_bounds *b, struct vec3 point, double distance) {
    double steady = b->steady;
    if (b->range < INFINITY) {
        double nearest = min_distance(&b->box, point);
        if (nearest >= b->range)
            return 0;
        steady *= 1 - nearest / b->range;
    }
    if (!(b->attenuation > 0))
        return steady;
    double fall = b->falloff[0] + b->falloff[1] * distance + b->falloff[2] * distance * distance;
    return steady + number_clamped(b->attenuation / fall, max);
}

double light_bounds_importance(const struct light_bounds *b, struct vec3 point, struct vec3 normal) {
    struct vec3 away = vec3_sub(point, b->centre);
    double radius = b->radius, distance = vec3_length(away);
    double strength = strength_at(b, point, larger(distance, radius));
    if (!(distance > radius))
        return strength;
    double inverse = 1 / distance;
    /* Half the angle of the ball. */
    double sin_b = radius * inverse, cos_b = sqrt((1 - sin_b) * (1 + sin_b));
    double cos_w = vec3_dot(b->axis, away) * inverse, cos_o = b->cos_theta_o, sin_o = b->sin_theta_o;
    if (b->two_sided)
        cos_w = fabs(cos_w);
    if (cos_w <= cos_o) { /* the direction is beside the cone of normals */
        double sin_w = sine_of(cos_w);
        double cos_x = cos_w * cos_o + sin_w * sin_o, sin_x = sin_w * cos_o - cos_w * sin_o;
        double cos_leaving = cos_less(sin_x, cos_x, sin_b, cos_b);
        if (cos_leaving < b->cos_theta_e)
            return 0;
        strength *= cos_leaving;
    }
    if (normal.x == 0 && normal.y == 0 && normal.z == 0)
        return strength;
    /* Highlights of classic materials have no cosine: light at grazing angles must keep a chance. */
    double cos_i = fabs(vec3_dot(away, normal)) * inverse;
    return cos_i > cos_b ? strength : strength * larger(min_cosine, cos_i * cos_b + sine_of(cos_i) * sin_b);
}

/* The attenuation of delta lights: by distance, and for a spot by its cone (docs/design/light.md). */

/* For a denominator of zero or a point at the light. A colour times it is finite. */
static const double strongest = 1e200;

double light_attenuation(const struct light *light, double distance) {
    const double *c = light->falloff;
    switch (light->attenuation) {
    case ATTENUATION_RANGE:
        return distance < light->range ? 1 - distance / light->range : 0;
    case ATTENUATION_INVERSE_SQUARE:
        return number_clamped(light->intensity / (distance * distance), strongest);
    case ATTENUATION_COEFFICIENTS:
        break;
    }
    if (c[0] == 0 && c[1] == 0 && c[2] == 0)
        return 1;
    return number_clamped(1 / (c[0] + c[1] * distance + c[2] * distance * distance), strongest);
}

/* Share of a spot's light in the unit direction from the light: 1 inside the inner cone, 0 outside the outer, between
 * them the cubic 3 s^2 - 2 s^3 of the cosine. */
double light_cone(const struct light *light, struct vec3 from_light) {
    double cosine = vec3_dot(light->direction, from_light);
    if (cosine >= light->cos_inner)
        return 1;
    if (cosine <= light->cos_outer)
        return 0;
    double s = (cosine - light->cos_outer) / (light->cos_inner - light->cos_outer);
    return s * s * (3 - 2 * s);
}

/* The points p from the tip with axis p >= cosine |p|: between or beyond the roots of A t^2 + 2 B t + C, on the side of
 * the axis. */
static bool cut_cone(const struct light *light, struct vec3 origin, struct vec3 d, double *from, double *to) {
    struct vec3 o = vec3_sub(origin, light->position), axis = light->direction;
    double square = light->cos_outer * light->cos_outer, along = vec3_dot(axis, d), start = vec3_dot(axis, o);
    double a = along * along - square, b = along * start - square * vec3_dot(o, d);
    double rest = b * b - a * (start * start - square * vec3_dot(o, o));
    if (!(rest > 0) || a == 0)
        return a == 0;
    double root = sqrt(rest), one = (-b - root) / a, two = (-b + root) / a, low = math_min(one, two),
           high = math_max(one, two);
    if (a < 0) {
        if (start + along * (low + high) / 2 < 0)
            return false;
        *from = math_max(*from, low);
        *to = math_min(*to, high);
    } else if (along > 0) {
        *from = math_max(*from, high);
    } else {
        *to = math_min(*to, low);
    }
    return *from < *to;
}

bool light_cut(const struct light *light, struct vec3 origin, struct vec3 direction, double *from, double *to) {
    bool narrow = light->kind == LIGHT_SPOT && light->cos_outer > 0;
    return !narrow || cut_cone(light, origin, direction, from, to);
}

void light_bounds_fade(const struct light *light, struct light_bounds *out) {
    double strength = light_strength(light);
    const double *c = light->falloff;
    switch (light->attenuation) {
    case ATTENUATION_RANGE:
        out->steady = strength;
        out->range = light->range;
        return;
    case ATTENUATION_INVERSE_SQUARE:
        out->attenuation = strength * fabs(light->intensity);
        out->falloff[2] = 1;
        return;
    case ATTENUATION_COEFFICIENTS:
        break;
    }
    bool constant = c[1] == 0 && c[2] == 0;
    if (constant)
        out->steady = c[0] != 0 ? strength / fabs(c[0]) : strength;
    else
        out->attenuation = strength;
    for (int i = 0; i < 3 && !constant; i++)
        out->falloff[i] = fabs(c[i]);
}
