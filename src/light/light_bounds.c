/* Bounds of lights, for light_sampler.c: those of a kind, their union and their importance. The formulas for cones are
 * those of Pharr, Jakob and Humphreys, sections 3.8.4 and 12.6.3. All decisions err towards giving a light a chance:
 * importance is 0 only where nothing arrives. */
#include "light/light_internal.h"
#include "light/light_mesh.h"
#include "light/light_sampler.h"
#include "math/elementary.h"
#include "math/range.h"

static const double pi = 3.14159265358979323846;

/* Sums over many lights and products with distances stay finite. */
static const double most = 1e200;

static const double least_cosine = 1.0 / 32;

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

static double magnitude(struct vec3 c) {
    return (fabs(c.x) + fabs(c.y) + fabs(c.z)) / 3;
}

static struct box box_around(struct vec3 centre, struct vec3 half) {
    return (struct box){vec3_sub(centre, half), vec3_add(centre, half)};
}

static struct box box_of_parallelogram(const struct light *light) {
    struct box box = {light->corner, light->corner};
    box = box_add_point(box, vec3_add(light->corner, light->edge1));
    box = box_add_point(box, vec3_add(light->corner, light->edge2));
    return box_add_point(box, vec3_add(vec3_add(light->corner, light->edge1), light->edge2));
}

static struct box box_of_disc(const struct light *light) {
    struct vec3 n = light->direction;
    struct vec3 sines = {sqrt(fmax(0, 1 - n.x * n.x)), sqrt(fmax(0, 1 - n.y * n.y)), sqrt(fmax(0, 1 - n.z * n.z))};
    return box_around(light->position, vec3_scale(sines, light->radius));
}

/* Into all directions alike. */
static void shine_everywhere(struct light_bounds *out) {
    out->axis = vec3_make(0, 1, 0);
    out->cos_theta_o = -1;
    out->cos_theta_e = 1;
}

/* How a delta light fades (light.c). */
static void fade(const struct light *light, struct light_bounds *out) {
    double strength = magnitude(light->colour);
    const double *c = light->falloff;
    switch (light->fading) {
    case FADING_RANGE:
        out->steady = strength;
        out->range = light->range;
        return;
    case FADING_INVERSE_SQUARE:
        out->fading = strength * fabs(light->intensity);
        out->falloff[2] = 1;
        return;
    case FADING_COEFFICIENTS:
        break;
    }
    bool constant = c[1] == 0 && c[2] == 0;
    if (constant)
        out->steady = c[0] != 0 ? strength / fabs(c[0]) : strength;
    else
        out->fading = strength;
    for (int i = 0; i < 3 && !constant; i++)
        out->falloff[i] = fabs(c[i]);
}

static void emit(double intensity, struct light_bounds *out) {
    out->fading = intensity;
    out->falloff[2] = 1;
}

/* From a parallelogram or disc of an area over pi. */
static void shine_from_plane(const struct light *light, struct vec3 normal, double area, struct light_bounds *out) {
    (void)light_surface_box(light, &out->box);
    emit(magnitude(light->colour) * area, out);
    out->axis = normal;
    out->cos_theta_o = 1;
    out->cos_theta_e = 0;
    out->two_sided = !light->one_sided;
}

/* The cone about the mean normal that holds all normals. What is seen of the triangles is their projection: as much as
 * the sum of their vectors, and a quarter of their area (Cauchy), a half where both sides shine, on average. */
static void bounds_of_mesh(const struct light_mesh *mesh, struct light_bounds *out) {
    struct vec3 sum = {0, 0, 0};
    double all = 0, least = 1;
    out->box = box_empty();
    for (uint32_t i = 0; i < mesh->count; i++) {
        const struct light_triangle *t = &mesh->triangles[i];
        double weight = vec3_length(vec3_cross(t->edge1, t->edge2)) / 2 * magnitude(light_triangle_radiance(t));
        sum = vec3_add_scaled(sum, t->normal, weight);
        all += weight;
        out->box = box_add_point(out->box, t->corner);
        out->box = box_add_point(out->box, vec3_add(t->corner, t->edge1));
        out->box = box_add_point(out->box, vec3_add(t->corner, t->edge2));
    }
    out->axis = vec3_normalize(sum);
    bool directed = vec3_length(sum) > 0x1p-20 * all;
    for (uint32_t i = 0; i < mesh->count && directed; i++)
        least = fmin(least, vec3_dot(out->axis, mesh->triangles[i].normal));
    emit(intensity_of(fmax(vec3_length(sum), all / (mesh->one_sided ? 4 : 2))), out);
    out->cos_theta_o = directed ? fmax(-1, least - 0x1p-40) : -1;
    out->cos_theta_e = 0;
    out->two_sided = !mesh->one_sided;
    if (!directed)
        out->axis = vec3_make(0, 1, 0);
}

bool light_surface_box(const struct light *light, struct box *out) {
    switch (light->kind) {
    case LIGHT_PARALLELOGRAM:
        *out = box_of_parallelogram(light);
        return true;
    case LIGHT_DISC:
        *out = box_of_disc(light);
        return true;
    case LIGHT_SPHERE:
        *out = box_around(light->position, vec3_all(light->radius));
        return true;
    case LIGHT_POINT:
    case LIGHT_DIRECTIONAL:
    case LIGHT_SPOT:
    case LIGHT_MESH:
    case LIGHT_SKY:
        break;
    }
    return false;
}

enum light_reach light_bounds_of(const struct light *light, struct light_bounds *out) {
    struct vec3 across;
    *out = (struct light_bounds){.box = {light->position, light->position}, .range = INFINITY};
    shine_everywhere(out);
    switch (light->kind) {
    case LIGHT_POINT:
        fade(light, out);
        break;
    case LIGHT_SPOT:
        fade(light, out);
        out->axis = light->direction;
        out->cos_theta_o = fmax(-1, fmin(1, light->cos_outer) - 0x1p-40);
        break;
    case LIGHT_PARALLELOGRAM:
        if (light_is_delta(light)) {
            fade(light, out);
            break;
        }
        across = vec3_cross(light->edge1, light->edge2);
        shine_from_plane(light, vec3_normalize(across), intensity_of(vec3_length(across)), out);
        break;
    case LIGHT_DISC:
        if (light_is_delta(light)) {
            fade(light, out);
            break;
        }
        shine_from_plane(light, light->direction, light->radius * light->radius, out); /* the area is pi r^2 */
        break;
    case LIGHT_SPHERE:
        if (light_is_delta(light)) {
            fade(light, out);
            break;
        }
        (void)light_surface_box(light, &out->box);
        emit(magnitude(light->colour) * light->radius * light->radius, out); /* as a disc in all directions */
        break;
    case LIGHT_MESH:
        bounds_of_mesh(light->mesh, out);
        break;
    case LIGHT_DIRECTIONAL:
    case LIGHT_SKY:
        return magnitude(light->colour) > 0 ? LIGHT_REACH_INFINITE : LIGHT_REACH_NONE;
    }
    out->steady = fmin(out->steady, most);
    out->fading = fmin(out->fading, most);
    work_out(out);
    bool shines = out->steady + out->fading > 0 && vec3_finite(out->box.min) && vec3_finite(out->box.max);
    return shines ? LIGHT_REACH_PLACED : LIGHT_REACH_NONE;
}

/* --- unions --- */

static double angle_of(double cosine) {
    return el_acos(fmax(-1, fmin(1, cosine)));
}

/* v turned by the angle towards `to`, a unit vector at right angles to it. */
static struct vec3 turned(struct vec3 v, struct vec3 to, double angle) {
    double sine, cosine;
    el_sincos(angle, &sine, &cosine);
    return vec3_normalize(vec3_add_scaled(vec3_scale(v, cosine), to, sine));
}

/* The axis of the smallest cone that holds both, and the cosine of its half angle. */
static struct vec3 join_cones(struct vec3 axis_a, double cos_a, struct vec3 axis_b, double cos_b, double *cos_half) {
    double a = angle_of(cos_a), b = angle_of(cos_b), apart = angle_of(vec3_dot(axis_a, axis_b));
    *cos_half = cos_a;
    if (fmin(apart + b, pi) <= a)
        return axis_a;
    *cos_half = cos_b;
    if (fmin(apart + a, pi) <= b)
        return axis_b;
    double half = (a + apart + b) / 2;
    struct vec3 across = vec3_sub(axis_b, vec3_scale(axis_a, vec3_dot(axis_a, axis_b)));
    *cos_half = -1;
    if (half >= pi || !(vec3_length(across) > 0))
        return axis_a;
    *cos_half = fmax(-1, el_cos(half) - 0x1p-40);
    return turned(axis_a, vec3_normalize(across), half - a);
}

struct light_bounds light_bounds_join(const struct light_bounds *a, const struct light_bounds *b) {
    struct light_bounds out = {.box = box_join(a->box, b->box),
                               .cos_theta_e = fmin(a->cos_theta_e, b->cos_theta_e),
                               .two_sided = a->two_sided || b->two_sided,
                               .steady = fmin(a->steady + b->steady, most),
                               .fading = fmin(a->fading + b->fading, most),
                               .range = fmax(a->range, b->range)};
    struct vec3 axis_b = b->axis;
    if (a->two_sided && b->two_sided && vec3_dot(a->axis, b->axis) < 0)
        axis_b = vec3_negate(axis_b);
    out.axis = join_cones(a->axis, a->cos_theta_o, axis_b, b->cos_theta_o, &out.cos_theta_o);
    double both = a->fading + b->fading;
    for (int i = 0; i < 3 && both > 0; i++)
        out.falloff[i] = a->falloff[i] * (a->fading / both) + b->falloff[i] * (b->fading / both);
    work_out(&out);
    return out;
}

/* --- importance --- */

/* The cosine of max(0, a - b). */
static double cos_less(double sin_a, double cos_a, double sin_b, double cos_b) {
    return cos_a > cos_b ? 1 : cos_a * cos_b + sin_a * sin_b;
}

static double least_distance(const struct box *box, struct vec3 point) {
    struct vec3 inside = vec3_min(vec3_max(point, box->min), box->max);
    return vec3_length(vec3_sub(point, inside));
}

/* What arrives at a distance, its direction aside. */
static double strength_at(const struct light_bounds *b, struct vec3 point, double distance) {
    double steady = b->steady;
    if (b->range < INFINITY) {
        double nearest = least_distance(&b->box, point);
        if (nearest >= b->range)
            return 0;
        steady *= 1 - nearest / b->range;
    }
    if (!(b->fading > 0))
        return steady;
    double fall = b->falloff[0] + b->falloff[1] * distance + b->falloff[2] * distance * distance;
    return steady + number_clamped(b->fading / fall, most);
}

double light_bounds_importance(const struct light_bounds *b, struct vec3 point, struct vec3 normal) {
    struct vec3 away = vec3_sub(point, b->centre);
    double radius = b->radius, distance = vec3_length(away);
    double strength = strength_at(b, point, larger(distance, radius));
    if (!(distance > radius))
        return strength;
    double inverse = 1 / distance;
    /* Half the angle that the ball fills. */
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
    /* Highlights of classic materials know no cosine: light that grazes the surface keeps a chance. */
    double cos_i = fabs(vec3_dot(away, normal)) * inverse;
    return cos_i > cos_b ? strength : strength * larger(least_cosine, cos_i * cos_b + sine_of(cos_i) * sin_b);
}
